#include "api/error_map.h"

int error_of_dcf(enum dcf_error kind)
{
    switch (kind) {
    case DCF_ERROR_NONE: return MCANOPEN_OK;
    case DCF_ERROR_MEMORY: return CANOPEN_DCF_OUT_OF_MEMORY;
    case DCF_ERROR_MISSING_SECTION: return CANOPEN_DCF_MISSING_SECTION;
    case DCF_ERROR_MISSING_ENTRY: return CANOPEN_DCF_MISSING_ENTRY;
    case DCF_ERROR_WRONG_PARAMETER: return CANOPEN_DCF_WRONG_PARAMETER;
    case DCF_ERROR_OUT_OF_RANGE: return CANOPEN_DCF_OUT_OF_RANGE;
    case DCF_ERROR_OUT_OF_LIMITS: return CANOPEN_DCF_OUT_OF_LIMITS;
    case DCF_ERROR_DOUBLE_SECTION: return CANOPEN_DCF_DOUBLE_SECTION;
    case DCF_ERROR_DOUBLE_KEYWORD: return CANOPEN_DCF_DOUBLE_KEYWORD;
    case DCF_ERROR_UNKNOWN_KEYWORD: return CANOPEN_DCF_UNKNOWN_KEYWORD;
    case DCF_ERROR_WRONG_NODE_ID: return CANOPEN_DCF_WRONG_NODE_ID;
    case DCF_ERROR_WRONG_BAUDRATE: return CANOPEN_DCF_WRONG_BAUDRATE;
    case DCF_ERROR_WRONG_MODULE_NO: return CANOPEN_DCF_WRONG_MODULE_NO;
    }
    return CANOPEN_DCF_WRONG_PARAMETER;
}

static int error_of(enum co_err err, int other)
{
    if (err == CO_OK)
        return MCANOPEN_OK;
    return err == CO_ERR_MEMORY ? MCAL_OBJ_NO_MEMORY : other;
}

int error_of_xml(enum co_err err)
{
    if (err == CO_ERR_ARG)
        return CANOPEN_DCF_WRONG_MODULE_NO;
    if (err == CO_ERR_BITRATE)
        return CANOPEN_DCF_WRONG_BAUDRATE;
    return error_of(err, err == CO_ERR_VALUE ? MCAL_PARA_ERROR : MCAL_SYS_ERROR);
}

int error_of_bus(enum co_err err)
{
    return error_of(err, err == CO_ERR_BITRATE ? CANOPEN_DCF_WRONG_BAUDRATE : MCAL_SYS_ERROR);
}

int error_of_command(enum co_err err)
{
    if (err == CO_ERR_NOT_FOUND)
        return MCAL_NODE_NOT_EXISTEND;
    if (err == CO_ERR_AGAIN)
        return MCAL_CAN_CONTR_BUSY;
    return error_of(err, MCAL_NODE_NOT_FREE);
}

int error_of_sdo(const struct co_event *result)
{
    switch ((enum sdo_outcome)result->detail) {
    case SDO_OUTCOME_OK: return MCANOPEN_OK;
    case SDO_OUTCOME_ABORTED: return MCAL_ABORT_DOMAIN;
    case SDO_OUTCOME_NO_ANSWER: return MCAL_CAN_RX_TIMEOUT;
    case SDO_OUTCOME_NOT_SENT: return MCAL_CAN_TX_TIMEOUT;
    case SDO_OUTCOME_TOGGLE: return MCAL_TOGGLE_ERROR;
    case SDO_OUTCOME_PROTOCOL: return MCAL_WRONG_SERVER_ANSWER;
    case SDO_OUTCOME_OVERFLOW: return MCAL_BUFFER_OVERFLOW;
    case SDO_OUTCOME_CANCELLED: return MCAL_NO_NET;
    }
    return MCAL_WRONG_SERVER_ANSWER;
}

void error_set(ERROR_T *error, sdo_abort_t code)
{
    if (!error)
        return;
    error->eclass = (unsigned char)(code >> 24);
    error->code = (unsigned char)(code >> 16);
    error->spec = (unsigned char)(code >> 8);
    error->global = (unsigned char)code;
}

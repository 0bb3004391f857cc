#include "api/error_map.h"

static const int dcf_codes[] = {
    [DCF_ERROR_NONE] = MCANOPEN_OK,
    [DCF_ERROR_MEMORY] = CANOPEN_DCF_OUT_OF_MEMORY,
    [DCF_ERROR_MISSING_SECTION] = CANOPEN_DCF_MISSING_SECTION,
    [DCF_ERROR_MISSING_ENTRY] = CANOPEN_DCF_MISSING_ENTRY,
    [DCF_ERROR_WRONG_PARAMETER] = CANOPEN_DCF_WRONG_PARAMETER,
    [DCF_ERROR_OUT_OF_RANGE] = CANOPEN_DCF_OUT_OF_RANGE,
    [DCF_ERROR_OUT_OF_LIMITS] = CANOPEN_DCF_OUT_OF_LIMITS,
    [DCF_ERROR_DOUBLE_SECTION] = CANOPEN_DCF_DOUBLE_SECTION,
    [DCF_ERROR_DOUBLE_KEYWORD] = CANOPEN_DCF_DOUBLE_KEYWORD,
    [DCF_ERROR_UNKNOWN_KEYWORD] = CANOPEN_DCF_UNKNOWN_KEYWORD,
    [DCF_ERROR_WRONG_NODE_ID] = CANOPEN_DCF_WRONG_NODE_ID,
    [DCF_ERROR_WRONG_BAUDRATE] = CANOPEN_DCF_WRONG_BAUDRATE,
    [DCF_ERROR_WRONG_MODULE_NO] = CANOPEN_DCF_WRONG_MODULE_NO,
};

int error_of_dcf(enum dcf_error kind)
{
    unsigned number = (unsigned)kind;

    return number < sizeof dcf_codes / sizeof dcf_codes[0] ? dcf_codes[number]
                                                           : CANOPEN_DCF_WRONG_PARAMETER;
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
    if (err == CO_ERR_AGAIN)
        return CANOPEN_DCF_WRONG_NET_NO;
    return error_of(err, err == CO_ERR_VALUE ? MCAL_PARA_ERROR : MCAL_SYS_ERROR);
}

int error_of_bus(enum co_err err)
{
    if (err == CO_ERR_VALUE) /* not as the slaves of this process have it */
        return MCAL_PARA_ERROR;
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

int error_of_bus_state(enum bus_state state)
{
    switch (state) {
    case BUS_OFF: return MCAL_CAN_CONTR_OFF_BUS;
    case BUS_DOWN: return MCAL_CAN_TX_ERROR;
    case BUS_ACTIVE:
    case BUS_WARNING:
    case BUS_PASSIVE: return MCANOPEN_OK;
    }
    return MCANOPEN_OK;
}

/* A frame that did not get out in time. */
static int error_of_unsent(enum bus_state state)
{
    int result = error_of_bus_state(state);

    if (result != MCANOPEN_OK)
        return result;
    return state == BUS_PASSIVE ? MCAL_CAN_CONTR_WARN : MCAL_CAN_TX_TIMEOUT;
}

int error_of_sdo(const struct co_event *result, enum bus_state state)
{
    switch ((enum sdo_outcome)result->detail) {
    case SDO_OUTCOME_OK: return MCANOPEN_OK;
    case SDO_OUTCOME_ABORTED: return MCAL_ABORT_DOMAIN;
    case SDO_OUTCOME_NO_ANSWER: return MCAL_CAN_RX_TIMEOUT;
    case SDO_OUTCOME_NOT_SENT: return error_of_unsent(state);
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

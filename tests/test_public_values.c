/*
 * What the values of the two headers promise each other.
 */
#include "mcanopen.h"
#include "scanopen.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const int codes[] = {
    MCAL_CAN_RX_TIMEOUT,
    MCAL_CAN_TX_TIMEOUT,
    MCAL_CAN_TX_ERROR,
    MCAL_CAN_CONTR_OFF_BUS,
    MCAL_CAN_CONTR_WARN,
    MCAL_CAN_CONTR_BUSY,
    MCAL_PARA_ERROR,
    MCAL_SYS_ERROR,
    MCAL_NO_NET,
    MCAL_OBJ_NO_MEMORY,
    MCAL_NODE_NOT_EXISTEND,
    MCAL_NO_EVENT,
    MCAL_UNSUPPORTED,
    MCAL_WRONG_SERVER_ANSWER,
    MCAL_TOGGLE_ERROR,
    MCAL_BUFFER_OVERFLOW,
    MCAL_ABORT_DOMAIN,
    MCAL_DOWNLOAD_ABORT_SLAVE,
    MCAL_WRONG_SLAVE_ANSWER,
    MCAL_WRONG_GUARD_ID,
    MCAL_NEW_GUARD_PARA,
    MCAL_NODE_NOT_FREE,
    CANOPEN_DCF_INIT_ERROR,
    CANOPEN_DCF_OUT_OF_MEMORY,
    CANOPEN_DCF_WRONG_NODE_ID,
    CANOPEN_DCF_WRONG_BAUDRATE,
    CANOPEN_DCF_MISSING_SECTION,
    CANOPEN_DCF_MISSING_ENTRY,
    CANOPEN_DCF_WRONG_PARAMETER,
    CANOPEN_DCF_OUT_OF_RANGE,
    CANOPEN_DCF_OUT_OF_LIMITS,
    CANOPEN_DCF_DOUBLE_SECTION,
    CANOPEN_DCF_DOUBLE_KEYWORD,
    CANOPEN_DCF_UNKNOWN_KEYWORD,
    CANOPEN_DCF_WRONG_NET_NO,
    CANOPEN_DCF_WRONG_MODULE_NO,
    SCANOPEN_WRONG_INDEX,
    SCANOPEN_WRONG_SUBINDEX,
    SCANOPEN_OUT_OF_MEMORY,
    SCANOPEN_WRONG_BAUDRATE,
    SCANOPEN_CANNOT_START_DAEMON,
    SCANOPEN_WRONG_PARAMETER,
    SCANOPEN_VALUE_TOO_HIGH,
    SCANOPEN_VALUE_TOO_LOW,
    SCANOPEN_WRONG_TYPE,
    SCANOPEN_WRONG_OBJECT_TYPE,
    SCANOPEN_PDO_MAPPING_ERROR,
    SCANOPEN_TOO_MANY_OBJECTS,
    SCANOPEN_WRONG_NODESTATE,
    SCANOPEN_SERVICE_NOT_ALLOWED,
    SCANOPEN_LENGTH_MISMATCH,
    SCANOPEN_INIT_ERRORS,
    SCANOPEN_INVALID_HANDLE,
    SCANOPEN_ACCESS_ERROR,
    SCANOPEN_PDO_PARAMETER_ERROR,
    SCANOPEN_NOT_IMPLEMENTED,
    SCANOPEN_INHIBITED,
    SCANOPEN_RX_TIMEOUT,
    SCANOPEN_TX_TIMEOUT,
};

/* A handler returns one of these or a positive abort code, so negative is what they have to be. */
START_TEST(codes_are_negative_and_differ)
{
    for (size_t i = 0; i < COUNT(codes); i++) {
        ck_assert_int_lt(codes[i], 0);
        for (size_t j = 0; j < i; j++)
            ck_assert_int_ne(codes[i], codes[j]);
    }
}
END_TEST

START_TEST(flags_do_not_share_bits)
{
    static const unsigned long kinds[] = { NET_NOT_VAL, NOD_NOT_VAL, PARA };
    static const unsigned long members[] = { PARA_C,  PARA_UC, PARA_S,  PARA_US,    PARA_I,
                                             PARA_UI, PARA_L,  PARA_UL, PARA_WRITE, PARA_STR };
    unsigned long all = 0xFF;

    for (size_t i = 0; i < COUNT(kinds); i++) {
        ck_assert_uint_eq(all & kinds[i], 0);
        all |= kinds[i];
    }
    ck_assert_uint_eq(all, 0xFFFFFFFFUL);
    for (size_t i = 0; i < COUNT(members); i++)
        ck_assert_uint_eq(members[i], 0x100UL << i);
}
END_TEST

static const struct {
    int type;
    const char *map;
} types[] = {
    { TYP_BOOL, MAP_BOOL },
    { TYP_INT8, MAP_INT8 },
    { TYP_INT16, MAP_INT16 },
    { TYP_INT32, MAP_INT32 },
    { TYP_INT64, MAP_INT64 },
    { TYP_UINT8, MAP_UINT8 },
    { TYP_UINT16, MAP_UINT16 },
    { TYP_UINT32, MAP_UINT32 },
    { TYP_UINT64, MAP_UINT64 },
    { TYP_FLOAT, MAP_FLOAT },
    { TYP_DOUBLE, MAP_DOUBLE },
    { TYP_CHAR, MAP_CHAR },
    { TYP_VIS_STRING, MAP_VIS_STRING },
    { TYP_OCT_STRING, MAP_OCT_STRING },
    { TYP_TIME_OF_DAY, MAP_TIME_OF_DAY },
    { TYP_TIME_DIFFERENCE, MAP_TIME_DIFFERENCE },
    { TYP_DOMAIN, MAP_DOMAIN },
};

START_TEST(descriptors_hold_their_type)
{
    for (size_t i = 0; i < COUNT(types); i++) {
        ck_assert_int_ge(types[i].type, 1);
        ck_assert_int_le(types[i].type, 127);
        ck_assert_int_eq(types[i].map[0], types[i].type);
        ck_assert_uint_eq(strlen(types[i].map), 1);
        for (size_t j = 0; j < i; j++)
            ck_assert_int_ne(types[i].type, types[j].type);
    }
}
END_TEST

/* With all bits set, a number without a sign is the largest one. */
START_TEST(short_types)
{
    const UINT8 u8 = (UINT8)-1;
    const UINT16 u16 = (UINT16)-1;
    const UINT32 u32 = (UINT32)-1;
    const UINT64 u64 = (UINT64)-1;
    const INT8 i8 = -1;
    const INT16 i16 = -1;
    const INT32 i32 = -1;
    const INT64 i64 = -1;

    ck_assert_uint_eq(u8, UINT8_MAX);
    ck_assert_uint_eq(u16, UINT16_MAX);
    ck_assert_uint_eq(u32, UINT32_MAX);
    ck_assert_uint_eq(u64, UINT64_MAX);
    ck_assert_uint_eq(sizeof i8, 1);
    ck_assert_uint_eq(sizeof i16, 2);
    ck_assert_uint_eq(sizeof i32, 4);
    ck_assert_uint_eq(sizeof i64, 8);
    ck_assert_int_eq(i8 + i16 + i32 + i64, -4);
    (VOID) u8;
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("public_values");
    TCase *values = tcase_create("values");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_test(values, codes_are_negative_and_differ);
    tcase_add_test(values, flags_do_not_share_bits);
    tcase_add_test(values, descriptors_hold_their_type);
    tcase_add_test(values, short_types);
    suite_add_tcase(suite, values);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

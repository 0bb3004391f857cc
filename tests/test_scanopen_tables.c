/*
 * The table macros: which calls they make. The functions of the library are replaced here by ones
 * that note their calls, so scanopen_tables.h is included by itself, behind them.
 */
#define SCANOPEN_TABLES_H
#include "scanopen.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char calls[1024];
static int fail_at; /* the call that fails; 0: none */
static int call_count;

static int note(const char *text)
{
    size_t used = strlen(calls);

    snprintf(calls + used, sizeof calls - used, "%s\n", text);
    return ++call_count == fail_at ? SCANOPEN_OUT_OF_MEMORY : SCANOPEN_OK;
}

static int canOpenFakeExtend(HNODE node, unsigned short index, unsigned short count,
                             unsigned short object, const char *types)
{
    char text[128];
    int used = snprintf(text, sizeof text, "extend %d %04X %u %u:", node != NULL, index, count,
                        object);

    for (; *types; types++)
        used += snprintf(text + used, sizeof text - (size_t)used, " %02X", (unsigned)*types);
    return note(text);
}

static int canOpenFakeInit(HNODE node, unsigned short index, unsigned short sub, const char *name,
                           unsigned short flags, pDictionaryData data, PFN_COS_DATA_HANDLER handler)
{
    char text[128];

    snprintf(text, sizeof text, "init %d %04X:%02X %s %u %u %s", node != NULL, index, sub,
             name ? name : "-", flags, data ? data->uint8.val : 0u, handler ? "handler" : "-");
    return note(text);
}

static int canOpenFakeInitTs(HNODE node, unsigned short index, unsigned short sub, const char *name,
                             unsigned short flags, pDictionaryData data,
                             PFN_COS_DATA_HANDLER_TS handler)
{
    char text[128];

    snprintf(text, sizeof text, "init_ts %d %04X:%02X %s %u %u %s", node != NULL, index, sub,
             name ? name : "-", flags, data ? data->uint8.val : 0u, handler ? "handler" : "-");
    return note(text);
}

static int canOpenFakeDefinePDO(HNODE node, const char *name, uint32_t cob_id, uint16_t mode,
                                int32_t inhibit, uint16_t tx, uint16_t rx, int32_t timer,
                                const uint16_t *mapping, HPDO *pdo)
{
    char text[128];

    snprintf(text, sizeof text, "pdo %d %s %08X %04X %d %u %u %d %04X", node != NULL,
             name ? name : "-", cob_id, mode, inhibit, tx, rx, timer, mapping ? mapping[0] : 0u);
    *pdo = (HPDO)(void *)(calls + call_count);
    return note(text);
}

#define canOpenExtendDictionary canOpenFakeExtend
#define canOpenInitDictionary   canOpenFakeInit
#define canOpenInitDictionaryTs canOpenFakeInitTs
#define canOpenDefinePDO        canOpenFakeDefinePDO
#undef SCANOPEN_TABLES_H
#include "scanopen_tables.h"

static HNODE node = (HNODE)(void *)calls; /* any handle */
static DictionaryData seven = { .uint8 = { .val = 7 } };
static const char mixed[] = { TYP_INT32, TYP_INT16, 0 };
static const char mixed_with_count[] = { TYP_UINT8, TYP_INT32, TYP_INT16, 0 };
static const char too_many[] = { TYP_UINT8, TYP_INT32, TYP_INT16, TYP_INT8, 0 };

static int on_data(int net, int id, int index, int sub, void *data)
{
    return net + id + index + sub + (data != NULL);
}

static int on_data_ts(int net, int id, int index, int sub, void *data, uint64_t time)
{
    return net + id + index + sub + (data != NULL) + (time != 0);
}

static void before(void)
{
    calls[0] = '\0';
    call_count = 0;
    fail_at = 0;
}

START_TEST(variable_and_array)
{
    BEGIN_DICTIONARY_TABLE(Table)
        DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_INT16, READ_ACCESS, &seven, NULL, "name")
        DICTIONARY_ENTRY(0x2001, 2, OBJ_ARRAY, MAP_UINT8, WRITE_ACCESS, &seven, on_data, NULL)
    END_DICTIONARY_TABLE()

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Table), SCANOPEN_OK);
    ck_assert_str_eq(calls, "extend 1 2000 0 7: 03\n"
                            "init 1 2000:00 name 1 7 -\n"
                            "extend 1 2001 2 8: 05\n"
                            "init 1 2001:01 - 2 7 handler\n"
                            "init 1 2001:02 - 2 7 handler\n");
}
END_TEST

START_TEST(handlers_with_time)
{
    BEGIN_DICTIONARY_TABLE_TS(Table)
        DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_INT16, READ_ACCESS, &seven, NULL, NULL)
        DICTIONARY_ENTRY(0x2001, 1, OBJ_ARRAY, MAP_UINT8, WRITE_ACCESS, &seven, on_data_ts, NULL)
    END_DICTIONARY_TABLE_TS()

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Table), SCANOPEN_OK);
    ck_assert_str_eq(calls, "extend 1 2000 0 7: 03\n"
                            "init_ts 1 2000:00 - 1 7 -\n"
                            "extend 1 2001 1 8: 05\n"
                            "init_ts 1 2001:01 - 2 7 handler\n");
}
END_TEST

/* Sub-index 0 comes by itself: read-only, the number of the others. */
START_TEST(record)
{
    BEGIN_DICTIONARY_TABLE(One)
        DICTIONARY_ENTRY(0x2000, 2, OBJ_RECORD, MAP_INT32, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_DICTIONARY_TABLE(Each)
        DICTIONARY_ENTRY(0x2000, 2, OBJ_RECORD, mixed, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_DICTIONARY_TABLE(All)
        DICTIONARY_ENTRY(0x2000, 2, OBJ_RECORD, mixed_with_count, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    const char *rest = "init 1 2000:00 - 1 2 -\n"
                       "init 1 2000:01 - 0 7 -\n"
                       "init 1 2000:02 - 0 7 -\n";

    ck_assert_int_eq(DECLARE_DICTIONARY(node, One), SCANOPEN_OK);
    ck_assert_str_eq(strchr(calls, ':'), ": 05 04 04\ninit 1 2000:00 - 1 2 -\n"
                                         "init 1 2000:01 - 0 7 -\ninit 1 2000:02 - 0 7 -\n");
    calls[0] = '\0';
    ck_assert_int_eq(DECLARE_DICTIONARY(node, Each), SCANOPEN_OK);
    ck_assert_int_eq(strncmp(calls, "extend 1 2000 2 9: 05 04 03\n", 28), 0);
    ck_assert_str_eq(calls + 28, rest);
    calls[0] = '\0';
    ck_assert_int_eq(DECLARE_DICTIONARY(node, All), SCANOPEN_OK);
    ck_assert_int_eq(strncmp(calls, "extend 1 2000 2 9: 05 04 03\n", 28), 0);
    ck_assert_str_eq(calls + 28, rest);
}
END_TEST

START_TEST(record_with_wrong_descriptor)
{
    BEGIN_DICTIONARY_TABLE(Long)
        DICTIONARY_ENTRY(0x2000, 2, OBJ_RECORD, too_many, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_DICTIONARY_TABLE(Short)
        DICTIONARY_ENTRY(0x2000, 4, OBJ_RECORD, mixed, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_DICTIONARY_TABLE(None)
        DICTIONARY_ENTRY(0x2000, 4, OBJ_RECORD, NULL, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_DICTIONARY_TABLE(High)
        DICTIONARY_ENTRY(0x2000, 255, OBJ_RECORD, MAP_INT8, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Long), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(DECLARE_DICTIONARY(node, Short), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(DECLARE_DICTIONARY(node, None), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(DECLARE_DICTIONARY(node, High), SCANOPEN_WRONG_PARAMETER);
    ck_assert_str_eq(calls, "");
}
END_TEST

START_TEST(record_of_all_sub_indices)
{
    char types[256];

    memset(types, 'x', sizeof types);
    ck_assert_int_eq(canopen_describe_record_(MAP_INT8, 254, types), SCANOPEN_OK);
    ck_assert_int_eq(types[0], TYP_UINT8);
    ck_assert_int_eq(types[254], TYP_INT8);
    ck_assert_int_eq(types[255], 0);
}
END_TEST

START_TEST(first_error_ends_it)
{
    BEGIN_DICTIONARY_TABLE(Table)
        DICTIONARY_ENTRY(0x2000, 2, OBJ_RECORD, MAP_INT8, 0, &seven, NULL, NULL)
        DICTIONARY_ENTRY(0x2001, 1, OBJ_ARRAY, MAP_UINT8, 0, &seven, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_PDO_TABLE(Table)
        PDO_ENTRY_UNMAPPED(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, 0, 0)
        PDO_ENTRY_UNMAPPED(DEFAULT_PDO2, RECEIVE_PDO | 255, 0, 0, 0, 0)
    END_PDO_TABLE()

    for (int at = 1; at <= 6; at++) {
        call_count = 0;
        fail_at = at;
        ck_assert_int_eq(DECLARE_DICTIONARY(node, Table), SCANOPEN_OUT_OF_MEMORY);
        ck_assert_int_eq(call_count, at);
    }
    call_count = 0;
    fail_at = 1;
    ck_assert_int_eq(DECLARE_PDO(node, Table), SCANOPEN_OUT_OF_MEMORY);
    ck_assert_int_eq(call_count, 1);
}
END_TEST

START_TEST(pdos_get_their_handles)
{
    BEGIN_MAPPING_TABLE(Objects)
        MAPPING_ENTRY(0x6200, 1)
        MAPPING_ENTRY(0x6201, 2)
    END_MAPPING_TABLE()
    BEGIN_PDO_TABLE(Table)
        PDO_ENTRY(DEFAULT_PDO1 | RTR_DISALLOW, RECEIVE_PDO | 255, 1, 2, 3, 4, Objects)
        PDO_ENTRY_UNMAPPED(0x1F0 | PDO_INVALID, TRANSMIT_PDO | 1, 5, 6, 7, 8)
    END_PDO_TABLE()

    ck_assert_int_eq(DECLARE_PDO(node, Table), SCANOPEN_OK);
    ck_assert_str_eq(calls, "pdo 1 - 40000001 01FF 1 2 3 4 6200\n"
                            "pdo 1 - 800001F0 0201 5 6 7 8 0000\n");
    ck_assert_ptr_eq(_PDO_Table_Table[0].handle, (HPDO)(void *)calls);
    ck_assert_ptr_eq(_PDO_Table_Table[1].handle, (HPDO)(void *)(calls + 1));
    ck_assert_uint_eq(_Mapping_Objects[2], 0x6201);
    ck_assert_uint_eq(_Mapping_Objects[3], 2);
    ck_assert_uint_eq(_Mapping_Objects[4], 0);
    ck_assert_uint_eq(_Mapping_Objects[5], 0);
}
END_TEST

START_TEST(empty_tables)
{
    BEGIN_DICTIONARY_TABLE(Table)
    END_DICTIONARY_TABLE()
    BEGIN_PDO_TABLE(Table)
    END_PDO_TABLE()

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Table), SCANOPEN_OK);
    ck_assert_int_eq(DECLARE_PDO(node, Table), SCANOPEN_OK);
    ck_assert_str_eq(calls, "");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("scanopen_tables");
    TCase *tables = tcase_create("tables");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_checked_fixture(tables, before, NULL);
    tcase_add_test(tables, variable_and_array);
    tcase_add_test(tables, handlers_with_time);
    tcase_add_test(tables, record);
    tcase_add_test(tables, record_with_wrong_descriptor);
    tcase_add_test(tables, record_of_all_sub_indices);
    tcase_add_test(tables, first_error_ends_it);
    tcase_add_test(tables, pdos_get_their_handles);
    tcase_add_test(tables, empty_tables);
    suite_add_tcase(suite, tables);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

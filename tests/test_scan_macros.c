/*
 * The macros of the manual, 4.7, with the library behind them: what the tables declare is there for
 * an SDO client and in PDOs. (Which calls they make: test_scanopen_tables.c.)
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#define WRITE_STATE_32_OUTPUT_LINES 0x6320
#define READ_INPUT_32_BIT           0x6120

static struct scan_plant *plant;
static HNODE node;
static DictionaryData initial = { .uint32 = { .val = 0x11223344, .defval = 0x11223344 } };
static DictionaryData small = { .uint8 = { .val = 7, .defval = 7 } };
static const char mixed[] = { TYP_INT32, TYP_INT16, 0 };

static int on_time(int net, int id, int index, int sub, void *data, uint64_t time)
{
    scan_note("time %d", time != 0);
    return scan_on_data(net, id, index, sub, data);
}

/* The manual's example, at file scope. */
BEGIN_DICTIONARY_TABLE(AsyncIo)
    DICTIONARY_ENTRY(WRITE_STATE_32_OUTPUT_LINES, 2, OBJ_ARRAY, MAP_UINT32,
                     MAPPABLE | READ_ACCESS | WRITE_ACCESS, &initial, scan_on_data, NULL)
    DICTIONARY_ENTRY(READ_INPUT_32_BIT, 2, OBJ_ARRAY, MAP_UINT32, MAPPABLE | READ_ACCESS, &initial,
                     NULL, NULL)
END_DICTIONARY_TABLE()

BEGIN_MAPPING_TABLE(OutputMapping1)
    MAPPING_ENTRY(WRITE_STATE_32_OUTPUT_LINES, 1)
    MAPPING_ENTRY(WRITE_STATE_32_OUTPUT_LINES, 2)
END_MAPPING_TABLE()

BEGIN_MAPPING_TABLE(InputMapping1)
    MAPPING_ENTRY(READ_INPUT_32_BIT, 1)
    MAPPING_ENTRY(READ_INPUT_32_BIT, 2)
END_MAPPING_TABLE()

BEGIN_PDO_TABLE(AsyncIo)
    PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | 255, 0, 5000, 5000, 0,
              OutputMapping1)
    PDO_ENTRY(DEFAULT_PDO1, TIMER_DRIVEN_PDO | TRANSMIT_PDO | AUTO_NOTIFY_PDO | 255, 0, 5000, 5000,
              300, InputMapping1)
    PDO_ENTRY_UNMAPPED(DEFAULT_PDO2 | PDO_INVALID, TRANSMIT_PDO | 255, 5, 0, 0, 0)
END_PDO_TABLE()

static void set_up(void)
{
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
    scan_on_data_size(WRITE_STATE_32_OUTPUT_LINES, 4);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static uint32_t value_at(unsigned index, unsigned sub)
{
    uint32_t value = 0;

    ck_assert_uint_eq(scan_sdo_read(plant, 5, index, sub, &value), 0);
    return value;
}

START_TEST(the_example_of_the_manual)
{
    ck_assert_int_eq(DECLARE_DICTIONARY(node, AsyncIo), SCANOPEN_OK);
    ck_assert_int_eq(DECLARE_PDO(node, AsyncIo), SCANOPEN_OK);
    scan_activate(plant, node);
    ck_assert_uint_eq(value_at(WRITE_STATE_32_OUTPUT_LINES, 0), 2);
    ck_assert_uint_eq(value_at(WRITE_STATE_32_OUTPUT_LINES, 2), 0x11223344);
    ck_assert_uint_eq(value_at(0x1400, 1), 0x205);
    ck_assert_uint_eq(value_at(0x1600, 0), 2);
    ck_assert_uint_eq(value_at(0x1A00, 2), 0x61200220);
    ck_assert_uint_eq(value_at(0x1800, 5), 300); /* Reserved: the event timer */
    ck_assert_uint_eq(value_at(0x1801, 1), 0x80000285);
    ck_assert_uint_eq(value_at(0x1801, 3), 50);
    ck_assert_uint_eq(value_at(0x1A01, 0), 0);
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_send(plant, "205#0102030405060708");
    scan_expect_note("data 0/5 6320:01 01020304");
    scan_expect_note("data 0/5 6320:02 05060708");
    scan_forget(plant);
    ck_assert_int_eq(scan_set(node, READ_INPUT_32_BIT, 1, 0x99), SCANOPEN_OK);
    scan_await(plant, "185#9900000044332211");
}
END_TEST

START_TEST(handles_of_a_table)
{
    ck_assert_int_eq(DECLARE_DICTIONARY(node, AsyncIo), SCANOPEN_OK);
    ck_assert_int_eq(DECLARE_PDO(node, AsyncIo), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenWritePDO(_PDO_Table_AsyncIo[0].handle, NULL),
                     SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenWritePDO(_PDO_Table_AsyncIo[1].handle, NULL), SCANOPEN_OK);
    scan_await(plant, "185#4433221144332211");
    ck_assert_int_eq(canOpenWritePDO(_PDO_Table_AsyncIo[2].handle, NULL),
                     SCANOPEN_SERVICE_NOT_ALLOWED); /* invalid */
}
END_TEST

/* At function scope, with times, as a record; single entries are changed afterwards. */
START_TEST(tables_of_other_kinds)
{
    DictionaryData other = { .uint8 = { .val = 9, .defval = 9 } };

    BEGIN_DICTIONARY_TABLE_TS(Timed)
        DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_UINT8, READ_ACCESS | WRITE_ACCESS, &small, on_time,
                         "timed")
        DICTIONARY_ENTRY(0x2001, 3, OBJ_ARRAY, MAP_UINT8, READ_ACCESS, &small, NULL, NULL)
    END_DICTIONARY_TABLE_TS()
    BEGIN_DICTIONARY_TABLE(Records)
        DICTIONARY_ENTRY(0x2002, 2, OBJ_RECORD, mixed, READ_ACCESS, &small, NULL, NULL)
    END_DICTIONARY_TABLE()

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Timed), SCANOPEN_OK);
    ck_assert_int_eq(DECLARE_DICTIONARY(node, Records), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, 0x2001, 2, NULL, READ_ACCESS, &other, NULL),
                     SCANOPEN_OK);
    scan_activate(plant, node);
    ck_assert_uint_eq(value_at(0x2001, 0), 3);
    ck_assert_uint_eq(value_at(0x2001, 1), 7);
    ck_assert_uint_eq(value_at(0x2001, 2), 9);
    ck_assert_uint_eq(value_at(0x2001, 3), 7);
    ck_assert_uint_eq(value_at(0x2002, 0), 2);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 8), 0);
    scan_await_note("time 1");
    scan_expect_note("data 0/5 2000:00 08");
}
END_TEST

START_TEST(the_first_error_of_a_table)
{
    BEGIN_DICTIONARY_TABLE(Twice)
        DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_UINT8, READ_ACCESS, &small, NULL, NULL)
        DICTIONARY_ENTRY(0x2000, 0, OBJ_VAR, MAP_UINT8, READ_ACCESS, &small, NULL, NULL)
        DICTIONARY_ENTRY(0x2001, 0, OBJ_VAR, MAP_UINT8, READ_ACCESS, &small, NULL, NULL)
    END_DICTIONARY_TABLE()
    BEGIN_PDO_TABLE(Wrong)
        PDO_ENTRY(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, 0, 0, OutputMapping1)
    END_PDO_TABLE()
    uint8_t value;

    ck_assert_int_eq(DECLARE_DICTIONARY(node, Twice), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2001, 0, &value), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(DECLARE_PDO(node, Wrong), SCANOPEN_PDO_MAPPING_ERROR);
    ck_assert_int_eq(DECLARE_DICTIONARY(NULL, AsyncIo), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(DECLARE_PDO(NULL, AsyncIo), SCANOPEN_INVALID_HANDLE);
    ck_assert_ptr_null(_PDO_Table_Wrong[0].handle);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("macros");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, the_example_of_the_manual);
    tcase_add_test(tcase, handles_of_a_table);
    tcase_add_test(tcase, tables_of_other_kinds);
    tcase_add_test(tcase, the_first_error_of_a_table);
    return suite_run("scan_macros", tcase);
}

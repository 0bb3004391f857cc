/*
 * The object dictionary through the API and through SDO: all data types, kinds of objects, limits,
 * access rights, power-on values, handles.
 */
#include "support/hex.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static HNODE node;

static void set_up(void)
{
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static void extend(unsigned short index, unsigned short subs, unsigned short object,
                   const char *types)
{
    ck_assert_int_eq(canOpenExtendDictionary(node, index, subs, object, types), SCANOPEN_OK);
}

static void init(unsigned short index, unsigned short sub, unsigned short flags,
                 DictionaryData *data)
{
    ck_assert_int_eq(canOpenInitDictionary(node, index, sub, "an entry", flags, data, NULL),
                     SCANOPEN_OK);
}

/* What an SDO client reads, as hex digits. */
static const char *uploaded(unsigned index, unsigned sub)
{
    static char text[200];
    uint8_t bytes[64];
    unsigned size = sizeof bytes;
    uint32_t abort_code = scan_sdo_upload(plant, 5, index, sub, bytes, &size);

    if (abort_code != 0)
        snprintf(text, sizeof text, "abort %08X", abort_code);
    else
        hex_format(bytes, size, text, sizeof text);
    return text;
}

/* --- numbers of each type --- */

/* Values by hex digits, little-endian as on the bus and in this machine. */
static const struct type_row {
    const char *name, *types;
    unsigned size;
    DictionaryData data; /* present and power-on value, 4 .. 10 where there are limits */
    const char *first, *second, *power_on;
    bool limits;
    const char *high, *low;
} type_rows[] = {
    { "BOOL",
      MAP_BOOL,
      1,
      { .boolean = { .val = 1, .defval = 0 } },
      "01",
      "00",
      "00",
      false,
      NULL,
      NULL },
    { "INT8",
      MAP_INT8,
      1,
      { .int8 = { .val = -2, .defval = -1, .minval = -2, .maxval = 2 } },
      "FE",
      "02",
      "FF",
      true,
      "03",
      "FD" },
    { "INT16",
      MAP_INT16,
      2,
      { .int16 = { .val = -2, .defval = -1, .minval = -2, .maxval = 0x1234 } },
      "FEFF",
      "3412",
      "FFFF",
      true,
      "3512",
      "FDFF" },
    { "INT32",
      MAP_INT32,
      4,
      { .int32 = { .val = -2, .defval = 5, .minval = -2, .maxval = 0x12345678 } },
      "FEFFFFFF",
      "78563412",
      "05000000",
      true,
      "79563412",
      "FDFFFFFF" },
    { "INT64",
      MAP_INT64,
      8,
      { .int64 = { .val = -2, .defval = 5, .minval = -2, .maxval = 0x100000000 } },
      "FEFFFFFFFFFFFFFF",
      "0000000001000000",
      "0500000000000000",
      true,
      "0100000001000000",
      "FDFFFFFFFFFFFFFF" },
    { "UINT8",
      MAP_UINT8,
      1,
      { .uint8 = { .val = 9, .defval = 4, .minval = 4, .maxval = 200 } },
      "09",
      "C8",
      "04",
      true,
      "C9",
      "03" },
    { "UINT16",
      MAP_UINT16,
      2,
      { .uint16 = { .val = 9, .defval = 4, .minval = 4, .maxval = 0x8000 } },
      "0900",
      "0080",
      "0400",
      true,
      "0180",
      "0300" },
    { "UINT32",
      MAP_UINT32,
      4,
      { .uint32 = { .val = 9, .defval = 4, .minval = 4, .maxval = 0x80000000 } },
      "09000000",
      "00000080",
      "04000000",
      true,
      "01000080",
      "03000000" },
    { "UINT64",
      MAP_UINT64,
      8,
      { .uint64 = { .val = 9, .defval = 4, .minval = 4, .maxval = 0x8000000000000000 } },
      "0900000000000000",
      "0000000000000080",
      "0400000000000000",
      true,
      "0100000000000080",
      "0300000000000000" },
    { "FLOAT",
      MAP_FLOAT,
      4,
      { .float32 = { .val = 1.0f, .defval = 0.5f, .minval = -1.0f, .maxval = 2.0f } },
      "0000803F",
      "00000040",
      "0000003F",
      true,
      "01000040",
      "010080BF" },
    { "DOUBLE",
      MAP_DOUBLE,
      8,
      { .float64 = { .val = 1.0, .defval = 0.5, .minval = -1.0, .maxval = 2.0 } },
      "000000000000F03F",
      "0000000000000040",
      "000000000000E03F",
      true,
      "0100000000000040",
      "010000000000F0BF" },
    { "CHAR",
      MAP_CHAR,
      1,
      { .int8 = { .val = 'A', .defval = 'B' } },
      "41",
      "5A",
      "42",
      false,
      NULL,
      NULL },
    { "TIME_OF_DAY",
      MAP_TIME_OF_DAY,
      0,
      { .timeofday = { { .ulMs = 0x0ABCDEF0, .usDays = 0x1234 }, { .ulMs = 1, .usDays = 2 } } },
      "F0DEBC0A3412",
      NULL,
      "010000000200",
      false,
      NULL,
      NULL },
    { "TIME_DIFFERENCE",
      MAP_TIME_DIFFERENCE,
      0,
      { .timedifference = { { .ulMs = 0x0ABCDEF0, .usDays = 0x1234 },
                            { .ulMs = 3, .usDays = 4 } } },
      "F0DEBC0A3412",
      NULL,
      "030000000400",
      false,
      NULL,
      NULL },
};

static void write_number(const struct type_row *row, const char *digits, int result)
{
    uint8_t bytes[8] = { 0 };

    ck_assert_uint_eq(hex_parse(digits, bytes, sizeof bytes), row->size);
    ck_assert_msg(canOpenWriteDictionary(node, 0x2000, 0, bytes) == result, "%s %s", row->name,
                  digits);
}

static void expect_number(const struct type_row *row, const char *digits)
{
    uint8_t bytes[9];
    char text[20];

    if (row->size != 0) {
        memset(bytes, 0xEE, sizeof bytes);
        ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, bytes), SCANOPEN_OK);
        ck_assert_str_eq(hex_format(bytes, row->size, text, sizeof text), digits);
        ck_assert_uint_eq(bytes[row->size], 0xEE);
    }
    if (scan_state(node) != NodeOffline)
        ck_assert_str_eq(uploaded(0x2000, 0), digits);
}

/* Through the API and on the bus: the first value, another one, and after a reset the power-on. */
START_TEST(numbers)
{
    const struct type_row *row = &type_rows[_i];
    DictionaryData data = row->data;

    extend(0x2000, 0, OBJ_VAR, row->types);
    init(0x2000, 0, BOTH, &data);
    memset(&data, 0xEE, sizeof data); /* it was copied */
    expect_number(row, row->first);
    scan_activate(plant, node);
    expect_number(row, row->first);
    if (row->second) {
        write_number(row, row->second, SCANOPEN_OK);
        expect_number(row, row->second);
    }
    if (row->limits) {
        write_number(row, row->high, SCANOPEN_VALUE_TOO_HIGH);
        write_number(row, row->low, SCANOPEN_VALUE_TOO_LOW);
        expect_number(row, row->second);
    }
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    expect_number(row, row->power_on);
    scan_activate(plant, node);
    expect_number(row, row->power_on);
}
END_TEST

START_TEST(times)
{
    DictionaryData data = { .timeofday = { { 1, 2 }, { 3, 4 } } };
    CAN_TIME_OF_DAY now = { .ulMs = 86399999, .usDays = 15000 }, *day = NULL;
    CAN_TIME_DIFFERENCE long_ago = { .ulMs = 0x0FFFFFFF, .usDays = 65535 }, *difference = NULL;

    extend(0x2000, 0, OBJ_VAR, MAP_TIME_OF_DAY);
    init(0x2000, 0, BOTH, &data);
    extend(0x2001, 0, OBJ_VAR, MAP_TIME_DIFFERENCE);
    init(0x2001, 0, BOTH, &data);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenWriteDictionary(node, 0x2000, 0, &now), SCANOPEN_OK);
    ck_assert_int_eq(canOpenWriteDictionary(node, 0x2001, 0, &long_ago), SCANOPEN_OK);
    now.ulMs = 0;
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &day), SCANOPEN_OK);
    ck_assert_uint_eq(day->ulMs, 86399999);
    ck_assert_uint_eq(day->usDays, 15000);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2001, 0, &difference), SCANOPEN_OK);
    ck_assert_uint_eq(difference->ulMs, 0x0FFFFFFF);
    ck_assert_uint_eq(difference->usDays, 65535);
    ck_assert_str_eq(uploaded(0x2000, 0), "FF5B2605983A");
    ck_assert_str_eq(uploaded(0x2001, 0), "FFFFFF0FFFFF");
}
END_TEST

/* --- strings and domains --- */

static const struct text_row {
    const char *types;
} text_rows[] = { { MAP_VIS_STRING }, { MAP_OCT_STRING }, { MAP_DOMAIN } };

/* The three structures are alike; written through the member that the type has. */
static int write_text(const char *types, char *memory, unsigned long size, unsigned long length)
{
    RecVisString visible = { .pData = memory, .ulSize = size, .ulLength = length };
    RecOctString octets = { .pData = (unsigned char *)memory, .ulSize = size, .ulLength = length };
    RecDomain domain = { .pData = memory, .ulSize = size, .ulLength = length };
    const void *data = types[0] == TYP_VIS_STRING   ? (const void *)&visible
                       : types[0] == TYP_OCT_STRING ? (const void *)&octets
                                                    : (const void *)&domain;

    return canOpenWriteDictionary(node, 0x2000, 0, data);
}

START_TEST(strings)
{
    const char *types = text_rows[_i].types;
    static char memory[20], other[8]; /* the entry keeps them */
    char *text = NULL;
    DictionaryData data;

    memset(&data, 0, sizeof data);
    strcpy(memory, "twelve bytes");
    strcpy(other, "short");
    if (_i == 0)
        data.visstring = (RecVisString){ memory, sizeof memory, 12 };
    else if (_i == 1)
        data.octstring = (RecOctString){ (unsigned char *)memory, sizeof memory, 12 };
    else
        data.domain = (RecDomain){ memory, sizeof memory, 12 };
    extend(0x2000, 0, OBJ_VAR, types);
    init(0x2000, 0, BOTH, &data);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "twelve bytes");
    memory[0] = 'T'; /* the application's own memory */
    scan_activate(plant, node);
    ck_assert_str_eq(uploaded(0x2000, 0), "5477656C7665206279746573");
    ck_assert_int_eq(write_text(types, other, sizeof other, 5), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "short");
    ck_assert_str_eq(uploaded(0x2000, 0), "73686F7274");
    ck_assert_int_eq(write_text(types, other, sizeof other, 0), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "");
}
END_TEST

/* Memory with more in it than is used: the string ends where it says. */
START_TEST(a_string_ends_from_the_beginning)
{
    static char memory[8] = "longer";
    char *text = NULL;
    DictionaryData data = { .visstring = { memory, sizeof memory, 4 } };

    extend(0x2000, 0, OBJ_VAR, MAP_VIS_STRING);
    init(0x2000, 0, BOTH, &data);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "long");
}
END_TEST

/* A client writes into the application's memory, as long as there is room. */
START_TEST(strings_written_by_a_client)
{
    static char memory[4] = "old";
    char *text = NULL;
    DictionaryData data = { .visstring = { memory, sizeof memory, 3 } };

    extend(0x2000, 0, OBJ_VAR, MAP_VIS_STRING);
    init(0x2000, 0, BOTH, &data);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 4, 0x64636261), 0);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_mem_eq(text, "abcd", 4);
    scan_get(node, 0x1000, 0); /* the library's lock: the client's next write comes after this */
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0x7978), 0);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "xy");
    ck_assert_mem_eq(memory, "xy", 2);
    scan_send(plant, "605#2100200005000000"); /* five bytes */
    scan_expect(plant, "585#8000200012000706");
}
END_TEST

/* --- kinds of objects --- */

START_TEST(arrays)
{
    DictionaryData data = { .uint16 = { .val = 0x1234, .defval = 0x1234 } };

    extend(0x9FFF, 254, OBJ_ARRAY, MAP_UINT16);
    for (unsigned short sub = 1; sub <= 254; sub++)
        init(0x9FFF, sub, READ_ACCESS, &data);
    extend(0x2000, 0, OBJ_ARRAY, MAP_UINT16);
    scan_activate(plant, node);
    ck_assert_str_eq(uploaded(0x9FFF, 0), "FE");
    ck_assert_str_eq(uploaded(0x9FFF, 1), "3412");
    ck_assert_str_eq(uploaded(0x9FFF, 254), "3412");
    ck_assert_str_eq(uploaded(0x2000, 0), "00");
    ck_assert_str_eq(uploaded(0x2000, 1), "abort 06090011");
    ck_assert_uint_eq(scan_get(node, 0x9FFF, 0), 254);
    ck_assert_uint_ne(scan_sdo_write(plant, 5, 0x9FFF, 0, 1, 3), 0);
}
END_TEST

START_TEST(records)
{
    static const char types[] = { TYP_UINT8, TYP_INT32, TYP_INT16, 0 };
    DictionaryData two = { .uint8 = { .val = 2, .defval = 2 } };
    DictionaryData wide = { .int32 = { .val = -2, .defval = -2 } };
    DictionaryData narrow = { .int16 = { .val = -3, .defval = -3 } };

    extend(0x6000, 2, OBJ_RECORD, types);
    init(0x6000, 0, READ_ACCESS, &two);
    init(0x6000, 1, BOTH, &wide);
    init(0x6000, 2, BOTH, &narrow);
    scan_activate(plant, node);
    ck_assert_str_eq(uploaded(0x6000, 0), "02");
    ck_assert_str_eq(uploaded(0x6000, 1), "FEFFFFFF");
    ck_assert_str_eq(uploaded(0x6000, 2), "FDFF");
    ck_assert_str_eq(uploaded(0x6000, 3), "abort 06090011");
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x6000, 0, 1, 3), 0x06010002);
}
END_TEST

/* Data type and object type (CiA 301, 7.4.5). */
START_TEST(sub_index_ff)
{
    static const char types[] = { TYP_UINT8, TYP_INT32, TYP_INT16, 0 };
    uint32_t structure = 0;

    extend(0x2000, 0, OBJ_VAR, MAP_UINT32);
    extend(0x2001, 3, OBJ_ARRAY, MAP_INT16);
    extend(0x2002, 2, OBJ_RECORD, types);
    scan_activate(plant, node);
    ck_assert_str_eq(uploaded(0x2000, 0xFF), "07070000");
    ck_assert_str_eq(uploaded(0x2001, 0xFF), "08030000");
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x2002, 0xFF, &structure), 0);
    ck_assert_uint_eq(structure & 0xFF, OBJ_RECORD);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0xFF, 4, 0), 0x06010002);
}
END_TEST

START_TEST(an_entry_without_value_is_not_there_for_clients)
{
    extend(0x2000, 0, OBJ_VAR, MAP_UINT32);
    scan_activate(plant, node);
    ck_assert_uint_ne(scan_sdo_write(plant, 5, 0x2000, 0, 4, 1), 0);
    ck_assert_int_eq(strncmp(uploaded(0x2000, 0), "abort", 5), 0);
}
END_TEST

/* --- access rights and limits, as clients see them --- */

static const struct access_row {
    unsigned short flags;
    const char *read;
    uint32_t write;
} access_rows[] = {
    { 0, "abort 06010000", 0x06010000 }, /* or one of the two below */
    { READ_ACCESS, "01", 0x06010002 },
    { WRITE_ACCESS, "abort 06010001", 0 },
    { READ_ACCESS | WRITE_ACCESS, "01", 0 },
};

START_TEST(access_rights_of_clients)
{
    const struct access_row *row = &access_rows[_i];
    uint32_t write;

    scan_number(node, 0x2000, TYP_UINT8, row->flags, 1, NULL);
    scan_activate(plant, node);
    if (row->flags == 0) {
        ck_assert_int_eq(strncmp(uploaded(0x2000, 0), "abort 060100", 12), 0);
        write = scan_sdo_write(plant, 5, 0x2000, 0, 1, 2);
        ck_assert_uint_eq(write & 0xFFFFFFF0, 0x06010000);
        return;
    }
    ck_assert_str_eq(uploaded(0x2000, 0), row->read);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 2), row->write);
}
END_TEST

START_TEST(limits_for_clients)
{
    DictionaryData data = { .int16 = { .val = 0, .minval = -10, .maxval = 10 } };
    int16_t value = 0;

    extend(0x2000, 0, OBJ_VAR, MAP_INT16);
    init(0x2000, 0, BOTH, &data);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 11), 0x06090031);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0xFFF5), 0x06090032);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0xFFF6), 0);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &value), SCANOPEN_OK);
    ck_assert_int_eq(value, -10);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 4, 1), 0x06070012);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 1), 0x06070013);
}
END_TEST

/* --- the rest --- */

START_TEST(the_last_initialization_holds)
{
    DictionaryData first = { .uint8 = { .val = 1, .defval = 1, .maxval = 10 } };
    DictionaryData second = { .uint8 = { .val = 200, .defval = 100 } };

    extend(0x2000, 0, OBJ_VAR, MAP_UINT8);
    init(0x2000, 0, READ_ACCESS, &first);
    init(0x2000, 0, BOTH, &second);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 200);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 255), 0);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 100);
}
END_TEST

START_TEST(entries_by_handle)
{
    HDICT one = NULL, two = NULL, again = NULL;
    uint32_t value = 0;

    scan_number(node, 0x2000, TYP_UINT32, BOTH, 1, NULL);
    scan_number(node, 0x2001, TYP_UINT32, BOTH, 2, NULL);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2000, 0, &one), SCANOPEN_OK);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2001, 0, &two), SCANOPEN_OK);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2000, 0, &again), SCANOPEN_OK);
    scan_number(node, 0x3000, TYP_UINT32, BOTH, 3, NULL); /* the others stay valid */
    scan_activate(plant, node);
    value = 0x99;
    ck_assert_int_eq(canOpenWriteDictionaryHnd(one, &value), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionaryHnd(again, &value), SCANOPEN_OK);
    ck_assert_uint_eq(value, 0x99);
    ck_assert_int_eq(canOpenReadDictionaryHnd(two, &value), SCANOPEN_OK);
    ck_assert_uint_eq(value, 2);
    ck_assert_str_eq(uploaded(0x2000, 0), "99000000");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionaryHnd(one, &value), SCANOPEN_OK);
    ck_assert_uint_eq(value, 1);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, numbers, 0, COUNT(type_rows));
    tcase_add_test(tcase, times);
    tcase_add_loop_test(tcase, strings, 0, COUNT(text_rows));
    tcase_add_test(tcase, a_string_ends_from_the_beginning);
    tcase_add_test(tcase, strings_written_by_a_client);
    tcase_add_test(tcase, arrays);
    tcase_add_test(tcase, records);
    tcase_add_test(tcase, sub_index_ff);
    tcase_add_test(tcase, an_entry_without_value_is_not_there_for_clients);
    tcase_add_loop_test(tcase, access_rights_of_clients, 0, COUNT(access_rows));
    tcase_add_test(tcase, limits_for_clients);
    tcase_add_test(tcase, the_last_initialization_holds);
    tcase_add_test(tcase, entries_by_handle);
}

int main(void)
{
    TCase *tcase = tcase_create("dictionary");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_dictionary", tcase);
}

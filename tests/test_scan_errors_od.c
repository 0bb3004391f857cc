/* What the functions for the object dictionary refuse. */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

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

static int extend(unsigned short index, unsigned short subs, unsigned short object,
                  const char *types)
{
    return canOpenExtendDictionary(node, index, subs, object, types);
}

/* --- canOpenExtendDictionary --- */

static const struct extension {
    unsigned short index, subs, object;
    const char *types;
    int result;
} extensions[] = {
    { 0x0000, 0, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_INDEX },
    { 0x1000, 0, OBJ_VAR, MAP_UINT32, SCANOPEN_WRONG_INDEX },
    { 0x1FFF, 0, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_INDEX },
    { 0xA000, 0, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_INDEX },
    { 0xFFFF, 0, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_INDEX },
    { 0x2000, 0, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_INDEX }, /* it exists */
    { 0x2000, 2, OBJ_ARRAY, MAP_UINT8, SCANOPEN_WRONG_INDEX },
    { 0x2001, 1, OBJ_VAR, MAP_UINT8, SCANOPEN_WRONG_SUBINDEX },
    { 0x2001, 255, OBJ_ARRAY, MAP_UINT8, SCANOPEN_WRONG_SUBINDEX },
    { 0x2001, 0xFFFF, OBJ_ARRAY, MAP_UINT8, SCANOPEN_WRONG_SUBINDEX },
    { 0x2001, 255, OBJ_RECORD, MAP_UINT8, SCANOPEN_WRONG_SUBINDEX },
    { 0x2001, 0, 0, MAP_UINT8, SCANOPEN_WRONG_OBJECT_TYPE },
    { 0x2001, 0, 2, MAP_UINT8, SCANOPEN_WRONG_OBJECT_TYPE }, /* DOMAIN of CiA 301 */
    { 0x2001, 0, OBJ_VAR - 1, MAP_UINT8, SCANOPEN_WRONG_OBJECT_TYPE },
    { 0x2001, 0, OBJ_RECORD + 1, MAP_UINT8, SCANOPEN_WRONG_OBJECT_TYPE },
    { 0x2001, 0, OBJ_VAR, "", SCANOPEN_WRONG_TYPE },
    { 0x2001, 0, OBJ_VAR, "\x7F", SCANOPEN_WRONG_TYPE },
    { 0x2001, 0, OBJ_VAR, "\x0E", SCANOPEN_WRONG_TYPE },
    { 0x2001, 0, OBJ_VAR, "\x10", SCANOPEN_WRONG_TYPE }, /* TYP_INT24: manager only */
    { 0x2001, 0, OBJ_VAR, "\x42", SCANOPEN_WRONG_TYPE }, /* TYP_DATE: manager only */
    { 0x2001, 0, OBJ_VAR, "\x85", SCANOPEN_WRONG_TYPE },
    { 0x2001, 0, OBJ_VAR, MAP_UINT8 MAP_UINT8, SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_ARRAY, "", SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_ARRAY, MAP_UINT8 MAP_UINT8, SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_RECORD, MAP_UINT8, SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_RECORD, MAP_UINT8 MAP_INT8 MAP_INT8 MAP_INT8, SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_RECORD, MAP_UINT16 MAP_INT8 MAP_INT8, SCANOPEN_WRONG_TYPE },
    { 0x2001, 2, OBJ_RECORD, MAP_UINT8 MAP_INT8 "\x7F", SCANOPEN_WRONG_TYPE },
    { 0x2001, 0, OBJ_VAR, NULL, SCANOPEN_WRONG_PARAMETER },
};

START_TEST(objects_that_cannot_be)
{
    const struct extension *row = &extensions[_i];
    HDICT entry;

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(extend(row->index, row->subs, row->object, row->types), row->result);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2001, 0, &entry), SCANOPEN_WRONG_INDEX);
}
END_TEST

/* As the manual prints descriptors. */
START_TEST(descriptors_of_pointers)
{
    const char *good[] = { (const char *)TYP_UINT8, (const char *)TYP_INT32, 0 };
    const char *bad[] = { "text", 0 };
    const char **none = NULL;

    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2000, 1, OBJ_RECORD, good), SCANOPEN_OK);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2001, 1, OBJ_RECORD, bad),
                     SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2001, 1, OBJ_RECORD, none),
                     SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* --- canOpenInitDictionary and its likes --- */

static int on_time(int net, int id, int index, int sub, void *data, uint64_t time)
{
    scan_note("time %d", time != 0);
    return scan_on_data(net, id, index, sub, data);
}

enum form { PLAIN, TS, Ts, FORMS };

static int init(enum form form, unsigned index, unsigned sub, unsigned flags, DictionaryData *data)
{
    unsigned short i = (unsigned short)index, s = (unsigned short)sub, f = (unsigned short)flags;

    if (form == PLAIN)
        return canOpenInitDictionary(node, i, s, NULL, f, data, scan_on_data);
    if (form == TS)
        return canOpenInitDictionaryTS(node, i, s, NULL, f, data, on_time);
    return canOpenInitDictionaryTs(node, i, s, NULL, f, data, on_time);
}

START_TEST(entries_that_are_not_there)
{
    DictionaryData data = { .uint8 = { .val = 1 } };
    enum form form = (enum form)_i;

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(extend(0x2001, 2, OBJ_ARRAY, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(extend(0x2002, 2, OBJ_RECORD, MAP_UINT8 MAP_INT8), SCANOPEN_OK);
    ck_assert_int_eq(init(form, 0x2003, 0, READ_ACCESS, &data), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(init(form, 0, 0, READ_ACCESS, &data), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(init(form, 0xFFFF, 0, READ_ACCESS, &data), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(init(form, 0x2000, 1, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(init(form, 0x2001, 3, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(init(form, 0x2001, 0xFF, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(init(form, 0x2001, 0x100, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(init(form, 0x2002, 3, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
}
END_TEST

/* Two types: the record begins with sub-index 1, as old devices had it. */
START_TEST(a_record_without_sub_index_0)
{
    DictionaryData data = { .uint8 = { .val = 1 } };
    uint8_t value;

    ck_assert_int_eq(extend(0x2000, 2, OBJ_RECORD, MAP_UINT8 MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(init(PLAIN, 0x2000, 0, READ_ACCESS, &data), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(init(PLAIN, 0x2000, 1, READ_ACCESS, &data), SCANOPEN_OK);
    ck_assert_int_eq(init(PLAIN, 0x2000, 2, READ_ACCESS, &data), SCANOPEN_OK);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &value), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 2, &value), SCANOPEN_OK);
}
END_TEST

START_TEST(values_beyond_their_own_limits)
{
    enum form form = (enum form)_i;
    DictionaryData high = { .uint8 = { .val = 11, .defval = 5, .minval = 4, .maxval = 10 } };
    DictionaryData low = { .uint8 = { .val = 3, .defval = 5, .minval = 4, .maxval = 10 } };
    DictionaryData later_high = { .uint8 = { .val = 5, .defval = 11, .minval = 4, .maxval = 10 } };
    DictionaryData later_low = { .uint8 = { .val = 5, .defval = 3, .minval = 4, .maxval = 10 } };
    DictionaryData crossed = { .uint8 = { .val = 5, .defval = 5, .minval = 6, .maxval = 4 } };
    DictionaryData free = { .uint8 = { .val = 255, .defval = 0 } };

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &high), SCANOPEN_VALUE_TOO_HIGH);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &low), SCANOPEN_VALUE_TOO_LOW);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &later_high), SCANOPEN_VALUE_TOO_HIGH);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &later_low), SCANOPEN_VALUE_TOO_LOW);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &crossed), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, &free), SCANOPEN_OK);
}
END_TEST

START_TEST(properties_that_are_none)
{
    enum form form = (enum form)_i;
    DictionaryData data = { .uint8 = { .val = 1 } };
    static char memory[4] = "abc";
    DictionaryData text = { .visstring = { memory, sizeof memory, sizeof memory + 1 } };
    DictionaryData nowhere = { .visstring = { NULL, 4, 1 } };

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(extend(0x2001, 0, OBJ_VAR, MAP_VIS_STRING), SCANOPEN_OK);
    ck_assert_int_eq(init(form, 0x2000, 0, READ_ACCESS, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(init(form, 0x2000, 0, 0x0010, &data), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(init(form, 0x2000, 0, 0x8000, &data), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(init(form, 0x2001, 0, READ_ACCESS, &text), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(init(form, 0x2001, 0, READ_ACCESS, &nowhere), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* --- reading and writing, by index and by handle --- */

static int read_at(bool by_handle, unsigned index, unsigned sub, void *data)
{
    HDICT entry = NULL;
    int result;

    if (!by_handle)
        return canOpenReadDictionary(node, (unsigned short)index, (unsigned short)sub, data);
    result = canOpenGetDictionaryHnd(node, (unsigned short)index, (unsigned short)sub, &entry);
    return result == SCANOPEN_OK ? canOpenReadDictionaryHnd(entry, data) : result;
}

static int write_at(bool by_handle, unsigned index, unsigned sub, const void *data)
{
    HDICT entry = NULL;
    int result;

    if (!by_handle)
        return canOpenWriteDictionary(node, (unsigned short)index, (unsigned short)sub, data);
    result = canOpenGetDictionaryHnd(node, (unsigned short)index, (unsigned short)sub, &entry);
    return result == SCANOPEN_OK ? canOpenWriteDictionaryHnd(entry, data) : result;
}

START_TEST(entries_that_cannot_be_found)
{
    HDICT entry = (HDICT)(void *)plant;
    uint32_t value = 7;

    scan_number(node, 0x2000, TYP_UINT32, READ_ACCESS, 1, NULL);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2001, 0, &value), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 1, &value), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0x100, &value), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenWriteDictionary(node, 0x2001, 0, &value), SCANOPEN_WRONG_INDEX);
    ck_assert_int_eq(canOpenWriteDictionary(node, 0x2000, 1, &value), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenWriteDictionary(node, 0x2000, 0x100, &value), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2001, 0, &entry), SCANOPEN_WRONG_INDEX);
    ck_assert_ptr_null(entry);
    entry = (HDICT)(void *)plant;
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2000, 1, &entry), SCANOPEN_WRONG_SUBINDEX);
    ck_assert_ptr_null(entry);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2000, 0, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_uint_eq(value, 7);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 1);
}
END_TEST

START_TEST(an_entry_that_was_never_initialized)
{
    uint8_t value = 7;

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(extend(0x2001, 2, OBJ_ARRAY, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, &value), SCANOPEN_WRONG_TYPE);
    ck_assert_int_eq(read_at(_i, 0x2001, 2, &value), SCANOPEN_WRONG_TYPE);
    ck_assert_uint_eq(value, 7);
    ck_assert_int_eq(read_at(_i, 0x2001, 0, &value), SCANOPEN_OK); /* the library's own */
    ck_assert_uint_eq(value, 2);
}
END_TEST

START_TEST(no_place_for_what_is_read)
{
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS, 1, NULL);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, NULL), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

START_TEST(an_entry_that_can_only_be_written)
{
    uint8_t value = 7;

    scan_number(node, 0x2000, TYP_UINT8, WRITE_ACCESS, 1, NULL);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, &value), SCANOPEN_ACCESS_ERROR);
    ck_assert_uint_eq(value, 7);
}
END_TEST

static const struct owned {
    unsigned short index, sub;
} owned[] = {
    { 0x1000, 0 }, { 0x1001, 0 }, { 0x1005, 0 }, { 0x1018, 0 }, { 0x1018, 1 },
    { 0x2001, 0 }, { 0x1800, 1 }, { 0x1A00, 0 }, { 0x1A00, 1 },
};

START_TEST(entries_of_the_library)
{
    const uint16_t mapping[] = { 0x2001, 1, 0, 0 };
    uint32_t value = 1, before, after = 0;
    DictionaryData data = { .uint8 = { .val = 1 } };
    HPDO pdo;

    ck_assert_int_eq(extend(0x2001, 1, OBJ_ARRAY, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(init(PLAIN, 0x2001, 1, READ_ACCESS | MAPPABLE, &data), SCANOPEN_OK);
    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, 0, 0, mapping, &pdo),
        SCANOPEN_OK);
    for (unsigned i = 0; i < COUNT(owned); i++) {
        before = scan_get(node, owned[i].index, owned[i].sub);
        ck_assert_int_eq(write_at(_i, owned[i].index, owned[i].sub, &value), SCANOPEN_ACCESS_ERROR);
        after = scan_get(node, owned[i].index, owned[i].sub);
        ck_assert_uint_eq(after, before);
    }
}
END_TEST

START_TEST(values_beyond_the_limits)
{
    DictionaryData data = { .int16 = { .val = 0, .minval = -10, .maxval = 10 } };
    int16_t high = 11, low = -11, most = 10, least = -10, value = 99;

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_INT16), SCANOPEN_OK);
    ck_assert_int_eq(init(PLAIN, 0x2000, 0, READ_ACCESS, &data), SCANOPEN_OK);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &most), SCANOPEN_OK);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &high), SCANOPEN_VALUE_TOO_HIGH);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, &value), SCANOPEN_OK);
    ck_assert_int_eq(value, 10);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &least), SCANOPEN_OK);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &low), SCANOPEN_VALUE_TOO_LOW);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, &value), SCANOPEN_OK);
    ck_assert_int_eq(value, -10);
}
END_TEST

START_TEST(a_string_longer_than_its_memory)
{
    static char memory[4] = "abc";
    char *text = NULL;
    DictionaryData data = { .visstring = { memory, sizeof memory, 3 } };
    RecVisString longer = { memory, sizeof memory, sizeof memory + 1 };

    ck_assert_int_eq(extend(0x2000, 0, OBJ_VAR, MAP_VIS_STRING), SCANOPEN_OK);
    ck_assert_int_eq(init(PLAIN, 0x2000, 0, READ_ACCESS, &data), SCANOPEN_OK);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &longer), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(read_at(_i, 0x2000, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "abc");
}
END_TEST

static HPDO notify_pdo(int32_t inhibit)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    HPDO pdo = NULL;

    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    ck_assert_int_eq(canOpenDefinePDO(node, NULL, DEFAULT_PDO1,
                                      TRANSMIT_PDO | AUTO_NOTIFY_PDO | 255, inhibit, 0, 0, 0,
                                      mapping, &pdo),
                     SCANOPEN_OK);
    return pdo;
}

START_TEST(sending_without_a_change)
{
    notify_pdo(0);
    ck_assert_int_eq(write_at(_i, 0x2001, 0, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    scan_activate(plant, node);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    scan_stop(plant, node);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, NULL), SCANOPEN_WRONG_NODESTATE);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(write_at(_i, 0x2001, 0, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#01");
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(within_the_inhibit_time)
{
    uint8_t two = 2, three = 3;
    co_us_t first;

    notify_pdo(200);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_await(plant, "185#01"); /* the node's first, as it is operational now */
    first = scan_time(plant);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &two), SCANOPEN_INHIBITED);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &three), SCANOPEN_INHIBITED);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 3);
    scan_expect(plant, "185#03");
    ck_assert_uint_ge(scan_time(plant) - first, CO_MS(150));
}
END_TEST

/* At 10 kbit/s a frame takes several ms; the PDO may wait one. */
START_TEST(a_bus_that_is_too_slow)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    struct scan_plant *slow = scan_plant_slow(1, 10);
    uint8_t value = 2;
    HPDO pdo;

    node = scan_node(slow, 6, NULL);
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    ck_assert_int_eq(canOpenDefinePDO(node, NULL, DEFAULT_PDO1,
                                      TRANSMIT_PDO | AUTO_NOTIFY_PDO | TX_DONE_PDO | 255, 0, 1, 0,
                                      0, mapping, &pdo),
                     SCANOPEN_OK);
    scan_activate(slow, node);
    scan_operational(slow, node);
    ck_assert_int_eq(write_at(_i, 0x2000, 0, &value), SCANOPEN_TX_TIMEOUT);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 2);
    scan_plant_free(slow);
}
END_TEST

static void add_dictionary_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, objects_that_cannot_be, 0, COUNT(extensions));
    tcase_add_test(tcase, descriptors_of_pointers);
    tcase_add_loop_test(tcase, entries_that_are_not_there, 0, FORMS);
    tcase_add_test(tcase, a_record_without_sub_index_0);
    tcase_add_loop_test(tcase, values_beyond_their_own_limits, 0, FORMS);
    tcase_add_loop_test(tcase, properties_that_are_none, 0, FORMS);
}

/* By index and by handle. */
static void add_value_tests(TCase *tcase)
{
    tcase_add_test(tcase, entries_that_cannot_be_found);
    tcase_add_loop_test(tcase, an_entry_that_was_never_initialized, 0, 2);
    tcase_add_loop_test(tcase, no_place_for_what_is_read, 0, 2);
    tcase_add_loop_test(tcase, an_entry_that_can_only_be_written, 0, 2);
    tcase_add_loop_test(tcase, entries_of_the_library, 0, 2);
    tcase_add_loop_test(tcase, values_beyond_the_limits, 0, 2);
    tcase_add_loop_test(tcase, a_string_longer_than_its_memory, 0, 2);
    tcase_add_loop_test(tcase, sending_without_a_change, 0, 2);
    tcase_add_loop_test(tcase, within_the_inhibit_time, 0, 2);
    tcase_add_loop_test(tcase, a_bus_that_is_too_slow, 0, 2);
}

int main(void)
{
    TCase *tcase = tcase_create("errors_od");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_dictionary_tests(tcase);
    add_value_tests(tcase);
    return suite_run("scan_errors_od", tcase);
}

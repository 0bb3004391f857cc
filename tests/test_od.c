/* Object dictionary: entries, checks with their abort codes, power-on values. */
#include "od/od_store.h"

#include "base/bytes.h"

#include <check.h>
#include <string.h>

static struct od od;

static void setup(void)
{
    od_init(&od);
}

static void teardown(void)
{
    od_done(&od);
}

static struct od_entry *add(const struct od_spec *spec)
{
    struct od_entry *entry = NULL;

    ck_assert_int_eq(od_add(&od, spec, &entry), CO_OK);
    ck_assert_ptr_nonnull(entry);
    return entry;
}

static struct od_entry *add_type(uint16_t index, uint8_t type)
{
    const struct od_spec spec = { .index = index, .type = type, .access = OD_RW };

    return add(&spec);
}

/* ---- types --------------------------------------------------------------------------------- */

static const struct {
    uint8_t type;
    uint32_t size;
    bool is_signed;
    const char *name;
} types[] = {
    { 0x01, 1, false, "BOOLEAN" },         { 0x02, 1, true, "INTEGER8" },
    { 0x03, 2, true, "INTEGER16" },        { 0x04, 4, true, "INTEGER32" },
    { 0x05, 1, false, "UNSIGNED8" },       { 0x06, 2, false, "UNSIGNED16" },
    { 0x07, 4, false, "UNSIGNED32" },      { 0x08, 4, false, "REAL32" },
    { 0x09, 0, false, "VISIBLE_STRING" },  { 0x0A, 0, false, "OCTET_STRING" },
    { 0x0B, 0, false, "UNICODE_STRING" },  { 0x0C, 6, false, "TIME_OF_DAY" },
    { 0x0D, 6, false, "TIME_DIFFERENCE" }, { 0x0F, 0, false, "DOMAIN" },
    { 0x10, 3, true, "INTEGER24" },        { 0x11, 8, false, "REAL64" },
    { 0x12, 5, true, "INTEGER40" },        { 0x13, 6, true, "INTEGER48" },
    { 0x14, 7, true, "INTEGER56" },        { 0x15, 8, true, "INTEGER64" },
    { 0x16, 3, false, "UNSIGNED24" },      { 0x18, 5, false, "UNSIGNED40" },
    { 0x19, 6, false, "UNSIGNED48" },      { 0x1A, 7, false, "UNSIGNED56" },
    { 0x1B, 8, false, "UNSIGNED64" },
};

START_TEST(test_types)
{
    unsigned known = 0;

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        ck_assert(od_type_known(types[i].type));
        ck_assert_uint_eq(od_type_size(types[i].type), types[i].size);
        ck_assert_int_eq(od_type_signed(types[i].type), types[i].is_signed);
        ck_assert_str_eq(od_type_name(types[i].type), types[i].name);
    }
    for (unsigned type = 0; type <= 0xFF; type++)
        known += od_type_known((uint8_t)type);
    ck_assert_uint_eq(known, sizeof types / sizeof types[0]);
    ck_assert_uint_eq(od_type_size(0x0E), 0);
    ck_assert(!od_type_signed(0x0E));
    ck_assert_str_eq(od_type_name(0x0E), "unknown type");
}
END_TEST

/* ---- entries ------------------------------------------------------------------------------- */

START_TEST(test_entries_are_sorted_and_stay)
{
    struct od_entry *entries[2000];

    for (unsigned i = 0; i < 2000; i++) {
        const unsigned place = i * 1237 % 2000; /* every place once, in disorder */
        const struct od_spec spec = { .index = (uint16_t)(0x2000 + place / 4),
                                      .sub = (uint8_t)(place % 4 * 85),
                                      .type = OD_UNSIGNED16,
                                      .access = OD_RW };

        entries[place] = add(&spec);
    }
    ck_assert_uint_eq(od.count, 2000);
    for (unsigned i = 0; i < 2000; i++) {
        ck_assert_ptr_eq(od.entries[i], entries[i]);
        ck_assert_ptr_eq(od_find(&od, (uint16_t)(0x2000 + i / 4), (uint8_t)(i % 4 * 85)),
                         entries[i]);
    }
    ck_assert_ptr_null(od_find(&od, 0x2000, 1));
    ck_assert_ptr_null(od_find(&od, 0x1FFF, 255));
    ck_assert_ptr_null(od_find(&od, 0xFFFF, 255));
    ck_assert(od_has_object(&od, 0x2000));
    ck_assert(!od_has_object(&od, 0x1FFF));
    ck_assert(!od_has_object(&od, 0x21F4));
}
END_TEST

START_TEST(test_add_refuses)
{
    const uint8_t bytes[8] = { 0 };
    const struct od_spec unknown = { .index = 0x2000, .type = 0x0E };
    const struct od_spec wrong_size = {
        .index = 0x2000, .type = OD_UNSIGNED16, .value = bytes, .size = 4
    };
    const struct od_spec too_long = {
        .index = 0x2000, .type = OD_DOMAIN, .value = bytes, .size = 8, .capacity = 7
    };
    struct od_entry *entry = NULL;

    ck_assert_int_eq(od_add(&od, &unknown, &entry), CO_ERR_ARG);
    ck_assert_int_eq(od_add(&od, &wrong_size, &entry), CO_ERR_ARG);
    ck_assert_int_eq(od_add(&od, &too_long, &entry), CO_ERR_ARG);
    ck_assert_int_eq(od_add_number(&od, 0x2000, 0, OD_DOMAIN, OD_RW, 1), CO_ERR_ARG);
    ck_assert_uint_eq(od.count, 0);
    ck_assert_int_eq(od_add_number(&od, 0x2000, 0, OD_UNSIGNED8, OD_RW, 1), CO_OK);
    ck_assert_int_eq(od_add_number(&od, 0x2000, 0, OD_UNSIGNED8, OD_RW, 2), CO_ERR_EXISTS);
    ck_assert_ptr_null(entry);
    ck_assert_uint_eq(od_number(&od, 0x2000, 0, 99), 1);
}
END_TEST

START_TEST(test_entry_keeps_description)
{
    char name[] = "Motor speed";
    const struct od_spec spec = { .index = 0x6000,
                                  .sub = 3,
                                  .type = OD_INTEGER16,
                                  .access = OD_RWW,
                                  .mappable = true,
                                  .has_low = true,
                                  .low = -5,
                                  .value = (const uint8_t *)"\x34\x12",
                                  .size = 2,
                                  .name = name };
    const struct od_entry *entry = add(&spec);

    memset(name, 'x', sizeof name - 1);
    ck_assert_str_eq(entry->name, "Motor speed");
    ck_assert_uint_eq(entry->access, OD_RWW);
    ck_assert(entry->mappable && entry->has_low && !entry->has_high);
    ck_assert_int_eq(entry->low, -5);
    ck_assert_uint_eq(entry->capacity, 2);
    ck_assert_uint_eq(entry->size, 2);
    ck_assert_uint_eq(get_le16(entry->value), 0x1234);
}
END_TEST

START_TEST(test_capacity)
{
    static const uint8_t bytes[100];
    const struct od_spec small = {
        .index = 0x2000, .type = OD_VISIBLE_STRING, .value = bytes, .size = 10
    };
    const struct od_spec large = {
        .index = 0x2001, .type = OD_DOMAIN, .value = bytes, .size = 100
    };
    const struct od_spec exact = {
        .index = 0x2002, .type = OD_OCTET_STRING, .value = bytes, .size = 3, .capacity = 3
    };
    const struct od_spec empty = { .index = 0x2003, .type = OD_DOMAIN, .size = 100 };

    ck_assert_uint_eq(add(&small)->capacity, 64);
    ck_assert_uint_eq(add(&large)->capacity, 100);
    ck_assert_uint_eq(add(&exact)->capacity, 3);
    ck_assert_uint_eq(add(&empty)->capacity, 100);
    ck_assert_uint_eq(od_find(&od, 0x2003, 0)->size, 0);
    ck_assert_uint_eq(od_find(&od, 0x2000, 0)->size, 10);
}
END_TEST

START_TEST(test_numbers)
{
    struct od_entry *entry = add_type(0x2000, OD_INTEGER24);

    add_type(0x2001, OD_DOMAIN);
    od_set_number(&od, 0x2000, 0, (uint64_t)-2);
    ck_assert_uint_eq(od_number(&od, 0x2000, 0, 0), 0xFFFFFE);
    ck_assert_int_eq(od_entry_signed(entry), -2);
    od_set_number(&od, 0x2000, 0, 0x7FFFFF);
    ck_assert_int_eq(od_entry_signed(entry), 0x7FFFFF);
    ck_assert_uint_eq(od_number(&od, 0x3000, 0, 42), 42);
    od_set_number(&od, 0x3000, 0, 1);
    od_set_number(&od, 0x2001, 0, 1);
    ck_assert_uint_eq(od_find(&od, 0x2001, 0)->size, 0);
    ck_assert_int_eq(od_entry_signed(od_find(&od, 0x2001, 0)), 0);
    entry = add_type(0x2002, OD_UNSIGNED8);
    od_set_number(&od, 0x2002, 0, 0xFE);
    ck_assert_int_eq(od_entry_signed(entry), 0xFE);
    entry = add_type(0x2003, OD_INTEGER64);
    od_set_number(&od, 0x2003, 0, UINT64_MAX);
    ck_assert_int_eq(od_entry_signed(entry), -1);
}
END_TEST

START_TEST(test_power_on_values)
{
    const struct od_spec spec = { .index = 0x2001,
                                  .type = OD_VISIBLE_STRING,
                                  .access = OD_RW,
                                  .value = (const uint8_t *)"ab",
                                  .size = 2 };
    struct od_entry *string = add(&spec);

    add_type(0x1FFF, OD_UNSIGNED8);
    add_type(0x3000, OD_UNSIGNED8);
    ck_assert_uint_eq(od_set(string, (const uint8_t *)"longer text", 11), SDO_OK);
    od_set_number(&od, 0x1FFF, 0, 1);
    od_set_number(&od, 0x3000, 0, 3);
    ck_assert_int_eq(od_store(&od, 0x3000, 0x3000), CO_OK);
    od_reset(&od, 0x2000, 0x3000);
    ck_assert_uint_eq(od_number(&od, 0x1FFF, 0, 0), 1);
    ck_assert_uint_eq(od_number(&od, 0x3000, 0, 0), 3);
    ck_assert_uint_eq(string->size, 2);
    ck_assert_mem_eq(string->value, "ab", 2);
    ck_assert_uint_eq(od_set(string, (const uint8_t *)"longer text", 11), SDO_OK);
    ck_assert_int_eq(od_store(&od, 0, 0xFFFF), CO_OK);
    ck_assert_uint_eq(od_set(string, NULL, 0), SDO_OK);
    ck_assert_uint_eq(string->size, 0);
    od_reset(&od, 0, 0xFFFF);
    ck_assert_uint_eq(string->size, 11);
    ck_assert_mem_eq(string->value, "longer text", 11);
}
END_TEST

/* ---- checks -------------------------------------------------------------------------------- */

static const struct {
    uint8_t access;
    sdo_abort_t read, write;
} rights[] = {
    { OD_RO, SDO_OK, SDO_READ_ONLY }, { OD_WO, SDO_WRITE_ONLY, SDO_OK },
    { OD_RW, SDO_OK, SDO_OK },        { OD_RWR, SDO_OK, SDO_OK },
    { OD_RWW, SDO_OK, SDO_OK },       { OD_CONST, SDO_OK, SDO_READ_ONLY },
};

START_TEST(test_access)
{
    const struct od_spec spec = {
        .index = 0x2000, .sub = 1, .type = OD_UNSIGNED8, .access = rights[_i].access
    };
    const struct od_entry *entry = add(&spec);
    struct od_entry *found = NULL;

    ck_assert_uint_eq(od_check_read(&od, 0x2000, 1, &found), rights[_i].read);
    ck_assert_ptr_eq(found, rights[_i].read == SDO_OK ? entry : NULL);
    found = NULL;
    ck_assert_uint_eq(od_check_write(&od, 0x2000, 1, &found), rights[_i].write);
    ck_assert_ptr_eq(found, rights[_i].write == SDO_OK ? entry : NULL);
    found = NULL;
    ck_assert_uint_eq(od_check_read(&od, 0x2000, 2, &found), SDO_NO_SUB);
    ck_assert_uint_eq(od_check_write(&od, 0x2000, 0, &found), SDO_NO_SUB);
    ck_assert_uint_eq(od_check_read(&od, 0x2001, 1, &found), SDO_NO_OBJECT);
    ck_assert_uint_eq(od_check_write(&od, 0x1FFF, 1, &found), SDO_NO_OBJECT);
    ck_assert_ptr_null(found);
}
END_TEST

START_TEST(test_sizes)
{
    const uint32_t size = types[_i].size;
    const struct od_entry *entry = add_type(0x2000, types[_i].type);

    if (size == 0) {
        ck_assert_uint_eq(od_check_size(entry, 0), SDO_OK);
        ck_assert_uint_eq(od_check_size(entry, 64), SDO_OK);
        ck_assert_uint_eq(od_check_size(entry, 65), SDO_TOO_LONG);
        return;
    }
    ck_assert_uint_eq(od_check_size(entry, size - 1), SDO_TOO_SHORT);
    ck_assert_uint_eq(od_check_size(entry, size), SDO_OK);
    ck_assert_uint_eq(od_check_size(entry, size + 1), SDO_TOO_LONG);
    ck_assert_uint_eq(od_check_size(entry, UINT32_MAX), SDO_TOO_LONG);
}
END_TEST

#define BOTH    true, true
#define LOW     true, false
#define HIGH    false, true
#define NEITHER false, false

static const struct {
    uint8_t type;
    bool has_low, has_high;
    int64_t low, high;
    uint64_t value;
    sdo_abort_t code;
} values[] = {
    { OD_BOOLEAN, NEITHER, 0, 0, 1, SDO_OK },
    { OD_BOOLEAN, NEITHER, 0, 0, 2, SDO_INVALID_VALUE },
    { OD_UNSIGNED8, NEITHER, 0, 0, 0xFF, SDO_OK },
    { OD_UNSIGNED8, BOTH, 1, 240, 0, SDO_VALUE_LOW },
    { OD_UNSIGNED8, BOTH, 1, 240, 1, SDO_OK },
    { OD_UNSIGNED8, BOTH, 1, 240, 240, SDO_OK },
    { OD_UNSIGNED8, BOTH, 1, 240, 241, SDO_VALUE_HIGH },
    { OD_UNSIGNED32, LOW, 0x81, 0, 0x80, SDO_VALUE_LOW },
    { OD_UNSIGNED32, LOW, 0x81, 0, 0xFFFFFFFF, SDO_OK },
    { OD_UNSIGNED64, HIGH, 0, -2, UINT64_MAX, SDO_VALUE_HIGH },
    { OD_UNSIGNED64, HIGH, 0, -2, UINT64_MAX - 1, SDO_OK },
    { OD_UNSIGNED64, HIGH, 0, 5, UINT64_C(1) << 63, SDO_VALUE_HIGH },
    { OD_UNSIGNED64, LOW, -2, 0, 5, SDO_VALUE_LOW },
    { OD_INTEGER8, BOTH, -100, 100, 0x9C, SDO_OK },
    { OD_INTEGER8, BOTH, -100, 100, 0x9B, SDO_VALUE_LOW },
    { OD_INTEGER8, BOTH, -100, 100, 101, SDO_VALUE_HIGH },
    { OD_INTEGER24, HIGH, 0, -1, 0, SDO_VALUE_HIGH },
    { OD_INTEGER24, HIGH, 0, -1, 0x800000, SDO_OK },
    { OD_INTEGER64, LOW, INT64_MIN + 1, 0, UINT64_C(1) << 63, SDO_VALUE_LOW },
    { OD_TIME_OF_DAY, NEITHER, 0, 0, UINT64_C(0xFFFFFFFFFFFF), SDO_OK },
    /* -1.5f and 2.0f; -1.5 and 2.0 */
    { OD_REAL32, BOTH, 0xBFC00000, 0x40000000, 0x00000000, SDO_OK },
    { OD_REAL32, BOTH, 0xBFC00000, 0x40000000, 0xBFC00000, SDO_OK },
    { OD_REAL32, BOTH, 0xBFC00000, 0x40000000, 0xBFC00001, SDO_VALUE_LOW },
    { OD_REAL32, BOTH, 0xBFC00000, 0x40000000, 0x40000001, SDO_VALUE_HIGH },
    { OD_REAL32, LOW, 0xBFC00000, 0, 0x7F800000, SDO_OK },
    { OD_REAL32, LOW, 0xBFC00000, 0, 0x7FC00000, SDO_INVALID_VALUE },
    { OD_REAL32, NEITHER, 0, 0, 0x7FC00000, SDO_OK },
    { OD_REAL64, HIGH, 0, 0x4000000000000000, 0x4000000000000001, SDO_VALUE_HIGH },
    { OD_REAL64, HIGH, 0, 0x4000000000000000, 0x4000000000000000, SDO_OK },
    { OD_REAL64, LOW, 0x4000000000000000, 0, 0x3FFFFFFFFFFFFFFF, SDO_VALUE_LOW },
};

START_TEST(test_values)
{
    const struct od_spec spec = { .index = 0x2000,
                                  .type = values[_i].type,
                                  .access = OD_RO,
                                  .has_low = values[_i].has_low,
                                  .has_high = values[_i].has_high,
                                  .low = values[_i].low,
                                  .high = values[_i].high };
    const uint32_t size = od_type_size(values[_i].type);
    struct od_entry *entry = add(&spec);
    uint8_t bytes[8], before[8];

    od_set_number(&od, 0x2000, 0, 0x1B);
    memcpy(before, entry->value, size);
    put_le(bytes, size, values[_i].value);
    ck_assert_uint_eq(od_check_value(entry, bytes, size), values[_i].code);
    ck_assert_mem_eq(entry->value, before, size);
    ck_assert_uint_eq(od_set(entry, bytes, size), values[_i].code);
    ck_assert_mem_eq(entry->value, values[_i].code == SDO_OK ? bytes : before, size);
    ck_assert_uint_eq(od_set(entry, bytes, size - 1), SDO_TOO_SHORT);
}
END_TEST

static const struct {
    sdo_abort_t code;
    const char *text;
} texts[] = {
    { SDO_TOGGLE, "toggle" },
    { SDO_TIMEOUT, "timed out" },
    { SDO_COMMAND, "command" },
    { SDO_BLOCK_SIZE, "block size" },
    { SDO_BLOCK_SEQUENCE, "sequence" },
    { SDO_BLOCK_CRC, "CRC" },
    { SDO_NO_MEMORY, "memory" },
    { SDO_ACCESS, "access" },
    { SDO_WRITE_ONLY, "write-only" },
    { SDO_READ_ONLY, "read-only" },
    { SDO_NO_OBJECT, "object does not exist" },
    { SDO_NOT_MAPPABLE, "mapped" },
    { SDO_PDO_LENGTH, "PDO length" },
    { SDO_PARAMETER, "parameter" },
    { SDO_INTERNAL, "inside" },
    { SDO_HARDWARE, "hardware" },
    { SDO_TYPE_LENGTH, "length does not match" },
    { SDO_TOO_LONG, "length too high" },
    { SDO_TOO_SHORT, "length too low" },
    { SDO_NO_SUB, "sub-index" },
    { SDO_INVALID_VALUE, "invalid value" },
    { SDO_VALUE_HIGH, "value too high" },
    { SDO_VALUE_LOW, "value too low" },
    { SDO_MAX_BELOW_MIN, "less than minimum" },
    { SDO_NO_CONNECTION, "connection" },
    { SDO_GENERAL, "general" },
    { SDO_NOT_STORED, "stored" },
    { SDO_LOCAL_CONTROL, "local control" },
    { SDO_DEVICE_STATE, "device state" },
    { SDO_NO_DICTIONARY, "dictionary" },
    { SDO_NO_DATA, "no data" },
    { SDO_OK, "no abort" },
    { 0xDEADBEEF, "unknown abort code" },
};

START_TEST(test_abort_texts)
{
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        const char *text = sdo_abort_text(texts[i].code);

        ck_assert_msg(strstr(text, texts[i].text) != NULL, "%08X is \"%s\"", texts[i].code, text);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("od");
    TCase *tcase = tcase_create("od");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, test_types);
    tcase_add_test(tcase, test_entries_are_sorted_and_stay);
    tcase_add_test(tcase, test_add_refuses);
    tcase_add_test(tcase, test_entry_keeps_description);
    tcase_add_test(tcase, test_capacity);
    tcase_add_test(tcase, test_numbers);
    tcase_add_test(tcase, test_power_on_values);
    tcase_add_loop_test(tcase, test_access, 0, sizeof rights / sizeof rights[0]);
    tcase_add_loop_test(tcase, test_sizes, 0, sizeof types / sizeof types[0]);
    tcase_add_loop_test(tcase, test_values, 0, sizeof values / sizeof values[0]);
    tcase_add_test(tcase, test_abort_texts);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* PDO mappings: bits of a frame and values of a dictionary. */
#include "proto/pdo_map.h"

#include "base/bytes.h"
#include "support/hex.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

#define FIELDS 64

static struct od od;
static struct pdo_field fields[FIELDS];
static struct pdo_map map;

static void setup(void)
{
    od_init(&od);
    pdo_map_init(&map, fields, FIELDS);
}

static void teardown(void)
{
    od_done(&od);
}

static struct od_entry *add_entry(uint8_t type)
{
    const struct od_spec spec = {
        .index = (uint16_t)(0x2000 + od.count), .type = type, .access = OD_RW, .capacity = 4
    };
    struct od_entry *entry = NULL;

    ck_assert_int_eq(od_add(&od, &spec, &entry), CO_OK);
    return entry;
}

#define DUMMY 0xFF /* as a type */

struct part {
    uint8_t type, bits;
    const char *value; /* in the dictionary */
};

/* clang-format off */
static const struct {
    const char *name, *data;
    uint8_t size;
    struct part parts[10];
    const char *sent; /* where it is other than the data; NULL: it is not */
} maps[] = {
    { "nothing", "-", 0, { { 0 } }, NULL },
    { "one byte", "5A", 1, { { OD_UNSIGNED8, 8, "5A" } }, NULL },
    { "two numbers and a bit", "11332201", 4,
      { { OD_UNSIGNED8, 8, "11" }, { OD_INTEGER16, 16, "3322" }, { OD_BOOLEAN, 1, "01" } }, NULL },
    { "the largest number", "0102030405060708", 8,
      { { OD_UNSIGNED64, 64, "0102030405060708" } }, NULL },
    { "odd sizes", "112233445566778F", 8,
      { { OD_UNSIGNED24, 24, "112233" }, { OD_UNSIGNED40, 40, "445566778F" } }, NULL },
    { "48 and 16 bits", "1122334455667788", 8,
      { { OD_INTEGER48, 48, "112233445566" }, { OD_UNSIGNED16, 16, "7788" } }, NULL },
    { "a date", "112233445566", 6, { { OD_TIME_OF_DAY, 48, "112233445566" } }, NULL },
    { "reals", "0000803F0000F03F", 8,
      { { OD_REAL32, 32, "0000803F" }, { OD_UNSIGNED32, 32, "0000F03F" } }, NULL },
    { "a byte across two", "FE01", 2,
      { { OD_BOOLEAN, 1, "00" }, { OD_UNSIGNED8, 8, "FF" } }, NULL },
    { "a long number behind a bit", "FFFFFFFF01", 5,
      { { OD_BOOLEAN, 1, "01" }, { OD_INTEGER32, 32, "FFFFFFFF" } }, NULL },
    { "56 bits behind a bit", "0100000000000001", 8,
      { { OD_BOOLEAN, 1, "01" }, { OD_UNSIGNED56, 56, "00000000000080" } }, NULL },
    { "a real behind a bit", "0000007F00", 5,
      { { OD_BOOLEAN, 1, "00" }, { OD_REAL32, 32, "0000803F" } }, NULL },
    { "eight bits", "A5", 1,
      { { OD_BOOLEAN, 1, "01" }, { OD_BOOLEAN, 1, "00" }, { OD_BOOLEAN, 1, "01" },
        { OD_BOOLEAN, 1, "00" }, { OD_BOOLEAN, 1, "00" }, { OD_BOOLEAN, 1, "01" },
        { OD_BOOLEAN, 1, "00" }, { OD_BOOLEAN, 1, "01" } }, NULL },
    { "a BOOLEAN of a byte", "0100", 2,
      { { OD_BOOLEAN, 8, "01" }, { OD_BOOLEAN, 8, "00" } }, NULL },
    { "a BOOLEAN that is more than true", "50", 1, { { OD_BOOLEAN, 8, "01" } }, "01" },
    { "dummies", "11FFFF22", 4,
      { { OD_UNSIGNED8, 8, "11" }, { DUMMY, 16, "" }, { OD_UNSIGNED8, 8, "22" } }, "11000022" },
    { "a dummy bit", "FF01", 2, { { DUMMY, 1, "" }, { OD_UNSIGNED8, 8, "FF" } }, "FE01" },
    { "a dummy of all", "1122334455667788", 8, { { DUMMY, 64, "" } }, "0000000000000000" },
    { "a part of a signed number", "FF", 1, { { OD_INTEGER16, 8, "FFFF" } }, NULL },
    { "a part of a positive one", "7F", 1, { { OD_INTEGER32, 8, "7F000000" } }, NULL },
    { "a part of an unsigned one", "FF", 1, { { OD_UNSIGNED32, 8, "FF000000" } }, NULL },
    { "more than a number has", "80FF", 2, { { OD_INTEGER8, 16, "80" } }, NULL },
    { "more than an unsigned one has", "8011", 2, { { OD_UNSIGNED8, 16, "80" } }, "8000" },
    { "a nibble of a signed one", "0F", 1, { { OD_INTEGER8, 4, "FF" } }, NULL },
    { "a string", "41424344", 4, { { OD_VISIBLE_STRING, 32, "41424344" } }, NULL },
    { "half of a string", "4142", 2, { { OD_VISIBLE_STRING, 16, "4142" } }, NULL },
    { "more than a string has room for", "4142434445", 5, { { OD_OCTET_STRING, 40, "41424344" } },
      "4142434400" },
};
/* clang-format on */

static void build(const struct part *part)
{
    for (; part->bits > 0; part++)
        ck_assert(
            pdo_map_add(&map, part->type == DUMMY ? NULL : add_entry(part->type), part->bits));
}

START_TEST(data_and_values)
{
    uint8_t data[PDO_SIZE_MAX] = { 0 }, sent[PDO_SIZE_MAX];
    const char *expected = maps[_i].sent ? maps[_i].sent : maps[_i].data;
    const size_t size = hex_parse(maps[_i].data, data, sizeof data);
    char text[32];

    build(maps[_i].parts);
    ck_assert_uint_eq(pdo_map_size(&map), maps[_i].size);
    pdo_map_write(&map, data);
    for (unsigned i = 0, used = 0; maps[_i].parts[i].bits > 0; i++) {
        if (maps[_i].parts[i].type == DUMMY)
            continue;
        hex_format(od.entries[used]->value, od.entries[used]->size, text, sizeof text);
        ck_assert_msg(strcmp(text, maps[_i].parts[i].value) == 0, "%s: %s", maps[_i].name, text);
        used++;
    }
    pdo_map_read(&map, sent);
    hex_format(sent, size, text, sizeof text);
    ck_assert_msg(maps[_i].size == 0 || strcmp(text, expected) == 0, "%s: sends %s", maps[_i].name,
                  text);
    for (size_t i = size; i < sizeof sent; i++)
        ck_assert_uint_eq(sent[i], 0);
}
END_TEST

START_TEST(what_does_not_fit)
{
    struct od_entry *entry = add_entry(OD_UNSIGNED32);

    ck_assert(!pdo_map_add(&map, entry, 0));
    ck_assert(!pdo_map_add(&map, NULL, 65));
    ck_assert(pdo_map_add(&map, entry, 32));
    ck_assert(!pdo_map_add(&map, entry, 33));
    ck_assert_uint_eq(map.count, 1);
    ck_assert_uint_eq(map.bits, 32);
    ck_assert(pdo_map_add(&map, entry, 32));
    ck_assert(!pdo_map_add(&map, NULL, 1));
    pdo_map_clear(&map);
    ck_assert_uint_eq(pdo_map_size(&map), 0);
    map.room = 1;
    ck_assert(pdo_map_add(&map, NULL, 1));
    ck_assert(!pdo_map_add(&map, NULL, 1));
}
END_TEST

START_TEST(no_fields_at_all)
{
    uint8_t data[PDO_SIZE_MAX] = { 1 };

    pdo_map_init(&map, NULL, 0);
    ck_assert(!pdo_map_add(&map, NULL, 8));
    ck_assert_uint_eq(pdo_map_write(&map, data), 0);
    pdo_map_read(&map, data);
    ck_assert_uint_eq(data[0], 0);
}
END_TEST

START_TEST(which_fields_changed)
{
    struct od_entry *first = add_entry(OD_UNSIGNED8), *second = add_entry(OD_BOOLEAN);

    ck_assert(pdo_map_add(&map, first, 8));
    ck_assert(pdo_map_add(&map, NULL, 7));
    ck_assert(pdo_map_add(&map, second, 1));
    ck_assert(pdo_map_contains(&map, second));
    ck_assert(!pdo_map_contains(&map, add_entry(OD_BOOLEAN)));
    ck_assert_uint_eq(pdo_map_write(&map, (const uint8_t *)"\x01\x80\0\0\0\0\0"), 5);
    ck_assert_uint_eq(pdo_map_write(&map, (const uint8_t *)"\x01\xFF\0\0\0\0\0"), 0);
    ck_assert_uint_eq(pdo_map_write(&map, (const uint8_t *)"\x02\xFF\0\0\0\0\0"), 1);
    ck_assert_uint_eq(pdo_map_write(&map, (const uint8_t *)"\x02\x7F\0\0\0\0\0"), 4);
}
END_TEST

static uint64_t long_noise(uint64_t *seed)
{
    return (uint64_t)noise(seed) << 32 | noise(seed);
}

/* Fields of any length, in any order: each bit goes where a simple loop puts it. */
START_TEST(random_fields)
{
    uint64_t seed = (uint64_t)_i + 1, packed = 0, values = long_noise(&seed);
    uint8_t data[PDO_SIZE_MAX];

    while (map.bits < 64) {
        const unsigned bits = 1 + noise(&seed) % 64;

        pdo_map_add(&map, add_entry(OD_UNSIGNED64), (uint8_t)bits);
    }
    put_le(data, sizeof data, values);
    pdo_map_write(&map, data);
    for (unsigned i = 0, at = 0; i < map.count; at += fields[i++].bits)
        for (unsigned bit = 0; bit < fields[i].bits; bit++) {
            const uint64_t value = get_le(fields[i].entry->value, 8);

            ck_assert_uint_eq(value >> bit & 1, values >> (at + bit) & 1);
            ck_assert(fields[i].bits == 64 || value >> fields[i].bits == 0);
            packed |= (value >> bit & 1) << (at + bit);
        }
    ck_assert_uint_eq(packed, values);
    pdo_map_read(&map, data);
    ck_assert_uint_eq(get_le(data, sizeof data), values);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("pdo_map");
    TCase *tcase = tcase_create("pdo_map");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, data_and_values, 0, (int)(sizeof maps / sizeof maps[0]));
    tcase_add_test(tcase, what_does_not_fit);
    tcase_add_test(tcase, no_fields_at_all);
    tcase_add_test(tcase, which_fields_changed);
    tcase_add_loop_test(tcase, random_fields, 0, 300);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

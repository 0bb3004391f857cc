#include "dcf/ccf.h"
#include "support/guard.h"
#include "support/guarded.h"
#include "support/hex.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

/* 1017h = 1000 and 1016h:01 = 007F07D0h */
#define EXAMPLE                                                                                    \
    "02000000"                                                                                     \
    "17100002000000E803"                                                                           \
    "16100104000000D0077F00"
#define EXAMPLE_SIZE 24

static struct messages messages;

static enum co_err parse(const char *hex, struct ccf *ret_ccf)
{
    uint8_t bytes[64];
    size_t size = hex_parse(hex, bytes, sizeof bytes);
    struct guard guard;
    enum co_err err;

    messages_init(&messages);
    guard_init(&guard, bytes, size);
    err = ccf_parse((const uint8_t *)guard.bytes, size, &messages.report, ret_ccf);
    guard_done(&guard);
    return err;
}

START_TEST(test_empty)
{
    struct ccf ccf;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ccf_init(&ccf);
    ck_assert_uint_eq(ccf_count(&ccf), 0);
    ccf_reader_init(&reader, &ccf);
    ck_assert(!ccf_read(&reader, &entry));
    ccf_done(&ccf);
}
END_TEST

START_TEST(test_append)
{
    static const uint8_t heartbeat[] = { 0xE8, 0x03 }, consumer[] = { 0xD0, 0x07, 0x7F, 0x00 };
    char text[100];
    struct ccf ccf;

    ccf_init(&ccf);
    ck_assert_int_eq(ccf_append(&ccf, 0x1017, 0, heartbeat, sizeof heartbeat), CO_OK);
    ck_assert_int_eq(ccf_append(&ccf, 0x1016, 1, consumer, sizeof consumer), CO_OK);
    ck_assert_str_eq(hex_format(ccf.bytes, ccf.size, text, sizeof text), EXAMPLE);
    ck_assert_uint_eq(ccf_count(&ccf), 2);
    ccf_done(&ccf);
    ck_assert_uint_eq(ccf_count(&ccf), 0);
}
END_TEST

START_TEST(test_lines)
{
    struct ccf ccf;

    ccf_init(&ccf);
    ck_assert_int_eq(ccf_note_line(&ccf, 7), CO_OK); /* there is no entry yet */
    ck_assert_int_eq(ccf_append(&ccf, 0x2000, 0, NULL, 0), CO_OK);
    ck_assert_uint_eq(ccf_line(&ccf, 1), 0);
    for (unsigned i = 2; i <= 40; i++) {
        ck_assert_int_eq(ccf_append(&ccf, 0x2000, 0, NULL, 0), CO_OK);
        ck_assert_int_eq(ccf_note_line(&ccf, 100 + i), CO_OK);
    }
    ck_assert_uint_eq(ccf_line(&ccf, 0), 0);
    ck_assert_uint_eq(ccf_line(&ccf, 1), 0);
    for (unsigned i = 2; i <= 40; i++)
        ck_assert_uint_eq(ccf_line(&ccf, i), 100 + i);
    ck_assert_uint_eq(ccf_line(&ccf, 41), 0);
    ccf_done(&ccf);
    ck_assert_uint_eq(ccf_line(&ccf, 2), 0);
}
END_TEST

START_TEST(test_append_nothing)
{
    char text[100];
    struct ccf ccf;

    ccf_init(&ccf);
    ck_assert_int_eq(ccf_append(&ccf, 0x2001, 0xFF, NULL, 0), CO_OK);
    ck_assert_str_eq(hex_format(ccf.bytes, ccf.size, text, sizeof text), "010000000120FF00000000");
    ccf_done(&ccf);
}
END_TEST

START_TEST(test_append_much)
{
    uint8_t value[1000];
    struct ccf ccf, again;
    struct ccf_reader reader;
    struct ccf_entry entry;
    uint32_t count = 0;

    ccf_init(&ccf);
    for (uint32_t i = 0; i < 1000; i++) {
        memset(value, (int)(i & 0xFF), sizeof value);
        ck_assert_int_eq(ccf_append(&ccf, (uint16_t)i, 1, value, i), CO_OK);
    }
    messages_init(&messages);
    ck_assert_int_eq(guarded_ccf_parse(ccf.bytes, ccf.size, &messages.report, &again), CO_OK);
    ccf_reader_init(&reader, &again);
    for (; ccf_read(&reader, &entry); count++) {
        ck_assert_uint_eq(entry.index, count);
        ck_assert_uint_eq(entry.size, count);
        ck_assert(entry.size == 0 || entry.value[entry.size - 1] == (count & 0xFF));
    }
    ck_assert_uint_eq(count, 1000);
    ccf_done(&again);
    ccf_done(&ccf);
}
END_TEST

START_TEST(test_read)
{
    struct ccf ccf;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ck_assert_int_eq(parse(EXAMPLE, &ccf), CO_OK);
    ck_assert_uint_eq(ccf_count(&ccf), 2);
    ccf_reader_init(&reader, &ccf);
    ck_assert(ccf_read(&reader, &entry));
    ck_assert_uint_eq(entry.index, 0x1017);
    ck_assert_uint_eq(entry.sub, 0);
    ck_assert_uint_eq(entry.size, 2);
    ck_assert_uint_eq(entry.value[1], 3);
    ck_assert(ccf_read(&reader, &entry));
    ck_assert_uint_eq(entry.index, 0x1016);
    ck_assert_uint_eq(entry.sub, 1);
    ck_assert_uint_eq(entry.value[2], 0x7F);
    ck_assert(!ccf_read(&reader, &entry));
    ccf_done(&ccf);
}
END_TEST

static const struct {
    const char *hex;
    const char *message; /* NULL: a whole concise DCF */
} files[] = {
    { "00000000", NULL },
    { "0100000017100000000000", NULL },
    { EXAMPLE, NULL },
    { "-", "a concise DCF begins with a count of 4 bytes, the file has 0" },
    { "010000", "a concise DCF begins with a count of 4 bytes, the file has 3" },
    { "01000000", "entry 1 of 1 at byte 4: 7 bytes of header expected, 0 are left" },
    { "01000000171000020000", "entry 1 of 1 at byte 4: 7 bytes of header expected, 6 are left" },
    { "0100000017100102000000E8",
      "entry 1 of 1 at byte 4 (1017h:01): a value of 2 bytes expected, 1 are left" },
    { "0200000017100002000000E80316", "entry 2 of 2 at byte 13: 7 bytes of header expected, 1 are "
                                      "left" },
    { "0000000000", "the 0 entries of the count end at byte 4, 1 more bytes follow" },
    { "0100000017100002000000E8030102",
      "the 1 entries of the count end at byte 13, 2 more bytes follow" },
    { "FFFFFFFF", "entry 1 of 4294967295 at byte 4: 7 bytes of header expected, 0 are left" },
    { "FFFFFFFF17100002000000E803",
      "entry 2 of 4294967295 at byte 13: 7 bytes of header expected, 0 are left" },
    { "01000000171000FFFFFFFFE803",
      "entry 1 of 1 at byte 4 (1017h:00): a value of 4294967295 bytes expected, 2 are left" },
    { "01000000171000F9FFFFFFE803",
      "entry 1 of 1 at byte 4 (1017h:00): a value of 4294967289 bytes expected, 2 are left" },
};

START_TEST(test_parse)
{
    struct ccf ccf = { .size = 77 };
    char expected[200];

    if (!files[_i].message) {
        ck_assert_int_eq(parse(files[_i].hex, &ccf), CO_OK);
        ck_assert_str_eq(messages.text, "");
        ck_assert_uint_eq(ccf.size, strlen(files[_i].hex) / 2);
        ccf_done(&ccf);
        return;
    }
    ck_assert_int_eq(parse(files[_i].hex, &ccf), CO_ERR_FORMAT);
    snprintf(expected, sizeof expected, " error: %s\n", files[_i].message);
    ck_assert_str_eq(messages.text, expected);
    ck_assert_uint_eq(ccf.size, 77);
}
END_TEST

START_TEST(test_every_truncation)
{
    uint8_t bytes[EXAMPLE_SIZE];
    struct ccf ccf;

    ck_assert_uint_eq(hex_parse(EXAMPLE, bytes, sizeof bytes), EXAMPLE_SIZE);
    for (size_t size = 0; size < EXAMPLE_SIZE; size++) {
        struct guard guard;

        guard_init(&guard, bytes, size);
        messages_init(&messages);
        ck_assert_int_eq(ccf_parse((const uint8_t *)guard.bytes, size, &messages.report, &ccf),
                         CO_ERR_FORMAT);
        ck_assert_uint_eq(messages.report.errors, 1);
        guard_done(&guard);
    }
}
END_TEST

/* What stands before the damage is read all the same, and the position tells where that is. */
static const struct {
    const char *hex;
    unsigned entries, position;
    bool broken;
} damaged[] = {
    { EXAMPLE, 2, EXAMPLE_SIZE, false },
    { "00000000", 0, 4, false },
    { "-", 0, 0, true },
    { "0000", 0, 0, true },
    { "0200000017100002000000E803", 1, 13, true },
    { "0200000017100002000000E80316100104000000D0077F", 1, 13, true },
    { "0200000017100002000000E80316100104000000D0077F00AA", 2, 24, true },
    { "FFFFFFFF17100002000000E80316100104000000D0077F00", 2, 24, true },
    { "0200000017100002000000E803161001FFFFFFFFD0077F00", 1, 13, true },
    { "0100000017100002000000E80316100104000000D0077F00", 1, 13, true },
};

START_TEST(test_read_damaged)
{
    uint8_t bytes[64];
    size_t size = hex_parse(damaged[_i].hex, bytes, sizeof bytes);
    struct ccf_reader reader;
    struct ccf_entry entry;
    struct guard guard;
    unsigned entries = 0;

    messages_init(&messages);
    guard_init(&guard, bytes, size);
    ccf_reader_init_bytes(&reader, (const uint8_t *)guard.bytes, size, &messages.report);
    while (ccf_read_checked(&reader, &messages.report, &entry))
        entries++;
    ck_assert_uint_eq(entries, damaged[_i].entries);
    ck_assert_uint_eq(reader.position, damaged[_i].position);
    ck_assert_int_eq(reader.broken, damaged[_i].broken);
    ck_assert(!ccf_read_checked(&reader, &messages.report, &entry)); /* told once */
    ck_assert_uint_eq(messages.report.errors, damaged[_i].broken ? 1 : 0);
    guard_done(&guard);
}
END_TEST

static Suite *ccf_suite(void)
{
    Suite *suite = suite_create("ccf");
    TCase *tests = tcase_create("ccf");

    tcase_add_test(tests, test_empty);
    tcase_add_test(tests, test_append);
    tcase_add_test(tests, test_lines);
    tcase_add_test(tests, test_append_nothing);
    tcase_add_test(tests, test_append_much);
    tcase_add_test(tests, test_read);
    tcase_add_loop_test(tests, test_parse, 0, sizeof files / sizeof files[0]);
    tcase_add_test(tests, test_every_truncation);
    tcase_add_loop_test(tests, test_read_damaged, 0, sizeof damaged / sizeof damaged[0]);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(ccf_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

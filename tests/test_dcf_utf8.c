#include "dcf/dcf_utf8.h"

#include "support/guard.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static struct guard guard;

static struct dcf_slice guarded(const char *text)
{
    guard_init(&guard, text, strlen(text));
    return (struct dcf_slice){ guard.bytes, strlen(text) };
}

static const struct {
    const char *name;
    const char *bytes;
    const char *text;
} texts[] = {
    { "nothing", "", "" },
    { "ASCII", "Speed [m/s]", "Speed [m/s]" },
    { "UTF-8", "\xC2\xB0\x43 \xE4\xB8\xAD \xF0\x9F\x98\x80",
      "\xC2\xB0\x43 \xE4\xB8\xAD \xF0\x9F\x98\x80" },
    { "Latin-1", "\xB0\x43 \xFC", "\xC2\xB0\x43 \xC3\xBC" },
    { "Windows-1252", "\x93\x80\x94 \x81", "\xE2\x80\x9C\xE2\x82\xAC\xE2\x80\x9D \xC2\x81" },
    { "one byte that is no UTF-8", "\xC2\xB0 \xB0", "\xC3\x82\xC2\xB0 \xC2\xB0" },
    { "cut off", "\xE4\xB8", "\xC3\xA4\xC2\xB8" },
    { "longer than it has to be", "\xC0\xAF", "\xC3\x80\xC2\xAF" },
    { "longer than it has to be, 3", "\xE0\x80\xAF", "\xC3\xA0\xE2\x82\xAC\xC2\xAF" },
    { "longer than it has to be, 4", "\xF0\x80\x80\xAF",
      "\xC3\xB0\xE2\x82\xAC\xE2\x82\xAC\xC2\xAF" },
    { "half of a pair", "\xED\xA0\x80", "\xC3\xAD\xC2\xA0\xE2\x82\xAC" },
    { "behind the last character", "\xF4\x90\x80\x80", "\xC3\xB4\xC2\x90\xE2\x82\xAC\xE2\x82\xAC" },
    { "the last character", "\xF4\x8F\xBF\xBF", "\xF4\x8F\xBF\xBF" },
    { "a byte that begins nothing", "\xF5\x80\x80\x80",
      "\xC3\xB5\xE2\x82\xAC\xE2\x82\xAC\xE2\x82\xAC" },
};

START_TEST(test_copy)
{
    struct co_pool pool = { NULL };
    char *copy = dcf_utf8_copy(&pool, guarded(texts[_i].bytes));

    ck_assert_ptr_nonnull(copy);
    ck_assert_msg(strcmp(copy, texts[_i].text) == 0, "%s: %s", texts[_i].name, copy);
    co_pool_done(&pool);
    guard_done(&guard);
}
END_TEST

START_TEST(test_show)
{
    ck_assert_str_eq(dcf_show(guarded("a\tb\x7F\x1B[1m")).text, "a?b??[1m");
    guard_done(&guard);
    ck_assert_str_eq(dcf_show(guarded("\xC2\x85\xB0\x85")).text,
                     "\xC3\x82\xE2\x80\xA6\xC2\xB0\xE2\x80\xA6");
    guard_done(&guard);
    ck_assert_str_eq(dcf_show(guarded("\xC2\x85")).text, "?");
    guard_done(&guard);
}
END_TEST

#define TEN "0123456789"

/* Cut between two characters, never in one. */
static const struct {
    const char *bytes;
    const char *text;
} cuts[] = {
    { TEN TEN TEN TEN TEN TEN "012", TEN TEN TEN TEN TEN TEN "012" },
    { TEN TEN TEN TEN TEN TEN "0123", TEN TEN TEN TEN TEN TEN "..." },
    { TEN TEN TEN TEN TEN "012345678\xC2\xB0zz", TEN TEN TEN TEN TEN "012345678\xC2\xB0zz" },
    { TEN TEN TEN TEN TEN "012345678\xC2\xB0zzz", TEN TEN TEN TEN TEN "012345678..." },
    { TEN TEN TEN TEN TEN TEN "0\xB0", TEN TEN TEN TEN TEN TEN "0\xC2\xB0" },
    { TEN TEN TEN TEN TEN TEN "01\xB0", TEN TEN TEN TEN TEN TEN "..." },
};

START_TEST(test_cut)
{
    ck_assert_str_eq(dcf_show(guarded(cuts[_i].bytes)).text, cuts[_i].text);
    guard_done(&guard);
}
END_TEST

/* All behind what can be shown would be a crash. */
START_TEST(test_show_beginning)
{
    char text[257];

    memset(text, 'x', sizeof text);
    guard_init(&guard, text, sizeof text);
    ck_assert_uint_eq(strlen(dcf_show((struct dcf_slice){ guard.bytes, (size_t)1 << 30 }).text),
                      63);
    guard_done(&guard);
    for (size_t i = 1; i < sizeof text; i++)
        text[i] = i % 2 ? '\xC2' : '\xB0';
    guard_init(&guard, text, sizeof text);
    ck_assert_ptr_nonnull(
        strstr(dcf_show((struct dcf_slice){ guard.bytes, (size_t)1 << 30 }).text, "x\xC2\xB0"));
    guard_done(&guard);
}
END_TEST

static Suite *utf8_suite(void)
{
    Suite *suite = suite_create("dcf_utf8");
    TCase *tests = tcase_create("dcf_utf8");

    tcase_add_loop_test(tests, test_copy, 0, sizeof texts / sizeof texts[0]);
    tcase_add_test(tests, test_show);
    tcase_add_test(tests, test_show_beginning);
    tcase_add_loop_test(tests, test_cut, 0, sizeof cuts / sizeof cuts[0]);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(utf8_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

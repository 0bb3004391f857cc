/* Texts larger than any description of a device: taken up to the limits, refused beyond. */
#include "dcf/dcf.h"
#include "dcf/dcf_lexer.h"
#include "dcf/dcf_rules.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct co_rule *told; /* by the first error */
static char first_error[CO_REPORT_TEXT_SIZE];

static void keep(void *context, const struct co_message *message)
{
    (void)context;
    if (message->severity != CO_ERROR || told)
        return;
    told = message->rule;
    snprintf(first_error, sizeof first_error, "%s", message->text);
}

/* begin, and the unit so many times */
static enum co_err parse_repeated(const char *begin, const char *unit, size_t count)
{
    const size_t size = strlen(unit);
    char *text = malloc(strlen(begin) + count * size + 1);
    struct co_report report = { .file = "a", .sink = keep };
    struct dcf dcf;
    enum co_err err;
    char *at;

    ck_assert_ptr_nonnull(text);
    at = stpcpy(text, begin);
    for (size_t i = 0; i < count; i++, at += size)
        memcpy(at, unit, size);
    told = NULL;
    first_error[0] = '\0';
    err = dcf_parse(text, (size_t)(at - text), &report, &dcf);
    dcf_done(&dcf);
    free(text);
    return err;
}

static const struct limit {
    const char *begin, *unit;
    size_t count; /* as many as there may be */
    const char *message;
} limits[] = {
    { "[1000]", " ", DCF_TEXT_MAX - 6,
      "a: error: at most 16777216 bytes expected, there are 16777217" },
    { "", "[1000]\n", DCF_SECTIONS_MAX,
      "a:524289: error: at most 524288 sections expected, there are more" },
    { "[1000]\n", "a=\n", DCF_KEYS_MAX,
      "a:2097154: error: at most 2097152 keywords expected, there are more" },
};

START_TEST(as_much_as_there_may_be)
{
    ck_assert_int_eq(parse_repeated(limits[_i].begin, limits[_i].unit, limits[_i].count), CO_OK);
    ck_assert_str_eq(first_error, "");
}
END_TEST

START_TEST(one_more)
{
    ck_assert_int_eq(parse_repeated(limits[_i].begin, limits[_i].unit, limits[_i].count + 1),
                     CO_ERR_FORMAT);
    ck_assert_ptr_eq(told, &dcf_rules[DCF_RULE_FILE_LIMIT]);
    ck_assert_str_eq(first_error, limits[_i].message);
}
END_TEST

/* Sections, but not one that is known. */
START_TEST(another_text)
{
    ck_assert_int_eq(parse_repeated("[Foo]\nA=1\n", "[Bar]\n", 3), CO_ERR_FORMAT);
    ck_assert_ptr_eq(told, &dcf_rules[DCF_RULE_NO_TEXT]);
    ck_assert_int_eq(parse_repeated("[Foo]\nA=1\n", "[1000]\n", 1), CO_OK);
    ck_assert_int_eq(parse_repeated("[Foo]\nA=1\n", "[Comments]\n", 1), CO_OK);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("limits");

    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, as_much_as_there_may_be, 0, 3);
    tcase_add_loop_test(tests, one_more, 0, 3);
    tcase_add_test(tests, another_text);
    return suite_run("limits", tests);
}

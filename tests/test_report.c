/* Messages about files, and the texts of errors. */
#include "base/report.h"

#include "base/error.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

struct log {
    unsigned count;
    enum co_severity severity;
    const struct co_rule *rule;
    char text[CO_REPORT_TEXT_SIZE];
    char body[CO_REPORT_TEXT_SIZE];
};

static void sink(void *context, const struct co_message *message)
{
    struct log *self = context;

    self->count++;
    self->severity = message->severity;
    self->rule = message->rule;
    snprintf(self->text, sizeof self->text, "%s", message->text);
    snprintf(self->body, sizeof self->body, "%s", message->body);
}

START_TEST(test_places)
{
    struct log log = { .count = 0 };
    struct co_report report = { .file = "network.xml", .sink = sink, .context = &log };

    co_report_add(&report, CO_ERROR, 14, "Guard_Time: %d is out of range 0..65535", 70000);
    ck_assert_str_eq(log.text, "network.xml:14: error: Guard_Time: 70000 is out of range 0..65535");
    ck_assert_int_eq(log.severity, CO_ERROR);
    co_report_add(&report, CO_WARNING, 0, "no nodes");
    ck_assert_str_eq(log.text, "network.xml: warning: no nodes");
    ck_assert_int_eq(log.severity, CO_WARNING);
    report.file = NULL;
    co_report_add(&report, CO_INFO, 3, "hello");
    ck_assert_str_eq(log.text, "info: hello");
    ck_assert_uint_eq(log.count, 3);
    ck_assert_uint_eq(report.errors, 1);
    ck_assert_uint_eq(report.warnings, 1);
}
END_TEST

START_TEST(test_rules)
{
    static const struct co_rule error = { "node-id", CO_ERROR, 7, "clause", "text" };
    static const struct co_rule warning = { "name", CO_WARNING, 8, "clause", "text" };
    struct log log = { .count = 0 };
    struct co_report report = { .file = "a", .sink = sink, .context = &log };

    co_report_rule(&report, &warning, 1, "a name of %d", 3);
    ck_assert_str_eq(log.text, "a:1: warning: a name of 3");
    ck_assert_str_eq(log.body, "a name of 3");
    ck_assert_ptr_eq(log.rule, &warning);
    ck_assert_int_eq(report.error_kind, 0);
    co_report_rule(&report, &error, 2, "there is %u", 128);
    ck_assert_str_eq(log.text, "a:2: error: there is 128");
    ck_assert_ptr_eq(log.rule, &error);
    ck_assert_int_eq(report.error_kind, 7);
    co_report_add(&report, CO_WARNING, 3, "no rule");
    ck_assert_ptr_null(log.rule);
    ck_assert_uint_eq(report.errors, 1);
    ck_assert_uint_eq(report.warnings, 2);
}
END_TEST

/* So many of each severity, and one more that says so; all are counted. */
START_TEST(test_limit)
{
    struct log log = { .count = 0 };
    struct co_report report = { .file = "a", .sink = sink, .context = &log, .limit = 3 };

    for (unsigned i = 1; i <= 9; i++)
        co_report_add(&report, CO_WARNING, i, "warning");
    ck_assert_str_eq(log.text, "a: warning: there are more than 3 warnings: the rest is left out");
    ck_assert_uint_eq(log.count, 4);
    for (unsigned i = 1; i <= 3; i++)
        co_report_add(&report, CO_ERROR, i, "error");
    ck_assert_str_eq(log.text, "a:3: error: error");
    co_report_add(&report, CO_ERROR, 4, "error");
    co_report_add(&report, CO_ERROR, 5, "error");
    ck_assert_str_eq(log.text, "a: error: there are more than 3 errors: the rest is left out");
    co_report_add(&report, CO_INFO, 6, "info");
    ck_assert_str_eq(log.text, "a:6: info: info");
    ck_assert_uint_eq(log.count, 9);
    ck_assert_uint_eq(report.errors, 5);
    ck_assert_uint_eq(report.warnings, 9);
    ck_assert_str_eq(report.first_error, "a:1: error: error");
}
END_TEST

START_TEST(test_limit_of_its_own_accord)
{
    struct log log = { .count = 0 };
    struct co_report report = { .sink = sink, .context = &log };

    for (unsigned i = 0; i < 2 * CO_REPORT_LIMIT; i++)
        co_report_add(&report, CO_WARNING, i, "warning");
    ck_assert_uint_eq(log.count, CO_REPORT_LIMIT + 1);
    ck_assert_uint_eq(report.warnings, 2 * CO_REPORT_LIMIT);
}
END_TEST

START_TEST(test_first_error_is_kept)
{
    struct co_report report = { .file = "a" };

    co_report_add(&report, CO_WARNING, 1, "warning");
    co_report_kind(&report, CO_ERR_FORMAT); /* no error yet */
    ck_assert_int_eq(report.error_kind, 0);
    co_report_add(&report, CO_ERROR, 2, "first");
    co_report_kind(&report, CO_ERR_VALUE);
    co_report_kind(&report, CO_ERR_MEMORY);
    co_report_add(&report, CO_ERROR, 3, "second");
    co_report_kind(&report, CO_ERR_FORMAT);
    ck_assert_str_eq(report.first_error, "a:2: error: first");
    ck_assert_int_eq(report.error_kind, CO_ERR_VALUE);
    ck_assert_uint_eq(report.errors, 2);
}
END_TEST

START_TEST(test_long_messages_are_cut)
{
    char name[2 * CO_REPORT_TEXT_SIZE], message[2 * CO_REPORT_TEXT_SIZE];
    struct log log = { .count = 0 };
    struct co_report report = { .file = "a", .sink = sink, .context = &log };

    memset(message, 'm', sizeof message - 1);
    message[sizeof message - 1] = '\0';
    co_report_add(&report, CO_ERROR, 1, "%s", message);
    ck_assert_uint_eq(strlen(log.text), CO_REPORT_TEXT_SIZE - 1);
    ck_assert_str_eq(report.first_error, log.text);
    memset(name, 'n', sizeof name - 1);
    name[sizeof name - 1] = '\0';
    report.file = name;
    co_report_add(&report, CO_ERROR, 1, "what happened");
    ck_assert_str_eq(log.text, "what happened"); /* rather than only half a name */
}
END_TEST

START_TEST(test_error_texts)
{
    const char *texts[16];

    for (int i = 0; i < 16; i++) {
        texts[i] = co_err_text((enum co_err) - i);
        ck_assert_str_ne(texts[i], "unknown error");
        for (int k = 0; k < i; k++)
            ck_assert_str_ne(texts[i], texts[k]);
    }
    ck_assert_str_eq(co_err_text(CO_ERR_TIMEOUT), "time-out");
    ck_assert_str_eq(co_err_text((enum co_err) - 99), "unknown error");
    ck_assert_str_eq(co_err_text((enum co_err)1), "unknown error");
    ck_assert_str_eq(co_severity_text(CO_WARNING), "warning");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("report");
    TCase *tcase = tcase_create("report");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_test(tcase, test_places);
    tcase_add_test(tcase, test_rules);
    tcase_add_test(tcase, test_limit);
    tcase_add_test(tcase, test_limit_of_its_own_accord);
    tcase_add_test(tcase, test_first_error_is_kept);
    tcase_add_test(tcase, test_long_messages_are_cut);
    tcase_add_test(tcase, test_error_texts);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

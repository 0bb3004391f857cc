/* The list of rules: what a manual page, a filter and an editor need of each is there. */
#include "dcf/dcf_rules.h"

#include "dcf/dcf.h"
#include "support/suite.h"

#include <ctype.h>
#include <string.h>

START_TEST(each_rule_is_complete)
{
    const struct co_rule *rule = &dcf_rules[_i];

    ck_assert_uint_gt(strlen(rule->name), 3);
    ck_assert_uint_lt(strlen(rule->name), 30);
    for (const char *c = rule->name; *c; c++)
        ck_assert_msg(islower(*c) || isdigit(*c) || *c == '-', "%s", rule->name);
    ck_assert_msg(rule->severity == CO_ERROR || rule->severity == CO_WARNING, "%s", rule->name);
    ck_assert_msg(rule->severity == CO_WARNING || rule->kind != DCF_ERROR_NONE, "%s", rule->name);
    ck_assert_uint_gt(strlen(rule->clause), 5);
    ck_assert_msg(isupper(rule->text[0]) || rule->text[0] == '[', "%s", rule->name);
    ck_assert_msg(rule->text[strlen(rule->text) - 1] == '.', "%s: %s", rule->name, rule->text);
}
END_TEST

START_TEST(a_name_is_that_of_one_rule)
{
    for (int i = 0; i < _i; i++)
        ck_assert_str_ne(dcf_rules[i].name, dcf_rules[_i].name);
}
END_TEST

static const struct co_rule *told;

static void keep(void *context, const struct co_message *message)
{
    (void)context;
    told = message->rule;
}

START_TEST(a_message_has_its_rule)
{
    struct co_report report = { .file = "a.dcf", .sink = keep };
    struct dcf dcf;

    ck_assert_int_eq(dcf_parse("", 0, &report, &dcf), CO_ERR_FORMAT);
    ck_assert_ptr_eq(told, &dcf_rules[DCF_RULE_NO_TEXT]);
    ck_assert_int_eq(report.error_kind, DCF_ERROR_MISSING_SECTION);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("dcf_rules");

    tcase_add_loop_test(tests, each_rule_is_complete, 0, DCF_RULE_COUNT);
    tcase_add_loop_test(tests, a_name_is_that_of_one_rule, 0, DCF_RULE_COUNT);
    tcase_add_test(tests, a_message_has_its_rule);
    return suite_run("dcf_rules", tests);
}

/* The rules of dcftest. */
#include "dcftest.h"

#include "common_tool.h"
#include "json/json_text.h"

const struct co_rule tool_rules[TOOL_RULE_COUNT] = {
    [RULE_UNREADABLE] = { "unreadable", CO_ERROR, 0, "dcftest",
                          "The file can be read, and a folder has files that end in .eds or "
                          ".dcf." },
    [RULE_ONLINE_IDENTITY] = { "online-identity", CO_WARNING, 0, "CiA 301, objects 1000h and 1018h",
                               "With --online: the device is of the type, vendor, product and "
                               "revision of the file, and has its node-ID." },
    [RULE_ONLINE_OBJECT] = { "online-object", CO_WARNING, 0,
                             "CiA 306-1, 6.6.3.2 (object description)",
                             "With --online: the device has what the file describes, and lets "
                             "it be read." },
    [RULE_ONLINE_SIZE] = { "online-size", CO_WARNING, 0, "CiA 306-1, 6.6.3.2 (object description)",
                           "With --online: a value has the size of its data type." },
    [RULE_ONLINE_VALUE] = { "online-value", CO_WARNING, 0, "CiA 306-1, 7.3.1 (values of a DCF)",
                            "With --online: the device has the ParameterValue of the DCF." },
};

const struct co_rule *rule_at(size_t number)
{
    return number < DCF_RULE_COUNT ? &dcf_rules[number] : &tool_rules[number - DCF_RULE_COUNT];
}

/* Where it is in an array; 'count' or more: elsewhere. */
static size_t place_in(const struct co_rule *rules, const struct co_rule *rule)
{
    return ((uintptr_t)rule - (uintptr_t)rules) / sizeof *rule;
}

size_t rule_number(const struct co_rule *rule)
{
    if (place_in(dcf_rules, rule) < DCF_RULE_COUNT)
        return place_in(dcf_rules, rule);
    if (place_in(tool_rules, rule) < TOOL_RULE_COUNT)
        return DCF_RULE_COUNT + place_in(tool_rules, rule);
    return RULE_COUNT;
}

const char *rule_code(const struct co_rule *rule)
{
    if (rule == &tool_rules[RULE_UNREADABLE])
        return "CANOPEN_DCF_INIT_ERROR";
    return rule ? tool_dcf_code(rule->kind) : NULL;
}

static const struct rule_list lists[] = {
    { dcf_rules, DCF_RULE_COUNT, true },
    { tool_rules, TOOL_RULE_COUNT, true },
};

void rules_init(struct rule_choice *self)
{
    *self = (struct rule_choice){ .tool = "dcftest",
                                  .lists = lists,
                                  .list_count = sizeof lists / sizeof lists[0] };
}

static bool print_line(const struct co_rule *rule)
{
    const char *code = rule_code(rule);

    return printf("%s: %s [%s%s%s]\n    %s\n", rule->name, co_severity_text(rule->severity),
                  rule->clause, code ? ", " : "", code ? code : "", rule->text) >= 0;
}

static bool print_object(const struct co_rule *rule, bool first)
{
    const char *code = rule_code(rule);
    json_t *object = json_pack("{s:s, s:s, s:s, s:s?, s:s}", "name", rule->name, "severity",
                               co_severity_text(rule->severity), "clause", rule->clause, "code",
                               code, "text", rule->text);

    return fputs(first ? "[\n" : ",\n", stdout) >= 0 && json_write(object, 0, stdout);
}

bool rules_print(bool json)
{
    bool good = true;

    for (size_t i = 0; good && i < RULE_COUNT; i++)
        good = json ? print_object(rule_at(i), i == 0) : print_line(rule_at(i));
    return good && (!json || puts("\n]") >= 0);
}

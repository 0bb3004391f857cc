/* The rules of dcftest: which there are, and which of them the user wants to hear of. */
#include "dcftest.h"

#include "common_tool.h"
#include "json/json_text.h"

#include <stdlib.h>
#include <string.h>

#define NAME_MAX_SIZE 40u /* longer ones resemble no rule's */
#define NEAR          2u  /* changes of a letter */

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

static size_t find(const char *name, size_t size)
{
    for (size_t i = 0; i < RULE_COUNT; i++)
        if (strlen(rule_at(i)->name) == size && memcmp(rule_at(i)->name, name, size) == 0)
            return i;
    return RULE_COUNT;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* How many letters are to be changed, put in or left out to make one of the other. */
static size_t distance(const char *a, size_t a_size, const char *b, size_t b_size)
{
    size_t row[NAME_MAX_SIZE + 1];

    if (a_size > NAME_MAX_SIZE || b_size > NAME_MAX_SIZE)
        return NAME_MAX_SIZE;
    for (size_t k = 0; k <= b_size; k++)
        row[k] = k;
    for (size_t i = 1; i <= a_size; i++) {
        size_t diagonal = row[0];

        row[0] = i;
        for (size_t k = 1; k <= b_size; k++) {
            const size_t changed = diagonal + (a[i - 1] != b[k - 1]);

            diagonal = row[k];
            row[k] = least(changed, least(row[k], row[k - 1]) + 1);
        }
    }
    return row[b_size];
}

static bool resembles(const char *rule, const char *name, size_t size)
{
    return distance(rule, strlen(rule), name, size) <= NEAR ||
           (size >= 3 && memmem(rule, strlen(rule), name, size) != NULL);
}

static void tell_unknown(const char *option, const char *name, size_t size)
{
    const char *between = "; did you mean ";

    fprintf(stderr, "dcftest: %s: no rule \"%.*s\"", option, (int)size, name);
    for (size_t i = 0; i < RULE_COUNT; i++) {
        if (resembles(rule_at(i)->name, name, size)) {
            fprintf(stderr, "%s%s", between, rule_at(i)->name);
            between = ", ";
        }
    }
    fputs(between[0] == ';' ? "\nTry 'dcftest --list-rules'.\n" : "?\n", stderr);
}

/* A boot fails on it, whoever wants to know. */
static bool tell_error_rule(const char *name)
{
    fprintf(stderr,
            "dcftest: --no-rule: \"%s\" is an error, for which the manager refuses a file: it "
            "cannot be left out\n",
            name);
    return false;
}

static bool add_name(struct rule_set *self, const char *option, const char *name, size_t size)
{
    const bool without = strcmp(option, "--no-rule") == 0;
    const size_t number = find(name, size);

    if (number == RULE_COUNT) {
        tell_unknown(option, name, size);
        return false;
    }
    if (without && rule_at(number)->severity == CO_ERROR)
        return tell_error_rule(rule_at(number)->name);
    (without ? self->unwanted : self->wanted)[number] = true;
    self->chosen |= !without;
    return true;
}

bool rule_set_add(struct rule_set *self, const char *option, const char *names)
{
    for (;;) {
        const size_t size = strcspn(names, ",");

        if (!add_name(self, option, names, size))
            return false;
        if (names[size] == '\0')
            return true;
        names += size + 1;
    }
}

bool rule_set_has(const struct rule_set *self, const struct co_message *message)
{
    const size_t number = rule_number(message->rule);

    if (message->severity == CO_ERROR)
        return true;
    if (number == RULE_COUNT)
        return !self->chosen;
    return !self->unwanted[number] && (!self->chosen || self->wanted[number]);
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

#include "common_rules.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define NAME_SIZE_MAX 40u /* longer ones resemble no rule's */
#define NEAR          2u  /* changes of a letter */
#define NONE          CHOICE_RULES_MAX

static const struct rule_list *list_of(const struct rule_choice *self, size_t *number)
{
    for (size_t i = 0; i < self->list_count; i++) {
        if (*number < self->lists[i].count)
            return &self->lists[i];
        *number -= self->lists[i].count;
    }
    return NULL;
}

const struct co_rule *rule_choice_at(const struct rule_choice *self, size_t number)
{
    const struct rule_list *list = number < NONE ? list_of(self, &number) : NULL;

    return list ? &list->rules[number] : NULL;
}

static bool is_named(const struct co_rule *rule, const char *name, size_t size)
{
    return strlen(rule->name) == size && memcmp(rule->name, name, size) == 0;
}

static size_t number_of(const struct rule_choice *self, const struct co_rule *rule)
{
    size_t before = 0;

    for (size_t i = 0; rule && i < self->list_count; i++) {
        const struct rule_list *list = &self->lists[i];
        const size_t place = ((uintptr_t)rule - (uintptr_t)list->rules) / sizeof *rule;

        if (place < list->count)
            return before + place;
        before += list->count;
    }
    return NONE;
}

static size_t least(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* How many letters are to be changed, put in or left out to make one of the other. */
static size_t distance(const char *a, size_t a_size, const char *b, size_t b_size)
{
    size_t row[NAME_SIZE_MAX + 1];

    if (a_size > NAME_SIZE_MAX || b_size > NAME_SIZE_MAX)
        return NAME_SIZE_MAX;
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

static void tell_unknown(const struct rule_choice *self, const char *option, const char *name,
                         size_t size)
{
    const char *between = "; did you mean ";
    const struct co_rule *rule;

    fprintf(stderr, "%s: %s: no rule \"%.*s\"", self->tool, option, (int)size, name);
    for (size_t i = 0; (rule = rule_choice_at(self, i)) != NULL; i++) {
        if (resembles(rule->name, name, size)) {
            fprintf(stderr, "%s%s", between, rule->name);
            between = ", ";
        }
    }
    if (between[0] == ';')
        fprintf(stderr, "\nTry '%s --list-rules'.\n", self->tool);
    else
        fputs("?\n", stderr);
}

/* A boot fails on it, whoever wants to know. */
static bool stays(const struct rule_choice *self, size_t number)
{
    const struct co_rule *rule = rule_choice_at(self, number);
    const struct rule_list *list = list_of(self, &number);

    if (rule->severity != CO_ERROR || !list->errors_stay)
        return false;
    fprintf(stderr,
            "%s: --no-rule: \"%s\" is an error, for which the manager refuses a file: it cannot be "
            "left out\n",
            self->tool, rule->name);
    return true;
}

/* Of two lists, each may have a rule of the name. */
static bool add_name(struct rule_choice *self, const char *option, const char *name, size_t size)
{
    const bool without = strcmp(option, "--no-rule") == 0;
    const struct co_rule *rule;
    bool found = false;

    for (size_t i = 0; (rule = rule_choice_at(self, i)) != NULL; i++) {
        if (!is_named(rule, name, size))
            continue;
        found = true;
        if (without && stays(self, i))
            return false;
        (without ? self->unwanted : self->wanted)[i] = true;
        self->chosen |= !without;
    }
    if (!found)
        tell_unknown(self, option, name, size);
    return found;
}

bool rule_choice_add(struct rule_choice *self, const char *option, const char *names)
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

bool rule_choice_has(const struct rule_choice *self, const struct co_message *message)
{
    const size_t number = number_of(self, message->rule);

    if (number == NONE)
        return message->severity == CO_ERROR || !self->chosen;
    if (self->unwanted[number])
        return false;
    return message->severity == CO_ERROR || !self->chosen || self->wanted[number];
}

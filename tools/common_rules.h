/*
 * Rules by name on the command line: --rule and --no-rule choose which messages are wanted.
 *
 *   in   lists of rules, names with commas between
 *   out  whether a message is wanted
 */
#ifndef TOOLS_COMMON_RULES_H
#define TOOLS_COMMON_RULES_H

#include "base/report.h"

#include <stdbool.h>
#include <stddef.h>

#define CHOICE_RULES_MAX 512u

struct rule_list {
    const struct co_rule *rules;
    size_t count;
    bool errors_stay; /* no one can leave out an error of these */
};

struct rule_choice {
    const char *tool; /* for messages */
    const struct rule_list *lists;
    size_t list_count;
    bool chosen; /* by --rule: only those */
    bool wanted[CHOICE_RULES_MAX];
    bool unwanted[CHOICE_RULES_MAX];
};

/* By number, in the order of the lists; NULL: there are no more. */
const struct co_rule *rule_choice_at(const struct rule_choice *self, size_t number);

/* The names of --rule or --no-rule. False: one is none, or has to stay; that was told on stderr. */
bool rule_choice_add(struct rule_choice *self, const char *option, const char *names);

/* Errors always are, unless they are left out by name. */
bool rule_choice_has(const struct rule_choice *self, const struct co_message *message);

#endif

/*
 * mcanopen check: what its parts share.
 *
 *   mcanopen_check       options, and what goes where
 *   mcanopen_check_text  the summary as text
 *   mcanopen_check_json  all of it as JSON
 */
#ifndef TOOLS_MCANOPEN_CHECK_H
#define TOOLS_MCANOPEN_CHECK_H

#include "audit/audit.h"
#include "common_rules.h"

#include <jansson.h>

struct check {
    struct audit audit;
    struct co_report report;
    struct rule_choice rules;
    bool strict, json;
    unsigned quiet;            /* 1: errors alone, 2: nothing */
    unsigned errors, warnings; /* that are wanted */
    bool failed;               /* no memory, or not written */
    json_t *messages;
};

bool check_is_bad(const struct check *self);

/* What an element of the table is called, for both outputs. */
const char *check_kind(const struct node_config *config);
struct check_text {
    char text[64];
};
struct check_text check_compared(const struct node_config *config);
struct check_text check_supervision(const struct audit_node *node);

/* Of the bus, in tenths of a per cent. */
unsigned long check_share(const struct audit_network *network, uint64_t rate);

void check_print_summary(const struct check *self);

bool check_add_json(struct check *self, const struct co_message *message);
bool check_print_json(struct check *self);

#endif

/*
 * The rules of EDS and DCF files: each message of the reader and of the checks belongs to one.
 *
 * The list dcf_rules.def is the one place that knows them. An error makes the manager refuse the
 * file, a warning it ignores.
 */
#ifndef CO_DCF_DCF_RULES_H
#define CO_DCF_DCF_RULES_H

#include "base/report.h"

#include <stddef.h>

enum dcf_rule {
#define DCF_RULE(rule, name, severity, kind, clause, text) DCF_RULE_##rule,
#include "dcf/dcf_rules.def"
#undef DCF_RULE
    DCF_RULE_COUNT
};

extern const struct co_rule dcf_rules[DCF_RULE_COUNT];

/* A message of a rule of the list: dcf_tell(report, DCF_RULE_NODE_ID, line, "...", ...) */
#define dcf_tell(report, rule, ...) co_report_rule((report), &dcf_rules[rule], __VA_ARGS__)

#endif

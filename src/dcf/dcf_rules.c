#include "dcf/dcf_rules.h"

#include "dcf/dcf.h"

const struct co_rule dcf_rules[DCF_RULE_COUNT] = {
#define DCF_RULE(rule, name, severity, kind, clause, text)                                         \
    { name, CO_##severity, DCF_ERROR_##kind, clause, text },
#include "dcf/dcf_rules.def"
#undef DCF_RULE
};

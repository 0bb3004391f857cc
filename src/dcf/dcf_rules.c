#include "dcf/dcf_rules.h"

#include "dcf/dcf.h"

#include <string.h>

const struct co_rule dcf_rules[DCF_RULE_COUNT] = {
#define DCF_RULE(rule, name, severity, kind, clause, text)                                         \
    { name, CO_##severity, DCF_ERROR_##kind, clause, text },
#include "dcf/dcf_rules.def"
#undef DCF_RULE
};

const struct co_rule *dcf_rule_find(const char *name)
{
    for (size_t i = 0; i < DCF_RULE_COUNT; i++) {
        if (strcmp(dcf_rules[i].name, name) == 0)
            return &dcf_rules[i];
    }
    return NULL;
}

#include "audit.h"

#include <string.h>

const struct co_rule audit_rules[AUDIT_RULE_COUNT] = {
#define AUDIT_RULE(rule, name, severity, clause, text) { name, CO_##severity, 0, clause, text },
#include "audit_rules.def"
#undef AUDIT_RULE
};

const struct co_rule *audit_rule_find(const char *name)
{
    for (size_t i = 0; i < AUDIT_RULE_COUNT; i++)
        if (strcmp(audit_rules[i].name, name) == 0)
            return &audit_rules[i];
    return NULL;
}

#include "audit.h"

#include <stdarg.h>
#include <stdio.h>

const struct co_rule audit_rules[AUDIT_RULE_COUNT] = {
#define AUDIT_RULE(rule, name, severity, clause, text) { name, CO_##severity, 0, clause, text },
#include "audit_rules.def"
#undef AUDIT_RULE
};

/* A file may belong to nodes of several networks. */
static struct audit_label name_network(const struct audit_network *self)
{
    struct audit_label label = { "" };

    if (self->audit->count > 1 && self->config->name)
        snprintf(label.text, sizeof label.text, "%.40s: ", self->config->name);
    else if (self->audit->count > 1)
        snprintf(label.text, sizeof label.text, "network %u: ", self->config->net);
    return label;
}

void audit_tell(const struct audit_network *self, struct audit_place place, enum audit_rule rule,
                const char *format, ...)
{
    char text[CO_REPORT_TEXT_SIZE];
    va_list arguments;

    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    self->report->file = place.file;
    co_report_rule(self->report, &audit_rules[rule], place.line, "%s%s", name_network(self).text,
                   text);
}

#include "dcf/dcf_lint.h"

#include "dcf/dcf_lint_parts.h"

const struct dcf_value *dcf_lint_effective(const struct dcf_entry *entry)
{
    if (entry->parameter.given && (dcf_entry_downloads(entry) || !entry->initial.given))
        return &entry->parameter;
    return entry->initial.given ? &entry->initial : NULL;
}

bool dcf_lint_is_mapping(uint16_t index)
{
    return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}

static size_t end_of_object(const struct dcf *dcf, size_t first)
{
    size_t end = first + 1;

    while (end < dcf->count && dcf->entries[end].index == dcf->entries[first].index)
        end++;
    return end;
}

enum co_err dcf_lint(const struct dcf *self, struct co_report *report)
{
    struct dcf_lint lint = { .dcf = self, .report = report };
    struct dcf_lint_object object;

    for (size_t i = 0; i < self->count; i += object.count) {
        object.entries = &self->entries[i];
        object.count = end_of_object(self, i) - i;
        dcf_lint_object(&lint, &object);
    }
    return CO_OK;
}

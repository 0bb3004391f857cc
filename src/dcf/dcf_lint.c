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

/* 1400h.., 1800h.. */
static bool is_communication(uint16_t index)
{
    return (index >= 0x1400 && index <= 0x15FF) || (index >= 0x1800 && index <= 0x19FF);
}

bool dcf_lint_is_writable(const struct dcf_entry *entry)
{
    return entry->access != OD_RO && entry->access != OD_CONST;
}

bool dcf_lint_number(const struct dcf_lint *self, const struct dcf_entry *entry,
                     const struct dcf_value *value, uint64_t *ret_number)
{
    if (!value || !value->given || od_type_size(entry->type) == 0)
        return false;
    *ret_number = dcf_value_number(value, entry->type, self->node_id);
    return true;
}

static void lint_object(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    uint16_t index = object->entries->index;

    dcf_lint_object(self, object);
    if (index < 0x1000 || index > 0x1FFF)
        return;
    dcf_lint_known(self, object);
    if (is_communication(index))
        dcf_lint_communication(self, object);
    if (dcf_lint_is_mapping(index))
        dcf_lint_mapping(self, object);
}

static bool object_at(const struct dcf *dcf, size_t first, struct dcf_lint_object *ret_object)
{
    size_t end = first;

    if (first >= dcf->count)
        return false;
    while (end < dcf->count && dcf->entries[end].index == dcf->entries[first].index)
        end++;
    *ret_object = (struct dcf_lint_object){ &dcf->entries[first], end - first };
    return true;
}

bool dcf_lint_first(const struct dcf_lint *self, struct dcf_lint_object *ret_object, uint16_t index)
{
    return object_at(self->dcf, dcf_place(self->dcf, index, 0), ret_object);
}

bool dcf_lint_next(const struct dcf_lint *self, struct dcf_lint_object *object)
{
    return object_at(self->dcf, (size_t)(object->entries - self->dcf->entries) + object->count,
                     object);
}

enum co_err dcf_lint(const struct dcf *self, struct co_report *report)
{
    struct dcf_lint lint = { .dcf = self,
                             .report = report,
                             .node_id = self->has_node_id ? self->node_id : 1 };
    struct dcf_lint_object object;

    dcf_lint_device(&lint);
    dcf_lint_abilities(&lint);
    for (bool more = dcf_lint_first(&lint, &object, 0); more; more = dcf_lint_next(&lint, &object))
        lint_object(&lint, &object);
    return dcf_lint_cob_ids(&lint) ? CO_OK : CO_ERR_MEMORY;
}

#include "dcf/dcf_modules.h"

static bool is_described(const struct dcf_modules *self, uint16_t index)
{
    struct dcf file = { .entries = self->builder->dcf->entries, .count = self->described };

    return dcf_has_object(&file, index);
}

/* What the file describes stays as it is there; of several modules the first one's is taken. */
static bool take_index(struct dcf_modules *self, uint16_t index)
{
    bool is_new = !self->is_taken[index] && !is_described(self, index);

    self->is_taken[index] = true;
    return is_new;
}

static void keep_new(struct dcf_modules *self, size_t start)
{
    struct dcf *dcf = self->builder->dcf;
    size_t kept = start;
    bool keep = false;

    for (size_t i = start; i < dcf->count; i++) {
        if (i == start || dcf->entries[i].index != dcf->entries[i - 1].index)
            keep = take_index(self, dcf->entries[i].index);
        if (keep)
            dcf->entries[kept++] = dcf->entries[i];
    }
    dcf->count = kept;
}

/* An object of a module that is not there is no object of the device. */
static void drop(struct dcf_modules *self, size_t start)
{
    struct dcf_builder *builder = self->builder;
    struct dcf *dcf = builder->dcf;

    dcf_check_values_from(builder, start);
    for (size_t i = start; i < dcf->count; i++) {
        const struct dcf_entry *entry = &dcf->entries[i];
        bool is_first = i == start || entry->index != dcf->entries[i - 1].index;

        if (is_first && is_described(self, entry->index))
            dcf_tell(builder->report, DCF_RULE_MODULE_OBJECT, entry->line,
                     "%04Xh: an object of modules only expected, [%04X] is in this file as well",
                     entry->index, entry->index);
    }
    dcf->count = start;
}

void dcf_module_build_fixed(struct dcf_modules *self, struct dcf_range range)
{
    struct dcf_builder *builder = self->builder;
    size_t start = builder->dcf->count;
    size_t place = (size_t)(range.first - builder->text.sections);
    size_t end = (size_t)(range.end - builder->text.sections);

    while (place < end && builder->text.sections[place].kind < DCF_SECTION_FIXED)
        place++;
    while (place < end && !builder->no_memory)
        place = dcf_build_group(builder, place);
    if (dcf_module_is_used(self, range.first->part))
        keep_new(self, start);
    else
        drop(self, start);
}

#include "dcf/dcf.h"

#include "base/bytes.h"
#include "dcf/dcf_build.h"

#include <stdlib.h>
#include <string.h>

void dcf_done(struct dcf *self)
{
    free(self->entries);
    co_pool_done(&self->pool);
    *self = (struct dcf){ .count = 0 };
}

static uint32_t address(uint16_t index, uint8_t sub)
{
    return (uint32_t)index << 8 | sub;
}

size_t dcf_place(const struct dcf *self, uint16_t index, uint8_t sub)
{
    size_t low = 0, high = self->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const struct dcf_entry *entry = &self->entries[middle];

        if (address(entry->index, entry->sub) < address(index, sub))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const struct dcf_entry *dcf_find(const struct dcf *self, uint16_t index, uint8_t sub)
{
    size_t place = dcf_place(self, index, sub);

    if (place == self->count || self->entries[place].index != index ||
        self->entries[place].sub != sub)
        return NULL;
    return &self->entries[place];
}

const struct dcf_entry *dcf_object(const struct dcf *self, uint16_t index, size_t *ret_count)
{
    size_t first = dcf_place(self, index, 0);
    size_t end = first;

    while (end < self->count && self->entries[end].index == index)
        end++;
    *ret_count = end - first;
    return end > first ? &self->entries[first] : NULL;
}

bool dcf_has_object(const struct dcf *self, uint16_t index)
{
    size_t place = dcf_place(self, index, 0);

    return place < self->count && self->entries[place].index == index;
}

uint32_t dcf_value(const struct dcf_value *value, uint8_t node_id, uint8_t *bytes)
{
    if (!value->given)
        return 0;
    if (value->size > 0)
        memcpy(bytes, value->bytes, value->size);
    if (value->has_node_id)
        put_le(bytes, value->size, get_le(value->bytes, value->size) + node_id);
    return value->size;
}

/* What is a text with brackets all the same would give an empty description. */
static void check_sections(struct dcf_builder *self)
{
    if (self->text.sections[0].kind == DCF_SECTION_UNKNOWN) /* they are the last ones */
        dcf_tell(self->report, DCF_RULE_NO_TEXT, 0,
                 "EDS or DCF text expected, none of its sections is one of CiA 306");
}

static void build(struct dcf_builder *self)
{
    check_sections(self);
    dcf_build_info(self);
    dcf_build_commissioning(self);
    dcf_build_objects(self);
    dcf_build_compact_pdos(self);
    dcf_build_modules(self);
    dcf_tell_no_names(self);
    dcf_apply_compact_lists(self);
    dcf_check_lists(self);
    dcf_check_notes(self);
    dcf_check_values(self);
}

enum co_err dcf_parse(const char *text, size_t size, struct co_report *report, struct dcf *ret_dcf)
{
    struct dcf dcf = { .count = 0 };
    struct dcf_builder builder = { .dcf = &dcf, .report = report };
    unsigned errors = report->errors;
    enum co_err err;

    *ret_dcf = dcf;
    err = dcf_lex(text, size, report, &builder.text);
    if (err != CO_OK)
        return err;
    build(&builder);
    dcf_text_done(&builder.text);
    if (report->errors > errors || builder.no_memory) {
        dcf_done(&dcf);
        return report->errors > errors ? CO_ERR_FORMAT : CO_ERR_MEMORY;
    }
    *ret_dcf = dcf;
    return CO_OK;
}

/* Compact objects: one section describes all sub-indices, others their names and values. */
#include "dcf/dcf_build.h"
#include "dcf/dcf_utf8.h"

#include <stdio.h>
#include <string.h>

#define ERROR_FIELD 0x1003u

static bool is_mapping(uint16_t index)
{
    return (index >= 0x1600 && index <= 0x17FF) || (index >= 0x1A00 && index <= 0x1BFF);
}

static void build_highest_sub(struct dcf_builder *self, const struct dcf_section *section,
                              unsigned count, uint8_t access)
{
    struct dcf_entry *entry = dcf_build_entry(self, section->index, 0);
    bool counts = section->index == ERROR_FIELD || is_mapping(section->index);

    if (!entry)
        return;
    entry->object_type = OBJECT_ARRAY;
    entry->type = OD_UNSIGNED8;
    entry->access = section->index == ERROR_FIELD ? OD_RW : counts ? access : OD_CONST;
    entry->line = section->line;
    dcf_set_text(self, &entry->name, "Highest sub-index supported");
    dcf_set_number(self, &entry->initial, 1, counts ? 0 : count);
}

void dcf_build_element(struct dcf_builder *self, const struct dcf_entry *pattern, unsigned sub)
{
    struct dcf_entry *entry = dcf_build_entry(self, pattern->index, (uint8_t)sub);
    char name[300];

    if (!entry)
        return;
    entry->type = pattern->type;
    entry->access = pattern->access;
    entry->mappable = pattern->mappable;
    entry->flags = pattern->flags;
    entry->line = pattern->line;
    snprintf(name, sizeof name, "%s%u", pattern->name ? pattern->name : "", sub);
    dcf_set_text(self, &entry->name, name);
    entry->initial = pattern->initial;
    entry->low = pattern->low;
    entry->high = pattern->high;
}

void dcf_build_compact(struct dcf_builder *self, struct dcf_section *section, unsigned count)
{
    struct dcf_entry pattern = { .index = section->index, .object_type = OBJECT_ARRAY };

    dcf_fill_entry(self, section, &pattern);
    if (pattern.parameter.given)
        dcf_tell(self->report, DCF_RULE_COMPACT_VALUE, pattern.parameter.line,
                 "[%s] ParameterValue: a section [%04XValue] expected for a compact object: "
                 "ignored",
                 dcf_show(section->name).text, section->index);
    build_highest_sub(self, section, count, pattern.access);
    for (unsigned sub = 1; sub <= count && !self->no_memory; sub++)
        dcf_build_element(self, &pattern, sub);
}

static struct dcf_entry *find_entry(struct dcf_builder *self, uint16_t index, unsigned sub)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, (uint8_t)sub);

    return entry ? &self->dcf->entries[entry - self->dcf->entries] : NULL;
}

static void apply_key(struct dcf_builder *self, struct dcf_section *section, struct dcf_key *key)
{
    struct dcf_entry *entry;
    unsigned sub = 0;

    if (key->value.size == 0)
        return;
    entry = dcf_slice_decimal(key->name, 254, &sub) ? find_entry(self, section->index, sub) : NULL;
    if (!entry) {
        dcf_tell(self->report, DCF_RULE_COMPACT_KEY, key->line,
                 "[%s]: a sub-index of %04Xh in decimal expected, there is \"%s\": ignored",
                 dcf_show(section->name).text, section->index, dcf_show(key->name).text);
        return;
    }
    if (section->kind == DCF_SECTION_VALUE) {
        dcf_key_value(self, section, key, entry->type, dcf_entry_downloads(entry),
                      &entry->parameter);
    } else {
        dcf_text_of_key(self, key,
                        section->kind == DCF_SECTION_NAME ? &entry->name : &entry->denotation);
    }
}

static void apply_section(struct dcf_builder *self, struct dcf_section *section)
{
    uint32_t announced = dcf_key_number(self, section, "NrOfEntries", UINT8_MAX, 0);
    size_t count = 0;

    for (size_t i = 0; i < section->count; i++) {
        if (dcf_slice_is(section->keys[i].name, "NrOfEntries"))
            continue;
        apply_key(self, section, &section->keys[i]);
        count++;
    }
    if (count != announced)
        dcf_tell(self->report, DCF_RULE_COMPACT_COUNT, section->line,
                 "[%s] NrOfEntries: %zu expected (so many are there), it is %lu",
                 dcf_show(section->name).text, count, (unsigned long)announced);
}

void dcf_apply_compact_lists(struct dcf_builder *self)
{
    struct dcf_text *text = &self->text;

    for (size_t i = 0; i < text->section_count && !self->no_memory; i++) {
        enum dcf_section_kind kind = text->sections[i].kind;

        if (kind == DCF_SECTION_NAME || kind == DCF_SECTION_VALUE || kind == DCF_SECTION_DENOTATION)
            apply_section(self, &text->sections[i]);
    }
}

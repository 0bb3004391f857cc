/* One PDO: switched off, its parameters, its mapping, switched on. */
#include "dcf/dcf_maker.h"

#define COB_INVALID    0x80000000u
#define MAPPING_OFFSET 0x200u
#define MAPPED_MAX     64u /* more in sub-index 0 tells a kind of MPDO */

#define SUB_RESERVED 4u

bool dcf_is_pdo(uint16_t index)
{
    return index >= 0x1400 && index <= 0x1BFF;
}

static bool is_written(const struct dcf_maker *self, uint16_t index, unsigned first)
{
    size_t count;
    const struct dcf_entry *entries = dcf_object(self->dcf, index, &count);

    for (size_t i = 0; i < count; i++) {
        if (entries[i].sub >= first && dcf_maker_writes(self, &entries[i]))
            return true;
    }
    return false;
}

/* The COB-ID that the PDO is to have; false where the PDO cannot be switched off and on. */
static bool find_cob_id(const struct dcf_maker *self, const struct dcf_entry *entry,
                        uint32_t *ret_cob_id)
{
    const struct dcf_value *value;

    if (!entry || !dcf_entry_downloads(entry) || entry->type != OD_UNSIGNED32)
        return false;
    value = entry->parameter.given ? &entry->parameter : &entry->initial;
    if (!value->given || (value->has_node_id && self->options->node_id == 0))
        return false;
    *ret_cob_id = (uint32_t)dcf_value_number(value, entry->type, self->options->node_id);
    return true;
}

static uint64_t mapped_object(const struct dcf_maker *self, uint16_t index, unsigned sub)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, (uint8_t)sub);

    if (!entry)
        return 0;
    if (entry->parameter.given)
        return dcf_value_number(&entry->parameter, entry->type, self->options->node_id);
    return entry->initial.given
               ? dcf_value_number(&entry->initial, entry->type, self->options->node_id)
               : 0;
}

/* Where the file does not tell the number of mapped objects: up to the last one it gives. */
static unsigned guess_count(const struct dcf_maker *self, uint16_t index)
{
    const struct dcf_entry *count = dcf_find(self->dcf, index, 0);
    bool told = count && count->initial.given;
    unsigned last = told ? count->initial.bytes[0] : 0;
    unsigned mapped = 0;

    for (unsigned sub = 1; sub <= MAPPED_MAX; sub++) {
        const struct dcf_entry *entry = dcf_maker_find(self, index, (uint8_t)sub);

        if (entry && (entry->parameter.given || !told) && sub > last)
            last = sub;
    }
    while (mapped < last && mapped_object(self, index, mapped + 1) != 0)
        mapped++;
    return mapped;
}

/* Of a compact object, whose values the file gives without that of sub-index 0. */
static bool is_compact(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    const struct dcf_entry *first = entry ? dcf_find(self->dcf, entry->index, 1) : NULL;

    return first && first->line == entry->line;
}

static bool has_parameters(const struct dcf_maker *self, uint16_t index)
{
    size_t count;
    const struct dcf_entry *entries = dcf_object(self->dcf, index, &count);

    for (size_t i = 0; i < count; i++) {
        if (entries[i].parameter.given)
            return true;
    }
    return false;
}

static unsigned find_count(const struct dcf_maker *self, uint16_t index)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, 0);
    unsigned count;

    if (entry && entry->parameter.given)
        return entry->parameter.bytes[0];
    if (entry && entry->initial.given && !has_parameters(self, index))
        return entry->initial.bytes[0];
    count = guess_count(self, index);
    if (!is_compact(self, entry))
        dcf_tell(self->report, DCF_RULE_MAPPED_COUNT, entry ? entry->line : 0,
                 "%04Xh:00 ParameterValue: the number of mapped objects expected, it is missing: "
                 "taken as %u",
                 index, count);
    return count;
}

static void put_mapped(struct dcf_maker *self, uint16_t index, unsigned mapped)
{
    unsigned last = mapped > MAPPED_MAX ? 0xFF : mapped;
    size_t count;
    const struct dcf_entry *entries = dcf_object(self->dcf, index, &count);

    for (size_t i = 0; i < count; i++) {
        const struct dcf_entry *entry = &entries[i];

        if (entry->sub == 0 || !dcf_maker_writes(self, entry))
            continue;
        if (entry->sub <= last)
            dcf_maker_put(self, entry);
        else if (entry->parameter.given && mapped_object(self, index, entry->sub) != 0)
            dcf_tell(self->report, DCF_RULE_MAPPED_BEYOND, entry->parameter.line,
                     "%04Xh:%02X: at most %u mapped objects expected (sub-index 0), this is "
                     "one more: not written",
                     index, entry->sub, mapped);
    }
}

static void put_mapping(struct dcf_maker *self, uint16_t index)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, 0);
    bool counted = entry && dcf_entry_downloads(entry);
    unsigned count;

    if (!is_written(self, index, 0))
        return;
    count = find_count(self, index);
    if (counted)
        dcf_maker_put_number(self, entry, self->options->old_style ? count : 0);
    put_mapped(self, index, count);
    if (counted && !self->options->old_style && count > 0)
        dcf_maker_put_number(self, entry, count);
}

static void put_parameters(struct dcf_maker *self, uint16_t index)
{
    size_t count;
    const struct dcf_entry *entries = dcf_object(self->dcf, index, &count);

    for (size_t i = 0; i < count; i++) {
        const struct dcf_entry *entry = &entries[i];

        if (entry->sub < 2 || !dcf_maker_writes(self, entry))
            continue;
        if (entry->sub != SUB_RESERVED)
            dcf_maker_put(self, entry);
        else if (entry->parameter.given)
            dcf_tell(self->report, DCF_RULE_PDO_RESERVED_SUB, entry->parameter.line,
                     "%04Xh:%02X ParameterValue: none expected, the sub-index is reserved: "
                     "not written",
                     index, entry->sub);
    }
}

void dcf_maker_put_pdo(struct dcf_maker *self, uint16_t communication)
{
    uint16_t mapping = (uint16_t)(communication + MAPPING_OFFSET);
    const struct dcf_entry *entry = dcf_find(self->dcf, communication, 1);
    uint32_t cob_id = 0;
    bool switched;

    if (!is_written(self, communication, 1) && !is_written(self, mapping, 0))
        return;
    switched = find_cob_id(self, entry, &cob_id);
    if (switched)
        dcf_maker_put_number(self, entry, cob_id | COB_INVALID);
    else
        dcf_tell(self->report, DCF_RULE_PDO_COB_ID, entry ? entry->line : 0,
                 "%04Xh:01: a writable COB-ID with a value expected, there is none: the PDO "
                 "is configured without switching it off",
                 communication);
    put_parameters(self, communication);
    put_mapping(self, mapping);
    if (switched && !(cob_id & COB_INVALID))
        dcf_maker_put_number(self, entry, cob_id);
}

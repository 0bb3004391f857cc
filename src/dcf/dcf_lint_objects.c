/* Sub-indices of an object against each other. */
#include "dcf/dcf_lint_parts.h"

#define FIRST_OWN     0x2000u
#define ERROR_FIELD   0x1003u
#define STRUCTURE_SUB 0xFFu

const struct dcf_entry *dcf_lint_sub(const struct dcf_lint_object *object, unsigned sub)
{
    for (size_t i = 0; i < object->count && object->entries[i].sub <= sub; i++) {
        if (object->entries[i].sub == sub)
            return &object->entries[i];
    }
    return NULL;
}

static unsigned highest_sub(const struct dcf_lint_object *object)
{
    size_t last = object->count - 1;

    if (last > 0 && object->entries[last].sub == STRUCTURE_SUB)
        last--;
    return object->entries[last].sub;
}

static bool has_subs(const struct dcf_lint_object *object)
{
    return object->count > 1 && object->entries[0].sub == 0 &&
           object->entries[0].type == OD_UNSIGNED8;
}

/* One that can be written tells how many are in use. */
static bool counts_used(const struct dcf_entry *first, unsigned highest)
{
    return dcf_lint_is_writable(first) && first->initial.bytes[0] < highest;
}

/* What a mapping has in sub-index 0 is how much of it is used; all of one that is fixed. */
static bool is_part_used(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    const struct dcf_entry *entries = object->entries;
    bool fixed = self->dcf->granularity_line != 0 && self->dcf->granularity == 0 &&
                 !dcf_lint_is_writable(&entries[0]) && !dcf_lint_is_writable(&entries[1]);

    return dcf_lint_is_mapping(entries->index) && !fixed;
}

static void check_highest_sub(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    const struct dcf_entry *first = object->entries;
    bool errors = first->index == ERROR_FIELD;
    unsigned expected = errors ? 0 : highest_sub(object);

    if (is_part_used(self, object))
        return;
    if (!first->initial.given) {
        if (!errors)
            dcf_tell(self->report, DCF_RULE_SUB_0_DEFAULT_MISSING, first->line,
                     "%04Xh:00 DefaultValue: %u expected (the highest sub-index), it is missing",
                     first->index, expected);
    } else if (first->initial.bytes[0] != expected && !counts_used(first, expected)) {
        dcf_tell(self->report, DCF_RULE_SUB_0_DEFAULT, first->initial.line,
                 "%04Xh:00 DefaultValue: %u expected (%s), there is %u", first->index, expected,
                 errors ? "no errors" : "the highest sub-index", first->initial.bytes[0]);
    }
}

/*
 * Once for an object: an array of 254 of another type is one fault. What CiA 301 and 302 describe
 * is compared with that: a record that is called an array has other types by right.
 */
static void check_array(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    const struct dcf_entry *entries = object->entries;

    if (entries[0].object_type != OBJECT_ARRAY || entries[0].index < FIRST_OWN)
        return;
    for (size_t i = 2; i < object->count && entries[i].sub != STRUCTURE_SUB; i++) {
        if (entries[i].type == entries[1].type)
            continue;
        dcf_tell(self->report, DCF_RULE_ARRAY_TYPES, entries[i].line,
                 "%04Xh:%02X: %s expected like the others of the ARRAY, there is %s",
                 entries[i].index, entries[i].sub, od_type_name(entries[1].type),
                 od_type_name(entries[i].type));
        return;
    }
}

static bool is_number(uint8_t type)
{
    return od_type_size(type) != 0;
}

/* Once for an object, as above. */
static void check_mappable(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    for (size_t i = 0; i < object->count; i++) {
        const struct dcf_entry *entry = &object->entries[i];

        if (!entry->mappable || entry->type == 0 || is_number(entry->type))
            continue;
        dcf_tell(self->report, DCF_RULE_MAPPABLE_TYPE, entry->line,
                 "%04Xh:%02X PDOMapping: 0 expected for %s, there is 1", entry->index, entry->sub,
                 od_type_name(entry->type));
        return;
    }
}

/* The last node-ID stands for all, where the file leaves it open. */
static void check_formula(const struct dcf_lint *self, const struct dcf_entry *entry,
                          const struct dcf_value *value)
{
    uint8_t node_id = self->dcf->has_node_id ? self->node_id : 127;

    if (!dcf_formula_fits(value, node_id))
        dcf_tell(self->report, DCF_RULE_FORMULA_RANGE, value->line,
                 "%04Xh:%02X: a value of %s expected, with node-ID %u this is too large",
                 entry->index, entry->sub, od_type_name(entry->type), node_id);
}

void dcf_lint_object(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    for (size_t i = 0; i < object->count; i++) {
        check_formula(self, &object->entries[i], &object->entries[i].initial);
        check_formula(self, &object->entries[i], &object->entries[i].parameter);
    }
    check_mappable(self, object);
    if (!has_subs(object))
        return;
    check_highest_sub(self, object);
    check_array(self, object);
}

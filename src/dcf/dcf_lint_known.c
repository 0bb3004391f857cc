/* Objects that CiA 301 and 302 describe: their object type, data type and access. */
#include "dcf/dcf_lint_parts.h"

#define DOMAIN_OBJECT 2u
#define VAR           7u
#define ARRAY         8u
#define RECORD        9u

#define STRUCTURE_SUB 0xFFu

/* Sub-indices of an ARRAY behind 0 have the type; those of a RECORD are below. */
static const struct known {
    uint16_t first, last;
    uint8_t object_type;
    uint8_t type;
    bool read_only;
} known[] = {
    { 0x1000, 0x1000, VAR, OD_UNSIGNED32, true },
    { 0x1001, 0x1001, VAR, OD_UNSIGNED8, true },
    { 0x1002, 0x1002, VAR, OD_UNSIGNED32, true },
    { 0x1003, 0x1003, ARRAY, OD_UNSIGNED32, true },
    { 0x1005, 0x1007, VAR, OD_UNSIGNED32, false },
    { 0x1008, 0x100A, VAR, OD_VISIBLE_STRING, true },
    { 0x100C, 0x100C, VAR, OD_UNSIGNED16, false },
    { 0x100D, 0x100D, VAR, OD_UNSIGNED8, false },
    { 0x1010, 0x1011, ARRAY, OD_UNSIGNED32, false },
    { 0x1012, 0x1014, VAR, OD_UNSIGNED32, false },
    { 0x1015, 0x1015, VAR, OD_UNSIGNED16, false },
    { 0x1016, 0x1016, ARRAY, OD_UNSIGNED32, false },
    { 0x1017, 0x1017, VAR, OD_UNSIGNED16, false },
    { 0x1018, 0x1018, RECORD, 0, true },
    { 0x1019, 0x1019, VAR, OD_UNSIGNED8, false },
    { 0x1020, 0x1020, ARRAY, OD_UNSIGNED32, false },
    { 0x1021, 0x1021, DOMAIN_OBJECT, OD_DOMAIN, true },
    { 0x1022, 0x1022, VAR, OD_UNSIGNED8, true },
    { 0x1023, 0x1023, RECORD, 0, false },
    { 0x1024, 0x1024, VAR, OD_UNSIGNED8, false },
    { 0x1025, 0x1025, RECORD, 0, false },
    { 0x1026, 0x1026, ARRAY, OD_UNSIGNED8, false },
    { 0x1027, 0x1027, ARRAY, OD_UNSIGNED16, true },
    { 0x1028, 0x1028, ARRAY, OD_UNSIGNED32, false },
    { 0x1029, 0x1029, ARRAY, OD_UNSIGNED8, false },
    { 0x102A, 0x102A, VAR, OD_UNSIGNED16, false },
    { 0x1200, 0x1200, RECORD, 0, true },
    { 0x1201, 0x12FF, RECORD, 0, false },
    { 0x1400, 0x1BFF, RECORD, 0, false },
    { 0x1F20, 0x1F20, ARRAY, OD_DOMAIN, false },
    { 0x1F21, 0x1F21, ARRAY, OD_UNSIGNED8, false },
    { 0x1F22, 0x1F22, ARRAY, OD_DOMAIN, false },
    { 0x1F25, 0x1F27, ARRAY, OD_UNSIGNED32, false },
    { 0x1F50, 0x1F50, ARRAY, OD_DOMAIN, false },
    { 0x1F51, 0x1F51, ARRAY, OD_UNSIGNED8, false },
    { 0x1F52, 0x1F57, ARRAY, OD_UNSIGNED32, false },
    { 0x1F58, 0x1F58, ARRAY, OD_DOMAIN, false },
    { 0x1F80, 0x1F80, VAR, OD_UNSIGNED32, false },
    { 0x1F81, 0x1F81, ARRAY, OD_UNSIGNED32, false },
    { 0x1F82, 0x1F83, ARRAY, OD_UNSIGNED8, false },
    { 0x1F84, 0x1F88, ARRAY, OD_UNSIGNED32, false },
    { 0x1F89, 0x1F89, VAR, OD_UNSIGNED32, false },
    { 0x1F8A, 0x1F8A, ARRAY, OD_UNSIGNED8, false },
    { 0x1F91, 0x1F91, ARRAY, OD_UNSIGNED16, false },
    { 0x1FA0, 0x1FCF, ARRAY, OD_UNSIGNED32, false },
    { 0x1FD0, 0x1FFF, ARRAY, OD_UNSIGNED64, false },
};

static const struct part { /* of records */
    uint16_t first, last;
    uint8_t first_sub, last_sub;
    uint8_t type;
    bool mandatory; /* the first sub-index */
} parts[] = {
    { 0x1018, 0x1018, 1, 4, OD_UNSIGNED32, true },   { 0x1200, 0x12FF, 1, 1, OD_UNSIGNED32, true },
    { 0x1200, 0x12FF, 2, 2, OD_UNSIGNED32, true },   { 0x1200, 0x12FF, 3, 3, OD_UNSIGNED8, false },
    { 0x1400, 0x15FF, 1, 1, OD_UNSIGNED32, true },   { 0x1400, 0x15FF, 2, 2, OD_UNSIGNED8, true },
    { 0x1400, 0x15FF, 3, 3, OD_UNSIGNED16, false },  { 0x1400, 0x15FF, 5, 5, OD_UNSIGNED16, false },
    { 0x1600, 0x17FF, 1, 64, OD_UNSIGNED32, false }, { 0x1800, 0x19FF, 1, 1, OD_UNSIGNED32, true },
    { 0x1800, 0x19FF, 2, 2, OD_UNSIGNED8, true },    { 0x1800, 0x19FF, 3, 3, OD_UNSIGNED16, false },
    { 0x1800, 0x19FF, 5, 5, OD_UNSIGNED16, false },  { 0x1800, 0x19FF, 6, 6, OD_UNSIGNED8, false },
    { 0x1A00, 0x1BFF, 1, 64, OD_UNSIGNED32, false },
};

static const struct known *find_known(uint16_t index)
{
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (index >= known[i].first && index <= known[i].last)
            return &known[i];
    }
    return NULL;
}

static const char *standard_of(uint16_t index)
{
    return index < 0x1F00 ? "CiA 301" : "CiA 302";
}

static const char *object_type_name(uint8_t type)
{
    switch (type) {
    case DOMAIN_OBJECT: return "2 (DOMAIN)";
    case VAR: return "7 (VAR)";
    case ARRAY: return "8 (ARRAY)";
    case RECORD: return "9 (RECORD)";
    default: return "another";
    }
}

static bool is_as_good(const struct dcf_entry *first, const struct known *should)
{
    if (should->object_type == DOMAIN_OBJECT) /* a VAR of that type */
        return first->object_type == VAR;
    return dcf_lint_is_mapping(first->index) && first->object_type == ARRAY; /* of one type */
}

static void check_object_type(const struct dcf_lint *self, const struct dcf_entry *first,
                              const struct known *should)
{
    if (first->sub != 0 || first->object_type == should->object_type || is_as_good(first, should))
        return;
    dcf_tell(self->report, DCF_RULE_KNOWN_OBJECT_TYPE, first->line,
             "%04Xh ObjectType: %s expected (%s), there is %s", first->index,
             object_type_name(should->object_type), standard_of(first->index),
             object_type_name(first->object_type));
}

/* Once for the sub-indices from .. to: what is wrong with one of an array is so with all. */
static void check_types(const struct dcf_lint *self, const struct dcf_lint_object *object,
                        unsigned from, unsigned to, uint8_t type)
{
    for (size_t i = 0; i < object->count; i++) {
        const struct dcf_entry *entry = &object->entries[i];

        if (entry->sub < from || entry->sub > to || entry->type == type || entry->type == 0)
            continue;
        dcf_tell(self->report, DCF_RULE_KNOWN_DATA_TYPE, entry->line,
                 "%04Xh:%02X DataType: %s expected (%s), there is %s", entry->index, entry->sub,
                 od_type_name(type), standard_of(entry->index), od_type_name(entry->type));
        return;
    }
}

static void check_access(const struct dcf_lint *self, const struct dcf_lint_object *object,
                         unsigned from)
{
    for (size_t i = 0; i < object->count; i++) {
        const struct dcf_entry *entry = &object->entries[i];

        if (entry->sub < from || !dcf_lint_is_writable(entry))
            continue;
        dcf_tell(self->report, DCF_RULE_KNOWN_ACCESS, entry->line,
                 "%04Xh:%02X AccessType: ro or const expected (%s), there is %s", entry->index,
                 entry->sub, standard_of(entry->index), dcf_access_text(entry->access));
        return;
    }
}

static void check_part(const struct dcf_lint *self, const struct dcf_lint_object *object,
                       const struct part *part)
{
    if (part->mandatory && !dcf_lint_sub(object, part->first_sub))
        dcf_tell(self->report, DCF_RULE_KNOWN_SUB, object->entries->line,
                 "%04Xh: a sub-index %u expected (%s), it is missing", object->entries->index,
                 part->first_sub, standard_of(object->entries->index));
    check_types(self, object, part->first_sub, part->last_sub, part->type);
}

static void check_parts(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    uint16_t index = object->entries->index;

    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (index >= parts[i].first && index <= parts[i].last)
            check_part(self, object, &parts[i]);
    }
}

void dcf_lint_known(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    const struct known *should = find_known(object->entries->index);
    bool single = object->count == 1 && object->entries->sub == 0;

    if (!should)
        return;
    check_object_type(self, object->entries, should);
    if (should->object_type == RECORD)
        check_parts(self, object);
    else
        check_types(self, object, single ? 0 : 1, STRUCTURE_SUB - 1, should->type);
    if (should->read_only)
        check_access(self, object, single ? 0 : 1);
}

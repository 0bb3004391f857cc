/* Object sections as entries: variables, and arrays and records with their sub-indices. */
#include "dcf/dcf_build.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COMPACT_MAX   254u
#define STRUCTURE_SUB 0xFFu /* the object's own description: not counted by SubNumber */

struct group {                  /* the sections of one object */
    struct dcf_section *object; /* NULL: missing */
    struct dcf_section *subs;
    size_t sub_count;
    uint8_t object_type;
};

struct dcf_entry *dcf_build_entry(struct dcf_builder *self, uint16_t index, uint8_t sub)
{
    struct dcf *dcf = self->dcf;
    struct dcf_entry *entries;
    size_t room = dcf->room ? dcf->room + dcf->room / 4 : self->text.section_count + 64;

    if (dcf->count == DCF_ENTRIES_MAX) {
        if (!self->no_memory)
            dcf_tell(self->report, DCF_RULE_ENTRY_LIMIT, 0,
                     "at most %u entries expected, there are more", DCF_ENTRIES_MAX);
        self->no_memory = true;
        return NULL;
    }
    if (dcf->count == dcf->room) {
        entries = realloc(dcf->entries, room * sizeof *entries);
        if (!entries) {
            self->no_memory = true;
            return NULL;
        }
        dcf->entries = entries;
        dcf->room = room;
    }
    dcf->entries[dcf->count] = (struct dcf_entry){ .index = index,
                                                   .sub = sub,
                                                   .object_type = OBJECT_VAR };
    return &dcf->entries[dcf->count++];
}

static int compare_entries(const void *left, const void *right)
{
    const struct dcf_entry *a = left, *b = right;

    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return (a->sub > b->sub) - (a->sub < b->sub);
}

void dcf_sort_entries(struct dcf_builder *self)
{
    struct dcf *dcf = self->dcf;

    if (dcf->count > 0)
        qsort(dcf->entries, dcf->count, sizeof *dcf->entries, compare_entries);
}

static bool has_subs(uint8_t object_type)
{
    return object_type == OBJECT_ARRAY || object_type == OBJECT_RECORD ||
           object_type == OBJECT_DEFSTRUCT;
}

static bool is_single(uint8_t object_type)
{
    return object_type == OBJECT_VAR || object_type == OBJECT_DOMAIN ||
           object_type == OBJECT_DEFTYPE;
}

static uint8_t read_object_type(struct dcf_builder *self, const struct group *group)
{
    struct dcf_section *section = group->object;
    uint8_t type = dcf_read_object_type(self, section);
    uint8_t meant = group->sub_count > 0 ? OBJECT_RECORD : OBJECT_VAR;

    if (has_subs(type) || (is_single(type) && group->sub_count == 0))
        return type;
    dcf_tell(self->report, DCF_RULE_OBJECT_TYPE, section->line,
             "[%s] ObjectType: %s expected, there is %u: taken as %u", dcf_show(section->name).text,
             group->sub_count > 0 ? "8 or 9 (there are sub-indices)" : "2, 5, 6, 7, 8 or 9", type,
             meant);
    return meant;
}

#define NOT_TOLD UINT32_MAX

/* SubNumber against the sections that there are. */
static void check_count(struct dcf_builder *self, struct dcf_section *object, size_t count)
{
    const struct dcf_key *key = dcf_section_find(object, "SubNumber");
    uint32_t announced = dcf_number_of_key(self, object, key, UINT8_MAX, NOT_TOLD);

    if (!key && count > 0)
        dcf_tell(self->report, DCF_RULE_SUB_COUNT, object->line,
                 "[%s] SubNumber: %zu expected (so many sub-index sections are there), it is "
                 "missing",
                 dcf_show(object->name).text, count);
    else if (announced != count && announced != NOT_TOLD)
        dcf_tell(self->report, DCF_RULE_SUB_COUNT, object->line,
                 "[%s] SubNumber: %zu expected (so many sub-index sections are there), it is "
                 "%lu",
                 dcf_show(object->name).text, count, (unsigned long)announced);
}

/* 0 says of these keywords that there is nothing. */
static bool may_be_zero(const char *name)
{
    return strcmp(name, "PDOMapping") == 0 || strcmp(name, "SubNumber") == 0 ||
           strcmp(name, "CompactSubObj") == 0;
}

/* Tells which of the keywords are there, in one message. */
static void tell_not_allowed(struct dcf_builder *self, struct dcf_section *section,
                             const char *const *names, size_t count)
{
    const struct dcf_key *first = NULL;
    char text[200] = "";
    size_t used = 0;

    for (size_t i = 0; i < count; i++) {
        const struct dcf_key *key = dcf_section_find(section, names[i]);
        struct dcf_number number;

        if (!key || (may_be_zero(names[i]) && dcf_number_parse(key->value, &number) &&
                     number.magnitude == 0 && !number.has_node_id))
            continue;
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used ? ", " : "",
                                 names[i]);
        if (!first || key->line < first->line)
            first = key;
    }
    if (first)
        dcf_tell(self->report, DCF_RULE_KEY_NOT_ALLOWED, first->line,
                 "[%s]: %s not expected with this ObjectType: ignored",
                 dcf_show(section->name).text, text);
}

static void build_single(struct dcf_builder *self, struct group *group)
{
    static const char *const not_allowed[] = { "SubNumber", "CompactSubObj", "PDOMapping",
                                               "LowLimit", "HighLimit" };
    struct dcf_entry *entry = dcf_build_entry(self, group->object->index, 0);

    if (!entry)
        return;
    entry->object_type = group->object_type;
    dcf_fill_entry(self, group->object, entry);
    tell_not_allowed(self, group->object, not_allowed, entry->object_type == OBJECT_DOMAIN ? 5 : 2);
}

static void build_sub(struct dcf_builder *self, const struct group *group,
                      struct dcf_section *section)
{
    struct dcf_entry *entry = dcf_build_entry(self, section->index, section->sub);

    if (!entry)
        return;
    entry->object_type = dcf_read_object_type(self, section);
    dcf_fill_entry(self, section, entry);
    if (!is_single(entry->object_type))
        dcf_tell(self->report, DCF_RULE_SUB_OBJECT_TYPE, section->line,
                 "[%s] ObjectType: 7 (VAR) expected for a sub-index, there is %u",
                 dcf_show(section->name).text, entry->object_type);
    if (section->sub == 0) {
        if (entry->type != OD_UNSIGNED8)
            dcf_tell(self->report, DCF_RULE_SUB_0_TYPE, section->line,
                     "[%s] DataType: UNSIGNED8 expected for sub-index 0, there is %s",
                     dcf_show(section->name).text, od_type_name(entry->type));
        entry->object_type = group->object_type;
    }
    dcf_tell_unused(self, section);
}

/* "2000" or "M1Fixed2000" */
static struct dcf_shown object_name(const struct dcf_section *section)
{
    struct dcf_shown name;

    if (section->part > 0)
        snprintf(name.text, sizeof name.text, "M%uFixed%04X", section->part, section->index);
    else
        snprintf(name.text, sizeof name.text, "%04X", section->index);
    return name;
}

/* Behind sub9 comes subA; who goes on with sub10 counts in decimal. */
static void check_digits(struct dcf_builder *self, const struct group *group)
{
    for (size_t i = 1; i < group->sub_count; i++) {
        const struct dcf_section *sub = &group->subs[i];

        if (sub->sub == 0x10 && sub[-1].sub == 9)
            dcf_tell(
                self->report, DCF_RULE_SECTION_NAME, sub->line,
                "[%s]: [%ssubA] expected behind [%s], sub-indices are hexadecimal: taken as 16",
                dcf_show(sub->name).text, object_name(sub).text, dcf_show(sub[-1].name).text);
    }
}

static void check_subs(struct dcf_builder *self, const struct group *group)
{
    struct dcf_section *object = group->object;
    size_t count = group->sub_count;

    if (count > 0 && group->subs[count - 1].sub == STRUCTURE_SUB)
        count--;
    if (count == 0) {
        dcf_section_find(object, "SubNumber");
        dcf_tell(self->report, DCF_RULE_SUBS_MISSING, object->line,
                 "[%s]: sections for its sub-indices expected, there are none: nothing of it is "
                 "used",
                 dcf_show(object->name).text);
        return;
    }
    check_count(self, object, count);
    check_digits(self, group);
    if (group->subs[0].sub != 0)
        dcf_tell(self->report, DCF_RULE_SUB_0_MISSING, object->line,
                 "[%s]: a section [%ssub0] expected, it is missing", dcf_show(object->name).text,
                 object_name(object).text);
}

static void build_structure(struct dcf_builder *self, struct group *group)
{
    static const char *const not_needed[] = { "ObjFlags", "Denotation", "ParamRefd" };
    static const char *const not_allowed[] = { "DataType",   "AccessType", "DefaultValue",
                                               "PDOMapping", "LowLimit",   "HighLimit" };

    dcf_use_keys(group->object, not_needed, sizeof not_needed / sizeof not_needed[0]);
    tell_not_allowed(self, group->object, not_allowed, sizeof not_allowed / sizeof not_allowed[0]);
    dcf_read_name(self, group->object, NULL);
    check_subs(self, group);
    for (size_t i = 0; i < group->sub_count; i++)
        build_sub(self, group, &group->subs[i]);
}

static void build_orphans(struct dcf_builder *self, struct group *group)
{
    dcf_tell(self->report, DCF_RULE_OBJECT_MISSING, group->subs[0].line,
             "[%s]: a section [%s] for its object expected, it is missing",
             dcf_show(group->subs[0].name).text, object_name(&group->subs[0]).text);
    group->object_type = OBJECT_RECORD;
    for (size_t i = 0; i < group->sub_count; i++)
        build_sub(self, group, &group->subs[i]);
}

static bool is_of_object(const struct dcf_text *text, size_t place)
{
    return place < text->section_count && text->sections[place].kind <= DCF_SECTION_LINKS;
}

/* 255 stands in files for "as many as there can be". */
static unsigned read_compact(struct dcf_builder *self, struct dcf_section *section)
{
    unsigned count = dcf_key_number(self, section, "CompactSubObj", UINT8_MAX, 0);

    if (count <= COMPACT_MAX)
        return count;
    dcf_tell(self->report, DCF_RULE_COMPACT_SIZE, section->line,
             "[%s] CompactSubObj: at most %u expected, there is %u: taken as %u",
             dcf_show(section->name).text, COMPACT_MAX, count, COMPACT_MAX);
    return COMPACT_MAX;
}

static void check_compact_type(struct dcf_builder *self, struct group *group)
{
    static const char *const not_allowed[] = { "SubNumber" };

    if (!has_subs(group->object_type))
        dcf_tell(self->report, DCF_RULE_OBJECT_TYPE, group->object->line,
                 "[%s] ObjectType: 8 or 9 expected with CompactSubObj, there is %u: taken as 8",
                 dcf_show(group->object->name).text, group->object_type);
    tell_not_allowed(self, group->object, not_allowed, 1);
}

static void build_group(struct dcf_builder *self, struct group *group)
{
    unsigned compact;

    if (!group->object) {
        if (group->sub_count > 0)
            build_orphans(self, group);
        return;
    }
    group->object_type = read_object_type(self, group);
    compact = read_compact(self, group->object);
    if (compact > 0 && group->sub_count == 0) {
        check_compact_type(self, group);
        dcf_build_compact(self, group->object, compact);
    } else if (has_subs(group->object_type)) {
        if (compact > 0)
            dcf_tell(self->report, DCF_RULE_COMPACT_AND_SUBS, group->object->line,
                     "[%s] CompactSubObj: 0 expected (there are sub-index sections), it is "
                     "%u: ignored",
                     dcf_show(group->object->name).text, compact);
        build_structure(self, group);
    } else {
        build_single(self, group);
    }
    dcf_section_find(group->object, "SubNumber");
    dcf_tell_unused(self, group->object);
}

/* Collects the sections of one object; the place of the next one. */
static size_t collect_group(struct dcf_text *text, size_t place, struct group *group)
{
    struct dcf_section *first = &text->sections[place], *section = first;
    const struct dcf_section *end = text->sections + text->section_count;

    *group = (struct group){ .sub_count = 0 };
    for (; section < end && section->index == first->index && section->part == first->part;
         section++) {
        if (section->kind == DCF_SECTION_OBJECT || section->kind == DCF_SECTION_FIXED)
            group->object = section;
        else if ((section->kind == DCF_SECTION_SUB || section->kind == DCF_SECTION_FIXED_SUB) &&
                 group->sub_count++ == 0)
            group->subs = section;
    }
    return (size_t)(section - text->sections);
}

size_t dcf_build_group(struct dcf_builder *self, size_t place)
{
    struct group group;

    place = collect_group(&self->text, place, &group);
    build_group(self, &group);
    return place;
}

void dcf_build_objects(struct dcf_builder *self)
{
    struct dcf_text *text = &self->text;
    size_t place = 0;

    while (place < text->section_count && text->sections[place].kind < DCF_SECTION_OBJECT)
        place++;
    while (is_of_object(text, place) && !self->no_memory)
        place = dcf_build_group(self, place);
}

void dcf_tell_no_names(struct dcf_builder *self)
{
    if (self->no_name > 0)
        dcf_tell(self->report, DCF_RULE_PARAMETER_NAME, self->no_name_line,
                 "ParameterName: a text expected, it is missing or empty (%u such sections)",
                 self->no_name);
}

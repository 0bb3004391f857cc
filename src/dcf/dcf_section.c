/* Knows the names of sections, sorts sections and keys, merges what comes twice. */
#include "dcf/dcf_lexer.h"

#include "dcf/dcf_rules.h"

#include <stdlib.h>

#define INDEX_DIGITS 4u
#define NO_ORDER     UINT64_MAX

static const struct {
    const char *name;
    enum dcf_section_kind kind;
} known[] = {
    { "FileInfo", DCF_SECTION_FILE_INFO },
    { "DeviceInfo", DCF_SECTION_DEVICE_INFO },
    { "DummyUsage", DCF_SECTION_DUMMY_USAGE },
    { "DeviceComissioning", DCF_SECTION_COMMISSIONING },
    { "DeviceCommissioning", DCF_SECTION_COMMISSIONING },
    { "MandatoryObjects", DCF_SECTION_MANDATORY },
    { "OptionalObjects", DCF_SECTION_OPTIONAL },
    { "ManufacturerObjects", DCF_SECTION_MANUFACTURER },
    { "SupportedModules", DCF_SECTION_SUPPORTED_MODULES },
    { "ConnectedModules", DCF_SECTION_CONNECTED_MODULES },
    { "Comments", DCF_SECTION_IGNORED },
    { "DynamicChannels", DCF_SECTION_IGNORED },
    { "Tools", DCF_SECTION_IGNORED },
};

static const struct {
    const char *suffix;
    enum dcf_section_kind kind;
} object_parts[] = {
    { "", DCF_SECTION_OBJECT },
    { "Name", DCF_SECTION_NAME },
    { "Value", DCF_SECTION_VALUE },
    { "Denotation", DCF_SECTION_DENOTATION },
    { "ObjectLinks", DCF_SECTION_IGNORED },
};

/* "sub1F", also "sub01" and "sub 1". */
static bool is_sub(struct dcf_slice rest, struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice digits;
    unsigned sub;

    if (!dcf_slice_begins(rest, "sub"))
        return false;
    digits = dcf_slice_trim(dcf_slice_skip(rest, 3));
    if (!dcf_slice_hex(digits, INDEX_DIGITS, &sub) || sub > 0xFF)
        return false;
    if (digits.size + 3 != rest.size || (digits.size > 1 && digits.text[0] == '0'))
        dcf_tell(report, DCF_RULE_SECTION_NAME, section->line,
                 "[%04Xsub%X] expected, there is [%s]", section->index, sub,
                 dcf_show(section->name).text);
    section->kind = DCF_SECTION_SUB;
    section->sub = (uint8_t)sub;
    return true;
}

/* A section whose name begins with an index. */
static bool is_object(struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice name = section->name;
    unsigned index;

    if (dcf_slice_begins(name, "0x"))
        name = dcf_slice_skip(name, 2);
    if (name.size < INDEX_DIGITS ||
        !dcf_slice_hex(dcf_slice_cut(name, INDEX_DIGITS), INDEX_DIGITS, &index))
        return false;
    section->index = (uint16_t)index;
    if (name.size != section->name.size)
        dcf_tell(report, DCF_RULE_SECTION_NAME, section->line, "[%04X...] expected, there is [%s]",
                 index, dcf_show(section->name).text);
    name = dcf_slice_trim(dcf_slice_skip(name, INDEX_DIGITS));
    for (size_t i = 0; i < sizeof object_parts / sizeof object_parts[0]; i++) {
        if (dcf_slice_is(name, object_parts[i].suffix)) {
            section->kind = object_parts[i].kind;
            return true;
        }
    }
    return is_sub(name, report, section);
}

/* "M1ModuleInfo", "M12Fixed6000sub1", "Tool1" */
static bool is_module_or_tool(struct dcf_slice name)
{
    bool module = dcf_slice_begins(name, "M");
    size_t skip = module ? 1 : dcf_slice_begins(name, "Tool") ? 4 : 0;
    size_t digits = skip;

    while (digits < name.size && name.text[digits] >= '0' && name.text[digits] <= '9')
        digits++;
    if (skip == 0 || digits == skip)
        return false;
    name = dcf_slice_skip(name, digits);
    if (!module)
        return name.size == 0;
    return dcf_slice_is(name, "ModuleInfo") || dcf_slice_is(name, "Comments") ||
           dcf_slice_begins(name, "Fixed") || dcf_slice_begins(name, "SubExt");
}

static void classify(struct dcf_section *section, struct co_report *report)
{
    section->kind = DCF_SECTION_UNKNOWN;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (dcf_slice_is(section->name, known[i].name)) {
            section->kind = known[i].kind;
            break;
        }
    }
    if (dcf_slice_is(section->name, "DeviceCommissioning"))
        dcf_tell(report, DCF_RULE_COMMISSIONING_NAME, section->line,
                 "[DeviceComissioning] expected (so the standard spells it), there is [%s]",
                 dcf_show(section->name).text);
    if (section->kind != DCF_SECTION_UNKNOWN || is_object(report, section))
        return;
    section->kind = DCF_SECTION_UNKNOWN;
    if (is_module_or_tool(section->name))
        section->kind = DCF_SECTION_IGNORED;
    else
        dcf_tell(report, DCF_RULE_UNKNOWN_SECTION, section->line,
                 "a section of CiA 306 expected, there is [%s]: ignored",
                 dcf_show(section->name).text);
}

/* Equal for sections that are the same one. */
static uint64_t order(const struct dcf_section *section)
{
    if (section->kind >= DCF_SECTION_IGNORED)
        return NO_ORDER;
    if (section->kind < DCF_SECTION_OBJECT)
        return (uint64_t)section->kind;
    return (uint64_t)1 << 32 | (uint64_t)section->index << 16 | (uint64_t)section->kind << 8 |
           section->sub;
}

static int compare_sections(const void *left, const void *right)
{
    const struct dcf_section *a = left, *b = right;

    if (order(a) != order(b))
        return order(a) < order(b) ? -1 : 1;
    return (a->number > b->number) - (a->number < b->number);
}

static int compare_keys(const void *left, const void *right)
{
    const struct dcf_key *a = left, *b = right;
    int difference;

    if (a->section != b->section)
        return a->section < b->section ? -1 : 1;
    difference = dcf_slice_compare(a->name, b->name);
    return difference != 0 ? difference : (a->line > b->line) - (a->line < b->line);
}

/* Leaves one of sections that are the same; fills places[number] with where each went. */
static void merge_sections(struct dcf_text *self, struct co_report *report, uint32_t *places)
{
    size_t count = 0;

    for (size_t i = 0; i < self->section_count; i++) {
        struct dcf_section *section = &self->sections[i];
        struct dcf_section *last = count > 0 ? &self->sections[count - 1] : NULL;

        if (last && order(section) != NO_ORDER && order(last) == order(section)) {
            dcf_tell(report, DCF_RULE_DOUBLE_SECTION, section->line,
                     "[%s]: expected once, it is also in line %u: keys of both are taken, of "
                     "the same ones the later",
                     dcf_show(section->name).text, last->line);
            places[section->number] = (uint32_t)count - 1;
            last->line = section->line;
        } else {
            places[section->number] = (uint32_t)count;
            self->sections[count++] = *section;
        }
    }
    self->section_count = count;
}

static void tell_twice(const struct dcf_text *self, struct co_report *report,
                       const struct dcf_key *first, const struct dcf_key *again)
{
    const struct dcf_section *section = &self->sections[again->section];

    if (section->kind >= DCF_SECTION_IGNORED)
        return;
    dcf_tell(report, DCF_RULE_DOUBLE_KEY, again->line,
             "[%s] %s: expected once, it is also in line %u: \"%s\" counts, not \"%s\"",
             dcf_show(section->name).text, dcf_show(again->name).text, first->line,
             dcf_show(again->value).text, dcf_show(first->value).text);
}

static void merge_keys(struct dcf_text *self, struct co_report *report)
{
    size_t count = 0;

    for (size_t i = 0; i < self->key_count; i++) {
        struct dcf_key *key = &self->keys[i];
        struct dcf_key *last = count > 0 ? &self->keys[count - 1] : NULL;
        struct dcf_section *section = &self->sections[key->section];

        if (last && last->section == key->section &&
            dcf_slice_compare(last->name, key->name) == 0) {
            tell_twice(self, report, last, key);
            *last = *key;
            continue;
        }
        if (section->count++ == 0)
            section->keys = &self->keys[count];
        self->keys[count++] = *key;
    }
    self->key_count = count;
}

enum co_err dcf_text_sort(struct dcf_text *self, struct co_report *report)
{
    uint32_t *places = calloc(self->section_count, sizeof *places);

    if (!places)
        return CO_ERR_MEMORY;
    for (size_t i = 0; i < self->section_count; i++)
        classify(&self->sections[i], report);
    qsort(self->sections, self->section_count, sizeof *self->sections, compare_sections);
    merge_sections(self, report, places);
    for (size_t i = 0; i < self->key_count; i++)
        self->keys[i].section = places[self->keys[i].section];
    free(places);
    if (self->key_count > 0)
        qsort(self->keys, self->key_count, sizeof *self->keys, compare_keys);
    merge_keys(self, report);
    return CO_OK;
}

struct dcf_section *dcf_text_find(const struct dcf_text *self, enum dcf_section_kind kind)
{
    for (size_t i = 0; i < self->section_count; i++) {
        if (self->sections[i].kind == kind)
            return &self->sections[i];
        if (self->sections[i].kind > kind)
            break;
    }
    return NULL;
}

const struct dcf_key *dcf_section_find(struct dcf_section *self, const char *name)
{
    struct dcf_slice wanted = dcf_slice_of(name);
    size_t low = 0, high = self->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;
        struct dcf_key *key = &self->keys[middle];
        int difference = dcf_slice_compare(key->name, wanted);

        if (difference == 0) {
            key->used = true;
            return key->value.size > 0 ? key : NULL;
        }
        if (difference < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

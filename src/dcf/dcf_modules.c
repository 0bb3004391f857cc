#include "dcf/dcf_modules.h"

#include <stdlib.h>

#define MODULE_LIST     0x1027u
#define MODULES_ASSUMED 127u /* where the file does not tell their number */

bool dcf_module_is_used(const struct dcf_modules *self, uint16_t module)
{
    for (size_t i = 1; i <= DCF_SLOTS_MAX; i++) {
        if (self->slots[i] == module)
            return true;
    }
    return false;
}

/* --- [SupportedModules], [ConnectedModules] --- */

static void take_connected(void *context, const struct dcf_section *section,
                           const struct dcf_key *key, unsigned number)
{
    struct dcf_modules *self = context;
    struct co_report *report = self->builder->report;
    struct dcf_number module;
    bool is_module = dcf_number_parse(key->value, &module) && !module.has_node_id &&
                     !module.negative && !module.too_large && module.magnitude >= 1 &&
                     module.magnitude <= self->supported;

    if (!is_module) {
        dcf_tell(report, DCF_RULE_MODULE_NUMBER, key->line,
                 "[%s] %u: a module of 1..%lu expected, there is \"%s\"",
                 dcf_show(section->name).text, number, (unsigned long)self->supported,
                 dcf_show(key->value).text);
    } else if (number < 1 || number > DCF_SLOTS_MAX) {
        dcf_tell(report, DCF_RULE_MODULE_SLOT, key->line,
                 "[%s] %u: a slot of 1..%u expected (1027h has no more): ignored",
                 dcf_show(section->name).text, number, DCF_SLOTS_MAX);
    } else {
        self->slots[number] = (uint16_t)module.magnitude;
        self->is_any = true;
    }
}

static void read_connected(struct dcf_modules *self)
{
    static const struct dcf_numbered form = { .count_key = "NrOfEntries",
                                              .prefix = "",
                                              .rule = DCF_RULE_ENTRY_COUNT,
                                              .take = take_connected };
    struct dcf_builder *builder = self->builder;
    struct dcf_section *section = dcf_text_find(&builder->text, DCF_SECTION_CONNECTED_MODULES);

    if (!section)
        return;
    dcf_read_numbered(builder, section, &form, self);
    dcf_tell_unused(builder, section);
}

static void read_supported(struct dcf_modules *self)
{
    struct dcf_builder *builder = self->builder;
    struct dcf_section *section = dcf_text_find(&builder->text, DCF_SECTION_SUPPORTED_MODULES);

    self->supported = MODULES_ASSUMED;
    if (!section)
        return;
    self->supported = dcf_key_number(builder, section, "NrOfEntries", UINT16_MAX, 0);
    dcf_tell_unused(builder, section);
    if (self->supported > 0 && !dcf_has_object(builder->dcf, MODULE_LIST))
        dcf_tell(builder->report, DCF_RULE_MODULE_LIST, section->line,
                 "[%s]: an object %04Xh (the list of modules) expected, it is missing",
                 dcf_show(section->name).text, MODULE_LIST);
}

/* --- sections of a module --- */

/* The section of this kind and index, or NULL. */
static struct dcf_section *find_section(struct dcf_range range, enum dcf_section_kind kind,
                                        uint16_t index)
{
    uint32_t wanted = (uint32_t)index << 8 | (uint32_t)kind;

    while (range.first < range.end) {
        struct dcf_section *middle = range.first + (range.end - range.first) / 2;
        uint32_t found = (uint32_t)middle->index << 8 | (uint32_t)middle->kind;

        if (found == wanted)
            return middle;
        if (found < wanted)
            range.first = middle + 1;
        else
            range.end = middle;
    }
    return NULL;
}

struct lister {
    struct dcf_builder *builder;
    struct dcf_range range;
    enum dcf_section_kind kind; /* of what is listed */
};

static const char *part_name(enum dcf_section_kind kind)
{
    return kind == DCF_SECTION_FIXED ? "Fixed" : "SubExt";
}

static void take_listed(void *context, const struct dcf_section *section, const struct dcf_key *key,
                        unsigned number)
{
    struct lister *self = context;
    struct dcf_section *described;
    uint16_t index;

    (void)number;
    if (!dcf_key_index(self->builder, section, key, &index))
        return;
    described = find_section(self->range, self->kind, index);
    if (!described)
        dcf_tell(self->builder->report, DCF_RULE_LISTED_MISSING, key->line,
                 "[%s]: a section [M%u%s%04X] for this index expected, it is missing",
                 dcf_show(section->name).text, section->part, part_name(self->kind), index);
    else if (described->listed)
        dcf_tell(self->builder->report, DCF_RULE_LISTED_TWICE, key->line,
                 "[%s]: %04Xh expected once", dcf_show(section->name).text, index);
    if (described)
        described->listed = true;
}

/* The list of a module against what it lists. */
static void check_list(struct dcf_builder *self, struct dcf_range range, enum dcf_section_kind list,
                       enum dcf_section_kind kind)
{
    static const struct dcf_numbered form = {
        .count_key = "NrOfEntries", .prefix = "", .rule = DCF_RULE_ENTRY_COUNT, .take = take_listed
    };
    struct lister lister = { self, range, kind };
    struct dcf_section *section = find_section(range, list, 0);

    if (section) {
        dcf_read_numbered(self, section, &form, &lister);
        dcf_tell_unused(self, section);
    }
    for (section = range.first; section < range.end; section++) {
        if (section->kind == kind && !section->listed)
            dcf_tell(self->report, DCF_RULE_NOT_LISTED, section->line,
                     "[%s]: its index expected in [M%u%s], it is not there",
                     dcf_show(section->name).text, section->part,
                     kind == DCF_SECTION_FIXED ? "FixedObjects" : "SubExtends");
    }
}

static void check_info(struct dcf_builder *self, struct dcf_section *section)
{
    static const char *const demanded[] = { "ProductName", "OrderCode" };

    dcf_expect_keys(self, section, demanded, 2, false);
    dcf_key_number(self, section, "ProductVersion", UINT8_MAX, 0);
    dcf_key_number(self, section, "ProductRevision", UINT8_MAX, 0);
    dcf_tell_unused(self, section);
}

static void read_module(struct dcf_modules *self, struct dcf_range range)
{
    struct dcf_builder *builder = self->builder;
    struct dcf_section *comments = find_section(range, DCF_SECTION_MODULE_COMMENTS, 0);

    if (range.first->part > self->supported)
        dcf_tell(builder->report, DCF_RULE_MODULE_SECTION, range.first->line,
                 "[%s]: a module of 1..%lu expected", dcf_show(range.first->name).text,
                 (unsigned long)self->supported);
    if (range.first->kind == DCF_SECTION_MODULE_INFO)
        check_info(builder, range.first);
    else
        dcf_tell(builder->report, DCF_RULE_MODULE_SECTION, range.first->line,
                 "[%s]: a section [M%uModuleInfo] expected, it is missing",
                 dcf_show(range.first->name).text, range.first->part);
    if (comments)
        dcf_check_comments(builder, comments);
    check_list(builder, range, DCF_SECTION_FIXED_LIST, DCF_SECTION_FIXED);
    check_list(builder, range, DCF_SECTION_EXTENSION_LIST, DCF_SECTION_EXTENSION);
    dcf_module_build_fixed(self, range);
    dcf_module_read_extensions(self, range);
}

/* --- all modules --- */

static bool is_of_module(const struct dcf_section *section)
{
    return section->kind >= DCF_SECTION_MODULE_INFO && section->kind <= DCF_SECTION_EXTENSION;
}

/* The first of the supported modules that has no section, or 0. */
static void tell_missing(struct dcf_modules *self, uint32_t first_missing)
{
    const struct dcf_section *section = dcf_text_find(&self->builder->text,
                                                      DCF_SECTION_SUPPORTED_MODULES);

    if (section && first_missing <= self->supported)
        dcf_tell(self->builder->report, DCF_RULE_MODULE_SECTION, section->line,
                 "[%s]: a section [M%luModuleInfo] expected, it is missing",
                 dcf_show(section->name).text, (unsigned long)first_missing);
}

static void read_modules(struct dcf_modules *self)
{
    struct dcf_text *text = &self->builder->text;
    struct dcf_section *section = text->sections, *end = section + text->section_count;
    uint32_t expected = 1;

    while (section < end && !is_of_module(section))
        section++;
    while (section < end && is_of_module(section) && !self->builder->no_memory) {
        struct dcf_range range = { section, section };

        while (range.end < end && is_of_module(range.end) && range.end->part == section->part)
            range.end++;
        read_module(self, range);
        expected += section->part == expected;
        section = range.end;
    }
    tell_missing(self, expected);
}

/* Few devices have some: the others are spared the memory. */
static bool has_modules(const struct dcf_text *text)
{
    const struct dcf_section *last = text->sections + text->section_count - 1;

    while (last > text->sections && last->kind > DCF_SECTION_EXTENSION)
        last--;
    return is_of_module(last) || dcf_text_find(text, DCF_SECTION_SUPPORTED_MODULES) ||
           dcf_text_find(text, DCF_SECTION_CONNECTED_MODULES);
}

void dcf_build_modules(struct dcf_builder *self)
{
    struct dcf_modules modules = { .builder = self, .described = self->dcf->count };

    if (!has_modules(&self->text))
        return;
    read_supported(&modules);
    read_connected(&modules);
    modules.is_taken = calloc((size_t)UINT16_MAX + 1, sizeof *modules.is_taken);
    if (modules.is_taken)
        read_modules(&modules);
    else
        self->no_memory = true;
    if (modules.is_any && self->dcf->count > modules.described)
        dcf_sort_entries(self);
    if (modules.is_any && modules.count > 0)
        dcf_module_extend(&modules);
    free(modules.extensions);
    free(modules.is_taken);
}

#include "dcf/dcf_modules.h"

#include <stdlib.h>
#include <string.h>

#define INDEX_COUNT 65536u
#define SUB_MAX     254u

/* --- reading --- */

static bool parse_number(struct dcf_slice text, uint32_t most, uint32_t *ret_number)
{
    struct dcf_number number;

    if (!dcf_number_parse(text, &number) || number.has_node_id || number.negative ||
        number.too_large || number.magnitude > most)
        return false;
    *ret_number = (uint32_t)number.magnitude;
    return true;
}

/* "2": sub-indices, or "0;4": bits */
static bool parse_count(struct dcf_slice text, uint32_t *ret_count, uint32_t *ret_bits)
{
    const char *semicolon = memchr(text.text, ';', text.size);
    size_t size = semicolon ? (size_t)(semicolon - text.text) : text.size;
    uint32_t count, bits = 0;

    if (!parse_number(dcf_slice_cut(text, size), SUB_MAX, &count))
        return false;
    if (semicolon && (!parse_number(dcf_slice_skip(text, size + 1), UINT16_MAX, &bits) ||
                      bits == 0 || count > 0))
        return false;
    *ret_count = count;
    *ret_bits = bits;
    return true;
}

static void read_count(struct dcf_builder *self, struct dcf_section *section,
                       struct dcf_extension *extension)
{
    const struct dcf_key *key = dcf_section_find(section, "Count");

    extension->count = 1;
    if (key && parse_count(key->value, &extension->count, &extension->bits))
        return;
    dcf_tell(self->report, DCF_RULE_MODULE_COUNT, key ? key->line : section->line,
             "[%s] Count: a number of sub-indices, or 0 and a number of bits (\"0;4\") expected, "
             "%s%s: taken as 1",
             dcf_show(section->name).text, key ? "there is " : "it is missing",
             key ? dcf_show(key->value).text : "");
}

static struct dcf_extension *add_extension(struct dcf_modules *self)
{
    size_t room = self->room ? 2 * self->room : 16;
    struct dcf_extension *grown;

    if (self->count < self->room)
        return &self->extensions[self->count++];
    grown = realloc(self->extensions, room * sizeof *grown);
    if (!grown) {
        self->builder->no_memory = true;
        return NULL;
    }
    self->extensions = grown;
    self->room = room;
    return &self->extensions[self->count++];
}

static void read_extension(struct dcf_modules *self, struct dcf_section *section)
{
    struct dcf_builder *builder = self->builder;
    struct dcf_extension *extension = add_extension(self);

    if (!extension)
        return;
    *extension = (struct dcf_extension){ .module = section->part };
    extension->pattern.index = section->index;
    extension->pattern.object_type = dcf_read_object_type(builder, section);
    dcf_fill_entry(builder, section, &extension->pattern);
    read_count(builder, section, extension);
    extension->most = dcf_key_number(builder, section, "ObjExtend", SUB_MAX, 0);
    dcf_section_find(section, "SubNumber");
    dcf_section_find(section, "CompactSubObj");
    dcf_tell_unused(builder, section);
}

void dcf_module_read_extensions(struct dcf_modules *self, struct dcf_range range)
{
    for (; range.first < range.end && !self->builder->no_memory; range.first++) {
        if (range.first->kind == DCF_SECTION_EXTENSION)
            read_extension(self, range.first);
    }
}

/* --- adding --- */

struct chain {          /* an object, and those behind it that take up what has no room in it */
    uint32_t total;     /* sub-indices that the modules give */
    uint32_t bits_left; /* of the last sub-index */
    uint16_t index;     /* of the object that is being filled */
    bool is_begun;
    bool is_full;
    /* Of the object of this index, whichever chain fills it. */
    bool is_counted;
    bool is_touched;
    uint8_t highest; /* sub-index */
};

struct extender {
    struct dcf_modules *modules;
    struct chain *chains; /* by index */
    size_t described;
};

/* The number of sub-indices that one more module begins. */
static uint32_t new_subs(struct chain *chain, const struct dcf_extension *extension)
{
    uint32_t size = 8 * od_type_size(extension->pattern.type);
    uint32_t count, missing;

    if (extension->bits == 0) {
        chain->bits_left = 0;
        return extension->count;
    }
    if (extension->pattern.type == OD_BOOLEAN || size == 0)
        size = 1;
    missing = extension->bits > chain->bits_left ? extension->bits - chain->bits_left : 0;
    count = (missing + size - 1) / size;
    chain->bits_left += count * size - extension->bits;
    return count;
}

/* The number of sub-indices in the file. */
static uint32_t count_described(struct extender *self, uint16_t index)
{
    struct dcf file = { .entries = self->modules->builder->dcf->entries, .count = self->described };
    struct chain *chain = &self->chains[index];
    uint32_t found = 0;
    size_t count;
    const struct dcf_entry *entries = dcf_object(&file, index, &count);

    for (size_t i = 0; i < count; i++) {
        if (entries[i].sub == 0 || entries[i].sub > SUB_MAX)
            continue;
        found++;
        if (!chain->is_counted)
            chain->highest = entries[i].sub;
    }
    chain->is_counted = true;
    return found;
}

/* The highest sub-index that there is by now. */
static uint8_t *highest_of(struct extender *self, uint16_t index)
{
    if (!self->chains[index].is_counted)
        count_described(self, index);
    return &self->chains[index].highest;
}

static uint32_t limit_of(const struct dcf_extension *extension)
{
    return extension->most ? extension->most : SUB_MAX;
}

/* A file that has as many sub-indices as the modules give has them already. */
static void begin(struct extender *self, struct chain *chain, const struct dcf_extension *extension)
{
    uint32_t limit = limit_of(extension);
    uint32_t given = chain->total < limit ? chain->total : limit;

    chain->is_begun = true;
    chain->bits_left = 0;
    chain->index = extension->pattern.index;
    chain->is_full = count_described(self, chain->index) >= given;
}

static void add_sub_0(struct extender *self, uint16_t index)
{
    struct dcf_builder *builder = self->modules->builder;
    struct dcf file = { .entries = builder->dcf->entries, .count = self->described };
    struct dcf_entry *entry;

    if (dcf_find(&file, index, 0))
        return;
    entry = dcf_build_entry(builder, index, 0);
    if (!entry)
        return;
    entry->object_type = OBJECT_ARRAY;
    entry->type = OD_UNSIGNED8;
    entry->access = OD_RO;
    dcf_set_text(builder, &entry->name, "Highest sub-index supported");
    dcf_set_number(builder, &entry->initial, 1, 0);
}

static bool find_room(struct extender *self, struct chain *chain,
                      const struct dcf_extension *extension)
{
    while (*highest_of(self, chain->index) >= limit_of(extension)) {
        if (extension->most == 0 || chain->index == UINT16_MAX) {
            dcf_tell(self->modules->builder->report, DCF_RULE_MODULE_ROOM, extension->pattern.line,
                     "%04Xh: sub-indices up to %u expected, the connected modules give more: left "
                     "out",
                     chain->index, (unsigned)limit_of(extension));
            return false;
        }
        chain->index++;
    }
    return true;
}

static void add_sub(struct extender *self, struct chain *chain,
                    const struct dcf_extension *extension)
{
    struct dcf_entry pattern = extension->pattern;

    chain->is_full = !find_room(self, chain, extension);
    if (chain->is_full)
        return;
    pattern.index = chain->index;
    if (!self->chains[chain->index].is_touched)
        add_sub_0(self, chain->index);
    self->chains[chain->index].is_touched = true;
    *highest_of(self, chain->index) += 1;
    dcf_build_element(self->modules->builder, &pattern, *highest_of(self, chain->index));
}

static void count_extension(struct extender *self, const struct dcf_extension *extension)
{
    struct chain *chain = &self->chains[extension->pattern.index];

    chain->total += new_subs(chain, extension);
}

static void add_extension_of(struct extender *self, const struct dcf_extension *extension)
{
    struct chain *chain = &self->chains[extension->pattern.index];
    uint32_t count;

    if (!chain->is_begun)
        begin(self, chain, extension);
    count = new_subs(chain, extension);
    for (uint32_t i = 0; i < count && !chain->is_full && !self->modules->builder->no_memory; i++)
        add_sub(self, chain, extension);
}

static void for_each(struct extender *self,
                     void (*what)(struct extender *self, const struct dcf_extension *extension))
{
    const struct dcf_modules *modules = self->modules;

    for (size_t slot = 1; slot <= DCF_SLOTS_MAX; slot++) {
        for (size_t i = 0; i < modules->count && modules->slots[slot] != 0; i++) {
            if (modules->extensions[i].module == modules->slots[slot])
                what(self, &modules->extensions[i]);
        }
    }
}

/* Sub-index 0 tells the highest one, which is another one now. */
static void renew_highest(struct extender *self)
{
    struct dcf_builder *builder = self->modules->builder;
    struct dcf *dcf = builder->dcf;
    struct dcf_entry *first = NULL;

    for (size_t i = 0; i < dcf->count && !builder->no_memory; i++) {
        struct dcf_entry *entry = &dcf->entries[i];

        if (entry->sub == 0)
            first = entry;
        if (!first || first->index != entry->index || !self->chains[entry->index].is_touched ||
            first->type != OD_UNSIGNED8 || entry->sub > SUB_MAX)
            continue;
        if (!first->initial.given)
            dcf_set_number(builder, &first->initial, 1, entry->sub);
        else
            first->initial.bytes[0] = entry->sub;
        first->initial.has_node_id = false;
    }
}

void dcf_module_extend(struct dcf_modules *self)
{
    struct extender extender = { .modules = self, .described = self->builder->dcf->count };

    extender.chains = calloc(INDEX_COUNT, sizeof *extender.chains);
    if (!extender.chains) {
        self->builder->no_memory = true;
        return;
    }
    for_each(&extender, count_extension);
    for (uint32_t i = 0; i < INDEX_COUNT; i++)
        extender.chains[i].bits_left = 0;
    for_each(&extender, add_extension_of);
    dcf_sort_entries(self->builder);
    renew_highest(&extender);
    free(extender.chains);
}

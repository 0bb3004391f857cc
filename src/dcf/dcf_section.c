/* Sorts sections and keys, merges what comes twice. */
#include "dcf/dcf_lexer.h"

#include "dcf/dcf_rules.h"

#include <stdlib.h>
#include <string.h>

#define FEW_KEYS 32u
#define NO_ORDER UINT64_MAX

static uint64_t order_of(const struct dcf_section *section)
{
    uint64_t group = section->kind < DCF_SECTION_OBJECT        ? 0
                     : section->kind < DCF_SECTION_MODULE_INFO ? 1
                                                               : 2;

    if (section->kind == DCF_SECTION_UNKNOWN)
        return NO_ORDER;
    if (section->kind == DCF_SECTION_TOOL)
        group = 3;
    return group << 48 | (uint64_t)section->part << 32 | (uint64_t)section->index << 16 |
           (uint64_t)section->kind << 8 | section->sub;
}

/* Much is in its order as it comes. */
static void sort(void *items, size_t count, size_t size, int (*compare)(const void *, const void *))
{
    const char *item = items;

    for (size_t i = 1; i < count; i++, item += size) {
        if (compare(item, item + size) > 0) {
            qsort(items, count, size, compare);
            return;
        }
    }
}

static int compare_sections(const void *left, const void *right)
{
    const struct dcf_section *a = left, *b = right;

    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    return (a->line > b->line) - (a->line < b->line);
}

static bool are_twins(const struct dcf_section *a, const struct dcf_section *b)
{
    return a->order == b->order && a->order != NO_ORDER;
}

static bool has_twins(const struct dcf_text *self)
{
    for (size_t i = 1; i < self->section_count; i++) {
        if (are_twins(&self->sections[i - 1], &self->sections[i]))
            return true;
    }
    return false;
}

static void join(struct dcf_section *first, const struct dcf_section *again,
                 struct co_report *report)
{
    dcf_tell(report, DCF_RULE_DOUBLE_SECTION, again->line,
             "[%s]: expected once, it is also in line %u: keys of both are taken, of "
             "the same ones the later",
             dcf_show(again->name).text, first->line);
    first->line = again->line;
    first->count += again->count;
}

/* Leaves one of sections that are the same: their keys become neighbours. */
static enum co_err join_twins(struct dcf_text *self, struct co_report *report)
{
    struct dcf_key *keys = malloc((self->key_count + 1) * sizeof *keys), *next = keys;
    size_t count = 0;

    if (!keys)
        return CO_ERR_MEMORY;
    for (size_t i = 0; i < self->section_count; i++) {
        struct dcf_section *section = &self->sections[i];

        if (section->count > 0)
            memcpy(next, section->keys, section->count * sizeof *next);
        section->keys = next;
        next += section->count;
        if (count > 0 && are_twins(&self->sections[count - 1], section))
            join(&self->sections[count - 1], section, report);
        else
            self->sections[count++] = *section;
    }
    self->section_count = count;
    free(self->keys);
    self->keys = keys;
    return CO_OK;
}

static bool are_same(struct dcf_slice a, struct dcf_slice b)
{
    return a.size == b.size &&
           (memcmp(a.text, b.text, a.size) == 0 || dcf_slice_compare(a, b) == 0);
}

static bool is_number(struct dcf_slice name)
{
    return name.text[0] >= '0' && name.text[0] <= '9';
}

/* Numbers last and the shorter ones first, so that lists are in their order as they come. */
static int compare_names(struct dcf_slice a, struct dcf_slice b)
{
    if (is_number(a) != is_number(b))
        return is_number(a) ? 1 : -1;
    if (a.size != b.size)
        return a.size < b.size ? -1 : 1;
    return dcf_slice_compare(a, b);
}

static int compare_keys(const void *left, const void *right)
{
    const struct dcf_key *a = left, *b = right;
    int difference = compare_names(a->name, b->name);

    return difference != 0 ? difference : (a->line > b->line) - (a->line < b->line);
}

/* Few, as nearly all sections have, are found without an order. */
static bool has_few_keys(const struct dcf_section *section)
{
    return section->count <= FEW_KEYS;
}

static struct dcf_key *scan(struct dcf_key *keys, size_t count, struct dcf_slice name, uint32_t tag)
{
    for (size_t i = 0; i < count; i++) {
        if (keys[i].tag == tag && are_same(keys[i].name, name))
            return &keys[i];
    }
    return NULL;
}

static struct dcf_key *bisect(const struct dcf_section *section, struct dcf_slice name)
{
    size_t low = 0, high = section->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;
        int difference = compare_names(section->keys[middle].name, name);

        if (difference == 0)
            return &section->keys[middle];
        if (difference < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return NULL;
}

/* Of a section that is there twice, which was told. */
static bool is_repetition(const struct dcf_section *section, const struct dcf_key *first,
                          const struct dcf_key *again)
{
    return first->line < section->line && dcf_slice_compare(first->value, again->value) == 0;
}

static void tell_twice(const struct dcf_section *section, struct co_report *report,
                       const struct dcf_key *first, const struct dcf_key *again)
{
    if (section->kind == DCF_SECTION_UNKNOWN || is_repetition(section, first, again))
        return;
    dcf_tell(report, DCF_RULE_DOUBLE_KEY, again->line,
             "[%s] %s: expected once, it is also in line %u: \"%s\" counts, not \"%s\"",
             dcf_show(section->name).text, dcf_show(again->name).text, first->line,
             dcf_show(again->value).text, dcf_show(first->value).text);
}

/* Leaves the last of keys that are the same; where there are many, same ones are neighbours. */
static void merge_keys(struct dcf_section *section, struct co_report *report)
{
    bool few = has_few_keys(section);
    size_t count = 0;

    for (size_t i = 0; i < section->count; i++) {
        struct dcf_key *key = &section->keys[i];
        size_t first = few || count == 0 ? 0 : count - 1;
        struct dcf_key *same = scan(&section->keys[first], count - first, key->name, key->tag);

        if (same)
            tell_twice(section, report, same, key);
        else
            same = &section->keys[count++];
        *same = *key;
        section->tags |= dcf_tag_bit(key->tag);
    }
    section->count = count;
}

static void know_keys(struct dcf_section *section, struct co_report *report)
{
    if (!has_few_keys(section))
        sort(section->keys, section->count, sizeof *section->keys, compare_keys);
    merge_keys(section, report);
}

enum co_err dcf_text_sort(struct dcf_text *self, struct co_report *report)
{
    struct dcf_key *keys = self->keys;

    for (size_t i = 0; i < self->section_count; i++) {
        struct dcf_section *section = &self->sections[i];

        dcf_section_know(section, report);
        section->order = order_of(section);
        section->keys = keys;
        if (section->count > 0)
            keys += section->count;
    }
    sort(self->sections, self->section_count, sizeof *self->sections, compare_sections);
    if (has_twins(self) && join_twins(self, report) != CO_OK)
        return CO_ERR_MEMORY;
    for (size_t i = 0; i < self->section_count; i++)
        know_keys(&self->sections[i], report);
    return CO_OK;
}

struct dcf_section *dcf_text_find(const struct dcf_text *self, enum dcf_section_kind kind)
{
    size_t low = 0, high = self->section_count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;

        if (self->sections[middle].kind < kind)
            low = middle + 1;
        else
            high = middle;
    }
    return low < self->section_count && self->sections[low].kind == kind ? &self->sections[low]
                                                                         : NULL;
}

const struct dcf_key *dcf_section_look(struct dcf_section *self, struct dcf_slice name,
                                       uint32_t tag)
{
    struct dcf_key *key = has_few_keys(self) ? scan(self->keys, self->count, name, tag)
                                             : bisect(self, name);

    if (!key)
        return NULL;
    key->used = true;
    return key->value.size > 0 ? key : NULL;
}

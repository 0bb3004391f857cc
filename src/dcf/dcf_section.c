/* Sorts sections and keys, merges what comes twice. */
#include "dcf/dcf_lexer.h"

#include "dcf/dcf_rules.h"

#include <stdlib.h>

#define NO_ORDER UINT64_MAX

/* Equal for sections that are the same one. */
static uint64_t order(const struct dcf_section *section)
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

    if (section->kind == DCF_SECTION_UNKNOWN)
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
        dcf_section_know(&self->sections[i], report);
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

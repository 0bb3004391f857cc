/* Sections that are lists: a number of entries and 1, 2, 3, ... */
#include "dcf/dcf_build.h"

#include <stdlib.h>

#define NUMBER_MAX 65535u
#define NOT_TOLD   UINT32_MAX

struct numbers {
    size_t count;
    unsigned most;
    bool has_zero;
};

/* "Line7": 7 */
static bool number_of(struct dcf_slice name, const char *prefix, unsigned *ret_number)
{
    if (!dcf_slice_begins(name, prefix))
        return false;
    name = dcf_slice_skip(name, dcf_slice_of(prefix).size);
    return dcf_slice_decimal(name, NUMBER_MAX, ret_number);
}

static struct numbers take_all(struct dcf_section *section, const struct dcf_numbered *form,
                               void *context)
{
    struct numbers numbers = { .count = 0 };
    unsigned number;

    for (size_t i = 0; i < section->count; i++) {
        struct dcf_key *key = &section->keys[i];

        if (!number_of(key->name, form->prefix, &number))
            continue;
        key->used = true;
        if (key->value.size == 0 && !form->may_be_empty)
            continue;
        if (form->take)
            form->take(context, section, key, number);
        numbers.count++;
        numbers.has_zero |= number == 0;
        numbers.most = number > numbers.most ? number : numbers.most;
    }
    return numbers;
}

/* The first of 1, 2, ... that is not there. */
static unsigned find_gap(struct dcf_builder *self, const struct dcf_section *section,
                         const struct dcf_numbered *form)
{
    bool *there = calloc(NUMBER_MAX + 2u, sizeof *there);
    unsigned number, gap = 1;

    if (!there) {
        self->no_memory = true;
        return 0;
    }
    for (size_t i = 0; i < section->count; i++) {
        if (number_of(section->keys[i].name, form->prefix, &number) &&
            (section->keys[i].value.size > 0 || form->may_be_empty))
            there[number] = true;
    }
    while (there[gap])
        gap++;
    free(there);
    return gap;
}

static const struct dcf_key *find_count(struct dcf_builder *self, struct dcf_section *section,
                                        const struct dcf_numbered *form)
{
    const struct dcf_key *key = dcf_section_find(section, form->count_key);

    if (key || !form->other_count_key)
        return key;
    key = dcf_section_find(section, form->other_count_key);
    if (key)
        dcf_tell(self->report, form->rule, key->line, "[%s]: %s expected, there is \"%s\"",
                 dcf_show(section->name).text, form->count_key, dcf_show(key->name).text);
    return key;
}

void dcf_read_numbered(struct dcf_builder *self, struct dcf_section *section,
                       const struct dcf_numbered *form, void *context)
{
    const struct dcf_key *key = find_count(self, section, form);
    uint32_t announced = dcf_number_of_key(self, section, key, NUMBER_MAX, NOT_TOLD);
    struct numbers numbers = take_all(section, form, context);

    if (!key && numbers.count > 0)
        dcf_tell(self->report, form->rule, section->line,
                 "[%s] %s: %zu expected (so many are listed), it is missing",
                 dcf_show(section->name).text, form->count_key, numbers.count);
    else if (numbers.count != announced && announced != NOT_TOLD)
        dcf_tell(self->report, form->rule, section->line,
                 "[%s] %s: %zu expected (so many are listed), it is %lu",
                 dcf_show(section->name).text, form->count_key, numbers.count,
                 (unsigned long)announced);
    else if (numbers.most != numbers.count || numbers.has_zero)
        dcf_tell(self->report, DCF_RULE_LIST_NUMBERS, section->line,
                 "[%s]: %s1 to %s%zu expected, %s%u is missing", dcf_show(section->name).text,
                 form->prefix, form->prefix, numbers.count, form->prefix,
                 find_gap(self, section, form));
}

bool dcf_key_index(struct dcf_builder *self, const struct dcf_section *section,
                   const struct dcf_key *key, uint16_t *ret_index)
{
    struct dcf_number number;

    if (dcf_number_parse(key->value, &number) && !number.has_node_id && !number.negative &&
        !number.too_large && number.magnitude <= UINT16_MAX) {
        *ret_index = (uint16_t)number.magnitude;
        dcf_tell_quirks(self, section, key, number.quirks);
        return true;
    }
    dcf_tell(self->report, DCF_RULE_LIST_ENTRY, key->line,
             "[%s] %s: an index expected, there is \"%s\": ignored", dcf_show(section->name).text,
             dcf_show(key->name).text, dcf_show(key->value).text);
    return false;
}

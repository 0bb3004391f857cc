/* The object dictionary that a file describes. */
#include "dcf/dcf_build.h"

#include <stdlib.h>

#define STRING_ROOM   64u                 /* for strings, which may be written */
#define DOMAIN_ROOM   65536u              /* the file does not tell how much a domain holds */
#define DOMAINS_TOTAL (64u * DOMAIN_ROOM) /* a file of many domains must not take all memory */

struct od_maker {
    const struct dcf *dcf;
    struct od *od;
    uint8_t node_id;
    uint32_t domains_left; /* bytes for further domains */
};

static uint32_t capacity_of(struct od_maker *self, const struct dcf_entry *entry, uint32_t size)
{
    uint32_t room = STRING_ROOM;

    if (od_type_size(entry->type) != 0)
        return 0;
    if (entry->parameter.size > size)
        size = entry->parameter.size;
    if (entry->type == OD_DOMAIN && self->domains_left >= DOMAIN_ROOM) {
        self->domains_left -= DOMAIN_ROOM;
        room = DOMAIN_ROOM;
    }
    return size > room ? size : room;
}

/* Highest sub-index of the object of 'first', which is its sub-index 0. */
static uint8_t highest_sub(const struct dcf *dcf, size_t first)
{
    uint8_t highest = 0;

    for (size_t i = first; i < dcf->count && dcf->entries[i].index == dcf->entries[first].index;
         i++) {
        if (dcf->entries[i].sub != 0xFF)
            highest = dcf->entries[i].sub;
    }
    return highest;
}

static bool is_count_without_value(const struct dcf *dcf, size_t place)
{
    const struct dcf_entry *entry = &dcf->entries[place];

    return entry->sub == 0 && entry->type == OD_UNSIGNED8 && !entry->initial.given &&
           highest_sub(dcf, place) > 0;
}

static void set_limits(const struct dcf_entry *entry, uint8_t node_id, struct od_spec *spec)
{
    spec->has_low = entry->low.given;
    spec->has_high = entry->high.given;
    if (spec->has_low)
        spec->low = (int64_t)dcf_value_number(&entry->low, entry->type, node_id);
    if (spec->has_high)
        spec->high = (int64_t)dcf_value_number(&entry->high, entry->type, node_id);
}

static enum co_err add_entry(struct od_maker *self, size_t place)
{
    const struct dcf *dcf = self->dcf;
    const struct dcf_entry *entry = &dcf->entries[place];
    uint8_t highest;
    struct od_spec spec = { .index = entry->index,
                            .sub = entry->sub,
                            .type = entry->type,
                            .access = entry->access,
                            .mappable = entry->mappable,
                            .name = entry->name };
    uint8_t *bytes = malloc(entry->initial.size + 1);
    struct od_entry *added;
    enum co_err err;

    if (!bytes)
        return CO_ERR_MEMORY;
    if (entry->initial.given) {
        spec.size = dcf_value(&entry->initial, self->node_id, bytes);
        spec.value = bytes;
    } else if (is_count_without_value(dcf, place)) {
        highest = highest_sub(dcf, place);
        spec.size = 1;
        spec.value = &highest;
    }
    spec.capacity = capacity_of(self, entry, spec.size);
    set_limits(entry, self->node_id, &spec);
    err = od_add(self->od, &spec, &added);
    free(bytes);
    return err;
}

enum co_err dcf_make_od(const struct dcf *self, uint8_t node_id, struct co_report *report,
                        struct od *od)
{
    struct od_maker maker = {
        .dcf = self, .od = od, .node_id = node_id, .domains_left = DOMAINS_TOTAL
    };

    for (size_t i = 0; i < self->count; i++) {
        const struct dcf_entry *entry = &self->entries[i];
        enum co_err err;

        if (!od_type_known(entry->type)) {
            dcf_tell(report, DCF_RULE_DATA_TYPE, entry->line,
                     "%04Xh:%02X: a data type of CiA 301 expected, there is none: the entry "
                     "is left out",
                     entry->index, entry->sub);
            continue;
        }
        err = add_entry(&maker, i);
        if (err == CO_ERR_MEMORY)
            return err;
        if (err != CO_OK) {
            dcf_tell(report, DCF_RULE_NOT_ACCEPTED, entry->line, "%04Xh:%02X: not accepted: %s",
                     entry->index, entry->sub, co_err_text(err));
            return CO_ERR_VALUE;
        }
    }
    return CO_OK;
}

#include "od/od.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

#define STRING_ROOM 64u /* least capacity of a string or domain whose capacity is not told */

void od_init(struct od *self)
{
    *self = (struct od){ .count = 0 };
}

static void free_bytes(const struct od_entry *entry, uint8_t *bytes)
{
    for (unsigned i = 0; i < sizeof entry->small / sizeof entry->small[0]; i++)
        if (bytes == entry->small[i])
            return;
    free(bytes);
}

static void free_entry(struct od_entry *entry)
{
    if (!entry->referred)
        free_bytes(entry, entry->value);
    free_bytes(entry, entry->initial);
    free_bytes(entry, entry->defaults);
    free(entry->name);
    free(entry);
}

void od_done(struct od *self)
{
    for (size_t i = 0; i < self->count; i++)
        free_entry(self->entries[i]);
    free(self->entries);
    od_init(self);
}

static uint32_t address(uint16_t index, uint8_t sub)
{
    return (uint32_t)index << 8 | sub;
}

/* Place of the first entry that is not before index:sub. */
static size_t lower_bound(const struct od *self, uint16_t index, uint8_t sub)
{
    size_t low = 0, high = self->count;

    while (low < high) {
        size_t middle = low + (high - low) / 2;
        const struct od_entry *entry = self->entries[middle];

        if (address(entry->index, entry->sub) < address(index, sub))
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

struct od_entry *od_find(const struct od *self, uint16_t index, uint8_t sub)
{
    size_t place = lower_bound(self, index, sub);

    if (place == self->count || self->entries[place]->index != index ||
        self->entries[place]->sub != sub)
        return NULL;
    return self->entries[place];
}

bool od_has_object(const struct od *self, uint16_t index)
{
    size_t place = lower_bound(self, index, 0);

    return place < self->count && self->entries[place]->index == index;
}

/* The capacity that a description asks for; false if its value does not fit its type. */
static bool plan_capacity(const struct od_spec *spec, uint32_t *ret_capacity)
{
    uint32_t fixed = od_type_size(spec->type);
    uint32_t size = spec->value ? spec->size : 0;

    if (!od_type_known(spec->type))
        return false;
    if (fixed != 0) {
        *ret_capacity = fixed;
        return !spec->value || size == fixed;
    }
    *ret_capacity = spec->capacity;
    if (spec->capacity == 0)
        *ret_capacity = spec->size > STRING_ROOM ? spec->size : STRING_ROOM;
    return size <= *ret_capacity;
}

/* Numbers lie within their entry. */
static void take_bytes(struct od_entry *entry)
{
    entry->value = entry->small[0];
    entry->initial = entry->small[1];
    if (od_type_size(entry->type) != 0)
        return;
    entry->value = calloc(1, entry->capacity);
    entry->initial = calloc(1, entry->size > 0 ? entry->size : 1);
}

static struct od_entry *new_entry(const struct od_spec *spec, uint32_t capacity)
{
    uint32_t fixed = od_type_size(spec->type);
    uint32_t size = fixed != 0 ? fixed : spec->value ? spec->size : 0;
    struct od_entry *entry = calloc(1, sizeof *entry);

    if (!entry)
        return NULL;
    *entry = (struct od_entry){ .index = spec->index,
                                .sub = spec->sub,
                                .type = spec->type,
                                .access = spec->access,
                                .mappable = spec->mappable,
                                .has_low = spec->has_low,
                                .has_high = spec->has_high,
                                .low = spec->low,
                                .high = spec->high,
                                .capacity = capacity,
                                .size = size,
                                .initial_size = size };
    take_bytes(entry);
    entry->name = spec->name ? strdup(spec->name) : NULL;
    if (!entry->value || !entry->initial || (spec->name && !entry->name)) {
        free_entry(entry);
        return NULL;
    }
    if (spec->value && size > 0) {
        memcpy(entry->value, spec->value, size);
        memcpy(entry->initial, spec->value, size);
    }
    return entry;
}

static bool make_room(struct od *self)
{
    size_t room = self->room ? 2 * self->room : 64;
    struct od_entry **entries;

    if (self->count < self->room)
        return true;
    entries = realloc(self->entries, room * sizeof *entries);
    if (!entries)
        return false;
    self->entries = entries;
    self->room = room;
    return true;
}

enum co_err od_add(struct od *self, const struct od_spec *spec, struct od_entry **ret_entry)
{
    size_t place = lower_bound(self, spec->index, spec->sub);
    struct od_entry *entry;
    uint32_t capacity = 0;

    if (od_find(self, spec->index, spec->sub))
        return CO_ERR_EXISTS;
    if (!plan_capacity(spec, &capacity))
        return CO_ERR_ARG;
    if (!make_room(self))
        return CO_ERR_MEMORY;
    entry = new_entry(spec, capacity);
    if (!entry)
        return CO_ERR_MEMORY;
    memmove(self->entries + place + 1, self->entries + place,
            (self->count - place) * sizeof(struct od_entry *));
    self->entries[place] = entry;
    self->count++;
    if (ret_entry)
        *ret_entry = entry;
    return CO_OK;
}

enum co_err od_add_number(struct od *self, uint16_t index, uint8_t sub, uint8_t type,
                          enum od_access access, uint64_t value)
{
    uint8_t bytes[8];
    uint32_t size = od_type_size(type);
    const struct od_spec spec = { .index = index,
                                  .sub = sub,
                                  .type = type,
                                  .access = (uint8_t)access,
                                  .value = bytes,
                                  .size = size };

    if (size == 0)
        return CO_ERR_ARG;
    put_le(bytes, sizeof bytes, value);
    return od_add(self, &spec, NULL);
}

void od_remove_object(struct od *self, uint16_t index, void (*forget)(void *owner))
{
    const size_t first = lower_bound(self, index, 0);
    size_t last = first;

    for (; last < self->count && self->entries[last]->index == index; last++) {
        if (self->entries[last]->owner)
            forget(self->entries[last]->owner);
        free_entry(self->entries[last]);
    }
    memmove(self->entries + first, self->entries + last,
            (self->count - last) * sizeof(struct od_entry *));
    self->count -= last - first;
}

uint64_t od_number(const struct od *self, uint16_t index, uint8_t sub, uint64_t missing)
{
    const struct od_entry *entry = od_find(self, index, sub);

    return entry ? get_le(entry->value, entry->size < 8 ? entry->size : 8) : missing;
}

void od_set_number(struct od *self, uint16_t index, uint8_t sub, uint64_t value)
{
    struct od_entry *entry = od_find(self, index, sub);

    if (entry && od_type_size(entry->type) != 0)
        put_le(entry->value, entry->size, value);
}

sdo_abort_t od_set(struct od_entry *entry, const uint8_t *value, uint32_t size)
{
    sdo_abort_t code = od_check_value(entry, value, size);

    if (code != SDO_OK)
        return code;
    if (size > 0)
        memmove(entry->value, value, size);
    entry->size = size;
    return SDO_OK;
}

void od_reset_entry(struct od_entry *entry)
{
    if (entry->referred) {
        entry->value = entry->initial_value;
        entry->capacity = entry->initial_capacity;
    }
    if (entry->initial && entry->initial_size > 0)
        memcpy(entry->value, entry->initial, entry->initial_size);
    entry->size = entry->initial_size;
}

void od_reset(struct od *self, uint16_t first, uint16_t last)
{
    for (size_t i = lower_bound(self, first, 0); i < self->count; i++) {
        if (self->entries[i]->index > last)
            return;
        od_reset_entry(self->entries[i]);
    }
}

/* Room for the power-on value; a number has it. */
static bool make_initial(struct od_entry *entry, uint32_t size)
{
    uint8_t *initial;

    if (size <= entry->initial_size && entry->initial)
        return true;
    initial = realloc(entry->initial, size > 0 ? size : 1);
    if (!initial)
        return false;
    entry->initial = initial;
    return true;
}

bool od_can_be_written(const struct od_entry *entry)
{
    return entry->access != OD_RO && entry->access != OD_CONST && entry->access != OD_NONE;
}

bool od_access_fits(uint8_t access, bool transmit)
{
    switch ((enum od_access)access) {
    case OD_RO:
    case OD_CONST:
    case OD_RWR: return transmit;
    case OD_WO:
    case OD_RWW: return !transmit;
    case OD_RW:
    case OD_NONE: break;
    }
    return true;
}

/* Of bytes that nobody writes, and of domains, no copy is kept. */
static bool keep_initial(struct od_entry *entry, const uint8_t *bytes, uint32_t size)
{
    if (entry->type == OD_DOMAIN || !od_can_be_written(entry)) {
        free_bytes(entry, entry->initial);
        entry->initial = NULL;
        return true;
    }
    if (!make_initial(entry, size))
        return false;
    if (size > 0)
        memcpy(entry->initial, bytes, size);
    return true;
}

void od_forget_default(struct od_entry *entry)
{
    free_bytes(entry, entry->defaults);
    entry->defaults = NULL;
}

enum co_err od_refer(struct od_entry *entry, uint8_t *bytes, uint32_t size, uint32_t capacity,
                     bool initial)
{
    if (initial && !keep_initial(entry, bytes, size))
        return CO_ERR_MEMORY;
    if (initial) {
        od_forget_default(entry);
        entry->initial_value = bytes;
        entry->initial_capacity = capacity;
        entry->initial_size = size;
    }
    if (!entry->referred)
        free_bytes(entry, entry->value);
    entry->fetched = false;
    entry->referred = true;
    entry->value = bytes;
    entry->size = size;
    entry->capacity = capacity;
    return CO_OK;
}

void od_fetch(struct od_entry *entry, uint32_t capacity)
{
    if (!entry->referred)
        free_bytes(entry, entry->value);
    free_bytes(entry, entry->initial);
    entry->value = entry->small[0];
    entry->initial = entry->small[1];
    entry->size = entry->initial_size = 0;
    entry->capacity = capacity;
    entry->referred = false;
    entry->fetched = true;
}

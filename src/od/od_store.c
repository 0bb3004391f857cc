#include "od/od_store.h"

#include "base/bytes.h"

#include <stdlib.h>
#include <string.h>

static bool is_number(const struct od_entry *entry)
{
    return od_type_size(entry->type) != 0;
}

bool od_is_parameter(const struct od_entry *entry)
{
    return od_can_be_written(entry) && entry->type != OD_DOMAIN && entry->initial != NULL;
}

struct od_value od_power_on(const struct od_entry *entry)
{
    return (struct od_value){ entry->initial, entry->initial_size };
}

struct od_value od_default(const struct od_entry *entry)
{
    if (entry->defaults == NULL)
        return od_power_on(entry);
    return (struct od_value){ entry->defaults, entry->default_size };
}

bool od_same(struct od_value a, struct od_value b)
{
    return a.size == b.size && (a.size == 0 || memcmp(a.bytes, b.bytes, a.size) == 0);
}

/* ---- one entry ---- */

static void take_number(struct od_entry *entry, const uint8_t *bytes)
{
    if (entry->defaults == NULL) {
        memcpy(entry->small[2], entry->initial, entry->size);
        entry->defaults = entry->small[2];
        entry->default_size = entry->size;
    }
    memcpy(entry->initial, bytes, entry->size);
}

static void take_text(struct od_entry *entry, uint8_t *bytes, uint32_t size)
{
    if (entry->defaults == NULL) {
        entry->defaults = entry->initial;
        entry->default_size = entry->initial_size;
    } else {
        free(entry->initial);
    }
    entry->initial = bytes;
    entry->initial_size = size;
}

void od_store_number(struct od_entry *entry, uint64_t number)
{
    uint8_t bytes[OD_SMALL];

    put_le(bytes, entry->size, number);
    take_number(entry, bytes);
}

void od_restore_default(struct od_entry *entry)
{
    if (entry->defaults == NULL)
        return;
    if (is_number(entry)) {
        memcpy(entry->initial, entry->defaults, entry->size);
    } else {
        free(entry->initial);
        entry->initial = entry->defaults;
        entry->initial_size = entry->default_size;
    }
    entry->defaults = NULL;
}

/* ---- plans ---- */

void od_plan_init(struct od_plan *self)
{
    *self = (struct od_plan){ .count = 0 };
}

void od_plan_done(struct od_plan *self)
{
    for (size_t i = 0; i < self->count; i++)
        free(self->values[i].bytes);
    free(self->values);
    od_plan_init(self);
}

static bool make_room(struct od_plan *self)
{
    const size_t room = self->room > 0 ? 2 * self->room : 64;
    struct od_planned *values;

    if (self->count < self->room)
        return true;
    values = realloc(self->values, room * sizeof *values);
    if (values == NULL)
        return false;
    self->values = values;
    self->room = room;
    return true;
}

enum co_err od_plan_add(struct od_plan *self, struct od_entry *entry, struct od_value value)
{
    struct od_planned planned = { .entry = entry, .size = value.size };
    uint8_t *bytes = planned.small;

    if (entry->referred && value.size > entry->initial_capacity)
        return CO_ERR_VALUE;
    if (!make_room(self))
        return CO_ERR_MEMORY;
    if (!is_number(entry)) {
        bytes = malloc(value.size > 0 ? value.size : 1);
        if (bytes == NULL)
            return CO_ERR_MEMORY;
        planned.bytes = bytes;
    }
    if (value.size > 0)
        memcpy(bytes, value.bytes, value.size);
    self->values[self->count++] = planned;
    return CO_OK;
}

void od_plan_commit(struct od_plan *self)
{
    for (size_t i = 0; i < self->count; i++) {
        struct od_planned *planned = &self->values[i];

        if (is_number(planned->entry))
            take_number(planned->entry, planned->small);
        else
            take_text(planned->entry, planned->bytes, planned->size);
    }
    self->count = 0;
    od_plan_done(self);
}

enum co_err od_store(struct od *self, uint16_t first, uint16_t last)
{
    struct od_plan plan;
    enum co_err err = CO_OK;

    od_plan_init(&plan);
    for (size_t i = 0; i < self->count && err == CO_OK; i++) {
        struct od_entry *entry = self->entries[i];

        if (entry->index >= first && entry->index <= last && od_is_parameter(entry))
            err = od_plan_add(&plan, entry, (struct od_value){ entry->value, entry->size });
    }
    if (err == CO_OK)
        od_plan_commit(&plan);
    od_plan_done(&plan);
    return err;
}

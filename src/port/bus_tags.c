#include "port/bus_tags.h"

#include <string.h>

static void remove_at(struct bus_tags *self, unsigned index)
{
    self->count--;
    memmove(&self->frames[index], &self->frames[index + 1],
            (self->count - index) * sizeof self->frames[0]);
}

void bus_tags_push(struct bus_tags *self, const struct co_frame *frame)
{
    if (self->count == BUS_TAGS_MAX)
        remove_at(self, 0);
    self->frames[self->count++] = *frame;
}

void bus_tags_take_back(struct bus_tags *self, const struct co_frame *frame)
{
    if (self->count > 0 && co_frame_equal(&self->frames[self->count - 1], frame))
        self->count--;
}

static bool has_same_id(const struct co_frame *a, const struct co_frame *b)
{
    return a->id == b->id && ((a->flags ^ b->flags) & CO_FRAME_EXT) == 0;
}

/* The frames of this identifier before end, which were lost. */
static void remove_overtaken(struct bus_tags *self, const struct co_frame *frame, unsigned end)
{
    for (unsigned i = end; i > 0; i--) {
        if (has_same_id(&self->frames[i - 1], frame))
            remove_at(self, i - 1);
    }
}

uint8_t bus_tags_confirm(struct bus_tags *self, const struct co_frame *frame)
{
    uint8_t tag;
    unsigned i = 0;

    while (i < self->count && !co_frame_equal(&self->frames[i], frame))
        i++;
    if (i == self->count)
        return 0;
    tag = self->frames[i].tag;
    remove_at(self, i);
    remove_overtaken(self, frame, i);
    return tag;
}

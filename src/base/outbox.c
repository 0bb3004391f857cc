#include "base/outbox.h"

#include <assert.h>

void co_outbox_init(struct co_outbox *self, struct co_frame *frames, unsigned frame_capacity,
                    struct co_event *events, unsigned event_capacity)
{
    *self = (struct co_outbox){ .frames = frames,
                                .events = events,
                                .frame_capacity = frame_capacity,
                                .event_capacity = event_capacity };
}

bool co_outbox_room(const struct co_outbox *self, unsigned frames, unsigned events)
{
    return self->frame_capacity - self->frame_count >= frames &&
           self->event_capacity - self->event_count >= events;
}

void co_outbox_put_frame(struct co_outbox *self, const struct co_frame *frame)
{
    assert(co_outbox_room(self, 1, 0));
    self->frames[(self->frame_first + self->frame_count++) % self->frame_capacity] = *frame;
}

void co_outbox_put_event(struct co_outbox *self, const struct co_event *event)
{
    assert(co_outbox_room(self, 0, 1));
    self->events[(self->event_first + self->event_count++) % self->event_capacity] = *event;
}

bool co_outbox_take_frame(struct co_outbox *self, struct co_frame *ret_frame)
{
    if (self->frame_count == 0)
        return false;
    *ret_frame = self->frames[self->frame_first];
    self->frame_first = (self->frame_first + 1) % self->frame_capacity;
    self->frame_count--;
    return true;
}

bool co_outbox_take_event(struct co_outbox *self, struct co_event *ret_event)
{
    if (self->event_count == 0)
        return false;
    *ret_event = self->events[self->event_first];
    self->event_first = (self->event_first + 1) % self->event_capacity;
    self->event_count--;
    return true;
}

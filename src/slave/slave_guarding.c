#include "slave/slave_internal.h"

#include "proto/event.h"

/* 0: the master may be silent for any time. */
static co_us_t life_time(const struct od *od)
{
    return CO_MS(od_number(od, 0x100C, 0, 0)) * od_number(od, 0x100D, 0, 0);
}

void slave_reset_guarding(struct slave *self)
{
    guard_slave_init(&self->guard, self->node);
    self->guard.state = self->state;
}

/* What the machine has put out; there is room for what it means to the device. */
static void pass_on(struct slave *self, struct co_outbox *inner, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(inner, &frame))
        co_outbox_put_frame(out, &frame);
    while (co_outbox_take_event(inner, &event))
        if (event.type == PROTO_LIFE_LOST)
            slave_error_control_lost(self, now, out);
        else
            slave_error_control_back(self, now, out);
}

/* Steps the machine, with a frame or without; it has room where the device has room for more. */
static void step(struct slave *self, const struct co_frame *request, co_us_t now,
                 struct co_outbox *out)
{
    const unsigned room = co_outbox_room(out, 2, 2) ? 1 : 0;
    struct co_frame frames[1];
    struct co_event events[1];
    struct co_outbox inner;

    co_outbox_init(&inner, frames, room, events, room);
    if (request != NULL)
        guard_slave_on_frame(&self->guard, request, now, &inner);
    else
        guard_slave_on_time(&self->guard, now, &inner);
    pass_on(self, &inner, now, out);
}

void slave_answer_guarding(struct slave *self, const struct co_frame *request, co_us_t now,
                           struct co_outbox *out)
{
    if (self->heartbeat.period > 0)
        return;
    self->guard.life_time = life_time(self->od);
    step(self, request, now, out);
}

void slave_watch_guarding(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (guard_slave_deadline(&self->guard) <= now)
        step(self, NULL, now, out);
}

void slave_configure_guarding(struct slave *self, co_us_t now, struct co_outbox *out)
{
    struct co_event events[1];
    struct co_outbox inner;

    if (self->heartbeat.period == 0 && life_time(self->od) > 0)
        return;
    co_outbox_init(&inner, NULL, 0, events, 1);
    guard_slave_stop(&self->guard, &inner);
    pass_on(self, &inner, now, out);
}

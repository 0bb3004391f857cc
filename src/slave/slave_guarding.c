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

static bool is_running(const struct slave *self)
{
    return self->guard.deadline != CO_NEVER;
}

static void put_guarding_event(const struct slave *self, enum slave_watching what,
                               struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_GUARDING,
                                    .node = self->node,
                                    .detail = (uint8_t)what };

    co_outbox_put_event(out, &event);
}

static void tell_running(struct slave *self, struct co_outbox *out)
{
    const bool running = is_running(self);

    if (self->told_guarding == running || self->guard.lost || !co_outbox_room(out, 0, 1))
        return;
    self->told_guarding = running;
    put_guarding_event(self, running ? WATCH_BEGINS : WATCH_ENDS, out);
}

static void lose_master(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->told_guarding = false;
    put_guarding_event(self, WATCH_TIMEOUT, out);
    slave_error_control_lost(self, now, out);
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
            lose_master(self, now, out);
        else
            slave_error_control_back(self, now, out);
    tell_running(self, out);
}

/* Steps the machine, with a frame or without; it has room where the device has room for more. */
static void step(struct slave *self, const struct co_frame *request, co_us_t now,
                 struct co_outbox *out)
{
    const unsigned room = co_outbox_room(out, 2, 3) ? 1 : 0;
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
    if (slave_guarding_deadline(self) <= now)
        step(self, NULL, now, out);
}

co_us_t slave_guarding_deadline(const struct slave *self)
{
    if (self->told_guarding != is_running(self) && !self->guard.lost)
        return 0;
    return guard_slave_deadline(&self->guard);
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

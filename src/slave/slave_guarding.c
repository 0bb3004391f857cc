#include "slave/slave_internal.h"

#define TOGGLE_BIT 0x80u

/* 0: the master may be silent for any time. */
static co_us_t life_time(const struct od *od)
{
    return CO_MS(od_number(od, 0x100C, 0, 0)) * od_number(od, 0x100D, 0, 0);
}

void slave_reset_guarding(struct slave *self)
{
    self->guard = (struct slave_guard){ .deadline = CO_NEVER };
}

/* A request that finds no room is not answered; the master asks again. */
void slave_answer_guarding(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const unsigned toggle = self->guard.toggle ? TOGGLE_BIT : 0;
    const struct co_frame frame = nmt_error_control_frame(self->node,
                                                          (uint8_t)(self->state | toggle));
    const co_us_t life = life_time(self->od);

    if (self->heartbeat.period > 0 || !co_outbox_room(out, 2, 1))
        return;
    co_outbox_put_frame(out, &frame);
    self->guard.toggle = !self->guard.toggle;
    if (self->guard.lost)
        slave_error_control_back(self, now, out);
    self->guard.lost = false;
    self->guard.deadline = life > 0 ? now + life : CO_NEVER;
}

void slave_watch_guarding(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (now < self->guard.deadline || !co_outbox_room(out, 1, 2))
        return;
    self->guard.deadline = CO_NEVER;
    self->guard.lost = true;
    slave_error_control_lost(self, now, out);
}

void slave_end_guarding(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->guard.deadline = CO_NEVER;
    if (self->guard.lost)
        slave_error_control_back(self, now, out);
    self->guard.lost = false;
}

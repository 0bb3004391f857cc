#include "proto/heartbeat.h"

#include "proto/event.h"
#include "proto/nmt.h"

void hb_producer_init(struct hb_producer *self, uint8_t node)
{
    *self = (struct hb_producer){ .node = node, .deadline = CO_NEVER };
}

void hb_producer_start(struct hb_producer *self, co_us_t period, bool at_once, co_us_t now)
{
    self->period = period;
    self->deadline = CO_NEVER;
    if (period > 0)
        self->deadline = at_once ? now : now + period;
}

void hb_producer_on_time(struct hb_producer *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame;

    if (now < self->deadline || !co_outbox_room(out, 1, 0))
        return;
    frame = nmt_error_control_frame(self->node, self->state);
    co_outbox_put_frame(out, &frame);
    self->deadline += self->period;
    if (self->deadline <= now) /* after a stall: one heartbeat, not all that were missed */
        self->deadline = now + self->period;
}

co_us_t hb_producer_deadline(const struct hb_producer *self)
{
    return self->deadline;
}

static void forget(struct hb_consumer *self)
{
    self->state = NMT_INITIALISING;
    self->untold = false;
    self->lost = false;
    self->deadline = CO_NEVER;
}

void hb_consumer_init(struct hb_consumer *self, uint8_t node)
{
    *self = (struct hb_consumer){ .node = node };
    forget(self);
}

void hb_consumer_start(struct hb_consumer *self, co_us_t period)
{
    self->period = period;
    forget(self);
}

static void put_event(const struct hb_consumer *self, uint16_t type, struct co_outbox *out)
{
    const struct co_event event = { .type = type, .node = self->node, .detail = self->state };

    co_outbox_put_event(out, &event);
}

static void tell_state(struct hb_consumer *self, struct co_outbox *out)
{
    if (!self->untold || !co_outbox_room(out, 0, 1))
        return;
    put_event(self, PROTO_HB_STATE, out);
    self->untold = false;
}

void hb_consumer_on_frame(struct hb_consumer *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out)
{
    uint8_t node, state;

    if (self->period == 0 || !nmt_parse_error_control(frame, &node, &state) || node != self->node)
        return;
    if (state == NMT_INITIALISING) {
        forget(self);
        return;
    }
    if (self->lost || state != self->state)
        self->untold = true;
    self->state = state;
    self->lost = false;
    self->deadline = now + self->period;
    tell_state(self, out);
}

void hb_consumer_on_time(struct hb_consumer *self, co_us_t now, struct co_outbox *out)
{
    tell_state(self, out);
    if (now < self->deadline || !co_outbox_room(out, 0, 1))
        return;
    put_event(self, PROTO_HB_LOST, out);
    self->lost = true;
    self->deadline = CO_NEVER;
}

co_us_t hb_consumer_deadline(const struct hb_consumer *self)
{
    return self->untold ? 0 : self->deadline;
}

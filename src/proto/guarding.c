#include "proto/guarding.h"

#include "proto/event.h"
#include "proto/nmt.h"

#define TOGGLE_BIT 0x80u

static void put_event(uint16_t type, uint8_t node, uint8_t detail, uint64_t actual,
                      struct co_outbox *out)
{
    const struct co_event event = {
        .type = type, .node = node, .detail = detail, .actual = actual
    };

    co_outbox_put_event(out, &event);
}

/* ---- master -------------------------------------------------------------------------------- */

/* Off, but for the toggle bit. */
static void rest(struct guard_master *self)
{
    self->state = NMT_INITIALISING;
    self->once = false;
    self->asked = false;
    self->lost = false;
    self->told_lost = false;
    self->state_untold = false;
    self->toggle_untold = false;
    self->period = 0;
    self->request = CO_NEVER;
    self->loss = CO_NEVER;
}

void guard_master_init(struct guard_master *self, uint8_t node)
{
    *self = (struct guard_master){ .node = node };
    rest(self);
}

static void begin(struct guard_master *self, co_us_t period, co_us_t life_time, co_us_t now)
{
    rest(self);
    self->period = period;
    self->life_time = life_time;
    self->request = now;
    self->sent = now;
    self->alive = now;
}

void guard_master_start(struct guard_master *self, co_us_t period, uint8_t factor, co_us_t now)
{
    if (period > 0 && factor > 0)
        begin(self, period, period * factor, now);
    else
        guard_master_stop(self);
}

void guard_master_stop(struct guard_master *self)
{
    rest(self);
    self->toggle = false;
}

void guard_master_ask(struct guard_master *self, co_us_t timeout, co_us_t now)
{
    begin(self, timeout, timeout, now);
    self->once = true;
}

static void tell_answer(struct guard_master *self, struct co_outbox *out)
{
    if (self->state_untold && co_outbox_room(out, 0, 1)) {
        put_event(PROTO_GUARD_STATE, self->node, self->state, 0, out);
        self->state_untold = false;
        self->told_lost = false;
    }
    if (self->toggle_untold && co_outbox_room(out, 0, 1)) {
        put_event(PROTO_GUARD_TOGGLE, self->node, self->state, self->toggle_errors, out);
        self->toggle_untold = false;
    }
}

static void on_boot_up(struct guard_master *self, co_us_t now)
{
    self->toggle = false;
    if (self->once)
        return;
    self->state = NMT_INITIALISING;
    self->state_untold = false;
    self->lost = self->told_lost; /* an answer that nobody knows of is as none */
    self->asked = false;
    self->alive = now;
    self->loss = CO_NEVER;
}

static void check_toggle(struct guard_master *self, bool toggle)
{
    if (toggle != self->toggle && !self->once) {
        self->toggle_errors++;
        self->toggle_untold = true;
    }
    self->toggle = !toggle;
}

/* Every answer counts, whoever asked for it: it alternates the toggle bit like ours. */
static void on_answer(struct guard_master *self, uint8_t state)
{
    if (self->lost || state != self->state)
        self->state_untold = true;
    self->state = state;
    self->lost = false;
    self->asked = false;
    self->alive = self->sent;
    self->loss = CO_NEVER;
    if (self->once)
        self->period = 0;
    self->once = false;
}

void guard_master_on_frame(struct guard_master *self, const struct co_frame *frame, co_us_t now,
                           struct co_outbox *out)
{
    uint8_t node, state;

    if (!nmt_parse_error_control(frame, &node, &state) || node != self->node)
        return;
    if (state == NMT_INITIALISING) {
        on_boot_up(self, now);
        return;
    }
    if (self->period == 0 || (self->once && !self->asked))
        return;
    check_toggle(self, (frame->data[0] & TOGGLE_BIT) != 0);
    on_answer(self, state);
    tell_answer(self, out);
}

static co_us_t later(co_us_t a, co_us_t b)
{
    return a > b ? a : b;
}

static void send_request(struct guard_master *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = nmt_error_control_frame(self->node, 0);

    if (now < self->request || !co_outbox_room(out, 1, 0))
        return;
    frame.flags = CO_FRAME_RTR;
    co_outbox_put_frame(out, &frame);
    if (!self->asked && !self->lost)
        self->loss = later(self->alive + self->life_time, now + self->period);
    self->asked = true;
    self->sent = now;
    self->request += self->period;
    if (self->request <= now) /* after a stall: one request, not all that were missed */
        self->request = now + self->period;
    if (self->once)
        self->request = CO_NEVER;
}

/* A request that is due as well goes first, however full the outbox. */
static void watch(struct guard_master *self, co_us_t now, struct co_outbox *out)
{
    if (now < self->loss || now >= self->request || !co_outbox_room(out, 0, 1))
        return;
    put_event(PROTO_GUARD_LOST, self->node, self->state, 0, out);
    self->lost = true;
    self->told_lost = true;
    self->loss = CO_NEVER;
    if (self->once)
        rest(self);
}

void guard_master_on_time(struct guard_master *self, co_us_t now, struct co_outbox *out)
{
    tell_answer(self, out);
    send_request(self, now, out);
    watch(self, now, out);
}

co_us_t guard_master_deadline(const struct guard_master *self)
{
    return self->state_untold || self->toggle_untold ? 0 : co_earlier(self->request, self->loss);
}

/* ---- slave --------------------------------------------------------------------------------- */

void guard_slave_init(struct guard_slave *self, uint8_t node)
{
    *self = (struct guard_slave){ .node = node, .deadline = CO_NEVER };
}

/* An answer that is due goes first. */
static void tell_life(struct guard_slave *self, struct co_outbox *out)
{
    if (self->lost == self->told_lost || self->answer_due || !co_outbox_room(out, 0, 1))
        return;
    put_event(self->lost ? PROTO_LIFE_LOST : PROTO_LIFE_BACK, self->node, 0, 0, out);
    self->told_lost = self->lost;
}

void guard_slave_stop(struct guard_slave *self, struct co_outbox *out)
{
    self->answer_due = false;
    self->lost = false;
    self->deadline = CO_NEVER;
    tell_life(self, out);
}

static void answer(struct guard_slave *self, struct co_outbox *out)
{
    const unsigned toggle = self->toggle ? TOGGLE_BIT : 0;
    const struct co_frame frame = nmt_error_control_frame(self->node,
                                                          (uint8_t)(self->state | toggle));

    if (!self->answer_due || !co_outbox_room(out, 1, 0))
        return;
    co_outbox_put_frame(out, &frame);
    self->toggle = !self->toggle;
    self->answer_due = false;
}

void guard_slave_on_frame(struct guard_slave *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out)
{
    const unsigned kind = frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR);

    if (kind != CO_FRAME_RTR || frame->id != NMT_ERROR_CONTROL_ID + self->node)
        return;
    self->answer_due = true;
    self->lost = false;
    self->deadline = self->life_time > 0 ? now + self->life_time : CO_NEVER;
    answer(self, out);
    tell_life(self, out);
}

void guard_slave_on_time(struct guard_slave *self, co_us_t now, struct co_outbox *out)
{
    if (now >= self->deadline) {
        self->lost = true;
        self->deadline = CO_NEVER;
    }
    answer(self, out);
    tell_life(self, out);
}

co_us_t guard_slave_deadline(const struct guard_slave *self)
{
    return self->answer_due || self->lost != self->told_lost ? 0 : self->deadline;
}

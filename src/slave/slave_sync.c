#include "slave/slave_internal.h"

#include "base/bytes.h"
#include "proto/event.h"

#define COB_ID_SYNC      0x1005u
#define CYCLE_PERIOD     0x1006u
#define WINDOW_LENGTH    0x1007u
#define COUNTER_OVERFLOW 0x1019u

#define SYNC_CAN_ID      0x80u /* where no object says another */
#define EMCY_SYNC_LENGTH 0x8240u

bool slave_is_sync_object(uint16_t index)
{
    return index == COB_ID_SYNC || index == CYCLE_PERIOD || index == COUNTER_OVERFLOW;
}

static bool knows_sync(const struct slave *self)
{
    return self->assume_sync || od_has_object(self->od, COB_ID_SYNC);
}

static co_us_t period(const struct slave *self)
{
    return od_number(self->od, CYCLE_PERIOD, 0, 0);
}

static bool produces(const struct slave *self)
{
    return (self->sync.cob_id & COB_ID_BIT30) != 0 && self->sync.period > 0;
}

void slave_update_sync_consumer(struct slave *self)
{
    self->consumes_sync = knows_sync(self) && (produces(self) || slave_has_synchronous_pdo(self));
    self->listen_generation++;
}

/* Devices from before the counter do not look at the length. */
static enum sync_length expected_length(const struct slave *self)
{
    if (!od_has_object(self->od, COUNTER_OVERFLOW))
        return SYNC_ANY_LENGTH;
    return od_number(self->od, COUNTER_OVERFLOW, 0, 0) == 0 ? SYNC_WITHOUT_COUNTER
                                                            : SYNC_WITH_COUNTER;
}

void slave_configure_sync(struct slave *self)
{
    const uint32_t cob_id = (uint32_t)od_number(self->od, COB_ID_SYNC, 0, SYNC_CAN_ID);
    const uint8_t overflow = (uint8_t)od_number(self->od, COUNTER_OVERFLOW, 0, 0);

    sync_producer_configure(&self->sync, cob_id, period(self), overflow);
    self->sync_heard.cob_id = cob_id;
    self->sync_heard.length = (uint8_t)expected_length(self);
    self->sync_heard.wrong = false;
    self->window_end = CO_NEVER;
    self->sync_generation++;
    slave_update_sync_consumer(self);
}

void slave_enable_sync(struct slave *self, bool enabled)
{
    const bool active = sync_producer_is_active(&self->sync);

    sync_producer_enable(&self->sync, enabled);
    if (active != sync_producer_is_active(&self->sync))
        self->sync_generation++;
}

/* ---- consumer ---- */

/* How long the application may take for new data. */
static co_us_t answer_time(const struct slave *self)
{
    const co_us_t window = od_number(self->od, WINDOW_LENGTH, 0, 0);
    const co_us_t half = period(self) / 2;

    if (window > 0)
        return window;
    return half > 0 && half < TPDO_ANSWER_TIME ? half : TPDO_ANSWER_TIME;
}

static void consume(struct slave *self, uint8_t counter, co_us_t now, struct co_outbox *out)
{
    const co_us_t window = od_number(self->od, WINDOW_LENGTH, 0, 0);
    const struct tpdo_sync sync = { .counter = counter,
                                    .answer_end = now + answer_time(self),
                                    .window_end = window > 0 ? now + window : CO_NEVER };

    self->window_end = sync.window_end;
    slave_sync_pdos(self, &sync, now, out);
}

static void put_length_event(const struct slave *self, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_SYNC_LENGTH,
                                    .node = self->node,
                                    .detail = self->sync_heard.wrong_size,
                                    .sub = self->sync_heard.length == SYNC_WITH_COUNTER,
                                    .code = EMCY_SYNC_LENGTH };

    co_outbox_put_event(out, &event);
}

static void tell_length(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = { .code = EMCY_SYNC_LENGTH,
                                        .field = { 0, 0, 0, self->sync_heard.wrong_size,
                                                   self->sync_heard.length == SYNC_WITH_COUNTER } };

    if (self->sync_heard.wrong == self->told_sync_wrong || !co_outbox_room(out, 0, 2))
        return;
    self->told_sync_wrong = self->sync_heard.wrong;
    if (!self->sync_heard.wrong) {
        slave_clear_fault(self, now, out);
        return;
    }
    put_length_event(self, out);
    slave_raise_fault(self, &error, false, now, out);
}

bool slave_hear_sync(struct slave *self, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    struct sync_consumer heard = self->sync_heard;
    uint8_t counter = 0;

    if (!self->consumes_sync || !sync_consumer_on_frame(&heard, frame, &counter))
        return false;
    if (!self->sync.enabled)
        return true;
    self->sync_heard = heard;
    sync_producer_on_sync(&self->sync, now);
    consume(self, counter, now, out);
    tell_length(self, now, out);
    return true;
}

/* ---- producer ---- */

static void put_missing_event(const struct slave *self, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_SYNC_MISSING, .node = self->node };

    co_outbox_put_event(out, &event);
}

/* Its own SYNC is one to the device as soon as it is on its way. */
static void step_producer(struct slave *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frames[1], frame;
    struct co_event events[1], event;
    struct co_outbox inner;

    co_outbox_init(&inner, frames, co_outbox_room(out, 1, 0), events, co_outbox_room(out, 0, 1));
    sync_producer_on_time(&self->sync, now, &inner);
    if (co_outbox_take_event(&inner, &event))
        put_missing_event(self, out);
    if (!co_outbox_take_frame(&inner, &frame))
        return;
    co_outbox_put_frame(out, &frame);
    consume(self, frame.data[0], now, out);
}

void slave_step_sync(struct slave *self, co_us_t now, struct co_outbox *out)
{
    tell_length(self, now, out);
    if (sync_producer_deadline(&self->sync) <= now)
        step_producer(self, now, out);
}

co_us_t slave_sync_deadline(const struct slave *self)
{
    return self->sync_heard.wrong != self->told_sync_wrong ? 0
                                                           : sync_producer_deadline(&self->sync);
}

void slave_sync_plan(const struct slave *self, struct slave_sync_plan *ret_plan)
{
    const uint32_t can_id = slave_can_id(self->sync.cob_id);

    *ret_plan = (struct slave_sync_plan){ .active = sync_producer_is_active(&self->sync),
                                          .cob_id = can_id & ~COB_ID_EXT,
                                          .ext = (can_id & COB_ID_EXT) != 0,
                                          .overflow = self->sync.overflow,
                                          .period = self->sync.period };
}

void slave_sync_external(struct slave *self, bool external)
{
    sync_producer_set_external(&self->sync, external);
}

#include "proto/sync.h"

#include "proto/event.h"

#define COB_ID_PRODUCES 0x40000000u
#define COB_ID_EXT      0x20000000u

static bool is_ext(uint32_t cob_id)
{
    return (cob_id & COB_ID_EXT) != 0;
}

static uint32_t can_id(uint32_t cob_id)
{
    return cob_id & (is_ext(cob_id) ? 0x1FFFFFFFu : 0x7FFu);
}

void sync_producer_init(struct sync_producer *self)
{
    *self = (struct sync_producer){ .counter = 1, .deadline = CO_NEVER };
}

bool sync_producer_is_active(const struct sync_producer *self)
{
    return self->enabled && self->period > 0 && (self->cob_id & COB_ID_PRODUCES) != 0;
}

static void begin(struct sync_producer *self)
{
    self->counter = 1;
    self->missing = false;
    self->begins = sync_producer_is_active(self);
    self->deadline = CO_NEVER;
}

void sync_producer_configure(struct sync_producer *self, uint32_t cob_id, co_us_t period,
                             uint8_t overflow)
{
    self->cob_id = cob_id;
    self->period = period;
    self->overflow = overflow;
    begin(self);
}

void sync_producer_enable(struct sync_producer *self, bool enabled)
{
    if (self->enabled == enabled)
        return;
    self->enabled = enabled;
    begin(self);
}

void sync_producer_set_external(struct sync_producer *self, bool external)
{
    if (self->external == external)
        return;
    self->external = external;
    begin(self);
}

static co_us_t patience(const struct sync_producer *self)
{
    return 4 * self->period > SYNC_PATIENCE ? 4 * self->period : SYNC_PATIENCE;
}

void sync_producer_on_sync(struct sync_producer *self, co_us_t now)
{
    if (!self->external || !sync_producer_is_active(self))
        return;
    self->begins = false;
    self->missing = false;
    self->deadline = now + patience(self);
}

static void watch(struct sync_producer *self, struct co_outbox *out)
{
    const struct co_event event = { .type = PROTO_SYNC_MISSING };

    if (!co_outbox_room(out, 0, 1))
        return;
    co_outbox_put_event(out, &event);
    self->missing = true;
    self->outages++;
    self->deadline = CO_NEVER;
}

static void send(struct sync_producer *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = co_frame_make(can_id(self->cob_id), self->overflow > 0 ? 1 : 0);

    if (!co_outbox_room(out, 1, 0))
        return;
    if (is_ext(self->cob_id))
        frame.flags |= CO_FRAME_EXT;
    if (self->overflow > 0)
        frame.data[0] = self->counter;
    co_outbox_put_frame(out, &frame);
    self->counter = self->counter < self->overflow ? (uint8_t)(self->counter + 1) : 1;
    self->deadline += self->period;
    if (self->deadline <= now) /* after a stall: one SYNC, and the pace is kept */
        self->deadline += (now - self->deadline) / self->period * self->period + self->period;
}

void sync_producer_on_time(struct sync_producer *self, co_us_t now, struct co_outbox *out)
{
    if (self->begins) {
        self->begins = false;
        self->deadline = now + (self->external ? patience(self) : self->period);
    }
    if (now < self->deadline)
        return;
    if (self->external)
        watch(self, out);
    else
        send(self, now, out);
}

co_us_t sync_producer_deadline(const struct sync_producer *self)
{
    return self->begins ? 0 : self->deadline;
}

static bool is_expected(const struct sync_consumer *self, uint8_t dlc)
{
    switch ((enum sync_length)self->length) {
    case SYNC_ANY_LENGTH: break;
    case SYNC_WITHOUT_COUNTER: return dlc == 0;
    case SYNC_WITH_COUNTER: return dlc == 1;
    }
    return true;
}

bool sync_consumer_on_frame(struct sync_consumer *self, const struct co_frame *frame,
                            uint8_t *ret_counter)
{
    const unsigned kind = is_ext(self->cob_id) ? CO_FRAME_EXT : 0;

    if (frame->id != can_id(self->cob_id) || (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR)) != kind)
        return false;
    self->wrong = !is_expected(self, frame->dlc);
    if (self->wrong)
        self->wrong_size = frame->dlc;
    *ret_counter = frame->dlc == 1 && self->length != SYNC_WITHOUT_COUNTER ? frame->data[0] : 0;
    return true;
}

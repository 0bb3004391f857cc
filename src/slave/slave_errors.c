#include "slave/slave_internal.h"

#include "base/bytes.h"
#include "proto/event.h"

#include <stdlib.h>
#include <string.h>

#define ERROR_GENERIC       0x01u /* bits of 1001h */
#define ERROR_COMMUNICATION 0x10u

#define EMCY_ERROR_CONTROL    0x8130u /* a watched node has fallen silent */
#define NMT_ERROR_CONTROL_BIT 0x01u   /* in the first byte of the manufacturer specific field */

#define SDO_UPLOAD 0x40u

enum error_behaviour { TO_PREOPERATIONAL = 0, NO_CHANGE = 1, TO_STOPPED = 2 };

struct slave_consumer {
    struct hb_consumer watch;
    uint8_t told_state; /* what the owner and the network know of it */
    bool told_lost;
    bool changed; /* another value was written: nothing is lost any more */
};

static void update_error_register(struct slave *self)
{
    unsigned bits = self->raised;

    if (self->lost > 0 || self->faults > 0)
        bits |= ERROR_COMMUNICATION;
    if (bits != 0)
        bits |= ERROR_GENERIC;
    od_set_number(self->od, 0x1001, 0, bits);
}

static uint8_t highest_sub(const struct od *od, uint16_t index, uint8_t limit)
{
    for (uint8_t sub = limit; sub > 0; sub--)
        if (od_find(od, index, sub) != NULL)
            return sub;
    return 0;
}

static void record_error(struct od *od, const struct emcy_message *error)
{
    const uint8_t capacity = highest_sub(od, 0x1003, 254);
    const uint64_t recorded = od_number(od, 0x1003, 0, 0);
    const uint32_t info = get_le16(error->field);
    uint8_t count = recorded < capacity ? (uint8_t)(recorded + 1) : capacity;

    if (capacity == 0)
        return;
    for (uint8_t sub = count; sub > 1; sub--)
        od_set_number(od, 0x1003, sub, od_number(od, 0x1003, (uint8_t)(sub - 1), 0));
    od_set_number(od, 0x1003, 1, info << 16 | error->code);
    od_set_number(od, 0x1003, 0, count);
}

/* One emergency for what has just changed; there is room for the event. */
static void announce(struct slave *self, const struct emcy_message *error, co_us_t now,
                     struct co_outbox *out)
{
    struct emcy_message message = *error;
    struct co_event event = { .type = SLAVE_EMERGENCY, .node = self->node, .code = error->code };

    update_error_register(self);
    message.error_register = (uint8_t)od_number(self->od, 0x1001, 0, 0);
    if (error->code != 0)
        record_error(self->od, error);
    event.detail = message.error_register;
    put_le16(event.data, message.code);
    event.data[2] = message.error_register;
    memcpy(event.data + 3, message.field, sizeof message.field);
    co_outbox_put_event(out, &event);
    emcy_producer_raise(&self->emcy, &message);
    emcy_producer_on_time(&self->emcy, now, out);
}

enum co_err slave_raise_error(struct slave *self, const struct emcy_message *error, co_us_t now,
                              struct co_outbox *out)
{
    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    self->raised |= error->error_register != 0 ? error->error_register : ERROR_GENERIC;
    announce(self, error, now, out);
    return CO_OK;
}

enum co_err slave_clear_error(struct slave *self, uint8_t bits, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message none = { .code = 0 };

    if (!co_outbox_room(out, 0, 1))
        return CO_ERR_AGAIN;
    self->raised &= (uint8_t)~bits;
    announce(self, &none, now, out);
    return CO_OK;
}

bool slave_history_lacks(const struct slave *self, const struct co_frame *request)
{
    const uint8_t *data = request->data;

    return request->dlc == 8 && (request->flags & CO_FRAME_RTR) == 0 &&
           (data[0] & 0xE0u) == SDO_UPLOAD && get_le16(data + 1) == 0x1003 &&
           od_find(self->od, 0x1003, data[3]) != NULL &&
           data[3] > od_number(self->od, 0x1003, 0, UINT8_MAX);
}

/* ---- heartbeat consumers ---- */

enum co_err slave_make_consumers(struct slave *self)
{
    self->consumer_count = highest_sub(self->od, 0x1016, NMT_NODE_MAX);
    if (self->consumer_count == 0)
        return CO_OK;
    self->consumers = calloc(self->consumer_count, sizeof *self->consumers);
    return self->consumers != NULL ? CO_OK : CO_ERR_MEMORY;
}

void slave_leave_heartbeats(struct slave *self)
{
    self->consumer_count = 0;
}

uint8_t slave_consumer_node(const struct slave *self, unsigned i)
{
    const struct hb_consumer *watch = &self->consumers[i].watch;

    return watch->period > 0 && watch->node <= NMT_NODE_MAX ? watch->node : 0;
}

static void update_consumer_deadline(struct slave *self)
{
    co_us_t deadline = CO_NEVER;

    for (unsigned i = 0; i < self->consumer_count; i++)
        deadline = co_earlier(deadline, hb_consumer_deadline(&self->consumers[i].watch));
    self->consumer_deadline = deadline;
}

void slave_configure_consumer(struct slave *self, uint8_t sub)
{
    const uint64_t entry = od_number(self->od, 0x1016, sub, 0);
    const uint8_t node = (uint8_t)(entry >> 16);
    struct slave_consumer *consumer;

    if (sub < 1 || sub > self->consumer_count)
        return;
    consumer = &self->consumers[sub - 1];
    hb_consumer_init(&consumer->watch, node);
    hb_consumer_start(&consumer->watch, CO_MS(entry & 0xFFFF));
    consumer->told_state = consumer->watch.state;
    consumer->changed = true;
    self->consumers_due = true;
    update_consumer_deadline(self);
}

static void apply_error_behaviour(struct slave *self, co_us_t now, struct co_outbox *out)
{
    switch (od_number(self->od, 0x1029, 1, TO_PREOPERATIONAL)) {
    case TO_PREOPERATIONAL:
        if (self->state == NMT_OPERATIONAL)
            slave_enter_state(self, NMT_PREOPERATIONAL, now, out);
        break;
    case TO_STOPPED:
        if (self->state != NMT_STOPPED)
            slave_enter_state(self, NMT_STOPPED, now, out);
        break;
    default: break;
    }
}

static void put_consumer_event(enum proto_event type, const struct hb_consumer *watch,
                               struct co_outbox *out)
{
    const struct co_event event = { .type = (uint16_t)type,
                                    .node = watch->node,
                                    .detail = watch->state };

    co_outbox_put_event(out, &event);
}

void slave_error_control_lost(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message error = { .code = EMCY_ERROR_CONTROL,
                                        .field = { NMT_ERROR_CONTROL_BIT } };

    self->lost++;
    announce(self, &error, now, out);
    apply_error_behaviour(self, now, out);
}

void slave_error_control_back(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message none = { .code = 0 };

    self->lost--;
    announce(self, &none, now, out);
}

void slave_raise_fault(struct slave *self, const struct emcy_message *error, bool again,
                       co_us_t now, struct co_outbox *out)
{
    struct emcy_message message = *error;

    if (!again)
        self->faults++;
    message.field[0] = self->lost > 0 ? NMT_ERROR_CONTROL_BIT : 0;
    announce(self, &message, now, out);
}

void slave_clear_fault(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct emcy_message none = { .code = 0 };

    self->faults--;
    announce(self, &none, now, out);
}

static void report_lost(struct slave *self, struct slave_consumer *consumer, co_us_t now,
                        struct co_outbox *out)
{
    consumer->told_lost = true;
    consumer->told_state = NMT_INITIALISING;
    put_consumer_event(PROTO_HB_LOST, &consumer->watch, out);
    slave_error_control_lost(self, now, out);
}

/* A boot-up alone does not count, the next heartbeat does. */
static bool is_back(const struct slave_consumer *consumer)
{
    return consumer->changed || consumer->watch.state != NMT_INITIALISING;
}

static void report_present(struct slave *self, struct slave_consumer *consumer, co_us_t now,
                           struct co_outbox *out)
{
    if (consumer->told_state != consumer->watch.state) {
        consumer->told_state = consumer->watch.state;
        put_consumer_event(PROTO_HB_STATE, &consumer->watch, out);
    }
    if (consumer->told_lost && is_back(consumer)) {
        consumer->told_lost = false;
        slave_error_control_back(self, now, out);
    }
}

static bool is_told(const struct slave_consumer *consumer)
{
    if (consumer->watch.lost)
        return consumer->told_lost;
    return consumer->told_state == consumer->watch.state &&
           !(consumer->told_lost && is_back(consumer));
}

/* Tells what is not known yet; false when there is no room. */
static bool report(struct slave *self, struct slave_consumer *consumer, co_us_t now,
                   struct co_outbox *out)
{
    if (!is_told(consumer)) {
        if (!co_outbox_room(out, 1, 3))
            return false;
        if (consumer->watch.lost)
            report_lost(self, consumer, now, out);
        else
            report_present(self, consumer, now, out);
    }
    consumer->changed = false;
    return true;
}

/*
 * The consumers' own events go nowhere: what is to be told is the difference between what a
 * consumer knows and what was told, so that a full outbox loses nothing.
 */
static void step_consumer(struct slave_consumer *consumer, const struct co_frame *frame,
                          co_us_t now)
{
    struct co_frame frames[1];
    struct co_event events[2];
    struct co_outbox unused;

    co_outbox_init(&unused, frames, 1, events, 2);
    if (frame != NULL)
        hb_consumer_on_frame(&consumer->watch, frame, now, &unused);
    else
        hb_consumer_on_time(&consumer->watch, now, &unused);
}

static void report_all(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->consumers_due = false;
    for (unsigned i = 0; i < self->consumer_count; i++)
        if (!report(self, &self->consumers[i], now, out))
            self->consumers_due = true;
    update_consumer_deadline(self);
}

void slave_consume_heartbeat(struct slave *self, const struct co_frame *frame, co_us_t now,
                             struct co_outbox *out)
{
    const uint8_t node = (uint8_t)(frame->id & 0x7Fu);
    bool watched = false;

    for (unsigned i = 0; i < self->consumer_count; i++)
        if (self->consumers[i].watch.node == node) {
            step_consumer(&self->consumers[i], frame, now);
            watched = true;
        }
    if (watched)
        report_all(self, now, out);
}

void slave_watch_consumers(struct slave *self, co_us_t now, struct co_outbox *out)
{
    if (self->consumer_deadline > now && !self->consumers_due)
        return;
    for (unsigned i = 0; i < self->consumer_count; i++)
        step_consumer(&self->consumers[i], NULL, now);
    report_all(self, now, out);
}

/* ---- parameters ---- */

void slave_configure_emcy(struct slave *self)
{
    const uint32_t cob_id = (uint32_t)od_number(self->od, 0x1014, 0, COB_ID_INVALID);
    const co_us_t inhibit = od_number(self->od, 0x1015, 0, 0) * 100;

    emcy_producer_configure(&self->emcy, cob_id, inhibit);
}

void slave_reset_errors(struct slave *self)
{
    self->raised = 0;
    self->lost = 0;
    self->faults = 0;
    self->sync_heard.wrong = false;
    self->told_sync_wrong = false;
    update_error_register(self);
    od_set_number(self->od, 0x1003, 0, 0);
    emcy_producer_init(&self->emcy, COB_ID_INVALID);
    slave_configure_emcy(self);
    for (unsigned i = 0; i < self->consumer_count; i++) {
        self->consumers[i].told_lost = false;
        slave_configure_consumer(self, (uint8_t)(i + 1));
    }
    self->consumers_due = false;
}

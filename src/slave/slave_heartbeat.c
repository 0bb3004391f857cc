#include "slave/slave_internal.h"

#include "proto/event.h"

#include <stdlib.h>

struct slave_consumer {
    struct hb_consumer watch;
    uint8_t told_state; /* what the owner and the network know of it */
    bool told_lost;
    uint8_t told_running; /* the node that is watched, as told; 0: none */
    bool boot_up;         /* its boot-up message was not told yet */
    bool changed;         /* another value was written: nothing is lost any more */
};

enum co_err slave_make_consumers(struct slave *self)
{
    self->consumer_count = slave_highest_sub(self->od, 0x1016, NMT_NODE_MAX);
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

uint8_t slave_watched_node(const struct slave *self, unsigned i)
{
    return self->consumers[i].told_running;
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
    consumer->boot_up = false;
    consumer->changed = true;
    self->consumers_due = true;
    update_consumer_deadline(self);
}

void slave_reset_consumers(struct slave *self)
{
    for (unsigned i = 0; i < self->consumer_count; i++) {
        self->consumers[i].told_lost = false;
        slave_configure_consumer(self, (uint8_t)(i + 1));
    }
}

/* ---- what is to be told ---- */

enum news { NOTHING, BOOTED, LOST, ENDED, BEGUN, OTHER_STATE, BACK };

/* A boot-up alone does not count, the next heartbeat does. */
static bool is_back(const struct slave_consumer *consumer)
{
    return consumer->told_lost && (consumer->changed || consumer->watch.state != NMT_INITIALISING);
}

/* The node whose time runs; 0: none. */
static uint8_t running(const struct slave_consumer *consumer)
{
    return consumer->watch.deadline != CO_NEVER ? consumer->watch.node : 0;
}

static enum news next_news(const struct slave_consumer *consumer)
{
    if (consumer->boot_up)
        return BOOTED;
    if (consumer->watch.lost)
        return consumer->told_lost ? NOTHING : LOST;
    if (consumer->told_running != running(consumer))
        return consumer->told_running != 0 ? ENDED : BEGUN;
    if (consumer->told_state != consumer->watch.state)
        return OTHER_STATE;
    return is_back(consumer) ? BACK : NOTHING;
}

static void put_event(const struct slave_consumer *consumer, uint16_t type, struct co_outbox *out)
{
    const struct co_event event = { .type = type,
                                    .node = consumer->watch.node,
                                    .detail = consumer->watch.state };

    co_outbox_put_event(out, &event);
}

static void put_watch_event(const struct slave_consumer *consumer, uint8_t node,
                            enum slave_watching what, struct co_outbox *out)
{
    const struct co_event event = {
        .type = SLAVE_WATCH, .node = node, .detail = (uint8_t)what, .sub = consumer->watch.state
    };

    co_outbox_put_event(out, &event);
}

static void report_lost(struct slave *self, struct slave_consumer *consumer, co_us_t now,
                        struct co_outbox *out)
{
    consumer->told_lost = true;
    consumer->told_running = 0;
    consumer->told_state = NMT_INITIALISING;
    put_watch_event(consumer, consumer->watch.node, WATCH_TIMEOUT, out);
    slave_error_control_lost(self, now, out);
}

static void report_running(struct slave_consumer *consumer, enum news news, struct co_outbox *out)
{
    const uint8_t node = consumer->told_running;

    consumer->told_running = news == BEGUN ? consumer->watch.node : 0;
    if (news == BOOTED)
        put_watch_event(consumer, consumer->watch.node, WATCH_BOOT_UP, out);
    else if (news == BEGUN)
        put_watch_event(consumer, consumer->watch.node, WATCH_BEGINS, out);
    else
        put_watch_event(consumer, node, WATCH_ENDS, out);
}

static void report_news(struct slave *self, struct slave_consumer *consumer, enum news news,
                        co_us_t now, struct co_outbox *out)
{
    switch (news) {
    case NOTHING: break;
    case LOST: report_lost(self, consumer, now, out); break;
    case BOOTED:
        consumer->boot_up = false;
        report_running(consumer, news, out);
        break;
    case ENDED:
    case BEGUN: report_running(consumer, news, out); break;
    case OTHER_STATE:
        consumer->told_state = consumer->watch.state;
        put_event(consumer, PROTO_HB_STATE, out);
        break;
    case BACK:
        consumer->told_lost = false;
        slave_error_control_back(self, now, out);
        break;
    }
}

/* Tells what is not known yet; false when there is no room. */
static bool report(struct slave *self, struct slave_consumer *consumer, co_us_t now,
                   struct co_outbox *out)
{
    enum news news;

    while ((news = next_news(consumer)) != NOTHING) {
        if (!co_outbox_room(out, 1, news == LOST ? 3 : 1))
            return false;
        report_news(self, consumer, news, now, out);
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
    uint8_t node, state;

    co_outbox_init(&unused, frames, 1, events, 2);
    if (frame != NULL && consumer->watch.period > 0 &&
        nmt_parse_error_control(frame, &node, &state) && state == NMT_INITIALISING)
        consumer->boot_up = true;
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

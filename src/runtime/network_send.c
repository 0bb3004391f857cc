#include "runtime/network_internal.h"

#include "manager/event.h"

#define TX_RETRY   CO_MS(1)   /* the bus had no room */
#define BUS_RETRY  CO_MS(100) /* it is down, or off, or refuses */
#define TELL_PAUSE CO_MS(1000)
#define REFUSED                                                                                    \
    CO_MS(1000) /* the bus says that it is well and refuses frames: until the next try */

void network_tell(struct network *self, struct co_event event)
{
    self->news = CONDITION_ALL;
    if (self->options.sink)
        self->options.sink(self->options.context, self, &event);
}

static bool is_lost(enum bus_state state)
{
    return state == BUS_OFF || state == BUS_DOWN;
}

enum slave_bus network_slave_bus(enum bus_state state)
{
    if (is_lost(state))
        return SLAVE_BUS_LOST;
    return state == BUS_PASSIVE ? SLAVE_BUS_PASSIVE : SLAVE_BUS_OK;
}

/* Frames have the order in which their senders had the network's lock. */
static void wait_for_sender(struct network *self)
{
    if (!self->sender_away)
        return;
    lock_take(&self->sending);
    lock_give(&self->sending);
}

/* False: the bus does not keep up, or is lost, or refuses. */
static bool note_sent(struct network *self, enum co_err err)
{
    if (err == CO_OK)
        self->refused_until = 0;
    else if (err != CO_ERR_AGAIN && !is_lost(bus_get_state(self->bus)))
        self->refused_until = network_clock(self) + REFUSED;
    if (err == CO_ERR_AGAIN && !self->busy_told) {
        self->busy_told = true;
        network_tell(self, (struct co_event){ .type = RUNTIME_BUSY });
    }
    return err == CO_OK;
}

static bool send_frame(struct network *self, const struct co_frame *frame)
{
    wait_for_sender(self);
    return note_sent(self, bus_send(self->bus, frame));
}

/* Frames wait only while the bus does not keep up; then the most urgent one is first. */
static void put_frame(struct network *self, const struct co_frame *frame)
{
    if (tx_queue_first(&self->tx) != NULL || !send_frame(self, frame))
        tx_queue_put(&self->tx, frame, network_clock(self));
}

/* Only who has made a request waits for its end. */
static uint32_t concerned(const struct device *device, const struct co_event *event)
{
    const bool is_for_one = device->manager && event->type == MANAGER_REQUEST_DONE;

    return is_for_one && event->actual != 0 ? (uint32_t)event->actual : CONDITION_ALL;
}

/* Takes what a device has put out; a full queue costs frames, with a count, never time. */
void network_drain(struct network *self, struct device *device)
{
    struct co_frame frame;
    struct co_event event;

    network_follow(self, device);
    while (co_outbox_take_frame(&self->out, &frame)) {
        frame.tag = device->node;
        if (MCANOPEN_TRACE)
            network_trace_frame(self, &frame, device->node);
        put_frame(self, &frame);
        network_expect(self, device, &frame);
    }
    network_follow_sync(self, device);
    while (co_outbox_take_event(&self->out, &event)) {
        self->news |= concerned(device, &event);
        if (device->sink)
            device->sink(device->context, self, &event);
    }
}

static bool is_sent_apart(const struct network *self)
{
    return self->out.frame_count == 1 && self->out.event_count == 0 && !self->sender_away &&
           tx_queue_first(&self->tx) == NULL;
}

/* The network's lock is given when the other one is taken: no other frame comes in between. */
static enum co_err send_apart(struct network *self, const struct co_frame *frame)
{
    enum co_err err;

    self->sender_away = true;
    lock_take(&self->sending);
    lock_give(&self->lock);
    err = bus_send(self->bus, frame);
    lock_give(&self->sending);
    lock_take(&self->lock);
    self->sender_away = false;
    return err;
}

bool network_send_apart(struct network *self, struct device *device)
{
    struct co_frame frame;

    if (!is_sent_apart(self))
        return false;
    network_follow(self, device);
    co_outbox_take_frame(&self->out, &frame);
    frame.tag = device->node;
    if (MCANOPEN_TRACE)
        network_trace_frame(self, &frame, device->node);
    network_expect(self, device, &frame);
    /* When the bus is lost, nobody waits for the frame any more. */
    if (!note_sent(self, send_apart(self, &frame)) && !is_lost(self->bus_state))
        tx_queue_put(&self->tx, &frame, network_clock(self));
    return true;
}

static void tell_lost(struct network *self, co_us_t now)
{
    if (self->tx.lost == 0 || now < self->tx_tell)
        return;
    self->tx_tell = now + TELL_PAUSE;
    network_tell(self, (struct co_event){ .type = RUNTIME_UNSENT,
                                          .detail = (uint8_t)self->bus_state,
                                          .actual = tx_queue_take_lost(&self->tx) });
}

/* The managers end what they are doing: what they wanted to send must not come later. */
static void tell_managers(struct network *self, bool up, co_us_t now)
{
    if (!up)
        tx_queue_lose_all(&self->tx);
    for (unsigned i = 0; i < self->device_count; i++) {
        if (!self->devices[i].manager)
            continue;
        manager_on_bus(self->devices[i].manager, up, now, &self->out);
        network_drain(self, &self->devices[i]);
    }
}

static void tell_slaves(struct network *self, enum bus_state state)
{
    for (unsigned i = 0; i < self->device_count; i++) {
        if (!self->devices[i].slave)
            continue;
        slave_on_bus(self->devices[i].slave, network_slave_bus(state), self->now, &self->out);
        network_drain(self, &self->devices[i]);
    }
}

static void change_state(struct network *self, enum bus_state state)
{
    enum bus_state before = self->bus_state;
    bool returned = network_returns_requests(self);

    if (state == before)
        return;
    self->bus_state = state;
    if (network_returns_requests(self) != returned)
        network_listen(self);
    network_tell(self, (struct co_event){ .type = RUNTIME_BUS_STATE, .detail = (uint8_t)state });
    if (is_lost(before) != is_lost(state))
        tell_managers(self, !is_lost(state), network_clock(self));
    tell_slaves(self, state);
}

/* A connection that was lost and is back before anybody has looked was lost all the same. */
static void look_at_bus(struct network *self, co_us_t now)
{
    enum bus_state state = bus_get_state(self->bus);
    unsigned outages = bus_outages(self->bus);

    if (now >= self->refused_until)
        self->refused_until = 0;
    if ((self->refused_until > 0 || self->receive_fails) && !is_lost(state))
        state = BUS_DOWN;
    if (outages != self->outages && !is_lost(state) && !is_lost(self->bus_state))
        change_state(self, BUS_DOWN);
    self->outages = outages;
    change_state(self, state);
}

static void send_frames(struct network *self, co_us_t now)
{
    const struct co_frame *frame;

    while ((frame = tx_queue_first(&self->tx)) != NULL) {
        if (send_frame(self, frame))
            tx_queue_sent(&self->tx);
        else if (!tx_queue_give_up(&self->tx, now))
            return;
    }
}

void network_flush(struct network *self, co_us_t now)
{
    if (tx_queue_first(&self->tx) != NULL)
        now = network_clock(self);
    send_frames(self, now);
    look_at_bus(self, now);
    self->tx_retry = CO_NEVER;
    if (tx_queue_first(&self->tx) != NULL)
        self->tx_retry = now + (is_lost(self->bus_state) ? BUS_RETRY : TX_RETRY);
    tell_lost(self, now);
}

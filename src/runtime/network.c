#include "runtime/network.h"

#include "port/clock.h"
#include "runtime/tx_queue.h"

#include <stdlib.h>
#include <string.h>

#define OUT_FRAMES 512u
#define OUT_EVENTS 512u
#define RX_BURST   64u        /* frames handled before the lock is given once */
#define TX_RETRY   CO_MS(1)   /* the bus had no room */
#define BUS_RETRY  CO_MS(100) /* it is down, or off, or refuses */
#define TELL_PAUSE CO_MS(1000)
#define REFUSED                                                                                    \
    CO_MS(1000) /* the bus says that it is well and refuses frames: until the next try */

/* What a manager and a slave have in common: the machine's form. */
struct device {
    uint8_t node;
    struct slave *slave; /* one of these two */
    struct manager *manager;
};

struct network {
    struct co_lock lock;
    struct co_condition changed;
    struct co_thread thread;
    struct bus *bus;
    struct network_options options;
    struct device devices[NMT_NODE_MAX + 1];
    unsigned device_count;
    bool closing;
    struct co_outbox out; /* of the device being run */
    struct co_frame out_frames[OUT_FRAMES];
    struct co_event out_events[OUT_EVENTS];
    struct tx_queue tx;
    co_us_t tx_retry; /* CO_NEVER: nothing waits */
    co_us_t tx_tell;  /* when losses may be told again */
    bool busy_told;
    bool receive_fails;
    co_us_t refused_until;    /* 0: it takes frames */
    enum bus_state bus_state; /* as told */
    unsigned outages;         /* of the bus, as last seen */
    bool has_events;          /* since the last signal of changed */
    co_us_t last_frame;       /* time of the frame delivered last */
};

/* --- devices --- */

static void device_start(const struct device *self, co_us_t now, struct co_outbox *out)
{
    if (self->manager)
        manager_start(self->manager, now, out);
    else
        slave_start(self->slave, now, out);
}

static void device_on_frame(const struct device *self, const struct co_frame *frame, co_us_t now,
                            struct co_outbox *out)
{
    if (self->manager)
        manager_on_frame(self->manager, frame, now, out);
    else
        slave_on_frame(self->slave, frame, now, out);
}

static void device_on_time(const struct device *self, co_us_t now, struct co_outbox *out)
{
    if (self->manager)
        manager_on_time(self->manager, now, out);
    else
        slave_on_time(self->slave, now, out);
}

static co_us_t device_deadline(const struct device *self)
{
    return self->manager ? manager_deadline(self->manager) : slave_deadline(self->slave);
}

/* --- sending --- */

static void tell(struct network *self, struct co_event event)
{
    self->has_events = true;
    if (self->options.sink)
        self->options.sink(self->options.context, self, &event);
}

static bool is_lost(enum bus_state state)
{
    return state == BUS_OFF || state == BUS_DOWN;
}

/* False: the bus does not keep up, or is lost, or refuses. */
static bool send_frame(struct network *self, const struct co_frame *frame, co_us_t now)
{
    enum co_err err = bus_send(self->bus, frame);

    if (err == CO_OK)
        self->refused_until = 0;
    else if (err != CO_ERR_AGAIN && !is_lost(bus_get_state(self->bus)))
        self->refused_until = now + REFUSED;
    if (err == CO_ERR_AGAIN && !self->busy_told) {
        self->busy_told = true;
        tell(self, (struct co_event){ .type = RUNTIME_BUSY });
    }
    return err == CO_OK;
}

/* Frames wait only while the bus does not keep up; then the most urgent one is first. */
static void put_frame(struct network *self, const struct co_frame *frame, co_us_t now)
{
    if (tx_queue_first(&self->tx) != NULL || !send_frame(self, frame, now))
        tx_queue_put(&self->tx, frame, now);
}

/* Takes what a device has put out; a full queue costs frames, with a count, never time. */
static void drain(struct network *self, uint8_t node, co_us_t now)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame)) {
        frame.tag = node;
        put_frame(self, &frame, now);
    }
    while (co_outbox_take_event(&self->out, &event))
        tell(self, event);
}

static void tell_lost(struct network *self, co_us_t now)
{
    if (self->tx.lost == 0 || now < self->tx_tell)
        return;
    self->tx_tell = now + TELL_PAUSE;
    tell(self, (struct co_event){ .type = RUNTIME_UNSENT,
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
        drain(self, self->devices[i].node, now);
    }
}

static void change_state(struct network *self, enum bus_state state, co_us_t now)
{
    enum bus_state before = self->bus_state;

    if (state == before)
        return;
    self->bus_state = state;
    tell(self, (struct co_event){ .type = RUNTIME_BUS_STATE, .detail = (uint8_t)state });
    if (is_lost(before) != is_lost(state))
        tell_managers(self, !is_lost(state), now);
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
        change_state(self, BUS_DOWN, now);
    self->outages = outages;
    change_state(self, state, now);
}

static void send_frames(struct network *self, co_us_t now)
{
    const struct co_frame *frame;

    while ((frame = tx_queue_first(&self->tx)) != NULL) {
        if (send_frame(self, frame, now))
            tx_queue_sent(&self->tx);
        else if (!tx_queue_give_up(&self->tx, now))
            return;
    }
}

static void flush_tx(struct network *self, co_us_t now)
{
    send_frames(self, now);
    look_at_bus(self, now);
    self->tx_retry = CO_NEVER;
    if (tx_queue_first(&self->tx) != NULL)
        self->tx_retry = now + (is_lost(self->bus_state) ? BUS_RETRY : TX_RETRY);
    tell_lost(self, now);
}

/* --- the protocol thread --- */

/* Each local device gets the frames of all others, and its own as confirmation. */
static void deliver(struct network *self, const struct bus_rx *rx)
{
    struct co_frame frame = rx->frame;
    bool sent_here = (frame.flags & CO_FRAME_OWN) != 0;

    for (unsigned i = 0; i < self->device_count; i++) {
        const struct device *device = &self->devices[i];

        frame.flags = (uint8_t)(rx->frame.flags & ~CO_FRAME_OWN);
        if (sent_here && frame.tag == device->node)
            frame.flags |= CO_FRAME_OWN;
        device_on_frame(device, &frame, rx->time, &self->out);
        drain(self, device->node, rx->time);
    }
}

static bool receive_burst(struct network *self)
{
    struct bus_rx rx;
    enum co_err err = CO_OK;

    for (unsigned i = 0; i < RX_BURST; i++) {
        err = bus_receive(self->bus, &rx);
        if (err != CO_OK)
            break;
        if (rx.lost)
            tell(self, (struct co_event){ .type = RUNTIME_FRAMES_LOST, .actual = rx.lost });
        self->last_frame = rx.time;
        deliver(self, &rx);
    }
    self->receive_fails = err != CO_OK && err != CO_ERR_AGAIN;
    return err == CO_OK;
}

static void run_due(struct network *self, co_us_t now)
{
    for (unsigned i = 0; i < self->device_count; i++) {
        const struct device *device = &self->devices[i];

        if (device_deadline(device) > now)
            continue;
        device_on_time(device, now, &self->out);
        drain(self, device->node, now);
    }
}

static co_us_t next_deadline(const struct network *self)
{
    co_us_t next = self->tx.lost > 0 ? self->tx_tell : CO_NEVER;

    if (self->refused_until > 0)
        next = co_earlier(next, self->refused_until);
    for (unsigned i = 0; i < self->device_count; i++)
        next = co_earlier(next, device_deadline(&self->devices[i]));
    return co_earlier(next, self->tx_retry);
}

/* True if there was something to signal. */
static bool signal_changes(struct network *self)
{
    bool has_events = self->has_events;

    if (has_events)
        condition_signal(&self->changed);
    self->has_events = false;
    return has_events;
}

static void wait_for_bus(struct network *self, co_us_t deadline)
{
    enum co_err err = bus_wait(self->bus, deadline);

    if (err == CO_OK || err == CO_ERR_TIMEOUT)
        return;
    lock_take(&self->lock); /* the bus is gone: go on with time alone, not in a hurry */
    if (!self->closing)
        condition_wait(&self->changed, &self->lock, co_earlier(deadline, clock_now() + CO_MS(100)));
    lock_give(&self->lock);
}

static void *run(void *context)
{
    struct network *self = context;
    bool closing = false;

    while (!closing) {
        co_us_t now, deadline;
        bool more;

        lock_take(&self->lock);
        more = receive_burst(self);
        /* With more to read, time has only come as far as the frames: an answer that is there
         * already must not be taken for missing. */
        now = more ? self->last_frame : clock_now();
        run_due(self, now);
        flush_tx(self, now);
        deadline = next_deadline(self);
        signal_changes(self);
        closing = self->closing;
        lock_give(&self->lock);
        if (!closing && !more)
            wait_for_bus(self, deadline);
    }
    return NULL;
}

/* --- opening and closing --- */

/* What devices listen to: NMT, emergencies (and SYNC), SDO both ways, error control with the
 * requests of guarding. */
static enum co_err set_filters(struct network *self)
{
    static const struct bus_filter filters[] = {
        { 0x000, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
        { 0x080, 0x780, 0, CO_FRAME_EXT | CO_FRAME_RTR },
        { 0x580, 0x780, 0, CO_FRAME_EXT | CO_FRAME_RTR },
        { 0x600, 0x780, 0, CO_FRAME_EXT | CO_FRAME_RTR },
        { 0x700, 0x780, 0, CO_FRAME_EXT },
    };

    return bus_set_filters(self->bus, filters, sizeof filters / sizeof filters[0]);
}

static enum co_err open_bus(struct network *self, char *message, size_t message_size)
{
    struct bus_options options = { .own_frames = true, .bitrate = self->options.bitrate };
    enum co_err err = CO_OK;

    if (self->options.opened)
        self->bus = self->options.opened;
    else
        err = bus_open(self->options.bus, &options, &self->bus, message, message_size);
    if (err == CO_OK)
        err = set_filters(self);
    return err;
}

enum co_err network_open(const struct network_options *options, struct network **ret_network,
                         char *message, size_t message_size)
{
    struct network *self = calloc(1, sizeof *self);
    enum co_err err;

    if (!self)
        return CO_ERR_MEMORY;
    self->options = *options;
    self->tx_retry = CO_NEVER;
    co_outbox_init(&self->out, self->out_frames, OUT_FRAMES, self->out_events, OUT_EVENTS);
    err = lock_init(&self->lock);
    if (err != CO_OK)
        goto free_self;
    err = condition_init(&self->changed);
    if (err != CO_OK)
        goto done_lock;
    err = open_bus(self, message, message_size);
    if (err == CO_OK) {
        *ret_network = self;
        return CO_OK;
    }
    if (self->bus)
        bus_close(self->bus);
    condition_done(&self->changed);
done_lock:
    lock_done(&self->lock);
free_self:
    free(self);
    return err;
}

void network_shut(struct network *self)
{
    lock_take(&self->lock);
    self->closing = true;
    condition_signal(&self->changed);
    lock_give(&self->lock);
    bus_wake(self->bus);
}

void network_stop(struct network *self)
{
    network_shut(self);
    thread_join(&self->thread);
}

void network_close(struct network *self)
{
    if (!self)
        return;
    network_stop(self);
    bus_close(self->bus);
    condition_done(&self->changed);
    lock_done(&self->lock);
    free(self);
}

static enum co_err add_device(struct network *self, struct device device)
{
    for (unsigned i = 0; i < self->device_count; i++)
        if (self->devices[i].node == device.node)
            return CO_ERR_EXISTS;
    self->devices[self->device_count++] = device;
    return CO_OK;
}

enum co_err network_add_slave(struct network *self, struct slave *slave)
{
    return add_device(self, (struct device){ .node = slave->node, .slave = slave });
}

enum co_err network_add_manager(struct network *self, struct manager *manager)
{
    return add_device(
        self, (struct device){ .node = manager->config->manager_node_id, .manager = manager });
}

enum co_err network_start(struct network *self)
{
    co_us_t now;

    lock_take(&self->lock);
    now = clock_now();
    for (unsigned i = 0; i < self->device_count; i++) {
        device_start(&self->devices[i], now, &self->out);
        drain(self, self->devices[i].node, now);
    }
    flush_tx(self, now);
    lock_give(&self->lock);
    return thread_start(&self->thread, "mcanopen", run, self);
}

enum co_err network_set_priority(struct network *self, int native)
{
    return thread_set_priority(&self->thread, native);
}

bool network_takes(const struct network *self, uint32_t can_id)
{
    const struct co_frame frame = co_frame_make(can_id, 0);

    return tx_queue_takes(&self->tx, &frame);
}

enum bus_state network_bus_state(const struct network *self)
{
    return self->bus_state;
}

const char *network_name(const struct network *self)
{
    return bus_name(self->bus);
}

void network_explain(const struct network *self, char *text, size_t size)
{
    bus_explain(self->bus, text, size);
}

/* --- API calls --- */

struct co_outbox *network_enter(struct network *self, co_us_t *ret_now)
{
    lock_take(&self->lock);
    *ret_now = clock_now();
    return &self->out;
}

/* True if something has happened meanwhile. */
static bool send_out(struct network *self, uint8_t node)
{
    const co_us_t now = clock_now();

    drain(self, node, now);
    flush_tx(self, now);
    bus_wake(self->bus); /* deadlines may have changed */
    return signal_changes(self);
}

void network_leave(struct network *self, uint8_t node)
{
    send_out(self, node);
    lock_give(&self->lock);
}

enum co_err network_wait(struct network *self, uint8_t node, co_us_t deadline)
{
    bool has_news = send_out(self, node);

    if (self->closing)
        return CO_ERR_STATE;
    if (has_news) /* by ourselves: no signal will come for it */
        return CO_OK;
    return condition_wait(&self->changed, &self->lock, deadline);
}

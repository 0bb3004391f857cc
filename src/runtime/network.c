#include "runtime/network.h"

#include "port/clock.h"
#include "runtime/network_internal.h"

#include <stdlib.h>
#include <string.h>

#define RX_BURST 64u /* frames handled before the lock is given once */

/* --- devices --- */

static void device_start(const struct device *self, co_us_t now, struct co_outbox *out)
{
    if (self->manager)
        manager_start(self->manager, now, out);
    else if (self->slave)
        slave_start(self->slave, now, out);
}

static void device_on_frame(const struct device *self, const struct co_frame *frame, co_us_t now,
                            struct co_outbox *out)
{
    if (self->manager)
        manager_on_frame(self->manager, frame, now, out);
    else if (self->slave)
        slave_on_frame(self->slave, frame, now, out);
}

static void device_on_time(const struct device *self, co_us_t now, struct co_outbox *out)
{
    if (self->manager)
        manager_on_time(self->manager, now, out);
    else if (self->slave)
        slave_on_time(self->slave, now, out);
}

static co_us_t device_deadline(const struct device *self)
{
    if (self->manager)
        return manager_deadline(self->manager);
    return self->slave ? slave_deadline(self->slave) : CO_NEVER;
}

struct device *network_device(struct network *self, uint8_t node)
{
    for (unsigned i = 0; i < self->device_count; i++)
        if (self->devices[i].node == node)
            return &self->devices[i];
    return NULL;
}

/* --- the protocol thread --- */

/* Each local device gets the frames of all others, and its own as confirmation. */
static void deliver(struct network *self, const struct bus_rx *rx)
{
    struct co_frame frame = rx->frame;
    bool sent_here = (frame.flags & CO_FRAME_OWN) != 0;

    for (unsigned i = 0; i < self->device_count; i++) {
        struct device *device = &self->devices[i];

        if (rx->time < device->since) /* it was not meant for this one */
            continue;
        frame.flags = (uint8_t)(rx->frame.flags & ~CO_FRAME_OWN);
        if (sent_here && frame.tag == device->node)
            frame.flags |= CO_FRAME_OWN;
        device_on_frame(device, &frame, rx->time, &self->out);
        network_drain(self, device);
    }
}

static void tell_frames_lost(struct network *self, unsigned count)
{
    network_tell(self, (struct co_event){ .type = RUNTIME_FRAMES_LOST, .actual = count });
    for (unsigned i = 0; i < self->device_count; i++) {
        if (!self->devices[i].slave)
            continue;
        slave_on_frames_lost(self->devices[i].slave, self->now, &self->out);
        network_drain(self, &self->devices[i]);
    }
}

/* What the wait has brought; true: there were frames. */
static bool receive_burst(struct network *self)
{
    struct bus_rx rx;
    enum co_err err = CO_OK;
    bool got_frames = false;

    for (unsigned i = 0; i < RX_BURST && bus_has_fetched(self->bus); i++) {
        err = bus_receive(self->bus, &rx);
        if (err != CO_OK)
            break;
        got_frames = true;
        self->last_frame = rx.time;
        self->now = rx.time;
        if (rx.lost)
            tell_frames_lost(self, rx.lost);
        if (MCANOPEN_TRACE && !(rx.frame.flags & CO_FRAME_OWN))
            network_trace_frame(self, &rx.frame, 0);
        deliver(self, &rx);
    }
    self->receive_fails = err != CO_OK && err != CO_ERR_AGAIN;
    return got_frames;
}

static void run_due(struct network *self, co_us_t now)
{
    for (unsigned i = 0; i < self->device_count; i++) {
        struct device *device = &self->devices[i];

        if (device_deadline(device) > now)
            continue;
        device_on_time(device, now, &self->out);
        network_drain(self, device);
    }
}

static co_us_t devices_deadline(const struct network *self)
{
    co_us_t next = CO_NEVER;

    for (unsigned i = 0; i < self->device_count; i++)
        next = co_earlier(next, device_deadline(&self->devices[i]));
    return next;
}

static co_us_t next_deadline(const struct network *self)
{
    co_us_t next = self->tx.lost > 0 ? self->tx_tell : CO_NEVER;

    next = co_earlier(next, self->look);
    if (self->refused_until > 0)
        next = co_earlier(next, self->refused_until);
    next = co_earlier(next, devices_deadline(self));
    return co_earlier(next, self->tx_retry);
}

/* Bits of those in network_wait() who are to be woken. */
static uint32_t take_news(struct network *self)
{
    const uint32_t news = self->news;

    self->news = 0;
    return news;
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

/* Who is woken may run at once, and wants the lock: it is given before. */
static void give_lock(struct network *self)
{
    const uint32_t news = take_news(self);

    lock_give(&self->lock);
    if (news != 0)
        condition_signal_to(&self->changed, news);
}

static void end_step(struct network *self)
{
    struct daemon *woken[DAEMONS_MAX];
    const unsigned count = self->woken_count;

    memcpy(woken, self->woken, sizeof woken);
    self->woken_count = 0;
    self->stepping = false;
    give_lock(self);
    for (unsigned i = 0; i < count; i++)
        daemon_wake(woken[i]);
}

static void begin_step(struct network *self)
{
    lock_take(&self->lock);
    self->stepping = true;
    self->steps++;
}

static void *run(void *context)
{
    struct network *self = context;
    bool closing = false;

    while (!closing) {
        co_us_t now, deadline;
        bool more, got_frames;

        begin_step(self);
        /* With frames, time has only come as far as these: there may be more, and an answer that
         * is there already must not be taken for missing. A wait that brings none tells that. */
        got_frames = receive_burst(self);
        now = got_frames ? self->last_frame : clock_now();
        self->now = now;
        if (!got_frames || !network_is_behind(self, devices_deadline(self), now)) {
            network_confirm(self, now);
            run_due(self, now);
        }
        network_flush(self, now);
        deadline = next_deadline(self);
        closing = self->closing;
        more = bus_has_fetched(self->bus);
        self->sleeps_until = more ? 0 : deadline;
        end_step(self);
        if (!closing && !more)
            wait_for_bus(self, deadline);
    }
    return NULL;
}

/* --- opening and closing --- */

static enum co_err open_bus(struct network *self, char *message, size_t message_size)
{
    struct bus_options options = { .own_frames = true, .bitrate = self->options.bitrate };
    enum co_err err = CO_OK;

    if (self->options.opened)
        self->bus = self->options.opened;
    else
        err = bus_open(self->options.bus, &options, &self->bus, message, message_size);
    if (err == CO_OK)
        err = network_listen(self);
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
    self->tx_retry = self->look = CO_NEVER;
    co_outbox_init(&self->out, self->out_frames, OUT_FRAMES, self->out_events, OUT_EVENTS);
    err = lock_init(&self->lock);
    if (err != CO_OK)
        goto free_self;
    err = lock_init(&self->sending);
    if (err != CO_OK)
        goto done_lock;
    err = condition_init(&self->changed);
    if (err != CO_OK)
        goto done_sending;
    err = open_bus(self, message, message_size);
    if (err == CO_OK) {
        *ret_network = self;
        return CO_OK;
    }
    if (self->bus)
        bus_close(self->bus);
    condition_done(&self->changed);
done_sending:
    lock_done(&self->sending);
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
    lock_done(&self->sending);
    lock_done(&self->lock);
    free(self);
}

enum co_err network_add(struct network *self, uint8_t node, network_sink_fn sink, void *context)
{
    enum co_err err = CO_ERR_EXISTS;

    lock_take(&self->lock);
    if (!network_device(self, node)) {
        self->devices[self->device_count++] = (struct device){ .node = node,
                                                               .sink = sink,
                                                               .context = context };
        err = CO_OK;
    }
    lock_give(&self->lock);
    return err;
}

bool network_has_manager(const struct network *self)
{
    for (unsigned i = 0; i < self->device_count; i++)
        if (self->devices[i].manager)
            return true;
    return false;
}

static enum co_err take_device(struct network *self, struct device *device)
{
    const enum co_err err = network_forget(self, device);

    if (err != CO_OK) {
        device->slave = NULL;
        device->manager = NULL;
    }
    return err;
}

/* What it listens to is about to be set; SYNC is new to us. */
static void note_slave(struct device *device, const struct slave *slave)
{
    device->listen_seen = slave->listen_generation;
    device->sync_seen = slave->sync_generation - 1;
}

enum co_err network_set_slave(struct network *self, uint8_t node, struct slave *slave)
{
    struct device *device = network_device(self, node);

    if (slave) {
        device->since = self->now;
        note_slave(device, slave);
        slave_on_bus(slave, network_slave_bus(self->bus_state), self->now, &self->out);
    }
    device->slave = slave;
    return take_device(self, device);
}

enum co_err network_set_manager(struct network *self, uint8_t node, struct manager *manager)
{
    struct device *device = network_device(self, node);

    if (manager)
        note_slave(device, &manager->device);
    device->manager = manager;
    return take_device(self, device);
}

enum co_err network_add_slave(struct network *self, struct slave *slave)
{
    const enum co_err err = network_add(self, slave->node, self->options.sink,
                                        self->options.context);

    return err == CO_OK ? network_set_slave(self, slave->node, slave) : err;
}

enum co_err network_add_manager(struct network *self, struct manager *manager)
{
    const uint8_t node = manager->config->manager_node_id;
    const enum co_err err = network_add(self, node, self->options.sink, self->options.context);

    return err == CO_OK ? network_set_manager(self, node, manager) : err;
}

void network_retire(struct network *self, uint8_t node)
{
    lock_take(&self->lock);
    network_device(self, node)->retired = true;
    condition_signal(&self->changed);
    lock_give(&self->lock);
}

void network_remove(struct network *self, uint8_t node)
{
    struct device *device;

    lock_take(&self->lock);
    device = network_device(self, node);
    device->slave = NULL;
    device->manager = NULL;
    network_forget(self, device);
    *device = self->devices[--self->device_count];
    lock_give(&self->lock);
}

enum co_err network_run(struct network *self)
{
    return self->thread.running ? CO_OK : thread_start(&self->thread, "mcanopen", run, self);
}

enum co_err network_start(struct network *self)
{
    co_us_t now;

    lock_take(&self->lock);
    now = clock_now();
    for (unsigned i = 0; i < self->device_count; i++) {
        device_start(&self->devices[i], now, &self->out);
        network_drain(self, &self->devices[i]);
    }
    network_flush(self, now);
    lock_give(&self->lock);
    return network_run(self);
}

enum co_err network_claim_priority(struct network *self, int native)
{
    enum co_err err = CO_OK;

    lock_take(&self->lock);
    if (!self->has_priority)
        err = thread_set_priority(&self->thread, native);
    else if (self->priority != native)
        err = CO_ERR_EXISTS;
    if (err == CO_OK) {
        self->has_priority = true;
        self->priority = native;
    }
    lock_give(&self->lock);
    return err;
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
    network_enter_untimed(self, ret_now);
    *ret_now = network_clock(self);
    return &self->out;
}

struct co_outbox *network_enter_untimed(struct network *self, co_us_t *ret_now)
{
    lock_take(&self->lock);
    *ret_now = self->now;
    return &self->out;
}

/* Within a tick of the kernel the last step or call knows the time. */
struct co_outbox *network_enter_recent(struct network *self, co_us_t *ret_now)
{
    lock_take(&self->lock);
    if (clock_coarse() > self->now)
        network_clock(self);
    *ret_now = self->now;
    return &self->out;
}

co_us_t network_clock(struct network *self)
{
    self->now = clock_now();
    return self->now;
}

void network_hold(struct network *self)
{
    lock_take(&self->lock);
}

void network_release(struct network *self)
{
    lock_give(&self->lock);
}

co_us_t network_time(const struct network *self)
{
    return self->now;
}

void network_put(struct network *self, struct daemon *daemon, const void *element)
{
    unsigned i = 0;

    daemon_add(daemon, element);
    while (i < self->woken_count && self->woken[i] != daemon)
        i++;
    if (!self->stepping || i == DAEMONS_MAX)
        daemon_wake(daemon);
    else if (i == self->woken_count)
        self->woken[self->woken_count++] = daemon;
}

/* The step under way is over when the next one begins. */
void network_settle(struct network *self)
{
    unsigned steps;

    lock_take(&self->lock);
    steps = self->steps;
    while (self->steps == steps && !self->closing) {
        bus_wake(self->bus);
        condition_signal(&self->changed); /* it may wait for that, where the bus is gone */
        self->news = CONDITION_ALL;       /* the next step signals */
        condition_wait(&self->changed, &self->lock, CO_NEVER);
    }
    lock_give(&self->lock);
}

void network_poke(struct network *self)
{
    self->news = CONDITION_ALL;
}

static void send_out(struct network *self, uint8_t node)
{
    const co_us_t now = self->now;
    struct device nobody = { .node = node };
    struct device *device = network_device(self, node);

    network_drain(self, device ? device : &nobody);
    network_flush(self, now);
    if (next_deadline(self) < self->sleeps_until)
        bus_wake(self->bus);
}

void network_leave(struct network *self, uint8_t node)
{
    send_out(self, node);
    give_lock(self);
}

uint32_t network_caller(struct network *self)
{
    return 1u << self->callers++ % 32;
}

enum co_err network_wait_as(struct network *self, uint8_t node, uint32_t caller, co_us_t deadline)
{
    struct device *device = network_device(self, node);
    uint32_t news;

    if (device && network_send_apart(self, device))
        return CO_OK;
    send_out(self, node);
    news = take_news(self);
    if (news != 0)
        condition_signal_to(&self->changed, news);
    if (self->closing || (device && device->retired))
        return CO_ERR_STATE;
    if ((news & caller) != 0) /* by ourselves: no signal will come for it */
        return CO_OK;
    return condition_wait_as(&self->changed, caller, &self->lock, deadline);
}

enum co_err network_wait(struct network *self, uint8_t node, co_us_t deadline)
{
    return network_wait_as(self, node, CONDITION_ALL, deadline);
}

#include "port/bus_socketcan.h"

#include "port/bus_tags.h"
#include "port/can_cyclic.h"
#include "port/can_format.h"
#include "port/can_intake.h"
#include "port/can_stamp.h"
#include "port/can_watch.h"
#include "port/clock.h"
#include "port/thread.h"

#include <errno.h>
#include <limits.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define RECEIVE_BUFFER (4 * 1024 * 1024) /* bytes; some thousand frames */

/* Not the lost arbitrations (they are normal) and bus errors (they come as fast as frames). */
#define ERROR_FRAMES (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL | CAN_ERR_ACK)

struct bus_socketcan {
    struct bus bus;
    const struct socketcan_calls *calls;
    int fd;
    struct can_intake intake;
    uint32_t overflows;  /* of the socket, as last seen */
    unsigned lost;       /* not yet told */
    struct co_lock lock; /* of what the thread that waits shares with the others: */
    bool own_frames;
    struct can_watch watch;
    struct bus_tags tags;
    unsigned tags_outages; /* when they were last forgotten */
    struct can_cyclic cyclic;
    struct can_stamp stamp;
    struct bus_filter *filters;
    size_t filter_count;
};

static struct bus_socketcan *to_socketcan(struct bus *bus)
{
    return (struct bus_socketcan *)bus;
}

/* --- sending --- */

/* False: the frame will not come back. */
static bool expect_back(struct bus_socketcan *self, const struct co_frame *frame)
{
    bool expected;

    lock_take(&self->lock);
    expected = self->own_frames && bus_filters_pass(self->filters, self->filter_count, frame);
    if (expected)
        bus_tags_push(&self->tags, frame);
    lock_give(&self->lock);
    return expected;
}

/* What was on its way when the connection was lost does not come back. */
static void forget_sent(struct bus_socketcan *self)
{
    if (self->bus.outages != self->tags_outages)
        self->tags.count = 0;
    self->tags_outages = self->bus.outages;
}

static enum co_err follow_cyclic(struct bus_socketcan *self)
{
    int index = can_watch_state(&self->watch) < BUS_OFF ? self->watch.bound : 0;

    return can_cyclic_follow(&self->cyclic, index, self->bus.outages);
}

/* Under the lock, when the state may have changed. */
static void follow_state(struct bus_socketcan *self)
{
    forget_sent(self);
    follow_cyclic(self); /* where it fails, the next news are waited for */
}

/* What a call has run into; the kernel is asked how the interface is. */
static void doubt_interface(struct bus_socketcan *self)
{
    lock_take(&self->lock);
    can_watch_doubt(&self->watch);
    follow_state(self);
    lock_give(&self->lock);
}

static enum co_err why_not(struct bus_socketcan *self)
{
    enum co_err err;

    lock_take(&self->lock);
    err = can_watch_error(&self->watch);
    lock_give(&self->lock);
    return err;
}

static enum co_err socketcan_send(struct bus *bus, const struct co_frame *frame)
{
    struct bus_socketcan *self = to_socketcan(bus);
    struct can_frame raw = can_format_frame(frame);
    enum co_err err = CO_OK;
    bool expected;

    if (can_watch_state(&self->watch) >= BUS_OFF) /* the kernel might drop it and say nothing */
        err = why_not(self);
    if (err)
        return err;
    expected = expect_back(self, frame); /* before: it may come back at once */
    if (self->calls->send(self->fd, &raw, sizeof raw, MSG_DONTWAIT) >= 0)
        return CO_OK;
    err = can_parse_error(errno);
    if (expected) {
        lock_take(&self->lock);
        bus_tags_take_back(&self->tags, frame);
        lock_give(&self->lock);
    }
    if (err == CO_ERR_DOWN || err == CO_ERR_NO_BUS)
        doubt_interface(self);
    return err;
}

/* --- receiving --- */

/* The time of reception; the losses are added up. */
static co_us_t read_control(struct bus_socketcan *self, struct msghdr *message)
{
    struct timespec stamp;
    uint32_t overflows;
    co_us_t time = 0;

    for (struct cmsghdr *part = CMSG_FIRSTHDR(message); part; part = CMSG_NXTHDR(message, part)) {
        if (part->cmsg_level != SOL_SOCKET)
            continue;
        if (part->cmsg_type == SO_RXQ_OVFL) {
            memcpy(&overflows, CMSG_DATA(part), sizeof overflows);
            self->lost += overflows - self->overflows;
            self->overflows = overflows;
        } else if (part->cmsg_type == SCM_TIMESTAMPNS) {
            memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
            time = can_stamp_time(&self->stamp, &stamp);
        }
    }
    return time != 0 ? time : clock_now();
}

/* False: it is not asked for any more. */
static bool mark_own(struct bus_socketcan *self, struct co_frame *frame)
{
    bool wanted;

    lock_take(&self->lock);
    frame->tag = bus_tags_confirm(&self->tags, frame);
    wanted = self->own_frames;
    lock_give(&self->lock);
    frame->flags |= CO_FRAME_OWN;
    return wanted;
}

static void take_error_frame(struct bus_socketcan *self, const struct can_frame *frame)
{
    lock_take(&self->lock);
    can_watch_on_error_frame(&self->watch, frame);
    self->lost += self->watch.overruns;
    self->watch.overruns = 0;
    follow_state(self);
    lock_give(&self->lock);
}

/* True: it is a frame for the stack. */
static bool take_frame(struct bus_socketcan *self, struct can_message *message,
                       struct bus_rx *ret_rx)
{
    bool is_ours = can_watch_state(&self->watch) != BUS_DOWN; /* else of another interface's */

    ret_rx->time = read_control(self, &message->head);
    if (message->result != CAN_MTU)
        return false;
    if (message->frame.can_id & CAN_ERR_FLAG) {
        take_error_frame(self, &message->frame);
        return false;
    }
    ret_rx->frame = can_parse_frame(&message->frame);
    if ((message->head.msg_flags & MSG_CONFIRM) && !mark_own(self, &ret_rx->frame))
        return false;
    return is_ours;
}

/* The reason for no message. */
static enum co_err fail_receive(struct bus_socketcan *self, enum co_err err)
{
    if (err == CO_ERR_AGAIN && can_watch_state(&self->watch) == BUS_DOWN)
        return why_not(self);
    if (err == CO_ERR_DOWN || err == CO_ERR_NO_BUS || err == CO_ERR_IO)
        doubt_interface(self);
    return err;
}

static enum co_err socketcan_receive(struct bus *bus, struct bus_rx *ret_rx)
{
    struct bus_socketcan *self = to_socketcan(bus);
    struct bus_rx rx = { .lost = 0 };
    struct can_message *message;

    do {
        message = can_intake_take(&self->intake);
        if (!message)
            return fail_receive(self, CO_ERR_AGAIN);
        if (message->result < 0)
            return fail_receive(self, can_parse_error(-message->result));
    } while (!take_frame(self, message, &rx));
    rx.lost = self->lost;
    self->lost = 0;
    *ret_rx = rx;
    return CO_OK;
}

static bool socketcan_has_fetched(struct bus *bus)
{
    return can_intake_has(&to_socketcan(bus)->intake);
}

/* --- what is wanted --- */

/* Without any (count 0) all data frames with 11-bit identifiers. */
static enum co_err set_kernel_filters(struct bus_socketcan *self, const struct bus_filter *filters,
                                      size_t count)
{
    static const struct bus_filter plain = { .flags_mask = CO_FRAME_EXT | CO_FRAME_RTR };
    size_t raw_count = count > 0 ? count : 1;
    struct can_filter *raw = calloc(raw_count, sizeof *raw);
    int error;

    if (!raw)
        return CO_ERR_MEMORY;
    raw[0] = can_format_filter(&plain);
    for (size_t i = 0; i < count; i++)
        raw[i] = can_format_filter(&filters[i]);
    error = self->calls->setsockopt(self->fd, SOL_CAN_RAW, CAN_RAW_FILTER, raw,
                                    (socklen_t)(raw_count * sizeof *raw));
    free(raw);
    return error < 0 ? CO_ERR_IO : CO_OK;
}

/* Under the lock, else binding anew could set the old ones meanwhile. */
static enum co_err replace_filters(struct bus_socketcan *self, struct bus_filter *filters,
                                   size_t count)
{
    enum co_err err = set_kernel_filters(self, filters, count);

    if (err)
        return err;
    free(self->filters);
    self->filters = filters;
    self->filter_count = count;
    return CO_OK;
}

static enum co_err socketcan_set_filters(struct bus *bus, const struct bus_filter *filters,
                                         size_t count)
{
    struct bus_socketcan *self = to_socketcan(bus);
    struct bus_filter *copy = malloc((count + 1) * sizeof *copy);
    enum co_err err;

    if (!copy)
        return CO_ERR_MEMORY;
    if (count > 0)
        memcpy(copy, filters, count * sizeof *copy);
    lock_take(&self->lock);
    err = replace_filters(self, copy, count);
    lock_give(&self->lock);
    if (err)
        free(copy);
    return err;
}

static int set_int(const struct bus_socketcan *self, int level, int option, int value)
{
    return self->calls->setsockopt(self->fd, level, option, &value, sizeof value);
}

static enum co_err socketcan_set_own_frames(struct bus *bus, bool on)
{
    struct bus_socketcan *self = to_socketcan(bus);
    enum co_err err = CO_OK;

    lock_take(&self->lock);
    if (set_int(self, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, on) < 0)
        err = CO_ERR_IO;
    else
        self->own_frames = on;
    lock_give(&self->lock);
    return err;
}

/* Under the lock. Without the interface they wait for it like everything else. */
static enum co_err begin_cyclic(struct bus_socketcan *self)
{
    enum co_err err = follow_cyclic(self);

    if (err == CO_ERR_DOWN || err == CO_ERR_NO_BUS) {
        can_watch_doubt(&self->watch);
        follow_state(self);
        return CO_OK;
    }
    if (err)
        can_cyclic_set(&self->cyclic, NULL, 0, 0);
    return err;
}

static enum co_err socketcan_set_cyclic(struct bus *bus, const struct co_frame *frames,
                                        unsigned count, co_us_t period)
{
    struct bus_socketcan *self = to_socketcan(bus);
    enum co_err err;

    lock_take(&self->lock);
    can_cyclic_set(&self->cyclic, frames, count, period);
    err = begin_cyclic(self);
    lock_give(&self->lock);
    return err;
}

/* --- the interface --- */

/* Of the interface that went away the kernel has dropped the filters, too. */
static enum co_err bind_to(struct bus_socketcan *self, int index)
{
    const struct sockaddr_can address = { .can_family = AF_CAN, .can_ifindex = index };
    enum co_err err = set_kernel_filters(self, self->filters, self->filter_count);

    if (err)
        return err;
    return self->calls->bind(self->fd, (const struct sockaddr *)&address, sizeof address) < 0
               ? can_parse_error(errno)
               : CO_OK;
}

/* Under the lock: what the news ask for. Where binding fails, the interface is gone again. */
static enum co_err follow_interface(struct bus_socketcan *self)
{
    int index = can_watch_bind_due(&self->watch);
    enum co_err err = CO_OK;

    if (index != 0)
        err = bind_to(self, index);
    if (index != 0 && err == CO_OK)
        can_watch_bound(&self->watch, index);
    follow_state(self);
    return err;
}

static void read_news(struct bus_socketcan *self)
{
    lock_take(&self->lock);
    can_watch_read(&self->watch);
    follow_interface(self);
    lock_give(&self->lock);
}

static enum co_err socketcan_wait(struct bus *bus, co_us_t deadline)
{
    struct bus_socketcan *self = to_socketcan(bus);
    bool has_news;
    enum co_err err = can_intake_wait(&self->intake, deadline, &has_news);

    if (has_news)
        read_news(self);
    return err;
}

static void socketcan_wake(struct bus *bus)
{
    can_intake_wake(&to_socketcan(bus)->intake);
}

/* --- state --- */

/* A frame is charged to the socket until the driver has it. */
static unsigned socketcan_backlog(struct bus *bus)
{
    const struct bus_socketcan *self = to_socketcan(bus);
    uint32_t memory[SK_MEMINFO_VARS] = { 0 };
    socklen_t size = sizeof memory;

    if (self->calls->getsockopt(self->fd, SOL_SOCKET, SO_MEMINFO, memory, &size) < 0)
        return 0;
    return memory[SK_MEMINFO_WMEM_ALLOC];
}

static enum bus_state socketcan_get_state(struct bus *bus)
{
    return can_watch_state(&to_socketcan(bus)->watch);
}

static void socketcan_explain(struct bus *bus, char *text, size_t size)
{
    struct bus_socketcan *self = to_socketcan(bus);
    const struct bus_message message = { text, size };

    lock_take(&self->lock);
    can_watch_explain(&self->watch, &message);
    lock_give(&self->lock);
}

/* --- opening and closing --- */

static enum co_err open_socket(struct bus_socketcan *self, const struct bus_message *message)
{
    self->fd = self->calls->socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    if (self->fd >= 0)
        return CO_OK;
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
        return bus_fail(message, CO_ERR_NO_BUS,
                        "%s: this kernel has no CAN support (run: modprobe can_raw); "
                        "\"virtual:NAME\" works without",
                        self->watch.name);
    }
    if (errno == EPERM || errno == EACCES) {
        return bus_fail(message, CO_ERR_PERMISSION,
                        "%s: no right to open a CAN socket: %s; allow AF_CAN to this container or "
                        "service",
                        self->watch.name, strerror(errno));
    }
    return bus_fail(message, can_parse_error(errno), "%s: cannot open a CAN socket: %s",
                    self->watch.name, strerror(errno));
}

static enum co_err configure_socket(struct bus_socketcan *self)
{
    /* Beyond the system's limit only with CAP_NET_ADMIN; else as much as it allows. */
    if (set_int(self, SOL_SOCKET, SO_RCVBUFFORCE, RECEIVE_BUFFER) < 0)
        set_int(self, SOL_SOCKET, SO_RCVBUF, RECEIVE_BUFFER);
    if (set_int(self, SOL_SOCKET, SO_RXQ_OVFL, 1) < 0 ||
        set_int(self, SOL_SOCKET, SO_TIMESTAMPNS, 1) < 0 ||
        set_int(self, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, self->own_frames) < 0 ||
        set_int(self, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, ERROR_FRAMES) < 0)
        return CO_ERR_IO;
    return socketcan_set_filters(&self->bus, NULL, 0);
}

static enum co_err connect_interface(struct bus_socketcan *self, const struct bus_message *message)
{
    enum co_err err = can_watch_open(&self->watch, message);

    if (err)
        return err;
    err = configure_socket(self);
    if (!err)
        err = follow_interface(self);
    if (err)
        return bus_fail(message, err, "%s: cannot use the CAN socket: %s", self->watch.name,
                        strerror(errno));
    self->intake.fd = self->fd;
    self->intake.news = self->watch.fd;
    if (can_intake_open(&self->intake) != CO_OK)
        return bus_fail(message, CO_ERR_IO, "%s: %s", self->watch.name, strerror(errno));
    return CO_OK;
}

static void socketcan_close(struct bus *bus)
{
    struct bus_socketcan *self = to_socketcan(bus);

    can_intake_close(&self->intake);
    if (self->fd >= 0)
        close(self->fd);
    can_cyclic_close(&self->cyclic);
    can_watch_close(&self->watch);
    lock_done(&self->lock);
    free(self->filters);
    free(self);
}

static const struct bus_ops socketcan_ops = { .close = socketcan_close,
                                              .send = socketcan_send,
                                              .receive = socketcan_receive,
                                              .has_fetched = socketcan_has_fetched,
                                              .wait = socketcan_wait,
                                              .wake = socketcan_wake,
                                              .set_filters = socketcan_set_filters,
                                              .set_own_frames = socketcan_set_own_frames,
                                              .set_cyclic = socketcan_set_cyclic,
                                              .backlog = socketcan_backlog,
                                              .get_state = socketcan_get_state,
                                              .explain = socketcan_explain };

static struct bus_socketcan *new_socketcan(const struct socketcan_calls *calls, const char *name,
                                           const struct bus_options *options)
{
    struct bus_socketcan *self = calloc(1, sizeof *self);

    if (!self)
        return NULL;
    if (lock_init(&self->lock) != CO_OK) {
        free(self);
        return NULL;
    }
    self->bus.ops = &socketcan_ops;
    self->calls = calls;
    self->fd = -1;
    self->intake = (struct can_intake){ .calls = calls, .wake = -1 };
    self->own_frames = options->own_frames;
    self->cyclic = (struct can_cyclic){ .calls = calls, .fd = -1 };
    self->watch = (struct can_watch){
        .calls = calls, .fd = -1, .kbit = options->bitrate, .outages = &self->bus.outages
    };
    memcpy(self->watch.name, name, strlen(name) + 1);
    return self;
}

enum co_err bus_socketcan_open_with(const struct socketcan_calls *calls, const char *name,
                                    const struct bus_options *options, struct bus **ret_bus,
                                    const struct bus_message *message)
{
    struct bus_socketcan *self;
    enum co_err err;

    if (name[0] == '\0' || strlen(name) >= IFNAMSIZ || strpbrk(name, "/: \t\n"))
        return bus_fail(message, CO_ERR_ARG,
                        "\"%s\" is no name of an interface, nor \"virtual:NAME\"", name);
    self = new_socketcan(calls, name, options);
    if (!self)
        return bus_fail(message, CO_ERR_MEMORY, "%s: out of memory", name);
    err = open_socket(self, message);
    if (!err)
        err = connect_interface(self, message);
    if (err) {
        socketcan_close(&self->bus);
        return err;
    }
    *ret_bus = &self->bus;
    return CO_OK;
}

const struct socketcan_calls socketcan_system_calls = { .socket = socket,
                                                        .connect = connect,
                                                        .bind = bind,
                                                        .setsockopt = setsockopt,
                                                        .getsockopt = getsockopt,
                                                        .send = send,
                                                        .recvmsg = recvmsg,
                                                        .recvmmsg = recvmmsg,
                                                        .io_uring_setup = io_ring_setup };

enum co_err bus_socketcan_open(const char *name, const struct bus_options *options,
                               struct bus **ret_bus, const struct bus_message *message)
{
    return bus_socketcan_open_with(&socketcan_system_calls, name, options, ret_bus, message);
}

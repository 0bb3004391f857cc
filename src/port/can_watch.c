#include "port/can_watch.h"

#include "port/clock.h"

#include <errno.h>
#include <linux/can/error.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define ANSWER_LIMIT  CO_MS(1000) /* the kernel answers at once */
#define SHORT_QUEUE   100u        /* the default of 10 frames is soon full when a network boots */
#define DEFAULT_SPEED 500000u     /* for a command, where none is configured */

/* --- the state --- */

static bool is_connected(const struct can_watch *self)
{
    return self->link.index != 0 && self->link.is_up && !self->doubted &&
           self->bound == self->link.index && !can_link_has_other_bitrate(&self->link, self->kbit);
}

static void update(struct can_watch *self)
{
    enum bus_state state = is_connected(self) ? self->link.controller : BUS_DOWN;

    if (state >= BUS_OFF && self->state < BUS_OFF)
        (*self->outages)++;
    if (state == BUS_ACTIVE && self->state != BUS_ACTIVE)
        self->unacknowledged = false;
    self->state = state;
}

enum bus_state can_watch_state(const struct can_watch *self)
{
    return (enum bus_state)self->state;
}

enum co_err can_watch_error(const struct can_watch *self)
{
    if (can_watch_state(self) < BUS_OFF)
        return CO_OK;
    return self->link.index == 0 ? CO_ERR_NO_BUS : CO_ERR_DOWN;
}

int can_watch_bind_due(const struct can_watch *self)
{
    bool is_usable = self->link.index != 0 && self->link.is_up && self->link.is_can &&
                     !can_link_has_other_bitrate(&self->link, self->kbit);

    return is_usable && self->bound != self->link.index ? self->link.index : 0;
}

void can_watch_bound(struct can_watch *self, int index)
{
    self->bound = index;
    update(self);
}

/* --- error frames --- */

/* What the controller says about itself, if it does. */
static enum bus_state state_told(const struct can_frame *frame, enum bus_state otherwise)
{
    if (frame->can_id & CAN_ERR_BUSOFF)
        return BUS_OFF;
    if (frame->can_id & CAN_ERR_RESTARTED)
        return BUS_ACTIVE;
    if (!(frame->can_id & CAN_ERR_CRTL))
        return otherwise;
    if (frame->data[1] & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE))
        return BUS_PASSIVE;
    if (frame->data[1] & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING))
        return BUS_WARNING;
    return frame->data[1] & CAN_ERR_CRTL_ACTIVE ? BUS_ACTIVE : otherwise;
}

void can_watch_on_error_frame(struct can_watch *self, const struct can_frame *frame)
{
    self->link.controller = state_told(frame, self->link.controller);
    if (frame->can_id & CAN_ERR_ACK)
        self->unacknowledged = true;
    if ((frame->can_id & CAN_ERR_CRTL) && (frame->data[1] & CAN_ERR_CRTL_RX_OVERFLOW))
        self->overruns++;
    update(self);
}

/* --- news of the kernel --- */

static void forget_link(struct can_watch *self)
{
    self->link = (struct can_link){ .index = 0 };
    self->bound = 0;
    self->doubted = false;
}

static void take_link(struct can_watch *self, const struct can_link *link)
{
    bool is_same = link->index == self->link.index && link->is_up && self->link.is_up;
    enum bus_state controller = self->link.controller;

    if (link->index != self->link.index)
        self->bound = 0;
    self->link = *link;
    self->doubted = false;
    self->answered = true;
    if (is_same && !link->is_controller) /* it does not know */
        self->link.controller = controller;
}

static void take_news(struct can_watch *self, const struct can_link_news *news)
{
    bool is_named = strcmp(news->link.name, self->name) == 0;
    bool is_ours = news->link.index == self->link.index;

    switch (news->type) {
    case CAN_LINK_IS:
        if (is_named)
            take_link(self, &news->link);
        else if (is_ours) /* it has got another name */
            forget_link(self);
        break;
    case CAN_LINK_GONE:
        if (is_ours)
            forget_link(self);
        break;
    case CAN_LINK_REFUSED:
        if (news->error != ENODEV)
            break;
        forget_link(self);
        self->answered = true;
        break;
    }
    update(self);
}

static void ask(struct can_watch *self)
{
    uint8_t request[CAN_LINK_REQUEST_MAX];
    size_t size = can_link_request(self->name, request);

    self->calls->send(self->fd, request, size, 0); /* refused: news will come all the same */
}

/* One datagram; false: there is none. */
static bool read_datagram(struct can_watch *self)
{
    uint8_t bytes[CAN_LINK_MESSAGE_MAX];
    struct sockaddr_nl sender = { .nl_pid = 0 };
    struct iovec data = { bytes, sizeof bytes };
    struct msghdr message = {
        .msg_name = &sender, .msg_namelen = sizeof sender, .msg_iov = &data, .msg_iovlen = 1
    };
    ssize_t size = self->calls->recvmsg(self->fd, &message, 0);
    struct can_link_reader reader = { bytes, size > 0 ? (size_t)size : 0 };
    struct can_link_news news;

    if (size < 0 && errno == ENOBUFS) { /* news were lost */
        ask(self);
        return true;
    }
    if (size <= 0)
        return false;
    while (sender.nl_pid == 0 && can_link_next(&reader, &news))
        take_news(self, &news);
    return true;
}

void can_watch_read(struct can_watch *self)
{
    while (read_datagram(self))
        ;
}

void can_watch_doubt(struct can_watch *self)
{
    if (self->doubted)
        return;
    self->doubted = true;
    update(self);
    ask(self);
}

/* --- text --- */

static enum co_err say_absent(const struct can_watch *self, const struct bus_message *message)
{
    return bus_fail(message, CO_ERR_NO_BUS,
                    "%s: no such CAN interface; ip -br link show type can lists them, "
                    "\"virtual:NAME\" needs no interface",
                    self->name);
}

static enum co_err say_bitrate(const struct can_watch *self, const struct bus_message *message)
{
    const char *name = self->name;

    return bus_fail(message, CO_ERR_BITRATE,
                    "%s is at %u bit/s, configured are %u; run: ip link set %s down; "
                    "ip link set %s up type can bitrate %u restart-ms 100",
                    name, self->link.bitrate, self->kbit * 1000, name, name, self->kbit * 1000);
}

static enum co_err say_down(const struct can_watch *self, const struct bus_message *message)
{
    const char *name = self->name;

    if (!self->link.is_controller ||
        (self->link.bitrate != 0 && !can_link_has_other_bitrate(&self->link, self->kbit)))
        return bus_fail(message, CO_ERR_DOWN, "%s is down; run: ip link set %s up", name, name);
    return bus_fail(message, CO_ERR_DOWN,
                    "%s is down; run: ip link set %s up type can bitrate %u restart-ms 100", name,
                    name, self->kbit > 0 ? self->kbit * 1000 : DEFAULT_SPEED);
}

static enum co_err say_off(const struct can_watch *self, const struct bus_message *message)
{
    const char *name = self->name;

    if (self->link.restart_ms > 0 || !self->link.is_controller)
        return bus_fail(message, CO_ERR_DOWN,
                        "%s is bus-off and tries again after %u ms; check cable, termination and "
                        "bit rate",
                        name, self->link.restart_ms);
    return bus_fail(message, CO_ERR_DOWN,
                    "%s is bus-off and stays so; check cable, termination and bit rate, then run: "
                    "ip link set %s type can restart; or have it try by itself: ip link set %s "
                    "down; ip link set %s up type can restart-ms 100",
                    name, name, name, name);
}

/* ", 500000 bit/s", where it has one. */
static const char *bitrate_text(const struct can_watch *self, char text[32])
{
    text[0] = '\0';
    if (self->link.bitrate != 0)
        snprintf(text, 32, ", %u bit/s", self->link.bitrate);
    return text;
}

static enum co_err say_up(const struct can_watch *self, const struct bus_message *message)
{
    static const char *const states[] = { "error active", "error warning", "error passive" };
    const char *name = self->name, *state = states[self->link.controller];
    const char *hint = self->unacknowledged
                           ? ": nobody acknowledges; is another node there, at this bit rate?"
                           : "";
    char rate[32];

    if (!self->link.is_controller && self->link.controller == BUS_ACTIVE)
        return bus_fail(message, CO_OK, "%s is up", name);
    if (self->link.queue_length >= SHORT_QUEUE || !self->link.is_controller)
        return bus_fail(message, CO_OK, "%s is up%s, %s%s", name, bitrate_text(self, rate), state,
                        hint);
    return bus_fail(message, CO_OK,
                    "%s is up%s, %s%s; its queue has room for %u frames, better run: "
                    "ip link set %s txqueuelen 1000",
                    name, bitrate_text(self, rate), state, hint, self->link.queue_length, name);
}

static enum co_err say_no_can(const struct can_watch *self, const struct bus_message *message)
{
    return bus_fail(message, CO_ERR_NO_BUS,
                    "%s is not a CAN interface; ip -br link show type can lists them", self->name);
}

enum co_err can_watch_explain(const struct can_watch *self, const struct bus_message *message)
{
    if (self->link.index == 0)
        return say_absent(self, message);
    if (!self->link.is_can)
        return say_no_can(self, message);
    if (!self->link.is_up)
        return say_down(self, message);
    if (can_link_has_other_bitrate(&self->link, self->kbit))
        return say_bitrate(self, message);
    if (self->link.controller == BUS_OFF)
        return say_off(self, message);
    return say_up(self, message);
}

/* --- opening and closing --- */

static enum co_err open_socket(struct can_watch *self)
{
    const struct sockaddr_nl address = { .nl_family = AF_NETLINK, .nl_groups = RTMGRP_LINK };

    self->fd = self->calls->socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK,
                                   NETLINK_ROUTE);
    if (self->fd < 0 ||
        self->calls->bind(self->fd, (const struct sockaddr *)&address, sizeof address) < 0)
        return errno == EPERM || errno == EACCES ? CO_ERR_PERMISSION : CO_ERR_IO;
    return CO_OK;
}

static void wait_for_answer(struct can_watch *self)
{
    struct bus_poll poll = { .fd = { self->fd, -1, -1 } };
    co_us_t limit = clock_now() + ANSWER_LIMIT;

    ask(self);
    can_watch_read(self);
    while (!self->answered && bus_poll_until(&poll, limit) == CO_OK)
        can_watch_read(self);
}

enum co_err can_watch_open(struct can_watch *self, const struct bus_message *message)
{
    const struct bus_message nowhere = { NULL, 0 };
    enum co_err err;

    self->state = BUS_DOWN;
    err = open_socket(self);
    if (err)
        return bus_fail(message, err, "%s: cannot follow the interface by a netlink socket: %s",
                        self->name, strerror(errno));
    wait_for_answer(self);
    if (!self->answered)
        return bus_fail(message, CO_ERR_IO, "%s: the kernel does not tell about the interface",
                        self->name);
    if (self->link.is_up && self->link.controller == BUS_OFF && can_watch_bind_due(self) != 0)
        return CO_OK; /* it may come back */
    err = can_watch_explain(self, &nowhere);
    return err == CO_OK ? CO_OK : can_watch_explain(self, message);
}

void can_watch_close(struct can_watch *self)
{
    if (self->fd >= 0)
        close(self->fd);
}

#include "port/bus_socketcan.h"

#include "port/bus_tags.h"
#include "port/clock.h"
#include "port/thread.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if_arp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

#define RECEIVE_BUFFER (4 * 1024 * 1024) /* bytes; some thousand frames */
#define STAMP_AGE_MAX  CO_MS(10000)      /* an older one means that the wall clock was set */

struct bus_socketcan {
    struct bus bus;
    const struct socketcan_calls *calls;
    char name[IFNAMSIZ];
    int fd;
    int wake; /* eventfd of bus_wake() */
    int index;
    uint32_t overflows; /* of the socket, as last seen */
    bool own_frames;
    struct co_lock lock; /* of what the sending and the receiving thread share: */
    struct bus_tags tags;
    struct bus_filter *filters;
    size_t filter_count;
};

static struct bus_socketcan *to_socketcan(struct bus *bus)
{
    return (struct bus_socketcan *)bus;
}

static enum co_err error_of(int error)
{
    switch (error) {
    case EAGAIN:  /* no frame, or the socket's send buffer is full */
    case ENOBUFS: /* the interface's queue is full */
    case EINTR: return CO_ERR_AGAIN;
    case ENETDOWN: return CO_ERR_DOWN;
    case ENODEV:
    case ENXIO: return CO_ERR_NO_BUS;
    case EACCES:
    case EPERM: return CO_ERR_PERMISSION;
    case ENOMEM: return CO_ERR_MEMORY;
    default: return CO_ERR_IO;
    }
}

/* --- frames --- */

static struct can_frame to_kernel(const struct co_frame *frame)
{
    struct can_frame result = { .can_id = frame->id, .len = frame->dlc };

    if (frame->flags & CO_FRAME_EXT)
        result.can_id |= CAN_EFF_FLAG;
    if (frame->flags & CO_FRAME_RTR)
        result.can_id |= CAN_RTR_FLAG;
    else
        memcpy(result.data, frame->data, frame->dlc);
    return result;
}

static struct co_frame from_kernel(const struct can_frame *frame)
{
    struct co_frame result = { .dlc = frame->len <= 8 ? frame->len : 8 };

    if (frame->can_id & CAN_EFF_FLAG)
        result.flags |= CO_FRAME_EXT;
    result.id = frame->can_id & (result.flags & CO_FRAME_EXT ? CAN_EFF_MASK : CAN_SFF_MASK);
    if (frame->can_id & CAN_RTR_FLAG)
        result.flags |= CO_FRAME_RTR;
    else
        memcpy(result.data, frame->data, result.dlc);
    return result;
}

/* --- sending --- */

/* False: the frame will not come back. */
static bool expect_back(struct bus_socketcan *self, const struct co_frame *frame)
{
    bool expected;

    if (!self->own_frames)
        return false;
    lock_take(&self->lock);
    expected = bus_filters_pass(self->filters, self->filter_count, frame);
    if (expected)
        bus_tags_push(&self->tags, frame);
    lock_give(&self->lock);
    return expected;
}

static enum co_err socketcan_send(struct bus *bus, const struct co_frame *frame)
{
    struct bus_socketcan *self = to_socketcan(bus);
    struct can_frame raw = to_kernel(frame);
    bool expected = expect_back(self, frame); /* before: it may come back at once */
    ssize_t size = self->calls->send(self->fd, &raw, sizeof raw, 0);
    enum co_err err = size < 0 ? error_of(errno) : CO_OK;

    if (err && expected) {
        lock_take(&self->lock);
        bus_tags_take_back(&self->tags, frame);
        lock_give(&self->lock);
    }
    return err;
}

/* --- receiving --- */

/* The kernel's time stamp is of the wall clock. */
static co_us_t monotonic_of(const struct timespec *stamp)
{
    co_us_t now = clock_now();
    struct timespec wall;
    int64_t age;

    clock_gettime(CLOCK_REALTIME, &wall);
    age = ((int64_t)wall.tv_sec - stamp->tv_sec) * 1000000 + (wall.tv_nsec - stamp->tv_nsec) / 1000;
    return age > 0 && age < (int64_t)STAMP_AGE_MAX ? now - (co_us_t)age : now;
}

static void read_control(struct bus_socketcan *self, struct msghdr *message, struct bus_rx *rx)
{
    struct timespec stamp;
    uint32_t overflows;

    rx->time = 0;
    for (struct cmsghdr *part = CMSG_FIRSTHDR(message); part; part = CMSG_NXTHDR(message, part)) {
        if (part->cmsg_level != SOL_SOCKET)
            continue;
        if (part->cmsg_type == SO_RXQ_OVFL) {
            memcpy(&overflows, CMSG_DATA(part), sizeof overflows);
            rx->lost = overflows - self->overflows;
            self->overflows = overflows;
        } else if (part->cmsg_type == SCM_TIMESTAMPNS) {
            memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
            rx->time = monotonic_of(&stamp);
        }
    }
    if (rx->time == 0)
        rx->time = clock_now();
}

static void mark_own(struct bus_socketcan *self, struct co_frame *frame)
{
    lock_take(&self->lock);
    frame->tag = bus_tags_confirm(&self->tags, frame);
    lock_give(&self->lock);
    frame->flags |= CO_FRAME_OWN;
}

/* CO_ERR_AGAIN also for what is no classic frame. */
static enum co_err receive_one(struct bus_socketcan *self, struct bus_rx *ret_rx)
{
    union {
        struct cmsghdr align;
        char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t))];
    } control;
    struct can_frame raw;
    struct iovec data = { &raw, sizeof raw };
    struct msghdr message = { .msg_iov = &data,
                              .msg_iovlen = 1,
                              .msg_control = control.bytes,
                              .msg_controllen = sizeof control.bytes };
    ssize_t size = self->calls->recvmsg(self->fd, &message, 0);

    if (size < 0)
        return error_of(errno);
    if (size != CAN_MTU || (raw.can_id & CAN_ERR_FLAG))
        return CO_ERR_AGAIN;
    *ret_rx = (struct bus_rx){ .frame = from_kernel(&raw) };
    read_control(self, &message, ret_rx);
    if (message.msg_flags & MSG_CONFIRM)
        mark_own(self, &ret_rx->frame);
    return CO_OK;
}

static enum co_err socketcan_receive(struct bus *bus, struct bus_rx *ret_rx)
{
    return receive_one(to_socketcan(bus), ret_rx);
}

static enum co_err socketcan_wait(struct bus *bus, co_us_t deadline)
{
    struct bus_socketcan *self = to_socketcan(bus);
    struct bus_poll poll = { .fd = { self->fd, self->wake } };
    enum co_err err = bus_poll_until(&poll, deadline);
    uint64_t count;

    if (poll.readable[1] && read(self->wake, &count, sizeof count) != (ssize_t)sizeof count)
        return CO_ERR_IO;
    return err;
}

static void socketcan_wake(struct bus *bus)
{
    const uint64_t one = 1;
    ssize_t size = write(to_socketcan(bus)->wake, &one, sizeof one);

    (void)size; /* EAGAIN: 2^64 - 2 wake-ups are pending, one more says nothing new */
}

/* --- filters --- */

static struct can_filter to_kernel_filter(const struct bus_filter *filter)
{
    struct can_filter result = { .can_id = filter->id & CAN_EFF_MASK,
                                 .can_mask = filter->mask & CAN_EFF_MASK };

    if (filter->flags & CO_FRAME_EXT)
        result.can_id |= CAN_EFF_FLAG;
    if (filter->flags & CO_FRAME_RTR)
        result.can_id |= CAN_RTR_FLAG;
    if (filter->flags_mask & CO_FRAME_EXT)
        result.can_mask |= CAN_EFF_FLAG;
    if (filter->flags_mask & CO_FRAME_RTR)
        result.can_mask |= CAN_RTR_FLAG;
    return result;
}

static enum co_err set_kernel_filters(struct bus_socketcan *self, const struct bus_filter *filters,
                                      size_t count)
{
    struct can_filter *raw = calloc(count, sizeof *raw);
    int error;

    if (!raw)
        return CO_ERR_MEMORY;
    for (size_t i = 0; i < count; i++)
        raw[i] = to_kernel_filter(&filters[i]);
    error = self->calls->setsockopt(self->fd, SOL_CAN_RAW, CAN_RAW_FILTER, raw,
                                    (socklen_t)(count * sizeof *raw));
    free(raw);
    return error < 0 ? CO_ERR_IO : CO_OK;
}

static enum co_err socketcan_set_filters(struct bus *bus, const struct bus_filter *filters,
                                         size_t count)
{
    static const struct bus_filter plain = { .flags_mask = CO_FRAME_EXT | CO_FRAME_RTR };
    struct bus_socketcan *self = to_socketcan(bus);
    struct bus_filter *copy = malloc((count + 1) * sizeof *copy), *old;
    enum co_err err;

    if (!copy)
        return CO_ERR_MEMORY;
    if (count > 0)
        memcpy(copy, filters, count * sizeof *copy);
    err = count > 0 ? set_kernel_filters(self, filters, count)
                    : set_kernel_filters(self, &plain, 1);
    if (err) {
        free(copy);
        return err;
    }
    lock_take(&self->lock);
    old = self->filters;
    self->filters = copy;
    self->filter_count = count;
    lock_give(&self->lock);
    free(old);
    return CO_OK;
}

/* --- the interface --- */

static int request(const struct bus_socketcan *self, unsigned long number, struct ifreq *ret)
{
    memset(ret, 0, sizeof *ret);
    memcpy(ret->ifr_name, self->name, sizeof ret->ifr_name);
    return self->calls->request(self->fd, number, ret);
}

static bool is_up(const struct bus_socketcan *self)
{
    struct ifreq interface;

    return request(self, SIOCGIFFLAGS, &interface) == 0 && (interface.ifr_flags & IFF_UP) != 0;
}

/* An interface that was removed and made again has another index: it is not ours. */
static bool is_there(const struct bus_socketcan *self)
{
    struct ifreq interface;

    return request(self, SIOCGIFINDEX, &interface) == 0 && interface.ifr_ifindex == self->index;
}

static enum bus_state socketcan_get_state(struct bus *bus)
{
    struct bus_socketcan *self = to_socketcan(bus);

    return is_there(self) && is_up(self) ? BUS_ACTIVE : BUS_DOWN;
}

static enum co_err say_absent(const struct bus_socketcan *self, const struct bus_message *message)
{
    return bus_fail(message, CO_ERR_NO_BUS,
                    "%s: no such CAN interface; ip -br link show type can lists them, "
                    "\"virtual:NAME\" needs no interface",
                    self->name);
}

/* Only real controllers have a bit rate. */
static enum co_err say_down(const struct bus_socketcan *self, unsigned kbit,
                            const struct bus_message *message)
{
    if (strncmp(self->name, "vcan", 4) == 0 || strncmp(self->name, "vxcan", 5) == 0)
        return bus_fail(message, CO_ERR_DOWN, "%s is down; run: ip link set %s up", self->name,
                        self->name);
    return bus_fail(message, CO_ERR_DOWN,
                    "%s is down; run: ip link set %s up type can bitrate %u restart-ms 100",
                    self->name, self->name, kbit > 0 ? kbit * 1000 : 500000);
}

static void socketcan_explain(struct bus *bus, char *text, size_t size)
{
    struct bus_socketcan *self = to_socketcan(bus);
    const struct bus_message message = { text, size };

    if (!is_there(self))
        say_absent(self, &message);
    else if (!is_up(self))
        say_down(self, 0, &message);
    else
        bus_fail(&message, CO_OK, "%s is up", self->name);
}

/* --- opening and closing --- */

static enum co_err open_socket(struct bus_socketcan *self, const struct bus_message *message)
{
    self->fd = self->calls->socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, CAN_RAW);
    if (self->fd >= 0)
        return CO_OK;
    if (errno == EAFNOSUPPORT || errno == EPROTONOSUPPORT) {
        return bus_fail(message, CO_ERR_NO_BUS,
                        "%s: this kernel has no CAN support (run: modprobe can_raw); "
                        "\"virtual:NAME\" works without",
                        self->name);
    }
    return bus_fail(message, error_of(errno), "%s: cannot open a CAN socket: %s", self->name,
                    strerror(errno));
}

static enum co_err find_interface(struct bus_socketcan *self, const struct bus_options *options,
                                  const struct bus_message *message)
{
    struct ifreq interface;

    if (request(self, SIOCGIFINDEX, &interface) < 0)
        return say_absent(self, message);
    self->index = interface.ifr_ifindex;
    if (request(self, SIOCGIFHWADDR, &interface) < 0 ||
        interface.ifr_hwaddr.sa_family != ARPHRD_CAN) {
        return bus_fail(message, CO_ERR_NO_BUS,
                        "%s is not a CAN interface; ip -br link show type can lists them",
                        self->name);
    }
    return is_up(self) ? CO_OK : say_down(self, options->bitrate, message);
}

static int set_int(const struct bus_socketcan *self, int level, int option, int value)
{
    return self->calls->setsockopt(self->fd, level, option, &value, sizeof value);
}

static enum co_err configure_socket(struct bus_socketcan *self)
{
    /* Beyond the system's limit only with CAP_NET_ADMIN; else as much as it allows. */
    if (set_int(self, SOL_SOCKET, SO_RCVBUFFORCE, RECEIVE_BUFFER) < 0)
        set_int(self, SOL_SOCKET, SO_RCVBUF, RECEIVE_BUFFER);
    if (set_int(self, SOL_SOCKET, SO_RXQ_OVFL, 1) < 0 ||
        set_int(self, SOL_SOCKET, SO_TIMESTAMPNS, 1) < 0 ||
        set_int(self, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, self->own_frames) < 0)
        return CO_ERR_IO;
    return socketcan_set_filters(&self->bus, NULL, 0);
}

static enum co_err bind_socket(const struct bus_socketcan *self)
{
    const struct sockaddr_can address = { .can_family = AF_CAN, .can_ifindex = self->index };

    return self->calls->bind(self->fd, (const struct sockaddr *)&address, sizeof address) < 0
               ? error_of(errno)
               : CO_OK;
}

static enum co_err connect_interface(struct bus_socketcan *self, const struct bus_options *options,
                                     const struct bus_message *message)
{
    enum co_err err = find_interface(self, options, message);

    if (err)
        return err;
    err = configure_socket(self);
    if (!err)
        err = bind_socket(self);
    if (err)
        return bus_fail(message, err, "%s: cannot use the CAN socket: %s", self->name,
                        strerror(errno));
    self->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (self->wake < 0)
        return bus_fail(message, CO_ERR_IO, "%s: %s", self->name, strerror(errno));
    return CO_OK;
}

static void socketcan_close(struct bus *bus)
{
    struct bus_socketcan *self = to_socketcan(bus);

    if (self->fd >= 0)
        close(self->fd);
    if (self->wake >= 0)
        close(self->wake);
    lock_done(&self->lock);
    free(self->filters);
    free(self);
}

static const struct bus_ops socketcan_ops = { .close = socketcan_close,
                                              .send = socketcan_send,
                                              .receive = socketcan_receive,
                                              .wait = socketcan_wait,
                                              .wake = socketcan_wake,
                                              .set_filters = socketcan_set_filters,
                                              .get_state = socketcan_get_state,
                                              .explain = socketcan_explain };

static struct bus_socketcan *new_socketcan(const struct socketcan_calls *calls, const char *name,
                                           bool own_frames)
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
    self->wake = -1;
    self->own_frames = own_frames;
    memcpy(self->name, name, strlen(name) + 1);
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
    self = new_socketcan(calls, name, options->own_frames);
    if (!self)
        return bus_fail(message, CO_ERR_MEMORY, "%s: out of memory", name);
    err = open_socket(self, message);
    if (!err)
        err = connect_interface(self, options, message);
    if (err) {
        socketcan_close(&self->bus);
        return err;
    }
    *ret_bus = &self->bus;
    return CO_OK;
}

static int system_request(int fd, unsigned long number, struct ifreq *interface)
{
    return ioctl(fd, number, interface);
}

enum co_err bus_socketcan_open(const char *name, const struct bus_options *options,
                               struct bus **ret_bus, const struct bus_message *message)
{
    static const struct socketcan_calls system_calls = { .socket = socket,
                                                         .request = system_request,
                                                         .bind = bind,
                                                         .setsockopt = setsockopt,
                                                         .send = send,
                                                         .recvmsg = recvmsg };

    return bus_socketcan_open_with(&system_calls, name, options, ret_bus, message);
}

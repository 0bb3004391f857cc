#include "port/bus.h"

#include "port/bus_ops.h"
#include "port/clock.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum co_err bus_fail(const struct bus_message *message, enum co_err err, const char *format, ...)
{
    va_list args;

    if (message->text && message->size > 0) {
        va_start(args, format);
        vsnprintf(message->text, message->size, format, args);
        va_end(args);
    }
    return err;
}

static bool is_virtual(const char *name)
{
    return strncmp(name, BUS_VIRTUAL_PREFIX, strlen(BUS_VIRTUAL_PREFIX)) == 0;
}

enum co_err bus_open(const char *name, const struct bus_options *options, struct bus **ret_bus,
                     char *message, size_t message_size)
{
    const struct bus_message out = { message, message_size };
    struct bus *bus = NULL;
    enum co_err err;

    if (is_virtual(name))
        err = bus_virtual_open(name + strlen(BUS_VIRTUAL_PREFIX), options, &bus, &out);
    else
        err = bus_socketcan_open(name, options, &bus, &out);
    if (err)
        return err;
    snprintf(bus->name, sizeof bus->name, "%s", name);
    *ret_bus = bus;
    return CO_OK;
}

void bus_close(struct bus *self)
{
    if (self)
        self->ops->close(self);
}

static bool is_sendable(const struct co_frame *frame)
{
    return frame->dlc <= 8 && frame->id <= (frame->flags & CO_FRAME_EXT ? 0x1FFFFFFFu : 0x7FFu);
}

enum co_err bus_send(struct bus *self, const struct co_frame *frame)
{
    return is_sendable(frame) ? self->ops->send(self, frame) : CO_ERR_ARG;
}

enum co_err bus_receive(struct bus *self, struct bus_rx *ret_rx)
{
    return self->ops->receive(self, ret_rx);
}

bool bus_has_fetched(struct bus *self)
{
    return self->ops->has_fetched(self);
}

enum co_err bus_wait(struct bus *self, co_us_t deadline)
{
    return self->ops->wait(self, deadline);
}

void bus_wake(struct bus *self)
{
    self->ops->wake(self);
}

enum co_err bus_set_filters(struct bus *self, const struct bus_filter *filters, size_t count)
{
    return count <= BUS_FILTERS_MAX ? self->ops->set_filters(self, filters, count) : CO_ERR_ARG;
}

enum co_err bus_set_own_frames(struct bus *self, bool on)
{
    return self->ops->set_own_frames(self, on);
}

static bool is_cyclic(const struct co_frame *frames, unsigned count, co_us_t period)
{
    if (count > BUS_CYCLIC_MAX || (count > 0 && period == 0))
        return false;
    for (unsigned i = 0; i < count; i++) {
        if (!is_sendable(&frames[i]))
            return false;
    }
    return true;
}

enum co_err bus_set_cyclic(struct bus *self, const struct co_frame *frames, unsigned count,
                           co_us_t period)
{
    if (is_cyclic(frames, count, period))
        return self->ops->set_cyclic(self, frames, count, period);
    self->ops->set_cyclic(self, NULL, 0, 0);
    return CO_ERR_ARG;
}

unsigned bus_backlog(struct bus *self)
{
    return self->ops->backlog(self);
}

enum bus_state bus_get_state(struct bus *self)
{
    return self->ops->get_state(self);
}

unsigned bus_outages(const struct bus *self)
{
    return self->outages;
}

void bus_explain(struct bus *self, char *message, size_t message_size)
{
    self->ops->explain(self, message, message_size);
}

const char *bus_name(const struct bus *self)
{
    return self->name;
}

static bool filter_passes(const struct bus_filter *self, const struct co_frame *frame)
{
    return ((frame->id ^ self->id) & self->mask) == 0 &&
           ((frame->flags ^ self->flags) & self->flags_mask & (CO_FRAME_EXT | CO_FRAME_RTR)) == 0;
}

bool bus_filters_pass(const struct bus_filter *filters, size_t count, const struct co_frame *frame)
{
    if (count == 0)
        return (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR)) == 0;
    for (size_t i = 0; i < count; i++) {
        if (filter_passes(&filters[i], frame))
            return true;
    }
    return false;
}

/* NULL: no limit. Far deadlines are cut to a day, the callers wait again. */
static const struct timespec *time_left(co_us_t deadline, struct timespec *ret_left)
{
    const co_us_t day = CO_MS(86400000u);
    co_us_t now, left;

    if (deadline == CO_NEVER)
        return NULL;
    now = clock_now();
    left = deadline > now ? deadline - now : 0;
    if (left > day)
        left = day;
    ret_left->tv_sec = (time_t)(left / 1000000u);
    ret_left->tv_nsec = (long)(left % 1000000u) * 1000;
    return ret_left;
}

enum co_err bus_poll_until(struct bus_poll *self, co_us_t deadline)
{
    struct pollfd fds[BUS_POLL_MAX];
    struct timespec left;
    int count;

    for (unsigned i = 0; i < BUS_POLL_MAX; i++)
        fds[i] = (struct pollfd){ .fd = self->fd[i], .events = POLLIN };
    count = ppoll(fds, BUS_POLL_MAX, time_left(deadline, &left), NULL);
    for (unsigned i = 0; i < BUS_POLL_MAX; i++)
        self->readable[i] = count > 0 && fds[i].revents != 0;
    if (count < 0)
        return errno == EINTR ? CO_OK : CO_ERR_IO;
    return count > 0 || clock_now() < deadline ? CO_OK : CO_ERR_TIMEOUT;
}

#include "port/can_intake.h"

#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

/* --- opening and closing --- */

enum co_err can_intake_open(struct can_intake *self)
{
    io_ring_setup_fn *setup = self->calls->io_uring_setup;

    self->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (self->wake < 0)
        return CO_ERR_IO;
    self->has_ring = setup && can_intake_ring_open(self, setup) == CO_OK;
    return CO_OK;
}

void can_intake_close(struct can_intake *self)
{
    if (self->has_ring)
        can_intake_ring_close(self);
    if (self->wake >= 0)
        close(self->wake);
}

/* --- messages --- */

void can_intake_prepare(struct can_message *message)
{
    message->data = (struct iovec){ &message->frame, sizeof message->frame };
    message->head = (struct msghdr){ .msg_iov = &message->data,
                                     .msg_iovlen = 1,
                                     .msg_control = message->control.bytes,
                                     .msg_controllen = sizeof message->control.bytes };
}

/*
 * What there is on the socket, behind so many messages that were fetched before; one message with
 * the error if it cannot be read.
 */
static void fetch(struct can_intake *self, unsigned before)
{
    struct can_message *messages = &self->messages[before];
    struct mmsghdr heads[INTAKE_MESSAGES];
    const unsigned room = INTAKE_MESSAGES - before;
    int count;

    for (unsigned i = 0; i < room; i++) {
        can_intake_prepare(&messages[i]);
        heads[i].msg_hdr = messages[i].head;
    }
    count = self->calls->recvmmsg(self->fd, heads, room, MSG_DONTWAIT, NULL);
    messages[0].result = -errno;
    for (int i = 0; i < count; i++) {
        messages[i].head = heads[i].msg_hdr;
        messages[i].result = (int)heads[i].msg_len;
    }
    if (before == 0)
        self->taken = 0;
    self->fetched = before + (count < 0 ? 1 : (unsigned)count);
}

bool can_intake_has(struct can_intake *self)
{
    while (self->taken < self->fetched && self->messages[self->taken].result == -EAGAIN)
        self->taken++;
    return self->taken < self->fetched;
}

struct can_message *can_intake_take(struct can_intake *self)
{
    if (!can_intake_has(self) && !(self->has_ring && can_intake_ring_look(self)))
        fetch(self, 0);
    return can_intake_has(self) ? &self->messages[self->taken++] : NULL;
}

/* --- waiting --- */

void can_intake_wake(struct can_intake *self)
{
    const uint64_t one = 1;
    ssize_t size = write(self->wake, &one, sizeof one);

    (void)size; /* EAGAIN: 2^64 - 2 wake-ups are pending, one more says nothing new */
}

void can_intake_take_wake(struct can_intake *self)
{
    uint64_t count;
    ssize_t size = read(self->wake, &count, sizeof count);

    (void)size; /* it is readable, and nobody else reads it */
    self->woken = true;
}

static enum co_err wait_by_poll(struct can_intake *self, co_us_t deadline)
{
    struct bus_poll poll = { .fd = { self->fd, self->wake, self->news } };
    enum co_err err = bus_poll_until(&poll, deadline);

    if (poll.readable[0])
        fetch(self, 0);
    if (poll.readable[1])
        can_intake_take_wake(self);
    self->has_news = poll.readable[2];
    return err;
}

/* The whole chain has got messages: there may be many more. */
static enum co_err wait_by_ring(struct can_intake *self, co_us_t deadline)
{
    const enum co_err err = can_intake_ring_wait(self, deadline);

    if (err == CO_OK && self->ring.chained == 0 && self->fetched == INTAKE_CHAIN &&
        self->messages[INTAKE_CHAIN - 1].result >= 0)
        fetch(self, INTAKE_CHAIN);
    return err;
}

enum co_err can_intake_wait(struct can_intake *self, co_us_t deadline, bool *ret_news)
{
    enum co_err err = CO_OK;

    if (!can_intake_has(self))
        err = self->has_ring ? wait_by_ring(self, deadline) : wait_by_poll(self, deadline);
    *ret_news = self->has_news;
    self->has_news = self->woken = self->alarmed = false;
    return err;
}

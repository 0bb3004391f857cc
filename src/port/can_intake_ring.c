/*
 * can_intake.h by io_uring. What is handed over, and stays until it has a result:
 *
 *   - a chain of receptions: the first one waits, each other one begins when the one before it has
 *     got a message, and takes what is there. The first that finds nothing ends the chain. There is
 *     one chain at a time, so messages keep their order; while there is one, nobody else may read
 *     from the socket.
 *   - that the wake-up or the news is readable
 *   - an alarm at the deadline. A later deadline leaves it alone, it is set anew when it has gone
 *     off: deadlines move with each frame, and most of the time away.
 */
#include "port/can_intake.h"

#include <errno.h>
#include <poll.h>
#include <string.h>

/* Numbers of requests; those of the receptions are below. */
enum {
    WAKE = INTAKE_CHAIN,
    NEWS,
    CANCEL,
    ALARM /* this one and all above */
};

#define REQUESTS_MAX (INTAKE_CHAIN + 4) /* of one wait: an alarm is taken back, and a new one set */
#define ENTRIES      (2 * REQUESTS_MAX)

static uint64_t address_of(const void *object)
{
    return (uint64_t)(uintptr_t)object;
}

enum co_err can_intake_ring_open(struct can_intake *self, io_ring_setup_fn *setup)
{
    enum co_err err = io_ring_open(&self->ring.ring, ENTRIES, setup);

    if (err)
        io_ring_close(&self->ring.ring);
    self->ring.alarm = CO_NEVER;
    self->ring.alarm_number = ALARM;
    return err;
}

/* --- requests --- */

static void prepare_chain(struct can_intake *self)
{
    struct io_uring_sqe *request;

    for (unsigned i = 0; i < INTAKE_CHAIN; i++) {
        can_intake_prepare(&self->messages[i]);
        request = io_ring_prepare(&self->ring.ring, IORING_OP_RECVMSG, i);
        request->fd = self->fd;
        request->addr = address_of(&self->messages[i].head);
        request->len = 1;
        request->msg_flags = i > 0 ? MSG_DONTWAIT : 0;
        request->flags = i + 1 < INTAKE_CHAIN ? IOSQE_IO_LINK : 0;
    }
    self->ring.chained = INTAKE_CHAIN;
    self->taken = self->fetched = 0;
}

static void prepare_watch(struct can_intake *self, int fd, uint64_t number, bool *watched)
{
    struct io_uring_sqe *request;

    if (*watched)
        return;
    request = io_ring_prepare(&self->ring.ring, IORING_OP_POLL_ADD, number);
    request->fd = fd;
    request->poll_events = POLLIN;
    *watched = true;
}

static void take_alarm_back(struct can_intake_ring *ring)
{
    io_ring_prepare(&ring->ring, IORING_OP_TIMEOUT_REMOVE, CANCEL)->addr = ring->alarm_number;
}

static void prepare_alarm(struct can_intake_ring *ring, co_us_t deadline)
{
    struct io_uring_sqe *request;

    if (ring->alarm <= deadline)
        return;
    if (ring->alarm != CO_NEVER)
        take_alarm_back(ring);
    ring->alarm = deadline;
    ring->alarm_time.tv_sec = (long long)(deadline / 1000000u);
    ring->alarm_time.tv_nsec = (long long)(deadline % 1000000u) * 1000;
    request = io_ring_prepare(&ring->ring, IORING_OP_TIMEOUT, ++ring->alarm_number);
    request->addr = address_of(&ring->alarm_time);
    request->len = 1;
    request->timeout_flags = IORING_TIMEOUT_ABS;
}

/* --- results --- */

static void take_message(struct can_intake *self, int result)
{
    self->messages[self->fetched++].result = result == -ECANCELED ? -EAGAIN : result;
    self->ring.chained--;
}

static void take_wake(struct can_intake *self, int result)
{
    self->ring.wake_watched = false;
    if (result > 0)
        can_intake_take_wake(self);
}

static void take_news(struct can_intake *self, int result)
{
    self->ring.news_watched = false;
    if (result > 0)
        self->has_news = true;
}

static void take_alarm(struct can_intake *self, uint64_t number, int result)
{
    if (number != self->ring.alarm_number) /* of one that was taken back */
        return;
    self->ring.alarm = CO_NEVER;
    if (result == -ETIME)
        self->alarmed = true;
}

/* How many there were. What waited in a thread that has ended was given up. */
static unsigned take_results(struct can_intake *self)
{
    unsigned count = 0;
    uint64_t number;
    int result;

    for (; io_ring_take(&self->ring.ring, &number, &result); count++) {
        if (number < INTAKE_CHAIN)
            take_message(self, result);
        else if (number == WAKE)
            take_wake(self, result);
        else if (number == NEWS)
            take_news(self, result);
        else if (number >= ALARM)
            take_alarm(self, number, result);
    }
    return count;
}

/* --- waiting --- */

/* False: the kernel takes nothing, and there is no room for more. */
static bool prepare_all(struct can_intake *self, co_us_t deadline)
{
    struct can_intake_ring *ring = &self->ring;

    if (io_ring_room(&ring->ring) < REQUESTS_MAX && io_ring_enter(&ring->ring, 0) != CO_OK)
        return false;
    if (ring->chained == 0)
        prepare_chain(self);
    prepare_watch(self, self->wake, WAKE, &ring->wake_watched);
    prepare_watch(self, self->news, NEWS, &ring->news_watched);
    prepare_alarm(ring, deadline);
    return true;
}

static bool has_something(struct can_intake *self)
{
    return can_intake_has(self) || self->woken || self->has_news;
}

enum co_err can_intake_ring_wait(struct can_intake *self, co_us_t deadline)
{
    while (!has_something(self)) {
        co_us_t alarm;

        if (!prepare_all(self, deadline))
            return CO_ERR_IO;
        alarm = self->ring.alarm;
        self->alarmed = false;
        if (io_ring_enter(&self->ring.ring, 1) != CO_OK)
            return CO_ERR_IO;
        if (take_results(self) == 0) /* a signal */
            return CO_OK;
        if (self->alarmed && alarm == deadline && !has_something(self))
            return CO_ERR_TIMEOUT;
    }
    return CO_OK;
}

bool can_intake_ring_look(struct can_intake *self)
{
    if (self->ring.chained == 0)
        return false;
    io_ring_enter(&self->ring.ring, 0);
    take_results(self);
    return true;
}

/* --- closing --- */

/* The messages are ours again. */
void can_intake_ring_close(struct can_intake *self)
{
    struct can_intake_ring *ring = &self->ring;

    take_results(self);
    if (ring->chained > 0)
        io_ring_prepare(&ring->ring, IORING_OP_ASYNC_CANCEL, CANCEL)->addr = 0;
    while (ring->chained > 0 && io_ring_enter(&ring->ring, 1) == CO_OK)
        take_results(self);
    io_ring_close(&ring->ring);
}

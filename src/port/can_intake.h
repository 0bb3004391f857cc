/*
 * The receiving end of a CAN socket: waits, and fetches what has come with the same system call.
 *
 *   in   messages on the socket, wake-ups, news on another descriptor, a deadline
 *   out  messages, in the order of the socket; what has ended the wait
 *
 * By io_uring a frame that comes alone costs one system call, the one that waits for it. Where more
 * are there, and without io_uring, it is two for up to INTAKE_MESSAGES: the other one is
 * recvmmsg(). Internal to port/. Locking: one thread, the one that receives; can_intake_wake() is
 * for any.
 */
#ifndef CO_PORT_CAN_INTAKE_H
#define CO_PORT_CAN_INTAKE_H

#include "port/bus_socketcan.h"
#include "port/io_ring.h"

#include <linux/can.h>
#include <time.h>

#define INTAKE_MESSAGES 32u /* fetched with one wait */
#define INTAKE_CHAIN    2u  /* by io_uring: more would cost each frame that comes alone */

union can_control { /* what comes beside a frame */
    size_t align;   /* as that of a cmsghdr */
    char bytes[CMSG_SPACE(sizeof(struct timespec)) + CMSG_SPACE(sizeof(uint32_t))];
};

struct can_message {
    int result; /* bytes of the frame; -errno; -EAGAIN: there was none */
    struct can_frame frame;
    struct msghdr head;
    struct iovec data;
    union can_control control;
};

/* The state of io_uring; see can_intake_ring.c. */
struct can_intake_ring {
    struct io_ring ring;
    unsigned chained; /* receptions of the chain that are not finished */
    bool wake_watched, news_watched;
    co_us_t alarm; /* CO_NEVER: none is set */
    uint64_t alarm_number;
    struct __kernel_timespec alarm_time;
};

struct can_intake {
    const struct socketcan_calls *calls;
    int fd;   /* of the CAN socket, the owner's */
    int news; /* watched, the owner's */
    int wake; /* eventfd */
    bool has_ring;
    struct can_intake_ring ring;
    bool woken, has_news, alarmed; /* since the last wait */
    unsigned taken, fetched;       /* of messages */
    struct can_message messages[INTAKE_MESSAGES];
};

/* Everything else is set. CO_ERR_IO: errno tells. */
enum co_err can_intake_open(struct can_intake *self);
/* By the thread that waited, or when that has ended. */
void can_intake_close(struct can_intake *self);

/* As bus_wait(); true in *ret_news: the watched descriptor is readable. */
enum co_err can_intake_wait(struct can_intake *self, co_us_t deadline, bool *ret_news);
void can_intake_wake(struct can_intake *self);
/* There is a message that was fetched and not taken. */
bool can_intake_has(struct can_intake *self);
/* The next one, until the next call; NULL: neither fetched nor on the socket. */
struct can_message *can_intake_take(struct can_intake *self);

/* For can_intake_ring.c: a message is to be filled, and the wake-up is to be taken. */
void can_intake_prepare(struct can_message *message);
void can_intake_take_wake(struct can_intake *self);

/* CO_ERR_UNSUPPORTED */
enum co_err can_intake_ring_open(struct can_intake *self, io_ring_setup_fn *setup);
void can_intake_ring_close(struct can_intake *self);
enum co_err can_intake_ring_wait(struct can_intake *self, co_us_t deadline);
/* Fetches without waiting. False: the socket is free to be read from, too. */
bool can_intake_ring_look(struct can_intake *self);

#endif

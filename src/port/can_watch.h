/*
 * Follows the CAN interface of one name: is it there, up, at the right bit rate, and in which state
 * is its controller. An interface that was removed and made again, or unplugged and plugged in, is
 * another one of the same name: the owner binds its socket to that one then.
 *
 *   in   news of the kernel (rtnetlink), error frames, what the CAN socket has run into
 *   out  the state; the interface to bind to; a line of text that explains
 *
 * A socket that finds the interface down only makes this ask the kernel: its answer comes behind
 * all older news, and alone tells how things are.
 *
 * Internal to port/. Locking: the owner's; can_watch_state() and fd are for any thread.
 */
#ifndef CO_PORT_CAN_WATCH_H
#define CO_PORT_CAN_WATCH_H

#include "port/bus_socketcan.h"
#include "port/can_link.h"

#include <linux/can.h>

struct can_watch {
    const struct socketcan_calls *calls;
    int fd; /* readable: can_watch_read() */
    char name[IFNAMSIZ];
    unsigned kbit;        /* expected; 0: any */
    struct can_link link; /* as last told; index 0: there is none */
    int bound;            /* index of the interface that the owner's socket is bound to; 0: none */
    bool doubted;         /* the socket has found it down; the kernel has been asked */
    bool answered;        /* the kernel has told of this name at least once */
    bool unacknowledged;  /* nobody on the bus has taken a frame, since it was last in order */
    unsigned overruns;    /* of the controller's receive buffer, not yet told */
    _Atomic unsigned state;    /* enum bus_state */
    _Atomic unsigned *outages; /* the owner's counter: how often it became OFF or DOWN */
};

/* CO_ERR_NO_BUS, CO_ERR_DOWN, CO_ERR_BITRATE, CO_ERR_PERMISSION, CO_ERR_IO, with a message. */
enum co_err can_watch_open(struct can_watch *self, const struct bus_message *message);
void can_watch_close(struct can_watch *self);

/* Takes the news there are. */
void can_watch_read(struct can_watch *self);
/* The interface that the socket has to be bound to now, 0: none or done. */
int can_watch_bind_due(const struct can_watch *self);
void can_watch_bound(struct can_watch *self, int index);
/* A call on the CAN socket has failed because of the interface. */
void can_watch_doubt(struct can_watch *self);
void can_watch_on_error_frame(struct can_watch *self, const struct can_frame *frame);

enum bus_state can_watch_state(const struct can_watch *self);
/* Why nothing can be sent: CO_ERR_NO_BUS, CO_ERR_DOWN (bus-off, too); CO_OK: it can. */
enum co_err can_watch_error(const struct can_watch *self);
/* The state as a line of text, with the command that mends it; returns its error, or CO_OK. */
enum co_err can_watch_explain(const struct can_watch *self, const struct bus_message *message);

#endif

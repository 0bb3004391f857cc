/*
 * Frames that the kernel sends by itself, one per period (CAN_BCM).
 *
 *   in   the frames and the period; the interface that the CAN socket is connected to
 *   out  a job in the kernel, with a socket of its own
 *
 * A job ends with its connection, and a new one begins with the next: the kernel would go on where
 * it was, or never again. Internal to port/. Locking: the owner's.
 */
#ifndef CO_PORT_CAN_CYCLIC_H
#define CO_PORT_CAN_CYCLIC_H

#include "port/bus_socketcan.h"

struct can_cyclic {
    const struct socketcan_calls *calls;
    int fd;           /* of the job in the kernel; -1: there is none */
    unsigned outages; /* of the connection it was started for */
    unsigned count;   /* 0: none is wanted */
    co_us_t period;
    struct co_frame frames[BUS_CYCLIC_MAX];
};

void can_cyclic_close(struct can_cyclic *self);
/* Ends the job; count 0: that is all. The arguments are right. */
void can_cyclic_set(struct can_cyclic *self, const struct co_frame *frames, unsigned count,
                    co_us_t period);
/*
 * The connection is to this interface (0: there is none), after so many outages. CO_ERR_UNSUPPORTED
 * and errors of the system calls: there is a connection and no job.
 */
enum co_err can_cyclic_follow(struct can_cyclic *self, int index, unsigned outages);

#endif

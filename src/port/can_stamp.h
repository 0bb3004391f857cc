/*
 * The kernel's time stamps of received frames as monotonic time. They are of the wall clock, which
 * somebody may set at any moment.
 *
 *   in   stamps, in the order of reception; both clocks, now and then
 *   out  monotonic times
 *
 * The difference of the two clocks is measured at most each 100 ms, and when a stamp tells that the
 * wall clock was set: reading clocks is a system call on some machines.
 *
 *   owner    bus_socketcan.c
 *   locking  none; the receiving thread's
 */
#ifndef CO_PORT_CAN_STAMP_H
#define CO_PORT_CAN_STAMP_H

#include "base/time.h"

#include <stdint.h>
#include <time.h>

struct can_stamp {      /* zeros at first */
    int64_t ahead;      /* wall clock minus monotonic, us */
    int64_t last;       /* the time of the last stamp, us */
    int64_t good_until; /* the difference is that old by now, us */
};

co_us_t can_stamp_time(struct can_stamp *self, const struct timespec *stamp);

#endif

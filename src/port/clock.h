/* The monotonic clock, the only source of co_us_t in the running stack. Any thread. */
#ifndef CO_PORT_CLOCK_H
#define CO_PORT_CLOCK_H

#include "base/time.h"

co_us_t clock_now(void);
/* The same clock as of the kernel's last tick, 10 ms ago at most; never a system call. */
co_us_t clock_coarse(void);

#endif

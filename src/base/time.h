/*
 * Time: one type for all of the stack, monotonic microseconds.
 *
 * Machines get the time as an argument and keep absolute deadlines; only port/clock.h asks the
 * operating system.
 */
#ifndef CO_BASE_TIME_H
#define CO_BASE_TIME_H

#include <stdint.h>

typedef uint64_t co_us_t;

#define CO_NEVER  UINT64_MAX /* as a deadline: nothing pending */
#define CO_MS(ms) (1000u * (co_us_t)(ms))

static inline co_us_t co_earlier(co_us_t a, co_us_t b)
{
    return a < b ? a : b;
}

#endif

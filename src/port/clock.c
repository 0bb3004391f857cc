#include "port/clock.h"

#include <time.h>

static co_us_t read_clock(clockid_t clock)
{
    struct timespec now;

    clock_gettime(clock, &now);
    return (co_us_t)now.tv_sec * 1000000u + (co_us_t)now.tv_nsec / 1000u;
}

co_us_t clock_now(void)
{
    return read_clock(CLOCK_MONOTONIC);
}

co_us_t clock_coarse(void)
{
    return read_clock(CLOCK_MONOTONIC_COARSE);
}

#include "port/clock.h"

#include <time.h>

co_us_t clock_now(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (co_us_t)now.tv_sec * 1000000u + (co_us_t)now.tv_nsec / 1000u;
}

#include "runtime/network_internal.h"

#include "port/clock.h"

#define STALL CO_MS(50) /* frames that are older have waited for this thread */
#define REST  CO_MS(1000)

/* Not for ever: a bus that brings more than can be handled is no stall. */
bool network_is_behind(struct network *self, co_us_t due, co_us_t now)
{
    co_us_t clock;

    if (now >= self->behind_until && co_earlier(due, self->look) > now)
        return false;
    clock = clock_now();
    if (clock >= self->behind_next && now >= self->behind_until && clock - now > STALL) {
        self->behind_until = clock;
        self->behind_next = clock + REST;
    }
    return now < self->behind_until && clock < self->behind_next;
}

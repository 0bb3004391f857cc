#include "port/can_stamp.h"

#include "port/clock.h"

#define AGE_MAX 10000000 /* us; an older stamp means that the wall clock was set */
#define GOOD    100000   /* us */

static int64_t us_of(const struct timespec *time)
{
    return (int64_t)time->tv_sec * 1000000 + time->tv_nsec / 1000;
}

static int64_t measure(struct can_stamp *self, int64_t stamp)
{
    const int64_t now = (int64_t)clock_now();
    struct timespec wall;
    int64_t age;

    clock_gettime(CLOCK_REALTIME, &wall);
    self->ahead = us_of(&wall) - now;
    self->good_until = now + GOOD;
    age = now - (stamp - self->ahead);
    return age > 0 && age < AGE_MAX ? now - age : now;
}

co_us_t can_stamp_time(struct can_stamp *self, const struct timespec *stamp)
{
    int64_t time = us_of(stamp) - self->ahead;

    if (time < self->last || time > self->good_until)
        time = measure(self, us_of(stamp));
    self->last = time;
    return (co_us_t)time;
}

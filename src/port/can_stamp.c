#include "port/can_stamp.h"

#include "port/clock.h"

#define AGE_MAX 10000000 /* us; an older stamp means that the wall clock was set */
#define GOOD    100000   /* us */
#define CLOSE   20       /* us between two readings of one clock, with the other in between */
#define TRIES   8

static int64_t us_of(const struct timespec *time)
{
    return (int64_t)time->tv_sec * 1000000 + time->tv_nsec / 1000;
}

struct reading {
    int64_t ahead, now;
    int64_t width; /* how far apart in time the two clocks may have been read, us */
};

static struct reading read_clocks(void)
{
    const int64_t before = (int64_t)clock_now();
    struct timespec wall;
    int64_t after;

    clock_gettime(CLOCK_REALTIME, &wall);
    after = (int64_t)clock_now();
    return (struct reading){ .ahead = us_of(&wall) - before - (after - before) / 2,
                             .now = after,
                             .width = after - before };
}

/* A thread that has to pause between the clocks would have all stamps too early, by so much. */
static struct reading read_clocks_well(void)
{
    struct reading best = read_clocks();

    for (unsigned i = 1; i < TRIES && best.width > CLOSE; i++) {
        const struct reading other = read_clocks();

        if (other.width < best.width)
            best = other;
    }
    return best;
}

static int64_t measure(struct can_stamp *self, int64_t stamp)
{
    const struct reading reading = read_clocks_well();
    const int64_t age = reading.now - (stamp - reading.ahead);

    self->ahead = reading.ahead;
    self->good_until = reading.now + GOOD;
    return age > 0 && age < AGE_MAX ? reading.now - age : reading.now;
}

co_us_t can_stamp_time(struct can_stamp *self, const struct timespec *stamp)
{
    int64_t time = us_of(stamp) - self->ahead;

    if (time < self->last || time > self->good_until)
        time = measure(self, us_of(stamp));
    self->last = time;
    return (co_us_t)time;
}

/* Time stamps of the wall clock as monotonic time. */
#include "port/can_stamp.h"

#include "support/suite.h"

#include <stdbool.h>
#include <string.h>

#define AHEAD      INT64_C(1700000000000000) /* us, wall clock minus monotonic */
#define START      INT64_C(5000000)
#define READ       2 /* us that reading a clock takes */
#define ABOUT      5 /* us by which times may be wrong, by that */
#define PAUSES_MAX 10

int __real_clock_gettime(clockid_t clock, struct timespec *time);
int __wrap_clock_gettime(clockid_t clock, struct timespec *time);

/* The clocks of a test; the thread pauses before it reads the wall clock for the n-th time. */
static struct {
    bool used;
    int64_t now, ahead;
    int64_t pauses[PAUSES_MAX];
    unsigned walls;
} clocks;

int __wrap_clock_gettime(clockid_t clock, struct timespec *time)
{
    int64_t us;

    if (!clocks.used)
        return __real_clock_gettime(clock, time);
    if (clock == CLOCK_REALTIME)
        clocks.now += clocks.pauses[clocks.walls++ % PAUSES_MAX];
    us = clocks.now + (clock == CLOCK_REALTIME ? clocks.ahead : 0);
    clocks.now += READ;
    time->tv_sec = (time_t)(us / 1000000);
    time->tv_nsec = (long)(us % 1000000 * 1000);
    return 0;
}

static void set_up(void)
{
    memset(&clocks, 0, sizeof clocks);
    clocks.now = START;
    clocks.ahead = AHEAD;
    clocks.used = true;
}

static void tear_down(void)
{
    clocks.used = false;
}

/* The stamp of a frame that came so long before now. */
static struct timespec stamped(int64_t age)
{
    const int64_t us = clocks.now - age + clocks.ahead;

    return (struct timespec){ .tv_sec = (time_t)(us / 1000000),
                              .tv_nsec = (long)(us % 1000000 * 1000) };
}

static void expect_age(struct can_stamp *self, int64_t age)
{
    const int64_t came = clocks.now - age;
    const struct timespec stamp = stamped(age);
    const int64_t time = (int64_t)can_stamp_time(self, &stamp);

    ck_assert_msg(time >= came - ABOUT && time <= came + ABOUT, "%lld us wrong",
                  (long long)(time - came));
}

START_TEST(a_stamp_is_when_the_frame_came)
{
    struct can_stamp self = { 0 };

    for (int64_t age = 3000; age >= 0; age -= 100) {
        clocks.now += 1000;
        expect_age(&self, age);
    }
    ck_assert_uint_eq(clocks.walls, 1);
    clocks.now += 1000000;
    expect_age(&self, 10);
    ck_assert_uint_eq(clocks.walls, 2);
}
END_TEST

/* Otherwise a device would take what comes at once for older than itself. */
START_TEST(a_pause_between_the_clocks_does_not_matter)
{
    struct can_stamp self = { 0 };

    clocks.pauses[0] = 4000;
    clocks.pauses[1] = 1000;
    clocks.pauses[2] = 50;
    expect_age(&self, 100);
    clocks.now += 1000;
    expect_age(&self, 100);
    ck_assert_uint_eq(clocks.walls, 4);
}
END_TEST

START_TEST(of_many_pauses_the_shortest_counts)
{
    struct can_stamp self = { 0 };
    const struct timespec stamp = stamped(100);
    const int64_t came = clocks.now - 100;
    int64_t time;

    for (unsigned i = 0; i < PAUSES_MAX; i++)
        clocks.pauses[i] = 1000 + 100 * (i > 3 ? i - 3 : 3 - i);
    time = (int64_t)can_stamp_time(&self, &stamp);
    ck_assert_msg(time >= came - 510 && time <= came + 510, "%lld us wrong",
                  (long long)(time - came));
    ck_assert_uint_lt(clocks.walls, PAUSES_MAX);
}
END_TEST

START_TEST(the_wall_clock_may_be_set)
{
    struct can_stamp self = { 0 };

    expect_age(&self, 100);
    clocks.now += 1000;
    clocks.ahead += 3600000000;
    expect_age(&self, 50);
    clocks.now += 1000;
    clocks.ahead -= 7200000000;
    expect_age(&self, 50);
    expect_age(&self, 20);
}
END_TEST

/* As one from before the wall clock was set; and one of the future. */
START_TEST(an_impossible_stamp_is_now)
{
    static const int64_t ages[] = { 3600000000, -3600000000 };
    struct can_stamp self = { 0 };
    const struct timespec stamp = stamped(ages[_i]);
    const int64_t time = (int64_t)can_stamp_time(&self, &stamp);

    ck_assert(time >= START && time <= clocks.now);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("can_stamp");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, a_stamp_is_when_the_frame_came);
    tcase_add_test(tests, a_pause_between_the_clocks_does_not_matter);
    tcase_add_test(tests, of_many_pauses_the_shortest_counts);
    tcase_add_test(tests, the_wall_clock_may_be_set);
    tcase_add_loop_test(tests, an_impossible_stamp_is_now, 0, 2);
    return suite_run("can_stamp", tests);
}

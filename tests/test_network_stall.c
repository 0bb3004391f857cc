/* Which delay of the protocol thread is a stall, and which is a bus that brings too much. */
#include "port/clock.h"
#include "runtime/network_internal.h"
#include "support/suite.h"

static struct network network;

static void set_up(void)
{
    network = (struct network){ .look = CO_NEVER };
}

/* Something is due; the frame that is handled has waited for so long. */
static bool is_behind(co_us_t age)
{
    return network_is_behind(&network, 0, clock_now() - age);
}

START_TEST(a_stall_ends_with_what_came_meanwhile)
{
    ck_assert(!is_behind(0));
    ck_assert(is_behind(CO_MS(2000)));
    ck_assert(is_behind(CO_MS(1000)));
    ck_assert(!is_behind(0));
}
END_TEST

START_TEST(what_is_not_due_has_not_to_wait)
{
    ck_assert(!network_is_behind(&network, CO_NEVER, clock_now() - CO_MS(2000)));
}
END_TEST

/* A second has passed, and frames are still from before it: now time counts, for a while. */
START_TEST(too_many_frames_are_no_stall)
{
    ck_assert(is_behind(CO_MS(3000)));
    network.behind_next = clock_now();
    ck_assert(!is_behind(CO_MS(3000)));
    ck_assert(!is_behind(CO_MS(3000)));
}
END_TEST

static co_us_t recent_time(co_us_t last)
{
    co_us_t time;

    ck_assert_int_eq(lock_init(&network.lock), CO_OK);
    network.now = last;
    network_enter_recent(&network, &time);
    network_release(&network);
    lock_done(&network.lock);
    return time;
}

/* The protocol thread was to wake up long ago, and a call comes before it. */
START_TEST(a_call_after_a_stall_has_the_time_of_now)
{
    const co_us_t now = clock_now();

    network.sleeps_until = now - CO_MS(2990);
    ck_assert_uint_ge(recent_time(now - CO_MS(3000)) + NETWORK_RECENT, now);
    ck_assert_uint_ge(recent_time(now - CO_MS(50)) + NETWORK_RECENT, now);
}
END_TEST

START_TEST(within_a_tick_the_last_time_counts)
{
    const co_us_t last = clock_now() + CO_MS(1000);

    network.sleeps_until = last + CO_MS(1000);
    ck_assert_uint_eq(recent_time(last), last);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("stall");

    tcase_add_checked_fixture(tests, set_up, NULL);
    tcase_add_test(tests, a_stall_ends_with_what_came_meanwhile);
    tcase_add_test(tests, what_is_not_due_has_not_to_wait);
    tcase_add_test(tests, too_many_frames_are_no_stall);
    tcase_add_test(tests, a_call_after_a_stall_has_the_time_of_now);
    tcase_add_test(tests, within_a_tick_the_last_time_counts);
    return suite_run("network_stall", tests);
}

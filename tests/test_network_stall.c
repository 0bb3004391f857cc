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

int main(void)
{
    TCase *tests = tcase_create("stall");

    tcase_add_checked_fixture(tests, set_up, NULL);
    tcase_add_test(tests, a_stall_ends_with_what_came_meanwhile);
    tcase_add_test(tests, what_is_not_due_has_not_to_wait);
    tcase_add_test(tests, too_many_frames_are_no_stall);
    return suite_run("network_stall", tests);
}

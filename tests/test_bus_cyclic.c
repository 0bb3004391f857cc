/*
 * Frames that the kernel sends by itself: what CAN_BCM is told, and when, in a played kernel; and
 * what a virtual bus says to it. The real thing is tested in vcan/test_cyclic_vcan.c.
 */
#include "support/bus_fixture.h"
#include "support/played_kernel.h"
#include "support/suite.h"

#include "port/clock.h"

#include <errno.h>
#include <linux/can/error.h>
#include <string.h>

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))
#define PERIOD        CO_MS(10)

static struct bus *bus;
static struct co_frame syncs[BUS_CYCLIC_MAX + 1];

static void set_up(void)
{
    for (unsigned i = 0; i <= BUS_CYCLIC_MAX; i++) {
        syncs[i] = co_frame_make(0x80, 1);
        syncs[i].data[0] = (uint8_t)(i + 1);
    }
    played_reset();
    bus = played_open();
}

static void tear_down(void)
{
    played_close(bus);
}

/* Until there is nothing more to read. */
static void settle(void)
{
    struct bus_rx rx;

    do {
        while (bus_receive(bus, &rx) == CO_OK)
            ;
    } while (bus_wait(bus, 0) != CO_ERR_TIMEOUT);
}

static void expect_job(unsigned started, int index)
{
    ck_assert_uint_eq(kernel.job.started, started);
    ck_assert_int_eq(played_job_runs() ? kernel.job.index : 0, index);
}

/* --- what the kernel is told --- */

static const struct {
    unsigned count;
    co_us_t period;
    long seconds, microseconds;
} jobs[] = {
    { 1, 1, 0, 1 },
    { 1, 1000, 0, 1000 },
    { 240, 999999, 0, 999999 },
    { 239, 1000000, 1, 0 },
    { 2, UINT32_MAX, 4294, 967295 },
};

START_TEST(the_kernel_gets_frames_and_period)
{
    const struct played_job *job = &kernel.job;

    ck_assert_int_eq(bus_set_cyclic(bus, syncs, jobs[_i].count, jobs[_i].period), CO_OK);
    expect_job(1, 7);
    ck_assert_uint_eq(job->opcode, TX_SETUP);
    ck_assert_uint_eq(job->flags, SETTIMER | STARTTIMER);
    ck_assert_uint_eq(job->count, 0);
    ck_assert_int_eq(job->first_periods.tv_sec, 0);
    ck_assert_int_eq(job->first_periods.tv_usec, 0);
    ck_assert_int_eq(job->period.tv_sec, jobs[_i].seconds);
    ck_assert_int_eq(job->period.tv_usec, jobs[_i].microseconds);
    ck_assert_uint_eq(job->can_id, 0x80);
    ck_assert_uint_eq(job->frame_count, jobs[_i].count);
    for (unsigned i = 0; i < jobs[_i].count; i++) {
        ck_assert_uint_eq(job->frames[i].can_id, 0x80);
        ck_assert_uint_eq(job->frames[i].len, 1);
        ck_assert_uint_eq(job->frames[i].data[0], i + 1);
    }
}
END_TEST

START_TEST(other_frames_are_translated_like_sent_ones)
{
    struct co_frame frame = co_frame_make(0x12345, 0);

    frame.flags = CO_FRAME_EXT | CO_FRAME_RTR;
    ck_assert_int_eq(bus_set_cyclic(bus, &frame, 1, PERIOD), CO_OK);
    ck_assert_uint_eq(kernel.job.frames[0].can_id, 0x12345 | CAN_EFF_FLAG | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.job.can_id, 0x12345 | CAN_EFF_FLAG | CAN_RTR_FLAG);
}
END_TEST

START_TEST(a_new_job_ends_the_old_one)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 240, PERIOD), CO_OK);
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, 2 * PERIOD), CO_OK);
    expect_job(2, 7); /* the played kernel sees to it that there is one at a time */
    ck_assert_int_eq(kernel.job.period.tv_usec, 20000);
    ck_assert_int_eq(bus_set_cyclic(bus, NULL, 0, 0), CO_OK);
    expect_job(2, 0);
    ck_assert_int_eq(bus_set_cyclic(bus, NULL, 0, 0), CO_OK);
    settle();
    expect_job(2, 0);
}
END_TEST

START_TEST(closing_the_bus_ends_it)
{
    struct bus *own;
    struct played_kernel first = kernel;

    own = played_open();
    ck_assert_int_eq(bus_set_cyclic(own, syncs, 1, PERIOD), CO_OK);
    expect_job(1, 7);
    played_close(own);
    expect_job(1, 0);
    memcpy(kernel.can, first.can, sizeof first.can);
    memcpy(kernel.netlink, first.netlink, sizeof first.netlink);
}
END_TEST

/* --- what is refused --- */

static const struct {
    unsigned count;
    co_us_t period;
    struct co_frame last;
} wrong[] = {
    { 1, 0, { .id = 0x80 } },
    { BUS_CYCLIC_MAX + 1, PERIOD, { .id = 0x80 } },
    { 3, PERIOD, { .id = 0x800 } },
    { 3, PERIOD, { .id = 0x80, .dlc = 9 } },
    { 1, PERIOD, { .id = 0x20000000, .flags = CO_FRAME_EXT } },
};

START_TEST(wrong_arguments_end_what_runs)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    syncs[wrong[_i].count - 1] = wrong[_i].last;
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, wrong[_i].count, wrong[_i].period), CO_ERR_ARG);
    expect_job(1, 0);
}
END_TEST

static const struct {
    int bcm_error, connect_error, job_error;
    enum co_err err;
} failures[] = {
    { EPROTONOSUPPORT, 0, 0, CO_ERR_UNSUPPORTED },
    { EAFNOSUPPORT, 0, 0, CO_ERR_UNSUPPORTED },
    { ESOCKTNOSUPPORT, 0, 0, CO_ERR_UNSUPPORTED },
    { EPERM, 0, 0, CO_ERR_PERMISSION },
    { EMFILE, 0, 0, CO_ERR_IO },
    { ENOMEM, 0, 0, CO_ERR_MEMORY },
    { 0, EPERM, 0, CO_ERR_PERMISSION },
    { 0, ENOMEM, 0, CO_ERR_MEMORY },
    { 0, 0, ENOMEM, CO_ERR_MEMORY },
    { 0, 0, EINVAL, CO_ERR_UNSUPPORTED }, /* a 64-bit kernel to a 32-bit program */
    { 0, 0, EIO, CO_ERR_IO },
};

START_TEST(what_fails_is_not_begun_later)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    kernel.bcm_error = failures[_i].bcm_error;
    kernel.connect_error = failures[_i].connect_error;
    kernel.job_error = failures[_i].job_error;
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 2, PERIOD), failures[_i].err);
    ck_assert(!played_job_runs());
    kernel.bcm_error = kernel.connect_error = kernel.job_error = 0;
    played_set_up(false);
    settle();
    played_set_up(true);
    settle();
    expect_job(1, 0);
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    expect_job(2, 7);
}
END_TEST

START_TEST(a_32_bit_program_sends_no_message_that_can_be_misread)
{
    struct co_frame frame = co_frame_make(0x80, 8);

    ck_assert_int_eq(bus_set_cyclic(bus, &frame, 1, PERIOD),
                     sizeof(long) == 8 ? CO_OK : CO_ERR_UNSUPPORTED);
}
END_TEST

/* --- with the interface --- */

START_TEST(down_and_up)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 240, PERIOD), CO_OK);
    played_set_up(false);
    settle();
    expect_job(1, 0);
    played_set_up(true);
    settle();
    expect_job(2, 7);
    ck_assert_uint_eq(kernel.job.frames[0].data[0], 1);
}
END_TEST

/* Over before anybody has looked: the kernel may have left out some of them. */
START_TEST(a_short_outage)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 240, PERIOD), CO_OK);
    played_set_up(false);
    played_set_up(true);
    settle();
    expect_job(2, 7);
}
END_TEST

START_TEST(another_interface_of_the_name)
{
    const struct can_link gone = kernel.link;

    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    kernel.link.index = 0;
    played_news(CAN_LINK_GONE, &gone);
    settle();
    expect_job(1, 0);
    kernel.link.index = 12;
    played_set_up(true);
    settle();
    expect_job(2, 12);
}
END_TEST

START_TEST(the_socket_notices_first)
{
    struct bus_rx rx;

    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    kernel.link.is_up = false;
    played_fail(ENETDOWN);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_DOWN);
    expect_job(1, 0);
    played_set_up(true);
    settle();
    expect_job(2, 7);
}
END_TEST

START_TEST(bus_off)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    settle();
    expect_job(1, 7);
    played_error_frame(CAN_ERR_BUSOFF, 0);
    settle();
    expect_job(1, 0);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    settle();
    expect_job(2, 7);
}
END_TEST

START_TEST(begun_while_down)
{
    played_set_up(false);
    settle();
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    expect_job(0, 0);
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 2, PERIOD), CO_OK);
    played_set_up(true);
    settle();
    expect_job(1, 7);
    ck_assert_uint_eq(kernel.job.frame_count, 2);
}
END_TEST

START_TEST(ended_while_down)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    played_set_up(false);
    settle();
    ck_assert_int_eq(bus_set_cyclic(bus, NULL, 0, 0), CO_OK);
    played_set_up(true);
    settle();
    expect_job(1, 0);
}
END_TEST

/* Gone in that moment, and nobody has told yet. */
START_TEST(begun_as_the_interface_goes)
{
    const struct can_link gone = kernel.link;

    kernel.link.index = 0;
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    expect_job(0, 0);
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    settle();
    kernel.link = gone;
    played_tell();
    settle();
    expect_job(1, 7);
}
END_TEST

/* Each news is a chance. */
START_TEST(what_fails_on_the_way_back_is_tried_again)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 1, PERIOD), CO_OK);
    played_set_up(false);
    settle();
    kernel.bcm_error = ENOMEM;
    played_set_up(true);
    settle();
    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
    ck_assert(!played_job_runs());
    kernel.bcm_error = 0;
    played_tell();
    settle();
    expect_job(2, 7);
}
END_TEST

/* --- a virtual bus --- */

START_TEST(a_virtual_bus_leaves_it_to_the_caller)
{
    struct bus *own = fixture_open(false);

    ck_assert_int_eq(bus_set_cyclic(own, syncs, 1, PERIOD), CO_ERR_UNSUPPORTED);
    ck_assert_int_eq(bus_set_cyclic(own, NULL, 0, 0), CO_OK);
    ck_assert_int_eq(bus_set_cyclic(own, syncs, 1, 0), CO_ERR_ARG);
    ck_assert_int_eq(bus_wait(own, clock_now() + CO_MS(5)), CO_ERR_TIMEOUT);
    bus_close(own);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("played kernel");
    int failed;

    fixture_choose_name();
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_loop_test(tests, the_kernel_gets_frames_and_period, 0, LENGTH(jobs));
    tcase_add_test(tests, other_frames_are_translated_like_sent_ones);
    tcase_add_test(tests, a_new_job_ends_the_old_one);
    tcase_add_test(tests, closing_the_bus_ends_it);
    tcase_add_loop_test(tests, wrong_arguments_end_what_runs, 0, LENGTH(wrong));
    tcase_add_loop_test(tests, what_fails_is_not_begun_later, 0, LENGTH(failures));
    tcase_add_test(tests, a_32_bit_program_sends_no_message_that_can_be_misread);
    tcase_add_test(tests, down_and_up);
    tcase_add_test(tests, a_short_outage);
    tcase_add_test(tests, another_interface_of_the_name);
    tcase_add_test(tests, the_socket_notices_first);
    tcase_add_test(tests, bus_off);
    tcase_add_test(tests, begun_while_down);
    tcase_add_test(tests, ended_while_down);
    tcase_add_test(tests, begun_as_the_interface_goes);
    tcase_add_test(tests, what_fails_on_the_way_back_is_tried_again);
    tcase_add_test(tests, a_virtual_bus_leaves_it_to_the_caller);
    failed = suite_run("bus_cyclic", tests);
    fixture_remove_file();
    return failed;
}

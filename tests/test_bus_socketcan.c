/*
 * SocketCAN without a CAN kernel: the system calls are played here, over a socket pair. The real
 * thing is tested in vcan/test_socketcan_vcan.c.
 */
#include "support/played_kernel.h"

#include "port/clock.h"

#include <check.h>
#include <errno.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <stdlib.h>
#include <string.h>

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

static struct co_frame parse(const char *text)
{
    struct co_frame frame = { .id = 0 };

    ck_assert(co_frame_parse(text, &frame));
    return frame;
}

static enum co_err send_tagged(struct bus *bus, const char *text, uint8_t tag)
{
    struct co_frame frame = parse(text);

    frame.tag = tag;
    return bus_send(bus, &frame);
}

/* The confirmation of a frame with one byte of data; returns the tag it is reported with. */
static uint8_t confirm(struct bus *bus, canid_t can_id, uint8_t first)
{
    struct delivery delivery = played_frame(can_id, first);
    struct bus_rx rx;

    delivery.flags = MSG_CONFIRM;
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_eq(rx.frame.flags & CO_FRAME_OWN, CO_FRAME_OWN);
    return rx.frame.tag;
}

/* --- opening --- */

static const struct {
    int socket_error, netlink_error, bind_error;
    struct can_link link;
    enum co_err err;
    const char *text;
} open_cases[] = {
#define CAN(up, rate)                                                                              \
    {                                                                                              \
        "can0", 7, true, true, up, rate, 100, 1000, BUS_ACTIVE                                     \
    }
#define VCAN(up)                                                                                   \
    {                                                                                              \
        "can0", 7, true, false, up, 0, 0, 1000, BUS_ACTIVE                                         \
    }
    { EAFNOSUPPORT, 0, 0, CAN(true, 250000), CO_ERR_NO_BUS, "\"virtual:NAME\" works without" },
    { EPROTONOSUPPORT, 0, 0, CAN(true, 250000), CO_ERR_NO_BUS, "modprobe can_raw" },
    { EPERM, 0, 0, CAN(true, 250000), CO_ERR_PERMISSION, "no right to open a CAN socket" },
    { EMFILE, 0, 0, CAN(true, 250000), CO_ERR_IO, "Too many open files" },
    { 0, EMFILE, 0, CAN(true, 250000), CO_ERR_IO, "by a netlink socket: Too many open files" },
    { 0, EACCES, 0, CAN(true, 250000), CO_ERR_PERMISSION, "by a netlink socket: Permission" },
    { 0, 0, 0, { .index = 0 }, CO_ERR_NO_BUS, "can0: no such CAN interface; ip -br link" },
    { 0, 0, 0, { .name = "can0", .index = 7, .is_up = true }, CO_ERR_NO_BUS, "can0 is not a CAN" },
    { 0, 0, 0, CAN(false, 0), CO_ERR_DOWN, "ip link set can0 up type can bitrate 250000 restart" },
    { 0, 0, 0, CAN(false, 500000), CO_ERR_DOWN, "can0 up type can bitrate 250000" },
    { 0, 0, 0, CAN(false, 250000), CO_ERR_DOWN, "can0 is down; run: ip link set can0 up" },
    { 0, 0, 0, VCAN(false), CO_ERR_DOWN, "can0 is down; run: ip link set can0 up" },
    { 0, 0, 0, CAN(true, 500000), CO_ERR_BITRATE,
      "can0 is at 500000 bit/s, configured are 250000; run: ip link set can0 down; ip link set "
      "can0 up type can bitrate 250000 restart-ms 100" },
    { 0, 0, 0, CAN(true, 252600), CO_ERR_BITRATE, "252600" },
    { 0, 0, 0, CAN(true, 247400), CO_ERR_BITRATE, "247400" },
    { 0, 0, 0, CAN(true, 252500), CO_OK, "" }, /* as near as its clock allows */
    { 0, 0, 0, CAN(true, 247500), CO_OK, "" },
    { 0, 0, ENODEV, CAN(true, 250000), CO_ERR_NO_BUS, "No such device" },
    { 0, 0, 0, CAN(true, 250000), CO_OK, "" },
    { 0, 0, 0, CAN(true, 0), CO_OK, "" },
    { 0, 0, 0, VCAN(true), CO_OK, "" },
    { 0, 0, 0, { "can0", 7, true, true, true, 250000, 0, 10, BUS_OFF }, CO_OK, "" },
};

START_TEST(opening_tells_what_is_wrong)
{
    char text[300] = "";
    struct bus *bus = NULL;

    kernel.socket_error = open_cases[_i].socket_error;
    kernel.netlink_error = open_cases[_i].netlink_error;
    kernel.bind_error = open_cases[_i].bind_error;
    kernel.link = open_cases[_i].link;
    ck_assert_int_eq(played_try_open("can0", &bus, text, sizeof text), open_cases[_i].err);
    ck_assert_msg(strstr(text, open_cases[_i].text) != NULL, "%s", text);
    ck_assert((bus != NULL) == (open_cases[_i].err == CO_OK));
    ck_assert((text[0] == '\0') == (open_cases[_i].err == CO_OK));
    bus_close(bus);
}
END_TEST

START_TEST(a_kernel_that_does_not_answer_is_an_error)
{
    char text[200] = "";
    struct bus *bus = NULL;

    kernel.is_mute = true;
    ck_assert_int_eq(played_try_open("can0", &bus, text, sizeof text), CO_ERR_IO);
    ck_assert_ptr_nonnull(strstr(text, "does not tell about the interface"));
    ck_assert_ptr_null(bus);
}
END_TEST

START_TEST(options_that_fail_are_errors)
{
    static const int options[] = { SO_RXQ_OVFL, SO_TIMESTAMPNS, CAN_RAW_RECV_OWN_MSGS,
                                   CAN_RAW_ERR_FILTER, CAN_RAW_FILTER };
    struct bus *bus = NULL;

    kernel.option_error = ENOPROTOOPT;
    kernel.failing_option = options[_i];
    ck_assert_int_eq(played_try_open("can0", &bus, NULL, 0), CO_ERR_IO);
    ck_assert_ptr_null(bus);
}
END_TEST

static const char *const bad_names[] = { "", "a-name-too-long-", "can0/x", "can 0", "udp:x" };

START_TEST(names_are_checked)
{
    const struct bus_options options = { .own_frames = false };
    char text[200] = "";
    struct bus *bus = NULL;

    ck_assert_int_eq(bus_open(bad_names[_i], &options, &bus, text, sizeof text), CO_ERR_ARG);
    ck_assert_ptr_nonnull(strstr(text, "is no name of an interface"));
    ck_assert_int_eq(bus_open("nocan0", &options, &bus, text, sizeof text), CO_ERR_NO_BUS);
    ck_assert_ptr_nonnull(strstr(text, "virtual:NAME"));
}
END_TEST

START_TEST(the_socket_is_set_up)
{
    struct bus *bus = played_open();

    ck_assert_int_eq(kernel.raw_options[CAN_RAW_RECV_OWN_MSGS], 1);
    ck_assert_int_eq(kernel.raw_options[CAN_RAW_ERR_FILTER],
                     CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_CRTL | CAN_ERR_ACK);
    ck_assert_int_eq(kernel.bound, 7);
    ck_assert_int_eq(kernel.socket_options[SO_RXQ_OVFL], 1);
    ck_assert_int_ge(kernel.socket_options[SO_RCVBUFFORCE], 1 << 20);
    ck_assert_uint_eq(kernel.filter_count, 1);
    ck_assert_uint_eq(kernel.filters[0].can_id, 0);
    ck_assert_uint_eq(kernel.filters[0].can_mask, CAN_EFF_FLAG | CAN_RTR_FLAG);
    played_close(bus);
}
END_TEST

START_TEST(the_buffer_is_as_large_as_allowed)
{
    kernel.option_error = EPERM;
    kernel.failing_option = SO_RCVBUFFORCE;
    played_close(played_open());
    ck_assert_int_ge(kernel.socket_options[SO_RCVBUF], 1 << 20);
}
END_TEST

/* --- frames --- */

static const struct {
    const char *text;
    canid_t can_id;
} frame_cases[] = {
    { "605#4000100000000000", 0x605 },
    { "7FF#", 0x7FF },
    { "00000605#01", 0x605 | CAN_EFF_FLAG },
    { "1FFFFFFF#0102030405060708", 0x1FFFFFFF | CAN_EFF_FLAG },
    { "705#R1", 0x705 | CAN_RTR_FLAG },
    { "00000705#R8", 0x705 | CAN_RTR_FLAG | CAN_EFF_FLAG },
};

START_TEST(frames_are_translated_both_ways)
{
    struct bus *bus = played_open();
    struct delivery delivery = { .size = CAN_MTU };
    char text[CO_FRAME_TEXT_SIZE];
    struct bus_rx rx;

    ck_assert_int_eq(send_tagged(bus, frame_cases[_i].text, 0), CO_OK);
    ck_assert_uint_eq(kernel.sent.can_id, frame_cases[_i].can_id);
    delivery.frame = kernel.sent;
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_str_eq(co_frame_format(&rx.frame, text, sizeof text), frame_cases[_i].text);
    ck_assert_uint_eq(rx.frame.flags & CO_FRAME_OWN, 0);
    ck_assert_uint_eq(rx.frame.tag, 0);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
    played_close(bus);
}
END_TEST

START_TEST(the_backlog_is_what_the_socket_still_has)
{
    struct bus *bus = played_open();

    ck_assert_uint_eq(bus_backlog(bus), 0);
    kernel.backlog = 1536;
    ck_assert_uint_eq(bus_backlog(bus), 1536);
    kernel.backlog_error = ENOPROTOOPT; /* before Linux 4.12 */
    ck_assert_uint_eq(bus_backlog(bus), 0);
    played_close(bus);
}
END_TEST

static const struct {
    int error;
    enum co_err err;
    bool asks; /* the kernel, how the interface is */
} error_cases[] = {
    { EAGAIN, CO_ERR_AGAIN, false },
    { ENOBUFS, CO_ERR_AGAIN, false },
    { EINTR, CO_ERR_AGAIN, false },
    { ENETDOWN, CO_ERR_DOWN, true },
    { ENODEV, CO_ERR_NO_BUS, true },
    { ENXIO, CO_ERR_NO_BUS, true },
    { EIO, CO_ERR_IO, true },
    { EACCES, CO_ERR_PERMISSION, false },
    { EPERM, CO_ERR_PERMISSION, false },
    { ENOMEM, CO_ERR_MEMORY, false },
};

START_TEST(errors_are_translated)
{
    struct bus *bus = played_open();
    struct delivery delivery = { .error = error_cases[_i].error };
    struct bus_rx rx;

    kernel.send_error = error_cases[_i].error;
    ck_assert_int_eq(send_tagged(bus, "123#01", 1), error_cases[_i].err);
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), error_cases[_i].err);
    kernel.send_error = 0;
    ck_assert_int_eq(bus_wait(bus, 0), error_cases[_i].asks ? CO_OK : CO_ERR_TIMEOUT);
    ck_assert_int_eq(send_tagged(bus, "123#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x123, 1), 2); /* what was not sent is not waited for */
    played_close(bus);
}
END_TEST

START_TEST(what_is_no_classic_frame_is_left_out)
{
    struct bus *bus = played_open();
    struct delivery error_frame = played_frame(CAN_ERR_FLAG | CAN_ERR_CRTL, 0);
    struct delivery short_frame = played_frame(0x123, 0);
    struct bus_rx rx;

    played_deliver(&error_frame);
    short_frame.size = 8;
    played_deliver(&short_frame);
    for (unsigned i = 0; i < 2; i++)
        ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_wait(bus, 0), CO_ERR_TIMEOUT);
    played_close(bus);
}
END_TEST

START_TEST(losses_are_differences_of_the_socket_s_counter)
{
    static const struct {
        uint32_t drops;
        unsigned lost;
    } steps[] = {
        { 0, 0 }, { 3, 3 }, { 3, 0 }, { 10, 7 }, { UINT32_MAX, UINT32_MAX - 10 }, { 4, 5 }
    };
    struct bus *bus = played_open();
    struct bus_rx rx;

    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        struct delivery delivery = played_frame(0x123, 0);

        delivery.drops = steps[i].drops;
        played_deliver(&delivery);
        ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
        ck_assert_uint_eq(rx.lost, steps[i].lost);
    }
    played_close(bus);
}
END_TEST

/* The time reported for a frame stamped so long ago, relative to now. */
static int64_t age_reported(struct bus *bus, int seconds_ago)
{
    struct delivery delivery = played_frame(0x123, 0);
    struct bus_rx rx;

    clock_gettime(CLOCK_REALTIME, &delivery.stamp);
    delivery.stamp.tv_sec -= seconds_ago;
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    return (int64_t)(clock_now() - rx.time);
}

START_TEST(time_stamps_become_monotonic)
{
    struct bus *bus = played_open();
    struct delivery unstamped = played_frame(0x123, 0);
    struct bus_rx rx;

    ck_assert_int_ge(age_reported(bus, 2), 2000000);
    ck_assert_int_lt(age_reported(bus, 2), 3000000);
    ck_assert_int_lt(age_reported(bus, -2), 1000000);   /* the wall clock was set back ... */
    ck_assert_int_lt(age_reported(bus, 3600), 1000000); /* ... or forth */
    played_deliver(&unstamped);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_lt(clock_now() - rx.time, CO_MS(1000));
    played_close(bus);
}
END_TEST

/* --- tags of own frames --- */

START_TEST(confirmations_bring_their_tags)
{
    const struct bus_filter all = { 0, 0, 0, 0 };
    struct bus *bus = played_open();

    ck_assert_int_eq(bus_set_filters(bus, &all, 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "00000101#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x101 | CAN_EFF_FLAG, 1), 2);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 0);
    played_close(bus);
}
END_TEST

START_TEST(frames_the_filters_drop_are_not_waited_for)
{
    const struct bus_filter filter = { 0x101, 0x7FF, 0, 3 };
    struct bus *bus = played_open();

    ck_assert_int_eq(bus_set_filters(bus, &filter, 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    for (unsigned i = 0; i < 5000; i++)
        ck_assert_int_eq(send_tagged(bus, "102#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    played_close(bus);
}
END_TEST

/* --- own frames switched --- */

START_TEST(own_frames_are_switched)
{
    struct bus *bus = played_open();
    struct delivery late = played_frame(0x101, 1);
    struct bus_rx rx;

    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "101#01", 2), CO_OK);
    ck_assert_int_eq(bus_set_own_frames(bus, false), CO_OK);
    ck_assert_int_eq(kernel.raw_options[CAN_RAW_RECV_OWN_MSGS], 0);
    late.flags = MSG_CONFIRM; /* the socket had it already */
    played_deliver(&late);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_set_own_frames(bus, true), CO_OK);
    ck_assert_int_eq(kernel.raw_options[CAN_RAW_RECV_OWN_MSGS], 1);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 2);
    played_close(bus);
}
END_TEST

START_TEST(frames_sent_meanwhile_are_not_waited_for)
{
    struct bus *bus = played_open();

    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    ck_assert_int_eq(bus_set_own_frames(bus, false), CO_OK);
    for (unsigned i = 0; i < 5000; i++)
        ck_assert_int_eq(send_tagged(bus, "102#01", 2), CO_OK);
    ck_assert_int_eq(bus_set_own_frames(bus, true), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "102#01", 3), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x102, 1), 3);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    played_close(bus);
}
END_TEST

START_TEST(own_frames_that_cannot_be_switched_stay)
{
    struct bus *bus = played_open();

    kernel.option_error = EINVAL;
    kernel.failing_option = CAN_RAW_RECV_OWN_MSGS;
    ck_assert_int_eq(bus_set_own_frames(bus, false), CO_ERR_IO);
    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    played_close(bus);
}
END_TEST

/* --- filters, waiting, state --- */

START_TEST(filters_are_exact)
{
    const struct bus_filter filters[] = { { 0x605, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
                                          { 0x700, 0x780, CO_FRAME_RTR, CO_FRAME_RTR },
                                          { 0x1234567, 0x1FFFFFFF, CO_FRAME_EXT, CO_FRAME_EXT } };
    static const struct bus_filter many[BUS_FILTERS_MAX + 1];
    struct bus *bus = played_open();

    ck_assert_int_eq(bus_set_filters(bus, filters, 3), CO_OK);
    ck_assert_uint_eq(kernel.filters[0].can_id, 0x605);
    ck_assert_uint_eq(kernel.filters[0].can_mask, 0x7FF | CAN_EFF_FLAG | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[1].can_id, 0x700 | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[1].can_mask, 0x780 | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[2].can_id, 0x1234567 | CAN_EFF_FLAG);
    ck_assert_uint_eq(kernel.filters[2].can_mask, 0x1FFFFFFF | CAN_EFF_FLAG);
    ck_assert_int_eq(bus_set_filters(bus, many, BUS_FILTERS_MAX + 1), CO_ERR_ARG);
    ck_assert_int_eq(bus_set_filters(bus, many, BUS_FILTERS_MAX), CO_OK);
    ck_assert_uint_eq(kernel.filter_count, BUS_FILTERS_MAX);
    ck_assert_int_eq(bus_set_filters(bus, NULL, 0), CO_OK);
    ck_assert_uint_eq(kernel.filter_count, 1);
    kernel.option_error = EINVAL;
    kernel.failing_option = CAN_RAW_FILTER;
    ck_assert_int_eq(bus_set_filters(bus, filters, 3), CO_ERR_IO);
    played_close(bus);
}
END_TEST

START_TEST(waiting_ends_with_a_frame_a_wake_or_the_deadline)
{
    struct bus *bus = played_open();
    struct delivery delivery = played_frame(0x123, 0);
    co_us_t deadline = clock_now() + CO_MS(20);
    struct bus_rx rx;

    ck_assert_int_eq(bus_wait(bus, deadline), CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
    bus_wake(bus);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(bus_wait(bus, 0), CO_ERR_TIMEOUT);
    played_deliver(&delivery);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    played_close(bus);
}
END_TEST

/* Without asking the system for one that is not there. */
START_TEST(what_a_wait_has_fetched_is_told)
{
    struct bus *bus = played_open();
    struct delivery delivery = played_frame(0x123, 0);
    struct bus_rx rx;

    ck_assert(!bus_has_fetched(bus));
    for (unsigned i = 0; i < 3; i++)
        played_deliver(&delivery);
    ck_assert(!bus_has_fetched(bus));
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    for (unsigned i = 0; i < 3; i++) {
        ck_assert(bus_has_fetched(bus));
        ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    }
    ck_assert(!bus_has_fetched(bus));
    played_fail(ENOMEM);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert(bus_has_fetched(bus));
    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_MEMORY);
    ck_assert(!bus_has_fetched(bus));
    played_close(bus);
}
END_TEST

static Suite *suite_of_all(void)
{
    Suite *suite = suite_create("bus_socketcan");
    TCase *tests = tcase_create("played kernel");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, played_reset, NULL);
    tcase_add_loop_test(tests, opening_tells_what_is_wrong, 0, LENGTH(open_cases));
    tcase_add_test(tests, a_kernel_that_does_not_answer_is_an_error);
    tcase_add_loop_test(tests, options_that_fail_are_errors, 0, 5);
    tcase_add_loop_test(tests, names_are_checked, 0, LENGTH(bad_names));
    tcase_add_test(tests, the_socket_is_set_up);
    tcase_add_test(tests, the_buffer_is_as_large_as_allowed);
    tcase_add_test(tests, the_backlog_is_what_the_socket_still_has);
    tcase_add_loop_test(tests, frames_are_translated_both_ways, 0, LENGTH(frame_cases));
    tcase_add_loop_test(tests, errors_are_translated, 0, LENGTH(error_cases));
    tcase_add_test(tests, what_is_no_classic_frame_is_left_out);
    tcase_add_test(tests, losses_are_differences_of_the_socket_s_counter);
    tcase_add_test(tests, time_stamps_become_monotonic);
    tcase_add_test(tests, confirmations_bring_their_tags);
    tcase_add_test(tests, frames_the_filters_drop_are_not_waited_for);
    tcase_add_test(tests, own_frames_are_switched);
    tcase_add_test(tests, frames_sent_meanwhile_are_not_waited_for);
    tcase_add_test(tests, own_frames_that_cannot_be_switched_stay);
    tcase_add_test(tests, filters_are_exact);
    tcase_add_test(tests, waiting_ends_with_a_frame_a_wake_or_the_deadline);
    tcase_add_test(tests, what_a_wait_has_fetched_is_told);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(suite_of_all());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

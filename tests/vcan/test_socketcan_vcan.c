/*
 * SocketCAN on a real vcan0, which tests/vcan/run.sh provides in a place of its own; interfaces
 * that come, go and are down are made here with ip.
 */
#include "port/clock.h"
#include "support/vcan.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static enum co_err fail_on(const char *name, char *message, size_t size)
{
    const struct bus_options options = { .bitrate = 125 };
    struct bus *bus = NULL;
    enum co_err err = bus_open(name, &options, &bus, message, size);

    ck_assert_ptr_null(bus);
    return err;
}

static enum co_err send_number(struct bus *bus, uint32_t number)
{
    struct co_frame frame = co_frame_make(0x123, 4);

    memcpy(frame.data, &number, sizeof number);
    return bus_send(bus, &frame);
}

START_TEST(a_frame_reaches_the_others)
{
    struct bus *sender = vcan_open("vcan0", false), *reader = vcan_open("vcan0", true);
    co_us_t before = clock_now();
    struct bus_rx rx;

    ck_assert_int_eq(vcan_send(sender, "605#4000100000000000", 5), CO_OK);
    rx = vcan_expect(reader, "605#4000100000000000");
    ck_assert_uint_eq(rx.frame.tag, 0);
    ck_assert_uint_eq(rx.frame.flags, 0);
    ck_assert_uint_eq(rx.lost, 0);
    ck_assert_uint_ge(rx.time + 1000, before); /* two clocks are read one after the other */
    ck_assert_uint_le(rx.time, clock_now());
    vcan_expect_nothing(sender);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(own_frames_come_back_with_their_tags)
{
    struct bus *self = vcan_open("vcan0", true), *other = vcan_open("vcan0", false);
    struct bus_rx rx;

    ck_assert_int_eq(vcan_send(self, "181#01", 7), CO_OK);
    ck_assert_int_eq(vcan_send(other, "182#02", 8), CO_OK);
    ck_assert_int_eq(vcan_send(self, "181#01", 9), CO_OK);
    rx = vcan_expect(self, "181#01");
    ck_assert_uint_eq(rx.frame.flags, CO_FRAME_OWN);
    ck_assert_uint_eq(rx.frame.tag, 7);
    rx = vcan_expect(self, "182#02");
    ck_assert_uint_eq(rx.frame.flags, 0);
    ck_assert_uint_eq(rx.frame.tag, 0);
    rx = vcan_expect(self, "181#01");
    ck_assert_uint_eq(rx.frame.flags, CO_FRAME_OWN);
    ck_assert_uint_eq(rx.frame.tag, 9);
    vcan_expect_nothing(self);
    bus_close(self);
    bus_close(other);
}
END_TEST

START_TEST(own_frames_are_switched)
{
    struct bus *self = vcan_open("vcan0", false), *other = vcan_open("vcan0", false);

    ck_assert_int_eq(vcan_send(self, "181#01", 7), CO_OK);
    vcan_expect_nothing(self);
    ck_assert_int_eq(bus_set_own_frames(self, true), CO_OK);
    ck_assert_int_eq(vcan_send(self, "181#01", 8), CO_OK);
    ck_assert_uint_eq(vcan_expect(self, "181#01").frame.tag, 8);
    ck_assert_int_eq(bus_set_own_frames(self, false), CO_OK);
    ck_assert_int_eq(vcan_send(self, "181#02", 9), CO_OK);
    ck_assert_int_eq(bus_wait(self, clock_now() + CO_MS(5)), CO_ERR_TIMEOUT);
    vcan_expect_nothing(self);
    vcan_expect(other, "181#01");
    vcan_expect(other, "181#01");
    vcan_expect(other, "181#02");
    bus_close(self);
    bus_close(other);
}
END_TEST

static const struct {
    struct bus_filter filters[2];
    size_t count;
    const char *sent[6];
    const char *passes[6];
} filter_cases[] = {
    { .count = 0, .sent = { "123#", "123#R", "00000123#", "7FF#" }, .passes = { "123#", "7FF#" } },
    { .filters = { { 0x123, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR } },
      .count = 1,
      .sent = { "122#", "123#", "123#R", "00000123#", "124#" },
      .passes = { "123#" } },
    { .filters = { { 0x700, 0x780, CO_FRAME_RTR, CO_FRAME_RTR } },
      .count = 1,
      .sent = { "705#R", "705#", "77F#R1", "680#R", "00000701#R" },
      .passes = { "705#R0", "77F#R1", "00000701#R0" } },
    { .filters = { { 0x80, 0x7FF, 0, 3 }, { 0x00ABCDEF, 0x1FFFFFFF, CO_FRAME_EXT, 3 } },
      .count = 2,
      .sent = { "080#", "00ABCDEF#11", "00ABCDEE#", "081#", "080#R" },
      .passes = { "080#", "00ABCDEF#11" } },
    { .filters = { { 0, 0, 0, 0 } },
      .count = 1,
      .sent = { "080#", "00ABCDEF#", "081#R" },
      .passes = { "080#", "00ABCDEF#", "081#R0" } },
};

START_TEST(filters_pass_what_they_name)
{
    struct bus *sender = vcan_open("vcan0", false), *reader = vcan_open("vcan0", false);

    ck_assert_int_eq(bus_set_filters(reader, filter_cases[_i].filters, filter_cases[_i].count),
                     CO_OK);
    for (unsigned i = 0; i < 6 && filter_cases[_i].sent[i]; i++)
        ck_assert_int_eq(vcan_send(sender, filter_cases[_i].sent[i], 0), CO_OK);
    for (unsigned i = 0; i < 6 && filter_cases[_i].passes[i]; i++)
        vcan_expect(reader, filter_cases[_i].passes[i]);
    vcan_expect_nothing(reader);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(all_see_the_same_order)
{
    struct bus *handles[3];
    uint32_t number;

    for (unsigned i = 0; i < 3; i++)
        handles[i] = vcan_open("vcan0", true);
    for (uint32_t n = 0; n < 500; n++)
        ck_assert_int_eq(send_number(handles[n % 5 % 3], n), CO_OK);
    for (unsigned i = 0; i < 3; i++) {
        for (uint32_t n = 0; n < 500; n++) {
            struct bus_rx rx = vcan_receive(handles[i]);

            memcpy(&number, rx.frame.data, sizeof number);
            ck_assert_uint_eq(number, n);
            ck_assert_uint_eq(rx.frame.flags, n % 5 % 3 == i ? CO_FRAME_OWN : 0);
        }
        bus_close(handles[i]);
    }
}
END_TEST

START_TEST(a_slow_reader_learns_what_it_lost)
{
    enum { COUNT = 20000 };
    struct bus *sender = vcan_open("vcan0", false), *reader = vcan_open("vcan0", false);
    uint32_t number, next = 0;
    unsigned lost = 0;

    for (uint32_t n = 0; n < COUNT; n++) {
        while (send_number(sender, n) == CO_ERR_AGAIN)
            ;
    }
    for (struct bus_rx rx; bus_receive(reader, &rx) == CO_OK; next++) {
        memcpy(&number, rx.frame.data, sizeof number);
        ck_assert_uint_eq(number, next); /* the newest are lost, not the oldest */
        ck_assert_uint_eq(rx.lost, 0);
    }
    ck_assert_uint_gt(next, 1000); /* the buffer was enlarged */
    ck_assert_int_eq(send_number(sender, COUNT), CO_OK);
    lost = vcan_receive(reader).lost;
    ck_assert_uint_gt(lost, 0);
    ck_assert_uint_eq(next + lost, COUNT);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(other_programs_are_heard)
{
    struct bus *bus = vcan_open("vcan0", true);

    vcan_run("cansend vcan0 705#7F");
    vcan_expect(bus, "705#7F");
    bus_close(bus);
}
END_TEST

START_TEST(waiting_ends_with_a_frame_a_wake_or_the_deadline)
{
    struct bus *bus = vcan_open("vcan0", true);
    co_us_t deadline = clock_now() + CO_MS(20);

    ck_assert_int_eq(bus_wait(bus, deadline), CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
    bus_wake(bus);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(send_number(bus, 1), CO_OK);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    vcan_expect(bus, "123#01000000");
    bus_close(bus);
}
END_TEST

START_TEST(interfaces_that_cannot_be_used_are_refused)
{
    char message[200] = "";

    ck_assert_int_eq(fail_on("vcan77", message, sizeof message), CO_ERR_NO_BUS);
    ck_assert_ptr_nonnull(strstr(message, "vcan77: no such CAN interface"));
    ck_assert_int_eq(fail_on("lo", message, sizeof message), CO_ERR_NO_BUS);
    ck_assert_ptr_nonnull(strstr(message, "lo is not a CAN interface"));
    vcan_run("ip link add vcan7 type vcan");
    ck_assert_int_eq(fail_on("vcan7", message, sizeof message), CO_ERR_DOWN);
    ck_assert_ptr_nonnull(strstr(message, "run: ip link set vcan7 up"));
    vcan_run("ip link set vcan7 name can7");
    ck_assert_int_eq(fail_on("can7", message, sizeof message), CO_ERR_DOWN);
    ck_assert_ptr_nonnull(strstr(message, "run: ip link set can7 up"));
    vcan_run("ip link del can7");
}
END_TEST

START_TEST(an_interface_may_go_down_and_come_back)
{
    struct bus *bus, *other;
    struct bus_rx rx;

    vcan_run("ip link add vcan8 type vcan");
    vcan_run("ip link set vcan8 up");
    bus = vcan_open("vcan8", false);
    other = vcan_open("vcan8", false);
    vcan_run("ip link set vcan8 down");
    ck_assert_int_eq(bus_wait(bus, clock_now() + VCAN_PATIENCE), CO_OK);
    for (unsigned i = 0; i < 3; i++)
        ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_DOWN);
    ck_assert_int_eq(bus_receive(other, &rx), CO_ERR_DOWN);
    ck_assert_int_eq(send_number(bus, 1), CO_ERR_DOWN);
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    while (bus_wait(bus, clock_now() + CO_MS(50)) == CO_OK)
        ; /* the news have come */
    ck_assert_int_eq(bus_wait(bus, clock_now() + CO_MS(50)), CO_ERR_TIMEOUT);
    vcan_run("ip link set vcan8 up");
    vcan_wait_state(bus, BUS_ACTIVE);
    vcan_wait_state(other, BUS_ACTIVE);
    ck_assert_int_eq(send_number(bus, 2), CO_OK);
    vcan_expect(other, "123#02000000");
    ck_assert_uint_eq(bus_outages(bus), 1);
    bus_close(other);
    bus_close(bus);
    vcan_run("ip link del vcan8");
}
END_TEST

START_TEST(an_interface_may_be_removed_and_made_again)
{
    const struct bus_filter filter = { 0x123, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR };
    struct bus *bus, *other;
    struct bus_rx rx;

    vcan_run("ip link add vcan8 type vcan");
    vcan_run("ip link set vcan8 up");
    bus = vcan_open("vcan8", false);
    ck_assert_int_eq(bus_set_filters(bus, &filter, 1), CO_OK);
    ck_assert_int_eq(bus_set_own_frames(bus, true), CO_OK);
    vcan_run("ip link del vcan8");
    vcan_wait_state(bus, BUS_DOWN);
    while (bus_receive(bus, &rx) != CO_ERR_NO_BUS)
        ck_assert_int_eq(bus_wait(bus, clock_now() + VCAN_PATIENCE), CO_OK);
    ck_assert_int_eq(send_number(bus, 3), CO_ERR_NO_BUS);
    vcan_run("ip link add vcan8 type vcan && ip link set vcan8 up");
    vcan_wait_state(bus, BUS_ACTIVE);
    other = vcan_open("vcan8", false);
    ck_assert_int_eq(vcan_send(other, "122#", 0), CO_OK); /* the filter has stayed */
    ck_assert_int_eq(vcan_send(other, "123#05", 0), CO_OK);
    vcan_expect(bus, "123#05");
    ck_assert_int_eq(vcan_send(bus, "123#06", 9), CO_OK); /* and so have the options */
    ck_assert_uint_eq(vcan_expect(bus, "123#06").frame.tag, 9);
    vcan_expect(other, "123#06");
    bus_close(other);
    bus_close(bus);
    vcan_run("ip link del vcan8");
}
END_TEST

/* vcan passes error frames on that a test writes. */
START_TEST(error_frames_tell_the_state)
{
    struct bus *bus = vcan_open("vcan0", false);

    vcan_run("cansend vcan0 20000004#0008000000000000");
    vcan_wait_state(bus, BUS_WARNING);
    vcan_run("cansend vcan0 20000004#0020000000000000");
    vcan_wait_state(bus, BUS_PASSIVE);
    vcan_run("cansend vcan0 20000040#0000000000000000");
    vcan_wait_state(bus, BUS_OFF);
    ck_assert_int_eq(send_number(bus, 1), CO_ERR_DOWN);
    vcan_run("cansend vcan0 20000100#0000000000000000");
    vcan_wait_state(bus, BUS_ACTIVE);
    ck_assert_int_eq(send_number(bus, 2), CO_OK);
    ck_assert_uint_eq(bus_outages(bus), 1);
    bus_close(bus);
}
END_TEST

static void by_io_uring(void)
{
    vcan_choose(true);
}

static void by_poll(void)
{
    vcan_choose(false);
}

static void add_tests(Suite *suite, const char *name, void (*choose)(void))
{
    TCase *tests = tcase_create(name);

    tcase_set_timeout(tests, 50);
    tcase_add_checked_fixture(tests, choose, NULL);
    tcase_add_test(tests, a_frame_reaches_the_others);
    tcase_add_test(tests, own_frames_come_back_with_their_tags);
    tcase_add_test(tests, own_frames_are_switched);
    tcase_add_loop_test(tests, filters_pass_what_they_name, 0,
                        sizeof filter_cases / sizeof filter_cases[0]);
    tcase_add_test(tests, all_see_the_same_order);
    tcase_add_test(tests, a_slow_reader_learns_what_it_lost);
    tcase_add_test(tests, other_programs_are_heard);
    tcase_add_test(tests, waiting_ends_with_a_frame_a_wake_or_the_deadline);
    tcase_add_test(tests, interfaces_that_cannot_be_used_are_refused);
    tcase_add_test(tests, an_interface_may_go_down_and_come_back);
    tcase_add_test(tests, an_interface_may_be_removed_and_made_again);
    tcase_add_test(tests, error_frames_tell_the_state);
    suite_add_tcase(suite, tests);
}

int main(void)
{
    Suite *suite = suite_create("socketcan_vcan");
    SRunner *runner;
    int failed;

    if (vcan_has_io_uring())
        add_tests(suite, "io_uring", by_io_uring);
    add_tests(suite, "poll", by_poll);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

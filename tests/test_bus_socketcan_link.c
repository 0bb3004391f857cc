/* SocketCAN whose controller has errors and whose interface comes and goes, in a played kernel. */
#include "support/played_kernel.h"

#include "port/clock.h"
#include "support/hex.h"
#include "support/suite.h"

#include <errno.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

static struct bus *bus;

static void set_up(void)
{
    played_reset();
    bus = played_open();
}

static void tear_down(void)
{
    played_close(bus);
}

static enum co_err send_tagged(uint8_t tag)
{
    struct co_frame frame = co_frame_make(0x123, 1);

    frame.tag = tag;
    return bus_send(bus, &frame);
}

static enum co_err receive(void)
{
    struct bus_rx rx;

    return bus_receive(bus, &rx);
}

/* Until there is nothing more to read; what was read last but for the end. */
static void settle(void)
{
    struct bus_rx rx;

    for (unsigned i = 0; i < 100; i++) {
        while (bus_receive(bus, &rx) == CO_OK)
            ;
        if (bus_wait(bus, 0) == CO_ERR_TIMEOUT)
            return;
    }
    ck_abort_msg("it does not come to rest");
}

static void expect_state(enum bus_state state, unsigned outages, const char *text)
{
    char explained[400];

    bus_explain(bus, explained, sizeof explained);
    ck_assert_msg(bus_get_state(bus) == state, "state %d: %s", (int)bus_get_state(bus), explained);
    ck_assert_uint_eq(bus_outages(bus), outages);
    ck_assert_msg(strstr(explained, text) != NULL, "%s", explained);
}

/* --- the controller --- */

static const struct {
    const char *what;
    canid_t class;
    uint8_t second;
    enum bus_state state;
    const char *text;
} error_frames[] = {
    { "warning, received", CAN_ERR_CRTL, CAN_ERR_CRTL_RX_WARNING, BUS_WARNING, "error warning" },
    { "warning, sent", CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, BUS_WARNING, "error warning" },
    { "passive, received", CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE, BUS_PASSIVE, "error passive" },
    { "passive, sent", CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, BUS_PASSIVE, "error passive" },
    { "both", CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_RX_WARNING, BUS_PASSIVE, "" },
    { "with counters", CAN_ERR_CRTL | CAN_ERR_CNT, CAN_ERR_CRTL_TX_WARNING, BUS_WARNING, "" },
    { "active", CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE, BUS_ACTIVE,
      "can0 is up, 250000 bit/s, error active" },
    { "unspecified", CAN_ERR_CRTL, CAN_ERR_CRTL_UNSPEC, BUS_ACTIVE, "" },
    { "overflow", CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, BUS_ACTIVE, "" },
    { "not acknowledged", CAN_ERR_ACK, 0, BUS_ACTIVE, "" },
    { "lost arbitration", CAN_ERR_LOSTARB, 0, BUS_ACTIVE, "" },
    { "bus-off", CAN_ERR_BUSOFF, 0, BUS_OFF, "is bus-off and tries again after 100 ms" },
    { "bus-off and passive", CAN_ERR_BUSOFF | CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, BUS_OFF, "" },
};

START_TEST(error_frames_tell_the_state)
{
    played_error_frame(error_frames[_i].class, error_frames[_i].second);
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    expect_state(error_frames[_i].state, error_frames[_i].state == BUS_OFF ? 1 : 0,
                 error_frames[_i].text);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
}
END_TEST

START_TEST(a_frame_behind_an_error_frame_is_received_at_once)
{
    const struct delivery delivery = played_frame(0x123, 1);

    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
    played_deliver(&delivery);
    ck_assert_int_eq(receive(), CO_OK);
    ck_assert_int_eq(bus_get_state(bus), BUS_WARNING);
}
END_TEST

START_TEST(bus_off_and_restart)
{
    unsigned sent;

    ck_assert_int_eq(send_tagged(1), CO_OK);
    sent = kernel.sent_count;
    played_error_frame(CAN_ERR_BUSOFF, 0);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    expect_state(BUS_OFF, 1, "bus-off");
    ck_assert_int_eq(send_tagged(2), CO_ERR_DOWN);
    ck_assert_uint_eq(kernel.sent_count, sent); /* the kernel would not have said no */
    played_error_frame(CAN_ERR_RESTARTED, 0);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    expect_state(BUS_ACTIVE, 1, "error active");
    ck_assert_int_eq(send_tagged(3), CO_OK);
}
END_TEST

/* The time between two looks was too long to see it. */
START_TEST(a_short_bus_off_is_counted)
{
    played_error_frame(CAN_ERR_BUSOFF, 0);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    expect_state(BUS_ACTIVE, 1, "error active");
}
END_TEST

/* As the kernel tells it: the carrier is lost and back. */
START_TEST(bus_off_by_news)
{
    kernel.link.controller = BUS_OFF;
    kernel.link.restart_ms = 0;
    played_tell();
    settle();
    expect_state(BUS_OFF, 1,
                 "stays so; check cable, termination and bit rate, then run: ip link "
                 "set can0 type can restart; or have it try by itself: ip link set "
                 "can0 down; ip link set can0 up type can restart-ms 100");
    kernel.link.controller = BUS_WARNING;
    played_tell();
    settle();
    expect_state(BUS_WARNING, 1, "error warning");
}
END_TEST

START_TEST(a_lonely_node_is_told_why)
{
    played_error_frame(CAN_ERR_ACK, 0);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    settle();
    expect_state(BUS_PASSIVE, 0, "nobody acknowledges");
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    settle();
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    settle();
    expect_state(BUS_PASSIVE, 0, "error passive");
}
END_TEST

START_TEST(overruns_of_the_controller_are_losses)
{
    struct delivery delivery = played_frame(0x123, 1);
    struct bus_rx rx;

    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW);
    delivery.drops = 5;
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_eq(rx.lost, 7);
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_eq(rx.lost, 0);
}
END_TEST

/* Error frames on a vcan, from a test: news that know nothing of them do not undo them. */
START_TEST(vcan_has_the_states_it_is_told)
{
    kernel.link.is_controller = false;
    played_tell();
    settle();
    expect_state(BUS_ACTIVE, 0, "can0 is up");
    played_error_frame(CAN_ERR_BUSOFF, 0);
    settle();
    played_tell();
    settle();
    expect_state(BUS_OFF, 1, "bus-off");
    played_error_frame(CAN_ERR_RESTARTED, 0);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
}
END_TEST

START_TEST(a_short_queue_is_advised_against)
{
    kernel.link.queue_length = 10;
    played_tell();
    settle();
    expect_state(BUS_ACTIVE, 0, "room for 10 frames, better run: ip link set can0 txqueuelen 1000");
}
END_TEST

/* --- the interface --- */

START_TEST(down_and_up)
{
    ck_assert_int_eq(send_tagged(1), CO_OK);
    kernel.link.is_up = false;
    played_fail(ENETDOWN);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(receive(), CO_ERR_DOWN);
    expect_state(BUS_DOWN, 1, "can0");
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK); /* the kernel's answer */
    expect_state(BUS_DOWN, 1, "can0 is down; run: ip link set can0 up");
    ck_assert_int_eq(receive(), CO_ERR_DOWN);
    ck_assert_int_eq(send_tagged(2), CO_ERR_DOWN);
    ck_assert_int_eq(bus_wait(bus, clock_now() + CO_MS(20)), CO_ERR_TIMEOUT); /* no haste */
    played_set_up(true);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(receive(), CO_ERR_AGAIN);
    ck_assert_int_eq(send_tagged(3), CO_OK);
    ck_assert_uint_eq(kernel.binds, 1); /* it is still the same one */
}
END_TEST

START_TEST(a_sender_notices_first)
{
    kernel.link.is_up = false;
    kernel.send_error = ENETDOWN;
    ck_assert_int_eq(send_tagged(1), CO_ERR_DOWN);
    expect_state(BUS_DOWN, 1, "can0");
    ck_assert_uint_eq(kernel.requests, 2);
    kernel.send_error = 0;
    played_set_up(true);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(send_tagged(2), CO_OK);
}
END_TEST

/* It is over when the socket tells of it. */
START_TEST(late_errors_of_the_socket_do_no_harm)
{
    played_set_up(false);
    played_set_up(true);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    played_fail(ENETDOWN);
    ck_assert_int_eq(receive(), CO_ERR_DOWN);
    settle();
    expect_state(BUS_ACTIVE, 2, "can0 is up");
    ck_assert_int_eq(send_tagged(1), CO_OK);
}
END_TEST

static void replace_interface(int index)
{
    played_news(CAN_LINK_GONE, &kernel.link);
    kernel.link.index = index;
    kernel.link.is_up = false;
    played_tell();
}

START_TEST(removed_and_made_again)
{
    const struct bus_filter filters[] = { { 0x123, 0x7FF, 0, 3 }, { 0x605, 0x7FF, 0, 3 } };
    const struct can_link gone = kernel.link;

    ck_assert_int_eq(bus_set_filters(bus, filters, 2), CO_OK);
    kernel.link.index = 0;
    played_news(CAN_LINK_GONE, &gone);
    played_fail(ENODEV);
    settle();
    expect_state(BUS_DOWN, 1, "no such CAN interface");
    ck_assert_int_eq(receive(), CO_ERR_NO_BUS);
    ck_assert_int_eq(send_tagged(1), CO_ERR_NO_BUS);
    kernel.link = gone;
    kernel.link.index = 12;
    played_set_up(false);
    settle();
    expect_state(BUS_DOWN, 1, "can0 is down");
    ck_assert_int_eq(kernel.bound, 0);
    played_set_up(true);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(kernel.bound, 12);
    ck_assert_uint_eq(kernel.filter_count, 2);
    ck_assert_uint_eq(kernel.filters[1].can_id, 0x605);
    ck_assert_int_eq(send_tagged(2), CO_OK);
}
END_TEST

START_TEST(another_one_without_a_gap)
{
    replace_interface(9);
    played_set_up(true);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(kernel.bound, 9);
}
END_TEST

START_TEST(the_name_counts)
{
    struct can_link other = kernel.link;
    const struct delivery delivery = played_frame(0x123, 1);

    strcpy(other.name, "can5");
    kernel.link.index = 0;
    played_news(CAN_LINK_IS, &other);
    settle();
    expect_state(BUS_DOWN, 1, "no such CAN interface");
    played_deliver(&delivery); /* the socket is still bound to it */
    ck_assert_int_eq(receive(), CO_ERR_NO_BUS);
    strcpy(other.name, "can0");
    kernel.link = other;
    played_tell();
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    played_deliver(&delivery);
    ck_assert_int_eq(receive(), CO_OK);
}
END_TEST

START_TEST(others_do_not_count)
{
    struct can_link other = kernel.link;

    strcpy(other.name, "can5");
    other.index = 8;
    other.is_up = false;
    played_news(CAN_LINK_IS, &other);
    played_news(CAN_LINK_GONE, &other);
    settle();
    expect_state(BUS_ACTIVE, 0, "can0 is up");
}
END_TEST

START_TEST(back_at_another_bit_rate)
{
    played_set_up(false);
    kernel.link.bitrate = 500000;
    played_set_up(true);
    settle();
    expect_state(BUS_DOWN, 1, "can0 is at 500000 bit/s, configured are 250000; run: ip link set");
    ck_assert_int_eq(send_tagged(1), CO_ERR_DOWN);
    played_set_up(false);
    kernel.link.bitrate = 250000;
    played_set_up(true);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(send_tagged(2), CO_OK);
}
END_TEST

START_TEST(back_as_something_else)
{
    replace_interface(9);
    kernel.link.is_can = false;
    played_set_up(true);
    settle();
    expect_state(BUS_DOWN, 1, "can0 is not a CAN interface");
    ck_assert_uint_eq(kernel.binds, 1);
}
END_TEST

/* Gone again in that moment: the next news are waited for. */
START_TEST(binding_fails)
{
    replace_interface(9);
    kernel.bind_error = ENODEV;
    played_set_up(true);
    settle();
    expect_state(BUS_DOWN, 1, "");
    kernel.bind_error = 0;
    replace_interface(10);
    played_set_up(true);
    settle();
    expect_state(BUS_ACTIVE, 1, "can0 is up");
    ck_assert_int_eq(kernel.bound, 10);
}
END_TEST

START_TEST(lost_news_are_asked_for)
{
    kernel.news_error = ENOBUFS;
    kernel.link.is_up = false; /* and nobody tells */
    played_bytes((const uint8_t *)"garbage", 7);
    settle();
    ck_assert_uint_eq(kernel.requests, 2);
    expect_state(BUS_DOWN, 1, "can0 is down");
}
END_TEST

START_TEST(garbage_changes_nothing)
{
    uint8_t bytes[200];
    uint64_t seed = (uint64_t)_i;

    for (unsigned n = 0; n < 100; n++) {
        for (unsigned i = 0; i < sizeof bytes; i++)
            bytes[i] = (uint8_t)noise(&seed);
        played_bytes(bytes, n);
    }
    settle();
    expect_state(BUS_ACTIVE, 0, "can0 is up");
}
END_TEST

/* What was on its way does not come back: its tag is for no other frame. */
START_TEST(tags_end_with_the_connection)
{
    struct delivery delivery = played_frame(0x123, 0);
    struct bus_rx rx;

    ck_assert_int_eq(send_tagged(1), CO_OK);
    played_set_up(false);
    played_set_up(true);
    settle();
    ck_assert_int_eq(send_tagged(2), CO_OK);
    delivery.flags = MSG_CONFIRM;
    played_deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_eq(rx.frame.tag, 2);
}
END_TEST

/* --- filters set while the socket is bound anew --- */

#define REPLACED 300u

struct follower {
    _Atomic bool ended;
    _Atomic unsigned waits;
};

static void *follow_news(void *context)
{
    struct follower *self = context;

    for (; !self->ended; self->waits++)
        bus_wait(bus, CO_NEVER);
    return NULL;
}

/* Each time another interface of the name, gone again: the socket goes back to the first one. */
static void tell_of_another(void)
{
    struct can_link other = kernel.link;

    other.index = 9;
    other.is_up = false;
    played_news(CAN_LINK_IS, &other);
    played_tell();
}

START_TEST(the_last_filters_count)
{
    struct bus_filter filter = { 0, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR };
    struct follower follower = { .waits = 0 };
    pthread_t thread;

    ck_assert_int_eq(pthread_create(&thread, NULL, follow_news, &follower), 0);
    for (filter.id = 1; filter.id <= REPLACED; filter.id++) {
        unsigned waits = follower.waits;

        tell_of_another();
        ck_assert_int_eq(bus_set_own_frames(bus, filter.id % 2), CO_OK);
        ck_assert_int_eq(bus_set_filters(bus, &filter, 1), CO_OK);
        while (follower.waits == waits)
            ;
    }
    follower.ended = true;
    bus_wake(bus);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    settle();
    expect_state(BUS_ACTIVE, bus_outages(bus), "can0 is up");
    ck_assert_uint_ge(kernel.binds, 2);
    ck_assert_uint_eq(kernel.filters[0].can_id, REPLACED);
    ck_assert_int_eq(kernel.raw_options[CAN_RAW_RECV_OWN_MSGS], REPLACED % 2);
}
END_TEST

/* --- everything in any order --- */

static void change_interface(uint32_t choice)
{
    struct can_link gone = kernel.link;

    switch (choice % 8) {
    case 0:
    case 1: kernel.link.is_up = !kernel.link.is_up; break;
    case 2: kernel.link.bitrate = 750000 - kernel.link.bitrate; break;
    case 3:
        kernel.link.index = 0;
        if (gone.index != 0)
            played_news(CAN_LINK_GONE, &gone);
        return;
    case 4: kernel.link.index = 3 + (int)(choice / 8 % 3); break;
    case 5: played_fail(ENETDOWN); return;
    case 6: played_fail(choice & 8 ? ENODEV : ENXIO); return;
    default: bus_wait(bus, 0); return;
    }
    played_tell();
}

START_TEST(in_the_end_it_is_as_the_kernel_says)
{
    uint64_t seed = (uint64_t)_i;
    bool is_usable;

    for (unsigned n = 0; n < 50; n++) {
        for (unsigned i = noise(&seed) % 8; i > 0; i--) {
            change_interface(noise(&seed));
            if (noise(&seed) % 3 == 0)
                receive();
            if (noise(&seed) % 3 == 0)
                send_tagged(1);
        }
        settle();
        is_usable = kernel.link.index != 0 && kernel.link.is_up && kernel.link.bitrate == 250000;
        ck_assert_int_eq(bus_get_state(bus), is_usable ? BUS_ACTIVE : BUS_DOWN);
        ck_assert_int_eq(receive(), is_usable                ? CO_ERR_AGAIN
                                    : kernel.link.index != 0 ? CO_ERR_DOWN
                                                             : CO_ERR_NO_BUS);
        if (is_usable)
            ck_assert_int_eq(kernel.bound, kernel.link.index);
    }
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("played kernel");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_loop_test(tests, error_frames_tell_the_state, 0, LENGTH(error_frames));
    tcase_add_test(tests, a_frame_behind_an_error_frame_is_received_at_once);
    tcase_add_test(tests, bus_off_and_restart);
    tcase_add_test(tests, a_short_bus_off_is_counted);
    tcase_add_test(tests, bus_off_by_news);
    tcase_add_test(tests, a_lonely_node_is_told_why);
    tcase_add_test(tests, overruns_of_the_controller_are_losses);
    tcase_add_test(tests, vcan_has_the_states_it_is_told);
    tcase_add_test(tests, a_short_queue_is_advised_against);
    tcase_add_test(tests, down_and_up);
    tcase_add_test(tests, a_sender_notices_first);
    tcase_add_test(tests, late_errors_of_the_socket_do_no_harm);
    tcase_add_test(tests, removed_and_made_again);
    tcase_add_test(tests, another_one_without_a_gap);
    tcase_add_test(tests, the_name_counts);
    tcase_add_test(tests, others_do_not_count);
    tcase_add_test(tests, back_at_another_bit_rate);
    tcase_add_test(tests, back_as_something_else);
    tcase_add_test(tests, binding_fails);
    tcase_add_test(tests, lost_news_are_asked_for);
    tcase_add_loop_test(tests, garbage_changes_nothing, 0, 5);
    tcase_add_test(tests, tags_end_with_the_connection);
    tcase_add_test(tests, the_last_filters_count);
    tcase_add_loop_test(tests, in_the_end_it_is_as_the_kernel_says, 0, 40);
    return suite_run("bus_socketcan_link", tests);
}

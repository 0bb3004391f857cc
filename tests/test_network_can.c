/* runtime/network on a SocketCAN whose system calls fail. */
#include "runtime/network.h"

#include "port/clock.h"
#include "support/played_kernel.h"
#include "support/suite.h"

#include <errno.h>
#include <linux/can/error.h>
#include <string.h>

#define NODE     5
#define PATIENCE CO_MS(30000)
#define EVENTS   64u

static struct network *network;
static struct od od;
static struct slave slave;

static struct {
    struct co_lock lock;
    struct co_condition changed;
    struct co_event events[EVENTS];
    unsigned count;
} told;

static void on_event(void *context, struct network *from, const struct co_event *event)
{
    (void)context;
    (void)from;
    if (event->type < RUNTIME_FRAMES_LOST)
        return;
    lock_take(&told.lock);
    if (told.count < EVENTS)
        told.events[told.count++] = *event;
    condition_signal(&told.changed);
    lock_give(&told.lock);
}

/* The n-th event about the bus must be this one. */
static uint64_t expect_told(unsigned number, unsigned type, unsigned detail)
{
    co_us_t limit = clock_now() + PATIENCE;
    enum co_err err = CO_OK;
    struct co_event event = { .type = 0 };

    lock_take(&told.lock);
    while (told.count <= number && err != CO_ERR_TIMEOUT)
        err = condition_wait(&told.changed, &told.lock, limit);
    if (told.count > number)
        event = told.events[number];
    lock_give(&told.lock);
    ck_assert_uint_eq(event.type, type);
    ck_assert_uint_eq(event.detail, detail);
    return event.actual;
}

static void set_up(void)
{
    struct network_options options = { .sink = on_event };

    played_reset();
    options.opened = played_open();
    told.count = 0;
    ck_assert_int_eq(lock_init(&told.lock), CO_OK);
    ck_assert_int_eq(condition_init(&told.changed), CO_OK);
    ck_assert_int_eq(network_open(&options, &network, NULL, 0), CO_OK);
    od_init(&od);
    ck_assert_int_eq(slave_init(&slave, NODE, &od), CO_OK);
    ck_assert_int_eq(network_add_slave(network, &slave), CO_OK);
    ck_assert_int_eq(network_start(network), CO_OK);
}

static void tear_down(void)
{
    network_close(network);
    slave_done(&slave);
    od_done(&od);
}

static struct co_outbox *enter(void)
{
    co_us_t now;

    return network_enter(network, &now);
}

static void set_send_error(int error)
{
    enter();
    kernel.send_error = error;
    network_leave(network, NODE);
}

static void put(const char *const *texts)
{
    struct co_outbox *out = enter();
    struct co_frame frame;

    for (; *texts; texts++) {
        ck_assert(co_frame_parse(*texts, &frame));
        co_outbox_put_frame(out, &frame);
    }
    network_leave(network, NODE);
}

static unsigned sent_count(void)
{
    unsigned count;

    enter();
    count = kernel.sent_count;
    network_leave(network, NODE);
    return count;
}

static void wait_sent(unsigned count)
{
    co_us_t limit = clock_now() + PATIENCE;
    struct timespec pause = { .tv_nsec = 1000000 };

    while (sent_count() < count && clock_now() < limit)
        nanosleep(&pause, NULL);
    ck_assert_uint_eq(sent_count(), count);
}

/* The frames behind the boot-up message. */
static void expect_sent(const char *const *texts)
{
    char text[CO_FRAME_TEXT_SIZE];

    enter();
    for (unsigned i = 1; *texts; i++, texts++) {
        const struct can_frame *raw = &kernel.log[i];
        struct co_frame frame = co_frame_make(raw->can_id, raw->len);

        memcpy(frame.data, raw->data, sizeof frame.data);
        ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), *texts);
    }
    network_leave(network, NODE);
}

static const char *const as_made[] = { "705#05", "605#01", "000#8105", "605#02", "085#00", NULL };
static const char *const by_rank[] = { "000#8105", "085#00", "605#01", "605#02", "705#05", NULL };

START_TEST(a_bus_that_keeps_up_gets_frames_as_they_are_made)
{
    wait_sent(1);
    put(as_made);
    wait_sent(6);
    expect_sent(as_made);
    ck_assert_uint_eq(told.count, 0);
}
END_TEST

START_TEST(waiting_frames_are_sent_by_priority)
{
    wait_sent(1);
    set_send_error(ENOBUFS);
    put(as_made);
    expect_told(0, RUNTIME_BUSY, 0);
    ck_assert_uint_eq(sent_count(), 1);
    set_send_error(0);
    wait_sent(6);
    expect_sent(by_rank);
}
END_TEST

/* Many short ones; nothing is lost, and it is told once. */
START_TEST(bursts_of_enobufs)
{
    wait_sent(1);
    for (unsigned i = 0; i < 20; i++) {
        set_send_error(i % 2 ? EAGAIN : ENOBUFS);
        put(as_made);
        set_send_error(0);
        wait_sent(6 + 5 * i);
    }
    expect_told(0, RUNTIME_BUSY, 0);
    ck_assert_uint_eq(told.count, 1);
}
END_TEST

START_TEST(down_while_frames_wait)
{
    wait_sent(1);
    set_send_error(ENOBUFS);
    put(as_made);
    enter();
    kernel.send_error = ENETDOWN;
    kernel.link.is_up = false;
    network_leave(network, NODE);
    expect_told(0, RUNTIME_BUSY, 0);
    expect_told(1, RUNTIME_BUS_STATE, BUS_DOWN);
    ck_assert_uint_eq(expect_told(2, RUNTIME_UNSENT, BUS_DOWN), 5); /* not sent later, either */
    enter();
    kernel.send_error = 0;
    played_set_up(true);
    network_leave(network, NODE);
    expect_told(3, RUNTIME_BUS_STATE, BUS_ACTIVE);
    ck_assert_uint_eq(sent_count(), 1);
    put(by_rank);
    wait_sent(6);
}
END_TEST

START_TEST(states_of_the_controller_are_told)
{
    static const struct {
        canid_t class;
        uint8_t second;
        enum bus_state state;
    } steps[] = {
        { CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, BUS_WARNING },
        { CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, BUS_PASSIVE },
        { CAN_ERR_BUSOFF, 0, BUS_OFF },
        { CAN_ERR_RESTARTED, 0, BUS_ACTIVE },
    };

    for (unsigned i = 0; i < 4; i++) {
        played_error_frame(steps[i].class, steps[i].second);
        expect_told(i, RUNTIME_BUS_STATE, steps[i].state);
    }
}
END_TEST

/* Over before anybody has looked: lost all the same, and who had to know knows. */
START_TEST(a_short_outage_is_told)
{
    wait_sent(1);
    enter();
    played_error_frame(CAN_ERR_BUSOFF, 0);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    network_leave(network, NODE);
    expect_told(0, RUNTIME_BUS_STATE, BUS_DOWN);
    expect_told(1, RUNTIME_BUS_STATE, BUS_ACTIVE);
}
END_TEST

START_TEST(no_right_to_send)
{
    wait_sent(1);
    set_send_error(EPERM);
    put(as_made);
    expect_told(0, RUNTIME_BUS_STATE, BUS_DOWN);
    expect_told(1, RUNTIME_UNSENT, BUS_DOWN);
    set_send_error(0);
    expect_told(2, RUNTIME_BUS_STATE, BUS_ACTIVE);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("played kernel");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, a_bus_that_keeps_up_gets_frames_as_they_are_made);
    tcase_add_test(tests, waiting_frames_are_sent_by_priority);
    tcase_add_test(tests, bursts_of_enobufs);
    tcase_add_test(tests, down_while_frames_wait);
    tcase_add_test(tests, states_of_the_controller_are_told);
    tcase_add_test(tests, a_short_outage_is_told);
    tcase_add_test(tests, no_right_to_send);
    return suite_run("network_can", tests);
}

/* runtime/network: local devices on a virtual bus, sending, waiting and closing. */
#include "runtime/network.h"

#include "manager/event.h"
#include "port/bus_segment.h"
#include "port/clock.h"
#include "proto/event.h"
#include "runtime/tx_queue.h"
#include "slave/slave.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/config_text.h"
#include "support/suite.h"

#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EVENTS 4096u

static struct network *network;
static struct api_wire *wire;
static char bus[40];

static struct {
    struct co_lock lock;
    struct co_condition changed;
    struct co_event events[EVENTS];
    unsigned count;
} told;

static void on_event(void *context, struct network *from, const struct co_event *event)
{
    (void)from;
    lock_take(&told.lock);
    if (told.count < EVENTS)
        told.events[told.count++] = *event;
    condition_signal(&told.changed);
    lock_give(&told.lock);
    ck_assert_ptr_eq(context, &told);
}

static void set_up(void)
{
    const struct network_options options = {
        .bus = bus, .bitrate = 500, .sink = on_event, .context = &told
    };
    char message[200] = "";

    snprintf(bus, sizeof bus, "virtual:network-%d", (int)getpid());
    told.count = 0;
    ck_assert_int_eq(lock_init(&told.lock), CO_OK);
    ck_assert_int_eq(condition_init(&told.changed), CO_OK);
    wire = api_wire_open(bus);
    ck_assert_msg(network_open(&options, &network, message, sizeof message) == CO_OK, "%s",
                  message);
}

static void tear_down(void)
{
    network_close(network);
    api_wire_close(wire);
    condition_done(&told.changed);
    lock_done(&told.lock);
}

/* Under the lock: how often this was told, and the sum of the numbers in it. */
static unsigned count_told(unsigned type, unsigned node, uint64_t *ret_sum)
{
    unsigned count = 0;

    *ret_sum = 0;
    for (unsigned i = 0; i < told.count; i++) {
        if (told.events[i].type != type || told.events[i].node != node)
            continue;
        count++;
        *ret_sum += told.events[i].actual;
    }
    return count;
}

/* Waits until it was told so often, and until the sum is as large. */
static uint64_t wait_told(unsigned type, unsigned node, unsigned times, uint64_t least)
{
    co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;
    unsigned count;
    uint64_t sum;

    lock_take(&told.lock);
    while (((count = count_told(type, node, &sum)) < times || sum < least) && err != CO_ERR_TIMEOUT)
        err = condition_wait(&told.changed, &told.lock, limit);
    lock_give(&told.lock);
    ck_assert_msg(count >= times && sum >= least, "event %u: %u times, sum %u", type, count,
                  (unsigned)sum);
    return sum;
}

static unsigned times_told(unsigned type, unsigned node)
{
    unsigned count;
    uint64_t sum;

    lock_take(&told.lock);
    count = count_told(type, node, &sum);
    lock_give(&told.lock);
    return count;
}

/* --- devices --- */

struct local {
    struct od od;
    struct slave slave;
};

/* watched: a node whose heartbeats it watches, 0: none */
static void add_device(struct local *self, uint8_t node, uint8_t watched)
{
    od_init(&self->od);
    ck_assert_int_eq(od_add_number(&self->od, 0x1016, 0, OD_UNSIGNED8, OD_RO, 1), CO_OK);
    ck_assert_int_eq(
        od_add_number(&self->od, 0x1016, 1, OD_UNSIGNED32, OD_RW, (uint32_t)watched << 16 | 30000),
        CO_OK);
    ck_assert_int_eq(od_add_number(&self->od, 0x1017, 0, OD_UNSIGNED16, OD_RW, 0), CO_OK);
    ck_assert_int_eq(slave_init(&self->slave, node, &self->od), CO_OK);
    ck_assert_int_eq(network_add_slave(network, &self->slave), CO_OK);
}

static void device_free(struct local *self)
{
    slave_done(&self->slave);
    od_done(&self->od);
}

START_TEST(a_lone_device_comes_up_and_answers)
{
    struct local device;

    add_device(&device, 5, 0);
    ck_assert_int_eq(network_start(network), CO_OK);
    api_wire_wait(wire, "705#00", 1);
    api_wire_say(wire, "605#4016100000000000");
    api_wire_wait(wire, "585#4F161000010", 1);
    network_stop(network);
    device_free(&device);
}
END_TEST

START_TEST(a_deadline_is_kept_without_a_frame)
{
    struct local device;

    add_device(&device, 5, 0);
    ck_assert_int_eq(network_start(network), CO_OK);
    api_wire_say(wire, "605#2B1710000A000000"); /* a heartbeat each 10 ms */
    api_wire_wait(wire, "705#7F", 5);
    network_stop(network);
    device_free(&device);
}
END_TEST

/* 5 watches itself, and must not hear itself; 6 watches 5. */
START_TEST(local_devices_hear_each_other_but_not_themselves)
{
    struct local first, second;

    add_device(&first, 5, 5);
    add_device(&second, 6, 5);
    ck_assert_int_eq(network_start(network), CO_OK);
    api_wire_wait(wire, "706#00", 1);
    api_wire_say(wire, "605#2B1710000A000000");
    wait_told(PROTO_HB_STATE, 5, 1, 0);
    api_wire_wait(wire, "705#7F", 10);
    network_stop(network);
    ck_assert_uint_eq(times_told(PROTO_HB_STATE, 5), 1);
    device_free(&first);
    device_free(&second);
}
END_TEST

START_TEST(a_node_id_is_given_once)
{
    struct local device;

    add_device(&device, 5, 0);
    ck_assert_int_eq(network_add_slave(network, &device.slave), CO_ERR_EXISTS);
    device_free(&device);
}
END_TEST

/* A manager boots a device of its own process: NMT, both ways of SDO, heartbeats. */
START_TEST(a_manager_boots_a_local_device)
{
    struct network_config *config = config_parse_one(
        NODE("<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
             "<NMT_Reset_Node>TRUE</NMT_Reset_Node>\n"));
    struct manager *manager = calloc(1, sizeof *manager);
    struct local device;

    ck_assert_ptr_nonnull(manager);
    ck_assert_int_eq(manager_init(manager, config), CO_OK);
    ck_assert_int_eq(network_add_manager(network, manager), CO_OK);
    add_device(&device, 5, 127);
    ck_assert_int_eq(network_start(network), CO_OK);
    wait_told(MANAGER_NETWORK_UP, 0, 1, 1);
    wait_told(SLAVE_STATE, 5, 5, 0); /* on, off by the reset, on, operational */
    network_stop(network);
    ck_assert_uint_eq(device.slave.state, NMT_OPERATIONAL);
    device_free(&device);
    manager_done(manager);
    free(manager);
    network_config_free(config, 1);
}
END_TEST

/* --- sending --- */

/* Takes the bus away, as a stopped process does. */
static void hold_bus(struct segment *segment)
{
    const struct bus_message message = { NULL, 0 };

    ck_assert_int_eq(segment_open(segment, bus + strlen("virtual:"), 0, &message), CO_OK);
    while (segment_lock(segment, SEGMENT_HOLD_LIMIT) != CO_OK)
        continue;
}

static void let_bus_go(struct segment *segment)
{
    segment_unlock(segment);
    segment_close(segment);
}

/* Numbered frames, in bursts as large as an outbox. */
static void send_frames(unsigned count)
{
    struct co_outbox *out;
    co_us_t now;

    for (unsigned i = 0; i < count;) {
        out = network_enter(network, &now);
        for (; i < count && co_outbox_room(out, 1, 0); i++) {
            struct co_frame frame = co_frame_make(0x201, 2);

            frame.data[0] = (uint8_t)(i >> 8);
            frame.data[1] = (uint8_t)i;
            co_outbox_put_frame(out, &frame);
        }
        network_leave(network, 5);
    }
}

static unsigned bus_state(void)
{
    enum bus_state state;
    co_us_t now;

    network_enter(network, &now);
    state = network_bus_state(network);
    network_leave(network, 5);
    return state;
}

START_TEST(frames_wait_for_the_bus_and_what_finds_no_room_is_told)
{
    struct segment segment;
    char text[CO_FRAME_TEXT_SIZE];

    ck_assert_int_eq(network_start(network), CO_OK);
    hold_bus(&segment);
    send_frames(3); /* lost: that is how it shows */
    ck_assert_uint_eq(wait_told(RUNTIME_UNSENT, 0, 1, 3), 3);
    wait_told(RUNTIME_BUS_STATE, 0, 1, 0);
    ck_assert_uint_eq(bus_state(), BUS_DOWN);
    send_frames(TX_QUEUE_SIZE + 500);
    ck_assert_uint_eq(wait_told(RUNTIME_UNSENT, 0, 2, 503), 503);
    ck_assert_uint_eq(api_wire_count(wire, "201#"), 0);
    let_bus_go(&segment);
    api_wire_wait(wire, "201#", TX_QUEUE_SIZE);
    for (unsigned i = 0; i < TX_QUEUE_SIZE; i++) {
        snprintf(text, sizeof text, "201#%04X", i);
        ck_assert_uint_eq(api_wire_count(wire, text), 1);
    }
    wait_told(RUNTIME_BUS_STATE, 0, 2, 0);
    ck_assert_uint_eq(bus_state(), BUS_ACTIVE);
}
END_TEST

START_TEST(frames_that_waited_too_long_are_given_up)
{
    struct segment segment;
    co_us_t start;

    ck_assert_int_eq(network_start(network), CO_OK);
    hold_bus(&segment);
    send_frames(1);
    wait_told(RUNTIME_UNSENT, 0, 1, 1);
    start = clock_now();
    send_frames(10);
    ck_assert_uint_eq(wait_told(RUNTIME_UNSENT, 0, 2, 11), 11);
    ck_assert_uint_ge(clock_now(), start + TX_QUEUE_GIVE_UP);
    ck_assert_uint_lt(clock_now(), start + 2 * TX_QUEUE_GIVE_UP);
    let_bus_go(&segment);
    wait_told(RUNTIME_BUS_STATE, 0, 2, 0);
    send_frames(1);
    api_wire_wait(wire, "201#", 1);
    ck_assert_uint_eq(api_wire_count(wire, "201#"), 1);
}
END_TEST

/* --- receiving --- */

START_TEST(frames_that_come_too_fast_are_counted)
{
    const struct bus_options options = { .own_frames = false };
    const struct co_frame frame = co_frame_make(0x000, 1); /* everybody listens to it */
    struct bus *other;
    co_us_t now;

    ck_assert_int_eq(network_start(network), CO_OK);
    ck_assert_int_eq(bus_open(bus, &options, &other, NULL, 0), CO_OK);
    network_enter(network, &now); /* so that nobody reads */
    for (unsigned i = 0; i < SEGMENT_RECORDS + 1000; i++)
        ck_assert_int_eq(bus_send(other, &frame), CO_OK);
    network_leave(network, 5);
    ck_assert_uint_ge(wait_told(RUNTIME_FRAMES_LOST, 0, 1, 1), 1000);
    bus_close(other);
}
END_TEST

/* --- waiting and closing --- */

static unsigned waiting; /* under the network's lock */

static void *wait_for_ever(void *context)
{
    enum co_err *err = context;
    co_us_t now;

    network_enter(network, &now);
    waiting++;
    *err = CO_OK;
    while (*err == CO_OK)
        *err = network_wait(network, 5, CO_NEVER);
    network_leave(network, 5);
    return NULL;
}

/* Who has the lock after them knows that they wait. */
static void until_waiting(unsigned count)
{
    unsigned now_waiting = 0;
    co_us_t now;

    while (now_waiting < count) {
        network_enter(network, &now);
        now_waiting = waiting;
        network_leave(network, 5);
        sched_yield();
    }
}

START_TEST(closing_ends_all_who_wait)
{
    struct co_thread threads[3];
    enum co_err results[3];
    co_us_t start;

    ck_assert_int_eq(network_start(network), CO_OK);
    for (unsigned i = 0; i < 3; i++)
        ck_assert_int_eq(thread_start(&threads[i], "waits", wait_for_ever, &results[i]), CO_OK);
    until_waiting(3);
    start = clock_now();
    network_shut(network);
    for (unsigned i = 0; i < 3; i++) {
        thread_join(&threads[i]);
        ck_assert_int_eq(results[i], CO_ERR_STATE);
    }
    ck_assert_uint_lt(clock_now(), start + CO_MS(10000));
}
END_TEST

START_TEST(a_wait_has_a_deadline)
{
    co_us_t now, deadline = clock_now() + CO_MS(30);
    enum co_err err;

    ck_assert_int_eq(network_start(network), CO_OK);
    network_enter(network, &now);
    do
        err = network_wait(network, 5, deadline);
    while (err == CO_OK);
    network_leave(network, 5);
    ck_assert_int_eq(err, CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
}
END_TEST

START_TEST(a_network_that_never_ran_can_be_closed)
{
    network_stop(network);
    network_stop(network);
    network_close(NULL);
    ck_assert_str_eq(network_name(network), bus);
}
END_TEST

START_TEST(a_bus_that_cannot_be_opened)
{
    const struct network_options options = { .bus = "no-such-can9" };
    struct network *none = NULL;
    char message[200] = "";

    ck_assert_int_eq(network_open(&options, &none, message, sizeof message), CO_ERR_NO_BUS);
    ck_assert_ptr_null(none);
    ck_assert_ptr_nonnull(strstr(message, "no-such-can9"));
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("network");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, a_lone_device_comes_up_and_answers);
    tcase_add_test(tests, a_deadline_is_kept_without_a_frame);
    tcase_add_test(tests, local_devices_hear_each_other_but_not_themselves);
    tcase_add_test(tests, a_node_id_is_given_once);
    tcase_add_test(tests, a_manager_boots_a_local_device);
    tcase_add_test(tests, frames_wait_for_the_bus_and_what_finds_no_room_is_told);
    tcase_add_test(tests, frames_that_waited_too_long_are_given_up);
    tcase_add_test(tests, frames_that_come_too_fast_are_counted);
    tcase_add_test(tests, closing_ends_all_who_wait);
    tcase_add_test(tests, a_wait_has_a_deadline);
    tcase_add_test(tests, a_network_that_never_ran_can_be_closed);
    tcase_add_test(tests, a_bus_that_cannot_be_opened);
    return suite_run("network", tests);
}

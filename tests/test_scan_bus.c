/*
 * What local nodes tell of their bus, at the API: a network on a CAN interface whose kernel is
 * played (support/played_kernel.h); tests/CMakeLists.txt leads bus_socketcan_open() here.
 */
#include "support/played_kernel.h"
#include "support/scan_notes.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include "api/scan.h"
#include "port/clock.h"

#include <linux/can/error.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE CO_MS(30000)

static HNODE node;

enum co_err __wrap_bus_socketcan_open(const char *name, const struct bus_options *options,
                                      struct bus **ret_bus, const struct bus_message *message);

enum co_err __wrap_bus_socketcan_open(const char *name, const struct bus_options *options,
                                      struct bus **ret_bus, const struct bus_message *message)
{
    return bus_socketcan_open_with(&played_calls, name, options, ret_bus, message);
}

static struct network *network(void)
{
    return scan_net(0)->network;
}

static HNODE make_node(int id, unsigned long options, unsigned long mask)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE made = NULL;

    info.ulOptions |= options;
    info.ulEventMask = mask;
    info.ulSyncCobID = DEFAULT_SYNC_COBID | SYNC_PRODUCE;
    info.ulCyclePeriod = 5000;
    ck_assert_int_eq(canOpenCreateNodeEx(0, id, scan_on_event, &info, &made), SCANOPEN_OK);
    ck_assert_int_eq(canOpenActivateNode(made), SCANOPEN_OK);
    return made;
}

static void set_up(void)
{
    const SLAVE_NET_INFO info = { .usBaudrate = 250 };

    played_reset();
    scan_notes_clear();
    ck_assert_int_eq(setenv("MCANOPEN_NET_0", "can0", 1), 0);
    ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    node = make_node(5, 0, EV_CAN);
}

static void remove_node(HNODE old)
{
    canOpenResetNode(old);
    canOpenDeleteNode(old);
}

static void tear_down(void)
{
    remove_node(node);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
}

static unsigned sent_count(void)
{
    unsigned count;

    network_hold(network());
    count = kernel.sent_count;
    network_release(network());
    return count;
}

/* The n-th frame that was sent, 0 is the boot-up message. */
static void expect_sent(unsigned number, const char *text)
{
    const co_us_t limit = clock_now() + PATIENCE;
    const struct timespec pause = { .tv_nsec = 1000000 };
    char got[CO_FRAME_TEXT_SIZE];
    struct co_frame frame;

    while (sent_count() <= number && clock_now() < limit)
        nanosleep(&pause, NULL);
    ck_assert_uint_gt(sent_count(), number);
    network_hold(network());
    frame = co_frame_make(kernel.log[number].can_id, kernel.log[number].len);
    memcpy(frame.data, kernel.log[number].data, sizeof frame.data);
    network_release(network());
    ck_assert_str_eq(co_frame_format(&frame, got, sizeof got), text);
}

static void expect_event(int id, int what, unsigned number)
{
    char note[SCAN_NOTE_SIZE];

    snprintf(note, sizeof note, "event 0/%d CAN %d %u", id, what, number);
    scan_expect_note(note);
}

#define BOOT_UP   "705#00"
#define PASSIVE   "085#2081110201000000"
#define RECOVERED "085#4081110401000000"
#define NO_ERROR  "085#0000000001000000"

START_TEST(error_passive)
{
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    expect_event(5, EV_CONTROLLER_WARN, 0);
    expect_sent(0, BOOT_UP);
    expect_sent(1, PASSIVE);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    expect_event(5, EV_CONTROLLER_OK, 0);
    expect_sent(2, NO_ERROR);
    ck_assert_uint_eq(EMCY_CAN_PASSIVE, 0x8120);
    ck_assert_uint_eq(EMCY_TEMPORARY_CAN_PASSIVE, 2);
    ck_assert_uint_eq(EMCY_STICKY_CAN_ERROR, 1);
}
END_TEST

/* 1029h is not there: operational becomes pre-operational. */
START_TEST(bus_off)
{
    struct delivery start = played_frame(0x000, NMT_START);

    start.frame.len = 2;
    start.frame.data[1] = 5;
    played_deliver(&start);
    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_OPERATIONAL), NodeOperational);
    played_error_frame(CAN_ERR_BUSOFF, 0);
    expect_event(5, EV_CONTROLLER_BUS_OFF, 0);
    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_PRE_OPERATIONAL), NodePreOperational);
    ck_assert_uint_eq(sent_count(), 1);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    expect_event(5, EV_CONTROLLER_OK, 0);
    expect_sent(1, RECOVERED);
    expect_sent(2, NO_ERROR);
    ck_assert_uint_eq(EMCY_BUS_OFF_RECOVERED, 0x8140);
    ck_assert_uint_eq(EMCY_TEMPORARY_BUS_OFF, 4);
}
END_TEST

/* Over before anybody has looked. */
START_TEST(a_short_outage)
{
    network_hold(network());
    played_error_frame(CAN_ERR_BUSOFF, 0);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    network_release(network());
    expect_event(5, EV_CONTROLLER_BUS_OFF, 0);
    expect_event(5, EV_CONTROLLER_OK, 0);
    expect_sent(1, RECOVERED);
    expect_sent(2, NO_ERROR);
}
END_TEST

/* All nodes are told, also one that comes when it is so already. */
START_TEST(several_nodes)
{
    HNODE other;

    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    expect_event(5, EV_CONTROLLER_WARN, 0);
    other = make_node(6, 0, EV_CAN);
    expect_sent(2, "706#00");
    expect_sent(3, "086#2081110201000000");
    played_error_frame(CAN_ERR_BUSOFF, 0);
    expect_event(5, EV_CONTROLLER_BUS_OFF, 0);
    expect_event(6, EV_CONTROLLER_BUS_OFF, 0);
    remove_node(other);
}
END_TEST

START_TEST(frames_that_are_lost)
{
    struct delivery frame = played_frame(0x000, 0);

    frame.frame.len = 1;
    frame.drops = 3;
    played_deliver(&frame);
    expect_event(5, EV_FIFO_OVERRUN, 3);
    expect_sent(1, "085#1081110002000000");
    ck_assert_uint_eq(EMCY_CAN_OVERRUN, 0x8110);
}
END_TEST

/* The kernel sends SYNC, and none comes back. */
START_TEST(a_sync_that_does_not_come)
{
    HNODE producer = make_node(6, SYNC_GENERATION, EV_SYNC);
    char note[SCAN_NOTE_SIZE];

    snprintf(note, sizeof note, "event 0/6 SYNC %d 0", EV_TIMEOUT);
    scan_expect_note(note);
    network_hold(network());
    ck_assert(played_job_runs());
    network_release(network());
    remove_node(producer);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("bus");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, error_passive);
    tcase_add_test(tcase, bus_off);
    tcase_add_test(tcase, a_short_outage);
    tcase_add_test(tcase, several_nodes);
    tcase_add_test(tcase, frames_that_are_lost);
    tcase_add_test(tcase, a_sync_that_does_not_come);
    return suite_run("scan_bus", tcase);
}

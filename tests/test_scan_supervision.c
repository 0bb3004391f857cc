/*
 * Supervision at the API: heartbeats of others and life guarding, what the event handlers of both
 * forms are told, and what an error of communication does to the NMT state.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct scan_plant *plant;
static HNODE node;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static void expect_event(const char *kind, int arg1, int arg2)
{
    char note[SCAN_NOTE_SIZE];

    snprintf(note, sizeof note, "event 0/5 %s %d %d", kind, arg1, arg2);
    scan_expect_note(note);
}

/* --- heartbeats --- */

static void make_consumer(unsigned long mask)
{
    static const unsigned long list[] = { CHBT_ENTRY(7, 60), END_OF_CHBT_LIST };
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= CONSUMER_HEARTBEAT;
    info.ulEventMask = mask;
    info.pulListCHBT = list;
    info.ucMaxConsumerHB = 3;
    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
}

#define HEARTBEAT "CONSUMER_HEARTBEAT"

START_TEST(heartbeats_of_a_node)
{
    make_consumer(EV_CONSUMER_HEARTBEAT);
    scan_send(plant, "707#00");
    expect_event(HEARTBEAT, EV_BOOTUP, 7);
    scan_send(plant, "708#7F"); /* nobody watches it */
    scan_send(plant, "707#7F");
    expect_event(HEARTBEAT, EV_START, 7);
    expect_event(HEARTBEAT, EV_TIMEOUT, 7);
    scan_expect(plant, "085#3081110100000000");
    scan_send(plant, "707#05");
    expect_event(HEARTBEAT, EV_START, 7);
    scan_expect(plant, "085#0000000000000000");
    ck_assert_uint_eq(EMCY_ERROR_CONTROL, 0x8130);
    ck_assert_uint_eq(EMCY_TEMPORARY_ERROR_CONTROL, 1);
}
END_TEST

static void watch_9(void)
{
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 2, 4, CHBT_ENTRY(9, 30000)), 0);
    scan_send(plant, "709#05");
    expect_event(HEARTBEAT, EV_START, 9);
}

START_TEST(the_end_of_a_watch)
{
    make_consumer(EV_CONSUMER_HEARTBEAT);
    watch_9();
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 2, 4, 0), 0);
    expect_event(HEARTBEAT, EV_STOP, 9);
    watch_9();
    scan_send(plant, "000#8205");
    expect_event(HEARTBEAT, EV_STOP, 9);
    scan_await(plant, "705#00");
    scan_send(plant, "707#05");
    expect_event(HEARTBEAT, EV_START, 7);
}
END_TEST

/* A node twice is refused; another time for the same entry is not. */
START_TEST(a_node_is_watched_once)
{
    make_consumer(0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 2, 4, CHBT_ENTRY(7, 50)), 0x06040043);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 1, 4, CHBT_ENTRY(7, 50)), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 2, 4, CHBT_ENTRY(7, 0)), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1016, 2, 4, CHBT_ENTRY(8, 50)), 0);
    scan_send(plant, "708#05");
    scan_await(plant, "085#3081110100000000");
    scan_expect_no_note();
}
END_TEST

/* --- guarding --- */

static SLAVE_NODE_INFO guarded_info(unsigned long mask)
{
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= GUARDING | PRODUCER_HEARTBEAT;
    info.ulEventMask = mask;
    info.usGuardTime = 30;
    info.ucLifeTime = 2;
    return info;
}

START_TEST(life_guarding)
{
    const SLAVE_NODE_INFO info = guarded_info(EV_GUARDING);

    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    scan_send(plant, "705#R1");
    scan_expect(plant, "705#7F");
    expect_event("GUARDING", EV_START, 0);
    expect_event("GUARDING", EV_TIMEOUT, 0);
    scan_expect(plant, "085#3081110100000000");
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x100C, 0, 2, 30000), 0);
    scan_send(plant, "705#R1");
    scan_expect(plant, "705#FF");
    scan_expect(plant, "085#0000000000000000");
    expect_event("GUARDING", EV_START, 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1017, 0, 2, 30000), 0);
    expect_event("GUARDING", EV_STOP, 0);
    scan_await(plant, "705#7F"); /* the heartbeat takes its place */
    scan_send(plant, "705#R1");
    scan_expect_nothing_more(plant, node);
}
END_TEST

static int on_old_event(int net_and_node, int event, int arg1, int arg2)
{
    scan_note("old %d/%d %d %d %d", CANOPEN_NET(net_and_node), CANOPEN_NODE(net_and_node), event,
              arg1, arg2);
    return SCANOPEN_OK;
}

static void expect_old(unsigned long event, int arg1, int arg2)
{
    char note[SCAN_NOTE_SIZE];

    snprintf(note, sizeof note, "old 3/127 %lu %d %d", event, arg1, arg2);
    scan_expect_note(note);
}

/* The older handler: three kinds of events, and no others, whatever happens. */
START_TEST(events_of_the_older_form)
{
    struct scan_plant *other = scan_plant_new(3);

    ck_assert_int_eq(canOpenCreateNode(3, "old", 127, 0x191, GUARDING, 0, NULL, NULL, NULL, 30, 2,
                                       1, 0, on_old_event, &node),
                     SCANOPEN_OK);
    scan_plant_keep(other, node, 127);
    scan_activate(other, node);
    expect_old(EV_STATE_CHANGE, NodePreOperational, 0);
    ck_assert_uint_eq(scan_sdo_write(other, 127, 0x1015, 0, 2, 0), 0); /* EV_WRITE_DICTIONARY */
    scan_send(other, "77F#R1");
    expect_old(EV_GUARDING, EV_START, 0);
    expect_old(EV_GUARDING, EV_TIMEOUT, 0);
    ck_assert_uint_eq(scan_sdo_write(other, 127, 0x100C, 0, 2, 30000), 0);
    scan_send(other, "77F#R1");
    expect_old(EV_GUARDING, EV_START, 0);
    ck_assert_uint_eq(scan_sdo_write(other, 127, 0x100D, 0, 1, 0), 0);
    expect_old(EV_GUARDING, EV_STOP, 0);
    scan_send(other, "000#827F");
    expect_old(EV_RESET, EV_COMMUNICATION, EV_BEGIN);
    expect_old(EV_RESET, EV_COMMUNICATION, EV_END);
    expect_old(EV_STATE_CHANGE, NodePreOperational, 0);
    scan_plant_free(other);
}
END_TEST

/* Off the bus nobody watches. */
START_TEST(a_node_that_goes_offline)
{
    static const unsigned long list[] = { CHBT_ENTRY(9, 30000), END_OF_CHBT_LIST };
    SLAVE_NODE_INFO info = guarded_info(EV_GUARDING | EV_CONSUMER_HEARTBEAT);

    info.ulOptions |= CONSUMER_HEARTBEAT;
    info.usGuardTime = 30000;
    info.pulListCHBT = list;
    info.ucMaxConsumerHB = 2;
    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    scan_send(plant, "705#R1");
    expect_event("GUARDING", EV_START, 0);
    scan_send(plant, "709#05");
    expect_event(HEARTBEAT, EV_START, 9);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    expect_event(HEARTBEAT, EV_STOP, 9);
    expect_event("GUARDING", EV_STOP, 0);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    scan_expect_no_note();
}
END_TEST

/* --- what is asked for --- */

START_TEST(events_that_are_not_asked_for)
{
    SLAVE_NODE_INFO info = guarded_info(EV_ALL & ~(EV_GUARDING | EV_STATE_CHANGE));

    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    scan_send(plant, "705#R1");
    scan_await(plant, "085#3081110100000000");
    scan_send(plant, "000#8205");
    expect_event("RESET", EV_COMMUNICATION, EV_BEGIN);
    expect_event("RESET", EV_COMMUNICATION, EV_END);
    scan_await(plant, "705#00");
    scan_expect_nothing_more(plant, node);
    scan_expect_no_note();
}
END_TEST

/* --- 1029h --- */

static const struct behaviour {
    unsigned char behaviour;
    int before, after;
} behaviours[] = {
    { ERROR_BEHAVIOUR_DEFAULT, NodeOperational, NodePreOperational },
    { ERROR_BEHAVIOUR_NO_CHANGE, NodeOperational, NodeOperational },
    { ERROR_BEHAVIOUR_STOP, NodeOperational, NodeStopped },
    { ERROR_BEHAVIOUR_STOP, NodePreOperational, NodeStopped },
};

START_TEST(what_a_lost_master_does)
{
    const struct behaviour *row = &behaviours[_i];
    SLAVE_NODE_INFO info = guarded_info(EV_GUARDING);

    info.ulOptions |= ERROR_BEHAVIOUR_OBJECT;
    info.ucErrorBehaviour = row->behaviour;
    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    if (row->before == NodeOperational)
        scan_operational(plant, node);
    scan_send(plant, "705#R1");
    scan_await(plant, "085#3081110100000000");
    expect_event("GUARDING", EV_START, 0);
    expect_event("GUARDING", EV_TIMEOUT, 0);
    ck_assert_int_eq(scan_state(node), row->after);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("supervision");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, heartbeats_of_a_node);
    tcase_add_test(tcase, the_end_of_a_watch);
    tcase_add_test(tcase, a_node_is_watched_once);
    tcase_add_test(tcase, life_guarding);
    tcase_add_test(tcase, events_of_the_older_form);
    tcase_add_test(tcase, a_node_that_goes_offline);
    tcase_add_test(tcase, events_that_are_not_asked_for);
    tcase_add_loop_test(tcase, what_a_lost_master_does, 0, (int)COUNT(behaviours));
    return suite_run("scan_supervision", tcase);
}

/*
 * The life of a node: created, activated, led by a manager on the bus, reset, deleted; what it
 * tells its event handler about that.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdio.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static struct scan_plant *plant;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

/* --- states --- */

START_TEST(a_node_that_is_offline_is_not_on_the_bus)
{
    HNODE node = scan_node(plant, 5, NULL), other = scan_node(plant, 6, NULL);

    ck_assert_int_eq(scan_state(node), NodeOffline);
    ck_assert_int_eq(NodeOffline, NodeInit);
    scan_activate(plant, other);
    scan_send(plant, "605#4000100000000000");
    scan_send(plant, "000#0105");
    scan_expect_nothing_more(plant, other); /* it has been through */
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    scan_expect(plant, "705#00");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_state(node), NodePreOperational);
}
END_TEST

static const struct command {
    const char *frame;
    unsigned short mask;
    int state;
} commands[] = {
    { "000#0105", WFNS_OPERATIONAL, NodeOperational },
    { "000#0205", WFNS_STOPPED, NodeStopped },
    { "000#8005", WFNS_PRE_OPERATIONAL, NodePreOperational },
    { "000#0100", WFNS_OPERATIONAL, NodeOperational },
    { "000#8000", WFNS_PRE_OPERATIONAL, NodePreOperational },
    { "000#0200", WFNS_STOPPED, NodeStopped },
    { "000#0105", WFNS_OPERATIONAL, NodeOperational },
};

START_TEST(commands_of_the_manager)
{
    HNODE node = scan_node(plant, 5, NULL);
    int state = -1, error = -1;

    scan_activate(plant, node);
    for (unsigned i = 0; i < COUNT(commands); i++) {
        scan_send(plant, commands[i].frame);
        ck_assert_int_eq(canOpenWaitForNodeState(node, commands[i].mask), commands[i].state);
        ck_assert_int_eq(canOpenGetNodeInfo(node, &state, &error), SCANOPEN_OK);
        ck_assert_int_eq(state, commands[i].state);
        ck_assert_int_eq(error, 0);
    }
    scan_send(plant, "000#0206"); /* not for this one */
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_state(node), NodeOperational);
}
END_TEST

/* SDO in pre-operational and operational, nothing in stopped. */
START_TEST(services_of_the_states)
{
    HNODE node = scan_node(plant, 5, NULL);
    uint32_t type = 0;

    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1000, 0, &type), 0);
    scan_operational(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1000, 0, &type), 0);
    scan_stop(plant, node);
    scan_send(plant, "605#4000100000000000");
    scan_preoperational(plant, node);
    scan_expect_nothing_more(plant, node);
}
END_TEST

static const struct start_row {
    unsigned long options;
    int state;
} start_rows[] = {
    { 0, NodePreOperational },
    { AUTO_START, NodeOperational },
};

/* Also behind a reset by the manager. */
START_TEST(where_an_activated_node_goes)
{
    const struct start_row *row = &start_rows[_i];
    const unsigned short all = WFNS_STOPPED | WFNS_PRE_OPERATIONAL | WFNS_OPERATIONAL;
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;

    info.ulOptions |= row->options;
    node = scan_node(plant, 5, &info);
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    scan_expect(plant, "705#00");
    if (row->state == NodeOperational)
        ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_OPERATIONAL), NodeOperational);
    ck_assert_int_eq(canOpenWaitForNodeState(node, all), row->state);
    scan_send(plant, "000#8105");
    scan_expect(plant, "705#00");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(canOpenWaitForNodeState(node, all), row->state);
}
END_TEST

START_TEST(a_node_goes_offline_and_comes_back)
{
    HNODE node = scan_node(plant, 5, NULL), other = scan_node(plant, 6, NULL);

    scan_activate(plant, other);
    scan_number(node, 0x2000, TYP_UINT16, READ_ACCESS | WRITE_ACCESS, 0x1234, NULL);
    for (unsigned i = 0; i < 3; i++) {
        scan_activate(plant, node);
        scan_operational(plant, node);
        ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0x99), 0);
        ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x99);
        ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
        ck_assert_int_eq(scan_state(node), NodeOffline);
        ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x1234);
        ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK); /* as it is */
        scan_send(plant, "605#4000200000000000");
        scan_expect_nothing_more(plant, other);
    }
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS, 7, NULL); /* and it may be extended */
    scan_activate(plant, node);
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 7);
}
END_TEST

/* 1000h..1FFFh with "reset communication", all with "reset node". */
START_TEST(resets_by_the_manager)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;
    uint32_t value = 0;

    info.ulOptions |= PRODUCER_HEARTBEAT;
    info.usProducerHbTime = 50000;
    node = scan_node(plant, 5, &info);
    scan_number(node, 0x2000, TYP_UINT16, READ_ACCESS | WRITE_ACCESS, 0x1234, NULL);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0x99), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1017, 0, 2, 40000), 0);
    scan_send(plant, "000#8205");
    scan_await(plant, "705#00");
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1017, 0, &value), 0);
    ck_assert_uint_eq(value, 50000);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x99);
    scan_send(plant, "000#8105");
    scan_await(plant, "705#00");
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x2000, 0, &value), 0);
    ck_assert_uint_eq(value, 0x1234);
}
END_TEST

START_TEST(a_deleted_node_makes_room)
{
    HNODE node = scan_node(plant, 5, NULL), next;

    scan_activate(plant, node);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    next = scan_node(plant, 5, NULL);
    ck_assert_ptr_ne(next, node);
    scan_activate(plant, next);
    scan_expect_nothing_more(plant, next);
}
END_TEST

/* Node 127 hears what node 1 sends, both in this process. */
START_TEST(nodes_beside_each_other)
{
    HNODE first = scan_node(plant, 1, NULL), last = scan_node(plant, 127, NULL);

    scan_activate(plant, first);
    scan_activate(plant, last);
    scan_operational(plant, first);
    ck_assert_int_eq(scan_state(last), NodePreOperational);
    scan_expect_nothing_more(plant, first);
    scan_expect_nothing_more(plant, last);
}
END_TEST

/* --- events --- */

START_TEST(events_about_the_state)
{
    HNODE node = scan_node(plant, 5, NULL);

    ck_assert_int_eq(EV_STATE_CHANGE, 2);
    scan_activate(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    scan_operational(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 5 0");
    scan_stop(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 4 0");
    scan_send(plant, "000#0205"); /* no change */
    scan_preoperational(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 127 0");
}
END_TEST

/* The first two arguments: EV_COMMUNICATION or EV_APPLICATION, EV_BEGIN or EV_END. */
START_TEST(events_about_resets)
{
    HNODE node = scan_node(plant, 5, NULL);
    char note[SCAN_NOTE_SIZE];
    const int kinds[] = { EV_COMMUNICATION, EV_APPLICATION };
    const char *const frames[] = { "000#8205", "000#8105" };

    scan_activate(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_int_eq(EV_RESET, 4);
    scan_send(plant, frames[_i]);
    snprintf(note, sizeof note, "event 0/5 RESET %d %d", kinds[_i], EV_BEGIN);
    scan_await_note(note);
    snprintf(note, sizeof note, "event 0/5 RESET %d %d", kinds[_i], EV_END);
    scan_await_note(note);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    scan_await(plant, "705#00");
}
END_TEST

/* Written by an SDO client, not by the application. */
START_TEST(events_about_written_entries)
{
    HNODE node = scan_node(plant, 5, NULL);

    scan_number(node, 0x2000, TYP_UINT16, READ_ACCESS | WRITE_ACCESS, 0x1234, NULL);
    scan_activate(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_int_eq(EV_WRITE_DICTIONARY, 0x80);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 1), SCANOPEN_OK);
    ck_assert_uint_ne(scan_sdo_write(plant, 5, 0x2001, 0, 2, 2), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 3), 0);
    scan_expect_note("event 0/5 WRITE_DICTIONARY 8192 0");
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1006, 0, 4, 10000), 0);
    scan_expect_note("event 0/5 WRITE_DICTIONARY 4102 0");
}
END_TEST

START_TEST(only_the_events_that_are_wanted)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;

    info.ulEventMask = EV_WRITE_DICTIONARY;
    node = scan_node(plant, 5, &info);
    scan_number(node, 0x2000, TYP_UINT16, READ_ACCESS | WRITE_ACCESS, 0x1234, NULL);
    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 3), 0);
    scan_expect_note("event 0/5 WRITE_DICTIONARY 8192 0");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    scan_expect_no_note();
}
END_TEST

START_TEST(no_events_without_a_mask)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;

    info.ulEventMask = 0;
    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    scan_expect_no_note();
}
END_TEST

static int on_old_event(int net_and_node, int event, int arg1, int arg2)
{
    scan_note("old %d/%d %d %d %d", CANOPEN_NET(net_and_node), CANOPEN_NODE(net_and_node), event,
              arg1, arg2);
    return SCANOPEN_OK;
}

START_TEST(the_older_event_handler)
{
    struct scan_plant *far = scan_plant_new(255);
    HNODE node = NULL;

    ck_assert_int_eq(canOpenCreateNode(255, "old", 127, 0x191, 0, 0, NULL, NULL, NULL, 0, 0, 0, 0,
                                       on_old_event, &node),
                     SCANOPEN_OK);
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | WRITE_ACCESS, 1, NULL);
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    scan_await(far, "77F#00");
    scan_await_note("old 255/127 2 127 0");
    ck_assert_uint_eq(scan_sdo_write(far, 127, 0x2000, 0, 1, 2), 0); /* not told */
    scan_send(far, "000#017F");
    scan_expect_note("old 255/127 2 5 0");
    scan_send(far, "000#827F");
    scan_expect_note("old 255/127 4 5 7");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    scan_plant_free(far);
}
END_TEST

/* --- waiting --- */

struct waiter {
    HNODE node;
    unsigned short mask;
    int result;
    pthread_t thread;
};

static void *wait_for_state(void *context)
{
    struct waiter *self = context;

    self->result = canOpenWaitForNodeState(self->node, self->mask);
    return NULL;
}

START_TEST(many_wait_for_a_state)
{
    HNODE node = scan_node(plant, 5, NULL);
    struct waiter waiters[] = {
        { .node = node, .mask = WFNS_OPERATIONAL },
        { .node = node, .mask = WFNS_OPERATIONAL | WFNS_STOPPED },
        { .node = node, .mask = WFNS_STOPPED },
    };

    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_INIT | WFNS_STOPPED), NodeInit);
    for (unsigned i = 0; i < COUNT(waiters); i++)
        ck_assert_int_eq(pthread_create(&waiters[i].thread, NULL, wait_for_state, &waiters[i]), 0);
    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_int_eq(pthread_join(waiters[0].thread, NULL), 0);
    ck_assert_int_eq(pthread_join(waiters[1].thread, NULL), 0);
    ck_assert_int_eq(waiters[0].result, NodeOperational);
    ck_assert_int_eq(waiters[1].result, NodeOperational);
    scan_stop(plant, node);
    ck_assert_int_eq(pthread_join(waiters[2].thread, NULL), 0);
    ck_assert_int_eq(waiters[2].result, NodeStopped);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_test(tcase, a_node_that_is_offline_is_not_on_the_bus);
    tcase_add_test(tcase, commands_of_the_manager);
    tcase_add_test(tcase, services_of_the_states);
    tcase_add_loop_test(tcase, where_an_activated_node_goes, 0, COUNT(start_rows));
    tcase_add_test(tcase, a_node_goes_offline_and_comes_back);
    tcase_add_test(tcase, resets_by_the_manager);
    tcase_add_test(tcase, a_deleted_node_makes_room);
    tcase_add_test(tcase, nodes_beside_each_other);
    tcase_add_test(tcase, events_about_the_state);
    tcase_add_loop_test(tcase, events_about_resets, 0, 2);
    tcase_add_test(tcase, events_about_written_entries);
    tcase_add_test(tcase, only_the_events_that_are_wanted);
    tcase_add_test(tcase, no_events_without_a_mask);
    tcase_add_test(tcase, the_older_event_handler);
    tcase_add_test(tcase, many_wait_for_a_state);
}

int main(void)
{
    TCase *tcase = tcase_create("node");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_node", tcase);
}

/*
 * Nodes that fall silent, come back, restart or do not follow while the network is running.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>

#define HEARTBEAT "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define ACTION(a) "<NMT_Action_On_Error>" #a "</NMT_Action_On_Error>"

/* Nodes 5 and 6, with a heartbeat each 200 ms. */
static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 6; node++) {
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
        plant_configure(plant, node, 0x6200, 1, 1, 0x50u + node);
        plant_configure(plant, node, 0x1017, 0, 2, 200);
    }
    watch_start(plant);
    return plant;
}

static struct plant *run_plant(const char *xml)
{
    struct plant *plant = make_plant(xml);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "does not boot");
    plant->sim.trace_count = 0;
    return plant;
}

static void unplug(struct plant *plant, uint8_t node, bool unplugged)
{
    plant->devices[node]->sim->unplugged = unplugged;
}

/* --- RESET_SLAVE --- */

START_TEST(test_loss)
{
    static const char *const xml[] = {
        PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT),
        PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, HEARTBEAT),
        ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT MANDATORY),
        ACTION(RESET_ALL) PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT MANDATORY),
        PLANT_NODE(5, HEARTBEAT "<NMT_Reset_Node>TRUE</NMT_Reset_Node>") PLANT_NODE(6, HEARTBEAT),
    };
    struct plant *plant = run_plant(xml[_i]);
    co_us_t last = plant_node(plant, 5)->supervision.last_heartbeat;

    plant_power(plant, 5, false);
    sim_run(&plant->sim, last + CO_MS(500) - 1);
    ck_assert(!plant_said(plant, "heartbeat lost"));
    sim_run(&plant->sim, last + CO_MS(500));
    ck_assert(
        plant_said(plant, "error: node 5: heartbeat lost: silent for 500 ms, was operational"));
    plant_run_ms(plant, 10000);
    ck_assert_uint_eq(plant_said_times(plant, "heartbeat lost"), 1);
    ck_assert_uint_eq(plant_sent(plant, _i == 4 ? "000#8105" : "000#8205"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_INITIALISING);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "000#"), 2);
    plant_free(plant);
}
END_TEST

/* The cable: the node has heard no reset and comes back as it went, without a boot-up message. */
START_TEST(test_unplugged)
{
    struct plant *plant = run_plant(PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT));

    unplug(plant, 5, true);
    plant_run_ms(plant, 5000);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_RETRY);
    unplug(plant, 5, false);
    plant->sim.trace_count = 0;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1); /* the reset is repeated */
    ck_assert_uint_eq(plant_sent(plant, "705#00"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    plant_free(plant);
}
END_TEST

/* The reset itself and the boot-up message are lost, but the node answers. */
START_TEST(test_no_loss_without_heartbeat)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(6, HEARTBEAT));

    plant_power(plant, 5, false);
    plant_run_ms(plant, 10000);
    ck_assert(!plant_said(plant, "heartbeat lost"));
    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/* --- RESET_ALL, STOP_ALL --- */

START_TEST(test_reset_all)
{
    struct plant *plant = run_plant(ACTION(RESET_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY)
                                        PLANT_NODE(6, HEARTBEAT));

    plant_power(plant, 5, false);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "000#8100"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    ck_assert_int_eq(plant->manager->device.state, NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_PREOPERATIONAL);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_said_times(plant, "network is up"), 2);
    plant_free(plant);
}
END_TEST

START_TEST(test_stop_all)
{
    struct plant *plant = run_plant(ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY)
                                        PLANT_NODE(6, HEARTBEAT));

    unplug(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "000#0200"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    ck_assert_int_eq(plant->manager->device.state, NMT_STOPPED);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_STOPPED);
    unplug(plant, 5, false);
    plant_run_ms(plant, 3000);
    ck_assert(plant_said(plant, "node 5: heartbeat is back, operational"));
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    /* the application decides; what was lost is booted anew, whatever state it says it is in */
    ck_assert_int_eq(plant_command(plant, NMT_START, _i ? 0 : 127), CO_OK);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

START_TEST(test_stop_all_still_lost)
{
    struct plant *plant = run_plant(ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY)
                                        PLANT_NODE(6, HEARTBEAT));

    unplug(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert_int_eq(plant_command(plant, NMT_START, _i ? 0 : 127), CO_OK);
    plant_run_ms(plant, 3000);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 0);
    unplug(plant, 5, false);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/* It is in mid-boot when all are stopped: no SDO for it any more, but it goes on in the end. */
START_TEST(test_stop_all_in_mid_boot)
{
    struct plant *plant = make_plant(ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY)
                                         PLANT_NODE(6, ""));

    plant_lie(plant, "606#2B1710", "586#8017100022000008", 100);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant_node(plant, 6)->step, BOOT_RETRY);
    unplug(plant, 5, true);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    unplug(plant, 5, false);
    plant->lie_count = 0;
    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(plant_sent(plant, "000#0106"), 0);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    plant_run_ms(plant, 5000);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/*
 * A mandatory node has never come, another one that has booted is lost, and all are stopped: the
 * start that is ordered then waits for both of them.
 */
START_TEST(test_stop_all_before_all_have_booted)
{
    struct plant *plant = make_plant(ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY)
                                         PLANT_NODE(6, MANDATORY));

    plant_power_on(plant);
    plant_power(plant, 6, false);
    plant_run_ms(plant, 2000);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    ck_assert_int_eq(plant_command(plant, NMT_START, _i ? 0 : 127), CO_OK);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_int_ne(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up in the end");
    plant_free(plant);
}
END_TEST

/* The answer to its first read is on its way when it is stopped: it proves nothing. */
static enum sim_fate answer_late(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x606 && frame->data[0] == 0x40 && plant->sim.now > CO_MS(2500))
        plant->devices[6]->sim->hold_until = plant->sim.now + CO_MS(150);
    return SIM_DELIVER;
}

START_TEST(test_stopped_with_an_answer_on_its_way)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, "") PLANT_NODE(6, "<Vendor_Identification>0x29A</Vendor_Identification>"));

    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    plant->fault = answer_late;
    plant_power(plant, 6, false);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 50);
    ck_assert_int_eq(plant_node(plant, 6)->step, BOOT_DEVICE_TYPE);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 0), CO_OK);
    plant_run_ms(plant, 5000);
    ck_assert(plant_node(plant, 6)->booted);
    ck_assert_int_eq(plant_command(plant, NMT_START, 0), CO_OK);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is left stopped");
    plant_free(plant);
}
END_TEST

/* --- nodes that the application boots --- */

START_TEST(test_told_only)
{
    struct plant *plant = make_plant(PLANT_NODE(5, "") PLANT_NODE(
        6, HEARTBEAT MANDATORY "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"));

    plant_power_on(plant);
    plant_run_ms(plant, 600); /* its heartbeat is off: no luck so far */
    sim_say(&plant->sim, "606#2B171000C8000000");
    plant_run_ms(plant, 1000);
    ck_assert_msg(plant_node(plant, 6)->booted, "%s", plant->events);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_START, 6), CO_OK);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant_node(plant, 6)->nmt_state, NMT_OPERATIONAL);
    unplug(plant, 6, true);
    plant_run_ms(plant, 2000);
    ck_assert(plant_said(plant, "error: node 6: heartbeat lost"));
    ck_assert_int_eq(plant_node(plant, 6)->nmt_state, NMT_INITIALISING);
    unplug(plant, 6, false);
    plant_run_ms(plant, 2000);
    ck_assert(plant_said(plant, "node 6: heartbeat is back, operational"));
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    ck_assert_uint_eq(plant_sent(plant, "606#"), 0);
    plant_free(plant);
}
END_TEST

/* --- heartbeats that come late, or tell of a node that does not follow --- */

/* K, but then it comes after all: the boot begins anew. */
START_TEST(test_heartbeat_after_all)
{
    struct plant *plant = make_plant(PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, HEARTBEAT));

    plant_power_on(plant);
    while (plant_node(plant, 5)->step != BOOT_ERROR_CONTROL)
        sim_run(&plant->sim, plant->sim.now + 10);
    unplug(plant, 5, true);
    plant_run_ms(plant, 2000);
    ck_assert(plant_said(plant, "node 5: boot error K"));
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    unplug(plant, 5, false);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

static enum sim_fate lose_start(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    unsigned *left = plant->fault_context;

    (void)sender;
    if (frame->id != 0 || frame->data[0] != NMT_START || *left == 0)
        return SIM_DELIVER;
    --*left;
    return SIM_UNHEARD;
}

/* The start command is not heard: the heartbeats tell, it is repeated. */
START_TEST(test_start_not_followed)
{
    struct plant *plant = make_plant(
        _i ? "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT)
           : PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT));
    unsigned left = 2;

    plant->fault = lose_start;
    plant->fault_context = &left;
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(left, 0);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_le(plant_sent(plant, "000#01"), 6);
    plant_free(plant);
}
END_TEST

/* It never follows: a few times are enough, then it is told. The application may try again. */
START_TEST(test_never_follows)
{
    struct plant *plant = make_plant(PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, HEARTBEAT));
    unsigned left = 1000;

    plant->fault = lose_start;
    plant->fault_context = &left;
    plant_power_on(plant);
    plant_run_ms(plant, 10000);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 3);
    ck_assert_uint_eq(plant_said_times(plant, "error: node 5: has been started 3 times and is "
                                              "pre-operational still"),
                      1);
    ck_assert(!plant_said(plant, "network is up"));
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    plant_run_ms(plant, 10000);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 6);
    ck_assert_uint_eq(plant_said_times(plant, "node 5: has been started 3 times"), 2);
    left = 0;
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    ck_assert_int_eq(plant_command(plant, NMT_START, 6), CO_OK);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* But a node that has followed, and then leaves by itself, has its reasons: that is only told. */
START_TEST(test_leaves_by_itself)
{
    struct plant *plant = run_plant(PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT));

    slave_command(&plant->devices[5]->slave, NMT_ENTER_PREOPERATIONAL, plant->sim.now,
                  &plant->devices[5]->sim->box);
    plant->devices[5]->nmt_state = NMT_PREOPERATIONAL; /* to the watch */
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_uint_eq(plant_said_times(plant, "info: node 5: is pre-operational"), 1);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node restarts just as it is to be started: the start overtakes the news. */
static enum sim_fate restart_before_start(struct plant *plant, const struct co_frame *frame,
                                          uint8_t sender)
{
    unsigned *left = plant->fault_context;

    (void)sender;
    if (frame->id != 0x586 || frame->data[0] != 0x60 || frame->data[1] != 0x17 || *left == 0)
        return SIM_DELIVER;
    --*left;
    slave_command(&plant->devices[5]->slave, NMT_RESET_NODE, plant->sim.now,
                  &plant->devices[5]->sim->box);
    sim_touch(&plant->sim, plant->devices[5]->sim);
    return SIM_DELIVER;
}

START_TEST(test_start_overtakes)
{
    struct plant *plant = make_plant(PLANT_NODE(5, "") PLANT_NODE(6, MANDATORY));
    unsigned left = 1;

    plant->fault = restart_before_start;
    plant->fault_context = &left;
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(left, 0);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* A node that has failed sends its heartbeat all the same: that does not make it right. */
START_TEST(test_heartbeat_of_a_failed_node)
{
    struct plant *plant = make_plant(PLANT_NODE(5, HEARTBEAT "<Serial_Number>77</Serial_Number>")
                                         PLANT_NODE(6, HEARTBEAT));

    plant_power_on(plant);
    for (unsigned i = 0; i < 20; i++) {
        sim_say(&plant->sim, "705#7F");
        plant_run_ms(plant, 200);
    }
    ck_assert(plant_said(plant, "node 5: boot error O"));
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert(!plant_said(plant, "node 5: booted"));
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 0);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("error_control");

    tcase_add_loop_test(tcase, test_loss, 0, 5);
    tcase_add_test(tcase, test_unplugged);
    tcase_add_test(tcase, test_no_loss_without_heartbeat);
    tcase_add_test(tcase, test_reset_all);
    tcase_add_loop_test(tcase, test_stop_all, 0, 2);
    tcase_add_loop_test(tcase, test_stop_all_still_lost, 0, 2);
    tcase_add_test(tcase, test_stop_all_in_mid_boot);
    tcase_add_loop_test(tcase, test_stop_all_before_all_have_booted, 0, 2);
    tcase_add_test(tcase, test_stopped_with_an_answer_on_its_way);
    tcase_add_test(tcase, test_told_only);
    tcase_add_test(tcase, test_heartbeat_after_all);
    tcase_add_loop_test(tcase, test_start_not_followed, 0, 2);
    tcase_add_test(tcase, test_never_follows);
    tcase_add_test(tcase, test_leaves_by_itself);
    tcase_add_test(tcase, test_start_overtakes);
    tcase_add_test(tcase, test_heartbeat_of_a_failed_node);
    return suite_run("error_control", tcase);
}

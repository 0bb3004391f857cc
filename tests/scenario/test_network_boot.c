/*
 * What the nodes have in common: who is reset, booted and started when, and when it is halted.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define MANDATORY     "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define NO_AUTO_START "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
#define NO_SLAVE      "<NMT_Slave>FALSE</NMT_Slave>"

/* Nodes 5 and 6 are there, with an entry to configure each; other nodes of the XML are absent. */
static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 6; node++) {
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
        plant_configure(plant, node, 0x6200, 1, 1, 0x50u + node);
    }
    watch_start(plant);
    return plant;
}

static struct plant *run_plant(const char *xml, unsigned ms)
{
    struct plant *plant = make_plant(xml);

    plant_power_on(plant);
    plant_run_ms(plant, ms);
    return plant;
}

/* Time of the n-th frame that begins like this, in ms since power on; 0: there is none. */
static unsigned time_of(const struct plant *plant, const char *beginning, unsigned n)
{
    for (size_t i = 0; i < plant->sim.trace_count; i++) {
        char text[CO_FRAME_TEXT_SIZE];

        co_frame_format(&plant->sim.trace[i].frame, text, sizeof text);
        if (strncmp(text, beginning, strlen(beginning)) == 0 && n-- == 0)
            return (unsigned)(plant->sim.trace[i].time / 1000u - 1000u);
    }
    return 0;
}

static int state_of(const struct plant *plant, uint8_t node)
{
    return plant->devices[node]->slave.state;
}

/* --- who is started, and how --- */

static const struct start {
    const char *name, *xml;
    uint8_t network;      /* enum boot_network_state */
    uint8_t self, n5, n6; /* NMT states */
    unsigned all, each;   /* start commands */
} starts[] = {
    { "defaults", PLANT_NODE(5, "") PLANT_NODE(6, ""), NETWORK_OPERATIONAL, 5, 5, 5, 0, 2 },
    { "all", "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "") PLANT_NODE(6, ""),
      NETWORK_OPERATIONAL, 5, 5, 5, 1, 0 },
    { "all, one is the application's",
      "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "") PLANT_NODE(6, NO_AUTO_START),
      NETWORK_OPERATIONAL, 5, 5, 127, 0, 1 },
    { "all, one is no slave of ours",
      "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "") PLANT_NODE(6, NO_SLAVE),
      NETWORK_OPERATIONAL, 5, 5, 127, 0, 1 },
    { "all, one is absent",
      "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "") PLANT_NODE(6, "") PLANT_NODE(7, ""),
      NETWORK_OPERATIONAL, 5, 5, 5, 0, 2 },
    { "all, a mandatory one is absent",
      "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "") PLANT_NODE(6, "")
          PLANT_NODE(7, MANDATORY),
      NETWORK_BOOTING, 127, 127, 127, 0, 0 },
    { "no automatic start",
      "<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(5, "") PLANT_NODE(6, ""),
      NETWORK_OPERATIONAL, 5, 127, 127, 0, 0 },
    { "no automatic start, even of all",
      "<NMT_Auto_Start>FALSE</NMT_Auto_Start><NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "")
          PLANT_NODE(6, ""),
      NETWORK_OPERATIONAL, 5, 127, 127, 0, 0 },
    { "not operational by itself",
      "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>" PLANT_NODE(5, "") PLANT_NODE(6, ""),
      NETWORK_WAITING, 127, 127, 127, 0, 0 },
    { "nobody is ours", PLANT_NODE(5, NO_SLAVE) PLANT_NODE(6, NO_SLAVE), NETWORK_OPERATIONAL, 5,
      127, 127, 0, 0 },
};

START_TEST(test_start)
{
    const struct start *start = &starts[_i];
    struct plant *plant = run_plant(start->xml, 1000);

    ck_assert_msg(plant->manager->state == start->network, "%s: %u", start->name,
                  plant->manager->state);
    ck_assert_int_eq(plant->manager->device.state, start->self);
    ck_assert_int_eq(state_of(plant, 5), start->n5);
    ck_assert_int_eq(state_of(plant, 6), start->n6);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), start->all);
    ck_assert_msg(plant_sent(plant, "000#01") == start->all + start->each, "%s", start->name);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1 + start->all + start->each);
    plant_free(plant);
}
END_TEST

/* A node that is not the master's gets no frame; one that the application boots is watched only. */
START_TEST(test_left_alone)
{
    struct plant *plant = run_plant(PLANT_NODE(5, NO_SLAVE) PLANT_NODE(6, NO_AUTO_START MANDATORY),
                                    3000);

    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "606#"), 0);
    ck_assert(plant_node(plant, 6)->booted);
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_power(plant, 6, false);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "606#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "node 5: boot-up message"), 2);
    ck_assert_int_eq(plant_node(plant, 6)->nmt_state, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_foreign_node)
{
    struct plant *plant = run_plant(PLANT_NODE(5, ""), 1000);

    ck_assert_uint_eq(plant_sent(plant, "606#"), 0);
    ck_assert(plant_said(plant, "node 6: boot-up message of a node that is not configured"));
    plant_free(plant);
}
END_TEST

/* --- resets and delays --- */

START_TEST(test_reset)
{
    struct plant *plant = run_plant(PLANT_NODE(5, ""), 500);

    ck_assert_uint_eq(plant_sent(plant, "000#8200"), 1);
    ck_assert_uint_eq(time_of(plant, "605#", 0), 200);
    plant_free(plant);
    plant = run_plant("<NMT_Reset_All>TRUE</NMT_Reset_All><Boot_Delay>700</Boot_Delay>" PLANT_NODE(
                          5, "<Boot_Delay>900</Boot_Delay>"),
                      2000);
    ck_assert_uint_eq(plant_sent(plant, "000#8100"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#82"), 0);
    ck_assert_uint_eq(time_of(plant, "605#", 0), 700);
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_RESET_COMMUNICATION, 5), CO_OK);
    plant_run_ms(plant, 2000);
    ck_assert_uint_eq(time_of(plant, "605#", 0) - time_of(plant, "000#8205", 0), 900);
    ck_assert_uint_eq(plant_sent(plant, "605#4000"), 1);
    watch_expect_up(plant, "reset by the application");
    plant_free(plant);
}
END_TEST

/* --- absent and late nodes --- */

START_TEST(test_endless_retry)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(7, ""), 17000);

    ck_assert_uint_eq(plant_sent(plant, "607#40"), 3 * 11);
    ck_assert_uint_eq((time_of(plant, "607#40", 3) - time_of(plant, "607#40", 2)) / 10, 120);
    ck_assert_uint_eq(plant_said_times(plant, "node 7: boot error"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "node 7: boot begins"), 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Node 6 is switched on later; with its boot-up message seen or (even i) not. */
static enum sim_fate lose_boot_up(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)plant;
    (void)sender;
    return frame->id == 0x706 && frame->data[0] == 0 ? SIM_UNHEARD : SIM_DELIVER;
}

START_TEST(test_late_node)
{
    const char *mandatory = _i < 2 ? "" : MANDATORY;
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml,
             PLANT_NODE(5, "") "<Node_Instance><Node_Id>6</Node_Id>%s</Node_Instance>", mandatory);
    plant = make_plant(xml);
    plant_power_on(plant);
    plant_power(plant, 6, false);
    plant_run_ms(plant, 5300);
    ck_assert_int_eq(state_of(plant, 5), _i < 2 ? NMT_OPERATIONAL : NMT_PREOPERATIONAL);
    if (_i % 2 == 0)
        plant->fault = lose_boot_up;
    plant_power(plant, 6, true);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "the late node is not up");
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 2);
    plant_free(plant);
}
END_TEST

/* --- Boot_Time --- */

START_TEST(test_boot_time)
{
    struct plant *plant = run_plant(
        "<Boot_Time>3000</Boot_Time>" PLANT_NODE(5, "") PLANT_NODE(7, MANDATORY), 3199);

    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    plant_run_ms(plant, 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    plant_run_ms(plant, 1);
    ck_assert(plant_said(plant, "network not started: mandatory node 7 is missing after 3000 ms"));
    plant_run_ms(plant, 20000);
    ck_assert_uint_eq(plant_said_times(plant, "network not started"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    plant_free(plant);
}
END_TEST

/* No limit: it goes on trying. */
START_TEST(test_no_boot_time)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(7, MANDATORY), 60000);

    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    plant_free(plant);
}
END_TEST

/* The time is over while only optional nodes are missing: nothing to halt for, nor to spin. */
START_TEST(test_boot_time_of_optional)
{
    struct plant *plant = run_plant(
        "<Boot_Time>300</Boot_Time>" PLANT_NODE(5, MANDATORY) PLANT_NODE(7, ""), 700);

    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    ck_assert_uint_gt(manager_deadline(plant->manager), plant->sim.now);
    plant_run_ms(plant, 500);
    watch_expect_up(plant, "is not up");
    ck_assert(!plant_said(plant, "network not started"));
    plant_free(plant);
}
END_TEST

/* A network without nodes, and one whose nodes are all absent. */
START_TEST(test_nobody)
{
    struct plant *plant = run_plant("", 1000);

    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert(plant_said(plant, "network is up: 0 of 0 nodes booted"));
    plant_free(plant);
    plant = run_plant(PLANT_NODE(7, "") PLANT_NODE(8, ""), 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert(plant_said(plant, "network is up: 0 of 2 nodes booted"));
    ck_assert(manager_is_up(plant->manager, false));
    ck_assert(!manager_is_up(plant->manager, true));
    plant_free(plant);
}
END_TEST

/* --- not a master --- */

START_TEST(test_no_master)
{
    struct plant *plant = run_plant("<NMT_Master>FALSE</NMT_Master>" PLANT_NODE(5, ""), 2000);

    ck_assert_uint_eq(plant->sim.trace_count, 1); /* its boot-up */
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert(manager_is_up(plant->manager, true));
    for (unsigned i = 0; i < 2; i++) { /* no node, nor all */
        ck_assert_int_eq(plant_command(plant, NMT_START, i ? 5 : 0), CO_ERR_STATE);
        ck_assert_int_eq(plant_command(plant, NMT_STOP, i ? 5 : 0), CO_ERR_STATE);
        ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, i ? 5 : 0), CO_ERR_STATE);
    }
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    sim_say(&plant->sim, "000#0200");
    plant_run_ms(plant, 10);
    ck_assert_int_eq(plant->manager->device.state, NMT_STOPPED);
    sim_say(&plant->sim, "000#817F");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), 2);
    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 127), CO_OK);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), 3);
    ck_assert_uint_eq(plant_sent(plant, "000#82"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#8100"), 0);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    plant_free(plant);
}
END_TEST

/* SYNC from the manager's boot-up on, in each of its states but STOPPED. */
START_TEST(test_sync)
{
    struct plant *plant = run_plant("<Sync_Interval>20000</Sync_Interval>"
                                    "<Sync_Cob_Id>0x90</Sync_Cob_Id>" PLANT_NODE(5, ""),
                                    99);

    ck_assert_uint_eq(plant_sent(plant, "090#"), 4);
    ck_assert_uint_eq(time_of(plant, "090#", 0), 20);
    ck_assert_uint_eq(time_of(plant, "090#", 3), 80);
    plant_run_ms(plant, 911);
    ck_assert_uint_eq(plant_sent(plant, "090#"), 50);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 127), CO_OK);
    plant_run_ms(plant, 200);
    ck_assert_uint_eq(plant_sent(plant, "090#"), 50);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    plant_run_ms(plant, 100);
    ck_assert_uint_ge(plant_sent(plant, "090#"), 54);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_sync)
{
    struct plant *plant = run_plant("<Sync_Interval>0</Sync_Interval>" PLANT_NODE(5, ""), 1000);

    ck_assert_uint_eq(plant_sent(plant, "080#"), 0);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_master_not_operational)
{
    struct plant *plant = run_plant("<NMT_Master>FALSE</NMT_Master>"
                                    "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>",
                                    1000);

    ck_assert_int_eq(plant->manager->device.state, NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("network_boot");

    tcase_add_loop_test(tcase, test_start, 0, sizeof starts / sizeof starts[0]);
    tcase_add_test(tcase, test_left_alone);
    tcase_add_test(tcase, test_foreign_node);
    tcase_add_test(tcase, test_reset);
    tcase_add_test(tcase, test_endless_retry);
    tcase_add_loop_test(tcase, test_late_node, 0, 4);
    tcase_add_test(tcase, test_boot_time);
    tcase_add_test(tcase, test_no_boot_time);
    tcase_add_test(tcase, test_boot_time_of_optional);
    tcase_add_test(tcase, test_nobody);
    tcase_add_test(tcase, test_sync);
    tcase_add_test(tcase, test_no_sync);
    tcase_add_test(tcase, test_no_master);
    tcase_add_test(tcase, test_no_master_not_operational);
    return suite_run("network_boot", tcase);
}

/*
 * The manager loses its own connection to the bus, and gets it back.
 */
#include "od/od_store.h"
#include "support/suite.h"
#include "support/watch.h"

#include <stdlib.h>

#define HEARTBEAT "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define ACTION(a) "<NMT_Action_On_Error>" #a "</NMT_Action_On_Error>"
#define LENGTH(a) ((int)(sizeof(a) / sizeof((a)[0])))

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

static void connect(struct plant *plant, bool up)
{
    struct co_outbox *box = sim_box(&plant->sim, plant->manager_device);

    plant->manager_device->unplugged = !up;
    manager_on_bus(plant->manager, up, plant->sim.now, box);
}

static void submit(struct plant *plant, struct sdo_request *request)
{
    static uint8_t buffer[4];
    struct co_outbox *box = sim_box(&plant->sim, plant->manager_device);

    request->transfer = (struct sdo_transfer){
        .index = 0x6200, .sub = 1, .buffer = buffer, .size = 4, .timeout = CO_MS(1000)
    };
    manager_submit(plant->manager, 5, request, plant->sim.now, box);
}

static const char *const networks[] = {
    PLANT_NODE(5, HEARTBEAT) PLANT_NODE(6, HEARTBEAT),
    ACTION(RESET_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, HEARTBEAT MANDATORY),
    ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, HEARTBEAT),
    "<Boot_Time>2000</Boot_Time>" PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, MANDATORY),
};

/* Nobody is missed meanwhile, and all are booted anew, with one reset for all. */
START_TEST(test_outage)
{
    struct plant *plant = run_plant(networks[_i]);

    connect(plant, false);
    plant_run_ms(plant, 10000);
    ck_assert_msg(!plant_said(plant, "lost") && !plant_said(plant, "error"), "%s", plant->events);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_INITIALISING);
    ck_assert(!manager_is_up(plant->manager, false));
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_ERR_STATE);
    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 0), CO_ERR_STATE);
    connect(plant, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "000#8200") + plant_sent(plant, "000#8100"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "network is up"), 2);
    plant_free(plant);
}
END_TEST

/* Each step of the boot, in fine steps and far beyond its end. */
START_TEST(test_outage_in_mid_boot)
{
    struct plant *plant = make_plant(networks[1]);

    plant_power_on(plant);
    sim_run(&plant->sim, plant->sim.now + CO_MS(1) / 2 * (co_us_t)_i);
    connect(plant, false);
    plant_run_ms(plant, _i % 2 ? 10 : 3000);
    connect(plant, true);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    ck_assert_msg(!plant_said(plant, "boot error"), "%s", plant->events);
    plant_free(plant);
}
END_TEST

/* Behind the same switch: a node is back a moment later and has heard no reset. */
START_TEST(test_a_node_is_back_later)
{
    struct plant *plant = run_plant(networks[_i]);

    connect(plant, false);
    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 2000);
    connect(plant, true);
    plant_run_ms(plant, 100);
    plant->devices[5]->sim->unplugged = false;
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "705#00"), 1);
    ck_assert_uint_eq(plant_sent(plant, "706#00"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_free(plant);
}
END_TEST

START_TEST(test_requests_end)
{
    struct plant *plant = run_plant(networks[0]);
    struct sdo_request requests[3] = { { .next = NULL } };

    submit(plant, &requests[0]);
    submit(plant, &requests[1]);
    ck_assert_int_eq(requests[0].state, REQUEST_RUNNING);
    ck_assert_int_eq(requests[1].state, REQUEST_QUEUED);
    connect(plant, false);
    submit(plant, &requests[2]);
    for (unsigned i = 0; i < 3; i++) {
        ck_assert_int_eq(requests[i].state, REQUEST_DONE);
        ck_assert_uint_eq(requests[i].result.detail, SDO_OUTCOME_NOT_SENT);
        ck_assert_uint_eq(requests[i].result.index, 0x6200);
    }
    plant_run_ms(plant, 5000);
    connect(plant, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    submit(plant, &requests[0]);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(requests[0].state, REQUEST_DONE);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_OK);
    plant_free(plant);
}
END_TEST

/* What STOP_ALL has stopped is started by the application only. */
START_TEST(test_stopped_stays_stopped)
{
    struct plant *plant = run_plant(networks[2]);

    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    plant->devices[5]->sim->unplugged = false;
    connect(plant, false);
    plant_power(plant, 6, false); /* restarts meanwhile */
    plant_power(plant, 6, true);
    plant_run_ms(plant, 2000);
    connect(plant, true);
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_STOPPED);
    ck_assert_uint_eq(plant_sent(plant, "000#0200"), 2);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 2);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/* Where another master commands there is nothing to boot. */
START_TEST(test_not_the_master)
{
    struct plant *plant = make_plant("<NMT_Master>FALSE</NMT_Master>" PLANT_NODE(5, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 100);
    connect(plant, false);
    plant_run_ms(plant, 100);
    connect(plant, true);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), 1);
    plant_free(plant);
}
END_TEST

/* Told twice, or "back" without having been away: nothing happens. */
START_TEST(test_told_twice)
{
    struct plant *plant = run_plant(networks[0]);

    connect(plant, true);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    connect(plant, false);
    connect(plant, false);
    connect(plant, true);
    connect(plant, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "000#8200"), 1);
    plant_free(plant);
}
END_TEST

/* A node that is only watched is watched again, though the network stays stopped. */
START_TEST(test_watched_again)
{
    struct plant *plant = make_plant(ACTION(STOP_ALL) PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(
        6, HEARTBEAT "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>")
                                         PLANT_NODE(7, "<NMT_Slave>FALSE</NMT_Slave>"));

    od_set_number(&plant->devices[6]->od, 0x1017, 0, 200);
    ck_assert_int_eq(od_store(&plant->devices[6]->od, 0x1017, 0x1017), CO_OK);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    connect(plant, false);
    plant_run_ms(plant, 1000);
    connect(plant, true);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    ck_assert(!plant_said(plant, "node 6: heartbeat lost"));
    plant_power(plant, 6, false);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_said_times(plant, "node 6: heartbeat lost"), 1);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("the bus is lost and comes back");

    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, test_outage, 0, LENGTH(networks));
    tcase_add_loop_test(tests, test_outage_in_mid_boot, 0, 24);
    tcase_add_loop_test(tests, test_a_node_is_back_later, 0, LENGTH(networks));
    tcase_add_test(tests, test_requests_end);
    tcase_add_test(tests, test_stopped_stays_stopped);
    tcase_add_test(tests, test_not_the_master);
    tcase_add_test(tests, test_told_twice);
    tcase_add_test(tests, test_watched_again);
    return suite_run("bus_outage", tests);
}

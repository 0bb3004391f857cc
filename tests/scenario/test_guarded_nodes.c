/*
 * Node guarding, and nodes that are to be kept alive (NMT_Check_Nodestate).
 */
#include "od/od_store.h"
#include "support/suite.h"
#include "support/watch.h"

#define GUARDED    "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"
#define KEPT_ALIVE "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
#define HEARTBEAT  "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"

/* Node 5, with a configuration; 'running' goes operational by itself and sends a heartbeat. */
static struct plant *make_plant(const char *xml, bool running, unsigned heartbeat)
{
    struct plant *plant = plant_new(xml, 1000000);
    struct plant_device *device = plant_add_device(plant, 5);

    plant_add_object(device, 0x6200, 1, 1, 0);
    if (running)
        plant_add_object(device, 0x1F80, 0, 4, 0);
    od_set_number(&device->od, 0x1017, 0, heartbeat);
    ck_assert_int_eq(od_store(&device->od, 0x1017, 0x1017), CO_OK);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    return plant;
}

/* --- guarding --- */

START_TEST(test_guarding)
{
    struct plant *plant = make_plant(PLANT_NODE(5, GUARDED), false, 0);

    watch_start(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "does not boot");
    ck_assert_uint_ge(plant_sent(plant, "705#R"), 7);
    ck_assert_uint_eq(plant_sent(plant, "705#7F"), 1);
    ck_assert_uint_ge(plant_sent(plant, "705#85"), 3);
    ck_assert_uint_ge(plant_sent(plant, "705#05"), 2);
    ck_assert(!plant_said(plant, "toggle"));
    plant_free(plant);
}
END_TEST

START_TEST(test_guarded_node_is_lost)
{
    struct plant *plant = make_plant(PLANT_NODE(5, GUARDED), false, 0);

    watch_start(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 400);
    ck_assert(
        plant_said(plant, "error: node 5: no answer to guarding for 300 ms, was operational"));
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "does not come back");
    ck_assert_uint_eq(plant_said_times(plant, "no answer to guarding"), 1);
    plant_free(plant);
}
END_TEST

/* A node that answers each request with toggle bit 0. */
static enum sim_fate answer_without_toggle(struct plant *plant, const struct co_frame *frame,
                                           uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x705 && (frame->flags & CO_FRAME_RTR))
        sim_say(&plant->sim, "705#05");
    return frame->id == 0x705 && frame->dlc == 1 && (frame->data[0] & 0x80u) ? SIM_LOSE
                                                                             : SIM_DELIVER;
}

START_TEST(test_toggle_error)
{
    struct plant *plant = make_plant(PLANT_NODE(5, GUARDED), false, 0);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->fault = answer_without_toggle;
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "warning: node 5: guarding toggle error no 1"));
    ck_assert(!plant_said(plant, "no answer to guarding"));
    plant_free(plant);
}
END_TEST

START_TEST(test_heartbeat_goes_before_guarding)
{
    struct plant *plant = make_plant(PLANT_NODE(5, GUARDED HEARTBEAT), false, 200);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "does not boot");
    ck_assert_uint_eq(plant_sent(plant, "705#R"), 0);
    plant_free(plant);
}
END_TEST

/* --- keep alive --- */

static const struct {
    const char *xml;
    unsigned heartbeat;
} kept_alive[] = {
    { PLANT_NODE(5, KEPT_ALIVE HEARTBEAT), 200 },
    { PLANT_NODE(5, KEPT_ALIVE GUARDED), 0 },
    { PLANT_NODE(5, KEPT_ALIVE), 0 },
};

START_TEST(test_running_node_is_left_alone)
{
    struct plant *plant = make_plant(kept_alive[_i].xml, true, kept_alive[_i].heartbeat);

    plant_power_on(plant);
    plant_run_ms(plant, 1500);
    ck_assert(plant_said(plant, "node 5: is running already: kept alive (L)"));
    ck_assert(plant_said(plant, "network is up: 1 of 1 nodes booted"));
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 0);
    ck_assert_int_eq(plant_node(plant, 5)->nmt_state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_STARTED);
    plant_free(plant);
}
END_TEST

START_TEST(test_node_that_does_not_run_is_booted)
{
    struct plant *plant = make_plant(kept_alive[_i].xml, false, kept_alive[_i].heartbeat);

    watch_start(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "does not boot");
    ck_assert_uint_eq(plant_sent(plant, "000#8200"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    plant_free(plant);
}
END_TEST

START_TEST(test_others_are_reset_one_by_one)
{
    struct plant *plant = make_plant(PLANT_NODE(5, KEPT_ALIVE HEARTBEAT) PLANT_NODE(6, "")
                                         PLANT_NODE(7, "<NMT_Reset_Node>TRUE</NMT_Reset_Node>"),
                                     true, 200);

    plant_add_device(plant, 6);
    plant_add_device(plant, 7);
    plant_power_on(plant);
    plant_run_ms(plant, 1500);
    ck_assert(plant_said(plant, "network is up: 3 of 3 nodes booted"));
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8107"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8"), 2);
    plant_free(plant);
}
END_TEST

static enum sim_fate lose_life_signs(struct plant *plant, const struct co_frame *frame,
                                     uint8_t sender)
{
    (void)plant;
    (void)sender;
    return frame->id == 0x705 && !(frame->flags & CO_FRAME_RTR) ? SIM_UNHEARD : SIM_DELIVER;
}

START_TEST(test_state_that_nobody_tells)
{
    static const struct {
        const char *xml, *text;
    } rows[] = {
        { PLANT_NODE(5, KEPT_ALIVE HEARTBEAT), "boot error E: no heartbeat within 500 ms" },
        { PLANT_NODE(5, KEPT_ALIVE), "boot error F: no answer to guarding within 100 ms" },
    };
    struct plant *plant = make_plant(rows[_i].xml, true, _i == 0 ? 200 : 0);

    plant_power_on(plant);
    plant->fault = lose_life_signs;
    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(plant_said_times(plant, rows[_i].text), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant->fault = NULL; /* only a full bus, perhaps */
    plant_run_ms(plant, 2000);
    ck_assert_uint_eq(plant_said_times(plant, "kept alive (L)"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant_free(plant);
}
END_TEST

/* It falls silent and comes back as it was: nobody resets it. */
START_TEST(test_kept_alive_after_loss)
{
    struct plant *plant = make_plant(kept_alive[0].xml, true, 200);

    plant_power_on(plant);
    plant_run_ms(plant, 1500);
    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 3000);
    ck_assert(plant_said(plant, "error: node 5: heartbeat lost"));
    plant->devices[5]->sim->unplugged = false;
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_said_times(plant, "kept alive (L)"), 2);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant_free(plant);
}
END_TEST

/* Its power fails: it comes back with nothing configured. */
START_TEST(test_restarted_node_is_configured)
{
    struct plant *plant = make_plant(kept_alive[0].xml, false, 200);

    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "does not boot");
    plant_power(plant, 5, false);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "does not come back");
    plant_free(plant);
}
END_TEST

/* It restarts twice, the second time unheard by anybody, and runs: that is asked, not assumed. */
START_TEST(test_restart_that_nobody_hears)
{
    struct plant *plant = make_plant(kept_alive[0].xml, true, 200);

    plant_power_on(plant);
    plant_run_ms(plant, 1500);
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 0);
    sim_run(&plant->sim, plant->sim.now + 150); /* the boot-up message is heard, no more */
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_DEVICE_TYPE);
    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "boot error B"));
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    plant->devices[5]->sim->unplugged = false;
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_said_times(plant, "kept alive (L)"), 2);
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant_free(plant);
}
END_TEST

/* Its last heartbeat says that it runs; it has been asked in vain since, and that is no matter. */
START_TEST(test_heartbeat_of_before)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, KEPT_ALIVE "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>"), true,
        60000);

    plant_lie(plant, "605#40001000", NULL, 3);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    sim_say(&plant->sim, "705#05");
    plant_run_ms(plant, 2000);
    ck_assert(plant_said(plant, "boot error B"));
    ck_assert(plant_said(plant, "node 5: is running already: kept alive (L)"));
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant_free(plant);
}
END_TEST

/* A node that is only guarded restarts: its toggle bit begins anew, and that is no error. */
START_TEST(test_guarded_only_node_restarts)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, GUARDED "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"), false, 0);

    plant_power_on(plant);
    for (unsigned i = 0; i < 4; i++) { /* after an even and after an odd number of answers */
        plant_run_ms(plant, 1000 + i % 2 * 100);
        plant_power(plant, 5, false);
        plant_power(plant, 5, true);
    }
    plant_run_ms(plant, 1000);
    ck_assert(!plant_said(plant, "toggle error"));
    ck_assert(!plant_said(plant, "no answer to guarding"));
    plant_free(plant);
}
END_TEST

/*
 * All were stopped, and the manager has restarted since: a stopped node does not answer SDO, and
 * nobody but the manager brings it out of that.
 */
START_TEST(test_found_stopped)
{
    struct plant *plant = make_plant(kept_alive[_i].xml, false, kept_alive[_i].heartbeat);

    watch_start(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 0), CO_OK);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_STOPPED);
    plant_power_manager(plant, false);
    plant_power_manager(plant, true);
    plant->sim.trace_count = 0;
    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    watch_expect_up(plant, "is left stopped");
    plant_free(plant);
}
END_TEST

/* An absent one is asked for its state as well, and told as before, once. */
START_TEST(test_kept_alive_is_absent)
{
    struct plant *plant = make_plant(PLANT_NODE(5, KEPT_ALIVE GUARDED), false, 0);

    plant_power_on(plant);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 5000);
    ck_assert_int_eq(plant_node(plant, 5)->failure.letter, 'B');
    ck_assert_int_eq(plant_node(plant, 5)->failure.step, BOOT_DEVICE_TYPE);
    ck_assert_uint_eq(plant_said_times(plant, "boot error B"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "asks for its state"), 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1500);
    watch_expect_up(plant, "does not boot");
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("guarded_nodes");

    tcase_add_test(tcase, test_guarding);
    tcase_add_test(tcase, test_guarded_node_is_lost);
    tcase_add_test(tcase, test_toggle_error);
    tcase_add_test(tcase, test_heartbeat_goes_before_guarding);
    tcase_add_loop_test(tcase, test_running_node_is_left_alone, 0, 3);
    tcase_add_loop_test(tcase, test_node_that_does_not_run_is_booted, 0, 3);
    tcase_add_test(tcase, test_others_are_reset_one_by_one);
    tcase_add_loop_test(tcase, test_state_that_nobody_tells, 0, 2);
    tcase_add_test(tcase, test_kept_alive_after_loss);
    tcase_add_test(tcase, test_restarted_node_is_configured);
    tcase_add_test(tcase, test_restart_that_nobody_hears);
    tcase_add_test(tcase, test_heartbeat_of_before);
    tcase_add_test(tcase, test_guarded_only_node_restarts);
    tcase_add_loop_test(tcase, test_found_stopped, 0, sizeof kept_alive / sizeof kept_alive[0]);
    tcase_add_test(tcase, test_kept_alive_is_absent);
    return suite_run("guarded_nodes", tcase);
}

/*
 * The configuration changes while something is under way that the old one has begun: a boot, a
 * restoring of default values, the reset of the network.
 */
#include "od/od_store.h"
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#include <stdio.h>

#define LISTED   0x01u /* bits of 1F81h */
#define BOOTED   0x05u
#define RESTORED 0x80u

#define CONF 0x666E6F63u

/* Node 5 has an output to be configured, and default values. */
static struct plant *make_plant(const char *node)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, PLANT_NODE(5, "%s"), node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_add_object(plant->devices[5], 0x1011, 1, 4, 1);
    plant_add_object(plant_add_device(plant, 6), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    watch_start(plant);
    tool_attach(plant);
    return plant;
}

static void put(struct plant *plant, uint16_t index, uint8_t sub, uint8_t size, uint32_t value)
{
    ck_assert_uint_eq(tool_put(plant, index, sub, size, value), 0);
    plant_run_ms(plant, 2); /* what follows from it is behind the answer */
}

static int state_of(const struct plant *plant, uint8_t node)
{
    return plant->devices[node]->slave.state;
}

/* A node that is no longer booted by the manager is asked nothing more, but gets all or nothing. */
START_TEST(test_left_to_the_application)
{
    static const struct {
        const char *request; /* is not answered: the boot stands still there */
        int step;
        const char *talk;
    } rows[] = { { "605#40181001", BOOT_IDENTITY, " r1018:1" },
                 { "605#2F006201", BOOT_CONFIGURE, " r1018:1 w6200:1=55 w6200:1=55" } };
    struct plant *plant = make_plant("<Vendor_Identification>666</Vendor_Identification>"
                                     "<SDO_Timeout>2000</SDO_Timeout>");

    plant_lie(plant, rows[_i].request, NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, rows[_i].step);
    put(plant, 0x1F81, 5, 4, LISTED);
    plant_run_ms(plant, 5000);
    ck_assert_str_eq(plant_talk(plant, 5), rows[_i].talk);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    ck_assert_int_eq(state_of(plant, 5), NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_READY);
    plant_free(plant);
}
END_TEST

/* The same for one that ran: it runs again behind the configuration that was begun anew. */
START_TEST(test_runs_again)
{
    struct plant *plant = make_plant("<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<SDO_Timeout>2000</SDO_Timeout>");

    plant_lie(plant, "605#2F006201", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    plant_run_ms(plant, 10);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    put(plant, 0x1F85, 5, 4, 0x29A);
    plant_run_ms(plant, 100);
    ck_assert_str_eq(plant_talk(plant, 5), " w6200:1=55 w6200:1=55");
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* The error control of one that is watched only begins anew, with the new time. */
START_TEST(test_watched_otherwise)
{
    struct plant *plant = make_plant("<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<Consumer_Heartbeat_Time>30000</Consumer_Heartbeat_Time>");

    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_ERROR_CONTROL);
    put(plant, 0x1016, 5, 4, 0x000501F4);
    plant_run_ms(plant, 600);
    ck_assert(plant_said(plant, "boot error K: no heartbeat within 500 ms"));
    plant_free(plant);
}
END_TEST

/* What was written of a configuration that is no more is to be restored as well. */
START_TEST(test_restored_again)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>"
                                     "<SDO_Timeout>2000</SDO_Timeout>");

    plant_lie(plant, "605#2F006201", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 700);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    put(plant, 0x1F85, 5, 4, 0x29A);
    plant_run_ms(plant, 1500);
    ck_assert_str_eq(plant_talk(plant, 5), " w1011:1=6F6C w6200:1=55"
                                           " r1018:1 w1011:1=6F6C r1018:1 w6200:1=55");
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* 1F25h of a node that has failed behind its restoring: it is restored, and booted behind that. */
START_TEST(test_conf_restores_again)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "605#2F006201", "585#8000620130000906", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 2);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Where each node was reset by itself, one that joins behind that was not. */
START_TEST(test_joins_behind_resets)
{
    struct plant *plant = make_plant("<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>");

    plant_power_on(plant);
    od_set_number(&plant->devices[6]->od, 0x6200, 1, 0x77);
    sim_say(&plant->sim, "000#0106");
    plant_run_ms(plant, 50);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    put(plant, 0x1F81, 6, 4, BOOTED);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node is removed while its owner takes no news; then it is missed. That means nothing more. */
START_TEST(test_removed_before_lost)
{
    struct plant *plant = make_plant("<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
                                     "<Guard_Time>50</Guard_Time>"
                                     "<Life_Time_Factor>3</Life_Time_Factor>");
    const struct co_event event = { .type = MANAGER_NODE_STEP };
    struct co_frame frames[4], request;
    struct co_event events[1];
    struct co_outbox full;

    plant->config->action_on_error = ACTION_STOP_ALL;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 100);
    co_outbox_init(&full, frames, 4, events, 1);
    co_outbox_put_event(&full, &event);
    ck_assert(co_frame_parse("67F#23811F0508000000", &request));
    manager_on_frame(plant->manager, &request, plant->sim.now, &full);
    manager_on_time(plant->manager, plant->sim.now + CO_MS(200), &full);
    manager_on_time(plant->manager, plant->sim.now + CO_MS(400), &full);
    plant_run_ms(plant, 500);
    ck_assert(!plant_node(plant, 5)->config->nmt_slave);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert(!plant_said(plant, "no answer to guarding"));
    plant_free(plant);
}
END_TEST

/* One that is watched only is never reset: what has failed is told, and may be asked for again. */
START_TEST(test_watched_fails)
{
    static const char *const lies[] = { NULL, "585#8000620130000906" };
    struct plant *plant = make_plant("<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>");

    plant_lie(plant, "605#2F006201", lies[_i], 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 3000);
    ck_assert(plant_said(plant, "boot error J"));
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 500);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6200, 1, 0), 0x55);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_READY);
    ck_assert_uint_eq(plant_sent(plant, "000#8205") + plant_sent(plant, "000#8105"), 0);
    plant_free(plant);
}
END_TEST

/* What was refused does not end its supervision, whose end is told and not more than that. */
START_TEST(test_watched_on_failed)
{
    static const struct {
        const char *node, *lie, *lost;
    } rows[] = {
        { "<Guard_Time>50</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>",
          "585#8000620130000906", "node 5: no answer to guarding" },
        { "<Consumer_Heartbeat_Time>300</Consumer_Heartbeat_Time>", "585#8000620130000906",
          "node 5: heartbeat lost" },
        { "<Guard_Time>50</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>", NULL,
          "node 5: no answer to guarding" },
    };
    char node[256];
    struct plant *plant;

    snprintf(node, sizeof node, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>%s",
             rows[_i].node);
    plant = make_plant(node);
    od_set_number(&plant->devices[5]->od, 0x1017, 0, _i == 1 ? 100 : 0);
    ck_assert_int_eq(od_store(&plant->devices[5]->od, 0x1017, 0x1017), CO_OK);
    plant_lie(plant, "605#2F006201", rows[_i].lie, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert(!plant_said(plant, rows[_i].lost));
    plant_power(plant, 5, false);
    plant_run_ms(plant, 1000);
    ck_assert_msg(plant_said_times(plant, rows[_i].lost) == 1, "%s", plant->events);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    ck_assert_msg(!plant_node(plant, 5)->lost, "%s", plant->events);
    ck_assert_uint_eq(plant_said_times(plant, "boot error"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8205") + plant_sent(plant, "000#8105"), 0);
    plant_free(plant);
}
END_TEST

/* It starts anew in the middle of that: what it had been given is lost, and is given again. */
START_TEST(test_watched_restarts)
{
    struct plant *plant = make_plant("<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<SDO_Timeout>2000</SDO_Timeout>");

    plant_lie(plant, "605#2F016201", NULL, 1);
    plant_add_object(plant->devices[5], 0x6201, 1, 1, 0);
    plant_configure(plant, 5, 0x6201, 1, 1, 0x66);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    put(plant, 0x1F25, 5, 4, CONF);
    plant_run_ms(plant, 100);
    ck_assert_str_eq(plant_talk(plant, 5), " w6200:1=55 w6201:1=66");
    plant_power(plant, 5, false);
    plant_run_ms(plant, 10);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6200, 1, 0), 0x55);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6201, 1, 0), 0x66);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_READY);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_midway");

    tcase_add_loop_test(tcase, test_left_to_the_application, 0, 2);
    tcase_add_test(tcase, test_runs_again);
    tcase_add_test(tcase, test_watched_otherwise);
    tcase_add_loop_test(tcase, test_watched_fails, 0, 2);
    tcase_add_loop_test(tcase, test_watched_on_failed, 0, 3);
    tcase_add_test(tcase, test_watched_restarts);
    tcase_add_test(tcase, test_restored_again);
    tcase_add_test(tcase, test_conf_restores_again);
    tcase_add_test(tcase, test_joins_behind_resets);
    tcase_add_test(tcase, test_removed_before_lost);
    return suite_run("config_midway", tcase);
}

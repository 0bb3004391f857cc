/* 1F25h: other tools ask for a node's configuration to be written to it, as it is now. */
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#define CONF 0x666E6F63u

#define NO_DATA 0x08000024u
#define NO_TIME 0x08000022u /* not in this state */
#define REFUSED 0x06090030u

#define NODES PLANT_NODE(5, "") PLANT_NODE(6, "")

/* A node that runs is configured anew, and runs again; the other one is not touched. */
START_TEST(test_conf)
{
    struct plant *plant = tool_plant_run(_i == 0 ? NODES
                                                 : "<NMT_Auto_Start>FALSE</NMT_Auto_Start>" NODES);

    if (_i == 1)
        ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put_concise(plant, 6, tool_concise_more, sizeof tool_concise_more), 0);
    plant_run_ms(plant, 100);
    tool_expect_value(plant, 5, 0x6200, 0);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 100);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 5), " w6200:1=55");
    ck_assert_uint_eq(plant_sent(plant, "000#8005"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 2);
    ck_assert_uint_eq(plant_sent(plant, "000#8006"), 0);
    tool_expect_value(plant, 6, 0x6200, 0);
    ck_assert_uint_eq(plant_said_times(plant, "node 5: booted"), 2);
    plant_free(plant);
}
END_TEST

/* One that is held where it is stays there, started by nobody. */
START_TEST(test_conf_held)
{
    struct plant *plant = tool_plant_run(NODES);

    ck_assert_int_eq(plant_command(plant, NMT_ENTER_PREOPERATIONAL, 5), CO_OK);
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 500);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    plant_free(plant);
}
END_TEST

/* While it is configured another master stops it: it is not started again. */
START_TEST(test_conf_stopped)
{
    struct plant *plant = tool_plant_run(
        "<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(5, "<SDO_Timeout>1000</SDO_Timeout>"));

    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(50);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    sim_say(&plant->sim, _i == 0 ? "000#8005" : "000#0105");
    plant_run_ms(plant, 500);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), _i == 0 ? 1 : 3);
    plant_free(plant);
}
END_TEST

/* One that was found running and left so is configured now, and started behind that. */
START_TEST(test_conf_kept_alive)
{
    struct plant *plant = tool_plant(
        PLANT_NODE(5, "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                      "<Guard_Time>50</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"));

    sim_say(&plant->sim, "000#0105");
    plant_run_ms(plant, 1000);
    ck_assert(plant_node(plant, 5)->kept_alive);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 500);
    ck_assert(!plant_node(plant, 5)->kept_alive);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* What it has to write takes it longer than it may be silent: it is not watched meanwhile. */
START_TEST(test_conf_slow)
{
    struct plant *plant = tool_plant_run(
        PLANT_NODE(5, "<SDO_Timeout>2000</SDO_Timeout>"
                      "<Guard_Time>50</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"));

    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(400);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 300);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    ck_assert(!plant_node(plant, 5)->booted);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert(!plant_said(plant, "no answer to guarding"));
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    plant_free(plant);
}
END_TEST

/* It refuses: it is not started with half of it, and when it is mended the request boots it. */
START_TEST(test_conf_fails)
{
    static const uint8_t refused[] = { 2, 0,    0, 0,    0x00, 0x62, 1, 1, 0, 0,
                                       0, 0x44, 0, 0x62, 9,    1,    0, 0, 0, 0x77 };
    struct plant *plant = tool_plant_run(_i == 0 ? PLANT_NODE(5, "<DCF_File>five.dcf</DCF_File>")
                                                 : PLANT_NODE(5, "<CCF_File>five.ccf</CCF_File>"));

    ck_assert_uint_eq(tool_put_concise(plant, 5, refused, sizeof refused), 0);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 500);
    ck_assert(plant_said(plant, "node 5: boot error J: write 6200h:09 = 77h (entry 2 of 2 of the "
                                "configuration): the node answers abort 06090011h"));
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    tool_expect_value(plant, 5, 0x6200, 0x44);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    tool_set(plant, 0x1F25, 5, CONF);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    plant_free(plant);
}
END_TEST

/* A node that is not booted, only watched: it is configured, and runs again if it ran. */
START_TEST(test_conf_watched_only)
{
    struct plant *plant = tool_plant_run(
        PLANT_NODE(5, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                      "<Guard_Time>50</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"));
    struct plant_device *device = plant->devices[5];

    if (_i == 1) /* by itself */
        slave_command(&device->slave, NMT_START, plant->sim.now, sim_box(&plant->sim, device->sim));
    plant_run_ms(plant, 200);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 100);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    tool_expect_state(plant, 5, _i == 0 ? NMT_PREOPERATIONAL : NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#8005"), _i == 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), _i == 1);
    plant_free(plant);
}
END_TEST

/* Another configuration comes while it is configured: it gets that one, and runs again. */
START_TEST(test_conf_changed)
{
    struct plant *plant = tool_plant_run(
        PLANT_NODE(5, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                      "<SDO_Timeout>2000</SDO_Timeout>"));

    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    plant_lie(plant, "605#2F006201", NULL, 1);
    tool_set(plant, 0x1F25, 5, CONF);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise_more, sizeof tool_concise_more), 0);
    plant_run_ms(plant, 100);
    tool_expect_value(plant, 5, 0x6200, 0x66);
    tool_expect_value(plant, 5, 0x6201, 0x77);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#8005"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    plant_free(plant);
}
END_TEST

static const struct conf {
    uint8_t sub;
    uint32_t value, code;
} confs[] = {
    { 5, 0x666E6F64, 0x08000021 },  { 6, CONF, NO_DATA },    { 7, CONF, REFUSED },
    { 77, CONF, REFUSED },          { 0, CONF, 0x06010002 }, { 0x81, CONF, 0x06090011 },
    { 0x80, CONF + 1, 0x08000021 },
};

START_TEST(test_conf_refused)
{
    struct plant *plant = tool_plant_run(NODES PLANT_NODE(7, "<NMT_Slave>FALSE</NMT_Slave>"));
    uint8_t read[4];
    uint32_t size = sizeof read;

    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put_concise(plant, 7, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, confs[_i].sub, 4, confs[_i].value), confs[_i].code);
    plant_run_ms(plant, 100);
    ck_assert_uint_eq(plant_sent(plant, "605#2F"), 0);
    ck_assert_uint_eq(tool_read(plant, 0x1F25, 5, read, &size), 0x06010001);
    plant_free(plant);
}
END_TEST

/* Not now: it is booted, it is stopped, the network has its boot delay. */
START_TEST(test_conf_not_now)
{
    struct plant *plant = tool_plant(NODES);

    plant_run_ms(plant, 50);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 5, 4, CONF), NO_TIME);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 0x80, 4, CONF), NO_TIME);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 5), CO_OK);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 5, 4, CONF), NO_TIME);
    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 5), CO_OK);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 5, 4, CONF), NO_TIME);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* One that is absent is tried again at once. */
START_TEST(test_conf_absent)
{
    struct plant *plant = tool_plant_run(PLANT_NODE(5, "") PLANT_NODE(9, ""));

    ck_assert_uint_eq(tool_put_concise(plant, 9, tool_concise, sizeof tool_concise), 0);
    while (plant_node(plant, 9)->step != BOOT_RETRY)
        plant_run_ms(plant, 10);
    tool_set(plant, 0x1F25, 9, CONF);
    ck_assert_uint_eq(plant_sent(plant, "000#8209"), 1);
    plant_free(plant);
}
END_TEST

/* All that have a configuration, and are there. */
START_TEST(test_conf_all)
{
    struct plant *plant = tool_plant_run(NODES PLANT_NODE(7, ""));

    ck_assert_uint_eq(tool_put(plant, 0x1F25, 0x80, 4, CONF), NO_DATA);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put_concise(plant, 6, tool_concise_more, sizeof tool_concise_more), 0);
    tool_set(plant, 0x1F25, 0x80, CONF);
    plant_run_ms(plant, 100);
    ck_assert_str_eq(plant_talk(plant, 5), " w6200:1=55");
    ck_assert_str_eq(plant_talk(plant, 6), " w6200:1=66 w6201:1=77");
    ck_assert_str_eq(plant_talk(plant, 7), "");
    for (uint8_t node = 5; node <= 7; node++)
        tool_expect_state(plant, node, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_request");

    tcase_add_loop_test(tcase, test_conf, 0, 2);
    tcase_add_test(tcase, test_conf_held);
    tcase_add_loop_test(tcase, test_conf_stopped, 0, 2);
    tcase_add_test(tcase, test_conf_kept_alive);
    tcase_add_test(tcase, test_conf_slow);
    tcase_add_loop_test(tcase, test_conf_fails, 0, 2);
    tcase_add_loop_test(tcase, test_conf_watched_only, 0, 2);
    tcase_add_test(tcase, test_conf_changed);
    tcase_add_loop_test(tcase, test_conf_refused, 0, (int)(sizeof confs / sizeof confs[0]));
    tcase_add_test(tcase, test_conf_not_now);
    tcase_add_test(tcase, test_conf_absent);
    tcase_add_test(tcase, test_conf_all);
    return suite_run("config_request", tcase);
}

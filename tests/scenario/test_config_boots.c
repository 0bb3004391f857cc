/*
 * Configuration over the network while it boots and runs: when what was written counts.
 */
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#include <stdio.h>

#define BOOTED    0x05u
#define MANDATORY 0x08u

#define RESET_COMM 0x07 /* of 1F82h */

static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 7; node++)
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
    watch_start(plant);
    tool_attach(plant);
    plant_power_on(plant);
    return plant;
}

static struct plant *run_plant(const char *xml)
{
    struct plant *plant = make_plant(xml);

    plant_run_ms(plant, 1000);
    return plant;
}

/* --- in the middle of a boot --- */

/* Its first write is not answered: the boot stands still there for a while. */
static struct plant *stuck_plant(const char *node)
{
    char xml[512];
    struct plant *plant;

    snprintf(xml, sizeof xml, PLANT_NODE(5, "%s<SDO_Timeout>2000</SDO_Timeout>"), node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    watch_start(plant);
    tool_attach(plant);
    return plant;
}

/* A boot that has begun to configure begins with a reset: nothing of it may be left. */
START_TEST(test_changed_while_configured)
{
    struct plant *plant = stuck_plant("");

    plant_lie(plant, "605#2F006201", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    tool_set(plant, 0x1F88, 5, _i == 0 ? 5 : 99);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_run_ms(plant, 1000);
    if (_i == 0)
        tool_expect_state(plant, 5, NMT_OPERATIONAL);
    else
        ck_assert(plant_said(plant, "boot error O: 1018h:04 serial number is 00000005h"));
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_free(plant);
}
END_TEST

/* The same while it saves; but not of a node that the change is not about. */
START_TEST(test_changed_while_saving)
{
    struct plant *plant = stuck_plant("<Save_Configuration>TRUE</Save_Configuration>");

    plant_add_object(plant->devices[5], 0x1010, 1, 4, 1);
    plant_lie(plant, "605#23101001", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_SAVE);
    tool_set(plant, 0x1F88, 6, 6);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    tool_set(plant, 0x1F88, 5, 5);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_run_ms(plant, 1000);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* One that only reads reads again. */
START_TEST(test_changed_while_compared)
{
    struct plant *plant = stuck_plant("<Product_Code>1</Product_Code>");

    plant_lie(plant, "605#40181002", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_IDENTITY);
    tool_set(plant, 0x1F85, 5, 0x29A);
    plant_run_ms(plant, 1000);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 5), " r1018:2 r1018:1 r1018:2 w6200:1=55");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    plant_free(plant);
}
END_TEST

/* Asked for its state, it is to be asked no more. */
START_TEST(test_changed_while_asked)
{
    struct plant *plant = stuck_plant("<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                                      "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>");

    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CHECK_STATE);
    tool_set(plant, 0x1016, 5, 0);
    tool_set(plant, 0x1F81, 5, BOOTED);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node that has failed waits for an order, and then boots with what is right now. */
START_TEST(test_corrected)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "<Serial_Number>99</Serial_Number>"));

    ck_assert(plant_said(plant, "boot error O"));
    tool_set(plant, 0x1F88, 5, 5);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert_uint_eq(tool_put(plant, 0x1F82, 5, 1, RESET_COMM), 0);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node that runs goes on as it is until its next boot. */
START_TEST(test_next_boot)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "<Guard_Time>100</Guard_Time>"
                                                  "<Life_Time_Factor>3</Life_Time_Factor>"));

    tool_set(plant, 0x1016, 5, 0x000501F4);
    tool_set(plant, 0x1F81, 5, BOOTED | 0x00320200);
    plant_run_ms(plant, 1000);
    ck_assert_uint_ge(plant_sent(plant, "705#R"), 15);
    ck_assert_uint_eq(tool_get(plant, 0x1F83, 5), 1);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 500);
    ck_assert(plant_said(plant, "node 5: no answer to guarding for 300 ms, was operational"));
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1500);
    ck_assert(plant_said(plant, "no heartbeat within 500 ms"));
    plant_free(plant);
}
END_TEST

/* --- the network --- */

/* 1F80h starts nobody, and stops nobody, before the network boots the next time. */
START_TEST(test_startup)
{
    struct plant *plant = run_plant("<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(5, "")
                                        PLANT_NODE(6, ""));

    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    tool_set(plant, 0x1F80, 0, 0x03);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    tool_boot_all(plant);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 1);
    tool_set(plant, 0x1F80, 0, 0x05);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_boot_all(plant);
    ck_assert_int_eq(plant->manager->state, NETWORK_WAITING);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_boot_time)
{
    struct plant *plant = run_plant("");

    tool_set(plant, 0x1F81, 9, BOOTED | MANDATORY);
    tool_set(plant, 0x1F89, 0, 700);
    tool_set(plant, 0x1F80, 0, 0x41);
    tool_boot_all(plant);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    ck_assert(plant_said(plant, "mandatory node 9 is missing after 700 ms (Boot_Time)"));
    plant_free(plant);
}
END_TEST

/* The heartbeat of the manager: at once, and resets keep it. */
START_TEST(test_own_heartbeat)
{
    struct plant *plant = run_plant("");

    ck_assert_uint_eq(tool_put(plant, 0x1017, 0, 2, 100), 0);
    plant_run_ms(plant, 1000);
    ck_assert_uint_ge(plant_sent(plant, "77F#05"), 9);
    tool_boot_all(plant);
    ck_assert_uint_eq(tool_get(plant, 0x1017, 0), 100);
    ck_assert_uint_ge(plant_sent(plant, "77F#"), 18);
    plant_free(plant);
}
END_TEST

START_TEST(test_own_sync)
{
    struct plant *plant = run_plant("<Sync_Interval>0</Sync_Interval>");

    tool_set(plant, 0x1006, 0, 10000);
    tool_set(plant, 0x1005, 0, 0x40000080);
    plant_run_ms(plant, 100);
    ck_assert_uint_ge(plant_sent(plant, "080#"), 9);
    tool_boot_all(plant);
    ck_assert_uint_eq(tool_get(plant, 0x1006, 0), 10000);
    ck_assert_uint_ge(plant_sent(plant, "080#"), 90);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_boots");

    tcase_add_loop_test(tcase, test_changed_while_configured, 0, 2);
    tcase_add_test(tcase, test_changed_while_saving);
    tcase_add_test(tcase, test_changed_while_compared);
    tcase_add_test(tcase, test_changed_while_asked);
    tcase_add_test(tcase, test_corrected);
    tcase_add_test(tcase, test_next_boot);
    tcase_add_test(tcase, test_startup);
    tcase_add_test(tcase, test_boot_time);
    tcase_add_test(tcase, test_own_heartbeat);
    tcase_add_test(tcase, test_own_sync);
    return suite_run("config_boots", tcase);
}

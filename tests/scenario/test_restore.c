/*
 * 1F81h bit 7 and 1F8Ah, element Restore_Configuration: a device gets its default values back
 * before it is configured.
 */
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#include <stdio.h>

#define BOOTED   0x05u /* of 1F81h */
#define RESTORED 0x80u

#define LOAD "=6F6C" /* as plant_talk() shows it */

/* Node 5 has saved 6200h:01 = 9, which is 0 by default; its configuration is 6201h:01 = 55h. */
static struct plant *make_plant(const char *node)
{
    char xml[1024];
    struct plant *plant;
    struct plant_device *device;

    snprintf(xml, sizeof xml, PLANT_NODE(5, "%s"), node);
    plant = plant_new(xml, 1000000);
    device = plant_add_device(plant, 5);
    plant_add_object(device, 0x1010, 1, 4, 1);
    plant_add_object(device, 0x1011, 1, 4, 1);
    plant_add_object(device, 0x1011, 2, 4, 1);
    plant_add_object(device, 0x6200, 1, 1, 0);
    plant_add_object(device, 0x6201, 1, 1, 0);
    plant_configure(plant, 5, 0x6201, 1, 1, 0x55);
    watch_start(plant);
    return plant;
}

/* It has used these values for a while when the manager comes. */
static void power_on(struct plant *plant)
{
    sim_power(&plant->sim, plant->devices[5]->sim, true);
    plant_run_ms(plant, 10);
    sim_say(&plant->sim, "605#2F00620109000000");
    plant_run_ms(plant, 10);
    sim_say(&plant->sim, "605#2310100173617665");
    plant_run_ms(plant, 10);
    tool_attach(plant);
    plant_power_on(plant);
}

static struct plant *run_plant(const char *node)
{
    struct plant *plant = make_plant(node);

    power_on(plant);
    plant_run_ms(plant, 1500);
    return plant;
}

static void expect_up(const struct plant *plant, uint64_t saved)
{
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6200, 1, 0xDEAD), saved);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6201, 1, 0xDEAD), 0x55);
}

static const struct row {
    const char *node;
    const char *talk, *reset;
    uint64_t saved;
} rows[] = {
    { "", " w6201:1=55", "000#8205", 9 },
    { "<Restore_Configuration>0</Restore_Configuration>", " w6201:1=55", "000#8205", 9 },
    { "<Restore_Configuration>1</Restore_Configuration>", " w1011:1" LOAD " w6201:1=55", "000#8105",
      0 },
    { "<Restore_Configuration>2</Restore_Configuration>", " w1011:2" LOAD " w6201:1=55", "000#8205",
      9 },
    { "<Restore_Configuration>1</Restore_Configuration><Boot_Delay>0</Boot_Delay>",
      " w1011:1" LOAD " w6201:1=55", "000#8105", 0 },
};

START_TEST(test_element)
{
    const struct row *row = &rows[_i];
    struct plant *plant = run_plant(row->node);

    ck_assert_str_eq(plant_talk(plant, 5), row->talk);
    ck_assert_uint_eq(plant_sent(plant, row->reset), _i < 2 ? 0 : 1);
    ck_assert_int_eq(plant_said(plant, "node 5: restores its default values"), _i >= 2);
    expect_up(plant, row->saved);
    plant_free(plant);
}
END_TEST

/* The same by a tool; both are needed. */
START_TEST(test_objects)
{
    static const struct {
        uint32_t bits;
        uint8_t sub;
    } values[] = { { BOOTED | RESTORED, 1 }, { BOOTED, 1 }, { BOOTED | RESTORED, 0 } };
    struct plant *plant = run_plant("");

    ck_assert_uint_eq(tool_put(plant, 0x1F8A, 5, 1, 128), 0x06090030);
    ck_assert_uint_eq(tool_put(plant, 0x1F8A, 5, 1, values[_i].sub), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, 5, 4, values[_i].bits), 0);
    ck_assert_uint_eq(tool_get(plant, 0x1F8A, 5), values[_i].sub);
    ck_assert_uint_eq(tool_get(plant, 0x1F81, 5), values[_i].bits);
    ck_assert_uint_eq(tool_put(plant, 0x1F82, 5, 1, 7), 0);
    plant_run_ms(plant, 1500);
    expect_up(plant, _i == 0 ? 0 : 9);
    plant_free(plant);
}
END_TEST

/* 1020h says that it has its configuration: nothing is restored. */
START_TEST(test_up_to_date)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>"
                                     "<Configuration_Date>7</Configuration_Date>"
                                     "<Configuration_Time>8</Configuration_Time>");

    plant_add_object(plant->devices[5], 0x1020, 1, 4, _i == 0 ? 7 : 6);
    plant_add_object(plant->devices[5], 0x1020, 2, 4, 8);
    plant_power_on(plant);
    od_set_number(&plant->devices[5]->od, 0x6201, 1, 0x55);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), _i == 1);
    plant_free(plant);
}
END_TEST

/* In each boot that ends well, once. */
START_TEST(test_next_boot)
{
    struct plant *plant = run_plant("<Restore_Configuration>1</Restore_Configuration>");

    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 5), CO_OK);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 2);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 100);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 3);
    expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

/* A device that starts anew whenever it is configured is not restored each time. */
START_TEST(test_no_loop)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "605#2F016201", NULL, 10);
    power_on(plant);
    for (unsigned i = 0; i < 10; i++) {
        plant_run_ms(plant, 500);
        plant_power(plant, 5, false);
        plant_run_ms(plant, 10);
        plant_power(plant, 5, true);
    }
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 1);
    plant_run_ms(plant, 3000);
    expect_up(plant, 0);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 1);
    plant_free(plant);
}
END_TEST

/* An order begins it all anew. */
START_TEST(test_ordered_again)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "605#2F016201", "585#8001620122000008", 1);
    plant_lie(plant, "605#2F016201", "585#8001620130000906", 1);
    power_on(plant);
    plant_run_ms(plant, 3500);
    ck_assert(plant_said(plant, "boot error J: write 6201h:01"));
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 1);
    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 5), CO_OK);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 2);
    expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

START_TEST(test_refused)
{
    struct plant *plant = run_plant("<Restore_Configuration>3</Restore_Configuration>");

    ck_assert(plant_said(plant, "node 5: boot error J: write 1011h:03 \"load\": the node answers "
                                "abort 06090011h"));
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Its boot-up message takes longer than the boot delay; but not for ever. */
START_TEST(test_late)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "000#8105", NULL, 1);
    power_on(plant);
    plant_run_ms(plant, 500);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 3000);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_RESET);
    ck_assert_int_eq(plant_node(plant, 5)->failure.letter, 0);
    if (_i == 1)
        plant_run_ms(plant, 8000);
    ck_assert_int_eq(plant_said(plant, "node 5: boot error J: no boot-up message within 10000 ms "
                                       "after 1011h:01 \"load\" and its reset"),
                     _i == 1);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 30);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_STARTED);
    plant_run_ms(plant, 2000);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), 1);
    expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

/* Its boot-up message is lost: it answers when it is tried again. */
START_TEST(test_unheard)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    power_on(plant);
    plant_run_ms(plant, 100);
    plant_lie(plant, "705#00", NULL, 1);
    plant_run_ms(plant, 12000);
    ck_assert(plant_said(plant, "no boot-up message"));
    expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

/* It was restored, then it is reset for another reason: that is not waited for. */
START_TEST(test_reset_again)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "605#2F016201", NULL, 1);
    power_on(plant);
    while (plant_node(plant, 5)->step != BOOT_RETRY)
        plant_run_ms(plant, 1);
    plant_lie(plant, "705#00", NULL, 1);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

/* 1F25h: a running node is restored, and booted behind that; one that is only watched is not. */
START_TEST(test_conf)
{
    struct plant *plant = run_plant(_i == 0 ? ""
                                            : "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>");

    ck_assert_uint_eq(tool_put(plant, 0x1F8A, 5, 1, 1), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, 5, 4, (_i == 0 ? BOOTED : 1) | RESTORED), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 5, 4, 0x666E6F63), 0);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(plant_sent(plant, "605#23111001"), _i == 0);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6201, 1, 0), 0x55);
    if (_i == 0)
        expect_up(plant, 0);
    plant_free(plant);
}
END_TEST

/* The configuration changes while it is restored: what was begun is begun anew. */
START_TEST(test_changed)
{
    struct plant *plant = make_plant("<Restore_Configuration>1</Restore_Configuration>");

    plant_lie(plant, "605#23111001", NULL, 1);
    power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_RESTORE);
    ck_assert_uint_eq(tool_put(plant, 0x1F8A, 5, 1, 0), 0);
    plant_run_ms(plant, 500);
    expect_up(plant, 9);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("restore");

    tcase_add_loop_test(tcase, test_element, 0, (int)(sizeof rows / sizeof rows[0]));
    tcase_add_loop_test(tcase, test_objects, 0, 3);
    tcase_add_loop_test(tcase, test_up_to_date, 0, 2);
    tcase_add_test(tcase, test_next_boot);
    tcase_add_test(tcase, test_no_loop);
    tcase_add_test(tcase, test_ordered_again);
    tcase_add_test(tcase, test_refused);
    tcase_add_loop_test(tcase, test_late, 0, 2);
    tcase_add_test(tcase, test_unheard);
    tcase_add_test(tcase, test_reset_again);
    tcase_add_loop_test(tcase, test_conf, 0, 2);
    tcase_add_test(tcase, test_changed);
    return suite_run("restore", tcase);
}

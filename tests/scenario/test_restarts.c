/*
 * A device that resets itself in the middle of its boot, once, or each time: what its record says,
 * and that the others do not wait for it.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define VENDOR    "<Vendor_Identification>0x29A</Vendor_Identification>"
#define BEATS     "<Consumer_Heartbeat_Time>700</Consumer_Heartbeat_Time>"
#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define DATES                                                                                      \
    "<Configuration_Date>5000</Configuration_Date>"                                                \
    "<Configuration_Time>6000</Configuration_Time>"
#define SAVE "<Save_Configuration>TRUE</Save_Configuration>"
#define SOFTWARE                                                                                   \
    "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"                                              \
    "<Software_Identification>0x22</Software_Identification>"

#define MEANWHILE ": the node has started anew meanwhile"

/* What it resets itself at, and how often still. */
struct trigger {
    const char *frame;
    unsigned left;
};

static enum sim_fate on_frame(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    struct trigger *trigger = plant->fault_context;
    struct plant_device *device = plant->devices[5];
    char text[CO_FRAME_TEXT_SIZE];

    (void)sender;
    co_frame_format(frame, text, sizeof text);
    if (trigger->left == 0 || strncmp(text, trigger->frame, strlen(trigger->frame)) != 0)
        return SIM_DELIVER;
    trigger->left--;
    slave_command(&device->slave, NMT_RESET_NODE, plant->sim.now, &device->sim->box);
    sim_touch(&plant->sim, device->sim);
    return SIM_UNHEARD;
}

static struct plant *make_plant(const char *node, struct trigger *trigger)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml,
             "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>" PLANT_NODE(6, ""), node);
    plant = plant_new(xml, 1000000);
    plant_add_device(plant, 5);
    plant_add_device(plant, 6);
    plant_add_object(plant->devices[5], 0x1010, 1, 4, 1);
    plant_add_object(plant->devices[5], 0x1F56, 1, 4, 0x22);
    plant_add_object(plant->devices[5], 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 5, 0x1017, 0, 2, 200);
    watch_start(plant);
    plant_power_on(plant);
    plant->fault = on_frame;
    plant->fault_context = trigger;
    return plant;
}

static const struct row {
    const char *node, *frame; /* its elements; what it resets itself at */
    char letter;
    uint8_t step;
    const char *said;
} rows[] = {
    { "", "605#400010", 'B', BOOT_DEVICE_TYPE, "B: read 1000h:00 device type" MEANWHILE },
    { VENDOR, "605#40181001", 'D', BOOT_IDENTITY, "D: read 1018h:01 vendor-ID" MEANWHILE },
    { SOFTWARE, "605#40561F01", 'G', BOOT_CHECK_SOFTWARE,
      "G: read 1F56h:01 software identification" MEANWHILE },
    { DATES, "605#40201001", 'J', BOOT_CHECK_CONFIGURATION, "J: read 1020h:01" MEANWHILE },
    { "", "605#2F006201", 'J', BOOT_CONFIGURE,
      "J: write 6200h:01 = 55h (entry 1 of 2 of the configuration)" MEANWHILE },
    { SAVE, "605#23101001", 'J', BOOT_SAVE, "J: write 1010h:01 \"save\"" MEANWHILE },
    { BEATS, "705#7F", 'K', BOOT_ERROR_CONTROL,
      "K: the node has started anew while its heartbeat was waited for" },
};

/* For ever: node 6 is started all the same; when it stops doing so it is booted. */
START_TEST(test_each_time)
{
    const struct row *row = &rows[_i];
    struct trigger trigger = { row->frame, 1000000 };
    struct plant *plant = make_plant(row->node, &trigger);
    const struct boot_node *node = plant_node(plant, 5);
    char said[200];

    plant_run_ms(plant, 6000);
    snprintf(said, sizeof said, "node 5: boot error %s", row->said);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_msg(plant_said_times(plant, said) == 1, "\"%s\" expected:\n%s", said, plant->events);
    ck_assert_int_eq(node->failure.letter, row->letter);
    ck_assert_int_eq(node->failure.step, row->step);
    ck_assert_int_eq(node->failure.outcome, SDO_OUTCOME_CANCELLED);
    ck_assert_uint_ge(node->history.failures, 2);
    ck_assert_uint_le(1000000 - trigger.left, 12); /* it has a pause of a second between them */
    trigger.left = 0;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not booted in the end");
    ck_assert_int_eq(node->failure.letter, 0);
    plant_free(plant);
}
END_TEST

/* Once or twice is no failure. */
START_TEST(test_twice)
{
    struct trigger trigger = { "605#2F006201", 2 };
    struct plant *plant = make_plant("", &trigger);

    plant_run_ms(plant, 400);
    ck_assert_uint_eq(trigger.left, 0);
    watch_expect_up(plant, "is not booted at once");
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 0);
    plant_free(plant);
}
END_TEST

/* Nor are those of different boots counted together. */
START_TEST(test_of_several_boots)
{
    struct trigger trigger = { "605#2F006201", 2 };
    struct plant *plant = make_plant("", &trigger);

    plant_run_ms(plant, 400);
    trigger.left = 2;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 400);
    ck_assert_uint_eq(trigger.left, 0);
    watch_expect_up(plant, "is not booted at once");
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 0);
    plant_free(plant);
}
END_TEST

/* What answers the manager's own reset comes behind the boot delay: that is not another restart. */
START_TEST(test_no_boot_delay)
{
    struct trigger trigger = { "605#2F006201", 3 };
    struct plant *plant = make_plant("<Boot_Delay>0</Boot_Delay>", &trigger);

    plant_run_ms(plant, 800);
    ck_assert_uint_eq(trigger.left, 0);
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 1);
    plant_run_ms(plant, 600);
    watch_expect_up(plant, "is not booted after the pause");
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 1);
    ck_assert_int_eq(plant_node(plant, 5)->history.last.letter, 'J');
    plant_free(plant);
}
END_TEST

START_TEST(test_mandatory)
{
    struct trigger trigger = { "605#2F006201", 1000000 };
    struct plant *plant = make_plant(MANDATORY, &trigger);

    plant_run_ms(plant, 10000);
    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    trigger.left = 0;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not booted in the end");
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("restarts");

    tcase_add_loop_test(tcase, test_each_time, 0, sizeof rows / sizeof rows[0]);
    tcase_add_test(tcase, test_twice);
    tcase_add_test(tcase, test_of_several_boots);
    tcase_add_test(tcase, test_no_boot_delay);
    tcase_add_test(tcase, test_mandatory);
    return suite_run("restarts", tcase);
}

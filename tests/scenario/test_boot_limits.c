/*
 * Boot_Time, and what is told while a network waits.
 */
#include "support/plant.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>

static const char mandatory[] = "<Node_Instance><Node_Id>5</Node_Id><Name>pump</Name>"
                                "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave></Node_Instance>"
                                "<Node_Instance><Node_Id>6</Node_Id></Node_Instance>";

START_TEST(test_reminders_come_ever_more_rarely)
{
    struct plant *plant = plant_new(mandatory, 1000000);
    const char reminder[] = "warning: network waits: mandatory node 5 \"pump\" is missing";

    plant_add_device(plant, 6);
    plant_power_on(plant);
    plant_run_ms(plant, 200 + 4999);
    ck_assert(!plant_said(plant, reminder));
    plant_run_ms(plant, 2);
    ck_assert_uint_eq(plant_said_times(plant, reminder), 1);
    plant_run_ms(plant, 9998);
    ck_assert_uint_eq(plant_said_times(plant, reminder), 1);
    plant_run_ms(plant, 2);
    ck_assert_uint_eq(plant_said_times(plant, reminder), 2);
    plant_run_ms(plant, 299000); /* after 20, 40, and three times 60 s more */
    ck_assert_uint_eq(plant_said_times(plant, reminder), 7);
    plant_free(plant);
}
END_TEST

/* It waits for an optional node, too, until that was tried: but nobody has to come for it. */
START_TEST(test_no_reminder_of_optional_nodes)
{
    struct plant *plant = plant_new(PLANT_NODE(5, "<SDO_Timeout>8000</SDO_Timeout>"), 1000000);

    plant_power_on(plant);
    plant_run_ms(plant, 20000);
    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    ck_assert(!plant_said(plant, "network waits"));
    plant_run_ms(plant, 5000);
    ck_assert(plant_said(plant, "network is up: 0 of 1 nodes booted"));
    plant_free(plant);
}
END_TEST

START_TEST(test_limit_is_for_mandatory_nodes_only)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<Boot_Time>100</Boot_Time>%s", mandatory);
    plant = plant_new(xml, 1000000);
    plant_add_device(plant, 5);
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert(!plant_said(plant, "network not started"));
    ck_assert(plant_said(plant, "network is up: 1 of 2 nodes booted"));
    plant_free(plant);
}
END_TEST

START_TEST(test_limit_halts_and_a_late_node_lifts_it)
{
    char xml[1024];
    struct plant *plant;
    struct plant_device *late;

    snprintf(xml, sizeof xml, "<Boot_Time>3000</Boot_Time>%s", mandatory);
    plant = plant_new(xml, 1000000);
    late = plant_add_device(plant, 5);
    plant_add_device(plant, 6);
    plant_power_on(plant);
    sim_power(&plant->sim, late->sim, false);
    plant_run_ms(plant, 200 + 2999);
    ck_assert(!plant_said(plant, "network not started"));
    plant_run_ms(plant, 2);
    ck_assert(plant_said(plant, "error: network not started: mandatory node 5 \"pump\" is missing "
                                "after 3000 ms (Boot_Time)"));
    ck_assert_int_eq(plant_node(plant, 6)->nmt_state, NMT_PREOPERATIONAL);
    sim_power(&plant->sim, late->sim, true);
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "network is up: 2 of 2 nodes booted"));
    plant_free(plant);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("boot_limits");
    TCase *tests = tcase_create("limits");
    SRunner *runner;
    int failed;

    tcase_add_test(tests, test_reminders_come_ever_more_rarely);
    tcase_add_test(tests, test_no_reminder_of_optional_nodes);
    tcase_add_test(tests, test_limit_is_for_mandatory_nodes_only);
    tcase_add_test(tests, test_limit_halts_and_a_late_node_lifts_it);
    suite_add_tcase(suite, tests);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

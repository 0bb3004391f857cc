/*
 * What remains of a failure, and for how long: the last failed attempt, how many there were, when.
 */
#include "support/plant.h"
#include "support/suite.h"

#define VENDOR "<Vendor_Identification>0x29A</Vendor_Identification>"

static struct plant *boot(const char *request, const char *answer, unsigned times)
{
    struct plant *plant = plant_new(PLANT_NODE(5, VENDOR) PLANT_NODE(6, ""), 1000000);

    plant_add_device(plant, 5);
    plant_add_device(plant, 6);
    plant_lie(plant, request, answer, times);
    plant_power_on(plant);
    plant_run_ms(plant, 10000);
    return plant;
}

START_TEST(test_nothing_has_failed)
{
    struct plant *plant = boot("605#F", NULL, 0);
    const struct boot_history *history = &plant_node(plant, 5)->history;

    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_uint_eq(history->failures, 0);
    ck_assert_int_eq(history->last.letter, 0);
    ck_assert_uint_eq(history->failed_at, 0);
    ck_assert_uint_gt(history->booted_at, 0);
    plant_free(plant);
}
END_TEST

/* "Not now" twice, then it boots: the node's failure is over, what it was is kept. */
START_TEST(test_booted_since)
{
    struct plant *plant = boot("605#40181001", "585#8018100122000008", 2);
    const struct boot_node *node = plant_node(plant, 5);

    ck_assert(node->booted);
    ck_assert_int_eq(node->failure.letter, 0);
    ck_assert_uint_eq(node->attempts, 0);
    ck_assert_uint_eq(node->history.failures, 2);
    ck_assert_int_eq(node->history.last.letter, 'D');
    ck_assert_int_eq(node->history.last.step, BOOT_IDENTITY);
    ck_assert_uint_eq(node->history.last.abort_code, SDO_DEVICE_STATE);
    ck_assert_uint_ge(node->history.booted_at, node->history.failed_at + BOOT_RETRY_INTERVAL);
    ck_assert_uint_eq(plant_node(plant, 6)->history.failures, 0);
    plant_free(plant);
}
END_TEST

/* A frame was lost or late: the node tells that it has waited for it. That is no refusal. */
START_TEST(test_node_has_waited_in_vain)
{
    struct plant *plant = boot("605#40181001", "585#8018100100000405", 1);
    const struct boot_node *node = plant_node(plant, 5);

    ck_assert(node->booted);
    ck_assert_uint_eq(node->history.failures, 1);
    ck_assert_uint_eq(node->history.last.abort_code, SDO_TIMEOUT);
    plant_free(plant);
}
END_TEST

/* Boots that end well later change the time of the last one, and nothing else. */
START_TEST(test_boots_again)
{
    struct plant *plant = boot("605#40181001", "585#8018100122000008", 1);
    struct boot_history before = plant_node(plant, 5)->history;
    const struct boot_history *history = &plant_node(plant, 5)->history;

    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_uint_gt(history->booted_at, before.booted_at);
    ck_assert_uint_eq(history->failed_at, before.failed_at);
    ck_assert_uint_eq(history->failures, 1);
    ck_assert_int_eq(history->last.letter, 'D');
    plant_free(plant);
}
END_TEST

/* Another failure takes its place; both count. */
START_TEST(test_fails_otherwise)
{
    struct plant *plant = boot("605#40181001", "585#8018100122000008", 1);
    const struct boot_history *history = &plant_node(plant, 5)->history;
    co_us_t before = history->failed_at;

    plant_lie(plant, "605#40001000", "585#8000100022000008", 1);
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 5000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_uint_eq(history->failures, 2);
    ck_assert_int_eq(history->last.letter, 'B');
    ck_assert_uint_gt(history->failed_at, before);
    plant_free(plant);
}
END_TEST

/* The application resets all nodes and the network starts anew: the night is not forgotten. */
START_TEST(test_network_starts_anew)
{
    struct plant *plant = boot("605#40181001", "585#8018100122000008", 1);
    co_us_t before = plant_node(plant, 5)->history.booted_at;

    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 0), CO_OK);
    plant_run_ms(plant, 5000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_uint_gt(plant_node(plant, 5)->history.booted_at, before);
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 1);
    ck_assert_int_eq(plant_node(plant, 5)->history.last.letter, 'D');
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("boot_history");

    tcase_add_test(tcase, test_nothing_has_failed);
    tcase_add_test(tcase, test_booted_since);
    tcase_add_test(tcase, test_node_has_waited_in_vain);
    tcase_add_test(tcase, test_boots_again);
    tcase_add_test(tcase, test_fails_otherwise);
    tcase_add_test(tcase, test_network_starts_anew);
    return suite_run("boot_history", tcase);
}

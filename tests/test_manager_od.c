#include "manager/manager_od.h"

#include <check.h>

#define MISSING 0xDEADBEEFDEADu

static struct node_config nodes[3];
static struct network_config config;
static struct od od;

/* The defaults of a configuration file, with the nodes 5, 127 and 1. */
static void set_up(void)
{
    static const uint8_t ids[] = { 5, 127, 1 };

    config = (struct network_config){ .baudrate = 500,
                                      .manager_node_id = 100,
                                      .nmt_master = true,
                                      .auto_operational = true,
                                      .auto_start = true,
                                      .nodes = nodes,
                                      .node_count = 3 };
    for (size_t i = 0; i < 3; i++)
        nodes[i] = (struct node_config){ .node_id = ids[i],
                                         .nmt_slave = true,
                                         .auto_start_slave = true };
    od_init(&od);
}

static void tear_down(void)
{
    od_done(&od);
}

static uint64_t filled(uint16_t index, uint8_t sub)
{
    od_done(&od);
    ck_assert_int_eq(manager_od_fill(&config, &od), CO_OK);
    return od_number(&od, index, sub, MISSING);
}

static const struct expectation {
    uint16_t index;
    uint8_t sub;
    uint8_t type;
    uint64_t value;
} of_device[] = {
    { 0x1000, 0, OD_UNSIGNED32, 0 },
    { 0x1001, 0, OD_UNSIGNED8, 0 },
    { 0x1014, 0, OD_UNSIGNED32, 0xE4 },
    { 0x1016, 0, OD_UNSIGNED8, 127 },
    { 0x1017, 0, OD_UNSIGNED16, 0 },
    { 0x1018, 0, OD_UNSIGNED8, 4 },
    { 0x1018, 1, OD_UNSIGNED32, 0 },
    { 0x1018, 2, OD_UNSIGNED32, 0 },
    { 0x1018, 3, OD_UNSIGNED32, MCANOPEN_VERSION_MAJOR * 0x10000u + MCANOPEN_VERSION_MINOR },
    { 0x1018, 4, OD_UNSIGNED32, 0 },
    { 0x1028, 0, OD_UNSIGNED8, 127 },
    { 0x1F26, 0, OD_UNSIGNED8, 127 },
    { 0x1F27, 127, OD_UNSIGNED32, 0 },
    { 0x1F55, 6, OD_UNSIGNED32, 0 },
    { 0x1F80, 0, OD_UNSIGNED32, 1 },
    { 0x1F81, 0, OD_UNSIGNED8, 127 },
    { 0x1F81, 5, OD_UNSIGNED32, 5 },
    { 0x1F81, 6, OD_UNSIGNED32, 0 },
    { 0x1F82, 0, OD_UNSIGNED8, 128 },
    { 0x1F82, 127, OD_UNSIGNED8, 0 },
    { 0x1F82, 128, OD_UNSIGNED8, 0 },
    { 0x1F83, 0, OD_UNSIGNED8, 127 },
    { 0x1F83, 127, OD_UNSIGNED8, 0 },
    { 0x1F84, 0, OD_UNSIGNED8, 127 },
    { 0x1F88, 127, OD_UNSIGNED32, 0 },
    { 0x1F89, 0, OD_UNSIGNED32, 0 },
};

START_TEST(test_device)
{
    const struct expectation *row = &of_device[_i];
    const struct od_entry *entry;

    ck_assert_uint_eq(filled(row->index, row->sub), row->value);
    entry = od_find(&od, row->index, row->sub);
    ck_assert_uint_eq(entry->type, row->type);
}
END_TEST

static bool is_configuration(uint16_t index, uint8_t sub)
{
    if (index == 0x1F80 || index == 0x1F89)
        return true;
    return sub != 0 && (index == 0x1016 || index == 0x1F21 || index == 0x1F26 || index == 0x1F27 ||
                        index == 0x1F55 || index == 0x1F81 || (index >= 0x1F84 && index <= 0x1F8A));
}

static bool is_domain(uint16_t index, uint8_t sub)
{
    return sub != 0 && (index == 0x1F20 || index == 0x1F22 || index == 0x1F58);
}

static bool is_order(uint16_t index, uint8_t sub)
{
    return sub == REQUEST_ALL_NODES || (index == REQUEST_CONFIGURE && sub != 0);
}

/* 1017h is the device's own; of each other write the manager is told. */
START_TEST(test_what_can_be_written)
{
    struct od_entry *entry;

    filled(0x1000, 0);
    for (size_t i = 0; i < od.count; i++) {
        const uint16_t index = od.entries[i]->index;
        const uint8_t sub = od.entries[i]->sub;
        const bool is_request = (index == REQUEST_NMT || index == REQUEST_CONFIGURE) && sub != 0;
        const bool is_told = is_request || is_configuration(index, sub);
        const bool is_written = is_told || is_domain(index, sub) || index == 0x1017;

        ck_assert_uint_eq(od_check_write(&od, index, sub, &entry),
                          is_written ? SDO_OK : SDO_READ_ONLY);
        ck_assert_int_eq(od.entries[i]->watched, is_told);
        ck_assert_int_eq(od.entries[i]->fetched, is_domain(index, sub));
        ck_assert_uint_eq(od_check_read(&od, index, sub, &entry),
                          is_order(index, sub) ? SDO_WRITE_ONLY : SDO_OK);
    }
}
END_TEST

START_TEST(test_not_there)
{
    ck_assert_uint_eq(filled(0x1F81, 128), MISSING);
    ck_assert_uint_eq(filled(0x1005, 0), MISSING);
}
END_TEST

START_TEST(test_startup)
{
    config.start_all = true;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x03);
    config.auto_operational = false;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x07);
    config.auto_start = false;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x0F);
    config.action_on_error = ACTION_RESET_ALL;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x1F);
    config.action_on_error = ACTION_STOP_ALL;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x4F);
    config.nmt_master = false;
    ck_assert_uint_eq(filled(0x1F80, 0), 0x4E);
}
END_TEST

START_TEST(test_assignment)
{
    nodes[0].nmt_slave = false;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x04);
    nodes[0].auto_start_slave = false;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x00);
    nodes[0].mandatory = true;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x08);
    nodes[0].check_node_state = true;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x18);
    nodes[0].verify_software = true;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x38);
    nodes[0].allow_software_update = true;
    ck_assert_uint_eq(filled(0x1F81, 5), 0x78);
    nodes[0].restore = true;
    ck_assert_uint_eq(filled(0x1F81, 5), 0xF8);
    nodes[0].restore = false;
    nodes[0].life_time_factor = 0xA5;
    ck_assert_uint_eq(filled(0x1F81, 5), 0xA578);
    nodes[0].guard_time = 0xFEDC;
    ck_assert_uint_eq(filled(0x1F81, 5), 0xFEDCA578u);
    ck_assert_uint_eq(filled(0x1F81, 1), 0x05);
}
END_TEST

START_TEST(test_heartbeat)
{
    nodes[1].consumer_heartbeat_time = 0xFFFE;
    config.heartbeat_producer_time = 1500;
    config.boot_time = 20000;
    ck_assert_uint_eq(filled(0x1016, 127), 0x7FFFFE);
    ck_assert_uint_eq(filled(0x1016, 5), 0);
    ck_assert_uint_eq(filled(0x1017, 0), 1500);
    ck_assert_uint_eq(filled(0x1F89, 0), 20000);
}
END_TEST

START_TEST(test_emergency_consumers)
{
    ck_assert_uint_eq(filled(0x1028, 5), 0x85);
    ck_assert_uint_eq(filled(0x1028, 127), 0xFF);
    ck_assert_uint_eq(filled(0x1028, 6), 0x80000000u);
    config.preset_emergency_consumer = true;
    ck_assert_uint_eq(filled(0x1028, 5), 0x85);
    ck_assert_uint_eq(filled(0x1028, 6), 0x86);
    ck_assert_uint_eq(filled(0x1028, 127), 0xFF);
}
END_TEST

/* 1005h and 1006h are there only with a Sync_Interval; one of 0 sends nothing. */
START_TEST(test_sync)
{
    config.sync_cob_id = 0x90;
    ck_assert_uint_eq(filled(0x1005, 0), MISSING);
    ck_assert_uint_eq(filled(0x1006, 0), MISSING);
    config.has_sync_interval = true;
    ck_assert_uint_eq(filled(0x1005, 0), 0x90);
    ck_assert_uint_eq(filled(0x1006, 0), 0);
    config.sync_interval = 20000;
    ck_assert_uint_eq(filled(0x1005, 0), 0x40000090);
    ck_assert_uint_eq(filled(0x1006, 0), 20000);
}
END_TEST

START_TEST(test_identity)
{
    nodes[2].device_type = 0x191;
    nodes[2].vendor_id = 0xFFFFFFFFu;
    nodes[2].product_code = 2;
    nodes[2].revision_number = 3;
    nodes[2].serial_number = 4;
    ck_assert_uint_eq(filled(0x1F84, 1), 0x191);
    ck_assert_uint_eq(filled(0x1F85, 1), 0xFFFFFFFFu);
    ck_assert_uint_eq(filled(0x1F86, 1), 2);
    ck_assert_uint_eq(filled(0x1F87, 1), 3);
    ck_assert_uint_eq(filled(0x1F88, 1), 4);
    ck_assert_uint_eq(filled(0x1F88, 2), 0);
}
END_TEST

START_TEST(test_software)
{
    nodes[0].software_identification = 0x22;
    ck_assert_uint_eq(filled(0x1F55, 0), 127);
    ck_assert_uint_eq(filled(0x1F55, 5), 0x22);
    ck_assert_uint_eq(filled(0x1F55, 4), 0);
}
END_TEST

START_TEST(test_configuration_date)
{
    nodes[0].configuration_date = 9000;
    nodes[0].configuration_time = 43200000;
    ck_assert_uint_eq(filled(0x1F26, 5), 9000);
    ck_assert_uint_eq(filled(0x1F27, 5), 43200000);
    ck_assert_uint_eq(filled(0x1F27, 0), 127);
    ck_assert_uint_eq(filled(0x1F26, 127), 0);
}
END_TEST

START_TEST(test_twice)
{
    filled(0x1000, 0);
    ck_assert_int_eq(manager_od_fill(&config, &od), CO_ERR_EXISTS);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("manager_od");
    TCase *objects = tcase_create("objects");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_checked_fixture(objects, set_up, tear_down);
    tcase_add_loop_test(objects, test_device, 0, (int)(sizeof of_device / sizeof *of_device));
    tcase_add_test(objects, test_what_can_be_written);
    tcase_add_test(objects, test_emergency_consumers);
    tcase_add_test(objects, test_not_there);
    tcase_add_test(objects, test_startup);
    tcase_add_test(objects, test_assignment);
    tcase_add_test(objects, test_heartbeat);
    tcase_add_test(objects, test_sync);
    tcase_add_test(objects, test_identity);
    tcase_add_test(objects, test_configuration_date);
    tcase_add_test(objects, test_software);
    tcase_add_test(objects, test_twice);
    suite_add_tcase(suite, objects);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

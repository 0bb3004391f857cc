/*
 * SYNC and synchronous PDOs through the API: each transmission type in each direction, the order of
 * things at one SYNC, and the node as SYNC producer.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>

#define BOTH (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static HNODE node;

static const uint16_t input[] = { 0x2000, 0, 0, 0 };
static const uint16_t output[] = { 0x2001, 0, 0, 0 };
static const uint16_t shared[] = { 0x2002, 0, 0, 0 };

static void make_node(const SLAVE_NODE_INFO *info)
{
    node = scan_node(plant, 5, info);
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 0x11, NULL);
    scan_number(node, 0x2001, TYP_UINT8, WRITE_ACCESS | MAPPABLE, 0x22, scan_on_data);
    scan_number(node, 0x2002, TYP_UINT8, BOTH | MAPPABLE | MULTI_MAP, 0x33, NULL);
}

static void set_up(void)
{
    plant = scan_plant_new(0);
    make_node(NULL);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static void define(uint32_t cob_id, unsigned mode, const uint16_t *mapping)
{
    HPDO pdo;

    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, cob_id, (uint16_t)mode, 0, 0, 0, 0, mapping, &pdo),
        SCANOPEN_OK);
}

static void go(void)
{
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_forget(plant);
}

static void sync_times(unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        scan_send(plant, "080#");
}

/* --- transmission --- */

/* With something new only, whatever the first SYNC brings. */
START_TEST(acyclic)
{
    uint32_t type;

    define(DEFAULT_PDO1, TRANSMIT_PDO | SYNCHRON_PDO | 0, input);
    go();
    sync_times(1);
    scan_sdo_read(plant, 5, 0x1000, 0, &type); /* it has been through */
    scan_forget(plant);
    sync_times(3);
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x55), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
    sync_times(3);
    scan_expect(plant, "185#55");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* Types 1..240: each n-th SYNC brings the value that the entry has then. */
START_TEST(cyclic)
{
    const unsigned type = (unsigned)_i;

    define(DEFAULT_PDO1, TRANSMIT_PDO | SYNCHRON_PDO | type, input);
    go();
    sync_times(2 * type);
    scan_expect(plant, "185#11");
    scan_expect(plant, "185#11");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
    sync_times(type);
    scan_expect(plant, "185#44");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* 252: the value of the last SYNC. */
START_TEST(on_request_as_of_sync)
{
    define(DEFAULT_PDO1 | RTR_ALLOW, TRANSMIT_PDO | SYNCHRON_PDO | 252, input);
    go();
    sync_times(1);
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK);
    scan_send(plant, "185#R1");
    scan_expect(plant, "185#11");
    sync_times(1);
    scan_send(plant, "185#R1");
    scan_expect(plant, "185#44");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* 253: the value of now. */
START_TEST(on_request)
{
    define(DEFAULT_PDO1 | RTR_ALLOW, TRANSMIT_PDO | ASYNCHRON_PDO | 253, input);
    go();
    sync_times(2);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
    scan_send(plant, "185#R1");
    scan_expect(plant, "185#44");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* 254, 255: not for SYNC. */
START_TEST(by_event)
{
    define(DEFAULT_PDO1, TRANSMIT_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | (unsigned)_i, input);
    go();
    sync_times(3);
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x44), SCANOPEN_OK);
    scan_expect(plant, "185#44");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* --- reception --- */

/* Types 0..240: the last frame before a SYNC counts, from that SYNC on. */
START_TEST(taken_over_at_sync)
{
    define(DEFAULT_PDO1, RECEIVE_PDO | SYNCHRON_PDO | (unsigned)_i, output);
    go();
    scan_send(plant, "205#44");
    scan_send(plant, "205#55");
    scan_expect_nothing_more(plant, node);
    scan_expect_no_note();
    sync_times(1);
    scan_expect_note("data 0/5 2001:00 55");
    sync_times(2); /* nothing new */
    scan_send(plant, "205#66");
    sync_times(1);
    scan_expect_note("data 0/5 2001:00 66");
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(taken_over_at_once)
{
    define(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | (unsigned)_i, output);
    go();
    scan_send(plant, "205#44");
    scan_expect_note("data 0/5 2001:00 44");
    sync_times(1);
    scan_expect_nothing_more(plant, node);
    scan_expect_no_note();
}
END_TEST

/* Nothing that came before is left when the node was not operational meanwhile. */
START_TEST(not_across_states)
{
    define(DEFAULT_PDO1, RECEIVE_PDO | 1, shared);
    go();
    scan_send(plant, "205#44");
    scan_preoperational(plant, node);
    scan_operational(plant, node);
    sync_times(1);
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2002, 0), 0x33);
}
END_TEST

/* --- one SYNC --- */

/* What goes out is sampled before what came in is taken over. */
START_TEST(transmission_comes_before_reception)
{
    define(DEFAULT_PDO1, TRANSMIT_PDO | 1, shared);
    define(DEFAULT_PDO1, RECEIVE_PDO | 1, shared);
    go();
    scan_send(plant, "205#44");
    sync_times(1);
    scan_expect(plant, "185#33");
    scan_send(plant, "205#55");
    sync_times(1);
    scan_expect(plant, "185#44");
    sync_times(1);
    scan_expect(plant, "185#55");
}
END_TEST

START_TEST(sync_with_another_cob_id)
{
    SLAVE_NODE_INFO info = scan_info();

    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    info.ulSyncCobID = 0x90;
    make_node(&info);
    define(DEFAULT_PDO1, TRANSMIT_PDO | 1, input);
    go();
    sync_times(1);
    scan_expect_nothing_more(plant, node);
    scan_send(plant, "090#");
    scan_expect(plant, "185#11");
}
END_TEST

/* 1800h:06: the SYNC with this counter (1019h) is the first of the four. */
START_TEST(sync_start_value)
{
    char sync[16];

    define(DEFAULT_PDO1, TRANSMIT_PDO | 4, input);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1019, 0, 1, 10), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 1, 4, 0x80000185), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 6, 1, 3), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 1, 4, 0x185), 0);
    scan_operational(plant, node);
    scan_forget(plant);
    for (unsigned counter = 1; counter <= 10; counter++) {
        snprintf(sync, sizeof sync, "080#%02X", counter);
        scan_send(plant, sync);
        if (counter == 6 || counter == 10)
            scan_expect(plant, "185#11");
        scan_expect_nothing_more(plant, node);
    }
}
END_TEST

/* --- the producer --- */

static void make_producer(unsigned long period)
{
    SLAVE_NODE_INFO info = scan_info();

    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    info.ulOptions |= SYNC_GENERATION;
    info.ulSyncCobID = DEFAULT_SYNC_COBID | SYNC_PRODUCE;
    info.ulCyclePeriod = period;
    make_node(&info);
}

START_TEST(a_node_produces_sync)
{
    uint32_t value = 0;
    co_us_t first;

    make_producer(20000);
    define(DEFAULT_PDO1, TRANSMIT_PDO | 1, input);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1005, 0, &value), 0);
    ck_assert_uint_eq(value, 0x40000080);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1006, 0, &value), 0);
    ck_assert_uint_eq(value, 20000);
    scan_await(plant, "080#"); /* before it is operational, too */
    first = scan_time(plant);
    for (unsigned i = 0; i < 5; i++)
        scan_await(plant, "080#");
    ck_assert_uint_ge(scan_time(plant) - first, CO_MS(80));
    scan_operational(plant, node);
    scan_await(plant, "185#11"); /* its own SYNC counts for itself */
    scan_stop(plant, node);
    scan_forget(plant);
    ck_assert(!scan_await_within(plant, "080#", 60));
}
END_TEST

START_TEST(a_producer_is_switched_on_by_the_manager)
{
    make_producer(0);
    scan_activate(plant, node);
    ck_assert(!scan_await_within(plant, "080#", 20));
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1005, 0, 4, 0x80), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1019, 0, 1, 3), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1006, 0, 4, 5000), 0);
    ck_assert(!scan_await_within(plant, "080#*", 20));
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1005, 0, 4, 0x40000080), 0);
    scan_expect(plant, "080#01");
    scan_expect(plant, "080#02");
    scan_expect(plant, "080#03");
    scan_expect(plant, "080#01");
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1006, 0, 4, 0), 0);
    scan_forget(plant);
    ck_assert(!scan_await_within(plant, "080#*", 30));
}
END_TEST

START_TEST(synchronous_pdos_need_their_option)
{
    SLAVE_NODE_INFO info = scan_info();
    HPDO pdo;

    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    info.ulOptions &= ~(unsigned long)SYNCHRON_PDOS;
    make_node(&info);
    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, DEFAULT_PDO1, TRANSMIT_PDO | 1, 0, 0, 0, 0, input, &pdo),
        SCANOPEN_PDO_PARAMETER_ERROR);
    define(DEFAULT_PDO1, TRANSMIT_PDO | 255, input);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_test(tcase, acyclic);
    tcase_add_loop_test(tcase, cyclic, 1, 241);
    tcase_add_test(tcase, on_request_as_of_sync);
    tcase_add_test(tcase, on_request);
    tcase_add_loop_test(tcase, by_event, 254, 256);
    tcase_add_loop_test(tcase, taken_over_at_sync, 0, 241);
    tcase_add_loop_test(tcase, taken_over_at_once, 254, 256);
    tcase_add_test(tcase, not_across_states);
    tcase_add_test(tcase, transmission_comes_before_reception);
    tcase_add_test(tcase, sync_with_another_cob_id);
    tcase_add_test(tcase, sync_start_value);
    tcase_add_test(tcase, a_node_produces_sync);
    tcase_add_test(tcase, a_producer_is_switched_on_by_the_manager);
    tcase_add_test(tcase, synchronous_pdos_need_their_option);
}

int main(void)
{
    TCase *tcase = tcase_create("pdo_sync");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_pdo_sync", tcase);
}

/* What the functions for PDOs refuse. */
#include "port/clock.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static HNODE node;

static const uint16_t outputs[] = { 0x2000, 0, 0, 0 };
static const uint16_t inputs[] = { 0x2001, 0, 0, 0 };
static const uint16_t others[] = { 0x2002, 0, 0, 0 };

/* 2000h..2004h: for RPDOs, for TPDOs, for both and many, not mappable, of four bytes. */
static void set_up(void)
{
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
    scan_number(node, 0x2000, TYP_UINT8, WRITE_ACCESS | MAPPABLE, 1, NULL);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    scan_number(node, 0x2002, TYP_UINT8, BOTH | MAPPABLE | MULTI_MAP, 1, NULL);
    scan_number(node, 0x2003, TYP_UINT8, BOTH, 1, NULL);
    scan_number(node, 0x2004, TYP_UINT32, BOTH | MAPPABLE | MULTI_MAP, 1, NULL);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

/* --- canOpenDefinePDO --- */

struct order {
    uint32_t cob_id;
    unsigned mode;
    int32_t inhibit, timer;
    const uint16_t *mapping;
};

static int define(const struct order *order, HPDO *pdo)
{
    return canOpenDefinePDO(node, NULL, order->cob_id, (uint16_t)order->mode, order->inhibit, 0, 0,
                            order->timer, order->mapping, pdo);
}

static HPDO make(uint32_t cob_id, unsigned mode, uint16_t tx, uint16_t rx, const uint16_t *mapping)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, cob_id, (uint16_t)mode, 0, tx, rx, 0, mapping, &pdo),
        SCANOPEN_OK);
    return pdo;
}

static const struct order no_parameters[] = {
    /* restricted CAN-IDs, and bits beside them */
    { 0, RECEIVE_PDO | 255, 0, 0, NULL },
    { 5, RECEIVE_PDO | 255, 0, 0, NULL },
    { 0x7F, RECEIVE_PDO | 255, 0, 0, NULL },
    { 0x101, RECEIVE_PDO | 255, 0, 0, NULL },
    { 0x180, RECEIVE_PDO | 255, 0, 0, NULL },
    { 0x581, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x5FF, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x601, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x67F, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x6E0, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x6FF, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x701, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x77F, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x780, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x7FF, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x800, TRANSMIT_PDO | 255, 0, 0, NULL }, /* 29 bits without the flag */
    { 0x1FFFFFFF, TRANSMIT_PDO | 255, 0, 0, NULL },
    { 0x080, TRANSMIT_PDO | 255, 0, 0, NULL }, /* the node's SYNC */
    { 0x085, TRANSMIT_PDO | 255, 0, 0, NULL }, /* its EMCY */
    { 0x1F0, TRANSMIT_PDO | 255, 0, 0, NULL }, /* another PDO of it */
    /* direction and kind */
    { DEFAULT_PDO1, 255, 0, 0, NULL },
    { DEFAULT_PDO1, RECEIVE_PDO | TRANSMIT_PDO | 255, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | SYNCHRON_PDO | ASYNCHRON_PDO | 1, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | SYNCHRON_PDO | 255, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | ASYNCHRON_PDO | 1, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | ASYNCHRON_PDO | 0, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | 0x8000 | 255, 0, 0, NULL },
    /* transmission types that are reserved, or not for this direction */
    { DEFAULT_PDO1, TRANSMIT_PDO | 241, 0, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | 251, 0, 0, NULL },
    { DEFAULT_PDO1, RECEIVE_PDO | 241, 0, 0, NULL },
    { DEFAULT_PDO1, RECEIVE_PDO | 251, 0, 0, NULL },
    { DEFAULT_PDO1, RECEIVE_PDO | 252, 0, 0, NULL },
    { DEFAULT_PDO1, RECEIVE_PDO | 253, 0, 0, NULL },
    /* times */
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, -1, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 6554, 0, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, -1, NULL },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 65536, NULL },
};

START_TEST(parameters_that_are_not_valid)
{
    HPDO pdo = NULL;

    make(0x1F0, TRANSMIT_PDO | 255, 0, 0, NULL);
    ck_assert_int_eq(define(&no_parameters[_i], &pdo), SCANOPEN_PDO_PARAMETER_ERROR);
}
END_TEST

static const struct order good_parameters[] = {
    { 0x181, TRANSMIT_PDO | ASYNCHRON_PDO | 255, 6553, 65535, inputs },
    { 0x57F, TRANSMIT_PDO | ASYNCHRON_PDO | 254, 0, 1, inputs },
    { 0x080 | PDO_INVALID, RECEIVE_PDO | 254, 0, 0, outputs },
    { 0x680, RECEIVE_PDO | SYNCHRON_PDO | 240, 0, 0, NULL },
    { 0x6DF | RTR_DISALLOW, TRANSMIT_PDO | SYNCHRON_PDO | 0, 0, 0, NULL },
    { DEFAULT_PDO4 | PDO_VALID | RTR_ALLOW, TRANSMIT_PDO | 253, 0, 0, inputs },
    { 0x20000180, TRANSMIT_PDO | 252, 0, 0, inputs },
    { 0x3FFFFFFF, RECEIVE_PDO | 1, 0, 0, outputs },
    { PDO_INVALID, TRANSMIT_PDO | 255, 0, 0, NULL },
};

START_TEST(parameters_at_the_edge)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(define(&good_parameters[_i], NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(define(&good_parameters[_i], &pdo), SCANOPEN_OK);
    ck_assert_ptr_nonnull(pdo);
}
END_TEST

static const uint16_t no_object[] = { 0x2100, 0, 0, 0 };
static const uint16_t no_sub[] = { 0x2000, 1, 0, 0 };
static const uint16_t no_dummy[] = { 0x0008, 0, 0, 0 };
static const uint16_t not_mappable[] = { 0x2003, 0, 0, 0 };
static const uint16_t own[] = { 0x1018, 1, 0, 0 };
static const uint16_t second_is_bad[] = { 0x2002, 0, 0x2003, 0, 0, 0 };
static const uint16_t bits_72[] = { 0x2004, 0, 0x2004, 0, 0x2002, 0, 0, 0 };
static const struct order no_mappings[] = {
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, no_object },
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, no_sub },
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, no_dummy },
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, not_mappable },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, not_mappable },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, own },
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, second_is_bad },
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, inputs },   /* read only */
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, outputs }, /* write only */
    { DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, bits_72 },
    { DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, bits_72 },
};

START_TEST(mappings_that_cannot_be)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(define(&no_mappings[_i], &pdo), SCANOPEN_PDO_MAPPING_ERROR);
    make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, outputs); /* and nothing is left of it */
}
END_TEST

START_TEST(an_entry_in_a_second_pdo)
{
    struct order order = { DEFAULT_PDO2, RECEIVE_PDO | 255, 0, 0, outputs };
    HPDO pdo = NULL;

    make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, outputs);
    ck_assert_int_eq(define(&order, &pdo), SCANOPEN_PDO_MAPPING_ERROR);
}
END_TEST

START_TEST(an_entry_in_too_many_pdos)
{
    const uint16_t many[] = { 0x2002, 0, 0, 0 };
    SLAVE_NODE_INFO info = scan_info();
    struct order order = { 0x1F0, TRANSMIT_PDO | 255, 0, 0, many };
    HPDO pdo = NULL;

    info.ucMaxMapped = 2;
    node = scan_node(plant, 6, &info);
    scan_number(node, 0x2002, TYP_UINT8, BOTH | MAPPABLE | MULTI_MAP, 1, NULL);
    make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, many);
    make(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, many);
    ck_assert_int_eq(define(&order, &pdo), SCANOPEN_TOO_MANY_OBJECTS);
}
END_TEST

START_TEST(more_pdos_than_asked_for)
{
    SLAVE_NODE_INFO info = scan_info();
    struct order order = { 0x1F0, 0, 0, 0, NULL };
    HPDO pdo = NULL;

    info.usRxPDO = 1;
    info.usTxPDO = 2;
    node = scan_node(plant, 6, &info);
    make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, NULL);
    order.mode = RECEIVE_PDO | 255;
    ck_assert_int_eq(define(&order, &pdo), SCANOPEN_TOO_MANY_OBJECTS);
    make(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, NULL);
    make(DEFAULT_PDO2, TRANSMIT_PDO | 255, 0, 0, NULL);
    order.mode = TRANSMIT_PDO | 255;
    ck_assert_int_eq(define(&order, &pdo), SCANOPEN_TOO_MANY_OBJECTS);
}
END_TEST

/* --- states and kinds --- */

START_TEST(not_when_the_node_is_not_operational)
{
    HPDO tx = make(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, inputs);
    HPDO rx = make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, outputs);
    uint8_t buffer[8] = { 9 };

    for (int state = 0; state < 3; state++) {
        ck_assert_int_eq(canOpenWritePDO(tx, buffer), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(canOpenWritePDO(tx, NULL), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(canOpenReadPDO(rx, buffer), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(canOpenRequestPDO(rx, buffer), SCANOPEN_WRONG_NODESTATE);
        if (state == 0)
            scan_activate(plant, node);
        else
            scan_stop(plant, node);
    }
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 1);
    scan_preoperational(plant, node);
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(not_with_this_kind_of_pdo)
{
    HPDO asynchronous = make(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, inputs);
    HPDO synchronous = make(DEFAULT_PDO2, TRANSMIT_PDO | 1, 0, 0, NULL);
    HPDO no_tx = make(DEFAULT_PDO3 | PDO_INVALID, TRANSMIT_PDO | 255, 0, 0, NULL);
    HPDO rx = make(DEFAULT_PDO1 | RTR_DISALLOW, RECEIVE_PDO | 255, 0, 0, outputs);
    HPDO no_rx = make(DEFAULT_PDO2 | PDO_INVALID, RECEIVE_PDO | 255, 0, 0, NULL);
    uint8_t buffer[8] = { 9 };

    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenWritePDO(rx, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenWritePDO(synchronous, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenWritePDO(no_tx, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenReadPDO(asynchronous, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenReadPDO(no_rx, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenRequestPDO(asynchronous, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenRequestPDO(no_rx, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenRequestPDO(rx, buffer), SCANOPEN_SERVICE_NOT_ALLOWED);
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* --- sending --- */

START_TEST(data_beyond_an_entrys_limits)
{
    const uint16_t mapping[] = { 0x2001, 0, 0x2005, 0, 0, 0 };
    DictionaryData limited = { .uint8 = { .val = 5, .defval = 5, .minval = 4, .maxval = 10 } };
    const uint8_t high[] = { 7, 11 }, low[] = { 7, 3 }, good[] = { 7, 10 };
    HPDO pdo;

    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2005, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(
        canOpenInitDictionary(node, 0x2005, 0, NULL, READ_ACCESS | MAPPABLE, &limited, NULL),
        SCANOPEN_OK);
    pdo = make(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, mapping);
    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_int_eq(canOpenWritePDO(pdo, high), SCANOPEN_VALUE_TOO_HIGH);
    ck_assert_int_eq(canOpenWritePDO(pdo, low), SCANOPEN_VALUE_TOO_LOW);
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 1);
    ck_assert_uint_eq(scan_get(node, 0x2005, 0), 5);
    ck_assert_int_eq(canOpenWritePDO(pdo, good), SCANOPEN_OK);
    scan_expect(plant, "185#070A");
}
END_TEST

START_TEST(within_the_inhibit_time)
{
    const struct order order = { DEFAULT_PDO1, TRANSMIT_PDO | 255, 200, 0, inputs };
    const uint8_t two[8] = { 2 }, three[8] = { 3 }, four[8] = { 4 };
    co_us_t first;
    HPDO pdo;

    ck_assert_int_eq(define(&order, &pdo), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_int_eq(canOpenWritePDO(pdo, two), SCANOPEN_OK);
    scan_await(plant, "185#02");
    first = scan_time(plant);
    ck_assert_int_eq(canOpenWritePDO(pdo, three), SCANOPEN_INHIBITED);
    ck_assert_int_eq(canOpenWritePDO(pdo, four), SCANOPEN_INHIBITED);
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 4);
    scan_expect(plant, "185#04");
    ck_assert_uint_ge(scan_time(plant) - first, CO_MS(150));
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* At 10 kbit/s a frame takes several ms; these may wait one. */
START_TEST(a_bus_that_is_too_slow)
{
    struct scan_plant *slow = scan_plant_slow(1, 10);
    HPDO tx, rx;

    node = scan_node(slow, 6, NULL);
    scan_number(node, 0x2000, TYP_UINT8, WRITE_ACCESS | MAPPABLE, 1, NULL);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    tx = make(DEFAULT_PDO1, TRANSMIT_PDO | TX_DONE_PDO | 255, 1, 0, inputs);
    rx = make(DEFAULT_PDO1, RECEIVE_PDO | 255, 1, 1000, outputs);
    scan_activate(slow, node);
    scan_operational(slow, node);
    ck_assert_int_eq(canOpenWritePDO(tx, NULL), SCANOPEN_TX_TIMEOUT);
    ck_assert_int_eq(canOpenRequestPDO(rx, NULL), SCANOPEN_TX_TIMEOUT);
    scan_plant_free(slow);
}
END_TEST

/* --- receiving --- */

START_TEST(nothing_comes)
{
    HPDO at_once = make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, outputs);
    HPDO soon = make(DEFAULT_PDO2, RECEIVE_PDO | 255, 0, 20, others);
    uint8_t buffer[8] = { 9 };

    scan_activate(plant, node);
    scan_operational(plant, node);
    ck_assert_int_eq(canOpenReadPDO(at_once, buffer), SCANOPEN_RX_TIMEOUT);
    ck_assert_int_eq(canOpenReadPDO(soon, NULL), SCANOPEN_RX_TIMEOUT);
    ck_assert_int_eq(canOpenRequestPDO(at_once, NULL), SCANOPEN_RX_TIMEOUT);
    scan_await(plant, "205#R*");
    ck_assert_int_eq(canOpenRequestPDO(soon, buffer), SCANOPEN_RX_TIMEOUT);
    scan_await(plant, "305#R*");
    ck_assert_uint_eq(buffer[0], 9);
}
END_TEST

/* A call that waits, in a thread of its own. */
struct waiting {
    int (*call)(HPDO pdo, void *buffer);
    HPDO pdo;
    uint8_t buffer[8];
    int result;
    atomic_bool over;
    pthread_t thread;
};

static void *wait_for_pdo(void *context)
{
    struct waiting *self = context;

    self->result = self->call(self->pdo, self->buffer);
    atomic_store(&self->over, true);
    return NULL;
}

static void begin(struct waiting *self)
{
    ck_assert_int_eq(pthread_create(&self->thread, NULL, wait_for_pdo, self), 0);
}

static int (*const receives[])(HPDO pdo, void *buffer) = { canOpenReadPDO, canOpenRequestPDO };

/* Said again and again, as nobody sees when the call begins to wait. */
START_TEST(another_length_than_the_mapping)
{
    const char *const frames[] = { "205#", "205#0102" };
    struct waiting waiting = { .call = receives[_i % 2],
                               .pdo = make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 20000, outputs),
                               .buffer = { 9 } };
    co_us_t start = clock_now();

    scan_activate(plant, node);
    scan_operational(plant, node);
    begin(&waiting);
    while (!atomic_load(&waiting.over)) {
        scan_send(plant, frames[_i / 2]);
        scan_forget(plant);
    }
    ck_assert_int_eq(pthread_join(waiting.thread, NULL), 0);
    ck_assert_int_eq(waiting.result, SCANOPEN_LENGTH_MISMATCH);
    ck_assert_uint_lt(clock_now() - start, CO_MS(10000)); /* it did not wait for its time to end */
    ck_assert_uint_eq(waiting.buffer[0], 9);
}
END_TEST

/* Whether it waits already or not yet. */
START_TEST(no_longer_operational)
{
    struct waiting waiting = { .call = receives[_i],
                               .pdo = make(DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 60000, outputs) };

    scan_activate(plant, node);
    scan_operational(plant, node);
    begin(&waiting);
    while (_i == 1 && !atomic_load(&waiting.over) && !scan_await_within(plant, "205#R*", 10))
        ;
    scan_stop(plant, node);
    ck_assert_int_eq(pthread_join(waiting.thread, NULL), 0);
    ck_assert_int_eq(waiting.result, SCANOPEN_WRONG_NODESTATE);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, parameters_that_are_not_valid, 0, COUNT(no_parameters));
    tcase_add_loop_test(tcase, parameters_at_the_edge, 0, COUNT(good_parameters));
    tcase_add_loop_test(tcase, mappings_that_cannot_be, 0, COUNT(no_mappings));
    tcase_add_test(tcase, an_entry_in_a_second_pdo);
    tcase_add_test(tcase, an_entry_in_too_many_pdos);
    tcase_add_test(tcase, more_pdos_than_asked_for);
    tcase_add_test(tcase, not_when_the_node_is_not_operational);
    tcase_add_test(tcase, not_with_this_kind_of_pdo);
    tcase_add_test(tcase, data_beyond_an_entrys_limits);
    tcase_add_test(tcase, within_the_inhibit_time);
    tcase_add_test(tcase, a_bus_that_is_too_slow);
    tcase_add_test(tcase, nothing_comes);
    tcase_add_loop_test(tcase, another_length_than_the_mapping, 0, 4);
    tcase_add_loop_test(tcase, no_longer_operational, 0, 2);
}

int main(void)
{
    TCase *tcase = tcase_create("errors_pdo");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_errors_pdo", tcase);
}

/*
 * PDOs through the API: definition and the objects it makes, asynchronous sending, receiving,
 * requests, mapping, lengths. SYNC: test_scan_pdo_sync.c.
 */
#include "port/clock.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static HNODE node;

static const uint16_t first[] = { 0x2000, 0, 0, 0 };
static const uint16_t both[] = { 0x2000, 0, 0x2001, 0, 0, 0 };

/* 2000h and 2001h, of 1 and 2 bytes, and 2002h: one bit. */
static void set_up(void)
{
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
    scan_number(node, 0x2000, TYP_UINT8, BOTH | MAPPABLE | MULTI_MAP, 0x11, scan_on_data);
    scan_number(node, 0x2001, TYP_UINT16, BOTH | MAPPABLE | MULTI_MAP, 0x2233, scan_on_data);
    scan_number(node, 0x2002, TYP_BOOL, BOTH | MAPPABLE | MULTI_MAP, 1, scan_on_data);
    scan_on_data_size(0x2001, 2);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static HPDO define_at(uint32_t cob_id, unsigned mode, int32_t inhibit, int32_t timer,
                      const uint16_t *mapping)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(canOpenDefinePDO(node, NULL, cob_id, (uint16_t)mode, inhibit, 0, 30000, timer,
                                      mapping, &pdo),
                     SCANOPEN_OK);
    return pdo;
}

static HPDO define(uint32_t cob_id, unsigned mode, const uint16_t *mapping)
{
    return define_at(cob_id, mode, 0, 0, mapping);
}

static void go(void)
{
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_forget(plant);
}

static uint32_t value_at(unsigned index, unsigned sub)
{
    uint32_t value = 0;

    ck_assert_uint_eq(scan_sdo_read(plant, 5, index, sub, &value), 0);
    return value;
}

/* --- the objects of a PDO --- */

static const struct cob_row {
    uint32_t cob_id;
    unsigned direction;
    uint32_t object;
} cob_rows[] = {
    { DEFAULT_PDO1, TRANSMIT_PDO, 0x00000185 },
    { DEFAULT_PDO2, TRANSMIT_PDO, 0x00000285 },
    { DEFAULT_PDO3, TRANSMIT_PDO, 0x00000385 },
    { DEFAULT_PDO4, TRANSMIT_PDO, 0x00000485 },
    { DEFAULT_PDO_1, RECEIVE_PDO, 0x00000205 },
    { DEFAULT_PDO_2, RECEIVE_PDO, 0x00000305 },
    { DEFAULT_PDO_3, RECEIVE_PDO, 0x00000405 },
    { DEFAULT_PDO_4, RECEIVE_PDO, 0x00000505 },
    { DEFAULT_PDO1 | PDO_INVALID, TRANSMIT_PDO, 0x80000185 },
    { DEFAULT_PDO1 | RTR_DISALLOW, TRANSMIT_PDO, 0x40000185 },
    { 0x1F0 | PDO_VALID | RTR_ALLOW, TRANSMIT_PDO, 0x000001F0 },
    { 0x20012345, TRANSMIT_PDO, 0x20012345 },
};

START_TEST(cob_ids)
{
    const struct cob_row *row = &cob_rows[_i];
    unsigned index = row->direction == TRANSMIT_PDO ? 0x1800 : 0x1400;

    define(row->cob_id, row->direction | ASYNCHRON_PDO | 255, first);
    scan_activate(plant, node);
    ck_assert_uint_eq(value_at(index, 1), row->object);
    ck_assert_uint_eq(value_at(index, 2), 255);
    ck_assert_uint_eq(value_at(index + 0x200, 0), 1);
    ck_assert_uint_eq(value_at(index + 0x200, 1), 0x20000008);
}
END_TEST

START_TEST(communication_parameters)
{
    define_at(DEFAULT_PDO1, TRANSMIT_PDO | 254, 15, 5000, both);
    define_at(DEFAULT_PDO2, TRANSMIT_PDO | SYNCHRON_PDO | 17, 0, 0, NULL);
    scan_activate(plant, node);
    ck_assert_uint_eq(value_at(0x1800, 2), 254);
    ck_assert_uint_eq(value_at(0x1800, 3), 150); /* 100 us */
    ck_assert_uint_eq(value_at(0x1800, 5), 5000);
    ck_assert_uint_eq(value_at(0x1A00, 0), 2);
    ck_assert_uint_eq(value_at(0x1A00, 2), 0x20010010);
    ck_assert_uint_eq(value_at(0x1801, 2), 17);
    ck_assert_uint_eq(value_at(0x1A01, 0), 0);
}
END_TEST

/* The n-th call makes the n-th of its direction. */
START_TEST(as_many_pdos_as_there_may_be)
{
    SLAVE_NODE_INFO info = scan_info();

    info.usRxPDO = info.usTxPDO = 512;
    node = scan_node(plant, 6, &info);
    for (unsigned i = 0; i < 512; i++) {
        define(0x20010000 + i, TRANSMIT_PDO | 255, NULL);
        define(0x20020000 + i, RECEIVE_PDO | 255, NULL);
    }
    ck_assert_uint_eq(scan_get(node, 0x1800, 1), 0x20010000);
    ck_assert_uint_eq(scan_get(node, 0x19FF, 1), 0x200101FF);
    ck_assert_uint_eq(scan_get(node, 0x15FF, 1), 0x200201FF);
    ck_assert_uint_eq(scan_get(node, 0x17FF, 0), 0);
    ck_assert_uint_eq(scan_get(node, 0x1BFF, 0), 0);
}
END_TEST

/* --- sending --- */

START_TEST(a_pdo_is_written)
{
    const uint8_t data[8] = { 1, 2, 3, 9, 9, 9, 9, 9 };
    HPDO pdo = define(DEFAULT_PDO1, TRANSMIT_PDO | ASYNCHRON_PDO | 255, both);

    go();
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#113322");
    ck_assert_int_eq(canOpenWritePDO(pdo, data), SCANOPEN_OK);
    scan_expect(plant, "185#010203");
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 1);
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 0x0302);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 7), SCANOPEN_OK); /* not by itself */
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#070203");
    scan_expect_no_note();
}
END_TEST

START_TEST(a_pdo_with_29_bits)
{
    HPDO pdo = define(0x20000000 | 0x12345, TRANSMIT_PDO | 255, first);

    define(0x20000000 | 0x54321, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, first);
    go();
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "00012345#11");
    scan_send(plant, "00054321#22");
    scan_await_note("data 0/5 2000:00 22");
}
END_TEST

/* The confirmation is back when the call returns. */
START_TEST(sending_with_confirmation)
{
    HPDO pdo = define(DEFAULT_PDO1, TRANSMIT_PDO | TX_DONE_PDO | 255, first);

    go();
    for (unsigned i = 0; i < 20; i++) {
        ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
        ck_assert(scan_await_within(plant, "185#11", 0));
    }
}
END_TEST

START_TEST(what_changes_is_sent)
{
    HDICT entry;
    uint16_t value = 0x4455;

    define(DEFAULT_PDO1, TRANSMIT_PDO | ASYNCHRON_PDO | AUTO_NOTIFY_PDO | 255, both);
    ck_assert_int_eq(canOpenGetDictionaryHnd(node, 0x2001, 0, &entry), SCANOPEN_OK);
    scan_activate(plant, node);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 1), SCANOPEN_OK);
    scan_expect_nothing_more(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 2), SCANOPEN_OK);
    scan_expect(plant, "185#023322");
    ck_assert_int_eq(canOpenWriteDictionaryHnd(entry, &value), SCANOPEN_OK);
    scan_expect(plant, "185#025544");
    ck_assert_int_eq(canOpenWriteDictionaryHnd(entry, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#025544");
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(the_event_timer)
{
    HPDO pdo = define_at(DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 50, first);
    co_us_t written, repeated;

    go();
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_await(plant, "185#11");
    written = scan_time(plant);
    scan_expect(plant, "185#11");
    repeated = scan_time(plant);
    ck_assert_uint_ge(repeated - written, CO_MS(30));
    scan_expect(plant, "185#11");
    ck_assert_uint_ge(scan_time(plant) - repeated, CO_MS(30));
}
END_TEST

/* --- remote frames --- */

START_TEST(remote_frames_are_answered)
{
    define(DEFAULT_PDO1 | RTR_ALLOW, TRANSMIT_PDO | ASYNCHRON_PDO | 255, both);
    define(DEFAULT_PDO2 | RTR_DISALLOW, TRANSMIT_PDO | ASYNCHRON_PDO | 255, both);
    go();
    scan_send(plant, "185#R3");
    scan_expect(plant, "185#113322");
    scan_send(plant, "285#R3");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* --- receiving --- */

START_TEST(a_pdo_is_received)
{
    define(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | AUTO_NOTIFY | 255, both);
    scan_activate(plant, node);
    scan_send(plant, "205#010203"); /* too early */
    scan_expect_nothing_more(plant, node);
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_send(plant, "205#040506");
    scan_expect_note("data 0/5 2000:00 04");
    scan_expect_note("data 0/5 2001:00 0506");
    ck_assert_uint_eq(scan_get(node, 0x2001, 0), 0x0605);
    scan_stop(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 4 0");
    scan_send(plant, "205#070809");
    scan_preoperational(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 4);
}
END_TEST

/* Without AUTO_NOTIFY the value comes in silence. */
START_TEST(a_pdo_is_received_in_silence)
{
    define(DEFAULT_PDO1, RECEIVE_PDO | ASYNCHRON_PDO | 255, both);
    go();
    scan_send(plant, "205#040506");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 4);
    scan_expect_no_note();
}
END_TEST

START_TEST(dummies)
{
    const uint16_t mapping[] = { 0x0005, 0, 0x2001, 0, 0x0007, 0, 0x2000, 0, 0, 0 };

    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, mapping);
    go();
    scan_send(plant, "205#AA0102BBBBBBBB03");
    scan_expect_note("data 0/5 2001:00 0102");
    scan_expect_note("data 0/5 2000:00 03");
}
END_TEST

START_TEST(bits)
{
    const uint16_t mapping[] = { 0x2002, 0, 0x2000, 0, 0, 0 }; /* 9 bits: 2 bytes */
    HPDO pdo = define(DEFAULT_PDO1, TRANSMIT_PDO | 255, mapping);

    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, mapping);
    go();
    ck_assert_int_eq(scan_set(node, 0x2000, 0, 0x83), SCANOPEN_OK);
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#0701"); /* 1, then 83h one bit higher */
    scan_send(plant, "205#0A00");
    scan_expect_note("data 0/5 2002:00 00");
    scan_expect_note("data 0/5 2000:00 05");
}
END_TEST

/* --- other lengths --- */

START_TEST(too_short)
{
    char event[SCAN_NOTE_SIZE];

    define(DEFAULT_PDO2, RECEIVE_PDO | AUTO_NOTIFY | 255, NULL);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, both);
    go();
    scan_send(plant, "205#0102");
    ck_assert_int_eq(EV_CAN, 0x10);
    snprintf(event, sizeof event, "event 0/5 CAN %d 2", EV_PDO_NOT_PROCESSED);
    scan_expect_note(event);
    scan_expect(plant, "085#1082110004020203"); /* 8210h, EMCY_STICKY_PDO_LENGTH */
    ck_assert_uint_eq(EMCY_PDO_NOT_PROCESSED, 0x8210);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x11);
}
END_TEST

START_TEST(too_long)
{
    char event[SCAN_NOTE_SIZE];

    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, both);
    go();
    scan_send(plant, "205#01020304");
    snprintf(event, sizeof event, "event 0/5 CAN %d 1", EV_PDO_LENGTH_EXCEEDED);
    scan_expect_note(event);
    scan_expect(plant, "085#2082110004010403");
    ck_assert_uint_eq(EMCY_PDO_LENGTH_EXCEEDED, 0x8220);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x11);
}
END_TEST

START_TEST(too_long_but_taken)
{
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= PDO_ACCEPT_LONG;
    node = scan_node(plant, 6, &info);
    scan_number(node, 0x2000, TYP_UINT8, BOTH | MAPPABLE, 0x11, scan_on_data);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, first);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_forget(plant);
    scan_send(plant, "206#0102");
    scan_await_note("data 0/6 2000:00 01");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* --- waiting for reception --- */

struct waiting {
    int (*call)(HPDO pdo, void *buffer);
    HPDO pdo;
    void *buffer;
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

/* With a buffer handlers are not called, without they are. Nobody sees when the call begins to
 * wait, so the frame is said again and again. */
START_TEST(waiting_for_a_pdo)
{
    uint8_t buffer[8] = { 9, 9, 9, 9 };
    struct waiting waiting = { .call = canOpenReadPDO,
                               .pdo = define(DEFAULT_PDO1, RECEIVE_PDO | 255, both),
                               .buffer = _i == 0 ? buffer : NULL };

    go();
    begin(&waiting);
    while (!atomic_load(&waiting.over))
        scan_send(plant, "205#040506");
    ck_assert_int_eq(pthread_join(waiting.thread, NULL), 0);
    ck_assert_int_eq(waiting.result, SCANOPEN_OK);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 4);
    if (_i == 0) {
        ck_assert_mem_eq(buffer, "\x04\x05\x06", 3);
        scan_expect_no_note();
    } else {
        scan_await_note("data 0/5 2000:00 04");
        scan_await_note("data 0/5 2001:00 0506");
    }
}
END_TEST

START_TEST(requesting_a_pdo)
{
    uint8_t buffer[8] = { 9, 9, 9, 9 };
    struct waiting waiting = { .call = canOpenRequestPDO,
                               .pdo = define(DEFAULT_PDO1, RECEIVE_PDO | 255, both),
                               .buffer = _i == 0 ? buffer : NULL };

    go();
    begin(&waiting);
    while (!atomic_load(&waiting.over) && !scan_await_within(plant, "205#R*", 10))
        ;
    scan_send(plant, "205#040506");
    ck_assert_int_eq(pthread_join(waiting.thread, NULL), 0);
    ck_assert_int_eq(waiting.result, SCANOPEN_OK);
    if (_i == 0) {
        ck_assert_mem_eq(buffer, "\x04\x05\x06", 3);
        scan_expect_no_note();
    } else {
        scan_await_note("data 0/5 2000:00 04");
    }
}
END_TEST

/* --- the manager changes it --- */

START_TEST(a_manager_makes_a_pdo_valid)
{
    HPDO pdo = define(0x1F0 | PDO_INVALID, TRANSMIT_PDO | 255, first);

    go();
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 1, 4, 0x1F1), 0);
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "1F1#11");
}
END_TEST

START_TEST(a_manager_maps_anew)
{
    HPDO pdo = define(DEFAULT_PDO1, TRANSMIT_PDO | 255, first);

    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 1, 4, 0x80000185), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1A00, 0, 1, 0), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1A00, 1, 4, 0x20010010), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1A00, 2, 4, 0x20000008), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1A00, 0, 1, 2), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1800, 1, 4, 0x185), 0);
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenWritePDO(pdo, NULL), SCANOPEN_OK);
    scan_expect(plant, "185#332211");
}
END_TEST

static void add_object_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, cob_ids, 0, COUNT(cob_rows));
    tcase_add_test(tcase, communication_parameters);
    tcase_add_test(tcase, as_many_pdos_as_there_may_be);
    tcase_add_test(tcase, a_manager_makes_a_pdo_valid);
    tcase_add_test(tcase, a_manager_maps_anew);
}

static void add_sending_tests(TCase *tcase)
{
    tcase_add_test(tcase, a_pdo_is_written);
    tcase_add_test(tcase, a_pdo_with_29_bits);
    tcase_add_test(tcase, sending_with_confirmation);
    tcase_add_test(tcase, what_changes_is_sent);
    tcase_add_test(tcase, the_event_timer);
    tcase_add_test(tcase, remote_frames_are_answered);
}

static void add_receiving_tests(TCase *tcase)
{
    tcase_add_test(tcase, a_pdo_is_received);
    tcase_add_test(tcase, a_pdo_is_received_in_silence);
    tcase_add_test(tcase, dummies);
    tcase_add_test(tcase, bits);
    tcase_add_test(tcase, too_short);
    tcase_add_test(tcase, too_long);
    tcase_add_test(tcase, too_long_but_taken);
    tcase_add_loop_test(tcase, waiting_for_a_pdo, 0, 2);
    tcase_add_loop_test(tcase, requesting_a_pdo, 0, 2);
}

int main(void)
{
    TCase *tcase = tcase_create("pdo");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_object_tests(tcase);
    add_sending_tests(tcase);
    add_receiving_tests(tcase);
    return suite_run("scan_pdo", tcase);
}

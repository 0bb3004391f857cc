/* Object handlers: what they are told, when they are asked, their verdict on a client's data. */
#include "port/clock.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define BOTH         (READ_ACCESS | WRITE_ACCESS)

static struct scan_plant *plant;
static HNODE node;

static void set_up(void)
{
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, NULL);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static HPDO define(uint32_t cob_id, unsigned mode, int32_t timer, const uint16_t *mapping)
{
    HPDO pdo = NULL;

    ck_assert_int_eq(
        canOpenDefinePDO(node, NULL, cob_id, (uint16_t)mode, 0, 0, 0, timer, mapping, &pdo),
        SCANOPEN_OK);
    return pdo;
}

static void go(void)
{
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_forget(plant);
}

/* --- the verdict on a write of a client --- */

static const struct verdict {
    int returned;
    uint32_t abort_code;
} verdicts[] = {
    { SCANOPEN_OK, 0 },
    { 0x06040043, 0x06040043 },
    { 0x08000022, 0x08000022 },
    { 1, 1 },
    { SCANOPEN_VALUE_TOO_HIGH, 0x06090031 },
    { SCANOPEN_VALUE_TOO_LOW, 0x06090032 },
    { SCANOPEN_WRONG_PARAMETER, 0x06090030 },
    { SCANOPEN_ACCESS_ERROR, 0x08000020 },
    { SCANOPEN_INVALID_HANDLE, 0x08000020 },
    { -1, 0x08000020 },
    { INT32_MIN, 0x08000020 },
};

START_TEST(a_handler_decides)
{
    const struct verdict *row = &verdicts[_i];

    scan_number(node, 0x2000, TYP_UINT16, BOTH, 0x1122, scan_on_data);
    scan_on_data_size(0x2000, 2);
    scan_activate(plant, node);
    scan_on_data_returns(row->returned);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 2, 0x3344), row->abort_code);
    scan_expect_note("data 0/5 2000:00 4433");
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), row->abort_code == 0 ? 0x3344 : 0x1122);
}
END_TEST

static int on_look(int net, int id, int index, int sub, void *data)
{
    scan_note("%d/%d %04X:%02X old %02X", net, id, (unsigned)index, (unsigned)sub,
              scan_get(node, 0x2000, 0));
    return data ? SCANOPEN_OK : SCANOPEN_WRONG_PARAMETER;
}

/* By SDO the value is not there yet, by PDO it is. */
START_TEST(when_the_value_is_in_the_dictionary)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };

    scan_number(node, 0x2000, TYP_UINT8, BOTH | MAPPABLE, 0x11, on_look);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, 0, mapping);
    go();
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 0x22), 0);
    scan_await_note("0/5 2000:00 old 11");
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 0x22);
    scan_send(plant, "205#33");
    scan_await_note("0/5 2000:00 old 33");
}
END_TEST

/* What a handler refuses after its limits have been checked; handlers are not asked for more. */
START_TEST(limits_come_before_the_handler)
{
    DictionaryData data = { .uint8 = { .val = 5, .defval = 5, .minval = 1, .maxval = 10 } };

    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, 0x2000, 0, NULL, BOTH, &data, scan_on_data),
                     SCANOPEN_OK);
    go();
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 11), 0x06090031);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 10), 0);
    scan_expect_note("data 0/5 2000:00 0A");
}
END_TEST

static int on_text(int net, int id, int index, int sub, void *data)
{
    const RecVisString *text = data;

    scan_note("%d/%d %04X:%02X '%.*s'", net, id, (unsigned)index, (unsigned)sub,
              (int)text->ulLength, text->pData);
    return text->ulLength == 3 ? SCANOPEN_OK : SCANOPEN_WRONG_PARAMETER;
}

START_TEST(a_handler_of_a_string)
{
    static char memory[8] = "old"; /* the entry keeps it */
    char *now = NULL;
    DictionaryData data = { .visstring = { memory, sizeof memory, 3 } };

    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, MAP_VIS_STRING),
                     SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, 0x2000, 0, NULL, BOTH, &data, on_text),
                     SCANOPEN_OK);
    go();
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 4, 0x64636261), 0x06090030);
    scan_await_note("0/5 2000:00 'abcd'");
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &now), SCANOPEN_OK);
    ck_assert_str_eq(now, "old");
    scan_get(node, 0x1000, 0); /* the library's lock: the client's next write comes after this */
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 3, 0x00636261), 0);
    ck_assert_int_eq(canOpenReadDictionary(node, 0x2000, 0, &now), SCANOPEN_OK);
    ck_assert_str_eq(now, "abc");
}
END_TEST

static int on_time_of_day(int net, int id, int index, int sub, void *data)
{
    const CAN_TIME_OF_DAY *time = data;

    scan_note("%d/%d %04X:%02X %lu %u", net, id, (unsigned)index, (unsigned)sub, time->ulMs,
              (unsigned)time->usDays);
    return SCANOPEN_OK;
}

START_TEST(a_handler_of_a_time)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    DictionaryData data;

    memset(&data, 0, sizeof data);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, MAP_TIME_OF_DAY),
                     SCANOPEN_OK);
    ck_assert_int_eq(
        canOpenInitDictionary(node, 0x2000, 0, NULL, BOTH | MAPPABLE, &data, on_time_of_day),
        SCANOPEN_OK);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY | 255, 0, mapping);
    go();
    scan_send(plant, "205#FF5B2605983A");
    scan_await_note("0/5 2000:00 86399999 15000");
}
END_TEST

/* --- handlers that do not answer --- */

static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static int on_blocked(int net, int id, int index, int sub, void *data)
{
    scan_note("%d/%d %04X:%02X blocked %d", net, id, (unsigned)index, (unsigned)sub, data != NULL);
    pthread_mutex_lock(&gate);
    pthread_mutex_unlock(&gate);
    return SCANOPEN_OK;
}

/* The client is refused after a second; meanwhile the node serves others, and the late verdict
 * counts for nothing. */
START_TEST(a_handler_that_blocks)
{
    char event[SCAN_NOTE_SIZE];
    co_us_t start;

    scan_number(node, 0x2000, TYP_UINT8, BOTH, 1, on_blocked);
    go();
    pthread_mutex_lock(&gate);
    start = clock_now();
    scan_send(plant, "605#2F00200007000000");
    scan_await_note("0/5 2000:00 blocked 1");
    scan_stop(plant, node);
    scan_operational(plant, node);
    scan_send(plant, "605#2F00200009000000");
    scan_await(plant, "585#8000200020000008");
    ck_assert_uint_ge(clock_now() - start, CO_MS(1000));
    snprintf(event, sizeof event, "event 0/5 HANDLER %d %lu", EV_TIMEOUT, 0x200000UL);
    ck_assert_int_eq(EV_HANDLER, 0x200);
    scan_await_note(event);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 1);
    pthread_mutex_unlock(&gate);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 8), 0);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 8);
}
END_TEST

/* One is with the handler, two wait, two are lost. */
START_TEST(more_pdos_than_the_queue_holds)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    SLAVE_NODE_INFO info = scan_info();
    char event[SCAN_NOTE_SIZE];

    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    info.usPdoRxQueusize = 2;
    ck_assert_uint_eq(info.usPdoRxQueueSize, 2);
    node = scan_node(plant, 5, &info);
    scan_number(node, 0x2000, TYP_UINT8, BOTH | MAPPABLE, 1, on_blocked);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, 0, mapping);
    go();
    pthread_mutex_lock(&gate);
    scan_send(plant, "205#01");
    scan_await_note("0/5 2000:00 blocked 1");
    for (unsigned i = 0; i < 4; i++)
        scan_send(plant, "205#02");
    scan_expect_nothing_more(plant, node);
    pthread_mutex_unlock(&gate);
    snprintf(event, sizeof event, "event 0/5 CAN %d 2", EV_PDO_FIFO_OVERRUN);
    scan_await_note(event);
    scan_await(plant, "085#0081110002010200"); /* 8100h, EMCY_STICKY_FIFO_OVERRUN */
    ck_assert_uint_eq(EMCY_MESSAGE_LOST, 0x8100);
    scan_await(plant, "085#0000000002000000"); /* the queue is empty */
    ck_assert_uint_eq(scan_get(node, 0x1001, 0), 0);
}
END_TEST

/* What was lost until then is nothing to the node that is on the bus again. */
START_TEST(pdos_lost_before_the_node_goes_offline)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    SLAVE_NODE_INFO info = scan_info();

    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    info.usPdoRxQueueSize = 1;
    node = scan_node(plant, 5, &info);
    scan_number(node, 0x2000, TYP_UINT8, BOTH | MAPPABLE, 1, on_blocked);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, 0, mapping);
    go();
    pthread_mutex_lock(&gate);
    scan_send(plant, "205#01");
    scan_await_note("0/5 2000:00 blocked 1");
    for (unsigned i = 0; i < 4; i++)
        scan_send(plant, "205#02");
    scan_expect_nothing_more(plant, node);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    pthread_mutex_unlock(&gate);
    go();
    scan_send(plant, "205#03");
    scan_await_note("0/5 2000:00 blocked 1");
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* A client that gives up, and begins anew. */
START_TEST(a_client_that_aborts_meanwhile)
{
    uint32_t type = 0;

    scan_number(node, 0x2000, TYP_UINT8, BOTH, 1, on_blocked);
    go();
    pthread_mutex_lock(&gate);
    scan_send(plant, "605#2F00200007000000");
    scan_await_note("0/5 2000:00 blocked 1");
    scan_send(plant, "605#8000200000000405");
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1000, 0, &type), 0);
    ck_assert_uint_eq(type, 0x00020192);
    pthread_mutex_unlock(&gate);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 8), 0);
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 8);
}
END_TEST

/* Other threads delete nothing that a handler is in. */
START_TEST(a_node_that_is_reset_while_its_handler_runs)
{
    scan_number(node, 0x2000, TYP_UINT8, BOTH, 1, on_blocked);
    go();
    pthread_mutex_lock(&gate);
    scan_send(plant, "605#2F00200007000000");
    scan_await_note("0/5 2000:00 blocked 1");
    scan_send(plant, "000#8105");
    scan_await(plant, "705#00");
    ck_assert_int_eq(scan_state(node), NodePreOperational);
    pthread_mutex_unlock(&gate);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x2000, 0, 1, 8), 0);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 8);
}
END_TEST

static void *delete_node(void *result)
{
    *(int *)result = canOpenDeleteNode(node);
    return NULL;
}

/* Who deletes a node waits for the handler, and is told when it has returned. */
START_TEST(a_node_that_is_deleted_while_its_handler_runs)
{
    int result = -1, state, error;
    pthread_t thread;

    scan_number(node, 0x2000, TYP_UINT8, BOTH, 1, on_blocked);
    go();
    pthread_mutex_lock(&gate);
    scan_send(plant, "605#2F00200007000000");
    scan_await_note("0/5 2000:00 blocked 1");
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(pthread_create(&thread, NULL, delete_node, &result), 0);
    while (canOpenGetNodeInfo(node, &state, &error) != SCANOPEN_INVALID_HANDLE)
        sched_yield();
    pthread_mutex_unlock(&gate);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    ck_assert_int_eq(result, SCANOPEN_OK);
}
END_TEST

/* --- time stamps --- */

static _Atomic uint64_t last_time; /* written before its note */

static int on_time(int net, int id, int index, int sub, void *data, uint64_t time)
{
    last_time = time;
    scan_note("time %d/%d %04X:%02X %s", net, id, (unsigned)index, (unsigned)sub,
              data ? "set" : "wanted");
    return SCANOPEN_OK;
}

/* Each of the two spellings, in ns or, normalized, in us. */
START_TEST(handlers_with_time)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    const SLAVE_NET_INFO info = { .ulOptions = _i >= 2 ? NORMALIZE_TIMESTAMPS : 0,
                                  .usBaudrate = SCAN_BITRATE };
    const uint64_t unit = _i >= 2 ? 1 : 1000; /* in one microsecond */
    struct scan_plant *other = scan_plant_bare(1);
    DictionaryData data = { .uint8 = { .val = 1 } };
    co_us_t before;

    ck_assert_int_eq(canOpenCreateNetworkEx(1, &info), SCANOPEN_OK);
    node = scan_node(other, 5, NULL);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2000, 0, OBJ_VAR, MAP_UINT8), SCANOPEN_OK);
    if (_i % 2)
        ck_assert_int_eq(
            canOpenInitDictionaryTs(node, 0x2000, 0, NULL, BOTH | MAPPABLE, &data, on_time),
            SCANOPEN_OK);
    else
        ck_assert_int_eq(
            canOpenInitDictionaryTS(node, 0x2000, 0, NULL, BOTH | MAPPABLE, &data, on_time),
            SCANOPEN_OK);
    define(DEFAULT_PDO1, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, 0, mapping);
    scan_activate(other, node);
    scan_operational(other, node);
    before = clock_now();
    scan_send(other, "205#07");
    scan_await_note("time 1/5 2000:00 set");
    ck_assert_uint_ge(last_time / unit, before);
    ck_assert_uint_le(last_time / unit, clock_now());
    before = clock_now();
    ck_assert_uint_eq(scan_sdo_write(other, 5, 0x2000, 0, 1, 8), 0);
    scan_await_note("time 1/5 2000:00 set");
    ck_assert_uint_ge(last_time / unit, before);
    ck_assert_uint_le(last_time / unit, clock_now());
    scan_plant_free(other);
    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_OK);
}
END_TEST

/* --- handlers that are asked for data --- */

static uint8_t measured; /* only the handler's */

static int on_wanted(int net, int id, int index, int sub, void *data)
{
    int result = SCANOPEN_OK;

    if (data)
        return scan_on_data(net, id, index, sub, data);
    measured++;
    result = canOpenWriteDictionary(node, (unsigned short)index, (unsigned short)sub, &measured);
    scan_note("wanted %d/%d %04X:%02X %d", net, id, (unsigned)index, (unsigned)sub, result);
    return result;
}

static const uint16_t inputs[] = { 0x2000, 0, 0x2001, 0, 0, 0 };

static void add_inputs(void)
{
    measured = 0x40;
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, on_wanted);
    scan_number(node, 0x2001, TYP_UINT8, READ_ACCESS | MAPPABLE, 2, on_wanted);
}

START_TEST(a_sync_asks_for_data)
{
    add_inputs();
    define(DEFAULT_PDO1, TRANSMIT_PDO | SYNCHRON_PDO | 1, 0, inputs);
    go();
    scan_send(plant, "080#");
    scan_expect(plant, "185#4142");
    scan_expect_note("wanted 0/5 2000:00 0");
    scan_expect_note("wanted 0/5 2001:00 0");
    scan_send(plant, "080#");
    scan_expect(plant, "185#4344");
}
END_TEST

START_TEST(a_remote_frame_asks_for_data)
{
    add_inputs();
    define(DEFAULT_PDO1, TRANSMIT_PDO | 253, 0, inputs);
    go();
    scan_send(plant, "185#R2");
    scan_expect(plant, "185#4142");
    scan_expect_note("wanted 0/5 2000:00 0");
    scan_expect_note("wanted 0/5 2001:00 0");
    scan_expect_nothing_more(plant, node);
}
END_TEST

START_TEST(the_event_timer_asks_for_data)
{
    add_inputs();
    define(DEFAULT_PDO1, TRANSMIT_PDO | TIMER_DRIVEN_PDO | AUTO_NOTIFY_PDO | 255, 50, inputs);
    scan_activate(plant, node);
    scan_operational(plant, node);
    scan_await_note("wanted 0/5 2000:00 0");
    scan_await(plant, "185#4142");
    scan_await(plant, "185#4344");
}
END_TEST

static int on_pdo_blocked(int net, int id, int index, int sub, void *data)
{
    (void)data;
    return on_blocked(net, id, index, sub, NULL);
}

/* The PDO goes at the end of the window with what is there (1007h 20 ms). */
START_TEST(a_sync_does_not_wait_for_a_handler_for_ever)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };

    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 7, on_pdo_blocked);
    define(DEFAULT_PDO1, TRANSMIT_PDO | 1, 0, mapping);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1007, 0, 4, 20000), 0);
    scan_operational(plant, node);
    pthread_mutex_lock(&gate);
    scan_send(plant, "080#");
    scan_await_note("0/5 2000:00 blocked 0");
    scan_await(plant, "185#07");
    pthread_mutex_unlock(&gate);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_loop_test(tcase, a_handler_decides, 0, COUNT(verdicts));
    tcase_add_test(tcase, when_the_value_is_in_the_dictionary);
    tcase_add_test(tcase, limits_come_before_the_handler);
    tcase_add_test(tcase, a_handler_of_a_string);
    tcase_add_test(tcase, a_handler_of_a_time);
    tcase_add_test(tcase, a_handler_that_blocks);
    tcase_add_test(tcase, more_pdos_than_the_queue_holds);
    tcase_add_test(tcase, pdos_lost_before_the_node_goes_offline);
    tcase_add_test(tcase, a_client_that_aborts_meanwhile);
    tcase_add_test(tcase, a_node_that_is_reset_while_its_handler_runs);
    tcase_add_test(tcase, a_node_that_is_deleted_while_its_handler_runs);
    tcase_add_loop_test(tcase, handlers_with_time, 0, 4);
    tcase_add_test(tcase, a_sync_asks_for_data);
    tcase_add_test(tcase, a_remote_frame_asks_for_data);
    tcase_add_test(tcase, the_event_timer_asks_for_data);
    tcase_add_test(tcase, a_sync_does_not_wait_for_a_handler_for_ever);
}

int main(void)
{
    TCase *tcase = tcase_create("handlers");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_handlers", tcase);
}

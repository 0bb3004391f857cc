/* mcanOpenReadSDOAsync, mcanOpenWriteSDOAsync, mcanOpenCancelSDO: each request ends once. */
#include "api/control.h"
#include "port/bus_segment.h"
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TEXT     "a text that needs more than one segment"
#define ENDS_MAX 600u
#define DATA_MAX 64u

struct end {
    SDO_RESULT_T result;
    char data[DATA_MAX];
    pthread_t thread;
};

static struct api_plant *plant;
static struct api_wire *wire;
static struct {
    struct co_lock lock;
    struct co_condition changed;
    struct end list[ENDS_MAX];
    unsigned count;
} ends;

/* Node 5 is there; 7 is what the wire says, and has 60 s to answer; 8 is nowhere. */
static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2001, 1, 0x11);
    api_add_number(plant, 5, 0x2004, 4, 0x44332211);
    api_add_domain(plant, 5, 0x2010, TEXT, sizeof TEXT - 1, 65536);
    api_devices_start(plant);
    ck_assert_int_eq(lock_init(&ends.lock), CO_OK);
    ck_assert_int_eq(condition_init(&ends.changed), CO_OK);
    ends.count = 0;
}

#define SILENT                                                                                     \
    API_NODE_WITH(7, "<SDO_Timeout>60000</SDO_Timeout><NMT_Auto_Start_Slave>FALSE"                 \
                     "</NMT_Auto_Start_Slave>")

static void boot(void)
{
    api_boot(plant, API_NODE(5) SILENT);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
    condition_done(&ends.changed);
    lock_done(&ends.lock);
}

static void note_end(void *context, const SDO_RESULT_T *result)
{
    struct end *end;

    lock_take(&ends.lock);
    ck_assert_uint_lt(ends.count, ENDS_MAX);
    end = &ends.list[ends.count++];
    end->result = *result;
    end->thread = pthread_self();
    if (result->data && result->len <= (int)DATA_MAX)
        memcpy(end->data, result->data, (size_t)result->len);
    condition_signal(&ends.changed);
    lock_give(&ends.lock);
    (void)context;
}

static void wait_for_ends(unsigned count)
{
    co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;

    lock_take(&ends.lock);
    while (ends.count < count && err != CO_ERR_TIMEOUT)
        err = condition_wait(&ends.changed, &ends.lock, limit);
    lock_give(&ends.lock);
    ck_assert_uint_ge(ends.count, count);
}

static SDO_REQUEST_T reading(int node, int index, int len)
{
    return (SDO_REQUEST_T){
        .size = sizeof(SDO_REQUEST_T), .node = node, .index = index, .len = len, .done = note_end
    };
}

static SDO_REQUEST_T writing(int node, int index, int type, const void *data, int len)
{
    SDO_REQUEST_T request = reading(node, index, len);

    request.type = type;
    request.data = data;
    return request;
}

/* Its number. */
static unsigned read_async(int node, int index, int len)
{
    const SDO_REQUEST_T request = reading(node, index, len);
    unsigned number = 0;

    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, &number), MCANOPEN_OK);
    ck_assert_uint_ne(number, 0);
    return number;
}

/* --- good ends --- */

START_TEST(what_is_read_is_told)
{
    unsigned numbers[2];
    const SDO_RESULT_T *result;

    boot();
    numbers[0] = read_async(5, 0x2004, 8);
    numbers[1] = read_async(5, 0x2010, 60);
    wait_for_ends(2);
    result = &ends.list[0].result;
    ck_assert_int_eq(result->result, MCANOPEN_OK);
    ck_assert_uint_eq(result->number, numbers[0]);
    ck_assert_int_eq(result->net, 0);
    ck_assert_int_eq(result->node, 5);
    ck_assert_int_eq(result->index, 0x2004);
    ck_assert_int_eq(result->subindex, 0);
    ck_assert_int_eq(result->write, 0);
    ck_assert_int_eq(result->len, 4);
    ck_assert_mem_eq(ends.list[0].data, "\x11\x22\x33\x44", 4);
    result = &ends.list[1].result;
    ck_assert_uint_eq(result->number, numbers[1]);
    ck_assert_int_eq(result->len, sizeof TEXT - 1);
    ck_assert_mem_eq(ends.list[1].data, TEXT, sizeof TEXT - 1);
    ck_assert(pthread_equal(ends.list[0].thread, ends.list[1].thread));
    ck_assert(!pthread_equal(ends.list[0].thread, pthread_self()));
}
END_TEST

/* The buffer is the caller's again at once. */
START_TEST(what_was_written_is_there)
{
    char data[30], value[30];
    SDO_REQUEST_T request;

    memset(data, 'x', sizeof data);
    request = writing(5, 0x2010, TYP_DOMAIN | (_i ? TYP_BLOCK : 0), data, sizeof data);
    boot();
    ck_assert_int_eq(mcanOpenWriteSDOAsync(&request, NULL), MCANOPEN_OK);
    memset(data, 'y', sizeof data);
    wait_for_ends(1);
    ck_assert_int_eq(ends.list[0].result.result, MCANOPEN_OK);
    ck_assert_int_eq(ends.list[0].result.write, 1);
    ck_assert_ptr_null(ends.list[0].result.data);
    ck_assert_uint_eq(api_get(plant, 5, 0x2010, value, sizeof value), 30);
    for (int i = 0; i < 30; i++)
        ck_assert_int_eq(value[i], 'x');
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "605#C61020001E000000"), (unsigned)_i);
    request = reading(5, 0x2010, 30);
    request.subindex = _i ? TYP_BLOCK : 0;
    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    wait_for_ends(2);
    ck_assert_int_eq(ends.list[1].result.len, 30);
    ck_assert_int_eq(ends.list[1].result.subindex, 0);
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "605#A4102000"), (unsigned)_i);
}
END_TEST

/* --- bad ends --- */

static const struct {
    int node, index, len;
    const char *answer;
    int result, result_len;
    unsigned char global; /* of the abort code */
} bad[] = {
    { 5, 0x5000, 8, NULL, MCAL_ABORT_DOMAIN, 0, 0 },
    { 5, 0x2010, 9, NULL, MCAL_BUFFER_OVERFLOW, sizeof TEXT - 1, 0 },
    { 8, 0x2000, 9, NULL, MCAL_CAN_RX_TIMEOUT, 0, 0 },
    { 7, 0x2000, 9, "587#8000200011000906", MCAL_ABORT_DOMAIN, 0, 0x11 },
    { 7, 0x2000, 9, "587#6000200000000000", MCAL_WRONG_SERVER_ANSWER, 0, 0 },
};

START_TEST(what_has_failed_is_told)
{
    const SDO_RESULT_T *result = &ends.list[0].result;

    boot();
    if (bad[_i].answer)
        api_wire_answer(wire, "607#40", bad[_i].answer);
    read_async(bad[_i].node, bad[_i].index, bad[_i].len);
    wait_for_ends(1);
    ck_assert_int_eq(result->result, bad[_i].result);
    ck_assert_int_eq(result->len, bad[_i].result_len);
    ck_assert_ptr_null(result->data);
    ck_assert_uint_eq(result->error.eclass, bad[_i].result == MCAL_ABORT_DOMAIN ? 6 : 0);
    ck_assert_uint_eq(result->error.global, bad[_i].global);
}
END_TEST

/* --- refused: done is not called --- */

static const struct {
    SDO_REQUEST_T request;
    bool write;
} wrong[] = {
    { { .node = 0, .index = 0x2000, .type = TYP_UINT8, .data = "" }, true },
    { { .node = 0, .index = 0x2000 }, false },
    { { .node = 128, .index = 0x2000 }, false },
    { { .node = 5, .index = -1 }, false },
    { { .node = 5, .index = 0x10000 }, false },
    { { .node = 5, .subindex = 0x100 }, false },
    { { .node = 5, .subindex = -1 }, false },
    { { .node = 5, .len = -1 }, false },
    { { .node = 5, .net = -1 }, false },
    { { .node = 5, .net = 256 }, false },
    { { .node = 5, .type = TYP_UINT8 }, true },
    { { .node = 5, .type = 0, .data = "", .len = 1 }, true },
    { { .node = 5, .type = TYP_UINT8, .data = "", .len = -1 }, true },
    { { .node = 5, .type = TYP_DOMAIN, .data = "", .len = 0 }, true },
    { { .node = 5, .subindex = TYP_BLOCK, .type = TYP_UINT8, .data = "" }, true },
};

START_TEST(wrong_requests_are_refused)
{
    SDO_REQUEST_T request = wrong[_i].request;
    int (*call)(const SDO_REQUEST_T *, unsigned *) = wrong[_i].write ? mcanOpenWriteSDOAsync
                                                                     : mcanOpenReadSDOAsync;

    request.size = sizeof request;
    request.done = note_end;
    boot();
    ck_assert_int_eq(call(&request, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, 0);
}
END_TEST

/* Both directions say the same. */
static int try_both(const SDO_REQUEST_T *request)
{
    const int result = mcanOpenReadSDOAsync(request, NULL);

    ck_assert_int_eq(mcanOpenWriteSDOAsync(request, NULL), result);
    return result;
}

START_TEST(not_now_and_not_so)
{
    SDO_REQUEST_T good = writing(5, 0x2001, TYP_UINT8, "A", 1), request = good;

    ck_assert_int_eq(try_both(&good), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenCancelSDO(0, 1), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(try_both(&good), MCAL_NO_NET);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_int_eq(try_both(&good), MCAL_NODE_NOT_FREE);
    ck_assert_int_eq(mcanOpenCancelSDO(0, 1), MCAL_NODE_NOT_FREE);
    mcanOpenStart();
    ck_assert_int_eq(try_both(NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenCancelSDO(-1, 1), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenCancelSDO(1, 1), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenCancelSDO(0, 1), MCAL_NO_EVENT);
    request.size--;
    ck_assert_int_eq(try_both(&request), MCAL_PARA_ERROR);
    request = good;
    request.done = NULL;
    ck_assert_int_eq(try_both(&request), MCAL_PARA_ERROR);
    request = good;
    request.net = 9;
    ck_assert_int_eq(try_both(&request), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, 0);
}
END_TEST

/* --- many --- */

START_TEST(there_is_an_end_of_room_and_room_again)
{
    const SDO_REQUEST_T request = writing(7, 0x2000, TYP_UINT32, "ABCD", 4);
    unsigned number;

    boot();
    for (unsigned i = 0; i < MCANOPEN_SDO_REQUESTS; i++)
        number = read_async(7, 0x2000, 4);
    ck_assert_int_eq(try_both(&request), MCAL_SDO_QUEUE_FULL);
    ck_assert_int_eq(mcanOpenCancelSDO(0, number), MCANOPEN_OK);
    wait_for_ends(1);
    ck_assert_int_eq(ends.list[0].result.result, MCAL_SDO_CANCELLED);
    read_async(7, 0x2000, 4);
    ck_assert_int_eq(try_both(&request), MCAL_SDO_QUEUE_FULL);
}
END_TEST

/* Before it returns, and each of them once. */
START_TEST(shut_down_ends_all)
{
    co_us_t start;

    boot();
    for (unsigned i = 0; i < MCANOPEN_SDO_REQUESTS; i++)
        read_async(7, 0x2000, 4);
    api_wire_wait(wire, "607#40002000", 1);
    start = clock_now();
    ck_assert_int_eq(_i ? mcanOpenCleanup() : mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_lt(clock_now(), start + CO_MS(1500));
    ck_assert_uint_eq(ends.count, MCANOPEN_SDO_REQUESTS);
    for (unsigned i = 0; i < MCANOPEN_SDO_REQUESTS; i++) {
        ck_assert_int_eq(ends.list[i].result.result, MCAL_NO_NET);
        ck_assert_int_eq(ends.list[i].result.index, 0x2000);
        ck_assert(i == 0 || ends.list[i].result.number > ends.list[i - 1].result.number);
    }
}
END_TEST

/* Some have ended, some are on their way: whatever, each once. */
START_TEST(shut_down_amid_requests)
{
    unsigned taken = 0;

    boot();
    while (taken < 200) {
        const SDO_REQUEST_T request = reading(5, 0x2004, 4);

        ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
        taken++;
    }
    wait_for_ends(5);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, taken);
    for (unsigned i = 0; i < ends.count; i++)
        ck_assert(ends.list[i].result.result == MCANOPEN_OK ||
                  ends.list[i].result.result == MCAL_NO_NET);
}
END_TEST

/* Each with its own data, and to one node in turn. */
START_TEST(each_end_has_its_own_data)
{
    boot();
    for (unsigned i = 0; i < 100; i++) {
        const uint8_t value = (uint8_t)(3 * i);
        const SDO_REQUEST_T request = writing(5, 0x2001, TYP_UINT8, &value, 1);

        ck_assert_int_eq(mcanOpenWriteSDOAsync(&request, NULL), MCANOPEN_OK);
        read_async(5, 0x2001, 1);
    }
    wait_for_ends(200);
    for (unsigned i = 0; i < 100; i++) {
        ck_assert_int_eq(ends.list[2 * i].result.write, 1);
        ck_assert_int_eq(ends.list[2 * i + 1].result.len, 1);
        ck_assert_uint_eq((uint8_t)ends.list[2 * i + 1].data[0], (uint8_t)(3 * i));
    }
}
END_TEST

/* --- cancelled --- */

START_TEST(a_request_is_cancelled)
{
    unsigned running, waiting, last;

    boot();
    api_wire_answer(wire, "607#40002000", "587#4100200064000000");
    api_wire_answer(wire, "607#40012000", "587#4F01200009000000");
    running = read_async(7, 0x2000, 200);
    waiting = read_async(7, 0x2002, 4);
    last = read_async(7, 0x2001, 4);
    api_wire_wait(wire, "607#60", 1); /* in the middle of segments */
    ck_assert_int_eq(mcanOpenCancelSDO(0, waiting), MCANOPEN_OK);
    wait_for_ends(1);
    ck_assert_uint_eq(ends.list[0].result.number, waiting);
    ck_assert_int_eq(mcanOpenCancelSDO(0, running), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenCancelSDO(0, running), MCAL_NO_EVENT);
    wait_for_ends(3);
    ck_assert_uint_eq(ends.list[1].result.number, running);
    ck_assert_int_eq(ends.list[1].result.result, MCAL_SDO_CANCELLED);
    ck_assert_ptr_null(ends.list[1].result.data);
    ck_assert_uint_eq(ends.list[2].result.number, last);
    ck_assert_int_eq(ends.list[2].result.result, MCANOPEN_OK);
    ck_assert_int_eq(ends.list[2].data[0], 9);
    ck_assert_int_eq(mcanOpenCancelSDO(0, last), MCAL_NO_EVENT);
    ck_assert_uint_eq(api_wire_count(wire, "607#80002000"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "607#40022000"), 0);
}
END_TEST

/* --- what done may do --- */

static int results[4];

static void ask_again(void *context, const SDO_RESULT_T *result)
{
    unsigned *left = context;
    SDO_REQUEST_T request = reading(5, 0x2001, 1);
    EVENT_T event;
    char buffer[4];
    int len = sizeof buffer;

    results[0] = mcanOpenReadSDO(0, 5, 0x2001, 0, buffer, &len, NULL);
    results[1] = mcanOpenEvent(&event, 1);
    results[2] = mcanOpenShutDown();
    request.done = ask_again;
    request.context = left;
    if (*left > 0 && --*left > 0)
        results[3] = mcanOpenReadSDOAsync(&request, NULL);
    else
        note_end(NULL, result);
}

START_TEST(done_may_ask_again_but_not_wait)
{
    const MCANOPEN_SDO_DONE_T done = ask_again;
    SDO_REQUEST_T request = reading(5, 0x2001, 1);
    unsigned left = 20;

    boot();
    request.done = done;
    request.context = &left;
    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    wait_for_ends(1);
    ck_assert_int_eq(ends.list[0].result.result, MCANOPEN_OK);
    for (int i = 0; i < 3; i++)
        ck_assert_int_eq(results[i], MCAL_UNSUPPORTED);
    ck_assert_int_eq(results[3], MCANOPEN_OK);
    ck_assert_uint_eq(left, 0);
}
END_TEST

/* Without an end: shut down has one. */
static void ask_for_ever(void *context, const SDO_RESULT_T *result)
{
    SDO_REQUEST_T request = reading(5, 0x2001, 1);

    request.done = ask_for_ever;
    if (result->result != MCANOPEN_OK || mcanOpenReadSDOAsync(&request, NULL) != MCANOPEN_OK)
        note_end(context, result);
}

START_TEST(shut_down_ends_one_that_asks_for_ever)
{
    SDO_REQUEST_T request = reading(5, 0x2001, 1);

    boot();
    request.done = ask_for_ever;
    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    api_wire_wait(wire, "605#40012000", 20);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, 1);
}
END_TEST

/* --- a slow one --- */

static bool may_go_on;

static void wait_until_allowed(void *context, const SDO_RESULT_T *result)
{
    note_end(context, result);
    lock_take(&ends.lock);
    while (!may_go_on)
        condition_wait(&ends.changed, &ends.lock, CO_NEVER);
    lock_give(&ends.lock);
}

static void let_go_on(void)
{
    lock_take(&ends.lock);
    may_go_on = true;
    condition_signal(&ends.changed);
    lock_give(&ends.lock);
}

/* Transfers that others wait for take no room from the lines of the log. */
START_TEST(a_slow_one_loses_no_line_of_the_log)
{
    SDO_REQUEST_T request = reading(5, 0x2001, 1);
    char value;
    int len = 1;

    boot();
    may_go_on = false;
    request.done = wait_until_allowed;
    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    read_async(7, 0x2000, 4);
    wait_for_ends(1);
    for (unsigned i = 0; i <= CONTROL_LOG_EVENTS; i++)
        ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2001, 0, &value, &len, NULL), MCANOPEN_OK);
    let_go_on();
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, 2);
    ck_assert_uint_eq(api_log_count(plant, "messages lost"), 0);
}
END_TEST

/* --- the bus goes away --- */

START_TEST(requests_end_when_the_bus_is_lost)
{
    const struct bus_message message = { NULL, 0 };
    struct segment segment;

    boot();
    for (unsigned i = 0; i < 20; i++)
        read_async(7, 0x2000, 4);
    ck_assert_int_eq(segment_open(&segment, plant->bus + strlen("virtual:"), 0, &message), CO_OK);
    while (segment_lock(&segment, SEGMENT_HOLD_LIMIT) != CO_OK)
        continue;
    ck_assert_int_eq(mcanOpenEnterPreop(0, 5), MCANOPEN_OK); /* so that the loss is seen */
    wait_for_ends(20);
    for (unsigned i = 0; i < 20; i++)
        ck_assert_int_eq(ends.list[i].result.result, MCAL_CAN_TX_ERROR);
    read_async(5, 0x2001, 4);
    wait_for_ends(21);
    ck_assert_int_eq(ends.list[20].result.result, MCAL_CAN_TX_ERROR);
    segment_unlock(&segment);
    segment_close(&segment);
}
END_TEST

static int wait_for_bus_state(void)
{
    return api_wait_event(API_EVENT(PARA_I, MCANOPEN_MSG_BUS_STATE), -1).para.i;
}

/* Not what is the matter with it when the end is told at last. */
START_TEST(an_end_tells_of_the_bus_as_it_was)
{
    const struct bus_message message = { NULL, 0 };
    SDO_REQUEST_T request = reading(5, 0x2001, 1);
    struct segment segment;

    boot();
    may_go_on = false;
    request.done = wait_until_allowed;
    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    wait_for_ends(1);
    read_async(7, 0x2000, 4);
    ck_assert_int_eq(segment_open(&segment, plant->bus + strlen("virtual:"), 0, &message), CO_OK);
    while (segment_lock(&segment, SEGMENT_HOLD_LIMIT) != CO_OK)
        continue;
    ck_assert_int_eq(mcanOpenEnterPreop(0, 5), MCANOPEN_OK);
    ck_assert_int_eq(wait_for_bus_state(), MCANOPEN_BUS_DOWN);
    segment_unlock(&segment);
    ck_assert_int_eq(wait_for_bus_state(), MCANOPEN_BUS_ACTIVE);
    let_go_on();
    wait_for_ends(2);
    ck_assert_int_eq(ends.list[1].result.result, MCAL_CAN_TX_ERROR);
    segment_close(&segment);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("sdo_async");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, what_is_read_is_told);
    tcase_add_loop_test(tests, what_was_written_is_there, 0, 2);
    tcase_add_loop_test(tests, what_has_failed_is_told, 0, ROWS(bad));
    tcase_add_loop_test(tests, wrong_requests_are_refused, 0, ROWS(wrong));
    tcase_add_test(tests, not_now_and_not_so);
    tcase_add_test(tests, there_is_an_end_of_room_and_room_again);
    tcase_add_loop_test(tests, shut_down_ends_all, 0, 2);
    tcase_add_test(tests, shut_down_amid_requests);
    tcase_add_test(tests, each_end_has_its_own_data);
    tcase_add_test(tests, a_request_is_cancelled);
    tcase_add_test(tests, done_may_ask_again_but_not_wait);
    tcase_add_test(tests, shut_down_ends_one_that_asks_for_ever);
    tcase_add_test(tests, a_slow_one_loses_no_line_of_the_log);
    tcase_add_test(tests, requests_end_when_the_bus_is_lost);
    tcase_add_test(tests, an_end_tells_of_the_bus_as_it_was);
    return suite_run("api_sdo_async", tests);
}

/* SDO transfers of many threads at once, and answers that belong to none of them. */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#define NODES     4u
#define THREADS   6u
#define ROUNDS    15u
#define LARGE_MAX 900u

static struct api_plant *plant;
static struct api_wire *wire;
static struct {
    struct co_lock lock;
    struct co_condition changed;
    unsigned count;
    int result, len;
    unsigned char data[8];
} end;

/* Each thread has a number and a domain of its own in each of the nodes 5, 6, 7, 8. */
static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    for (uint8_t node = 5; node < 5 + NODES; node++) {
        api_add_device(plant, node);
        for (uint16_t i = 0; i < THREADS; i++) {
            api_add_number(plant, node, (uint16_t)(0x2000 + i), 4, 0);
            api_add_domain(plant, node, (uint16_t)(0x2100 + i), NULL, 0, LARGE_MAX);
        }
    }
    api_devices_start(plant);
    ck_assert_int_eq(lock_init(&end.lock), CO_OK);
    ck_assert_int_eq(condition_init(&end.changed), CO_OK);
    end.count = 0;
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
    condition_done(&end.changed);
    lock_done(&end.lock);
}

/* --- many threads --- */

struct worker {
    struct co_thread thread;
    unsigned number;
    unsigned wrong; /* calls that failed, and data of somebody else */
};

/* What nobody else writes anywhere, at any time. */
static void fill(char *data, size_t size, const struct worker *self, int node, unsigned round)
{
    for (size_t i = 0; i < size; i++)
        data[i] = (char)(self->number * 41 + (unsigned)node * 7 + round * 13 + i * (round % 5 + 1));
}

static void exchange(struct worker *self, int node, int index, size_t size, unsigned round)
{
    const int flag = round % 3 == 2 && size > 4 ? TYP_BLOCK : 0;
    char sent[LARGE_MAX], got[LARGE_MAX];
    int len = sizeof got;

    fill(sent, size, self, node, round);
    self->wrong += mcanOpenWriteSDO(0, (unsigned short)node, index, 0,
                                    (size > 4 ? TYP_DOMAIN : TYP_UINT32) | flag, sent, (int)size,
                                    NULL) != MCANOPEN_OK;
    self->wrong += mcanOpenReadSDO(0, (unsigned short)node, index, flag, got, &len, NULL) !=
                   MCANOPEN_OK;
    self->wrong += len != (int)size || memcmp(got, sent, size) != 0;
}

static void *work(void *context)
{
    struct worker *self = context;

    for (unsigned round = 0; round < ROUNDS; round++) {
        const int node = (int)(5 + (round + self->number) % NODES);

        exchange(self, node, (int)(0x2000 + self->number), 4, round);
        exchange(self, node, (int)(0x2100 + self->number), 5 + round * 8, round);
    }
    return NULL;
}

static atomic_uint told;

/* context: what the object must have been. */
static void count_right(void *context, const SDO_RESULT_T *result)
{
    const unsigned char value = (unsigned char)result->node;

    (void)context;
    if (result->result == MCANOPEN_OK && result->len == 4 &&
        ((const unsigned char *)result->data)[0] == 0x92 && value >= 5 && value < 5 + NODES)
        atomic_fetch_add(&told, 1);
}

/* Beside them, requests for which nobody waits. */
START_TEST(each_thread_gets_its_own_data)
{
    struct worker workers[THREADS] = { { .number = 0 } };
    const unsigned asked = 100;

    atomic_store(&told, 0);
    api_boot(plant, API_NODE(5) API_NODE(6) API_NODE(7)); /* 8 is not in the configuration */
    for (unsigned i = 0; i < THREADS; i++) {
        workers[i].number = i;
        ck_assert_int_eq(thread_start(&workers[i].thread, "worker", work, &workers[i]), CO_OK);
    }
    for (unsigned i = 0; i < asked; i++) {
        const SDO_REQUEST_T request = { .size = sizeof request,
                                        .node = (int)(5 + i % NODES),
                                        .index = 0x1000,
                                        .len = 4,
                                        .done = count_right };

        ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
    }
    for (unsigned i = 0; i < THREADS; i++) {
        thread_join(&workers[i].thread);
        ck_assert_uint_eq(workers[i].wrong, 0);
    }
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(atomic_load(&told), asked);
}
END_TEST

/* --- answers that belong to no transfer --- */

static void note_end(void *context, const SDO_RESULT_T *result)
{
    (void)context;
    lock_take(&end.lock);
    end.count++;
    end.result = result->result;
    end.len = result->len;
    if (result->data && result->len <= (int)sizeof end.data)
        memcpy(end.data, result->data, (size_t)result->len);
    condition_signal(&end.changed);
    lock_give(&end.lock);
}

static void ask(int index)
{
    const SDO_REQUEST_T request = {
        .size = sizeof request, .node = 9, .index = index, .len = 8, .done = note_end
    };

    ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
}

static void wait_for_ends(unsigned count)
{
    const co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;

    lock_take(&end.lock);
    while (end.count < count && err != CO_ERR_TIMEOUT)
        err = condition_wait(&end.changed, &end.lock, limit);
    lock_give(&end.lock);
    ck_assert_uint_ge(end.count, count);
}

/* While 2001h is asked for, before its answer and again behind it. */
static const char *const noises[] = {
    "589#4F00200077000000",      /* late: of the request before, which has timed out */
    "589#4100200008000000",      /* likewise, the beginning of segments */
    "589#6000200000000000",      /* late: the answer to a write */
    "589#8000200011000906",      /* late: an abort of another object */
    "588#4F01200077000000",      /* of another node */
    "58A#8001200011000906",      /* likewise */
    "609#4001200000000000",      /* somebody else's request to the same node */
    "589#4F012000",              /* too short */
    "00000589#4F01200077000000", /* an extended identifier */
    "589#R8",                    /* a remote frame */
};

START_TEST(answers_that_fit_no_request_change_nothing)
{
    api_boot(plant, API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<SDO_Timeout>100</SDO_Timeout>"));
    ask(0x2000);
    wait_for_ends(1);
    ck_assert_int_eq(end.result, MCAL_CAN_RX_TIMEOUT);
    ask(0x2001);
    api_wire_wait(wire, "609#40012000", 1);
    api_wire_say(wire, noises[_i]);
    api_wire_say(wire, "589#4F01200011000000");
    wait_for_ends(2);
    ck_assert_int_eq(end.result, MCANOPEN_OK);
    ck_assert_int_eq(end.len, 1);
    ck_assert_uint_eq(end.data[0], 0x11);
    api_wire_say(wire, "589#4F01200012000000"); /* a duplicate, to nobody */
    api_wire_say(wire, noises[_i]);
    ask(0x2002);
    api_wire_wait(wire, "609#40022000", 1);
    api_wire_say(wire, "589#4F01200013000000"); /* a duplicate, within the next */
    api_wire_say(wire, "589#4F02200022000000");
    wait_for_ends(3);
    ck_assert_int_eq(end.result, MCANOPEN_OK);
    ck_assert_uint_eq(end.data[0], 0x22);
}
END_TEST

/* The second one's time begins when the first one's is over. */
START_TEST(time_begins_with_the_turn)
{
    co_us_t start;

    api_boot(plant, API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<SDO_Timeout>150</SDO_Timeout>"));
    start = clock_now();
    ask(0x2000);
    ask(0x2001);
    wait_for_ends(1);
    api_wire_wait(wire, "609#40012000", 1);
    ck_assert_uint_ge(clock_now() - start, CO_MS(150));
    wait_for_ends(2);
    ck_assert_uint_ge(clock_now() - start, CO_MS(300));
    ck_assert_int_eq(end.result, MCAL_CAN_RX_TIMEOUT);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("sdo_many");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, each_thread_gets_its_own_data);
    tcase_add_loop_test(tests, answers_that_fit_no_request_change_nothing, 0, ROWS(noises));
    tcase_add_test(tests, time_begins_with_the_turn);
    return suite_run("api_sdo_many", tests);
}

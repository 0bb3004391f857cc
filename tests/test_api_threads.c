/* Calls from several threads, two networks, priorities, and threads that the system refuses. */
#include "port/bus_segment.h"
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <dlfcn.h>
#include <errno.h>
#include <linux/capability.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#define THREADS 4u
#define CROWD   32u
#define READS   50u
#define TEXT    "a text that needs more than one segment"

static struct api_plant *plant;
static struct api_wire *wire;

/* --- pthread_create, as a system short of threads has it --- */

static _Atomic int creations_left = -1; /* -1: no limit */

int pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                   void *context)
{
    int (*next)(pthread_t *, const pthread_attr_t *, void *(*)(void *), void *);
    void *symbol = dlsym(RTLD_NEXT, "pthread_create");

    if (atomic_load(&creations_left) == 0)
        return EAGAIN;
    if (atomic_load(&creations_left) > 0)
        atomic_fetch_sub(&creations_left, 1);
    memcpy(&next, &symbol, sizeof next);
    return next(thread, attributes, run, context);
}

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    for (uint8_t node = 5; node < 5 + THREADS; node++) {
        api_add_device(plant, node);
        api_add_domain(plant, node, 0x2010, TEXT, sizeof TEXT - 1, 100);
    }
    api_devices_start(plant);
}

static void tear_down(void)
{
    atomic_store(&creations_left, -1);
    api_plant_free(plant);
    api_wire_close(wire);
}

/* --- parallel transfers --- */

struct reader {
    struct co_thread thread;
    unsigned short node;
    unsigned count; /* reads to do; 0: until one fails */
    int result;     /* of the last one */
    _Atomic unsigned done;
    co_us_t end;
};

static void *read_often(void *context)
{
    struct reader *self = context;

    do {
        char buffer[100] = "";
        int len = sizeof buffer;

        self->result = mcanOpenReadSDO(0, self->node, 0x2010, 0, buffer, &len, NULL);
        if (self->result == MCANOPEN_OK && strcmp(buffer, TEXT) != 0)
            self->result = -1000;
        atomic_fetch_add(&self->done, 1);
    } while (self->result == MCANOPEN_OK && atomic_load(&self->done) != self->count);
    self->end = clock_now();
    return NULL;
}

static void readers_start(struct reader *readers, bool one_node, unsigned count)
{
    memset(readers, 0, THREADS * sizeof *readers);
    for (unsigned i = 0; i < THREADS; i++) {
        readers[i].node = (unsigned short)(one_node ? 5 : 5 + i);
        readers[i].count = count;
        ck_assert_int_eq(thread_start(&readers[i].thread, "reader", read_often, &readers[i]),
                         CO_OK);
    }
}

/* To one node they come in turn, to several side by side. */
START_TEST(many_threads_read)
{
    const unsigned expected = _i == 0 ? THREADS * READS : READS;
    struct reader readers[THREADS];

    api_boot(plant, API_NODE(5) API_NODE(6));
    readers_start(readers, _i == 0, READS);
    for (unsigned i = 0; i < THREADS; i++) {
        thread_join(&readers[i].thread);
        ck_assert_int_eq(readers[i].result, MCANOPEN_OK);
    }
    api_wire_wait(wire, "605#401020", expected);
    ck_assert_uint_eq(api_wire_count(wire, "605#401020"), expected);
}
END_TEST

START_TEST(all_kinds_of_calls_at_once)
{
    struct reader readers[THREADS];
    BOOT_RECORD_T record = { .size = sizeof record };
    EVENT_T event;
    int state;

    api_boot(plant, API_NODE(5) API_NODE(6));
    readers_start(readers, false, READS);
    for (unsigned i = 0; i < 200; i++) {
        ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
        ck_assert_int_eq(mcanOpenGetBootRecord(0, 6, &record), MCANOPEN_OK);
        ck_assert_int_eq(i % 2 ? mcanOpenStartNode(0, 6) : mcanOpenEnterPreop(0, 6), MCANOPEN_OK);
        mcanOpenEvent(&event, 0);
    }
    for (unsigned i = 0; i < THREADS; i++) {
        thread_join(&readers[i].thread);
        ck_assert_int_eq(readers[i].result, MCANOPEN_OK);
    }
}
END_TEST

/* Node 9 is not there and has a long time-out: one call is under way, the others queue. */
START_TEST(shut_down_ends_calls_that_wait)
{
    struct reader readers[THREADS];
    co_us_t start;

    api_boot(plant, API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<SDO_Timeout>60000</SDO_Timeout>"));
    memset(readers, 0, sizeof readers);
    for (unsigned i = 0; i < THREADS; i++) {
        readers[i].node = 9;
        ck_assert_int_eq(thread_start(&readers[i].thread, "reader", read_often, &readers[i]),
                         CO_OK);
    }
    api_wire_wait(wire, "609#40", 1);
    start = clock_now();
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    for (unsigned i = 0; i < THREADS; i++) {
        thread_join(&readers[i].thread);
        ck_assert_int_eq(readers[i].result, MCAL_NO_NET);
        ck_assert_uint_lt(readers[i].end, start + CO_MS(1500)); /* 100 ms; a busy machine */
    }
    ck_assert_uint_eq(api_wire_count(wire, "609#40"), 1);
}
END_TEST

START_TEST(shut_down_amid_running_transfers)
{
    struct reader readers[THREADS];

    api_boot(plant, API_NODE(5) API_NODE(6));
    readers_start(readers, false, 0);
    for (unsigned i = 0; i < THREADS; i++)
        while (atomic_load(&readers[i].done) < 5)
            sched_yield();
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    for (unsigned i = 0; i < THREADS; i++) {
        thread_join(&readers[i].thread);
        ck_assert(readers[i].result == MCAL_NO_NET || readers[i].result == MCAL_SYS_ERROR);
    }
}
END_TEST

/* Far more callers than nodes: some are sending, some wait for an answer, most for their turn. */
START_TEST(shut_down_amid_a_crowd)
{
    struct reader readers[CROWD];

    api_boot(plant, API_NODE(5) API_NODE(6));
    for (unsigned i = 0; i < CROWD / THREADS; i++)
        readers_start(&readers[i * THREADS], false, 0);
    for (unsigned i = 0; i < CROWD; i++)
        while (atomic_load(&readers[i].done) < 5)
            sched_yield();
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    for (unsigned i = 0; i < CROWD; i++) {
        thread_join(&readers[i].thread);
        ck_assert(readers[i].result == MCAL_NO_NET || readers[i].result == MCAL_SYS_ERROR);
    }
}
END_TEST

static void *start_up(void *context)
{
    (void)context;
    mcanOpenStart();
    return NULL;
}

START_TEST(shut_down_ends_a_start_that_waits)
{
    struct co_thread thread;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Wait_For_Startup>TRUE</Wait_For_Startup>" API_NODE_WITH(
                                           9, "<SDO_Timeout>60000</SDO_Timeout>")),
                     MCANOPEN_OK);
    ck_assert_int_eq(thread_start(&thread, "start", start_up, NULL), CO_OK);
    api_wire_wait(wire, "609#40", 1);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    thread_join(&thread);
}
END_TEST

static void *live(void *context)
{
    int *ok = context;

    for (int i = 0; i < 20; i++) {
        *ok += mcanOpenInitialize() == MCANOPEN_OK;
        mcanOpenShutDown();
        mcanOpenStart();
        mcanOpenCleanup();
    }
    return NULL;
}

/* Whatever comes of it: one at a time, and no state that another call does not leave. */
START_TEST(lives_in_several_threads)
{
    struct co_thread threads[2];
    int ok[3] = { 0 };

    ck_assert_ptr_nonnull(freopen("/dev/null", "w", stderr)); /* cleanup takes the hook away */
    for (unsigned i = 0; i < 2; i++)
        ck_assert_int_eq(thread_start(&threads[i], "lives", live, &ok[i]), CO_OK);
    live(&ok[2]);
    for (unsigned i = 0; i < 2; i++)
        thread_join(&threads[i]);
    ck_assert_int_gt(ok[0] + ok[1] + ok[2], 0);
    mcanOpenCleanup();
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
}
END_TEST

/* --- two networks --- */

START_TEST(two_networks_in_one_process)
{
    struct api_plant *second = api_plant_new();
    char text[4000], buffer[8];
    int length, len = sizeof buffer, state;

    api_add_device(second, 5);
    api_add_number(second, 5, 0x2001, 1, 0x22);
    api_devices_start(second);
    length = snprintf(text, sizeof text, "<CANopen_Manager>%s",
                      api_network(plant, 3, API_NODE(5) API_NODE(6)));
    snprintf(text + length, sizeof text - (size_t)length, "%s</CANopen_Manager>",
             api_network(second, 200, API_NODE(5)));
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(api_config_text(plant, text) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
    api_wait_state(3, 5, MCANOPEN_STATE_OPERATIONAL);
    api_wait_state(200, 5, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenReadSDO(3, 5, 0x2001, 0, buffer, &len, NULL), MCAL_ABORT_DOMAIN);
    ck_assert_int_eq(mcanOpenReadSDO(200, 5, 0x2001, 0, buffer, &len, NULL), MCANOPEN_OK);
    ck_assert_int_eq(buffer[0], 0x22);
    ck_assert_int_eq(mcanOpenStopNode(200, 5), MCANOPEN_OK);
    api_wait_state(200, 5, MCANOPEN_STATE_STOPPED);
    ck_assert_int_eq(mcanOpenGetNodeState(3, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCAL_NO_NET);
    snprintf(text, sizeof text, "%s: node 5: booted", second->bus);
    api_wait_log(second, text); /* its hook is the last one set */
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    api_plant_free(second);
}
END_TEST

/* --- the bus goes away --- */

START_TEST(a_bus_that_is_down)
{
    const struct bus_message message = { NULL, 0 };
    struct segment segment;
    char buffer[100];
    int len = sizeof buffer;
    co_us_t start;
    EVENT_T event;

    api_boot(plant, API_NODE(5));
    ck_assert_int_eq(segment_open(&segment, plant->bus + strlen("virtual:"), 0, &message), CO_OK);
    while (segment_lock(&segment, SEGMENT_HOLD_LIMIT) != CO_OK)
        continue;
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCAL_CAN_TX_ERROR);
    event = api_wait_event(API_EVENT(PARA_I, MCANOPEN_MSG_BUS_STATE), -1);
    ck_assert_int_eq(event.para.i, MCANOPEN_BUS_DOWN);
    ck_assert_int_eq(mcanOpenStopNode(0, 5), MCAL_CAN_TX_ERROR);
    start = clock_now();
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCAL_CAN_TX_ERROR);
    ck_assert_uint_lt(clock_now(), start + CO_MS(1500)); /* at once */
    segment_unlock(&segment);
    segment_close(&segment);
    event = api_wait_event(API_EVENT(PARA_I, MCANOPEN_MSG_BUS_STATE), -1);
    ck_assert_int_eq(event.para.i, MCANOPEN_BUS_ACTIVE);
    api_wait_event(API_NETWORK_UP, -1); /* all is begun anew */
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x2010, 0, buffer, &len, NULL), MCANOPEN_OK);
    api_wait_log(plant, "1 bus is down: virtual bus ");
    api_wait_log(plant, "frames given up");
}
END_TEST

/* --- what the system refuses --- */

static void give_up_rights(void)
{
    struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3 };
    struct __user_cap_data_struct data[2] = { { 0 } };
    const struct rlimit none = { 0, 0 };

    ck_assert_int_eq(setrlimit(RLIMIT_RTPRIO, &none), 0);
    ck_assert_int_eq((int)syscall(SYS_capget, &header, data), 0);
    data[0].effective &= ~(1u << CAP_SYS_NICE);
    ck_assert_int_eq((int)syscall(SYS_capset, &header, data), 0);
}

#define PRIORITIES "<Manager_Thread_Priorities>3:4:5</Manager_Thread_Priorities>"

START_TEST(priorities_without_the_right_are_one_warning)
{
    struct api_plant *second = api_plant_new();
    char text[4000];
    int length = snprintf(text, sizeof text, "<CANopen_Manager>%s",
                          api_network(plant, 0, PRIORITIES API_NODE(5)));

    snprintf(text + length, sizeof text - (size_t)length, "%s</CANopen_Manager>",
             api_network(second, 1, PRIORITIES API_NODE(5)));
    give_up_rights();
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(api_config_text(plant, text) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
    ck_assert_uint_eq(api_log_count(second, "1 no right to set thread priorities"), 1);
    api_wait_state(0, 5, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    api_plant_free(second);
}
END_TEST

START_TEST(without_threads_start_shuts_down)
{
    int state;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    atomic_store(&creations_left, _i); /* none; the daemon's only */
    mcanOpenStart();
    atomic_store(&creations_left, -1);
    ck_assert_uint_eq(api_log_count(plant, "0 mcanOpenStart: no memory for the threads"), 1);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenShutDown(), MCAL_SYS_ERROR);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_NETWORK_UP, -1);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("threads");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, many_threads_read, 0, 2);
    tcase_add_test(tests, all_kinds_of_calls_at_once);
    tcase_add_test(tests, shut_down_ends_calls_that_wait);
    tcase_add_test(tests, shut_down_amid_running_transfers);
    tcase_add_test(tests, shut_down_amid_a_crowd);
    tcase_add_test(tests, shut_down_ends_a_start_that_waits);
    tcase_add_test(tests, lives_in_several_threads);
    tcase_add_test(tests, two_networks_in_one_process);
    tcase_add_test(tests, a_bus_that_is_down);
    tcase_add_test(tests, priorities_without_the_right_are_one_warning);
    tcase_add_loop_test(tests, without_threads_start_shuts_down, 0, 2);
    return suite_run("api_threads", tests);
}

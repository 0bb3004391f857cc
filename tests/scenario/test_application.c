/*
 * The application's SDO requests while the network boots and runs; emergencies; frames that mean
 * nothing.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define REQUESTS 20u

static struct sdo_request requests[REQUESTS];
static uint8_t buffers[REQUESTS][8];
static unsigned done;

static void on_event(struct plant *plant, const struct co_event *event)
{
    (void)plant;
    done += event->type == MANAGER_REQUEST_DONE;
}

static struct plant *make_plant(const char *network)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "%s" PLANT_NODE(5, "") PLANT_NODE(6, ""), network);
    plant = plant_new(xml, 1000000);
    for (uint8_t node = 5; node <= 7; node++) /* 7 is in no file */
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant->on_event = on_event;
    watch_start(plant);
    memset(requests, 0, sizeof requests);
    done = 0;
    return plant;
}

static struct plant *run_plant(const char *network)
{
    struct plant *plant = make_plant(network);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

/* Reads 1018h of a node. */
static void read_identity(struct plant *plant, unsigned i, uint8_t node, uint8_t sub)
{
    requests[i].transfer = (struct sdo_transfer){
        .index = 0x1018, .sub = sub, .buffer = buffers[i], .size = 8, .timeout = CO_MS(100)
    };
    manager_submit(plant->manager, node, &requests[i], plant->sim.now, &plant->manager_device->box);
}

static void cancel(struct plant *plant, unsigned i, uint8_t node)
{
    manager_cancel(plant->manager, node, &requests[i], plant->sim.now, &plant->manager_device->box);
}

static void expect_read(unsigned i, uint8_t value)
{
    ck_assert_int_eq(requests[i].state, REQUEST_DONE);
    ck_assert_uint_eq(requests[i].result.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(buffers[i][0], value);
}

/* From the first moment on, in all of the boot: each has its answer, and the boot goes on. */
START_TEST(test_in_parallel)
{
    struct plant *plant = make_plant("");

    plant_power_on(plant);
    for (unsigned i = 0; i < REQUESTS; i++)
        read_identity(plant, i, (uint8_t)(5 + i % 3), 4);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    for (unsigned i = 0; i < REQUESTS; i++)
        expect_read(i, (uint8_t)(5 + i % 3));
    ck_assert_uint_eq(done, REQUESTS);
    plant_free(plant);
}
END_TEST

/* At each frame of the boot one more. */
static enum sim_fate ask_at(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    unsigned *left = plant->fault_context;

    (void)sender;
    (void)frame;
    if ((*left)-- == 0)
        read_identity(plant, 0, 5, 4);
    return SIM_DELIVER;
}

START_TEST(test_at_each_frame)
{
    for (unsigned n = 0; n < 12; n++) {
        struct plant *plant = make_plant("");
        unsigned left = n;

        plant_power_on(plant);
        plant->fault = ask_at;
        plant->fault_context = &left;
        plant_run_ms(plant, 1000);
        watch_expect_up(plant, "is not up");
        expect_read(0, 5);
        ck_assert_uint_eq(done, 1);
        plant_free(plant);
    }
}
END_TEST

/* One that waits, one that runs, one that is over; what is cancelled ends without a word. */
START_TEST(test_cancel)
{
    struct plant *plant = run_plant("");

    for (unsigned i = 0; i < 3; i++)
        read_identity(plant, i, 5, 4);
    cancel(plant, 1, 5);
    ck_assert_int_eq(requests[1].state, REQUEST_IDLE);
    cancel(plant, 0, 5);
    ck_assert_int_eq(requests[0].state, REQUEST_IDLE);
    plant_run_ms(plant, 10);
    expect_read(2, 5);
    ck_assert_uint_eq(done, 1);
    cancel(plant, 2, 5);
    expect_read(2, 5);
    read_identity(plant, 0, 5, 1);
    plant_run_ms(plant, 10);
    expect_read(0, 0x9A);
    ck_assert_uint_eq(done, 2);
    plant_free(plant);
}
END_TEST

/* The node dies: each request has its own time, from when its turn has come. */
START_TEST(test_time_out)
{
    struct plant *plant = run_plant("");
    co_us_t begin;

    plant_power(plant, 7, false);
    begin = plant->sim.now;
    read_identity(plant, 0, 7, 1);
    read_identity(plant, 1, 7, 1);
    sim_run(&plant->sim, begin + CO_MS(100));
    ck_assert_int_eq(requests[0].state, REQUEST_RUNNING);
    plant_run_ms(plant, 1);
    ck_assert_int_eq(requests[0].state, REQUEST_DONE);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_NO_ANSWER);
    plant_run_ms(plant, 98);
    ck_assert_int_eq(requests[1].state, REQUEST_RUNNING);
    plant_run_ms(plant, 3);
    ck_assert_int_eq(requests[1].state, REQUEST_DONE);
    ck_assert_uint_eq(plant_sent(plant, "607#8018100100000405"), 2);
    plant_free(plant);
}
END_TEST

/* The node restarts: the request of the application goes on and ends, the boot gets its turn. */
START_TEST(test_node_restarts)
{
    struct plant *plant = run_plant("");

    plant_lie(plant, "605#4018", NULL, 1);
    read_identity(plant, 0, 5, 4);
    plant_run_ms(plant, 10);
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_int_eq(requests[0].state, REQUEST_DONE);
    ck_assert_uint_eq(done, 1);
    plant_free(plant);
}
END_TEST

/* --- emergencies --- */

START_TEST(test_emergency)
{
    struct plant *plant = run_plant(
        _i ? "<Preset_Emergency_Consumer>TRUE</Preset_Emergency_Consumer>" : "");

    sim_say(&plant->sim, "085#1023020102030405");
    sim_say(&plant->sim, "087#0050010000000000");
    sim_say(&plant->sim, "086#0000000000000000");
    sim_say(&plant->sim, "0A0#0010010000000000");
    plant_run_ms(plant, 10);
    ck_assert(plant_said(plant, "warning: node 5: emergency 2310h, current, device output side, "
                                "error register 02h, field 01 02 03 04 05"));
    ck_assert(plant_said(plant, "node 6: emergency 0000h"));
    ck_assert_int_eq(plant_said(plant, "node 7: emergency 5000h"), _i);
    ck_assert_int_eq(plant_said(plant, "node 32: emergency 1000h"), _i);
    plant_free(plant);
}
END_TEST

/* --- garbage --- */

static const char *const garbage[] = {
    "585#",
    "585#43",
    "585#4300100092010200",
    "585#6000620100000000",

    "585#00",
    "585#FFFFFFFFFFFFFFFF",
    "600#4000100000000000",
    "580#4300100092010200",
    "605#4000100000000000",
    "67F#4000100000000000",
    "5FF#4300100000000000",
    "705#",
    "705#R1",
    "705#7F7F7F",
    "705#FF",
    "700#00",
    "77F#00",
    "07F#00",
    "080#",
    "085#",
    "085#102302",
    "100#000000000000",
    "185#0102030405060708",
    "7E5#0400000000000000",
    "00000605#4000100000000000",
    "00000705#00",
    "00000000#0100",
    "18FF0005#0102030405060708",
    "000#",
    "000#01",
    "000#R2",
    "000#FF05",
    "000#010203",
    "585#R8",
    "7FF#0011223344556677",
};

/* At each frame of a boot, one of these. */
static enum sim_fate add_garbage(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    unsigned *next = plant->fault_context;

    (void)frame;
    if (sender != 0)
        sim_say(&plant->sim, garbage[(*next)++ % (sizeof garbage / sizeof garbage[0])]);
    return SIM_DELIVER;
}

START_TEST(test_garbage)
{
    struct plant *plant = make_plant("");
    unsigned next = (unsigned)_i;

    plant_power_on(plant);
    plant->fault = add_garbage;
    plant->fault_context = &next;
    plant_run_ms(plant, 3000);
    plant->fault = NULL;
    plant_run_ms(plant, 5000);
    watch_expect_up(plant, "is not up");
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("application");

    tcase_add_test(tcase, test_in_parallel);
    tcase_add_test(tcase, test_at_each_frame);
    tcase_add_test(tcase, test_cancel);
    tcase_add_test(tcase, test_time_out);
    tcase_add_test(tcase, test_node_restarts);
    tcase_add_loop_test(tcase, test_emergency, 0, 2);
    tcase_add_loop_test(tcase, test_garbage, 0, sizeof garbage / sizeof garbage[0]);
    return suite_run("application", tcase);
}

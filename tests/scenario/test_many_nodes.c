/*
 * 126 nodes boot at once: how many frames that takes, and what a slow bus does to it.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODES   126u
#define ENTRIES 20u

static char *make_xml(const char *network, const char *node)
{
    char *xml = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&xml, &size);

    ck_assert_ptr_nonnull(stream);
    fputs(network, stream);
    for (unsigned id = 1; id <= NODES; id++)
        fprintf(stream, "<Node_Instance><Node_Id>%u</Node_Id>%s</Node_Instance>", id, node);
    fclose(stream);
    return xml;
}

static struct plant *make_plant(unsigned bitrate, const char *network, const char *node,
                                unsigned heartbeat)
{
    char *xml = make_xml(network, node);
    struct plant *plant = plant_new(xml, bitrate);

    free(xml);
    for (uint8_t id = 1; id <= NODES; id++) {
        struct plant_device *device = plant_add_device(plant, id);

        for (uint8_t i = 1; i < ENTRIES; i++) {
            plant_add_object(device, 0x6200, i, 4, 0);
            plant_configure(plant, id, 0x6200, i, 4, 0x01000000u * i + id);
        }
        plant_configure(plant, id, 0x1017, 0, 2, heartbeat);
    }
    watch_start(plant);
    plant_power_on(plant);
    return plant;
}

static bool is_sdo(const struct co_frame *frame)
{
    return frame->id >= 0x580 && frame->id < 0x680;
}

/* Share of the time between the first and the last SDO frame that the bus was busy, in percent. */
static unsigned busy_percent(const struct plant *plant)
{
    co_us_t begin = 0, end = 0, busy = 0, busy_at_end = 0;

    for (size_t i = 0; i < plant->sim.trace_count; i++) {
        const struct sim_line *line = &plant->sim.trace[i];
        co_us_t time = sim_frame_time(&plant->sim, &line->frame);

        if (!begin && is_sdo(&line->frame))
            begin = line->time - time;
        if (begin)
            busy += time;
        if (is_sdo(&line->frame)) {
            end = line->time;
            busy_at_end = busy;
        }
    }
    return (unsigned)(busy_at_end * 100 / (end - begin));
}

static int compare_frames(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct co_frame));
}

/* No request, and no answer, is there twice. */
static void expect_no_repeats(const struct plant *plant)
{
    size_t count = plant->sim.trace_count;
    struct co_frame *frames = calloc(count, sizeof *frames);

    for (size_t i = 0; i < count; i++) {
        frames[i] = plant->sim.trace[i].frame;
        frames[i].tag = 0;
    }
    qsort(frames, count, sizeof *frames, compare_frames);
    for (size_t i = 1; i < count; i++) {
        char text[CO_FRAME_TEXT_SIZE];

        ck_assert_msg(!co_frame_equal(&frames[i - 1], &frames[i]), "twice: %s",
                      co_frame_format(&frames[i], text, sizeof text));
    }
    free(frames);
}

START_TEST(test_no_frame_too_many)
{
    static const char identity[] = "<Vendor_Identification>0x29A</Vendor_Identification>"
                                   "<Product_Code>1</Product_Code>"
                                   "<Consumer_Heartbeat_Time>30000</Consumer_Heartbeat_Time>";
    struct plant *plant = make_plant(1000000, "", identity, 20000);
    size_t each = 2 + 2 * 2 + 2 * ENTRIES + 1 + 1 + 1;

    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant->sim.trace_count, NODES * each + 1 + 1); /* own boot-up, reset all */
    expect_no_repeats(plant);
    ck_assert_uint_ge(busy_percent(plant), 97);
    ck_assert_uint_eq(plant->manager->dropped, 0);
    ck_assert(plant_said(plant, "network is up: 126 of 126 nodes booted"));
    plant_free(plant);
}
END_TEST

static const unsigned answer_times[] = { 100, 1000, 5000, 10000 }; /* us */

static enum sim_fate answer_later(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    const unsigned *time = plant->fault_context;

    (void)sender;
    if (frame->id > SDO_REQUEST_ID && frame->id <= SDO_REQUEST_ID + NODES)
        plant->devices[frame->id - SDO_REQUEST_ID]->sim->hold_until = plant->sim.now + *time;
    return SIM_DELIVER;
}

/* Devices that take their time: others are asked meanwhile, and nobody waits for the last ones. */
START_TEST(test_bus_is_kept_busy)
{
    unsigned time = answer_times[_i];
    struct plant *plant = make_plant(1000000, "", "", 20000);

    plant->fault = answer_later;
    plant->fault_context = &time;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_ge(busy_percent(plant), 97);
    plant_free(plant);
}
END_TEST

/* All of them absent: each is told once, and nobody gets in the other's way. */
START_TEST(test_all_absent)
{
    struct plant *plant = make_plant(1000000, "", "", 20000);

    for (uint8_t id = 1; id <= NODES; id++)
        plant_power(plant, id, false);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_said_times(plant, "boot error B"), NODES);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    for (uint8_t id = 1; id <= NODES; id++)
        plant_power(plant, id, true);
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

static const char *first_error(struct plant *plant)
{
    char *error = strstr(plant->events, "error");

    if (error && strlen(error) > 400)
        error[400] = '\0';
    return error ? error : "";
}

static const struct slow {
    unsigned bitrate, seconds, heartbeat;
    const char *node;
} slow[] = {
    { 125000, 20, 20000, "" },
    { 125000, 20, 2000, "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>" },
    { 125000, 20, 1000, "<Consumer_Heartbeat_Time>2500</Consumer_Heartbeat_Time>" },
    { 50000, 40, 20000, "" },
    { 20000, 80, 20000, "" },
    { 20000, 80, 5000, "<Consumer_Heartbeat_Time>12000</Consumer_Heartbeat_Time>" },
    { 10000, 150, 20000, "" },
};

/* SDO_Timeout is 200 ms, and no answer takes longer; requests that wait for the bus are patient. */
START_TEST(test_slow_bus)
{
    const struct slow *row = &slow[_i];
    struct plant *plant = make_plant(row->bitrate, "", row->node, row->heartbeat);

    snprintf(plant->name, sizeof plant->name, "%u bit/s", row->bitrate);
    for (unsigned s = 0; s < row->seconds && !manager_is_up(plant->manager, true); s++)
        plant_run_ms(plant, 1000);
    plant_run_ms(plant, 2000); /* the start commands are still on their way */
    ck_assert_msg(!plant_said(plant, "error"), "%s\n%s", plant->name, first_error(plant));
    watch_expect_up(plant, "is not up");
    for (size_t i = 0; i < plant->sim.trace_count; i++)
        ck_assert(!is_sdo(&plant->sim.trace[i].frame) || plant->sim.trace[i].frame.data[0] != 0x80);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("many_nodes");

    tcase_set_timeout(tcase, 100);
    tcase_add_test(tcase, test_no_frame_too_many);
    tcase_add_loop_test(tcase, test_bus_is_kept_busy, 0,
                        sizeof answer_times / sizeof answer_times[0]);
    tcase_add_test(tcase, test_all_absent);
    tcase_add_loop_test(tcase, test_slow_bus, 0, sizeof slow / sizeof slow[0]);
    return suite_run("many_nodes", tcase);
}

/*
 * Outboxes with hardly any room, in networks of all sizes: everything takes its time, nothing is
 * lost, repeated, or stands still.
 */
#include "base/bytes.h"
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <stdlib.h>

static char *make_xml_of(const char *network, unsigned nodes, const char *node)
{
    char *xml = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&xml, &size);

    ck_assert_ptr_nonnull(stream);
    fputs(network, stream);
    for (unsigned id = 1; id <= nodes; id++)
        fprintf(stream, "<Node_Instance><Node_Id>%u</Node_Id>%s</Node_Instance>", id, node);
    fclose(stream);
    return xml;
}

static char *make_xml(const char *network, unsigned nodes)
{
    return make_xml_of(network, nodes,
                       "<Vendor_Identification>0x29A</Vendor_Identification>"
                       "<Consumer_Heartbeat_Time>3000</Consumer_Heartbeat_Time>");
}

static const struct size {
    unsigned box, nodes;
    const char *network;
} sizes[] = {
    { 4, 3, "" },
    { 4, 126, "" },
    { 5, 126, "<NMT_Start_All>TRUE</NMT_Start_All>" },
    { 7, 126, "<Boot_Delay>50</Boot_Delay>" },
    { 4, 20, "<NMT_Action_On_Error>RESET_ALL</NMT_Action_On_Error>" },
};

static struct plant *make_plant(const struct size *size)
{
    char *xml = make_xml(size->network, size->nodes);
    struct plant *plant = plant_new(xml, 1000000);

    free(xml);
    plant->sim.box_size = size->box;
    for (uint8_t id = 1; id <= size->nodes; id++) {
        plant_add_object(plant_add_device(plant, id), 0x6200, 1, 4, 0);
        plant_configure(plant, id, 0x6200, 1, 4, 1000u + id);
        plant_configure(plant, id, 0x1017, 0, 2, 1000);
    }
    watch_start(plant);
    plant_power_on(plant);
    return plant;
}

/* The same boot as with plenty of room: as many frames as it takes, none twice. */
START_TEST(test_boot)
{
    const struct size *size = &sizes[_i];
    struct plant *plant = make_plant(size);
    size_t all = 0;

    plant_run_ms(plant, 900);
    watch_expect_up(plant, "is not up");
    for (size_t i = 0; i < plant->sim.trace_count; i++)
        all += plant->sim.trace[i].frame.id >= 0x580 && plant->sim.trace[i].frame.id < 0x680;
    ck_assert_uint_eq(all, 8 * size->nodes);
    ck_assert_uint_eq(plant->manager->dropped, 0);
    plant_free(plant);
}
END_TEST

/* All fall silent at the same moment, and come back at the same moment. */
START_TEST(test_all_lost)
{
    const struct size *size = &sizes[_i];
    struct plant *plant = make_plant(size);

    plant_run_ms(plant, 900);
    for (unsigned id = 1; id <= size->nodes; id++)
        plant->devices[id]->sim->unplugged = true;
    plant_run_ms(plant, 6000);
    ck_assert_uint_ge(plant_said_times(plant, "heartbeat lost"), size->nodes);
    for (unsigned id = 1; id <= size->nodes; id++)
        plant->devices[id]->sim->unplugged = false;
    plant_run_ms(plant, 6000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant->manager->dropped, 0);
    plant_free(plant);
}
END_TEST

/* --- an owner that takes nothing for a while --- */

static struct manager manager;
static struct co_frame frames[600];
static struct co_event events[4];
static struct co_outbox out;
static co_us_t now;

static void begin(const struct plant *plant, unsigned frame_room)
{
    co_outbox_init(&out, frames, frame_room, events, 4);
    now = CO_MS(1000);
    ck_assert_int_eq(manager_init(&manager, plant->config), CO_OK);
    manager_start(&manager, now, &out);
}

/* Takes one event and one frame at a time, or nothing. */
static unsigned take(unsigned count)
{
    struct co_frame frame;
    struct co_event event;
    unsigned taken = 0;

    for (unsigned i = 0; i < count; i++) {
        taken += co_outbox_take_event(&out, &event);
        taken += co_outbox_take_frame(&out, &frame);
    }
    return taken;
}

static void answer_all(const struct network_config *config)
{
    for (size_t i = 0; i < config->node_count; i++) {
        struct co_frame frame = co_frame_make(0x580u + config->nodes[i].node_id, 8);

        frame.data[0] = 0x43;
        frame.data[2] = 0x10;
        manager_on_frame(&manager, &frame, now, &out);
    }
}

/* The outbox is full while all nodes answer, fail and are reset at once, again and again. */
START_TEST(test_owner_takes_nothing)
{
    struct plant *plant = make_plant(&sizes[1]);
    unsigned rest = 0;

    begin(plant, 4);
    for (unsigned i = 0; i < 3000; i++) {
        now += CO_MS(20);
        manager_on_time(&manager, now, &out);
        answer_all(plant->config);
        if (i % 100 == 0)
            manager_command(&manager, NMT_RESET_NODE, 0, now, &out);
        take(i / 1000);
    }
    for (; rest < 1000000 && manager_deadline(&manager) <= now; rest++) {
        manager_on_time(&manager, now, &out);
        take(1);
    }
    ck_assert_uint_lt(rest, 1000000);
    ck_assert_uint_eq(manager.inner.event_count, 0);
    manager_done(&manager);
    plant_free(plant);
}
END_TEST

static void drain(void)
{
    while (take(1) > 0)
        manager_on_time(&manager, now, &out);
}

/* Answers each node's next read. */
static void answer(const struct network_config *config, uint16_t index, uint8_t sub, uint32_t value)
{
    for (size_t i = 0; i < config->node_count; i++) {
        struct co_frame frame = co_frame_make(0x580u + config->nodes[i].node_id, 8);

        frame.data[0] = 0x43;
        put_le16(frame.data + 1, index);
        frame.data[3] = sub;
        put_le32(frame.data + 4, value);
        manager_on_frame(&manager, &frame, now, &out);
    }
}

/* 126 boots end in one moment, with 126 emergencies behind them: it is all told, in time. */
START_TEST(test_events_pile_up)
{
    static const char dates[] = "<Configuration_Date>1</Configuration_Date>"
                                "<Configuration_Time>2</Configuration_Time>";
    char *xml = make_xml_of("", 126, dates);
    struct plant *plant = plant_new(xml, 0);
    unsigned told = 0;

    free(xml);
    begin(plant, 600);
    drain();
    now += CO_MS(200);
    manager_on_time(&manager, now, &out);
    drain();
    answer(plant->config, 0x1000, 0, 1);
    drain();
    answer(plant->config, 0x1020, 1, 1);
    drain();
    while (co_outbox_room(&out, 0, 1))
        co_outbox_put_event(&out, &(struct co_event){ .type = MANAGER_EMCY });
    answer(plant->config, 0x1020, 2, 2);
    for (uint32_t id = 1; id <= 126; id++) {
        struct co_frame frame = co_frame_make(0x80u + id, 8);

        manager_on_frame(&manager, &frame, now, &out);
    }
    while (take(1) > 0) {
        manager_on_time(&manager, now, &out);
        told++;
    }
    ck_assert_uint_gt(told, 126 * 5);
    ck_assert_uint_eq(manager.dropped, 0);
    ck_assert(manager_is_up(&manager, false));
    for (uint8_t id = 1; id <= 126; id++)
        ck_assert(manager.nodes[id].booted);
    manager_done(&manager);
    plant_free(plant);
}
END_TEST

/* Nobody takes the events of a thousand frames: the next ones pass, and that is told in the end. */
START_TEST(test_dropped_frames_are_told)
{
    struct plant *plant = plant_new(PLANT_NODE(5, ""), 0);
    const struct co_frame boot_up = nmt_error_control_frame(99, NMT_INITIALISING);
    struct co_event event;
    unsigned told = 0;

    begin(plant, 1);
    while (co_outbox_room(&out, 0, 1))
        co_outbox_put_event(&out, &(struct co_event){ .type = MANAGER_EMCY });
    for (unsigned i = 0; i < 2000; i++)
        manager_on_frame(&manager, &boot_up, now, &out);
    ck_assert_uint_gt(manager.dropped, 0);
    for (unsigned i = 0; i < 3000; i++) {
        while (co_outbox_take_event(&out, &event))
            if (event.type == MANAGER_DROPPED)
                told += (unsigned)event.actual;
        manager_on_time(&manager, now, &out);
    }
    ck_assert_uint_eq(told, manager.dropped);
    manager_done(&manager);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("tiny_boxes");

    tcase_set_timeout(tcase, 60);
    tcase_add_loop_test(tcase, test_boot, 0, sizeof sizes / sizeof sizes[0]);
    tcase_add_loop_test(tcase, test_all_lost, 0, sizeof sizes / sizeof sizes[0]);
    tcase_add_test(tcase, test_owner_takes_nothing);
    tcase_add_test(tcase, test_events_pile_up);
    tcase_add_test(tcase, test_dropped_frames_are_told);
    return suite_run("tiny_boxes", tcase);
}

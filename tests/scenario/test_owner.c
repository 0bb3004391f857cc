/*
 * The manager and its owner: outboxes that are full when something is ordered, requests that are
 * taken back, an end in the middle of things, a bus that confirms nothing.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <string.h>

#define KEPT_ALIVE "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"

static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 6; node++) {
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
        plant_configure(plant, node, 0x6200, 1, 1, 0x50u + node);
    }
    watch_start(plant);
    return plant;
}

static struct plant *run_plant(const char *xml)
{
    struct plant *plant = make_plant(xml);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

/* --- no room --- */

/* Orders until there is room for none. */
static void fill(struct plant *plant, uint8_t node)
{
    unsigned count = 0;

    while (plant_command(plant, NMT_ENTER_PREOPERATIONAL, node) == CO_OK)
        ck_assert_uint_lt(count++, 3000);
    ck_assert_int_eq(plant_command(plant, NMT_ENTER_PREOPERATIONAL, node), CO_ERR_AGAIN);
}

/* An order that is accepted waits for room, and is done then. */
static const struct order {
    enum nmt_command command;
    uint8_t node;
    enum co_err err;
    const char *frame; /* NULL: none */
} orders[] = {
    { NMT_RESET_NODE, 5, CO_OK, "000#8105" },   { NMT_RESET_COMMUNICATION, 0, CO_OK, "000#8200" },
    { NMT_RESET_NODE, 127, CO_OK, "000#8100" }, { NMT_START, 0, CO_OK, "000#0100" },
    { NMT_STOP, 0, CO_ERR_AGAIN, NULL },        { NMT_STOP, 5, CO_ERR_AGAIN, NULL },
};

START_TEST(test_orders_without_room)
{
    const struct order *order = &orders[_i];
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(6, ""));

    plant->sim.trace_count = 0;
    fill(plant, 6);
    ck_assert_int_eq(plant_command(plant, order->command, order->node), order->err);
    plant_run_ms(plant, 3000);
    if (order->frame)
        ck_assert_uint_eq(plant_sent(plant, order->frame), 1);
    else
        ck_assert_uint_eq(plant_sent(plant, "000#02"), 0);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Each slave is started as soon as there is room, and none twice. */
START_TEST(test_starts_without_room)
{
    struct plant *plant = run_plant("<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>" PLANT_NODE(
        5, "") PLANT_NODE(6, "") PLANT_NODE(7, ""));

    fill(plant, 6);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    ck_assert_int_eq(plant_command(plant, NMT_START, 0), CO_OK); /* somebody is impatient */
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A start of all that has waited for room: meanwhile one has fallen silent, it is not for all. */
START_TEST(test_start_all_comes_too_late)
{
    struct plant *plant = run_plant("<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>"
                                    "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, "")
                                        PLANT_NODE(6, ""));
    const struct co_frame boot_up = nmt_error_control_frame(6, NMT_INITIALISING);

    fill(plant, 6);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    manager_on_frame(plant->manager, &boot_up, plant->sim.now, &plant->manager_device->box);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0106"), 1);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* The bus is back while nothing has been taken: each reset that is due goes out, later. */
START_TEST(test_resets_without_room)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(6, KEPT_ALIVE) PLANT_NODE(7, ""));

    plant->sim.trace_count = 0;
    fill(plant, 5);
    manager_on_bus(plant->manager, false, plant->sim.now, &plant->manager_device->box);
    manager_on_bus(plant->manager, true, plant->sim.now, &plant->manager_device->box);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8207"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 0);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert(plant_node(plant, 6)->booted);
    plant_free(plant);
}
END_TEST

/* What is still heard when the bus is lost is from before, and nothing any more. */
START_TEST(test_frames_of_a_lost_bus)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(6, ""));
    size_t said = plant->events_size;

    manager_on_bus(plant->manager, false, plant->sim.now, &plant->manager_device->box);
    sim_say(&plant->sim, "705#00");
    sim_say(&plant->sim, "085#1023020000000000");
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant->events_size, said);
    ck_assert_uint_eq(plant_sent(plant, "605#40001000"), 1);
    plant_free(plant);
}
END_TEST

/* Who is waited for: of the master's nodes those that it starts until they run, others not. */
static const struct up {
    const char *xml;
    bool mandatory, all;
} ups[] = {
    { PLANT_NODE(5, "") PLANT_NODE(6, ""), true, true },
    { PLANT_NODE(5, "") PLANT_NODE(7, ""), true, false },
    { PLANT_NODE(5, "") PLANT_NODE(7, "<NMT_Slave>FALSE</NMT_Slave>"), true, true },
    { "<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(5, "") PLANT_NODE(6, ""), true, true },
    { "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>" PLANT_NODE(5, ""), true, true },
    { PLANT_NODE(7, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"), false, false },
};

START_TEST(test_who_is_waited_for)
{
    struct plant *plant = run_plant(ups[_i].xml);

    ck_assert_int_eq(manager_is_up(plant->manager, false), ups[_i].mandatory);
    ck_assert_int_eq(manager_is_up(plant->manager, true), ups[_i].all);
    plant_free(plant);
}
END_TEST

/* --- requests that are taken back --- */

static struct sdo_request requests[5];
static uint8_t buffers[5][8];

static void submit(struct plant *plant, unsigned i, uint16_t index)
{
    requests[i].transfer = (struct sdo_transfer){ .index = index,
                                                  .sub = index == 0x1018 ? 4 : 0,
                                                  .buffer = buffers[i],
                                                  .size = 8,
                                                  .timeout = CO_MS(100) };
    manager_submit(plant->manager, 5, &requests[i], plant->sim.now, &plant->manager_device->box);
}

static struct plant *run_with_requests(void)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "") PLANT_NODE(6, ""));

    memset(requests, 0, sizeof requests);
    for (unsigned i = 0; i < 5; i++)
        submit(plant, i, 0x1018);
    return plant;
}

static void cancel(struct plant *plant, unsigned i)
{
    manager_cancel(plant->manager, 5, &requests[i], plant->sim.now, &plant->manager_device->box);
}

/* From the middle, the end and the beginning of the queue; those that stay have their answers. */
START_TEST(test_taken_back)
{
    struct plant *plant = run_with_requests();

    cancel(plant, 2);
    cancel(plant, 4);
    cancel(plant, 1);
    submit(plant, 2, 0x1018);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(requests[0].state, REQUEST_DONE);
    ck_assert_int_eq(requests[1].state, REQUEST_IDLE);
    ck_assert_int_eq(requests[2].state, REQUEST_DONE);
    ck_assert_int_eq(requests[3].state, REQUEST_DONE);
    ck_assert_int_eq(requests[4].state, REQUEST_IDLE);
    ck_assert_uint_eq(buffers[3][0], 5);
    plant_free(plant);
}
END_TEST

/* The server cannot be told, for want of room: the request is free all the same, the next runs. */
START_TEST(test_taken_back_without_room)
{
    struct plant *plant = run_with_requests();

    fill(plant, 6);
    cancel(plant, 0);
    ck_assert_int_eq(requests[0].state, REQUEST_IDLE);
    plant_run_ms(plant, 1000);
    for (unsigned i = 1; i < 5; i++) {
        ck_assert_int_eq(requests[i].state, REQUEST_DONE);
        ck_assert_uint_eq(requests[i].result.detail, SDO_OUTCOME_OK);
    }
    plant_free(plant);
}
END_TEST

/* The end is near: all are taken back at once, and who comes later is not served. */
START_TEST(test_shut)
{
    struct plant *plant = run_with_requests();

    if (_i == 1)
        fill(plant, 6);
    manager_shut(plant->manager, plant->sim.now, &plant->manager_device->box);
    submit(plant, 0, 0x1018);
    plant_run_ms(plant, 1000);
    for (unsigned i = 0; i < 5; i++)
        ck_assert_int_eq(requests[i].state, REQUEST_IDLE);
    ck_assert_uint_le(plant_sent(plant, "605#40181004"), 1);
    plant_free(plant);
}
END_TEST

/* --- a bus that confirms nothing --- */

static struct manager manager;
static struct co_frame frames[64];
static struct co_event events[256];
static struct co_outbox out;

static unsigned take_requests(void)
{
    struct co_frame frame;
    struct co_event event;
    unsigned count = 0;

    while (co_outbox_take_event(&out, &event))
        ;
    while (co_outbox_take_frame(&out, &frame))
        count += frame.id == SDO_REQUEST_ID + 5 && frame.data[0] == 0x40;
    return count;
}

/* Its time-out runs from when the owner says that all has left; then the read is tried again. */
START_TEST(test_handed_over)
{
    struct plant *plant = make_plant(PLANT_NODE(5, "") PLANT_NODE(6, ""));
    co_us_t now = CO_MS(1000);

    co_outbox_init(&out, frames, 64, events, 256);
    ck_assert_int_eq(manager_init(&manager, plant->config), CO_OK);
    manager_start(&manager, now, &out);
    ck_assert(!manager_awaits_wire(&manager));
    now += CO_MS(200);
    manager_on_time(&manager, now, &out);
    ck_assert_uint_eq(take_requests(), 1);
    ck_assert(manager_awaits_wire(&manager));
    now += CO_MS(1000); /* the bus is slow */
    manager_on_handed_over(&manager, now);
    ck_assert(!manager_awaits_wire(&manager));
    manager_on_time(&manager, now + CO_MS(200) - 1, &out);
    ck_assert_uint_eq(take_requests(), 0);
    manager_on_time(&manager, now + CO_MS(200), &out);
    ck_assert_uint_eq(take_requests(), 1);
    ck_assert(manager_awaits_wire(&manager));
    manager_done(&manager);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("owner");

    tcase_add_loop_test(tcase, test_orders_without_room, 0,
                        (int)(sizeof orders / sizeof orders[0]));
    tcase_add_test(tcase, test_starts_without_room);
    tcase_add_test(tcase, test_start_all_comes_too_late);
    tcase_add_test(tcase, test_resets_without_room);
    tcase_add_test(tcase, test_frames_of_a_lost_bus);
    tcase_add_loop_test(tcase, test_who_is_waited_for, 0, (int)(sizeof ups / sizeof ups[0]));
    tcase_add_test(tcase, test_taken_back);
    tcase_add_test(tcase, test_taken_back_without_room);
    tcase_add_loop_test(tcase, test_shut, 0, 2);
    tcase_add_test(tcase, test_handed_over);
    return suite_run("owner", tcase);
}

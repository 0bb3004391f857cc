/*
 * More of test_lessons.c: SDO, stalls, broadcasts, and nodes that have missed a reset.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define GUARDED   "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"
#define HEARTBEAT "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define VENDOR    "<Vendor_Identification>0x29A</Vendor_Identification>"

static void beat(struct plant *plant, uint8_t node)
{
    plant_configure(plant, node, 0x1017, 0, 2, 200);
}

static void restart(struct plant *plant, uint8_t node)
{
    plant_power(plant, node, false);
    plant_power(plant, node, true);
}

static void unplug(struct plant *plant, uint8_t node, bool unplugged)
{
    plant->devices[node]->sim->unplugged = unplugged;
}

/* --- 6: SDO as devices speak it --- */

/* The first answer comes when the second request has been sent: it is not taken for the next. */
static enum sim_fate hold_first_answer(struct plant *plant, const struct co_frame *frame,
                                       uint8_t sender)
{
    unsigned *held = plant->fault_context;

    (void)sender;
    if (frame->id == 0x605 && frame->data[0] == 0x40 && frame->data[1] == 0x18 && (*held)++ == 0)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(201);
    return SIM_DELIVER;
}

START_TEST(test_late_answer)
{
    unsigned held = 0;
    struct plant *plant = watch_two(
        PLANT_NODE(5, VENDOR "<Product_Code>1</Product_Code><Serial_Number>5</Serial_Number>")
            PLANT_NODE(6, ""));

    plant->fault = hold_first_answer;
    plant->fault_context = &held;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert(!plant_said(plant, "boot error"));
    plant_free(plant);
}
END_TEST

/* The last segment of a block is lost on the wire: it alone is sent again. */
static enum sim_fate lose_last_segment(struct plant *plant, const struct co_frame *frame,
                                       uint8_t sender)
{
    bool *lost = plant->fault_context;

    (void)sender;
    if (frame->id != 0x605 || *lost || frame->data[0] != 0x85)
        return SIM_DELIVER;
    *lost = true;
    return SIM_UNHEARD;
}

START_TEST(test_last_segment_of_block_is_lost)
{
    static const uint8_t text[] = "thirty-two bytes of configuration";
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 40
    };
    struct plant *plant = watch_two(PLANT_NODE(6, "")
                                        PLANT_NODE(5, "<SDO_Block_Size>127</SDO_Block_Size>"
                                                      "<SDO_Timeout>2500</SDO_Timeout>"));
    struct od_entry *entry;
    bool lost = false;

    ck_assert_int_eq(od_add(&plant->devices[5]->od, &spec, &entry), CO_OK);
    for (size_t i = 0; i < plant->config->node_count; i++)
        if (plant->config->nodes[i].node_id == 5)
            ck_assert_int_eq(
                ccf_append(&plant->config->nodes[i].ccf, 0x2010, 0, text, sizeof text - 1), CO_OK);
    plant->fault = lose_last_segment;
    plant->fault_context = &lost;
    plant_power_on(plant);
    plant_run_ms(plant, 5000);
    ck_assert(lost);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s", plant->events);
    ck_assert_uint_eq(entry->size, sizeof text - 1);
    ck_assert_mem_eq(entry->value, text, sizeof text - 1);
    ck_assert_uint_eq(plant_sent(plant, "605#211020"), 0); /* no second attempt, in segments */
    ck_assert(!plant_said(plant, "boot error"));
    plant_free(plant);
}
END_TEST

/* A burst of orders with room for four frames: all go out, in their order, none is refused. */
START_TEST(test_orders_wait_for_room)
{
    static const enum nmt_command commands[] = { NMT_STOP, NMT_ENTER_PREOPERATIONAL, NMT_START };
    struct plant *plant = watch_two(PLANT_NODE(5, "") PLANT_NODE(6, ""));
    unsigned next = 0;

    plant->sim.box_size = 4;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->sim.trace_count = 0;
    for (unsigned i = 0; i < 30; i++)
        ck_assert_int_eq(plant_command(plant, commands[i % 3], 5), CO_OK);
    plant_run_ms(plant, 100);
    for (size_t i = 0; i < plant->sim.trace_count; i++)
        if (plant->sim.trace[i].frame.id == NMT_CAN_ID)
            ck_assert_uint_eq(plant->sim.trace[i].frame.data[0], commands[next++ % 3]);
    ck_assert_uint_eq(next, 30);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* --- 7: a stall, and a node that cannot stop complaining --- */

/* The computer stands still for ten seconds: one heartbeat follows, and one request to a node. */
START_TEST(test_no_burst_after_a_stall)
{
    struct plant *plant = watch_two(
        "<Heartbeat_Producer_Time>100</Heartbeat_Producer_Time>" PLANT_NODE(5, GUARDED)
            PLANT_NODE(6, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->manager_device->active = false;
    plant_run_ms(plant, 10000);
    plant->sim.trace_count = 0;
    plant->manager_device->active = true;
    plant_run_ms(plant, 99);
    ck_assert_uint_eq(plant_sent(plant, "77F#05"), 1);
    ck_assert_uint_eq(plant_sent(plant, "705#R"), 1);
    plant_run_ms(plant, 900);
    ck_assert_uint_eq(plant_sent(plant, "77F#05"), 10);
    ck_assert(!plant_said(plant, "no answer to guarding")); /* it was us who did not ask */
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* Thousands of emergencies, as fast as the bus takes them: told, and the other node boots. */
static enum sim_fate flood(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x085 || frame->id == 0x706)
        sim_say(&plant->sim, "085#1023020000000000");
    return SIM_DELIVER;
}

START_TEST(test_flood_of_emergencies)
{
    struct plant *plant = watch_two(PLANT_NODE(5, "") PLANT_NODE(6, VENDOR));

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->fault = flood;
    restart(plant, 6);
    plant_run_ms(plant, 300);
    ck_assert_uint_ge(plant_sent(plant, "085#"), 2000);
    plant->fault = NULL;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant->manager->dropped, 0);
    plant_free(plant);
}
END_TEST

/* --- 8: a broadcast starts whoever hears it --- */

/* Node 5 may be started; of the others somebody must not: then nobody hears a broadcast. */
static const struct unstartable {
    const char *name, *xml;
    const char *request, *answer;
} unstartables[] = {
    { "absent", PLANT_NODE(7, ""), NULL, NULL },
    { "another device", PLANT_NODE(6, "<Serial_Number>77</Serial_Number>"), NULL, NULL },
    { "refuses its configuration", PLANT_NODE(6, ""), "606#2F", "586#8000620130000906" },
    { "has no heartbeat", PLANT_NODE(6, HEARTBEAT), NULL, NULL },
    { "is left to the application",
      PLANT_NODE(6, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"), NULL, NULL },
    { "is another master's", PLANT_NODE(6, "<NMT_Slave>FALSE</NMT_Slave>"), NULL, NULL },
};

START_TEST(test_no_broadcast)
{
    const struct unstartable *row = &unstartables[_i];
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "<NMT_Start_All>TRUE</NMT_Start_All>" PLANT_NODE(5, MANDATORY) "%s",
             row->xml);
    plant = watch_two(xml);
    if (row->request)
        plant_lie(plant, row->request, row->answer, 1000);
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert_msg(plant_sent(plant, "000#0100") == 0, "%s", row->name);
    ck_assert_msg(plant_sent(plant, "000#0105") == 1, "%s", row->name);
    ck_assert_msg(plant_sent(plant, "000#01") == 1, "%s", row->name);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- 9: a node that has missed the reset --- */

/* Its cable is out when it is reset. It comes back as it went: the reset is sent again. */
START_TEST(test_reset_is_repeated)
{
    struct plant *plant = watch_two(PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, ""));

    beat(plant, 5);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->sim.trace_count = 0;
    unplug(plant, 5, true);
    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    unplug(plant, 5, false);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 2);
    ck_assert_uint_eq(plant_sent(plant, "605#2F006201"), 1);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/*
 * It was powered off and on, its boot-up message is lost, and so is the reset: its heartbeat alone,
 * or its answers, tell that it is there. It is booted, not just believed.
 */
static enum sim_fate lose_boot_up(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    unsigned *left = plant->fault_context;

    (void)sender;
    if (frame->id != 0x705 || frame->data[0] != 0 || *left == 0)
        return SIM_DELIVER;
    --*left;
    return SIM_UNHEARD;
}

START_TEST(test_back_without_boot_up)
{
    unsigned left = 0;
    struct plant *plant = watch_two(PLANT_NODE(5, HEARTBEAT MANDATORY) PLANT_NODE(6, ""));

    beat(plant, 5);
    plant->fault = lose_boot_up;
    plant->fault_context = &left;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 3000);
    left = 2; /* of the power, and of the reset that is repeated */
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(left, 0);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/* It takes three seconds to start, and says no boot-up: one reset more is enough, then it boots. */
static enum sim_fate start_slowly(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == NMT_CAN_ID && frame->data[0] >= NMT_RESET_NODE && frame->data[1] % 5 == 0)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(3000);
    return frame->id == 0x705 && frame->data[0] == 0 ? SIM_UNHEARD : SIM_DELIVER;
}

START_TEST(test_slow_start_without_boot_up)
{
    struct plant *plant = watch_two(PLANT_NODE(5, MANDATORY) PLANT_NODE(6, ""));

    plant->fault = start_slowly;
    plant_power_on(plant);
    plant_run_ms(plant, 15000);
    ck_assert_uint_le(plant_sent(plant, "000#8205"), 1);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* After the reset of one node its boot delay is waited for, as after that of all. */
START_TEST(test_boot_delay_after_a_reset)
{
    struct plant *plant = watch_two(PLANT_NODE(5, "<Boot_Delay>700</Boot_Delay>")
                                        PLANT_NODE(6, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_RESET_NODE, 5), CO_OK);
    plant_run_ms(plant, 699);
    ck_assert_uint_eq(plant_sent(plant, "705#00"), 1);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    plant_run_ms(plant, 100);
    watch_expect_up(plant, "is not up again");
    plant_free(plant);
}
END_TEST

/*
 * A heartbeat at the begin of a boot that takes long says nothing about its end: the node has
 * fallen silent meanwhile, and is not started.
 */
static enum sim_fate write_slowly(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x605 && frame->data[0] == 0x2F && frame->data[3] == 1) {
        sim_say(&plant->sim, "705#7F");
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(800);
    }
    return SIM_DELIVER;
}

START_TEST(test_old_heartbeat)
{
    struct plant *plant = watch_two(PLANT_NODE(5, HEARTBEAT "<SDO_Timeout>1000</SDO_Timeout>")
                                        PLANT_NODE(6, ""));

    plant->fault = write_slowly;
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert(plant_said(plant, "node 5: boot error K: no heartbeat within 500 ms"));
    ck_assert(!plant_said(plant, "node 5: booted"));
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 0);
    plant_free(plant);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tcase = tcase_create("lessons_bus");

    tcase_add_test(tcase, test_late_answer);
    tcase_add_test(tcase, test_last_segment_of_block_is_lost);
    tcase_add_test(tcase, test_orders_wait_for_room);
    tcase_add_test(tcase, test_no_burst_after_a_stall);
    tcase_add_test(tcase, test_flood_of_emergencies);
    tcase_add_loop_test(tcase, test_no_broadcast, 0, ROWS(unstartables));
    tcase_add_test(tcase, test_reset_is_repeated);
    tcase_add_test(tcase, test_back_without_boot_up);
    tcase_add_test(tcase, test_slow_start_without_boot_up);
    tcase_add_test(tcase, test_boot_delay_after_a_reset);
    tcase_add_test(tcase, test_old_heartbeat);
    return suite_run("lessons_bus", tcase);
}

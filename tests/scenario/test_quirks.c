/*
 * Devices as they are sold: each test is a habit of one that a manager has to live with.
 */
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define HEARTBEAT "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define VENDOR    "<Vendor_Identification>0x29A</Vendor_Identification>"
#define SERIAL    "<Serial_Number>5</Serial_Number>"

/* Node 5 has the habits, with two entries to write. */
static struct plant *make_plant(const char *network, const char *node)
{
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml, "%s<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>", network,
             node);
    plant = plant_new(xml, 1000000);
    plant_add_device(plant, 5);
    for (uint8_t sub = 1; sub <= 2; sub++) {
        plant_add_object(plant->devices[5], 0x6200, sub, 1, 0);
        plant_configure(plant, 5, 0x6200, sub, 1, 0x50u + sub);
    }
    watch_start(plant);
    return plant;
}

static struct plant *run_plant(const char *network, const char *node)
{
    struct plant *plant = make_plant(network, node);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

static void beat(struct plant *plant)
{
    plant_configure(plant, 5, 0x1017, 0, 2, 200);
}

static void restart(struct plant *plant)
{
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
}

/* --- boot-up --- */

/* It starts up as in the third edition of CiA 301: an emergency without any data. */
static enum sim_fate boot_up_of_old(struct plant *plant, const struct co_frame *frame,
                                    uint8_t sender)
{
    const bool *both = plant->fault_context;

    (void)sender;
    if (frame->id != 0x705 || frame->data[0] != 0)
        return SIM_DELIVER;
    sim_say(&plant->sim, "085#");
    return *both ? SIM_DELIVER : SIM_UNHEARD;
}

START_TEST(test_boot_up_without_data)
{
    bool both = _i == 1;
    struct plant *plant = make_plant("", "");

    plant->fault = boot_up_of_old;
    plant->fault_context = &both;
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    restart(plant);
    plant->devices[5]->reborn = false;
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 4);
    ck_assert(plant_said(plant, "node 5: boot-up message"));
    ck_assert(!plant_said(plant, "emergency"));
    plant_free(plant);
}
END_TEST

/* Nobody knows of that node, or it is not ours: a line, no more. */
START_TEST(test_boot_up_without_data_of_foreign_node)
{
    struct plant *plant = run_plant("", "");

    sim_say(&plant->sim, "087#");
    sim_say(&plant->sim, "0FF#"); /* with the manager's own node-ID */
    plant_run_ms(plant, 100);
    ck_assert(plant_said(plant, "node 7: boot-up message of a node that is not configured"));
    ck_assert(plant_said(plant, "another device has this node-ID: it sends a boot-up message"));
    ck_assert_uint_eq(plant_sent(plant, "607#"), 0);
    plant_free(plant);
}
END_TEST

/* A boot loader, another product, says boot-up first; then the application does. */
START_TEST(test_boot_loader_first)
{
    struct plant *plant = make_plant("", MANDATORY "<Product_Code>1</Product_Code>");

    plant_lie(plant, "605#40181002", "585#4318100299000000", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 600);
    ck_assert(plant_said(plant, "node 5: boot error M"));
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    restart(plant);
    plant_run_ms(plant, 600);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* It says boot-up, and then nothing for two seconds. */
static enum sim_fate deaf_after_boot_up(struct plant *plant, const struct co_frame *frame,
                                        uint8_t sender)
{
    co_us_t *until = plant->fault_context;

    (void)sender;
    if (frame->id == 0x705)
        *until = plant->sim.now + CO_MS(2000);
    return frame->id == 0x605 && plant->sim.now < *until ? SIM_UNHEARD : SIM_DELIVER;
}

START_TEST(test_silence_after_boot_up)
{
    co_us_t until = 0;
    struct plant *plant = make_plant("", MANDATORY);

    plant->fault = deaf_after_boot_up;
    plant->fault_context = &until;
    plant_power_on(plant);
    plant_run_ms(plant, 4000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_said_times(plant, "boot error"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#82"), 1); /* patience, not resets */
    plant_free(plant);
}
END_TEST

/* --- SDO --- */

/* Answers that are shorter than eight bytes, without a size, in segments, of too many bytes. */
static const struct habit {
    const char *name;
    const char *request, *answer;
    const char *next, *next_answer; /* of a second request, NULL: none */
} habits[] = {
    { "short read", "605#40181004", "585#4F18100405", NULL, NULL },
    { "short acknowledgement", "605#2F006201", "585#60006201", NULL, NULL },
    { "no size", "605#40181004", "585#4218100405000000", NULL, NULL },
    { "garbage behind the value", "605#40181004", "585#4F181004050000FF", NULL, NULL },
    { "in segments", "605#40181004", "585#4118100404000000", "605#60", "585#0705000000000000" },
    { "in segments, no size", "605#40181004", "585#4018100400000000", "605#60",
      "585#0705000000000000" },
    { "a short last segment", "605#40181004", "585#4118100404000000", "605#60", "585#0705000000" },
    { "it has sent one answer too many", "605#40181004", "585#4318100405000000", NULL, NULL },
};

static enum sim_fate echo(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x605 && frame->data[0] == 0x40) { /* what it has said before, once more */
        sim_say(&plant->sim, "585#4300100092010200");
        sim_say(&plant->sim, "585#6000620700000000");
        sim_say(&plant->sim, "585#8000620700000206");
    }
    return SIM_DELIVER;
}

START_TEST(test_habit_of_answering)
{
    const struct habit *habit = &habits[_i];
    struct plant *plant = make_plant("", VENDOR SERIAL);

    plant_lie(plant, habit->request, habit->answer, 100);
    if (habit->next)
        plant_lie(plant, habit->next, habit->next_answer, 100);
    if (strstr(habit->name, "too many"))
        plant->fault = echo;
    plant->on_delivered = NULL; /* the simulated device has not heard what it is said to answer */
    plant_power_on(plant);
    plant_run_ms(plant, 900);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s:\n%s", habit->name, plant->events);
    ck_assert_msg(!plant_said(plant, "boot error"), "%s:\n%s", habit->name, plant->events);
    plant_free(plant);
}
END_TEST

/* It says that it has blocks, and loses the way in each: that is told, and nothing is started. */
START_TEST(test_broken_blocks)
{
    static const uint8_t text[] = "thirty-two bytes of configuration";
    struct plant *plant = make_plant("", MANDATORY "<SDO_Block_Size>16</SDO_Block_Size>");

    ck_assert_int_eq(ccf_append(&plant->config->nodes[0].ccf, 0x2010, 0, text, sizeof text), CO_OK);
    plant_lie(plant, "605#C6102000", "585#A410200010000000", 100);
    plant_lie(plant, "605#85", "585#8010200004000405", 100); /* CRC error */
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_msg(plant_said(plant, "node 5: boot error J: write 2010h:00"), "%s", plant->events);
    ck_assert(plant_said(plant, "the node answers abort 05040004h"));
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    plant_free(plant);
}
END_TEST

/* Each segment is answered a moment before the time is over: silence counts, not the whole. */
static enum sim_fate answer_at_the_last_moment(struct plant *plant, const struct co_frame *frame,
                                               uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x605)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(190);
    return SIM_DELIVER;
}

START_TEST(test_slow_segments)
{
    static const uint8_t text[] =
        "a text that takes a dozen of segments, one answer for each of them";
    const struct od_spec spec = {
        .index = 0x2010, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = sizeof text
    };
    struct plant *plant = make_plant("", "");
    struct od_entry *entry;

    ck_assert_int_eq(od_add(&plant->devices[5]->od, &spec, &entry), CO_OK);
    ck_assert_int_eq(ccf_append(&plant->config->nodes[0].ccf, 0x2010, 0, text, sizeof text - 1),
                     CO_OK);
    plant->fault = answer_at_the_last_moment;
    plant_power_on(plant);
    plant_run_ms(plant, 5000);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s", plant->events);
    ck_assert_uint_eq(entry->size, sizeof text - 1);
    ck_assert(!plant_said(plant, "boot error"));
    plant_free(plant);
}
END_TEST

/* --- heartbeats and emergencies --- */

/* Heartbeats of eight bytes are heartbeats; those of none are nothing, and harm nobody. */
static enum sim_fate stretch_heartbeat(struct plant *plant, const struct co_frame *frame,
                                       uint8_t sender)
{
    const char *say = plant->fault_context;

    if (frame->id != 0x705 || frame->data[0] == 0 || sender != 5)
        return SIM_DELIVER;
    sim_say(&plant->sim, say);
    return SIM_LOSE;
}

START_TEST(test_length_of_heartbeat)
{
    static char eight[] = "705#0511223344556677", none[] = "705#";
    struct plant *plant = make_plant("", HEARTBEAT);

    beat(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->fault = stretch_heartbeat;
    plant->fault_context = _i ? none : eight;
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant_said(plant, "heartbeat lost"), _i);
    plant->fault = NULL;
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* Emergencies shorter than eight bytes: what is there is told, the rest is 0. */
START_TEST(test_short_emergencies)
{
    struct plant *plant = run_plant("", "");

    sim_say(&plant->sim, "085#3412");
    sim_say(&plant->sim, "085#1050810102");
    sim_say(&plant->sim, "085#01"); /* not even a code */
    plant_run_ms(plant, 10);
    ck_assert(plant_said(plant, "emergency 1234h, generic error, error register 00h, field 00"));
    ck_assert(plant_said(plant, "emergency 5010h, device hardware, error register 81h, field 01 02 "
                                "00 00 00"));
    ck_assert_uint_eq(plant_said_times(plant, "emergency"), 2);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* Another protocol speaks on the same bus, with long identifiers that look like ours inside. */
START_TEST(test_long_identifiers)
{
    static const char *const frames[] = {
        "00000705#00",
        "00000585#4300100000000000",
        "00000085#0010010000000000",
        "00000000#0105",
        "00000085#",
        "00000000#8100",
    };
    struct plant *plant = make_plant("", HEARTBEAT);

    beat(plant);
    plant_power_on(plant);
    for (unsigned i = 0; i < 600; i++) {
        sim_say(&plant->sim, frames[i % 6]);
        plant_run_ms(plant, 2);
    }
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_said_times(plant, "node 5: boot-up message"), 1);
    ck_assert(!plant_said(plant, "emergency"));
    ck_assert(!plant_said(plant, "another NMT master"));
    plant_free(plant);
}
END_TEST

/* --- the bus --- */

/* Its power stays while the bus is gone for a moment shorter than its heartbeat's time. */
START_TEST(test_short_loss_of_the_cable)
{
    struct plant *plant = make_plant("", HEARTBEAT MANDATORY);

    beat(plant);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->sim.trace_count = 0;
    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 150);
    plant->devices[5]->sim->unplugged = false;
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up");
    ck_assert_msg(!plant_said(plant, "heartbeat lost"), "%s", plant->events);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("quirks");

    tcase_add_loop_test(tcase, test_boot_up_without_data, 0, 2);
    tcase_add_test(tcase, test_boot_up_without_data_of_foreign_node);
    tcase_add_test(tcase, test_boot_loader_first);
    tcase_add_test(tcase, test_silence_after_boot_up);
    tcase_add_loop_test(tcase, test_habit_of_answering, 0, sizeof habits / sizeof *habits);
    tcase_add_test(tcase, test_broken_blocks);
    tcase_add_test(tcase, test_slow_segments);
    tcase_add_loop_test(tcase, test_length_of_heartbeat, 0, 2);
    tcase_add_test(tcase, test_short_emergencies);
    tcase_add_test(tcase, test_long_identifiers);
    tcase_add_test(tcase, test_short_loss_of_the_cable);
    return suite_run("quirks", tcase);
}

/*
 * The manager's dictionary as other tools of the network see it: 1F82h "request NMT", by which they
 * read states and command, 1F83h, and what its configuration shows.
 */
#include "base/bytes.h"
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define SELF    127
#define FOREIGN 77
#define ALL     0x80

#define STOP         0x04
#define START        0x05
#define RESET_NODE   0x06
#define RESET_COMM   0x07
#define PREOP        0x7F
#define ANSWER_LIMIT 20 /* ms; twice that of any answer here */

/* 5 and 6 are booted, 8 is left to the application, 9 not the master's. */
#define NODES                                                                                      \
    PLANT_NODE(5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"                                \
                  "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>")            \
    PLANT_NODE(6, "")                                                                              \
    PLANT_NODE(8, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>")                            \
    PLANT_NODE(9, "<NMT_Slave>FALSE</NMT_Slave>")

static struct {
    bool answered;
    uint8_t data[8];
} answer; /* the last one of the manager's SDO server */

static void (*watch)(struct plant *plant, const struct co_frame *frame, uint8_t sender);

static void on_delivered(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    watch(plant, frame, sender);
    if (frame->id != SDO_RESPONSE_ID + SELF)
        return;
    answer.answered = true;
    memcpy(answer.data, frame->data, sizeof answer.data);
}

static void watch_answers(struct plant *plant)
{
    watch_start(plant);
    watch = plant->on_delivered;
    plant->on_delivered = on_delivered;
}

static struct plant *make_plant(const char *network)
{
    static const uint8_t nodes[] = { 5, 6, 8, 9 };
    char xml[2048];
    struct plant *plant;

    snprintf(xml, sizeof xml, "%s" NODES, network);
    plant = plant_new(xml, 1000000);
    for (size_t i = 0; i < sizeof nodes; i++)
        plant_add_object(plant_add_device(plant, nodes[i]), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 6, 0x6200, 1, 1, 0x56);
    watch_answers(plant);
    return plant;
}

static struct plant *run_plant(const char *network)
{
    struct plant *plant = make_plant(network);

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

static struct plant *operational(void)
{
    return run_plant("");
}

static int state_of(const struct plant *plant, uint8_t node)
{
    return plant->devices[node]->slave.state;
}

/* The nodes that the master boots are configured and operational. */
static void expect_up(const struct plant *plant)
{
    for (uint8_t node = 5; node <= 6; node++) {
        ck_assert(watch_is_configured(plant, node));
        ck_assert_int_eq(state_of(plant, node), NMT_OPERATIONAL);
    }
}

/* The tool's request; what is left of the answer's time may bring more. */
static void ask(struct plant *plant, const char *request)
{
    answer.answered = false;
    sim_say(&plant->sim, request);
    for (unsigned ms = 0; ms < ANSWER_LIMIT && !answer.answered; ms++)
        plant_run_ms(plant, 1);
    ck_assert_msg(answer.answered, "no answer to %s", request);
}

static uint32_t read_object(struct plant *plant, uint16_t index, uint8_t sub)
{
    char request[32];

    snprintf(request, sizeof request, "67F#40%02X%02X%02X00000000", index & 0xFFu, index >> 8, sub);
    ask(plant, request);
    return (uint32_t)get_le(answer.data + 4, 4);
}

/* The abort code, 0: accepted. */
static uint32_t write_object(struct plant *plant, uint16_t index, uint8_t sub, uint8_t value)
{
    char request[32];

    snprintf(request, sizeof request, "67F#2F%02X%02X%02X%02X000000", index & 0xFFu, index >> 8,
             sub, value);
    ask(plant, request);
    return answer.data[0] == 0x60 ? 0 : (uint32_t)get_le(answer.data + 4, 4);
}

static uint32_t request_nmt(struct plant *plant, uint8_t node, uint8_t value)
{
    return write_object(plant, 0x1F82, node, value);
}

/* --- read --- */

START_TEST(test_states)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(read_object(plant, 0x1F82, 0), 0x80);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 5), 0x05);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 8), 0x7F);
    ck_assert_uint_eq(read_object(plant, 0x1F82, SELF), 0x05);
    ck_assert_uint_eq(read_object(plant, 0x1F82, FOREIGN), 0x00);
    ck_assert_uint_eq(read_object(plant, 0x1F82, ALL), 0x06010001);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 0x81), 0x06090011);
    ck_assert_int_eq(plant_command(plant, NMT_STOP, 6), CO_OK);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x04);
    plant_free(plant);
}
END_TEST

/* It was never there, and nobody has asked yet; then that is known. A guarded one falls silent. */
START_TEST(test_missing)
{
    struct plant *plant = make_plant("");

    plant_power_on(plant);
    plant_power(plant, 6, false);
    plant_run_ms(plant, 100);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x00);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x01);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 5), 0x05);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 450);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 5), 0x01);
    plant_power(plant, 5, true);
    plant_power(plant, 6, true);
    plant_run_ms(plant, 1500);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 5), 0x05);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x05);
    plant_free(plant);
}
END_TEST

START_TEST(test_guarding)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(read_object(plant, 0x1F83, 0), 127);
    ck_assert_uint_eq(read_object(plant, 0x1F83, 5), 1);
    ck_assert_uint_eq(read_object(plant, 0x1F83, 6), 0);
    ck_assert_uint_eq(read_object(plant, 0x1F83, FOREIGN), 0);
    ck_assert_uint_eq(write_object(plant, 0x1F83, 5, 0), 0x06010002);
    ck_assert_uint_eq(read_object(plant, 0x1F83, 5), 1);
    plant_free(plant);
}
END_TEST

/* What is read is not what was read before. */
START_TEST(test_configuration)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(read_object(plant, 0x1F80, 0), 1);
    ck_assert_uint_eq(read_object(plant, 0x1F81, 5), 0x0064030D);
    ck_assert_uint_eq(read_object(plant, 0x1F89, 0), 0);
    ck_assert_uint_eq(read_object(plant, 0x1028, 5), 0x85);
    ck_assert_uint_eq(read_object(plant, 0x1028, FOREIGN), 0x80000000u);
    plant_free(plant);
}
END_TEST

/* A node that is only asked for its state, to be left alone where it is operational. */
START_TEST(test_not_guarded)
{
    struct plant *plant = plant_new(
        PLANT_NODE(5, "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"), 1000000);

    plant_add_device(plant, 5);
    plant_lie(plant, "705#R", NULL, 100);
    watch_answers(plant);
    plant_power_on(plant);
    while (plant_sent(plant, "705#R") == 0)
        plant_run_ms(plant, 1);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CHECK_STATE);
    ck_assert_uint_eq(read_object(plant, 0x1F83, 5), 0);
    plant_free(plant);
}
END_TEST

static unsigned emergencies;

static void count_emergencies(struct plant *plant, const struct co_event *event)
{
    (void)plant;
    emergencies += event->type == MANAGER_EMCY || event->type == SLAVE_EMCY_HEARD;
}

/* 1028h shows whose are heard; each is told once, by the manager and not by its device. */
START_TEST(test_emergency)
{
    struct plant *plant = operational();

    emergencies = 0;
    plant->on_event = count_emergencies;
    sim_say(&plant->sim, "085#1081110102030405");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(emergencies, 1);
    ck_assert_uint_eq(plant_said_times(plant, "emergency 8110h"), 1);
    plant_free(plant);
}
END_TEST

/* --- command --- */

START_TEST(test_commands)
{
    static const struct {
        uint8_t value, state;
        const char *command;
    } rows[] = { { STOP, NMT_STOPPED, "\"stop\" to node 6" },
                 { PREOP, NMT_PREOPERATIONAL, "\"enter pre-operational\" to node 6" } };
    struct plant *plant = operational();
    char text[128];

    ck_assert_uint_eq(request_nmt(plant, 6, rows[_i].value), 0);
    plant_run_ms(plant, 1500);
    ck_assert_int_eq(state_of(plant, 6), rows[_i].state);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), rows[_i].state);
    snprintf(text, sizeof text, "info: a tool commands by 1F82h: %s", rows[_i].command);
    ck_assert_uint_eq(plant_said_times(plant, text), 1);
    ck_assert_uint_eq(request_nmt(plant, 6, START), 0);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_said_times(plant, "another NMT master"), 0);
    plant_free(plant);
}
END_TEST

/* A node is booted again before it is started: as the application's reset does it. */
START_TEST(test_resets)
{
    static const uint8_t values[] = { RESET_NODE, RESET_COMM };
    static const char *const commands[] = { "000#8106", "000#8206" };
    struct plant *plant = operational();

    ck_assert_uint_eq(request_nmt(plant, 6, values[_i]), 0);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x00); /* it was there: not missing yet */
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, commands[_i]), 1);
    ck_assert_uint_eq(plant_sent(plant, "606#2F006201"), 2);
    ck_assert_int_eq(state_of(plant, 6), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_all)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(request_nmt(plant, ALL, STOP), 0);
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_sent(plant, "000#0200"), 1);
    ck_assert_int_eq(state_of(plant, 9), NMT_STOPPED);
    ck_assert(plant_said(plant, "by 1F82h: \"stop\" to all nodes"));
    ck_assert_uint_eq(request_nmt(plant, ALL, START), 0);
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 1);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Of the manager itself, by name or with all: answered before it is reset, then all boots anew. */
START_TEST(test_reset_of_manager)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(request_nmt(plant, _i ? SELF : ALL, RESET_NODE), 0);
    plant_run_ms(plant, 1);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#8100"), 1);
    ck_assert_uint_eq(plant_sent(plant, "77F#00"), 2);
    ck_assert_uint_eq(plant_said_times(plant, "by 1F82h: \"reset node\""), 1);
    expect_up(plant);
    plant_free(plant);
}
END_TEST

/* Where the application is to start the network, another tool may as well. */
START_TEST(test_start_of_manager)
{
    struct plant *plant = run_plant("<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>");

    ck_assert_int_eq(plant->manager->state, NETWORK_WAITING);
    ck_assert_uint_eq(request_nmt(plant, 5, START), 0x08000022);
    ck_assert_uint_eq(request_nmt(plant, SELF, START), 0);
    plant_run_ms(plant, 10);
    ck_assert_int_eq(plant->manager->device.state, NMT_OPERATIONAL);
    ck_assert_int_eq(state_of(plant, 5), NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- refused --- */

START_TEST(test_refused)
{
    static const struct {
        uint8_t node, value;
        uint32_t code;
    } rows[] = { { FOREIGN, STOP, 0x06090030 }, { 5, 0x00, 0x06090030 },
                 { 5, 0x01, 0x06090030 },       { 5, 0x80, 0x06090030 },
                 { 5, 0x84, 0x06090030 },       { ALL, 0xFF, 0x06090030 },
                 { 0x81, STOP, 0x06090011 },    { 0xFF, STOP, 0x06090011 },
                 { 0, STOP, 0x06010002 },       { FOREIGN, RESET_NODE, 0x06090030 } };
    struct plant *plant = operational();

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint32_t code = request_nmt(plant, rows[i].node, rows[i].value);

        ck_assert_msg(code == rows[i].code, "%u, %02X: %08X", rows[i].node, rows[i].value, code);
    }
    ask(plant, "67F#2B821F0504000000");
    ck_assert_uint_eq(get_le(answer.data + 4, 4), 0x06070012);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#02"), 0);
    ck_assert(!plant_said(plant, "1F82h"));
    expect_up(plant);
    plant_free(plant);
}
END_TEST

/* The mandatory node boots for ever. */
START_TEST(test_booting)
{
    struct plant *plant = make_plant("");

    plant_lie(plant, "605#", NULL, 100);
    plant_power_on(plant);
    plant_run_ms(plant, 600);
    ck_assert_int_eq(plant->manager->state, NETWORK_BOOTING);
    ck_assert_uint_eq(request_nmt(plant, ALL, START), 0x08000022);
    ck_assert_uint_eq(request_nmt(plant, SELF, START), 0x08000022);
    ck_assert_uint_eq(request_nmt(plant, SELF, STOP), 0x08000022);
    ck_assert_uint_eq(request_nmt(plant, 6, START), 0x08000022);
    ck_assert_uint_eq(request_nmt(plant, 5, STOP), 0x08000022);
    ck_assert_uint_eq(read_object(plant, 0x1F82, 6), 0x7F);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_master)
{
    struct plant *plant = run_plant("<NMT_Master>FALSE</NMT_Master>");

    ck_assert_uint_eq(request_nmt(plant, 5, STOP), 0x08000021);
    ck_assert_uint_eq(request_nmt(plant, ALL, RESET_NODE), 0x08000021);
    ck_assert_uint_eq(request_nmt(plant, SELF, RESET_NODE), 0x08000021);
    ck_assert_uint_eq(request_nmt(plant, 5, 0x44), 0x08000021);
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_uint_eq(read_object(plant, 0x1F82, SELF), 0x05);
    plant_free(plant);
}
END_TEST

/* The bus does not take what the manager has to say: nothing is done that is not answered. */
START_TEST(test_no_room)
{
    const struct co_frame filler = { .id = 0x123 };
    struct plant *plant = operational();
    struct co_outbox *inner = &plant->manager->inner, none;
    struct co_frame frames[1], request;
    struct co_event events[1];

    ck_assert(co_frame_parse("67F#2F821F0604000000", &request));
    co_outbox_init(&none, frames, 1, events, 1);
    co_outbox_put_frame(&none, &filler);
    while (co_outbox_room(inner, 3, 0)) /* 2: for an answer, but not for a command as well */
        co_outbox_put_frame(inner, &filler);
    answer.answered = false;
    manager_on_frame(plant->manager, &request, plant->sim.now, &none);
    plant_run_ms(plant, 1100);
    ck_assert(answer.answered);
    ck_assert_uint_eq(get_le(answer.data + 4, 4), 0x08000020);
    expect_up(plant);
    ck_assert_uint_eq(request_nmt(plant, 6, STOP), 0);
    plant_free(plant);
}
END_TEST

/* The tool has aborted before the manager could look at what it wrote. */
START_TEST(test_given_up)
{
    const struct co_event filler = { .type = MANAGER_NODE_STEP };
    struct plant *plant = operational();
    struct co_frame frames[1], request, abort;
    struct co_event events[1];
    struct co_outbox full;

    ck_assert(co_frame_parse("67F#2F821F0604000000", &request));
    ck_assert(co_frame_parse("67F#80821F0600000405", &abort));
    co_outbox_init(&full, frames, 1, events, 1);
    co_outbox_put_event(&full, &filler);
    answer.answered = false;
    manager_on_frame(plant->manager, &request, plant->sim.now, &full);
    manager_on_frame(plant->manager, &abort, plant->sim.now, &full);
    plant_run_ms(plant, 1100);
    ck_assert(!answer.answered);
    expect_up(plant);
    plant_free(plant);
}
END_TEST

START_TEST(test_own_states)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(request_nmt(plant, SELF, PREOP), 0);
    ck_assert_uint_eq(read_object(plant, 0x1F82, SELF), 0x7F);
    ck_assert_uint_eq(request_nmt(plant, SELF, START), 0);
    ck_assert_uint_eq(read_object(plant, 0x1F82, SELF), 0x05);
    plant_free(plant);
}
END_TEST

/* In the state in which it has no SDO server any more it cannot answer. */
START_TEST(test_own_stop)
{
    struct plant *plant = operational();

    ck_assert_uint_eq(request_nmt(plant, SELF, STOP), 0);
    plant_run_ms(plant, 1);
    ck_assert_int_eq(plant->manager->device.state, NMT_STOPPED);
    ck_assert(plant_said(plant, "by 1F82h: \"stop\" to node 127"));
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("requests");

    tcase_add_test(tcase, test_states);
    tcase_add_test(tcase, test_missing);
    tcase_add_test(tcase, test_guarding);
    tcase_add_test(tcase, test_not_guarded);
    tcase_add_test(tcase, test_configuration);
    tcase_add_test(tcase, test_emergency);
    tcase_add_loop_test(tcase, test_commands, 0, 2);
    tcase_add_loop_test(tcase, test_resets, 0, 2);
    tcase_add_test(tcase, test_all);
    tcase_add_loop_test(tcase, test_reset_of_manager, 0, 2);
    tcase_add_test(tcase, test_start_of_manager);
    tcase_add_test(tcase, test_refused);
    tcase_add_test(tcase, test_booting);
    tcase_add_test(tcase, test_no_master);
    tcase_add_test(tcase, test_no_room);
    tcase_add_test(tcase, test_given_up);
    tcase_add_test(tcase, test_own_states);
    tcase_add_test(tcase, test_own_stop);
    return suite_run("requests", tcase);
}

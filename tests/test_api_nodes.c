/* State of nodes, NMT commands and boot records. */
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_device(plant, 6);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

static void boot(void)
{
    api_boot(plant,
             API_NODE_WITH(5, "<Name>pump</Name>"
                              "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>") API_NODE(6));
}

static int state_of(int node)
{
    int state = -1;

    ck_assert_int_eq(mcanOpenGetNodeState(0, node, &state), MCANOPEN_OK);
    return state;
}

/* --- commands --- */

typedef int command_fn(int net, int nodeID);

static const struct command {
    command_fn *call;
    const char *frame;
    int state; /* of the node afterwards */
} commands[] = {
    { mcanOpenStopNode, "000#0205", MCANOPEN_STATE_STOPPED },
    { mcanOpenEnterPreop, "000#8005", MCANOPEN_STATE_PREOPERATIONAL },
    { mcanOpenStartNode, "000#0105", MCANOPEN_STATE_OPERATIONAL },
    { mcanOpenResetNode, "000#8105", MCANOPEN_STATE_OPERATIONAL }, /* it is booted again */
};

START_TEST(a_command_to_a_node)
{
    const struct command *row = &commands[_i];
    unsigned before;

    boot();
    before = api_wire_count(wire, row->frame);
    ck_assert_int_eq(row->call(0, 5), MCANOPEN_OK);
    api_wire_wait(wire, row->frame, before + 1);
    api_wait_state(0, 5, row->state);
    ck_assert_int_eq(state_of(6), MCANOPEN_STATE_OPERATIONAL);
}
END_TEST

/* Reset node, whatever the elements say that govern the manager's own resets. */
START_TEST(a_reset_is_always_reset_node)
{
    api_boot(plant, API_NODE_WITH(5, "<NMT_Reset_Node>FALSE</NMT_Reset_Node>"));
    ck_assert_int_eq(mcanOpenResetNode(0, 5), MCANOPEN_OK);
    api_wire_wait(wire, "000#8105", 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#8205"), 0);
    ck_assert_int_eq(mcanOpenResetNode(0, 127), MCANOPEN_OK);
    api_wire_wait(wire, "000#8100", 1);
}
END_TEST

static const struct command broadcasts[] = {
    { mcanOpenStopNode, "000#0200", MCANOPEN_STATE_STOPPED },
    { mcanOpenEnterPreop, "000#8000", MCANOPEN_STATE_PREOPERATIONAL },
    { mcanOpenStartNode, "000#0100", MCANOPEN_STATE_OPERATIONAL },
    { mcanOpenResetNode, "000#8100", MCANOPEN_STATE_OPERATIONAL },
};

START_TEST(a_command_to_all_nodes)
{
    const struct command *row = &broadcasts[_i];
    unsigned before;

    boot();
    before = api_wire_count(wire, row->frame);
    ck_assert_int_eq(row->call(0, 0), MCANOPEN_OK);
    api_wire_wait(wire, row->frame, before + 1);
    api_wait_state(0, 5, row->state);
    api_wait_state(0, 6, row->state);
}
END_TEST

START_TEST(the_manager_lets_the_network_start)
{
    const char *frame = "000#0105";

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(
        api_config(plant, "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>" API_NODE(5)),
        MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 5);
    ck_assert_int_eq(mcanOpenStartNode(0, 5), MCAL_NODE_NOT_FREE);
    ck_assert_int_eq(state_of(127), MCANOPEN_STATE_PREOPERATIONAL);
    ck_assert_uint_eq(api_wire_count(wire, frame), 0);
    ck_assert_int_eq(mcanOpenStartNode(0, 127), MCANOPEN_OK);
    api_wire_wait(wire, frame, 1);
    ck_assert_int_eq(state_of(127), MCANOPEN_STATE_OPERATIONAL);
}
END_TEST

/* As another tool would have it, and told like its. */
START_TEST(a_command_through_the_managers_dictionary)
{
    static const char *const told = "Node: 5 a tool commands by 1F82h 128 (enter pre-operational)";
    char text[MCANOPEN_EVENT_TEXT_SIZE] = "";
    EVENT_T event;

    boot();
    ck_assert_int_eq(mcanOpenWriteSDO(0, 127, 0x1F82, 5, TYP_UINT8, "\x7F", 0, NULL), MCANOPEN_OK);
    api_wire_wait(wire, "000#8005", 1);
    while (!strstr(text, told)) {
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
        mcanOpenEventText(&event, text, sizeof text);
    }
    ck_assert_int_eq(mcanOpenWriteSDO(0, 127, 0x1F82, 77, TYP_UINT8, "\x04", 0, NULL),
                     MCAL_ABORT_DOMAIN);
}
END_TEST

/* A bus that takes a frame each 7 ms or so: the queue is full, and most of it is given up. */
START_TEST(more_commands_than_the_bus_takes)
{
    static const char format[] =
        "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>10</Baudrate>"
        "<Interface>%s-slow?bitrate=10000</Interface>" API_NODE_WITH(
            5, "<NMT_Slave>FALSE</NMT_Slave>") "</Manager_Instance></CANopen_Manager>";
    char text[sizeof format + sizeof plant->bus];
    int result;

    snprintf(text, sizeof text, format, plant->bus);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config_text(plant, text), MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_NETWORK_UP, -1);
    do
        result = mcanOpenEnterPreop(0, 5);
    while (result == MCANOPEN_OK);
    ck_assert_int_eq(result, MCAL_CAN_CONTR_BUSY);
    ck_assert_uint_gt(api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_FRAMES_UNSENT), -1).para.ul,
                      0);
}
END_TEST

START_TEST(commands_wait_until_the_network_has_booted)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5) API_NODE_WITH(9, "<NMT_Mandatory_Slave>TRUE"
                                                                    "</NMT_Mandatory_Slave>")),
                     MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 5);
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(commands[i].call(0, 9), MCAL_NODE_NOT_FREE);
        ck_assert_int_eq(commands[i].call(0, 127), MCAL_NODE_NOT_FREE);
        ck_assert_int_eq(commands[i].call(0, 0), MCAL_NODE_NOT_FREE);
    }
    ck_assert_int_eq(mcanOpenStartNode(0, 5), MCAL_NODE_NOT_FREE);
    ck_assert_uint_eq(api_wire_count(wire, "000#01"), 0);
}
END_TEST

START_TEST(who_is_not_master_commands_nobody)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<NMT_Master>FALSE</NMT_Master>" API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    for (int i = 0; i < ROWS(commands); i++) {
        ck_assert_int_eq(commands[i].call(0, 5), MCAL_NODE_NOT_FREE);
        ck_assert_int_eq(commands[i].call(0, 0), MCAL_NODE_NOT_FREE);
    }
    ck_assert_int_eq(mcanOpenStopNode(0, 127), MCANOPEN_OK); /* its own state */
    api_wait_state(0, 127, MCANOPEN_STATE_STOPPED);
    ck_assert_uint_eq(api_wire_count(wire, "000#"), 0);
}
END_TEST

static const struct arguments {
    int net, node, state, command;
} arguments[] = {
    { 1, 5, MCAL_NO_NET, MCAL_NO_NET },
    { 255, 5, MCAL_NO_NET, MCAL_NO_NET },
    { 256, 5, MCAL_PARA_ERROR, MCAL_PARA_ERROR },
    { -1, 5, MCAL_PARA_ERROR, MCAL_PARA_ERROR },
    { 0, -1, MCAL_PARA_ERROR, MCAL_PARA_ERROR },
    { 0, 128, MCAL_PARA_ERROR, MCAL_PARA_ERROR },
    { 0, 9, MCAL_NODE_NOT_EXISTEND, MCAL_NODE_NOT_EXISTEND },
    { 0, 126, MCAL_NODE_NOT_EXISTEND, MCAL_NODE_NOT_EXISTEND },
};

START_TEST(wrong_nets_and_nodes)
{
    const struct arguments *row = &arguments[_i];
    BOOT_RECORD_T record = { .size = sizeof record };
    int state = -1;

    boot();
    ck_assert_int_eq(mcanOpenGetNodeState(row->net, row->node, &state), row->state);
    ck_assert_int_eq(state, -1);
    ck_assert_int_eq(mcanOpenGetBootRecord(row->net, row->node, &record), row->state);
    for (int i = 0; i < ROWS(commands); i++)
        ck_assert_int_eq(commands[i].call(row->net, row->node), row->command);
}
END_TEST

START_TEST(a_state_needs_a_place_and_a_node)
{
    int state;

    boot();
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 0, &state), MCAL_PARA_ERROR);
    ck_assert_int_eq(state_of(127), MCANOPEN_STATE_OPERATIONAL);
}
END_TEST

START_TEST(a_heartbeat_tells_the_state)
{
    boot();
    api_wire_say(wire, "705#04");
    api_wait_state(0, 5, MCANOPEN_STATE_STOPPED);
    api_wire_say(wire, "705#85"); /* bit 7 is not the state's */
    api_wait_state(0, 5, MCANOPEN_STATE_OPERATIONAL);
}
END_TEST

/* --- boot records --- */

START_TEST(the_record_of_a_node_that_has_booted)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    boot();
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.size, sizeof record);
    ck_assert_int_eq(record.mandatory, 1);
    ck_assert_int_eq(record.state, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(record.step, MCANOPEN_STEP_STARTED);
    ck_assert_int_eq(record.booted, 1);
    ck_assert_int_eq(record.letter, 0);
    ck_assert_uint_eq(record.index, 0);
    ck_assert_int_eq(record.tried, 1);
    ck_assert_int_eq(record.keptAlive, 0);
    ck_assert_uint_eq(record.failures, 0);
    ck_assert_int_eq(record.failedLetter, 0);
    ck_assert_int_eq(record.failedStep, MCANOPEN_STEP_IDLE);
    ck_assert_uint_eq(record.failedTime, 0);
    ck_assert_uint_ne(record.bootedTime, 0);
    ck_assert_str_eq(record.failedText, "");
    ck_assert_str_eq(record.file, "");
    ck_assert_str_eq(record.name, "pump");
    ck_assert_str_eq(record.text, "started");
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 6, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.mandatory, 0);
    ck_assert_str_eq(record.name, "");
}
END_TEST

START_TEST(the_record_of_a_wrong_device)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    api_boot(plant, API_NODE_WITH(5, "<Vendor_Identification>0x17F</Vendor_Identification>"));
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.step, MCANOPEN_STEP_FAILED);
    ck_assert_int_eq(record.letter, 'D');
    ck_assert_int_eq(record.booted, 0);
    ck_assert_uint_eq(record.index, 0x1018);
    ck_assert_uint_eq(record.subindex, 1);
    ck_assert_uint_eq(record.abortCode, 0);
    ck_assert_uint_eq(record.expected, 0x17F);
    ck_assert_uint_eq(record.actual, 0x29A);
    ck_assert_uint_eq(record.attempts, 1);
    ck_assert_uint_eq(record.failedExpected, 0x17F);
    ck_assert_uint_eq(record.failedActual, 0x29A);
    ck_assert_ptr_nonnull(strstr(record.text, "boot error D: 1018h:01 vendor-ID is 0000029Ah, "
                                              "configuration expects 0000017Fh"));
}
END_TEST

START_TEST(the_record_of_a_node_that_aborts)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    api_boot(plant, API_NODE_WITH(5, "<Product_Code>1</Product_Code>"));
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.letter, 'M');
    ck_assert_uint_eq(record.subindex, 2);
    ck_assert_uint_eq(record.abortCode, 0x06090011);
}
END_TEST

START_TEST(the_record_of_a_node_that_refuses_its_configuration)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    api_write(plant, "pump.dcf", OBJECT("2001", VAR("2001", "5", "rw") "ParameterValue=7\n"));
    api_boot(plant, API_NODE_WITH(5, "<DCF_File>pump.dcf</DCF_File>"));
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.tried, 1);
    ck_assert_int_eq(record.step, MCANOPEN_STEP_FAILED);
    ck_assert_uint_eq(record.failures, 1);
    ck_assert_int_eq(record.failedStep, MCANOPEN_STEP_CONFIGURE);
    ck_assert_int_eq(record.failedLetter, 'J');
    ck_assert_uint_eq(record.failedIndex, 0x2001);
    ck_assert_uint_eq(record.failedSubindex, 0);
    ck_assert_uint_eq(record.failedAbortCode, 0x06020000);
    ck_assert_uint_eq(record.failedExpected, 7);
    ck_assert_uint_eq(record.failedEntry, 1);
    ck_assert_uint_eq(record.entries, 1);
    ck_assert_uint_eq(record.failedLine, 67);
    ck_assert_str_eq(record.file, "pump.dcf");
    ck_assert_uint_ne(record.failedTime, 0);
    ck_assert_uint_eq(record.bootedTime, 0);
    ck_assert_str_eq(record.failedText, record.text);
    ck_assert_ptr_nonnull(strstr(record.failedText, "(entry 1 of 1 of pump.dcf, line 67)"));
}
END_TEST

/* In the morning the node runs: why did it take two attempts? */
START_TEST(the_record_tells_what_has_failed_before)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    api_boot(plant, API_NODE_WITH(7, "<SDO_Timeout>20</SDO_Timeout>"));
    api_wire_answer(wire, "607#40001000", "587#4300100092010200");
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 7);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 7, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.booted, 1);
    ck_assert_int_eq(record.letter, 0);
    ck_assert_uint_eq(record.attempts, 0);
    ck_assert_uint_ge(record.failures, 1);
    ck_assert_int_eq(record.failedLetter, 'B');
    ck_assert_int_eq(record.failedStep, MCANOPEN_STEP_DEVICE_TYPE);
    ck_assert_uint_eq(record.failedIndex, 0x1000);
    ck_assert_uint_eq(record.failedEntry, 0);
    ck_assert_uint_eq(record.failedLine, 0);
    ck_assert_uint_ge(record.bootedTime, record.failedTime + 1000000);
    ck_assert_ptr_nonnull(strstr(record.failedText, "no answer within 20 ms"));
}
END_TEST

START_TEST(the_record_of_a_node_that_is_kept_alive)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    api_wire_answer(wire, "607#40001000", "587#4300100092010200");
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(
        api_config(plant,
                   API_NODE_WITH(7, "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                                    "<Consumer_Heartbeat_Time>30000</Consumer_Heartbeat_Time>")),
        MCANOPEN_OK);
    mcanOpenStart();
    api_wait_log(plant, "asks for its state");
    api_wire_say(wire, "707#05");
    api_wait_log(plant, "waits for its heartbeat");
    api_wire_say(wire, "707#05");
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 7);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 7, &record), MCANOPEN_OK);
    ck_assert_int_eq(record.keptAlive, 1);
    ck_assert_int_eq(record.letter, 'L');
    ck_assert_int_eq(record.booted, 1);
}
END_TEST

/* Applications of later versions bring larger records, those of the first one a smaller one. */
START_TEST(a_record_has_a_size)
{
    struct {
        BOOT_RECORD_T record;
        char behind[8];
    } larger = { .record = { .size = sizeof larger }, .behind = "behind" };
    const int first = (int)offsetof(BOOT_RECORD_T, failures);
    BOOT_RECORD_T small = { .size = first - 1, .step = -1, .failedStep = -1 };

    boot();
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &small), MCAL_PARA_ERROR);
    ck_assert_int_eq(small.step, -1);
    small.size = first;
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &small), MCANOPEN_OK);
    ck_assert_int_eq(small.size, first);
    ck_assert_int_eq(small.step, MCANOPEN_STEP_STARTED);
    ck_assert_str_eq(small.text, "started");
    ck_assert_int_eq(small.failedStep, -1);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &larger.record), MCANOPEN_OK);
    ck_assert_int_eq(larger.record.step, MCANOPEN_STEP_STARTED);
    ck_assert_int_eq(larger.record.size, sizeof larger);
    ck_assert_str_eq(larger.behind, "behind");
    larger.record.size = sizeof larger;
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 0, &larger.record), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 127, &larger.record), MCAL_NODE_NOT_EXISTEND);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("nodes");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, a_command_to_a_node, 0, ROWS(commands));
    tcase_add_test(tests, a_reset_is_always_reset_node);
    tcase_add_loop_test(tests, a_command_to_all_nodes, 0, ROWS(broadcasts));
    tcase_add_test(tests, the_manager_lets_the_network_start);
    tcase_add_test(tests, a_command_through_the_managers_dictionary);
    tcase_add_test(tests, more_commands_than_the_bus_takes);
    tcase_add_test(tests, commands_wait_until_the_network_has_booted);
    tcase_add_test(tests, who_is_not_master_commands_nobody);
    tcase_add_loop_test(tests, wrong_nets_and_nodes, 0, ROWS(arguments));
    tcase_add_test(tests, a_state_needs_a_place_and_a_node);
    tcase_add_test(tests, a_heartbeat_tells_the_state);
    tcase_add_test(tests, the_record_of_a_node_that_has_booted);
    tcase_add_test(tests, the_record_of_a_wrong_device);
    tcase_add_test(tests, the_record_of_a_node_that_aborts);
    tcase_add_test(tests, the_record_of_a_node_that_refuses_its_configuration);
    tcase_add_test(tests, the_record_tells_what_has_failed_before);
    tcase_add_test(tests, the_record_of_a_node_that_is_kept_alive);
    tcase_add_test(tests, a_record_has_a_size);
    return suite_run("api_nodes", tests);
}

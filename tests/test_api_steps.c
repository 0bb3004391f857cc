/* Where the boot of a node stands, as its record tells: node 7 answers up to a step, no further. */
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stdio.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_write(plant, "a.dcf", OBJECT("2000", VAR("2000", "5", "rw") "ParameterValue=7\n"));
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

static int step_of_node(void)
{
    BOOT_RECORD_T record = { .size = sizeof record };

    ck_assert_int_eq(mcanOpenGetBootRecord(0, 7, &record), MCANOPEN_OK);
    return record.step;
}

static void start(const char *network, const char *node)
{
    char text[1500];

    snprintf(text, sizeof text, "%s<Node_Instance><Node_Id>7</Node_Id>%s</Node_Instance>\n",
             network, node);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(api_config(plant, text) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
}

#define DCF "<DCF_File>a.dcf</DCF_File>"

/* The request that has no answer. */
static const struct row {
    const char *node, *request;
    int step;
} rows[] = {
    { "", "607#40001000", MCANOPEN_STEP_DEVICE_TYPE },
    { "<Vendor_Identification>1</Vendor_Identification>", "607#40181001", MCANOPEN_STEP_IDENTITY },
    { DCF "<Configuration_Date>1</Configuration_Date><Configuration_Time>1</Configuration_Time>",
      "607#40201001", MCANOPEN_STEP_CHECK_CONFIGURATION },
    { DCF, "607#2F002000", MCANOPEN_STEP_CONFIGURE },
    { "<Restore_Configuration>1</Restore_Configuration>", "607#23111001", MCANOPEN_STEP_RESTORE },
    { DCF "<Save_Configuration>TRUE</Save_Configuration>", "607#23101001", MCANOPEN_STEP_SAVE },
    { "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
      "<Software_Identification>2</Software_Identification>",
      "607#40561F01", MCANOPEN_STEP_CHECK_SOFTWARE },
};

static const struct {
    const char *request, *answer;
} answers[] = {
    { "607#40001000", "587#4300100092010200" }, { "607#40181001", "587#4318100101000000" },
    { "607#40201001", "587#4320100102000000" }, { "607#2F002000", "587#6000200000000000" },
    { "607#40561F01", "587#43561F0101000000" },
};

static void answer_all(void)
{
    for (int i = 0; i < ROWS(answers); i++)
        api_wire_answer(wire, answers[i].request, answers[i].answer);
}

START_TEST(a_step_that_waits_for_an_answer)
{
    const struct row *row = &rows[_i];
    char node[500];

    answer_all();
    api_wire_answer(wire, row->request, "");
    snprintf(node, sizeof node, "<SDO_Timeout>60000</SDO_Timeout>%s", row->node);
    start("", node);
    api_wire_wait(wire, row->request, 1);
    ck_assert_int_eq(step_of_node(), row->step);
}
END_TEST

START_TEST(an_update_asks_whether_the_program_runs)
{
    api_write(plant, "a.bin", "program");
    answer_all();
    start("", "<SDO_Timeout>60000</SDO_Timeout><Software_File>a.bin</Software_File>"
              "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
              "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>"
              "<Software_Identification>2</Software_Identification>");
    api_wire_wait(wire, "607#40511F01", 1);
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_UPDATE_SOFTWARE);
}
END_TEST

/* Each step ends when the node answers otherwise. Its program is written in one segment. */
static const struct {
    int told;
    const char *request, *answer; /* from then on */
} update[] = {
    { MCANOPEN_UPDATE_STOP, "607#40511F01", "587#4F511F0100000000" },
    { MCANOPEN_UPDATE_CLEAR, "607#40571F01", "587#43571F0100000000" },
    { MCANOPEN_UPDATE_WRITE, "607#40561F01", "587#43561F0102000000" },
    { MCANOPEN_UPDATE_COMPARE, "607#40511F01", "587#4F511F0101000000" },
    { MCANOPEN_UPDATE_START, "607#4", "" },
};

START_TEST(an_update_tells_what_it_does)
{
    EVENT_T event;

    api_write(plant, "a.bin", "program");
    answer_all();
    api_wire_answer(wire, "607#40511F01", "587#4F511F0101000000");
    api_wire_answer(wire, "607#2F511F01", "587#60511F0100000000");
    api_wire_answer(wire, "607#C", "587#80501F0101000405"); /* no block transfer */
    api_wire_answer(wire, "607#21501F01", "587#60501F0100000000");
    api_wire_answer(wire, "607#0170726F6772616D", "587#2000000000000000");
    start("", "<SDO_Timeout>60000</SDO_Timeout><Software_File>a.bin</Software_File>"
              "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
              "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>"
              "<Software_Identification>2</Software_Identification>");
    for (int i = 0; i < ROWS(update); i++) {
        event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_SOFTWARE_UPDATE), 7);
        ck_assert_int_eq(event.para.uc, update[i].told);
        api_wire_answer(wire, update[i].request, update[i].answer);
    }
}
END_TEST

START_TEST(a_reset_takes_its_time)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(7)), MCANOPEN_OK);
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_IDLE);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    start("", "<Boot_Delay>60000</Boot_Delay><SDO_Timeout>20</SDO_Timeout>");
    answer_all();
    api_wait_event(API_NETWORK_UP, -1);
    ck_assert_int_eq(mcanOpenResetNode(0, 7), MCANOPEN_OK);
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_RESET);
}
END_TEST

#define HEARTBEAT "<Consumer_Heartbeat_Time>30000</Consumer_Heartbeat_Time>"

START_TEST(a_state_is_waited_for)
{
    answer_all();
    start("", HEARTBEAT "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>");
    api_wait_log(plant, "asks for its state");
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_CHECK_STATE);
}
END_TEST

START_TEST(a_heartbeat_is_waited_for)
{
    answer_all();
    start("", HEARTBEAT);
    api_wait_log(plant, "waits for its heartbeat");
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_ERROR_CONTROL);
}
END_TEST

START_TEST(a_node_is_ready_and_then_started)
{
    answer_all();
    start("<NMT_Auto_Operational>FALSE</NMT_Auto_Operational>", "");
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 7);
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_READY);
    ck_assert_int_eq(mcanOpenStartNode(0, 127), MCANOPEN_OK);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STARTED), 7);
    ck_assert_int_eq(step_of_node(), MCANOPEN_STEP_STARTED);
}
END_TEST

/* Without an answer it is tried again, with a wrong one not. */
START_TEST(a_boot_that_fails)
{
    if (_i == 1)
        answer_all();
    start("", _i == 0 ? "<SDO_Timeout>20</SDO_Timeout>"
                      : "<Vendor_Identification>2</Vendor_Identification>");
    api_wait_event(API_EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR), 7);
    ck_assert_int_eq(step_of_node(), _i == 0 ? MCANOPEN_STEP_RETRY : MCANOPEN_STEP_FAILED);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("steps");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, a_step_that_waits_for_an_answer, 0, ROWS(rows));
    tcase_add_test(tests, an_update_asks_whether_the_program_runs);
    tcase_add_test(tests, an_update_tells_what_it_does);
    tcase_add_test(tests, a_reset_takes_its_time);
    tcase_add_test(tests, a_state_is_waited_for);
    tcase_add_test(tests, a_heartbeat_is_waited_for);
    tcase_add_test(tests, a_node_is_ready_and_then_started);
    tcase_add_loop_test(tests, a_boot_that_fails, 0, 2);
    return suite_run("api_steps", tests);
}

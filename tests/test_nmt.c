/* NMT: frames of commands and error control, and the states that commands lead to. */
#include "proto/nmt.h"

#include "support/talk.h"

#include <check.h>

static const struct {
    const char *frame; /* to node 5 */
    unsigned command;  /* 0: not for it */
} commands[] = {
    { "000#0105", NMT_START },
    { "000#0205", NMT_STOP },
    { "000#8005", NMT_ENTER_PREOPERATIONAL },
    { "000#8105", NMT_RESET_NODE },
    { "000#8205", NMT_RESET_COMMUNICATION },
    { "000#8100", NMT_RESET_NODE }, /* all nodes */
    { "000#0106", 0 },
    { "000#0305", 0 },
    { "000#0005", 0 },
    { "000#FF05", 0 },
    { "000#01", 0 },
    { "000#", 0 },
    { "000#010500", 0 },
    { "000#0105000000000000", 0 },
    { "000#R2", 0 },
    { "00000000#0105", 0 },
    { "001#0105", 0 },
};

START_TEST(test_commands)
{
    const struct co_frame frame = talk_frame(commands[_i].frame);
    enum nmt_command command = (enum nmt_command)0;

    ck_assert_int_eq(nmt_command_for(&frame, 5, &command), commands[_i].command != 0);
    ck_assert_uint_eq(command, commands[_i].command);
}
END_TEST

START_TEST(test_frames)
{
    char text[CO_FRAME_TEXT_SIZE];
    struct co_frame frame = nmt_command_frame(NMT_RESET_COMMUNICATION, 0);

    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "000#8200");
    frame = nmt_command_frame(NMT_START, 127);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "000#017F");
    frame = nmt_error_control_frame(5, NMT_PREOPERATIONAL);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "705#7F");
    frame = nmt_error_control_frame(127, NMT_INITIALISING);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "77F#00");
}
END_TEST

static const struct {
    enum nmt_state from;
    enum nmt_command command;
    enum nmt_state to;
} steps[] = {
    { NMT_PREOPERATIONAL, NMT_START, NMT_OPERATIONAL },
    { NMT_STOPPED, NMT_START, NMT_OPERATIONAL },
    { NMT_OPERATIONAL, NMT_START, NMT_OPERATIONAL },
    { NMT_OPERATIONAL, NMT_STOP, NMT_STOPPED },
    { NMT_PREOPERATIONAL, NMT_STOP, NMT_STOPPED },
    { NMT_STOPPED, NMT_ENTER_PREOPERATIONAL, NMT_PREOPERATIONAL },
    { NMT_OPERATIONAL, NMT_ENTER_PREOPERATIONAL, NMT_PREOPERATIONAL },
    { NMT_OPERATIONAL, NMT_RESET_NODE, NMT_INITIALISING },
    { NMT_STOPPED, NMT_RESET_COMMUNICATION, NMT_INITIALISING },
    { NMT_INITIALISING, NMT_START, NMT_INITIALISING },
    { NMT_INITIALISING, NMT_STOP, NMT_INITIALISING },
    { NMT_INITIALISING, NMT_ENTER_PREOPERATIONAL, NMT_INITIALISING },
    { NMT_INITIALISING, NMT_RESET_NODE, NMT_INITIALISING },
};

START_TEST(test_states)
{
    ck_assert_uint_eq(nmt_next_state(steps[_i].from, steps[_i].command), steps[_i].to);
}
END_TEST

static const struct {
    const char *frame;
    bool valid;
    uint8_t node, state;
} reports[] = {
    { "705#00", true, 5, NMT_INITIALISING },
    { "701#05", true, 1, NMT_OPERATIONAL },
    { "77F#7F", true, 127, NMT_PREOPERATIONAL },
    { "705#84", true, 5, NMT_STOPPED },                   /* toggle bit of guarding */
    { "705#0511223344556677", true, 5, NMT_OPERATIONAL }, /* longer than it should be */
    { "705#", false, 0, 0 },
    { "705#R1", false, 0, 0 },
    { "700#05", false, 0, 0 },
    { "780#05", false, 0, 0 },
    { "00000705#05", false, 0, 0 },
};

START_TEST(test_error_control)
{
    const struct co_frame frame = talk_frame(reports[_i].frame);
    uint8_t node = 0, state = 0;

    ck_assert_int_eq(nmt_parse_error_control(&frame, &node, &state), reports[_i].valid);
    ck_assert_uint_eq(node, reports[_i].node);
    ck_assert_uint_eq(state, reports[_i].state);
}
END_TEST

START_TEST(test_texts)
{
    ck_assert_str_eq(nmt_state_text(NMT_INITIALISING), "initialising");
    ck_assert_str_eq(nmt_state_text(NMT_STOPPED), "stopped");
    ck_assert_str_eq(nmt_state_text(NMT_OPERATIONAL), "operational");
    ck_assert_str_eq(nmt_state_text(NMT_PREOPERATIONAL), "pre-operational");
    ck_assert_str_eq(nmt_state_text(3), "unknown state");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("nmt");
    TCase *tcase = tcase_create("nmt");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_commands, 0, sizeof commands / sizeof commands[0]);
    tcase_add_test(tcase, test_frames);
    tcase_add_loop_test(tcase, test_states, 0, sizeof steps / sizeof steps[0]);
    tcase_add_loop_test(tcase, test_error_control, 0, sizeof reports / sizeof reports[0]);
    tcase_add_test(tcase, test_texts);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

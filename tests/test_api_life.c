/* Initialize, Config, Start, ShutDown, Cleanup: the order of calls, and what each leaves behind. */
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

static struct api_plant *plant;

static void set_up(void)
{
    plant = api_plant_new();
}

static void tear_down(void)
{
    api_plant_free(plant);
}

/* What each function that needs a network returns now. */
static void expect_calls(int events, int state, int command)
{
    BOOT_RECORD_T record = { .size = sizeof record };
    char buffer[8] = "";
    int node_state, len = sizeof buffer;
    EVENT_T event;

    ck_assert_int_eq(mcanOpenEvent(&event, 0), events);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &node_state), state);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), state);
    ck_assert_int_eq(mcanOpenStartNode(0, 5), command);
    ck_assert_int_eq(mcanOpenStopNode(0, 5), command);
    ck_assert_int_eq(mcanOpenResetNode(0, 5), command);
    ck_assert_int_eq(mcanOpenEnterPreop(0, 5), command);
    ck_assert_int_eq(mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &len, NULL), command);
    ck_assert_int_eq(mcanOpenWriteSDO(0, 5, 0x2000, 0, TYP_UINT8, buffer, 0, NULL), command);
}

START_TEST(nothing_goes_before_initialize)
{
    expect_calls(MCAL_SYS_ERROR, MCAL_SYS_ERROR, MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenCleanup(), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenShutDown(), MCAL_SYS_ERROR);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCAL_SYS_ERROR);
    ck_assert_str_eq(mcanOpenGetErrorText(),
                     "error: mcanOpenConfig: mcanOpenInitialize comes first");
    mcanOpenStart();
    ck_assert_str_eq(plant->log, "0 error: mcanOpenConfig: mcanOpenInitialize comes first\n"
                                 "0 mcanOpenStart: nothing is configured\n");
}
END_TEST

START_TEST(what_needs_no_initialize)
{
    unsigned short version = 0;

    ck_assert_int_eq(mcanOpenGetVersion(NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenGetVersion(&version), MCANOPEN_OK);
    ck_assert_uint_eq(version >> 12, MCANOPEN_VERSION_MAJOR);
    ck_assert_uint_eq(version >> 8 & 0xF, MCANOPEN_VERSION_MINOR);
    ck_assert_uint_eq(version & 0xFF, MCANOPEN_VERSION_PATCH);
    ck_assert_int_eq(mcanOpenNodeControl(-1, -1, -1), MCANOPEN_OK);
    ck_assert_str_eq(mcanOpenGetErrorText(), "");
    ck_assert_int_eq(mcanOpenSetLog(NULL, NULL), MCANOPEN_OK);
}
END_TEST

START_TEST(nothing_goes_before_config)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    expect_calls(MCAL_NO_NET, MCAL_NO_NET, MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenShutDown(), MCAL_SYS_ERROR);
    mcanOpenStart();
    ck_assert_str_eq(plant->log, "0 mcanOpenStart: nothing is configured\n");
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenCleanup(), MCAL_SYS_ERROR);
}
END_TEST

START_TEST(a_second_initialize_changes_nothing)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
}
END_TEST

START_TEST(commands_wait_for_start)
{
    int state = -1;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    expect_calls(MCAL_NO_EVENT, MCANOPEN_OK, MCAL_NODE_NOT_FREE);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OFFLINE);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 127, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OFFLINE);
    ck_assert_str_eq(plant->log, "");
}
END_TEST

START_TEST(config_sends_nothing_and_is_undone_by_shut_down)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenShutDown(), MCAL_SYS_ERROR);
    expect_calls(MCAL_NO_NET, MCAL_NO_NET, MCAL_NO_NET);
    ck_assert_int_eq(api_config(plant, API_NODE(6)), MCANOPEN_OK);
}
END_TEST

START_TEST(a_second_config_is_refused_and_changes_nothing)
{
    int state;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_str_eq(mcanOpenGetErrorText(), "");
    ck_assert_int_eq(api_config(plant, API_NODE(6)), MCAL_SYS_ERROR);
    ck_assert_str_eq(mcanOpenGetErrorText(), "error: mcanOpenConfig: configured already, "
                                             "mcanOpenShutDown comes first");
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 6, &state), MCAL_NODE_NOT_EXISTEND);
}
END_TEST

START_TEST(a_config_may_succeed_after_one_that_failed)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Nonsense>1</Nonsense>"), MCAL_PARA_ERROR);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "network.xml:7: error: Nonsense"));
    ck_assert_ptr_nonnull(strstr(plant->log, mcanOpenGetErrorText()));
    expect_calls(MCAL_NO_NET, MCAL_NO_NET, MCAL_NO_NET);
    mcanOpenStart();
    ck_assert_uint_eq(api_log_count(plant, "nothing is configured"), 1);
    ck_assert_int_eq(mcanOpenConfig(NULL), MCAL_PARA_ERROR);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_str_eq(mcanOpenGetErrorText(), "");
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
}
END_TEST

START_TEST(cleanup_forgets_the_error_and_the_hook)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Nonsense>1</Nonsense>"), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    ck_assert_str_eq(mcanOpenGetErrorText(), "");
    api_forget_log(plant);
    ck_assert_ptr_nonnull(freopen("/dev/null", "w", stderr));
    mcanOpenStart();
    ck_assert_str_eq(plant->log, "");
}
END_TEST

START_TEST(without_a_hook_warnings_and_errors_go_to_stderr)
{
    char text[400] = "";
    FILE *file;

    ck_assert_ptr_nonnull(freopen(api_path(plant, "stderr"), "w", stderr));
    ck_assert_int_eq(mcanOpenSetLog(NULL, NULL), MCANOPEN_OK);
    api_boot(plant, "");
    mcanOpenStart();
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    fflush(stderr);
    file = fopen(api_path(plant, "stderr"), "r");
    ck_assert_ptr_nonnull(file);
    ck_assert_uint_gt(fread(text, 1, sizeof text - 1, file), 0);
    fclose(file);
    ck_assert_ptr_nonnull(strstr(text, "network.xml:2: warning: Manager_Instance: without any"));
    ck_assert_ptr_nonnull(strstr(text, "\nmcanOpenStart: started already\n"));
    ck_assert_ptr_null(strstr(text, "network is up"));
}
END_TEST

START_TEST(a_network_boots_and_starts_only_once)
{
    int state;

    api_add_device(plant, 5);
    api_devices_start(plant);
    api_boot(plant, API_NODE_WITH(5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"));
    api_wait_log(plant, "2 network is up: 1 of 1 nodes booted\n");
    mcanOpenStart();
    ck_assert_uint_eq(api_log_count(plant, "0 mcanOpenStart: started already\n"), 1);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
}
END_TEST

START_TEST(shut_down_and_cleanup_send_no_nmt_command)
{
    struct api_wire *wire = api_wire_open(plant->bus);

    api_add_device(plant, 5);
    api_devices_start(plant);
    api_boot(plant, API_NODE(5));
    ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    api_wire_say(wire, "605#4001100000000000");
    api_wire_wait(wire, "585#4F011000", 1); /* all that was sent before is there */
    ck_assert_uint_eq(api_wire_count(wire, "000#"), 2);
    ck_assert_uint_eq(api_wire_count(wire, "000#8200"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#0105"), 1);
    api_wire_close(wire);
}
END_TEST

START_TEST(wait_for_startup_waits_until_all_were_tried)
{
    int state;

    api_add_device(plant, 5);
    api_devices_start(plant);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(
        api_config(plant, "<Wait_For_Startup>TRUE</Wait_For_Startup>" API_NODE(5) API_NODE(6)),
        MCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    api_wait_log(plant, "node 6: boot error B: read 1000h:00 device type: no answer");
}
END_TEST

START_TEST(who_is_not_master_has_no_startup_to_wait_for)
{
    int state;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, "<Wait_For_Startup>TRUE</Wait_For_Startup>"
                                       "<NMT_Master>FALSE</NMT_Master>" API_NODE(5)),
                     MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_NETWORK_UP, -1);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 127, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenStartNode(0, 5), MCAL_NODE_NOT_FREE);
}
END_TEST

START_TEST(fifty_lives)
{
    api_add_device(plant, 5);
    api_devices_start(plant);
    for (unsigned i = 0; i < 50; i++) {
        ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
        if (i % 5 != 0)
            ck_assert_int_eq(api_config(plant, "<Boot_Time>100</Boot_Time>" API_NODE(5)),
                             MCANOPEN_OK);
        if (i % 5 > 1)
            mcanOpenStart();
        if (i % 5 == 3)
            api_wait_event(API_NETWORK_UP, -1);
        if (i % 5 == 4)
            ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
        ck_assert_int_eq(mcanOpenCleanup(), MCANOPEN_OK);
    }
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("life");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, nothing_goes_before_initialize);
    tcase_add_test(tests, what_needs_no_initialize);
    tcase_add_test(tests, nothing_goes_before_config);
    tcase_add_test(tests, a_second_initialize_changes_nothing);
    tcase_add_test(tests, commands_wait_for_start);
    tcase_add_test(tests, config_sends_nothing_and_is_undone_by_shut_down);
    tcase_add_test(tests, a_second_config_is_refused_and_changes_nothing);
    tcase_add_test(tests, a_config_may_succeed_after_one_that_failed);
    tcase_add_test(tests, cleanup_forgets_the_error_and_the_hook);
    tcase_add_test(tests, without_a_hook_warnings_and_errors_go_to_stderr);
    tcase_add_test(tests, a_network_boots_and_starts_only_once);
    tcase_add_test(tests, shut_down_and_cleanup_send_no_nmt_command);
    tcase_add_test(tests, wait_for_startup_waits_until_all_were_tried);
    tcase_add_test(tests, who_is_not_master_has_no_startup_to_wait_for);
    tcase_add_test(tests, fifty_lives);
    return suite_run("api_life", tests);
}

/* What the elements of <Manager_Instance> do: seen on the bus, in states and by events. */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2000, 1, 0);
    api_devices_start(plant);
    ck_assert_int_eq(unsetenv("MCANOPEN_NET_0"), 0);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

/* --- which network --- */

START_TEST(net_no)
{
    char text[1500];
    int state;

    snprintf(text, sizeof text, "<CANopen_Manager>%s</CANopen_Manager>",
             api_network(plant, 3, API_NODE(5))); /* Net_No 3 */
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config_text(plant, text), MCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(api_wait_event(API_NETWORK_UP, -1).net, 3);
    ck_assert_int_eq(mcanOpenGetNodeState(3, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCAL_NO_NET);
}
END_TEST

/* A bus that has a bit rate of its own. */
START_TEST(baudrate)
{
    static const char format[] =
        "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>%d</Baudrate>"
        "<Interface>%s-rate?bitrate=250000</Interface>" API_NODE(5) "</Manager_Instance>"
                                                                    "</CANopen_Manager>";
    char text[sizeof format + sizeof plant->bus];

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    snprintf(text, sizeof text, format, 250, plant->bus);
    ck_assert_int_eq(api_config_text(plant, text), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    snprintf(text, sizeof text, format, 500, plant->bus);
    ck_assert_int_eq(api_config_text(plant, text), CANOPEN_DCF_WRONG_BAUDRATE);
}
END_TEST

/* That of api_network(); without it there would be can0. */
START_TEST(interface)
{
    ck_assert_ptr_nonnull(strstr(api_network(plant, 0, ""), "<Interface>virtual:"));
    api_boot(plant, API_NODE_WITH(5, API_PATIENT));
    api_wire_wait(wire, "000#0105", 1);
}
END_TEST

START_TEST(name)
{
    api_boot(plant, "<Name>conveyor</Name>" API_NODE_WITH(5, API_PATIENT));
    api_wait_log(plant, "2 conveyor: network is up: 1 of 1 nodes booted");
}
END_TEST

START_TEST(manager_node_id)
{
    int state;

    api_boot(plant, "<Manager_Node_Id>1</Manager_Node_Id>" API_NODE(5));
    ck_assert_int_eq(mcanOpenGetNodeState(0, 1, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    api_wire_wait(wire, "701#00", 1);
}
END_TEST

static const char *const repositories[] = { "Config_File_Repository", "Config_File_Path" };

START_TEST(config_file_repository)
{
    char text[500];
    uint8_t value = 0;

    ck_assert_int_eq(mkdir(api_path(plant, "dcf"), 0700), 0);
    api_write(plant, "dcf/a.dcf", OBJECT("2000", VAR("2000", "5", "rw") "ParameterValue=7\n"));
    snprintf(text, sizeof text,
             "<%s>%s</%s>" API_NODE_WITH(5, API_PATIENT "<DCF_File>a.dcf</DCF_File>"),
             repositories[_i], api_path(plant, "dcf"), repositories[_i]);
    api_boot(plant, text);
    ck_assert_uint_eq(api_get(plant, 5, 0x2000, &value, 1), 1);
    ck_assert_uint_eq(value, 7);
}
END_TEST

/* --- what the manager sends by itself --- */

START_TEST(heartbeat_producer_time)
{
    api_start(plant, "<Heartbeat_Producer_Time>100</Heartbeat_Producer_Time>" API_NODE(5));
    api_wire_wait(wire, "77F#05", 2);
}
END_TEST

START_TEST(sync_interval)
{
    api_start(plant, "<Sync_Interval>20000</Sync_Interval>" API_NODE(5));
    api_wire_wait(wire, "080#", 3);
}
END_TEST

START_TEST(sync_cob_id)
{
    api_start(plant,
              "<Sync_Interval>20000</Sync_Interval><Sync_Cob_Id>0x90</Sync_Cob_Id>" API_NODE(5));
    api_wire_wait(wire, "090#", 2);
    ck_assert_uint_eq(api_wire_count(wire, "080#"), 0);
}
END_TEST

/* Node 6 is not in the file, node 5 comes behind it. */
START_TEST(preset_emergency_consumer)
{
    api_boot(plant, "<Preset_Emergency_Consumer>TRUE</Preset_Emergency_Consumer>" API_NODE(5));
    api_wire_say(wire, "086#1081110102030405");
    api_wire_say(wire, "085#1081110102030405");
    ck_assert_int_eq(api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY), -1).node, 6);
}
END_TEST

/* --- the first reset --- */

START_TEST(nmt_reset_all)
{
    api_start(plant, "<NMT_Reset_All>TRUE</NMT_Reset_All>" API_NODE(5));
    api_wire_wait(wire, "000#8", 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#8100"), 1);
}
END_TEST

START_TEST(boot_delay)
{
    static const char format[] =
        "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>500</Baudrate>"
        "<Interface>%s</Interface><Boot_Delay>450</Boot_Delay>" API_NODE(5) "</Manager_Instance>"
                                                                            "</CANopen_Manager>";
    char text[sizeof format + sizeof plant->bus];
    co_us_t begin;

    snprintf(text, sizeof text, format, plant->bus);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config_text(plant, text), MCANOPEN_OK);
    begin = clock_now();
    mcanOpenStart();
    ck_assert_uint_ge(api_wire_time(wire, "605#40001000", 1), begin + CO_MS(450));
}
END_TEST

/* --- starting --- */

START_TEST(nmt_start_all)
{
    api_boot(plant, "<NMT_Start_All>TRUE</NMT_Start_All>" API_NODE_WITH(5, API_PATIENT));
    api_wait_state(0, 5, MCANOPEN_STATE_OPERATIONAL);
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "000#0100"), 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#0105"), 0);
}
END_TEST

/* The manager is operational, and starts nobody. */
START_TEST(nmt_auto_start)
{
    api_start(plant, "<NMT_Auto_Start>FALSE</NMT_Auto_Start>" API_NODE(5));
    api_wait_state(0, 127, MCANOPEN_STATE_OPERATIONAL);
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "000#01"), 0);
    ck_assert_int_eq(mcanOpenStartNode(0, 5), MCANOPEN_OK);
    api_wire_wait(wire, "000#0105", 1);
}
END_TEST

/* --- a mandatory node is lost: its heartbeat answers that of the manager, until it does not --- */

#define LOSS                                                                                       \
    "<Heartbeat_Producer_Time>100</Heartbeat_Producer_Time>" API_NODE(5)                           \
        API_NODE_WITH(9, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"                         \
                         "<Consumer_Heartbeat_Time>250</Consumer_Heartbeat_Time>")
#define ACTION(name) "<NMT_Action_On_Error>" name "</NMT_Action_On_Error>"

static void lose_node(const char *inner)
{
    api_wire_answer(wire, "609#40001000", "589#4300100092010200");
    api_wire_answer(wire, "77F#", "709#05");
    api_boot(plant, inner);
    api_wire_answer(wire, "77F#", "");
    api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_HEARTBEAT_LOST), 9);
}

START_TEST(nmt_action_on_error_reset_all)
{
    lose_node(ACTION("RESET_ALL") LOSS);
    api_wire_wait(wire, "000#8100", 1);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_BOOT_UP), 5);
}
END_TEST

START_TEST(nmt_action_on_error_stop_all)
{
    lose_node(ACTION("STOP_ALL") LOSS);
    api_wire_wait(wire, "000#0200", 1);
    api_wait_state(0, 127, MCANOPEN_STATE_STOPPED);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("elements");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, net_no);
    tcase_add_test(tests, baudrate);
    tcase_add_test(tests, interface);
    tcase_add_test(tests, name);
    tcase_add_test(tests, manager_node_id);
    tcase_add_loop_test(tests, config_file_repository, 0, ROWS(repositories));
    tcase_add_test(tests, heartbeat_producer_time);
    tcase_add_test(tests, sync_interval);
    tcase_add_test(tests, sync_cob_id);
    tcase_add_test(tests, preset_emergency_consumer);
    tcase_add_test(tests, nmt_reset_all);
    tcase_add_test(tests, boot_delay);
    tcase_add_test(tests, nmt_start_all);
    tcase_add_test(tests, nmt_auto_start);
    tcase_add_test(tests, nmt_action_on_error_reset_all);
    tcase_add_test(tests, nmt_action_on_error_stop_all);
    return suite_run("api_elements", tests);
}

/*
 * What the elements of <Node_Instance> do: seen on the bus and by events. Node 5 is a device, node
 * 7 answers what the test lets it.
 */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <stdio.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    struct od *od;

    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    od = &plant->devices[5].od;
    for (uint8_t sub = 2; sub <= 4; sub++)
        ck_assert_int_eq(od_add_number(od, 0x1018, sub, OD_UNSIGNED32, OD_RO, sub), CO_OK);
    ck_assert_int_eq(od_add_number(od, 0x1F56, 1, OD_UNSIGNED32, OD_RO, 1), CO_OK);
    api_devices_start(plant);
    api_wire_answer(wire, "607#40001000", "587#4300100092010200");
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

/* --- which node --- */

START_TEST(node_id)
{
    int state;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE_WITH(5, API_PATIENT)), MCANOPEN_OK); /* Node_Id 5 */
    ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &state), MCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(api_wait_boot(5), 0);
    api_wire_wait(wire, "000#0105", 1);
}
END_TEST

START_TEST(name)
{
    api_start(plant, API_NODE_WITH(5, "<Name>pump</Name>"));
    api_wait_log(plant, "node 5 \"pump\": booted");
}
END_TEST

/* --- whether it is booted and started --- */

START_TEST(nmt_slave)
{
    api_boot(plant, API_NODE_WITH(5, "<NMT_Slave>FALSE</NMT_Slave>"));
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "605#"), 0);
    ck_assert_uint_eq(api_wire_count(wire, "000#01"), 0);
}
END_TEST

/* It comes up, and nobody but the application takes notice. */
START_TEST(nmt_auto_start_slave)
{
    api_boot(plant, API_NODE_WITH(7, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"));
    api_wire_say(wire, "707#00");
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_BOOT_UP), 7);
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "607#"), 0);
    ck_assert_uint_eq(api_wire_count(wire, "000#01"), 0);
}
END_TEST

/* Node 9 is not there. */
START_TEST(nmt_mandatory_slave)
{
    int state;

    api_start(plant, API_NODE(5) API_NODE_WITH(9, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
                                                  "<SDO_Timeout>20</SDO_Timeout>"));
    ck_assert_int_eq(api_wait_boot(9), 'B');
    api_wire_settle(wire);
    ck_assert_int_eq(mcanOpenGetNodeState(0, 127, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_PREOPERATIONAL);
    ck_assert_uint_eq(api_wire_count(wire, "000#01"), 0);
}
END_TEST

/* It runs, as its heartbeat says, and is left alone. */
START_TEST(nmt_check_nodestate)
{
    EVENT_T event;

    api_wire_answer(wire, "77F#", "707#05");
    api_start(plant, "<Heartbeat_Producer_Time>100</Heartbeat_Producer_Time>" API_NODE_WITH(
                         7, API_PATIENT "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                                        "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>"));
    event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 7);
    ck_assert_uint_eq(event.para.uc, 'L');
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "000#"), 0);
}
END_TEST

/* --- its own reset --- */

/* That of node 7 waits for its state, so node 5 is reset by itself. */
START_TEST(nmt_reset_node)
{
    api_start(plant, API_NODE_WITH(5, "<NMT_Reset_Node>TRUE</NMT_Reset_Node>")
                         API_NODE_WITH(7, "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"));
    api_wire_wait(wire, "000#8", 1);
    ck_assert_uint_eq(api_wire_count(wire, "000#8105"), 1);
}
END_TEST

START_TEST(boot_delay)
{
    unsigned before;
    co_us_t begin;

    api_boot(plant, API_NODE_WITH(5, API_PATIENT "<Boot_Delay>450</Boot_Delay>"));
    api_wire_settle(wire);
    before = api_wire_count(wire, "605#40001000");
    begin = clock_now();
    ck_assert_int_eq(mcanOpenResetNode(0, 5), MCANOPEN_OK);
    ck_assert_uint_ge(api_wire_time(wire, "605#40001000", before + 1), begin + CO_MS(450));
}
END_TEST

/* --- is it the right one --- */

static const struct identity {
    const char *inner; /* of its node */
    int letter;
} identities[] = {
    { API_NODE_WITH(5, API_PATIENT "<Device_Type_Identification>1</Device_Type_Identification>"),
      'C' },
    { API_NODE_WITH(5, API_PATIENT "<Vendor_Identification>1</Vendor_Identification>"), 'D' },
    { API_NODE_WITH(5, API_PATIENT "<Product_Code>1</Product_Code>"), 'M' },
    { API_NODE_WITH(5, API_PATIENT "<Revision_Number>1</Revision_Number>"), 'N' },
    { API_NODE_WITH(5, API_PATIENT "<Serial_Number>1</Serial_Number>"), 'O' },
};

START_TEST(identity)
{
    api_start(plant, identities[_i].inner);
    ck_assert_int_eq(api_wait_boot(5), identities[_i].letter);
}
END_TEST

/* The device has 1. */
START_TEST(software_identification)
{
    api_start(plant,
              API_NODE_WITH(5, API_PATIENT "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
                                           "<Software_Identification>2</Software_Identification>"));
    ck_assert_int_eq(api_wait_boot(5), 'H');
    api_wire_settle(wire);
    ck_assert_uint_eq(api_wire_count(wire, "605#40561F01"), 1);
}
END_TEST

/* --- how long it may take --- */

START_TEST(sdo_timeout)
{
    const co_us_t begin = clock_now();

    api_start(plant, API_NODE_WITH(9, "<SDO_Timeout>450</SDO_Timeout>"));
    ck_assert_uint_ge(api_wire_time(wire, "609#8000100000000405", 1), begin + CO_MS(20 + 450));
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("elements of nodes");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, node_id);
    tcase_add_test(tests, name);
    tcase_add_test(tests, nmt_slave);
    tcase_add_test(tests, nmt_auto_start_slave);
    tcase_add_test(tests, nmt_mandatory_slave);
    tcase_add_test(tests, nmt_check_nodestate);
    tcase_add_test(tests, nmt_reset_node);
    tcase_add_test(tests, boot_delay);
    tcase_add_loop_test(tests, identity, 0, ROWS(identities));
    tcase_add_test(tests, software_identification);
    tcase_add_test(tests, sdo_timeout);
    return suite_run("api_elements_node", tests);
}

/* mcanOpenEvent: the news of a network, brought about from outside, with codes and texts. */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <string.h>

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2001, 1, 0x11);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

static void expect_text(const EVENT_T *event, const char *expected)
{
    char text[MCANOPEN_EVENT_TEXT_SIZE];

    ck_assert_int_eq(mcanOpenEventText(event, text, sizeof text), MCANOPEN_OK);
    ck_assert_str_eq(text, expected);
}

START_TEST(a_boot_tells_its_steps)
{
    static const int steps[] = { MCANOPEN_STEP_DEVICE_TYPE, MCANOPEN_STEP_CONFIGURE };
    EVENT_T event;

    api_write(plant, "5.dcf",
              "[DeviceInfo]\nVendorNumber=1\n[2001]\nParameterName=value\nDataType=5\n"
              "AccessType=rw\nParameterValue=9\n[OptionalObjects]\nSupportedObjects=1\n1=0x2001\n");
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_msg(api_config(plant, API_NODE_WITH(5, "<DCF_File>5.dcf</DCF_File>")) == MCANOPEN_OK,
                  "%s", mcanOpenGetErrorText());
    mcanOpenStart();
    for (unsigned i = 0; i < 2; i++) {
        event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_BOOT_STEP), 5);
        ck_assert_int_eq(event.para.uc, steps[i]);
    }
    expect_text(&event, "Net: 0 Node: 5 boot step 5 (configuration)");
    event = api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_CONFIGURED), 5);
    ck_assert_uint_eq(event.para.ul, 1);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_BOOTED), 5);
    api_wait_log(plant, "2 node 5: configured, entries written: 1");
}
END_TEST

START_TEST(a_wrong_mandatory_node_halts_the_network)
{
    EVENT_T event;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE_WITH(5, "<NMT_Mandatory_Slave>TRUE"
                                                        "</NMT_Mandatory_Slave>"
                                                        "<Vendor_Identification>1"
                                                        "</Vendor_Identification>")),
                     MCANOPEN_OK);
    mcanOpenStart();
    event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NETWORK_HALTED), 5);
    ck_assert_uint_eq(event.para.uc, 1);
    expect_text(&event, "Net: 0 Node: 5 has failed, network halted, mandatory nodes missing: 1");
}
END_TEST

/* --- what others do --- */

static const struct {
    const char *frame;
    unsigned long kind;
    unsigned times; /* to be said */
    int node;       /* -1: all */
    unsigned char uc;
    const char *text;
} doings[] = {
    { "000#0205", PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND, 1, 5, MCANOPEN_NMT_STOP,
      "Net: 0 Node: 5 another NMT master commands 2 (stop)" },
    { "000#8000", PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND, 1, -1, MCANOPEN_NMT_ENTER_PREOPERATIONAL,
      "Net: 0 another NMT master commands 128 (enter pre-operational)" },
    { "000#0105", PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND, 1, 5, MCANOPEN_NMT_START,
      "Net: 0 Node: 5 another NMT master commands 1 (start)" },
    { "000#8105", PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND, 1, 5, MCANOPEN_NMT_RESET_NODE,
      "Net: 0 Node: 5 another NMT master commands 129 (reset node)" },
    { "000#8205", PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND, 1, 5, MCANOPEN_NMT_RESET_COMMUNICATION,
      "Net: 0 Node: 5 another NMT master commands 130 (reset communication)" },
    { "67F#2F821F0504000000", PARA_UC | MCANOPEN_MSG_REQUESTED_COMMAND, 1, 5, MCANOPEN_NMT_STOP,
      "Net: 0 Node: 5 a tool commands by 1F82h 2 (stop)" },
    { "77F#05", PARA_UC | MCANOPEN_MSG_NODE_ID_TAKEN, 1, 127, MCANOPEN_STATE_OPERATIONAL,
      "Net: 0 Node: 127 another device has the node-ID of the manager, state 5 (operational)" },
    { "705#7F", PARA_UC | MCANOPEN_MSG_NOT_STARTED, 6, 5, MCANOPEN_STATE_PREOPERATIONAL,
      "Net: 0 Node: 5 does not follow its start command, state 127 (pre-operational)" },
};

START_TEST(what_others_do_is_told)
{
    EVENT_T event;

    api_boot(plant, API_NODE(5));
    api_wire_wait(wire, "000#0105", 1);
    for (unsigned i = 0; i < doings[_i].times; i++)
        api_wire_say(wire, doings[_i].frame);
    event = api_wait_event(doings[_i].kind, doings[_i].node);
    ck_assert_int_eq(event.node, doings[_i].node);
    ck_assert_uint_eq(event.para.uc, doings[_i].uc);
    expect_text(&event, doings[_i].text);
}
END_TEST

/* 1F82h has an event of its own. */
START_TEST(a_write_to_the_managers_dictionary)
{
    EVENT_T event;

    api_boot(plant, "<Sync_Interval>50000</Sync_Interval>" API_NODE(5));
    api_wire_say(wire, "67F#2F821F0504000000");
    api_wire_wait(wire, "5FF#60821F05", 1);
    api_wire_say(wire, "67F#2306100040420F00");
    event = api_wait_event(API_EVENT(PARA_WRITE, MCANOPEN_MSG_OBJECT_WRITTEN), 127);
    ck_assert_uint_eq(event.para.write.index, 0x1006);
    expect_text(&event, "Net: 0 Node: 127 object written, 1006h:00");
    api_wait_log(plant, "2 node 127 (manager): a tool has written 1006h:00");
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("news");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, a_boot_tells_its_steps);
    tcase_add_test(tests, a_wrong_mandatory_node_halts_the_network);
    tcase_add_loop_test(tests, what_others_do_is_told, 0, ROWS(doings));
    tcase_add_test(tests, a_write_to_the_managers_dictionary);
    return suite_run("api_news", tests);
}

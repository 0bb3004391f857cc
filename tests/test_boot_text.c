#include "manager/boot_text.h"

#include "base/bytes.h"
#include "mcanopen.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

static struct node_config nodes[2];
static struct network_config config;
static char pump[] = "pump", dcf[] = "pump.dcf";

/* Node 5 is "pump" with a file, node 6 has no name, 127 is the manager. */
static void set_up(void)
{
    static const uint8_t value[4] = { 1, 2, 3, 4 };

    nodes[0] = (struct node_config){ .node_id = 5,
                                     .name = pump,
                                     .dcf_file = dcf,
                                     .nmt_slave = true,
                                     .auto_start_slave = true,
                                     .boot_delay = 300,
                                     .sdo_timeout = 200,
                                     .consumer_heartbeat_time = 1500 };
    nodes[1] = (struct node_config){ .node_id = 6 };
    ccf_init(&nodes[0].ccf);
    for (uint8_t i = 0; i < 7; i++)
        ck_assert_int_eq(ccf_append(&nodes[0].ccf, 0x2000, i, value, 4), CO_OK);
    config = (struct network_config){ .manager_node_id = 127,
                                      .boot_time = 5000,
                                      .nodes = nodes,
                                      .node_count = 2,
                                      .refusals = { [2] = "1F20h:17: error: it is" },
                                      .refused = 6 };
}

static void tear_down(void)
{
    ccf_done(&nodes[0].ccf);
}

/* --- events --- */

#define EVENT(...)                                                                                 \
    {                                                                                              \
        .type = MANAGER_##__VA_ARGS__                                                              \
    }

static const struct told {
    struct co_event event;
    enum co_severity severity;
    const char *text; /* NULL: nothing to be told */
} events[] = {
    { EVENT(STATE, .node = 127, .detail = NMT_OPERATIONAL), CO_INFO,
      "node 127 (manager): is operational" },
    { EVENT(NETWORK_UP, .actual = 3, .expected = 4), CO_INFO,
      "network is up: 3 of 4 nodes booted" },
    { EVENT(HALTED, .node = 5, .actual = 1, .expected = 5000), CO_ERROR,
      "network not started: mandatory node 5 \"pump\" is missing after 5000 ms (Boot_Time)" },
    { EVENT(HALTED, .node = 6, .actual = 2), CO_ERROR,
      "network not started: 2 mandatory nodes are missing, among them node 6" },
    { EVENT(WAITING, .node = 6, .actual = 1), CO_WARNING,
      "network waits: mandatory node 6 is missing" },
    { EVENT(NODE_STEP, .node = 5, .detail = BOOT_RESET), CO_INFO,
      "node 5 \"pump\": reset, boot delay 300 ms" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_DEVICE_TYPE), CO_INFO,
      "node 6: boot begins, asks for its device type" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_IDENTITY), CO_INFO,
      "node 6: checks its identity" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_CHECK_CONFIGURATION), CO_INFO,
      "node 6: checks its configuration date" },
    { EVENT(NODE_STEP, .node = 5, .detail = BOOT_CONFIGURE, .actual = 7), CO_INFO,
      "node 5 \"pump\": configures it: 7 entries of pump.dcf" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_CONFIGURE, .actual = 1), CO_INFO,
      "node 6: configures it: 1 entry of the configuration" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_SAVE), CO_INFO,
      "node 6: saves its configuration" },
    { EVENT(NODE_STEP, .node = 6, .detail = BOOT_RESTORE), CO_INFO,
      "node 6: restores its default values" },
    { EVENT(NODE_STEP, .node = 5, .detail = BOOT_ERROR_CONTROL), CO_INFO,
      "node 5 \"pump\": waits for its heartbeat, at most 1500 ms" },
    { EVENT(NODE_STEP, .node = 5, .detail = BOOT_READY), 0, NULL },
    { EVENT(NODE_STEP, .node = 5, .detail = 99), 0, NULL },
    { EVENT(NODE_READ, .node = 5, .index = 0x1018, .sub = 2, .actual = 0xABCD), CO_INFO,
      "node 5 \"pump\": 1018h:02 product code is 0000ABCDh" },
    { EVENT(NODE_READ, .node = 5, .index = 0x1020, .sub = 1, .actual = 7), CO_INFO,
      "node 5 \"pump\": 1020h:01 is 00000007h" },
    { EVENT(NODE_COMPARED, .node = 6, .expected = 12, .actual = 0), CO_INFO,
      "node 6: is configured already (entries compared: 12)" },
    { EVENT(NODE_COMPARED, .node = 6, .expected = 12, .actual = 3), CO_INFO,
      "node 6: entries written: 3 of 12, the others were there" },
    { EVENT(NODE_CONFIGURED, .node = 6, .expected = 12, .actual = 12), CO_INFO,
      "node 6: configured, entries written: 12" },
    { EVENT(WRITTEN, .node = 127, .index = 0x1006, .sub = 0), CO_INFO,
      "node 127 (manager): a tool has written 1006h:00" },
    { EVENT(NODE_UP_TO_DATE, .node = 6), CO_INFO, "node 6: is configured already (1020h)" },
    { EVENT(NODE_BOOTED, .node = 6), CO_INFO, "node 6: booted" },
    { EVENT(NODE_STARTED, .node = 6), CO_INFO, "node 6: start command sent" },
    { EVENT(NODE_STATE, .node = 6, .detail = NMT_STOPPED), CO_INFO, "node 6: is stopped" },
    { EVENT(NODE_STATE, .node = 6, .detail = 9), CO_INFO, "node 6: is unknown state" },
    { EVENT(NODE_BOOT_UP, .node = 6, .actual = 1), CO_INFO, "node 6: boot-up message" },
    { EVENT(NODE_BOOT_UP, .node = 77), CO_INFO,
      "node 77: boot-up message of a node that is not configured" },
    { EVENT(NODE_LOST, .node = 5, .detail = NMT_OPERATIONAL, .expected = 1500), CO_ERROR,
      "node 5 \"pump\": heartbeat lost: silent for 1500 ms, was operational" },
    { EVENT(NODE_BACK, .node = 5, .detail = NMT_OPERATIONAL), CO_INFO,
      "node 5 \"pump\": heartbeat is back, operational" },
    { EVENT(EMCY, .node = 77, .code = 0x8110, .detail = 0x11,
            .data = { 0x10, 0x81, 0x11, 1, 2, 3, 4, 255 }),
      CO_WARNING,
      "node 77: emergency 8110h, CAN overrun, objects lost, error register 11h, field 01 02 03 04 "
      "FF" },
    { EVENT(SECOND_MASTER, .node = 0, .detail = NMT_RESET_NODE), CO_WARNING,
      "another NMT master is on the bus: it commands \"reset node\" to all nodes" },
    { EVENT(SECOND_MASTER, .node = 5, .detail = NMT_ENTER_PREOPERATIONAL), CO_WARNING,
      "another NMT master is on the bus: it commands \"enter pre-operational\" to node 5" },
    { EVENT(NMT_REQUEST, .node = 0, .detail = NMT_STOP), CO_INFO,
      "a tool commands by 1F82h: \"stop\" to all nodes" },
    { EVENT(NMT_REQUEST, .node = 5, .detail = NMT_START), CO_INFO,
      "a tool commands by 1F82h: \"start\" to node 5" },
    { EVENT(CONFIG_REFUSED, .node = 5, .index = 0x1F20, .sub = 5, .actual = 6), CO_WARNING,
      "node 5 \"pump\": what a tool has written to 1F20h:05 is refused: 1F20h:17: error: it is" },
    { EVENT(CONFIG_REFUSED, .node = 77, .index = 0x1F22, .sub = 77, .actual = 2), CO_WARNING,
      "node 77: what a tool has written to 1F22h:4D is refused; why is no longer known: others "
      "were refused since" },
    { EVENT(SYNC_MISSING), CO_WARNING, "SYNC is not on the bus: the interface does not send it" },
    { EVENT(REQUEST_DONE, .node = 5), 0, NULL },
};

START_TEST(test_event)
{
    const struct told *told = &events[_i];
    char text[BOOT_TEXT_SIZE];
    enum co_severity severity = CO_INFO;
    bool is = boot_text_event(&config, &told->event, &severity, text, sizeof text);

    ck_assert_msg(is == (told->text != NULL), "event %d: %s", _i, text);
    if (!told->text)
        return;
    ck_assert_str_eq(text, told->text);
    ck_assert_int_eq(severity, told->severity);
}
END_TEST

/* Cut off, but whole up to there, in a buffer of any size. */
START_TEST(test_event_in_little_room)
{
    const struct told *told = &events[_i];
    char text[BOOT_TEXT_SIZE];
    enum co_severity severity;

    if (!told->text)
        return;
    for (size_t size = 1; size < strlen(told->text) + 2; size++) {
        memset(text, '#', sizeof text);
        ck_assert(boot_text_event(&config, &told->event, &severity, text, size));
        ck_assert_uint_eq(strlen(text), size <= strlen(told->text) ? size - 1 : strlen(told->text));
        ck_assert_int_eq(strncmp(text, told->text, strlen(text)), 0);
        ck_assert_int_eq(text[size], '#');
    }
}
END_TEST

/* --- failures: as an event, and as the state of a node --- */

static const struct failed {
    struct boot_failure failure;
    const char *text;
} failures[] = {
    { { .letter = 'B',
        .step = BOOT_DEVICE_TYPE,
        .outcome = SDO_OUTCOME_NO_ANSWER,
        .index = 0x1000 },
      "B: read 1000h:00 device type: no answer within 200 ms (3 tries): the node is absent or off, "
      "or has another node-ID or bit rate" },
    { { .letter = 'B', .step = BOOT_DEVICE_TYPE, .outcome = SDO_OUTCOME_NOT_SENT, .index = 0x1000 },
      "B: read 1000h:00 device type: the request could not be sent: check the bus" },
    { { .letter = 'M',
        .step = BOOT_IDENTITY,
        .index = 0x1018,
        .sub = 2,
        .expected = 1,
        .actual = 0xFFFFFFFF },
      "M: 1018h:02 product code is FFFFFFFFh, configuration expects 00000001h: wrong device at "
      "node 5, or remove Product_Code to skip the check" },
    { { .letter = 'O',
        .step = BOOT_IDENTITY,
        .outcome = SDO_OUTCOME_ABORTED,
        .index = 0x1018,
        .sub = 4,
        .abort_code = SDO_NO_SUB },
      "O: read 1018h:04 serial number: the node answers abort 06090011h, sub-index does not "
      "exist: remove Serial_Number to skip the check" },
    { { .letter = 'J',
        .step = BOOT_CONFIGURE,
        .outcome = SDO_OUTCOME_ABORTED,
        .index = 0x1A00,
        .sub = 1,
        .abort_code = SDO_NOT_MAPPABLE,
        .entry = 3,
        .expected = 0x20,
        .size = 1 },
      "J: write 1A00h:01 = 20h (entry 3 of 7 of pump.dcf): the node answers abort 06040041h, "
      "object cannot be mapped to a PDO: the device's manual tells what it can map; 8 bytes in "
      "all" },
    { { .letter = 'J',
        .step = BOOT_CONFIGURE,
        .outcome = SDO_OUTCOME_TOGGLE,
        .index = 0x2000,
        .abort_code = SDO_TOGGLE,
        .entry = 7,
        .size = 20 },
      "J: write 2000h:00 (20 bytes) (entry 7 of 7 of pump.dcf): wrong answer, aborted with "
      "05030000h, toggle bit not alternated: two masters on the bus, or two devices with this "
      "node-ID?" },
    { { .letter = 'J',
        .step = BOOT_CONFIGURE,
        .outcome = SDO_OUTCOME_NO_ANSWER,
        .index = 0x2000,
        .entry = 1,
        .size = 255 },
      "J: write 2000h:00 (255 or more bytes) (entry 1 of 7 of pump.dcf): no answer within 200 "
      "ms: has it gone, or is it slow there (SDO_Timeout)?" },
    { { .letter = 'J',
        .step = BOOT_CONFIGURE,
        .outcome = SDO_OUTCOME_NO_ANSWER,
        .index = 0x1011,
        .sub = 1,
        .entry = 1,
        .size = 4,
        .expected = 0x64616F6C },
      "J: write 1011h:01 = 64616F6Ch (entry 1 of 7 of pump.dcf): no answer within 10000 ms: "
      "has it gone, or is it slow there (SDO_Timeout)?" },
    { { .letter = 'J',
        .step = BOOT_SAVE,
        .outcome = SDO_OUTCOME_NO_ANSWER,
        .index = 0x1010,
        .sub = 1 },
      "J: write 1010h:01 \"save\": no answer within 10000 ms: has it gone, or is it slow there "
      "(SDO_Timeout)?" },
    { { .letter = 'K', .step = BOOT_ERROR_CONTROL, .expected = 1500 },
      "K: no heartbeat within 1500 ms (Consumer_Heartbeat_Time): the configuration does not set "
      "1017h: add it, with a half of that time" },
    { { .letter = 'E', .step = BOOT_CHECK_STATE, .expected = 1500 },
      "E: no heartbeat within 1500 ms: the state of this node, which is to be kept alive "
      "(NMT_Check_Nodestate), is not known; it is not reset: reset it by hand" },
    { { .letter = 'F', .step = BOOT_CHECK_STATE },
      "F: no answer to guarding within 100 ms: the state of this node, which is to be kept alive "
      "(NMT_Check_Nodestate), is not known; it is not reset: reset it by hand" },
};

START_TEST(test_failure)
{
    const struct failed *failed = &failures[_i];
    struct co_event event = boot_failure_event(&failed->failure);
    struct boot_node node;
    char text[BOOT_TEXT_SIZE], expected[BOOT_TEXT_SIZE];
    enum co_severity severity;

    event.node = 5;
    ck_assert(boot_text_event(&config, &event, &severity, text, sizeof text));
    ck_assert_int_eq(severity, CO_ERROR);
    snprintf(expected, sizeof expected, "node 5 \"pump\": boot error %s", failed->text);
    ck_assert_str_eq(text, expected);
    boot_node_init(&node, 5, &nodes[0]);
    node.failure = failed->failure;
    node.step = BOOT_FAILED;
    node.attempts = 2;
    boot_text_node(&node, text, sizeof text);
    snprintf(expected, sizeof expected, "boot error %s", failed->text);
    ck_assert_str_eq(text, expected);
    boot_text_failure(&nodes[0], &failed->failure, text, sizeof text);
    ck_assert_str_eq(text, expected);
    node.step = BOOT_RETRY;
    boot_text_node(&node, text, sizeof text);
    snprintf(expected, sizeof expected, "boot error %s; tried 2 times", failed->text);
    ck_assert_str_eq(text, expected);
    node.step = BOOT_DEVICE_TYPE; /* in the middle of the next try */
    boot_text_node(&node, text, sizeof text);
    ck_assert_str_eq(text, expected);
    node.attempts = 0; /* since its boot-up message */
    boot_text_node(&node, text, sizeof text);
    ck_assert_ptr_null(strstr(text, "tried"));
    node.booted = true;
    node.step = BOOT_STARTED;
    boot_text_node(&node, text, sizeof text);
    ck_assert_str_eq(text, "started");
}
END_TEST

/* --- what to do about it --- */

static const struct advised {
    char letter;
    uint8_t step;
    uint16_t index;
    uint8_t sub;
    sdo_abort_t code;
    const char *advice; /* behind the code's own text; "": none */
} advised[] = {
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_NO_OBJECT,
      ": is the file of another device, or of another version of it?" },
    { 'J', BOOT_CONFIGURE, 0x2000, 9, SDO_NO_SUB,
      ": is the file of another device, or of another version of it?" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_READ_ONLY, ": take its ParameterValue out of the file" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_VALUE_HIGH,
      ": the device's manual has its limits; correct the file" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_TYPE_LENGTH,
      ": the file has another data type than the device" },
    { 'J', BOOT_CONFIGURE, 0x1A00, 0, SDO_PDO_LENGTH,
      ": the device's manual tells what it can map; 8 bytes in all" },
    { 'J', BOOT_CONFIGURE, 0x1A00, 1, SDO_ACCESS,
      ": a mapping is changed while its sub-index 0 is 0 and the PDO is switched off" },
    { 'J', BOOT_CONFIGURE, 0x1600, 1, SDO_DEVICE_STATE,
      ": a mapping is changed while its sub-index 0 is 0 and the PDO is switched off" },
    { 'J', BOOT_CONFIGURE, 0x1800, 2, SDO_GENERAL,
      ": a PDO is changed while it is switched off (bit 31 of its COB-ID)" },
    { 'J', BOOT_CONFIGURE, 0x15FF, 1, SDO_INVALID_VALUE,
      ": a PDO is changed while it is switched off (bit 31 of its COB-ID)" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_DEVICE_STATE,
      ": the device takes it in another state: its manual, its switches" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_HARDWARE,
      ": the device's errors (1001h, 1003h) may tell more" },
    { 'J', BOOT_CONFIGURE, 0x2000, 0, SDO_GENERAL, "" },
    { 'J', BOOT_SAVE, 0x1010, 1, SDO_NO_OBJECT,
      ": the device cannot save: remove Save_Configuration" },
    { 'J', BOOT_SAVE, 0x1010, 1, SDO_NOT_STORED,
      ": its manual tells when it can save; or remove Save_Configuration" },
    { 'B', BOOT_DEVICE_TYPE, 0x1000, 0, SDO_NO_OBJECT, ": is it in its boot loader?" },
    { 'B', BOOT_DEVICE_TYPE, 0x1000, 0, SDO_TIMEOUT, "" }, /* a frame was lost */
    { 'D', BOOT_IDENTITY, 0x1018, 1, SDO_TIMEOUT, "" },
    { 'D', BOOT_IDENTITY, 0x1018, 1, SDO_NO_OBJECT,
      ": remove Vendor_Identification to skip the check" },
    { 'I', BOOT_UPDATE_SOFTWARE, 0x1F51, 1, SDO_NO_OBJECT,
      ": the device has no program download: update it by its own tool" },
    { 'I', BOOT_UPDATE_SOFTWARE, 0x1F50, 1, SDO_HARDWARE, "" },
    { 'G', BOOT_CHECK_SOFTWARE, 0x1F56, 1, SDO_NO_OBJECT,
      ": remove NMT_Verify_Software to skip the check" },
};

START_TEST(test_advice)
{
    const struct advised *row = &advised[_i];
    const struct boot_failure failure = { .letter = row->letter,
                                          .step = row->step,
                                          .outcome = SDO_OUTCOME_ABORTED,
                                          .index = row->index,
                                          .sub = row->sub,
                                          .abort_code = row->code,
                                          .entry = row->step == BOOT_CONFIGURE ? 1
                                                   : row->step == BOOT_UPDATE_SOFTWARE
                                                       ? SOFTWARE_STOP
                                                       : 0 };
    char text[BOOT_TEXT_SIZE], end[BOOT_TEXT_SIZE];

    snprintf(end, sizeof end, "abort %08Xh, %s%s", row->code, sdo_abort_text(row->code),
             row->advice);
    boot_text_failure(&nodes[0], &failure, text, sizeof text);
    ck_assert_msg(strlen(text) > strlen(end) && strcmp(text + strlen(text) - strlen(end), end) == 0,
                  "%s", text);
    ck_assert_uint_lt(strlen(text), sizeof((BOOT_RECORD_T *)0)->text);
}
END_TEST

/* What the configuration writes to 1017h, and what is said of it; -1: nothing. */
static const struct {
    int time;
    const char *text;
} heartbeats[] = {
    { -1, "the configuration does not set 1017h: add it, with a half of that time" },
    { 0, "the configuration sets 1017h to 0, no heartbeat: set a half of that time" },
    { 1500, "the configuration sets 1017h to 1500 ms: that is too long" },
    { 700, "1017h is set to 700 ms, but none comes: has the node gone?" },
};

START_TEST(test_no_heartbeat)
{
    const struct boot_failure failure = { .letter = 'K',
                                          .step = BOOT_ERROR_CONTROL,
                                          .expected = 1500 };
    uint8_t value[2];
    char text[BOOT_TEXT_SIZE];

    put_le16(value, (uint16_t)heartbeats[_i].time);
    if (heartbeats[_i].time >= 0)
        ck_assert_int_eq(ccf_append(&nodes[0].ccf, 0x1017, 0, value, 2), CO_OK);
    boot_text_failure(&nodes[0], &failure, text, sizeof text);
    ck_assert_msg(strstr(text, heartbeats[_i].text) != NULL, "%s", text);
}
END_TEST

START_TEST(test_no_failure)
{
    struct boot_failure none = { .letter = 0 };
    char text[] = "before";

    boot_text_failure(&nodes[0], &none, text, sizeof text);
    ck_assert_str_eq(text, "");
}
END_TEST

/* Made from a DCF, an entry has a line there. */
START_TEST(test_line_of_an_entry)
{
    struct boot_failure failure = { .letter = 'J',
                                    .step = BOOT_CONFIGURE,
                                    .index = 0x2000,
                                    .entry = 7,
                                    .size = 1,
                                    .outcome = SDO_OUTCOME_ABORTED,
                                    .abort_code = SDO_READ_ONLY };
    char text[BOOT_TEXT_SIZE];

    ck_assert_int_eq(ccf_note_line(&nodes[0].ccf, 88), CO_OK); /* of the last one */
    boot_text_failure(&nodes[0], &failure, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "(entry 7 of 7 of pump.dcf, line 88): the node answers"));
}
END_TEST

/* --- what a node waits for --- */

static const struct waits {
    enum boot_step step;
    const char *text;
} waits[] = {
    { BOOT_IDLE, "not booted yet" },
    { BOOT_RESET, "in its boot delay after a reset" },
    { BOOT_DEVICE_TYPE, "waits for the answer to 1000h" },
    { BOOT_IDENTITY, "waits for the answer to 1018h" },
    { BOOT_CHECK_CONFIGURATION, "waits for the answer to 1020h" },
    { BOOT_CONFIGURE, "is being configured, entry 3 of 7" },
    { BOOT_RESTORE, "restores its default values" },
    { BOOT_SAVE, "saves its configuration" },
    { BOOT_ERROR_CONTROL, "waits for its heartbeat" },
    { BOOT_READY, "booted, not started" },
    { BOOT_STARTED, "started" },
};

START_TEST(test_waits)
{
    struct boot_node node;
    char text[BOOT_TEXT_SIZE];

    boot_node_init(&node, 5, &nodes[0]);
    node.step = (uint8_t)waits[_i].step;
    node.entry_number = 3;
    boot_text_node(&node, text, sizeof text);
    ck_assert_str_eq(text, waits[_i].text);
}
END_TEST

START_TEST(test_not_ours)
{
    struct boot_node node;
    char text[BOOT_TEXT_SIZE];

    boot_node_init(&node, 6, &nodes[1]);
    boot_text_node(&node, text, sizeof text);
    ck_assert_str_eq(text, "not booted by this master");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("boot_text");
    int event_count = sizeof events / sizeof events[0];

    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_loop_test(tcase, test_event, 0, event_count);
    tcase_add_loop_test(tcase, test_event_in_little_room, 0, event_count);
    tcase_add_loop_test(tcase, test_failure, 0, sizeof failures / sizeof failures[0]);
    tcase_add_loop_test(tcase, test_advice, 0, sizeof advised / sizeof advised[0]);
    tcase_add_loop_test(tcase, test_no_heartbeat, 0, sizeof heartbeats / sizeof heartbeats[0]);
    tcase_add_test(tcase, test_no_failure);
    tcase_add_test(tcase, test_line_of_an_entry);
    tcase_add_loop_test(tcase, test_waits, 0, sizeof waits / sizeof waits[0]);
    tcase_add_test(tcase, test_not_ours);
    return suite_run("boot_text", tcase);
}

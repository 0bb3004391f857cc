/* Each event of the managers and networks: what the application gets of it, and as which text. */
#include "api/event_map.h"

#include "manager/event.h"
#include "runtime/network.h"
#include "support/suite.h"

#include <string.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))
#define NEWS(...)                                                                                  \
    {                                                                                              \
        .type = __VA_ARGS__                                                                        \
    }

static struct node_config node = { .node_id = 5, .sdo_timeout = 200 };
static const struct network_config config = {
    .net = 1, .manager_node_id = 127, .nodes = &node, .node_count = 1
};

/* NULL: nothing, it is for the log. A failure gives more, see below. */
static const struct {
    struct co_event event;
    unsigned long kind; /* of EVENT_T.event */
    const char *text;
} news[] = {
    { NEWS(MANAGER_STATE, .node = 127, .detail = NMT_OPERATIONAL),
      PARA_UC | MCANOPEN_MSG_MANAGER_STATE, "Net: 1 Node: 127 manager, state 5 (operational)" },
    { NEWS(MANAGER_NETWORK_UP, .actual = 3), PARA_UC | NOD_NOT_VAL | MCANOPEN_MSG_NETWORK_UP,
      "Net: 1 network is up, booted nodes: 3" },
    { NEWS(MANAGER_HALTED, .node = 5, .actual = 2, .expected = 150),
      PARA_US | NOD_NOT_VAL | MCANOPEN_MSG_BOOT_TIME_OVER,
      "Net: 1 mandatory nodes are missing, Boot_Time over, ms: 150" },
    { NEWS(MANAGER_HALTED, .node = 5, .actual = 2), PARA_UC | MCANOPEN_MSG_NETWORK_HALTED,
      "Net: 1 Node: 5 has failed, network halted, mandatory nodes missing: 2" },
    { NEWS(MANAGER_WAITING, .node = 5, .actual = 300), PARA_UC | MCANOPEN_MSG_NODES_MISSING,
      "Net: 1 Node: 5 is missing, mandatory nodes missing in all: 255" },
    { NEWS(MANAGER_NODE_STEP, .node = 5, .detail = BOOT_CONFIGURE),
      PARA_UC | MCANOPEN_MSG_BOOT_STEP, "Net: 1 Node: 5 boot step 5 (configuration)" },
    { NEWS(MANAGER_NODE_STEP, .node = 5, .detail = BOOT_READY), 0, NULL },
    { NEWS(MANAGER_NODE_STEP, .node = 5, .detail = BOOT_STARTED), 0, NULL },
    { NEWS(MANAGER_NODE_READ, .node = 5, .index = 0x1000), 0, NULL },
    { NEWS(MANAGER_NODE_UP_TO_DATE, .node = 5), PARA_UL | MCANOPEN_MSG_CONFIGURED,
      "Net: 1 Node: 5 configured, entries written: 0" },
    { NEWS(MANAGER_NODE_COMPARED, .node = 5, .expected = 7, .actual = 2),
      PARA_UL | MCANOPEN_MSG_CONFIGURED, "Net: 1 Node: 5 configured, entries written: 2" },
    { NEWS(MANAGER_NODE_CONFIGURED, .node = 5, .expected = 7, .actual = 7),
      PARA_UL | MCANOPEN_MSG_CONFIGURED, "Net: 1 Node: 5 configured, entries written: 7" },
    { NEWS(MANAGER_NODE_SOFTWARE, .node = 5, .detail = SOFTWARE_WRITE),
      PARA_UC | MCANOPEN_MSG_SOFTWARE_UPDATE,
      "Net: 1 Node: 5 software update, step 6 (write the program)" },
    { NEWS(MANAGER_NODE_BOOTED, .node = 5, .detail = 'L'), PARA_UC | MCANOPEN_MSG_NODE_BOOTED,
      "Net: 1 Node: 5 booted, was operational already" },
    { NEWS(MANAGER_NODE_STARTED, .node = 5), PARA_UC | MCANOPEN_MSG_NODE_STARTED,
      "Net: 1 Node: 5 started, state 5 (operational)" },
    { NEWS(MANAGER_NODE_UNFOLLOWED, .node = 5, .detail = NMT_PREOPERATIONAL, .actual = 3),
      PARA_UC | MCANOPEN_MSG_NOT_STARTED,
      "Net: 1 Node: 5 does not follow its start command, state 127 (pre-operational)" },
    { NEWS(MANAGER_NODE_STATE, .node = 5, .detail = NMT_STOPPED), PARA_UC | MCANOPEN_MSG_NODE_STATE,
      "Net: 1 Node: 5 NMT state 4 (stopped)" },
    { NEWS(MANAGER_NODE_BOOT_UP, .node = 5, .actual = 1), PARA_UC | MCANOPEN_MSG_BOOT_UP,
      "Net: 1 Node: 5 boot-up message" },
    { NEWS(MANAGER_NODE_LOST, .node = 5, .expected = 70000), PARA_US | MCANOPEN_MSG_HEARTBEAT_LOST,
      "Net: 1 Node: 5 heartbeat lost, consumer time in ms: 65535" },
    { NEWS(MANAGER_NODE_LOST, .node = 5, .expected = 300, .actual = 1),
      PARA_US | MCANOPEN_MSG_GUARDING_LOST,
      "Net: 1 Node: 5 no answer to guarding, time in ms: 300" },
    { NEWS(MANAGER_NODE_TOGGLE, .node = 5, .actual = 2), PARA_I | MCANOPEN_MSG_GUARDING_TOGGLE,
      "Net: 1 Node: 5 guarding toggle error no 2" }, /* the manual's own example */
    { NEWS(MANAGER_NODE_BACK, .node = 5, .expected = 300), PARA_US | MCANOPEN_MSG_HEARTBEAT_BACK,
      "Net: 1 Node: 5 heartbeat is back, consumer time in ms: 300" },
    { NEWS(MANAGER_NODE_BACK, .node = 5, .expected = 300, .actual = 1),
      PARA_US | MCANOPEN_MSG_GUARDING_BACK,
      "Net: 1 Node: 5 answers guarding again, time in ms: 300" },
    { NEWS(MANAGER_EMCY, .node = 5, .code = 0x8110, .detail = 0x11),
      PARA_UL | MCANOPEN_MSG_EMERGENCY,
      "Net: 1 Node: 5 emergency: error code 8110h, error register 11h" },
    { NEWS(MANAGER_SECOND_MASTER, .node = 5, .detail = NMT_STOP),
      PARA_UC | MCANOPEN_MSG_FOREIGN_COMMAND,
      "Net: 1 Node: 5 another NMT master commands 2 (stop)" },
    { NEWS(MANAGER_NMT_REQUEST, .node = 0, .detail = NMT_RESET_NODE),
      PARA_UC | NOD_NOT_VAL | MCANOPEN_MSG_REQUESTED_COMMAND,
      "Net: 1 a tool commands by 1F82h 129 (reset node)" },
    { NEWS(MANAGER_NODE_ID_TAKEN, .node = 127, .detail = NMT_INITIALISING),
      PARA_UC | MCANOPEN_MSG_NODE_ID_TAKEN,
      "Net: 1 Node: 127 another device has the node-ID of the manager, state 0 (offline)" },
    { NEWS(MANAGER_DROPPED, .actual = 3), PARA_UL | NOD_NOT_VAL | MCANOPEN_MSG_FRAMES_LOST,
      "Net: 1 CAN frames lost: 3" },
    { NEWS(MANAGER_REQUEST_DONE, .node = 5), 0, NULL },
    { NEWS(MANAGER_SYNC_MISSING, .node = 127), PARA_UC | NOD_NOT_VAL | MCANOPEN_MSG_SYNC_MISSING,
      "Net: 1 SYNC is not on the bus" },
    { NEWS(MANAGER_WRITTEN, .node = 127, .index = 0x1006), PARA_WRITE | MCANOPEN_MSG_OBJECT_WRITTEN,
      "Net: 1 Node: 127 object written, 1006h:00" },
    { NEWS(MANAGER_CONFIG_REFUSED, .node = 5, .index = 0x1F22, .sub = 5, .actual = 1),
      PARA_STR | MCANOPEN_MSG_TEXT,
      "Net: 1 Node: 5 message: node 5: what a tool has written to 1F22h:05 is refused; why is " },
    { NEWS(RUNTIME_FRAMES_LOST, .actual = 4), PARA_UL | NOD_NOT_VAL | MCANOPEN_MSG_FRAMES_LOST,
      "Net: 1 CAN frames lost: 4" },
    { NEWS(RUNTIME_UNSENT, .actual = 5), PARA_UL | NOD_NOT_VAL | MCANOPEN_MSG_FRAMES_UNSENT,
      "Net: 1 CAN frames not sent in time: 5" },
    { NEWS(RUNTIME_BUS_STATE, .detail = BUS_OFF), PARA_I | NOD_NOT_VAL | MCANOPEN_MSG_BUS_STATE,
      "Net: 1 CAN bus state 3 (bus-off)" },
    { NEWS(RUNTIME_BUSY), PARA_UC | NOD_NOT_VAL | MCANOPEN_MSG_BUS_BUSY,
      "Net: 1 frames have to wait for the bus" },
    { NEWS(RUNTIME_FRAME, .code = 0x705, .index = 1), 0, NULL }, /* for the log */
};

START_TEST(an_event_has_its_code_and_its_text)
{
    char text[MCANOPEN_EVENT_TEXT_SIZE];
    EVENT_T events[EVENT_MAP_MAX];

    ck_assert_uint_eq(event_map(&config, &news[_i].event, events), news[_i].text ? 1 : 0);
    if (!news[_i].text)
        return;
    ck_assert_uint_eq((unsigned long)events[0].event, news[_i].kind);
    ck_assert_int_ge(events[0].event, 0); /* zero-extended; with 32 bits only without NET_NOT_VAL */
    ck_assert_int_eq(events[0].net, 1);
    ck_assert_int_eq(events[0].node, (news[_i].kind & NOD_NOT_VAL) ? -1 : news[_i].event.node);
    ck_assert_int_eq(mcanOpenEventText(&events[0], text, sizeof text), MCANOPEN_OK);
    ck_assert_str_eq(text, news[_i].text);
}
END_TEST

static bool is_in_table(unsigned type)
{
    bool is = type == MANAGER_NODE_FAILED;

    for (int i = 0; i < ROWS(news); i++)
        is |= news[i].event.type == type;
    return is;
}

/* A new event has to be decided on. */
START_TEST(no_event_is_forgotten)
{
    for (unsigned type = MANAGER_STATE; type < MANAGER_EVENTS_END; type++)
        ck_assert_msg(is_in_table(type), "event %u of the manager", type);
    for (unsigned type = RUNTIME_FRAMES_LOST; type <= RUNTIME_FRAME; type++)
        ck_assert_msg(is_in_table(type), "event %u of the network", type);
}
END_TEST

static const struct {
    char letter;
    unsigned long kind;
} aborts[] = {
    { 'D', PARA_WRITE | MCANOPEN_MSG_BOOT_READ_ABORTED },
    { 'J', PARA_WRITE | MCANOPEN_MSG_CONFIGURATION_ABORTED },
    { 'I', PARA_WRITE | MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED },
};

START_TEST(a_failure_has_a_letter_an_abort_and_a_text)
{
    struct boot_failure failure = { .letter = aborts[_i].letter,
                                    .step = BOOT_IDENTITY,
                                    .outcome = SDO_OUTCOME_ABORTED,
                                    .index = 0x1018,
                                    .sub = 1,
                                    .abort_code = SDO_NO_SUB };
    struct co_event event = boot_failure_event(&failure);
    EVENT_T events[EVENT_MAP_MAX];

    event.node = 5;
    ck_assert_uint_eq(event_map(&config, &event, events), 3);
    ck_assert_uint_eq((unsigned long)events[0].event, PARA_C | MCANOPEN_MSG_BOOT_ERROR);
    ck_assert_int_eq(events[0].para.c, aborts[_i].letter);
    ck_assert_uint_eq((unsigned long)events[1].event, aborts[_i].kind);
    ck_assert_uint_eq(events[1].para.write.index, 0x1018);
    ck_assert_uint_eq(events[1].para.write.err.global, 0x11);
    ck_assert_uint_eq((unsigned long)events[2].event, PARA_STR | MCANOPEN_MSG_TEXT);
    ck_assert_uint_eq(strlen(events[2].para.str), sizeof events[2].para.str - 1);
    failure.outcome = SDO_OUTCOME_NO_ANSWER;
    event = boot_failure_event(&failure);
    event.node = 5;
    ck_assert_uint_eq(event_map(&config, &event, events), 2);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("event_map");

    tcase_add_loop_test(tests, an_event_has_its_code_and_its_text, 0, ROWS(news));
    tcase_add_test(tests, no_event_is_forgotten);
    tcase_add_loop_test(tests, a_failure_has_a_letter_an_abort_and_a_text, 0, ROWS(aborts));
    return suite_run("event_map", tests);
}

/*
 * Configuration over the network: other tools write 1F80h..1F89h of the manager's dictionary, and
 * the network boots with what they have written.
 */
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#include <stdio.h>

#define LISTED    0x01u /* bits of 1F81h */
#define BOOTED    0x05u
#define MANDATORY 0x08u
#define KEPT      0x10u

#define RESET_COMM 0x07 /* values of 1F82h */

static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    for (uint8_t node = 5; node <= 7; node++)
        plant_add_object(plant_add_device(plant, node), 0x6200, 1, 1, 0);
    watch_start(plant);
    tool_attach(plant);
    plant_power_on(plant);
    return plant;
}

static struct plant *run_plant(const char *xml)
{
    struct plant *plant = make_plant(xml);

    plant_run_ms(plant, 1000);
    return plant;
}

static void put(struct plant *plant, uint16_t index, uint8_t sub, uint32_t value)
{
    ck_assert_uint_eq(tool_put(plant, index, sub, 4, value), 0);
    plant_run_ms(plant, 2); /* what follows from it is behind the answer */
}

static int state_of(const struct plant *plant, uint8_t node)
{
    return plant->devices[node]->slave.state;
}

static void expect_state(const struct plant *plant, uint8_t node, int state)
{
    ck_assert_msg(state_of(plant, node) == state, "node %u is %d, not %d", node,
                  state_of(plant, node), state);
}

static void boot_all_anew(struct plant *plant)
{
    ck_assert_uint_eq(tool_put(plant, 0x1F82, 0x80, 1, RESET_COMM), 0);
    plant_run_ms(plant, 1000);
}

/* --- values --- */

static const struct write {
    uint16_t index;
    uint8_t sub, size;
    uint32_t value;
    uint32_t code, read;
} writes[] = {
    { 0x1016, 5, 4, 0x000501F4, 0, 0x000501F4 },
    { 0x1016, 5, 4, 0x000601F4, 0x06090030, 0 },
    { 0x1016, 5, 4, 0x010501F4, 0x06090030, 0 },
    { 0x1016, 5, 4, 0x000001F4, 0x06090030, 0 },
    { 0x1016, 5, 4, 0x00050000, 0, 0 },
    { 0x1016, 5, 4, 0, 0, 0 },
    { 0x1F26, 5, 4, 9000, 0, 9000 },
    { 0x1F27, 5, 4, 1000, 0, 1000 },
    { 0x1F55, 5, 4, 0x22, 0, 0x22 },
    { 0x1F80, 0, 4, 0x5, 0, 0x5 },
    { 0x1F80, 0, 4, 0x1B, 0, 0x1B },
    { 0x1F80, 0, 4, 0x43, 0, 0x43 },
    { 0x1F80, 0, 4, 0x0, 0x06090030, 1 },
    { 0x1F80, 0, 4, 0x51, 0x06090030, 1 },
    { 0x1F80, 0, 4, 0x21, 0x06090030, 1 },
    { 0x1F80, 0, 4, 0x81, 0x06090030, 1 },
    { 0x1F80, 0, 4, 0x80000001, 0x06090030, 1 },
    { 0x1F80, 0, 2, 0x1, 0x06070013, 1 },
    { 0x1F81, 77, 4, 0xFEDCA57D, 0, 0xFEDCA57D },
    { 0x1F81, 77, 4, 0xFD, 0, 0xFD },
    { 0x1F81, 77, 4, 0x03, 0x06090030, 0 },
    { 0x1F81, 127, 4, 0x05, 0x06090030, 0 },
    { 0x1F81, 127, 4, 0, 0, 0 },
    { 0x1F81, 0, 1, 1, 0x06010002, 127 },
    { 0x1F84, 5, 4, 0x191, 0, 0x191 },
    { 0x1F85, 5, 4, 0xFFFFFFFF, 0, 0xFFFFFFFF },
    { 0x1F86, 5, 4, 3, 0, 3 },
    { 0x1F87, 5, 4, 4, 0, 4 },
    { 0x1F88, 127, 4, 4, 0x06090030, 0 },
    { 0x1F88, 126, 4, 4, 0, 4 },
    { 0x1F89, 0, 4, 100000, 0, 100000 },
    { 0x1F8A, 5, 1, 127, 0, 127 },
    { 0x1F8A, 5, 1, 128, 0x06090030, 0 },
    { 0x1028, 5, 4, 0x85, 0x06010002, 0x80000000 },
};

START_TEST(test_values)
{
    const struct write *row = &writes[_i];
    struct plant *plant = run_plant("");

    ck_assert_uint_eq(tool_put(plant, row->index, row->sub, row->size, row->value), row->code);
    ck_assert_uint_eq(tool_get(plant, row->index, row->sub), row->read);
    if (row->code != 0)
        ck_assert_uint_eq(plant->config->node_count, 0);
    boot_all_anew(plant);
    ck_assert_uint_eq(tool_get(plant, row->index, row->sub), row->read);
    plant_free(plant);
}
END_TEST

/* A refused write of a node that is there leaves all of it as it was. */
START_TEST(test_refused)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "<Guard_Time>100</Guard_Time>"));

    ck_assert_uint_eq(tool_put(plant, 0x1F81, 5, 4, 0x00C80103), 0x06090030);
    ck_assert_uint_eq(tool_get(plant, 0x1F81, 5), 0x00640005);
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_master)
{
    struct plant *plant = run_plant("<NMT_Master>FALSE</NMT_Master>");

    ck_assert_uint_eq(tool_put(plant, 0x1F81, 5, 4, BOOTED), 0x08000021);
    ck_assert_uint_eq(tool_put(plant, 0x1F89, 0, 4, 1), 0x08000021);
    ck_assert_uint_eq(tool_get(plant, 0x1F81, 5), 0);
    ck_assert_uint_eq(plant->config->node_count, 0);
    plant_free(plant);
}
END_TEST

START_TEST(test_told)
{
    struct plant *plant = run_plant("");

    put(plant, 0x1F85, 5, 0x29A);
    ck_assert(plant_said(plant, "info: node 127 (manager): a tool has written 1F85h:05"));
    ck_assert_uint_eq(tool_put(plant, 0x1F81, 5, 4, 2), 0x06090030);
    ck_assert(!plant_said(plant, "1F81h"));
    plant_free(plant);
}
END_TEST

/* The manager hears a request while its owner takes no frames, or no events. */
static void say_unheeded(struct plant *plant, const char *text, bool no_events)
{
    const struct co_frame frame = { .id = 0x123 };
    const struct co_event event = { .type = MANAGER_NODE_STEP };
    struct co_frame frames[1], request;
    struct co_event events[1];
    struct co_outbox full;

    ck_assert(co_frame_parse(text, &request));
    co_outbox_init(&full, frames, 1, events, 1);
    if (no_events)
        co_outbox_put_event(&full, &event);
    else
        co_outbox_put_frame(&full, &frame);
    manager_on_frame(plant->manager, &request, plant->sim.now, &full);
}

/* What cannot be answered is not done. */
START_TEST(test_no_room)
{
    const struct co_frame filler = { .id = 0x123 };
    struct plant *plant = run_plant("");

    while (co_outbox_room(&plant->manager->inner, 4, 0))
        co_outbox_put_frame(&plant->manager->inner, &filler);
    say_unheeded(plant, "67F#23811F0505000000", false);
    plant_run_ms(plant, 1100);
    ck_assert_uint_eq(plant_sent(plant, "5FF#80811F0520000008"), 1);
    ck_assert_uint_eq(plant->config->node_count, 0);
    put(plant, 0x1F81, 5, BOOTED);
    plant_free(plant);
}
END_TEST

/* The tool has given up before the manager could look at what it wrote. */
START_TEST(test_given_up)
{
    struct plant *plant = run_plant("");

    say_unheeded(plant, "67F#23811F0505000000", true);
    say_unheeded(plant, "67F#80811F0500000405", true);
    plant_run_ms(plant, 1100);
    ck_assert_uint_eq(plant->config->node_count, 0);
    plant_free(plant);
}
END_TEST

/* --- nodes --- */

/* A file without any node: all of the network comes from the tool. */
START_TEST(test_empty_network)
{
    struct plant *plant = run_plant("");

    ck_assert(plant_said(plant, "network is up: 0 of 0 nodes booted"));
    for (uint8_t node = 5; node <= 6; node++) {
        put(plant, 0x1F84, node, 0x20192);
        put(plant, 0x1F88, node, node);
        put(plant, 0x1F81, node, BOOTED | MANDATORY);
    }
    plant_run_ms(plant, 500);
    expect_state(plant, 5, NMT_OPERATIONAL);
    expect_state(plant, 6, NMT_OPERATIONAL);
    expect_state(plant, 7, NMT_PREOPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 5), " r1018:4");
    ck_assert_uint_eq(tool_get(plant, 0x1028, 5), 0x85);
    ck_assert_uint_eq(tool_get(plant, 0x1F82, 5), 5);
    boot_all_anew(plant);
    ck_assert(plant_said(plant, "network is up: 2 of 2 nodes booted"));
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* The first write that makes it one of the network resets it: who knows what it was before. */
START_TEST(test_joins)
{
    struct plant *plant = run_plant(PLANT_NODE(5, ""));

    sim_say(&plant->sim, "000#0106");
    plant_run_ms(plant, 10);
    expect_state(plant, 6, NMT_OPERATIONAL);
    put(plant, 0x1F81, 6, BOOTED);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_run_ms(plant, 500);
    expect_state(plant, 6, NMT_OPERATIONAL);
    put(plant, 0x1F81, 6, BOOTED);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    plant_free(plant);
}
END_TEST

/* One that runs and is to be kept alive is asked first. */
START_TEST(test_joins_kept_alive)
{
    struct plant *plant = run_plant("");

    plant_configure(plant, 6, 0x6200, 1, 1, 7);
    sim_say(&plant->sim, "000#0106");
    plant_run_ms(plant, 10);
    put(plant, 0x1F81, 6, BOOTED | KEPT | 0x00640300);
    plant_run_ms(plant, 500);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 0);
    ck_assert_int_eq(plant_node(plant, 6)->kept_alive, true);
    expect_state(plant, 6, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Listed, but not booted by the manager: it is watched only, until bit 2 says otherwise. */
START_TEST(test_watched_only)
{
    struct plant *plant = run_plant("");

    put(plant, 0x1F81, 6, LISTED | 0x00640300);
    plant_run_ms(plant, 500);
    expect_state(plant, 6, NMT_PREOPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 6), "");
    ck_assert_uint_ge(plant_sent(plant, "706#R"), 4);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 0);
    put(plant, 0x1F81, 6, BOOTED | 0x00640300);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    plant_run_ms(plant, 500);
    expect_state(plant, 6, NMT_OPERATIONAL);
    put(plant, 0x1F81, 6, LISTED | 0x00640300);
    plant_run_ms(plant, 500);
    expect_state(plant, 6, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* In the boot delay, it is booted with the others. */
START_TEST(test_joins_in_boot_delay)
{
    struct plant *plant = make_plant("");

    plant_run_ms(plant, 50);
    put(plant, 0x1F81, 5, BOOTED | MANDATORY);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    plant_run_ms(plant, 1000);
    expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    ck_assert(plant_said(plant, "network is up: 1 of 1 nodes booted"));
    plant_free(plant);
}
END_TEST

/* While the network is stopped nobody answers; the manager's SDO server of its own does not. */
START_TEST(test_stopped)
{
    struct plant *plant = run_plant(
        "<NMT_Action_On_Error>STOP_ALL</NMT_Action_On_Error>" PLANT_NODE(
            5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
               "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"));

    plant_power(plant, 5, false);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant->manager->state, NETWORK_STOPPED);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, 6, 4, BOOTED), TOOL_SILENCE);
    ck_assert_uint_eq(plant->config->node_count, 1);
    plant_free(plant);
}
END_TEST

/* Its heartbeat is not missed any more, its boot-up message not answered. */
START_TEST(test_removed)
{
    struct plant *plant = run_plant(PLANT_NODE(
        5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
           "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>") PLANT_NODE(6, ""));
    unsigned asked;

    put(plant, 0x1F81, 5, 0);
    asked = plant_sent(plant, "705#R");
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "705#R"), asked);
    ck_assert(!plant_said(plant, "node 5: no answer"));
    expect_state(plant, 5, NMT_PREOPERATIONAL);
    ck_assert_uint_eq(tool_get(plant, 0x1F81, 5), 0);
    boot_all_anew(plant);
    expect_state(plant, 5, NMT_PREOPERATIONAL);
    expect_state(plant, 6, NMT_OPERATIONAL);
    ck_assert(plant_said(plant, "network is up: 1 of 1 nodes booted"));
    plant_free(plant);
}
END_TEST

/* A mandatory node that is not there, and is no longer asked for. */
START_TEST(test_missing_removed)
{
    struct plant *plant = make_plant("<Boot_Time>1000</Boot_Time>" PLANT_NODE(
        9, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>") PLANT_NODE(5, ""));

    plant_run_ms(plant, _i == 0 ? 700 : 2000);
    ck_assert_int_eq(plant->manager->state, _i == 0 ? NETWORK_BOOTING : NETWORK_HALTED);
    expect_state(plant, 5, NMT_PREOPERATIONAL);
    if (_i < 2)
        put(plant, 0x1F81, 9, 0);
    else
        put(plant, 0x1F81, 9, BOOTED); /* not mandatory any more */
    plant_run_ms(plant, 50);
    expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* --- in the middle of a boot --- */

/* Its first write is not answered: the boot stands still there for a while. */
static struct plant *stuck_plant(const char *node)
{
    char xml[512];
    struct plant *plant;

    snprintf(xml, sizeof xml, PLANT_NODE(5, "%s<SDO_Timeout>2000</SDO_Timeout>"), node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    watch_start(plant);
    tool_attach(plant);
    return plant;
}

/* A boot that has begun to configure begins with a reset: nothing of it may be left. */
START_TEST(test_changed_while_configured)
{
    struct plant *plant = stuck_plant("");

    plant_lie(plant, "605#2F006201", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    put(plant, 0x1F88, 5, _i == 0 ? 5 : 99);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_run_ms(plant, 1000);
    if (_i == 0)
        expect_state(plant, 5, NMT_OPERATIONAL);
    else
        ck_assert(plant_said(plant, "boot error O: 1018h:04 serial number is 00000005h"));
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_free(plant);
}
END_TEST

/* One that only reads reads again. */
START_TEST(test_changed_while_compared)
{
    struct plant *plant = stuck_plant("<Product_Code>1</Product_Code>");

    plant_lie(plant, "605#40181002", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_IDENTITY);
    put(plant, 0x1F85, 5, 0x29A);
    plant_run_ms(plant, 1000);
    expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 5), " r1018:2 r1018:1 r1018:2 w6200:1=55");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    plant_free(plant);
}
END_TEST

/* Asked for its state, it is to be asked no more. */
START_TEST(test_changed_while_asked)
{
    struct plant *plant = stuck_plant("<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                                      "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>");

    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CHECK_STATE);
    put(plant, 0x1016, 5, 0);
    put(plant, 0x1F81, 5, BOOTED);
    plant_run_ms(plant, 500);
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node that has failed waits for an order, and then boots with what is right now. */
START_TEST(test_corrected)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "<Serial_Number>99</Serial_Number>"));

    ck_assert(plant_said(plant, "boot error O"));
    put(plant, 0x1F88, 5, 5);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert_uint_eq(tool_put(plant, 0x1F82, 5, 1, RESET_COMM), 0);
    plant_run_ms(plant, 500);
    expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* A node that runs goes on as it is until its next boot. */
START_TEST(test_next_boot)
{
    struct plant *plant = run_plant(PLANT_NODE(5, "<Guard_Time>100</Guard_Time>"
                                                  "<Life_Time_Factor>3</Life_Time_Factor>"));

    put(plant, 0x1016, 5, 0x000501F4);
    put(plant, 0x1F81, 5, BOOTED | 0x00320200);
    plant_run_ms(plant, 1000);
    ck_assert_uint_ge(plant_sent(plant, "705#R"), 15);
    ck_assert_uint_eq(tool_get(plant, 0x1F83, 5), 1);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 500);
    ck_assert(plant_said(plant, "node 5: no answer to guarding for 300 ms, was operational"));
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1500);
    ck_assert(plant_said(plant, "no heartbeat within 500 ms"));
    plant_free(plant);
}
END_TEST

/* --- the network --- */

/* 1F80h starts nobody, and stops nobody, before the network boots the next time. */
START_TEST(test_startup)
{
    struct plant *plant = run_plant("<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(5, "")
                                        PLANT_NODE(6, ""));

    expect_state(plant, 5, NMT_PREOPERATIONAL);
    put(plant, 0x1F80, 0, 0x03);
    plant_run_ms(plant, 500);
    expect_state(plant, 5, NMT_PREOPERATIONAL);
    boot_all_anew(plant);
    expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 1);
    put(plant, 0x1F80, 0, 0x05);
    plant_run_ms(plant, 500);
    expect_state(plant, 5, NMT_OPERATIONAL);
    boot_all_anew(plant);
    ck_assert_int_eq(plant->manager->state, NETWORK_WAITING);
    expect_state(plant, 5, NMT_PREOPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_boot_time)
{
    struct plant *plant = run_plant("");

    put(plant, 0x1F81, 9, BOOTED | MANDATORY);
    put(plant, 0x1F89, 0, 700);
    put(plant, 0x1F80, 0, 0x41);
    boot_all_anew(plant);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    ck_assert(plant_said(plant, "mandatory node 9 is missing after 700 ms (Boot_Time)"));
    plant_free(plant);
}
END_TEST

/* The heartbeat of the manager: at once, and resets keep it. */
START_TEST(test_own_heartbeat)
{
    struct plant *plant = run_plant("");

    ck_assert_uint_eq(tool_put(plant, 0x1017, 0, 2, 100), 0);
    plant_run_ms(plant, 1000);
    ck_assert_uint_ge(plant_sent(plant, "77F#05"), 9);
    boot_all_anew(plant);
    ck_assert_uint_eq(tool_get(plant, 0x1017, 0), 100);
    ck_assert_uint_ge(plant_sent(plant, "77F#"), 18);
    plant_free(plant);
}
END_TEST

START_TEST(test_own_sync)
{
    struct plant *plant = run_plant("<Sync_Interval>0</Sync_Interval>");

    put(plant, 0x1006, 0, 10000);
    put(plant, 0x1005, 0, 0x40000080);
    plant_run_ms(plant, 100);
    ck_assert_uint_ge(plant_sent(plant, "080#"), 9);
    boot_all_anew(plant);
    ck_assert_uint_eq(tool_get(plant, 0x1006, 0), 10000);
    ck_assert_uint_ge(plant_sent(plant, "080#"), 90);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_write");

    tcase_add_loop_test(tcase, test_values, 0, (int)(sizeof writes / sizeof writes[0]));
    tcase_add_test(tcase, test_refused);
    tcase_add_test(tcase, test_no_master);
    tcase_add_test(tcase, test_told);
    tcase_add_test(tcase, test_no_room);
    tcase_add_test(tcase, test_given_up);
    tcase_add_test(tcase, test_empty_network);
    tcase_add_test(tcase, test_joins);
    tcase_add_test(tcase, test_joins_kept_alive);
    tcase_add_test(tcase, test_watched_only);
    tcase_add_test(tcase, test_joins_in_boot_delay);
    tcase_add_test(tcase, test_stopped);
    tcase_add_test(tcase, test_removed);
    tcase_add_loop_test(tcase, test_missing_removed, 0, 3);
    tcase_add_loop_test(tcase, test_changed_while_configured, 0, 2);
    tcase_add_test(tcase, test_changed_while_compared);
    tcase_add_test(tcase, test_changed_while_asked);
    tcase_add_test(tcase, test_corrected);
    tcase_add_test(tcase, test_next_boot);
    tcase_add_test(tcase, test_startup);
    tcase_add_test(tcase, test_boot_time);
    tcase_add_test(tcase, test_own_heartbeat);
    tcase_add_test(tcase, test_own_sync);
    return suite_run("config_write", tcase);
}

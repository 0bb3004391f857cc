/*
 * Configuration over the network: other tools write 1F80h..1F89h of the manager's dictionary, and
 * the network boots with what they have written.
 */
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#define LISTED    0x01u /* bits of 1F81h */
#define BOOTED    0x05u
#define MANDATORY 0x08u
#define KEPT      0x10u

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
    tool_boot_all(plant);
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
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_sub)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
    } none[] = {
        { 0x1F80, 1 }, { 0x1F89, 5 }, { 0x1F81, 0x80 }, { 0x1016, 0xFF }, { 0x1028, 0x80 }
    };
    struct plant *plant = run_plant("");
    uint8_t bytes[4];
    uint32_t size;

    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        size = sizeof bytes;
        ck_assert_uint_eq(tool_read(plant, none[i].index, none[i].sub, bytes, &size), 0x06090011);
    }
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

    tool_set(plant, 0x1F85, 5, 0x29A);
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
    tool_set(plant, 0x1F81, 5, BOOTED);
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
        tool_set(plant, 0x1F84, node, 0x20192);
        tool_set(plant, 0x1F88, node, node);
        tool_set(plant, 0x1F81, node, BOOTED | MANDATORY);
    }
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    tool_expect_state(plant, 7, NMT_PREOPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 5), " r1018:4");
    ck_assert_uint_eq(tool_get(plant, 0x1028, 5), 0x85);
    ck_assert_uint_eq(tool_get(plant, 0x1F82, 5), 5);
    tool_boot_all(plant);
    ck_assert(plant_said(plant, "network is up: 2 of 2 nodes booted"));
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* The first write that makes it one of the network resets it: who knows what it was before. */
START_TEST(test_joins)
{
    struct plant *plant = run_plant(PLANT_NODE(5, ""));

    sim_say(&plant->sim, "000#0106");
    plant_run_ms(plant, 10);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    tool_set(plant, 0x1F81, 6, BOOTED);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    tool_set(plant, 0x1F81, 6, BOOTED);
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
    tool_set(plant, 0x1F81, 6, BOOTED | KEPT | 0x00640300);
    plant_run_ms(plant, 500);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 0);
    ck_assert_int_eq(plant_node(plant, 6)->kept_alive, true);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* Listed, but not booted by the manager: it is watched only, until bit 2 says otherwise. */
START_TEST(test_watched_only)
{
    struct plant *plant = run_plant("");

    tool_set(plant, 0x1F81, 6, LISTED | 0x00640300);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 6, NMT_PREOPERATIONAL);
    ck_assert_str_eq(plant_talk(plant, 6), "");
    ck_assert_uint_ge(plant_sent(plant, "706#R"), 4);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 0);
    tool_set(plant, 0x1F81, 6, BOOTED | 0x00640300);
    ck_assert_uint_eq(plant_sent(plant, "000#8206"), 1);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    tool_set(plant, 0x1F81, 6, LISTED | 0x00640300);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* In the boot delay, it is booted with the others. */
START_TEST(test_joins_in_boot_delay)
{
    struct plant *plant = make_plant("");

    plant_run_ms(plant, 50);
    tool_set(plant, 0x1F81, 5, BOOTED | MANDATORY);
    ck_assert_int_eq(plant->manager->state, NETWORK_RESETTING);
    plant_run_ms(plant, 1000);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
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

    tool_set(plant, 0x1F81, 5, 0);
    asked = plant_sent(plant, "705#R");
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    plant_power(plant, 5, false);
    plant_run_ms(plant, 1000);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 1000);
    ck_assert_uint_eq(plant_sent(plant, "705#R"), asked);
    ck_assert(!plant_said(plant, "node 5: no answer"));
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    ck_assert_uint_eq(tool_get(plant, 0x1F81, 5), 0);
    tool_boot_all(plant);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    tool_expect_state(plant, 6, NMT_OPERATIONAL);
    ck_assert(plant_said(plant, "network is up: 1 of 1 nodes booted"));
    plant_free(plant);
}
END_TEST

/* A mandatory node that is not there, and is no longer asked for. */
START_TEST(test_missing_removed)
{
    struct plant *plant = make_plant("<Boot_Time>1000</Boot_Time>" PLANT_NODE(
        9, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>") PLANT_NODE(5, ""));
    unsigned asked;

    plant_run_ms(plant, _i == 0 ? 500 : 2000);
    ck_assert_int_eq(plant->manager->state, _i == 0 ? NETWORK_BOOTING : NETWORK_HALTED);
    tool_expect_state(plant, 5, NMT_PREOPERATIONAL);
    if (_i < 2)
        tool_set(plant, 0x1F81, 9, 0);
    else
        tool_set(plant, 0x1F81, 9, BOOTED); /* not mandatory any more */
    plant_run_ms(plant, 50);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    asked = plant_sent(plant, "609#40001000");
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant_sent(plant, "609#40001000") > asked, _i == 2);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_write");

    tcase_add_loop_test(tcase, test_values, 0, (int)(sizeof writes / sizeof writes[0]));
    tcase_add_test(tcase, test_refused);
    tcase_add_test(tcase, test_no_sub);
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
    return suite_run("config_write", tcase);
}

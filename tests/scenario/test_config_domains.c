/*
 * What is to be written to the nodes, over the network: 1F20h (text of a DCF), 1F22h (concise DCF),
 * 1F58h (program) of the manager's dictionary.
 */
#include "manager/boot_text.h"
#include "support/dcf_file.h"
#include "support/loader.h"
#include "support/suite.h"
#include "support/tool.h"
#include "support/watch.h"

#include <stdlib.h>
#include <string.h>

#define BOOTED 0x05u /* of 1F81h */

#define CONF 0x666E6F63u

#define NO_DATA 0x08000024u
#define NO_TIME 0x08000022u /* not in this state */
#define REFUSED 0x06090030u

static const uint8_t nothing[] = { 0, 0, 0, 0 };

static void expect_bytes(struct plant *plant, uint16_t index, uint8_t sub, const void *bytes,
                         uint32_t size)
{
    uint8_t read[4096];
    uint32_t read_size = sizeof read;

    ck_assert_uint_eq(tool_read(plant, index, sub, read, &read_size), 0);
    ck_assert_uint_eq(read_size, size);
    ck_assert_mem_eq(read, bytes, size);
}

static void expect_no_bytes(struct plant *plant, uint16_t index, uint8_t sub)
{
    uint8_t read[4096];
    uint32_t read_size = sizeof read;

    ck_assert_uint_eq(tool_read(plant, index, sub, read, &read_size), NO_DATA);
}

/* --- 1F22h --- */

START_TEST(test_concise)
{
    struct plant *plant = tool_plant_run("");

    expect_bytes(plant, 0x1F22, 5, nothing, sizeof nothing);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise_more, sizeof tool_concise_more), 0);
    expect_bytes(plant, 0x1F22, 5, tool_concise_more, sizeof tool_concise_more);
    expect_no_bytes(plant, 0x1F20, 5);
    tool_set(plant, 0x1F81, 5, BOOTED);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_expect_value(plant, 5, 0x6200, 0x66);
    tool_expect_value(plant, 5, 0x6201, 0x77);
    ck_assert_uint_eq(tool_put_concise(plant, 5, nothing, sizeof nothing), 0);
    expect_bytes(plant, 0x1F22, 5, nothing, sizeof nothing);
    plant_free(plant);
}
END_TEST

static const struct wrong {
    const char *name;
    uint32_t size;
    uint8_t bytes[16];
    uint32_t code;
    const char *said;
} wrongs[] = {
    { "no count", 3, { 1, 0, 0 }, 0x06070013, "a concise DCF begins with a count of 4 bytes" },
    { "no entry", 4, { 1 }, 0x06070013, "entry 1 of 1 at byte 4: 7 bytes of header expected" },
    { "half a value",
      12,
      { 1, 0, 0, 0, 0, 0x62, 1, 2, 0, 0, 0, 5 },
      0x06070013,
      "entry 1 of 1 at byte 4 (6200h:01): a value of 2 bytes expected, 1 are left" },
    { "more than one",
      13,
      { 1, 0, 0, 0, 0, 0x62, 1, 1, 0, 0, 0, 5, 5 },
      0x08000020,
      "the 1 entries of the count end at byte 12, 1 more bytes follow" },
};

/* It is taken whole or not at all, and is told what was wrong with it. */
START_TEST(test_wrong_concise)
{
    const struct wrong *row = &wrongs[_i];
    struct plant *plant = tool_plant_run(PLANT_NODE(5, "<Name>pump</Name>"));

    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(tool_put_concise(plant, 5, row->bytes, row->size), row->code);
    expect_bytes(plant, 0x1F22, 5, tool_concise, sizeof tool_concise);
    ck_assert_uint_eq(tool_put_concise(plant, 6, row->bytes, row->size), row->code);
    ck_assert_uint_eq(plant->config->node_count, 1);
    ck_assert_msg(plant_said(plant, row->said), "%s: %s", row->name, plant->events);
    ck_assert(plant_said(plant, "warning: node 5 \"pump\": what a tool has written to 1F22h:05 is "
                                "refused: 1F22h: error: "));
    plant_free(plant);
}
END_TEST

/* The owner asks later, when more were refused: each tells its own reason, or that it is gone. */
START_TEST(test_refused_in_a_row)
{
    static const char *const requests[] = { "67F#27221F0501000000", "67F#23221F0501000000" };
    static const char *const said[] = { "a concise DCF begins with a count",
                                        "entry 1 of 1 at byte 4" };
    struct plant *plant = tool_plant_run(PLANT_NODE(5, ""));
    struct co_frame frames[16], request;
    struct co_event events[16], event;
    struct co_outbox kept;
    enum co_severity severity;
    char text[512];

    co_outbox_init(&kept, frames, 16, events, 16);
    for (unsigned i = 0; i < 6; i++) {
        ck_assert(co_frame_parse(requests[i % 2], &request));
        manager_on_frame(plant->manager, &request, plant->sim.now, &kept);
    }
    for (unsigned i = 0; i < 6; i++) {
        const char *const expected = i < 2 ? "no longer known" : said[i % 2];

        ck_assert(co_outbox_take_event(&kept, &event));
        ck_assert(boot_text_event(plant->config, &event, &severity, text, sizeof text));
        ck_assert_msg(strstr(text, expected), "%u: %s", i, text);
        ck_assert_uint_eq(event.code, 0x06070013);
    }
    plant_free(plant);
}
END_TEST

/* 1 MiB is enough for a configuration. */
START_TEST(test_size)
{
    struct plant *plant = tool_plant_run("");

    sim_say(&plant->sim, "67F#21221F0501001000");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_sent(plant, "5FF#80221F0512000706"), 1);
    sim_say(&plant->sim, "67F#21221F0500001000");
    plant_run_ms(plant, 10);
    ck_assert_uint_eq(plant_sent(plant, "5FF#60221F05"), 1);
    plant_free(plant);
}
END_TEST

/* What says nothing makes no node of the network. */
START_TEST(test_nothing)
{
    struct plant *plant = tool_plant_run("");

    ck_assert_uint_eq(tool_put_concise(plant, 5, nothing, sizeof nothing), 0);
    ck_assert_uint_eq(tool_put(plant, 0x1F21, 5, 1, 0), 0);
    ck_assert_uint_eq(plant->config->node_count, 0);
    ck_assert_uint_eq(tool_put_concise(plant, 127, tool_concise, sizeof tool_concise), REFUSED);
    ck_assert_uint_eq(plant->config->node_count, 0);
    plant_free(plant);
}
END_TEST

/* A text without values, and a program, do. */
START_TEST(test_something)
{
    static const char text[] = CLEAN;
    struct plant *plant = tool_plant_run("");

    ck_assert_uint_eq(tool_write(plant, 0x1F20, 5, text, sizeof text - 1), 0);
    expect_bytes(plant, 0x1F22, 5, nothing, sizeof nothing);
    expect_bytes(plant, 0x1F20, 5, text, sizeof text - 1);
    ck_assert_uint_eq(tool_write(plant, 0x1F58, 6, text, 9), 0);
    expect_bytes(plant, 0x1F58, 6, text, 9);
    ck_assert_uint_eq(plant->config->node_count, 2);
    ck_assert_uint_eq(tool_write(plant, 0x1F58, 6, text, 0), 0);
    expect_no_bytes(plant, 0x1F58, 6);
    plant_free(plant);
}
END_TEST

START_TEST(test_no_master)
{
    struct plant *plant = tool_plant_run("<NMT_Master>FALSE</NMT_Master>" PLANT_NODE(5, ""));

    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0x08000021);
    ck_assert_uint_eq(tool_put(plant, 0x1F25, 5, 4, CONF), 0x08000021);
    expect_bytes(plant, 0x1F22, 5, nothing, sizeof nothing);
    plant_free(plant);
}
END_TEST

/* There is no memory for another node. */
START_TEST(test_no_memory)
{
    struct plant *plant = tool_plant_run(PLANT_NODE(5, ""));

    plant->config->node_room = 1;
    ck_assert_uint_eq(tool_put_concise(plant, 6, tool_concise, sizeof tool_concise), 0x05040005);
    ck_assert_uint_eq(tool_put(plant, 0x1F81, 6, 4, BOOTED), 0x05040005);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise, sizeof tool_concise), 0);
    ck_assert_uint_eq(plant->config->node_count, 1);
    plant_free(plant);
}
END_TEST

/* It is just being written to the device, which is reset and gets the other one. */
START_TEST(test_replaced_while_written)
{
    struct plant *plant = plant_new(PLANT_NODE(5,
                                               "<SDO_Timeout>2000</SDO_Timeout>"
                                               "<Verify_Configuration>TRUE</Verify_Configuration>"),
                                    1000000);

    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_add_object(plant->devices[5], 0x6201, 1, 1, 0);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    watch_start(plant);
    tool_attach(plant);
    plant_lie(plant, _i == 0 ? "605#40006201" : "605#2F006201", NULL, 1);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_CONFIGURE);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise_more, sizeof tool_concise_more), 0);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    plant_run_ms(plant, 1000);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_expect_value(plant, 5, 0x6201, 0x77);
    plant_free(plant);
}
END_TEST

/* --- 1F20h --- */

#define TEXT(node, value)                                                                          \
    OBJECT("6200", "[6200]\nParameterName=Output\nObjectType=8\nSubNumber=2\n"                     \
                   "[6200sub0]\nParameterName=n\nDataType=5\nAccessType=const\nDefaultValue=1\n"   \
                   "[6200sub1]\nParameterName=o\nDataType=5\nAccessType=rw\n" value                \
                   "[DeviceComissioning]\nNodeID=" node "\nNodeName=N\nBaudrate=1000\n")

START_TEST(test_text)
{
    static const char text[] = TEXT("5", "ParameterValue=0x55\n");
    struct plant *plant = tool_plant_run("");

    ck_assert_uint_eq(tool_put(plant, 0x1F21, 5, 1, 1), REFUSED);
    ck_assert_uint_eq(tool_write(plant, 0x1F20, 5, text, sizeof text - 1), 0);
    expect_bytes(plant, 0x1F20, 5, text, sizeof text - 1);
    expect_bytes(plant, 0x1F22, 5, tool_concise, sizeof tool_concise);
    tool_set(plant, 0x1F81, 5, BOOTED);
    plant_run_ms(plant, 500);
    tool_expect_state(plant, 5, NMT_OPERATIONAL);
    tool_expect_value(plant, 5, 0x6200, 0x55);
    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise_more, sizeof tool_concise_more), 0);
    expect_no_bytes(plant, 0x1F20, 5);
    ck_assert_uint_eq(tool_write(plant, 0x1F20, 5, text, sizeof text - 1), 0);
    ck_assert_uint_eq(tool_write(plant, 0x1F20, 5, text, 0), 0);
    expect_no_bytes(plant, 0x1F20, 5);
    expect_bytes(plant, 0x1F22, 5, nothing, sizeof nothing);
    plant_free(plant);
}
END_TEST

static const struct wrong_text {
    const char *text, *said;
} wrong_texts[] = {
    { "nothing", "1F20h: error: EDS or DCF text expected, there is no section in it" },
    { TEXT("6", ""), "error: NodeID is 6, but this is for node 5" },
    { TEXT("5", "ParameterValue=0x155\n"), "6200sub1" },
    { OBJECT("6200", "[6200]\nParameterName=o\nDataType=5\nAccessType=rw\nParameterValue=1\n"
                     "[DeviceComissioning]\nNodeID=5\nNodeName=N\nBaudrate=500\n"),
      "error: Baudrate is 500 kbit/s, but the network has 1000 kbit/s" },
    { OBJECT("6200", "[6200]\nParameterName=o\nDataType=0xF\nAccessType=rw\n"
                     "DownloadFile=passwd\n[DeviceComissioning]\nNodeID=5\nNodeName=N\n"
                     "Baudrate=1000\n"),
      "6200h:00 DownloadFile: a readable file expected, \"passwd\": permission denied" },
};

START_TEST(test_wrong_text)
{
    const struct wrong_text *row = &wrong_texts[_i];
    struct plant *plant = tool_plant_run(PLANT_NODE(5, ""));

    ck_assert_uint_eq(tool_put_concise(plant, 5, tool_concise_more, sizeof tool_concise_more), 0);
    ck_assert_uint_eq(tool_write(plant, 0x1F20, 5, row->text, (uint32_t)strlen(row->text)),
                      0x08000020);
    plant_run_ms(plant, 2);
    ck_assert_msg(plant_said(plant, "1F20h:05 is refused: 1F20h") && plant_said(plant, row->said),
                  "%s", plant->events);
    expect_bytes(plant, 0x1F22, 5, tool_concise_more, sizeof tool_concise_more);
    expect_no_bytes(plant, 0x1F20, 5);
    plant_free(plant);
}
END_TEST

/* --- 1F58h --- */

START_TEST(test_program)
{
    struct loader loader;
    struct node_config *node;
    uint8_t program[LOADER_SIZE];

    loader_make(&loader, LOADER_UPDATE);
    node = &loader.plant->config->nodes[0];
    memcpy(program, node->software, LOADER_SIZE);
    free(node->software);
    node->software = NULL;
    tool_attach(loader.plant);
    loader_run(&loader, 1000);
    ck_assert(plant_said(loader.plant, "there is no Software_File to update it with"));
    expect_no_bytes(loader.plant, 0x1F58, 5);
    expect_no_bytes(loader.plant, 0x1F58, 6);
    ck_assert_uint_eq(tool_write(loader.plant, 0x1F58, 5, program, LOADER_SIZE), 0);
    expect_bytes(loader.plant, 0x1F58, 5, program, LOADER_SIZE);
    ck_assert_uint_eq(tool_put(loader.plant, 0x1F82, 5, 1, 6), 0);
    loader.write_ms = 1000;
    loader_run(&loader, 1000);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, BOOT_UPDATE_SOFTWARE);
    ck_assert_uint_eq(tool_write(loader.plant, 0x1F58, 5, program, 10), NO_TIME);
    ck_assert_uint_eq(tool_put_concise(loader.plant, 5, tool_concise, sizeof tool_concise), 0);
    loader_run(&loader, 3000);
    loader_expect_updated(&loader, "1F58h");
    ck_assert(plant_said(loader.plant, "writes its program: 2000 bytes of 1F58h"));
    plant_free(loader.plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("config_domains");

    tcase_add_test(tcase, test_concise);
    tcase_add_loop_test(tcase, test_wrong_concise, 0, (int)(sizeof wrongs / sizeof wrongs[0]));
    tcase_add_test(tcase, test_refused_in_a_row);
    tcase_add_test(tcase, test_size);
    tcase_add_test(tcase, test_nothing);
    tcase_add_test(tcase, test_something);
    tcase_add_test(tcase, test_no_master);
    tcase_add_test(tcase, test_no_memory);
    tcase_add_loop_test(tcase, test_replaced_while_written, 0, 2);
    tcase_add_test(tcase, test_text);
    tcase_add_loop_test(tcase, test_wrong_text, 0,
                        (int)(sizeof wrong_texts / sizeof wrong_texts[0]));
    tcase_add_test(tcase, test_program);
    return suite_run("config_domains", tcase);
}

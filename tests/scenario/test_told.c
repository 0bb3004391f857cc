/*
 * What an operator is told: where each node is in its boot, and each failure that is another one.
 */
#include "support/suite.h"
#include "support/watch.h"

#include "manager/boot_text.h"

#include <stdio.h>
#include <string.h>

#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define VENDOR    "<Vendor_Identification>0x29A</Vendor_Identification>"

static char seen[8192]; /* each different text about a node, a line each */

static void note(const struct boot_node *node)
{
    char text[BOOT_TEXT_SIZE + 2];

    boot_text_node(node, text, BOOT_TEXT_SIZE);
    strcat(text, "\n");
    if (!strstr(seen, text) && strlen(seen) + strlen(text) < sizeof seen)
        strcat(seen, text);
}

static void note_all(struct plant *plant, const struct co_event *event)
{
    (void)event;
    for (size_t i = 0; i < plant->config->node_count; i++)
        note(plant_node(plant, plant->config->nodes[i].node_id));
}

static struct plant *make_plant(const char *xml)
{
    struct plant *plant = plant_new(xml, 1000000);

    plant_add_device(plant, 5);
    plant->on_event = note_all;
    seen[0] = '\0';
    return plant;
}

static void expect_seen(const char *text)
{
    ck_assert_msg(strstr(seen, text) != NULL, "'%s' is not in\n%s", text, seen);
}

static void expect_said(const struct plant *plant, const char *text)
{
    ck_assert_msg(plant_said(plant, text), "'%s' is not in\n%s", text, plant->events);
}

/* --- where a node is --- */

START_TEST(test_each_step)
{
    static const char *const texts[] = {
        "in its boot delay after a reset\n",
        "waits for the answer to 1000h\n",
        "waits for the answer to 1018h\n",
        "waits for it to tell its state\n",
        "waits for the answer to 1F56h\n",
        "waits for the answer to 1020h\n",
        "is being configured, entry 1 of 2\n",
        "saves its configuration\n",
        "booted, not started\n",
        "started\n",
        "not booted by this master\n",
        "not booted yet\n",
    };
    struct plant *plant = make_plant("<NMT_Auto_Start>FALSE</NMT_Auto_Start>" PLANT_NODE(
        5, VENDOR "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                  "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"
                  "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
                  "<Software_Identification>7</Software_Identification>"
                  "<Save_Configuration>TRUE</Save_Configuration>"
                  "<Configuration_Date>5000</Configuration_Date>"
                  "<Configuration_Time>6000</Configuration_Time>")
                                         PLANT_NODE(6, "<NMT_Slave>FALSE</NMT_Slave>"));
    struct plant_device *device = plant->devices[5];

    plant_add_object(device, 0x6200, 1, 1, 0);
    plant_add_object(device, 0x1010, 1, 4, 1);
    plant_add_object(device, 0x1020, 1, 4, 0);
    plant_add_object(device, 0x1F56, 1, 4, 7);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 5, 0x1017, 0, 2, 200);
    plant_power_on(plant);
    plant_run_ms(plant, 250);
    sim_say(&plant->sim, "705#7F"); /* asked for its state, before it is reset */
    plant_run_ms(plant, 3000);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s", plant->events);
    ck_assert_int_eq(plant_command(plant, NMT_START, 5), CO_OK);
    plant_run_ms(plant, 300);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        expect_seen(texts[i]);
    plant_free(plant);
}
END_TEST

START_TEST(test_waiting_for_a_heartbeat)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"));

    plant_power_on(plant);
    plant_run_ms(plant, 300);
    note_all(plant, NULL);
    expect_seen("waits for its heartbeat\n");
    plant_free(plant);
}
END_TEST

/* How often it was tried, and nothing of it any more when it has booted. */
START_TEST(test_failing)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));
    char text[BOOT_TEXT_SIZE] = "?";

    plant_lie(plant, "605#4018", "585#8018100122000008", 2);
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    expect_seen("boot error D: read 1018h:01 vendor-ID: the node answers abort 08000022h, ");
    note_all(plant, NULL);
    expect_seen("started\n");
    boot_text_failure(plant_node(plant, 5)->config, &plant_node(plant, 5)->failure, text,
                      sizeof text);
    ck_assert_str_eq(text, "");
    boot_text_failure(plant_node(plant, 5)->config, &plant_node(plant, 5)->history.last, text,
                      sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "boot error D: read 1018h:01"));
    plant_free(plant);
}
END_TEST

START_TEST(test_number_of_tries)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));

    plant_lie(plant, "605#4018", "585#8018100122000008", 100);
    plant_power_on(plant);
    for (unsigned i = 1; i <= 3; i++) {
        char text[BOOT_TEXT_SIZE], tries[32];

        plant_run_ms(plant, i == 1 ? 500 : 1000);
        boot_text_node(plant_node(plant, 5), text, sizeof text);
        snprintf(tries, sizeof tries, "; tried %u time%s", i, i == 1 ? "" : "s");
        ck_assert_msg(strstr(text, tries) != NULL, "%s", text);
    }
    plant_free(plant);
}
END_TEST

/* --- each failure that is another one --- */

/* In whatever it differs from the one before, it is told; the same again is not. */
START_TEST(test_each_difference)
{
    static const struct {
        const char *request, *answer;
        unsigned times;
    } lies[] = {
        { "605#40001000", "585#8000100022000008", 2 }, /* told once */
        { "605#40001000", "585#8000100023000A06", 1 }, /* another code */
        { "605#40001000", NULL, 3 },                   /* another outcome */
        { "605#40181001", "585#8018100123000A06", 1 }, /* another letter */
        { "605#2F006201", "585#8000620123000A06", 1 },
        { "605#2F006202", "585#8000620223000A06", 1 }, /* another sub-index */
        { "605#2F006302", "585#8000630223000A06", 1 }, /* another index */
        { "605#2310", "585#8010100123000A06", 1 },     /* another step */
    };
    struct plant *plant = make_plant(
        PLANT_NODE(5, VENDOR "<Save_Configuration>TRUE</Save_Configuration>"));

    plant_add_object(plant->devices[5], 0x1010, 1, 4, 1);
    for (unsigned i = 0; i < 3; i++) {
        static const uint16_t indices[] = { 0x6200, 0x6200, 0x6300 };
        const uint8_t sub = i == 0 ? 1 : 2;

        plant_add_object(plant->devices[5], indices[i], sub, 1, 0);
        plant_configure(plant, 5, indices[i], sub, 1, 0x55);
    }
    for (size_t i = 0; i < sizeof lies / sizeof lies[0]; i++)
        plant_lie(plant, lies[i].request, lies[i].answer, lies[i].times);
    plant_power_on(plant);
    plant_run_ms(plant, 30000);
    ck_assert_msg(plant_node(plant, 5)->booted, "%s", plant->events);
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 9);
    ck_assert_uint_eq(plant_said_times(plant, "boot error"), 8);
    plant_free(plant);
}
END_TEST

/* Two devices that are both wrong, one after the other, in the same way but for the number. */
START_TEST(test_another_wrong_device)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));

    plant_lie(plant, "605#4018", "585#4318100101000000", 2);
    plant_lie(plant, "605#4018", "585#4318100102000000", 1);
    plant_power_on(plant);
    for (unsigned i = 1; i <= 3; i++) {
        plant_run_ms(plant, 500);
        ck_assert_uint_eq(plant_node(plant, 5)->history.failures, i);
        plant_power(plant, 5, false);
        plant_power(plant, 5, true);
    }
    ck_assert_uint_eq(plant_said_times(plant, "boot error D: 1018h:01 vendor-ID is 00000001h"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "boot error D: 1018h:01 vendor-ID is 00000002h"), 1);
    plant_free(plant);
}
END_TEST

/* It has booted since: the same failure is news again. */
START_TEST(test_same_failure_after_a_boot)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));

    plant_lie(plant, "605#4018", "585#8018100122000008", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert(plant_node(plant, 5)->booted);
    plant->lies[0].times = 1;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 2000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert_uint_eq(plant_said_times(plant, "boot error D"), 2);
    plant_free(plant);
}
END_TEST

/* A step is told when it begins, and each answer, but not each question. */
START_TEST(test_identity)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, VENDOR "<Product_Code>1</Product_Code><Serial_Number>5</Serial_Number>"));

    plant_power_on(plant);
    plant_run_ms(plant, 500);
    ck_assert_uint_eq(plant_said_times(plant, "checks its identity"), 1);
    expect_said(plant, "node 5: 1000h:00 device type is 00020192h");
    expect_said(plant, "node 5: 1018h:01 vendor-ID is 0000029Ah");
    expect_said(plant, "node 5: 1018h:02 product code is 00000001h");
    expect_said(plant, "node 5: 1018h:04 serial number is 00000005h");
    plant_free(plant);
}
END_TEST

/* --- ways to fail that are rare --- */

/* An answer with the toggle bit of another segment. */
START_TEST(test_wrong_toggle_bit)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));

    plant_lie(plant, "605#4018", "585#4118100104000000", 100);
    plant_lie(plant, "605#60", "585#179A020000000000", 100);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    expect_said(plant,
                "boot error D: read 1018h:01 vendor-ID: wrong answer, aborted with 05030000h");
    plant_free(plant);
}
END_TEST

/* Nobody takes the manager's frames: that is said, and not that the node is absent. */
START_TEST(test_nothing_gets_out)
{
    struct plant *plant = make_plant(PLANT_NODE(5, VENDOR));

    plant_power_on(plant);
    plant_run_ms(plant, 100);
    plant->manager_device->hold_until = plant->sim.now + CO_MS(20000);
    plant_run_ms(plant, 15000);
    expect_said(plant, "boot error B: read 1000h:00 device type: the request could not be sent: "
                       "check the bus");
    plant_run_ms(plant, 15000);
    ck_assert(plant_node(plant, 5)->booted);
    plant_free(plant);
}
END_TEST

/* The entry of a refused write, with its file, its line and as much of its value as is useful. */
static const struct written {
    const char *file, *request, *answer;
    uint8_t size;
    unsigned line;
    const char *says;
} writtens[] = {
    { "<DCF_File>a.dcf</DCF_File>", "605#2F0062", "585#8000620000000206", 1, 812,
      "write 6200h:00 = 55h (entry 1 of 1 of a.dcf, line 812): the node" },
    { "<CCF_File>a.ccf</CCF_File>", "605#2B0062", "585#8000620000000206", 2, 0,
      "write 6200h:00 = 5555h (entry 1 of 1 of a.ccf): the node" },
    { "", "605#210062", "585#8000620000000206", 8, 0,
      "write 6200h:00 (8 bytes) (entry 1 of 1 of the configuration): the node" },
    { "", "605#210062", "585#8000620000000206", 255, 0,
      "write 6200h:00 (255 or more bytes) (entry 1 of 1 of the configuration): the node" },
    { "", "605#210062", "585#8000620000000206", 0, 0, /* no bytes at all */
      "write 6200h:00 (0 bytes) (entry 1 of 1 of the configuration): the node" },
};

START_TEST(test_refused_write)
{
    const struct written *row = &writtens[_i];
    uint8_t value[255];
    char xml[256];
    struct plant *plant;
    struct ccf *ccf;

    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id>%s</Node_Instance>", row->file);
    memset(value, 0x55, sizeof value);
    plant = make_plant(xml);
    ccf = &plant->config->nodes[0].ccf;
    ck_assert_int_eq(ccf_append(ccf, 0x6200, 0, value, row->size), CO_OK);
    if (row->line)
        ck_assert_int_eq(ccf_note_line(ccf, row->line), CO_OK);
    plant_lie(plant, row->request, row->answer, 100);
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    expect_said(plant, row->says);
    plant_free(plant);
}
END_TEST

/* --- of the network --- */

START_TEST(test_who_is_missing)
{
    struct plant *plant = make_plant(
        "<Boot_Time>6000</Boot_Time>"
        "<Node_Instance><Node_Id>7</Node_Id><Name>mill</Name>" MANDATORY
        "</Node_Instance>" PLANT_NODE(8, MANDATORY) PLANT_NODE(5, MANDATORY));

    plant_power_on(plant);
    plant_run_ms(plant, 8000);
    expect_said(plant, "network waits: 2 mandatory nodes are missing, among them node 7 \"mill\"");
    expect_said(plant, "network not started: 2 mandatory nodes are missing, among them node 7 "
                       "\"mill\" after 6000 ms (Boot_Time)");
    plant_free(plant);
}
END_TEST

/* A name longer than any line: it is cut, not more. */
START_TEST(test_long_name)
{
    char name[401] = "", xml[600], *line;
    struct plant *plant;

    memset(name, 'n', 400);
    snprintf(xml, sizeof xml, "<Node_Instance><Node_Id>5</Node_Id><Name>%s</Name></Node_Instance>",
             name);
    plant = make_plant(xml);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert(plant_node(plant, 5)->booted);
    line = strstr(plant->events, "nnnn");
    ck_assert_ptr_nonnull(line);
    ck_assert_uint_lt(strcspn(line, "\n"), BOOT_TEXT_SIZE);
    plant_free(plant);
}
END_TEST

/* A guarded node of the application's own is silent, and answers again. */
START_TEST(test_guarding_is_back)
{
    struct plant *plant = make_plant(
        PLANT_NODE(5, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                      "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"));

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->devices[5]->sim->unplugged = true;
    plant_run_ms(plant, 1000);
    expect_said(plant, "error: node 5: no answer to guarding for 300 ms, was pre-operational");
    plant->devices[5]->sim->unplugged = false;
    plant_run_ms(plant, 1000);
    expect_said(plant, "node 5: answers guarding again, pre-operational");
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("told");

    tcase_add_test(tcase, test_each_step);
    tcase_add_test(tcase, test_waiting_for_a_heartbeat);
    tcase_add_test(tcase, test_failing);
    tcase_add_test(tcase, test_number_of_tries);
    tcase_add_test(tcase, test_each_difference);
    tcase_add_test(tcase, test_another_wrong_device);
    tcase_add_test(tcase, test_same_failure_after_a_boot);
    tcase_add_test(tcase, test_identity);
    tcase_add_test(tcase, test_wrong_toggle_bit);
    tcase_add_test(tcase, test_nothing_gets_out);
    tcase_add_loop_test(tcase, test_refused_write, 0, (int)(sizeof writtens / sizeof *writtens));
    tcase_add_test(tcase, test_who_is_missing);
    tcase_add_test(tcase, test_long_name);
    tcase_add_test(tcase, test_guarding_is_back);
    return suite_run("told", tcase);
}

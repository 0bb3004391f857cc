/*
 * Each step of a boot fails in each way: the letter, the text, what the network does then.
 */
#include "support/plant.h"
#include "support/suite.h"

#include "manager/boot_text.h"

#include <stdio.h>
#include <string.h>

#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define NO_ANSWER "no answer within 200 ms (3 tries)"

/* Node 5 is the one that fails, node 6 always boots. */
static struct plant *make_plant(const char *network, const char *node)
{
    char xml[2048];
    struct plant *plant;

    snprintf(xml, sizeof xml,
             "%s<Node_Instance><Node_Id>5</Node_Id><Name>pump</Name>%s</Node_Instance>" PLANT_NODE(
                 6, ""),
             network, node);
    plant = plant_new(xml, 1000000);
    plant_add_object(plant_add_device(plant, 5), 0x6200, 1, 1, 0);
    plant_add_object(plant->devices[5], 0x6200, 2, 4, 0);
    plant_add_device(plant, 6);
    plant_configure(plant, 5, 0x6200, 1, 1, 0x55);
    plant_configure(plant, 5, 0x6200, 2, 4, 0x12345678);
    return plant;
}

static const struct failure {
    const char *name;
    const char *node;             /* its XML */
    const char *request, *answer; /* a lie */
    unsigned times;
    char letter;
    uint8_t step;     /* 1.9 s after power on */
    const char *says; /* after "boot error " */
} failures[] = {
    { "no answer at all", "", "605#", NULL, 1000, 'B', BOOT_RETRY,
      "B: read 1000h:00 device type: " NO_ANSWER
      ": the node is absent or off, or has another node-ID or bit rate" },
    { "1000h refused", "", "605#40001000", "585#8000100000000206", 1000, 'B', BOOT_RETRY,
      "B: read 1000h:00 device type: the node answers abort 06020000h" },
    { "another device type", "<Device_Type_Identification>0x12345</Device_Type_Identification>",
      NULL, NULL, 0, 'C', BOOT_FAILED,
      "C: 1000h:00 device type is 00020192h, configuration expects 00012345h: wrong device at node "
      "5, or remove Device_Type_Identification to skip the check" },
    { "another vendor", "<Vendor_Identification>0x17F</Vendor_Identification>", NULL, NULL, 0, 'D',
      BOOT_FAILED,
      "D: 1018h:01 vendor-ID is 0000029Ah, configuration expects 0000017Fh: wrong device at node "
      "5, or remove Vendor_Identification to skip the check" },
    { "another product", "<Product_Code>2</Product_Code>", NULL, NULL, 0, 'M', BOOT_FAILED,
      "M: 1018h:02 product code is 00000001h, configuration expects 00000002h" },
    { "another revision", "<Revision_Number>0x20001</Revision_Number>", NULL, NULL, 0, 'N',
      BOOT_FAILED, "N: 1018h:03 revision number is 00010001h, configuration expects 00020001h" },
    { "another serial number", "<Serial_Number>77</Serial_Number>", NULL, NULL, 0, 'O', BOOT_FAILED,
      "O: 1018h:04 serial number is 00000005h, configuration expects 0000004Dh" },
    { "1018h:01 refused", "<Vendor_Identification>0x29A</Vendor_Identification>", "605#40181001",
      "585#8018100111000906", 1000, 'D', BOOT_FAILED,
      "D: read 1018h:01 vendor-ID: the node answers abort 06090011h" },
    { "1018h:02 refused", "<Product_Code>1</Product_Code>", "605#40181002", "585#8018100211000906",
      1000, 'M', BOOT_FAILED, "M: read 1018h:02 product code: the node answers abort 06090011h" },
    { "1018h:03 refused", "<Revision_Number>0x10001</Revision_Number>", "605#40181003",
      "585#8018100300000206", 1000, 'N', BOOT_FAILED,
      "N: read 1018h:03 revision number: the node" },
    { "1018h:04 refused", "<Serial_Number>5</Serial_Number>", "605#40181004",
      "585#8018100411000906", 1000, 'O', BOOT_FAILED, "O: read 1018h:04 serial number: the node" },
    { "1018h:01 without answer", "<Vendor_Identification>0x29A</Vendor_Identification>",
      "605#40181001", NULL, 1000, 'D', BOOT_RETRY,
      "D: read 1018h:01 vendor-ID: " NO_ANSWER ": the node has gone in mid-boot" },
    { "1018h:04 without answer", "<Serial_Number>5</Serial_Number>", "605#40181004", NULL, 1000,
      'O', BOOT_RETRY, "O: read 1018h:04 serial number: " NO_ANSWER },
    { "first write refused", "", "605#2F006201", "585#8000620111000906", 1000, 'J', BOOT_FAILED,
      "J: write 6200h:01 = 55h (entry 1 of 2 of the configuration): the node answers abort "
      "06090011h, sub-index does not exist" },
    { "last write refused", "", "605#23006202", "585#8000620230000906", 1000, 'J', BOOT_FAILED,
      "J: write 6200h:02 = 12345678h (entry 2 of 2 of the configuration): the node answers abort "
      "06090030h" },
    { "a segment of a write was lost", "", "605#23006202", "585#8000620200000405", 1000, 'J',
      BOOT_RETRY,
      "J: write 6200h:02 = 12345678h (entry 2 of 2 of the configuration): the node answers abort "
      "05040000h, SDO protocol timed out" },
    { "a segment of a block was lost", "", "605#23006202", "585#8000620203000405", 1000, 'J',
      BOOT_RETRY,
      "J: write 6200h:02 = 12345678h (entry 2 of 2 of the configuration): the node answers abort "
      "05040003h" },
    { "refused with a code of the manufacturer", "", "605#23006202", "585#80006202EFBEADDE", 1000,
      'J', BOOT_FAILED,
      "J: write 6200h:02 = 12345678h (entry 2 of 2 of the configuration): the node answers abort "
      "DEADBEEFh, unknown abort code" },
    { "write without answer", "", "605#2F006201", NULL, 1000, 'J', BOOT_RETRY,
      "J: write 6200h:01 = 55h (entry 1 of 2 of the configuration): no answer within 200 ms" },
    { "\"save\" refused", "<Save_Configuration>TRUE</Save_Configuration>", NULL, NULL, 0, 'J',
      BOOT_FAILED, "J: write 1010h:01 \"save\": the node answers abort 06020000h" },
    { "no heartbeat", "<Consumer_Heartbeat_Time>700</Consumer_Heartbeat_Time>", NULL, NULL, 0, 'K',
      BOOT_FAILED, "K: no heartbeat within 700 ms (Consumer_Heartbeat_Time)" },
    { "a wrong answer", "<Vendor_Identification>0x29A</Vendor_Identification>", "605#40181001",
      "585#6018100100000000", 1000, 'D', BOOT_RETRY,
      "D: read 1018h:01 vendor-ID: wrong answer, aborted with 05040001h" },
    { "an answer too long", "<Vendor_Identification>0x29A</Vendor_Identification>", "605#40181001",
      "585#4118100109000000", 1000, 'D', BOOT_FAILED,
      "D: read 1018h:01 vendor-ID: the answer is longer than 8 bytes" },
};

#define FAILURES (sizeof failures / sizeof failures[0])

static struct plant *boot_and_fail(const struct failure *failure, const char *network,
                                   const char *more)
{
    char node[512];
    struct plant *plant;

    snprintf(node, sizeof node, "%s%s", failure->node, more);
    plant = make_plant(network, node);
    if (failure->request)
        plant_lie(plant, failure->request, failure->answer, failure->times);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    return plant;
}

static void expect_failure(struct plant *plant, const struct failure *failure)
{
    const struct boot_node *node = plant_node(plant, 5);
    char text[BOOT_TEXT_SIZE], line[BOOT_TEXT_SIZE];

    boot_text_node(node, text, sizeof text);
    ck_assert_msg(node->failure.letter == failure->letter, "%s: %s", failure->name, text);
    ck_assert_msg(node->step == failure->step, "%s: step %u: %s", failure->name, node->step, text);
    snprintf(line, sizeof line, "error: node 5 \"pump\": boot error %s", failure->says);
    ck_assert_msg(plant_said(plant, line), "%s: no '%s' in\n%s", failure->name, line,
                  plant->events);
    snprintf(line, sizeof line, "boot error %s", failure->says);
    ck_assert_msg(strstr(text, line) == text, "%s: %s", failure->name, text);
    ck_assert_uint_eq(plant_sent(plant, "000#0105"), 0);
    ck_assert_int_ne(plant->devices[5]->slave.state, NMT_OPERATIONAL);
}

/* An optional node that fails keeps nobody from starting. */
START_TEST(test_optional)
{
    struct plant *plant = boot_and_fail(&failures[_i], "<NMT_Start_All>TRUE</NMT_Start_All>", "");

    expect_failure(plant, &failures[_i]);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#0106"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#0100"), 0);
    ck_assert(plant_said(plant, "network is up: 1 of 2 nodes booted"));
    plant_free(plant);
}
END_TEST

/* A mandatory one keeps all: at once when it has failed for good, else until it boots. */
START_TEST(test_mandatory)
{
    const struct failure *failure = &failures[_i];
    struct plant *plant = boot_and_fail(failure, "", MANDATORY);
    bool halts = failure->step == BOOT_FAILED;

    expect_failure(plant, failure);
    ck_assert_int_eq(plant->manager->state, halts ? NETWORK_HALTED : NETWORK_BOOTING);
    ck_assert_uint_eq(plant_said_times(plant, "network not started: mandatory node"), halts);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    ck_assert_int_eq(plant->manager->device.state, NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant_node(plant, 6)->step, BOOT_READY);
    plant_free(plant);
}
END_TEST

/* It is told once, though it happens again and again, and the network goes on when it has ended. */
START_TEST(test_mended)
{
    const struct failure *failure = &failures[_i];
    struct plant *plant = boot_and_fail(failure, "<Boot_Time>800</Boot_Time>", MANDATORY);
    unsigned told;

    plant_run_ms(plant, 5000);
    told = plant_said_times(plant, "boot error ");
    ck_assert_msg(told == 1, "%s:\n%s", failure->name, plant->events);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    ck_assert_uint_eq(plant_said_times(plant, "network not started"), 1);
    if (!failure->request) { /* another device, then */
        plant_free(plant);
        return;
    }
    plant->lie_count = 0;
    plant_power(plant, 5, false);
    plant_run_ms(plant, 100);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 2000);
    ck_assert_msg(plant->manager->state == NETWORK_OPERATIONAL, "%s:\n%s", failure->name,
                  plant->events);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant->devices[6]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(od_number(&plant->devices[5]->od, 0x6200, 2, 0), 0x12345678);
    plant_free(plant);
}
END_TEST

/* After a difference nothing more is asked. */
START_TEST(test_nothing_after_difference)
{
    struct plant *plant = boot_and_fail(&failures[2], "",
                                        "<Vendor_Identification>1</Vendor_Identification>");

    plant_run_ms(plant, 5000);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 1);
    plant_free(plant);
}
END_TEST

START_TEST(test_identity_in_order)
{
    struct plant *plant = make_plant(
        "", "<Serial_Number>5</Serial_Number><Product_Code>1</Product_Code>");
    const struct sim_line *line;
    unsigned subs[4] = { 0 }, count = 0;

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    for (size_t i = 0; i < plant->sim.trace_count; i++) {
        line = &plant->sim.trace[i];
        if (line->frame.id == 0x605 && line->frame.data[1] == 0x18 && count < 4)
            subs[count++] = line->frame.data[3];
    }
    ck_assert_uint_eq(count, 2);
    ck_assert_uint_eq(subs[0], 2);
    ck_assert_uint_eq(subs[1], 4);
    ck_assert(plant_node(plant, 5)->booted);
    plant_free(plant);
}
END_TEST

/* Wrong answers are asked for three times, then the node has failed, until its boot-up message. */
START_TEST(test_garbled)
{
    struct plant *plant = make_plant("", MANDATORY
                                     "<Vendor_Identification>0x29A</Vendor_Identification>");

    plant_lie(plant, "605#40181001", "585#6018100100000000", 1000);
    plant_power_on(plant);
    plant_run_ms(plant, 10000);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_FAILED);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    ck_assert_uint_eq(plant_sent(plant, "605#40181001"), 3);
    plant->lies[0].times = 2;
    plant_power(plant, 5, false);
    plant_power(plant, 5, true);
    plant_run_ms(plant, 3000);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    plant_free(plant);
}
END_TEST

/* "Not now" right after the boot-up: asked again a second later. */
static const struct busy {
    const char *request, *answer;
} busy[] = {
    { "605#40001000", "585#8000100022000008" },
    { "605#40001000", "585#800010002300"
                      "0A06" },
    { "605#40181001", "585#8018100122000008" },
    { "605#40181001", "585#8018100123000A06" },
    { "605#2F006201", "585#8000620122000008" },
    { "605#23006202", "585#8000620223000A06" },
};

START_TEST(test_busy)
{
    struct plant *plant = make_plant("", MANDATORY
                                     "<Vendor_Identification>0x29A</Vendor_Identification>");

    plant_lie(plant, busy[_i].request, busy[_i].answer, 2);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant_node(plant, 5)->step, BOOT_RETRY);
    plant_run_ms(plant, 2000);
    ck_assert_msg(plant->manager->state == NETWORK_OPERATIONAL, "%s", plant->events);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(plant_said_times(plant, "boot error"), 1);
    plant_free(plant);
}
END_TEST

/* A read that gets no answer is repeated at once, twice; a write never within an attempt. */
START_TEST(test_lost_frames)
{
    static const char *const requests[] = { "605#40001000", "605#40181001", "605#2F006201" };
    struct plant *plant = make_plant("", MANDATORY
                                     "<Vendor_Identification>0x29A</Vendor_Identification>");

    plant_lie(plant, requests[_i], NULL, _i == 2 ? 1 : 2);
    plant_power_on(plant);
    plant_run_ms(plant, 900);
    ck_assert_int_eq(plant->manager->state == NETWORK_OPERATIONAL, _i != 2);
    ck_assert_uint_eq(plant_sent(plant, requests[_i]), _i == 2 ? 1 : 3);
    plant_run_ms(plant, 2000);
    ck_assert_int_eq(plant->manager->state, NETWORK_OPERATIONAL);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), _i == 2);
    plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("boot_failures");

    tcase_add_loop_test(tcase, test_optional, 0, FAILURES);
    tcase_add_loop_test(tcase, test_mandatory, 0, FAILURES);
    tcase_add_loop_test(tcase, test_mended, 0, FAILURES);
    tcase_add_test(tcase, test_nothing_after_difference);
    tcase_add_test(tcase, test_identity_in_order);
    tcase_add_test(tcase, test_garbled);
    tcase_add_loop_test(tcase, test_busy, 0, sizeof busy / sizeof busy[0]);
    tcase_add_loop_test(tcase, test_lost_frames, 0, 3);
    return suite_run("boot_failures", tcase);
}

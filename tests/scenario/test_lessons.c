/*
 * What users of other stacks have lost days with: each test is one such story, in plain words.
 */
#include "od/od_store.h"
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define GUARDED    "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"
#define KEPT_ALIVE "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
#define MANDATORY  "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
#define VENDOR     "<Vendor_Identification>0x29A</Vendor_Identification>"

static void restart(struct plant *plant, uint8_t node)
{
    plant_power(plant, node, false);
    plant_power(plant, node, true);
}

/* --- 1: the boot-up message of a node that is guarded and kept alive --- */

/*
 * It does not run when the manager looks: it is reset, its boot-up message is seen though nobody
 * watches it by a heartbeat, it is booted at once and guarded from then on.
 */
START_TEST(test_guarded_node_is_seen_to_boot)
{
    struct plant *plant = watch_two(PLANT_NODE(5, GUARDED KEPT_ALIVE) PLANT_NODE(6, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 1200);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "node 5: boot-up message"), 1);
    ck_assert_uint_ge(plant_sent(plant, "705#R"), 5);
    ck_assert(!plant_said(plant, "boot error"));
    plant_free(plant);
}
END_TEST

/* It runs and is left alone; then its power fails for a moment: the boot-up message tells. */
START_TEST(test_guarded_node_is_seen_to_restart)
{
    struct plant *plant = watch_two(PLANT_NODE(5, GUARDED KEPT_ALIVE) PLANT_NODE(6, ""));

    plant_add_object(plant->devices[5], 0x1F80, 0, 4, 0); /* starts by itself */
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "node 5: is running already: kept alive (L)"));
    ck_assert_uint_eq(plant_sent(plant, "605#2"), 0);
    od_set_number(&plant->devices[5]->od, 0x1F80, 0, 4);
    ck_assert_int_eq(od_store(&plant->devices[5]->od, 0x1F80, 0x1F80), CO_OK);
    restart(plant, 5);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up again");
    ck_assert_uint_eq(plant_said_times(plant, "node 5: boot-up message"), 1);
    ck_assert_uint_eq(plant_sent(plant, "605#2"), WATCH_ENTRIES);
    ck_assert(!plant_said(plant, "no answer to guarding"));
    plant_free(plant);
}
END_TEST

/*
 * Its default values are restored first, which takes a reset and three seconds: its boot-up message
 * alone tells when it is there again, and it is waited for.
 */
static enum sim_fate restart_slowly(struct plant *plant, const struct co_frame *frame,
                                    uint8_t sender)
{
    (void)sender;
    if (frame->id == NMT_CAN_ID && frame->data[0] == NMT_RESET_NODE && frame->data[1] == 5)
        plant->devices[5]->sim->hold_until = plant->sim.now + CO_MS(3000);
    return SIM_DELIVER;
}

START_TEST(test_guarded_node_is_restored)
{
    struct plant *plant = watch_two(
        PLANT_NODE(5, GUARDED KEPT_ALIVE "<Restore_Configuration>1</Restore_Configuration>")
            PLANT_NODE(6, ""));

    plant_add_object(plant->devices[5], 0x1011, 1, 4, 1);
    plant->fault = restart_slowly;
    plant_power_on(plant);
    plant_run_ms(plant, 3000);
    ck_assert_uint_eq(plant_sent(plant, "605#2F"), 0);
    plant_run_ms(plant, 2000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "605#231110016C6F6164"), 1);
    ck_assert_uint_eq(plant_sent(plant, "000#8105"), 1);
    ck_assert_uint_eq(plant_said_times(plant, "node 5: boot-up message"), 2);
    ck_assert(!plant_said(plant, "boot error"));
    plant_free(plant);
}
END_TEST

/* --- 2: a node that restarts in the middle of its configuration --- */

static enum sim_fate restart_at_write(struct plant *plant, const struct co_frame *frame,
                                      uint8_t sender)
{
    unsigned *left = plant->fault_context;

    (void)sender;
    if (frame->id == 0x605 && frame->data[0] == 0x2F && --*left == 0) {
        slave_command(&plant->devices[5]->slave, NMT_RESET_NODE, plant->sim.now,
                      &plant->devices[5]->sim->box);
        sim_touch(&plant->sim, plant->devices[5]->sim);
    }
    return SIM_DELIVER;
}

/* At each of its entries: the boot begins anew, at 1000h, and no entry is left out. */
START_TEST(test_restart_in_mid_configuration)
{
    unsigned left = (unsigned)_i + 1;
    struct plant *plant = watch_two(PLANT_NODE(5, VENDOR) PLANT_NODE(6, ""));
    char talk[PLANT_TALK_SIZE];

    plant->fault = restart_at_write;
    plant->fault_context = &left;
    plant_power_on(plant);
    plant_run_ms(plant, 500);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "605#40001000"), 2);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 0);
    snprintf(talk, sizeof talk, "%s", plant_talk(plant, 5));
    ck_assert_ptr_nonnull(strstr(talk, " r1018:1 w6200:1=51 w6200:2=52 w6200:3=53 w6200:4=54 "
                                       "w6200:5=55"));
    plant_free(plant);
}
END_TEST

/* --- 3: retries, the node's own time-out, and one limit for all steps --- */

/* Silence twice, then an answer: whatever is read, the boot goes on where it was. */
START_TEST(test_reads_are_repeated)
{
    static const char *const requests[] = { "605#40001000", "605#40181001", "605#40181004",
                                            "605#40201001", "605#40561F01" };
    struct plant *plant = watch_two(
        PLANT_NODE(5, VENDOR "<Serial_Number>5</Serial_Number>"
                             "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
                             "<Software_Identification>7</Software_Identification>"
                             "<Configuration_Date>5000</Configuration_Date>"
                             "<Configuration_Time>6000</Configuration_Time>") PLANT_NODE(6, ""));

    plant_add_object(plant->devices[5], 0x1F56, 1, 4, 7);
    plant_add_object(plant->devices[5], 0x1020, 1, 4, 0);
    plant_lie(plant, requests[_i], NULL, 2);
    plant_power_on(plant);
    plant_run_ms(plant, 800);
    watch_expect_up(plant, requests[_i]);
    ck_assert_uint_eq(plant_sent(plant, requests[_i]), 3);
    ck_assert(!plant_said(plant, "boot error"));
    ck_assert_uint_eq(plant_sent(plant, "605#2"), WATCH_ENTRIES); /* no write is repeated */
    plant_free(plant);
}
END_TEST

/* Three times, no more: then it has failed, and is asked again a second later. */
START_TEST(test_reads_are_given_up)
{
    struct plant *plant = watch_two(PLANT_NODE(5, VENDOR) PLANT_NODE(6, ""));

    plant_lie(plant, "605#40181001", NULL, 1000);
    plant_power_on(plant);
    plant_run_ms(plant, 200 + 3 * 200 + 900);
    ck_assert_uint_eq(plant_sent(plant, "605#40181001"), 3);
    ck_assert(plant_said(plant, "no answer within 200 ms (3 tries)"));
    plant_run_ms(plant, 300);
    ck_assert_uint_eq(plant_sent(plant, "605#40181001"), 4);
    plant_free(plant);
}
END_TEST

/* Each node has its own time: what is too slow for one is not for the other. */
static enum sim_fate answer_late(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    (void)sender;
    if (frame->id == 0x605 || frame->id == 0x606)
        plant->devices[frame->id & 0x7Fu]->sim->hold_until = plant->sim.now + CO_MS(300);
    return SIM_DELIVER;
}

START_TEST(test_time_out_of_each_node)
{
    struct plant *plant = watch_two(PLANT_NODE(5, "<SDO_Timeout>400</SDO_Timeout>")
                                        PLANT_NODE(6, ""));

    plant->fault = answer_late;
    plant_power_on(plant);
    plant_run_ms(plant, 4000);
    ck_assert(plant_node(plant, 5)->booted);
    ck_assert(!plant_node(plant, 6)->booted);
    ck_assert(plant_said(plant, "node 6: boot error B: read 1000h:00 device type: no answer within "
                                "200 ms (3 tries)"));
    plant->fault = NULL; /* and late answers of before harm nobody */
    plant_run_ms(plant, 3000);
    watch_expect_up(plant, "is not up");
    plant_free(plant);
}
END_TEST

/* Wherever the mandatory node hangs, Boot_Time is over when it is over, and says who it was. */
static const struct hang {
    const char *name, *node, *request, *answer;
    uint8_t step;
} hangs[] = {
    { "absent", "", "605#4000", NULL, BOOT_DEVICE_TYPE },
    { "in its identity", VENDOR "<SDO_Timeout>5000</SDO_Timeout>", "605#4018", NULL,
      BOOT_IDENTITY },
    { "busy for ever", "", "605#2F", "585#8000620122000008", BOOT_RETRY },
    { "in a write", "<SDO_Timeout>5000</SDO_Timeout>", "605#2F", NULL, BOOT_CONFIGURE },
    { "in its flash", "<Save_Configuration>TRUE</Save_Configuration>", "605#2310", NULL,
      BOOT_SAVE },
    { "before its heartbeat", "<Consumer_Heartbeat_Time>5000</Consumer_Heartbeat_Time>", NULL, NULL,
      BOOT_ERROR_CONTROL },
};

START_TEST(test_boot_time_covers_each_step)
{
    const struct hang *hang = &hangs[_i];
    char xml[1024];
    struct plant *plant;

    snprintf(xml, sizeof xml,
             "<Boot_Time>1500</Boot_Time><Node_Instance><Node_Id>5</Node_Id>" MANDATORY
             "%s</Node_Instance>" PLANT_NODE(6, ""),
             hang->node);
    plant = watch_two(xml);
    if (hang->request)
        plant_lie(plant, hang->request, hang->answer, 1000);
    plant_power_on(plant);
    plant_run_ms(plant, 200 + 1499);
    ck_assert_msg(plant->manager->state == NETWORK_BOOTING, "%s", hang->name);
    ck_assert_msg(hang->step == plant_node(plant, 5)->step || _i == 0, "%s: %u", hang->name,
                  plant_node(plant, 5)->step);
    plant_run_ms(plant, 2);
    ck_assert_msg(plant_said(plant, "network not started: mandatory node 5 is missing after 1500 "
                                    "ms (Boot_Time)"),
                  "%s:\n%s", hang->name, plant->events);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    plant_free(plant);
}
END_TEST

/* --- 4: a refused write says which, and can be asked for later --- */

START_TEST(test_record_of_refused_write)
{
    struct plant *plant = watch_two(PLANT_NODE(5, "") PLANT_NODE(6, ""));
    const struct boot_failure *last = &plant_node(plant, 5)->history.last;

    plant_lie(plant, "605#2F006203", "585#8000620330000906", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert(plant_said(plant, "node 5: boot error J: write 6200h:03 = 53h (entry 3 of 5 of the "
                                "configuration): the node answers abort 06090030h"));
    restart(plant, 5); /* somebody mends it: what it was is still known */
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_int_eq(plant_node(plant, 5)->failure.letter, 0);
    ck_assert_uint_eq(plant_node(plant, 5)->history.failures, 1);
    ck_assert_int_eq(last->letter, 'J');
    ck_assert_uint_eq(last->index, 0x6200);
    ck_assert_uint_eq(last->sub, 3);
    ck_assert_uint_eq(last->entry, 3);
    ck_assert_uint_eq(last->expected, 0x53);
    ck_assert_uint_eq(last->size, 1);
    ck_assert_uint_eq(last->abort_code, 0x06090030);
    plant_free(plant);
}
END_TEST

/* --- 5: a halt is no end --- */

/* A wrong device stands at a mandatory node; it is exchanged, and the network starts. */
START_TEST(test_halt_is_lifted)
{
    struct plant *plant = watch_two(PLANT_NODE(5, MANDATORY "<Serial_Number>5</Serial_Number>")
                                        PLANT_NODE(6, ""));

    plant_lie(plant, "605#40181004", "585#431810044D000000", 1);
    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->state, NETWORK_HALTED);
    ck_assert_uint_eq(plant_sent(plant, "000#01"), 0);
    restart(plant, 5);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_said_times(plant, "network is up: 2 of 2 nodes booted"), 1);
    plant_free(plant);
}
END_TEST

/* The manager goes to pre-operational and back, and nobody is reset or configured for it. */
START_TEST(test_manager_in_preoperational)
{
    struct plant *plant = watch_two(PLANT_NODE(5, MANDATORY) PLANT_NODE(6, ""));

    plant_power_on(plant);
    plant_run_ms(plant, 1000);
    plant->sim.trace_count = 0;
    ck_assert_int_eq(plant_command(plant, NMT_ENTER_PREOPERATIONAL, 127), CO_OK);
    plant_run_ms(plant, 1000);
    ck_assert_int_eq(plant->manager->device.state, NMT_PREOPERATIONAL);
    ck_assert_int_eq(plant->devices[5]->slave.state, NMT_OPERATIONAL);
    ck_assert_int_eq(plant_command(plant, NMT_START, 127), CO_OK);
    plant_run_ms(plant, 1000);
    watch_expect_up(plant, "is not up");
    ck_assert_uint_eq(plant_sent(plant, "000#"), 0);
    ck_assert_uint_eq(plant_sent(plant, "605#"), 0);
    plant_free(plant);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tcase = tcase_create("lessons");

    tcase_add_test(tcase, test_guarded_node_is_seen_to_boot);
    tcase_add_test(tcase, test_guarded_node_is_seen_to_restart);
    tcase_add_test(tcase, test_guarded_node_is_restored);
    tcase_add_loop_test(tcase, test_restart_in_mid_configuration, 0, (int)WATCH_ENTRIES);
    tcase_add_loop_test(tcase, test_reads_are_repeated, 0, 5);
    tcase_add_test(tcase, test_reads_are_given_up);
    tcase_add_test(tcase, test_time_out_of_each_node);
    tcase_add_loop_test(tcase, test_boot_time_covers_each_step, 0, ROWS(hangs));
    tcase_add_test(tcase, test_record_of_refused_write);
    tcase_add_test(tcase, test_halt_is_lifted);
    tcase_add_test(tcase, test_manager_in_preoperational);
    return suite_run("lessons", tcase);
}

/*
 * NMT_Verify_Software and NMT_Allow_Software_Update: a device with a boot loader, which the test
 * plays, is checked and given its program.
 */
#include "support/loader.h"
#include "support/suite.h"
#include "support/watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEEP                                                                                       \
    "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"                                              \
    "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"

#define CHECK   " r1F56:1"
#define STOP    " r1F51:1 w1F51:1=0 r1F51:1"
#define CLEAR   " w1F51:1=3 r1F57:1"
#define WRITE   " b1F50:1=7D0 r1F57:1"
#define START   " r1F56:1 w1F51:1=1 r1F51:1"
#define DONE    START CHECK " r1F51:1 w6200:1=55"
#define UPDATED CHECK STOP CLEAR WRITE DONE

/* --- the check --- */

static const struct check {
    const char *node;
    uint32_t id;
    const char *lie, *answer;
    const char *talk, *said;
} checks[] = {
    { "", LOADER_OLD, NULL, NULL, " w6200:1=55", "booted" },
    { LOADER_VERIFY, LOADER_NEW, NULL, NULL, CHECK " w6200:1=55", "checks its software" },
    { LOADER_UPDATE, LOADER_NEW, NULL, NULL, CHECK " r1F51:1 w6200:1=55",
      "1F56h:01 software identification is 00000022h" },
    { "<NMT_Verify_Software>TRUE</NMT_Verify_Software>", LOADER_OLD, NULL, NULL, "",
      "boot error G: Software_Identification is missing" },
    { LOADER_VERIFY, LOADER_OLD, "605#40561F01", "585#80561F0100000206", CHECK,
      "boot error G: read 1F56h:01 software identification: the node answers abort 06020000h" },
    { LOADER_VERIFY, LOADER_OLD, NULL, NULL, CHECK,
      "boot error H: 1F56h:01 software identification is 00000011h, configuration expects "
      "00000022h: update it, or set NMT_Allow_Software_Update" },
    { LOADER_UPDATE KEEP, LOADER_OLD, NULL, NULL, CHECK,
      "boot error H: 1F56h:01 software identification is 00000011h, configuration expects "
      "00000022h: a node that is to be kept alive (NMT_Check_Nodestate) is not updated" },
};

START_TEST(test_check)
{
    const struct check *row = &checks[_i];
    struct loader loader;
    bool fails = strncmp(row->said, "boot error", 10) == 0;

    loader_make(&loader, row->node);
    loader.id = row->id;
    if (row->lie)
        plant_lie(loader.plant, row->lie, row->answer, 1);
    loader_run(&loader, 2500);
    ck_assert_str_eq(plant_talk(loader.plant, 5), row->talk);
    ck_assert_msg(plant_said(loader.plant, row->said), "\"%s\" expected:\n%s", row->said,
                  loader.plant->events);
    ck_assert_int_eq(plant_node(loader.plant, 5)->booted, !fails);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, fails ? BOOT_FAILED : BOOT_STARTED);
    ck_assert_uint_eq(loader.programs, 0);
    plant_free(loader.plant);
}
END_TEST

/* It is asked three times, and again a second later. */
START_TEST(test_check_is_not_answered)
{
    struct loader loader;

    loader_make(&loader, LOADER_VERIFY);
    loader.id = LOADER_NEW;
    plant_lie(loader.plant, "605#40561F01", NULL, 3);
    loader_run_until(&loader,
                     "boot error G: read 1F56h:01 software identification: no answer within 200 ms "
                     "(3 tries): the node has gone in mid-boot",
                     2000);
    loader_run(&loader, 1500);
    watch_expect_up(loader.plant, "is not asked again");
    plant_free(loader.plant);
}
END_TEST

/* A start command that was on its way for long: the node is operational without its boot. */
START_TEST(test_started_while_it_is_checked)
{
    const struct co_frame start = nmt_command_frame(NMT_START, 5);
    struct loader loader;
    struct plant *plant;

    loader_make(&loader, LOADER_VERIFY);
    plant = loader.plant;
    loader.id = LOADER_NEW;
    plant_lie(plant, "605#40561F01", NULL, 1);
    loader_run_until(&loader, "checks its software", 500);
    co_outbox_put_frame(sim_box(&plant->sim, plant->manager_device), &start);
    loader_run(&loader, 1000);
    ck_assert_uint_eq(plant_sent(plant, "000#8205"), 1);
    watch_expect_up(plant, "started too early");
    plant_free(plant);
}
END_TEST

/* Found operational, it is not looked at at all. */
START_TEST(test_kept_alive)
{
    struct loader loader;
    struct plant_device *device;

    loader_make(&loader, LOADER_UPDATE KEEP);
    device = loader.plant->devices[5];
    slave_command(&device->slave, NMT_START, loader.plant->sim.now,
                  sim_box(&loader.plant->sim, device->sim));
    loader_run(&loader, 1000);
    ck_assert_str_eq(plant_talk(loader.plant, 5), "");
    ck_assert(plant_said(loader.plant, "is running already: kept alive (L)"));
    plant_free(loader.plant);
}
END_TEST

START_TEST(test_no_file)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    free(loader.plant->config->nodes[0].software);
    loader.plant->config->nodes[0].software = NULL;
    loader_run(&loader, 2500);
    loader_expect_failed(&loader,
                         "boot error I: 1F56h:01 software identification is 00000011h, "
                         "configuration expects 00000022h: there is no Software_File to update "
                         "it with");
    ck_assert_str_eq(plant_talk(loader.plant, 5), CHECK);
    plant_free(loader.plant);
}
END_TEST

/* --- the update --- */

/* The ways that devices have; all end with the new program. */
static const struct way {
    const char *name;
    unsigned off_at_stop, off_at_start;
    unsigned clear_ms, write_ms;
    const char *lie, *answer;
    unsigned times;
    const char *talk; /* NULL: any */
} ways[] = {
    { "plain", 0, 0, 50, 50, NULL, NULL, 0, UPDATED },
    { "restarts each time", 500, 500, 50, 50, NULL, NULL, 0, NULL },
    { "restarts long", 8000, 8000, 50, 50, NULL, NULL, 0, NULL },
    { "no blocks", 0, 0, 50, 50, "605#C6501F01", "585#80501F0101000405", 1,
      CHECK STOP CLEAR " b1F50:1=7D0 w1F50:1=7D0 r1F57:1" DONE },
    { "slow flash", 0, 0, 250, 350, NULL, NULL, 0,
      CHECK STOP CLEAR " r1F57:1 r1F57:1" WRITE " r1F57:1 r1F57:1 r1F57:1" DONE },
    { "no 1F57h", 0, 0, 50, 50, "605#40571F01", "585#80571F0100000206", 2, UPDATED },
    { "no 1F57h:01", 0, 0, 50, 50, "605#40571F01", "585#80571F0111000906", 2, UPDATED },
    { "not now", 0, 0, 50, 50, "605#40571F01", "585#80571F0122000008", 2,
      CHECK STOP CLEAR " r1F57:1 r1F57:1" WRITE DONE },
    { "silent while it clears", 0, 0, 50, 50, "605#40571F01", NULL, 3, NULL },
    { "1F51h is write-only", 0, 0, 50, 50, "605#40511F01", "585#80511F0101000106", 4, UPDATED },
    { "asked twice for its state", 0, 0, 50, 50, "605#40511F01", NULL, 2, NULL },
    { "stop is not answered", 500, 0, 50, 50, "605#2F511F0100", NULL, 1, NULL },
    { "start is not answered", 0, 500, 50, 50, "605#2F511F0101", NULL, 1, NULL },
    { "says what it is only when it runs", 0, 0, 50, 50, NULL, NULL, 0, UPDATED },
};

/* It does what it was told, though it does not answer. */
static void follow_silent(struct loader *self, const char *lie)
{
    loader_run(self, 260);
    loader_follow(self, (uint8_t)(lie[13] - '0'));
}

START_TEST(test_way)
{
    const struct way *row = &ways[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.off_at_stop = row->off_at_stop;
    loader.off_at_start = row->off_at_start;
    loader.clear_ms = row->clear_ms;
    loader.write_ms = row->write_ms;
    if (row->lie)
        plant_lie(loader.plant, row->lie, row->answer, row->times);
    if (strstr(row->name, "stop is not"))
        follow_silent(&loader, row->lie);
    if (strstr(row->name, "start is not")) {
        loader_run_until(&loader, "starts its program", 3000);
        loader_follow(&loader, 1);
    }
    if (strstr(row->name, "only when it runs")) {
        loader_run_until(&loader, "writes its program", 3000);
        plant_lie(loader.plant, "605#40561F01", "585#80561F0124000008", 1);
    }
    loader_run_until(&loader, "node 5: start command sent", 25000);
    loader_run(&loader, 10);
    loader_expect_updated(&loader, row->name);
    ck_assert_uint_eq(loader.programs, 1);
    ck_assert_msg(!plant_said(loader.plant, "error"), "%s: %s", row->name, loader.plant->events);
    if (row->talk)
        ck_assert_str_eq(plant_talk(loader.plant, 5), row->talk);
    plant_free(loader.plant);
}
END_TEST

START_TEST(test_what_is_told)
{
    static const char *const said[] = { "stops its program",
                                        "clears its program",
                                        "writes its program: 2000 bytes of pump.bin",
                                        "its program is written, compares it",
                                        "starts its program",
                                        "node 5: booted" };
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    for (unsigned i = 0; i < sizeof said / sizeof said[0]; i++)
        loader_run_until(&loader, said[i], 1000);
    for (unsigned i = 0; i < sizeof said / sizeof said[0]; i++)
        ck_assert_uint_eq(plant_said_times(loader.plant, said[i]), 1);
    plant_free(loader.plant);
}
END_TEST

/* It has the right program, which does not run: an update was cut off before the end. */
START_TEST(test_stopped)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.id = LOADER_NEW;
    loader.running = false;
    loader_run(&loader, 1000);
    loader_expect_updated(&loader, "not started");
    ck_assert_str_eq(plant_talk(loader.plant, 5),
                     CHECK " r1F51:1 w1F51:1=1 r1F51:1" CHECK " r1F51:1 w6200:1=55");
    plant_free(loader.plant);
}
END_TEST

/* It is back in its boot loader each time. */
START_TEST(test_stops_again)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.id = LOADER_NEW;
    loader.running = false;
    loader.deaf = true;
    for (unsigned i = 0; i < 5; i++) {
        loader_run(&loader, 250);
        loader_restart(&loader, 50);
    }
    loader_run(&loader, 1000);
    loader_expect_failed(&loader,
                         "boot error I: its program, 1F51h:01, does not go on running: started 3 "
                         "times");
    ck_assert_uint_eq(plant_said_times(loader.plant, "starts its program"), 3);
    plant_free(loader.plant);
}
END_TEST

/* --- refusals, once: nothing is tried again --- */

static const struct refusal {
    const char *lie, *answer;
    const char *said;
} refusals[] = {
    { "605#2F511F0100", "585#80511F0130000906",
      "boot error I: stop its program, 1F51h:01: the node answers abort 06090030h" },
    { "605#2F511F0103", "585#80511F0130000906",
      "boot error I: clear its program, 1F51h:01: the node answers abort 06090030h" },
    { "605#40571F01", "585#80571F0100000606",
      "boot error I: wait for its flash to be cleared, 1F57h:01: the node answers abort "
      "06060000h" },
    { "605#40571F01", "585#43571F010A000000",
      "boot error I: wait for its flash to be cleared, 1F57h:01: flash status 0000000Ah, flash "
      "write error" },
    { "605#C6501F01", "585#80501F0100000606",
      "boot error I: write its program, 1F50h:01: the node answers abort 06060000h" },
    { "605#2F511F0101", "585#80511F0130000906",
      "boot error I: start its program, 1F51h:01: the node answers abort 06090030h" },
};

START_TEST(test_refusal)
{
    const struct refusal *row = &refusals[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    plant_lie(loader.plant, row->lie, row->answer, 9);
    loader_run(&loader, 4000);
    loader_expect_failed(&loader, row->said);
    ck_assert_uint_eq(plant_said_times(loader.plant, "checks its software"), 1);
    ck_assert_uint_eq(sim_count(&loader.plant->sim, 0), 1); /* no reset either */
    plant_free(loader.plant);
}
END_TEST

/* What the flash says when the program is there. */
static const struct {
    uint32_t status;
    const char *text;
} flash[] = {
    { 1 << 1, "00000002h, no valid program" },
    { 2 << 1, "00000004h, data format unknown" },
    { 3 << 1, "00000006h, checksum wrong" },
    { 4 << 1, "00000008h, flash not cleared" },
    { 5 << 1, "0000000Ah, flash write error" },
    { 6 << 1, "0000000Ch, address error" },
    { 7 << 1, "0000000Eh, flash secured" },
    { 8 << 1, "00000010h, memory access error" },
    { 64 << 1, "00000080h, error of the manufacturer" },
};

START_TEST(test_flash_status)
{
    char said[200];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.written = flash[_i].status;
    loader_run(&loader, 3000);
    snprintf(said, sizeof said,
             "boot error I: wait for its flash to be written, 1F57h:01: flash status %s",
             flash[_i].text);
    loader_expect_failed(&loader, said);
    plant_free(loader.plant);
}
END_TEST

START_TEST(test_other_program)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.written_id = 0x23;
    loader_run(&loader, 3000);
    loader_expect_failed(&loader,
                         "boot error I: compare its new program, 1F56h:01: it is 00000023h, "
                         "configuration expects 00000022h: Software_File is another program than "
                         "Software_Identification says");
    ck_assert(!loader.running);
    plant_free(loader.plant);
}
END_TEST

/* --- deadlines --- */

static const struct limit {
    const char *lie; /* not answered from the beginning; NULL: the device is deaf, or slow */
    const char *phase;
    unsigned ms; /* from the phase's begin to its end, and 400 ms less and more than that */
    bool deaf, slow_clear, slow_write;
    const char *said;
    unsigned updates;
} limits[] = {
    { NULL, "stops its program", 10100, true, false, false,
      "boot error I: wait for its program to stop, 1F51h:01: still 00000001h after 10000 ms", 1 },
    { "605#2F511F0103", "clears its program", 10000, false, false, false,
      "boot error I: clear its program, 1F51h:01: no answer within 10000 ms", 3 },
    { NULL, "clears its program", 60100, false, true, false,
      "boot error I: wait for its flash to be cleared, 1F57h:01: still 00000001h after 60000 ms",
      1 },
    { "605#40571F01", "clears its program", 60100, false, false, false,
      "boot error I: wait for its flash to be cleared, 1F57h:01: no answer within 60000 ms", 3 },
    { "605#C6501F01", "writes its program", 10000, false, false, false,
      "boot error I: write its program, 1F50h:01: no answer within 10000 ms", 3 },
    { NULL, "writes its program", 60100, false, false, true,
      "boot error I: wait for its flash to be written, 1F57h:01: still 00000001h after 60000 ms",
      1 },
};

START_TEST(test_limit)
{
    const struct limit *row = &limits[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader.deaf = row->deaf;
    loader.clear_ms = row->slow_clear ? 100000 : 50;
    loader.write_ms = row->slow_write ? 100000 : 50;
    if (row->lie)
        plant_lie(loader.plant, row->lie, NULL, 100000);
    loader_run_until(&loader, row->phase, 5000);
    loader_run(&loader, row->ms - 400);
    ck_assert_msg(!plant_said(loader.plant, "error"), "%s: %s", row->said, loader.plant->events);
    loader_run_until(&loader, row->said, 800);
    loader_run(&loader, 3 * (row->ms + 3000));
    ck_assert_uint_eq(plant_said_times(loader.plant, row->phase), row->updates);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, BOOT_FAILED);
    plant_free(loader.plant);
}
END_TEST

/* It is told to start and does not. */
START_TEST(test_does_not_start)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader_run_until(&loader, "starts its program", 3000);
    loader.deaf = true;
    loader.command_count = 0;
    loader_run(&loader, 9700);
    ck_assert(!plant_said(loader.plant, "error"));
    loader_run_until(
        &loader,
        "boot error I: wait for its program to start, 1F51h:01: still 00000000h after 10000 "
        "ms",
        800);
    loader_run(&loader, 2000);
    ck_assert_int_eq(plant_node(loader.plant, 5)->step, BOOT_FAILED);
    plant_free(loader.plant);
}
END_TEST

START_TEST(test_does_not_tell_that_it_starts)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader_run_until(&loader, "starts its program", 3000);
    plant_lie(loader.plant, "605#40511F01", NULL, 1000);
    loader_run(&loader, 9900);
    ck_assert(!plant_said(loader.plant, "error"));
    loader_run_until(
        &loader,
        "boot error I: wait for its program to start, 1F51h:01: no answer within 10000 "
        "ms",
        800);
    ck_assert_uint_lt(plant_sent(loader.plant, "605#40511F01"), 40); /* each once, after a pause */
    loader_run(&loader, 3000);
    loader_expect_updated(&loader, "it does run");
    ck_assert_uint_eq(loader.programs, 1);
    plant_free(loader.plant);
}
END_TEST

START_TEST(test_does_not_tell_whether_it_runs)
{
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    plant_lie(loader.plant, "605#40511F01", NULL, 1000);
    loader_run(&loader, 8000);
    ck_assert_uint_eq(plant_said_times(loader.plant,
                                       "boot error I: ask whether its program runs, 1F51h:01: no "
                                       "answer within 200 ms"),
                      1);
    loader_expect_failed(&loader, "and 3 updates have not changed that");
    ck_assert_uint_eq(plant_sent(loader.plant, "605#40511F01"), 9);
    ck_assert_uint_eq(plant_sent(loader.plant, "605#2F511F01"), 0);
    plant_free(loader.plant);
}
END_TEST

/* An answer that fits no request: a second master, most often. It is tried again. */
static const struct garbled {
    const char *from; /* when this was said */
    const char *request, *answer, *said;
} garbled[] = {
    { "boot begins", "605#40511F01", "585#60511F0100000000", "ask whether its program runs" },
    { "boot begins", "605#2F511F0100", "585#4F511F0100000000", "stop its program" },
    { "stops its program", "605#40511F01", "585#60511F0100000000", "wait for its program to stop" },
    { "clears its program", "605#40571F01", "585#60571F0100000000", "flash to be cleared" },
    { "writes its program", "605#40571F01", "585#60571F0100000000", "flash to be written" },
    { "writes its program", "605#40561F01", "585#60561F0100000000", "compare its new program" },
    { "starts its program", "605#40511F01", "585#60511F0100000000",
      "wait for its program to start" },
};

START_TEST(test_garbled)
{
    const struct garbled *row = &garbled[_i];
    struct loader loader;

    loader_make(&loader, LOADER_UPDATE);
    loader_run_until(&loader, row->from, 3000);
    plant_lie(loader.plant, row->request, row->answer, 1);
    loader_run(&loader, 5000);
    ck_assert_msg(plant_said_times(loader.plant, row->said) == 1, "%s: %s", row->said,
                  loader.plant->events);
    ck_assert(plant_said(loader.plant, "wrong answer, aborted with 05040001h"));
    loader_expect_updated(&loader, row->said);
    plant_free(loader.plant);
}
END_TEST

#define LOOP(test, rows) tcase_add_loop_test(tcase, test, 0, sizeof rows / sizeof rows[0])

int main(void)
{
    TCase *tcase = tcase_create("software");

    LOOP(test_check, checks);
    tcase_add_test(tcase, test_check_is_not_answered);
    tcase_add_test(tcase, test_started_while_it_is_checked);
    tcase_add_test(tcase, test_kept_alive);
    tcase_add_test(tcase, test_no_file);
    LOOP(test_way, ways);
    tcase_add_test(tcase, test_what_is_told);
    tcase_add_test(tcase, test_stopped);
    tcase_add_test(tcase, test_stops_again);
    LOOP(test_refusal, refusals);
    LOOP(test_flash_status, flash);
    tcase_add_test(tcase, test_other_program);
    LOOP(test_limit, limits);
    tcase_add_test(tcase, test_does_not_start);
    tcase_add_test(tcase, test_does_not_tell_that_it_starts);
    tcase_add_test(tcase, test_does_not_tell_whether_it_runs);
    LOOP(test_garbled, garbled);
    return suite_run("software", tcase);
}

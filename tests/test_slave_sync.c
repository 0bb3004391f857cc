/* SYNC of a device: what it does with one, when it sends one, and data that is asked for first. */
#include "slave/slave.h"

#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct device_entry entries[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1006, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1007, 0, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1010, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1019, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1400, 1, OD_UNSIGNED32, OD_RW, 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1600, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW, 0x20000010, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1800, 6, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x21000010, false },
    { 0x1801, 1, OD_UNSIGNED32, OD_RW, 0x80000285, false },
    { 0x1801, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1801, 5, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1A01, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A01, 1, OD_UNSIGNED32, OD_RW, 0x21010008, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RWW, 0, true },
    { 0x2100, 0, OD_UNSIGNED16, OD_RWR, 0x1111, true },
    { 0x2101, 0, OD_UNSIGNED8, OD_RWR, 0, true },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
}

static void teardown(void)
{
    device_done(&device);
}

/* clang-format off */
#define BOOT { 0, SENDS, "705#00" }
#define START { 0, HEARS, "000#0105" }
#define STATES { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" }, { 0, TELLS, "state 5" }
/* 1005h: produces; 1006h: 10 ms, 4 ms; 1007h: 3 ms; 1019h: 3 */
#define PRODUCE { 0, HEARS, "605#2305100080000040" }, { 0, SENDS, "585#6005100000000000" }
#define PERIOD  { 0, HEARS, "605#2306100010270000" }, { 0, SENDS, "585#6006100000000000" }
#define PERIOD4 { 0, HEARS, "605#23061000A00F0000" }, { 0, SENDS, "585#6006100000000000" }
#define WINDOW  { 0, HEARS, "605#23071000B80B0000" }, { 0, SENDS, "585#6007100000000000" }
#define COUNTER { 0, HEARS, "605#2F19100003000000" }, { 0, SENDS, "585#6019100000000000" }

static const struct device_talk talks[] = {
    { "consumed only when operational",
      { BOOT, { 1, HEARS, "080#" }, START, { 2, HEARS, "080#" }, { 2, SENDS, "185#1111" },
        { 3, HEARS, "080#R" }, { 3, HEARS, "00000080#" }, { 3, ECHOES, "080#" },
        { 4, HEARS, "000#0205" }, { 5, HEARS, "080#" }, { 6, QUIET, "-" } } },
    { "another identifier, of 29 bits",
      { BOOT, { 0, HEARS, "605#2305100045230120" }, { 0, SENDS, "585#6005100000000000" },
        START, { 2, HEARS, "080#" }, { 2, HEARS, "00012345#" }, { 2, SENDS, "185#1111" } } },
    { "of a wrong length, while it is stopped: that is not for it",
      { BOOT, START, STATES, { 1, HEARS, "000#0205" }, { 1, TELLS, "state 4" },
        { 2, HEARS, "080#05" }, { 10, QUIET, "-" }, { 10, HEARS, "000#8005" },
        { 10, TELLS, "state 127" }, { 20, QUIET, "-" } } },
    { "of a wrong length: processed, one emergency, until it is right",
      { BOOT, START, STATES, { 1, HEARS, "080#05" }, { 1, SENDS, "185#1111" },
        { 1, SENDS, "085#4082110000000100" },
        { 1, TELLS, "sync wrong 8240, 1 of 0" }, { 1, TELLS, "emcy 8240 11" },
        { 2, HEARS, "080#05" }, { 2, SENDS, "185#1111" },
        { 3, HEARS, "080#" }, { 3, SENDS, "185#1111" }, { 3, SENDS, "085#0000000000000000" },
        { 3, TELLS, "emcy 0000 00" } } },
    { "of a wrong length: when a counter is expected, and in pre-operational",
      { BOOT, COUNTER, { 1, HEARS, "080#" }, { 1, SENDS, "085#4082110000000001" },
        { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" }, { 3, HEARS, "080#" },
        { 4, QUIET, "-" } } },
    { "the start value",
      { BOOT, { 0, HEARS, "605#2300180185010080" }, { 0, SENDS, "585#6000180100000000" },
        { 0, HEARS, "605#2F00180603000000" }, { 0, SENDS, "585#6000180600000000" },
        { 0, HEARS, "605#2300180185010000" }, { 0, SENDS, "585#6000180100000000" },
        COUNTER, START,
        { 1, HEARS, "080#01" }, { 2, HEARS, "080#02" },
        { 3, HEARS, "080#03" }, { 3, SENDS, "185#1111" },
        { 4, HEARS, "080#01" }, { 4, SENDS, "185#1111" } } },
    { "behind the window data received counts nothing until the next SYNC",
      { BOOT, WINDOW, START,
        { 1, HEARS, "205#0100" }, { 2, HEARS, "080#" }, { 2, SENDS, "185#1111" },
        { 2, HEARS, "605#4000200000000000" }, { 2, SENDS, "585#4B00200001000000" },
        { 5, HEARS, "205#0200" }, { 6, HEARS, "205#0300" },
        { 9, HEARS, "080#" }, { 9, SENDS, "185#1111" },
        { 9, HEARS, "605#4000200000000000" }, { 9, SENDS, "585#4B00200002000000" } } },
    { "produced: in pre-operational and operational, its own data with it",
      { BOOT, PERIOD, PRODUCE, { 9, QUIET, "-" }, { 10, SENDS, "080#" },
        { 11, HEARS, "000#0105" }, { 12, HEARS, "205#0700" },
        { 20, SENDS, "080#" }, { 20, SENDS, "185#1111" }, { 20, ECHOES, "080#" },
        { 21, HEARS, "605#4000200000000000" }, { 21, SENDS, "585#4B00200007000000" },
        { 22, HEARS, "000#0205" }, { 95, QUIET, "-" },
        { 95, HEARS, "000#8005" }, { 105, SENDS, "080#" } } },
    { "produced: bit 30 and period end it",
      { BOOT, PERIOD, { 50, QUIET, "-" },
        { 50, HEARS, "605#2305100080000040" }, { 50, SENDS, "585#6005100000000000" },
        { 60, SENDS, "080#" },
        { 61, HEARS, "605#2306100000000000" }, { 61, SENDS, "585#6006100000000000" },
        { 99, QUIET, "-" },
        { 100, HEARS, "605#2306100010270000" }, { 100, SENDS, "585#6006100000000000" },
        { 110, SENDS, "080#" }, { 120, SENDS, "080#" },
        { 121, HEARS, "605#2305100080000000" }, { 121, SENDS, "585#6005100000000000" },
        { 300, QUIET, "-" } } },
    { "produced: with a counter, from 1 after stopped and reset",
      { BOOT, COUNTER, PERIOD, PRODUCE,
        { 10, SENDS, "080#01" }, { 20, SENDS, "080#02" }, { 25, HEARS, "000#0105" },
        { 30, SENDS, "080#03" }, { 30, SENDS, "185#1111" },
        { 40, SENDS, "080#01" }, { 40, SENDS, "185#1111" },
        { 50, SENDS, "080#02" }, { 50, SENDS, "185#1111" },
        { 51, HEARS, "000#0200" }, { 60, HEARS, "000#8000" }, { 70, SENDS, "080#01" },
        { 80, SENDS, "080#02" }, { 81, HEARS, "605#2310100173617665" },
        { 81, SENDS, "585#6010100100000000" }, { 85, HEARS, "000#8205" }, { 85, SENDS, "705#00" },
        { 95, SENDS, "080#01" } } },
    { "a second producer is consumed",
      { BOOT, PERIOD, PRODUCE, START, { 5, HEARS, "080#" }, { 5, SENDS, "185#1111" },
        { 10, SENDS, "080#" }, { 10, SENDS, "185#1111" } } },
    { "data that is asked for: an answer, none, a late one",
      { BOOT, { 0, DOES, "watch 2100:00" }, START, STATES,
        { 10, HEARS, "080#" }, { 10, TELLS, "wanted 1 1" }, { 12, DOES, "set 2100:00 1234" },
        { 12, DOES, "answer 1 1" }, { 12, SENDS, "185#3412" },
        { 30, HEARS, "080#" }, { 30, TELLS, "wanted 1 2" }, { 39, QUIET, "-" },
        { 40, SENDS, "185#3412" }, { 41, DOES, "answer 1 2" }, { 42, DOES, "answer 2 1" },
        { 42, DOES, "answer 9 1" }, { 50, QUIET, "-" } } },
    { "half of the period is the time for an answer",
      { BOOT, PERIOD4, { 0, DOES, "watch 2100:00" }, START,
        { 10, HEARS, "080#" }, { 11, QUIET, "-" }, { 12, SENDS, "185#1111" } } },
    { "the window is the time for an answer",
      { BOOT, PERIOD4, WINDOW, { 0, DOES, "watch 2100:00" }, START,
        { 10, HEARS, "080#" }, { 12, QUIET, "-" }, { 13, SENDS, "185#1111" },
        { 20, HEARS, "080#" }, { 22, DOES, "answer 1 2" }, { 22, SENDS, "185#1111" } } },
    { "a window is the time for an answer even where it is long",
      { BOOT, { 0, HEARS, "605#2307100050C30000" }, { 0, SENDS, "585#6007100000000000" },
        { 0, DOES, "watch 2100:00" }, START,
        { 10, HEARS, "080#" }, { 59, QUIET, "-" }, { 60, SENDS, "185#1111" } } },
    { "data received does not wait for data that is asked for",
      { BOOT, { 0, DOES, "flags r1 1" }, { 0, DOES, "watch 2100:00" }, START, STATES,
        { 5, HEARS, "205#0700" }, { 10, HEARS, "080#" }, { 10, TELLS, "wanted 1 1" },
        { 10, TELLS, "rpdo 1 0700 at 5" }, { 20, SENDS, "185#1111" } } },
    { "the event timer asks where it is to, changes do not",
      { BOOT, { 0, DOES, "watch 2101:00" }, { 0, DOES, "flags t2 5" },
        { 0, HEARS, "605#2B01180564000000" }, { 0, SENDS, "585#6001180500000000" },
        { 0, HEARS, "605#2301180185020000" }, { 0, SENDS, "585#6001180100000000" },
        { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" },
        { 0, TELLS, "written 1801:05 = 100" }, { 0, TELLS, "written 1801:01 = 645" },
        { 0, HEARS, "000#0105" }, { 0, SENDS, "285#00" }, { 0, TELLS, "state 5" },
        { 100, TELLS, "wanted 2 1" },
        { 101, DOES, "set 2101:00 7" }, { 102, DOES, "set 2101:00 8" },
        { 103, DOES, "answer 2 1" }, { 103, SENDS, "285#08" },
        { 104, DOES, "set 2101:00 9" }, { 104, SENDS, "285#09" },
        { 204, TELLS, "wanted 2 2" }, { 214, SENDS, "285#09" } } },
    { "a request asks",
      { BOOT, { 0, DOES, "watch 2101:00" },
        { 0, HEARS, "605#2301180185020000" }, { 0, SENDS, "585#6001180100000000" }, START,
        { 10, HEARS, "285#R1" }, { 11, DOES, "set 2101:00 7" }, { 12, DOES, "answer 2 1" },
        { 12, SENDS, "285#07" }, { 20, HEARS, "285#R1" }, { 30, SENDS, "285#07" } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

START_TEST(conversation)
{
    device_start(&device);
    device.stalled = _i % 2 != 0;
    device_talk(&device, &talks[_i / 2]);
}
END_TEST

/* Room comes when the window is over: dropped, and counted. */
START_TEST(window_passes_without_room)
{
    const struct tpdo *tpdo = slave_tpdo(&device.slave, 1);

    device_start(&device);
    ck_assert_uint_eq(device_write(&device, 0x1007, 0, 4, 3000), SDO_OK);
    device_hear(&device, "000#0105");
    device_drain(&device);
    device_forget(&device);
    for (unsigned late = 0; late < 2; late++) {
        device_fill(&device, 0, 0);
        device_hear(&device, "080#");
        device.now += 3000 + late;
        device_drain(&device);
        slave_on_time(&device.slave, device.now, &device.out);
        device_drain(&device);
        ck_assert_str_eq(device_next_frame(&device, NULL), late ? "" : "185#1111");
        ck_assert_uint_eq(tpdo->missed, late);
        ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
    }
}
END_TEST

/* ---- who sends ---- */

static void produce(uint32_t period, uint8_t overflow)
{
    device_start(&device);
    ck_assert_uint_eq(device_write(&device, 0x1019, 0, 1, overflow), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1006, 0, 4, period), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1005, 0, 4, 0x40000080), SDO_OK);
    device_forget(&device);
}

START_TEST(plan_of_the_sender)
{
    struct slave_sync_plan plan;
    unsigned generation;

    device_start(&device);
    slave_sync_plan(&device.slave, &plan);
    ck_assert(!plan.active);
    produce(10000, 5);
    slave_sync_plan(&device.slave, &plan);
    ck_assert(plan.active);
    ck_assert(!plan.ext);
    ck_assert_uint_eq(plan.cob_id, 0x80);
    ck_assert_uint_eq(plan.overflow, 5);
    ck_assert_uint_eq(plan.period, 10000);
    generation = device.slave.sync_generation;
    device_hear(&device, "000#0105"); /* goes on */
    device_hear(&device, "000#8005");
    ck_assert_uint_eq(device_write(&device, 0x1400, 2, 1, 255), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1007, 0, 4, 100), SDO_OK);
    ck_assert_uint_eq(device.slave.sync_generation, generation);
    device_hear(&device, "000#0205");
    ck_assert_uint_eq(device.slave.sync_generation, generation + 1);
    slave_sync_plan(&device.slave, &plan);
    ck_assert(!plan.active);
    device_hear(&device, "000#0105");
    ck_assert_uint_eq(device.slave.sync_generation, generation + 2);
    slave_sync_plan(&device.slave, &plan);
    ck_assert(plan.active);
}
END_TEST

/* Everything that changes the plan, or starts it anew. */
START_TEST(generation_of_the_plan)
{
    static const struct {
        uint16_t index;
        uint8_t size;
        uint32_t value;
    } writes[] = { { 0x1006, 4, 20000 },
                   { 0x1006, 4, 0 },
                   { 0x1019, 1, 7 },
                   { 0x1005, 4, 0x80 },
                   { 0x1005, 4, 0x60012345 } };
    struct slave_sync_plan plan;

    produce(10000, 5);
    for (size_t i = 0; i < sizeof writes / sizeof writes[0]; i++) {
        const unsigned generation = device.slave.sync_generation;

        ck_assert_uint_eq(
            device_write(&device, writes[i].index, 0, writes[i].size, writes[i].value), SDO_OK);
        ck_assert_uint_ne(device.slave.sync_generation, generation);
    }
    ck_assert_uint_eq(device_write(&device, 0x1006, 0, 4, 1000), SDO_OK);
    slave_sync_plan(&device.slave, &plan);
    ck_assert(plan.active && plan.ext);
    ck_assert_uint_eq(plan.cob_id, 0x12345);
    ck_assert_uint_eq(plan.overflow, 7);
    device_hear(&device, "000#8205");
    slave_sync_plan(&device.slave, &plan);
    ck_assert(!plan.active);
}
END_TEST

/* The kernel sends: its frames are the device's SYNC, and missed when they do not come. */
START_TEST(sent_by_somebody_else)
{
    produce(10000, 0);
    slave_sync_external(&device.slave, true);
    device_hear(&device, "000#0105");
    for (unsigned i = 1; i <= 3; i++) {
        device_run(&device, CO_MS(10 * i));
        device_hear(&device, "080#");
        device_drain(&device);
        ck_assert_str_eq(device_next_frame(&device, NULL), "185#1111");
    }
    ck_assert_str_eq(device_next_event(&device), "state 5");
    device_run(&device, CO_MS(1530) - 1);
    ck_assert_str_eq(device_next_event(&device), "");
    device_run(&device, CO_MS(1530));
    ck_assert_str_eq(device_next_event(&device), "sync missing");
    device_run(&device, CO_MS(9000));
    ck_assert_str_eq(device_next_event(&device), "");
    ck_assert_uint_eq(device.slave.sync.outages, 1);
    ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
    slave_sync_external(&device.slave, false);
    device_run(&device, CO_MS(9010));
    ck_assert_str_eq(device_next_frame(&device, NULL), "080#");
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#1111");
}
END_TEST

/* 100 SYNCs of 100 ms, and a type of 10: as the conformance test counts them. */
START_TEST(counted)
{
    unsigned syncs = 0, data = 0;

    produce(100000, 0);
    ck_assert_uint_eq(device_write(&device, 0x1800, 2, 1, 10), SDO_OK);
    device_forget(&device);
    device_hear(&device, "000#0105");
    device_run(&device, CO_MS(10000));
    for (const char *frame = device_next_frame(&device, NULL); *frame != '\0';
         frame = device_next_frame(&device, NULL)) {
        syncs += strcmp(frame, "080#") == 0;
        data += strcmp(frame, "185#1111") == 0;
    }
    ck_assert_uint_eq(syncs, 100);
    ck_assert_uint_eq(data, 10);
}
END_TEST

/* Nothing depends on SYNC: the device neither wants to hear it nor minds its length. */
START_TEST(no_use_for_it)
{
    device_start(&device);
    ck_assert_uint_eq(device_write(&device, 0x1400, 2, 1, 255), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1800, 2, 1, 255), SDO_OK);
    device_forget(&device);
    ck_assert(!device.slave.consumes_sync);
    device_hear(&device, "080#05");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    ck_assert_uint_eq(device_write(&device, 0x1800, 2, 1, 252), SDO_OK);
    ck_assert(device.slave.consumes_sync);
}
END_TEST

/* Without 1019h a device is older than the counter: any length is right. */
START_TEST(before_the_counter)
{
    struct device_entry old[sizeof entries / sizeof entries[0]] = { { 0 } };
    size_t count = 0;

    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
        if (entries[i].index != 0x1019)
            old[count++] = entries[i];
    device_done(&device);
    device_init(&device, old);
    device_start(&device);
    device_hear(&device, "000#0105");
    device_drain(&device);
    device_forget(&device);
    device_hear(&device, "080#05");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "185#1111");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_sync");
    TCase *tcase = tcase_create("slave_sync");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * 2);
    tcase_add_test(tcase, window_passes_without_room);
    tcase_add_test(tcase, plan_of_the_sender);
    tcase_add_test(tcase, generation_of_the_plan);
    tcase_add_test(tcase, sent_by_somebody_else);
    tcase_add_test(tcase, counted);
    tcase_add_test(tcase, no_use_for_it);
    tcase_add_test(tcase, before_the_counter);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

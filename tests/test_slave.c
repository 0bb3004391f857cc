/* The NMT machine of a local device: states, boot-up, heartbeat, SDO, resets, error control. */
#include "slave/slave.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct device_entry entries[] = {
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1003, 2, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1015, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1016, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1016, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1017, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1029, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1029, 1, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RW, 0x1234, false },
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
static const struct device_talk talks[] = {
    { "boot-up once, then silent",
      { { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" },
        { 60000, QUIET, "-" } } },
    { "SDO in pre-operational",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#4000100000000000" }, { 1, SENDS, "585#4300100000000000" },
        { 2, HEARS, "605#2B00200078560000" }, { 2, SENDS, "585#6000200000000000" },
        { 2, TELLS, "state 0" }, { 2, TELLS, "state 127" }, { 2, TELLS, "written 2000:00 = 22136" },
        { 3, HEARS, "605#4000200000000000" }, { 3, SENDS, "585#4B00200078560000" } } },
    { "commands to others, to all, malformed and unknown ones",
      { { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" },
        { 1, HEARS, "000#0106" }, { 1, HEARS, "000#01" }, { 1, HEARS, "000#010500" },
        { 1, HEARS, "000#0305" }, { 1, HEARS, "000#8305" }, { 1, HEARS, "000#0005" },
        { 1, HEARS, "000#R2" }, { 1, HEARS, "00000000#0105" }, { 1, TELLS, "" },
        { 2, HEARS, "000#0105" }, { 2, TELLS, "state 5" },
        { 3, HEARS, "000#0200" }, { 3, TELLS, "state 4" },
        { 4, HEARS, "000#8000" }, { 4, TELLS, "state 127" },
        { 5, QUIET, "-" } } },
    { "a repeated command changes nothing",
      { { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" },
        { 1, HEARS, "000#0105" }, { 1, HEARS, "000#0105" }, { 1, TELLS, "state 5" },
        { 2, HEARS, "000#0205" }, { 2, HEARS, "000#0205" }, { 2, TELLS, "state 4" },
        { 3, HEARS, "000#8005" }, { 3, HEARS, "000#8005" }, { 3, TELLS, "state 127" },
        { 4, TELLS, "" } } },
    { "a burst of commands",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#2B171000E8030000" }, { 1, SENDS, "585#6017100000000000" },
        { 1, SENDS, "705#7F" },
        { 2, HEARS, "000#8005" }, { 3, HEARS, "000#0105" }, { 4, HEARS, "000#0205" },
        { 5, HEARS, "000#0105" }, { 1001, SENDS, "705#05" } } },
    { "no SDO when stopped; the request repeated afterwards works",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "000#0205" }, { 2, HEARS, "605#4000100000000000" },
        { 1002, QUIET, "-" },
        { 1003, HEARS, "000#8005" }, { 1004, HEARS, "605#4000100000000000" },
        { 1004, SENDS, "585#4300100000000000" } } },
    { "stop ends a transfer silently, start does not",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#2100200002000000" }, { 1, SENDS, "585#6000200000000000" },
        { 2, HEARS, "000#0105" },
        { 3, HEARS, "605#0B11220000000000" }, { 3, SENDS, "585#2000000000000000" },
        { 4, HEARS, "605#2100200002000000" }, { 4, SENDS, "585#6000200000000000" },
        { 5, HEARS, "000#0205" }, { 6, HEARS, "605#0B33440000000000" },
        { 7, HEARS, "000#8005" }, { 2000, QUIET, "-" },
        { 2001, HEARS, "605#4000200000000000" }, { 2001, SENDS, "585#4B00200011220000" } } },
    { "a client that falls silent",
      { { 0, SENDS, "705#00" },
        { 10, HEARS, "605#2100200002000000" }, { 10, SENDS, "585#6000200000000000" },
        { 1009, QUIET, "-" }, { 1010, SENDS, "585#8000200000000405" } } },
    { "segmented write of 1017h, the heartbeat right behind the answer",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#2117100002000000" }, { 1, SENDS, "585#6017100000000000" },
        { 2, HEARS, "605#0BE8030000000000" }, { 2, SENDS, "585#2000000000000000" },
        { 2, SENDS, "705#7F" }, { 1002, SENDS, "705#7F" } } },
    { "SDO requests that do not fit",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#E000100000000000" }, { 1, SENDS, "585#8000100001000405" },
        { 2, HEARS, "605#4000100100000000" }, { 2, SENDS, "585#8000100111000906" },
        { 3, HEARS, "605#4004100000000000" }, { 3, SENDS, "585#8004100000000206" },
        { 4, HEARS, "605#2300100001000000" }, { 4, SENDS, "585#8000100002000106" },
        { 5, HEARS, "605#2317100001000000" }, { 5, SENDS, "585#8017100012000706" },
        { 6, HEARS, "605#2F17100001000000" }, { 6, SENDS, "585#8017100013000706" },
        { 7, HEARS, "605#2117100064000000" }, { 7, SENDS, "585#8017100012000706" },
        { 8, HEARS, "605#2117100002000000" }, { 8, SENDS, "585#6017100000000000" },
        { 8, HEARS, "605#1BE8030000000000" }, { 8, SENDS, "585#8017100000000305" },
        { 9, HEARS, "605#4017100000000000" }, { 9, SENDS, "585#4B17100000000000" } } },
    { "heartbeat: starts at once, tells each state, also when stopped, ends",
      { { 0, SENDS, "705#00" },
        { 5, HEARS, "605#2B17100064000000" }, { 5, SENDS, "585#6017100000000000" },
        { 5, SENDS, "705#7F" }, { 104, QUIET, "-" }, { 105, SENDS, "705#7F" },
        { 110, HEARS, "000#0105" }, { 205, SENDS, "705#05" },
        { 210, HEARS, "000#0205" }, { 305, SENDS, "705#04" },
        { 310, HEARS, "000#8005" }, { 405, SENDS, "705#7F" },
        { 410, HEARS, "605#2B17100000000000" }, { 410, SENDS, "585#6017100000000000" },
        { 5000, QUIET, "-" } } },
    { "resets: boot-up each, communication objects back, others only by reset node",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "605#2B00200078560000" }, { 1, SENDS, "585#6000200000000000" },
        { 2, HEARS, "605#2B171000E8030000" }, { 2, SENDS, "585#6017100000000000" },
        { 2, SENDS, "705#7F" }, { 3, HEARS, "000#0105" },
        { 4, HEARS, "000#8205" }, { 4, SENDS, "705#00" },
        { 5, HEARS, "605#4017100000000000" }, { 5, SENDS, "585#4B17100000000000" },
        { 5, HEARS, "605#4000200000000000" }, { 5, SENDS, "585#4B00200078560000" },
        { 6, HEARS, "000#0200" }, { 7, HEARS, "000#8100" }, { 7, SENDS, "705#00" },
        { 8, HEARS, "605#4000200000000000" }, { 8, SENDS, "585#4B00200034120000" },
        { 9000, QUIET, "-" } } },
    { "what each reset tells",
      { { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" },
        { 1, HEARS, "000#8105" }, { 1, SENDS, "705#00" },
        { 1, TELLS, "state 0" }, { 1, TELLS, "state 127" },
        { 1, HEARS, "000#8205" }, { 1, SENDS, "705#00" },
        { 1, TELLS, "state 0" }, { 1, TELLS, "state 127" }, { 1, TELLS, "" } } },
    { "frames of others",
      { { 0, SENDS, "705#00" },
        { 1, HEARS, "606#4000100000000000" }, { 1, HEARS, "585#4000100000000000" },
        { 1, HEARS, "00000605#4000100000000000" }, { 1, HEARS, "605#R8" },
        { 1, HEARS, "605#40001000000000" }, { 1, HEARS, "605#" }, { 1, HEARS, "080#" },
        { 1, HEARS, "7FF#010203040506" }, { 1, HEARS, "706#05" },
        { 1, HEARS, "7E5#0400000000000000" }, { 2000, QUIET, "-" } } },
};
/* clang-format on */

START_TEST(conversation)
{
    device_start(&device);
    device_talk(&device, &talks[_i]);
}
END_TEST

START_TEST(init_refuses_bad_node_ids)
{
    struct slave slave;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(slave_init(&slave, 0, &od), CO_ERR_ARG);
    ck_assert_int_eq(slave_init(&slave, 128, &od), CO_ERR_ARG);
    ck_assert_uint_eq(od.count, 0);
    od_done(&od);
}
END_TEST

START_TEST(init_adds_what_every_device_has)
{
    ck_assert(od_find(&device.od, 0x1000, 0) != NULL);
    ck_assert(od_find(&device.od, 0x1001, 0) != NULL);
    ck_assert_uint_eq(od_number(&device.od, 0x1018, 0, 0), 1);
    ck_assert(od_find(&device.od, 0x1018, 1) != NULL);
}
END_TEST

START_TEST(silent_until_started)
{
    device_hear(&device, "000#0105");
    device_hear(&device, "000#8105");
    device_hear(&device, "605#4000100000000000");
    slave_on_time(&device.slave, CO_MS(1000), &device.out);
    device_drain(&device);
    ck_assert_uint_eq(device.frame_count, 0);
    ck_assert_uint_eq(device.event_count, 0);
    ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
}
END_TEST

START_TEST(own_frames_are_ignored)
{
    struct co_frame frame = nmt_command_frame(NMT_START, NMT_ALL_NODES);

    device_start(&device);
    frame.flags |= CO_FRAME_OWN;
    slave_on_frame(&device.slave, &frame, 0, &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_PREOPERATIONAL);
    frame.flags = 0;
    slave_on_frame(&device.slave, &frame, 0, &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_OPERATIONAL);
}
END_TEST

START_TEST(commands_of_its_owner)
{
    device_start(&device);
    slave_command(&device.slave, NMT_START, 0, &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_OPERATIONAL);
    slave_command(&device.slave, NMT_RESET_NODE, 0, &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_PREOPERATIONAL);
}
END_TEST

START_TEST(default_heartbeat_counts_the_boot_up_as_its_first)
{
    static const struct device_talk talk = { "default heartbeat",
                                             { { 0, SENDS, "705#00" },
                                               { 99, QUIET, "-" },
                                               { 100, SENDS, "705#7F" },
                                               { 200, SENDS, "705#7F" } } };
    const uint8_t period[] = { 100, 0 };
    struct od_entry *entry = od_find(&device.od, 0x1017, 0);

    memcpy(entry->initial, period, 2);
    device_start(&device);
    device_talk(&device, &talk);
}
END_TEST

START_TEST(heartbeat_comes_with_the_answer)
{
    device_start(&device);
    device_forget(&device);
    device_hear(&device, "605#2B17100064000000");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#6017100000000000");
    ck_assert_str_eq(device_next_frame(&device, NULL), "705#7F");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

START_TEST(heartbeats_in_ten_seconds)
{
    device_start(&device);
    device_forget(&device);
    ck_assert_uint_eq(device_write(&device, 0x1017, 0, 2, 100), SDO_OK);
    device_run(&device, CO_MS(10000));
    ck_assert_uint_eq(device.frame_count, 1 + 101);
}
END_TEST

/* The buffer of the server is as large as the largest object. */
START_TEST(large_values)
{
    const struct od_spec spec = {
        .index = 0x2100, .type = OD_DOMAIN, .access = OD_RW, .capacity = 3000
    };
    struct device other;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(od_add(&od, &spec, NULL), CO_OK);
    device_init_od(&other, &od);
    device_start(&other);
    device_hear(&other, "605#21002100B80B0000"); /* 3000 = 428 * 7 + 4 bytes */
    for (unsigned i = 0; i <= 428; i++) {
        const char *const segments[] = { "605#0011223344556677", "605#1011223344556677",
                                         "605#0711223344000000" };

        device_hear(&other, segments[i < 428 ? i % 2 : 2]);
        device_drain(&other);
        ck_assert_uint_ne(other.frames[other.frame_count - 1].frame.data[0], 0x80);
        device_forget(&other);
    }
    ck_assert_uint_eq(od_find(&other.od, 0x2100, 0)->size, 3000);
    device_done(&other);
}
END_TEST

START_TEST(objects_with_1f80_start_by_themselves)
{
    static const struct {
        uint32_t value;
        uint8_t state;
    } cases[] = { { 0x0, NMT_OPERATIONAL },
                  { 0x4, NMT_PREOPERATIONAL },
                  { 0x1, NMT_PREOPERATIONAL },
                  { 0x8, NMT_OPERATIONAL } };
    struct slave slave;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(od_add_number(&od, 0x1F80, 0, OD_UNSIGNED32, OD_RW, cases[_i].value), CO_OK);
    ck_assert_int_eq(slave_init(&slave, 3, &od), CO_OK);
    slave_start(&slave, 0, &device.out);
    ck_assert_uint_eq(slave.state, cases[_i].state);
    slave_done(&slave);
    od_done(&od);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("slave");
    TCase *tcase = tcase_create("slave");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, (int)(sizeof talks / sizeof talks[0]));
    tcase_add_test(tcase, init_refuses_bad_node_ids);
    tcase_add_test(tcase, init_adds_what_every_device_has);
    tcase_add_test(tcase, silent_until_started);
    tcase_add_test(tcase, own_frames_are_ignored);
    tcase_add_test(tcase, commands_of_its_owner);
    tcase_add_test(tcase, default_heartbeat_counts_the_boot_up_as_its_first);
    tcase_add_test(tcase, heartbeat_comes_with_the_answer);
    tcase_add_test(tcase, heartbeats_in_ten_seconds);
    tcase_add_test(tcase, large_values);
    tcase_add_loop_test(tcase, objects_with_1f80_start_by_themselves, 0, 4);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* Values of clients that the application is asked about: its verdict, in time, late, or none. */
#include "slave/slave.h"

#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct device_entry entries[] = {
    { 0x1010, 1, OD_UNSIGNED32, OD_RW, 1, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x20000010, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RW, 0, true },
    { 0x2001, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x2002, 0, OD_UNSIGNED32, OD_RW, 0x55, false },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
    od_find(&device.od, 0x1010, 1)->watched = true;
    od_find(&device.od, 0x2000, 0)->watched = true;
    od_find(&device.od, 0x2002, 0)->watched = true;
    od_find(&device.od, 0x2002, 0)->frozen = 0xFF;
}

static void teardown(void)
{
    device_done(&device);
}

/* clang-format off */
#define BOOT { 0, SENDS, "705#00" }, { 0, TELLS, "state 0" }, { 0, TELLS, "state 127" }
#define WRITE(at) { at, HEARS, "605#2B00200034120000" }
#define ASKED(at, n) { at, TELLS, "verdict " #n " on 2000:00, 2 bytes" }
#define ANSWER(at) { at, SENDS, "585#6000200000000000" }, \
                   { at, TELLS, "written 2000:00 = 4660" }
#define IS(at, value) { at, HEARS, "605#4000200000000000" }, \
                      { at, SENDS, "585#4B002000" value "0000" }

static const struct device_talk talks[] = {
    { "accepted",
      { BOOT, WRITE(1), ASKED(1, 1), { 500, QUIET, "-" }, { 500, DOES, "verdict 1 0" },
        ANSWER(500), IS(501, "3412"), { 3000, QUIET, "-" } } },
    { "refused",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, DOES, "verdict 1 06090031" },
        { 2, SENDS, "585#8000200031000906" }, IS(3, "0000"), { 3, TELLS, "" } } },
    { "accepted at the last moment",
      { BOOT, WRITE(1), ASKED(1, 1), { 1000, DOES, "verdict 1 0" }, ANSWER(1000) } },
    { "none in time",
      { BOOT, WRITE(1), ASKED(1, 1), { 1000, QUIET, "-" }, { 1001, SENDS, "585#8000200020000008" },
        { 1001, TELLS, "no verdict on 2000:00" }, { 1002, DOES, "verdict 1 0" },
        IS(1003, "0000"), { 1003, TELLS, "" } } },
    { "the client gives up",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "605#8000200000000405" },
        { 3, DOES, "verdict 1 0" }, IS(4, "0000"), { 3000, QUIET, "-" }, { 3000, TELLS, "" } } },
    { "the client begins anew: the verdict on the first is none on the second",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "605#2B00200078560000" }, ASKED(2, 2),
        { 3, DOES, "verdict 1 0" }, { 3, QUIET, "-" }, { 4, DOES, "verdict 3 0" },
        { 5, DOES, "verdict 2 0" }, { 5, SENDS, "585#6000200000000000" },
        { 5, TELLS, "written 2000:00 = 22136" }, { 6, DOES, "verdict 2 0" }, IS(6, "7856") } },
    { "the client reads meanwhile",
      { BOOT, WRITE(1), ASKED(1, 1), IS(2, "0000"), { 3, DOES, "verdict 1 0" },
        { 3000, QUIET, "-" }, IS(3001, "0000") } },
    { "stopped meanwhile",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "000#0205" }, { 3, DOES, "verdict 1 0" },
        { 4, HEARS, "000#8005" }, IS(5, "0000"), { 3000, QUIET, "-" } } },
    { "reset meanwhile",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "000#8105" }, { 2, SENDS, "705#00" },
        { 3, DOES, "verdict 1 0" }, IS(5, "0000") } },
    { "started meanwhile",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "000#0105" }, { 2, TELLS, "state 5" },
        { 3, DOES, "verdict 1 0" }, ANSWER(3) } },
    { "in segments",
      { BOOT, { 1, HEARS, "605#2100200002000000" }, { 1, SENDS, "585#6000200000000000" },
        { 2, HEARS, "605#0B34120000000000" }, ASKED(2, 1),
        { 3, DOES, "verdict 1 0" }, { 3, SENDS, "585#2000000000000000" },
        { 3, TELLS, "written 2000:00 = 4660" } } },
    { "what the device itself refuses is not asked about",
      { BOOT, { 1, HEARS, "605#2300200034120000" }, { 1, SENDS, "585#8000200012000706" },
        { 2, HEARS, "605#2302200034120000" }, { 2, SENDS, "585#8002200030000906" },
        { 3, TELLS, "" }, { 3, HEARS, "605#2302200055120000" },
        { 3, TELLS, "verdict 2 on 2002:00, 4 bytes" }, { 4, DOES, "verdict 2 0" },
        { 4, SENDS, "585#6002200000000000" } } },
    { "one that is not watched",
      { BOOT, { 1, HEARS, "605#2F01200007000000" }, { 1, SENDS, "585#6001200000000000" },
        { 1, TELLS, "written 2001:00 = 7" } } },
    { "saving",
      { BOOT, { 1, HEARS, "605#2310100173617665" },
        { 1, TELLS, "verdict 1 on 1010:01, 4 bytes" },
        { 2, DOES, "verdict 1 06060000" }, { 2, SENDS, "585#8010100100000606" },
        { 3, HEARS, "605#2310100100000000" }, { 3, SENDS, "585#8010100120000008" },
        { 4, HEARS, "605#2310100173617665" }, { 4, TELLS, "verdict 3 on 1010:01, 4 bytes" },
        { 5, DOES, "verdict 3 0" }, { 5, SENDS, "585#6010100100000000" },
        { 6, HEARS, "605#4010100100000000" }, { 6, SENDS, "585#4310100101000000" } } },
    { "accepted: a TPDO that notifies follows",
      { BOOT, { 0, DOES, "flags t1 1" }, { 0, HEARS, "000#0105" }, { 0, SENDS, "185#0000" },
        { 0, TELLS, "state 5" }, WRITE(1), ASKED(1, 1), { 2, DOES, "verdict 1 0" },
        { 2, SENDS, "585#6000200000000000" }, { 2, SENDS, "185#3412" } } },
    { "garbage while it waits",
      { BOOT, WRITE(1), ASKED(1, 1), { 2, HEARS, "605#E0" }, { 2, HEARS, "605#R8" },
        { 3, HEARS, "605#6000000000000000" }, { 3, SENDS, "585#8000200001000405" },
        { 4, DOES, "verdict 1 0" }, IS(5, "0000") } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

/* With room in the outbox, and without in the moment of the verdict. */
START_TEST(conversation)
{
    device_start(&device);
    device.stalled = _i % 2 != 0;
    device_talk(&device, &talks[_i / 2]);
}
END_TEST

static void ask(uint32_t number)
{
    char text[64];

    device_hear(&device, "605#2B00200034120000");
    device_drain(&device);
    snprintf(text, sizeof text, "verdict %u on 2000:00, 2 bytes", number);
    ck_assert_str_eq(device_next_event(&device), text);
}

START_TEST(counted_when_late)
{
    device_start(&device);
    device_forget(&device);
    for (unsigned i = 1; i <= 3; i++) {
        ask(i);
        device_run(&device, device.now + CO_MS(1000));
        ck_assert_str_eq(device_next_event(&device), "no verdict on 2000:00");
        ck_assert_uint_eq(device.slave.late_verdicts, i);
    }
}
END_TEST

/* The value's limits are others now than when it was asked about. */
START_TEST(checked_again)
{
    struct od_entry *entry = od_find(&device.od, 0x2000, 0);

    device_start(&device);
    device_forget(&device);
    ask(1);
    entry->has_high = true;
    entry->high = 0x1000;
    device_do(&device, "verdict 1 0");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#8000200031000906");
    ck_assert_str_eq(device_next_event(&device), "");
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 99), 0);
}
END_TEST

/* It comes in time but finds no room until the time is over: the client has given up. */
START_TEST(no_room_for_too_long)
{
    device_start(&device);
    device_forget(&device);
    ask(1);
    device_fill(&device, 0, 0);
    device_do(&device, "verdict 1 0");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device.now += CO_MS(1000);
    device_drain(&device);
    device_run(&device, device.now);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#8000200020000008");
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 99), 0);
    ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
}
END_TEST

/* It waits for room when the client begins anew: it is none on the new value. */
START_TEST(no_room_and_a_new_transfer)
{
    device_start(&device);
    device_forget(&device);
    ask(1);
    device_fill(&device, 0, 2);
    device_do(&device, "verdict 1 0");
    device_drain(&device);
    device_hear(&device, "605#2B00200078560000"); /* the first is answered before */
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "585#6000200000000000");
    ck_assert_str_eq(device_next_event(&device), "written 2000:00 = 4660");
    ck_assert_str_eq(device_next_event(&device), "verdict 2 on 2000:00, 2 bytes");
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 99), 0x1234);
}
END_TEST

/* Nothing was asked, or the server is off. */
START_TEST(without_a_question)
{
    device_do(&device, "verdict 0 0");
    device_do(&device, "verdict 1 0");
    device_start(&device);
    device_forget(&device);
    device_do(&device, "verdict 0 0");
    device_do(&device, "verdict 1 06090031");
    device_run(&device, CO_MS(2000));
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_verdict");
    TCase *tcase = tcase_create("slave_verdict");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * 2);
    tcase_add_test(tcase, counted_when_late);
    tcase_add_test(tcase, checked_again);
    tcase_add_test(tcase, no_room_for_too_long);
    tcase_add_test(tcase, no_room_and_a_new_transfer);
    tcase_add_test(tcase, without_a_question);
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

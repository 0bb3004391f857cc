/* Guarding of a local device: its answers, and what it does when the master falls silent. */
#include "slave/slave.h"

#include "support/device.h"
#include "support/suite.h"

#include <check.h>

static const struct device_entry entries[] = {
    { 0x100C, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x100D, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1017, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1029, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1029, 1, OD_UNSIGNED8, OD_RW, 0, false },
    { 0 },
};

static struct device device;

static void setup(void)
{
    device_init(&device, entries);
    device_start(&device);
    device_forget(&device);
}

static void teardown(void)
{
    device_done(&device);
}

#define ERROR    "085#3081110100000000"
#define NO_ERROR "085#0000000000000000"

/* Guard time 100 ms, life time factor 2. */
#define GUARD                                                                                      \
    { 0, HEARS, "605#2B0C100064000000" }, { 0, SENDS, "585#600C100000000000" },                    \
        { 0, HEARS, "605#2F0D100002000000" },                                                      \
    {                                                                                              \
        0, SENDS, "585#600D100000000000"                                                           \
    }

/* clang-format off */
static const struct device_talk guard_talks[] = {
    { "answers alternate, whatever the length asked for, also when stopped",
      { { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" }, { 2, HEARS, "705#R0" },
        { 2, SENDS, "705#FF" }, { 3, HEARS, "000#0105" }, { 3, HEARS, "705#R1" },
        { 3, SENDS, "705#05" }, { 4, HEARS, "000#0205" }, { 4, HEARS, "705#R1" },
        { 4, SENDS, "705#84" }, { 5000, QUIET, "-" } } },
    { "requests to others",
      { { 1, HEARS, "704#R1" }, { 1, HEARS, "706#R1" }, { 1, HEARS, "00000705#R1" },
        { 1, QUIET, "-" } } },
    { "the first answer after a reset",
      { { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" }, { 2, HEARS, "000#8205" },
        { 2, SENDS, "705#00" }, { 3, HEARS, "705#R1" }, { 3, SENDS, "705#7F" } } },
    { "life guarding, from the first request on",
      { GUARD, { 0, HEARS, "000#0105" }, { 10000, QUIET, "-" },
        { 10000, HEARS, "705#R1" }, { 10000, SENDS, "705#05" },
        { 10199, HEARS, "705#R1" }, { 10199, SENDS, "705#85" },
        { 10398, QUIET, "-" }, { 10399, SENDS, ERROR }, { 20000, QUIET, "-" },
        { 20000, TELLS, "written 100C:00 = 100" }, { 20000, TELLS, "written 100D:00 = 2" },
        { 20000, TELLS, "state 5" }, { 20000, TELLS, "guarding begins" },
        { 20000, TELLS, "guarding lost" }, { 20000, TELLS, "emcy 8130 11" },
        { 20000, TELLS, "state 127" },
        { 20001, HEARS, "705#R1" }, { 20001, SENDS, "705#7F" }, { 20001, SENDS, NO_ERROR },
        { 20001, TELLS, "emcy 0000 00" }, { 20001, TELLS, "guarding begins" },
        { 20200, QUIET, "-" }, { 20201, SENDS, ERROR } } },
    { "no life time, no life guarding",
      { { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" }, { 60000, QUIET, "-" } } },
    { "without a life time any more it ends at once",
      { GUARD, { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" },
        { 2, HEARS, "605#2B0C100000000000" }, { 2, SENDS, "585#600C100000000000" },
        { 9000, QUIET, "-" },
        { 9000, HEARS, "605#2B0C100064000000" }, { 9000, SENDS, "585#600C100000000000" },
        { 9200, QUIET, "-" }, { 9201, HEARS, "705#R1" }, { 9201, SENDS, "705#FF" },
        { 9401, SENDS, ERROR },
        { 9500, HEARS, "605#2F0D100000000000" }, { 9500, SENDS, "585#600D100000000000" },
        { 9500, SENDS, NO_ERROR }, { 9999, QUIET, "-" } } },
    { "another life time counts from the next request on",
      { GUARD, { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" },
        { 2, HEARS, "605#2F0D100005000000" }, { 2, SENDS, "585#600D100000000000" },
        { 200, HEARS, "705#R1" }, { 200, SENDS, "705#FF" },
        { 699, QUIET, "-" }, { 700, SENDS, ERROR } } },
    { "a heartbeat takes its place, and gives it back",
      { GUARD, { 1, HEARS, "705#R1" }, { 1, SENDS, "705#7F" },
        { 2, HEARS, "605#2B171000E8030000" }, { 2, SENDS, "585#6017100000000000" },
        { 2, SENDS, "705#7F" }, { 3, HEARS, "705#R1" }, { 1001, QUIET, "-" },
        { 1002, SENDS, "705#7F" },
        { 1003, HEARS, "605#2B17100000000000" }, { 1003, SENDS, "585#6017100000000000" },
        { 1004, HEARS, "705#R1" }, { 1004, SENDS, "705#FF" }, { 1204, SENDS, ERROR },
        { 1300, HEARS, "605#2B171000E8030000" }, { 1300, SENDS, "585#6017100000000000" },
        { 1300, SENDS, NO_ERROR }, { 1300, SENDS, "705#7F" } } },
};
/* clang-format on */

START_TEST(guarding)
{
    device_talk(&device, &guard_talks[_i]);
}
END_TEST

START_TEST(full_outbox_guarding)
{
    ck_assert_uint_eq(device_write(&device, 0x100C, 0, 2, 100), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x100D, 0, 1, 1), SDO_OK);
    device_forget(&device);
    device_fill(&device, 1, 8);
    device_hear(&device, "705#R1");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    device_hear(&device, "705#R1");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "705#7F");
    device_fill(&device, 0, 8);
    slave_on_time(&device.slave, CO_MS(100), &device.out);
    ck_assert_uint_le(slave_deadline(&device.slave), CO_MS(100));
    device_drain(&device);
    device_run(&device, CO_MS(100));
    ck_assert_str_eq(device_next_frame(&device, NULL), ERROR);
}
END_TEST

/* A request counts at once; its answer comes when there is room. */
START_TEST(full_outbox_answer)
{
    ck_assert_uint_eq(device_write(&device, 0x100C, 0, 2, 100), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x100D, 0, 1, 1), SDO_OK);
    device_hear(&device, "705#R1");
    device_drain(&device);
    device_forget(&device);
    device_run(&device, CO_MS(60));
    device_fill(&device, 0, 0);
    device_hear(&device, "705#R1");
    device_drain(&device);
    device_run(&device, CO_MS(159));
    ck_assert_str_eq(device_next_frame(&device, NULL), "705#FF");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    device_run(&device, CO_MS(160));
    ck_assert_str_eq(device_next_frame(&device, NULL), ERROR);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_guarding");

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, guarding, 0, (int)(sizeof guard_talks / sizeof guard_talks[0]));
    tcase_add_test(tcase, full_outbox_guarding);
    tcase_add_test(tcase, full_outbox_answer);
    return suite_run("slave_guarding", tcase);
}

/* What the state of the bus means to a local device: emergencies, bits, and 1029h. */
#include "slave/slave.h"

#include "support/device.h"
#include "support/suite.h"

#include <check.h>

static const struct device_entry entries[] = {
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },
    { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1003, 2, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1015, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1016, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0x00070064, false },
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

#define PASSIVE   "085#2081110201000000"
#define RECOVERED "085#4081110401000000"
#define NO_ERROR  "085#0000000001000000"

/* clang-format off */
static const struct device_talk talks[] = {
    { "error passive, and back",
      { { 1, DOES, "bus passive" }, { 1, SENDS, PASSIVE }, { 1, TELLS, "emcy 8120 11" },
        { 2, DOES, "bus passive" }, { 2, QUIET, "-" },
        { 3, HEARS, "605#4001100000000000" }, { 3, SENDS, "585#4F01100011000000" },
        { 4, DOES, "bus ok" }, { 4, SENDS, NO_ERROR }, { 4, TELLS, "emcy 0000 00" },
        { 5, HEARS, "605#4003100000000000" }, { 5, SENDS, "585#4F03100001000000" } } },
    { "bus-off: nothing can be told before it is over",
      { { 0, HEARS, "000#0105" }, { 0, TELLS, "state 5" },
        { 1, DOES, "bus passive" }, { 1, SENDS, PASSIVE }, { 1, TELLS, "emcy 8120 11" },
        { 2, DOES, "bus lost" }, { 2, TELLS, "state 127" }, { 2, TELLS, "" },
        { 100, QUIET, "-" },
        { 100, DOES, "bus ok" }, { 100, SENDS, RECOVERED }, { 100, SENDS, NO_ERROR },
        { 100, TELLS, "emcy 8140 11" }, { 100, TELLS, "emcy 0000 00" }, { 100, TELLS, "" },
        { 101, HEARS, "605#4003100100000000" }, { 101, SENDS, "585#4303100140810401" } } },
    { "what happens meanwhile is told before",
      { { 1, HEARS, "707#05" }, { 2, DOES, "bus lost" }, { 50, DOES, "raise 1000 0 00 0000" },
        { 500, QUIET, "-" },
        { 500, DOES, "bus ok" }, { 500, SENDS, "085#0010110000030405" },
        { 500, SENDS, "085#3081110501000000" }, { 500, SENDS, "085#4081110501000000" },
        { 500, SENDS, "085#0000110101000000" },
        { 501, HEARS, "707#05" }, { 501, SENDS, "085#0000010001000000" } } },
    { "back as error passive",
      { { 1, DOES, "bus lost" }, { 2, DOES, "bus passive" }, { 2, SENDS, RECOVERED },
        { 2, SENDS, NO_ERROR }, { 2, SENDS, PASSIVE }, { 3, DOES, "bus ok" },
        { 3, SENDS, NO_ERROR } } },
    { "frames lost: once, until a second has passed without",
      { { 1, DOES, "overrun" }, { 1, SENDS, "085#1081110002000000" },
        { 1, TELLS, "emcy 8110 11" }, { 900, DOES, "overrun" },
        { 1899, QUIET, "-" }, { 1900, SENDS, "085#0000000002000000" },
        { 9000, QUIET, "-" },
        { 9000, DOES, "overrun" }, { 9000, SENDS, "085#1081110002000000" } } },
    { "in stopped both wait",
      { { 0, HEARS, "000#0205" }, { 1, DOES, "bus lost" }, { 2, DOES, "bus ok" },
        { 100, QUIET, "-" }, { 100, HEARS, "000#8005" }, { 100, SENDS, RECOVERED },
        { 100, SENDS, NO_ERROR } } },
    { "a reset forgets it, and what there is comes anew",
      { { 1, DOES, "bus passive" }, { 1, SENDS, PASSIVE },
        { 2, HEARS, "000#8205" }, { 2, SENDS, "705#00" }, { 2, SENDS, PASSIVE },
        { 3, DOES, "bus ok" }, { 3, SENDS, NO_ERROR },
        { 4, DOES, "overrun" }, { 4, SENDS, "085#1081110003000000" },
        { 5, HEARS, "000#8205" }, { 5, SENDS, "705#00" }, { 5000, QUIET, "-" } } },
    { "PDOs that were lost add their bit",
      { { 1, DOES, "bus passive" }, { 1, SENDS, PASSIVE },
        { 2, DOES, "lose 2" }, { 2, SENDS, "085#0081110203010200" },
        { 3, DOES, "bus ok" }, { 3, SENDS, "085#0000110003000000" },
        { 4, DOES, "taken" }, { 4, SENDS, "085#0000000003000000" } } },
};
/* clang-format on */

START_TEST(conversation)
{
    device_talk(&device, &talks[_i]);
}
END_TEST

START_TEST(error_behaviour)
{
    static const struct {
        uint8_t behaviour, command, after;
    } cases[] = {
        { 0, NMT_START, NMT_PREOPERATIONAL },
        { 1, NMT_START, NMT_OPERATIONAL },
        { 2, NMT_START, NMT_STOPPED },
        { 0, NMT_STOP, NMT_STOPPED },
        { 2, NMT_ENTER_PREOPERATIONAL, NMT_STOPPED },
    };

    ck_assert_uint_eq(device_write(&device, 0x1029, 1, 1, cases[_i].behaviour), SDO_OK);
    slave_command(&device.slave, (enum nmt_command)cases[_i].command, 0, &device.out);
    device_do(&device, "bus passive");
    ck_assert_uint_eq(device.slave.state, cases[_i].command == NMT_START  ? NMT_OPERATIONAL
                                          : cases[_i].command == NMT_STOP ? NMT_STOPPED
                                                                          : NMT_PREOPERATIONAL);
    device_do(&device, "bus lost");
    ck_assert_uint_eq(device.slave.state, cases[_i].after);
}
END_TEST

/* Over before there was room for a word of it: it was an error all the same, once. */
START_TEST(full_outbox_short_outage)
{
    device_hear(&device, "000#0105");
    device_drain(&device);
    device_forget(&device);
    device_fill(&device, _i == 0 ? 0 : 8, _i == 1 ? 1 : 8);
    device_do(&device, "bus lost");
    device_do(&device, "bus ok");
    device_do(&device, "bus lost");
    device_do(&device, "bus ok");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_run(&device, 1);
    ck_assert_uint_eq(device.slave.state, NMT_PREOPERATIONAL);
    for (unsigned i = 0; i < (_i == 0 ? 2 : 1); i++) {
        ck_assert_str_eq(device_next_frame(&device, NULL), RECOVERED);
        ck_assert_str_eq(device_next_frame(&device, NULL), NO_ERROR);
    }
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

START_TEST(full_outbox_overrun)
{
    device_fill(&device, 8, 0);
    device_do(&device, "overrun");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_run(&device, CO_MS(999));
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#1081110002000000");
    device_fill(&device, 8, 0);
    device.now = CO_MS(1000);
    slave_on_time(&device.slave, device.now, &device.out);
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    device_run(&device, CO_MS(1001));
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0000000002000000");
}
END_TEST

/* What was before the device was there is none of its errors; what still is becomes one. */
START_TEST(before_it_is_switched_on)
{
    static const struct device_entry other[] = { { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
                                                 { 0 } };
    struct device late;

    device_init(&late, other);
    device_do(&late, "overrun");
    device_do(&late, "bus lost");
    device_do(&late, _i == 0 ? "bus ok" : "bus passive");
    ck_assert_uint_eq(slave_deadline(&late.slave), CO_NEVER);
    device_start(&late);
    device_run(&late, CO_MS(5000));
    ck_assert_str_eq(device_next_frame(&late, NULL), "705#00");
    ck_assert_str_eq(device_next_frame(&late, NULL), _i == 0 ? "" : PASSIVE);
    device_done(&late);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("slave_bus");

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, conversation, 0, (int)(sizeof talks / sizeof talks[0]));
    tcase_add_loop_test(tcase, error_behaviour, 0, 5);
    tcase_add_loop_test(tcase, full_outbox_short_outage, 0, 2);
    tcase_add_test(tcase, full_outbox_overrun);
    tcase_add_loop_test(tcase, before_it_is_switched_on, 0, 2);
    return suite_run("slave_bus", tcase);
}

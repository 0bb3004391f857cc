/* Error control of a local device: emergencies, error history, heartbeat consumers. */
#include "slave/slave.h"

#include "base/bytes.h"
#include "support/device.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static const struct device_entry entries[] = {
    { 0x1003, 0, OD_UNSIGNED8, OD_RW, 0, false },  { 0x1003, 1, OD_UNSIGNED32, OD_RO, 0, false },
    { 0x1003, 2, OD_UNSIGNED32, OD_RO, 0, false }, { 0x100C, 0, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x100D, 0, OD_UNSIGNED8, OD_RW, 0, false },  { 0x1014, 0, OD_UNSIGNED32, OD_RW, 0x85, false },
    { 0x1015, 0, OD_UNSIGNED16, OD_RW, 0, false }, { 0x1016, 0, OD_UNSIGNED8, OD_CONST, 2, false },
    { 0x1016, 1, OD_UNSIGNED32, OD_RW, 0, false }, { 0x1016, 2, OD_UNSIGNED32, OD_RW, 0, false },
    { 0x1017, 0, OD_UNSIGNED16, OD_RW, 0, false }, { 0x1029, 0, OD_UNSIGNED8, OD_CONST, 1, false },
    { 0x1029, 1, OD_UNSIGNED8, OD_RW, 0, false },  { 0 },
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

/* Node 7 is watched, 100 ms. */
#define WATCH_7                                                                                    \
    { 0, HEARS, "605#2316100164000700" },                                                          \
    {                                                                                              \
        0, SENDS, "585#6016100100000000"                                                           \
    }
#define WATCH_8                                                                                    \
    { 0, HEARS, "605#2316100264000800" },                                                          \
    {                                                                                              \
        0, SENDS, "585#6016100200000000"                                                           \
    }
#define ERROR      "085#3081110100000000"
#define ERROR_LESS "085#0000110000000000"
#define NO_ERROR   "085#0000000000000000"

/* clang-format off */
static const struct device_talk talks[] = {
    { "watched in time, and from the first heartbeat on",
      { WATCH_7, { 0, TELLS, "written 1016:01 = 458852" },
        { 10000, QUIET, "-" }, { 10000, HEARS, "707#7F" }, { 10099, HEARS, "707#05" },
        { 10198, HEARS, "707#05" }, { 10297, HEARS, "706#05" }, { 10297, QUIET, "-" },
        { 10297, TELLS, "watch 7 begins" }, { 10297, TELLS, "heard 7: 127" },
        { 10297, TELLS, "heard 7: 5" },
        { 10297, TELLS, "" } } },
    { "lost, once, and back",
      { WATCH_7, { 0, TELLS, "written 1016:01 = 458852" },
        { 10, HEARS, "707#05" }, { 109, QUIET, "-" }, { 110, SENDS, ERROR },
        { 110, TELLS, "watch 7 begins" }, { 110, TELLS, "heard 7: 5" },
        { 110, TELLS, "lost 7: 5" }, { 110, TELLS, "emcy 8130 11" },
        { 5000, QUIET, "-" },
        { 5000, HEARS, "605#4001100000000000" }, { 5000, SENDS, "585#4F01100011000000" },
        { 5010, HEARS, "707#05" }, { 5010, SENDS, NO_ERROR },
        { 5010, TELLS, "watch 7 begins" }, { 5010, TELLS, "heard 7: 5" },
        { 5010, TELLS, "emcy 0000 00" }, { 5010, TELLS, "" },
        { 5020, HEARS, "605#4001100000000000" }, { 5020, SENDS, "585#4F01100000000000" },
        { 5110, SENDS, ERROR } } },
    { "a boot-up ends the watch until the next heartbeat",
      { WATCH_7, { 10, HEARS, "707#05" }, { 50, HEARS, "707#00" }, { 5000, QUIET, "-" },
        { 5000, TELLS, "written 1016:01 = 458852" }, { 5000, TELLS, "watch 7 begins" },
        { 5000, TELLS, "heard 7: 5" }, { 5000, TELLS, "watch 7 boots" },
        { 5000, TELLS, "heard 7: 0" }, { 5000, TELLS, "" },
        { 5001, HEARS, "707#7F" }, { 5100, QUIET, "-" }, { 5101, SENDS, ERROR } } },
    { "a boot-up alone is not yet the end of an error",
      { WATCH_7, { 10, HEARS, "707#05" }, { 110, SENDS, ERROR },
        { 200, HEARS, "707#00" }, { 300, QUIET, "-" }, { 300, HEARS, "707#7F" },
        { 300, SENDS, NO_ERROR } } },
    { "two nodes lost, one after the other back",
      { WATCH_7, WATCH_8, { 10, HEARS, "707#05" }, { 20, HEARS, "708#05" },
        { 110, SENDS, ERROR }, { 120, SENDS, ERROR },
        { 200, HEARS, "708#05" }, { 200, SENDS, "085#0000110100000000" },
        { 250, HEARS, "707#05" }, { 250, SENDS, NO_ERROR }, { 290, HEARS, "707#05" },
        { 299, QUIET, "-" } } },
    { "two nodes lost at the same time",
      { WATCH_7, WATCH_8, { 10, HEARS, "707#05" }, { 10, HEARS, "708#05" },
        { 110, SENDS, ERROR }, { 110, SENDS, ERROR }, { 111, QUIET, "-" } } },
    { "a lost node that is no longer to be watched",
      { WATCH_7, { 10, HEARS, "707#05" }, { 110, SENDS, ERROR },
        { 200, HEARS, "605#2316100100000000" }, { 200, SENDS, "585#6016100100000000" },
        { 200, SENDS, NO_ERROR }, { 201, HEARS, "707#05" }, { 5000, QUIET, "-" } } },
    { "entries that watch nobody",
      { { 0, HEARS, "605#2316100164000000" }, { 0, SENDS, "585#6016100100000000" },
        { 0, HEARS, "605#2316100264008000" }, { 0, SENDS, "585#6016100200000000" },
        { 1, HEARS, "700#05" }, { 1, HEARS, "707#05" }, { 5000, QUIET, "-" } } },
    { "operational goes to pre-operational",
      { WATCH_7, { 0, HEARS, "000#0105" }, { 10, HEARS, "707#05" }, { 110, SENDS, ERROR },
        { 110, TELLS, "written 1016:01 = 458852" }, { 110, TELLS, "state 5" },
        { 110, TELLS, "watch 7 begins" }, { 110, TELLS, "heard 7: 5" },
        { 110, TELLS, "lost 7: 5" }, { 110, TELLS, "emcy 8130 11" },
        { 110, TELLS, "state 127" } } },
    { "in stopped the emergency waits",
      { WATCH_7, { 0, HEARS, "000#0205" }, { 10, HEARS, "707#05" }, { 1000, QUIET, "-" },
        { 1000, HEARS, "000#8005" }, { 1000, SENDS, ERROR } } },
    { "a reset forgets errors and watches",
      { WATCH_7, { 10, HEARS, "707#05" }, { 110, SENDS, ERROR },
        { 200, HEARS, "000#8205" }, { 200, SENDS, "705#00" },
        { 201, HEARS, "605#4001100000000000" }, { 201, SENDS, "585#4F01100000000000" },
        { 202, HEARS, "605#4003100000000000" }, { 202, SENDS, "585#4F03100000000000" },
        { 203, HEARS, "707#05" }, { 5000, QUIET, "-" } } },
    { "inhibit time",
      { { 0, HEARS, "605#2B151000E8030000" }, { 0, SENDS, "585#6015100000000000" }, WATCH_7,
        { 10, HEARS, "707#05" }, { 110, SENDS, ERROR }, { 120, HEARS, "707#05" },
        { 209, HEARS, "707#05" }, { 209, QUIET, "-" }, { 210, SENDS, NO_ERROR } } },
    { "no emergencies where 1014h is not valid",
      { { 0, HEARS, "605#2314100085000080" }, { 0, SENDS, "585#6014100000000000" }, WATCH_7,
        { 10, HEARS, "707#05" }, { 1000, QUIET, "-" },
        { 1000, HEARS, "605#4003100100000000" }, { 1000, SENDS, "585#4303100130810100" } } },
    { "another CAN-ID for emergencies",
      { { 0, HEARS, "605#2314100085000080" }, { 0, SENDS, "585#6014100000000000" },
        { 0, HEARS, "605#23141000C5000000" }, { 0, SENDS, "585#6014100000000000" }, WATCH_7,
        { 10, HEARS, "707#05" }, { 110, SENDS, "0C5#3081110100000000" } } },
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
        uint8_t behaviour, before, after;
    } cases[] = {
        { 0, NMT_OPERATIONAL, NMT_PREOPERATIONAL },
        { 0, NMT_PREOPERATIONAL, NMT_PREOPERATIONAL },
        { 0, NMT_STOPPED, NMT_STOPPED },
        { 1, NMT_OPERATIONAL, NMT_OPERATIONAL },
        { 2, NMT_OPERATIONAL, NMT_STOPPED },
        { 2, NMT_PREOPERATIONAL, NMT_STOPPED },
        { 2, NMT_STOPPED, NMT_STOPPED },
        { 128, NMT_OPERATIONAL, NMT_OPERATIONAL },
    };

    ck_assert_uint_eq(device_write(&device, 0x1029, 1, 1, cases[_i].behaviour), SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1016, 1, 4, 0x00070064), SDO_OK);
    if (cases[_i].before == NMT_OPERATIONAL)
        device_hear(&device, "000#0105");
    if (cases[_i].before == NMT_STOPPED)
        device_hear(&device, "000#0205");
    device_hear(&device, "707#05");
    device_run(&device, CO_MS(99));
    ck_assert_uint_eq(device.slave.state, cases[_i].before);
    device_forget(&device);
    device_run(&device, CO_MS(100));
    ck_assert_uint_eq(device.slave.state, cases[_i].after);
    /* The emergency goes out before the state that forbids it. */
    ck_assert_str_eq(device_next_frame(&device, NULL),
                     cases[_i].before == NMT_STOPPED ? "" : ERROR);
}
END_TEST

static void raise_error(uint16_t code, uint8_t bits)
{
    const struct slave_error error = { .code = code,
                                       .info = 0xB2A1,
                                       .error_register = bits,
                                       .field = { 0x01, 0x02, 0xC3, 0xD4, 0xE5 } };

    ck_assert_int_eq(slave_raise_error(&device.slave, &error, device.now, &device.out), CO_OK);
    device_drain(&device);
}

static void clear_error(uint8_t bits)
{
    static const uint8_t field[5] = { 0x11, 0x02, 0x33, 0x44, 0x55 };

    ck_assert_int_eq(slave_clear_error(&device.slave, bits, field, device.now, &device.out), CO_OK);
    device_drain(&device);
}

START_TEST(own_errors)
{
    raise_error(0x4200, 0x08);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0042090102C3D4E5");
    ck_assert_str_eq(device_next_event(&device), "emcy 4200 09");
    raise_error(0x1000, 0);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0010090102C3D4E5");
    clear_error(0x08);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0000011102334455");
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 0x01);
    device_forget(&device);
    clear_error(0);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0000001102334455");
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 0);
    ck_assert_uint_eq(device_value(&device, 0x1003, 0), 2);
}
END_TEST

START_TEST(own_and_communication_errors)
{
    ck_assert_uint_eq(device_write(&device, 0x1016, 1, 4, 0x00070064), SDO_OK);
    raise_error(0x8110, 0x10);
    device_hear(&device, "707#05");
    device_run(&device, CO_MS(100));
    device_forget(&device);
    device_hear(&device, "707#05");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), ERROR_LESS);
    clear_error(0x10);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0000001102334455");
}
END_TEST

START_TEST(history)
{
    uint32_t value = 77;

    ck_assert_uint_eq(device_read(&device, 0x1003, 1, &value), SDO_NO_DATA);
    raise_error(0x1001, 1);
    ck_assert_uint_eq(device_value(&device, 0x1003, 1), 0xB2A11001);
    ck_assert_uint_eq(device_read(&device, 0x1003, 2, &value), SDO_NO_DATA);
    raise_error(0x1002, 1);
    raise_error(0x1003, 1);
    ck_assert_uint_eq(device_value(&device, 0x1003, 0), 2);
    ck_assert_uint_eq(device_value(&device, 0x1003, 1), 0xB2A11003);
    ck_assert_uint_eq(device_value(&device, 0x1003, 2), 0xB2A11002);
    ck_assert_uint_eq(device_read(&device, 0x1003, 3, &value), SDO_NO_SUB);
    ck_assert_uint_eq(device_write(&device, 0x1003, 0, 1, 1), SDO_INVALID_VALUE);
    ck_assert_uint_eq(device_value(&device, 0x1003, 0), 2);
    clear_error(1);
    ck_assert_uint_eq(device_value(&device, 0x1003, 0), 2);
    ck_assert_uint_eq(device_value(&device, 0x1003, 1), 0xB2A11003);
    ck_assert_uint_eq(device_write(&device, 0x1003, 0, 1, 0), SDO_OK);
    ck_assert_uint_eq(device_value(&device, 0x1003, 0), 0);
    ck_assert_uint_eq(device_read(&device, 0x1003, 1, &value), SDO_NO_DATA);
    ck_assert_uint_eq(value, 77);
}
END_TEST

START_TEST(empty_history_ends_a_running_transfer)
{
    static const struct device_talk talk = { "history during a transfer",
                                             { { 0, HEARS, "605#2117100002000000" },
                                               { 0, SENDS, "585#6017100000000000" },
                                               { 1, HEARS, "605#4003100200000000" },
                                               { 1, SENDS, "585#8003100224000008" },
                                               { 2, HEARS, "605#0B11220000000000" },
                                               { 2, SENDS, "585#8017100001000405" },
                                               { 3, HEARS, "000#0205" },
                                               { 3, HEARS, "605#4003100100000000" },
                                               { 4, QUIET, "-" } } };

    device_talk(&device, &talk);
}
END_TEST

START_TEST(devices_without_these_objects)
{
    static const struct device_entry none[] = { { 0 } };
    struct device bare;

    device_init(&bare, none);
    device_start(&bare);
    device_forget(&bare);
    device_hear(&bare, "705#R1");
    device_hear(&bare, "707#05");
    device_run(&bare, CO_MS(10000));
    ck_assert_str_eq(device_next_frame(&bare, NULL), "705#7F");
    ck_assert_int_eq(slave_raise_error(&bare.slave, &(struct slave_error){ .code = 0x1000 },
                                       bare.now, &bare.out),
                     CO_OK);
    device_drain(&bare);
    ck_assert_str_eq(device_next_frame(&bare, NULL), "");
    ck_assert_uint_eq(device_value(&bare, 0x1001, 0), 1);
    device_done(&bare);
}
END_TEST

/* ---- full outbox ---- */

START_TEST(full_outbox_boot_up)
{
    static const char *const expected[] = { "state 0", "state 127", "" };

    ck_assert_uint_eq(device_write(&device, 0x1017, 0, 2, 100), SDO_OK);
    device_forget(&device);
    device_fill(&device, _i == 0 ? 0 : 8, _i == 1 ? 1 : 8);
    device_hear(&device, "000#8105");
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_hear(&device, "000#0105");
    device_hear(&device, "605#4000100000000000");
    slave_on_time(&device.slave, CO_MS(1000), &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_INITIALISING);
    device_drain(&device);
    ck_assert_str_eq(device_next_event(&device), "");
    device_run(&device, 0);
    for (size_t i = 0; i < 3; i++)
        ck_assert_str_eq(device_next_event(&device), expected[i]);
    ck_assert_str_eq(device_next_frame(&device, NULL), "705#00");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    ck_assert_uint_eq(slave_deadline(&device.slave), CO_NEVER);
}
END_TEST

START_TEST(full_outbox_power_on)
{
    struct slave slave;
    struct od od;

    od_init(&od);
    ck_assert_int_eq(slave_init(&slave, 9, &od), CO_OK);
    device_fill(&device, 0, 8);
    slave_start(&slave, 0, &device.out);
    ck_assert_uint_eq(slave_deadline(&slave), 0);
    device_drain(&device);
    slave_on_time(&slave, 0, &device.out);
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "709#00");
    ck_assert_uint_eq(slave_deadline(&slave), CO_NEVER);
    slave_done(&slave);
    od_done(&od);
}
END_TEST

START_TEST(full_outbox_reset_in_a_reset)
{
    device_fill(&device, 0, 0);
    device_hear(&device, "000#8205");
    device_hear(&device, "000#8105");
    device_drain(&device);
    device_run(&device, 0);
    ck_assert_str_eq(device_next_frame(&device, NULL), "705#00");
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

START_TEST(full_outbox_state)
{
    device_fill(&device, 0, 0);
    device_hear(&device, "000#0105");
    device_hear(&device, "000#0205");
    ck_assert_uint_eq(device.slave.state, NMT_STOPPED);
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_run(&device, 0);
    ck_assert_str_eq(device_next_event(&device), "state 4");
    ck_assert_str_eq(device_next_event(&device), "");
}
END_TEST

START_TEST(full_outbox_request)
{
    device_fill(&device, _i == 0 ? 1 : 8, _i == 1 ? 1 : 8);
    device_hear(&device, "605#2B17100064000000");
    device_drain(&device);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
    ck_assert_uint_eq(device_value(&device, 0x1017, 0), 0);
    ck_assert_uint_eq(device.slave.channels[0].server.dropped, 1);
    ck_assert_uint_eq(device_write(&device, 0x1017, 0, 2, 100), SDO_OK);
}
END_TEST

START_TEST(full_outbox_consumer)
{
    static const char *const expected[] = { "lost 7: 5", "emcy 8130 11", "state 127", "" };

    ck_assert_uint_eq(device_write(&device, 0x1016, 1, 4, 0x00070064), SDO_OK);
    device_hear(&device, "000#0105");
    device_hear(&device, "707#05");
    device_drain(&device);
    device_forget(&device);
    device_fill(&device, _i == 0 ? 0 : 8, _i == 1 ? 2 : 8);
    slave_on_time(&device.slave, CO_MS(100), &device.out);
    ck_assert_uint_eq(device.slave.state, NMT_OPERATIONAL);
    ck_assert_uint_eq(slave_deadline(&device.slave), 0);
    device_drain(&device);
    device_run(&device, CO_MS(100));
    for (size_t i = 0; i < 4; i++)
        ck_assert_str_eq(device_next_event(&device), expected[i]);
    ck_assert_str_eq(device_next_frame(&device, NULL), ERROR);
    device_fill(&device, 0, 0);
    device_hear(&device, "707#7F");
    device_drain(&device);
    device_run(&device, CO_MS(101));
    ck_assert_str_eq(device_next_event(&device), "watch 7 begins");
    ck_assert_str_eq(device_next_event(&device), "heard 7: 127");
    ck_assert_str_eq(device_next_event(&device), "emcy 0000 00");
    ck_assert_str_eq(device_next_frame(&device, NULL), NO_ERROR);
}
END_TEST

START_TEST(full_outbox_own_error)
{
    const struct slave_error error = { .code = 0x1000, .error_register = 1 };
    static const uint8_t none[5] = { 0 };

    device_fill(&device, 8, 0);
    ck_assert_int_eq(slave_raise_error(&device.slave, &error, 0, &device.out), CO_ERR_AGAIN);
    device_drain(&device);
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 0);
    device_fill(&device, 0, 8);
    ck_assert_int_eq(slave_raise_error(&device.slave, &error, 0, &device.out), CO_OK);
    device_drain(&device);
    device_fill(&device, 8, 0);
    ck_assert_int_eq(slave_clear_error(&device.slave, 1, none, 0, &device.out), CO_ERR_AGAIN);
    device_drain(&device);
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 1);
    device_forget(&device);
    device_run(&device, 0);
    ck_assert_str_eq(device_next_frame(&device, NULL), "085#0010010000000000");
}
END_TEST

/* ---- anything at all ---- */

static uint32_t random_state = 1;

static uint32_t random_number(void)
{
    random_state = random_state * 1664525u + 1013904223u;
    return random_state >> 8;
}

static struct co_frame random_frame(void)
{
    static const uint32_t ids[] = { 0x000, 0x605, 0x605, 0x605, 0x705, 0x707, 0x708, 0x7FF };
    static const uint8_t commands[] = { 0x23, 0x2B, 0x2F, 0x40, 0x21, 0x00, 0x60, 0x0D };
    static const uint8_t objects[] = { 0x01, 0x03, 0x14, 0x15, 0x16, 0x17, 0x29, 0x0C };
    struct co_frame frame = co_frame_make(ids[random_number() % 8], 8);

    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = (uint8_t)(random_number() % 3 == 0 ? random_number() : 0);
    if (frame.id == 0x605 && random_number() % 8 != 0) {
        frame.data[0] = commands[random_number() % 8];
        put_le16(frame.data + 1, (uint16_t)(0x1000 + objects[random_number() % 8]));
        frame.data[3] = (uint8_t)(random_number() % 3);
    }
    if (frame.id == 0)
        put_le16(frame.data, (uint16_t)((random_number() % 2 ? 0x80 : 0) + random_number() % 4));
    if (frame.id == 0 || random_number() % 8 == 0)
        frame.dlc = frame.id == 0 ? 2 : (uint8_t)(random_number() % 9);
    if (random_number() % 16 == 0)
        frame.flags = (uint8_t)(random_number() % 8);
    return frame;
}

START_TEST(garbage)
{
    unsigned operational = 0, preoperational = 0;

    random_state = (uint32_t)_i + 1;
    for (unsigned i = 0; i < 20000; i++) {
        const struct co_frame frame = random_frame();

        if (random_number() % 4 == 0)
            device_fill(&device, random_number() % 4, random_number() % 4);
        slave_on_frame(&device.slave, &frame, device.now, &device.out);
        device_drain(&device);
        device_forget(&device);
        device_run(&device, device.now + random_number() % 50000);
        device_forget(&device);
        ck_assert_uint_eq(device.slave.state, device.slave.told_state);
        operational += device.slave.state == NMT_OPERATIONAL;
        preoperational += device.slave.state == NMT_PREOPERATIONAL;
    }
    ck_assert_uint_gt(operational, 0);
    ck_assert_uint_gt(preoperational, 0);
    device_hear(&device, "000#8105");
    device_drain(&device);
    device_forget(&device);
    ck_assert_uint_eq(device_value(&device, 0x1014, 0), 0x85);
    ck_assert_uint_eq(device_value(&device, 0x1001, 0), 0);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_errors");
    TCase *tcase = tcase_create("slave_errors");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, (int)(sizeof talks / sizeof talks[0]));
    tcase_add_loop_test(tcase, error_behaviour, 0, 8);
    tcase_add_test(tcase, own_errors);
    tcase_add_test(tcase, own_and_communication_errors);
    tcase_add_test(tcase, history);
    tcase_add_test(tcase, empty_history_ends_a_running_transfer);
    tcase_add_test(tcase, devices_without_these_objects);
    tcase_add_loop_test(tcase, full_outbox_boot_up, 0, 2);
    tcase_add_test(tcase, full_outbox_power_on);
    tcase_add_test(tcase, full_outbox_reset_in_a_reset);
    tcase_add_test(tcase, full_outbox_state);
    tcase_add_loop_test(tcase, full_outbox_request, 0, 2);
    tcase_add_loop_test(tcase, full_outbox_consumer, 0, 2);
    tcase_add_test(tcase, full_outbox_own_error);
    tcase_add_loop_test(tcase, garbage, 0, 4);
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

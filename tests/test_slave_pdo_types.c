/* Every transmission type, each direction: what a device does on the bus that is told to use it. */
#include "slave/slave.h"

#include "support/device.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OFF 0x80000000u

static const struct device_entry entries[] = {
    { 0x1005, 0, OD_UNSIGNED32, OD_RW, 0x80, false },
    { 0x1400, 0, OD_UNSIGNED8, OD_CONST, 5, false },
    { 0x1400, 1, OD_UNSIGNED32, OD_RW, OFF | 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1600, 0, OD_UNSIGNED8, OD_RW, 2, false },
    { 0x1600, 1, OD_UNSIGNED32, OD_RW, 0x20000010, false },
    { 0x1600, 2, OD_UNSIGNED32, OD_RW, 0x20010010, false },
    { 0x1800, 0, OD_UNSIGNED8, OD_CONST, 6, false },
    { 0x1800, 1, OD_UNSIGNED32, OD_RW, OFF | 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, OD_RW, 255, false },
    { 0x1800, 3, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1800, 5, OD_UNSIGNED16, OD_RW, 0, false },
    { 0x1A00, 0, OD_UNSIGNED8, OD_RW, 1, false },
    { 0x1A00, 1, OD_UNSIGNED32, OD_RW, 0x21000010, false },
    { 0x2000, 0, OD_UNSIGNED16, OD_RWW, 0, true },
    { 0x2001, 0, OD_UNSIGNED16, OD_RWW, 0, true },
    { 0x2100, 0, OD_UNSIGNED16, OD_RWR, 0x1111, true },
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

static bool is_reserved(int type, bool transmit)
{
    return type > 240 && type < (transmit ? 252 : 254);
}

/* Sets the type, switches the PDO on, and starts the device; false where the type is refused. */
static bool use_type(uint16_t index, int type, uint32_t cob_id, bool transmit)
{
    const sdo_abort_t code = device_write(&device, index, 2, 1, (uint32_t)type);

    ck_assert_uint_eq(code, is_reserved(type, transmit) ? SDO_INVALID_VALUE : SDO_OK);
    ck_assert_uint_eq(device_value(&device, index, 2), code == SDO_OK ? (uint32_t)type : 255);
    ck_assert_uint_eq(device_write(&device, index, 1, 4, cob_id), SDO_OK);
    device_forget(&device);
    device_hear(&device, "000#0105");
    device_drain(&device);
    return code == SDO_OK;
}

static void hear_at(unsigned ms, const char *frame)
{
    device_run(&device, CO_MS(ms));
    device_hear(&device, frame);
    device_drain(&device);
}

static void expect_value(uint32_t value)
{
    ck_assert_uint_eq(od_number(&device.od, 0x2000, 0, 0), value & 0xFFFF);
    ck_assert_uint_eq(od_number(&device.od, 0x2001, 0, 0), value >> 16);
}

/* Types 0..240: with the SYNC behind it. 254, 255: at once. */
START_TEST(received)
{
    const bool waits = _i <= 240;

    if (!use_type(0x1400, _i, 0x205, false))
        return;
    hear_at(1, "205#11223344");
    expect_value(waits ? 0 : 0x44332211);
    hear_at(2, "080#");
    expect_value(0x44332211);
    hear_at(3, "205#55667788");
    hear_at(4, "205#01020304");
    expect_value(waits ? 0x44332211 : 0x04030201);
    hear_at(5, "080#");
    expect_value(0x04030201);
    hear_at(6, "205#55667788");
    hear_at(7, "000#8005"); /* what waits is dropped */
    hear_at(8, "080#");
    hear_at(9, "205#00000000");
    hear_at(10, "000#0105");
    hear_at(11, "080#");
    expect_value(waits ? 0x04030201 : 0x88776655);
    ck_assert_str_eq(device_next_frame(&device, NULL), "");
}
END_TEST

static void expect_sent(bool sent, const char *frame)
{
    ck_assert_str_eq(device_next_frame(&device, NULL), sent ? frame : "");
}

/* 241 SYNCs: the first one for the event that a start is, then each n-th. */
static void check_syncs(int type)
{
    for (unsigned i = 1; i <= 241; i++) {
        hear_at(i, "080#");
        expect_sent(type == 0 ? i == 1 : type <= 240 && i % (unsigned)type == 0, "185#1111");
    }
}

/* Requests: 253, 254, 255 and 0 answer with the value of now, the others with that of the SYNC. */
static void check_requests(int type)
{
    const bool sampled = type >= 1 && type <= 240;

    device_do(&device, "set 2100:00 2222");
    hear_at(300, "185#R2");
    expect_sent(true, sampled || type == 252 ? "185#1111" : "185#2222");
    if (type != 252)
        return;
    hear_at(301, "080#");
    expect_sent(false, NULL);
    device_do(&device, "set 2100:00 3333");
    hear_at(302, "185#R");
    expect_sent(true, "185#2222");
}

static void check_events(int type)
{
    const bool possible = type == 0 || type >= 254;
    char text[32];

    device_do(&device, "set 2100:00 4444");
    if (type == 0) {
        hear_at(400, "080#");
        expect_sent(true, "185#4444");
    }
    expect_sent(false, NULL);
    snprintf(text, sizeof text, "send 1 -> %d", possible ? CO_OK : CO_ERR_ARG);
    device_do(&device, text);
    device_drain(&device);
    expect_sent(type >= 254, "185#4444");
    hear_at(401, "080#");
    if (type == 0 || type == 1)
        expect_sent(true, "185#4444");
}

/* Only the event-driven ones look at the time. */
static void check_timer(int type)
{
    device_forget(&device);
    ck_assert_uint_eq(device_write(&device, 0x1800, 5, 2, 100), SDO_OK);
    device_forget(&device);
    device_run(&device, CO_MS(501));
    expect_sent(type >= 254, "185#4444");
    device_forget(&device);
}

START_TEST(transmitted)
{
    if (!use_type(0x1800, _i, 0x185, true))
        return;
    expect_sent(false, NULL);
    check_syncs(_i);
    check_requests(_i);
    check_events(_i);
    check_timer(_i);
    hear_at(600, "000#0205");
    for (unsigned i = 601; i < 1000; i++) {
        hear_at(i, i % 2 ? "080#" : "185#R2");
        expect_sent(false, NULL);
    }
    device_do(&device, _i == 0 || _i >= 254 ? "send 1 -> -13" : "send 1 -> -1");
    expect_sent(false, NULL);
}
END_TEST

/* No requests are allowed: types that live by them are refused, the others are silent. */
START_TEST(transmitted_without_requests)
{
    const bool by_request = _i == 252 || _i == 253;
    sdo_abort_t code;

    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, 0xC0000185), SDO_OK);
    code = device_write(&device, 0x1800, 2, 1, (uint32_t)_i);
    ck_assert_uint_eq(code, is_reserved(_i, true) || by_request ? SDO_INVALID_VALUE : SDO_OK);
    ck_assert_uint_eq(device_write(&device, 0x1800, 1, 4, 0x40000185), SDO_OK);
    device_forget(&device);
    hear_at(1, "000#0105");
    hear_at(2, "185#R2");
    expect_sent(false, NULL);
}
END_TEST

/* A device without SYNC: its description may have such a type, nobody can set one. */
START_TEST(without_sync)
{
    const bool synchronous = _i <= 240 || _i == 252;
    struct device other;
    sdo_abort_t code;

    device_init(&other, entries + 1);
    device_start(&other);
    code = device_write(&other, 0x1400, 2, 1, (uint32_t)_i);
    ck_assert_uint_eq(code, synchronous || is_reserved(_i, false) ? SDO_INVALID_VALUE : SDO_OK);
    code = device_write(&other, 0x1800, 2, 1, (uint32_t)_i);
    ck_assert_uint_eq(code, synchronous || is_reserved(_i, true) ? SDO_INVALID_VALUE : SDO_OK);
    other.slave.assume_sync = true;
    code = device_write(&other, 0x1800, 2, 1, (uint32_t)_i);
    ck_assert_uint_eq(code, is_reserved(_i, true) ? SDO_INVALID_VALUE : SDO_OK);
    device_done(&other);
}
END_TEST

/* Its file lacks 1005h, but it knows SYNC all the same. */
START_TEST(assumed_sync)
{
    device_done(&device);
    device_init(&device, entries + 1);
    device.slave.assume_sync = true;
    device_start(&device);
    ck_assert(use_type(0x1800, 1, 0x185, true));
    hear_at(1, "080#");
    expect_sent(true, "185#1111");
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_pdo_types");
    TCase *tcase = tcase_create("slave_pdo_types");

    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, received, 0, 256);
    tcase_add_loop_test(tcase, transmitted, 0, 256);
    tcase_add_loop_test(tcase, transmitted_without_requests, 0, 256);
    tcase_add_loop_test(tcase, without_sync, 0, 256);
    tcase_add_test(tcase, assumed_sync);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_set_fork_status(runner, CK_NOFORK); /* a thousand small tests */
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/* 1010h, 1011h, 1020h of a local device: what survives a reset, and what tells that it did. */
#include "slave/slave.h"

#include "support/saver.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    uint8_t save; /* sub-index, 0: none */
    uint8_t load;
    const char *command;
    uint32_t communication, manufacturer, application;
} cases[] = {
    { 0, 0, RESET_NODE, 0, 20, 60 },
    { 0, 0, RESET_COMMUNICATION, 0, 2222, 6666 },
    { 1, 0, RESET_NODE, 1111, 2222, 6666 },
    { 1, 0, RESET_COMMUNICATION, 1111, 2222, 6666 },
    { 2, 0, RESET_NODE, 1111, 20, 60 },
    { 3, 0, RESET_NODE, 0, 20, 6666 },
    { 4, 0, RESET_NODE, 0, 2222, 60 },
    { 1, 1, RESET_NODE, 0, 20, 60 },
    { 1, 1, RESET_COMMUNICATION, 1111, 2222, 6666 },
    { 1, 2, RESET_NODE, 0, 2222, 6666 },
    { 1, 2, RESET_COMMUNICATION, 0, 2222, 6666 },
    { 1, 3, RESET_NODE, 1111, 2222, 60 },
    { 1, 3, RESET_COMMUNICATION, 1111, 2222, 6666 },
    { 1, 4, RESET_NODE, 1111, 20, 6666 },
    { 0, 1, RESET_NODE, 0, 20, 60 },
};

START_TEST(save_and_load)
{
    saver_change_all();
    if (cases[_i].save != 0)
        saver_put(0x1010, cases[_i].save, 4, SAVE);
    if (cases[_i].load != 0)
        saver_put(0x1011, cases[_i].load, 4, LOAD);
    saver_expect("before", 1111, 2222, 6666);
    saver_reset(cases[_i].command);
    saver_expect("after", cases[_i].communication, cases[_i].manufacturer, cases[_i].application);
    ck_assert_uint_eq(device_value(&saver_device, 0x1010, 1), 1);
    ck_assert_uint_eq(device_value(&saver_device, 0x1011, 1), 1);
}
END_TEST

START_TEST(wrong_signatures_change_nothing)
{
    saver_change_all();
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 1, 4, LOAD), SDO_NOT_STORED);
    saver_reset(RESET_NODE);
    saver_expect("not saved", 0, 20, 60);
    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    ck_assert_uint_eq(device_write(&saver_device, 0x1011, 1, 4, SAVE), SDO_NOT_STORED);
    saver_reset(RESET_NODE);
    saver_expect("not loaded", 1111, 2222, 6666);
}
END_TEST

/* Of all groups, in both objects; what such a transfer leaves behind does not disturb the next. */
START_TEST(each_wrong_signature)
{
    static const uint32_t wrong[] = { 0,          1,          0x77726F6E, 0x6C6F6164,
                                      0x73617665, 0x45564153, 0xFFFFFFFF };

    saver_change_all();
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        for (uint8_t sub = 1; sub <= 4; sub++) {
            ck_assert_uint_eq(device_write(&saver_device, 0x1010, sub, 4, wrong[i]),
                              SDO_NOT_STORED);
            ck_assert_uint_eq(device_write(&saver_device, 0x1011, sub, 4, wrong[i]),
                              SDO_NOT_STORED);
        }
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 1, 2, 0x6173), SDO_TOO_SHORT);
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 5, 4, SAVE), SDO_NO_SUB);
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 0, 1, 1), SDO_READ_ONLY);
    saver_expect("nothing changed", 1111, 2222, 6666);
    saver_reset(RESET_NODE);
    saver_expect("nothing saved", 0, 20, 60);
}
END_TEST

/* A sub-index whose value says that it does not save on command; 0 is what many files leave out. */
START_TEST(groups_that_do_not_obey)
{
    od_set_number(&saver_device.od, 0x1010, 1, 2);
    od_set_number(&saver_device.od, 0x1011, 1, 2);
    od_set_number(&saver_device.od, 0x1010, 2, 3);
    od_set_number(&saver_device.od, 0x1010, 3, 0);
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 1, 4, SAVE), SDO_NOT_STORED);
    ck_assert_uint_eq(device_write(&saver_device, 0x1011, 1, 4, LOAD), SDO_NOT_STORED);
    saver_put(0x1010, 2, 4, SAVE);
    saver_put(0x1010, 3, 4, SAVE);
}
END_TEST

START_TEST(load_is_done_once)
{
    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x1011, 1, 4, LOAD);
    saver_reset(RESET_NODE);
    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    saver_reset(RESET_NODE);
    saver_expect("saved again", 1111, 2222, 6666);
}
END_TEST

START_TEST(the_later_command_counts)
{
    saver_change_all();
    saver_put(0x1011, 1, 4, LOAD);
    saver_put(0x1010, 1, 4, SAVE);
    saver_reset(RESET_NODE);
    saver_expect("load, save", 1111, 2222, 6666);
    saver_put(0x1011, 1, 4, LOAD);
    saver_put(0x1010, 3, 4, SAVE);
    saver_reset(RESET_NODE);
    saver_expect("load all, save a part", 0, 20, 6666);
}
END_TEST

START_TEST(values_of_other_length)
{
    static const struct device_talk talk = { "a string",
                                             { { 0, HEARS, "605#2301200041424344" },
                                               { 0, SENDS, "585#6001200000000000" },
                                               { 0, HEARS, "605#2310100173617665" },
                                               { 0, SENDS, "585#6010100100000000" },
                                               { 0, HEARS, "605#2B01200058590000" },
                                               { 0, SENDS, "585#6001200000000000" },
                                               { 0, HEARS, "000#8105" },
                                               { 0, SENDS, "705#00" },
                                               { 0, HEARS, "605#4001200000000000" },
                                               { 0, SENDS, "585#4301200041424344" },
                                               { 0, HEARS, "605#231110016C6F6164" },
                                               { 0, SENDS, "585#6011100100000000" },
                                               { 0, HEARS, "000#8105" },
                                               { 0, SENDS, "705#00" },
                                               { 0, HEARS, "605#4001200000000000" },
                                               { 0, SENDS, "585#4101200000000000" } } };

    device_forget(&saver_device);
    device_talk(&saver_device, &talk);
}
END_TEST

START_TEST(saved_heartbeat_runs_after_reset)
{
    saver_put(0x1017, 0, 2, 100);
    saver_put(0x1010, 1, 4, SAVE);
    device_run(&saver_device, CO_MS(50));
    saver_reset(RESET_NODE);
    device_run(&saver_device, CO_MS(149));
    ck_assert_str_eq(device_next_frame(&saver_device, NULL), "");
    device_run(&saver_device, CO_MS(150));
    ck_assert_str_eq(device_next_frame(&saver_device, NULL), "705#7F");
}
END_TEST

/* The error register and the history are states, no parameters. */
START_TEST(errors_are_not_saved)
{
    const struct slave_error error = { .code = 0x1000, .error_register = 1 };

    ck_assert_int_eq(slave_raise_error(&saver_device.slave, &error, 0, &saver_device.out), CO_OK);
    device_drain(&saver_device);
    saver_put(0x1010, 1, 4, SAVE);
    saver_reset(RESET_NODE);
    ck_assert_uint_eq(device_value(&saver_device, 0x1001, 0), 0);
    ck_assert_uint_eq(device_value(&saver_device, 0x1003, 0), 0);
}
END_TEST

static void verify(uint32_t date, uint32_t time)
{
    saver_put(0x1020, 1, 4, date);
    saver_put(0x1020, 2, 4, time);
}

static void expect_verified(uint32_t date, uint32_t time)
{
    ck_assert_uint_eq(device_value(&saver_device, 0x1020, 1), date);
    ck_assert_uint_eq(device_value(&saver_device, 0x1020, 2), time);
}

START_TEST(verification_in_the_order_of_a_configuration)
{
    saver_change_all();
    verify(1, 2);
    saver_put(0x1010, 1, 4, SAVE);
    expect_verified(1, 2);
    saver_reset(RESET_NODE);
    expect_verified(1, 2);
    saver_reset(RESET_COMMUNICATION);
    expect_verified(1, 2);
}
END_TEST

START_TEST(a_change_ends_verification)
{
    static const struct {
        uint16_t index;
        uint8_t sub, size;
        uint32_t value;
        uint32_t date, time;
    } changes[] = {
        { 0x1006, 0, 4, 5, 0, 0 }, { 0x2000, 0, 2, 21, 0, 0 },   { 0x2001, 0, 2, 0x4141, 0, 0 },
        { 0x1006, 0, 4, 0, 1, 2 }, { 0x1003, 0, 1, 0, 1, 2 },    { 0x1020, 1, 4, 3, 3, 2 },
        { 0x1020, 2, 4, 4, 1, 4 }, { 0x1010, 1, 4, SAVE, 1, 2 }, { 0x1011, 1, 4, LOAD, 1, 2 },
    };

    const struct slave_error error = { .code = 0x1000, .error_register = 1 };

    ck_assert_int_eq(slave_raise_error(&saver_device.slave, &error, 0, &saver_device.out), CO_OK);
    device_drain(&saver_device);
    verify(1, 2);
    saver_put(changes[_i].index, changes[_i].sub, changes[_i].size, changes[_i].value);
    expect_verified(changes[_i].date, changes[_i].time);
}
END_TEST

START_TEST(a_refused_write_does_not_end_verification)
{
    verify(1, 2);
    ck_assert_uint_eq(device_write(&saver_device, 0x1005, 0, 4, 0x7F), SDO_INVALID_VALUE);
    ck_assert_uint_eq(device_write(&saver_device, 0x2000, 0, 4, 0x7F), SDO_TOO_LONG);
    expect_verified(1, 2);
}
END_TEST

/* Reset communication brings 1020h back, but not the application's parameters that it is about. */
START_TEST(half_restored_is_not_verified)
{
    verify(1, 2);
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x1006, 0, 4, 7);
    expect_verified(0, 0);
    saver_reset(RESET_COMMUNICATION);
    expect_verified(1, 2);
    saver_put(0x2000, 0, 2, 7);
    saver_reset(RESET_COMMUNICATION);
    expect_verified(0, 0);
    saver_reset(RESET_NODE);
    expect_verified(1, 2);
}
END_TEST

/* A description may make 1020h a string: there is no 0 for that. */
START_TEST(a_text_is_no_verification)
{
    static const struct device_entry with_text[] = {
        { 0x1010, 4, OD_UNSIGNED32, OD_RW, 1, false },
        { 0x1020, 1, OD_VISIBLE_STRING, OD_RW, 0, false },
        { 0x2000, 0, OD_UNSIGNED16, OD_RW, 20, false },
        { 0x6000, 0, OD_UNSIGNED16, OD_RW, 60, false },
        { 0 },
    };
    uint8_t text[12] = "ABCDEFGHIJK";

    device_done(&saver_device);
    device_init(&saver_device, with_text);
    ck_assert_int_eq(
        od_refer(od_find(&saver_device.od, 0x1020, 1), text, sizeof text, sizeof text, true),
        CO_OK);
    device_start(&saver_device);
    saver_put(0x6000, 0, 2, 5);
    saver_put(0x1010, 4, 4, SAVE);
    saver_reset(RESET_NODE);
    ck_assert_str_eq((const char *)od_find(&saver_device.od, 0x1020, 1)->value, "ABCDEFGHIJK");
}
END_TEST

START_TEST(half_saved_is_not_verified)
{
    saver_change_all();
    verify(1, 2);
    saver_put(0x1010, 2, 4, SAVE);
    expect_verified(1, 2);
    saver_reset(RESET_NODE);
    saver_expect("half saved", 1111, 20, 60);
    expect_verified(0, 0);
    verify(1, 2);
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x6000, 0, 2, 5);
    saver_put(0x1010, 3, 4, SAVE);
    saver_reset(RESET_NODE);
    saver_expect("half saved later", 1111, 20, 5);
    expect_verified(0, 0);
}
END_TEST

START_TEST(loaded_is_not_verified)
{
    saver_change_all();
    verify(1, 2);
    saver_put(0x1010, 1, 4, SAVE);
    saver_put(0x1011, 3, 4, LOAD);
    saver_reset(RESET_NODE);
    saver_expect("application's defaults", 1111, 2222, 60);
    expect_verified(0, 0);
}
END_TEST

/* ---- what is stored ---- */

/* What clients cannot write is no parameter: its value is the device's own business. */
START_TEST(values_of_the_device_are_not_saved)
{
    od_set_number(&saver_device.od, 0x2002, 0, 7);
    saver_put(0x1010, 1, 4, SAVE);
    saver_reset(RESET_NODE);
    ck_assert_uint_eq(device_value(&saver_device, 0x2002, 0), 1);
}
END_TEST

/* A domain in the application's memory; it once took the place of other values. */
START_TEST(domains_are_not_saved)
{
    static uint8_t memory[64] = "program";
    struct od_entry *domain = od_find(&saver_device.od, 0x2003, 0);

    ck_assert_int_eq(od_refer(domain, memory, 7, sizeof memory, true), CO_OK);
    saver_put(0x1010, 1, 4, SAVE);
    memcpy(memory, "changed", 7);
    saver_put(0x1011, 1, 4, LOAD);
    saver_reset(RESET_NODE);
    ck_assert_mem_eq(domain->value, "changed", 7);
    ck_assert_ptr_null(domain->initial);
}
END_TEST

/* The application has moved the string to larger memory, which a reset gives up again. */
START_TEST(strings_that_a_reset_has_no_room_for)
{
    static uint8_t small[4] = "ab", large[16];
    struct od_entry *string = od_find(&saver_device.od, 0x2001, 0);

    ck_assert_int_eq(od_refer(string, small, 2, sizeof small, true), CO_OK);
    ck_assert_int_eq(od_refer(string, large, 0, sizeof large, false), CO_OK);
    ck_assert_uint_eq(od_set(string, (const uint8_t *)"12345", 5), SDO_OK);
    saver_change_all();
    ck_assert_uint_eq(device_write(&saver_device, 0x1010, 1, 4, SAVE), SDO_HARDWARE);
    saver_put(0x1010, 3, 4, SAVE);
    ck_assert_uint_eq(od_set(string, (const uint8_t *)"1234", 4), SDO_OK);
    saver_reset(RESET_NODE);
    saver_expect("only one group", 0, 20, 6666);
    ck_assert_ptr_eq(string->value, small);
    ck_assert_uint_eq(string->size, 2);
}
END_TEST

static void switch_off_and_on(void)
{
    slave_done(&saver_device.slave);
    od_reset(&saver_device.od, 0, 0xFFFF);
    ck_assert_int_eq(slave_init(&saver_device.slave, DEVICE_NODE, &saver_device.od), CO_OK);
    device_start(&saver_device);
}

/* The owner may make the device anew on the same dictionary. */
START_TEST(defaults_outlive_the_device)
{
    saver_change_all();
    saver_put(0x1010, 1, 4, SAVE);
    switch_off_and_on();
    saver_expect("saved", 1111, 2222, 6666);
    saver_put(0x1011, 4, 4, LOAD);
    switch_off_and_on();
    saver_expect("one group loaded", 1111, 20, 6666);
    saver_put(0x1011, 1, 4, LOAD);
    saver_reset(RESET_NODE);
    saver_expect("loaded", 0, 20, 60);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("slave_store");
    TCase *tcase = tcase_create("slave_store");

    tcase_add_checked_fixture(tcase, saver_setup, saver_teardown);
    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, save_and_load, 0, (int)(sizeof cases / sizeof cases[0]));
    tcase_add_test(tcase, wrong_signatures_change_nothing);
    tcase_add_test(tcase, each_wrong_signature);
    tcase_add_test(tcase, groups_that_do_not_obey);
    tcase_add_test(tcase, load_is_done_once);
    tcase_add_test(tcase, the_later_command_counts);
    tcase_add_test(tcase, values_of_other_length);
    tcase_add_test(tcase, saved_heartbeat_runs_after_reset);
    tcase_add_test(tcase, errors_are_not_saved);
    tcase_add_test(tcase, verification_in_the_order_of_a_configuration);
    tcase_add_loop_test(tcase, a_change_ends_verification, 0, 9);
    tcase_add_test(tcase, a_refused_write_does_not_end_verification);
    tcase_add_test(tcase, half_restored_is_not_verified);
    tcase_add_test(tcase, half_saved_is_not_verified);
    tcase_add_test(tcase, a_text_is_no_verification);
    tcase_add_test(tcase, loaded_is_not_verified);
    tcase_add_test(tcase, values_of_the_device_are_not_saved);
    tcase_add_test(tcase, domains_are_not_saved);
    tcase_add_test(tcase, strings_that_a_reset_has_no_room_for);
    tcase_add_test(tcase, defaults_outlive_the_device);
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

/* 1010h and 1011h with the slave API: EV_CONFIGURATION, and power-on values in a file. */
#include "port/clock.h"
#include "support/dcf_file.h"
#include "support/store_node.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define NOT_STORED   0x08000020U
#define HARDWARE     0x06060000U

/* --- the application is asked --- */

static const struct verdict {
    int returned;
    uint32_t abort_code;
} verdicts[] = {
    { SCANOPEN_OK, 0 },
    { 0x06060000, 0x06060000 },
    { 1, 1 },
    { SCANOPEN_VALUE_TOO_HIGH, 0x06090031 },
    { SCANOPEN_VALUE_TOO_LOW, 0x06090032 },
    { SCANOPEN_WRONG_PARAMETER, 0x06090030 },
    { SCANOPEN_ACCESS_ERROR, NOT_STORED },
    { -1, NOT_STORED },
};

static void expect_question(int argument, unsigned sub)
{
    char text[SCAN_NOTE_SIZE];

    snprintf(text, sizeof text, "event 0/5 CONFIGURATION %d %u", argument, sub);
    scan_expect_note(text);
}

/* With a file and without. */
START_TEST(the_handler_decides)
{
    const struct verdict *row = &verdicts[_i / 2];
    const bool good = row->abort_code == 0;

    store_make(EV_CONFIGURATION);
    if (_i % 2)
        ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
    store_change(1);
    scan_on_event_returns(row->returned);
    ck_assert_uint_eq(store_save(1), row->abort_code);
    expect_question(EV_STORE, 1);
    ck_assert_uint_eq(store_save(3), row->abort_code);
    expect_question(EV_STORE, 3);
    store_reset("000#8105");
    if (good)
        store_expect_changed(1);
    else
        store_expect_defaults();
    ck_assert_uint_eq(store_load(4), row->abort_code);
    expect_question(EV_RESTORE, 4);
    store_reset("000#8105");
    if (good)
        store_expect(30001, 20, 6661);
    ck_assert_uint_eq(store_files(), _i % 2 && good ? 1 : 0);
    scan_expect_no_note();
}
END_TEST

START_TEST(who_is_not_asked)
{
    store_make(EV_ALL & ~EV_CONFIGURATION & ~EV_WRITE_DICTIONARY);
    scan_activate(store_plant, store_node);
    scan_expect_note("event 0/5 STATE_CHANGE 127 0");
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
    ck_assert_uint_eq(store_load(1), 0);
    scan_expect_no_note();
}
END_TEST

START_TEST(wrong_signatures_are_not_asked_about)
{
    store_make(EV_CONFIGURATION);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
    for (unsigned sub = 1; sub <= 4; sub++) {
        ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1010, sub, 4, STORE_LOAD), NOT_STORED);
        ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1011, sub, 4, STORE_SAVE), NOT_STORED);
    }
    scan_expect_no_note();
    ck_assert_uint_eq(store_files(), 0);
}
END_TEST

static pthread_mutex_t question = PTHREAD_MUTEX_INITIALIZER;

static int on_blocked(SLAVE_EVENT *event)
{
    if (event->ulEvent == EV_CONFIGURATION) {
        scan_note("asked");
        pthread_mutex_lock(&question);
        pthread_mutex_unlock(&question);
    } else if (event->ulEvent == EV_HANDLER) {
        scan_note("late %lX", event->arg.ulArg2);
    }
    return SCANOPEN_OK;
}

/* The client is refused after a second; what the handler says then counts for nothing. */
START_TEST(a_handler_that_is_late)
{
    const SLAVE_NODE_INFO info = store_info(EV_CONFIGURATION | EV_HANDLER);
    co_us_t begin;

    ck_assert_int_eq(canOpenCreateNodeEx(0, 5, on_blocked, &info, &store_node), SCANOPEN_OK);
    scan_plant_keep(store_plant, store_node, 5);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
    pthread_mutex_lock(&question);
    begin = clock_now();
    scan_send(store_plant, "605#2310100173617665");
    scan_expect_note("asked");
    store_put(0x1017, 2, 30000); /* it ends the transfer */
    scan_send(store_plant, "605#2310100173617665");
    scan_await(store_plant, "585#8010100120000008");
    ck_assert_uint_ge(clock_now() - begin, CO_MS(1000));
    pthread_mutex_unlock(&question);
    scan_expect_note("asked");
    scan_expect_note("late 101001");
    ck_assert_uint_eq(store_files(), 0);
    ck_assert_uint_eq(store_save(1), 0);
    ck_assert_uint_eq(store_files(), 1);
}
END_TEST

/* --- the file --- */

START_TEST(values_outlive_the_node)
{
    store_start();
    store_expect_defaults();
    ck_assert_uint_eq(store_files(), 0);
    store_change(1);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x2001, 0, 4, 0x34333231), 0);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1020, 1, 4, 7), 0);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1020, 2, 4, 8), 0);
    ck_assert_uint_eq(store_save(1), 0);
    ck_assert_uint_eq(store_files(), 1);
    store_change(2); /* lost */
    ck_assert_int_eq(scan_set(store_node, 0x2002, 0, 9), SCANOPEN_OK);
    store_restart();
    store_expect_changed(1);
    ck_assert_uint_eq(scan_get(store_node, 0x2002, 0), 1);
    ck_assert_uint_eq(scan_get(store_node, 0x1020, 1), 7);
    ck_assert_uint_eq(scan_get(store_node, 0x1020, 2), 8);
    store_put(0x2000, 2, 5);
    ck_assert_uint_eq(scan_get(store_node, 0x1020, 1), 0);
    store_reset("000#8105");
    store_expect_changed(1);
    ck_assert_uint_eq(scan_get(store_node, 0x1020, 1), 7);
    store_change(3);
    store_reset("000#8205");
    store_expect(30001, 2223, 6663);
    ck_assert_int_eq(canOpenResetNode(store_node), SCANOPEN_OK);
    store_expect_changed(1);
    ck_assert(!store_log_has(""));
}
END_TEST

/* Shorter strings, too: with a NUL behind them. */
START_TEST(strings)
{
    char *text = NULL;

    store_start();
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x2001, 0, 2, 0x7978), 0);
    ck_assert_uint_eq(store_save(4), 0);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x2001, 0, 4, 0x34333231), 0);
    store_reset("000#8105");
    ck_assert_int_eq(canOpenReadDictionary(store_node, 0x2001, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "xy");
    store_restart();
    ck_assert_int_eq(canOpenReadDictionary(store_node, 0x2001, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "xy");
    ck_assert_uint_eq(store_load(4), 0);
    store_restart();
    ck_assert_int_eq(canOpenReadDictionary(store_node, 0x2001, 0, &text), SCANOPEN_OK);
    ck_assert_str_eq(text, "abc");
}
END_TEST

static const struct {
    unsigned save, load;
    uint32_t communication, manufacturer, application; /* after the power cut */
} groups[] = {
    { 1, 0, 30001, 2221, 6661 }, { 2, 0, 30001, 20, 60 },   { 3, 0, 0, 20, 6661 },
    { 4, 0, 0, 2221, 60 },       { 1, 1, 0, 20, 60 },       { 1, 2, 0, 2221, 6661 },
    { 1, 3, 30001, 2221, 60 },   { 1, 4, 30001, 20, 6661 },
};

/* A "load" waits for the reset, and holds for one who is switched off before. */
START_TEST(groups_and_power_cuts)
{
    store_start();
    store_change(1);
    ck_assert_uint_eq(store_save(groups[_i].save), 0);
    if (groups[_i].load)
        ck_assert_uint_eq(store_load(groups[_i].load), 0);
    store_expect_changed(1);
    store_restart();
    store_expect(groups[_i].communication, groups[_i].manufacturer, groups[_i].application);
    store_reset("000#8105");
    store_expect(groups[_i].communication, groups[_i].manufacturer, groups[_i].application);
    ck_assert_uint_eq(store_load(1), 0);
    store_reset("000#8105");
    store_expect_defaults();
}
END_TEST

/* In the format that ccfread shows: what differs from the defaults, and nothing else. */
START_TEST(what_is_in_the_file)
{
    static const char one[] = "\1\0\0\0\0\x20\0\2\0\0\0\x34\x12";
    char bytes[40];
    FILE *file;

    store_start();
    store_put(0x2000, 2, 0x1234);
    store_put(0x6000, 2, 60);
    ck_assert_uint_eq(store_save(1), 0);
    file = fopen(store_path, "r");
    ck_assert_uint_eq(fread(bytes, 1, sizeof bytes, file), sizeof one - 1);
    fclose(file);
    ck_assert_mem_eq(bytes, one, sizeof one - 1);
    ck_assert_uint_eq(store_load(1), 0);
    file = fopen(store_path, "r");
    ck_assert_uint_eq(fread(bytes, 1, sizeof bytes, file), 4);
    fclose(file);
    ck_assert_mem_eq(bytes, "\0\0\0\0", 4);
}
END_TEST

START_TEST(another_file_and_none)
{
    char other[SUITE_PATH_SIZE + 16];

    snprintf(other, sizeof other, "%s/other", store_folder);
    store_start();
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
    ck_assert_int_eq(canOpenResetNode(store_node), SCANOPEN_OK);
    store_expect_changed(1);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, other), SCANOPEN_OK);
    store_expect_defaults();
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    store_expect_changed(1);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, NULL), SCANOPEN_OK);
    store_expect_changed(1);
    scan_activate(store_plant, store_node);
    store_change(2);
    ck_assert_uint_eq(store_save(1), 0); /* in memory alone */
    store_reset("000#8105");
    store_expect_changed(2);
    store_restart();
    store_expect_changed(1);
}
END_TEST

/* Where the file is does not change with the process's folder. */
START_TEST(a_relative_name)
{
    char *before = getcwd(NULL, 0);

    ck_assert_int_eq(chdir(store_folder), 0);
    store_make(0);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, "node-5.ccf"), SCANOPEN_OK);
    ck_assert_int_eq(chdir(before), 0);
    free(before);
    scan_activate(store_plant, store_node);
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
    store_restart();
    store_expect_changed(1);
}
END_TEST

#define STORE_EDS                                                                                  \
    FILE_INFO DEVICE_INFO                                                                          \
        "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n"                   \
        "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n"                                    \
        "[OptionalObjects]\nSupportedObjects=1\n1=0x1010\n" MANDATORY                              \
        "[1010]\nParameterName=Store\nObjectType=8\nSubNumber=2\n" VAR(                            \
            "1010sub0", "5",                                                                       \
            "ro") "DefaultValue=1\n" VAR("1010sub1", "7",                                          \
                                         "rw") "DefaultValue=1\n" VAR("2000", "6",                 \
                                                                      "rw") "DefaultValue=20\n"

static void start_from_file(const char *eds)
{
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, NULL, eds, NULL, &store_node), SCANOPEN_OK);
    scan_plant_keep(store_plant, store_node, 5);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
}

START_TEST(a_node_from_a_file)
{
    char eds[SUITE_PATH_SIZE + 16];
    FILE *file;

    snprintf(eds, sizeof eds, "%s/node.eds", store_folder);
    file = fopen(eds, "w");
    fputs(STORE_EDS, file);
    fclose(file);
    start_from_file(eds);
    ck_assert_uint_eq(scan_get(store_node, 0x2000, 0), 20);
    store_put(0x2000, 2, 5);
    ck_assert_uint_eq(store_save(1), 0);
    scan_plant_free(store_plant);
    store_plant = scan_plant_new(0);
    start_from_file(eds);
    ck_assert_uint_eq(scan_get(store_node, 0x2000, 0), 5);
}
END_TEST

/* --- files that do not fit --- */

static void write_file(const char *bytes, size_t size)
{
    FILE *file = fopen(store_path, "w");

    ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static const struct {
    const char *name;
    const char *bytes;
    size_t size;
    const char *message; /* after the name of the file */
    uint32_t manufacturer;
} bad_files[] = {
    { "empty", "", 0, ": error: a concise DCF begins with a count of 4 bytes", 20 },
    { "no concise DCF", "hello world", 11, ": error: entry 1 of 1819043176 at byte 4", 20 },
    { "cut", "\1\0\0\0\0\x20\0\2\0\0\0\x34", 12, ": error: entry 1 of 1", 20 },
    { "no object", "\2\0\0\0\1\x90\0\1\0\0\0\1\0\x20\0\2\0\0\0\x34\x12", 21,
      ": warning: 9001h:00 is stored, but the device has no such object", 0x1234 },
    { "another size", "\1\0\0\0\0\x20\0\4\0\0\0\1\0\0\0", 15,
      ": warning: 2000h:00 has 4 bytes, the device expects 2", 20 },
    { "read only", "\2\0\0\0\2\x20\0\2\0\0\0\1\0\0\x20\0\2\0\0\0\x34\x12", 22,
      ": warning: 2002h:00 is stored, but the device has no such parameter", 0x1234 },
    { "a long string", "\1\0\0\0\1\x20\0\x11\0\0\0 12345678901234567", 28,
      ": warning: 2001h:00 has 17 bytes, the device has room for 16", 20 },
};

START_TEST(what_does_not_fit)
{
    char message[SUITE_PATH_SIZE + 200];

    write_file(bad_files[_i].bytes, bad_files[_i].size);
    snprintf(message, sizeof message, "%s%s", store_path, bad_files[_i].message);
    store_start();
    ck_assert_msg(store_log_has(message), "%s", bad_files[_i].name);
    store_expect(0, bad_files[_i].manufacturer, 60);
    ck_assert_uint_eq(scan_get(store_node, 0x2002, 0), 1);
    ck_assert_uint_eq(store_files(), 1); /* it is still there */
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
    store_log_clear();
    store_restart();
    store_expect_changed(1);
    ck_assert(!store_log_has(""));
}
END_TEST

/* --- what cannot be written --- */

static void expect_failure(const char *reason)
{
    char message[SUITE_PATH_SIZE + 200];

    snprintf(message, sizeof message, "%s: error: the parameters of node 5 could not be stored: %s",
             store_path, reason);
    ck_assert_uint_eq(store_save(1), HARDWARE);
    ck_assert(store_log_has(message));
}

START_TEST(no_folder)
{
    ck_assert_int_eq(rmdir(store_folder), 0);
    store_start();
    store_change(1);
    expect_failure("no such folder");
    ck_assert_uint_eq(store_load(1), HARDWARE);
    store_reset("000#8105");
    store_expect_defaults();
    ck_assert_int_eq(mkdir(store_folder, 0777), 0);
    store_change(2);
    ck_assert_uint_eq(store_save(1), 0);
    store_reset("000#8105");
    store_expect_changed(2);
}
END_TEST

START_TEST(a_folder_in_its_place)
{
    ck_assert_int_eq(mkdir(store_path, 0777), 0);
    store_start();
    ck_assert(store_log_has(": error: a folder, expected a file"));
    store_change(1);
    expect_failure("the disk is full or fails, or this is no file");
    store_reset("000#8105");
    store_expect_defaults();
    ck_assert_uint_eq(store_files(), 1);
}
END_TEST

/* --- refused --- */

static int on_forbidden(SLAVE_EVENT *event)
{
    if (event->ulEvent == EV_STATE_CHANGE)
        scan_note("%d",
                  canOpenSetStoreFile(store_node, store_path) == SCANOPEN_SERVICE_NOT_ALLOWED);
    return SCANOPEN_OK;
}

START_TEST(errors_of_the_function)
{
    const SLAVE_NODE_INFO info = store_info(EV_STATE_CHANGE);
    HNODE other = scan_node(store_plant, 6, NULL);

    ck_assert_int_eq(canOpenSetStoreFile(NULL, store_path), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(canOpenSetStoreFile(other, store_path), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenCreateNodeEx(0, 5, on_forbidden, &info, &store_node), SCANOPEN_OK);
    scan_plant_keep(store_plant, store_node, 5);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, ""), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
    scan_expect_note("1");
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_WRONG_NODESTATE);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, NULL), SCANOPEN_WRONG_NODESTATE);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("store");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, store_set_up, store_tear_down);
    tcase_add_loop_test(tcase, the_handler_decides, 0, 2 * COUNT(verdicts));
    tcase_add_test(tcase, who_is_not_asked);
    tcase_add_test(tcase, wrong_signatures_are_not_asked_about);
    tcase_add_test(tcase, a_handler_that_is_late);
    tcase_add_test(tcase, values_outlive_the_node);
    tcase_add_test(tcase, strings);
    tcase_add_loop_test(tcase, groups_and_power_cuts, 0, COUNT(groups));
    tcase_add_test(tcase, what_is_in_the_file);
    tcase_add_test(tcase, another_file_and_none);
    tcase_add_test(tcase, a_relative_name);
    tcase_add_test(tcase, a_node_from_a_file);
    tcase_add_loop_test(tcase, what_does_not_fit, 0, COUNT(bad_files));
    tcase_add_test(tcase, no_folder);
    tcase_add_test(tcase, a_folder_in_its_place);
    tcase_add_test(tcase, errors_of_the_function);
    return suite_run("scan_store", tcase);
}

/* TIME with the slave API: canOpenSendTime, EV_TIME, 1012h by SLAVE_NODE_INFO and from a file. */
#include "support/dcf_file.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define TIME_EDS                                                                                   \
    FILE_INFO DEVICE_INFO LISTS "[OptionalObjects]\nSupportedObjects=1\n1=0x1012\n" MANDATORY VAR( \
        "1012", "7", "rw") "DefaultValue=0xC0000181\n"
#define NO_OBJECT     0x06020000u
#define EPOCH_SECONDS 441763200LL /* 1984-01-01 */

static struct scan_plant *plant;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static HNODE make(unsigned long cob_id)
{
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= TIME_STAMP;
    info.ulTimestampCobId = cob_id;
    return scan_node(plant, 5, &info);
}

/* --- received --- */

START_TEST(a_node_hears_the_time)
{
    HNODE node = make(0);

    scan_activate(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    scan_send(plant, "100#FF5B2605983A");
    scan_expect_note("event 0/5 TIME 86399999 15000");
    scan_operational(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 5 0");
    scan_send(plant, "100#010000000200");
    scan_expect_note("event 0/5 TIME 1 2");
    scan_stop(plant, node);
    scan_await_note("event 0/5 STATE_CHANGE 4 0");
    scan_send(plant, "100#010000000200");
    scan_preoperational(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_int_eq(EV_TIME, 0x400);
}
END_TEST

/* A handler that does not want it is not called. */
START_TEST(not_wanted)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node;

    info.ulOptions |= TIME_STAMP;
    info.ulEventMask = EV_ALL & ~EV_TIME;
    node = scan_node(plant, 5, &info);
    scan_activate(plant, node);
    scan_send(plant, "100#010000000200");
    scan_operational(plant, node);
    scan_expect_note("event 0/5 STATE_CHANGE 127 0");
    scan_expect_note("event 0/5 STATE_CHANGE 5 0");
}
END_TEST

/* Devices of one process hear each other, but none hears itself. */
START_TEST(from_one_node_to_the_other)
{
    const CAN_TIME_OF_DAY now = { .ulMs = 5, .usDays = 6 };
    SLAVE_NODE_INFO info = scan_info();
    HNODE one = make(TIME_CONSUME | TIME_PRODUCE | 0x181), other;

    info.ulOptions |= TIME_STAMP;
    info.ulTimestampCobId = TIME_CONSUME | 0x181;
    info.ulEventMask = EV_TIME;
    other = scan_node(plant, 6, &info);
    scan_activate(plant, one);
    scan_activate(plant, other);
    scan_await_note("event 0/5 STATE_CHANGE 127 0");
    ck_assert_int_eq(canOpenSendTime(one, &now), SCANOPEN_OK);
    scan_expect(plant, "181#050000000600");
    scan_expect_note("event 0/6 TIME 5 6");
    scan_expect_nothing_more(plant, one);
    scan_expect_no_note();
}
END_TEST

/* --- sent --- */

START_TEST(a_node_sends_the_time)
{
    const CAN_TIME_OF_DAY last = { .ulMs = 86399999, .usDays = 15000 };
    const CAN_TIME_OF_DAY first = { .ulMs = 0, .usDays = 0 };
    HNODE node = make(TIME_PRODUCE | DEFAULT_TIME_COBID);

    scan_activate(plant, node);
    ck_assert_int_eq(canOpenSendTime(node, &last), SCANOPEN_OK);
    scan_expect(plant, "100#FF5B2605983A");
    scan_operational(plant, node);
    scan_forget(plant);
    ck_assert_int_eq(canOpenSendTime(node, &first), SCANOPEN_OK);
    scan_expect(plant, "100#000000000000");
}
END_TEST

static int on_time(SLAVE_EVENT *event)
{
    const CAN_TIME_OF_DAY *got = event->arg.pArg2;
    const long long now = (long long)time(NULL) - EPOCH_SECONDS;
    const long long seconds = got->usDays * 86400LL + (long long)(got->ulMs / 1000);

    if (now - seconds >= -1 && now - seconds <= SCAN_PATIENCE_S)
        scan_note("it is now");
    else
        scan_note("%lld s away", now - seconds);
    return SCANOPEN_OK;
}

START_TEST(the_clock_of_the_system)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node = make(TIME_PRODUCE | DEFAULT_TIME_COBID), other = NULL;

    info.ulOptions |= TIME_STAMP;
    info.ulEventMask = EV_TIME;
    ck_assert_int_eq(canOpenCreateNodeEx(0, 6, on_time, &info, &other), SCANOPEN_OK);
    scan_plant_keep(plant, other, 6);
    scan_activate(plant, node);
    scan_activate(plant, other);
    ck_assert_int_eq(canOpenSendTime(node, NULL), SCANOPEN_OK);
    scan_await_note("it is now");
}
END_TEST

static const struct {
    unsigned long cob_id;
    uint32_t expected;
} members[] = {
    { 0, 0x80000100 },
    { TIME_CONSUME | DEFAULT_TIME_COBID, 0x80000100 },
    { TIME_PRODUCE | 0x181, 0x40000181 },
    { TIME_CONSUME | TIME_PRODUCE | 0x100, 0xC0000100 },
    { 0x100, 0x100 },
};

START_TEST(the_object)
{
    HNODE node = make(members[_i].cob_id);
    uint32_t value = 0;

    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1012, 0, &value), 0);
    ck_assert_uint_eq(value, members[_i].expected);
}
END_TEST

/* --- refused --- */

START_TEST(errors_of_sending)
{
    const CAN_TIME_OF_DAY good = { .ulMs = 1 }, bad = { .ulMs = 86400000 };
    HNODE node = make(TIME_PRODUCE | 0x100);

    ck_assert_int_eq(canOpenSendTime(NULL, &good), SCANOPEN_INVALID_HANDLE);
    ck_assert_int_eq(canOpenSendTime(node, &good), SCANOPEN_WRONG_NODESTATE);
    scan_activate(plant, node);
    ck_assert_int_eq(canOpenSendTime(node, &bad), SCANOPEN_WRONG_PARAMETER);
    scan_stop(plant, node);
    ck_assert_int_eq(canOpenSendTime(node, &good), SCANOPEN_WRONG_NODESTATE);
    scan_preoperational(plant, node);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1012, 0, 4, 0x100), 0);
    ck_assert_int_eq(canOpenSendTime(node, &good), SCANOPEN_SERVICE_NOT_ALLOWED);
}
END_TEST

START_TEST(without_the_object)
{
    HNODE node = scan_node(plant, 5, NULL);
    uint32_t value = 0;

    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1012, 0, &value), NO_OBJECT);
    ck_assert_int_eq(canOpenSendTime(node, NULL), SCANOPEN_SERVICE_NOT_ALLOWED);
}
END_TEST

static const unsigned long bad_ids[] = { TIME_PRODUCE, 0x101, TIME_CONSUME | 0x601, 0x20000100,
                                         0x7FF };

START_TEST(identifiers_that_are_refused)
{
    SLAVE_NODE_INFO info = scan_info();
    HNODE node = NULL;

    info.ulOptions |= TIME_STAMP;
    info.ulTimestampCobId = bad_ids[_i];
    ck_assert_int_eq(canOpenCreateNodeEx(0, 5, NULL, &info, &node), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* --- from a file --- */

START_TEST(a_node_from_a_file)
{
    const CAN_TIME_OF_DAY now = { .ulMs = 1, .usDays = 2 };
    const SLAVE_NODE_INFO info = { .ulEventMask = EV_TIME };
    char path[SUITE_PATH_SIZE];
    HNODE node = NULL;
    FILE *file;

    suite_temporary("time", path);
    file = fdopen(mkstemp(path), "w");
    fputs(TIME_EDS, file);
    fclose(file);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, scan_on_event, path, &info, &node),
                     SCANOPEN_OK);
    scan_plant_keep(plant, node, 5);
    unlink(path);
    scan_activate(plant, node);
    scan_send(plant, "181#030000000400");
    scan_expect_note("event 0/5 TIME 3 4");
    ck_assert_int_eq(canOpenSendTime(node, &now), SCANOPEN_OK);
    scan_expect(plant, "181#010000000200");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("time");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, a_node_hears_the_time);
    tcase_add_test(tcase, not_wanted);
    tcase_add_test(tcase, from_one_node_to_the_other);
    tcase_add_test(tcase, a_node_sends_the_time);
    tcase_add_test(tcase, the_clock_of_the_system);
    tcase_add_loop_test(tcase, the_object, 0, COUNT(members));
    tcase_add_test(tcase, errors_of_sending);
    tcase_add_test(tcase, without_the_object);
    tcase_add_loop_test(tcase, identifiers_that_are_refused, 0, COUNT(bad_ids));
    tcase_add_test(tcase, a_node_from_a_file);
    return suite_run("scan_time", tcase);
}

/* mcanOpenEvent: what comes, waiting for it, a full queue, and the end. */
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define QUEUE 4096u /* the size that docs/threading.md tells */

static struct api_plant *plant;
static struct api_wire *wire;

static void set_up(void)
{
    plant = api_plant_new();
    wire = api_wire_open(plant->bus);
    api_add_device(plant, 5);
    ck_assert_int_eq(od_add_number(&plant->devices[5].od, 0x1F56, 1, OD_UNSIGNED32, OD_RO, 0x11),
                     CO_OK);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
    api_wire_close(wire);
}

START_TEST(wrong_arguments)
{
    EVENT_T event = { 0 };
    unsigned lost = 7;

    ck_assert_int_eq(mcanOpenEvent(&event, 1), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenGetLostEvents(&lost), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenEvent(NULL, 0), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenEvent(&event, 2), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenEvent(&event, -1), MCAL_PARA_ERROR);
    ck_assert_int_eq(mcanOpenEvent(&event, 1), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenGetLostEvents(&lost), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenGetLostEvents(NULL), MCAL_PARA_ERROR);
    ck_assert_uint_eq(lost, 7);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenEvent(&event, 0), MCAL_NO_EVENT);
}
END_TEST

/* All of it, the texts included. */
START_TEST(the_events_of_a_boot)
{
    static const char *const expected[] = { "Net: 0 Node: 5", "Net: 0 Node: 127", "Net: 0" };
    char text[MCANOPEN_EVENT_TEXT_SIZE];
    unsigned seen[3] = { 0 };
    EVENT_T event = { 0 };

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    while ((unsigned long)event.event != (API_NETWORK_UP | NOD_NOT_VAL)) {
        ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
        ck_assert_int_eq(event.net, 0);
        ck_assert_int_ge(event.event, 0); /* also where long has 64 bits: zero-extended */
        ck_assert_int_eq(mcanOpenEventText(&event, text, sizeof text), MCANOPEN_OK);
        for (int i = 0; i < 3; i++)
            seen[i] += strncmp(text, expected[i], strlen(expected[i])) == 0;
    }
    ck_assert_int_eq(event.node, -1);
    ck_assert_uint_eq(event.para.uc, 1);
    ck_assert_uint_ge(seen[0], 3); /* boot-up, booted, started */
    ck_assert_uint_ge(seen[1], 2); /* pre-operational, operational */
}
END_TEST

/* Of which node, and with which value; the manager is node 127. */
static const struct step {
    int message, node;
    unsigned char value;
} steps[] = {
    { MCANOPEN_MSG_MANAGER_STATE, 127, MCANOPEN_STATE_OFFLINE },
    { MCANOPEN_MSG_MANAGER_STATE, 127, MCANOPEN_STATE_PREOPERATIONAL },
    { MCANOPEN_MSG_BOOT_UP, 5, 0 },
    { MCANOPEN_MSG_NODE_BOOTED, 5, 0 },
    { MCANOPEN_MSG_MANAGER_STATE, 127, MCANOPEN_STATE_OPERATIONAL },
    { MCANOPEN_MSG_NODE_STARTED, 5, MCANOPEN_STATE_OPERATIONAL },
    { MCANOPEN_MSG_NETWORK_UP, -1, 1 },
};

START_TEST(each_step_of_a_boot_is_an_event)
{
    EVENT_T event;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        event = api_wait_event(API_EVENT(PARA_UC, steps[i].message), steps[i].node);
        ck_assert_int_eq(event.node, steps[i].node);
        ck_assert_uint_eq(event.para.uc, steps[i].value);
    }
    api_wire_say(wire, "705#04");
    event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STATE), 5);
    ck_assert_uint_eq(event.para.uc, MCANOPEN_STATE_STOPPED);
}
END_TEST

START_TEST(a_configuration_that_is_refused)
{
    EVENT_T event;

    api_write(plant, "pump.dcf", OBJECT("2001", VAR("2001", "5", "rw") "ParameterValue=7\n"));
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE_WITH(5, "<DCF_File>pump.dcf</DCF_File>")),
                     MCANOPEN_OK);
    mcanOpenStart();
    event = api_wait_event(API_EVENT(PARA_WRITE, MCANOPEN_MSG_CONFIGURATION_ABORTED), 5);
    ck_assert_uint_eq(event.para.write.index, 0x2001);
    ck_assert_uint_eq(event.para.write.subindex, 0);
    ck_assert_uint_eq(event.para.write.err.eclass, 6);
    ck_assert_uint_eq(event.para.write.err.code, 2);
}
END_TEST

START_TEST(a_failure_comes_as_letter_abort_and_text)
{
    EVENT_T event;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE_WITH(5, "<Product_Code>1</Product_Code>")),
                     MCANOPEN_OK);
    mcanOpenStart();
    event = api_wait_event(API_EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR), 5);
    ck_assert_int_eq(event.para.c, 'M');
    ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    ck_assert_uint_eq((unsigned long)event.event,
                      API_EVENT(PARA_WRITE, MCANOPEN_MSG_BOOT_READ_ABORTED));
    ck_assert_uint_eq(event.para.write.index, 0x1018);
    ck_assert_uint_eq(event.para.write.subindex, 2);
    ck_assert_uint_eq(event.para.write.err.eclass, 6);
    ck_assert_uint_eq(event.para.write.err.code, 9);
    ck_assert_uint_eq(event.para.write.err.spec, 0);
    ck_assert_uint_eq(event.para.write.err.global, 0x11);
    ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    ck_assert_uint_eq((unsigned long)event.event, API_EVENT(PARA_STR, MCANOPEN_MSG_TEXT));
    ck_assert_uint_eq(strlen(event.para.str), sizeof event.para.str - 1); /* cut to fit */
    ck_assert_ptr_nonnull(strstr(event.para.str, "boot error M: read 1018h:02"));
}
END_TEST

/* The device has 1F56h and no program download. */
START_TEST(an_update_that_is_refused)
{
    EVENT_T event;

    api_write(plant, "p.bin", "program");
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(
        api_config(plant, API_NODE_WITH(5, "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
                                           "<Software_Identification>2</Software_Identification>"
                                           "<NMT_Allow_Software_Update>TRUE"
                                           "</NMT_Allow_Software_Update>"
                                           "<Software_File>p.bin</Software_File>")),
        MCANOPEN_OK);
    mcanOpenStart();
    event = api_wait_event(API_EVENT(PARA_C, MCANOPEN_MSG_BOOT_ERROR), 5);
    ck_assert_int_eq(event.para.c, 'I');
    event = api_wait_event(API_EVENT(PARA_WRITE, MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED), 5);
    ck_assert_uint_eq(event.para.write.index, 0x1F51);
    ck_assert_uint_eq(event.para.write.subindex, 1);
    api_wait_log(plant,
                 "boot error I: stop its program, 1F51h:01: the node answers abort 06020000");
}
END_TEST

START_TEST(emergencies_and_boot_ups)
{
    EVENT_T event;

    api_boot(plant, API_NODE(5));
    api_wire_say(wire, "085#1081110102030405");
    event = api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY), 5);
    ck_assert_uint_eq(event.para.ul, 0x118110);
    api_wait_log(plant, "node 5: emergency 8110h");
    api_wire_say(wire, "70A#00");
    event = api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_BOOT_UP), 10);
    ck_assert_uint_eq(event.para.uc, 0);
}
END_TEST

/* Its error control is all that the manager does for the node. */
START_TEST(a_heartbeat_is_lost_and_comes_back)
{
    EVENT_T event;

    api_wire_answer(wire, "000#82", "709#05"); /* at the beginning of its boot */
    api_boot(plant, API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"));
    event = api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_HEARTBEAT_LOST), 9);
    ck_assert_uint_eq(event.para.us, 500);
    api_wire_say(wire, "709#05");
    event = api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_HEARTBEAT_BACK), 9);
    ck_assert_uint_eq(event.para.us, 500);
}
END_TEST

/* The first answers have the same toggle bit, then there are none, then there are again. */
START_TEST(guarding_fails_and_comes_back)
{
    EVENT_T event;

    api_wire_answer(wire, "709#R", "709#05");
    api_boot(plant, API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                     "<Guard_Time>50</Guard_Time>"
                                     "<Life_Time_Factor>4</Life_Time_Factor>"));
    event = api_wait_event(API_EVENT(PARA_I, MCANOPEN_MSG_GUARDING_TOGGLE), 9);
    ck_assert_int_eq(event.para.i, 1);
    api_wire_answer(wire, "709#R", "");
    event = api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_GUARDING_LOST), 9);
    ck_assert_uint_eq(event.para.us, 200);
    api_wire_answer(wire, "709#R", "709#05");
    event = api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_GUARDING_BACK), 9);
    ck_assert_uint_eq(event.para.us, 200);
}
END_TEST

START_TEST(the_boot_time_is_over)
{
    EVENT_T event;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(
        api_config(plant, "<Boot_Time>150</Boot_Time>" API_NODE_WITH(9, "<NMT_Mandatory_Slave>TRUE"
                                                                        "</NMT_Mandatory_Slave>")),
        MCANOPEN_OK);
    mcanOpenStart();
    event = api_wait_event(API_EVENT(PARA_US, MCANOPEN_MSG_BOOT_TIME_OVER), -1);
    ck_assert_int_eq(event.node, -1);
    ck_assert_uint_eq(event.para.us, 150);
}
END_TEST

/* --- a full queue --- */

START_TEST(events_that_found_no_room_are_counted)
{
    const unsigned sent = QUEUE + 500;
    EVENT_T event = { 0 };
    unsigned taken = 0, lost = 0;
    char text[32];

    api_boot(plant, API_NODE(5));
    for (unsigned i = 0; i < sent; i++) {
        snprintf(text, sizeof text, "085#10811100%04X", i);
        api_wire_say(wire, text);
    }
    api_wait_log(plant, "field 00 11 F3 00 00"); /* the last one has come: 4595 */
    ck_assert_int_eq(mcanOpenGetLostEvents(&lost), MCANOPEN_OK);
    while (mcanOpenEvent(&event, 0) == MCANOPEN_OK && event.net == 0)
        taken += (unsigned long)event.event == API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY);
    ck_assert_uint_eq((unsigned long)event.event,
                      NET_NOT_VAL | NOD_NOT_VAL | API_EVENT(PARA_UL, MCANOPEN_MSG_EVENTS_LOST));
    ck_assert_int_eq(event.net, -1);
    ck_assert_int_eq(event.node, -1);
    ck_assert_uint_eq(taken + event.para.ul, sent);
    ck_assert_uint_eq(event.para.ul, lost);
    ck_assert_int_eq(mcanOpenGetLostEvents(&lost), MCANOPEN_OK);
    ck_assert_uint_eq(event.para.ul, lost); /* told or not */
    ck_assert_int_eq(mcanOpenEvent(&event, 0), MCAL_NO_EVENT);
    api_wire_say(wire, "085#1081110102030405");
    api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY), 5);
}
END_TEST

/* --- waiting --- */

struct waiter {
    struct co_thread thread;
    int result; /* of the last call, the first one that failed */
    _Atomic unsigned events;
    co_us_t end;
};

static void *take_all(void *context)
{
    struct waiter *self = context;
    EVENT_T event;

    while ((self->result = mcanOpenEvent(&event, 1)) == MCANOPEN_OK)
        self->events += (unsigned long)event.event == API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY);
    self->end = clock_now();
    return NULL;
}

static void waiters_start(struct waiter *waiters, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        atomic_init(&waiters[i].events, 0);
        ck_assert_int_eq(thread_start(&waiters[i].thread, "waiter", take_all, &waiters[i]), CO_OK);
    }
}

static unsigned events_of(struct waiter *waiters, unsigned count)
{
    unsigned events = 0;

    for (unsigned i = 0; i < count; i++)
        events += atomic_load(&waiters[i].events);
    return events;
}

START_TEST(each_event_goes_to_one_of_those_who_wait)
{
    struct waiter waiters[3];
    char text[32];

    api_boot(plant, API_NODE(5));
    waiters_start(waiters, 3);
    for (unsigned i = 0; i < 100; i++) {
        snprintf(text, sizeof text, "085#10811100%04X", i);
        api_wire_say(wire, text);
    }
    api_wait_log(plant, "field 00 00 63 00 00");
    while (events_of(waiters, 3) < 100)
        sched_yield();
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    for (unsigned i = 0; i < 3; i++) {
        thread_join(&waiters[i].thread);
        ck_assert_int_eq(waiters[i].result, MCAL_NO_NET);
    }
    ck_assert_uint_eq(events_of(waiters, 3), 100);
}
END_TEST

/* 100 ms are promised; a busy machine gets more, but not the time of another test. */
START_TEST(shut_down_ends_all_who_wait)
{
    struct waiter waiters[3];
    co_us_t start;
    bool started = _i != 0, cleanup = _i == 2;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    if (started)
        mcanOpenStart();
    waiters_start(waiters, 3);
    usleep(20000); /* so that most of them do wait; it is right all the same if not */
    start = clock_now();
    ck_assert_int_eq(cleanup ? mcanOpenCleanup() : mcanOpenShutDown(), MCANOPEN_OK);
    for (unsigned i = 0; i < 3; i++) {
        thread_join(&waiters[i].thread);
        ck_assert(waiters[i].result == MCAL_NO_NET ||
                  (cleanup && waiters[i].result == MCAL_SYS_ERROR)); /* it began too late */
        ck_assert_uint_lt(waiters[i].end, start + CO_MS(1500));
    }
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("event");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, wrong_arguments);
    tcase_add_test(tests, the_events_of_a_boot);
    tcase_add_test(tests, each_step_of_a_boot_is_an_event);
    tcase_add_test(tests, a_configuration_that_is_refused);
    tcase_add_test(tests, a_failure_comes_as_letter_abort_and_text);
    tcase_add_test(tests, an_update_that_is_refused);
    tcase_add_test(tests, emergencies_and_boot_ups);
    tcase_add_test(tests, a_heartbeat_is_lost_and_comes_back);
    tcase_add_test(tests, guarding_fails_and_comes_back);
    tcase_add_test(tests, the_boot_time_is_over);
    tcase_add_test(tests, events_that_found_no_room_are_counted);
    tcase_add_test(tests, each_event_goes_to_one_of_those_who_wait);
    tcase_add_loop_test(tests, shut_down_ends_all_who_wait, 0, 3);
    return suite_run("api_event", tests);
}

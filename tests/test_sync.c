/* SYNC: the producer's pace, whoever sends; what the consumer takes for a SYNC. */
#include "proto/sync.h"

#include "proto/event.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "set COB-ID PERIOD OVERFLOW" (in ms), "on", "off", "external 0|1", "heard". */
/* clang-format off */
static const struct talk talks[] = {
    { "off without state, bit 30 or period", {
        { 0, CALL, "set 40000080 10 0" }, { 100, IDLE, NULL },
        { 100, CALL, "on" }, { 109, QUIET, NULL }, { 110, SENT, "080#" },
        { 111, CALL, "set 00000080 10 0" }, { 500, IDLE, NULL },
        { 500, CALL, "set 40000080 0 0" }, { 900, IDLE, NULL },
        { 900, CALL, "set C0000080 10 0" }, { 910, SENT, "080#" },
        { 911, CALL, "off" }, { 2000, IDLE, NULL } } },
    { "another identifier", {
        { 0, CALL, "on" }, { 0, CALL, "set 40000123 10 0" }, { 10, SENT, "123#" },
        { 11, CALL, "set 72345678 10 0" }, { 21, SENT, "12345678#" } } },
    { "the counter, and where it begins", {
        { 0, CALL, "on" }, { 0, CALL, "set 40000080 10 3" },
        { 10, SENT, "080#01" }, { 20, SENT, "080#02" }, { 30, SENT, "080#03" },
        { 40, SENT, "080#01" }, { 50, SENT, "080#02" },
        { 51, CALL, "off" }, { 100, IDLE, NULL }, { 100, CALL, "on" },
        { 110, SENT, "080#01" }, { 115, CALL, "on" }, { 120, SENT, "080#02" },
        { 125, CALL, "set 40000080 5 2" },
        { 130, SENT, "080#01" }, { 135, SENT, "080#02" }, { 140, SENT, "080#01" } } },
    { "another period", {
        { 0, CALL, "on" }, { 0, CALL, "set 40000080 10 0" },
        { 10, SENT, "080#" }, { 14, CALL, "set 40000080 100 0" }, { 114, SENT, "080#" } } },
    { "somebody else sends", {
        { 0, CALL, "on" }, { 0, CALL, "external 1" }, { 0, CALL, "set 40000080 10 0" },
        { 10, CALL, "heard" }, { 20, CALL, "heard" }, { 1000, CALL, "heard" },
        { 2499, QUIET, NULL }, { 2500, TOLD, "missing" }, { 9000, IDLE, NULL },
        { 9000, CALL, "heard" }, { 10500, TOLD, "missing" } } },
    { "none comes from the beginning; a long period", {
        { 0, CALL, "on" }, { 0, CALL, "external 1" }, { 0, CALL, "set 40000080 1000 0" },
        { 3999, QUIET, NULL }, { 4000, TOLD, "missing" }, { 20000, IDLE, NULL } } },
    { "somebody else sends from now on, and no longer", {
        { 0, CALL, "on" }, { 0, CALL, "set 40000080 10 5" },
        { 10, SENT, "080#01" }, { 20, SENT, "080#02" },
        { 21, CALL, "external 1" }, { 40, CALL, "heard" }, { 41, CALL, "external 1" },
        { 60, CALL, "external 0" }, { 70, SENT, "080#01" }, { 75, CALL, "heard" },
        { 80, SENT, "080#02" } } },
    { "nobody is missed when it is off", {
        { 0, CALL, "external 1" }, { 0, CALL, "set 40000080 10 0" }, { 0, CALL, "heard" },
        { 5000, IDLE, NULL }, { 5000, CALL, "on" }, { 5001, CALL, "off" }, { 9000, IDLE, NULL } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct sync_producer *self = machine;
    unsigned cob_id = 0, period = 0, overflow = 0;

    (void)out;
    if (sscanf(text, "set %x %u %u", &cob_id, &period, &overflow) == 3)
        sync_producer_configure(self, cob_id, CO_MS(period), (uint8_t)overflow);
    else if (text[0] == 'o')
        sync_producer_enable(self, text[1] == 'n');
    else if (text[0] == 'e')
        sync_producer_set_external(self, text[9] == '1');
    else
        sync_producer_on_sync(self, now);
    return true;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    sync_producer_on_time(machine, now, out);
}

static co_us_t deadline(const void *machine)
{
    return sync_producer_deadline(machine);
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    (void)machine;
    snprintf(text, size, event->type == PROTO_SYNC_MISSING ? "missing" : "event");
}

START_TEST(conversation)
{
    struct sync_producer producer;
    const struct talk_machine machine = { .self = &producer,
                                          .call = call,
                                          .on_time = on_time,
                                          .deadline = deadline,
                                          .describe = describe };

    sync_producer_init(&producer);
    talk_run(&talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* The time at which it is called does not add up; after a stall there is one SYNC, no burst. */
START_TEST(keeps_its_pace)
{
    struct sync_producer producer;
    struct co_frame frames[2], frame;
    struct co_outbox out;

    sync_producer_init(&producer);
    co_outbox_init(&out, frames, 2, NULL, 0);
    sync_producer_enable(&producer, true);
    sync_producer_configure(&producer, 0x40000080, 1000, 0);
    sync_producer_on_time(&producer, 500, &out);
    for (co_us_t due = 1500; due < 100000; due += 1000) {
        ck_assert_uint_eq(sync_producer_deadline(&producer), due);
        sync_producer_on_time(&producer, due + due % 7 * 100, &out);
        ck_assert(co_outbox_take_frame(&out, &frame));
    }
    ck_assert_uint_eq(sync_producer_deadline(&producer), 100500);
    sync_producer_on_time(&producer, 123456, &out);
    ck_assert(co_outbox_take_frame(&out, &frame));
    ck_assert(!co_outbox_take_frame(&out, &frame));
    ck_assert_uint_eq(sync_producer_deadline(&producer), 123500);
    sync_producer_on_time(&producer, 124500, &out);
    ck_assert_uint_eq(sync_producer_deadline(&producer), 125500);
}
END_TEST

static const struct {
    uint32_t cob_id;
    uint8_t length;
    const char *frame;
    bool is_sync;
    uint8_t counter;
    bool wrong;
} frames[] = {
    { 0x80, SYNC_ANY_LENGTH, "080#", true, 0, false },
    { 0x80, SYNC_ANY_LENGTH, "080#07", true, 7, false },
    { 0x80, SYNC_ANY_LENGTH, "080#0708", true, 0, false },
    { 0x80, SYNC_WITHOUT_COUNTER, "080#", true, 0, false },
    { 0x80, SYNC_WITHOUT_COUNTER, "080#07", true, 0, true },
    { 0x80, SYNC_WITH_COUNTER, "080#07", true, 7, false },
    { 0x80, SYNC_WITH_COUNTER, "080#", true, 0, true },
    { 0x80, SYNC_WITH_COUNTER, "080#0708", true, 0, true },
    { 0x80, SYNC_ANY_LENGTH, "081#", false, 0, false },
    { 0x80, SYNC_ANY_LENGTH, "080#R", false, 0, false },
    { 0x80, SYNC_ANY_LENGTH, "00000080#", false, 0, false },
    { 0xC0000081, SYNC_ANY_LENGTH, "081#", true, 0, false },
    { 0x20000080, SYNC_ANY_LENGTH, "080#", false, 0, false },
    { 0x20000080, SYNC_ANY_LENGTH, "00000080#05", true, 5, false },
    { 0x3FFFFFFF, SYNC_WITH_COUNTER, "1FFFFFFF#05", true, 5, false },
};

START_TEST(what_is_a_sync)
{
    struct sync_consumer consumer = { .cob_id = frames[_i].cob_id, .length = frames[_i].length };
    const struct co_frame frame = talk_frame(frames[_i].frame);
    uint8_t counter = 99;

    ck_assert_int_eq(sync_consumer_on_frame(&consumer, &frame, &counter), frames[_i].is_sync);
    ck_assert_uint_eq(counter, frames[_i].is_sync ? frames[_i].counter : 99);
    ck_assert_int_eq(consumer.wrong, frames[_i].wrong);
    ck_assert_uint_eq(consumer.wrong_size, frames[_i].wrong ? frame.dlc : 0);
}
END_TEST

START_TEST(wrong_until_right)
{
    struct sync_consumer consumer = { .cob_id = 0x80, .length = SYNC_WITHOUT_COUNTER };
    struct co_frame frame = talk_frame("080#01");
    uint8_t counter;

    ck_assert(sync_consumer_on_frame(&consumer, &frame, &counter));
    ck_assert(consumer.wrong);
    frame = talk_frame("081#");
    ck_assert(!sync_consumer_on_frame(&consumer, &frame, &counter));
    ck_assert(consumer.wrong);
    frame = talk_frame("080#");
    ck_assert(sync_consumer_on_frame(&consumer, &frame, &counter));
    ck_assert(!consumer.wrong);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("sync");
    TCase *tcase = tcase_create("sync");

    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * TALK_STALLS);
    tcase_add_test(tcase, keeps_its_pace);
    tcase_add_loop_test(tcase, what_is_a_sync, 0, (int)(sizeof frames / sizeof frames[0]));
    tcase_add_test(tcase, wrong_until_right);
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

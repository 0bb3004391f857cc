/* Heartbeat: the producer's rhythm, and what the consumer of node 5 notices. */
#include "proto/heartbeat.h"

#include "proto/event.h"
#include "proto/nmt.h"
#include "support/hex.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- producer ------------------------------------------------------------------------------ */

/* clang-format off */
static const struct talk producer_talks[] = {
    { "off", {
        { 0, CALL, "later 0" },
        { 5000, IDLE, NULL } } },
    { "one period after the start", {
        { 10, CALL, "state 127" },
        { 10, CALL, "later 100" },
        { 109, QUIET, NULL },
        { 110, SENT, "705#7F" },
        { 210, SENT, "705#7F" },
        { 250, CALL, "state 5" },
        { 310, SENT, "705#05" } } },
    { "at once", {
        { 10, CALL, "state 5" },
        { 10, CALL, "at_once 1000" },
        { 10, SENT, "705#05" },
        { 1009, QUIET, NULL },
        { 1010, SENT, "705#05" } } },
    { "another period, then off", {
        { 0, CALL, "state 5" },
        { 0, CALL, "later 100" },
        { 100, SENT, "705#05" },
        { 150, CALL, "later 30" },
        { 180, SENT, "705#05" },
        { 210, SENT, "705#05" },
        { 220, CALL, "later 0" },
        { 5000, IDLE, NULL } } },
};
/* clang-format on */

#define PRODUCER_TALKS ((int)(sizeof producer_talks / sizeof producer_talks[0]))

static bool producer_call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct hb_producer *self = machine;
    const char *number = strchr(text, ' ');

    (void)out;
    ck_assert_ptr_nonnull(number);
    if (text[0] == 's')
        self->state = (uint8_t)atoi(number);
    else
        hb_producer_start(self, CO_MS(atoi(number)), text[0] == 'a', now);
    return true;
}

static void producer_on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    hb_producer_on_time(machine, now, out);
}

static co_us_t producer_deadline(const void *machine)
{
    return hb_producer_deadline(machine);
}

START_TEST(test_producer)
{
    struct hb_producer producer;
    const struct talk_machine machine = { .self = &producer,
                                          .call = producer_call,
                                          .on_time = producer_on_time,
                                          .deadline = producer_deadline };

    hb_producer_init(&producer, 5);
    talk_run(&producer_talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* After a stall one heartbeat goes out, not all that were missed. */
START_TEST(test_producer_stall)
{
    struct hb_producer producer;
    struct co_frame frames[4];
    struct co_outbox out;

    co_outbox_init(&out, frames, 4, NULL, 0);
    hb_producer_init(&producer, 5);
    hb_producer_start(&producer, CO_MS(100), false, 0);
    hb_producer_on_time(&producer, CO_MS(1050), &out);
    hb_producer_on_time(&producer, CO_MS(1050), &out);
    ck_assert_uint_eq(out.frame_count, 1);
    ck_assert_uint_eq(hb_producer_deadline(&producer), CO_MS(1150));
    hb_producer_on_time(&producer, CO_MS(1151), &out); /* a little late: the rhythm stays */
    ck_assert_uint_eq(out.frame_count, 2);
    ck_assert_uint_eq(hb_producer_deadline(&producer), CO_MS(1250));
    hb_producer_on_time(&producer, CO_MS(1350), &out); /* a whole period late */
    hb_producer_on_time(&producer, CO_MS(1350), &out);
    ck_assert_uint_eq(out.frame_count, 3);
}
END_TEST

/* ---- consumer ------------------------------------------------------------------------------ */

/* clang-format off */
static const struct talk consumer_talks[] = {
    { "a node that never comes is not lost", {
        { 0, CALL, "150" },
        { 60000, IDLE, NULL } } },
    { "the first heartbeat, a change, silence, return", {
        { 0, CALL, "150" },
        { 10, GOT,  "705#7F" },
        { 10, TOLD, "state 127" },
        { 110, GOT,  "705#7F" },
        { 210, GOT,  "705#05" },
        { 210, TOLD, "state 5" },
        { 359, QUIET, NULL },
        { 360, TOLD, "lost 5" },
        { 9000, IDLE, NULL },
        { 9001, GOT,  "705#05" },
        { 9001, TOLD, "state 5" },
        { 9151, TOLD, "lost 5" } } },
    { "a heartbeat at the last moment", {
        { 0, CALL, "150" },
        { 10, GOT,  "705#05" },
        { 10, TOLD, "state 5" },
        { 160, GOT,  "705#05" },
        { 309, QUIET, NULL },
        { 310, TOLD, "lost 5" } } },
    { "boot-up ends the watch until the next heartbeat", {
        { 0, CALL, "150" },
        { 10, GOT,  "705#05" },
        { 10, TOLD, "state 5" },
        { 20, GOT,  "705#00" },
        { 5000, IDLE, NULL },
        { 5001, GOT,  "705#05" },
        { 5001, TOLD, "state 5" } } },
    { "boot-up is no first heartbeat", {
        { 0, CALL, "150" },
        { 10, GOT,  "705#00" },
        { 5000, IDLE, NULL } } },
    { "frames that are not heartbeats of this node", {
        { 0, CALL, "150" },
        { 10, GOT,  "706#05" },
        { 11, GOT,  "705#" },
        { 12, GOT,  "705#R1" },
        { 13, GOT,  "00000705#05" },
        { 14, IDLE, NULL },
        { 15, GOT,  "705#85" }, /* b7 is masked */
        { 15, TOLD, "state 5" } } },
    { "not watched, watched again", {
        { 0, GOT,  "705#05" },
        { 0, IDLE, NULL },
        { 1, CALL, "150" },
        { 10, GOT,  "705#05" },
        { 10, TOLD, "state 5" },
        { 20, CALL, "0" },
        { 500, IDLE, NULL },
        { 500, GOT,  "705#7F" },
        { 501, CALL, "20" },
        { 502, GOT,  "705#7F" },
        { 502, TOLD, "state 127" },
        { 522, TOLD, "lost 127" } } },
};
/* clang-format on */

#define CONSUMER_TALKS ((int)(sizeof consumer_talks / sizeof consumer_talks[0]))

static bool consumer_call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    (void)now;
    (void)out;
    hb_consumer_start(machine, CO_MS(atoi(text)));
    return true;
}

static bool consumer_on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                              struct co_outbox *out)
{
    hb_consumer_on_frame(machine, frame, now, out);
    return true;
}

static void consumer_on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    hb_consumer_on_time(machine, now, out);
}

static co_us_t consumer_deadline(const void *machine)
{
    return hb_consumer_deadline(machine);
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    (void)machine;
    ck_assert_uint_eq(event->node, 5);
    ck_assert(event->type == PROTO_HB_STATE || event->type == PROTO_HB_LOST);
    snprintf(text, size, "%s %u", event->type == PROTO_HB_STATE ? "state" : "lost", event->detail);
}

static const struct talk_machine consumer_functions = { .call = consumer_call,
                                                        .on_frame = consumer_on_frame,
                                                        .on_time = consumer_on_time,
                                                        .deadline = consumer_deadline,
                                                        .describe = describe };

START_TEST(test_consumer)
{
    struct hb_consumer consumer;
    struct talk_machine machine = consumer_functions;

    hb_consumer_init(&consumer, 5);
    machine.self = &consumer;
    talk_run(&consumer_talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* Whatever comes: a node is lost when its period has passed, not before, and once. */
START_TEST(test_consumer_garbage)
{
    uint64_t seed = (uint64_t)_i + 1;
    struct hb_consumer consumer;
    struct co_event events[4], event;
    struct co_outbox out;
    co_us_t now = 0, last = CO_NEVER;
    unsigned losses = 0;

    co_outbox_init(&out, NULL, 0, events, 4);
    hb_consumer_init(&consumer, 5);
    hb_consumer_start(&consumer, 100);
    for (unsigned i = 0; i < 5000; i++) {
        struct co_frame frame = co_frame_make(0x704 + noise(&seed) % 3,
                                              (uint8_t)(noise(&seed) % 3));

        frame.data[0] = (uint8_t)noise(&seed);
        hb_consumer_on_frame(&consumer, &frame, now, &out);
        if (frame.id == 0x705 && frame.dlc > 0)
            last = (frame.data[0] & 0x7F) != 0 ? now : CO_NEVER;
        now += noise(&seed) % 60;
        hb_consumer_on_time(&consumer, now, &out);
        while (co_outbox_take_event(&out, &event)) {
            if (event.type != PROTO_HB_LOST)
                continue;
            ck_assert(last != CO_NEVER && now >= last + 100);
            last = CO_NEVER;
            losses++;
        }
        ck_assert(last == CO_NEVER || now < last + 100);
    }
    ck_assert_uint_gt(losses, 20);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("heartbeat");
    TCase *tcase = tcase_create("heartbeat");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_producer, 0, PRODUCER_TALKS * TALK_STALLS);
    tcase_add_test(tcase, test_producer_stall);
    tcase_add_loop_test(tcase, test_consumer, 0, CONSUMER_TALKS * TALK_STALLS);
    tcase_add_loop_test(tcase, test_consumer_garbage, 0, 4);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

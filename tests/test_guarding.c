/* Guarding: the master that watches node 5. The device's side: test_guarding_slave. */
#include "proto/guarding.h"

#include "proto/event.h"
#include "proto/nmt.h"
#include "support/hex.h"
#include "support/suite.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))
#define NODE         5

/* clang-format off */
static const struct talk master_talks[] = {
    { "nothing to do without guard time or factor", {
        { 0, CALL, "start 0 2" },
        { 1, CALL, "start 100 0" },
        { 60000, IDLE, NULL } } },
    { "a request each guard time; answers alternate; only another state is told", {
        { 10, CALL, "start 100 2" },
        { 10, SENT, "705#R1" },
        { 11, GOT,  "705#7F" },
        { 11, TOLD, "state 127" },
        { 109, QUIET, NULL },
        { 110, SENT, "705#R1" },
        { 111, GOT,  "705#FF" },
        { 210, SENT, "705#R1" },
        { 212, GOT,  "705#05" },
        { 212, TOLD, "state 5" },
        { 310, SENT, "705#R1" },
        { 311, GOT,  "705#84" },
        { 311, TOLD, "state 4" },
        { 410, SENT, "705#R1" } } },
    { "a node that never answers is lost, once; the requests go on", {
        { 0, CALL, "start 100 3" },
        { 0, SENT, "705#R1" },
        { 100, SENT, "705#R1" },
        { 200, SENT, "705#R1" },
        { 299, QUIET, NULL },
        { 300, SENT, "705#R1" },
        { 300, TOLD, "lost 0" },
        { 400, SENT, "705#R1" },
        { 500, SENT, "705#R1" },
        { 600, SENT, "705#R1" },
        { 700, SENT, "705#R1" },
        { 750, QUIET, NULL } } },
    { "lost one life time after the last answered request, not after the answer; back", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 99, GOT,  "705#05" },
        { 99, TOLD, "state 5" },
        { 100, SENT, "705#R1" },
        { 199, QUIET, NULL },
        { 200, SENT, "705#R1" },
        { 200, TOLD, "lost 5" },
        { 300, SENT, "705#R1" },
        { 301, GOT,  "705#85" },
        { 301, TOLD, "state 5" },
        { 400, SENT, "705#R1" },
        { 499, QUIET, NULL },
        { 500, SENT, "705#R1" },
        { 500, TOLD, "lost 5" } } },
    { "with factor 1 a request has its guard time for the answer", {
        { 0, CALL, "start 100 1" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 100, SENT, "705#R1" },
        { 101, GOT,  "705#85" },
        { 199, QUIET, NULL },
        { 200, SENT, "705#R1" },
        { 299, QUIET, NULL },
        { 300, SENT, "705#R1" },
        { 300, TOLD, "lost 5" } } },
    { "with factor 1 and no answer at all", {
        { 0, CALL, "start 100 1" },
        { 0, SENT, "705#R1" },
        { 99, QUIET, NULL },
        { 100, SENT, "705#R1" },
        { 100, TOLD, "lost 0" } } },
    { "wrong toggle bits are counted, and cost nothing else", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#85" },
        { 1, TOLD, "state 5" },
        { 1, TOLD, "toggle 5 1" },
        { 100, SENT, "705#R1" },
        { 101, GOT,  "705#05" },
        { 200, SENT, "705#R1" },
        { 201, GOT,  "705#04" },
        { 201, TOLD, "state 4" },
        { 201, TOLD, "toggle 4 2" },
        { 300, SENT, "705#R1" },
        { 301, GOT,  "705#84" },
        { 400, SENT, "705#R1" },
        { 401, GOT,  "705#04" },
        { 402, CALL, "stop" },
        { 402, CALL, "start 100 2" },
        { 402, SENT, "705#R1" },
        { 403, GOT,  "705#84" },
        { 403, TOLD, "state 4" },
        { 403, TOLD, "toggle 4 3" } } },
    { "a node that does not toggle", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 100, SENT, "705#R1" },
        { 101, GOT,  "705#05" },
        { 101, TOLD, "toggle 5 1" },
        { 200, SENT, "705#R1" },
        { 201, GOT,  "705#05" },
        { 201, TOLD, "toggle 5 2" } } },
    { "an answer after the next request is one; so is one that another master asked for", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 100, SENT, "705#R1" },
        { 101, GOT,  "705#05" },
        { 101, TOLD, "state 5" },
        { 102, GOT,  "705#85" },
        { 150, GOT,  "705#7F" },
        { 150, TOLD, "state 127" },
        { 200, SENT, "705#R1" },
        { 201, GOT,  "705#FF" },
        { 290, GOT,  "705#7F" }, /* answers no request of ours: */
        { 300, SENT, "705#R1" },
        { 399, QUIET, NULL },
        { 400, SENT, "705#R1" },
        { 400, TOLD, "lost 127" } } },
    { "boot-up is no answer; the toggle bit starts anew, and the time", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 100, SENT, "705#R1" },
        { 150, GOT,  "705#00" },
        { 200, SENT, "705#R1" },
        { 201, GOT,  "705#05" },
        { 201, TOLD, "state 5" },
        { 300, SENT, "705#R1" },
        { 350, GOT,  "705#00" },
        { 400, SENT, "705#R1" },
        { 500, SENT, "705#R1" },
        { 549, QUIET, NULL },
        { 550, TOLD, "lost 0" },
        { 560, GOT,  "705#00" }, /* it stays lost: */
        { 600, SENT, "705#R1" },
        { 700, SENT, "705#R1" },
        { 800, SENT, "705#R1" },
        { 801, GOT,  "705#7F" },
        { 801, TOLD, "state 127" } } },
    { "frames that are no answers of this node", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 10, GOT,  "704#05" },
        { 11, GOT,  "706#05" },
        { 12, GOT,  "705#" },
        { 13, GOT,  "705#R1" },
        { 14, GOT,  "00000705#05" },
        { 15, GOT,  "585#05" },
        { 16, GOT,  "704#00" },
        { 17, GOT,  "700#05" },
        { 18, ECHO, NULL }, /* our own request */
        { 100, SENT, "705#R1" },
        { 200, SENT, "705#R1" },
        { 200, TOLD, "lost 0" },
        { 201, GOT,  "705#0511223344556677" }, /* long ones are */
        { 201, TOLD, "state 5" } } },
    { "stopped; frames count no more", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 50, CALL, "stop" },
        { 50, IDLE, NULL },
        { 60, GOT,  "705#FF" },
        { 61, GOT,  "705#00" },
        { 9000, IDLE, NULL },
        { 9000, CALL, "start 20 1" },
        { 9000, SENT, "705#R1" },
        { 9001, GOT,  "705#7F" },
        { 9001, TOLD, "state 127" } } },
    { "another guard time goes on with the toggle bit", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 10, CALL, "start 50 2" },
        { 10, SENT, "705#R1" },
        { 11, GOT,  "705#85" },
        { 11, TOLD, "state 5" },
        { 60, SENT, "705#R1" },
        { 61, CALL, "start 0 0" },
        { 61, IDLE, NULL } } },
    { "asked once: no answer", {
        { 0, CALL, "ask 50" },
        { 0, SENT, "705#R1" },
        { 49, QUIET, NULL },
        { 50, TOLD, "lost 0" },
        { 51, GOT,  "705#05" },
        { 9000, IDLE, NULL } } },
    { "asked once: an answer, at the last moment, and then guarded on from it", {
        { 0, CALL, "ask 50" },
        { 0, SENT, "705#R1" },
        { 50, GOT,  "705#85" },
        { 50, TOLD, "state 5" },
        { 50, IDLE, NULL },
        { 60, GOT,  "705#7F" },
        { 9000, IDLE, NULL },
        { 9000, CALL, "start 100 2" },
        { 9000, SENT, "705#R1" },
        { 9001, GOT,  "705#05" },
        { 9001, TOLD, "state 5" },
        { 9100, SENT, "705#R1" },
        { 9101, GOT,  "705#05" },
        { 9101, TOLD, "toggle 5 1" } } },
    { "asked once: an answer with bit 0 makes the next one 1; a boot-up takes that back", {
        { 0, CALL, "ask 50" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 2, CALL, "ask 50" },
        { 2, SENT, "705#R1" },
        { 3, GOT,  "705#05" },
        { 3, TOLD, "state 5" },
        { 10, GOT,  "705#00" },
        { 11, CALL, "start 100 2" },
        { 11, SENT, "705#R1" },
        { 12, GOT,  "705#7F" },
        { 12, TOLD, "state 127" } } },
    { "asked once: boot-up is no answer and gives no more time", {
        { 0, CALL, "ask 50" },
        { 0, SENT, "705#R1" },
        { 40, GOT,  "705#00" },
        { 49, QUIET, NULL },
        { 50, TOLD, "lost 0" },
        { 9000, IDLE, NULL } } },
    { "asked in the place of guarding, and stopped", {
        { 0, CALL, "start 100 2" },
        { 0, SENT, "705#R1" },
        { 1, GOT,  "705#05" },
        { 1, TOLD, "state 5" },
        { 10, CALL, "ask 500" },
        { 10, SENT, "705#R1" },
        { 300, QUIET, NULL },
        { 300, CALL, "stop" },
        { 301, GOT,  "705#05" },
        { 9000, IDLE, NULL } } },
};
/* clang-format on */

static bool master_call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    unsigned period = 0, factor = 0;
    char verb[8];

    (void)out;
    ck_assert_int_ge(sscanf(text, "%7s %u %u", verb, &period, &factor), 1);
    if (strcmp(verb, "start") == 0)
        guard_master_start(machine, CO_MS(period), (uint8_t)factor, now);
    else if (strcmp(verb, "ask") == 0)
        guard_master_ask(machine, CO_MS(period), now);
    else
        guard_master_stop(machine);
    return true;
}

static bool master_on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                            struct co_outbox *out)
{
    guard_master_on_frame(machine, frame, now, out);
    return true;
}

static void master_on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    guard_master_on_time(machine, now, out);
}

static co_us_t master_deadline(const void *machine)
{
    return guard_master_deadline(machine);
}

static void master_describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    (void)machine;
    ck_assert_uint_eq(event->node, NODE);
    if (event->type == PROTO_GUARD_TOGGLE)
        snprintf(text, size, "toggle %u %u", event->detail, (unsigned)event->actual);
    else
        snprintf(text, size, "%s %u", event->type == PROTO_GUARD_STATE ? "state" : "lost",
                 event->detail);
    ck_assert(event->type == PROTO_GUARD_TOGGLE || event->type == PROTO_GUARD_STATE ||
              event->type == PROTO_GUARD_LOST);
}

START_TEST(master_conversation)
{
    struct guard_master master;
    const struct talk_machine machine = { .self = &master,
                                          .call = master_call,
                                          .on_frame = master_on_frame,
                                          .on_time = master_on_time,
                                          .deadline = master_deadline,
                                          .describe = master_describe };

    guard_master_init(&master, NODE);
    talk_run(&master_talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* A master with an outbox that is as large as the test says. */
struct bench {
    struct guard_master master;
    struct co_outbox out;
    struct co_frame frames[8];
    struct co_event events[8];
};

static void bench_room(struct bench *self, unsigned frames, unsigned events)
{
    co_outbox_init(&self->out, self->frames, frames, self->events, events);
}

static void bench_init(struct bench *self, co_us_t period, uint8_t factor)
{
    bench_room(self, 8, 8);
    guard_master_init(&self->master, NODE);
    guard_master_start(&self->master, period, factor, 0);
}

static void bench_hear(struct bench *self, const char *text, co_us_t now)
{
    const struct co_frame frame = talk_frame(text);

    guard_master_on_frame(&self->master, &frame, now, &self->out);
}

static void expect_event(struct bench *self, enum proto_event type, uint8_t state, uint64_t actual)
{
    struct co_event event;

    ck_assert(co_outbox_take_event(&self->out, &event));
    ck_assert_uint_eq(event.type, type);
    ck_assert_uint_eq(event.detail, state);
    ck_assert_uint_eq(event.actual, actual);
}

/* After a stall one request goes out, and it gets its time before the node is lost. */
START_TEST(master_stall)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 2);
    guard_master_on_time(&bench.master, 0, &bench.out);
    bench_hear(&bench, "705#05", CO_MS(1));
    expect_event(&bench, PROTO_GUARD_STATE, 5, 0);
    guard_master_on_time(&bench.master, CO_MS(1050), &bench.out);
    guard_master_on_time(&bench.master, CO_MS(1050), &bench.out);
    ck_assert_uint_eq(bench.out.frame_count, 2);
    ck_assert_uint_eq(bench.out.event_count, 0);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), CO_MS(1150));
    guard_master_on_time(&bench.master, CO_MS(1149), &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, CO_MS(1151), &bench.out); /* a little late */
    expect_event(&bench, PROTO_GUARD_LOST, 5, 0);
    ck_assert_uint_eq(bench.out.frame_count, 3);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), CO_MS(1250)); /* the rhythm stays */
}
END_TEST

/* When the answer and its time-out come together, the answer counts. */
START_TEST(answer_at_the_last_moment)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 2);
    guard_master_on_time(&bench.master, 0, &bench.out);
    guard_master_on_time(&bench.master, CO_MS(100), &bench.out);
    bench_hear(&bench, "705#05", CO_MS(200));
    expect_event(&bench, PROTO_GUARD_STATE, 5, 0);
    guard_master_on_time(&bench.master, CO_MS(200), &bench.out);
    guard_master_on_time(&bench.master, CO_MS(300) - 1, &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, CO_MS(300), &bench.out);
    expect_event(&bench, PROTO_GUARD_LOST, 5, 0);
}
END_TEST

/* What could not be asked is no silence of the node. */
START_TEST(master_without_room_to_ask)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 1);
    bench_room(&bench, 0, 8);
    guard_master_on_time(&bench.master, CO_MS(5000), &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    ck_assert_uint_le(guard_master_deadline(&bench.master), CO_MS(5000));
    bench_room(&bench, 8, 8);
    guard_master_on_time(&bench.master, CO_MS(5001), &bench.out);
    ck_assert_uint_eq(bench.out.frame_count, 1);
    guard_master_on_time(&bench.master, CO_MS(5100), &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, CO_MS(5101), &bench.out);
    expect_event(&bench, PROTO_GUARD_LOST, 0, 0);
}
END_TEST

/* Answers while nothing can be told: the last state and the number of errors are told later. */
START_TEST(master_without_room_to_tell)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 2);
    guard_master_on_time(&bench.master, 0, &bench.out);
    bench_room(&bench, 8, 0);
    bench_hear(&bench, "705#05", 1);
    bench_hear(&bench, "705#05", 2);
    bench_hear(&bench, "705#04", 3);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), 0);
    bench_room(&bench, 8, 1);
    guard_master_on_time(&bench.master, 4, &bench.out);
    expect_event(&bench, PROTO_GUARD_STATE, 4, 0);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), 0);
    guard_master_on_time(&bench.master, 4, &bench.out);
    expect_event(&bench, PROTO_GUARD_TOGGLE, 4, 2);
    guard_master_on_time(&bench.master, 4, &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), CO_MS(100));
}
END_TEST

/* A boot-up between an answer and its telling: as if it had not answered. */
START_TEST(master_boot_up_untold)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 1);
    guard_master_on_time(&bench.master, 0, &bench.out);
    guard_master_on_time(&bench.master, CO_MS(100), &bench.out);
    expect_event(&bench, PROTO_GUARD_LOST, 0, 0);
    bench_room(&bench, 8, 0);
    bench_hear(&bench, "705#05", CO_MS(101));
    bench_hear(&bench, "705#00", CO_MS(102));
    bench_room(&bench, 8, 8);
    for (unsigned i = 2; i < 9; i++)
        guard_master_on_time(&bench.master, CO_MS(100) * i, &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    bench_hear(&bench, "705#7F", CO_MS(801));
    expect_event(&bench, PROTO_GUARD_STATE, 0x7F, 0);
}
END_TEST

/* A stop forgets what was not told, a question what guarding knew. */
START_TEST(master_forgets)
{
    struct bench bench;

    bench_init(&bench, CO_MS(100), 2);
    guard_master_on_time(&bench.master, 0, &bench.out);
    bench_room(&bench, 8, 0);
    bench_hear(&bench, "705#85", 1);
    guard_master_stop(&bench.master);
    bench_room(&bench, 8, 8);
    guard_master_on_time(&bench.master, 2, &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    ck_assert_uint_eq(guard_master_deadline(&bench.master), CO_NEVER);
}
END_TEST

/* A question is open from its request on: what came before answers something else. */
START_TEST(question_before_its_request)
{
    struct bench bench;

    bench_init(&bench, 0, 0);
    guard_master_ask(&bench.master, CO_MS(50), 0);
    bench_hear(&bench, "705#05", 1);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, CO_MS(30), &bench.out); /* the outbox was full for long */
    guard_master_on_time(&bench.master, CO_MS(80) - 1, &bench.out);
    ck_assert_uint_eq(bench.out.frame_count, 1);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, CO_MS(80), &bench.out);
    expect_event(&bench, PROTO_GUARD_LOST, 0, 0);
}
END_TEST

/* The largest times do not overflow. */
START_TEST(largest_life_time)
{
    struct bench bench;
    const co_us_t life = CO_MS(65535) * 255;

    bench_init(&bench, CO_MS(65535), 255);
    for (unsigned i = 0; i < 255; i++) {
        bench_room(&bench, 1, 1);
        guard_master_on_time(&bench.master, CO_MS(65535) * i, &bench.out);
        ck_assert_uint_eq(bench.out.frame_count, 1);
    }
    bench_room(&bench, 1, 1);
    guard_master_on_time(&bench.master, life - 1, &bench.out);
    ck_assert_uint_eq(bench.out.event_count, 0);
    guard_master_on_time(&bench.master, life, &bench.out);
    expect_event(&bench, PROTO_GUARD_LOST, 0, 0);
}
END_TEST

/* Whatever comes: losses and answers take turns, and no loss comes before its time. */
START_TEST(master_garbage)
{
    uint64_t seed = (uint64_t)_i + 1;
    struct bench bench;
    struct co_event event;
    co_us_t now = 0, sign = 0;
    unsigned losses = 0;
    bool lost = false;

    bench_init(&bench, 100, 3);
    for (unsigned i = 0; i < 5000; i++) {
        struct co_frame frame = co_frame_make(0x704 + noise(&seed) % 3,
                                              (uint8_t)(noise(&seed) % 3));

        frame.flags = noise(&seed) % 4 ? 0 : CO_FRAME_RTR;
        frame.data[0] = (uint8_t)noise(&seed);
        guard_master_on_frame(&bench.master, &frame, now, &bench.out);
        if (frame.id == 0x705 && frame.dlc > 0 && frame.flags == 0)
            sign = now;
        now += noise(&seed) % 60;
        guard_master_on_time(&bench.master, now, &bench.out);
        while (co_outbox_take_event(&bench.out, &event)) {
            ck_assert(event.type != PROTO_GUARD_TOGGLE || !lost);
            ck_assert(event.type != PROTO_GUARD_LOST || (!lost && now >= sign + 200));
            losses += event.type == PROTO_GUARD_LOST;
            lost = event.type == PROTO_GUARD_LOST;
        }
        bench_room(&bench, 8, 8);
    }
    ck_assert_uint_gt(losses, 20);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("guarding");

    tcase_add_loop_test(tcase, master_conversation, 0, COUNT(master_talks) * TALK_STALLS);
    tcase_add_test(tcase, master_stall);
    tcase_add_test(tcase, answer_at_the_last_moment);
    tcase_add_test(tcase, master_without_room_to_ask);
    tcase_add_test(tcase, master_without_room_to_tell);
    tcase_add_test(tcase, master_boot_up_untold);
    tcase_add_test(tcase, master_forgets);
    tcase_add_test(tcase, question_before_its_request);
    tcase_add_test(tcase, largest_life_time);
    tcase_add_loop_test(tcase, master_garbage, 0, 4);
    return suite_run("guarding", tcase);
}

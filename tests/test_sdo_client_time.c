/* SDO client: time-outs, late answers, cancelling, no room, and garbage at any time. */
#include "support/client_bench.h"
#include "support/hex.h"

#include <check.h>
#include <stdio.h>

/* clang-format off */
static const struct talk talks[] = {
    /* time */
    { "no answer", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 10, ECHO, NULL },
        { 209, QUIET, NULL },
        { 210, SENT, "605#8000100000000405" },
        { 210, TOLD, "no answer 05040000 0" },
        { 5000, IDLE, NULL } } },
    { "no answer to the second segment: the time starts anew with each request", {
        { 0, CALL, "write 2000:00 3031323334353637" },
        { 0, SENT, "605#2000200000000000" },
        { 1, ECHO, NULL },
        { 150, GOT,  "585#6000200000000000" },
        { 150, SENT, "605#0030313233343536" },
        { 151, ECHO, NULL },
        { 300, GOT,  "585#2000000000000000" },
        { 300, SENT, "605#1D37000000000000" },
        { 301, ECHO, NULL },
        { 400, ECHO, NULL }, /* does not start it again */
        { 500, QUIET, NULL },
        { 501, SENT, "605#8000200000000405" },
        { 501, TOLD, "no answer 05040000 7" } } },
    { "an answer at the last moment", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 10, ECHO, NULL },
        { 210, GOT,  "585#4300100091010F00" },
        { 210, TOLD, "ok 00000000 4 91010F00" } } },
    { "the request does not get on the wire", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1999, QUIET, NULL },
        { 2000, TOLD, "not sent 00000000 0" },
        { 2500, ECHO, NULL }, /* too late */
        { 5000, IDLE, NULL } } },
    { "a segment does not get on the wire", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 1, ECHO, NULL },
        { 2, GOT,  "585#4008100000000000" },
        { 2, SENT, "605#6000000000000000" },
        { 2001, QUIET, NULL },
        { 2002, TOLD, "not sent 00000000 0" } } },
    { "an answer without the confirmation before", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1900, GOT,  "585#4300100091010F00" },
        { 1900, TOLD, "ok 00000000 4 91010F00" } } },
    { "the abort's own frame does not confirm the next request", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 0, ECHO, NULL },
        { 200, SENT, "605#8000100000000405" },
        { 200, TOLD, "no answer 05040000 0" },
        { 200, CALL, "read 1000:00 4" },
        { 200, SENT, "605#4000100000000000" },
        { 201, ECHO, "605#8000100000000405" },
        { 600, QUIET, NULL },
        { 600, ECHO, NULL },
        { 800, SENT, "605#8000100000000405" },
        { 800, TOLD, "no answer 05040000 0" } } },
    /* late answers */
    { "an answer that is late meets the next transfer", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 0, ECHO, NULL },
        { 200, SENT, "605#8000100000000405" },
        { 200, TOLD, "no answer 05040000 0" },
        { 210, CALL, "read 1018:01 4" },
        { 210, SENT, "605#4018100100000000" },
        { 211, GOT,  "585#4300100091010F00" },
        { 211, CALL, "late 1" },
        { 212, GOT,  "585#430110012A000000" },
        { 212, CALL, "late 2" },
        { 213, GOT,  "585#431810012A000000" },
        { 213, TOLD, "ok 00000000 4 2A000000" } } },
    { "a segment that is late meets the next transfer", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 0, ECHO, NULL },
        { 1, GOT,  "585#4108100010000000" },
        { 1, SENT, "605#6000000000000000" },
        { 1, ECHO, NULL },
        { 201, SENT, "605#8008100000000405" },
        { 201, TOLD, "no answer 05040000 0" },
        { 210, CALL, "read 1018:01 4" },
        { 210, SENT, "605#4018100100000000" },
        { 211, GOT,  "585#0030313233343536" },
        { 211, CALL, "late 1" },
        { 213, GOT,  "585#431810012A000000" },
        { 213, TOLD, "ok 00000000 4 2A000000" },
        { 220, CALL, "read 1018:01 4" },
        { 220, SENT, "605#4018100100000000" },
        { 221, GOT,  "585#0030313233343536" },
        { 221, SENT, "605#8018100101000405" },
        { 221, TOLD, "protocol 05040001 0" } } },
    { "answers to reads that were given up come while the same object is written", {
        { 0, CALL, "read 1020:01 4" },
        { 0, SENT, "605#4020100100000000" },
        { 0, ECHO, NULL },
        { 200, SENT, "605#8020100100000405" },
        { 200, TOLD, "no answer 05040000 0" },
        { 201, CALL, "write 1020:01 01020304" },
        { 201, SENT, "605#2320100101020304" },
        { 202, GOT,  "585#432010012A000000" },
        { 202, GOT,  "585#432010012A000000" },
        { 202, CALL, "late 2" },
        { 203, GOT,  "585#6020100100000000" },
        { 203, TOLD, "ok 00000000 4" } } },
    { "an answer of the wrong kind, where no other is owed", {
        { 0, CALL, "write 1020:02 01020304" },
        { 0, SENT, "605#2320100201020304" },
        { 1, GOT,  "585#432010022A000000" },
        { 1, SENT, "605#8020100201000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "an answer to a write that was given up comes while the same object is read", {
        { 0, CALL, "write 1020:01 01020304" },
        { 0, SENT, "605#2320100101020304" },
        { 1, CALL, "cancel 08000022" },
        { 1, TOLD, "cancelled 08000022 0" },
        { 2, CALL, "read 1020:01 4" },
        { 2, SENT, "605#4020100100000000" },
        { 3, GOT,  "585#6020100100000000" },
        { 3, CALL, "late 1" },
        { 4, GOT,  "585#4320100101020304" },
        { 4, TOLD, "ok 00000000 4 01020304" } } },
    { "two answers to the first request of a transfer in segments, the other one is late", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 0, ECHO, NULL },
        { 200, SENT, "605#8008100000000405" },
        { 200, TOLD, "no answer 05040000 0" },
        { 201, CALL, "read 1008:00 8" },
        { 201, SENT, "605#4008100000000000" },
        { 202, GOT,  "585#4108100002000000" },
        { 202, SENT, "605#6000000000000000" },
        { 203, GOT,  "585#4108100002000000" },
        { 203, CALL, "late 1" },
        { 204, GOT,  "585#0B41420000000000" },
        { 204, TOLD, "ok 00000000 2 4142" } } },
    { "an answer for another object among the segments", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#4300100091010F00" },
        { 2, GOT,  "585#8000100000000405" },
        { 2, CALL, "late 2" },
        { 3, GOT,  "585#0B41420000000000" },
        { 3, TOLD, "ok 00000000 2 4142" } } },
    /* cancelling */
    { "cancelled before the first answer: the server is not told", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, CALL, "cancel 08000022" },
        { 1, TOLD, "cancelled 08000022 0" },
        { 2, GOT,  "585#4300100091010F00" },
        { 2, CALL, "late 1" },
        { 5000, IDLE, NULL } } },
    { "cancelled among the segments", {
        { 0, CALL, "write 2000:00 3132333435" },
        { 0, SENT, "605#2000200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0531323334350000" },
        { 2, CALL, "cancel 08000022" },
        { 2, SENT, "605#8000200022000008" },
        { 2, TOLD, "cancelled 08000022 0" },
        { 3, CALL, "cancel nothing" },
        { 5000, IDLE, NULL } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    client_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* The outcome that waits for room is kept when the transfer is cancelled meanwhile. */
START_TEST(test_cancel_after_end)
{
    struct co_frame frames[2], answer = talk_frame("585#4300100091010F00");
    struct co_event events[2], event;
    struct co_outbox out;
    struct client_bench bench;

    client_bench_init(&bench);
    co_outbox_init(&out, frames, 2, events, 2);
    client_bench_start(&bench, "read 1000:00 4", 0, &out);
    co_outbox_init(&out, frames, 2, events, 0);
    sdo_client_on_frame(&bench.client, &answer, 1, &out);
    ck_assert(sdo_client_busy(&bench.client));
    ck_assert(!sdo_client_cancel(&bench.client, SDO_GENERAL, &out));
    co_outbox_init(&out, frames, 2, events, 2);
    ck_assert(sdo_client_cancel(&bench.client, SDO_GENERAL, &out));
    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(event.actual, 4);
    ck_assert(!sdo_client_busy(&bench.client));
}
END_TEST

/* A request that waits for room so long that its time is over is not sent any more. */
START_TEST(test_unsent_expires)
{
    struct co_frame frames[2];
    struct co_event events[2], event;
    struct co_outbox out;
    struct client_bench bench;

    client_bench_init(&bench);
    co_outbox_init(&out, frames, 0, events, 2);
    client_bench_start(&bench, "read 1000:00 4", 0, &out);
    ck_assert_uint_eq(sdo_client_deadline(&bench.client), 0);
    sdo_client_on_time(&bench.client, SDO_SEND_TIMEOUT - 1, &out);
    ck_assert(!co_outbox_take_event(&out, &event));
    co_outbox_init(&out, frames, 2, events, 2);
    sdo_client_on_time(&bench.client, SDO_SEND_TIMEOUT, &out);
    ck_assert_uint_eq(out.frame_count, 0);
    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.detail, SDO_OUTCOME_NOT_SENT);
    ck_assert_uint_eq(sdo_client_deadline(&bench.client), CO_NEVER);
}
END_TEST

/* Before the request has found room nothing can be its answer, but the server may give up. */
START_TEST(test_answer_to_unsent)
{
    struct co_frame frames[2], answer = talk_frame("585#4300100091010F00");
    struct co_frame refusal = talk_frame("585#8000100000000206");
    struct co_event events[2], event;
    struct co_outbox out;
    struct client_bench bench;

    client_bench_init(&bench);
    co_outbox_init(&out, frames, 0, events, 2);
    client_bench_start(&bench, "read 1000:00 4", 0, &out);
    sdo_client_on_frame(&bench.client, &answer, 1, &out);
    ck_assert_uint_eq(bench.client.late, 1);
    ck_assert(sdo_client_busy(&bench.client));
    sdo_client_on_frame(&bench.client, &refusal, 1, &out);
    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.detail, SDO_OUTCOME_ABORTED);
}
END_TEST

/* Frames that are nearly right get far. */
static struct co_frame garbage(const struct client_bench *self, uint64_t *seed)
{
    struct co_frame frame = co_frame_make(SDO_RESPONSE_ID + BENCH_NODE, 8);

    if (noise(seed) % 8 == 0)
        frame.id = SDO_REQUEST_ID + BENCH_NODE;
    if (noise(seed) % 8 == 0)
        frame.dlc = (uint8_t)(noise(seed) % 9);
    frame.flags = noise(seed) % 8 == 0 ? (uint8_t)(noise(seed) % 8) : 0;
    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = (uint8_t)noise(seed);
    if (noise(seed) % 4 != 0) {
        frame.data[1] = (uint8_t)self->transfer.index;
        frame.data[2] = (uint8_t)(self->transfer.index >> 8);
        frame.data[3] = self->transfer.sub;
    }
    if (noise(seed) % 2) /* sizes of some bytes, not of gigabytes */
        frame.data[5] = frame.data[6] = frame.data[7] = 0;
    return frame;
}

static void start_any(struct client_bench *self, uint64_t *seed, co_us_t now, struct co_outbox *out)
{
    char text[32];

    if (noise(seed) % 2)
        snprintf(text, sizeof text, "read 2000:%02x %u", noise(seed) % 4, noise(seed) % 40);
    else
        snprintf(text, sizeof text, "write 2000:%02x %.*s", noise(seed) % 4,
                 (int)(2 * (1 + noise(seed) % 8)), "0102030405060708");
    client_bench_start(self, text, now, out);
}

static void count_ends(struct client_bench *self, struct co_outbox *out)
{
    char text[700];
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(out, &frame)) {
        if (frame.dlc != 8 || frame.id != SDO_REQUEST_ID + BENCH_NODE)
            ck_abort_msg("a frame that is no request");
    }
    while (co_outbox_take_event(out, &event))
        client_bench_describe(self, &event, text, sizeof text);
    if (self->starts != self->ends + sdo_client_busy(&self->client))
        ck_abort_msg("%u starts, %u ends", self->starts, self->ends);
}

START_TEST(test_garbage)
{
    uint64_t seed = (uint64_t)_i + 1;
    struct co_frame frames[4];
    struct co_event events[4];
    struct co_outbox out;
    struct client_bench bench;
    co_us_t now = 0;

    client_bench_init(&bench);
    for (unsigned i = 0; i < 4000; i++) {
        struct co_frame frame = garbage(&bench, &seed);

        co_outbox_init(&out, frames, noise(&seed) % 3, events, noise(&seed) % 3);
        if (!sdo_client_busy(&bench.client))
            start_any(&bench, &seed, now, &out);
        sdo_client_on_frame(&bench.client, &frame, now, &out);
        now += noise(&seed) % 64 ? 1000 : CO_MS(100);
        sdo_client_on_time(&bench.client, now, &out);
        count_ends(&bench, &out);
    }
    ck_assert_uint_gt(bench.ends, 200);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_client_time");
    TCase *tcase = tcase_create("sdo_client_time");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    tcase_add_test(tcase, test_cancel_after_end);
    tcase_add_test(tcase, test_unsent_expires);
    tcase_add_test(tcase, test_answer_to_unsent);
    tcase_add_loop_test(tcase, test_garbage, 0, 8);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* SDO server: time-outs, verdicts, interrupted transfers, silence, no room, and garbage. */
#include "base/bytes.h"
#include "proto/event.h"
#include "support/hex.h"
#include "support/server_bench.h"

#include <check.h>

/* clang-format off */
static const struct talk talks[] = {
    { "K29: the client aborts an upload", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#8008100000000405" },
        { 1, IDLE, NULL },
        { 2, GOT,  "605#6000000000000000" },
        { 2, SENT, "585#8008100001000405" },
        { 3, GOT,  "605#4000100000000000" },
        { 3, SENT, "585#4300100091010F00" } } },
    { "the client aborts a download, or nothing", {
        { 0, GOT,  "605#2117100002000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#8017100000000405" },
        { 1, IDLE, NULL },
        { 2, GOT,  "605#8017100000000405" },
        { 2, GOT,  "605#0BE8030000000000" },
        { 2, SENT, "585#8017100001000405" },
        { 2, CALL, "value 1017:00 0000" } } },
    { "K30: frames of other lengths and kinds", {
        { 0, GOT,  "605#40001000000000" },
        { 0, GOT,  "605#" },
        { 0, GOT,  "605#R8" },
        { 0, GOT,  "00000605#4000100000000000" },
        { 0, GOT,  "606#4000100000000000" },
        { 0, GOT,  "585#4000100000000000" },
        { 9, IDLE, NULL } } },
    { "K31: another request ends an upload and is served", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#0043414E6F70656E" },
        { 2, GOT,  "605#4008100000000000" },
        { 2, SENT, "585#4108100010000000" },
        { 3, GOT,  "605#6000000000000000" },
        { 3, SENT, "585#0043414E6F70656E" },
        { 4, GOT,  "605#4000100000000000" },
        { 4, SENT, "585#4300100091010F00" },
        { 9, IDLE, NULL } } },
    { "K31: another request ends a download and is served", {
        { 0, GOT,  "605#2103200008000000" },
        { 0, SENT, "585#6003200000000000" },
        { 1, GOT,  "605#0001020304050607" },
        { 1, SENT, "585#2000000000000000" },
        { 2, GOT,  "605#2117100002000000" },
        { 2, SENT, "585#6017100000000000" },
        { 3, GOT,  "605#0BE8030000000000" },
        { 3, TOLD, "write 1017:00 E803" },
        { 3, CALL, "verdict 0" },
        { 3, SENT, "585#2000000000000000" },
        { 3, CALL, "value 2003:00 0000000000000000" } } },
    { "a request that is refused ends the transfer as well", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#4004100000000000" },
        { 1, SENT, "585#8004100000000206" },
        { 1, IDLE, NULL } } },
    { "K32: no segment request in time", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 600, GOT,  "605#6000000000000000" },
        { 600, SENT, "585#0043414E6F70656E" },
        { 1599, QUIET, NULL },
        { 1600, SENT, "585#8008100000000405" },
        { 1600, IDLE, NULL },
        { 1601, GOT,  "605#4000100000000000" },
        { 1601, SENT, "585#4300100091010F00" } } },
    { "K32: no segment in time", {
        { 0, GOT,  "605#2103200008000000" },
        { 0, SENT, "585#6003200000000000" },
        { 600, GOT,  "605#0001020304050607" },
        { 600, SENT, "585#2000000000000000" },
        { 1599, QUIET, NULL },
        { 1600, SENT, "585#8003200000000405" },
        { 1600, IDLE, NULL } } },
    { "a segment at the last moment", {
        { 0, GOT,  "605#2117100002000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1000, GOT,  "605#0BE8030000000000" },
        { 1000, TOLD, "write 1017:00 E803" },
        { 1000, CALL, "verdict 0" },
        { 1000, SENT, "585#2000000000000000" } } },
    /* verdicts */
    { "the owner refuses", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 5, CALL, "verdict 08000022" },
        { 5, SENT, "585#8017100022000008" },
        { 5, IDLE, NULL },
        { 6, CALL, "value 1017:00 0000" },
        { 7, GOT,  "605#2117100002000000" },
        { 7, SENT, "585#6017100000000000" },
        { 8, GOT,  "605#0BE8030000000000" },
        { 8, TOLD, "write 1017:00 E803" },
        { 9, CALL, "verdict 06060000" },
        { 9, SENT, "585#8017100000000606" } } },
    { "the verdict does not come in time", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 999, QUIET, NULL },
        { 1000, SENT, "585#8017100020000008" },
        { 1001, CALL, "verdict 08000022" },
        { 2000, IDLE, NULL } } },
    { "a verdict at the deadline is too late", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 1000, CALL, "verdict 08000022" },
        { 1000, SENT, "585#8017100020000008" } } },
    { "a verdict that nobody asked for", {
        { 0, CALL, "verdict 08000022" },
        { 1, GOT,  "605#2117100002000000" },
        { 1, SENT, "585#6017100000000000" },
        { 2, CALL, "verdict 08000022" },
        { 3, QUIET, NULL } } },
    { "the client aborts while the verdict is out", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 1, GOT,  "605#8017100000000405" },
        { 1, IDLE, NULL },
        { 2, CALL, "verdict 08000022" },
        { 9, IDLE, NULL } } },
    { "another request while the verdict is out", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 1, GOT,  "605#4000100000000000" },
        { 1, SENT, "585#4300100091010F00" },
        { 2, CALL, "verdict 08000022" },
        { 9, IDLE, NULL } } },
    { "another write while the verdict is out", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 1, GOT,  "605#2F19100007000000" },
        { 1, TOLD, "write 1019:00 07" },
        { 2, CALL, "verdict 0" },
        { 2, SENT, "585#6019100000000000" },
        { 2, CALL, "value 1019:00 07" },
        { 2, CALL, "value 1017:00 0000" } } },
    { "a segment while the verdict is out", {
        { 0, GOT,  "605#2117100002000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#0BE8030000000000" },
        { 1, TOLD, "write 1017:00 E803" },
        { 2, GOT,  "605#1BE8030000000000" },
        { 2, SENT, "585#8017100001000405" },
        { 2, IDLE, NULL } } },
    /* NMT state */
    { "disabled: no answer, the transfer is dropped", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, CALL, "disable" },
        { 1, IDLE, NULL },
        { 2, GOT,  "605#6000000000000000" },
        { 2, GOT,  "605#4000100000000000" },
        { 5, IDLE, NULL },
        { 6, CALL, "enable" },
        { 7, GOT,  "605#6000000000000000" },
        { 7, SENT, "585#8008100001000405" },
        { 8, GOT,  "605#4000100000000000" },
        { 8, SENT, "585#4300100091010F00" } } },
    { "disabled while the verdict is out", {
        { 0, GOT,  "605#2B171000E8030000" },
        { 0, TOLD, "write 1017:00 E803" },
        { 1, CALL, "disable" },
        { 2, CALL, "verdict 08000022" },
        { 9, IDLE, NULL } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    server_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* More bytes than the buffer holds, in segments, without a size in advance. */
START_TEST(test_buffer_too_small)
{
    struct server_bench bench;
    struct co_frame frames[2], frame = talk_frame("605#2000200000000000");
    struct co_event events[1];
    struct co_outbox out;
    char text[CO_FRAME_TEXT_SIZE];
    unsigned segments = 0;

    server_bench_init(&bench);
    co_outbox_init(&out, frames, 2, events, 1);
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    for (; co_outbox_take_frame(&out, &frame) && frame.data[0] != 0x80; segments++) {
        frame = talk_frame(segments % 2 ? "605#1001020304050607" : "605#0001020304050607");
        sdo_server_on_frame(&bench.server, &frame, 0, &out);
    }
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "585#8000200005000405");
    ck_assert_uint_eq(segments, BENCH_CAPACITY / 7 + 1);
    server_bench_done(&bench);
}
END_TEST

/* A verdict whose answer waits for room is gone when the client asks for something else. */
START_TEST(test_unsent_verdict)
{
    struct server_bench bench;
    struct co_frame frames[2], write = talk_frame("605#2B171000E8030000");
    struct co_frame frame = talk_frame("605#4008100000000000");
    struct co_event events[1];
    struct co_outbox out;

    server_bench_init(&bench);
    co_outbox_init(&out, frames, 2, events, 1);
    sdo_server_on_frame(&bench.server, &write, 0, &out);
    co_outbox_init(&out, frames, 0, events, 1);
    sdo_server_verdict(&bench.server, SDO_GENERAL, 0, &out);
    ck_assert_uint_eq(sdo_server_deadline(&bench.server), 0);
    sdo_server_on_time(&bench.server, 0, &out);
    co_outbox_init(&out, frames, 2, events, 1);
    sdo_server_on_frame(&bench.server, &frame, 1, &out);
    ck_assert_uint_eq(sdo_server_deadline(&bench.server), 1 + SDO_SERVER_TIMEOUT);
    sdo_server_on_time(&bench.server, 1, &out);
    ck_assert_uint_eq(out.frame_count, 1);
    ck_assert_uint_eq(frames[0].data[0], 0x41);
    server_bench_done(&bench);
}
END_TEST

START_TEST(test_no_room_is_counted)
{
    struct server_bench bench;
    struct co_frame frames[1], frame = talk_frame("605#4000100000000000");
    struct co_event events[1];
    struct co_outbox out;

    server_bench_init(&bench);
    co_outbox_init(&out, frames, 0, events, 1);
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    ck_assert_uint_eq(bench.server.dropped, 1);
    frame = talk_frame("606#4000100000000000");
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    ck_assert_uint_eq(bench.server.dropped, 1);
    server_bench_done(&bench);
}
END_TEST

static void garbage_block(const struct server_bench *self, uint64_t *seed, uint8_t *data)
{
    const struct sdo_server *server = &self->server;

    if (server->state == SDO_SERVER_BLOCK_UP_START) {
        data[0] = BLOCK_START;
    } else if (server->state == SDO_SERVER_BLOCK_UP) {
        data[0] = BLOCK_ACK;
        data[1] = (uint8_t)(noise(seed) % 8 ? server->sender.sent : noise(seed) % 9);
        data[2] = (uint8_t)(noise(seed) % 8 + (noise(seed) % 8 != 0));
    } else if (server->state == SDO_SERVER_BLOCK_UP_END) {
        data[0] = BLOCK_END_ANSWER;
    } else if (server->state == SDO_SERVER_BLOCK_DOWN) {
        data[0] = (uint8_t)(server->receiver.in_order + 1 + (noise(seed) % 8 == 0));
        data[0] |= noise(seed) % 4 == 0 ? BLOCK_LAST : 0;
    } else {
        data[0] = (uint8_t)(BLOCK_END | (data[0] & 0x1C));
        put_le16(data + 1, (uint16_t)(server->receiver.crc + (noise(seed) % 8 == 0)));
    }
}

static void continue_transfer(const struct server_bench *self, uint64_t *seed, uint8_t *data)
{
    const unsigned toggle = self->server.toggle ? 0x10 : 0;

    if (self->server.state == SDO_SERVER_DOWN_SEGMENT)
        data[0] = (uint8_t)(toggle | (noise(seed) % 8 == 0 ? noise(seed) % 16 : 0));
    else if (self->server.state == SDO_SERVER_UP_SEGMENT)
        data[0] = (uint8_t)(0x60 | toggle);
    else if (self->server.state >= SDO_SERVER_BLOCK_DOWN)
        garbage_block(self, seed, data);
}

/* Frames that are nearly right get far. */
static struct co_frame garbage(const struct server_bench *self, uint64_t *seed)
{
    static const uint16_t objects[] = { 0x1000, 0x1008, 0x1017, 0x1019, 0x2000, 0x2002,
                                        0x2003, 0x2005, 0x2008, 0x1F50, 0x3000, 0x2009 };
    struct co_frame frame = co_frame_make(0x605, 8);

    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = (uint8_t)noise(seed);
    if (noise(seed) % 16 == 0)
        frame.dlc = (uint8_t)(noise(seed) % 9);
    if (noise(seed) % 4 != 0) {
        put_le16(frame.data + 1, objects[noise(seed) % (sizeof objects / sizeof objects[0])]);
        frame.data[3] = noise(seed) % 8 == 0;
    }
    if (noise(seed) % 2) /* sizes of some bytes, not of gigabytes */
        frame.data[5] = frame.data[6] = frame.data[7] = 0;
    if (self->server.state != SDO_SERVER_IDLE && noise(seed) % 16)
        continue_transfer(self, seed, frame.data);
    return frame;
}

struct tally {
    unsigned requests, responses, writes, verdicts, reads, blocks;
};

static void check_output(struct server_bench *self, struct co_outbox *out, struct tally *tally)
{
    struct co_frame frame;
    struct co_event event;

    for (; co_outbox_take_frame(out, &frame); tally->responses++) {
        if (frame.id != 0x585 || frame.dlc != 8)
            ck_abort_msg("a frame that is no response");
    }
    while (co_outbox_take_event(out, &event)) {
        const struct od_entry *entry = od_find(&self->od, event.index, event.sub);

        tally->writes += event.type == PROTO_SDO_WRITE;
        tally->reads += event.type == PROTO_SDO_READ;
        if (event.type == PROTO_SDO_READ)
            continue;
        if (event.type != PROTO_SDO_WRITE || !entry || event.actual > BENCH_CAPACITY ||
            od_check_value(entry, sdo_server_value(&self->server), (uint32_t)event.actual))
            ck_abort_msg("a write that is not valid");
    }
    if ((self->server.state == SDO_SERVER_IDLE) != (sdo_server_deadline(&self->server) == CO_NEVER))
        ck_abort_msg("a deadline without a transfer, or a transfer without a deadline");
}

/* The owner has its say, or not. */
static void decide(struct server_bench *self, uint64_t *seed, struct co_outbox *out, co_us_t now,
                   struct tally *tally)
{
    const sdo_abort_t code = noise(seed) % 2 ? SDO_OK : SDO_GENERAL;
    const uint8_t bytes[64] = { 1, 2, 3 };

    if (noise(seed) % 2)
        return;
    tally->verdicts += self->server.state == SDO_SERVER_VERDICT;
    sdo_server_verdict(&self->server, code, now, out);
    sdo_server_give(&self->server, code, bytes, noise(seed) % sizeof bytes, now, out);
}

START_TEST(test_garbage)
{
    uint64_t seed = (uint64_t)_i + 1;
    struct server_bench bench;
    struct co_frame frames[4];
    struct co_event events[4];
    struct co_outbox out;
    struct tally tally = { .requests = 0 };
    co_us_t now = 0;

    server_bench_init(&bench);
    bench.server.block = true;
    bench.server.block_limit = 5;
    for (; tally.requests < 20000; tally.requests++) {
        struct co_frame frame = garbage(&bench, &seed);

        co_outbox_init(&out, frames, noise(&seed) % 8 ? 4 : 0, events, noise(&seed) % 8 ? 4 : 0);
        sdo_server_on_frame(&bench.server, &frame, now, &out);
        tally.blocks += bench.server.form == SDO_SERVER_BLOCK &&
                        (bench.server.state == SDO_SERVER_VERDICT ||
                         bench.server.state == SDO_SERVER_BLOCK_UP_END);
        decide(&bench, &seed, &out, now, &tally);
        check_output(&bench, &out, &tally);
        now += noise(&seed) % 64 ? 1000 : CO_MS(400);
        sdo_server_on_time(&bench.server, now, &out);
        check_output(&bench, &out, &tally);
    }
    ck_assert_uint_gt(tally.responses, 1000);
    ck_assert_uint_gt(tally.writes, 100);
    ck_assert_uint_gt(tally.verdicts, 50);
    ck_assert_uint_gt(tally.reads, 50);
    ck_assert_uint_gt(tally.blocks, 50);
    server_bench_done(&bench);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_server_time");
    TCase *tcase = tcase_create("sdo_server_time");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    tcase_add_test(tcase, test_buffer_too_small);
    tcase_add_test(tcase, test_unsent_verdict);
    tcase_add_test(tcase, test_no_room_is_counted);
    tcase_add_loop_test(tcase, test_garbage, 0, 8);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* SDO client: block downloads. The time-out is 200 ms. */
#include "support/client_bench.h"
#include "support/suite.h"

#include <check.h>

/* clang-format off */
#define WRITE_2000 { 0, CALL, "blocks of 4" },                                  \
                   { 0, CALL, "write 2000:00 43414E6F70656E44656D6F5049433332" }, \
                   { 0, SENT, "605#C600200010000000" },                         \
                   { 0, ECHO, NULL }
#define SEGMENTS(at) { at, SENT, "605#0143414E6F70656E" }, \
                     { at, SENT, "605#0244656D6F504943" }, \
                     { at, SENT, "605#8333320000000000" }
static const struct talk talks[] = {
    { "with a checksum", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 1, ECHO, NULL },
        { 2, GOT,  "585#A203040000000000" },
        { 2, SENT, "605#D5F3430000000000" },
        { 2, ECHO, NULL },
        { 3, GOT,  "585#A100000000000000" },
        { 3, TOLD, "ok 00000000 16" },
        { 3, IDLE, NULL } } },
    { "without a checksum", {
        WRITE_2000,
        { 1, GOT,  "585#A000200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A203040000000000" },
        { 2, SENT, "605#D500000000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, TOLD, "ok 00000000 16" } } },
    { "without a size, and of few bytes", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "write- 1017:00 E803" },
        { 0, SENT, "605#C417100000000000" },
        { 1, GOT,  "585#A417100004000000" },
        { 1, SENT, "605#81E8030000000000" },
        { 2, GOT,  "585#A201040000000000" },
        { 2, SENT, "605#D578A90000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, TOLD, "ok 00000000 2" } } },
    { "of nothing", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "write 2000:00 -" },
        { 0, SENT, "605#C600200000000000" },
        { 1, GOT,  "585#A400200004000000" },
        { 1, SENT, "605#8100000000000000" },
        { 2, GOT,  "585#A201040000000000" },
        { 2, SENT, "605#DD00000000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, TOLD, "ok 00000000 0" } } },
    { "in sub-blocks of one, two and 127", {
        WRITE_2000,
        { 1, GOT,  "585#A400200001000000" },
        { 1, SENT, "605#0143414E6F70656E" },
        { 2, GOT,  "585#A201010000000000" },
        { 2, SENT, "605#0144656D6F504943" },
        { 3, GOT,  "585#A2017F0000000000" },
        { 3, SENT, "605#8133320000000000" },
        { 4, GOT,  "585#A201020000000000" },
        { 4, SENT, "605#D5F3430000000000" },
        { 5, GOT,  "585#A100000000000000" },
        { 5, TOLD, "ok 00000000 16" } } },
    { "all of a sub-block again, then its rest", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A200030000000000" },
        SEGMENTS(2),
        { 3, GOT,  "585#A202040000000000" },
        { 3, SENT, "605#8133320000000000" },
        { 4, GOT,  "585#A201040000000000" },
        { 4, SENT, "605#D5F3430000000000" },
        { 5, GOT,  "585#A100000000000000" },
        { 5, TOLD, "ok 00000000 16" } } },
    /* what is wrong with the answers */
    { "no such block size", {
        WRITE_2000,
        { 1, GOT,  "585#A400200000000000" },
        { 1, SENT, "605#8000200002000405" },
        { 1, TOLD, "protocol 05040002 0" },
        { 2, CALL, "write 2000:00 -" },
        { 2, SENT, "605#C600200000000000" },
        { 3, GOT,  "585#A400200080000000" },
        { 3, SENT, "605#8000200002000405" },
        { 3, TOLD, "protocol 05040002 0" } } },
    { "no such block size for what is to come", {
        WRITE_2000,
        { 1, GOT,  "585#A400200001000000" },
        { 1, SENT, "605#0143414E6F70656E" },
        { 2, GOT,  "585#A201800000000000" },
        { 2, SENT, "605#8000200002000405" },
        { 2, TOLD, "protocol 05040002 0" } } },
    { "more segments received than sent", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A204040000000000" },
        { 2, SENT, "605#8000200003000405" },
        { 2, TOLD, "protocol 05040003 0" },
        { 2, IDLE, NULL } } },
    { "the end too early", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A100000000000000" },
        { 2, SENT, "605#8000200001000405" },
        { 2, TOLD, "protocol 05040001 0" } } },
    { "another answer at the end", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A203040000000000" },
        { 2, SENT, "605#D5F3430000000000" },
        { 3, GOT,  "585#A203040000000000" },
        { 3, SENT, "605#8000200001000405" },
        { 3, TOLD, "protocol 05040001 16" } } },
    { "an answer as if there were no blocks", {
        WRITE_2000,
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#8000200001000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "late and short answers", {
        WRITE_2000,
        { 1, GOT,  "585#A4002000" },
        { 1, GOT,  "585#A400100004000000" },
        { 1, CALL, "late 2" },
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#6000100000000000" },
        { 2, GOT,  "585#A203" },
        { 2, GOT,  "585#8000100020000008" },
        { 2, CALL, "late 5" },
        { 2, GOT,  "585#A203040000000000" },
        { 2, SENT, "605#D5F3430000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, TOLD, "ok 00000000 16" } } },
    { "cancelled before the first answer: the server would take a request for a segment", {
        WRITE_2000,
        { 1, CALL, "cancel 08000022" },
        { 1, SENT, "605#8000200022000008" },
        { 1, TOLD, "cancelled 08000022 0" },
        { 2, CALL, "write 1000:00 4142" },
        { 2, SENT, "605#C600100002000000" },
        { 3, GOT,  "585#A400200004000000" },
        { 3, GOT,  "585#A400100004000000" },
        { 3, SENT, "605#8141420000000000" },
        { 4, GOT,  "585#A201040000000000" },
        { 4, SENT, "605#D57B560000000000" },
        { 5, GOT,  "585#A100000000000000" },
        { 5, TOLD, "ok 00000000 2" } } },
    { "answers that the server owes to the transfer before", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, CALL, "cancel 08000020" },
        { 2, SENT, "605#8000200020000008" },
        { 2, TOLD, "cancelled 08000020 0" },
        { 3, CALL, "write 1000:00 4142" },
        { 3, SENT, "605#C600100002000000" },
        { 3, GOT,  "585#A200100000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, CALL, "late 2" },
        { 4, GOT,  "585#8000100002000106" },
        { 4, TOLD, "aborted 06010002 0" } } },
    { "the server aborts", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#8000200005000405" },
        { 2, TOLD, "aborted 05040005 0" },
        { 3, CALL, "write 1017:00 E803" },
        { 3, SENT, "605#C617100002000000" },
        { 4, GOT,  "585#A417100004000000" },
        { 4, SENT, "605#81E8030000000000" },
        { 5, GOT,  "585#A201040000000000" },
        { 5, SENT, "605#D578A90000000000" },
        { 6, GOT,  "585#8017100004000405" },
        { 6, TOLD, "aborted 05040004 2" } } },
    /* time */
    { "no answer to the initiate", {
        WRITE_2000,
        { 199, QUIET, NULL },
        { 200, SENT, "605#8000200000000405" },
        { 200, TOLD, "no answer 05040000 0" } } },
    { "no answer to the segments; the way of the last one counts", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 700, ECHO, "605#0143414E6F70656E" },
        { 800, ECHO, "605#0244656D6F504943" },
        { 900, ECHO, "605#8333320000000000" },
        { 1099, QUIET, NULL },
        { 1100, SENT, "605#8000200000000405" },
        { 1100, TOLD, "no answer 05040000 0" } } },
    { "the segments do not get on the wire", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2000, QUIET, NULL },
        { 2001, TOLD, "not sent 00000000 0" },
        { 2001, IDLE, NULL } } },
    { "segments handed over instead of seen: with the time that they may take", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, CALL, "handed over" },
        { 50, CALL, "handed over" },
        { 243, QUIET, NULL },
        { 244, SENT, "605#8000200000000405" },
        { 244, TOLD, "no answer 05040000 0" } } },
    { "no answer to the end", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#A203040000000000" },
        { 2, SENT, "605#D5F3430000000000" },
        { 2, ECHO, NULL },
        { 201, QUIET, NULL },
        { 202, SENT, "605#8000200000000405" },
        { 202, TOLD, "no answer 05040000 16" } } },
    /* servers without blocks */
    { "blocks refused: in segments", {
        WRITE_2000,
        { 1, GOT,  "585#8000200001000405" },
        { 1, SENT, "605#2000200000000000" },
        { 2, GOT,  "585#6000200000000000" },
        { 2, SENT, "605#0043414E6F70656E" },
        { 3, GOT,  "585#2000000000000000" },
        { 3, SENT, "605#1044656D6F504943" },
        { 4, GOT,  "585#3000000000000000" },
        { 4, SENT, "605#0B33320000000000" },
        { 5, GOT,  "585#2000000000000000" },
        { 5, TOLD, "ok 00000000 16 no blocks" } } },
    { "blocks refused: expedited", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "write 1017:00 E803" },
        { 0, SENT, "605#C617100002000000" },
        { 1, GOT,  "585#8017100001000405" },
        { 1, SENT, "605#2B171000E8030000" },
        { 2, GOT,  "585#6017100000000000" },
        { 2, TOLD, "ok 00000000 2 no blocks" } } },
    { "nothing is repeated once data was sent", {
        WRITE_2000,
        { 1, GOT,  "585#A400200004000000" },
        SEGMENTS(1),
        { 2, GOT,  "585#8000200001000405" },
        { 2, TOLD, "aborted 05040001 0" },
        { 2, IDLE, NULL } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    client_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

START_TEST(test_what_awaits_the_wire)
{
    struct client_bench bench;
    struct co_frame frames[8], frame;
    struct co_event events[1];
    struct co_outbox out;

    client_bench_init(&bench);
    co_outbox_init(&out, frames, 0, events, 1);
    ck_assert(!sdo_client_awaits_wire(&bench.client));
    bench.block = 4;
    client_bench_start(&bench, "write 2000:00 4142", 0, &out);
    ck_assert(!sdo_client_awaits_wire(&bench.client));
    co_outbox_init(&out, frames, 8, events, 1);
    sdo_client_on_time(&bench.client, 0, &out);
    ck_assert(sdo_client_awaits_wire(&bench.client));
    frame = frames[0];
    frame.flags = CO_FRAME_OWN;
    sdo_client_on_frame(&bench.client, &frame, 1, &out);
    ck_assert(!sdo_client_awaits_wire(&bench.client));
    frame = talk_frame("585#A400200004000000");
    sdo_client_on_frame(&bench.client, &frame, 2, &out);
    ck_assert(sdo_client_awaits_wire(&bench.client));
    ck_assert_uint_eq(sdo_client_deadline(&bench.client), 2 + SDO_SEND_TIMEOUT);
    frame = frames[1];
    frame.flags = CO_FRAME_OWN;
    sdo_client_on_frame(&bench.client, &frame, 3, &out);
    ck_assert(!sdo_client_awaits_wire(&bench.client));
    ck_assert_uint_eq(sdo_client_deadline(&bench.client), 3 + CO_MS(200));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("sdo_client_block_down");

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    tcase_add_test(tcase, test_what_awaits_the_wire);
    return suite_run("sdo_client_block_down", tcase);
}

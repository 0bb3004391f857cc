/* SDO server: bytes that its owner keeps, and channels other than a node's default one. */
#include "base/bytes.h"
#include "support/server_bench.h"

#include <check.h>

/* clang-format off */
static const struct talk talks[] = {
    { "an upload of bytes that the owner has, expedited", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 5, CALL, "give 41424344" },
        { 5, SENT, "585#4309200041424344" },
        { 9, IDLE, NULL } } },
    { "an upload of bytes that the owner has, in segments", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 999, CALL, "give 4142434445464748" },
        { 999, SENT, "585#4109200008000000" },
        { 1000, GOT,  "605#6000000000000000" },
        { 1000, SENT, "585#0041424344454647" },
        { 1001, GOT,  "605#7000000000000000" },
        { 1001, SENT, "585#1D48000000000000" },
        { 1009, IDLE, NULL } } },
    { "the owner has no bytes", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1, CALL, "give -" },
        { 1, SENT, "585#4109200000000000" },
        { 2, GOT,  "605#6000000000000000" },
        { 2, SENT, "585#0F00000000000000" },
        { 9, IDLE, NULL } } },
    { "the owner refuses to give them", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1, CALL, "refuse 08000024" },
        { 1, SENT, "585#8009200024000008" },
        { 1, IDLE, NULL } } },
    { "the owner does not answer", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 999, QUIET, NULL },
        { 1000, SENT, "585#8009200020000008" },
        { 1001, CALL, "give 4142" },
        { 2000, IDLE, NULL } } },
    { "at the deadline the owner is too late", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1000, CALL, "give 4142" },
        { 1000, SENT, "585#8009200020000008" } } },
    { "bytes that nobody asked for", {
        { 0, CALL, "give 4142" },
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, CALL, "give 4142" },
        { 2, QUIET, NULL },
        { 3, GOT,  "605#2F19100007000000" },
        { 3, TOLD, "write 1019:00 07" },
        { 4, CALL, "give 4142" },
        { 4, QUIET, NULL },
        { 5, GOT,  "605#4009200000000000" },
        { 5, TOLD, "read 2009:00" },
        { 5, CALL, "verdict 0" },
        { 6, QUIET, NULL } } },
    { "the client aborts while the owner is asked", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1, GOT,  "605#8009200000000405" },
        { 1, IDLE, NULL },
        { 2, CALL, "give 4142" },
        { 9, IDLE, NULL } } },
    { "another request while the owner is asked", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1, GOT,  "605#4000100000000000" },
        { 1, SENT, "585#4300100091010F00" },
        { 2, CALL, "give 4142" },
        { 9, IDLE, NULL } } },
    { "a segment request while the owner is asked", {
        { 0, GOT,  "605#4009200000000000" },
        { 0, TOLD, "read 2009:00" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#8009200001000405" },
        { 1, IDLE, NULL } } },
    { "a write of bytes that the owner keeps is a write", {
        { 0, GOT,  "605#2309200041424344" },
        { 0, TOLD, "write 2009:00 41424344" },
        { 1, CALL, "verdict 0" },
        { 1, SENT, "585#6009200000000000" } } },
    /* channels */
    { "another channel", {
        { 0, CALL, "channel 640 5C0" },
        { 0, GOT,  "605#4000100000000000" },
        { 1, GOT,  "640#4000100000000000" },
        { 1, SENT, "5C0#4300100091010F00" },
        { 9, IDLE, NULL } } },
    { "another channel ends the transfer", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, CALL, "channel 640 5C0" },
        { 1, IDLE, NULL },
        { 2, GOT,  "640#6000000000000000" },
        { 2, SENT, "5C0#8008100001000405" } } },
    { "a closed channel", {
        { 0, CALL, "channel 0 585" },
        { 0, GOT,  "605#4000100000000000" },
        { 0, GOT,  "000#4000100000000000" },
        { 9, IDLE, NULL } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    server_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

START_TEST(test_node_0_has_no_channel)
{
    struct server_bench bench;
    struct co_frame frames[1], frame = talk_frame("600#4000100000000000");
    struct co_event events[1];
    struct co_outbox out;

    server_bench_init(&bench);
    sdo_server_init(&bench.server, &bench.od, 0, bench.buffer, BENCH_CAPACITY);
    sdo_server_enable(&bench.server, true);
    co_outbox_init(&out, frames, 1, events, 1);
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    frame.id = 0;
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    ck_assert_uint_eq(out.frame_count, 0);
    server_bench_done(&bench);
}
END_TEST

/* What the owner gives is copied, and may be more than there is room for. */
START_TEST(test_given_bytes_are_copied)
{
    uint8_t bytes[BENCH_CAPACITY + 1] = { 1, 2, 3, 4, 5 };
    struct server_bench bench;
    struct co_frame frames[4], frame = talk_frame("605#4009200000000000");
    struct co_event events[4];
    struct co_outbox out;

    server_bench_init(&bench);
    co_outbox_init(&out, frames, 4, events, 4);
    sdo_server_on_frame(&bench.server, &frame, 0, &out);
    sdo_server_give(&bench.server, SDO_OK, bytes, 5, 1, &out);
    bytes[0] = 99;
    ck_assert_uint_eq(frames[0].data[4], 5);
    ck_assert_uint_eq(sdo_server_value(&bench.server)[0], 1);
    sdo_server_on_frame(&bench.server, &frame, 2, &out);
    sdo_server_give(&bench.server, SDO_OK, bytes, sizeof bytes, 3, &out);
    ck_assert_uint_eq(out.frame_count, 2);
    ck_assert_uint_eq(frames[1].data[0], 0x80);
    ck_assert_uint_eq(get_le32(frames[1].data + 4), SDO_NO_MEMORY);
    server_bench_done(&bench);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_server_owner");
    TCase *tcase = tcase_create("sdo_server_owner");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    tcase_add_test(tcase, test_node_0_has_no_channel);
    tcase_add_test(tcase, test_given_bytes_are_copied);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

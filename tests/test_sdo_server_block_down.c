/*
 * SDO server: block downloads. "SDO 23" is that test of the CiA conformance test; "K43" the
 * conformance check. Sub-blocks are of 4 segments, unless said otherwise.
 */
#include "support/server_bench.h"
#include "support/suite.h"

#include <check.h>

/* clang-format off */
#define BLOCKS { 0, CALL, "blocks of 4" }
#define DOWNLOAD_2000 { 0, CALL, "blocks of 4" },           \
                      { 0, GOT,  "605#C400200000000000" },  \
                      { 0, SENT, "585#A400200004000000" }

static const struct talk talks[] = {
    { "SDO 21, K34: without a checksum", {
        BLOCKS,
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D500000000000000" },
        { 2, TOLD, "write 1017:00 E803" },
        { 3, CALL, "verdict 0" },
        { 3, SENT, "585#A100000000000000" },
        { 3, CALL, "value 1017:00 E803" },
        { 3, IDLE, NULL } } },
    { "with a checksum", {
        BLOCKS,
        { 0, GOT,  "605#C617100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D578A90000000000" },
        { 2, TOLD, "write 1017:00 E803" },
        { 2, CALL, "verdict 0" },
        { 2, SENT, "585#A100000000000000" },
        { 2, IDLE, NULL } } },
    { "K36: a wrong checksum", {
        BLOCKS,
        { 0, GOT,  "605#C617100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D578A80000000000" },
        { 2, SENT, "585#8017100004000405" },
        { 2, CALL, "value 1017:00 0000" },
        { 2, IDLE, NULL } } },
    { "the most segments that there are", {
        { 0, CALL, "blocks of 127" },
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#A41710007F000000" } } },
    { "without a size, of more than one sub-block", {
        DOWNLOAD_2000,
        { 0, CALL, "set 2000:00 4142" },
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#0208090A0B0C0D0E" },
        { 1, GOT,  "605#030F101112131415" },
        { 1, GOT,  "605#041617181920FFFF" },
        { 1, SENT, "585#A204040000000000" },
        { 2, GOT,  "605#8122FFFFFFFFFFFF" },
        { 2, SENT, "585#A201040000000000" },
        { 3, GOT,  "605#8000200000000405" },
        { 3, CALL, "value 2000:00 4142" },
        { 3, IDLE, NULL } } },
    { "of nothing", {
        BLOCKS,
        { 0, CALL, "set 2000:00 4142" },
        { 0, GOT,  "605#C600200000000000" },
        { 0, SENT, "585#A400200004000000" },
        { 1, GOT,  "605#8100000000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#DD00000000000000" },
        { 2, TOLD, "write 2000:00 " },
        { 2, CALL, "verdict 0" },
        { 2, SENT, "585#A100000000000000" } } },
    { "an empty segment at the end of others", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#82FFFFFFFFFFFFFF" },
        { 1, SENT, "585#A202040000000000" },
        { 2, GOT,  "605#DDB3260000000000" },
        { 2, TOLD, "write 2000:00 01020304050607" } } },
    { "K43: a segment is missing", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 2, GOT,  "605#0308090A0B0C0D0E" },
        { 3, GOT,  "605#8408090A0B0C0D0E" },
        { 3, SENT, "585#A201040000000000" },
        { 4, GOT,  "605#8108090A0B0C0D0E" },
        { 4, SENT, "585#A201040000000000" },
        { 5, GOT,  "605#C1929B0000000000" },
        { 5, TOLD, "write 2000:00 0102030405060708090A0B0C0D0E" } } },
    { "K44: the first segment is missing", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#02FFFFFFFFFFFFFF" },
        { 2, GOT,  "605#04FFFFFFFFFFFFFF" },
        { 2, SENT, "585#A200040000000000" },
        { 3, GOT,  "605#8141424300000000" },
        { 3, SENT, "585#A201040000000000" },
        { 4, GOT,  "605#D194390000000000" },
        { 4, TOLD, "write 2000:00 414243" } } },
    { "the last segment is missing: an answer after a silence", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 100, GOT,  "605#0208090A0B0C0D0E" },
        { 199, QUIET, NULL },
        { 200, SENT, "585#A202040000000000" },
        { 1199, GOT,  "605#810F000000000000" },
        { 1199, SENT, "585#A201040000000000" },
        { 1200, GOT,  "605#D900000000000000" },
        { 1200, SENT, "585#8000200004000405" } } },
    { "the client was only slow: segments that have crossed the answer", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 101, SENT, "585#A201040000000000" },
        { 102, GOT,  "605#0208090A0B0C0D0E" },
        { 102, GOT,  "605#030F000000000000" },
        { 102, GOT,  "605#0410000000000000" },
        { 103, GOT,  "605#0108090A0B0C0D0E" },
        { 104, GOT,  "605#820F000000000000" },
        { 104, SENT, "585#A202040000000000" } } },
    { "segments that have crossed the answer, and no others", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 101, SENT, "585#A201040000000000" },
        { 102, GOT,  "605#0208090A0B0C0D0E" },
        { 103, GOT,  "605#8308090A0B0C0D0E" },
        { 202, QUIET, NULL },
        { 203, SENT, "585#A200040000000000" },
        { 204, GOT,  "605#8108090A0B0C0D0E" },
        { 204, SENT, "585#A201040000000000" } } },
    { "two silences", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#02FFFFFFFFFFFFFF" },
        { 101, SENT, "585#A200040000000000" },
        { 1100, QUIET, NULL },
        { 1101, SENT, "585#8000200000000405" },
        { 1101, IDLE, NULL } } },
    { "segments twice", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#0208090A0B0C0D0E" },
        { 1, GOT,  "605#01FFFFFFFFFFFFFF" },
        { 1, GOT,  "605#8341424344454647" },
        { 1, SENT, "585#A203040000000000" },
        { 5, QUIET, NULL } } },
    { "other sizes of sub-blocks on the way", {
        DOWNLOAD_2000,
        { 1, CALL, "blocks of 1" },
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#0408090A0B0C0D0E" },
        { 1, SENT, "585#A201010000000000" },
        { 2, CALL, "blocks of 2" },
        { 2, GOT,  "605#0108090A0B0C0D0E" },
        { 2, SENT, "585#A201020000000000" },
        { 3, GOT,  "605#0301020304050607" },
        { 3, SENT, "585#8000200003000405" } } },
    { "no segment has the number 0", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0001020304050607" },
        { 1, SENT, "585#8000200003000405" },
        { 1, IDLE, NULL } } },
    { "or more than there are", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8501020304050607" },
        { 1, SENT, "585#8000200003000405" },
        { 1, IDLE, NULL } } },
    { "the owner refuses", {
        BLOCKS,
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D500000000000000" },
        { 2, TOLD, "write 1017:00 E803" },
        { 3, CALL, "verdict 08000022" },
        { 3, SENT, "585#8017100022000008" },
        { 3, IDLE, NULL } } },
    { "an object that is not there, or not to be written", {
        BLOCKS,
        { 0, GOT,  "605#C604100014000000" },
        { 0, SENT, "585#8004100000000206" },
        { 0, GOT,  "605#C617100114000000" },
        { 0, SENT, "585#8017100111000906" },
        { 0, GOT,  "605#C600100004000000" },
        { 0, SENT, "585#8000100002000106" },
        { 0, IDLE, NULL } } },
    { "a size that the object or the buffer does not have", {
        BLOCKS,
        { 0, GOT,  "605#C617100003000000" },
        { 0, SENT, "585#8017100012000706" },
        { 0, GOT,  "605#C617100001000000" },
        { 0, SENT, "585#8017100013000706" },
        { 0, GOT,  "605#C60020002D010000" },
        { 0, SENT, "585#8000200005000405" },
        { 0, GOT,  "605#C6002000FFFFFFFE" },
        { 0, SENT, "585#8000200012000706" },
        { 0, IDLE, NULL } } },
    { "K46: fewer bytes than told", {
        BLOCKS,
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D900000000000000" },
        { 2, SENT, "585#8017100013000706" },
        { 2, CALL, "value 1017:00 0000" },
        { 2, IDLE, NULL } } },
    { "K46: more bytes than told", {
        BLOCKS,
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#81E8030000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D100000000000000" },
        { 2, SENT, "585#8017100012000706" },
        { 2, CALL, "value 1017:00 0000" },
        { 2, IDLE, NULL } } },
    { "a segment more than told", {
        BLOCKS,
        { 0, GOT,  "605#C205200002000000" },
        { 0, SENT, "585#A405200004000000" },
        { 1, GOT,  "605#0141424344454647" },
        { 1, GOT,  "605#0248000000000000" },
        { 1, SENT, "585#8005200012000706" },
        { 1, IDLE, NULL } } },
    { "more bytes than the object has, no size told", {
        BLOCKS,
        { 0, GOT,  "605#C005200000000000" },
        { 0, SENT, "585#A405200004000000" },
        { 1, GOT,  "605#0141424344454647" },
        { 1, GOT,  "605#8248000000000000" },
        { 1, SENT, "585#A202040000000000" },
        { 2, GOT,  "605#D500000000000000" },
        { 2, SENT, "585#8005200012000706" },
        { 2, IDLE, NULL } } },
    { "fewer bytes than the object has, no size told", {
        BLOCKS,
        { 0, GOT,  "605#C017100000000000" },
        { 0, SENT, "585#A417100004000000" },
        { 1, GOT,  "605#8141000000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D900000000000000" },
        { 2, SENT, "585#8017100013000706" },
        { 2, IDLE, NULL } } },
    { "a limit is checked at the end", {
        BLOCKS,
        { 0, GOT,  "605#C204200002000000" },
        { 0, SENT, "585#A404200004000000" },
        { 1, GOT,  "605#8165000000000000" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#D500000000000000" },
        { 2, SENT, "585#8004200031000906" } } },
    /* ends */
    { "K47: the client aborts among segments", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 2, GOT,  "605#8000200000000405" },
        { 2, IDLE, NULL },
        { 3, GOT,  "605#0208090A0B0C0D0E" },
        { 3, SENT, "585#8000200001000405" } } },
    { "the client aborts before the end", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8101020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#8000200000000405" },
        { 2, IDLE, NULL } } },
    { "all but the abort is a segment: 81h is no abort, 40h no request", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8100200000000405" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#C1EF7A0000000000" },
        { 2, SENT, "585#8000200004000405" },
        { 3, GOT,  "605#C400200000000000" },
        { 3, SENT, "585#A400200004000000" },
        { 4, GOT,  "605#4000100000000000" },
        { 4, SENT, "585#8000200003000405" } } },
    { "a segment instead of the end", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8101020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#0101020304050607" },
        { 2, SENT, "585#8000200001000405" },
        { 2, IDLE, NULL } } },
    { "another request is served before the end", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8101020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#C600200001000000" },
        { 2, SENT, "585#A400200004000000" },
        { 3, GOT,  "605#8141FFFFFFFFFFFF" },
        { 3, SENT, "585#A201040000000000" },
        { 4, GOT,  "605#D9E5580000000000" },
        { 4, TOLD, "write 2000:00 41" },
        { 5, GOT,  "605#4000100000000000" },
        { 5, SENT, "585#4300100091010F00" },
        { 6, CALL, "verdict 0" },
        { 6, IDLE, NULL } } },
    { "no segment in time", {
        DOWNLOAD_2000,
        { 999, QUIET, NULL },
        { 1000, SENT, "585#8000200000000405" },
        { 1000, IDLE, NULL } } },
    { "no segment of the next sub-block in time", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 1, GOT,  "605#0401020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 1000, QUIET, NULL },
        { 1001, SENT, "585#8000200000000405" },
        { 1001, IDLE, NULL } } },
    { "no end in time", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8101020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 1000, QUIET, NULL },
        { 1001, SENT, "585#8000200000000405" },
        { 1001, IDLE, NULL } } },
    { "no verdict in time", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#8101020304050607" },
        { 1, SENT, "585#A201040000000000" },
        { 2, GOT,  "605#C1B3260000000000" },
        { 2, TOLD, "write 2000:00 01020304050607" },
        { 1001, QUIET, NULL },
        { 1002, SENT, "585#8000200020000008" },
        { 1002, IDLE, NULL } } },
    { "disabled", {
        DOWNLOAD_2000,
        { 1, GOT,  "605#0101020304050607" },
        { 2, CALL, "disable" },
        { 2, IDLE, NULL },
        { 3, GOT,  "605#0208090A0B0C0D0E" },
        { 4, CALL, "enable" },
        { 4, GOT,  "605#0208090A0B0C0D0E" },
        { 4, SENT, "585#8000200001000405" } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    server_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("sdo_server_block_down");

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    return suite_run("sdo_server_block_down", tcase);
}

/*
 * SDO server: block uploads. "SDO 23" is that test of the CiA conformance test; "K43" the
 * conformance check.
 */
#include "support/server_bench.h"
#include "support/suite.h"

#include <check.h>

/* clang-format off */
#define BLOCKS { 0, CALL, "blocks of 4" }
#define UPLOAD_1008 { 0, CALL, "blocks of 4" },             \
                    { 0, GOT,  "605#A408100014000000" },    \
                    { 0, SENT, "585#C608100010000000" }
#define SEGMENTS_1008(at) { at, SENT, "585#0143414E6F70656E" }, \
                          { at, SENT, "585#0244656D6F504943" }, \
                          { at, SENT, "585#8333320000000000" }
static const struct talk talks[] = {
    { "SDO 23, K35: with a checksum", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A203140000000000" },
        { 2, SENT, "585#D5F3430000000000" },
        { 3, GOT,  "605#A100000000000000" },
        { 3, IDLE, NULL } } },
    { "SDO 19, K33: without a checksum", {
        BLOCKS,
        { 0, GOT,  "605#A000100014000000" },
        { 0, SENT, "585#C600100004000000" },
        { 1, GOT,  "605#A300000000000000" },
        { 1, SENT, "585#8191010F00000000" },
        { 2, GOT,  "605#A201140000000000" },
        { 2, SENT, "585#CD00000000000000" },
        { 3, GOT,  "605#A100000000000000" },
        { 3, IDLE, NULL } } },
    { "of nothing", {
        BLOCKS,
        { 0, GOT,  "605#A402200014000000" },
        { 0, SENT, "585#C602200000000000" },
        { 1, GOT,  "605#A300000000000000" },
        { 1, SENT, "585#8100000000000000" },
        { 2, GOT,  "605#A200140000000000" },
        { 2, SENT, "585#8100000000000000" },
        { 3, GOT,  "605#A201140000000000" },
        { 3, SENT, "585#DD00000000000000" },
        { 4, GOT,  "605#A100000000000000" },
        { 4, IDLE, NULL } } },
    { "of whole segments, in sub-blocks of one", {
        BLOCKS,
        { 0, CALL, "set 2000:00 0102030405060708090A0B0C0D0E" },
        { 0, GOT,  "605#A400200001000000" },
        { 0, SENT, "585#C60020000E000000" },
        { 1, GOT,  "605#A300000000000000" },
        { 1, SENT, "585#0101020304050607" },
        { 2, GOT,  "605#A201010000000000" },
        { 2, SENT, "585#8108090A0B0C0D0E" },
        { 3, GOT,  "605#A201010000000000" },
        { 3, SENT, "585#C1929B0000000000" },
        { 4, GOT,  "605#A100000000000000" },
        { 4, IDLE, NULL } } },
    { "K39: all of a sub-block again", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A200140000000000" },
        SEGMENTS_1008(2),
        { 3, GOT,  "605#A200140000000000" },
        SEGMENTS_1008(3),
        { 4, GOT,  "605#A203140000000000" },
        { 4, SENT, "585#D5F3430000000000" },
        { 5, GOT,  "605#A100000000000000" } } },
    { "K40, K41: the rest of a sub-block again, with other sizes", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A201010000000000" },
        { 2, SENT, "585#0144656D6F504943" },
        { 3, GOT,  "605#A2017F0000000000" },
        { 3, SENT, "585#8133320000000000" },
        { 4, GOT,  "605#A201010000000000" },
        { 4, SENT, "585#D5F3430000000000" },
        { 5, GOT,  "605#A100000000000000" },
        { 5, IDLE, NULL } } },
    { "K42: few enough bytes to go without blocks", {
        BLOCKS,
        { 0, GOT,  "605#A400100014040000" },
        { 0, SENT, "585#4300100091010F00" },
        { 0, IDLE, NULL },
        { 1, GOT,  "605#A408100014100000" },
        { 1, SENT, "585#4108100010000000" },
        { 2, GOT,  "605#6000000000000000" },
        { 2, SENT, "585#0043414E6F70656E" },
        { 3, GOT,  "605#A4081000140F0000" },
        { 3, SENT, "585#C608100010000000" },
        { 4, GOT,  "605#A402200014010000" },
        { 4, SENT, "585#4102200000000000" } } },
    { "SDO 26, K37: no such block size", {
        BLOCKS,
        { 0, GOT,  "605#A408100080000000" },
        { 0, SENT, "585#8008100002000405" },
        { 1, GOT,  "605#A408100000000000" },
        { 1, SENT, "585#8008100002000405" },
        { 2, GOT,  "605#A408100014000000" },
        { 2, SENT, "585#C608100010000000" },
        { 3, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(3),
        { 4, GOT,  "605#A203800000000000" },
        { 4, SENT, "585#8008100002000405" },
        { 5, IDLE, NULL } } },
    { "no block size for what is to come", {
        UPLOAD_1008,
        { 3, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(3),
        { 4, GOT,  "605#A202000000000000" },
        { 4, SENT, "585#8008100002000405" },
        { 5, IDLE, NULL } } },
    { "SDO 27: more segments received than sent", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A204140000000000" },
        { 2, SENT, "585#8008100003000405" },
        { 2, IDLE, NULL },
        { 3, GOT,  "605#A203140000000000" },
        { 3, SENT, "585#8008100001000405" } } },
    { "128 segments received", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A280140000000000" },
        { 2, SENT, "585#8008100003000405" },
        { 2, IDLE, NULL } } },
    { "an object that is not there, or not to be read", {
        BLOCKS,
        { 0, GOT,  "605#A404100014000000" },
        { 0, SENT, "585#8004100000000206" },
        { 0, GOT,  "605#A408100114000000" },
        { 0, SENT, "585#8008100111000906" },
        { 0, GOT,  "605#A4501F0180000000" },
        { 0, SENT, "585#80501F0101000106" },
        { 0, GOT,  "605#A408200014000000" },
        { 0, SENT, "585#8008200005000405" },
        { 0, IDLE, NULL } } },
    { "bytes that the owner has", {
        BLOCKS,
        { 0, GOT,  "605#A409200014020000" },
        { 0, TOLD, "read 2009:00" },
        { 9, CALL, "give 4142434445464748" },
        { 9, SENT, "585#C609200008000000" },
        { 10, GOT,  "605#A300000000000000" },
        { 10, SENT, "585#0141424344454647" },
        { 10, SENT, "585#8248000000000000" },
        { 11, GOT,  "605#A202140000000000" },
        { 11, SENT, "585#D9D1100000000000" },
        { 12, GOT,  "605#A100000000000000" },
        { 12, IDLE, NULL },
        { 13, GOT,  "605#A409200014020000" },
        { 13, TOLD, "read 2009:00" },
        { 14, CALL, "give 4142" },
        { 14, SENT, "585#4B09200041420000" } } },
    { "a snapshot", {
        BLOCKS,
        { 0, CALL, "set 2003:00 0101010101010101" },
        { 0, GOT,  "605#A003200014000000" },
        { 0, SENT, "585#C603200008000000" },
        { 1, CALL, "set 2003:00 0202020202020202" },
        { 1, GOT,  "605#A300000000000000" },
        { 1, SENT, "585#0101010101010101" },
        { 1, SENT, "585#8201000000000000" } } },
    /* commands out of place */
    { "answers to segments before there are any", {
        UPLOAD_1008,
        { 1, GOT,  "605#A203140000000000" },
        { 1, SENT, "585#8008100001000405" },
        { 1, IDLE, NULL } } },
    { "the end of an upload that has not begun", {
        UPLOAD_1008,
        { 1, GOT,  "605#A100000000000000" },
        { 1, SENT, "585#8008100001000405" },
        { 1, IDLE, NULL } } },
    { "the end of an upload among segments, and a second start", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A100000000000000" },
        { 2, SENT, "585#8008100001000405" },
        { 2, IDLE, NULL },
        { 3, GOT,  "605#A408100014000000" },
        { 3, SENT, "585#C608100010000000" },
        { 4, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(4),
        { 5, GOT,  "605#A300000000000000" },
        { 5, SENT, "585#8008100001000405" },
        { 5, IDLE, NULL } } },
    { "segments and the end of a download instead", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#C100000000000000" },
        { 2, SENT, "585#8008100001000405" },
        { 2, IDLE, NULL } } },
    { "a segment request instead", {
        UPLOAD_1008,
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#8008100001000405" },
        { 1, IDLE, NULL } } },
    { "an unknown command instead", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#E100000000000000" },
        { 2, SENT, "585#8008100001000405" },
        { 2, IDLE, NULL } } },
    { "block commands without a block transfer", {
        BLOCKS,
        { 0, GOT,  "605#A100000000000000" },
        { 0, SENT, "585#8000000001000405" },
        { 0, GOT,  "605#A203140000000000" },
        { 0, SENT, "585#8000000001000405" },
        { 0, GOT,  "605#A300000000000000" },
        { 0, SENT, "585#8000000001000405" },
        { 0, GOT,  "605#C100000000000000" },
        { 0, SENT, "585#8000000001000405" },
        { 0, IDLE, NULL } } },
    /* ends */
    { "the client aborts before, among and behind the segments", {
        UPLOAD_1008,
        { 1, GOT,  "605#8008100000000405" },
        { 1, IDLE, NULL },
        { 2, GOT,  "605#A408100014000000" },
        { 2, SENT, "585#C608100010000000" },
        { 3, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(3),
        { 4, GOT,  "605#8008100000000405" },
        { 4, IDLE, NULL },
        { 5, GOT,  "605#A408100014000000" },
        { 5, SENT, "585#C608100010000000" },
        { 6, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(6),
        { 7, GOT,  "605#A203140000000000" },
        { 7, SENT, "585#D5F3430000000000" },
        { 8, GOT,  "605#8008100000000405" },
        { 8, IDLE, NULL } } },
    { "another request is served", {
        UPLOAD_1008,
        { 1, GOT,  "605#A408100003000000" },
        { 1, SENT, "585#C608100010000000" },
        { 2, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(2),
        { 3, GOT,  "605#4000100000000000" },
        { 3, SENT, "585#4300100091010F00" },
        { 3, IDLE, NULL } } },
    { "another request is served at the end, too", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A203140000000000" },
        { 2, SENT, "585#D5F3430000000000" },
        { 3, GOT,  "605#2117100002000000" },
        { 3, SENT, "585#6017100000000000" } } },
    { "disabled", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, CALL, "disable" },
        { 2, IDLE, NULL },
        { 3, GOT,  "605#A203140000000000" },
        { 4, CALL, "enable" },
        { 4, GOT,  "605#A203140000000000" },
        { 4, SENT, "585#8008100001000405" } } },
    { "no start in time", {
        UPLOAD_1008,
        { 999, QUIET, NULL },
        { 1000, SENT, "585#8008100000000405" },
        { 1000, IDLE, NULL } } },
    { "no answer to the segments in time, which includes theirs", {
        UPLOAD_1008,
        { 500, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(500),
        { 1541, QUIET, NULL },
        { 1542, SENT, "585#8008100000000405" },
        { 1542, IDLE, NULL } } },
    { "no answer to segments that were sent again", {
        UPLOAD_1008,
        { 0, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(0),
        { 600, GOT,  "605#A202140000000000" },
        { 600, SENT, "585#8133320000000000" },
        { 1613, QUIET, NULL },
        { 1614, SENT, "585#8008100000000405" },
        { 1614, IDLE, NULL } } },
    { "no answer to the end in time", {
        UPLOAD_1008,
        { 1, GOT,  "605#A300000000000000" },
        SEGMENTS_1008(1),
        { 2, GOT,  "605#A203140000000000" },
        { 2, SENT, "585#D5F3430000000000" },
        { 1001, QUIET, NULL },
        { 1002, SENT, "585#8008100000000405" },
        { 1002, IDLE, NULL } } },
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
    TCase *tcase = tcase_create("sdo_server_block_up");

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    return suite_run("sdo_server_block_up", tcase);
}

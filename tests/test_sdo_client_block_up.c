/* SDO client: block uploads. Sub-blocks are of 4 segments, the time-out is 200 ms. */
#include "support/client_bench.h"

#include <check.h>

/* clang-format off */
#define DATA "43414E6F70656E44656D6F5049433332"
#define READ_1008 { 0, CALL, "blocks of 4" },            \
                  { 0, CALL, "read 1008:00 20" },        \
                  { 0, SENT, "605#A408100004000000" },   \
                  { 0, ECHO, NULL },                     \
                  { 1, GOT,  "585#C608100010000000" },   \
                  { 1, SENT, "605#A300000000000000" },   \
                  { 1, ECHO, NULL }
#define SEGMENTS_1008(at) { at, GOT, "585#0143414E6F70656E" }, \
                          { at, GOT, "585#0244656D6F504943" }, \
                          { at, GOT, "585#8333320000000000" }
static const struct talk talks[] = {
    { "with a checksum", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 2, ECHO, NULL },
        { 3, GOT,  "585#D5F3430000000000" },
        { 3, SENT, "605#A100000000000000" },
        { 3, TOLD, "ok 00000000 16 " DATA },
        { 3, IDLE, NULL } } },
    { "without a checksum, and without a size", {
        { 0, CALL, "blocks of 127" },
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#A40010007F000000" },
        { 1, GOT,  "585#C000100000000000" },
        { 1, SENT, "605#A300000000000000" },
        { 2, GOT,  "585#8191010F00FFFFFF" },
        { 2, SENT, "605#A2017F0000000000" },
        { 3, GOT,  "585#CDFFFF0000000000" },
        { 3, SENT, "605#A100000000000000" },
        { 3, TOLD, "ok 00000000 4 91010F00" } } },
    { "of nothing", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 2002:00 0" },
        { 0, SENT, "605#A402200004000000" },
        { 1, GOT,  "585#C602200000000000" },
        { 1, SENT, "605#A300000000000000" },
        { 2, GOT,  "585#8100000000000000" },
        { 2, SENT, "605#A201040000000000" },
        { 3, GOT,  "585#DD00000000000000" },
        { 3, SENT, "605#A100000000000000" },
        { 3, TOLD, "ok 00000000 0 " } } },
    { "of more than one sub-block", {
        { 0, CALL, "blocks of 1" },
        { 0, CALL, "read 1008:00 14" },
        { 0, SENT, "605#A408100001000000" },
        { 1, GOT,  "585#C20810000E000000" },
        { 1, SENT, "605#A300000000000000" },
        { 2, GOT,  "585#0101020304050607" },
        { 2, SENT, "605#A201010000000000" },
        { 3, GOT,  "585#8108090A0B0C0D0E" },
        { 3, SENT, "605#A201010000000000" },
        { 4, GOT,  "585#C100000000000000" },
        { 4, SENT, "605#A100000000000000" },
        { 4, TOLD, "ok 00000000 14 0102030405060708090A0B0C0D0E" } } },
    { "a segment is missing", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, GOT,  "585#8333320000000000" },
        { 2, SENT, "605#A201040000000000" },
        { 3, GOT,  "585#0144656D6F504943" },
        { 3, GOT,  "585#8233320000000000" },
        { 3, SENT, "605#A202040000000000" },
        { 4, GOT,  "585#D5F3430000000000" },
        { 4, SENT, "605#A100000000000000" },
        { 4, TOLD, "ok 00000000 16 " DATA } } },
    { "the first segment is missing", {
        READ_1008,
        { 2, GOT,  "585#0244656D6F504943" },
        { 2, GOT,  "585#8333320000000000" },
        { 2, SENT, "605#A200040000000000" },
        SEGMENTS_1008(3),
        { 3, SENT, "605#A203040000000000" } ,
        { 4, CALL, "cancel 08000020" },
        { 4, SENT, "605#8008100020000008" },
        { 4, TOLD, "cancelled 08000020 14" } } },
    { "the last segment is missing: an answer after half the time-out", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 50, GOT,  "585#0244656D6F504943" },
        { 149, QUIET, NULL },
        { 150, SENT, "605#A202040000000000" },
        { 150, ECHO, NULL },
        { 349, GOT,  "585#8133320000000000" },
        { 349, SENT, "605#A201040000000000" },
        { 350, GOT,  "585#D5F3430000000000" },
        { 350, SENT, "605#A100000000000000" },
        { 350, TOLD, "ok 00000000 16 " DATA } } },
    { "segments twice", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, GOT,  "585#0244656D6F504943" },
        { 2, GOT,  "585#01FFFFFFFFFFFFFF" },
        { 2, GOT,  "585#8333320000000000" },
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D5F3430000000000" },
        { 3, SENT, "605#A100000000000000" },
        { 3, TOLD, "ok 00000000 16 " DATA } } },
    { "the server prefers to go without blocks", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#A400100004000000" },
        { 1, GOT,  "585#4300100091010F00" },
        { 1, TOLD, "ok 00000000 4 91010F00" },
        { 2, CALL, "read 1008:00 8" },
        { 2, SENT, "605#A408100004000000" },
        { 3, GOT,  "585#4108100008000000" },
        { 3, SENT, "605#6000000000000000" } ,
        { 4, GOT,  "585#0001020304050607" },
        { 4, SENT, "605#7000000000000000" },
        { 5, GOT,  "585#1D08000000000000" },
        { 5, TOLD, "ok 00000000 8 0102030405060708" } } },
    /* what is wrong with the data */
    { "a wrong checksum", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D5F3440000000000" },
        { 3, SENT, "605#8008100004000405" },
        { 3, TOLD, "protocol 05040004 16" },
        { 3, IDLE, NULL } } },
    { "fewer bytes than told", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D9A9900000000000" },
        { 3, SENT, "605#8008100004000405" },
        { 3, TOLD, "protocol 05040004 15" },
        { 4, CALL, "read 1008:00 20" },
        { 4, SENT, "605#A408100004000000" },
        { 5, GOT,  "585#C208100010000000" },
        { 5, SENT, "605#A300000000000000" },
        SEGMENTS_1008(6),
        { 6, SENT, "605#A203040000000000" },
        { 7, GOT,  "585#D900000000000000" },
        { 7, SENT, "605#8008100010000706" },
        { 7, TOLD, "protocol 06070010 15" } } },
    { "more bytes than told", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D100000000000000" },
        { 3, SENT, "605#8008100010000706" },
        { 3, TOLD, "protocol 06070010 14" } } },
    { "a segment more than told", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, GOT,  "585#0244656D6F504943" },
        { 2, GOT,  "585#0333320000000000" },
        { 2, GOT,  "585#0433320000000000" },
        { 2, SENT, "605#8008100010000706" },
        { 2, TOLD, "protocol 06070010 14" },
        { 2, IDLE, NULL },
        { 3, CALL, "read 1000:00 4" }, /* the server's segments still come */
        { 3, SENT, "605#A400100004000000" },
        { 3, GOT,  "585#0100000000000000" },
        { 3, GOT,  "585#8200000000000000" },
        { 3, CALL, "late 2" },
        { 4, GOT,  "585#4300100091010F00" },
        { 4, TOLD, "ok 00000000 4 91010F00" } } },
    { "more than there is room for", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 15" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#C608100010000000" },
        { 1, SENT, "605#8008100005000405" },
        { 1, TOLD, "overflow 05040005 16" } } },
    { "more than there is room for, no size told", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 15" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#C408100000000000" },
        { 1, SENT, "605#A300000000000000" },
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D5F3430000000000" },
        { 3, SENT, "605#8008100005000405" },
        { 3, TOLD, "overflow 05040005 0" } } },
    { "no segment has the number 0", {
        READ_1008,
        { 2, GOT,  "585#0043414E6F70656E" },
        { 2, SENT, "605#8008100003000405" },
        { 2, TOLD, "protocol 05040003 0" } } },
    { "or more than was agreed", {
        READ_1008,
        { 2, GOT,  "585#0543414E6F70656E" },
        { 2, SENT, "605#8008100003000405" },
        { 2, TOLD, "protocol 05040003 0" } } },
    { "the wrong command at the end", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#A100000000000000" },
        { 3, SENT, "605#8008100001000405" },
        { 3, TOLD, "protocol 05040001 14" } } },
    { "short frames", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 0, ECHO, NULL },
        { 1, GOT,  "585#C6081000100000" },
        { 1, CALL, "late 1" },
        { 1, GOT,  "585#C608100010000000" },
        { 1, SENT, "605#A300000000000000" },
        { 2, GOT,  "585#0143414E6F7065" },
        { 2, CALL, "late 2" },
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 3, GOT,  "585#D5F3" },
        { 3, CALL, "late 3" },
        { 3, GOT,  "585#D5F3430000000000" },
        { 3, SENT, "605#A100000000000000" },
        { 3, TOLD, "ok 00000000 16 " DATA } } },
    /* aborts, and what comes behind the end */
    { "the server aborts among segments and at the end", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, GOT,  "585#8008100020000008" },
        { 2, TOLD, "aborted 08000020 0" },
        { 3, CALL, "read 1008:00 20" },
        { 3, SENT, "605#A408100004000000" },
        { 4, GOT,  "585#C608100010000000" },
        { 4, SENT, "605#A300000000000000" },
        SEGMENTS_1008(5),
        { 5, SENT, "605#A203040000000000" },
        { 6, GOT,  "585#8008100000000405" },
        { 6, TOLD, "aborted 05040000 14" },
        { 6, IDLE, NULL } } },
    { "an abort is 80h, all else are segments", {
        READ_1008,
        { 2, GOT,  "585#8108100020000008" },
        { 2, SENT, "605#A201040000000000" },
        { 3, GOT,  "585#8009100020000008" },
        { 3, CALL, "late 1" },
        { 3, GOT,  "585#8000000020000008" },
        { 3, TOLD, "aborted 08000020 0" } } },
    { "cancelled: segments that still come are none of the next transfer's", {
        READ_1008,
        { 2, GOT,  "585#0143414E6F70656E" },
        { 2, CALL, "cancel 08000020" },
        { 2, SENT, "605#8008100020000008" },
        { 2, TOLD, "cancelled 08000020 0" },
        { 3, CALL, "read 1000:00 4" },
        { 3, SENT, "605#A400100004000000" },
        { 3, GOT,  "585#0244656D6F504943" },
        { 3, GOT,  "585#2244656D6F504943" },
        { 3, GOT,  "585#8100000000000000" },
        { 3, GOT,  "585#C100100000000000" },
        { 3, CALL, "late 4" },
        { 4, GOT,  "585#C000100000000000" },
        { 4, SENT, "605#A300000000000000" },
        { 5, CALL, "cancel 08000020" },
        { 5, SENT, "605#8000100020000008" },
        { 5, TOLD, "cancelled 08000020 0" } } },
    /* time */
    { "no answer to the initiate", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 5, ECHO, NULL },
        { 204, QUIET, NULL },
        { 205, SENT, "605#8008100000000405" },
        { 205, TOLD, "no answer 05040000 0" } } },
    { "no segment in time", {
        READ_1008,
        { 200, QUIET, NULL },
        { 201, SENT, "605#8008100000000405" },
        { 201, TOLD, "no answer 05040000 0" },
        { 201, IDLE, NULL } } },
    { "no segment in time, twice", {
        READ_1008,
        { 2, GOT,  "585#0244656D6F504943" },
        { 102, SENT, "605#A200040000000000" },
        { 110, ECHO, NULL },
        { 309, QUIET, NULL },
        { 310, SENT, "605#8008100000000405" },
        { 310, TOLD, "no answer 05040000 0" },
        { 310, IDLE, NULL } } },
    { "no end in time", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 2, ECHO, NULL },
        { 201, QUIET, NULL },
        { 202, SENT, "605#8008100000000405" },
        { 202, TOLD, "no answer 05040000 14" } } },
    { "an answer to a sub-block that does not get on the wire", {
        READ_1008,
        SEGMENTS_1008(2),
        { 2, SENT, "605#A203040000000000" },
        { 2001, QUIET, NULL },
        { 2002, TOLD, "not sent 00000000 14" },
        { 2002, IDLE, NULL } } },
    { "handed over instead of seen", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 10, CALL, "handed over" },
        { 209, GOT,  "585#C608100010000000" },
        { 209, SENT, "605#A300000000000000" },
        { 1000, CALL, "handed over" },
        { 1001, CALL, "handed over" },
        { 1199, QUIET, NULL },
        { 1200, SENT, "605#8008100000000405" },
        { 1200, TOLD, "no answer 05040000 0" } } },
    { "an initiate handed over", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "handed over" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 10, CALL, "handed over" },
        { 209, QUIET, NULL },
        { 210, SENT, "605#8008100000000405" },
        { 210, TOLD, "no answer 05040000 0" } } },
    /* servers without blocks */
    { "blocks refused: in segments", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#8008100001000405" },
        { 1, SENT, "605#4008100000000000" },
        { 1, ECHO, NULL },
        { 2, GOT,  "585#4B08100041420000" },
        { 2, TOLD, "ok 00000000 2 4142 no blocks" },
        { 2, IDLE, NULL } } },
    { "blocks refused, and then no answer", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#8000000001000405" },
        { 1, SENT, "605#4008100000000000" },
        { 1, ECHO, NULL },
        { 201, SENT, "605#8008100000000405" },
        { 201, TOLD, "no answer 05040000 0 no blocks" } } },
    { "blocks refused, and all else, too", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#8008100000000008" },
        { 1, SENT, "605#4008100000000000" },
        { 2, GOT,  "585#8008100000000008" },
        { 2, TOLD, "aborted 08000000 0" } } },
    { "block size, access or more refused, but not the transfer", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#8008100002000405" },
        { 1, SENT, "605#4008100000000000" },
        { 2, GOT,  "585#4B08100041420000" },
        { 2, TOLD, "ok 00000000 2 4142 no blocks" },
        { 3, CALL, "read 1008:00 20" },
        { 3, SENT, "605#A408100004000000" },
        { 4, GOT,  "585#8008100000000106" },
        { 4, SENT, "605#4008100000000000" },
        { 5, GOT,  "585#4B08100041420000" },
        { 5, TOLD, "ok 00000000 2 4142 no blocks" },
        { 6, CALL, "read 1008:00 20" },
        { 6, SENT, "605#A408100004000000" },
        { 7, GOT,  "585#8008100000000008" },
        { 7, SENT, "605#4008100000000000" },
        { 8, GOT,  "585#4B08100041420000" },
        { 8, TOLD, "ok 00000000 2 4142 no blocks" } } },
    { "other reasons are no refusal of blocks", {
        { 0, CALL, "blocks of 4" },
        { 0, CALL, "read 1008:00 20" },
        { 0, SENT, "605#A408100004000000" },
        { 1, GOT,  "585#8008100000000206" },
        { 1, TOLD, "aborted 06020000 0" },
        { 2, CALL, "read 1008:00 20" },
        { 2, SENT, "605#A408100004000000" },
        { 3, GOT,  "585#C608100010000000" },
        { 3, SENT, "605#A300000000000000" },
        { 4, GOT,  "585#8008100001000405" },
        { 4, TOLD, "aborted 05040001 0" } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

START_TEST(test_conversation)
{
    client_bench_talk(&talks[_i / TALK_STALLS], (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_client_block_up");
    TCase *tcase = tcase_create("sdo_client_block_up");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

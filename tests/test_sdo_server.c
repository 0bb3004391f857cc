/*
 * SDO server: the answers to everything a client may ask, right or wrong. "K5" is the fifth of the
 * conformance checks.
 */
#include "support/server_bench.h"

#include <check.h>

/* clang-format off */
static const struct talk talks[] = {
    /* uploads */
    { "K5: upload of 4 bytes, expedited", {
        { 0, GOT,  "605#4000100000000000" },
        { 0, SENT, "585#4300100091010F00" },
        { 9, IDLE, NULL } } },
    { "K6: upload of 2 bytes and write back", {
        { 0, CALL, "set 1017:00 E803" },
        { 0, GOT,  "605#4017100000000000" },
        { 0, SENT, "585#4B171000E8030000" },
        { 1, GOT,  "605#2B171000E8030000" },
        { 1, TOLD, "write 1017:00 E803" },
        { 1, CALL, "verdict 0" },
        { 1, SENT, "585#6017100000000000" },
        { 1, CALL, "value 1017:00 E803" },
        { 9, IDLE, NULL } } },
    { "upload of 1 byte and of 3", {
        { 0, GOT,  "605#4019100000000000" },
        { 0, SENT, "585#4F19100000000000" },
        { 0, CALL, "set 2005:00 414243" },
        { 0, GOT,  "605#4005200000000000" },
        { 0, SENT, "585#4705200041424300" } } },
    { "K19: segmented upload of 16 bytes", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#0043414E6F70656E" },
        { 2, GOT,  "605#7000000000000000" },
        { 2, SENT, "585#1044656D6F504943" },
        { 3, GOT,  "605#6000000000000000" },
        { 3, SENT, "585#0B33320000000000" },
        { 3, IDLE, NULL },
        { 4, GOT,  "605#7000000000000000" },
        { 4, SENT, "585#8008100001000405" } } },
    { "an upload is a snapshot", {
        { 0, CALL, "set 2003:00 0101010101010101" },
        { 0, GOT,  "605#4003200000000000" },
        { 0, SENT, "585#4103200008000000" },
        { 1, CALL, "set 2003:00 0202020202020202" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#0001010101010101" },
        { 2, GOT,  "605#7000000000000000" },
        { 2, SENT, "585#1D01000000000000" } } },
    { "K52: upload of an empty string", {
        { 0, GOT,  "605#4002200000000000" },
        { 0, SENT, "585#4102200000000000" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#0F00000000000000" },
        { 9, IDLE, NULL } } },
    { "K7: write of a read-only object", {
        { 0, GOT,  "605#2300100001020304" },
        { 0, SENT, "585#8000100002000106" },
        { 0, GOT,  "605#2F08100001000000" },
        { 0, SENT, "585#8008100002000106" },
        { 0, GOT,  "605#2100100004000000" },
        { 0, SENT, "585#8000100002000106" } } },
    { "K8: upload of a write-only object", {
        { 0, GOT,  "605#40501F0100000000" },
        { 0, SENT, "585#80501F0101000106" } } },
    { "K9: missing sub-index", {
        { 0, GOT,  "605#4000100100000000" },
        { 0, SENT, "585#8000100111000906" },
        { 0, GOT,  "605#2F17100500000000" },
        { 0, SENT, "585#8017100511000906" } } },
    { "K10: missing object", {
        { 0, GOT,  "605#4004100000000000" },
        { 0, SENT, "585#8004100000000206" },
        { 0, GOT,  "605#2F04100000000000" },
        { 0, SENT, "585#8004100000000206" },
        { 0, GOT,  "605#2104100000000000" },
        { 0, SENT, "585#8004100000000206" } } },
    { "K11: unknown command specifier", {
        { 0, GOT,  "605#E000100000000000" },
        { 0, SENT, "585#8000100001000405" } } },
    { "block transfers are not there", {
        { 0, GOT,  "605#A400100014000000" },
        { 0, SENT, "585#8000100001000405" },
        { 0, GOT,  "605#C217100002000000" },
        { 0, SENT, "585#8017100001000405" },
        { 0, GOT,  "605#A100000000000000" },
        { 0, SENT, "585#8017100001000405" },
        { 0, GOT,  "605#C100000000000000" },
        { 0, SENT, "585#8017100001000405" } } },
    { "an upload that the buffer does not hold", {
        { 0, GOT,  "605#4008200000000000" },
        { 0, SENT, "585#8008200005000405" } } },
    /* values that do not fit */
    { "K12: too long for the object", {
        { 0, GOT,  "605#2319100001000000" },
        { 0, SENT, "585#8019100012000706" },
        { 0, GOT,  "605#2317100001000000" },
        { 0, SENT, "585#8017100012000706" },
        { 0, CALL, "value 1017:00 0000" } } },
    { "K13: too short for the object", {
        { 0, GOT,  "605#2F17100001000000" },
        { 0, SENT, "585#8017100013000706" },
        { 0, GOT,  "605#2F06200001000000" },
        { 0, SENT, "585#8006200013000706" },
        { 0, CALL, "value 1017:00 0000" } } },
    { "K14: above the high limit", {
        { 0, GOT,  "605#2F031000FF000000" },
        { 0, SENT, "585#8003100031000906" },
        { 0, GOT,  "605#2B04200065000000" },
        { 0, SENT, "585#8004200031000906" },
        { 0, CALL, "value 1003:00 00" } } },
    { "K15: below the low limit", {
        { 0, GOT,  "605#2314100000000000" },
        { 0, SENT, "585#8014100032000906" },
        { 0, GOT,  "605#2B0420009BFF0000" },
        { 0, SENT, "585#8004200032000906" },
        { 0, GOT,  "605#2B0420009CFF0000" },
        { 0, TOLD, "write 2004:00 9CFF" } } },
    { "a BOOLEAN is 0 or 1", {
        { 0, GOT,  "605#2F01200002000000" },
        { 0, SENT, "585#8001200030000906" },
        { 0, GOT,  "605#2F01200001000000" },
        { 0, TOLD, "write 2001:00 01" },
        { 0, CALL, "verdict 0" },
        { 0, SENT, "585#6001200000000000" } } },
    { "strings may be shorter, not longer", {
        { 0, GOT,  "605#2B05200041420000" },
        { 0, TOLD, "write 2005:00 4142" },
        { 0, CALL, "verdict 0" },
        { 0, SENT, "585#6005200000000000" },
        { 0, CALL, "value 2005:00 4142" },
        { 1, GOT,  "605#2105200009000000" },
        { 1, SENT, "585#8005200012000706" } } },
    /* downloads */
    { "K18: segmented download of 2 bytes", {
        { 0, GOT,  "605#2117100002000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#0BE8030000000000" },
        { 1, TOLD, "write 1017:00 E803" },
        { 3, CALL, "verdict 0" },
        { 3, SENT, "585#2000000000000000" },
        { 3, CALL, "value 1017:00 E803" },
        { 9, IDLE, NULL } } },
    { "segmented download with a toggle bit", {
        { 0, GOT,  "605#2103200008000000" },
        { 0, SENT, "585#6003200000000000" },
        { 1, GOT,  "605#0001020304050607" },
        { 1, SENT, "585#2000000000000000" },
        { 2, GOT,  "605#1D08000000000000" },
        { 2, TOLD, "write 2003:00 0102030405060708" },
        { 2, CALL, "verdict 0" },
        { 2, SENT, "585#3000000000000000" } } },
    { "K27: segmented download without a size", {
        { 0, GOT,  "605#2017100000000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#0BE8030000000000" },
        { 1, TOLD, "write 1017:00 E803" },
        { 1, CALL, "verdict 0" },
        { 1, SENT, "585#2000000000000000" } } },
    { "K28: expedited download without a size", {
        { 0, GOT,  "605#2219100005FFFFFF" },
        { 0, TOLD, "write 1019:00 05" },
        { 0, CALL, "verdict 0" },
        { 0, SENT, "585#6019100000000000" },
        { 1, GOT,  "605#22171000E803FFFF" },
        { 1, TOLD, "write 1017:00 E803" },
        { 1, CALL, "verdict 0" },
        { 1, SENT, "585#6017100000000000" },
        { 2, GOT,  "605#2206200001020304" },
        { 2, TOLD, "write 2006:00 01020304" },
        { 2, CALL, "verdict 0" },
        { 2, SENT, "585#6006200000000000" },
        { 3, GOT,  "605#2205200041424344" },
        { 3, TOLD, "write 2005:00 41424344" },
        { 3, CALL, "verdict 0" },
        { 3, SENT, "585#6005200000000000" },
        { 4, GOT,  "605#2203200001020304" },
        { 4, SENT, "585#8003200013000706" },
        { 5, GOT,  "605#2207200001020304" },
        { 5, SENT, "585#8007200012000706" } } },
    { "download of nothing", {
        { 0, CALL, "set 2000:00 4142" },
        { 0, GOT,  "605#2100200000000000" },
        { 0, SENT, "585#6000200000000000" },
        { 1, GOT,  "605#0F00000000000000" },
        { 1, TOLD, "write 2000:00 " },
        { 1, CALL, "verdict 0" },
        { 1, SENT, "585#2000000000000000" },
        { 2, GOT,  "605#2117100000000000" },
        { 2, SENT, "585#8017100013000706" },
        { 3, GOT,  "605#2017100000000000" },
        { 3, SENT, "585#6017100000000000" },
        { 4, GOT,  "605#0F00000000000000" },
        { 4, SENT, "585#8017100013000706" } } },
    { "K25: a size that the object cannot have", {
        { 0, GOT,  "605#2117100064000000" },
        { 0, SENT, "585#8017100012000706" },
        { 0, GOT,  "605#2117100001000000" },
        { 0, SENT, "585#8017100013000706" },
        { 0, GOT,  "605#21002000FFFFFFFE" },
        { 0, SENT, "585#8000200012000706" },
        { 9, IDLE, NULL } } },
    { "a size that the buffer does not hold", {
        { 0, GOT,  "605#210020002D010000" },
        { 0, SENT, "585#8000200005000405" } } },
    { "K26: fewer bytes than told", {
        { 0, GOT,  "605#2106200004000000" },
        { 0, SENT, "585#6006200000000000" },
        { 1, GOT,  "605#0B01020000000000" },
        { 1, SENT, "585#8006200013000706" },
        { 1, CALL, "value 2006:00 00000000" },
        { 9, IDLE, NULL } } },
    { "K26: a string of fewer bytes than told", {
        { 0, GOT,  "605#2105200004000000" },
        { 0, SENT, "585#6005200000000000" },
        { 1, GOT,  "605#0B41420000000000" },
        { 1, SENT, "585#8005200013000706" },
        { 9, IDLE, NULL } } },
    { "more bytes than told", {
        { 0, GOT,  "605#2105200002000000" },
        { 0, SENT, "585#6005200000000000" },
        { 1, GOT,  "605#0941424300000000" },
        { 1, SENT, "585#8005200012000706" },
        { 9, IDLE, NULL } } },
    { "more bytes than the object has, no size told", {
        { 0, GOT,  "605#2017100000000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#0001020304050607" },
        { 1, SENT, "585#8017100012000706" } } },
    { "a limit is checked at the end of segments too", {
        { 0, GOT,  "605#2104200002000000" },
        { 0, SENT, "585#6004200000000000" },
        { 1, GOT,  "605#0B65000000000000" },
        { 1, SENT, "585#8004200031000906" } } },
    /* segments out of place */
    { "K20: wrong toggle bit in the first upload segment", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#7000000000000000" },
        { 1, SENT, "585#8008100000000305" },
        { 9, IDLE, NULL } } },
    { "K21: repeated upload segment", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#6000000000000000" },
        { 1, SENT, "585#0043414E6F70656E" },
        { 2, GOT,  "605#6000000000000000" },
        { 2, SENT, "585#8008100000000305" } } },
    { "K22: wrong toggle bit in a download segment", {
        { 0, GOT,  "605#2117100002000000" },
        { 0, SENT, "585#6017100000000000" },
        { 1, GOT,  "605#1BE8030000000000" },
        { 1, SENT, "585#8017100000000305" },
        { 1, CALL, "value 1017:00 0000" },
        { 9, IDLE, NULL } } },
    { "K23, K24: segments without a transfer", {
        { 0, GOT,  "605#6000000000000000" },
        { 0, SENT, "585#8000000001000405" },
        { 0, GOT,  "605#0000000000000000" },
        { 0, SENT, "585#8000000001000405" } } },
    { "segments of the other direction", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#0000000000000000" },
        { 1, SENT, "585#8008100001000405" },
        { 2, GOT,  "605#2117100002000000" },
        { 2, SENT, "585#6017100000000000" },
        { 3, GOT,  "605#6000000000000000" },
        { 3, SENT, "585#8017100001000405" },
        { 9, IDLE, NULL } } },
    { "an unknown command specifier among segments", {
        { 0, GOT,  "605#4008100000000000" },
        { 0, SENT, "585#4108100010000000" },
        { 1, GOT,  "605#E000000000000000" },
        { 1, SENT, "585#8008100001000405" },
        { 9, IDLE, NULL } } },
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
    Suite *suite = suite_create("sdo_server");
    TCase *tcase = tcase_create("sdo_server");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

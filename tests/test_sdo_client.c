/* SDO client: what goes over the wire in every transfer, and what the server may do wrong. */
#include "support/client_bench.h"

#include <check.h>

/* clang-format off */
static const struct talk talks[] = {
    /* uploads */
    { "upload of 4 bytes, expedited", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#4300100091010F00" },
        { 1, TOLD, "ok 00000000 4 91010F00" },
        { 9, IDLE, NULL } } },
    { "upload of 3 bytes", {
        { 0, CALL, "read 2001:02 4" },
        { 0, SENT, "605#4001200200000000" },
        { 1, GOT,  "585#4701200201020300" },
        { 1, TOLD, "ok 00000000 3 010203" } } },
    { "upload of 2 bytes", {
        { 0, CALL, "read 1017:00 2" },
        { 0, SENT, "605#4017100000000000" },
        { 1, GOT,  "585#4B171000E8030000" },
        { 1, TOLD, "ok 00000000 2 E803" } } },
    { "upload of 1 byte", {
        { 0, CALL, "read 1001:00 1" },
        { 0, SENT, "605#4001100000000000" },
        { 1, GOT,  "585#4F01100011000000" },
        { 1, TOLD, "ok 00000000 1 11" } } },
    { "expedited without a size: 4 bytes", {
        { 0, CALL, "read 1000:00 8" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#4200100091010F00" },
        { 1, TOLD, "ok 00000000 4 91010F00" } } },
    { "expedited without a size: as many as the caller expects", {
        { 0, CALL, "read 1001:00 1" },
        { 0, SENT, "605#4001100000000000" },
        { 1, GOT,  "585#4201100011000000" },
        { 1, TOLD, "ok 00000000 1 11" } } },
    { "segmented with a size", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4108100010000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0030313233343536" },
        { 2, SENT, "605#7000000000000000" },
        { 3, GOT,  "585#1037383940414243" },
        { 3, SENT, "605#6000000000000000" },
        { 4, GOT,  "585#0B44450000000000" },
        { 4, TOLD, "ok 00000000 16 30313233343536373839404142434445" },
        { 9, IDLE, NULL } } },
    { "segmented without a size, a full last segment", {
        { 0, CALL, "read 1008:00 300" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0130313233343536" },
        { 2, TOLD, "ok 00000000 7 30313233343536" } } },
    { "segments that are not full", {
        { 0, CALL, "read 1008:00 300" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0C30000000000000" },
        { 2, SENT, "605#7000000000000000" },
        { 3, GOT,  "585#1D31000000000000" },
        { 3, TOLD, "ok 00000000 2 3031" } } },
    { "upload of nothing", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4108100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0F00000000000000" },
        { 2, TOLD, "ok 00000000 0 " } } },
    { "short answers with all that is needed", {
        { 0, CALL, "read 1017:00 2" },
        { 0, SENT, "605#4017100000000000" },
        { 1, GOT,  "585#4B171000E803" },
        { 1, TOLD, "ok 00000000 2 E803" },
        { 2, CALL, "read 1008:00 7" },
        { 2, SENT, "605#4008100000000000" },
        { 3, GOT,  "585#40081000" },
        { 3, SENT, "605#6000000000000000" },
        { 4, GOT,  "585#0B4142" },
        { 4, TOLD, "ok 00000000 2 4142" },
        { 5, CALL, "write 1017:00 01" },
        { 5, SENT, "605#2F17100001000000" },
        { 6, GOT,  "585#60171000" },
        { 6, TOLD, "ok 00000000 1" } } },
    { "answers too short for what they say are no answers", {
        { 0, CALL, "read 1008:00 7" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#" },
        { 1, GOT,  "585#40" },
        { 1, GOT,  "585#400810" },
        { 1, GOT,  "585#43081000414243" },
        { 1, GOT,  "585#41081000070000" },
        { 1, GOT,  "585#80081000000009" },
        { 2, CALL, "late 6" },
        { 2, GOT,  "585#40081000" },
        { 2, SENT, "605#6000000000000000" },
        { 3, GOT,  "585#0B41" },
        { 3, GOT,  "585#" },
        { 3, CALL, "late 8" },
        { 3, GOT,  "585#0B4142" },
        { 3, TOLD, "ok 00000000 2 4142" } } },
    /* uploads that fail */
    { "expedited, more than fits", {
        { 0, CALL, "read 1000:00 3" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#4300100091010F00" },
        { 1, SENT, "605#8000100005000405" },
        { 1, TOLD, "overflow 05040005 4" } } },
    { "the size told does not fit", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4108100011000000" },
        { 1, SENT, "605#8008100005000405" },
        { 1, TOLD, "overflow 05040005 17" } } },
    { "no size told, more than fits", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0030313233343536" },
        { 2, SENT, "605#7000000000000000" },
        { 3, GOT,  "585#1B37380000000000" },
        { 3, SENT, "605#8008100005000405" },
        { 3, TOLD, "overflow 05040005 0" } } },
    { "fewer bytes than told", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4108100003000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0B30310000000000" },
        { 2, SENT, "605#8008100010000706" },
        { 2, TOLD, "protocol 06070010 2" } } },
    { "more bytes than told", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4108100001000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#0030313233343536" },
        { 2, SENT, "605#8008100010000706" },
        { 2, TOLD, "protocol 06070010 7" } } },
    { "wrong toggle bit in the first segment", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 2, GOT,  "585#4108100009000000" },
        { 2, SENT, "605#6000000000000000" },
        { 4, GOT,  "585#1031323334353637" },
        { 4, SENT, "605#8008100000000305" },
        { 4, TOLD, "toggle 05030000 0" } } },
    { "a segment that comes twice", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 2, GOT,  "585#4108100009000000" },
        { 2, SENT, "605#6000000000000000" },
        { 4, GOT,  "585#0031323334353637" },
        { 4, SENT, "605#7000000000000000" },
        { 5, GOT,  "585#0031323334353637" },
        { 5, SENT, "605#8008100000000305" },
        { 5, TOLD, "toggle 05030000 7" } } },
    { "an empty segment that is not the last", {
        { 0, CALL, "read 1008:00 16" },
        { 0, SENT, "605#4008100000000000" },
        { 2, GOT,  "585#4008100000000000" },
        { 2, SENT, "605#6000000000000000" },
        { 4, GOT,  "585#0E00000000000000" },
        { 4, SENT, "605#8008100001000405" },
        { 4, TOLD, "protocol 05040001 0" } } },
    /* downloads */
    { "download of 1 byte", {
        { 0, CALL, "write 1019:00 05" },
        { 0, SENT, "605#2F19100005000000" },
        { 1, GOT,  "585#6019100000000000" },
        { 1, TOLD, "ok 00000000 1" },
        { 9, IDLE, NULL } } },
    { "download of 2 bytes, of 3, of 4", {
        { 0, CALL, "write 1017:00 E803" },
        { 0, SENT, "605#2B171000E8030000" },
        { 1, GOT,  "585#6017100000000000" },
        { 1, TOLD, "ok 00000000 2" },
        { 2, CALL, "write+ 2001:02 010203" },
        { 2, SENT, "605#2701200201020300" },
        { 3, GOT,  "585#6001200200000000" },
        { 3, TOLD, "ok 00000000 3" },
        { 4, CALL, "write 1010:01 73617665" },
        { 4, SENT, "605#2310100173617665" },
        { 5, GOT,  "585#6010100100000000" },
        { 5, TOLD, "ok 00000000 4" } } },
    { "expedited download that hides its size", {
        { 0, CALL, "write- 1017:00 E803" },
        { 0, SENT, "605#22171000E8030000" },
        { 1, GOT,  "585#6017100000000000" },
        { 1, TOLD, "ok 00000000 2" } } },
    { "download of 5 bytes, size told", {
        { 0, CALL, "write+ 2000:00 3132333435" },
        { 0, SENT, "605#2100200005000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0531323334350000" },
        { 2, GOT,  "585#2000000000000000" },
        { 2, TOLD, "ok 00000000 5" } } },
    { "download of 14 bytes, size not told", {
        { 0, CALL, "write 2000:00 3031323334353637383940414243" },
        { 0, SENT, "605#2000200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0030313233343536" },
        { 2, GOT,  "585#2000000000000000" },
        { 2, SENT, "605#1137383940414243" },
        { 3, GOT,  "585#3000000000000000" },
        { 3, TOLD, "ok 00000000 14" } } },
    { "download of nothing", {
        { 0, CALL, "write+ 2000:00 -" },
        { 0, SENT, "605#2100200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0F00000000000000" },
        { 2, GOT,  "585#2000000000000000" },
        { 2, TOLD, "ok 00000000 0" } } },
    { "wrong toggle bit in a confirmation", {
        { 0, CALL, "write 2000:00 3132333435" },
        { 0, SENT, "605#2000200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0531323334350000" },
        { 2, GOT,  "585#3000000000000000" },
        { 2, SENT, "605#8000200000000305" },
        { 2, TOLD, "toggle 05030000 0" } } },
    /* aborts of the server */
    { "the server refuses", {
        { 0, CALL, "read 1000:05 4" },
        { 0, SENT, "605#4000100500000000" },
        { 1, GOT,  "585#8000100511000906" },
        { 1, TOLD, "aborted 06090011 0" },
        { 9, IDLE, NULL } } },
    { "the server refuses in the middle, naming no object, with a code of its own", {
        { 0, CALL, "write 2000:00 3132333435" },
        { 0, SENT, "605#2000200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0531323334350000" },
        { 2, GOT,  "585#80000000EFBEADDE" },
        { 2, TOLD, "aborted DEADBEEF 0" } } },
    { "an abort for another object is not ours", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#8008100000000206" },
        { 1, GOT,  "585#8000100100000206" },
        { 1, CALL, "late 2" },
        { 2, GOT,  "585#4300100091010F00" },
        { 2, TOLD, "ok 00000000 4 91010F00" } } },
    /* unexpected answers */
    { "a download's answer to an upload", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#6000100000000000" },
        { 1, SENT, "605#8000100001000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "an upload's answer to a download", {
        { 0, CALL, "write 1000:00 01" },
        { 0, SENT, "605#2F00100001000000" },
        { 1, GOT,  "585#4F00100001000000" },
        { 1, SENT, "605#8000100001000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "an unknown answer", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#E000100000000000" },
        { 1, SENT, "605#8000100001000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "a segment where none was asked for", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "585#0000100000000000" },
        { 1, SENT, "605#8000100001000405" },
        { 1, TOLD, "protocol 05040001 0" } } },
    { "a download's segment answer to an upload's segment", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#2000000000000000" },
        { 2, SENT, "605#8008100001000405" },
        { 2, TOLD, "protocol 05040001 0" } } },
    { "an upload's segment answer to a download's segment", {
        { 0, CALL, "write 2000:00 3132333435" },
        { 0, SENT, "605#2000200000000000" },
        { 1, GOT,  "585#6000200000000000" },
        { 1, SENT, "605#0531323334350000" },
        { 2, GOT,  "585#0000000000000000" },
        { 2, SENT, "605#8000200001000405" },
        { 2, TOLD, "protocol 05040001 0" } } },
    { "the initiate answer comes again among the segments", {
        { 0, CALL, "read 1008:00 8" },
        { 0, SENT, "605#4008100000000000" },
        { 1, GOT,  "585#4008100000000000" },
        { 1, SENT, "605#6000000000000000" },
        { 2, GOT,  "585#4008100000000000" },
        { 2, SENT, "605#8008100001000405" },
        { 2, TOLD, "protocol 05040001 0" } } },
    /* frames that are not for this client */
    { "other frames", {
        { 0, CALL, "read 1000:00 4" },
        { 0, SENT, "605#4000100000000000" },
        { 1, GOT,  "586#4300100091010F00" },
        { 1, GOT,  "00000585#4300100091010F00" },
        { 1, GOT,  "585#R8" },
        { 1, GOT,  "605#8000100000000405" },
        { 1, GOT,  "705#05" },
        { 2, CALL, "late 0" },
        { 2, GOT,  "585#4300100091010F00" },
        { 2, TOLD, "ok 00000000 4 91010F00" } } },
    { "answers to an idle client", {
        { 0, GOT,  "585#4300100091010F00" },
        { 0, GOT,  "585#8000100000000405" },
        { 0, ECHO, "605#4000100000000000" },
        { 0, CALL, "late 2" },
        { 5, IDLE, NULL } } },
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
    Suite *suite = suite_create("sdo_client");
    TCase *tcase = tcase_create("sdo_client");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_conversation, 0, TALK_COUNT * TALK_STALLS);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

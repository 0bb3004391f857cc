/* Frames and their text; numbers in bytes. */
#include "base/frame.h"

#include "base/bytes.h"

#include <check.h>
#include <string.h>

static const struct {
    const char *text;
    uint32_t id;
    uint8_t flags, dlc;
    const char *again; /* as it is printed; NULL: the same */
} good[] = {
    { "605#4000100000000000", 0x605, 0, 8, NULL },
    { "000#8200", 0, 0, 2, NULL },
    { "7FF#", 0x7FF, 0, 0, NULL },
    { "705#R1", 0x705, CO_FRAME_RTR, 1, NULL },
    { "705#R", 0x705, CO_FRAME_RTR, 0, "705#R0" },
    { "705#R8", 0x705, CO_FRAME_RTR, 8, NULL },
    { "1FFFFFFF#01", 0x1FFFFFFF, CO_FRAME_EXT, 1, NULL },
    { "00000001#", 1, CO_FRAME_EXT, 0, NULL },
    { "18daf110#R2", 0x18DAF110, CO_FRAME_EXT | CO_FRAME_RTR, 2, "18DAF110#R2" },
    { "5aB#aBcD", 0x5AB, 0, 2, "5AB#ABCD" },
};

START_TEST(test_text)
{
    char text[CO_FRAME_TEXT_SIZE];
    struct co_frame frame;

    ck_assert(co_frame_parse(good[_i].text, &frame));
    ck_assert_uint_eq(frame.id, good[_i].id);
    ck_assert_uint_eq(frame.flags, good[_i].flags);
    ck_assert_uint_eq(frame.dlc, good[_i].dlc);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text),
                     good[_i].again ? good[_i].again : good[_i].text);
}
END_TEST

static const char *const bad[] = {
    "",
    "#",
    "605",
    "605 40",
    "60#00",
    "6050#00",
    "800#00",
    "20000000#00",
    "123456789#00",
    "605#4",
    "605#400",
    "605#4G",
    "605#G4",
    "605#000000000000000000",
    "605#R9",
    "605#R12",
    "605#00 ",
    " 605#00",
    "605#00R",
    "605##00",
    "6G5#00",
    "FFFFFFFF#",
};

START_TEST(test_no_text)
{
    struct co_frame frame = co_frame_make(0x123, 3), before = frame;

    ck_assert(!co_frame_parse(bad[_i], &frame));
    ck_assert_mem_eq(&frame, &before, sizeof frame);
}
END_TEST

START_TEST(test_format_is_bounded)
{
    struct co_frame frame = co_frame_make(0x1FFFFFFF, 8);
    char text[CO_FRAME_TEXT_SIZE];

    frame.flags = CO_FRAME_EXT;
    memset(text, 'x', sizeof text);
    ck_assert_str_eq(co_frame_format(&frame, text, 5), "1FFF");
    ck_assert_int_eq(text[5], 'x');
    frame.dlc = 15; /* as some drivers show it */
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "1FFFFFFF#0000000000000000");
}
END_TEST

START_TEST(test_equal)
{
    struct co_frame a = co_frame_make(0x605, 2), b = a;

    ck_assert(co_frame_equal(&a, &b));
    b.flags = CO_FRAME_OWN;
    b.tag = 9;
    b.data[2] = 1; /* behind the data */
    ck_assert(co_frame_equal(&a, &b));
    b.data[1] = 1;
    ck_assert(!co_frame_equal(&a, &b));
    b = a;
    b.id++;
    ck_assert(!co_frame_equal(&a, &b));
    b = a;
    b.dlc = 3;
    ck_assert(!co_frame_equal(&a, &b));
    b = a;
    b.flags = CO_FRAME_EXT;
    ck_assert(!co_frame_equal(&a, &b));
    b.flags = a.flags = CO_FRAME_RTR;
    b.data[0] = 1; /* a remote frame has no data */
    ck_assert(co_frame_equal(&a, &b));
}
END_TEST

START_TEST(test_bytes)
{
    const uint8_t bytes[8] = { 0x01, 0x82, 0x03, 0x84, 0x05, 0x86, 0x07, 0x88 };
    uint8_t written[9] = { 0 };

    ck_assert_uint_eq(get_le16(bytes), 0x8201);
    ck_assert_uint_eq(get_le32(bytes), 0x84038201);
    ck_assert_uint_eq(get_le(bytes, 0), 0);
    ck_assert_uint_eq(get_le(bytes, 3), 0x038201);
    ck_assert_uint_eq(get_le(bytes, 8), UINT64_C(0x8807860584038201));
    put_le(written, 8, UINT64_C(0x8807860584038201));
    ck_assert_mem_eq(written, bytes, 8);
    ck_assert_uint_eq(written[8], 0);
    memset(written, 0xFF, sizeof written);
    put_le16(written, 0x8201);
    ck_assert_uint_eq(get_le(written, 3), 0xFF8201);
    put_le32(written, 0x84038201);
    ck_assert_uint_eq(get_le(written, 5), UINT64_C(0xFF84038201));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("frame");
    TCase *tcase = tcase_create("frame");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_text, 0, sizeof good / sizeof good[0]);
    tcase_add_loop_test(tcase, test_no_text, 0, sizeof bad / sizeof bad[0]);
    tcase_add_test(tcase, test_format_is_bounded);
    tcase_add_test(tcase, test_equal);
    tcase_add_test(tcase, test_bytes);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

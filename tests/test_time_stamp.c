/* TIME: its bytes, what is one, and who may send it. */
#include "proto/time_stamp.h"

#include "support/suite.h"
#include "support/talk.h"

#include <check.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

static const struct {
    struct time_of_day time;
    const char *frame;
} times[] = {
    { { 0, 0 }, "100#000000000000" },
    { { TIME_MS_MAX, 15000 }, "100#FF5B2605983A" },
    { { 0x0FFFFFFF, UINT16_MAX }, "100#FFFFFF0FFFFF" },
    { { 1, 0x0201 }, "100#010000000102" },
};

START_TEST(bytes_of_a_time)
{
    const struct co_frame frame = talk_frame(times[_i].frame);
    const struct time_of_day time = time_of_day_decode(frame.data);
    uint8_t bytes[TIME_OF_DAY_SIZE];

    ck_assert_uint_eq(time.ms, times[_i].time.ms);
    ck_assert_uint_eq(time.days, times[_i].time.days);
    time_of_day_encode(&times[_i].time, bytes);
    ck_assert_mem_eq(bytes, frame.data, sizeof bytes);
}
END_TEST

/* The upper 4 bits are reserved: 0 when sent, not looked at when received. */
START_TEST(reserved_bits)
{
    const struct time_of_day wide = { .ms = 0xF0000001 };
    uint8_t bytes[TIME_OF_DAY_SIZE];

    time_of_day_encode(&wide, bytes);
    ck_assert_uint_eq(bytes[3], 0);
    bytes[3] = 0xF0;
    ck_assert_uint_eq(time_of_day_decode(bytes).ms, 1);
}
END_TEST

static const struct {
    uint32_t cob_id;
    bool enabled;
    const char *frame;
    bool is_time;
} frames[] = {
    { 0x80000100, true, "100#0100000002000000", false },
    { 0x80000100, true, "100#010000000200", true },
    { 0xC0000100, true, "100#010000000200", true },
    { 0x80000100, false, "100#010000000200", false },
    { 0x00000100, true, "100#010000000200", false },
    { 0x40000100, true, "100#010000000200", false },
    { 0x80000100, true, "100#0100000002", false },
    { 0x80000100, true, "100#", false },
    { 0x80000100, true, "100#R6", false },
    { 0x80000100, true, "00000100#010000000200", false },
    { 0x80000100, true, "101#010000000200", false },
    { 0x80000181, true, "181#010000000200", true },
    { 0xA0000100, true, "00000100#010000000200", true },
    { 0xA0000100, true, "100#010000000200", false },
};

START_TEST(what_is_a_time)
{
    const struct time_stamp self = { .cob_id = frames[_i].cob_id, .enabled = frames[_i].enabled };
    const struct co_frame frame = talk_frame(frames[_i].frame);
    struct time_of_day time = { .ms = 77 };

    ck_assert_int_eq(time_stamp_on_frame(&self, &frame, &time), frames[_i].is_time);
    ck_assert_uint_eq(time.ms, frames[_i].is_time ? 1 : 77);
    ck_assert_uint_eq(time.days, frames[_i].is_time ? 2 : 0);
}
END_TEST

static const struct {
    uint32_t cob_id;
    bool enabled;
    enum co_err err;
    const char *frame;
} orders[] = {
    { 0x40000100, true, CO_OK, "100#010000000200" },
    { 0xC0000181, true, CO_OK, "181#010000000200" },
    { 0x60000181, true, CO_OK, "00000181#010000000200" },
    { 0x40000100, false, CO_ERR_STATE, "" },
    { 0x80000100, true, CO_ERR_ARG, "" },
    { 0x00000100, true, CO_ERR_ARG, "" },
};

START_TEST(who_may_send)
{
    const struct time_stamp self = { .cob_id = orders[_i].cob_id, .enabled = orders[_i].enabled };
    const struct time_of_day time = { .ms = 1, .days = 2 };
    struct co_frame frames_out[1], frame;
    char text[CO_FRAME_TEXT_SIZE] = "";
    struct co_outbox out;

    co_outbox_init(&out, frames_out, 1, NULL, 0);
    ck_assert_int_eq(time_stamp_send(&self, &time, &out), orders[_i].err);
    if (orders[_i].err == CO_OK) {
        ck_assert_int_eq(time_stamp_send(&self, &time, &out), CO_ERR_AGAIN);
        ck_assert(co_outbox_take_frame(&out, &frame));
        co_frame_format(&frame, text, sizeof text);
    }
    ck_assert_str_eq(text, orders[_i].frame);
    ck_assert(!co_outbox_take_frame(&out, &frame));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("time_stamp");

    tcase_add_loop_test(tcase, bytes_of_a_time, 0, COUNT(times));
    tcase_add_test(tcase, reserved_bits);
    tcase_add_loop_test(tcase, what_is_a_time, 0, COUNT(frames));
    tcase_add_loop_test(tcase, who_may_send, 0, COUNT(orders));
    return suite_run("time_stamp", tcase);
}

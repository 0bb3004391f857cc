/*
 * The wire of the virtual bus in virtual time: when each frame is through, and which is next. The
 * segment is asked directly, with the times a clock would give.
 */
#include "port/bus_segment.h"
#include "port/bus_timing.h"
#include "support/bus_fixture.h"
#include "support/suite.h"
#include "support/talk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define START CO_MS(1000000)

static struct segment segment;
static uint64_t cursor;

static void open_wire(uint32_t bitrate)
{
    const struct bus_message none = { NULL, 0 };

    fixture_choose_name();
    ck_assert_int_eq(
        segment_open(&segment, fixture_name() + strlen(BUS_VIRTUAL_PREFIX), bitrate, &none), CO_OK);
    ck_assert_int_eq(segment_lock(&segment, 0), CO_OK);
    for (unsigned slot = 0; slot < 3; slot++)
        segment_take_slot(&segment, slot, slot + 1);
    cursor = 0;
}

static void close_wire(void)
{
    segment_unlock(&segment);
    segment_close(&segment);
}

static enum co_err offer(unsigned slot, const char *text, co_us_t at, bool *ret_sooner)
{
    const struct segment_frame frame = { .frame = talk_frame(text),
                                         .time = START + at,
                                         .slot = slot };

    return segment_offer(&segment, &frame, ret_sooner);
}

static void queue(unsigned slot, const char *text, co_us_t at)
{
    bool sooner;

    ck_assert_int_eq(offer(slot, text, at, &sooner), CO_OK);
}

/* The next frame of the ring is this one, at this time. */
static struct segment_frame expect(const char *text, co_us_t at)
{
    struct segment_frame got = { .slot = 0 };
    char name[CO_FRAME_TEXT_SIZE];
    uint64_t lost = 0;

    ck_assert_msg(segment_read(&segment, &cursor, &lost, &got), "no %s", text);
    ck_assert_str_eq(co_frame_format(&got.frame, name, sizeof name), text);
    ck_assert_uint_eq(got.time - START, at);
    ck_assert_uint_eq(lost, 0);
    return got;
}

static void expect_nothing(void)
{
    ck_assert(segment_is_drained(&segment, cursor));
}

static void move_on(co_us_t now)
{
    segment_move_on(&segment, START + now);
}

/* 000# has 53 bits, 705#7F 58, 605#40... 124, 7FF#FF... 126 (test_bus_timing.c). */
static const struct {
    uint32_t bitrate;
    const char *frame;
    co_us_t us; /* of one, and of a thousand behind each other */
    co_us_t thousand;
} times[] = {
    { 1000000, "000#", 53, 53000 },
    { 800000, "000#", 67, 66250 }, /* 66.25: rounded up for its time, not for the next one's */
    { 500000, "000#", 106, 106000 },
    { 500000, "605#4000100000000000", 248, 248000 },
    { 125000, "605#4000100000000000", 992, 992000 },
    { 125000, "705#7F", 464, 464000 },
    { 10000, "7FF#FFFFFFFFFFFFFFFF", 12600, 12600000 },
    { 83333, "705#7F", 697, 696003 }, /* 696.002784 */
};

START_TEST(a_frame_takes_its_time)
{
    open_wire(times[_i].bitrate);
    queue(0, times[_i].frame, 100);
    ck_assert_uint_eq(segment_due(&segment), START + 100 + times[_i].us);
    move_on(100 + times[_i].us - 1);
    expect_nothing();
    move_on(100 + times[_i].us);
    expect(times[_i].frame, 100 + times[_i].us);
    ck_assert_uint_eq(segment_due(&segment), CO_NEVER);
    close_wire();
}
END_TEST

/* Always some pending: the wire is never idle, whenever somebody looks. */
START_TEST(throughput_is_the_bit_rate)
{
    struct segment_frame got = { .slot = 0 };
    uint64_t lost = 0;
    unsigned sent = 0, received = 0;
    bool sooner;

    open_wire(times[_i].bitrate);
    for (co_us_t now = 0; received < 1000; now += times[_i].us * 3 / 2) {
        move_on(now);
        while (received < 1000 && segment_read(&segment, &cursor, &lost, &got))
            received++;
        while (sent - received < 60 && sent < 1000)
            ck_assert_int_eq(offer(sent++ % 2, times[_i].frame, now, &sooner), CO_OK);
    }
    ck_assert_uint_eq(got.time - START, times[_i].thousand);
    close_wire();
}
END_TEST

START_TEST(the_lowest_identifier_is_next)
{
    open_wire(1000000);
    queue(0, "7FF#FFFFFFFFFFFFFFFF", 0); /* alone: on the wire for 126 us, nobody stops it */
    queue(1, "705#7F", 10);
    queue(2, "000#", 125);
    queue(0, "605#4000100000000000", 126); /* just in time for the arbitration */
    move_on(10000);
    expect("7FF#FFFFFFFFFFFFFFFF", 126);
    expect("000#", 126 + 53);
    expect("605#4000100000000000", 126 + 53 + 124);
    expect("705#7F", 126 + 53 + 124 + 58);
    expect_nothing();
    close_wire();
}
END_TEST

START_TEST(who_comes_late_waits)
{
    open_wire(1000000);
    queue(0, "705#7F", 0);
    queue(1, "605#4000100000000000", 0); /* both at once: this one first, 124 us */
    queue(2, "000#", 1);
    queue(2, "000#", 183); /* while 705# is on the wire since 177 */
    move_on(10000);
    expect("605#4000100000000000", 124);
    expect("000#", 177);
    expect("705#7F", 235);
    expect("000#", 288);
    close_wire();
}
END_TEST

START_TEST(equal_identifiers_keep_their_order)
{
    char text[16];

    open_wire(500000);
    for (unsigned i = 0; i < 60; i++) {
        snprintf(text, sizeof text, "123#%02X", i);
        queue(i % 3, text, i / 7);
    }
    move_on(CO_MS(1000));
    for (unsigned i = 0; i < 60; i++) {
        struct segment_frame got = { .slot = 0 };
        uint64_t lost = 0;

        ck_assert(segment_read(&segment, &cursor, &lost, &got));
        ck_assert_uint_eq(got.frame.data[0], i);
        ck_assert_uint_eq(got.slot, i % 3);
    }
    close_wire();
}
END_TEST

START_TEST(who_looks_late_finds_the_times_of_the_wire)
{
    open_wire(1000000);
    queue(0, "000#", 0);
    queue(1, "000#", 20);
    queue(2, "000#", 5000); /* the wire was idle from 106 on */
    ck_assert_uint_eq(segment_due(&segment), START + 5053);
    expect("000#", 53);
    expect("000#", 106);
    move_on(CO_MS(3600000));
    expect("000#", 5053);
    queue(0, "000#", CO_MS(3600000));
    move_on(CO_MS(7200000));
    expect("000#", CO_MS(3600000) + 53);
    close_wire();
}
END_TEST

/* However often and when somebody looks, and who: the same frames at the same times. */
static void run_with_looks(unsigned step, struct segment_frame *ret_frames, unsigned count)
{
    unsigned sent = 0, got = 0;
    uint64_t lost = 0;
    char text[32];

    open_wire(500000);
    for (co_us_t now = 0; got < count; now++) {
        if (sent < count && now % 150 == sent % 7 * 13) {
            snprintf(text, sizeof text, "%03X#%02X0102", sent * 37 % 11 + 0x100, sent);
            queue(sent % 3, text, now);
            sent++;
        }
        if (now % step == 0)
            move_on(now);
        while (got < count && segment_read(&segment, &cursor, &lost, &ret_frames[got]))
            got++;
        if (sent == count)
            now += step;
    }
    close_wire();
}

START_TEST(the_times_do_not_depend_on_who_looks_when)
{
    static struct segment_frame often[80], seldom[80];

    run_with_looks(1, often, 80);
    run_with_looks(997, seldom, 80);
    for (unsigned i = 0; i < 80; i++) {
        ck_assert(co_frame_equal(&often[i].frame, &seldom[i].frame));
        ck_assert_uint_eq(often[i].time, seldom[i].time);
        ck_assert_uint_eq(often[i].slot, seldom[i].slot);
    }
}
END_TEST

START_TEST(a_full_queue_is_full_for_its_owner_only)
{
    bool sooner;

    open_wire(1000000);
    for (unsigned i = 0; i < SEGMENT_PENDING; i++)
        queue(0, "000#", 0);
    ck_assert_int_eq(offer(0, "000#", 52, &sooner), CO_ERR_AGAIN);
    queue(1, "7FF#FFFFFFFFFFFFFFFF", 52);
    ck_assert_int_eq(offer(0, "000#", 53, &sooner), CO_OK); /* the first is through */
    ck_assert_int_eq(offer(0, "000#", 53, &sooner), CO_ERR_AGAIN);
    move_on(CO_MS(100));
    for (unsigned i = 1; i <= SEGMENT_PENDING + 1; i++)
        expect("000#", i * 53);
    expect("7FF#FFFFFFFFFFFFFFFF", (SEGMENT_PENDING + 1) * 53 + 126);
    expect_nothing();
    close_wire();
}
END_TEST

START_TEST(sleepers_are_told_of_an_earlier_end_only)
{
    bool sooner;

    open_wire(1000000);
    ck_assert_uint_eq(segment_due(&segment), CO_NEVER);
    ck_assert_int_eq(offer(0, "705#7F", 0, &sooner), CO_OK);
    ck_assert(sooner);
    ck_assert_int_eq(offer(1, "000#", 1, &sooner), CO_OK); /* waits */
    ck_assert(!sooner);
    ck_assert_int_eq(offer(1, "000#", 60, &sooner), CO_OK); /* 705# is through, the next one on */
    ck_assert(!sooner);
    move_on(CO_MS(1));
    ck_assert_int_eq(offer(0, "705#7F", CO_MS(2), &sooner), CO_OK);
    ck_assert(sooner);
    ck_assert_int_eq(offer(1, "000#", CO_MS(2), &sooner), CO_OK); /* in the same microsecond */
    ck_assert(sooner);
    close_wire();
}
END_TEST

START_TEST(the_next_owner_of_a_slot_has_not_sent_what_is_left)
{
    open_wire(1000000);
    queue(1, "705#7F", 0);
    queue(1, "000#", 10);
    segment_free_slot(&segment, 1, 2);
    segment_take_slot(&segment, 1, 77);
    queue(1, "001#", 12);
    move_on(1000);
    ck_assert_uint_eq(expect("705#7F", 58).slot, SEGMENT_NOBODY);
    ck_assert_uint_eq(expect("000#", 111).slot, SEGMENT_NOBODY);
    ck_assert_uint_eq(expect("001#", 111 + bus_frame_bits(&(struct co_frame){ .id = 1 })).slot, 1);
    close_wire();
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("wire");
    const int time_count = sizeof times / sizeof times[0];

    tcase_add_loop_test(tests, a_frame_takes_its_time, 0, time_count);
    tcase_add_loop_test(tests, throughput_is_the_bit_rate, 0, time_count);
    tcase_add_test(tests, the_lowest_identifier_is_next);
    tcase_add_test(tests, who_comes_late_waits);
    tcase_add_test(tests, equal_identifiers_keep_their_order);
    tcase_add_test(tests, who_looks_late_finds_the_times_of_the_wire);
    tcase_add_test(tests, the_times_do_not_depend_on_who_looks_when);
    tcase_add_test(tests, a_full_queue_is_full_for_its_owner_only);
    tcase_add_test(tests, sleepers_are_told_of_an_earlier_end_only);
    tcase_add_test(tests, the_next_owner_of_a_slot_has_not_sent_what_is_left);
    return suite_run("bus_wire", tests);
}

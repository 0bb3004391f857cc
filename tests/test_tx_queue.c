/* The queue of frames that wait for the bus. */
#include "runtime/tx_queue.h"

#include "support/suite.h"

#include <stdlib.h>

static struct tx_queue *queue;

static void set_up(void)
{
    queue = calloc(1, sizeof *queue);
    ck_assert_ptr_nonnull(queue);
}

static void tear_down(void)
{
    free(queue);
}

static void put(uint32_t id, co_us_t now)
{
    struct co_frame frame = co_frame_make(id, 0);

    tx_queue_put(queue, &frame, now);
}

static bool takes(uint32_t id)
{
    struct co_frame frame = co_frame_make(id, 0);

    return tx_queue_takes(queue, &frame);
}

static void put_text(const char *text)
{
    struct co_frame frame;

    ck_assert(co_frame_parse(text, &frame));
    tx_queue_put(queue, &frame, 0);
}

static void expect(const char *text)
{
    char got[CO_FRAME_TEXT_SIZE];

    ck_assert_ptr_nonnull(tx_queue_first(queue));
    ck_assert_str_eq(co_frame_format(tx_queue_first(queue), got, sizeof got), text);
    tx_queue_sent(queue);
}

START_TEST(frames_come_out_in_order)
{
    ck_assert_ptr_null(tx_queue_first(queue));
    for (uint32_t round = 0; round < 3 * TX_QUEUE_SIZE; round += 2) {
        put(round % 0x7FF, round);
        put(round % 0x7FF + 1, round);
        ck_assert_uint_eq(tx_queue_first(queue)->id, round % 0x7FF);
        tx_queue_sent(queue);
        ck_assert_uint_eq(tx_queue_first(queue)->id, round % 0x7FF + 1);
        tx_queue_sent(queue);
        ck_assert_ptr_null(tx_queue_first(queue));
    }
    ck_assert_uint_eq(tx_queue_take_lost(queue), 0);
}
END_TEST

/* In the order of arbitration; those of one identifier stay as they came, whatever their kind. */
static const char *const ranked[] = { "000#8200",  "080#",        "605#01",      "605#R8",
                                      "605#02",    "18140000#01", "18140000#02", "18140001#",
                                      "1817FFFF#", "606#",        "70A#",        "1FFFFFFF#" };

#define RANKED (sizeof ranked / sizeof ranked[0])

START_TEST(the_lowest_identifier_is_first)
{
    static const unsigned orders[][RANKED] = {
        { 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 }, { 11, 10, 9, 8, 7, 5, 6, 2, 3, 4, 1, 0 },
        { 10, 2, 8, 0, 5, 3, 11, 6, 9, 4, 1, 7 }, { 2, 0, 3, 1, 4, 11, 5, 10, 6, 9, 7, 8 },
        { 5, 6, 2, 10, 9, 3, 11, 4, 1, 8, 0, 7 },
    };

    for (unsigned i = 0; i < RANKED; i++)
        put_text(ranked[orders[_i][i]]);
    for (unsigned i = 0; i < RANKED; i++)
        expect(ranked[i]);
    ck_assert_ptr_null(tx_queue_first(queue));
}
END_TEST

START_TEST(what_finds_no_room_is_counted)
{
    for (uint32_t i = 0; i < TX_QUEUE_SIZE; i++) {
        ck_assert(!tx_queue_is_full(queue));
        ck_assert(takes(0x7FF));
        put(i, 0);
    }
    ck_assert(tx_queue_is_full(queue));
    ck_assert(!takes(0x7FF));
    ck_assert(!takes(TX_QUEUE_SIZE - 1)); /* behind the last one, which has the same */
    ck_assert(takes(TX_QUEUE_SIZE - 2));
    ck_assert(takes(0));
    put(0x7FF, 0);
    put(TX_QUEUE_SIZE - 1, 0);
    ck_assert_uint_eq(tx_queue_take_lost(queue), 2);
    ck_assert_uint_eq(tx_queue_take_lost(queue), 0);
    for (uint32_t i = 0; i < TX_QUEUE_SIZE; i++) {
        ck_assert_uint_eq(tx_queue_first(queue)->id, i);
        tx_queue_sent(queue);
    }
    ck_assert_ptr_null(tx_queue_first(queue));
}
END_TEST

/* The one that would be sent last makes room. */
START_TEST(an_urgent_frame_finds_room)
{
    for (uint32_t i = 0; i < TX_QUEUE_SIZE; i++)
        put(0x100 + i, 0);
    put(0, 0);
    put(0x101, 0);
    ck_assert_uint_eq(tx_queue_take_lost(queue), 2);
    expect("000#");
    expect("100#");
    expect("101#");
    for (uint32_t i = 1; i < TX_QUEUE_SIZE - 2; i++) {
        ck_assert_uint_eq(tx_queue_first(queue)->id, 0x100 + i);
        tx_queue_sent(queue);
    }
    ck_assert_ptr_null(tx_queue_first(queue));
}
END_TEST

START_TEST(an_overtaken_frame_is_given_up_in_time)
{
    put(0x705, 1000);
    put(0x605, 2000);
    ck_assert(!tx_queue_give_up(queue, 1000 + TX_QUEUE_GIVE_UP));
    ck_assert_uint_eq(tx_queue_take_lost(queue), 1);
    expect("605#");
    ck_assert_ptr_null(tx_queue_first(queue));
    ck_assert(!tx_queue_give_up(queue, CO_NEVER - 1));
}
END_TEST

START_TEST(each_frame_has_its_own_time)
{
    const co_us_t limit = TX_QUEUE_GIVE_UP;

    put(1, 1000);
    put(2, 1000);
    put(3, 5000);
    ck_assert(!tx_queue_give_up(queue, 1000 + limit - 1));
    ck_assert_uint_eq(tx_queue_first(queue)->id, 1);
    ck_assert(tx_queue_give_up(queue, 1000 + limit)); /* the second has waited as long */
    ck_assert_uint_eq(tx_queue_take_lost(queue), 2);
    ck_assert(!tx_queue_give_up(queue, 5000 + limit - 1));
    ck_assert_uint_eq(tx_queue_first(queue)->id, 3);
    ck_assert(tx_queue_give_up(queue, 5000 + limit));
    ck_assert_ptr_null(tx_queue_first(queue));
    ck_assert_uint_eq(tx_queue_take_lost(queue), 1);
}
END_TEST

START_TEST(all_are_lost_at_once)
{
    for (uint32_t i = 0; i < 5; i++)
        put(i, i);
    tx_queue_lose_all(queue);
    ck_assert_ptr_null(tx_queue_first(queue));
    ck_assert_uint_eq(tx_queue_take_lost(queue), 5);
    put(9, 0);
    ck_assert_uint_eq(tx_queue_first(queue)->id, 9);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("tx_queue");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, frames_come_out_in_order);
    tcase_add_loop_test(tests, the_lowest_identifier_is_first, 0, 5);
    tcase_add_test(tests, an_urgent_frame_finds_room);
    tcase_add_test(tests, an_overtaken_frame_is_given_up_in_time);
    tcase_add_test(tests, what_finds_no_room_is_counted);
    tcase_add_test(tests, each_frame_has_its_own_time);
    tcase_add_test(tests, all_are_lost_at_once);
    return suite_run("tx_queue", tests);
}

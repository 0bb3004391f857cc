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

START_TEST(what_finds_no_room_is_counted)
{
    for (uint32_t i = 0; i < TX_QUEUE_SIZE; i++) {
        ck_assert(!tx_queue_is_full(queue));
        put(i, 0);
    }
    ck_assert(tx_queue_is_full(queue));
    put(0x7FF, 0);
    put(0x7FF, 0);
    ck_assert_uint_eq(tx_queue_take_lost(queue), 2);
    ck_assert_uint_eq(tx_queue_take_lost(queue), 0);
    for (uint32_t i = 0; i < TX_QUEUE_SIZE; i++) {
        ck_assert_uint_eq(tx_queue_first(queue)->id, i);
        tx_queue_sent(queue);
    }
    ck_assert_ptr_null(tx_queue_first(queue));
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
    ck_assert(tx_queue_give_up(queue, 1000 + limit));
    ck_assert(tx_queue_give_up(queue, 1000 + limit)); /* the second has waited as long */
    ck_assert(!tx_queue_give_up(queue, 5000 + limit - 1));
    ck_assert_uint_eq(tx_queue_first(queue)->id, 3);
    ck_assert(tx_queue_give_up(queue, 5000 + limit));
    ck_assert_ptr_null(tx_queue_first(queue));
    ck_assert_uint_eq(tx_queue_take_lost(queue), 3);
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
    tcase_add_test(tests, what_finds_no_room_is_counted);
    tcase_add_test(tests, each_frame_has_its_own_time);
    tcase_add_test(tests, all_are_lost_at_once);
    return suite_run("tx_queue", tests);
}

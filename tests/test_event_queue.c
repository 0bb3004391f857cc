/* The bounded queue between protocol threads and those who read events. */
#include "runtime/event_queue.h"

#include "port/clock.h"
#include "support/suite.h"

#include <unistd.h>

#define CAPACITY 4u
#define EACH     20000u
#define WRITERS  2u

static struct event_queue queue;

static void set_up(void)
{
    ck_assert_int_eq(event_queue_init(&queue, sizeof(unsigned), CAPACITY), CO_OK);
}

static void tear_down(void)
{
    event_queue_done(&queue);
}

static void put(unsigned value)
{
    event_queue_put(&queue, &value);
}

static unsigned take(void)
{
    unsigned value = 0;

    ck_assert_int_eq(event_queue_take(&queue, 0, &value), CO_OK);
    return value;
}

START_TEST(elements_come_out_in_order)
{
    for (unsigned i = 0; i < 100; i += 3) {
        put(i);
        put(i + 1);
        put(i + 2);
        ck_assert_uint_eq(take(), i);
        ck_assert_uint_eq(take(), i + 1);
        ck_assert_uint_eq(take(), i + 2);
    }
}
END_TEST

START_TEST(an_empty_queue_gives_nothing)
{
    unsigned value = 7;
    co_us_t deadline = clock_now() + CO_MS(20);

    ck_assert_int_eq(event_queue_take(&queue, 0, &value), CO_ERR_AGAIN);
    ck_assert_int_eq(event_queue_take(&queue, deadline, &value), CO_ERR_AGAIN);
    ck_assert_uint_ge(clock_now(), deadline);
    ck_assert_uint_eq(value, 7);
}
END_TEST

START_TEST(a_full_queue_drops_new_ones_and_counts_them)
{
    for (unsigned i = 0; i < CAPACITY + 3; i++)
        put(i);
    for (unsigned i = 0; i < CAPACITY; i++)
        ck_assert_uint_eq(take(), i);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 3);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
    put(99);
    ck_assert_uint_eq(take(), 99);
}
END_TEST

/* A reader who is never as far as the last element is told as well. */
START_TEST(losses_are_told_at_their_place)
{
    for (unsigned i = 0; i < CAPACITY + 1; i++)
        put(i);
    for (unsigned i = 0; i < CAPACITY; i++) {
        ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
        ck_assert_uint_eq(take(), i);
        put(100 + i);
        put(200 + i); /* lost, like the first one */
    }
    ck_assert_uint_eq(event_queue_take_lost(&queue), 1 + CAPACITY);
    ck_assert_uint_eq(take(), 100);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
}
END_TEST

START_TEST(closed_it_can_be_emptied_but_not_filled)
{
    unsigned value = 0;

    put(1);
    event_queue_close(&queue);
    put(2);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
    ck_assert_uint_eq(take(), 1);
    ck_assert_int_eq(event_queue_take(&queue, CO_NEVER, &value), CO_ERR_STATE);
    ck_assert_int_eq(event_queue_take(&queue, 0, &value), CO_ERR_STATE);
}
END_TEST

START_TEST(opened_again_it_is_empty)
{
    unsigned value = 0;

    for (unsigned i = 0; i < CAPACITY + 1; i++)
        put(i);
    event_queue_close(&queue);
    event_queue_open(&queue);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
    ck_assert_int_eq(event_queue_take(&queue, 0, &value), CO_ERR_AGAIN);
    put(5);
    ck_assert_uint_eq(take(), 5);
    ck_assert_uint_eq(event_queue_take_lost(&queue), 0);
}
END_TEST

/* --- with threads --- */

static void *wait_for_one(void *context)
{
    unsigned value = 0;

    *(enum co_err *)context = event_queue_take(&queue, CO_NEVER, &value);
    return NULL;
}

START_TEST(closing_ends_all_who_wait)
{
    struct co_thread threads[3];
    enum co_err results[3] = { CO_OK, CO_OK, CO_OK };

    for (unsigned i = 0; i < 3; i++)
        ck_assert_int_eq(thread_start(&threads[i], "waits", wait_for_one, &results[i]), CO_OK);
    usleep(20000); /* so that most of them do wait; it is right all the same if not */
    event_queue_close(&queue);
    for (unsigned i = 0; i < 3; i++) {
        thread_join(&threads[i]);
        ck_assert_int_eq(results[i], CO_ERR_STATE);
    }
}
END_TEST

static void *write_many(void *context)
{
    const unsigned *first = context;

    for (unsigned i = 0; i < EACH; i++)
        put(*first + i);
    return NULL;
}

/* Each writer's elements keep their order, and none vanishes without being counted. */
START_TEST(many_write_one_reads)
{
    struct co_thread threads[WRITERS];
    unsigned firsts[WRITERS] = { 0, EACH }, next[WRITERS] = { 0, EACH };
    unsigned value, taken = 0;

    for (unsigned i = 0; i < WRITERS; i++)
        ck_assert_int_eq(thread_start(&threads[i], "writes", write_many, &firsts[i]), CO_OK);
    for (unsigned lost = 0; taken + lost < WRITERS * EACH; lost += event_queue_take_lost(&queue)) {
        if (event_queue_take(&queue, 0, &value) != CO_OK)
            continue;
        ck_assert_uint_ge(value, next[value / EACH]);
        next[value / EACH] = value + 1;
        taken++;
    }
    for (unsigned i = 0; i < WRITERS; i++)
        thread_join(&threads[i]);
    ck_assert_uint_gt(taken, 0);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("event_queue");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, elements_come_out_in_order);
    tcase_add_test(tests, an_empty_queue_gives_nothing);
    tcase_add_test(tests, a_full_queue_drops_new_ones_and_counts_them);
    tcase_add_test(tests, losses_are_told_at_their_place);
    tcase_add_test(tests, closed_it_can_be_emptied_but_not_filled);
    tcase_add_test(tests, opened_again_it_is_empty);
    tcase_add_test(tests, closing_ends_all_who_wait);
    tcase_add_test(tests, many_write_one_reads);
    return suite_run("event_queue", tests);
}

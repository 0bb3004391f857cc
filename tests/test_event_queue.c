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

/* An element. */
static unsigned take(void)
{
    unsigned value = 0, lost = 99;

    ck_assert_int_eq(event_queue_take(&queue, 0, &value, &lost), CO_OK);
    ck_assert_uint_eq(lost, 0);
    return value;
}

/* A place where some are missing, and how many. */
static unsigned take_gap(void)
{
    unsigned value = 99, lost = 0;

    ck_assert_int_eq(event_queue_take(&queue, CO_NEVER, &value, &lost), CO_OK);
    ck_assert_uint_gt(lost, 0);
    ck_assert_uint_eq(value, 99);
    return lost;
}

static enum co_err try_to_take(co_us_t deadline)
{
    unsigned value = 7, lost = 8;
    enum co_err err = event_queue_take(&queue, deadline, &value, &lost);

    ck_assert_uint_eq(value, 7);
    ck_assert_uint_eq(lost, 8);
    return err;
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
    co_us_t deadline = clock_now() + CO_MS(20);

    ck_assert_int_eq(try_to_take(0), CO_ERR_AGAIN);
    ck_assert_int_eq(try_to_take(deadline), CO_ERR_AGAIN);
    ck_assert_uint_ge(clock_now(), deadline);
}
END_TEST

START_TEST(a_full_queue_drops_new_ones_and_counts_them)
{
    for (unsigned i = 0; i < CAPACITY + 3; i++)
        put(i);
    for (unsigned i = 0; i < CAPACITY; i++)
        ck_assert_uint_eq(take(), i);
    ck_assert_uint_eq(take_gap(), 3);
    ck_assert_int_eq(try_to_take(0), CO_ERR_AGAIN);
    put(99);
    ck_assert_uint_eq(take(), 99);
    ck_assert_uint_eq(event_queue_lost(&queue), 3);
}
END_TEST

/* Between the elements before and behind it, also for a reader who never comes to the end. */
START_TEST(each_loss_is_told_at_its_place)
{
    for (unsigned i = 0; i < CAPACITY + 1; i++)
        put(i); /* the last one is lost */
    for (unsigned i = 0; i < CAPACITY; i++) {
        ck_assert_uint_eq(take(), i);
        put(100 + i);
        put(200 + i); /* lost */
    }
    for (unsigned i = 0; i < CAPACITY; i++) {
        ck_assert_uint_eq(take_gap(), 1);
        ck_assert_uint_eq(take(), 100 + i);
    }
    ck_assert_uint_eq(take_gap(), 1);
    ck_assert_int_eq(try_to_take(0), CO_ERR_AGAIN);
    ck_assert_uint_eq(event_queue_lost(&queue), 1 + CAPACITY);
}
END_TEST

START_TEST(closed_it_can_be_emptied_but_not_filled)
{
    put(1);
    event_queue_close(&queue);
    put(2);
    ck_assert_uint_eq(take(), 1);
    ck_assert_int_eq(try_to_take(CO_NEVER), CO_ERR_STATE);
    ck_assert_int_eq(try_to_take(0), CO_ERR_STATE);
    ck_assert_uint_eq(event_queue_lost(&queue), 0);
}
END_TEST

START_TEST(opened_again_it_is_empty)
{
    for (unsigned i = 0; i < CAPACITY + 1; i++)
        put(i);
    event_queue_close(&queue);
    event_queue_open(&queue);
    ck_assert_uint_eq(event_queue_lost(&queue), 0);
    ck_assert_int_eq(try_to_take(0), CO_ERR_AGAIN);
    put(5);
    ck_assert_uint_eq(take(), 5);
    ck_assert_int_eq(try_to_take(0), CO_ERR_AGAIN);
}
END_TEST

/* --- with threads --- */

static void *wait_for_one(void *context)
{
    unsigned value = 0, lost = 0;

    *(enum co_err *)context = event_queue_take(&queue, CO_NEVER, &value, &lost);
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
    unsigned value, gap, taken = 0, lost = 0;

    for (unsigned i = 0; i < WRITERS; i++)
        ck_assert_int_eq(thread_start(&threads[i], "writes", write_many, &firsts[i]), CO_OK);
    while (taken + lost < WRITERS * EACH) {
        if (event_queue_take(&queue, 0, &value, &gap) != CO_OK)
            continue;
        lost += gap;
        if (gap > 0)
            continue;
        ck_assert_uint_ge(value, next[value / EACH]);
        next[value / EACH] = value + 1;
        taken++;
    }
    for (unsigned i = 0; i < WRITERS; i++)
        thread_join(&threads[i]);
    ck_assert_uint_gt(taken, 0);
    ck_assert_uint_eq(event_queue_lost(&queue), lost);
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
    tcase_add_test(tests, each_loss_is_told_at_its_place);
    tcase_add_test(tests, closed_it_can_be_emptied_but_not_filled);
    tcase_add_test(tests, opened_again_it_is_empty);
    tcase_add_test(tests, closing_ends_all_who_wait);
    tcase_add_test(tests, many_write_one_reads);
    return suite_run("event_queue", tests);
}

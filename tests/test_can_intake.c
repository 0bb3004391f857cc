/*
 * Waiting for and fetching of messages, by io_uring and by poll(): each test runs both ways, on a
 * pair of sockets that keeps messages apart as a CAN socket does.
 */
#include "port/can_intake.h"

#include "port/clock.h"
#include "support/suite.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/time.h>
#include <unistd.h>

#define PATIENCE CO_MS(20000)
#define SKIPPED  77

enum { BY_POLL, BY_RING, WAYS };

static const struct socketcan_calls calls[WAYS] = {
    [BY_POLL] = { .recvmmsg = recvmmsg },
    [BY_RING] = { .recvmmsg = recvmmsg, .io_uring_setup = io_ring_setup },
};

static struct can_intake intake;
static int sender, news;

static void open_intake(int way)
{
    int pair[2], on = 1;

    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_SEQPACKET, 0, pair), 0);
    ck_assert_int_eq(setsockopt(pair[0], SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on), 0);
    sender = pair[1];
    news = eventfd(0, EFD_NONBLOCK);
    intake = (struct can_intake){ .calls = &calls[way], .fd = pair[0], .news = news, .wake = -1 };
    ck_assert_int_eq(can_intake_open(&intake), CO_OK);
    ck_assert_int_eq(intake.has_ring, way == BY_RING);
}

static void close_intake(void)
{
    can_intake_close(&intake);
    close(intake.fd);
    close(news);
    if (sender >= 0)
        close(sender);
}

static void put(unsigned number)
{
    const struct can_frame frame = { .can_id = number };

    ck_assert_int_eq(write(sender, &frame, sizeof frame), sizeof frame);
}

static enum co_err wait_until(co_us_t deadline)
{
    bool has_news;

    return can_intake_wait(&intake, deadline, &has_news);
}

static void expect_number(const struct can_message *message, unsigned number)
{
    ck_assert_ptr_nonnull(message);
    ck_assert_int_eq(message->result, sizeof(struct can_frame));
    ck_assert_uint_eq(message->frame.can_id, number);
    ck_assert_uint_ge(message->head.msg_controllen, CMSG_SPACE(sizeof(struct timespec)));
}

/* The next one that was fetched, or is by waiting. */
static void expect(unsigned number)
{
    while (!can_intake_has(&intake))
        ck_assert_int_eq(wait_until(clock_now() + PATIENCE), CO_OK);
    expect_number(can_intake_take(&intake), number);
}

static void expect_timeout(co_us_t us)
{
    co_us_t deadline = clock_now() + us;

    ck_assert_int_eq(wait_until(deadline), CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
}

/* --- messages --- */

START_TEST(what_has_come_is_fetched_in_order)
{
    open_intake(_i);
    for (unsigned n = 0; n < 50; n++)
        put(n);
    for (unsigned n = 0; n < 50; n++)
        expect(n);
    ck_assert(!can_intake_has(&intake));
    ck_assert_ptr_null(can_intake_take(&intake));
    expect_timeout(CO_MS(5));
    close_intake();
}
END_TEST

START_TEST(several_come_with_one_wait)
{
    unsigned count = 0;

    open_intake(_i);
    for (unsigned n = 0; n < INTAKE_MESSAGES + 4; n++)
        put(n);
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    for (; can_intake_has(&intake); count++)
        expect_number(can_intake_take(&intake), count);
    ck_assert_uint_eq(count, INTAKE_MESSAGES);
    for (; count < INTAKE_MESSAGES + 4; count++)
        expect(count);
    expect_timeout(CO_MS(5));
    close_intake();
}
END_TEST

START_TEST(a_message_ends_the_wait_until_it_is_taken)
{
    open_intake(_i);
    put(1);
    for (unsigned i = 0; i < 3; i++)
        ck_assert_int_eq(wait_until(0), CO_OK);
    expect_number(can_intake_take(&intake), 1);
    ck_assert_int_eq(wait_until(0), CO_ERR_TIMEOUT);
    close_intake();
}
END_TEST

/* Before the first wait, and while requests are with the kernel. */
START_TEST(they_are_there_without_a_wait)
{
    open_intake(_i);
    ck_assert_ptr_null(can_intake_take(&intake));
    put(1);
    put(2);
    expect_number(can_intake_take(&intake), 1);
    expect_number(can_intake_take(&intake), 2);
    ck_assert_ptr_null(can_intake_take(&intake));
    expect_timeout(CO_MS(1));
    for (unsigned n = 3; n < 30; n++)
        put(n);
    for (unsigned n = 3; n < 30; n++)
        expect_number(can_intake_take(&intake), n);
    ck_assert_ptr_null(can_intake_take(&intake));
    put(30);
    expect(30);
    close_intake();
}
END_TEST

static unsigned next_random(unsigned *seed)
{
    *seed = *seed * 1103515245u + 12345u;
    return *seed >> 16;
}

START_TEST(in_any_order_of_calls)
{
    unsigned seed = (unsigned)_i, sent = 0, received = 0;

    open_intake(_i % WAYS);
    for (unsigned step = 0; step < 2000; step++) {
        switch (next_random(&seed) % 4) {
        case 0:
        case 1: put(sent++); break;
        case 2: wait_until(0); break;
        default:
            if (received < sent)
                expect_number(can_intake_take(&intake), received++);
            else
                ck_assert_ptr_null(can_intake_take(&intake));
            break;
        }
        while (sent - received > 40)
            expect(received++);
    }
    while (received < sent)
        expect(received++);
    ck_assert_ptr_null(can_intake_take(&intake));
    close_intake();
}
END_TEST

START_TEST(errors_are_messages)
{
    struct can_message *message;

    open_intake(_i);
    ck_assert_int_eq(write(intake.fd, "", 1), 1); /* what nobody has read makes it a reset */
    put(1);
    close(sender);
    sender = -1;
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    message = can_intake_take(&intake);
    ck_assert_ptr_nonnull(message);
    while (message && message->result == sizeof(struct can_frame))
        message = can_intake_take(&intake);
    ck_assert_ptr_nonnull(message);
    ck_assert_int_eq(message->result, -ECONNRESET);
    close_intake();
}
END_TEST

/* --- deadlines --- */

START_TEST(deadlines_move_both_ways)
{
    open_intake(_i);
    put(1);
    ck_assert_int_eq(wait_until(clock_now() + PATIENCE), CO_OK);
    expect(1);
    expect_timeout(CO_MS(10)); /* nearer than the one before */
    put(2);
    ck_assert_int_eq(wait_until(clock_now() + CO_MS(10)), CO_OK);
    expect(2);
    expect_timeout(CO_MS(30)); /* farther: the alarm goes off before */
    expect_timeout(CO_MS(1));
    ck_assert_int_eq(wait_until(0), CO_ERR_TIMEOUT);
    ck_assert_int_eq(wait_until(clock_now() - CO_MS(1)), CO_ERR_TIMEOUT);
    close_intake();
}
END_TEST

/* A frame that is there when the deadline is over is fetched, not missed. */
START_TEST(late_is_not_too_late)
{
    open_intake(_i);
    for (unsigned n = 0; n < 100; n++) {
        put(n);
        ck_assert_int_eq(wait_until(n % 2 ? clock_now() : 0), CO_OK);
        expect_number(can_intake_take(&intake), n);
    }
    close_intake();
}
END_TEST

START_TEST(many_deadlines)
{
    unsigned seed = 1;

    open_intake(_i);
    for (unsigned n = 0; n < 300; n++) {
        co_us_t far = next_random(&seed) % 2 ? CO_NEVER : clock_now() + PATIENCE;

        if (next_random(&seed) % 4 == 0)
            expect_timeout(next_random(&seed) % 300);
        put(n);
        ck_assert_int_eq(wait_until(far - next_random(&seed)), CO_OK);
        expect_number(can_intake_take(&intake), n);
    }
    close_intake();
}
END_TEST

/* --- what else ends a wait --- */

START_TEST(a_wake_up_ends_one_wait)
{
    open_intake(_i);
    can_intake_wake(&intake);
    can_intake_wake(&intake);
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    ck_assert(!can_intake_has(&intake));
    expect_timeout(CO_MS(5));
    can_intake_wake(&intake);
    ck_assert_ptr_null(can_intake_take(&intake)); /* which may have seen it */
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    expect_timeout(CO_MS(5));
    close_intake();
}
END_TEST

START_TEST(news_are_told_while_there_are_some)
{
    const uint64_t one = 1;
    uint64_t count;
    bool has_news = false;

    open_intake(_i);
    expect_timeout(CO_MS(1));
    ck_assert_int_eq(write(news, &one, sizeof one), sizeof one);
    for (unsigned i = 0; i < 3; i++) {
        ck_assert_int_eq(can_intake_wait(&intake, CO_NEVER, &has_news), CO_OK);
        ck_assert(has_news);
    }
    ck_assert_int_eq(read(news, &count, sizeof count), sizeof count);
    put(1);
    ck_assert_int_eq(can_intake_wait(&intake, CO_NEVER, &has_news), CO_OK);
    expect(1);
    while (can_intake_wait(&intake, clock_now(), &has_news) != CO_ERR_TIMEOUT)
        ; /* one that was on its way */
    ck_assert_int_eq(can_intake_wait(&intake, 0, &has_news), CO_ERR_TIMEOUT);
    ck_assert(!has_news);
    close_intake();
}
END_TEST

static void on_signal(int number)
{
    (void)number;
}

START_TEST(a_signal_ends_it)
{
    const struct sigaction action = { .sa_handler = on_signal };
    const struct itimerval soon = { .it_value = { .tv_usec = 20000 } };

    open_intake(_i);
    expect_timeout(CO_MS(1));
    ck_assert_int_eq(sigaction(SIGALRM, &action, NULL), 0);
    ck_assert_int_eq(setitimer(ITIMER_REAL, &soon, NULL), 0);
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    ck_assert(!can_intake_has(&intake));
    close_intake();
}
END_TEST

/* --- with other threads --- */

#define MANY 20000u

static void *put_many(void *context)
{
    (void)context;
    for (unsigned n = 0; n < MANY; n++) {
        put(n);
        if (n % 16 == 0)
            can_intake_wake(&intake);
    }
    return NULL;
}

START_TEST(others_send_and_wake)
{
    pthread_t thread;

    open_intake(_i);
    ck_assert_int_eq(pthread_create(&thread, NULL, put_many, NULL), 0);
    for (unsigned n = 0; n < MANY; n++)
        expect(n);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    close_intake();
}
END_TEST

static void *wait_in_vain(void *context)
{
    (void)context;
    wait_until(clock_now() + CO_MS(1));
    return NULL;
}

/* Its requests end with it. */
START_TEST(another_thread_goes_on)
{
    open_intake(_i);
    for (unsigned n = 0; n < 3; n++) {
        pthread_t thread;

        ck_assert_int_eq(pthread_create(&thread, NULL, wait_in_vain, NULL), 0);
        ck_assert_int_eq(pthread_join(thread, NULL), 0);
        put(n);
        if (n == 1)
            expect_number(can_intake_take(&intake), n);
        else
            expect(n);
        expect_timeout(CO_MS(1));
    }
    close_intake();
}
END_TEST

START_TEST(closed_while_requests_are_with_the_kernel)
{
    pthread_t thread;

    open_intake(_i);
    expect_timeout(CO_MS(1));
    close_intake();
    open_intake(_i);
    ck_assert_int_eq(pthread_create(&thread, NULL, wait_in_vain, NULL), 0);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    close_intake();
    open_intake(_i);
    put(1);
    put(2);
    ck_assert_int_eq(wait_until(CO_NEVER), CO_OK);
    close_intake();
}
END_TEST

/* --- a kernel without io_uring --- */

static int refuse_setup(unsigned entries, struct io_uring_params *params)
{
    (void)entries;
    (void)params;
    errno = EPERM;
    return -1;
}

START_TEST(where_it_is_forbidden_poll_does)
{
    const struct socketcan_calls refused = { .recvmmsg = recvmmsg, .io_uring_setup = refuse_setup };

    open_intake(BY_POLL);
    can_intake_close(&intake);
    intake.calls = &refused;
    ck_assert_int_eq(can_intake_open(&intake), CO_OK);
    ck_assert(!intake.has_ring);
    put(1);
    expect(1);
    close_intake();
}
END_TEST

static bool has_io_uring(void)
{
    struct io_ring ring;
    enum co_err err = io_ring_open(&ring, 8, io_ring_setup);

    io_ring_close(&ring);
    return err == CO_OK;
}

int main(void)
{
    TCase *tests = tcase_create("both ways");

    if (!has_io_uring()) {
        printf("not run: this kernel has no io_uring for us\n");
        return SKIPPED;
    }
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, what_has_come_is_fetched_in_order, 0, WAYS);
    tcase_add_loop_test(tests, several_come_with_one_wait, 0, WAYS);
    tcase_add_loop_test(tests, a_message_ends_the_wait_until_it_is_taken, 0, WAYS);
    tcase_add_loop_test(tests, they_are_there_without_a_wait, 0, WAYS);
    tcase_add_loop_test(tests, in_any_order_of_calls, 0, 20 * WAYS);
    tcase_add_loop_test(tests, errors_are_messages, 0, WAYS);
    tcase_add_loop_test(tests, deadlines_move_both_ways, 0, WAYS);
    tcase_add_loop_test(tests, late_is_not_too_late, 0, WAYS);
    tcase_add_loop_test(tests, many_deadlines, 0, WAYS);
    tcase_add_loop_test(tests, a_wake_up_ends_one_wait, 0, WAYS);
    tcase_add_loop_test(tests, news_are_told_while_there_are_some, 0, WAYS);
    tcase_add_loop_test(tests, a_signal_ends_it, 0, WAYS);
    tcase_add_loop_test(tests, others_send_and_wake, 0, WAYS);
    tcase_add_loop_test(tests, another_thread_goes_on, 0, WAYS);
    tcase_add_loop_test(tests, closed_while_requests_are_with_the_kernel, 0, WAYS);
    tcase_add_test(tests, where_it_is_forbidden_poll_does);
    return suite_run("can_intake", tests);
}

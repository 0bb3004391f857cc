#include "port/thread.h"

#include "port/clock.h"

#include <check.h>
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

struct shared {
    struct co_lock lock;
    struct co_condition condition;
    struct co_thread thread;
    unsigned turns;
    char name[16];
    bool signals_blocked;
    bool stop;
};

static void shared_init(struct shared *self)
{
    memset(self, 0, sizeof *self);
    ck_assert_int_eq(lock_init(&self->lock), CO_OK);
    ck_assert_int_eq(condition_init(&self->condition), CO_OK);
}

static void shared_done(struct shared *self)
{
    thread_join(&self->thread);
    condition_done(&self->condition);
    lock_done(&self->lock);
}

static bool all_signals_blocked(void)
{
    static const int signals[] = { SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGUSR1, SIGCHLD, SIGPIPE };
    sigset_t set;

    pthread_sigmask(SIG_SETMASK, NULL, &set);
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        if (!sigismember(&set, signals[i]))
            return false;
    }
    return true;
}

/* Looks at itself, then stays until told to stop. */
static void *look_and_stay(void *context)
{
    struct shared *self = context;

    lock_take(&self->lock);
    self->signals_blocked = all_signals_blocked();
    self->turns++;
    condition_signal(&self->condition);
    while (!self->stop)
        condition_wait(&self->condition, &self->lock, CO_NEVER);
    pthread_getname_np(pthread_self(), self->name, sizeof self->name);
    lock_give(&self->lock);
    return NULL;
}

/* With the lock taken before, so that the thread does not look at *self too early. */
static void start(struct shared *self, const char *name)
{
    lock_take(&self->lock);
    ck_assert_int_eq(thread_start(&self->thread, name, look_and_stay, self), CO_OK);
    while (self->turns == 0)
        ck_assert_int_eq(condition_wait(&self->condition, &self->lock, clock_now() + CO_MS(20000)),
                         CO_OK);
    lock_give(&self->lock);
}

static void stop(struct shared *self)
{
    lock_take(&self->lock);
    self->stop = true;
    condition_signal(&self->condition);
    lock_give(&self->lock);
    thread_join(&self->thread);
}

START_TEST(a_thread_has_its_name_and_blocks_signals)
{
    struct shared shared;
    sigset_t before, after;

    shared_init(&shared);
    pthread_sigmask(SIG_SETMASK, NULL, &before);
    start(&shared, "protocol-thread-of-net-7");
    pthread_sigmask(SIG_SETMASK, NULL, &after);
    stop(&shared);
    ck_assert_str_eq(shared.name, "protocol-thread");
    ck_assert(shared.signals_blocked);
    ck_assert(!shared.thread.running);
    ck_assert_int_eq(sigismember(&before, SIGTERM), sigismember(&after, SIGTERM));
    shared_done(&shared);
}
END_TEST

START_TEST(a_thread_never_started_can_be_joined)
{
    struct co_thread thread = { .running = false };

    thread_join(&thread);
    ck_assert_int_eq(thread_set_priority(&thread, 5), CO_ERR_STATE);
}
END_TEST

START_TEST(a_wait_ends_at_its_deadline)
{
    struct shared shared;
    co_us_t deadline = clock_now() + CO_MS(20);
    enum co_err err;

    shared_init(&shared);
    lock_take(&shared.lock);
    do
        err = condition_wait(&shared.condition, &shared.lock, deadline);
    while (err == CO_OK);
    ck_assert_int_eq(err, CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
    ck_assert_uint_lt(clock_now(), deadline + CO_MS(10000));
    ck_assert_int_eq(condition_wait(&shared.condition, &shared.lock, 0), CO_ERR_TIMEOUT);
    lock_give(&shared.lock);
    shared_done(&shared);
}
END_TEST

#define MINE   2u
#define OTHERS 5u

static void *wait_for_mine(void *context)
{
    struct shared *self = context;

    lock_take(&self->lock);
    while (!self->stop)
        condition_wait_as(&self->condition, MINE, &self->lock, CO_NEVER);
    lock_give(&self->lock);
    return NULL;
}

/* What is for others does not wake it; after that, what is for it, among others, does. */
START_TEST(who_waits_for_something_is_woken_for_that)
{
    struct shared shared;

    shared_init(&shared);
    ck_assert_int_eq(thread_start(&shared.thread, "waits", wait_for_mine, &shared), CO_OK);
    while (atomic_load(&shared.condition.waiting) == 0)
        sched_yield();
    condition_signal_to(&shared.condition, OTHERS);
    lock_take(&shared.lock);
    shared.stop = true;
    lock_give(&shared.lock);
    condition_signal_to(&shared.condition, OTHERS | MINE);
    shared_done(&shared);
}
END_TEST

START_TEST(who_waits_for_anything_is_woken_for_each)
{
    struct shared shared;

    shared_init(&shared);
    start(&shared, "waits");
    lock_take(&shared.lock);
    shared.stop = true;
    lock_give(&shared.lock);
    condition_signal_to(&shared.condition, MINE);
    shared_done(&shared);
}
END_TEST

static void *count_up(void *context)
{
    struct shared *self = context;

    for (unsigned i = 0; i < 20000; i++) {
        lock_take(&self->lock);
        self->turns++;
        lock_give(&self->lock);
    }
    return NULL;
}

START_TEST(a_lock_excludes)
{
    struct shared shared;
    struct co_thread second;

    shared_init(&shared);
    ck_assert_int_eq(thread_start(&shared.thread, "first", count_up, &shared), CO_OK);
    ck_assert_int_eq(thread_start(&second, "second", count_up, &shared), CO_OK);
    count_up(&shared);
    thread_join(&second);
    thread_join(&shared.thread);
    ck_assert_uint_eq(shared.turns, 60000);
    shared_done(&shared);
}
END_TEST

START_TEST(a_lock_inherits_priority)
{
    struct co_lock lock;
    pthread_mutex_t plain = PTHREAD_MUTEX_INITIALIZER;
    int is_inheriting, plain_is;

    /* glibc keeps the protocol in bit 5 of the kind; a plain mutex shows that the bit tells it. */
    ck_assert_int_eq(lock_init(&lock), CO_OK);
    is_inheriting = lock.mutex.__data.__kind & 32;
    plain_is = plain.__data.__kind & 32;
    ck_assert_int_eq(plain_is, 0);
    ck_assert_int_ne(is_inheriting, 0);
    lock_done(&lock);
}
END_TEST

START_TEST(a_priority_is_set_or_refused)
{
    struct shared shared;
    struct sched_param parameters;
    int policy;
    enum co_err err;

    shared_init(&shared);
    start(&shared, "priority");
    ck_assert_int_eq(thread_set_priority(&shared.thread, 0), CO_OK);
    ck_assert_int_eq(thread_set_priority(&shared.thread, 100), CO_ERR_ARG);
    err = thread_set_priority(&shared.thread, 7);
    ck_assert_int_eq(pthread_getschedparam(shared.thread.id, &policy, &parameters), 0);
    if (err == CO_OK) {
        ck_assert_int_eq(policy, SCHED_FIFO);
        ck_assert_int_eq(parameters.sched_priority, 7);
    } else {
        ck_assert_int_eq(err, CO_ERR_PERMISSION);
        ck_assert_int_eq(policy, SCHED_OTHER);
    }
    stop(&shared);
    shared_done(&shared);
}
END_TEST

START_TEST(the_portable_scale_is_linear)
{
    ck_assert_int_eq(thread_native_priority(0), 1);
    ck_assert_int_eq(thread_native_priority(31), 49);
    ck_assert_int_eq(thread_native_priority(-1), 1);
    ck_assert_int_eq(thread_native_priority(32), 49);
    for (int i = 0; i < 31; i++) {
        int step = thread_native_priority(i + 1) - thread_native_priority(i);

        ck_assert_int_ge(step, 1);
        ck_assert_int_le(step, 2);
    }
}
END_TEST

START_TEST(the_clock_is_the_monotonic_one)
{
    co_us_t first = clock_now(), second = clock_now();
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    ck_assert_uint_le(first, second);
    ck_assert_uint_le(second, (co_us_t)now.tv_sec * 1000000u + (co_us_t)now.tv_nsec / 1000u);
    ck_assert_uint_lt((co_us_t)now.tv_sec * 1000000u, second + CO_MS(10000));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("thread");
    TCase *tests = tcase_create("all");
    SRunner *runner;
    int failed;

    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, a_thread_has_its_name_and_blocks_signals);
    tcase_add_test(tests, a_thread_never_started_can_be_joined);
    tcase_add_test(tests, a_wait_ends_at_its_deadline);
    tcase_add_test(tests, who_waits_for_something_is_woken_for_that);
    tcase_add_test(tests, who_waits_for_anything_is_woken_for_each);
    tcase_add_test(tests, a_lock_excludes);
    tcase_add_test(tests, a_lock_inherits_priority);
    tcase_add_test(tests, a_priority_is_set_or_refused);
    tcase_add_test(tests, the_portable_scale_is_linear);
    tcase_add_test(tests, the_clock_is_the_monotonic_one);
    suite_add_tcase(suite, tests);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

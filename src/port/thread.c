#include "port/thread.h"

#include <assert.h>
#include <errno.h>
#include <limits.h>
#include <linux/futex.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <sys/syscall.h>
#include <unistd.h>

#define NAME_SIZE 16 /* of the kernel, the end included */

enum co_err lock_init(struct co_lock *self)
{
    pthread_mutexattr_t attributes;
    int error = pthread_mutexattr_init(&attributes);

    if (error)
        return CO_ERR_MEMORY;
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    error = pthread_mutex_init(&self->mutex, &attributes);
    pthread_mutexattr_destroy(&attributes);
    return error ? CO_ERR_MEMORY : CO_OK;
}

void lock_done(struct co_lock *self)
{
    pthread_mutex_destroy(&self->mutex);
}

void lock_take(struct co_lock *self)
{
    int error = pthread_mutex_lock(&self->mutex);

    assert(error == 0);
    (void)error;
}

void lock_give(struct co_lock *self)
{
    int error = pthread_mutex_unlock(&self->mutex);

    assert(error == 0);
    (void)error;
}

/* What the system call takes, whatever time_t the C library has. */
struct kernel_time {
    long seconds, nanoseconds;
};

/* The operation's private form: no other process has this word. */
static int call_futex(_Atomic uint32_t *word, int operation, uint32_t value,
                      const struct kernel_time *until, uint32_t bits)
{
    const long result = syscall(SYS_futex, word, operation | FUTEX_PRIVATE_FLAG, value, until, NULL,
                                bits);

    return result < 0 ? errno : 0;
}

enum co_err condition_init(struct co_condition *self)
{
    atomic_init(&self->turn, 0);
    atomic_init(&self->waiting, 0);
    return CO_OK;
}

void condition_done(struct co_condition *self)
{
    assert(atomic_load(&self->waiting) == 0);
    (void)self;
}

void condition_signal_to(struct co_condition *self, uint32_t bits)
{
    atomic_fetch_add(&self->turn, 1);
    if (atomic_load(&self->waiting) > 0)
        call_futex(&self->turn, FUTEX_WAKE_BITSET, INT_MAX, NULL, bits);
}

void condition_signal(struct co_condition *self)
{
    condition_signal_to(self, CONDITION_ALL);
}

/* A deadline too far away for 32 bits of seconds is never reached all the same. */
static bool is_reachable(co_us_t deadline)
{
    return deadline / 1000000u < INT32_MAX;
}

/*
 * Where the lock is not given before the turn has been read, no signal is missed. The C library's
 * conditions do the same, but leave a lock that inherits priority marked as contended: then giving
 * it takes a system call.
 */
enum co_err condition_wait_as(struct co_condition *self, uint32_t bits, struct co_lock *lock,
                              co_us_t deadline)
{
    const struct kernel_time until = { (long)(deadline / 1000000u),
                                       (long)(deadline % 1000000u) * 1000 };
    const uint32_t turn = atomic_load(&self->turn);
    int error;

    atomic_fetch_add(&self->waiting, 1);
    lock_give(lock);
    error = call_futex(&self->turn, FUTEX_WAIT_BITSET, turn, is_reachable(deadline) ? &until : NULL,
                       bits);
    atomic_fetch_sub(&self->waiting, 1);
    lock_take(lock);
    assert(error == 0 || error == EAGAIN || error == EINTR || error == ETIMEDOUT);
    return error == ETIMEDOUT ? CO_ERR_TIMEOUT : CO_OK;
}

enum co_err condition_wait(struct co_condition *self, struct co_lock *lock, co_us_t deadline)
{
    return condition_wait_as(self, CONDITION_ALL, lock, deadline);
}

enum co_err thread_start(struct co_thread *self, const char *name, void *(*run)(void *context),
                         void *context)
{
    char short_name[NAME_SIZE];
    sigset_t all, before;
    int error;

    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before); /* a new thread inherits it */
    error = pthread_create(&self->id, NULL, run, context);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    self->running = error == 0;
    if (error)
        return CO_ERR_MEMORY;
    snprintf(short_name, sizeof short_name, "%s", name);
    pthread_setname_np(self->id, short_name);
    return CO_OK;
}

void thread_join(struct co_thread *self)
{
    if (!self->running)
        return;
    pthread_join(self->id, NULL);
    self->running = false;
}

enum co_err thread_set_priority(struct co_thread *self, int native)
{
    struct sched_param parameters = { .sched_priority = native };

    if (native == 0)
        return CO_OK;
    if (!self->running)
        return CO_ERR_STATE;
    switch (pthread_setschedparam(self->id, SCHED_FIFO, &parameters)) {
    case 0: return CO_OK;
    case EINVAL: return CO_ERR_ARG;
    default: return CO_ERR_PERMISSION;
    }
}

int thread_native_priority(int portable)
{
    if (portable < 0)
        portable = 0;
    if (portable > 31)
        portable = 31;
    return 1 + portable * 48 / 31;
}

#include "port/thread.h"

#include <assert.h>
#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>

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

enum co_err condition_init(struct co_condition *self)
{
    pthread_condattr_t attributes;
    int error = pthread_condattr_init(&attributes);

    if (error)
        return CO_ERR_MEMORY;
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    error = pthread_cond_init(&self->condition, &attributes);
    pthread_condattr_destroy(&attributes);
    return error ? CO_ERR_MEMORY : CO_OK;
}

void condition_done(struct co_condition *self)
{
    pthread_cond_destroy(&self->condition);
}

void condition_signal(struct co_condition *self)
{
    pthread_cond_broadcast(&self->condition);
}

/* A deadline too far away for time_t (32 bits on some machines) is never reached all the same. */
static bool is_reachable(co_us_t deadline)
{
    return deadline / 1000000u < INT32_MAX;
}

enum co_err condition_wait(struct co_condition *self, struct co_lock *lock, co_us_t deadline)
{
    struct timespec until;
    int error;

    if (!is_reachable(deadline)) {
        error = pthread_cond_wait(&self->condition, &lock->mutex);
    } else {
        until.tv_sec = (time_t)(deadline / 1000000u);
        until.tv_nsec = (long)(deadline % 1000000u) * 1000;
        error = pthread_cond_timedwait(&self->condition, &lock->mutex, &until);
    }
    assert(error == 0 || error == ETIMEDOUT);
    return error == ETIMEDOUT ? CO_ERR_TIMEOUT : CO_OK;
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

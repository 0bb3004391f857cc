/*
 * Threads, locks and conditions over pthreads, as this stack needs them: locks inherit priority,
 * conditions wait on the monotonic clock, threads block all signals.
 */
#ifndef CO_PORT_THREAD_H
#define CO_PORT_THREAD_H

#include "base/error.h"
#include "base/time.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>

struct co_lock {
    pthread_mutex_t mutex;
};

struct co_condition {
    _Atomic uint32_t turn; /* another one with each signal; what the kernel compares */
    _Atomic uint32_t waiting;
};

#define CONDITION_ALL UINT32_MAX /* bits of all who wait */

struct co_thread {
    pthread_t id;
    bool running;
};

enum co_err lock_init(struct co_lock *self);
void lock_done(struct co_lock *self);
void lock_take(struct co_lock *self);
void lock_give(struct co_lock *self);

enum co_err condition_init(struct co_condition *self);
/* Nobody waits any more. */
void condition_done(struct co_condition *self);
/*
 * Wakes all who wait. With the lock or without: those who are woken want it at once, so it is
 * better given before.
 */
void condition_signal(struct co_condition *self);
/* Gives the lock while waiting. CO_ERR_TIMEOUT at the deadline (CO_NEVER: none); may wake early. */
enum co_err condition_wait(struct co_condition *self, struct co_lock *lock, co_us_t deadline);
/* The same where not all wait for the same: only those who have one of these bits are woken. */
void condition_signal_to(struct co_condition *self, uint32_t bits);
enum co_err condition_wait_as(struct co_condition *self, uint32_t bits, struct co_lock *lock,
                              co_us_t deadline);

/* name: at most 15 characters. CO_ERR_MEMORY */
enum co_err thread_start(struct co_thread *self, const char *name, void *(*run)(void *context),
                         void *context);
/* Waits for its end; nothing if it was never started. */
void thread_join(struct co_thread *self);
/*
 * SCHED_FIFO with a native priority 1..99; 0: leave as it is. CO_ERR_PERMISSION without the right:
 * the thread runs on as before.
 */
enum co_err thread_set_priority(struct co_thread *self, int native);
/* The portable scale 0 (lowest) .. 31 as SCHED_FIFO 1..49, linear. */
int thread_native_priority(int portable);

#endif

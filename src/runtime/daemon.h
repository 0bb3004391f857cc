/*
 * A thread of the library that runs code of the application: takes what has been put for it, one
 * element at a time, in order.
 *
 *   in   elements of one size, from protocol threads and API calls; put never waits
 *   out  calls of its owner's function
 *
 *   locking  its queue has a lock of its own, taken last (docs/threading.md); none is held while
 *            the owner's function runs
 */
#ifndef CO_RUNTIME_DAEMON_H
#define CO_RUNTIME_DAEMON_H

#include "runtime/event_queue.h"

#define DAEMON_ELEMENT_MAX 128u

struct daemon {
    struct event_queue queue;
    struct co_thread thread;
    void (*work)(void *context, const void *element);
    void (*lost)(void *context, unsigned count); /* elements found no room; NULL: nobody is told */
    void *context;
};

/* What is to be done; the other members are daemon_start()'s. CO_ERR_MEMORY, and nothing runs. */
enum co_err daemon_start(struct daemon *self, const char *name, size_t element_size,
                         unsigned capacity);
void daemon_put(struct daemon *self, const void *element);
/* The same in two steps: the thread is woken by the second. */
void daemon_add(struct daemon *self, const void *element);
void daemon_wake(struct daemon *self);
/* What is still in the queue is dropped; waits until the owner's function has returned. */
void daemon_stop(struct daemon *self);
/* SCHED_FIFO 1..99. CO_ERR_PERMISSION */
enum co_err daemon_set_priority(struct daemon *self, int native);

#endif

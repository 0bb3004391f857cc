/*
 * Events on their way from protocol threads to whoever reads them: elements of one size, bounded in
 * number. What does not fit is dropped and counted: the older ones stay, as they tell how it began,
 * and who reads is told how many are missing, and where.
 *
 *   locking  its own lock, taken last (docs/threading.md); put never waits
 */
#ifndef CO_RUNTIME_EVENT_QUEUE_H
#define CO_RUNTIME_EVENT_QUEUE_H

#include "base/error.h"
#include "port/thread.h"

#include <stddef.h>

struct event_queue {
    struct co_lock lock;
    struct co_condition changed;
    unsigned char *elements;
    size_t element_size;
    unsigned capacity, first, count;
    unsigned *gaps;      /* for each element: how many were lost between it and the one before */
    unsigned lost;       /* behind the last element */
    unsigned total_lost; /* since it was opened */
    bool closed;         /* who waits returns, nothing is put any more */
};

/* CO_ERR_MEMORY */
enum co_err event_queue_init(struct event_queue *self, size_t element_size, unsigned capacity);
void event_queue_done(struct event_queue *self);

void event_queue_put(struct event_queue *self, const void *element);
/* The same in two steps: who waits is woken by the second. */
void event_queue_add(struct event_queue *self, const void *element);
void event_queue_wake(struct event_queue *self);
/*
 * An element, and *ret_lost 0; or, at its place, how many elements are missing there, and no
 * element. CO_ERR_AGAIN: nothing there until the deadline; CO_ERR_STATE: closed and empty.
 */
enum co_err event_queue_take(struct event_queue *self, co_us_t deadline, void *ret_element,
                             unsigned *ret_lost);
/* Since it was opened last, told or not. */
unsigned event_queue_lost(struct event_queue *self);
/* Nobody waits any more; what is in the queue can still be taken. */
void event_queue_close(struct event_queue *self);
/* Open again, and empty. */
void event_queue_open(struct event_queue *self);

#endif

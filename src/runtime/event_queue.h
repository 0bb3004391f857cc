/*
 * Events on their way from protocol threads to whoever reads them: elements of one size, bounded in
 * number, with a count of what did not fit.
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
    unsigned lost;   /* since event_queue_take_lost() */
    unsigned before; /* elements still in the queue that came before the first of the lost */
    bool closed;     /* who waits returns, nothing is put any more */
};

/* CO_ERR_MEMORY */
enum co_err event_queue_init(struct event_queue *self, size_t element_size, unsigned capacity);
void event_queue_done(struct event_queue *self);

void event_queue_put(struct event_queue *self, const void *element);
/* The same in two steps: who waits is woken by the second. */
void event_queue_add(struct event_queue *self, const void *element);
void event_queue_wake(struct event_queue *self);
/* CO_ERR_AGAIN: none there until the deadline; CO_ERR_STATE: closed and empty. */
enum co_err event_queue_take(struct event_queue *self, co_us_t deadline, void *ret_element);
/*
 * How many were lost since the last call, at the place where the first of them is missing: 0 while
 * elements from before it are still to be taken.
 */
unsigned event_queue_take_lost(struct event_queue *self);
/* Nobody waits any more; what is in the queue can still be taken. */
void event_queue_close(struct event_queue *self);
/* Open again, and empty. */
void event_queue_open(struct event_queue *self);

#endif

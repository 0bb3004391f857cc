/*
 * Events on their way from protocol threads to whoever reads them: bounded, with a count of what did
 * not fit.
 *
 *   locking  its own lock, taken last (docs/threading.md); put never waits
 */
#ifndef CO_RUNTIME_EVENT_QUEUE_H
#define CO_RUNTIME_EVENT_QUEUE_H

#include "base/outbox.h"
#include "port/thread.h"

#define EVENT_QUEUE_SIZE 1024u

struct network;

struct queued_event {
    struct network *network; /* where it happened */
    struct co_event event;
};

struct event_queue {
    struct co_lock lock;
    struct co_condition changed;
    struct queued_event events[EVENT_QUEUE_SIZE];
    unsigned first, count;
    unsigned lost; /* since event_queue_take_lost() */
    bool closed;   /* who waits returns */
};

enum co_err event_queue_init(struct event_queue *self);
void event_queue_done(struct event_queue *self);

void event_queue_put(struct event_queue *self, struct network *network,
                     const struct co_event *event);
/* CO_ERR_AGAIN: none there until the deadline; CO_ERR_STATE: closed and empty. */
enum co_err event_queue_take(struct event_queue *self, co_us_t deadline,
                             struct queued_event *ret_event);
/* How many events were lost since the last call. */
unsigned event_queue_take_lost(struct event_queue *self);
/* Nobody waits any more; what is in the queue can still be taken. */
void event_queue_close(struct event_queue *self);

#endif

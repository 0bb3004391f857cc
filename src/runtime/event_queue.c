#include "runtime/event_queue.h"

#include <string.h>

enum co_err event_queue_init(struct event_queue *self)
{
    enum co_err err;

    memset(self, 0, sizeof *self);
    err = lock_init(&self->lock);
    if (err != CO_OK)
        return err;
    err = condition_init(&self->changed);
    if (err != CO_OK)
        lock_done(&self->lock);
    return err;
}

void event_queue_done(struct event_queue *self)
{
    condition_done(&self->changed);
    lock_done(&self->lock);
}

void event_queue_put(struct event_queue *self, struct network *network,
                     const struct co_event *event)
{
    lock_take(&self->lock);
    if (self->count == EVENT_QUEUE_SIZE) {
        self->lost++;
    } else {
        self->events[(self->first + self->count++) % EVENT_QUEUE_SIZE] =
            (struct queued_event){ network, *event };
        condition_signal(&self->changed);
    }
    lock_give(&self->lock);
}

enum co_err event_queue_take(struct event_queue *self, co_us_t deadline,
                             struct queued_event *ret_event)
{
    enum co_err err = CO_OK;

    lock_take(&self->lock);
    while (self->count == 0 && !self->closed && err != CO_ERR_TIMEOUT)
        err = condition_wait(&self->changed, &self->lock, deadline);
    if (self->count > 0) {
        *ret_event = self->events[self->first];
        self->first = (self->first + 1) % EVENT_QUEUE_SIZE;
        self->count--;
        err = CO_OK;
    } else {
        err = self->closed ? CO_ERR_STATE : CO_ERR_AGAIN;
    }
    lock_give(&self->lock);
    return err;
}

unsigned event_queue_take_lost(struct event_queue *self)
{
    unsigned lost;

    lock_take(&self->lock);
    lost = self->lost;
    self->lost = 0;
    lock_give(&self->lock);
    return lost;
}

void event_queue_close(struct event_queue *self)
{
    lock_take(&self->lock);
    self->closed = true;
    condition_signal(&self->changed);
    lock_give(&self->lock);
}

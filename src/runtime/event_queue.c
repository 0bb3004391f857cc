#include "runtime/event_queue.h"

#include <stdlib.h>
#include <string.h>

enum co_err event_queue_init(struct event_queue *self, size_t element_size, unsigned capacity)
{
    enum co_err err;

    memset(self, 0, sizeof *self);
    self->element_size = element_size;
    self->capacity = capacity;
    self->elements = calloc(capacity, element_size);
    if (!self->elements)
        return CO_ERR_MEMORY;
    err = lock_init(&self->lock);
    if (err != CO_OK)
        goto free_elements;
    err = condition_init(&self->changed);
    if (err == CO_OK)
        return CO_OK;
    lock_done(&self->lock);
free_elements:
    free(self->elements);
    return err;
}

void event_queue_done(struct event_queue *self)
{
    condition_done(&self->changed);
    lock_done(&self->lock);
    free(self->elements);
}

static unsigned char *element_at(struct event_queue *self, unsigned position)
{
    return self->elements + position % self->capacity * self->element_size;
}

void event_queue_add(struct event_queue *self, const void *element)
{
    lock_take(&self->lock);
    if (self->closed) {
        /* nobody misses it */
    } else if (self->count == self->capacity) {
        if (self->lost++ == 0)
            self->before = self->count;
    } else {
        memcpy(element_at(self, self->first + self->count++), element, self->element_size);
    }
    lock_give(&self->lock);
}

/* Not under the lock, which the one who is woken wants at once. */
void event_queue_wake(struct event_queue *self)
{
    condition_signal(&self->changed);
}

void event_queue_put(struct event_queue *self, const void *element)
{
    event_queue_add(self, element);
    event_queue_wake(self);
}

enum co_err event_queue_take(struct event_queue *self, co_us_t deadline, void *ret_element)
{
    enum co_err err = CO_OK;

    lock_take(&self->lock);
    while (self->count == 0 && !self->closed && err != CO_ERR_TIMEOUT)
        err = condition_wait(&self->changed, &self->lock, deadline);
    if (self->count > 0) {
        memcpy(ret_element, element_at(self, self->first), self->element_size);
        self->first = (self->first + 1) % self->capacity;
        self->count--;
        self->before -= self->before > 0;
        err = CO_OK;
    } else {
        err = self->closed ? CO_ERR_STATE : CO_ERR_AGAIN;
    }
    lock_give(&self->lock);
    return err;
}

unsigned event_queue_take_lost(struct event_queue *self)
{
    unsigned lost = 0;

    lock_take(&self->lock);
    if (self->before == 0) {
        lost = self->lost;
        self->lost = 0;
    }
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

void event_queue_open(struct event_queue *self)
{
    lock_take(&self->lock);
    self->first = 0;
    self->count = 0;
    self->lost = 0;
    self->before = 0;
    self->closed = false;
    lock_give(&self->lock);
}

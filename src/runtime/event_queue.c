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
    self->gaps = calloc(capacity, sizeof *self->gaps);
    err = self->elements && self->gaps ? lock_init(&self->lock) : CO_ERR_MEMORY;
    if (err != CO_OK)
        goto free_elements;
    err = condition_init(&self->changed);
    if (err == CO_OK)
        return CO_OK;
    lock_done(&self->lock);
free_elements:
    free(self->elements);
    free(self->gaps);
    return err;
}

void event_queue_done(struct event_queue *self)
{
    condition_done(&self->changed);
    lock_done(&self->lock);
    free(self->elements);
    free(self->gaps);
}

static unsigned char *element_at(struct event_queue *self, unsigned position)
{
    return self->elements + position % self->capacity * self->element_size;
}

static void append(struct event_queue *self, const void *element)
{
    const unsigned position = self->first + self->count++;

    memcpy(element_at(self, position), element, self->element_size);
    self->gaps[position % self->capacity] = self->lost;
    self->lost = 0;
}

void event_queue_add(struct event_queue *self, const void *element)
{
    lock_take(&self->lock);
    if (self->closed) {
        /* nobody misses it */
    } else if (self->count == self->capacity) {
        self->lost++;
        self->total_lost++;
    } else {
        append(self, element);
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

/* Where the next loss to be told is counted. */
static unsigned *next_gap(struct event_queue *self)
{
    return self->count > 0 ? &self->gaps[self->first] : &self->lost;
}

static void take_first(struct event_queue *self, void *ret_element)
{
    memcpy(ret_element, element_at(self, self->first), self->element_size);
    self->first = (self->first + 1) % self->capacity;
    self->count--;
}

enum co_err event_queue_take(struct event_queue *self, co_us_t deadline, void *ret_element,
                             unsigned *ret_lost)
{
    enum co_err err = CO_OK;
    unsigned *gap;

    lock_take(&self->lock);
    while (self->count == 0 && self->lost == 0 && !self->closed && err != CO_ERR_TIMEOUT)
        err = condition_wait(&self->changed, &self->lock, deadline);
    gap = next_gap(self);
    err = CO_OK;
    if (*gap > 0 || self->count > 0)
        *ret_lost = *gap;
    if (*gap > 0)
        *gap = 0;
    else if (self->count > 0)
        take_first(self, ret_element);
    else
        err = self->closed ? CO_ERR_STATE : CO_ERR_AGAIN;
    lock_give(&self->lock);
    return err;
}

unsigned event_queue_lost(struct event_queue *self)
{
    unsigned lost;

    lock_take(&self->lock);
    lost = self->total_lost;
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
    self->total_lost = 0;
    self->closed = false;
    lock_give(&self->lock);
}

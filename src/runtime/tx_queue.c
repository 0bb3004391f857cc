#include "runtime/tx_queue.h"

#include <stddef.h>

bool tx_queue_is_full(const struct tx_queue *self)
{
    return self->count == TX_QUEUE_SIZE;
}

void tx_queue_put(struct tx_queue *self, const struct co_frame *frame, co_us_t now)
{
    unsigned last = (self->first + self->count) % TX_QUEUE_SIZE;

    if (tx_queue_is_full(self)) {
        self->lost++;
        return;
    }
    self->items[last].frame = *frame;
    self->items[last].since = now;
    self->count++;
}

const struct co_frame *tx_queue_first(const struct tx_queue *self)
{
    return self->count > 0 ? &self->items[self->first].frame : NULL;
}

void tx_queue_sent(struct tx_queue *self)
{
    self->first = (self->first + 1) % TX_QUEUE_SIZE;
    self->count--;
}

bool tx_queue_give_up(struct tx_queue *self, co_us_t now)
{
    if (now < self->items[self->first].since + TX_QUEUE_GIVE_UP)
        return false;
    tx_queue_sent(self);
    self->lost++;
    return true;
}

void tx_queue_lose_all(struct tx_queue *self)
{
    self->lost += self->count;
    self->count = 0;
}

unsigned tx_queue_take_lost(struct tx_queue *self)
{
    unsigned lost = self->lost;

    self->lost = 0;
    return lost;
}

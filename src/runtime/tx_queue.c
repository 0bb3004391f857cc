#include "runtime/tx_queue.h"

#include <stddef.h>
#include <string.h>

bool tx_queue_is_full(const struct tx_queue *self)
{
    return self->count == TX_QUEUE_SIZE;
}

/* An 11-bit identifier wins against the 29-bit ones that begin with it. */
static uint32_t rank_of(const struct co_frame *frame)
{
    if (frame->flags & CO_FRAME_EXT)
        return frame->id >> 18 << 19 | 1u << 18 | (frame->id & 0x3FFFFu);
    return frame->id << 19;
}

/* Where a frame of this rank has its place: behind those of the same. */
static unsigned place_of(const struct tx_queue *self, uint32_t rank)
{
    unsigned low = 0, high = self->count;

    while (low < high) {
        unsigned middle = (low + high) / 2;

        if (self->items[middle].rank > rank)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

bool tx_queue_takes(const struct tx_queue *self, const struct co_frame *frame)
{
    return !tx_queue_is_full(self) || place_of(self, rank_of(frame)) > 0;
}

static void lose(struct tx_queue *self, unsigned count)
{
    self->lost += count;
    self->losses += count > 0;
}

void tx_queue_put(struct tx_queue *self, const struct co_frame *frame, co_us_t now)
{
    const struct tx_queue_item item = { .rank = rank_of(frame), .frame = *frame, .since = now };
    unsigned place = place_of(self, item.rank);

    if (tx_queue_is_full(self)) {
        lose(self, 1);
        if (place == 0)
            return;
        place--;
        memmove(&self->items[0], &self->items[1], place * sizeof item);
    } else {
        memmove(&self->items[place + 1], &self->items[place], (self->count - place) * sizeof item);
        self->count++;
    }
    self->items[place] = item;
}

const struct co_frame *tx_queue_first(const struct tx_queue *self)
{
    return self->count > 0 ? &self->items[self->count - 1].frame : NULL;
}

void tx_queue_sent(struct tx_queue *self)
{
    self->count--;
}

bool tx_queue_give_up(struct tx_queue *self, co_us_t now)
{
    unsigned kept = 0;
    bool first_is_over = self->count > 0 &&
                         now >= self->items[self->count - 1].since + TX_QUEUE_GIVE_UP;

    for (unsigned i = 0; i < self->count; i++) {
        if (now < self->items[i].since + TX_QUEUE_GIVE_UP)
            self->items[kept++] = self->items[i];
    }
    lose(self, self->count - kept);
    self->count = kept;
    return first_is_over;
}

void tx_queue_lose_all(struct tx_queue *self)
{
    lose(self, self->count);
    self->count = 0;
}

unsigned tx_queue_take_lost(struct tx_queue *self)
{
    unsigned lost = self->lost;

    self->lost = 0;
    return lost;
}

/*
 * Frames on their way to a bus that does not keep up: in the order in which the bus takes them,
 * the lowest identifier first and those of one identifier as they came; bounded in number, each
 * given up when it has waited too long. What an application ordered seconds ago must not come about
 * later.
 *
 *   in   frames, the time
 *   out  the next frame; how many were lost
 *
 *   owner    a network
 *   locking  none; the owner's
 */
#ifndef CO_RUNTIME_TX_QUEUE_H
#define CO_RUNTIME_TX_QUEUE_H

#include "base/frame.h"
#include "base/time.h"

#define TX_QUEUE_SIZE    1024u
#define TX_QUEUE_GIVE_UP CO_MS(2000)

struct tx_queue_item {
    uint32_t rank; /* in arbitration: lower is first */
    struct co_frame frame;
    co_us_t since;
};

struct tx_queue {
    struct tx_queue_item items[TX_QUEUE_SIZE]; /* the next one is the last */
    unsigned count;
    unsigned lost;   /* since tx_queue_take_lost() */
    unsigned losses; /* how often some were, ever */
};

/* Where there is no room, the frame that would be sent last is lost. */
void tx_queue_put(struct tx_queue *self, const struct co_frame *frame, co_us_t now);
bool tx_queue_is_full(const struct tx_queue *self);
/* True if this frame would not be the one that is lost. */
bool tx_queue_takes(const struct tx_queue *self, const struct co_frame *frame);
/* The next one; NULL: there is none. */
const struct co_frame *tx_queue_first(const struct tx_queue *self);
/* It was sent. */
void tx_queue_sent(struct tx_queue *self);
/* It could not be sent: those whose time is over are lost; true if it was one of them. */
bool tx_queue_give_up(struct tx_queue *self, co_us_t now);
/* The same for all, whatever their time. */
void tx_queue_lose_all(struct tx_queue *self);
unsigned tx_queue_take_lost(struct tx_queue *self);

#endif

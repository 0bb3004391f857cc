/*
 * Frames on their way to a bus that does not keep up: in order, bounded in number, each given up
 * when it has waited too long. What an application ordered seconds ago must not come about later.
 *
 *   in   frames, the time
 *   out  the oldest frame; how many were lost
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

struct tx_queue {
    struct {
        struct co_frame frame;
        co_us_t since;
    } items[TX_QUEUE_SIZE];
    unsigned first, count;
    unsigned lost; /* since tx_queue_take_lost() */
};

/* A frame that finds no room is lost. */
void tx_queue_put(struct tx_queue *self, const struct co_frame *frame, co_us_t now);
bool tx_queue_is_full(const struct tx_queue *self);
/* The oldest one; NULL: there is none. */
const struct co_frame *tx_queue_first(const struct tx_queue *self);
/* It was sent. */
void tx_queue_sent(struct tx_queue *self);
/* It could not be sent: true if its time is over, then it is lost. */
bool tx_queue_give_up(struct tx_queue *self, co_us_t now);
/* The same for all, whatever their time. */
void tx_queue_lose_all(struct tx_queue *self);
unsigned tx_queue_take_lost(struct tx_queue *self);

#endif

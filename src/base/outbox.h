/*
 * Where a machine puts what it wants: frames for the bus and events for its owner, in order.
 *
 *   owner    whoever runs the machine; it brings the storage and drains it after each call
 *   locking  none; the owner's
 *
 * A machine asks for room before it changes its state. Where there is none it returns as it was,
 * with its deadline still due, and is called again when the outbox has been drained: so nothing is
 * ever lost here, and nothing can call back into a machine that is running.
 */
#ifndef CO_BASE_OUTBOX_H
#define CO_BASE_OUTBOX_H

#include "base/frame.h"

#include <stdbool.h>
#include <stdint.h>

/* What happened. The emitting layer's header tells which fields an event uses; the others are 0. */
struct co_event {
    uint16_t type;  /* enum proto_event, slave_event or manager_event: ranges that do not overlap */
    uint8_t node;   /* node-ID of the device it is about; 0: the network as a whole */
    uint8_t detail; /* a small number: a state, a step, an outcome */
    uint16_t index; /* an object of that device */
    uint8_t sub;
    uint32_t code;     /* an abort or emergency code */
    uint64_t expected; /* a value that should be there ... */
    uint64_t actual;   /* ... and the one that is */
    uint8_t data[8];
};

struct co_outbox {
    struct co_frame *frames;
    struct co_event *events;
    unsigned frame_capacity, frame_first, frame_count;
    unsigned event_capacity, event_first, event_count;
};

void co_outbox_init(struct co_outbox *self, struct co_frame *frames, unsigned frame_capacity,
                    struct co_event *events, unsigned event_capacity);

/* True if so many frames and events can still be put. */
bool co_outbox_room(const struct co_outbox *self, unsigned frames, unsigned events);

/* There must be room. */
void co_outbox_put_frame(struct co_outbox *self, const struct co_frame *frame);
void co_outbox_put_event(struct co_outbox *self, const struct co_event *event);

/* The oldest one; false when there is none. */
bool co_outbox_take_frame(struct co_outbox *self, struct co_frame *ret_frame);
bool co_outbox_take_event(struct co_outbox *self, struct co_event *ret_event);

#endif

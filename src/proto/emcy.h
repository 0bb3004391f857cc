/*
 * Emergency producer and consumer (CiA 301, 7.2.7; objects 1001h, 1014h, 1015h, 1028h).
 *
 * The producer keeps the errors that are to be sent until the inhibit time allows: each event
 * gives one frame, in order. Its queue is bounded; what does not fit is counted. The latest one
 * always has a place, that of the one before it, so that the last frame tells how things are.
 */
#ifndef CO_PROTO_EMCY_H
#define CO_PROTO_EMCY_H

#include "base/outbox.h"
#include "base/time.h"

#define EMCY_CAN_ID    0x080u /* + node-ID */
#define EMCY_QUEUE_MAX 16u

struct emcy_message {
    uint16_t code;          /* 0000h: an error has gone */
    uint8_t error_register; /* 1001h after the event */
    uint8_t field[5];
};

struct emcy_producer {
    uint32_t cob_id; /* object 1014h; bit 31 set: none is sent */
    co_us_t inhibit; /* object 1015h as time */
    co_us_t not_before;
    bool enabled; /* NMT state pre-operational or operational */
    struct emcy_message queue[EMCY_QUEUE_MAX];
    unsigned first, count;
    unsigned lost; /* did not fit; the owner's to clear */
};

void emcy_producer_init(struct emcy_producer *self, uint32_t cob_id);
/* Takes over new values of 1014h and 1015h. */
void emcy_producer_configure(struct emcy_producer *self, uint32_t cob_id, co_us_t inhibit);
void emcy_producer_enable(struct emcy_producer *self, bool enabled);
/*
 * Puts a message in the queue; sent by on_time, which is due at once when nothing inhibits it.
 * While 1014h is not valid the message is left out.
 */
void emcy_producer_raise(struct emcy_producer *self, const struct emcy_message *message);
bool emcy_producer_is_full(const struct emcy_producer *self);
void emcy_producer_on_time(struct emcy_producer *self, co_us_t now, struct co_outbox *out);
co_us_t emcy_producer_deadline(const struct emcy_producer *self);

/*
 * True for an emergency on the pre-defined CAN-ID of a node; *ret_event becomes PROTO_EMCY. One
 * shorter than 8 bytes is accepted, the rest is 0; without an error code it is none (old devices
 * say boot-up so).
 */
bool emcy_parse(const struct co_frame *frame, struct co_event *ret_event);

/* The meaning of an error code's class: "heartbeat or life guarding error". */
const char *emcy_text(uint16_t code);

#endif

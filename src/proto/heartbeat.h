/*
 * Heartbeat producer and consumer (CiA 301, 7.2.8.2.2.1 and objects 1016h, 1017h).
 *
 * The producer sends the NMT state of its device each period.
 *
 *   in   the period, the state, the time
 *   out  heartbeat frames
 *
 * The consumer watches one node: it notices when the node falls silent or changes its state.
 *
 *   in   that node's error control frames, the time
 *   out  PROTO_HB_STATE   the first heartbeat, or another state than before
 *        PROTO_HB_LOST    silent for the whole period
 *
 * A node is watched from its first heartbeat on, not before: a node that has not started yet is
 * absent, not lost. A boot-up message is no heartbeat; it ends the watch until the next heartbeat.
 */
#ifndef CO_PROTO_HEARTBEAT_H
#define CO_PROTO_HEARTBEAT_H

#include "base/outbox.h"
#include "base/time.h"

struct hb_producer {
    uint8_t node;
    uint8_t state;    /* NMT state to report */
    co_us_t period;   /* 0: off */
    co_us_t deadline; /* CO_NEVER: off */
};

void hb_producer_init(struct hb_producer *self, uint8_t node);
/* Sets the period, 0 for off; at_once: the first heartbeat now, else one period from now. */
void hb_producer_start(struct hb_producer *self, co_us_t period, bool at_once, co_us_t now);
void hb_producer_on_time(struct hb_producer *self, co_us_t now, struct co_outbox *out);
co_us_t hb_producer_deadline(const struct hb_producer *self);

struct hb_consumer {
    uint8_t node;
    uint8_t state;    /* of the last heartbeat; NMT_INITIALISING until the first one */
    bool untold;      /* that state found no room in the outbox yet */
    bool lost;        /* silent since PROTO_HB_LOST */
    co_us_t period;   /* 0: not watched */
    co_us_t deadline; /* CO_NEVER until the first heartbeat */
};

void hb_consumer_init(struct hb_consumer *self, uint8_t node);
/* Watches from the next heartbeat on; period 0 ends the watch. */
void hb_consumer_start(struct hb_consumer *self, co_us_t period);
void hb_consumer_on_frame(struct hb_consumer *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out);
void hb_consumer_on_time(struct hb_consumer *self, co_us_t now, struct co_outbox *out);
co_us_t hb_consumer_deadline(const struct hb_consumer *self);

#endif

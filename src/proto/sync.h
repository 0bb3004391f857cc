/*
 * SYNC producer and consumer (CiA 301, 7.2.5; objects 1005h, 1006h, 1019h).
 *
 * The producer sends a SYNC each period, by deadlines that do not drift.
 *
 *   in   the objects, the time; what it hears of SYNCs that somebody else sends for it
 *   out  SYNC frames
 *        PROTO_SYNC_MISSING   somebody else is to send them, and none come: once until one does
 *
 * The consumer tells SYNCs from other frames, and whether they have the length that 1019h says.
 */
#ifndef CO_PROTO_SYNC_H
#define CO_PROTO_SYNC_H

#include "base/outbox.h"
#include "base/time.h"

#define SYNC_COUNTER_MAX 240u
#define SYNC_PATIENCE    CO_MS(1500) /* without a SYNC; 4 periods, if that is longer */

struct sync_producer {
    uint32_t cob_id;  /* object 1005h; bit 30: produces */
    co_us_t period;   /* object 1006h as time; 0: off */
    uint8_t overflow; /* object 1019h; 0: no counter */
    uint8_t counter;  /* of the next SYNC */
    bool enabled;     /* NMT state pre-operational or operational */
    bool external;    /* somebody else sends */
    bool begins;      /* the time of the first one is not known yet */
    bool missing;     /* since PROTO_SYNC_MISSING */
    unsigned outages;
    co_us_t deadline; /* of the next SYNC, or for somebody else's; CO_NEVER: none */
};

void sync_producer_init(struct sync_producer *self);
/* New values of the objects: it begins anew, with the first SYNC one period from now. */
void sync_producer_configure(struct sync_producer *self, uint32_t cob_id, co_us_t period,
                             uint8_t overflow);
/* Begins anew where it was off. */
void sync_producer_enable(struct sync_producer *self, bool enabled);
void sync_producer_set_external(struct sync_producer *self, bool external);
bool sync_producer_is_active(const struct sync_producer *self);
/* A SYNC was heard that somebody else has sent. */
void sync_producer_on_sync(struct sync_producer *self, co_us_t now);
void sync_producer_on_time(struct sync_producer *self, co_us_t now, struct co_outbox *out);
co_us_t sync_producer_deadline(const struct sync_producer *self);

enum sync_length { SYNC_ANY_LENGTH, SYNC_WITHOUT_COUNTER, SYNC_WITH_COUNTER };

struct sync_consumer {
    uint32_t cob_id;
    uint8_t length;     /* enum sync_length: what 1019h lets expect */
    bool wrong;         /* the last SYNC had another length */
    uint8_t wrong_size; /* that of the last one that had */
};

/* True for a SYNC; *ret_counter: 0 when it has none. */
bool sync_consumer_on_frame(struct sync_consumer *self, const struct co_frame *frame,
                            uint8_t *ret_counter);

#endif

/*
 * Node guarding and life guarding (CiA 301, 7.2.8.2.2.2 and objects 100Ch, 100Dh).
 *
 * The master asks one node for its NMT state each guard time, with a remote frame.
 *
 *     master                        node 5
 *       | -- 705h remote, DLC 1 ---> |
 *       | <-- 705h [t, state] ------ |      t alternates, 0 in the first answer after boot-up
 *
 *   in   the node's error control frames, the time
 *   out  requests
 *        PROTO_GUARD_STATE    the first answer, or another state than before
 *        PROTO_GUARD_LOST     no answer for the life time: once, and the requests go on
 *        PROTO_GUARD_TOGGLE   an answer with the wrong toggle bit; the next one has to differ
 *
 * A node is lost when guard time x factor has passed since the last request that it answered, or
 * since the start; but not before the oldest request without answer is one guard time old. That
 * counts with factor 1, and when we were late to ask.
 *
 * A boot-up message is no answer: the time starts anew with it, and the toggle bit with 0. A lost
 * node stays lost until it answers.
 *
 * The slave answers, and with a life time it watches its master in turn, from the first request on.
 *
 *   in   requests, the life time, the NMT state, the time
 *   out  answers
 *        PROTO_LIFE_LOST      no request for the life time
 *        PROTO_LIFE_BACK      a request after that, or the end of life guarding
 */
#ifndef CO_PROTO_GUARDING_H
#define CO_PROTO_GUARDING_H

#include "base/outbox.h"
#include "base/time.h"

struct guard_master {
    uint8_t node;
    uint8_t state;     /* of the last answer; NMT_INITIALISING: none since start or boot-up */
    bool toggle;       /* bit that the next answer should have */
    bool once;         /* one question, by guard_master_ask() */
    bool asked;        /* a request has no answer yet */
    bool lost;         /* no answer since PROTO_GUARD_LOST */
    bool told_lost;    /* what the last event said */
    bool state_untold; /* these found no room in the outbox yet */
    bool toggle_untold;
    uint32_t toggle_errors; /* since guard_master_init() */
    co_us_t period;         /* of the requests; 0: off */
    co_us_t life_time;
    co_us_t request; /* time of the next one; CO_NEVER: none */
    co_us_t sent;    /* time of the last one */
    co_us_t alive;   /* of the last one that was answered; of start or boot-up if later */
    co_us_t loss;    /* the node is lost then; CO_NEVER: nothing asked, or lost already */
};

void guard_master_init(struct guard_master *self, uint8_t node);
/*
 * Guards from now on, with the first request at once; period or factor 0: as guard_master_stop().
 * The first answer should have toggle bit 0, unless the node is known to go on with 1: it was
 * guarded or asked before, and neither a stop nor its boot-up message came since.
 */
void guard_master_start(struct guard_master *self, co_us_t period, uint8_t factor, co_us_t now);
/* No more requests and events; what is not told yet is forgotten. */
void guard_master_stop(struct guard_master *self);
/*
 * Asks once, with any toggle bit right: PROTO_GUARD_STATE with the answer, or PROTO_GUARD_LOST when
 * none has come within timeout (> 0) of the request. Then, or by a start or stop, it is over. Takes
 * the place of guarding.
 */
void guard_master_ask(struct guard_master *self, co_us_t timeout, co_us_t now);
/* Frames may be any; boot-up messages of the node count even when it is not guarded. */
void guard_master_on_frame(struct guard_master *self, const struct co_frame *frame, co_us_t now,
                           struct co_outbox *out);
void guard_master_on_time(struct guard_master *self, co_us_t now, struct co_outbox *out);
co_us_t guard_master_deadline(const struct guard_master *self);

struct guard_slave {
    uint8_t node;
    uint8_t state;     /* NMT state to answer with; its owner's to set */
    bool toggle;       /* bit of the next answer */
    bool answer_due;   /* found no room in the outbox yet */
    bool lost;         /* no request for the life time */
    bool told_lost;    /* what the last event said */
    co_us_t life_time; /* from the next request on, 0: the master may be silent; its owner's */
    co_us_t deadline;  /* of the next request; CO_NEVER: no life guarding */
};

/* As after boot-up: toggle bit 0, no life guarding before the first request. */
void guard_slave_init(struct guard_slave *self, uint8_t node);
/* Life guarding ends until the next request. */
void guard_slave_stop(struct guard_slave *self, struct co_outbox *out);
/* Answers requests to this node, whatever length they ask for; other frames are ignored. */
void guard_slave_on_frame(struct guard_slave *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out);
void guard_slave_on_time(struct guard_slave *self, co_us_t now, struct co_outbox *out);
co_us_t guard_slave_deadline(const struct guard_slave *self);

#endif

/*
 * A transmitted PDO (CiA 301, 7.2.2): sends values of the dictionary, when its type says so.
 *
 *   in   events of the application, SYNCs, requests (remote frames), the time
 *   out  frames
 *        PROTO_TPDO_WANTED   the application is asked for new data first, see below
 *
 *   type       SYNC                  event           event timer   request
 *   0          sends after an event  waits for SYNC  -             data of this moment
 *   1..240     sends at each n-th    -               -             data sent last
 *   252        takes a sample        -               -             the sample
 *   253        -                     -               -             data of this moment
 *   254, 255   -                     sends           sends         data of this moment
 *
 * Events of types 254 and 255 within the inhibit time are one, at its end. Data that depends on
 * others ('asks') is asked for before it goes out by SYNC, request, or, with 'timer_asks', by the
 * event timer:
 *
 *   FREE -- PROTO_TPDO_WANTED --> ASKING -- answer, or time over --> ANSWERED -- frame --> FREE
 *
 * Whatever else would send it while it asks goes out with the answer.
 *
 *   owner    a local device
 *   locking  none; the owner's
 */
#ifndef CO_PROTO_TPDO_H
#define CO_PROTO_TPDO_H

#include "base/outbox.h"
#include "base/time.h"
#include "proto/pdo_map.h"

#define TPDO_SYNC_TYPE_MAX 240u
#define TPDO_SYNC_REQUEST  252u
#define TPDO_REQUEST       253u
#define TPDO_EVENT         254u /* and 255 */

#define TPDO_ANSWER_TIME CO_MS(10) /* for the application's data, where no SYNC limits it */

enum tpdo_asking { TPDO_FREE, TPDO_ASKING, TPDO_ANSWERED };

struct tpdo {
    uint32_t cob_id; /* object 18xxh:01; bit 31: not valid, bit 30: no requests */
    uint16_t number; /* 1..512 */
    uint8_t type;
    uint8_t sync_start; /* object 18xxh:06: the counter of the SYNC that is its first; 0: any */
    bool notify;        /* the owner's: it is sent with each change, and when it starts */
    bool confirm;       /* the owner's: wants to hear that it was sent */
    bool timer_asks;    /* the owner's */
    bool asks;          /* the owner's: new data has to be asked for */
    bool marked;        /* the owner's: has changed while nothing is to be sent by itself */
    uint8_t confirms;   /* the owner's: confirmations that are not told yet */
    bool running;       /* NMT state operational */
    struct pdo_map map;
    unsigned sent;   /* frames */
    unsigned missed; /* sent without the data asked for, or not within the synchronous window */

    bool event;     /* to be sent: with the next SYNC (type 0), from not_before on (254, 255) */
    bool by_timer;  /* ... because of the event timer */
    bool due;       /* to be sent because of a SYNC */
    bool sampling;  /* a sample is to be taken */
    bool requested; /* a remote frame waits for its answer */
    bool started;   /* its first SYNC has come */
    bool sampled;
    uint8_t count; /* SYNCs since it was sent */
    uint8_t sample[PDO_SIZE_MAX];
    uint8_t asking; /* enum tpdo_asking */
    uint32_t ask;   /* number of the last PROTO_TPDO_WANTED */
    co_us_t ask_end;
    co_us_t answer_end; /* of data for the present SYNC */
    co_us_t window_end; /* for a frame because of it */
    co_us_t inhibit;    /* object 18xxh:03 as time */
    co_us_t period;     /* object 18xxh:05 as time; 0: no event timer */
    co_us_t not_before;
    co_us_t timer; /* CO_NEVER: does not run */
};

struct tpdo_parameters {
    uint32_t cob_id;
    uint8_t type;
    uint8_t sync_start;
    co_us_t inhibit;
    co_us_t period;
};

struct tpdo_sync {
    uint8_t counter;    /* 0: it has none */
    co_us_t answer_end; /* for data that is asked for */
    co_us_t window_end; /* for frames; CO_NEVER: up to the next SYNC */
};

void tpdo_init(struct tpdo *self, uint16_t number, struct pdo_field *fields, uint8_t room);
/* Takes over changed parameters; one that is now valid, or of another type, starts anew. */
void tpdo_configure(struct tpdo *self, const struct tpdo_parameters *parameters, co_us_t now);
/* Another mapping is there. */
void tpdo_remapped(struct tpdo *self, co_us_t now);
/* Valid, and there is something to send. */
bool tpdo_is_valid(const struct tpdo *self);

/* Operational: the application's events begin with one. */
void tpdo_start(struct tpdo *self, co_us_t now);
void tpdo_stop(struct tpdo *self);
/* Not running, and nothing was ever sent. */
void tpdo_reset(struct tpdo *self);

/* What it does about an event depends on the time; else tpdo_on_time() may be told an old one. */
bool tpdo_is_timed(const struct tpdo *self);
/* Types 0, 254 and 255: there is new data. Sent by tpdo_on_time(), which is due when it may. */
void tpdo_trigger(struct tpdo *self);
/* A SYNC; what is to be sent or taken because of it is done by tpdo_on_time(). */
void tpdo_on_sync(struct tpdo *self, const struct tpdo_sync *sync);
/* A remote frame with its COB-ID. */
void tpdo_on_request(struct tpdo *self);
/* The data asked for with this number is in the dictionary; other numbers are ignored. */
void tpdo_answer(struct tpdo *self, uint32_t ask);
void tpdo_on_time(struct tpdo *self, co_us_t now, struct co_outbox *out);
co_us_t tpdo_deadline(const struct tpdo *self);

#endif

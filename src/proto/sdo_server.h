/*
 * SDO server: one channel of a local device (CiA 301, 7.2.4), expedited and segmented.
 *
 *   in   the client's requests, the owner's verdict on a write, the bytes that it keeps, the time
 *   out  responses; PROTO_SDO_WRITE when a whole value has come for an entry; PROTO_SDO_READ when
 *        the owner is to give one
 *
 *   IDLE -- upload --> [FETCH -- sdo_server_give()] --> [UP_SEGMENT ...] --> IDLE
 *   IDLE -- download --> [DOWN_SEGMENT ...] --> VERDICT -- sdo_server_verdict() --> IDLE
 *
 * The server checks existence, access right, length and limits itself (od/), in this order, and
 * hands a value that passed to its owner, who stores or refuses it: nothing is ever half written.
 * An upload is a snapshot; a value of no bytes goes in one empty segment. A new initiate request
 * during a transfer, also while the owner is waited for, ends that transfer silently and is served.
 * An abort names the object of the request, or that of the last transfer where the request has
 * none.
 *
 *   owner    a local device; brings the dictionary and the buffer
 *   locking  none; the owner's
 *
 * A request needs room for one frame and one event in the outbox: one that finds none changes
 * nothing but 'dropped'; the owner may bring it again.
 */
#ifndef CO_PROTO_SDO_SERVER_H
#define CO_PROTO_SDO_SERVER_H

#include "base/outbox.h"
#include "base/time.h"
#include "od/od.h"

#define SDO_SERVER_TIMEOUT CO_MS(1000) /* for the client's next segment, and for the owner */

enum sdo_server_state {
    SDO_SERVER_IDLE,
    SDO_SERVER_UP_SEGMENT,
    SDO_SERVER_DOWN_SEGMENT,
    SDO_SERVER_VERDICT,
    SDO_SERVER_FETCH
};

struct sdo_server {
    const struct od *od;
    uint32_t request_id; /* CAN-IDs; 0: the channel is closed */
    uint32_t response_id;
    uint8_t state; /* enum sdo_server_state */
    bool enabled;  /* NMT state pre-operational or operational */
    bool toggle;
    bool unsent;    /* the response to what the owner decided found no room in the outbox yet */
    bool block;     /* set by the owner: block transfers are served */
    bool segmented; /* the running download came in segments: says which response is due */
    uint16_t index;
    uint8_t sub;
    uint8_t *buffer;
    uint32_t capacity;
    uint32_t size;      /* upload: bytes in the buffer; download: bytes so far */
    uint32_t position;  /* upload: bytes sent */
    uint32_t announced; /* download: size the client indicated; UINT32_MAX: none */
    uint32_t number; /* of the last question to the owner: tells an old answer from the right one */
    sdo_abort_t verdict; /* unsent */
    co_us_t deadline;
    unsigned dropped; /* requests that found no room in the outbox */
};

/* The default channel of a node; node 0: closed. */
void sdo_server_init(struct sdo_server *self, const struct od *od, uint8_t node, uint8_t *buffer,
                     uint32_t capacity);
/* CAN-IDs of 11 bits; request_id 0 closes the channel. Ends a transfer silently. */
void sdo_server_set_channel(struct sdo_server *self, uint32_t request_id, uint32_t response_id);
/* Disabling ends a transfer silently. */
void sdo_server_enable(struct sdo_server *self, bool enabled);
/* The value that waits for a verdict. */
const uint8_t *sdo_server_value(const struct sdo_server *self);
/*
 * SDO_OK: the owner has stored the value. Ignored when none is waited for; an owner who gives its
 * verdicts later compares 'number' with that of the event first.
 */
void sdo_server_verdict(struct sdo_server *self, sdo_abort_t code, co_us_t now,
                        struct co_outbox *out);
/*
 * The value of an entry whose bytes are with the owner, which are copied, or the reason why there
 * is none. Ignored when none is waited for, as sdo_server_verdict().
 */
void sdo_server_give(struct sdo_server *self, sdo_abort_t code, const uint8_t *bytes, uint32_t size,
                     co_us_t now, struct co_outbox *out);

void sdo_server_on_frame(struct sdo_server *self, const struct co_frame *frame, co_us_t now,
                         struct co_outbox *out);
void sdo_server_on_time(struct sdo_server *self, co_us_t now, struct co_outbox *out);
co_us_t sdo_server_deadline(const struct sdo_server *self);

#endif

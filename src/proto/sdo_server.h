/*
 * SDO server: one channel of a local device (CiA 301, 7.2.4).
 *
 *   in   the client's requests, the owner's verdict on a write, the bytes that it keeps, the time
 *   out  responses; PROTO_SDO_WRITE when a whole value has come for an entry; PROTO_SDO_READ when
 *        the owner is to give one
 *
 *   IDLE -- upload --> [FETCH -- sdo_server_give()] --> [UP_SEGMENT ...] --> IDLE
 *                                                   \-> BLOCK_UP_START -> BLOCK_UP -> BLOCK_UP_END
 *   IDLE -- download --> [DOWN_SEGMENT ...] --> VERDICT -- sdo_server_verdict() --> IDLE
 *                    \-> BLOCK_DOWN -> BLOCK_DOWN_END -/
 *
 * The server checks existence, access right, length and limits itself (od/), in this order, and
 * hands a value that passed to its owner, who stores or refuses it: nothing is ever half written.
 * An upload is a snapshot; a value of no bytes goes in one empty segment. A new initiate request
 * during a transfer, also while the owner is waited for, ends that transfer silently and is served;
 * but among the segments of a block download (BLOCK_DOWN) it looks like a segment. An abort names
 * the object of the request, or that of the last transfer where the request has none.
 *
 * In a block download it is the server who ends a sub-block: with its last segment, or when the
 * client has been silent for SDO_SERVER_SILENCE. Segments that are not the next are ignored, and
 * asked for again by the number of the last one that was.
 *
 *   owner    a local device; brings the dictionary and the buffer
 *   locking  none; the owner's
 *
 * A request needs room for one frame and one event in the outbox: one that finds none changes
 * nothing but 'dropped'; the owner may bring it again. The segments of a block upload fill what
 * room there is, up to a sub-block in one call, and the rest is due at once: the owner who wants
 * less at a time gives an outbox with room for less.
 */
#ifndef CO_PROTO_SDO_SERVER_H
#define CO_PROTO_SDO_SERVER_H

#include "base/outbox.h"
#include "base/time.h"
#include "od/od.h"
#include "proto/sdo.h"

#define SDO_SERVER_TIMEOUT CO_MS(1000) /* for the client's next segment, and for the owner */
#define SDO_SERVER_SILENCE CO_MS(100)  /* among the segments of a sub-block, before an answer */

enum sdo_server_state {
    SDO_SERVER_IDLE,
    SDO_SERVER_UP_SEGMENT,
    SDO_SERVER_DOWN_SEGMENT,
    SDO_SERVER_VERDICT,
    SDO_SERVER_FETCH,
    SDO_SERVER_BLOCK_DOWN,     /* segments */
    SDO_SERVER_BLOCK_DOWN_END, /* the end is to come */
    SDO_SERVER_BLOCK_UP_START, /* the client is to say that it is ready */
    SDO_SERVER_BLOCK_UP,       /* segments, and the client's A2 */
    SDO_SERVER_BLOCK_UP_END
};

enum sdo_server_form { SDO_SERVER_EXPEDITED, SDO_SERVER_SEGMENTED, SDO_SERVER_BLOCK };

struct sdo_server {
    const struct od *od;
    uint32_t request_id; /* CAN-IDs; 0: the channel is closed */
    uint32_t response_id;
    uint8_t state; /* enum sdo_server_state */
    bool enabled;  /* NMT state pre-operational or operational */
    bool toggle;
    bool unsent; /* the response to what the owner decided, or segments, found no room yet */
    bool block;  /* set by the owner: block transfers are served */
    uint8_t block_limit; /* set by the owner: segments in a sub-block to it, 1..SDO_BLOCK_MAX */
    uint8_t form;        /* enum sdo_server_form, as the request was */
    uint16_t index;
    uint8_t sub;
    uint8_t *buffer;
    uint32_t capacity;
    uint32_t size;      /* upload: bytes in the buffer; download: bytes so far */
    uint32_t position;  /* upload: bytes sent */
    uint32_t limit;     /* block download: bytes that the entry and the client's size allow */
    uint32_t announced; /* download: size the client indicated; UINT32_MAX: none */
    uint32_t number; /* of the last question to the owner: tells an old answer from the right one */
    sdo_abort_t verdict; /* unsent */
    co_us_t deadline;
    uint8_t threshold; /* block upload: so many bytes go without; 0: none do */
    union {
        struct block_sender sender;
        struct block_receiver receiver;
    };
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

/*
 * What SDO servers and clients have in common (CiA 301, 7.2.4): identifiers, and both sides of a
 * block transfer's data, whichever of the two sends it.
 *
 *     sub-block:   segment 1 .. segment n (n at most the block size)  -->
 *                  <--  A2, last segment that came in order, next block size
 *     end:         C1, unused bytes of the last segment, CRC  -->
 *                  <--  A1
 *
 * The sender goes on behind the last segment that came in order, with number 1 again. It is the
 * receiver who ends a sub-block: when the segment with the highest number or the last one of all
 * has come, or when its owner says so after a silence. If the sender was only slow, segments that
 * it sent before it got the answer still come: they are ignored, and not answered again. A
 * sub-block of which nothing came is not asked for again: it may be the answer before that is lost.
 *
 *   owner    a server or client; it makes the frames' ways and times
 *   locking  none; the owner's
 */
#ifndef CO_PROTO_SDO_H
#define CO_PROTO_SDO_H

#include "base/time.h"
#include "od/abort.h"

#include <stdbool.h>

#define SDO_REQUEST_ID   0x600u /* + node-ID, client to server */
#define SDO_RESPONSE_ID  0x580u
#define SDO_SIZE_UNKNOWN UINT32_MAX

#define SDO_SEGMENT_SIZE 7u
#define SDO_BLOCK_MAX    127u      /* segments in a sub-block */
#define SDO_SEGMENT_TIME CO_MS(14) /* of a queued one on its way to the wire, at 10 kbit/s */

/* Byte 0 in block transfers. */
#define BLOCK_CRC        0x04u /* in initiates: checksums are possible */
#define BLOCK_SIZE_TOLD  0x02u /* in initiates of who sends data */
#define BLOCK_LAST       0x80u /* in segments: the last one of all */
#define BLOCK_ABORT      0x80u /* in place of a segment, which has a number */
#define BLOCK_END_ANSWER 0xA1u
#define BLOCK_ACK        0xA2u
#define BLOCK_START      0xA3u
#define BLOCK_END        0xC1u

struct block_sender {
    const uint8_t *bytes;
    uint32_t size;
    uint32_t position; /* bytes that have arrived, as far as the receiver has told */
    uint16_t crc;      /* of these */
    bool use_crc;
    bool done;     /* all has arrived */
    uint8_t limit; /* segments in this sub-block ... */
    uint8_t sent;  /* ... and how many of them are on their way */
};

void block_sender_init(struct block_sender *self, const uint8_t *bytes, uint32_t size,
                       bool use_crc);
/* A sub-block begins with this size: SDO_OK, or SDO_BLOCK_SIZE when there is no such size. */
sdo_abort_t block_sender_begin(struct block_sender *self, uint8_t limit);
/* There are segments left in this sub-block. */
bool block_sender_has_segment(const struct block_sender *self);
void block_sender_take_segment(struct block_sender *self, uint8_t ret_data[8]);
/*
 * An A2: SDO_OK, and the next sub-block has begun unless all has arrived; SDO_BLOCK_SEQUENCE,
 * SDO_BLOCK_SIZE: it makes no sense.
 */
sdo_abort_t block_sender_on_ack(struct block_sender *self, const uint8_t data[8]);
/* The C1, when all has arrived. */
void block_sender_make_end(const struct block_sender *self, uint8_t ret_data[8]);

struct block_receiver {
    uint8_t *buffer;
    uint32_t room; /* in it */
    uint32_t size; /* bytes in it: all that came in order but those of the last segment */
    uint16_t crc;  /* of these */
    bool use_crc;
    bool holding; /* there is a last segment: how many of its bytes count is told at the end */
    uint8_t held[SDO_SEGMENT_SIZE];
    uint8_t limit;    /* segments in this sub-block */
    uint8_t in_order; /* number of its last one that came in order */
    bool heard;       /* one of its segments has come, in order or not */
    bool due;         /* its end has come: an A2 is to be sent */
    bool early;       /* the A2 before was not due: segments that it has crossed may come */
    bool complete;    /* the last segment of all has come in order */
};

void block_receiver_init(struct block_receiver *self, uint8_t *buffer, uint32_t room, bool use_crc,
                         uint8_t limit);
/*
 * A segment: SDO_OK, also for one that is not the next and changes nothing; SDO_BLOCK_SEQUENCE for
 * a number that there is not; SDO_NO_MEMORY: more bytes than there is room for.
 */
sdo_abort_t block_receiver_on_segment(struct block_receiver *self, const uint8_t data[8]);
/* The A2, with which the next sub-block begins, of this size. */
void block_receiver_make_ack(struct block_receiver *self, uint8_t limit, uint8_t ret_data[8]);
/* The C1: SDO_OK, SDO_NO_MEMORY, SDO_BLOCK_CRC. All bytes are in the buffer then. */
sdo_abort_t block_receiver_on_end(struct block_receiver *self, const uint8_t data[8]);

#endif

/*
 * SDO client: one transfer at a time with one server (CiA 301, 7.2.4).
 *
 *   in   a request, the server's answers, the own frames as transmit confirmation, the time
 *   out  request frames; PROTO_SDO_DONE, exactly once for each started transfer
 *
 *         start             answer
 *   IDLE -------> INITIATE --------> [SEGMENT ... SEGMENT] --------> [END] --> IDLE, PROTO_SDO_DONE
 *                                \-> BLOCK_DOWN -> BLOCK_DOWN_END -/
 *                                \-> BLOCK_UP -> BLOCK_UP_END -----/
 *
 * The time-out is the server's silence: it runs from the moment the request is on the wire (its own
 * frame comes back, CO_FRAME_OWN) and starts anew with each request. A request that does not get on
 * the wire has a time limit of its own; an answer shows as well that it did. An owner who does not
 * get its frames back tells instead when they are with the bus (sdo_client_on_handed_over()). Of a
 * sub-block it is the last segment whose way counts. After a time-out the server is told
 * (05040000h).
 *
 * A transfer in blocks that the server refuses at once, for a reason that may be the blocks, goes
 * on without them. In a block upload it is the client who ends a sub-block: with its last segment,
 * or when the server has been silent for half the time-out.
 *
 * Late answers are ignored and counted: those for another object, those to an idle client, and
 * what the server still owes to transfers before: segments, and first answers of another kind for
 * the same object. (One of the same kind for the same object cannot be told from the awaited one.)
 * An abort counts as the server's when its object is the one asked for, or 0000h:00, as some
 * devices send it.
 *
 *   owner    the manager: one client for each remote node
 *   locking  none; the owner's
 *
 * The segments of a block download fill what room there is in the outbox, as those of a server.
 */
#ifndef CO_PROTO_SDO_CLIENT_H
#define CO_PROTO_SDO_CLIENT_H

#include "base/outbox.h"
#include "base/time.h"
#include "proto/sdo.h"

#define SDO_SEND_TIMEOUT CO_MS(2000)  /* for a request to get on the wire ... */
#define SDO_SEND_LIMIT   CO_MS(10000) /* ... if that makes progress */

enum sdo_outcome {
    SDO_OUTCOME_OK,
    SDO_OUTCOME_ABORTED,   /* by the server; the event has its code */
    SDO_OUTCOME_NO_ANSWER, /* time-out, 05040000h was sent */
    SDO_OUTCOME_NOT_SENT,  /* the request did not get on the wire in time; no abort, code 0 */
    SDO_OUTCOME_TOGGLE,    /* wrong toggle bit, 05030000h was sent */
    SDO_OUTCOME_PROTOCOL,  /* unexpected answer, the code in the event was sent */
    SDO_OUTCOME_OVERFLOW,  /* the server has more than fits, 05040005h was sent */
    SDO_OUTCOME_CANCELLED  /* by sdo_client_cancel() */
};

enum sdo_client_state {
    SDO_CLIENT_IDLE,
    SDO_CLIENT_INITIATE,
    SDO_CLIENT_SEGMENT,
    SDO_CLIENT_BLOCK_DOWN, /* segments, and the server's A2 */
    SDO_CLIENT_BLOCK_DOWN_END,
    SDO_CLIENT_BLOCK_UP, /* segments, answered by A2 */
    SDO_CLIENT_BLOCK_UP_END,
    SDO_CLIENT_END /* over; abort frame or event found no room in the outbox yet */
};

struct sdo_transfer {
    bool download;      /* to the server */
    bool indicate_size; /* segmented download: tell the size in advance */
    bool hide_size;     /* expedited download, or in blocks: leave the size out */
    /* In blocks: segments in one, 1..SDO_BLOCK_MAX, of an upload; of a download the server says how
     * many. 0: not in blocks. */
    uint8_t block;
    uint16_t index;
    uint8_t sub;
    const uint8_t *source; /* download: what to write */
    uint8_t *buffer;       /* upload: where to */
    uint32_t size;         /* download: bytes to write; upload: room in buffer */
    co_us_t timeout;       /* silence of the server, > 0 */
};

struct sdo_client {
    uint8_t node;
    uint8_t state;        /* enum sdo_client_state */
    bool unsent;          /* a request is due, or segments are, that found no room in the outbox */
    bool on_wire;         /* the last request was confirmed; the time-out runs */
    bool toggle;          /* bit of the segment asked for, or sent, last */
    bool owes_segment;    /* the transfer before ended without the answer to its last segment */
    uint8_t owed_answers; /* bits by enum answer: transfers were given up without this first one */
    bool in_blocks;       /* asked for, and not refused so far */
    sdo_abort_t refusal;  /* of blocks; the transfer goes on without */
    struct sdo_transfer transfer;
    uint8_t request[8]; /* what was, or is to be, sent last */
    union {
        struct block_sender sender;
        struct block_receiver receiver;
    };
    uint32_t position;  /* bytes transferred */
    uint32_t announced; /* size the server indicated in an upload; UINT32_MAX: none */
    uint8_t last_size;  /* data bytes in the segment sent last */
    co_us_t send_limit; /* of the request's way to the wire, whatever progress there is */
    co_us_t deadline;   /* of the request's way to the wire, then of the answer */
    uint8_t outcome;    /* SDO_CLIENT_END: enum sdo_outcome, abort code, bytes for the event */
    sdo_abort_t code;
    uint32_t actual;
    uint8_t farewell; /* the last frame, which is due, too: ABORT or BLOCK_END_ANSWER; 0: none */
    unsigned late;    /* answers that fitted no request, ignored */
};

void sdo_client_init(struct sdo_client *self, uint8_t node);
bool sdo_client_busy(const struct sdo_client *self);

/* It must be idle. The buffer must stay, and stay as it is in a download, until PROTO_SDO_DONE. */
void sdo_client_start(struct sdo_client *self, const struct sdo_transfer *transfer, co_us_t now,
                      struct co_outbox *out);
/*
 * Ends a running transfer with SDO_OUTCOME_CANCELLED. The server is told (code) only when it is in
 * the middle of segments, or is to download in blocks; nothing is done when idle, or when the
 * outbox has no room (false). A transfer that is over already ends with the outcome that it had.
 */
bool sdo_client_cancel(struct sdo_client *self, sdo_abort_t code, struct co_outbox *out);

/*
 * Other frames of the same sender have got on the wire: the request is not stuck, only queued
 * behind them. Its time limit to get there starts anew then, up to SDO_SEND_LIMIT. It is enough to
 * tell this before the time-out, and of a time before the request it may be told, too.
 */
void sdo_client_on_progress(struct sdo_client *self, co_us_t when);

/* A request was put out, and nothing has shown yet that it is on the wire. */
bool sdo_client_awaits_wire(const struct sdo_client *self);
/*
 * In place of the own frame: what was put out is on the wire, or will be soon. The time-out runs
 * from now on; for the segments of a sub-block with the time that they may take on a slow bus.
 */
void sdo_client_on_handed_over(struct sdo_client *self, co_us_t now);

/* Takes the server's answers and the own requests; ignores all other frames. */
void sdo_client_on_frame(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                         struct co_outbox *out);
void sdo_client_on_time(struct sdo_client *self, co_us_t now, struct co_outbox *out);
co_us_t sdo_client_deadline(const struct sdo_client *self);

#endif

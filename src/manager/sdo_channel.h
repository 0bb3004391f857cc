/*
 * The SDO channel to one node: requests of the boot process and of the application, one at a time.
 *
 *   in   requests, PROTO_SDO_DONE of its client
 *   out  the ended request, with its result
 *
 * A request belongs to who made it and must stay until it is DONE or cancelled. Its time-out starts
 * when its turn comes. When a node has shown that it has no block transfers, none is asked for
 * again until sdo_channel_forget().
 *
 * Only few block downloads run at a time, whatever the node: their segments, all put out at once,
 * keep those of other requests from the bus for longer than a server waits. More go in segments.
 */
#ifndef CO_MANAGER_SDO_CHANNEL_H
#define CO_MANAGER_SDO_CHANNEL_H

#include "proto/sdo_client.h"

#define SDO_CHANNEL_BLOCK_DOWNLOADS 2u /* at a time */

enum sdo_request_state { REQUEST_IDLE, REQUEST_QUEUED, REQUEST_RUNNING, REQUEST_DONE };

struct sdo_request {
    struct sdo_request *next;
    struct sdo_transfer transfer;
    uint8_t state;          /* enum sdo_request_state */
    struct co_event result; /* PROTO_SDO_DONE, once DONE */
    uint32_t caller;        /* who waits for it, in a number of the owner's; 0: anybody */
};

struct sdo_channel {
    struct sdo_client client;
    struct sdo_request *running;
    struct sdo_request *first, *last; /* waiting */
    bool no_blocks;
    bool counted;              /* what runs is one of ... */
    unsigned *block_downloads; /* ... so many, of all channels of a network */
    unsigned cancelled;        /* PROTO_SDO_DONE still to come for requests that were taken out */
};

/* All channels of a network count their block downloads in one place, 0 to begin with. */
void sdo_channel_init(struct sdo_channel *self, uint8_t node, unsigned *block_downloads);
/* The node has started anew: it may be another one. */
void sdo_channel_forget(struct sdo_channel *self);
void sdo_channel_submit(struct sdo_channel *self, struct sdo_request *request, co_us_t now,
                        struct co_outbox *out);
/* The same before all that wait: the boot of a node waits for one transfer, not for a queue. */
void sdo_channel_submit_first(struct sdo_channel *self, struct sdo_request *request, co_us_t now,
                              struct co_outbox *out);
/*
 * Takes a request out, running or waiting; it becomes IDLE and gives no event. code 0: the server
 * is not told. False when the outbox has no room to tell it: try again.
 */
bool sdo_channel_cancel(struct sdo_channel *self, struct sdo_request *request, sdo_abort_t code,
                        co_us_t now, struct co_outbox *out);
/* Takes all requests out at once, so that none of those that wait is started. */
void sdo_channel_clear(struct sdo_channel *self, co_us_t now, struct co_outbox *out);
/* Hands over the client's PROTO_SDO_DONE; the request that ended with it, or NULL (cancelled). */
struct sdo_request *sdo_channel_on_done(struct sdo_channel *self, const struct co_event *event,
                                        co_us_t now, struct co_outbox *out);
/*
 * Without a bus: takes the running or the oldest waiting request out, DONE with NOT_SENT; NULL when
 * there is none left. Nothing is sent.
 */
struct sdo_request *sdo_channel_give_up(struct sdo_channel *self);
/* The same for a request that comes only then. */
void sdo_request_give_up(struct sdo_request *request, uint8_t node);

#endif

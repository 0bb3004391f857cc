/*
 * An SDO client and an SDO server on a wire of their own, for whole transfers of one object. The
 * frames take no time; where none is on its way, time jumps to the next deadline.
 */
#ifndef TEST_SUPPORT_SDO_LOOP_H
#define TEST_SUPPORT_SDO_LOOP_H

#include "proto/sdo_client.h"
#include "proto/sdo_server.h"

#define LOOP_ROOM    160u     /* frames in an outbox, at most */
#define LOOP_LARGE   1000000u /* bytes that the object may have */
#define LOOP_TIMEOUT CO_MS(200)

struct sdo_loop {
    struct od od;
    struct od_entry *entry; /* 2000:00, a domain */
    struct sdo_client client;
    struct sdo_server server;
    struct co_outbox to_server, to_client;
    struct co_frame frames[2][LOOP_ROOM];
    struct co_event events[2][2];
    uint8_t *server_buffer;
    uint8_t *data; /* of the client: LOOP_LARGE bytes, and one more */
    uint64_t seed;
    bool (*loses)(struct sdo_loop *self, const struct co_frame *frame,
                  bool to_server); /* or NULL */
    unsigned loss;                 /* for it: one frame of so many; the number of the only one */
    unsigned count;                /* frames so far */
    unsigned calls;                /* of a machine */
    uint8_t block;                 /* of the client's transfers */
    bool indicate_size;            /* of its downloads */
    struct co_event end;
    co_us_t now;
};

/* Outboxes with room for so many frames. */
void sdo_loop_init(struct sdo_loop *self, unsigned room);
void sdo_loop_done(struct sdo_loop *self);

/* A transfer to its end, which is in 'end'; random data. */
void sdo_loop_download(struct sdo_loop *self, uint32_t size);
void sdo_loop_upload(struct sdo_loop *self, uint32_t room);
/* Down and up again: all is well. */
void sdo_loop_check(struct sdo_loop *self, uint32_t size);
/* Until the server has given up, too. */
void sdo_loop_rest(struct sdo_loop *self);

#endif

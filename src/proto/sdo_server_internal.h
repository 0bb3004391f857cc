/*
 * What the files of the SDO server share: sdo_server.c has the requests, expedited and segmented
 * transfers, and the owner's part; sdo_server_block.c has block transfers.
 */
#ifndef CO_PROTO_SDO_SERVER_INTERNAL_H
#define CO_PROTO_SDO_SERVER_INTERNAL_H

#include "proto/sdo_server.h"

/* Functions that return an abort code return it to sdo_server_on_frame(), which sends it. */

/* The only way out of a transfer. */
void sdo_server_finish(struct sdo_server *self);
void sdo_server_wait(struct sdo_server *self, enum sdo_server_state state, co_us_t now);
void sdo_server_put(const struct sdo_server *self, const uint8_t data[8], struct co_outbox *out);
/* A response with the transfer's object, and 4 bytes or a number. */
void sdo_server_respond(const struct sdo_server *self, unsigned command, const uint8_t field[4],
                        struct co_outbox *out);
void sdo_server_respond_number(const struct sdo_server *self, unsigned command, uint32_t number,
                               struct co_outbox *out);
/* Can a value of this size be taken? */
sdo_abort_t sdo_server_check_room(const struct sdo_server *self, const struct od_entry *entry,
                                  uint32_t size);
/* Takes the value, or asks the owner for it, and answers. */
sdo_abort_t sdo_server_begin_upload(struct sdo_server *self, const struct od_entry *entry,
                                    co_us_t now, struct co_outbox *out);
/* Asks the owner for its verdict on the value in the buffer. */
sdo_abort_t sdo_server_offer_value(struct sdo_server *self, co_us_t now, struct co_outbox *out);

/* Initiates; the object is taken already. */
sdo_abort_t sdo_server_on_block_upload(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                       struct co_outbox *out);
sdo_abort_t sdo_server_on_block_download(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                         struct co_outbox *out);
/* A1, A2, A3, C1. */
sdo_abort_t sdo_server_on_block_command(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                        struct co_outbox *out);
sdo_abort_t sdo_server_on_block_segment(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                        struct co_outbox *out);
/* The value in the buffer is to go in blocks, and does. */
bool sdo_server_uploads_block(const struct sdo_server *self);
void sdo_server_begin_block_upload(struct sdo_server *self, co_us_t now, struct co_outbox *out);
void sdo_server_send_segments(struct sdo_server *self, co_us_t now, struct co_outbox *out);
/* Answers the segments of a sub-block, which may not all have come. */
void sdo_server_end_sub_block(struct sdo_server *self, co_us_t now, struct co_outbox *out);

#endif

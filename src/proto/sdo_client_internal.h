/*
 * What the files of the SDO client share: sdo_client.c has the way of a transfer from its start to
 * its end, expedited and segmented; sdo_client_block.c has block transfers.
 */
#ifndef CO_PROTO_SDO_CLIENT_INTERNAL_H
#define CO_PROTO_SDO_CLIENT_INTERNAL_H

#include "proto/sdo_client.h"

/* A request, or segments, are to be sent: their way to the wire begins. */
void sdo_client_begin_request(struct sdo_client *self, co_us_t now);
/* Sends what 'request' has, now or when there is room. */
void sdo_client_request(struct sdo_client *self, co_us_t now, struct co_outbox *out);

/* The only ways out of a transfer; an abort is sent by all but the first. */
void sdo_client_finish(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
                       struct co_outbox *out);
void sdo_client_finish_and_tell(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
                                struct co_outbox *out);
void sdo_client_finish_overflow(struct sdo_client *self, uint32_t needed, struct co_outbox *out);
void sdo_client_finish_unexpected(struct sdo_client *self, struct co_outbox *out);

void sdo_client_make_block_initiate(const struct sdo_client *self, uint8_t ret_data[8]);
/* The answers to it. */
void sdo_client_on_block_download(struct sdo_client *self, const struct co_frame *frame,
                                  co_us_t now, struct co_outbox *out);
void sdo_client_on_block_upload(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out);
/* All others but aborts. */
void sdo_client_on_block_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out);
void sdo_client_send_segments(struct sdo_client *self, co_us_t now, struct co_outbox *out);
/* Answers the segments of a sub-block, which may not all have come. */
void sdo_client_end_sub_block(struct sdo_client *self, co_us_t now, struct co_outbox *out);

#endif

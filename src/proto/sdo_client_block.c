#include "proto/sdo_client_internal.h"

#include "base/bytes.h"

#include <string.h>

/* Byte 0 of initiates, without options. */
#define UPLOAD   0xA0u
#define DOWNLOAD 0xC0u

void sdo_client_make_block_initiate(const struct sdo_client *self, uint8_t ret_data[8])
{
    const struct sdo_transfer *transfer = &self->transfer;

    memset(ret_data, 0, 8);
    ret_data[0] = (transfer->download ? DOWNLOAD : UPLOAD) | BLOCK_CRC;
    put_le16(ret_data + 1, transfer->index);
    ret_data[3] = transfer->sub;
    if (!transfer->download) {
        ret_data[4] = transfer->block;
    } else if (!transfer->hide_size) {
        ret_data[0] |= BLOCK_SIZE_TOLD;
        put_le32(ret_data + 4, transfer->size);
    }
}

static void finish_protocol(struct sdo_client *self, sdo_abort_t code, struct co_outbox *out)
{
    sdo_client_finish_and_tell(self, SDO_OUTCOME_PROTOCOL, code, out);
}

void sdo_client_send_segments(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame = co_frame_make(SDO_REQUEST_ID + self->node, 8);

    while (block_sender_has_segment(&self->sender) && co_outbox_room(out, 1, 0)) {
        block_sender_take_segment(&self->sender, self->request);
        memcpy(frame.data, self->request, sizeof frame.data);
        co_outbox_put_frame(out, &frame);
    }
    self->unsent = block_sender_has_segment(&self->sender);
    self->deadline = co_earlier(now + SDO_SEND_TIMEOUT, self->send_limit);
}

static void begin_sub_block(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->state = SDO_CLIENT_BLOCK_DOWN;
    sdo_client_begin_request(self, now);
    sdo_client_send_segments(self, now, out);
}

void sdo_client_on_block_download(struct sdo_client *self, const struct co_frame *frame,
                                  co_us_t now, struct co_outbox *out)
{
    sdo_abort_t code;

    if (frame->dlc < 5) {
        self->late++;
        return;
    }
    block_sender_init(&self->sender, self->transfer.source, self->transfer.size,
                      (frame->data[0] & BLOCK_CRC) != 0);
    code = block_sender_begin(&self->sender, frame->data[4]);
    if (code != SDO_OK)
        finish_protocol(self, code, out);
    else
        begin_sub_block(self, now, out);
}

static void on_sub_block_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out)
{
    const sdo_abort_t code = block_sender_on_ack(&self->sender, frame->data);

    self->position = self->sender.position;
    if (code != SDO_OK) {
        finish_protocol(self, code, out);
    } else if (!self->sender.done) {
        begin_sub_block(self, now, out);
    } else {
        block_sender_make_end(&self->sender, self->request);
        self->state = SDO_CLIENT_BLOCK_DOWN_END;
        sdo_client_request(self, now, out);
    }
}

void sdo_client_on_block_upload(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out)
{
    const bool size_told = (frame->data[0] & BLOCK_SIZE_TOLD) != 0;
    uint32_t room = self->transfer.size;

    if (size_told && frame->dlc < 8) {
        self->late++;
        return;
    }
    if (size_told)
        self->announced = get_le32(frame->data + 4);
    if (size_told && self->announced > room) {
        sdo_client_finish_overflow(self, self->announced, out);
        return;
    }
    if (size_told)
        room = self->announced;
    block_receiver_init(&self->receiver, self->transfer.buffer, room,
                        (frame->data[0] & BLOCK_CRC) != 0, self->transfer.block);
    memset(self->request, 0, sizeof self->request);
    self->request[0] = BLOCK_START;
    self->state = SDO_CLIENT_BLOCK_UP;
    sdo_client_request(self, now, out);
}

void sdo_client_end_sub_block(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    block_receiver_make_ack(&self->receiver, self->transfer.block, self->request);
    if (self->receiver.complete)
        self->state = SDO_CLIENT_BLOCK_UP_END;
    sdo_client_request(self, now, out);
}

/* Something is wrong with what has come. */
static void finish_bad_data(struct sdo_client *self, sdo_abort_t code, struct co_outbox *out)
{
    if (code != SDO_NO_MEMORY)
        finish_protocol(self, code, out);
    else if (self->announced != SDO_SIZE_UNKNOWN)
        finish_protocol(self, SDO_TYPE_LENGTH, out);
    else
        sdo_client_finish_overflow(self, SDO_SIZE_UNKNOWN, out);
}

static void on_segment(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                       struct co_outbox *out)
{
    sdo_abort_t code;

    if (frame->dlc < 8) {
        self->late++;
        return;
    }
    code = block_receiver_on_segment(&self->receiver, frame->data);
    self->position = self->receiver.size;
    if (code != SDO_OK) {
        finish_bad_data(self, code, out);
    } else if (self->receiver.due) {
        sdo_client_end_sub_block(self, now, out);
    } else {
        self->on_wire = true; /* the request before was */
        self->deadline = now + self->transfer.timeout / 2;
    }
}

static void on_upload_end(struct sdo_client *self, const struct co_frame *frame,
                          struct co_outbox *out)
{
    sdo_abort_t code = block_receiver_on_end(&self->receiver, frame->data);

    self->position = self->receiver.size;
    if (code == SDO_OK && self->announced != SDO_SIZE_UNKNOWN && self->position != self->announced)
        code = SDO_TYPE_LENGTH;
    if (code != SDO_OK) {
        finish_bad_data(self, code, out);
        return;
    }
    self->farewell = BLOCK_END_ANSWER;
    sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
}

/* Answers to initiates name an object: that of a transfer before is a late one. */
static bool is_late(const struct sdo_client *self, const struct co_frame *frame)
{
    const unsigned answer = frame->data[0] >> 5;

    return (answer == 2 || answer == 3) &&
           (frame->dlc < 4 || get_le16(frame->data + 1) != self->transfer.index ||
            frame->data[3] != self->transfer.sub);
}

void sdo_client_on_block_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                                struct co_outbox *out)
{
    const unsigned command = frame->data[0];

    if (self->state == SDO_CLIENT_BLOCK_UP)
        on_segment(self, frame, now, out);
    else if (is_late(self, frame) || frame->dlc < 3)
        self->late++;
    else if (self->state == SDO_CLIENT_BLOCK_DOWN && command == BLOCK_ACK)
        on_sub_block_answer(self, frame, now, out);
    else if (self->state == SDO_CLIENT_BLOCK_DOWN_END && command == BLOCK_END_ANSWER)
        sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
    else if (self->state == SDO_CLIENT_BLOCK_UP_END && (command & 0xE3u) == BLOCK_END)
        on_upload_end(self, frame, out);
    else
        sdo_client_finish_unexpected(self, out);
}

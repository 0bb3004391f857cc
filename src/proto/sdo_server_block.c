#include "proto/sdo_server_internal.h"

#include "base/bytes.h"

/* Byte 0 of responses to initiates. */
#define ANSWER_UPLOAD   0xC0u
#define ANSWER_DOWNLOAD 0xA0u

sdo_abort_t sdo_server_on_block_upload(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                       struct co_outbox *out)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = od_check_read(self->od, self->index, self->sub, &entry);

    block_sender_init(&self->sender, self->buffer, 0, (data[0] & BLOCK_CRC) != 0);
    if (code == SDO_OK)
        code = block_sender_begin(&self->sender, data[4]);
    if (code != SDO_OK)
        return code;
    self->threshold = data[5];
    self->form = SDO_SERVER_BLOCK;
    return sdo_server_begin_upload(self, entry, now, out);
}

bool sdo_server_uploads_block(const struct sdo_server *self)
{
    return self->form == SDO_SERVER_BLOCK && (self->threshold == 0 || self->size > self->threshold);
}

void sdo_server_begin_block_upload(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    self->sender.size = self->size;
    sdo_server_respond_number(self, ANSWER_UPLOAD | BLOCK_CRC | BLOCK_SIZE_TOLD, self->size, out);
    sdo_server_wait(self, SDO_SERVER_BLOCK_UP_START, now);
}

void sdo_server_send_segments(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    uint8_t data[8];

    while (block_sender_has_segment(&self->sender) && co_outbox_room(out, 1, 0)) {
        block_sender_take_segment(&self->sender, data);
        sdo_server_put(self, data, out);
    }
    self->unsent = block_sender_has_segment(&self->sender);
    sdo_server_wait(self, SDO_SERVER_BLOCK_UP, now);
    self->deadline += self->sender.sent * SDO_SEGMENT_TIME;
}

static sdo_abort_t on_sub_block_answer(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                       struct co_outbox *out)
{
    const sdo_abort_t code = block_sender_on_ack(&self->sender, data);
    uint8_t end[8];

    if (code != SDO_OK)
        return code;
    if (!self->sender.done) {
        sdo_server_send_segments(self, now, out);
        return SDO_OK;
    }
    self->unsent = false;
    block_sender_make_end(&self->sender, end);
    sdo_server_put(self, end, out);
    sdo_server_wait(self, SDO_SERVER_BLOCK_UP_END, now);
    return SDO_OK;
}

sdo_abort_t sdo_server_on_block_download(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                         struct co_outbox *out)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = od_check_write(self->od, self->index, self->sub, &entry);

    if (code != SDO_OK)
        return code;
    self->announced = data[0] & BLOCK_SIZE_TOLD ? get_le32(data + 4) : SDO_SIZE_UNKNOWN;
    if (self->announced != SDO_SIZE_UNKNOWN)
        code = sdo_server_check_room(self, entry, self->announced);
    if (code != SDO_OK)
        return code;
    self->limit = entry->capacity < self->announced ? entry->capacity : self->announced;
    self->form = SDO_SERVER_BLOCK;
    block_receiver_init(&self->receiver, self->buffer,
                        self->limit < self->capacity ? self->limit : self->capacity,
                        (data[0] & BLOCK_CRC) != 0, self->block_limit);
    sdo_server_respond_number(self, ANSWER_DOWNLOAD | BLOCK_CRC, self->receiver.limit, out);
    sdo_server_wait(self, SDO_SERVER_BLOCK_DOWN, now);
    return SDO_OK;
}

/* What is wrong when more comes than there is room for. */
static sdo_abort_t name_overflow(const struct sdo_server *self, sdo_abort_t code)
{
    return code == SDO_NO_MEMORY && self->receiver.room == self->limit ? SDO_TOO_LONG : code;
}

void sdo_server_end_sub_block(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    uint8_t data[8];

    block_receiver_make_ack(&self->receiver, self->block_limit, data);
    sdo_server_put(self, data, out);
    sdo_server_wait(
        self, self->receiver.complete ? SDO_SERVER_BLOCK_DOWN_END : SDO_SERVER_BLOCK_DOWN, now);
}

sdo_abort_t sdo_server_on_block_segment(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                        struct co_outbox *out)
{
    const sdo_abort_t code = block_receiver_on_segment(&self->receiver, data);

    if (code != SDO_OK)
        return name_overflow(self, code);
    if (self->receiver.due)
        sdo_server_end_sub_block(self, now, out);
    else
        self->deadline = now + SDO_SERVER_SILENCE;
    return SDO_OK;
}

static sdo_abort_t on_download_end(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                   struct co_outbox *out)
{
    const sdo_abort_t code = block_receiver_on_end(&self->receiver, data);

    if (code != SDO_OK)
        return name_overflow(self, code);
    self->size = self->receiver.size;
    if (self->announced != SDO_SIZE_UNKNOWN && self->size < self->announced)
        return SDO_TOO_SHORT;
    return sdo_server_offer_value(self, now, out);
}

sdo_abort_t sdo_server_on_block_command(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                        struct co_outbox *out)
{
    const unsigned command = data[0] & (data[0] >> 5 == BLOCK_END >> 5 ? 0xE1u : 0xE3u);

    if (command == BLOCK_START && self->state == SDO_SERVER_BLOCK_UP_START) {
        sdo_server_send_segments(self, now, out);
        return SDO_OK;
    }
    if (command == BLOCK_ACK && self->state == SDO_SERVER_BLOCK_UP)
        return on_sub_block_answer(self, data, now, out);
    if (command == BLOCK_END_ANSWER && self->state == SDO_SERVER_BLOCK_UP_END) {
        sdo_server_finish(self);
        return SDO_OK;
    }
    if (command == BLOCK_END && self->state == SDO_SERVER_BLOCK_DOWN_END)
        return on_download_end(self, data, now, out);
    return SDO_COMMAND;
}

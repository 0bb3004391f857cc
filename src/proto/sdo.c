#include "proto/sdo.h"

#include "base/bytes.h"
#include "base/crc16.h"

#include <assert.h>
#include <string.h>

#define NUMBER 0x7Fu /* of a segment, in its byte 0 */

void block_sender_init(struct block_sender *self, const uint8_t *bytes, uint32_t size, bool use_crc)
{
    *self = (struct block_sender){ .bytes = bytes, .size = size, .use_crc = use_crc };
}

sdo_abort_t block_sender_begin(struct block_sender *self, uint8_t limit)
{
    if (limit == 0 || limit > SDO_BLOCK_MAX)
        return SDO_BLOCK_SIZE;
    self->limit = limit;
    self->sent = 0;
    return SDO_OK;
}

/* Nothing at all goes in one empty segment. */
static bool is_beyond_end(const struct block_sender *self, unsigned segments)
{
    return segments > 0 && segments * SDO_SEGMENT_SIZE >= self->size - self->position;
}

bool block_sender_has_segment(const struct block_sender *self)
{
    return self->sent < self->limit && !is_beyond_end(self, self->sent);
}

void block_sender_take_segment(struct block_sender *self, uint8_t ret_data[8])
{
    const uint32_t first = self->position + self->sent * SDO_SEGMENT_SIZE;
    const uint32_t rest = self->size - first;
    const uint32_t size = rest < SDO_SEGMENT_SIZE ? rest : SDO_SEGMENT_SIZE;

    assert(block_sender_has_segment(self));
    self->sent++;
    memset(ret_data, 0, 8);
    ret_data[0] = (uint8_t)(self->sent | (size == rest ? BLOCK_LAST : 0));
    if (size > 0)
        memcpy(ret_data + 1, self->bytes + first, size);
}

static void advance(struct block_sender *self, unsigned segments)
{
    const uint32_t rest = self->size - self->position;
    uint32_t size = segments * SDO_SEGMENT_SIZE;

    if (size > rest)
        size = rest;
    if (self->use_crc && size > 0)
        self->crc = crc16_add(self->crc, self->bytes + self->position, size);
    self->position += size;
}

sdo_abort_t block_sender_on_ack(struct block_sender *self, const uint8_t data[8])
{
    const uint8_t arrived = data[1];

    if (arrived > self->sent)
        return SDO_BLOCK_SEQUENCE;
    if (data[2] == 0 || data[2] > SDO_BLOCK_MAX)
        return SDO_BLOCK_SIZE;
    self->done = is_beyond_end(self, arrived);
    advance(self, arrived);
    return self->done ? SDO_OK : block_sender_begin(self, data[2]);
}

void block_sender_make_end(const struct block_sender *self, uint8_t ret_data[8])
{
    const uint32_t last = self->size % SDO_SEGMENT_SIZE; /* bytes in the last segment; 0: all */
    const uint32_t unused = self->size == 0 ? SDO_SEGMENT_SIZE
                                            : (SDO_SEGMENT_SIZE - last) % SDO_SEGMENT_SIZE;

    memset(ret_data, 0, 8);
    ret_data[0] = (uint8_t)(BLOCK_END | unused << 2);
    put_le16(ret_data + 1, self->crc);
}

void block_receiver_init(struct block_receiver *self, uint8_t *buffer, uint32_t room, bool use_crc,
                         uint8_t limit)
{
    *self = (struct block_receiver){
        .buffer = buffer, .room = room, .use_crc = use_crc, .limit = limit
    };
}

/* So many bytes of the segment that is held are the transfer's. */
static sdo_abort_t release(struct block_receiver *self, uint32_t size)
{
    if (size > self->room - self->size)
        return SDO_NO_MEMORY;
    if (size == 0)
        return SDO_OK;
    if (self->use_crc)
        self->crc = crc16_add(self->crc, self->held, size);
    memcpy(self->buffer + self->size, self->held, size);
    self->size += size;
    return SDO_OK;
}

static sdo_abort_t take_next(struct block_receiver *self, const uint8_t data[8])
{
    const sdo_abort_t code = self->holding ? release(self, SDO_SEGMENT_SIZE) : SDO_OK;

    if (code != SDO_OK)
        return code;
    memcpy(self->held, data + 1, SDO_SEGMENT_SIZE);
    self->holding = true;
    self->in_order++;
    self->complete = (data[0] & BLOCK_LAST) != 0;
    return SDO_OK;
}

sdo_abort_t block_receiver_on_segment(struct block_receiver *self, const uint8_t data[8])
{
    const uint8_t number = data[0] & NUMBER;

    if (number == 0 || number > self->limit)
        return SDO_BLOCK_SEQUENCE;
    self->heard = true;
    if (self->early && number != 1)
        return SDO_OK;
    self->early = false;
    self->due = number == self->limit || (data[0] & BLOCK_LAST) != 0;
    return number == self->in_order + 1 ? take_next(self, data) : SDO_OK;
}

void block_receiver_make_ack(struct block_receiver *self, uint8_t limit, uint8_t ret_data[8])
{
    memset(ret_data, 0, 8);
    ret_data[0] = BLOCK_ACK;
    ret_data[1] = self->in_order;
    ret_data[2] = limit;
    self->limit = limit;
    self->in_order = 0;
    self->early = !self->due;
    self->heard = false;
    self->due = false;
}

sdo_abort_t block_receiver_on_end(struct block_receiver *self, const uint8_t data[8])
{
    const unsigned unused = data[0] >> 2 & 7u;
    const sdo_abort_t code = release(self, SDO_SEGMENT_SIZE - unused);

    if (code == SDO_OK && self->use_crc && get_le16(data + 1) != self->crc)
        return SDO_BLOCK_CRC;
    return code;
}

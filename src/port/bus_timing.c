#include "port/bus_timing.h"

#define CRC_BITS       15u
#define CRC_POLYNOMIAL 0x4599u
#define STUFF_RUN      5u /* equal bits, then one of the other kind */
#define UNSTUFFED_BITS                                                                             \
    13u /* CRC delimiter, ACK and its delimiter, 7 end of frame, 3 intermission */

struct bit_stream {
    unsigned count; /* with stuff bits */
    unsigned run;   /* of equal bits up to now ... */
    uint32_t last;  /* ... of this kind */
    uint32_t crc;
};

static void put_bit(struct bit_stream *self, uint32_t bit)
{
    uint32_t carry = bit ^ (self->crc >> (CRC_BITS - 1) & 1u);

    self->crc = (self->crc << 1 & 0x7FFFu) ^ (carry ? CRC_POLYNOMIAL : 0);
    self->run = bit == self->last ? self->run + 1 : 1;
    self->last = bit;
    self->count++;
    if (self->run == STUFF_RUN) {
        self->last = !bit;
        self->run = 1;
        self->count++;
    }
}

static void put_bits(struct bit_stream *self, uint32_t bits, unsigned size)
{
    while (size-- > 0)
        put_bit(self, bits >> size & 1u);
}

/* 11 bits, RTR, IDE (0), r0; or 11 bits, SRR (1), IDE (1), 18 bits, RTR, r1, r0. */
static void put_arbitration(struct bit_stream *self, const struct co_frame *frame)
{
    uint32_t rtr = (frame->flags & CO_FRAME_RTR) != 0;

    if (frame->flags & CO_FRAME_EXT) {
        put_bits(self, frame->id >> 18, 11);
        put_bits(self, 3, 2);
        put_bits(self, frame->id, 18);
        put_bits(self, rtr << 2, 3);
    } else {
        put_bits(self, frame->id, 11);
        put_bits(self, rtr << 2, 3);
    }
}

unsigned bus_frame_bits(const struct co_frame *frame)
{
    struct bit_stream stream = { .last = 1 }; /* the idle bus, of which no run counts */

    put_bit(&stream, 0);
    put_arbitration(&stream, frame);
    put_bits(&stream, frame->dlc, 4);
    for (unsigned i = 0; !(frame->flags & CO_FRAME_RTR) && i < frame->dlc; i++)
        put_bits(&stream, frame->data[i], 8);
    put_bits(&stream, stream.crc, CRC_BITS);
    return stream.count + UNSTUFFED_BITS;
}

uint32_t bus_frame_priority(const struct co_frame *frame)
{
    uint32_t rtr = (frame->flags & CO_FRAME_RTR) != 0;

    if (frame->flags & CO_FRAME_EXT)
        return frame->id >> 18 << 21 | 3u << 19 | (frame->id & 0x3FFFFu) << 1 | rtr;
    return frame->id << 21 | rtr << 20;
}

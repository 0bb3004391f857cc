/*
 * SDO client under frames, confirmations, time and outboxes of any kind.
 *
 * The input is a list of steps, one byte each with what it needs behind it:
 *
 *     0..63      start: download?, blocks?, index, size and room from the following 4 bytes
 *     64..191    the server's frame: 9 bytes, dlc and data; in blocks one with bit 2 takes the
 *                number that fits
 *     192..215   the own request comes back
 *     216..223   the requests were handed over
 *     224..247   time passes: one byte, in units of 10 ms
 *     248..255   cancel
 *
 * The low bits of the step say how much room the outbox has in it.
 */
#include "proto/event.h"
#include "proto/sdo_client.h"

#include <stdlib.h>
#include <string.h>

#define NODE 5
#define ROOM 64u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
    const uint8_t *data;
    size_t size;
};

struct fuzz {
    struct sdo_client client;
    uint8_t *buffer; /* exactly as large as told to the client */
    struct co_frame sent;
    co_us_t now;
    unsigned starts, ends;
    struct co_frame frames[2];
    struct co_event events[2];
    struct co_outbox out;
};

static void check(bool condition)
{
    if (!condition)
        abort();
}

static uint8_t take(struct input *self)
{
    if (self->size == 0)
        return 0;
    self->size--;
    return *self->data++;
}

static void start(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);
    struct sdo_transfer transfer = { .download = (kind & 1) != 0,
                                     .indicate_size = (kind & 2) != 0,
                                     .block = kind >> 4 & 7,
                                     .index = (uint16_t)(take(input) % 4),
                                     .sub = (uint8_t)(take(input) % 4),
                                     .size = take(input) % ROOM,
                                     .timeout = CO_MS(100) };

    if (sdo_client_busy(&self->client))
        return;
    free(self->buffer);
    self->buffer = calloc(1, transfer.size > 0 ? transfer.size : 1);
    check(self->buffer != NULL);
    transfer.buffer = self->buffer;
    transfer.source = self->buffer;
    self->starts++;
    sdo_client_start(&self->client, &transfer, self->now, &self->out);
}

static void answer(struct fuzz *self, struct input *input, bool fit)
{
    struct co_frame frame = co_frame_make(SDO_RESPONSE_ID + NODE, take(input) % 9);

    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = take(input);
    if (fit && self->client.state == SDO_CLIENT_BLOCK_UP)
        frame.data[0] = (uint8_t)((frame.data[0] & BLOCK_LAST) |
                                  (self->client.receiver.in_order + 1));
    sdo_client_on_frame(&self->client, &frame, self->now, &self->out);
}

static void confirm(struct fuzz *self)
{
    struct co_frame frame = self->sent;

    frame.flags |= CO_FRAME_OWN;
    sdo_client_on_frame(&self->client, &frame, self->now, &self->out);
}

static void step(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);

    co_outbox_init(&self->out, self->frames, kind & 1 ? 0 : 2, self->events, kind & 2 ? 0 : 2);
    if (kind < 64)
        start(self, input);
    else if (kind < 192)
        answer(self, input, (kind & 4) != 0);
    else if (kind < 216)
        confirm(self);
    else if (kind < 224)
        sdo_client_on_handed_over(&self->client, self->now);
    else if (kind < 248)
        self->now += CO_MS(10) * take(input);
    else
        sdo_client_cancel(&self->client, SDO_GENERAL, &self->out);
    sdo_client_on_time(&self->client, self->now, &self->out);
}

static void drain(struct fuzz *self)
{
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &self->sent))
        check(self->sent.id == SDO_REQUEST_ID + NODE && self->sent.dlc == 8);
    while (co_outbox_take_event(&self->out, &event)) {
        check(event.type == PROTO_SDO_DONE && event.detail <= SDO_OUTCOME_CANCELLED);
        check((event.detail != SDO_OUTCOME_OK) || event.actual <= self->client.transfer.size);
        self->ends++;
    }
    check(self->starts == self->ends + sdo_client_busy(&self->client));
    check(sdo_client_busy(&self->client) == (sdo_client_deadline(&self->client) != CO_NEVER));
}

/* Whatever came before: with room and time a transfer ends. */
static void end(struct fuzz *self)
{
    for (unsigned i = 0; i < SDO_BLOCK_MAX && sdo_client_busy(&self->client); i++) {
        co_outbox_init(&self->out, self->frames, 2, self->events, 2);
        self->now += 2 * SDO_SEND_TIMEOUT;
        sdo_client_on_time(&self->client, self->now, &self->out);
        drain(self);
    }
    check(!sdo_client_busy(&self->client));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = { .data = data, .size = size };
    struct fuzz fuzz = { .starts = 0 };

    sdo_client_init(&fuzz.client, NODE);
    while (input.size > 0) {
        step(&fuzz, &input);
        drain(&fuzz);
    }
    end(&fuzz);
    free(fuzz.buffer);
    return 0;
}

/*
 * SDO server under requests, verdicts, time and outboxes of any kind.
 *
 * The input is a list of steps, one byte each with what it needs behind it:
 *
 *     0..191     a request: 8 bytes; an odd one takes the toggle bit or number that fits
 *     192..207   a verdict: one byte, 0 stores the value
 *     208..223   the value that is asked for: one byte, its size, or above 200 the refusal
 *     224..247   time passes: one byte, in units of 10 ms
 *     248..255   disabled and enabled again
 *
 * The low bits of the step say how much room the outbox has in it.
 */
#include "proto/event.h"
#include "proto/sdo_server.h"

#include <stdlib.h>
#include <string.h>

#define NODE     5
#define CAPACITY 48u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
    const uint8_t *data;
    size_t size;
};

struct fuzz {
    struct od od;
    struct sdo_server server;
    uint8_t *buffer; /* exactly as large as told to the server */
    co_us_t now;
    bool waiting; /* a write was told and not decided */
    struct co_frame frames[2];
    struct co_event events[2];
    struct co_outbox out;
};

/* Index 0000h..0008h, so that requests of zeros and small numbers hit. */
static const struct od_spec entries[] = {
    { .index = 0, .type = OD_UNSIGNED32, .access = OD_RW },
    { .index = 1, .type = OD_UNSIGNED16, .access = OD_RO },
    { .index = 2, .type = OD_DOMAIN, .access = OD_RW, .capacity = 64 },
    { .index = 3, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 3 },
    { .index = 4,
      .type = OD_INTEGER64,
      .access = OD_RW,
      .has_low = true,
      .has_high = true,
      .low = -9,
      .high = INT64_MAX / 2 },
    { .index = 5, .type = OD_REAL32, .access = OD_WO, .has_high = true },
    { .index = 6, .type = OD_BOOLEAN, .access = OD_RW },
    { .index = 7, .sub = 1, .type = OD_OCTET_STRING, .access = OD_RWW, .capacity = 40 },
    { .index = 8, .type = OD_DOMAIN, .access = OD_RW, .capacity = 30 }, /* fetched */
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

static uint8_t fitting(const struct sdo_server *server, uint8_t command)
{
    if (server->state == SDO_SERVER_BLOCK_DOWN)
        return (uint8_t)((command & BLOCK_LAST) | (server->receiver.in_order + 1));
    return (uint8_t)((command & ~0x10) | (server->toggle ? 0x10 : 0));
}

static void request(struct fuzz *self, struct input *input, bool fit)
{
    struct co_frame frame = co_frame_make(0x600 + NODE, 8);

    for (unsigned i = 0; i < 8; i++)
        frame.data[i] = take(input);
    if (fit)
        frame.data[0] = fitting(&self->server, frame.data[0]);
    sdo_server_on_frame(&self->server, &frame, self->now, &self->out);
}

static void decide(struct fuzz *self, sdo_abort_t code)
{
    const struct sdo_server *server = &self->server;

    if (code == SDO_OK && self->waiting && server->state == SDO_SERVER_VERDICT)
        check(od_set(od_find(&self->od, server->index, server->sub), sdo_server_value(server),
                     server->size) == SDO_OK);
    self->waiting = false;
    sdo_server_verdict(&self->server, code, self->now, &self->out);
}

static void give(struct fuzz *self, uint8_t size)
{
    const uint8_t bytes[CAPACITY + 8] = { 1, 2, 3 };

    sdo_server_give(&self->server, size > 200 ? SDO_NO_DATA : SDO_OK, bytes,
                    size % (uint32_t)sizeof bytes, self->now, &self->out);
}

static void step(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);

    co_outbox_init(&self->out, self->frames, kind & 2 ? 0 : 2, self->events, kind & 4 ? 0 : 2);
    if (kind < 192) {
        request(self, input, (kind & 1) != 0);
    } else if (kind < 208) {
        decide(self, take(input));
    } else if (kind < 224) {
        give(self, take(input));
    } else if (kind < 248) {
        self->now += CO_MS(10) * take(input);
    } else {
        sdo_server_enable(&self->server, false);
        sdo_server_enable(&self->server, true);
    }
    sdo_server_on_time(&self->server, self->now, &self->out);
}

static void drain(struct fuzz *self)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame))
        check(frame.id == 0x580 + NODE && frame.dlc == 8);
    while (co_outbox_take_event(&self->out, &event)) {
        const struct od_entry *entry = od_find(&self->od, event.index, event.sub);

        if (event.type == PROTO_SDO_READ) {
            check(entry != NULL && entry->fetched);
            continue;
        }
        check(event.type == PROTO_SDO_WRITE && entry != NULL && event.actual <= CAPACITY);
        check(od_check_value(entry, sdo_server_value(&self->server), (uint32_t)event.actual) ==
              SDO_OK);
        self->waiting = true;
    }
    check((self->server.state == SDO_SERVER_IDLE) ==
          (sdo_server_deadline(&self->server) == CO_NEVER));
}

/* Whatever came before: with room and time the server is idle again. */
static void end(struct fuzz *self)
{
    for (unsigned i = 0; i < SDO_BLOCK_MAX && self->server.state != SDO_SERVER_IDLE; i++) {
        co_outbox_init(&self->out, self->frames, 2, self->events, 2);
        if (sdo_server_deadline(&self->server) > self->now)
            self->now = sdo_server_deadline(&self->server);
        sdo_server_on_time(&self->server, self->now, &self->out);
        drain(self);
    }
    check(self->server.state == SDO_SERVER_IDLE);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = { .data = data, .size = size };
    struct fuzz fuzz = { .buffer = malloc(CAPACITY) };

    od_init(&fuzz.od);
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
        check(od_add(&fuzz.od, &entries[i], NULL) == CO_OK);
    od_find(&fuzz.od, 8, 0)->fetched = true;
    sdo_server_init(&fuzz.server, &fuzz.od, NODE, fuzz.buffer, CAPACITY);
    sdo_server_enable(&fuzz.server, true);
    fuzz.server.block = true;
    fuzz.server.block_limit = 3;
    while (input.size > 0) {
        step(&fuzz, &input);
        drain(&fuzz);
    }
    end(&fuzz);
    od_done(&fuzz.od);
    free(fuzz.buffer);
    return 0;
}

#include "support/sdo_loop.h"

#include "proto/event.h"
#include "support/hex.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

#define NODE      5
#define UNTOUCHED 0xA5
#define PATIENCE  10000000u /* calls, before a transfer counts as hanging */

void sdo_loop_init(struct sdo_loop *self, unsigned room)
{
    const struct od_spec spec = {
        .index = 0x2000, .type = OD_DOMAIN, .access = OD_RW, .capacity = LOOP_LARGE
    };

    memset(self, 0, sizeof *self);
    self->seed = 1;
    self->server_buffer = malloc(LOOP_LARGE);
    self->data = malloc(LOOP_LARGE + 1);
    ck_assert(self->server_buffer && self->data && room <= LOOP_ROOM);
    od_init(&self->od);
    ck_assert_int_eq(od_add(&self->od, &spec, &self->entry), CO_OK);
    sdo_server_init(&self->server, &self->od, NODE, self->server_buffer, LOOP_LARGE);
    sdo_server_enable(&self->server, true);
    self->server.block = true;
    sdo_client_init(&self->client, NODE);
    co_outbox_init(&self->to_server, self->frames[0], room, self->events[0], 2);
    co_outbox_init(&self->to_client, self->frames[1], room, self->events[1], 2);
}

void sdo_loop_done(struct sdo_loop *self)
{
    od_done(&self->od);
    free(self->server_buffer);
    free(self->data);
}

static bool is_lost(struct sdo_loop *self, const struct co_frame *frame, bool to_server)
{
    self->count++;
    return self->loses && self->loses(self, frame, to_server);
}

static void serve_writes(struct sdo_loop *self)
{
    struct co_event event;

    while (co_outbox_take_event(&self->to_client, &event)) {
        ck_assert_uint_eq(event.type, PROTO_SDO_WRITE);
        sdo_server_verdict(
            &self->server,
            od_set(self->entry, sdo_server_value(&self->server), (uint32_t)event.actual), self->now,
            &self->to_client);
    }
}

/* The next frame that is on its way, answers first: the outbox must have room for more of them. */
static bool pass_frame(struct sdo_loop *self)
{
    struct co_frame frame;

    if (co_outbox_take_frame(&self->to_client, &frame)) {
        if (!is_lost(self, &frame, false))
            sdo_client_on_frame(&self->client, &frame, self->now, &self->to_server);
        return true;
    }
    if (!co_outbox_take_frame(&self->to_server, &frame))
        return false;
    if (!is_lost(self, &frame, true))
        sdo_server_on_frame(&self->server, &frame, self->now, &self->to_client);
    serve_writes(self);
    frame.flags |= CO_FRAME_OWN;
    sdo_client_on_frame(&self->client, &frame, self->now, &self->to_server);
    return true;
}

static void step(struct sdo_loop *self)
{
    const co_us_t due = co_earlier(sdo_client_deadline(&self->client),
                                   sdo_server_deadline(&self->server));

    if (++self->calls > PATIENCE)
        ck_abort_msg("a transfer that does not end");
    if (due <= self->now) {
        sdo_client_on_time(&self->client, self->now, &self->to_server);
        sdo_server_on_time(&self->server, self->now, &self->to_client);
    }
    if (!pass_frame(self) && due > self->now && due != CO_NEVER)
        self->now = due;
}

static void run(struct sdo_loop *self, const struct sdo_transfer *transfer)
{
    self->count = 0;
    self->calls = 0;
    sdo_client_start(&self->client, transfer, self->now, &self->to_server);
    while (sdo_client_busy(&self->client))
        step(self);
    while (pass_frame(self))
        continue;
    ck_assert(co_outbox_take_event(&self->to_server, &self->end));
    ck_assert_uint_eq(self->end.type, PROTO_SDO_DONE);
    ck_assert(!co_outbox_take_event(&self->to_server, &self->end));
}

void sdo_loop_rest(struct sdo_loop *self)
{
    while (self->server.state != SDO_SERVER_IDLE)
        step(self);
    while (pass_frame(self))
        continue;
}

void sdo_loop_download(struct sdo_loop *self, uint32_t size)
{
    const struct sdo_transfer transfer = { .download = true,
                                           .indicate_size = self->indicate_size,
                                           .hide_size = self->block > 0 && !self->indicate_size,
                                           .block = self->block,
                                           .index = 0x2000,
                                           .source = self->data,
                                           .size = size,
                                           .timeout = LOOP_TIMEOUT };

    for (uint32_t i = 0; i < size; i++)
        self->data[i] = (uint8_t)noise(&self->seed);
    run(self, &transfer);
}

void sdo_loop_upload(struct sdo_loop *self, uint32_t room)
{
    const struct sdo_transfer transfer = { .block = self->block,
                                           .index = 0x2000,
                                           .buffer = self->data,
                                           .size = room,
                                           .timeout = LOOP_TIMEOUT };

    memset(self->data, UNTOUCHED, room + 1);
    run(self, &transfer);
    ck_assert_uint_eq(self->data[room], UNTOUCHED);
}

void sdo_loop_check(struct sdo_loop *self, uint32_t size)
{
    sdo_loop_download(self, size);
    ck_assert_uint_eq(self->end.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(self->end.actual, size);
    ck_assert_uint_eq(self->entry->size, size);
    ck_assert_mem_eq(self->entry->value, self->data, size);
    sdo_loop_upload(self, size);
    ck_assert_uint_eq(self->end.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(self->end.actual, size);
    ck_assert_mem_eq(self->entry->value, self->data, size);
}

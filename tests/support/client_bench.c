#include "support/client_bench.h"

#include "proto/event.h"
#include "support/hex.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define UNTOUCHED 0xA5
#define TIMEOUT   CO_MS(200)

void client_bench_init(struct client_bench *self)
{
    *self = (struct client_bench){ .starts = 0 };
    sdo_client_init(&self->client, BENCH_NODE);
}

void client_bench_start(struct client_bench *self, const char *text, co_us_t now,
                        struct co_outbox *out)
{
    struct sdo_transfer *transfer = &self->transfer;
    unsigned index = 0, sub = 0;
    char data[2 * BENCH_ROOM + 1] = "", verb[8] = "";

    ck_assert_int_eq(sscanf(text, "%7s %x:%x %600s", verb, &index, &sub, data), 4);
    memset(self->buffer, UNTOUCHED, sizeof self->buffer);
    *transfer = (struct sdo_transfer){ .download = verb[0] == 'w',
                                       .indicate_size = strcmp(verb, "write+") == 0,
                                       .hide_size = strcmp(verb, "write-") == 0,
                                       .block = self->block,
                                       .index = (uint16_t)index,
                                       .sub = (uint8_t)sub,
                                       .timeout = TIMEOUT };
    if (transfer->download) {
        transfer->source = self->buffer;
        transfer->size = (uint32_t)hex_parse(data, self->buffer, BENCH_ROOM);
    } else {
        transfer->buffer = self->buffer;
        transfer->size = (uint32_t)atoi(data);
    }
    ck_assert_uint_le(transfer->size, BENCH_ROOM);
    sdo_client_start(&self->client, transfer, now, out);
    self->starts++;
}

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct client_bench *self = machine;
    unsigned number = 0;

    if (strcmp(text, "cancel nothing") == 0) {
        ck_assert(!sdo_client_cancel(&self->client, SDO_GENERAL, out));
        return true;
    }
    if (sscanf(text, "cancel %x", &number) == 1)
        return sdo_client_cancel(&self->client, number, out);
    if (sscanf(text, "late %u", &number) == 1)
        ck_assert_uint_eq(self->client.late, number);
    else if (sscanf(text, "blocks of %u", &number) == 1)
        self->block = (uint8_t)number;
    else if (strcmp(text, "handed over") == 0)
        sdo_client_on_handed_over(&self->client, now);
    else
        client_bench_start(self, text, now, out);
    return true;
}

static bool on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    struct client_bench *self = machine;

    sdo_client_on_frame(&self->client, frame, now, out);
    return true;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    struct client_bench *self = machine;

    sdo_client_on_time(&self->client, now, out);
}

static co_us_t deadline(const void *machine)
{
    const struct client_bench *self = machine;

    return sdo_client_deadline(&self->client);
}

static void check_guard(const struct client_bench *self)
{
    size_t touched = 0;

    for (size_t i = self->transfer.size; i < sizeof self->buffer; i++)
        touched += self->buffer[i] != UNTOUCHED;
    ck_assert_uint_eq(touched, 0);
}

void client_bench_describe(struct client_bench *self, const struct co_event *event, char *text,
                           size_t size)
{
    static const char *const outcomes[] = { "ok",     "aborted",  "no answer", "not sent",
                                            "toggle", "protocol", "overflow",  "cancelled" };
    char data[2 * BENCH_ROOM + 1];

    ck_assert_uint_eq(event->type, PROTO_SDO_DONE);
    ck_assert_uint_eq(event->node, BENCH_NODE);
    ck_assert_uint_eq(event->index, self->transfer.index);
    ck_assert_uint_eq(event->sub, self->transfer.sub);
    ck_assert_uint_lt(event->detail, sizeof outcomes / sizeof outcomes[0]);
    ck_assert(!sdo_client_busy(&self->client));
    check_guard(self);
    self->ends++;
    snprintf(text, size, "%s %08X %u", outcomes[event->detail], event->code,
             (unsigned)event->actual);
    if (event->detail == SDO_OUTCOME_OK && !self->transfer.download) {
        hex_format(self->buffer, (size_t)event->actual, data, sizeof data);
        snprintf(text + strlen(text), size - strlen(text), " %s", data);
    }
    if (event->expected)
        snprintf(text + strlen(text), size - strlen(text), " no blocks");
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    client_bench_describe(machine, event, text, size);
}

static const struct talk_machine functions = { .call = call,
                                               .on_frame = on_frame,
                                               .on_time = on_time,
                                               .deadline = deadline,
                                               .describe = describe };

void client_bench_talk(const struct talk *talk, enum talk_stall stall)
{
    struct client_bench bench;
    struct talk_machine machine = functions;

    client_bench_init(&bench);
    machine.self = &bench;
    talk_run(talk, &machine, stall);
    ck_assert_uint_eq(bench.starts, bench.ends);
}

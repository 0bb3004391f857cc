#include "support/server_bench.h"

#include "proto/event.h"
#include "support/hex.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME     "CANopenDemoPIC32"
#define TEXT_MAX 620

static const uint8_t zeros[301];

static const struct od_spec entries[] = {
    { .index = 0x1000,
      .type = OD_UNSIGNED32,
      .access = OD_RO,
      .value = (const uint8_t *)"\x91\x01\x0F",
      .size = 4 },
    { .index = 0x1003, .type = OD_UNSIGNED8, .access = OD_RW, .has_high = true },
    { .index = 0x1008,
      .type = OD_VISIBLE_STRING,
      .access = OD_CONST,
      .value = (const uint8_t *)NAME,
      .size = sizeof NAME - 1 },
    { .index = 0x1014, .type = OD_UNSIGNED32, .access = OD_RW, .has_low = true, .low = 0x81 },
    { .index = 0x1017, .type = OD_UNSIGNED16, .access = OD_RW },
    { .index = 0x1018, .sub = 0, .type = OD_UNSIGNED8, .access = OD_CONST },
    { .index = 0x1018, .sub = 1, .type = OD_UNSIGNED32, .access = OD_RO },
    { .index = 0x1019, .type = OD_UNSIGNED8, .access = OD_RW },
    { .index = 0x1F50, .sub = 1, .type = OD_DOMAIN, .access = OD_WO },
    { .index = 0x2000, .type = OD_DOMAIN, .access = OD_RW, .capacity = 400 },
    { .index = 0x2001, .type = OD_BOOLEAN, .access = OD_RW },
    { .index = 0x2002, .type = OD_VISIBLE_STRING, .access = OD_RO },
    { .index = 0x2003, .type = OD_UNSIGNED64, .access = OD_RW },
    { .index = 0x2004,
      .type = OD_INTEGER16,
      .access = OD_RW,
      .has_low = true,
      .has_high = true,
      .low = -100,
      .high = 100 },
    { .index = 0x2005, .type = OD_VISIBLE_STRING, .access = OD_RW, .capacity = 8 },
    { .index = 0x2006, .type = OD_UNSIGNED32, .access = OD_RW },
    { .index = 0x2007, .type = OD_OCTET_STRING, .access = OD_RW, .capacity = 3 },
    { .index = 0x2008, .type = OD_DOMAIN, .access = OD_RO, .value = zeros, .size = sizeof zeros },
    { .index = 0x2009, .type = OD_DOMAIN, .access = OD_RW, .capacity = 400 },
};

void server_bench_init(struct server_bench *self)
{
    *self = (struct server_bench){ .writing = 0 };
    od_init(&self->od);
    for (size_t i = 0; i < sizeof entries / sizeof entries[0]; i++)
        ck_assert_int_eq(od_add(&self->od, &entries[i], NULL), CO_OK);
    od_find(&self->od, 0x2009, 0)->fetched = true;
    self->buffer = malloc(BENCH_CAPACITY);
    ck_assert_ptr_nonnull(self->buffer);
    sdo_server_init(&self->server, &self->od, BENCH_NODE, self->buffer, BENCH_CAPACITY);
    sdo_server_enable(&self->server, true);
}

void server_bench_done(struct server_bench *self)
{
    od_done(&self->od);
    free(self->buffer);
}

static sdo_abort_t store(struct server_bench *self, sdo_abort_t code)
{
    const struct sdo_server *server = &self->server;

    if (code != SDO_OK || self->writing != server->number)
        return code;
    return od_set(od_find(&self->od, server->index, server->sub), sdo_server_value(server),
                  server->size);
}

static void use_value(struct server_bench *self, const char *text)
{
    char verb[8] = "", hex[TEXT_MAX] = "", present[TEXT_MAX];
    uint8_t bytes[TEXT_MAX / 2];
    unsigned index = 0, sub = 0;
    struct od_entry *entry;

    ck_assert_int_eq(sscanf(text, "%7s %x:%x %600s", verb, &index, &sub, hex), 4);
    entry = od_find(&self->od, (uint16_t)index, (uint8_t)sub);
    ck_assert_ptr_nonnull(entry);
    if (strcmp(verb, "set") == 0) {
        ck_assert_uint_eq(od_set(entry, bytes, (uint32_t)hex_parse(hex, bytes, sizeof bytes)), 0);
        return;
    }
    ck_assert_str_eq(verb, "value");
    ck_assert_str_eq(hex_format(entry->value, entry->size, present, sizeof present), hex);
}

static void give(struct server_bench *self, const char *hex, co_us_t now, struct co_outbox *out)
{
    uint8_t bytes[TEXT_MAX / 2];
    const uint32_t size = (uint32_t)hex_parse(hex, bytes, sizeof bytes);

    sdo_server_give(&self->server, SDO_OK, bytes, size, now, out);
}

static bool set_blocks(struct server_bench *self, const char *text)
{
    unsigned limit = 0;

    if (sscanf(text, "blocks of %u", &limit) != 1)
        return false;
    self->server.block = true;
    self->server.block_limit = (uint8_t)limit;
    return true;
}

/* False: the text is none of these. */
static bool call_server(struct server_bench *self, const char *text, co_us_t now,
                        struct co_outbox *out)
{
    unsigned code = 0, response = 0;
    char hex[TEXT_MAX] = "";

    if (sscanf(text, "verdict %x", &code) == 1)
        sdo_server_verdict(&self->server, store(self, code), now, out);
    else if (sscanf(text, "give %600s", hex) == 1)
        give(self, hex, now, out);
    else if (sscanf(text, "refuse %x", &code) == 1)
        sdo_server_give(&self->server, code, NULL, 0, now, out);
    else if (sscanf(text, "channel %x %x", &code, &response) == 2)
        sdo_server_set_channel(&self->server, code, response);
    else
        return set_blocks(self, text);
    return true;
}

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct server_bench *self = machine;

    if (strcmp(text, "enable") == 0 || strcmp(text, "disable") == 0)
        sdo_server_enable(&self->server, text[0] == 'e');
    else if (!call_server(self, text, now, out))
        use_value(self, text);
    return true;
}

static bool on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    struct server_bench *self = machine;
    const unsigned dropped = self->server.dropped;

    sdo_server_on_frame(&self->server, frame, now, out);
    return self->server.dropped == dropped;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    struct server_bench *self = machine;

    sdo_server_on_time(&self->server, now, out);
}

static co_us_t deadline(const void *machine)
{
    const struct server_bench *self = machine;

    return sdo_server_deadline(&self->server);
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    struct server_bench *self = machine;
    char data[TEXT_MAX];

    ck_assert_uint_eq(event->code, self->server.number);
    if (event->type == PROTO_SDO_READ) {
        snprintf(text, size, "read %04X:%02X", event->index, event->sub);
        return;
    }
    ck_assert_uint_eq(event->type, PROTO_SDO_WRITE);
    self->writing = event->code;
    hex_format(sdo_server_value(&self->server), (size_t)event->actual, data, sizeof data);
    snprintf(text, size, "write %04X:%02X %s", event->index, event->sub, data);
}

void server_bench_talk(const struct talk *talk, enum talk_stall stall)
{
    struct server_bench bench;
    const struct talk_machine machine = { .self = &bench,
                                          .call = call,
                                          .on_frame = on_frame,
                                          .on_time = on_time,
                                          .deadline = deadline,
                                          .describe = describe };

    server_bench_init(&bench);
    talk_run(talk, &machine, stall);
    server_bench_done(&bench);
}

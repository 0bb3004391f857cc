/*
 * A device with several SDO servers under clients, configuration, time, its owner's answers and
 * outboxes of any kind.
 *
 * The input is a list of steps, one byte each with what it needs behind it:
 *
 *     0..119     a request: one byte for the server, and 8 bytes
 *     120..159   a sensible one: one byte for the server, one for the request, one for the object
 *     160..179   a server opened or closed: one byte for it, one for its CAN-IDs
 *     180..199   time passes: one byte, in units of 5 ms
 *     200..247   the owner answers: one byte for the server and the number, one for what it says
 *     248..255   an NMT command: one byte
 *
 * The low bits of the step say how much room the outbox has in it.
 */
#include "base/bytes.h"
#include "slave/slave.h"
#include "slave/slave_internal.h"

#include <stdlib.h>
#include <string.h>

#define NODE    5
#define UNIT    CO_MS(5)
#define SERVERS 4u
#define LONGEST 600u
#define FETCHED 0x2003

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
    const uint8_t *data;
    size_t size;
};

struct fuzz {
    struct od od;
    struct slave slave;
    co_us_t now;
    struct co_frame frames[40];
    struct co_event events[8];
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

static void add_domain(struct od *od, uint16_t index, bool watched)
{
    static const uint8_t value[200] = { 1, 2, 3 };
    const struct od_spec spec = { .index = index,
                                  .type = OD_DOMAIN,
                                  .access = OD_RW,
                                  .value = value,
                                  .size = sizeof value,
                                  .capacity = LONGEST };
    struct od_entry *entry = NULL;

    check(od_add(od, &spec, &entry) == CO_OK);
    entry->watched = watched;
    if (index == FETCHED)
        od_fetch(entry, LONGEST);
}

static void make_device(struct fuzz *self)
{
    od_init(&self->od);
    for (uint16_t server = 1; server < SERVERS; server++)
        for (uint8_t sub = 1; sub <= 2; sub++)
            check(od_add_number(&self->od, (uint16_t)(0x1200 + server), sub, OD_UNSIGNED32, OD_RW,
                                0x680u + 2u * server + sub) == CO_OK);
    check(od_add_number(&self->od, 0x1003, 0, OD_UNSIGNED8, OD_RW, 0) == CO_OK);
    check(od_add_number(&self->od, 0x1003, 1, OD_UNSIGNED32, OD_RO, 0) == CO_OK);
    check(od_add_number(&self->od, 0x2000, 0, OD_UNSIGNED32, OD_RW, 0) == CO_OK);
    add_domain(&self->od, 0x2001, false);
    add_domain(&self->od, 0x2002, true);
    add_domain(&self->od, FETCHED, false);
    check(slave_init(&self->slave, NODE, &self->od) == CO_OK);
}

static void send(struct fuzz *self, unsigned server, const uint8_t data[8])
{
    struct co_frame frame = co_frame_make(self->slave.channels[server % SERVERS].server.request_id,
                                          8);

    memcpy(frame.data, data, 8);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
}

static void hear(struct fuzz *self, struct input *input)
{
    const uint8_t server = take(input);
    uint8_t data[8];

    for (unsigned i = 0; i < 8; i++)
        data[i] = take(input);
    send(self, server, data);
}

/* Toggle bits, sequence numbers and sizes that fit what the server is at. */
static void hear_sensible(struct fuzz *self, struct input *input)
{
    static const uint8_t commands[] = { 0x40, 0x20, 0x22, 0xA4, 0xC4, 0x60, 0x00, 0xA3,
                                        0xA2, 0xA1, 0xC1, 0x01, 0x80, 0x01, 0x81, 0x02 };
    static const uint16_t indexes[] = { 0x2000, 0x2001, 0x2002, FETCHED, 0x1003, 0x1201 };
    const uint8_t which = take(input), what = take(input), object = take(input);
    const struct sdo_server *server = &self->slave.channels[which % SERVERS].server;
    uint8_t data[8] = { commands[what % 16] };

    if (data[0] == 0xA2)
        data[1] = server->sender.sent;
    if (data[0] == 0x60 || data[0] == 0x00)
        data[0] |= server->toggle ? 0x10 : 0;
    if (data[0] == 0xA2 || data[0] == 0xA4)
        data[data[0] == 0xA2 ? 2 : 4] = (uint8_t)(1 + object % 127);
    if (what < 5)
        put_le16(data + 1, indexes[object % 6]);
    send(self, which, data);
}

static void configure(struct fuzz *self, struct input *input)
{
    const uint16_t index = (uint16_t)(0x1200 + take(input) % SERVERS);
    const uint8_t id = take(input);
    uint8_t data[8] = { 0x23, 0, 0, (uint8_t)(1 + (id & 1)) };

    put_le16(data + 1, index);
    put_le32(data + 4, (id & 2 ? COB_ID_INVALID : 0) | (0x680u + (id >> 2)));
    send(self, 0, data);
}

static void answer(struct fuzz *self, struct input *input)
{
    static const sdo_abort_t codes[] = { SDO_OK, SDO_OK, SDO_NO_DATA, 1 };
    static const uint8_t bytes[LONGEST + 1];
    const uint8_t which = take(input), what = take(input);
    const unsigned place = which % SERVERS;
    const struct slave_transfer transfer = {
        (uint8_t)place, self->slave.channels[place].server.number - (which >= 0xE0)
    };
    const struct slave_value value = { codes[what % 4], bytes, what * 3u % (LONGEST + 2) };

    if (slave_waits_for(&self->slave, transfer))
        check(self->slave.channels[place].server.enabled);
    if (what & 4)
        slave_give(&self->slave, transfer, &value, self->now, &self->out);
    else
        slave_verdict(&self->slave, transfer, value.code, self->now, &self->out);
}

static void command(struct fuzz *self, uint8_t byte)
{
    static const uint8_t commands[] = { NMT_START,      NMT_START,
                                        NMT_STOP,       NMT_ENTER_PREOPERATIONAL,
                                        NMT_RESET_NODE, NMT_RESET_COMMUNICATION };

    slave_command(&self->slave, (enum nmt_command)commands[byte % 6], self->now, &self->out);
}

/* Frames are answers of servers, or of NMT. */
static void drain(struct fuzz *self)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame))
        check(frame.dlc == 8 || frame.id == 0x700 + NODE);
    while (co_outbox_take_event(&self->out, &event))
        check(event.node == NODE && event.detail <= NMT_PREOPERATIONAL);
}

static void check_device(const struct fuzz *self)
{
    const bool on = self->slave.state == NMT_OPERATIONAL || self->slave.state == NMT_PREOPERATIONAL;

    check(self->slave.channel_count == SERVERS);
    for (unsigned i = 0; i < SERVERS; i++) {
        const struct sdo_server *server = &self->slave.channels[i].server;

        check(server->enabled == on);
        check(server->request_id != 0 || server->state == SDO_SERVER_IDLE);
        check(server->buffer != NULL || server->capacity == 0);
        check((server->request_id == 0) == (server->response_id == 0));
    }
    check(od_find(&self->od, FETCHED, 0)->size == 0);
    check(od_find(&self->od, 0x2001, 0)->size <= LONGEST);
}

static void step(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);

    co_outbox_init(&self->out, self->frames, kind % 4 == 3 ? 4 : 40, self->events, 8);
    if (kind % 16 == 15)
        co_outbox_init(&self->out, self->frames, 1, self->events, 1);
    if (kind < 120)
        hear(self, input);
    else if (kind < 160)
        hear_sensible(self, input);
    else if (kind < 180)
        configure(self, input);
    else if (kind < 200)
        self->now += UNIT * (co_us_t)take(input);
    else if (kind < 248)
        answer(self, input);
    else
        command(self, take(input));
    drain(self);
    slave_on_time(&self->slave, self->now, &self->out);
    drain(self);
    check_device(self);
}

/* With room nothing stays due, and left alone each transfer ends. */
static void come_to_rest(struct fuzz *self)
{
    for (unsigned i = 0; i < 2000 && slave_deadline(&self->slave) != CO_NEVER; i++) {
        co_outbox_init(&self->out, self->frames, 40, self->events, 8);
        if (slave_deadline(&self->slave) > self->now)
            self->now = slave_deadline(&self->slave);
        slave_on_time(&self->slave, self->now, &self->out);
        drain(self);
    }
    check(slave_deadline(&self->slave) == CO_NEVER);
    for (unsigned i = 0; i < SERVERS; i++)
        check(self->slave.channels[i].server.state == SDO_SERVER_IDLE);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = { data, size };
    struct fuzz self;

    memset(&self, 0, sizeof self);
    make_device(&self);
    co_outbox_init(&self.out, self.frames, 40, self.events, 8);
    slave_start(&self.slave, self.now, &self.out);
    drain(&self);
    while (input.size > 0)
        step(&self, &input);
    come_to_rest(&self);
    slave_done(&self.slave);
    od_done(&self.od);
    return 0;
}

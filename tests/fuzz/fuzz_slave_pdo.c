/*
 * A device with PDOs under frames, configuration, time, its application and outboxes of any kind.
 *
 * The input is a list of steps, one byte each with what it needs behind it:
 *
 *     0..79      a frame: one byte for its identifier, one for its length and kind, and data
 *     80..159    a client writes: one byte for the object, one for its size, and 4 bytes
 *     160..199   time passes: one byte, in units of 500 us
 *     200..247   the application, or the bus: one byte for what it does, one for an entry,
 *                number or code
 *     248..255   an NMT command: one byte
 *
 * The low bits of the step say how much room the outbox has in it.
 */
#include "base/bytes.h"
#include "proto/event.h"
#include "slave/slave.h"
#include "slave/slave_internal.h"

#include <stdlib.h>
#include <string.h>

#define NODE 5
#define UNIT 500u

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
    const uint8_t *data;
    size_t size;
};

struct fuzz {
    struct od od;
    struct slave slave;
    co_us_t now;
    uint32_t asks[3]; /* the last question for each TPDO */
    struct co_frame frames[4];
    struct co_event events[6];
    struct co_outbox out;
};

static const struct {
    uint16_t index;
    uint8_t sub, type;
    uint32_t value;
    bool watched;
} objects[] = {
    { 0x1005, 0, OD_UNSIGNED32, 0x80, false },
    { 0x1006, 0, OD_UNSIGNED32, 0, false },
    { 0x1007, 0, OD_UNSIGNED32, 0, false },
    { 0x1014, 0, OD_UNSIGNED32, 0x85, false },
    { 0x1019, 0, OD_UNSIGNED8, 0, false },
    { 0x1400, 1, OD_UNSIGNED32, 0x205, false },
    { 0x1400, 2, OD_UNSIGNED8, 255, false },
    { 0x1400, 5, OD_UNSIGNED16, 0, false },
    { 0x1401, 1, OD_UNSIGNED32, 0x305, false },
    { 0x1401, 2, OD_UNSIGNED8, 1, false },
    { 0x1600, 0, OD_UNSIGNED8, 2, false },
    { 0x1600, 1, OD_UNSIGNED32, 0x20000008, false },
    { 0x1600, 2, OD_UNSIGNED32, 0x20010010, false },
    { 0x1600, 3, OD_UNSIGNED32, 0, false },
    { 0x1601, 0, OD_UNSIGNED8, 1, false },
    { 0x1601, 1, OD_UNSIGNED32, 0x20020001, false },
    { 0x1800, 1, OD_UNSIGNED32, 0x185, false },
    { 0x1800, 2, OD_UNSIGNED8, 255, false },
    { 0x1800, 3, OD_UNSIGNED16, 0, false },
    { 0x1800, 5, OD_UNSIGNED16, 0, false },
    { 0x1801, 1, OD_UNSIGNED32, 0x285, false },
    { 0x1801, 2, OD_UNSIGNED8, 1, false },
    { 0x1801, 6, OD_UNSIGNED8, 0, false },
    { 0x1802, 1, OD_UNSIGNED32, 0x385, false },
    { 0x1802, 2, OD_UNSIGNED8, 0, false },
    { 0x1A00, 0, OD_UNSIGNED8, 2, false },
    { 0x1A00, 1, OD_UNSIGNED32, 0x20000008, false },
    { 0x1A00, 2, OD_UNSIGNED32, 0x20010010, false },
    { 0x1A01, 0, OD_UNSIGNED8, 1, false },
    { 0x1A01, 1, OD_UNSIGNED32, 0x20030020, false },
    { 0x1A02, 0, OD_UNSIGNED8, 1, false },
    { 0x1A02, 1, OD_UNSIGNED32, 0x20020001, false },
    { 0x2000, 0, OD_UNSIGNED8, 0, false },
    { 0x2001, 0, OD_INTEGER16, 0, false },
    { 0x2002, 0, OD_BOOLEAN, 0, false },
    { 0x2003, 0, OD_UNSIGNED32, 0, true },
    { 0x1001, 0, OD_UNSIGNED8, 0, false },
    { 0x1015, 0, OD_UNSIGNED16, 0, false },
    { 0x1016, 1, OD_UNSIGNED32, 0x00070005, false },
    { 0x1016, 2, OD_UNSIGNED32, 0, false },
    { 0x1028, 1, OD_UNSIGNED32, 0x87, false },
    { 0x1029, 1, OD_UNSIGNED8, 0, false },
};

#define OBJECTS (sizeof objects / sizeof objects[0])

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

static void make_device(struct fuzz *self)
{
    od_init(&self->od);
    for (size_t i = 0; i < OBJECTS; i++) {
        uint8_t bytes[4];
        const struct od_spec spec = { .index = objects[i].index,
                                      .sub = objects[i].sub,
                                      .type = objects[i].type,
                                      .access = objects[i].index == 0x1001 ? OD_RO : OD_RW,
                                      .mappable = objects[i].index >= 0x2000 ||
                                                  objects[i].index == 0x1001,
                                      .value = bytes,
                                      .size = od_type_size(objects[i].type) };
        struct od_entry *entry = NULL;

        put_le32(bytes, objects[i].value);
        check(od_add(&self->od, &spec, &entry) == CO_OK);
        entry->watched = objects[i].watched;
    }
    check(slave_init(&self->slave, NODE, &self->od) == CO_OK);
    for (uint16_t number = 1; number <= 3; number++) {
        slave_pdo_set_flags(&self->slave, PDO_RECEIVE, number, (uint8_t)(number & 1));
        slave_pdo_set_flags(&self->slave, PDO_TRANSMIT, number,
                            SLAVE_PDO_NOTIFY | SLAVE_PDO_CONFIRM | SLAVE_PDO_TIMER_ASKS);
    }
}

static void hear(struct fuzz *self, struct input *input)
{
    static const uint16_t ids[] = { 0x80,  0x205, 0x305, 0x185, 0x285, 0x385, 0x705, 0x605,
                                    0x707, 0x087, 0x80,  0x205, 0x305, 0x185, 0x285, 0x385 };
    const uint8_t which = take(input), kind = take(input);
    struct co_frame frame = co_frame_make(ids[which % 16], kind % 9);

    frame.flags = (uint8_t)((kind & 0x10 ? CO_FRAME_RTR : 0) | (kind & 0x20 ? CO_FRAME_OWN : 0) |
                            (kind & 0x40 ? CO_FRAME_EXT : 0));
    for (unsigned i = 0; i < frame.dlc; i++)
        frame.data[i] = take(input);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
}

static void write_object(struct fuzz *self, struct input *input)
{
    const size_t which = take(input) % OBJECTS;
    const uint32_t size = od_type_size(objects[which].type);
    struct co_frame frame = co_frame_make(0x600 + NODE, 8);

    frame.data[0] = (uint8_t)(0x23 | (4 - size) << 2);
    put_le16(frame.data + 1, objects[which].index);
    frame.data[3] = objects[which].sub;
    for (unsigned i = 0; i < 4; i++)
        frame.data[4 + i] = take(input);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
}

static void apply_error(struct fuzz *self, uint8_t what, uint8_t which)
{
    const struct slave_error error = { .code = 0x1000,
                                       .error_register = which & 0x82,
                                       .field = { which, which } };

    switch (what % 6) {
    case 0: slave_raise_error(&self->slave, &error, self->now, &self->out); break;
    case 1:
        slave_clear_error(&self->slave, which & 0x82, error.field, self->now, &self->out);
        break;
    case 2: slave_on_bus(&self->slave, (enum slave_bus)(which % 3), self->now, &self->out); break;
    case 3: slave_on_frames_lost(&self->slave, self->now, &self->out); break;
    case 4: slave_lose_pdos(&self->slave, which, self->now, &self->out); break;
    default: slave_pdos_taken(&self->slave, self->now, &self->out); break;
    }
}

static void apply(struct fuzz *self, struct input *input)
{
    const uint8_t what = take(input), which = take(input);
    const uint16_t number = which % 5;
    const struct slave_transfer transfer = { 0,
                                             self->slave.channels[0].server.number - (which & 1) };
    struct od_entry *entry = od_find(&self->od, (uint16_t)(0x2000 + which % 4), 0);

    if (what >= 192) {
        apply_error(self, what, which);
        return;
    }
    switch (what % 8) {
    case 0: slave_pdo_send(&self->slave, number, self->now, &self->out); break;
    case 1:
        entry->value[0] ^= 1;
        slave_entry_changed(&self->slave, entry, self->now, &self->out);
        break;
    case 2: slave_hold_transmission(&self->slave, which & 1, self->now, &self->out); break;
    case 3:
        slave_tpdo_answer(&self->slave, number, self->asks[which % 3], self->now, &self->out);
        break;
    case 4: slave_rpdo_request(&self->slave, number, self->now, &self->out); break;
    case 5: slave_sync_external(&self->slave, which & 1); break;
    case 6:
        slave_verdict(&self->slave, transfer, which & 2 ? SDO_VALUE_HIGH : SDO_OK, self->now,
                      &self->out);
        break;
    default: self->slave.accept_long = which & 1; break;
    }
}

static void command(struct fuzz *self, uint8_t byte)
{
    static const uint8_t commands[] = { NMT_START,      NMT_START,
                                        NMT_STOP,       NMT_ENTER_PREOPERATIONAL,
                                        NMT_RESET_NODE, NMT_RESET_COMMUNICATION };

    slave_command(&self->slave, (enum nmt_command)commands[byte % 6], self->now, &self->out);
}

static void drain(struct fuzz *self)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame))
        check(frame.dlc <= 8);
    while (co_outbox_take_event(&self->out, &event)) {
        check(event.node == NODE || event.type == SLAVE_WATCH || event.type == PROTO_HB_STATE);
        if (event.type == SLAVE_TPDO_WANTED)
            self->asks[event.index - 1] = event.code;
    }
}

/* What holds at any time. */
static void check_device(const struct fuzz *self)
{
    const struct slave_pdos *pdos = self->slave.pdos;
    const struct slave_errors *errors = &self->slave.errors;
    const uint64_t bits = od_number(&self->od, 0x1001, 0, 0);
    unsigned faults = self->slave.told_sync_wrong;
    bool wrong;

    for (unsigned i = 0; i < pdos->rpdo_count; i++) {
        faults += pdos->rpdos[i].told_fault != 0;
        check(pdos->rpdos[i].running == (self->slave.state == NMT_OPERATIONAL));
        check(rpdo_deadline(&pdos->rpdos[i]) >= pdos->deadline);
    }
    for (unsigned i = 0; i < pdos->tpdo_count; i++)
        check(tpdo_deadline(&pdos->tpdos[i]) >= pdos->deadline);
    check(errors->faults == faults + errors->overrun + errors->pdos_lost);
    wrong = errors->faults + errors->lost > 0 || errors->told_bus != SLAVE_BUS_OK;
    check((bits & 0x10) == (wrong ? 0x10 : 0));
    check((bits & 1) == (wrong || errors->application > 0));
}

static void check_mapping(const struct fuzz *self)
{
    const struct slave_pdos *pdos = self->slave.pdos;

    for (uint16_t index = 0x2000; index <= 0x2003; index++) {
        const struct od_entry *entry = od_find(&self->od, index, 0);
        unsigned count = 0;

        for (unsigned i = 0; i < pdos->rpdo_count; i++)
            count += pdo_map_contains(&pdos->rpdos[i].map, entry);
        for (unsigned i = 0; i < pdos->tpdo_count; i++)
            count += pdo_map_contains(&pdos->tpdos[i].map, entry);
        check(entry->map_count == count);
    }
}

static void step(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);

    co_outbox_init(&self->out, self->frames, kind & 1 ? 0 : 4, self->events, kind & 2 ? 0 : 6);
    if (kind < 80)
        hear(self, input);
    else if (kind < 160)
        write_object(self, input);
    else if (kind < 200)
        self->now += UNIT * (co_us_t)take(input);
    else if (kind < 248)
        apply(self, input);
    else
        command(self, take(input));
    drain(self);
    slave_on_time(&self->slave, self->now, &self->out);
    drain(self);
    check_device(self);
}

/* With room nothing stays due, whatever came before. */
static void settle(struct fuzz *self)
{
    for (unsigned i = 0; i < 40 && slave_deadline(&self->slave) <= self->now; i++) {
        co_outbox_init(&self->out, self->frames, 4, self->events, 6);
        slave_on_time(&self->slave, self->now, &self->out);
        drain(self);
    }
    check(slave_deadline(&self->slave) > self->now);
    check(self->slave.errors.told_bus == self->slave.errors.bus);
    check_device(self);
    check_mapping(self);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = { .data = data, .size = size };
    struct fuzz fuzz;

    memset(&fuzz, 0, sizeof fuzz);
    co_outbox_init(&fuzz.out, fuzz.frames, 4, fuzz.events, 6);
    make_device(&fuzz);
    slave_start(&fuzz.slave, 0, &fuzz.out);
    drain(&fuzz);
    while (input.size > 0)
        step(&fuzz, &input);
    settle(&fuzz);
    slave_done(&fuzz.slave);
    od_done(&fuzz.od);
    return 0;
}

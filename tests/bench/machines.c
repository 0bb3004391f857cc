/*
 * bench_machines WHAT N: hands a device N frames of one kind, for callgrind. No bus, no threads, no
 * clock. Exit code 77 where the device does not do yet what the frames ask for.
 */
#include "base/bytes.h"
#include "slave/slave.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODE     5
#define OUTPUTS  0x6200
#define OBJECTS  60 /* of the application, besides; as many as a common device has */
#define RPDO     0x200
#define REQUEST  0x600
#define RESPONSE 0x580

struct rig {
    struct od od;
    struct slave slave;
    struct co_outbox out;
    struct co_frame frames[8];
    struct co_event events[16];
    struct co_frame last; /* sent */
};

static void check(enum co_err err)
{
    if (err == CO_OK)
        return;
    fprintf(stderr, "%s\n", co_err_text(err));
    exit(1);
}

static void add_number(struct rig *self, uint16_t index, uint8_t sub, uint8_t type, uint64_t value)
{
    check(od_add_number(&self->od, index, sub, type, OD_RW, value));
}

static void add_outputs(struct rig *self, uint8_t type, unsigned count)
{
    struct od_spec spec = { .index = OUTPUTS, .type = type, .access = OD_RW, .mappable = true };
    const uint32_t bits = od_type_size(type) * 8;

    add_number(self, 0x1400, 0, OD_UNSIGNED8, 2);
    add_number(self, 0x1400, 1, OD_UNSIGNED32, RPDO + NODE);
    add_number(self, 0x1400, 2, OD_UNSIGNED8, 255);
    add_number(self, 0x1600, 0, OD_UNSIGNED8, count);
    add_number(self, OUTPUTS, 0, OD_UNSIGNED8, count);
    for (spec.sub = 1; spec.sub <= count; spec.sub++) {
        check(od_add(&self->od, &spec, NULL));
        add_number(self, 0x1600, spec.sub, OD_UNSIGNED32,
                   (uint32_t)OUTPUTS << 16 | (uint32_t)spec.sub << 8 | bits);
    }
}

static void drain(struct rig *self)
{
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &self->last))
        continue;
    while (co_outbox_take_event(&self->out, &event))
        continue;
}

static void start(struct rig *self, uint8_t type, unsigned count)
{
    od_init(&self->od);
    for (uint16_t i = 0; i < OBJECTS; i++)
        add_number(self, (uint16_t)(0x2000 + i), 0, OD_UNSIGNED32, i);
    add_outputs(self, type, count);
    check(slave_init(&self->slave, NODE, &self->od));
    co_outbox_init(&self->out, self->frames, 8, self->events, 16);
    slave_start(&self->slave, 0, &self->out);
    drain(self);
    slave_command(&self->slave, NMT_START, 0, &self->out);
    drain(self);
}

static void hand(struct rig *self, const char *text, unsigned long times)
{
    struct co_frame frame;

    if (!co_frame_parse(text, &frame))
        exit(1);
    for (unsigned long i = 0; i < times; i++) {
        frame.data[7] = (uint8_t)i;
        slave_on_frame(&self->slave, &frame, i + 1, &self->out);
        drain(self);
    }
}

static bool answered(const struct rig *self, uint8_t command)
{
    return self->last.id == RESPONSE + NODE && self->last.data[0] == command;
}

static bool upload(struct rig *self, unsigned long times)
{
    start(self, OD_UNSIGNED8, 8);
    hand(self, "605#4020200000000000", times);
    return answered(self, 0x43);
}

static bool download(struct rig *self, unsigned long times)
{
    start(self, OD_UNSIGNED8, 8);
    hand(self, "605#2320200078563412", times);
    return answered(self, 0x60);
}

/* What came last is in the dictionary. */
static bool received(const struct rig *self, unsigned count, unsigned long times)
{
    const struct od_entry *last = od_find(&self->od, OUTPUTS, (uint8_t)count);

    return last->value[last->size - 1] == (uint8_t)(times - 1) &&
           od_find(&self->od, OUTPUTS, 1)->value[0] == 0x11;
}

static bool rpdo_of_bytes(struct rig *self, unsigned long times)
{
    start(self, OD_UNSIGNED8, 8);
    hand(self, "205#1122334455667788", times);
    return received(self, 8, times);
}

static bool rpdo_of_words(struct rig *self, unsigned long times)
{
    start(self, OD_UNSIGNED32, 2);
    hand(self, "205#1122334455667788", times);
    return received(self, 2, times);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        bool (*run)(struct rig *self, unsigned long times);
    } kinds[] = { { "upload", upload },
                  { "download", download },
                  { "rpdo-bytes", rpdo_of_bytes },
                  { "rpdo-words", rpdo_of_words } };
    struct rig *rig = calloc(1, sizeof *rig);
    bool works = false, known = false;

    for (size_t i = 0; rig && argc == 3 && i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(argv[1], kinds[i].name) == 0) {
            known = true;
            works = kinds[i].run(rig, strtoul(argv[2], NULL, 10));
        }
    if (known) {
        slave_done(&rig->slave);
        od_done(&rig->od);
    }
    free(rig);
    if (known && !works)
        fputs("the device does not do this yet\n", stderr);
    return !known ? 2 : works ? 0 : 77;
}

/*
 * Guarding under frames, time and outboxes of any kind; master and device hear each other.
 *
 * The input is a list of steps, one byte each with what it needs behind it:
 *
 *     0..95      a frame of the node for the master: 2 bytes, dlc with kind, and data
 *     96..127    a frame for the device: 2 bytes, as above
 *     128..223   time passes: one byte, in units of 10 ms
 *     224..231   the master starts: 2 bytes, guard time in units of 10 ms and factor
 *     232..239   it asks: one byte, time in units of 10 ms
 *     240..243   it stops
 *     244..249   the device's life time: one byte, in units of 10 ms
 *     250..255   its life guarding stops
 *
 * The low bits of the step say how much room the outbox has in it.
 */
#include "proto/event.h"
#include "proto/guarding.h"
#include "proto/nmt.h"

#include <stdlib.h>

#define NODE 5
#define UNIT CO_MS(10)

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct input {
    const uint8_t *data;
    size_t size;
};

struct fuzz {
    struct guard_master master;
    struct guard_slave slave;
    co_us_t now;
    unsigned toggles;     /* as told last */
    bool lost, life_lost; /* as told last */
    struct co_frame frames[2];
    struct co_event events[4];
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

static struct co_frame make_frame(struct input *input)
{
    const uint8_t kind = take(input);
    struct co_frame frame = co_frame_make(NMT_ERROR_CONTROL_ID + NODE, kind % 9);

    frame.flags = kind & 0x80 ? CO_FRAME_RTR : 0;
    frame.data[0] = take(input);
    return frame;
}

static void start(struct fuzz *self, struct input *input)
{
    const co_us_t period = UNIT * take(input);

    guard_master_start(&self->master, period, take(input), self->now);
    self->lost = false;
}

static void ask(struct fuzz *self, struct input *input)
{
    guard_master_ask(&self->master, UNIT * (1u + take(input)), self->now);
    self->lost = false;
}

static void act(struct fuzz *self, uint8_t kind, struct input *input)
{
    if (kind < 128) {
        const struct co_frame frame = make_frame(input);

        if (kind < 96)
            guard_master_on_frame(&self->master, &frame, self->now, &self->out);
        else
            guard_slave_on_frame(&self->slave, &frame, self->now, &self->out);
    } else if (kind < 224) {
        self->now += UNIT * take(input);
    } else if (kind < 232) {
        start(self, input);
    } else if (kind < 240) {
        ask(self, input);
    } else if (kind < 244) {
        guard_master_stop(&self->master);
        self->lost = false;
    } else if (kind < 250) {
        self->slave.life_time = UNIT * take(input);
    } else {
        guard_slave_stop(&self->slave, &self->out);
    }
}

static void check_event(struct fuzz *self, const struct co_event *event)
{
    check(event->node == NODE);
    if (event->type == PROTO_GUARD_STATE) {
        check(event->detail > 0 && event->detail < 0x80);
        self->lost = false;
    } else if (event->type == PROTO_GUARD_LOST) {
        check(!self->lost);
        self->lost = true;
    } else if (event->type == PROTO_GUARD_TOGGLE) {
        check(event->actual > self->toggles);
        self->toggles = (unsigned)event->actual;
    } else {
        check(event->type == (self->life_lost ? PROTO_LIFE_BACK : PROTO_LIFE_LOST));
        self->life_lost = !self->life_lost;
    }
}

/* Hands the frames over; returns how many requests there were. */
static unsigned drain(struct fuzz *self)
{
    struct co_frame frame;
    struct co_event event;
    unsigned requests = 0;

    while (co_outbox_take_frame(&self->out, &frame)) {
        check(frame.id == NMT_ERROR_CONTROL_ID + NODE && frame.dlc == 1);
        requests += (frame.flags & CO_FRAME_RTR) != 0;
        guard_slave_on_frame(&self->slave, &frame, self->now, &self->out);
        guard_master_on_frame(&self->master, &frame, self->now, &self->out);
    }
    while (co_outbox_take_event(&self->out, &event))
        check_event(self, &event);
    return requests;
}

static unsigned step_time(struct fuzz *self)
{
    guard_master_on_time(&self->master, self->now, &self->out);
    guard_slave_on_time(&self->slave, self->now, &self->out);
    return drain(self);
}

static void step(struct fuzz *self, struct input *input)
{
    const uint8_t kind = take(input);

    co_outbox_init(&self->out, self->frames, kind & 1 ? 0 : 2, self->events, kind & 2 ? 0 : 4);
    act(self, kind, input);
    check(drain(self) == 0);
    check(step_time(self) <= 1);
}

/* With room nothing stays due, whatever came before. */
static void settle(struct fuzz *self)
{
    for (unsigned i = 0; i < 4; i++) {
        co_outbox_init(&self->out, self->frames, 2, self->events, 4);
        step_time(self);
    }
    check(guard_master_deadline(&self->master) > self->now);
    check(guard_slave_deadline(&self->slave) > self->now);
    check(self->life_lost == self->slave.lost);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct input input = { .data = data, .size = size };
    struct fuzz fuzz = { .toggles = 0 };

    guard_master_init(&fuzz.master, NODE);
    guard_slave_init(&fuzz.slave, NODE);
    fuzz.slave.state = NMT_PREOPERATIONAL;
    while (input.size > 0)
        step(&fuzz, &input);
    settle(&fuzz);
    return 0;
}

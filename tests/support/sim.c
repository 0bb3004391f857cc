#include "support/sim.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void sim_init(struct sim *self, unsigned bitrate)
{
    memset(self, 0, sizeof *self);
    self->bitrate = bitrate;
    self->sending = -1;
    self->now = CO_MS(1000);
    self->box_size = SIM_BOX;
}

void sim_done(struct sim *self)
{
    free(self->trace);
}

static struct sim_device *add_device(struct sim *self)
{
    struct sim_device *device = &self->devices[self->device_count++];

    assert(self->device_count <= SIM_DEVICES);
    co_outbox_init(&device->box, device->frames, self->box_size, device->events, self->box_size);
    return device;
}

struct sim_device *sim_add_slave(struct sim *self, struct slave *slave)
{
    struct sim_device *device = add_device(self);

    device->slave = slave;
    device->node = slave->node;
    return device;
}

struct sim_device *sim_add_manager(struct sim *self, struct manager *manager)
{
    struct sim_device *device = add_device(self);

    device->manager = manager;
    device->node = manager->config->manager_node_id;
    return device;
}

static void take_events(struct sim *self, struct sim_device *device)
{
    struct co_event event;

    while (co_outbox_take_event(&device->box, &event))
        if (device->manager && self->on_event)
            self->on_event(self->context, &event);
}

static void lose_frames(struct sim_device *device)
{
    struct co_frame frame;

    while (co_outbox_take_frame(&device->box, &frame))
        ;
}

void sim_power(struct sim *self, struct sim_device *device, bool on)
{
    device->active = on;
    if (!on)
        lose_frames(device);
    if (on && device->manager)
        manager_start(device->manager, self->now, &device->box);
    else if (on)
        slave_start(device->slave, self->now, &device->box);
    take_events(self, device);
}

co_us_t sim_frame_time(const struct sim *self, const struct co_frame *frame)
{
    unsigned bytes = frame->flags & CO_FRAME_RTR ? 0 : frame->dlc;
    unsigned bits = 47 + 8 * bytes + (33 + 8 * bytes) / 4;

    return self->bitrate ? (co_us_t)bits * 1000000u / self->bitrate : 0;
}

static void record(struct sim *self, const struct co_frame *frame, uint8_t sender)
{
    if (self->trace_count == self->trace_room) {
        self->trace_room = self->trace_room ? 2 * self->trace_room : 1024;
        self->trace = realloc(self->trace, self->trace_room * sizeof *self->trace);
        assert(self->trace);
    }
    self->trace[self->trace_count++] = (struct sim_line){ self->now, sender, *frame };
}

static void deliver(struct sim *self, const struct co_frame *frame, int sender)
{
    for (int i = 0; i < (int)self->device_count; i++) {
        struct sim_device *device = &self->devices[i];
        struct co_frame copy = *frame;

        if (!device->active || device->unplugged)
            continue;
        copy.flags = (uint8_t)(copy.flags & ~CO_FRAME_OWN);
        if (i == sender)
            copy.flags |= CO_FRAME_OWN;
        if (device->manager)
            manager_on_frame(device->manager, &copy, self->now, &device->box);
        else if (device->slave)
            slave_on_frame(device->slave, &copy, self->now, &device->box);
        take_events(self, device);
    }
}

/* Only the sender gets it back. */
static void confirm(struct sim *self, const struct co_frame *frame, struct sim_device *sender)
{
    struct co_frame own = *frame;

    own.flags |= CO_FRAME_OWN;
    if (sender->manager)
        manager_on_frame(sender->manager, &own, self->now, &sender->box);
    take_events(self, sender);
}

static void end_frame(struct sim *self)
{
    struct sim_device *sender = &self->devices[self->sending];
    struct co_frame frame = self->on_wire;
    enum sim_fate fate = SIM_DELIVER;

    self->sending = -1;
    if (self->fault)
        fate = self->fault(self->context, &frame, sender->node);
    if (fate == SIM_LOSE || !sender->active)
        return;
    record(self, &frame, sender->node);
    if (fate == SIM_DELIVER)
        deliver(self, &frame, (int)(sender - self->devices));
    else
        confirm(self, &frame, sender);
}

static bool wants_to_send(const struct sim *self, const struct sim_device *device)
{
    return device->active && device->box.frame_count > 0 && device->hold_until <= self->now;
}

static uint32_t next_id(const struct sim_device *device)
{
    return device->box.frames[device->box.frame_first].id;
}

/* The lowest CAN-ID of those that want to send wins. */
static void begin_frame(struct sim *self)
{
    int winner = -1;

    for (int i = 0; i < (int)self->device_count; i++) {
        if (self->devices[i].unplugged)
            lose_frames(&self->devices[i]);
        if (!wants_to_send(self, &self->devices[i]))
            continue;
        if (winner < 0 || next_id(&self->devices[i]) < next_id(&self->devices[winner]))
            winner = i;
    }
    if (winner < 0)
        return;
    co_outbox_take_frame(&self->devices[winner].box, &self->on_wire);
    self->sending = winner;
    self->wire_free = self->now + sim_frame_time(self, &self->on_wire);
    self->busy += self->wire_free - self->now;
}

static co_us_t device_deadline(const struct sim_device *device)
{
    if (!device->active || (!device->manager && !device->slave))
        return CO_NEVER;
    return device->manager ? manager_deadline(device->manager) : slave_deadline(device->slave);
}

static void run_timers(struct sim *self)
{
    for (unsigned i = 0; i < self->device_count; i++) {
        struct sim_device *device = &self->devices[i];

        if (device_deadline(device) > self->now)
            continue;
        if (device->manager)
            manager_on_time(device->manager, self->now, &device->box);
        else
            slave_on_time(device->slave, self->now, &device->box);
        take_events(self, device);
    }
}

/* A device whose outbox waits for the wire can do what is due only then. */
static co_us_t next_time_of(const struct sim *self, const struct sim_device *device)
{
    co_us_t deadline = device_deadline(device);
    bool waits = device->active && device->box.frame_count > 0;

    if (waits && device->hold_until > self->now)
        return deadline > self->now ? co_earlier(deadline, device->hold_until) : device->hold_until;
    if (waits && self->sending >= 0 && deadline <= self->now)
        return self->wire_free;
    return deadline;
}

static co_us_t next_time(const struct sim *self)
{
    co_us_t next = self->sending >= 0 ? self->wire_free : CO_NEVER;

    for (unsigned i = 0; i < self->device_count; i++)
        next = co_earlier(next, next_time_of(self, &self->devices[i]));
    return next > self->now ? next : self->now;
}

void sim_run(struct sim *self, co_us_t until)
{
    unsigned stuck = 0;

    for (;;) {
        co_us_t next;

        if (self->sending >= 0 && self->now >= self->wire_free)
            end_frame(self);
        run_timers(self);
        if (self->sending < 0)
            begin_frame(self);
        if (self->on_step)
            self->on_step(self->context);
        next = next_time(self);
        if (next > until)
            break;
        stuck = next == self->now ? stuck + 1 : 0;
        assert(stuck < 100000); /* a deadline that stays due for ever */
        self->now = next;
    }
    self->now = until;
}

static struct co_frame parse(const char *text)
{
    struct co_frame frame;
    bool ok = co_frame_parse(text, &frame);

    assert(ok);
    (void)ok;
    return frame;
}

void sim_inject(struct sim *self, const char *text)
{
    struct co_frame frame = parse(text);

    record(self, &frame, 0);
    deliver(self, &frame, -1);
}

void sim_say(struct sim *self, const char *text)
{
    struct co_frame frame = parse(text);

    if (!self->foreign) {
        self->foreign = add_device(self);
        self->foreign->active = true;
    }
    co_outbox_put_frame(&self->foreign->box, &frame);
}

struct co_outbox *sim_box(struct sim *self, struct sim_device *device)
{
    (void)self;
    return &device->box;
}

char *sim_trace_text(const struct sim *self)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);

    assert(stream);
    for (size_t i = 0; i < self->trace_count; i++) {
        const struct sim_line *line = &self->trace[i];
        char frame[CO_FRAME_TEXT_SIZE];

        fprintf(stream, "(%u.%06u) sim %s\n", (unsigned)(line->time / 1000000u),
                (unsigned)(line->time % 1000000u),
                co_frame_format(&line->frame, frame, sizeof frame));
    }
    fclose(stream);
    return text;
}

size_t sim_count(const struct sim *self, uint32_t id)
{
    size_t count = 0;

    for (size_t i = 0; i < self->trace_count; i++)
        count += self->trace[i].frame.id == id;
    return count;
}

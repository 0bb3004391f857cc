#include "support/sim.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FILTERS_MAX 64u /* of a device */

void sim_init(struct sim *self, unsigned bitrate)
{
    memset(self, 0, sizeof *self);
    self->bitrate = bitrate;
    self->sending = -1;
    self->now = CO_MS(1000);
    self->box_size = SIM_BOX;
    co_deadlines_init(&self->deadlines);
}

void sim_done(struct sim *self)
{
    free(self->trace);
}

static unsigned number_of(const struct sim *self, const struct sim_device *device)
{
    return (unsigned)(device - self->devices);
}

static co_us_t device_deadline(const struct sim_device *device)
{
    if (!device->active || (!device->manager && !device->slave))
        return CO_NEVER;
    return device->manager ? manager_deadline(device->manager) : slave_deadline(device->slave);
}

static void follow_filters(struct sim *self, struct sim_device *device)
{
    struct slave_filter filters[FILTERS_MAX];
    unsigned count = slave_listens(device->slave, filters, FILTERS_MAX);

    assert(count <= FILTERS_MAX);
    device->listens = device->slave->listen_generation;
    for (unsigned id = 0; id < SIM_IDS; id++)
        co_set_remove(&self->hearers[id], number_of(self, device));
    for (unsigned i = 0; i < count; i++)
        if (!filters[i].ext)
            co_set_add(&self->hearers[filters[i].id], number_of(self, device));
}

static void touch(struct sim *self, struct sim_device *device)
{
    unsigned number = number_of(self, device);

    co_deadlines_set(&self->deadlines, number, device_deadline(device));
    if (device->active && device->box.frame_count > 0)
        co_set_add(&self->waiting, number);
    else
        co_set_remove(&self->waiting, number);
    if (device->slave && device->listens != device->slave->listen_generation)
        follow_filters(self, device);
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
    follow_filters(self, device);
    return device;
}

struct sim_device *sim_add_manager(struct sim *self, struct manager *manager)
{
    struct sim_device *device = add_device(self);

    device->manager = manager;
    device->node = manager->config->manager_node_id;
    co_set_add(&self->managers, number_of(self, device));
    return device;
}

static void take_events(struct sim *self, struct sim_device *device)
{
    struct co_event event;

    while (co_outbox_take_event(&device->box, &event))
        if (device->manager && self->on_event)
            self->on_event(self->context, &event);
        else if (device->slave && self->on_slave_event)
            self->on_slave_event(self->context, &event);
}

void sim_touch(struct sim *self, struct sim_device *device)
{
    take_events(self, device);
    touch(self, device);
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
    touch(self, device);
}

co_us_t sim_frame_time(const struct sim *self, const struct co_frame *frame)
{
    unsigned bytes = frame->flags & CO_FRAME_RTR ? 0 : frame->dlc;
    unsigned bits = 47 + 8 * bytes + (33 + 8 * bytes) / 4;

    return self->bitrate ? (co_us_t)bits * 1000000u / self->bitrate : 0;
}

static void write_line(FILE *stream, const struct sim_line *line)
{
    char frame[CO_FRAME_TEXT_SIZE];

    fprintf(stream, "(%u.%06u) sim %s\n", (unsigned)(line->time / 1000000u),
            (unsigned)(line->time % 1000000u), co_frame_format(&line->frame, frame, sizeof frame));
}

static void record(struct sim *self, const struct co_frame *frame, uint8_t sender)
{
    if (self->trace_count == self->trace_room) {
        self->trace_room = self->trace_room ? 2 * self->trace_room : 1024;
        self->trace = realloc(self->trace, self->trace_room * sizeof *self->trace);
        assert(self->trace);
    }
    self->trace[self->trace_count++] = (struct sim_line){ self->now, sender, *frame };
    if (self->log)
        write_line(self->log, &self->trace[self->trace_count - 1]);
}

static void hear(struct sim *self, struct sim_device *device, struct co_frame frame)
{
    if (!device->active || device->unplugged)
        return;
    if (device->manager)
        manager_on_frame(device->manager, &frame, self->now, &device->box);
    else
        slave_on_frame(device->slave, &frame, self->now, &device->box);
    take_events(self, device);
    touch(self, device);
}

static void deliver(struct sim *self, const struct co_frame *frame, int sender)
{
    const struct co_set *hearers = &self->hearers[frame->id % SIM_IDS];
    bool ext = (frame->flags & CO_FRAME_EXT) != 0;
    struct co_set all = self->managers;

    for (size_t i = 0; !ext && i < sizeof all.bits / sizeof all.bits[0]; i++)
        all.bits[i] |= hearers->bits[i];
    CO_SET_EACH(&all, i)
    {
        struct co_frame copy = *frame;

        copy.flags = (uint8_t)(copy.flags & ~CO_FRAME_OWN);
        if ((int)i == sender)
            copy.flags |= CO_FRAME_OWN;
        hear(self, &self->devices[i], copy);
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

static uint32_t next_id(const struct sim_device *device)
{
    return device->box.frames[device->box.frame_first].id;
}

/* Of those that want to send the one with the lowest CAN-ID; NULL: nobody does. */
static struct sim_device *find_winner(struct sim *self)
{
    struct sim_device *winner = NULL;

    CO_SET_EACH(&self->waiting, i)
    {
        struct sim_device *device = &self->devices[i];

        if (device->unplugged) {
            lose_frames(device);
            touch(self, device);
        } else if (device->active && device->hold_until <= self->now &&
                   (!winner || next_id(device) < next_id(winner))) {
            winner = device;
        }
    }
    return winner;
}

static void begin_frame(struct sim *self)
{
    struct sim_device *winner = find_winner(self);

    if (!winner)
        return;
    co_outbox_take_frame(&winner->box, &self->on_wire);
    touch(self, winner);
    self->sending = (int)number_of(self, winner);
    self->wire_free = self->now + sim_frame_time(self, &self->on_wire);
    self->busy += self->wire_free - self->now;
}

static void touch_managers(struct sim *self)
{
    CO_SET_EACH(&self->managers, i)
    touch(self, &self->devices[i]);
}

static void run_timers(struct sim *self)
{
    for (unsigned i = co_deadlines_due(&self->deadlines, 0, self->now); i < self->device_count;
         i = co_deadlines_due(&self->deadlines, i + 1, self->now)) {
        struct sim_device *device = &self->devices[i];

        if (device->manager)
            manager_on_time(device->manager, self->now, &device->box);
        else
            slave_on_time(device->slave, self->now, &device->box);
        take_events(self, device);
        touch(self, device);
    }
}

/* When a device that is still due can go on: its outbox waits for the wire, or is held. */
static co_us_t next_time_of_stuck(const struct sim *self, const struct sim_device *device)
{
    bool waits = device->active && device->box.frame_count > 0;

    if (waits && device->hold_until > self->now)
        return device->hold_until;
    return waits && self->sending >= 0 ? self->wire_free : self->now;
}

static co_us_t next_time_of(const struct sim *self, const struct sim_device *device)
{
    co_us_t deadline = device_deadline(device);
    bool held = device->active && device->box.frame_count > 0 && device->hold_until > self->now;

    if (deadline <= self->now)
        return next_time_of_stuck(self, device);
    return held ? co_earlier(deadline, device->hold_until) : deadline;
}

static co_us_t next_time(const struct sim *self)
{
    co_us_t next = self->sending >= 0 ? self->wire_free : CO_NEVER;
    co_us_t first = co_deadlines_first(&self->deadlines);

    if (first > self->now) { /* most often: nobody is stuck */
        next = co_earlier(next, first);
        CO_SET_EACH(&self->waiting, i)
        if (self->devices[i].hold_until > self->now)
            next = co_earlier(next, self->devices[i].hold_until);
        return next;
    }
    for (unsigned i = 0; i < self->device_count; i++)
        next = co_earlier(next, next_time_of(self, &self->devices[i]));
    return next > self->now ? next : self->now;
}

static void step(struct sim *self)
{
    self->steps++;
    if (self->sending >= 0 && self->now >= self->wire_free)
        end_frame(self);
    touch_managers(self);
    run_timers(self);
    if (self->sending < 0)
        begin_frame(self);
    if (self->on_step)
        self->on_step(self->context);
    touch_managers(self);
}

void sim_run(struct sim *self, co_us_t until)
{
    unsigned stuck = 0;

    for (unsigned i = 0; i < self->device_count; i++)
        sim_touch(self, &self->devices[i]);
    for (;;) {
        co_us_t next;

        step(self);
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

    sim_put(self, &frame);
}

void sim_put(struct sim *self, const struct co_frame *frame)
{
    if (!self->foreign) {
        self->foreign = add_device(self);
        self->foreign->active = true;
    }
    co_outbox_put_frame(&self->foreign->box, frame);
    touch(self, self->foreign);
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
    for (size_t i = 0; i < self->trace_count; i++)
        write_line(stream, &self->trace[i]);
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

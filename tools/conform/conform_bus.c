#include "conform.h"

#include "port/clock.h"

#include <poll.h>
#include <stdlib.h>
#include <string.h>

#define SLICE          CO_MS(100) /* so often it looks whether the user gives up */
#define CONFIRMATION   CO_MS(2000)
#define FRAMES_AT_ONCE 1000u
#define FRAMES_AT_MOST 300000u

static bool is_stopped(struct conform *self)
{
    struct pollfd fd = { .fd = self->signals, .events = POLLIN };

    if (self->end == CONFORM_RUNS && self->signals >= 0 && poll(&fd, 1, 0) > 0) {
        self->end = CONFORM_STOPPED;
        snprintf(self->message, sizeof self->message, "stopped before the end");
    }
    return self->end == CONFORM_STOPPED || self->end == CONFORM_BUS_LOST;
}

static void lose_bus(struct conform *self, const char *what)
{
    char text[256];

    bus_explain(self->bus, text, sizeof text);
    snprintf(self->message, sizeof self->message, "%s: %s; %s", self->options.bus, what, text);
    self->end = CONFORM_BUS_LOST;
}

static void keep(struct conform *self, const struct bus_rx *rx)
{
    self->lost += rx->lost;
    if (self->frame_count == self->frame_room) {
        const size_t room = self->frame_room ? 2 * self->frame_room : 256;
        struct bus_rx *frames = room > FRAMES_AT_MOST
                                    ? NULL
                                    : realloc(self->frames, room * sizeof *frames);

        if (!frames) {
            self->lost++;
            return;
        }
        self->frames = frames;
        self->frame_room = room;
    }
    self->frames[self->frame_count++] = *rx;
}

/* Takes what is there, of a bus that never rests not all; false: the bus is lost. */
static bool drain(struct conform *self)
{
    enum co_err err = CO_OK;
    struct bus_rx rx;

    for (unsigned i = 0; i < FRAMES_AT_ONCE && err == CO_OK; i++) {
        err = bus_receive(self->bus, &rx);
        if (err == CO_OK)
            keep(self, &rx);
    }
    if (err != CO_OK && err != CO_ERR_AGAIN)
        lose_bus(self, co_err_text(err));
    return self->end != CONFORM_BUS_LOST;
}

/* Waits for frames, at most until the deadline; false: it has passed, or the run ends. */
static bool pump(struct conform *self, co_us_t deadline)
{
    const co_us_t now = clock_now();
    enum co_err err = CO_OK;

    if (is_stopped(self))
        return false;
    if (now < deadline)
        err = bus_wait(self->bus, co_earlier(deadline, now + SLICE));
    if (err != CO_OK && err != CO_ERR_TIMEOUT) {
        lose_bus(self, co_err_text(err));
        return false;
    }
    return drain(self) && now < deadline;
}

void conform_listen(struct conform *self, unsigned ms)
{
    const co_us_t deadline = clock_now() + CO_MS(ms);

    while (pump(self, deadline))
        continue;
}

size_t conform_mark(struct conform *self)
{
    if (!is_stopped(self))
        drain(self);
    return self->frame_count;
}

void conform_show(struct conform *self, uint32_t id)
{
    if (id < 0x800)
        self->shown[id / 8] |= (uint8_t)(1u << id % 8);
}

void conform_drop(struct conform *self, size_t from)
{
    if (!self->options.verbose && from < self->frame_count)
        self->frame_count = from;
}

/* --- sending --- */

/* Waits for its own frame, at its place among the others. */
static size_t confirm(struct conform *self, const struct co_frame *frame, size_t from)
{
    const co_us_t deadline = clock_now() + CONFIRMATION;

    for (size_t i = from;;) {
        for (; i < self->frame_count; i++)
            if ((self->frames[i].frame.flags & CO_FRAME_OWN) &&
                co_frame_equal(&self->frames[i].frame, frame))
                return i + 1;
        if (!pump(self, deadline)) {
            if (!is_stopped(self))
                lose_bus(self, "a frame is not confirmed: nobody acknowledges it");
            return self->frame_count;
        }
    }
}

size_t conform_send(struct conform *self, const struct co_frame *frame)
{
    const co_us_t deadline = clock_now() + CONFIRMATION;
    const size_t from = conform_mark(self);
    enum co_err err = CO_ERR_AGAIN;

    while (!is_stopped(self) && (err = bus_send(self->bus, frame)) == CO_ERR_AGAIN)
        if (!pump(self, co_earlier(deadline, clock_now() + CO_MS(1))) && clock_now() >= deadline)
            break;
    if (is_stopped(self))
        return from;
    if (err != CO_OK) {
        lose_bus(self, co_err_text(err));
        return from;
    }
    return confirm(self, frame, from);
}

size_t conform_send_data(struct conform *self, uint32_t id, const void *data, uint8_t dlc)
{
    struct co_frame frame = co_frame_make(id, dlc);

    if (dlc > 0)
        memcpy(frame.data, data, dlc);
    return conform_send(self, &frame);
}

size_t conform_send_rtr(struct conform *self, uint32_t id, uint8_t dlc)
{
    struct co_frame frame = co_frame_make(id, dlc);

    frame.flags = CO_FRAME_RTR;
    return conform_send(self, &frame);
}

/* --- receiving --- */

struct wanted {
    uint32_t id;
    int byte; /* the first one; -1: any */
};

static bool is_wanted(const struct co_frame *frame, const struct wanted *wanted)
{
    return frame->id == wanted->id && (frame->flags & (CO_FRAME_OWN | CO_FRAME_EXT)) == 0 &&
           (wanted->byte < 0 || (frame->dlc > 0 && frame->data[0] == wanted->byte));
}

static size_t find(struct conform *self, size_t from, const struct wanted *wanted)
{
    for (size_t i = from; i < self->frame_count; i++)
        if (is_wanted(&self->frames[i].frame, wanted))
            return i;
    return CONFORM_NOTHING;
}

static size_t await(struct conform *self, size_t from, const struct wanted *wanted, unsigned ms)
{
    const co_us_t deadline = clock_now() + CO_MS(ms);
    bool more = true;

    conform_show(self, wanted->id);
    for (;;) {
        const size_t end = self->frame_count;
        const size_t found = find(self, from, wanted);

        if (found != CONFORM_NOTHING || !more)
            return found;
        from = end > from ? end : from;
        more = pump(self, deadline);
    }
}

size_t conform_await(struct conform *self, size_t from, uint32_t id, unsigned ms)
{
    return await(self, from, &(struct wanted){ .id = id, .byte = -1 }, ms);
}

size_t conform_await_byte(struct conform *self, size_t from, uint32_t id, uint8_t byte, unsigned ms)
{
    return await(self, from, &(struct wanted){ .id = id, .byte = byte }, ms);
}

unsigned conform_count(struct conform *self, size_t from, uint32_t id, unsigned ms)
{
    const struct wanted wanted = { .id = id, .byte = -1 };
    unsigned count = 0;

    conform_show(self, id);
    conform_listen(self, ms);
    for (size_t i = from; i < self->frame_count; i++)
        count += is_wanted(&self->frames[i].frame, &wanted);
    return count;
}

bool conform_expect_none(struct conform *self, size_t from, uint32_t id, unsigned ms)
{
    const size_t at = conform_await(self, from, id, ms);
    char text[CO_FRAME_TEXT_SIZE];

    if (at == CONFORM_NOTHING)
        return true;
    return conform_fail(self, "expected no frame %03X, received %s", (unsigned)id,
                        co_frame_format(conform_frame(self, at), text, sizeof text));
}

const struct co_frame *conform_frame(const struct conform *self, size_t number)
{
    return &self->frames[number].frame;
}

co_us_t conform_time(const struct conform *self, size_t number)
{
    return self->frames[number].time;
}

/* --- NMT --- */

size_t conform_nmt(struct conform *self, uint8_t command)
{
    return conform_send_data(self, 0x000, (uint8_t[]){ command, self->options.node }, 2);
}

bool conform_reset(struct conform *self, uint8_t command)
{
    const unsigned ms = self->options.boot_timeout;
    const size_t from = conform_nmt(self, command);

    if (conform_await_byte(self, from, 0x700u + self->options.node, 0x00, ms) != CONFORM_NOTHING)
        return true;
    return conform_fail(self, "no boot-up message %03X#00 within %u ms after NMT reset %s",
                        0x700u + self->options.node, ms,
                        command == CONFORM_RESET_COMM ? "communication" : "node");
}

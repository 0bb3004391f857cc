#include "support/device.h"

#include "base/bytes.h"
#include "proto/event.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define SPIN_LIMIT 100000u

static void add_entries(struct od *od, const struct device_entry *entries)
{
    for (; entries->index != 0; entries++) {
        uint8_t bytes[8] = { 0 };
        const struct od_spec spec = { .index = entries->index,
                                      .sub = entries->sub,
                                      .type = entries->type,
                                      .access = entries->access,
                                      .mappable = entries->mappable,
                                      .value = bytes,
                                      .size = od_type_size(entries->type) };

        put_le32(bytes, entries->value);
        ck_assert_int_eq(od_add(od, &spec, NULL), CO_OK);
    }
}

void device_init_od(struct device *self, const struct od *od)
{
    memset(self, 0, sizeof *self);
    self->od = *od;
    co_outbox_init(&self->out, self->out_frames, 8, self->out_events, 8);
    ck_assert_int_eq(slave_init(&self->slave, DEVICE_NODE, &self->od), CO_OK);
}

void device_init(struct device *self, const struct device_entry *entries)
{
    struct od od;

    od_init(&od);
    add_entries(&od, entries);
    device_init_od(self, &od);
}

void device_done(struct device *self)
{
    slave_done(&self->slave);
    od_done(&self->od);
}

void device_start(struct device *self)
{
    slave_start(&self->slave, self->now, &self->out);
    device_drain(self);
}

void device_drain(struct device *self)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame)) {
        if (frame.id == 0 && frame.dlc == 0) /* by device_fill() */
            continue;
        ck_assert_uint_lt(self->frame_count, DEVICE_RECORDS);
        self->frames[self->frame_count].at = self->now;
        self->frames[self->frame_count++].frame = frame;
    }
    while (co_outbox_take_event(&self->out, &event)) {
        if (event.type == 0)
            continue;
        ck_assert_uint_lt(self->event_count, DEVICE_RECORDS);
        self->events[self->event_count++] = event;
    }
}

void device_fill(struct device *self, unsigned frames, unsigned events)
{
    const struct co_frame frame = { .id = 0 };
    const struct co_event event = { .type = 0 };

    while (co_outbox_room(&self->out, frames + 1, 0))
        co_outbox_put_frame(&self->out, &frame);
    while (co_outbox_room(&self->out, 0, events + 1))
        co_outbox_put_event(&self->out, &event);
}

void device_run(struct device *self, co_us_t until)
{
    device_drain(self);
    for (unsigned calls = 0; slave_deadline(&self->slave) <= until; calls++) {
        const co_us_t deadline = slave_deadline(&self->slave);

        ck_assert_uint_lt(calls, SPIN_LIMIT);
        if (deadline > self->now)
            self->now = deadline;
        slave_on_time(&self->slave, self->now, &self->out);
        device_drain(self);
    }
    self->now = until;
}

void device_hear(struct device *self, const char *text)
{
    struct co_frame frame;

    ck_assert_msg(co_frame_parse(text, &frame), "no frame: %s", text);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
}

const char *device_next_frame(struct device *self, co_us_t *ret_at)
{
    static char text[CO_FRAME_TEXT_SIZE];

    if (self->frame_taken == self->frame_count)
        return "";
    if (ret_at != NULL)
        *ret_at = self->frames[self->frame_taken].at;
    return co_frame_format(&self->frames[self->frame_taken++].frame, text, sizeof text);
}

const char *device_next_event(struct device *self)
{
    static char text[64];
    const struct co_event *event;

    if (self->event_taken == self->event_count)
        return "";
    event = &self->events[self->event_taken++];
    if (event->type == SLAVE_STATE)
        snprintf(text, sizeof text, "state %u", event->detail);
    else if (event->type == SLAVE_WRITTEN)
        snprintf(text, sizeof text, "written %04X:%02X = %llu", event->index, event->sub,
                 (unsigned long long)event->actual);
    else if (event->type == SLAVE_EMERGENCY)
        snprintf(text, sizeof text, "emcy %04X %02X", event->code, event->detail);
    else if (event->type == PROTO_HB_STATE)
        snprintf(text, sizeof text, "heard %u: %u", event->node, event->detail);
    else if (event->type == PROTO_HB_LOST)
        snprintf(text, sizeof text, "lost %u: %u", event->node, event->detail);
    else
        snprintf(text, sizeof text, "event %u", event->type);
    return text;
}

void device_forget(struct device *self)
{
    self->frame_count = 0;
    self->frame_taken = 0;
    self->event_count = 0;
    self->event_taken = 0;
}

/* The answer to a request; false when there is none. */
static bool ask(struct device *self, const uint8_t *request, struct co_frame *ret_answer)
{
    struct co_frame frame = co_frame_make(0x600 + DEVICE_NODE, 8);
    const unsigned before = self->frame_count;

    memcpy(frame.data, request, 8);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
    device_drain(self);
    if (self->frame_count == before)
        return false;
    *ret_answer = self->frames[before].frame;
    ck_assert_uint_eq(ret_answer->id, 0x580 + DEVICE_NODE);
    ck_assert_mem_eq(ret_answer->data + 1, request + 1, 3);
    return true;
}

sdo_abort_t device_write(struct device *self, uint16_t index, uint8_t sub, uint8_t size,
                         uint32_t value)
{
    uint8_t request[8] = { (uint8_t)(0x23 | (4 - size) << 2), 0, 0, sub };
    struct co_frame answer;

    put_le16(request + 1, index);
    put_le32(request + 4, value);
    if (!ask(self, request, &answer))
        return DEVICE_SILENT;
    if (answer.data[0] == 0x80)
        return get_le32(answer.data + 4);
    ck_assert_uint_eq(answer.data[0], 0x60);
    return SDO_OK;
}

sdo_abort_t device_read(struct device *self, uint16_t index, uint8_t sub, uint32_t *ret_value)
{
    uint8_t request[8] = { 0x40, 0, 0, sub };
    struct co_frame answer;

    put_le16(request + 1, index);
    if (!ask(self, request, &answer))
        return DEVICE_SILENT;
    if (answer.data[0] == 0x80)
        return get_le32(answer.data + 4);
    ck_assert_uint_eq(answer.data[0] & 0xE3u, 0x43);
    *ret_value = get_le32(answer.data + 4);
    return SDO_OK;
}

uint32_t device_value(struct device *self, uint16_t index, uint8_t sub)
{
    uint32_t value = 0;
    const sdo_abort_t code = device_read(self, index, sub, &value);

    ck_assert_msg(code == SDO_OK, "%04X:%02X: %08X", index, sub, code);
    return value;
}

static void expect_frame(struct device *self, const char *name, const struct talk_step *step)
{
    co_us_t at = 0;
    const char *frame = device_next_frame(self, &at);

    ck_assert_msg(strcmp(frame, step->text) == 0, "%s, %u ms: expected %s, got %s", name,
                  (unsigned)step->at, step->text, frame);
    ck_assert_msg(at == CO_MS(step->at), "%s, %u ms: %s came at %u us", name, (unsigned)step->at,
                  step->text, (unsigned)at);
}

static void expect_event(struct device *self, const char *name, const struct talk_step *step)
{
    const char *event = device_next_event(self);

    ck_assert_msg(strcmp(event, step->text) == 0, "%s, %u ms: expected '%s', got '%s'", name,
                  (unsigned)step->at, step->text, event);
}

static void expect_quiet(struct device *self, const char *name, co_us_t at)
{
    const char *frame = device_next_frame(self, NULL);

    ck_assert_msg(frame[0] == '\0', "%s, %u ms: unexpected %s", name, (unsigned)at, frame);
}

void device_talk(struct device *self, const struct device_talk *talk)
{
    const struct talk_step *step = talk->steps;

    for (; step < talk->steps + DEVICE_STEPS && step->text != NULL; step++) {
        device_run(self, CO_MS(step->at));
        switch (step->kind) {
        case HEARS:
            expect_quiet(self, talk->name, step->at);
            device_hear(self, step->text);
            device_drain(self);
            break;
        case SENDS: expect_frame(self, talk->name, step); break;
        case TELLS: expect_event(self, talk->name, step); break;
        case QUIET: expect_quiet(self, talk->name, step->at); break;
        }
    }
    expect_quiet(self, talk->name, self->now / 1000);
}

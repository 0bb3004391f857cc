#include "support/device.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "support/hex.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
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

/* Nothing happens before the deadline. */
static void call_too_early(struct device *self, co_us_t now)
{
    const unsigned frames = self->frame_count, events = self->event_count;

    self->now = now;
    slave_on_time(&self->slave, self->now, &self->out);
    device_drain(self);
    ck_assert_msg(self->frame_count == frames && self->event_count == events,
                  "too early at %llu us", (unsigned long long)now);
}

void device_run(struct device *self, co_us_t until)
{
    device_drain(self);
    for (unsigned calls = 0; slave_deadline(&self->slave) <= until; calls++) {
        const co_us_t deadline = slave_deadline(&self->slave);

        ck_assert_uint_lt(calls, SPIN_LIMIT);
        if (deadline > self->now + 1)
            call_too_early(self, deadline - 1);
        if (deadline > self->now)
            self->now = deadline;
        slave_on_time(&self->slave, self->now, &self->out);
        device_drain(self);
    }
    self->now = until;
}

static void hear(struct device *self, const char *text, uint8_t flags)
{
    struct co_frame frame;

    ck_assert_msg(co_frame_parse(text, &frame), "no frame: %s", text);
    frame.flags |= flags;
    if (self->stalled && frame.id != 0x600 + DEVICE_NODE)
        device_fill(self, 0, 0);
    slave_on_frame(&self->slave, &frame, self->now, &self->out);
}

void device_hear(struct device *self, const char *text)
{
    hear(self, text, 0);
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

static bool describe_service(const struct co_event *event, char *text, size_t size)
{
    switch (event->type) {
    case SLAVE_STATE: snprintf(text, size, "state %u", event->detail); break;
    case SLAVE_WRITTEN:
        snprintf(text, size, "written %04X:%02X = %llu", event->index, event->sub,
                 (unsigned long long)event->actual);
        break;
    case SLAVE_EMERGENCY: snprintf(text, size, "emcy %04X %02X", event->code, event->detail); break;
    case SLAVE_VERDICT:
        size -= (size_t)snprintf(text, size, "verdict %u on %04X:%02X, %u bytes", event->code,
                                 event->index, event->sub, (unsigned)event->actual);
        if (event->detail != 0)
            snprintf(text + strlen(text), size, ", channel %u", event->detail);
        break;
    case SLAVE_FETCH:
        snprintf(text, size, "fetch %u of %04X:%02X, channel %u", event->code, event->index,
                 event->sub, event->detail);
        break;
    case SLAVE_VERDICT_LATE:
        snprintf(text, size, "no verdict on %04X:%02X", event->index, event->sub);
        break;
    case PROTO_HB_STATE: snprintf(text, size, "heard %u: %u", event->node, event->detail); break;
    default: return false;
    }
    return true;
}

static const char *const watching[] = { [WATCH_BEGINS] = "begins",
                                        [WATCH_ENDS] = "ends",
                                        [WATCH_BOOT_UP] = "boots",
                                        [WATCH_TIMEOUT] = "lost" };

static bool describe_supervision(const struct co_event *event, char *text, size_t size)
{
    char data[20];

    switch (event->type) {
    case SLAVE_WATCH:
        if (event->detail == WATCH_TIMEOUT)
            snprintf(text, size, "lost %u: %u", event->node, event->sub);
        else
            snprintf(text, size, "watch %u %s", event->node, watching[event->detail]);
        break;
    case SLAVE_GUARDING: snprintf(text, size, "guarding %s", watching[event->detail]); break;
    case SLAVE_EMCY_HEARD:
        hex_format(event->data, 8, data, sizeof data);
        snprintf(text, size, "1028:%02X hears %X, node %u: %s", event->index, event->code,
                 event->detail, data);
        break;
    case SLAVE_EMCY_LOST: snprintf(text, size, "emcy lost %u", (unsigned)event->actual); break;
    default: return false;
    }
    return true;
}

static bool describe_pdo(const struct co_event *event, char *text, size_t size)
{
    char data[20];

    switch (event->type) {
    case SLAVE_RPDO:
        hex_format(event->data, event->sub, data, sizeof data);
        snprintf(text, size, "rpdo %u %s at %u", event->index, data,
                 (unsigned)(event->actual / 1000));
        break;
    case SLAVE_TPDO_WANTED: snprintf(text, size, "wanted %u %u", event->index, event->code); break;
    case SLAVE_TPDO_CONFIRMED: snprintf(text, size, "confirmed %u", event->index); break;
    case SLAVE_PDO_ERROR:
        snprintf(text, size, "rpdo %u wrong %04X, %u of %u", event->index, event->code,
                 event->detail, event->sub);
        break;
    case SLAVE_SYNC_LENGTH:
        snprintf(text, size, "sync wrong %04X, %u of %u", event->code, event->detail, event->sub);
        break;
    case SLAVE_SYNC_MISSING: snprintf(text, size, "sync missing"); break;
    case SLAVE_TIME: snprintf(text, size, "time %u %u", event->code, event->index); break;
    default: return false;
    }
    return true;
}

const char *device_next_event(struct device *self)
{
    static char text[64];
    const struct co_event *event;

    if (self->event_taken == self->event_count)
        return "";
    event = &self->events[self->event_taken++];
    if (!describe_service(event, text, sizeof text) && !describe_pdo(event, text, sizeof text) &&
        !describe_supervision(event, text, sizeof text))
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

static void set_value(struct device *self, unsigned index, unsigned sub, uint32_t value)
{
    struct od_entry *entry = od_find(&self->od, (uint16_t)index, (uint8_t)sub);

    ck_assert_ptr_nonnull(entry);
    put_le(entry->value, entry->size, value);
}

/* The application is to be asked; mappings learn of it with the next reset. */
static void watch(struct device *self, unsigned index, unsigned sub)
{
    struct od_entry *entry = od_find(&self->od, (uint16_t)index, (uint8_t)sub);

    ck_assert_ptr_nonnull(entry);
    entry->watched = true;
    for (uint16_t number = 1; number <= SLAVE_PDO_NUMBER_MAX; number++) {
        struct tpdo *tpdo = slave_tpdo(&self->slave, number);

        if (tpdo != NULL && pdo_map_contains(&tpdo->map, entry))
            tpdo->asks = true;
    }
}

/* A value of so many bytes: 'A' to 'Z', again and again. */
static void give(struct device *self, struct slave_transfer transfer, unsigned size)
{
    struct slave_value value = { .size = size };
    uint8_t *bytes = malloc(size + 1u);

    ck_assert_ptr_nonnull(bytes);
    for (unsigned i = 0; i < size; i++)
        bytes[i] = (uint8_t)('A' + i % 26);
    value.bytes = bytes;
    slave_give(&self->slave, transfer, &value, self->now, &self->out);
    free(bytes);
}

/* False: the text is something else. */
static bool answer_client(struct device *self, const char *text)
{
    unsigned number = 0, what = 0, channel = 0;
    struct slave_value refusal = { .size = 0 };
    struct slave_transfer transfer;

    if (sscanf(text, "%*s %u %x at %u", &number, &what, &channel) < 2)
        return false;
    transfer = (struct slave_transfer){ (uint8_t)channel, number };
    refusal.code = what;
    if (strncmp(text, "verdict", 7) == 0)
        slave_verdict(&self->slave, transfer, what, self->now, &self->out);
    else if (strncmp(text, "give", 4) == 0)
        give(self, transfer, what);
    else if (strncmp(text, "refuse", 6) == 0)
        slave_give(&self->slave, transfer, &refusal, self->now, &self->out);
    else
        return false;
    return true;
}

static enum slave_bus bus_of(const char *name)
{
    if (strcmp(name, "passive") == 0)
        return SLAVE_BUS_PASSIVE;
    return strcmp(name, "lost") == 0 ? SLAVE_BUS_LOST : SLAVE_BUS_OK;
}

/* What is about errors; false: nothing of that. */
static bool do_errors(struct device *self, const char *text, enum co_err *ret_err)
{
    struct slave *slave = &self->slave;
    struct co_outbox *out = &self->out;
    struct slave_error error = { .field = { 0 } };
    unsigned a = 0, b = 0, c = 0, first = 0, second = 0;
    char name[8];

    *ret_err = CO_OK;
    if (sscanf(text, "raise %x %x %x %2x%2x", &a, &b, &c, &first, &second) == 5) {
        error = (struct slave_error){
            (uint16_t)a, (uint16_t)b, (uint8_t)c, { (uint8_t)first, (uint8_t)second, 3, 4, 5 }
        };
        *ret_err = slave_raise_error(slave, &error, self->now, out);
    } else if (sscanf(text, "clear %x %2x%2x", &a, &first, &second) == 3) {
        error.field[0] = (uint8_t)first;
        error.field[1] = (uint8_t)second;
        *ret_err = slave_clear_error(slave, (uint8_t)a, error.field, self->now, out);
    } else if (sscanf(text, "bus %7s", name) == 1) {
        slave_on_bus(slave, bus_of(name), self->now, out);
    } else if (sscanf(text, "lose %u", &a) == 1) {
        *ret_err = slave_lose_pdos(slave, a, self->now, out);
    } else if (strncmp(text, "taken", 5) == 0) {
        *ret_err = slave_pdos_taken(slave, self->now, out);
    } else if (strncmp(text, "overrun", 7) == 0) {
        slave_on_frames_lost(slave, self->now, out);
    } else {
        return false;
    }
    return true;
}

/* CO_OK for what returns nothing. */
static enum co_err do_call(struct device *self, const char *text)
{
    struct slave *slave = &self->slave;
    struct co_outbox *out = &self->out;
    unsigned a = 0, b = 0, c = 0;
    enum co_err err;

    if (do_errors(self, text, &err))
        return err;
    if (sscanf(text, "send %u", &a) == 1)
        return slave_pdo_send(slave, (uint16_t)a, self->now, out);
    if (sscanf(text, "request %u", &a) == 1)
        return slave_rpdo_request(slave, (uint16_t)a, self->now, out);
    if (sscanf(text, "set %x:%x %x", &a, &b, &c) == 3) {
        set_value(self, a, b, c);
        return slave_entry_changed(slave, od_find(&self->od, (uint16_t)a, (uint8_t)b), self->now,
                                   out);
    }
    if (sscanf(text, "time %u %u", &a, &b) == 2) {
        const struct time_of_day time = { .ms = a, .days = (uint16_t)b };

        return slave_send_time(slave, &time, out);
    }
    if (sscanf(text, "flags r%u %u", &a, &b) == 2)
        slave_pdo_set_flags(slave, PDO_RECEIVE, (uint16_t)a, (uint8_t)b);
    else if (sscanf(text, "flags t%u %u", &a, &b) == 2)
        slave_pdo_set_flags(slave, PDO_TRANSMIT, (uint16_t)a, (uint8_t)b);
    else if (sscanf(text, "answer %u %u", &a, &b) == 2)
        slave_tpdo_answer(slave, (uint16_t)a, b, self->now, out);
    else if (sscanf(text, "watch %x:%x", &a, &b) == 2)
        watch(self, a, b);
    else if (strcmp(text, "hold") == 0 || strcmp(text, "release") == 0)
        slave_hold_transmission(slave, text[0] == 'h', self->now, out);
    else
        ck_assert_msg(answer_client(self, text), "%s?", text);
    return CO_OK;
}

void device_do(struct device *self, const char *text)
{
    const char *result = strstr(text, " -> ");
    int expected = result != NULL ? atoi(result + 4) : CO_OK, err;

    if (self->stalled && strncmp(text, "request", 7) != 0) /* a request is not kept */
        device_fill(self, 0, 0);
    err = do_call(self, text);
    if (self->stalled && err == CO_ERR_AGAIN && expected == CO_OK)
        err = CO_OK;
    ck_assert_msg(err == expected, "%s: returned %d", text, err);
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
        case ECHOES:
            expect_quiet(self, talk->name, step->at);
            hear(self, step->text, step->kind == ECHOES ? CO_FRAME_OWN : 0);
            device_drain(self);
            break;
        case DOES:
            expect_quiet(self, talk->name, step->at);
            device_do(self, step->text);
            device_drain(self);
            break;
        case SENDS: expect_frame(self, talk->name, step); break;
        case TELLS: expect_event(self, talk->name, step); break;
        case QUIET: expect_quiet(self, talk->name, step->at); break;
        }
    }
    expect_quiet(self, talk->name, self->now / 1000);
}

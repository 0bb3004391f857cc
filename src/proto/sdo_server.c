#include "proto/sdo_server.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "proto/sdo_server_internal.h"

#include <string.h>

/* Bits 7..5 of byte 0 in the client's requests. */
enum request {
    REQUEST_DOWNLOAD_SEGMENT,
    REQUEST_DOWNLOAD,
    REQUEST_UPLOAD,
    REQUEST_UPLOAD_SEGMENT,
    REQUEST_ABORT,
    REQUEST_BLOCK_UPLOAD,
    REQUEST_BLOCK_DOWNLOAD,
    REQUEST_UNKNOWN
};

void sdo_server_init(struct sdo_server *self, const struct od *od, uint8_t node, uint8_t *buffer,
                     uint32_t capacity)
{
    *self = (struct sdo_server){ .od = od,
                                 .request_id = node > 0 ? SDO_REQUEST_ID + node : 0,
                                 .response_id = SDO_RESPONSE_ID + node,
                                 .buffer = buffer,
                                 .capacity = capacity,
                                 .block_limit = SDO_BLOCK_MAX,
                                 .deadline = CO_NEVER };
}

void sdo_server_finish(struct sdo_server *self)
{
    self->state = SDO_SERVER_IDLE;
    self->unsent = false;
    self->deadline = CO_NEVER;
}

void sdo_server_set_channel(struct sdo_server *self, uint32_t request_id, uint32_t response_id)
{
    self->request_id = request_id;
    self->response_id = response_id;
    sdo_server_finish(self);
}

void sdo_server_enable(struct sdo_server *self, bool enabled)
{
    self->enabled = enabled;
    if (!enabled)
        sdo_server_finish(self);
}

const uint8_t *sdo_server_value(const struct sdo_server *self)
{
    return self->buffer;
}

void sdo_server_wait(struct sdo_server *self, enum sdo_server_state state, co_us_t now)
{
    self->state = (uint8_t)state;
    self->deadline = now + SDO_SERVER_TIMEOUT;
}

void sdo_server_put(const struct sdo_server *self, const uint8_t data[8], struct co_outbox *out)
{
    struct co_frame frame = co_frame_make(self->response_id, 8);

    memcpy(frame.data, data, sizeof frame.data);
    co_outbox_put_frame(out, &frame);
}

void sdo_server_respond(const struct sdo_server *self, unsigned command, const uint8_t field[4],
                        struct co_outbox *out)
{
    uint8_t data[8] = { (uint8_t)command, 0, 0, self->sub };

    put_le16(data + 1, self->index);
    memcpy(data + 4, field, 4);
    sdo_server_put(self, data, out);
}

void sdo_server_respond_number(const struct sdo_server *self, unsigned command, uint32_t number,
                               struct co_outbox *out)
{
    uint8_t field[4];

    put_le32(field, number);
    sdo_server_respond(self, command, field, out);
}

static void respond_to_segment(struct sdo_server *self, struct co_outbox *out)
{
    const uint8_t data[8] = { self->toggle ? 0x30 : 0x20 };

    sdo_server_put(self, data, out);
    self->toggle = !self->toggle;
}

static void abort_transfer(struct sdo_server *self, sdo_abort_t code, struct co_outbox *out)
{
    sdo_server_respond_number(self, 0x80, code, out);
    sdo_server_finish(self);
}

static void confirm_download(struct sdo_server *self, struct co_outbox *out)
{
    const uint8_t end[8] = { BLOCK_END_ANSWER };

    switch ((enum sdo_server_form)self->form) {
    case SDO_SERVER_EXPEDITED: sdo_server_respond_number(self, 0x60, 0, out); break;
    case SDO_SERVER_SEGMENTED: respond_to_segment(self, out); break;
    case SDO_SERVER_BLOCK: sdo_server_put(self, end, out); break;
    }
    sdo_server_finish(self);
}

/* The value to be read is in the buffer. */
static void answer_upload(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    uint8_t field[4] = { 0 };

    if (sdo_server_uploads_block(self)) {
        sdo_server_begin_block_upload(self, now, out);
        return;
    }
    if (self->size >= 1 && self->size <= 4) {
        memcpy(field, self->buffer, self->size);
        sdo_server_respond(self, 0x43 | (4 - self->size) << 2, field, out);
        sdo_server_finish(self);
        return;
    }
    self->position = 0;
    self->toggle = false;
    sdo_server_respond_number(self, 0x41, self->size, out);
    sdo_server_wait(self, SDO_SERVER_UP_SEGMENT, now);
}

/* The owner has decided. */
static void answer_decided(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    if (self->verdict != SDO_OK)
        abort_transfer(self, self->verdict, out);
    else if (self->state == SDO_SERVER_FETCH)
        answer_upload(self, now, out);
    else
        confirm_download(self, out);
}

/* Goes on with what is due, once there is room for it. */
static void send_unsent(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    if (!co_outbox_room(out, 1, 0))
        return;
    self->unsent = false;
    if (self->state == SDO_SERVER_BLOCK_UP)
        sdo_server_send_segments(self, now, out);
    else
        answer_decided(self, now, out);
}

static bool is_undecided(const struct sdo_server *self, enum sdo_server_state state, co_us_t now)
{
    return self->state == state && !self->unsent && now < self->deadline;
}

void sdo_server_verdict(struct sdo_server *self, sdo_abort_t code, co_us_t now,
                        struct co_outbox *out)
{
    if (!is_undecided(self, SDO_SERVER_VERDICT, now))
        return;
    self->verdict = code;
    self->unsent = true;
    send_unsent(self, now, out);
}

/* The bytes to be read, as they are now: what changes them later does not change the upload. */
static sdo_abort_t take_snapshot(struct sdo_server *self, const uint8_t *bytes, uint32_t size)
{
    if (size > self->capacity)
        return SDO_NO_MEMORY;
    if (size > 0)
        memmove(self->buffer, bytes, size);
    self->size = size;
    return SDO_OK;
}

void sdo_server_give(struct sdo_server *self, sdo_abort_t code, const uint8_t *bytes, uint32_t size,
                     co_us_t now, struct co_outbox *out)
{
    if (!is_undecided(self, SDO_SERVER_FETCH, now))
        return;
    self->verdict = code == SDO_OK ? take_snapshot(self, bytes, size) : code;
    self->unsent = true;
    send_unsent(self, now, out);
}

/* Asks the owner for its verdict on the value in the buffer. */
sdo_abort_t sdo_server_offer_value(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = od_check_write(self->od, self->index, self->sub, &entry);
    struct co_event event = { .type = PROTO_SDO_WRITE, .index = self->index, .sub = self->sub };

    if (code == SDO_OK)
        code = od_check_value(entry, self->buffer, self->size);
    if (code != SDO_OK)
        return code;
    event.actual = self->size;
    event.code = ++self->number;
    co_outbox_put_event(out, &event);
    sdo_server_wait(self, SDO_SERVER_VERDICT, now);
    return SDO_OK;
}

/* Data bytes of an expedited download; without a size in the request it is the object's. */
static uint32_t expedited_size(const struct od_entry *entry, uint8_t command)
{
    uint32_t fixed = od_type_size(entry->type);

    if (command & 0x01)
        return 4u - (command >> 2 & 3u);
    return fixed != 0 && fixed < 4 ? fixed : 4;
}

sdo_abort_t sdo_server_check_room(const struct sdo_server *self, const struct od_entry *entry,
                                  uint32_t size)
{
    sdo_abort_t code = od_check_size(entry, size);

    if (code == SDO_OK && size > self->capacity)
        return SDO_NO_MEMORY;
    return code;
}

static sdo_abort_t on_expedited(struct sdo_server *self, const struct od_entry *entry,
                                const uint8_t *data, co_us_t now, struct co_outbox *out)
{
    const uint32_t size = expedited_size(entry, data[0]);
    sdo_abort_t code = sdo_server_check_room(self, entry, size);

    if (code != SDO_OK)
        return code;
    memcpy(self->buffer, data + 4, size);
    self->size = size;
    self->form = SDO_SERVER_EXPEDITED;
    return sdo_server_offer_value(self, now, out);
}

static sdo_abort_t on_download(struct sdo_server *self, const uint8_t *data, co_us_t now,
                               struct co_outbox *out)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = od_check_write(self->od, self->index, self->sub, &entry);

    if (code != SDO_OK)
        return code;
    if (data[0] & 0x02)
        return on_expedited(self, entry, data, now, out);
    self->announced = data[0] & 0x01 ? get_le32(data + 4) : SDO_SIZE_UNKNOWN;
    if (self->announced != SDO_SIZE_UNKNOWN)
        code = sdo_server_check_room(self, entry, self->announced);
    if (code != SDO_OK)
        return code;
    self->size = 0;
    self->toggle = false;
    self->form = SDO_SERVER_SEGMENTED;
    sdo_server_respond_number(self, 0x60, 0, out);
    sdo_server_wait(self, SDO_SERVER_DOWN_SEGMENT, now);
    return SDO_OK;
}

/* May a segment of so many bytes be added to what has come? */
static sdo_abort_t check_growth(const struct sdo_server *self, uint32_t size)
{
    const struct od_entry *entry = od_find(self->od, self->index, self->sub);

    if (!entry)
        return SDO_NO_OBJECT;
    if (self->size + size > self->announced || self->size + size > entry->capacity)
        return SDO_TOO_LONG;
    if (self->size + size > self->capacity)
        return SDO_NO_MEMORY;
    return SDO_OK;
}

static sdo_abort_t on_download_segment(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                       struct co_outbox *out)
{
    const uint32_t size = 7u - (data[0] >> 1 & 7u);
    sdo_abort_t code;

    if (self->state != SDO_SERVER_DOWN_SEGMENT)
        return SDO_COMMAND;
    if (((data[0] & 0x10) != 0) != self->toggle)
        return SDO_TOGGLE;
    code = check_growth(self, size);
    if (code != SDO_OK)
        return code;
    if (size > 0)
        memcpy(self->buffer + self->size, data + 1, size);
    self->size += size;
    if ((data[0] & 0x01) == 0) {
        respond_to_segment(self, out);
        sdo_server_wait(self, SDO_SERVER_DOWN_SEGMENT, now);
        return SDO_OK;
    }
    if (self->announced != SDO_SIZE_UNKNOWN && self->size < self->announced)
        return SDO_TOO_SHORT;
    return sdo_server_offer_value(self, now, out);
}

/* Asks the owner for the value of an entry that does not have it. */
static void fetch_value(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    const struct co_event event = {
        .type = PROTO_SDO_READ, .index = self->index, .sub = self->sub, .code = ++self->number
    };

    co_outbox_put_event(out, &event);
    sdo_server_wait(self, SDO_SERVER_FETCH, now);
}

sdo_abort_t sdo_server_begin_upload(struct sdo_server *self, const struct od_entry *entry,
                                    co_us_t now, struct co_outbox *out)
{
    sdo_abort_t code;

    if (entry->fetched) {
        fetch_value(self, now, out);
        return SDO_OK;
    }
    code = take_snapshot(self, entry->value, entry->size);
    if (code == SDO_OK)
        answer_upload(self, now, out);
    return code;
}

static sdo_abort_t on_upload(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    struct od_entry *entry = NULL;
    const sdo_abort_t code = od_check_read(self->od, self->index, self->sub, &entry);

    if (code != SDO_OK)
        return code;
    self->form = SDO_SERVER_SEGMENTED;
    return sdo_server_begin_upload(self, entry, now, out);
}

static sdo_abort_t on_upload_segment(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                     struct co_outbox *out)
{
    const uint32_t rest = self->size - self->position;
    const uint32_t size = rest < 7 ? rest : 7;
    uint8_t segment[8] = { 0 };

    if (self->state != SDO_SERVER_UP_SEGMENT)
        return SDO_COMMAND;
    if (((data[0] & 0x10) != 0) != self->toggle)
        return SDO_TOGGLE;
    segment[0] = (uint8_t)((self->toggle ? 0x10u : 0u) | (7 - size) << 1 | (size == rest));
    if (size > 0)
        memcpy(segment + 1, self->buffer + self->position, size);
    sdo_server_put(self, segment, out);
    self->position += size;
    self->toggle = !self->toggle;
    if (size == rest)
        sdo_server_finish(self);
    else
        sdo_server_wait(self, SDO_SERVER_UP_SEGMENT, now);
    return SDO_OK;
}

/* Requests without an object leave that of the last transfer. */
static void take_object(struct sdo_server *self, const uint8_t *data)
{
    self->index = get_le16(data + 1);
    self->sub = data[3];
}

static sdo_abort_t on_initiate(struct sdo_server *self, const uint8_t *data, co_us_t now,
                               struct co_outbox *out)
{
    sdo_server_finish(self);
    take_object(self, data);
    switch ((enum request)(data[0] >> 5)) {
    case REQUEST_DOWNLOAD: return on_download(self, data, now, out);
    case REQUEST_UPLOAD: return on_upload(self, now, out);
    case REQUEST_BLOCK_UPLOAD: return sdo_server_on_block_upload(self, data, now, out);
    case REQUEST_BLOCK_DOWNLOAD: return sdo_server_on_block_download(self, data, now, out);
    case REQUEST_DOWNLOAD_SEGMENT:
    case REQUEST_UPLOAD_SEGMENT:
    case REQUEST_ABORT:
    case REQUEST_UNKNOWN: break;
    }
    return SDO_COMMAND;
}

/* Initiates have their bits 1..0 (upload) or bit 0 (download) clear; the others name no object. */
static sdo_abort_t on_block_request(struct sdo_server *self, const uint8_t *data, co_us_t now,
                                    struct co_outbox *out)
{
    const unsigned mask = data[0] >> 5 == REQUEST_BLOCK_UPLOAD ? 0x03 : 0x01;

    if ((data[0] & mask) != 0)
        return self->block ? sdo_server_on_block_command(self, data, now, out) : SDO_COMMAND;
    if (self->block)
        return on_initiate(self, data, now, out);
    take_object(self, data);
    return SDO_COMMAND;
}

static sdo_abort_t on_request(struct sdo_server *self, const uint8_t *data, co_us_t now,
                              struct co_outbox *out)
{
    if (self->state == SDO_SERVER_BLOCK_DOWN && data[0] != BLOCK_ABORT)
        return sdo_server_on_block_segment(self, data, now, out);
    switch ((enum request)(data[0] >> 5)) {
    case REQUEST_DOWNLOAD_SEGMENT: return on_download_segment(self, data, now, out);
    case REQUEST_UPLOAD_SEGMENT: return on_upload_segment(self, data, now, out);
    case REQUEST_DOWNLOAD:
    case REQUEST_UPLOAD: return on_initiate(self, data, now, out);
    case REQUEST_ABORT: sdo_server_finish(self); return SDO_OK;
    case REQUEST_BLOCK_UPLOAD:
    case REQUEST_BLOCK_DOWNLOAD: return on_block_request(self, data, now, out);
    case REQUEST_UNKNOWN: break;
    }
    if (self->state == SDO_SERVER_IDLE)
        take_object(self, data);
    return SDO_COMMAND;
}

static bool is_request(const struct sdo_server *self, const struct co_frame *frame)
{
    return self->enabled && self->request_id != 0 && frame->id == self->request_id &&
           frame->dlc == 8 && !(frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR));
}

void sdo_server_on_frame(struct sdo_server *self, const struct co_frame *frame, co_us_t now,
                         struct co_outbox *out)
{
    sdo_abort_t code;

    if (!is_request(self, frame))
        return;
    if (!co_outbox_room(out, 1, 1)) {
        self->dropped++;
        return;
    }
    code = on_request(self, frame->data, now, out);
    if (code != SDO_OK)
        abort_transfer(self, code, out);
}

static sdo_abort_t late_code(const struct sdo_server *self)
{
    return self->state == SDO_SERVER_VERDICT || self->state == SDO_SERVER_FETCH ? SDO_NOT_STORED
                                                                                : SDO_TIMEOUT;
}

void sdo_server_on_time(struct sdo_server *self, co_us_t now, struct co_outbox *out)
{
    if (self->unsent)
        send_unsent(self, now, out);
    else if (now < self->deadline || !co_outbox_room(out, 1, 0))
        return;
    else if (self->state == SDO_SERVER_BLOCK_DOWN && self->receiver.heard)
        sdo_server_end_sub_block(self, now, out);
    else
        abort_transfer(self, late_code(self), out);
}

co_us_t sdo_server_deadline(const struct sdo_server *self)
{
    return self->unsent ? 0 : self->deadline;
}

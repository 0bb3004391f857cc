#include "proto/sdo_client.h"

#include "base/bytes.h"
#include "proto/event.h"

#include <assert.h>
#include <string.h>

#define SIZE_UNKNOWN UINT32_MAX

/* Bits 7..5 of byte 0 in the server's answers. */
enum answer {
    ANSWER_UPLOAD_SEGMENT = 0,
    ANSWER_DOWNLOAD_SEGMENT = 1,
    ANSWER_UPLOAD = 2,
    ANSWER_DOWNLOAD = 3,
    ANSWER_ABORT = 4
};

void sdo_client_init(struct sdo_client *self, uint8_t node)
{
    *self = (struct sdo_client){ .node = node, .deadline = CO_NEVER };
}

bool sdo_client_busy(const struct sdo_client *self)
{
    return self->state != SDO_CLIENT_IDLE;
}

static struct co_frame new_frame(const struct sdo_client *self, unsigned command)
{
    struct co_frame frame = co_frame_make(SDO_REQUEST_ID + self->node, 8);

    frame.data[0] = (uint8_t)command;
    return frame;
}

static struct co_frame object_frame(const struct sdo_client *self, unsigned command)
{
    struct co_frame frame = new_frame(self, command);

    put_le16(frame.data + 1, self->transfer.index);
    frame.data[3] = self->transfer.sub;
    return frame;
}

static struct co_frame initiate_frame(const struct sdo_client *self)
{
    const struct sdo_transfer *transfer = &self->transfer;
    struct co_frame frame;

    if (!transfer->download)
        return object_frame(self, 0x40);
    if (transfer->size >= 1 && transfer->size <= 4) {
        frame = object_frame(self, transfer->hide_size ? 0x22 : 0x23 | (4 - transfer->size) << 2);
        memcpy(frame.data + 4, transfer->source, transfer->size);
        return frame;
    }
    frame = object_frame(self, transfer->indicate_size ? 0x21 : 0x20);
    if (transfer->indicate_size)
        put_le32(frame.data + 4, transfer->size);
    return frame;
}

static struct co_frame segment_frame(const struct sdo_client *self)
{
    const unsigned toggle = self->toggle ? 0x10 : 0;
    unsigned last;
    struct co_frame frame;

    if (!self->transfer.download)
        return new_frame(self, 0x60 | toggle);
    last = self->position + self->last_size == self->transfer.size;
    frame = new_frame(self, toggle | (7u - self->last_size) << 1 | last);
    if (self->last_size > 0)
        memcpy(frame.data + 1, self->transfer.source + self->position, self->last_size);
    return frame;
}

/* What was, or is to be, sent last: always the same frame until its answer has come. */
static struct co_frame request_frame(const struct sdo_client *self)
{
    return self->state == SDO_CLIENT_INITIATE ? initiate_frame(self) : segment_frame(self);
}

static void send_unsent(struct sdo_client *self, struct co_outbox *out)
{
    struct co_frame frame;

    if (!self->unsent || !co_outbox_room(out, 1, 0))
        return;
    frame = request_frame(self);
    co_outbox_put_frame(out, &frame);
    self->unsent = false;
}

static void request(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->unsent = true;
    self->on_wire = false;
    self->deadline = now + SDO_SEND_TIMEOUT;
    self->send_limit = now + SDO_SEND_LIMIT;
    send_unsent(self, out);
}

static void request_segment(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    uint32_t rest = self->transfer.size - self->position;

    if (self->transfer.download)
        self->last_size = (uint8_t)(rest < 7 ? rest : 7);
    request(self, now, out);
}

static void tell_end(struct sdo_client *self, struct co_outbox *out)
{
    const struct co_event event = { .type = PROTO_SDO_DONE,
                                    .node = self->node,
                                    .detail = self->outcome,
                                    .index = self->transfer.index,
                                    .sub = self->transfer.sub,
                                    .code = self->code,
                                    .actual = self->actual };
    struct co_frame frame;

    if (!co_outbox_room(out, self->tell_server ? 1 : 0, 1))
        return;
    if (self->tell_server) {
        frame = object_frame(self, 0x80);
        put_le32(frame.data + 4, self->code);
        co_outbox_put_frame(out, &frame);
    }
    co_outbox_put_event(out, &event);
    self->state = SDO_CLIENT_IDLE;
    self->deadline = CO_NEVER;
}

/* The only way out of a transfer. */
static void finish(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
                   struct co_outbox *out)
{
    if (outcome != SDO_OUTCOME_OVERFLOW)
        self->actual = self->position;
    self->outcome = (uint8_t)outcome;
    self->code = code;
    self->unsent = false;
    self->state = SDO_CLIENT_END;
    tell_end(self, out);
}

static void finish_and_tell(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
                            struct co_outbox *out)
{
    self->tell_server = true;
    finish(self, outcome, code, out);
}

static void finish_overflow(struct sdo_client *self, uint32_t needed, struct co_outbox *out)
{
    self->actual = needed == SIZE_UNKNOWN ? 0 : needed;
    finish_and_tell(self, SDO_OUTCOME_OVERFLOW, SDO_NO_MEMORY, out);
}

static void finish_unexpected(struct sdo_client *self, struct co_outbox *out)
{
    finish_and_tell(self, SDO_OUTCOME_PROTOCOL, SDO_COMMAND, out);
}

void sdo_client_start(struct sdo_client *self, const struct sdo_transfer *transfer, co_us_t now,
                      struct co_outbox *out)
{
    assert(self->state == SDO_CLIENT_IDLE);
    self->transfer = *transfer;
    self->state = SDO_CLIENT_INITIATE;
    self->toggle = false;
    self->tell_server = false;
    self->position = 0;
    self->announced = SIZE_UNKNOWN;
    request(self, now, out);
}

bool sdo_client_cancel(struct sdo_client *self, sdo_abort_t code, struct co_outbox *out)
{
    if (self->state == SDO_CLIENT_IDLE || !co_outbox_room(out, 1, 1))
        return false;
    if (self->state == SDO_CLIENT_END) {
        tell_end(self, out);
        return true;
    }
    self->tell_server = self->state == SDO_CLIENT_SEGMENT;
    self->owes_segment |= self->state == SDO_CLIENT_SEGMENT;
    finish(self, SDO_OUTCOME_CANCELLED, code, out);
    return true;
}

static void enter_segments(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->state = SDO_CLIENT_SEGMENT;
    request_segment(self, now, out);
}

static void next_segment(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->toggle = !self->toggle;
    request_segment(self, now, out);
}

static void on_download(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    if (self->transfer.size == 0 || self->transfer.size > 4) {
        enter_segments(self, now, out);
        return;
    }
    self->position = self->transfer.size;
    finish(self, SDO_OUTCOME_OK, SDO_OK, out);
}

static void on_expedited(struct sdo_client *self, const struct co_frame *frame,
                         struct co_outbox *out)
{
    const bool size_known = (frame->data[0] & 0x01) != 0;
    uint32_t size = size_known ? 4u - (frame->data[0] >> 2 & 3u) : 4u;

    if (!size_known && size > self->transfer.size)
        size = self->transfer.size; /* the object is smaller than the field that carries it */
    if (frame->dlc < 4 + size) {
        self->late++;
        return;
    }
    if (size > self->transfer.size) {
        finish_overflow(self, size, out);
        return;
    }
    if (size > 0)
        memcpy(self->transfer.buffer, frame->data + 4, size);
    self->position = size;
    finish(self, SDO_OUTCOME_OK, SDO_OK, out);
}

static void on_upload(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                      struct co_outbox *out)
{
    const bool size_known = (frame->data[0] & 0x01) != 0;

    if (frame->data[0] & 0x02) {
        on_expedited(self, frame, out);
        return;
    }
    if (size_known && frame->dlc < 8) {
        self->late++;
        return;
    }
    if (size_known)
        self->announced = get_le32(frame->data + 4);
    if (size_known && self->announced > self->transfer.size)
        finish_overflow(self, self->announced, out);
    else
        enter_segments(self, now, out);
}

static bool is_same_object(const struct sdo_client *self, const struct co_frame *frame)
{
    return frame->dlc >= 4 && get_le16(frame->data + 1) == self->transfer.index &&
           frame->data[3] == self->transfer.sub;
}

static void on_initiate_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                               struct co_outbox *out)
{
    const unsigned answer = frame->data[0] >> 5;

    if (answer <= ANSWER_DOWNLOAD_SEGMENT ? self->owes_segment : !is_same_object(self, frame)) {
        self->late++;
        return;
    }
    self->owes_segment = false;
    if (answer == ANSWER_DOWNLOAD && self->transfer.download)
        on_download(self, now, out);
    else if (answer == ANSWER_UPLOAD && !self->transfer.download)
        on_upload(self, frame, now, out);
    else
        finish_unexpected(self, out);
}

static bool is_toggle_right(const struct sdo_client *self, const struct co_frame *frame)
{
    return ((frame->data[0] & 0x10) != 0) == self->toggle;
}

static void on_upload_segment(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                              struct co_outbox *out)
{
    const uint32_t size = 7u - (frame->data[0] >> 1 & 7u);
    const bool last = (frame->data[0] & 0x01) != 0;

    if (frame->dlc < 1 + size) {
        self->late++;
        return;
    }
    if (size > self->transfer.size - self->position) {
        finish_overflow(self, self->announced, out);
        return;
    }
    if (size == 0 && !last) { /* a server could go on like this for ever */
        finish_unexpected(self, out);
        return;
    }
    if (size > 0)
        memcpy(self->transfer.buffer + self->position, frame->data + 1, size);
    self->position += size;
    if (self->position > self->announced ||
        (last && self->announced != SIZE_UNKNOWN && self->position != self->announced))
        finish_and_tell(self, SDO_OUTCOME_PROTOCOL, SDO_TYPE_LENGTH, out);
    else if (last)
        finish(self, SDO_OUTCOME_OK, SDO_OK, out);
    else
        next_segment(self, now, out);
}

static void on_download_segment(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->position += self->last_size;
    if (self->position == self->transfer.size)
        finish(self, SDO_OUTCOME_OK, SDO_OK, out);
    else
        next_segment(self, now, out);
}

static void on_segment_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                              struct co_outbox *out)
{
    const unsigned answer = frame->data[0] >> 5;
    const unsigned wanted = self->transfer.download ? ANSWER_DOWNLOAD_SEGMENT
                                                    : ANSWER_UPLOAD_SEGMENT;

    if (answer > ANSWER_DOWNLOAD_SEGMENT && !is_same_object(self, frame))
        self->late++;
    else if (answer != wanted)
        finish_unexpected(self, out);
    else if (!is_toggle_right(self, frame))
        finish_and_tell(self, SDO_OUTCOME_TOGGLE, SDO_TOGGLE, out);
    else if (self->transfer.download)
        on_download_segment(self, now, out);
    else
        on_upload_segment(self, frame, now, out);
}

static void on_abort(struct sdo_client *self, const struct co_frame *frame, struct co_outbox *out)
{
    static const uint8_t no_object[3] = { 0 };

    if (frame->dlc < 8 ||
        (!is_same_object(self, frame) && memcmp(frame->data + 1, no_object, 3) != 0)) {
        self->late++;
        return;
    }
    self->owes_segment = false;
    finish(self, SDO_OUTCOME_ABORTED, get_le32(frame->data + 4), out);
}

static void on_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                      struct co_outbox *out)
{
    if (frame->dlc == 0) {
        self->late++;
        return;
    }
    switch ((enum sdo_client_state)self->state) {
    case SDO_CLIENT_IDLE:
    case SDO_CLIENT_END: self->late++; return;
    case SDO_CLIENT_INITIATE:
    case SDO_CLIENT_SEGMENT: break;
    }
    if (frame->data[0] >> 5 == ANSWER_ABORT)
        on_abort(self, frame, out);
    else if (self->unsent)
        self->late++; /* no answer to what the server cannot have got */
    else if (self->state == SDO_CLIENT_INITIATE)
        on_initiate_answer(self, frame, now, out);
    else
        on_segment_answer(self, frame, now, out);
}

static bool is_awaiting_wire(const struct sdo_client *self)
{
    return (self->state == SDO_CLIENT_INITIATE || self->state == SDO_CLIENT_SEGMENT) &&
           !self->unsent && !self->on_wire;
}

static void on_own(struct sdo_client *self, const struct co_frame *frame, co_us_t now)
{
    struct co_frame sent;

    if (!is_awaiting_wire(self))
        return;
    sent = request_frame(self);
    if (!co_frame_equal(frame, &sent))
        return; /* the abort of the transfer before, for example */
    self->on_wire = true;
    self->deadline = now + self->transfer.timeout;
}

void sdo_client_on_frame(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                         struct co_outbox *out)
{
    if (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR))
        return;
    if (frame->id == SDO_RESPONSE_ID + self->node)
        on_answer(self, frame, now, out);
    else if (frame->id == SDO_REQUEST_ID + self->node && (frame->flags & CO_FRAME_OWN))
        on_own(self, frame, now);
}

void sdo_client_on_progress(struct sdo_client *self, co_us_t now)
{
    if ((self->state == SDO_CLIENT_INITIATE || self->state == SDO_CLIENT_SEGMENT) && !self->on_wire)
        self->deadline = co_earlier(now + SDO_SEND_TIMEOUT, self->send_limit);
}

void sdo_client_on_time(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    switch ((enum sdo_client_state)self->state) {
    case SDO_CLIENT_IDLE: return;
    case SDO_CLIENT_END: tell_end(self, out); return;
    case SDO_CLIENT_INITIATE:
    case SDO_CLIENT_SEGMENT: break;
    }
    if (now < self->deadline) {
        send_unsent(self, out);
        return;
    }
    self->owes_segment |= self->state == SDO_CLIENT_SEGMENT;
    if (self->on_wire)
        finish_and_tell(self, SDO_OUTCOME_NO_ANSWER, SDO_TIMEOUT, out);
    else
        finish(self, SDO_OUTCOME_NOT_SENT, SDO_OK, out);
}

co_us_t sdo_client_deadline(const struct sdo_client *self)
{
    return self->unsent || self->state == SDO_CLIENT_END ? 0 : self->deadline;
}

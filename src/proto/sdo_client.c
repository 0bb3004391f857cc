#include "proto/sdo_client.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "proto/sdo_client_internal.h"

#include <assert.h>
#include <string.h>

#define ABORT 0x80u /* byte 0 */

/* Bits 7..5 of byte 0 in the server's answers. */
enum answer {
    ANSWER_UPLOAD_SEGMENT = 0,
    ANSWER_DOWNLOAD_SEGMENT = 1,
    ANSWER_UPLOAD = 2,
    ANSWER_DOWNLOAD = 3,
    ANSWER_ABORT = 4,
    ANSWER_BLOCK_DOWNLOAD = 5,
    ANSWER_BLOCK_UPLOAD = 6
};

void sdo_client_init(struct sdo_client *self, uint8_t node)
{
    *self = (struct sdo_client){ .node = node, .deadline = CO_NEVER };
}

bool sdo_client_busy(const struct sdo_client *self)
{
    return self->state != SDO_CLIENT_IDLE;
}

static void put_frame(const struct sdo_client *self, const uint8_t data[8], struct co_outbox *out)
{
    struct co_frame frame = co_frame_make(SDO_REQUEST_ID + self->node, 8);

    memcpy(frame.data, data, sizeof frame.data);
    co_outbox_put_frame(out, &frame);
}

static void make_object(const struct sdo_client *self, unsigned command, uint8_t ret_data[8])
{
    memset(ret_data, 0, 8);
    ret_data[0] = (uint8_t)command;
    put_le16(ret_data + 1, self->transfer.index);
    ret_data[3] = self->transfer.sub;
}

static void make_download(const struct sdo_client *self, uint8_t ret_data[8])
{
    const struct sdo_transfer *transfer = &self->transfer;

    if (transfer->size >= 1 && transfer->size <= 4) {
        make_object(self, transfer->hide_size ? 0x22 : 0x23 | (4 - transfer->size) << 2, ret_data);
        memcpy(ret_data + 4, transfer->source, transfer->size);
        return;
    }
    make_object(self, transfer->indicate_size ? 0x21 : 0x20, ret_data);
    if (transfer->indicate_size)
        put_le32(ret_data + 4, transfer->size);
}

static void make_initiate(const struct sdo_client *self, uint8_t ret_data[8])
{
    if (self->in_blocks)
        sdo_client_make_block_initiate(self, ret_data);
    else if (self->transfer.download)
        make_download(self, ret_data);
    else
        make_object(self, 0x40, ret_data);
}

void sdo_client_begin_request(struct sdo_client *self, co_us_t now)
{
    self->unsent = true;
    self->on_wire = false;
    self->deadline = now + SDO_SEND_TIMEOUT;
    self->send_limit = now + SDO_SEND_LIMIT;
}

static void send_unsent(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    if (!self->unsent || !co_outbox_room(out, 1, 0))
        return;
    if (self->state == SDO_CLIENT_BLOCK_DOWN) {
        sdo_client_send_segments(self, now, out);
        return;
    }
    put_frame(self, self->request, out);
    self->unsent = false;
}

void sdo_client_request(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    sdo_client_begin_request(self, now);
    send_unsent(self, now, out);
}

static void request_initiate(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    make_initiate(self, self->request);
    sdo_client_request(self, now, out);
}

static void make_download_segment(struct sdo_client *self, uint8_t ret_data[8])
{
    const uint32_t rest = self->transfer.size - self->position;
    const uint32_t size = rest < SDO_SEGMENT_SIZE ? rest : SDO_SEGMENT_SIZE;

    ret_data[0] |= (uint8_t)((SDO_SEGMENT_SIZE - size) << 1 | (size == rest));
    if (size > 0)
        memcpy(ret_data + 1, self->transfer.source + self->position, size);
    self->last_size = (uint8_t)size;
}

static void request_segment(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    memset(self->request, 0, sizeof self->request);
    self->request[0] = self->toggle ? 0x10 : 0;
    if (self->transfer.download)
        make_download_segment(self, self->request);
    else
        self->request[0] |= 0x60;
    sdo_client_request(self, now, out);
}

/* The server has shown in this transfer that it has no blocks. */
static bool has_no_blocks(const struct sdo_client *self)
{
    return self->refusal == SDO_COMMAND ||
           (self->refusal != SDO_OK && self->outcome == SDO_OUTCOME_OK);
}

static void tell_end(struct sdo_client *self, struct co_outbox *out)
{
    const struct co_event event = { .type = PROTO_SDO_DONE,
                                    .node = self->node,
                                    .detail = self->outcome,
                                    .index = self->transfer.index,
                                    .sub = self->transfer.sub,
                                    .code = self->code,
                                    .expected = has_no_blocks(self),
                                    .actual = self->actual };
    uint8_t data[8] = { self->farewell };

    if (!co_outbox_room(out, self->farewell ? 1 : 0, 1))
        return;
    if (self->farewell == ABORT) {
        make_object(self, ABORT, data);
        put_le32(data + 4, self->code);
    }
    if (self->farewell)
        put_frame(self, data, out);
    co_outbox_put_event(out, &event);
    self->state = SDO_CLIENT_IDLE;
    self->deadline = CO_NEVER;
}

void sdo_client_finish(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
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

void sdo_client_finish_and_tell(struct sdo_client *self, enum sdo_outcome outcome, sdo_abort_t code,
                                struct co_outbox *out)
{
    self->owes_segment |= self->state == SDO_CLIENT_BLOCK_UP;
    self->farewell = ABORT;
    sdo_client_finish(self, outcome, code, out);
}

void sdo_client_finish_overflow(struct sdo_client *self, uint32_t needed, struct co_outbox *out)
{
    self->actual = needed == SDO_SIZE_UNKNOWN ? 0 : needed;
    sdo_client_finish_and_tell(self, SDO_OUTCOME_OVERFLOW, SDO_NO_MEMORY, out);
}

void sdo_client_finish_unexpected(struct sdo_client *self, struct co_outbox *out)
{
    sdo_client_finish_and_tell(self, SDO_OUTCOME_PROTOCOL, SDO_COMMAND, out);
}

void sdo_client_start(struct sdo_client *self, const struct sdo_transfer *transfer, co_us_t now,
                      struct co_outbox *out)
{
    assert(self->state == SDO_CLIENT_IDLE);
    self->transfer = *transfer;
    self->state = SDO_CLIENT_INITIATE;
    self->in_blocks = transfer->block > 0;
    self->refusal = SDO_OK;
    self->toggle = false;
    self->farewell = 0;
    self->position = 0;
    self->announced = SDO_SIZE_UNKNOWN;
    request_initiate(self, now, out);
}

static unsigned wanted_answer(const struct sdo_client *self)
{
    if (self->in_blocks)
        return self->transfer.download ? ANSWER_BLOCK_DOWNLOAD : ANSWER_BLOCK_UPLOAD;
    return self->transfer.download ? ANSWER_DOWNLOAD : ANSWER_UPLOAD;
}

/* The answer may come all the same. */
static void give_up(struct sdo_client *self)
{
    if (self->state == SDO_CLIENT_INITIATE)
        self->owed_answers |= (uint8_t)(1u << wanted_answer(self));
    else
        self->owes_segment = true;
}

/* A transfer before has not waited for one of this kind, maybe for the same object. */
static bool is_owed(const struct sdo_client *self, unsigned answer)
{
    return (self->owed_answers >> answer & 1u) != 0;
}

/* A server that has heard of a block download takes all but an abort for its segments. */
static bool is_server_free(const struct sdo_client *self)
{
    return self->state == SDO_CLIENT_INITIATE && !(self->in_blocks && self->transfer.download);
}

bool sdo_client_cancel(struct sdo_client *self, sdo_abort_t code, struct co_outbox *out)
{
    if (self->state == SDO_CLIENT_IDLE || !co_outbox_room(out, 1, 1))
        return false;
    if (self->state == SDO_CLIENT_END) {
        tell_end(self, out);
        return true;
    }
    self->farewell = is_server_free(self) ? 0 : ABORT;
    give_up(self);
    sdo_client_finish(self, SDO_OUTCOME_CANCELLED, code, out);
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
    sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
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
        sdo_client_finish_overflow(self, size, out);
        return;
    }
    if (size > 0)
        memcpy(self->transfer.buffer, frame->data + 4, size);
    self->position = size;
    sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
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
        sdo_client_finish_overflow(self, self->announced, out);
    else
        enter_segments(self, now, out);
}

static bool is_same_object(const struct sdo_client *self, const struct co_frame *frame)
{
    return frame->dlc >= 4 && get_le16(frame->data + 1) == self->transfer.index &&
           frame->data[3] == self->transfer.sub;
}

/* Answers to initiates do, and aborts; those within a transfer do not. */
static bool names_object(uint8_t command)
{
    switch (command >> 5) {
    case ANSWER_UPLOAD_SEGMENT:
    case ANSWER_DOWNLOAD_SEGMENT: return false;
    case ANSWER_BLOCK_DOWNLOAD: return (command & 0x03) == 0;
    case ANSWER_BLOCK_UPLOAD: return (command & 0x01) == 0;
    default: return true;
    }
}

static void on_initiate_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                               struct co_outbox *out)
{
    const unsigned answer = frame->data[0] >> 5;

    if (names_object(frame->data[0]) ? !is_same_object(self, frame) : self->owes_segment) {
        self->late++;
        return;
    }
    self->owes_segment = false;
    if (answer == ANSWER_UPLOAD && !self->transfer.download) /* in blocks, too, for few bytes */
        on_upload(self, frame, now, out);
    else if (answer != wanted_answer(self) && is_owed(self, answer))
        self->late++;
    else if (answer != wanted_answer(self))
        sdo_client_finish_unexpected(self, out);
    else if (answer == ANSWER_DOWNLOAD)
        on_download(self, now, out);
    else if (answer == ANSWER_BLOCK_DOWNLOAD)
        sdo_client_on_block_download(self, frame, now, out);
    else
        sdo_client_on_block_upload(self, frame, now, out);
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
        sdo_client_finish_overflow(self, self->announced, out);
        return;
    }
    if (size == 0 && !last) { /* a server could go on like this for ever */
        sdo_client_finish_unexpected(self, out);
        return;
    }
    if (size > 0)
        memcpy(self->transfer.buffer + self->position, frame->data + 1, size);
    self->position += size;
    if (self->position > self->announced ||
        (last && self->announced != SDO_SIZE_UNKNOWN && self->position != self->announced))
        sdo_client_finish_and_tell(self, SDO_OUTCOME_PROTOCOL, SDO_TYPE_LENGTH, out);
    else if (last)
        sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
    else
        next_segment(self, now, out);
}

static void on_download_segment(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    self->position += self->last_size;
    if (self->position == self->transfer.size)
        sdo_client_finish(self, SDO_OUTCOME_OK, SDO_OK, out);
    else
        next_segment(self, now, out);
}

static void on_segment_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                              struct co_outbox *out)
{
    const unsigned answer = frame->data[0] >> 5;
    const unsigned wanted = self->transfer.download ? ANSWER_DOWNLOAD_SEGMENT
                                                    : ANSWER_UPLOAD_SEGMENT;

    if (answer > ANSWER_DOWNLOAD_SEGMENT && (!is_same_object(self, frame) || is_owed(self, answer)))
        self->late++;
    else if (answer != wanted)
        sdo_client_finish_unexpected(self, out);
    else if (!is_toggle_right(self, frame))
        sdo_client_finish_and_tell(self, SDO_OUTCOME_TOGGLE, SDO_TOGGLE, out);
    else if (self->transfer.download)
        on_download_segment(self, now, out);
    else
        on_upload_segment(self, frame, now, out);
}

/* Reasons that may have to do with blocks: without them the server gives one that has not. */
static bool may_refuse_blocks(sdo_abort_t code)
{
    return code == SDO_COMMAND || code == SDO_BLOCK_SIZE || code == SDO_ACCESS ||
           code == SDO_GENERAL;
}

static void on_abort(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    static const uint8_t no_object[3] = { 0 };
    sdo_abort_t code;

    if (frame->dlc < 8 ||
        (!is_same_object(self, frame) && memcmp(frame->data + 1, no_object, 3) != 0)) {
        self->late++;
        return;
    }
    self->owes_segment = false;
    code = get_le32(frame->data + 4);
    if (self->state == SDO_CLIENT_INITIATE && self->in_blocks && may_refuse_blocks(code)) {
        self->in_blocks = false;
        self->refusal = code;
        request_initiate(self, now, out);
        return;
    }
    sdo_client_finish(self, SDO_OUTCOME_ABORTED, code, out);
}

/* A segment of a block may look like an abort but for its number. */
static bool is_abort(const struct sdo_client *self, const struct co_frame *frame)
{
    if (self->state == SDO_CLIENT_BLOCK_UP || self->owes_segment)
        return frame->data[0] == ABORT;
    return frame->data[0] >> 5 == ANSWER_ABORT;
}

/* What was asked for the server cannot have got, or nothing was. */
static bool is_no_answer(const struct sdo_client *self, const struct co_frame *frame)
{
    if (frame->dlc == 0 || self->state == SDO_CLIENT_IDLE || self->state == SDO_CLIENT_END)
        return true;
    return self->unsent && self->state != SDO_CLIENT_BLOCK_DOWN && !is_abort(self, frame);
}

static void on_answer(struct sdo_client *self, const struct co_frame *frame, co_us_t now,
                      struct co_outbox *out)
{
    if (is_no_answer(self, frame))
        self->late++;
    else if (is_abort(self, frame))
        on_abort(self, frame, now, out);
    else if (self->state == SDO_CLIENT_INITIATE)
        on_initiate_answer(self, frame, now, out);
    else if (self->state == SDO_CLIENT_SEGMENT)
        on_segment_answer(self, frame, now, out);
    else
        sdo_client_on_block_answer(self, frame, now, out);
}

/* A transfer runs, and its last request has not been confirmed. */
static bool is_unconfirmed(const struct sdo_client *self)
{
    return self->state != SDO_CLIENT_IDLE && self->state != SDO_CLIENT_END && !self->on_wire;
}

bool sdo_client_awaits_wire(const struct sdo_client *self)
{
    return is_unconfirmed(self) && !self->unsent;
}

static void on_own(struct sdo_client *self, const struct co_frame *frame, co_us_t now)
{
    if (!sdo_client_awaits_wire(self) || frame->dlc != sizeof self->request ||
        memcmp(frame->data, self->request, sizeof self->request) != 0)
        return; /* the abort of the transfer before, for example */
    self->on_wire = true;
    self->deadline = now + self->transfer.timeout;
}

void sdo_client_on_handed_over(struct sdo_client *self, co_us_t now)
{
    const unsigned segments = self->state == SDO_CLIENT_BLOCK_DOWN ? self->sender.sent : 0;

    if (!sdo_client_awaits_wire(self))
        return;
    self->on_wire = true;
    self->deadline = now + self->transfer.timeout + segments * SDO_SEGMENT_TIME;
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

void sdo_client_on_progress(struct sdo_client *self, co_us_t when)
{
    co_us_t deadline = co_earlier(when + SDO_SEND_TIMEOUT, self->send_limit);

    if (is_unconfirmed(self) && deadline > self->deadline)
        self->deadline = deadline;
}

static void on_deadline(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    if (self->state == SDO_CLIENT_BLOCK_UP && self->receiver.heard) {
        sdo_client_end_sub_block(self, now, out);
        return;
    }
    give_up(self);
    if (self->on_wire)
        sdo_client_finish_and_tell(self, SDO_OUTCOME_NO_ANSWER, SDO_TIMEOUT, out);
    else
        sdo_client_finish(self, SDO_OUTCOME_NOT_SENT, SDO_OK, out);
}

void sdo_client_on_time(struct sdo_client *self, co_us_t now, struct co_outbox *out)
{
    if (self->state == SDO_CLIENT_IDLE)
        return;
    if (self->state == SDO_CLIENT_END)
        tell_end(self, out);
    else if (now >= self->deadline)
        on_deadline(self, now, out);
    else
        send_unsent(self, now, out);
}

co_us_t sdo_client_deadline(const struct sdo_client *self)
{
    return self->unsent || self->state == SDO_CLIENT_END ? 0 : self->deadline;
}

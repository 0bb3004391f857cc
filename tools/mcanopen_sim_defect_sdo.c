/* Defects of the SDO server: expedited and segmented transfers. */
#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/nmt.h"
#include "proto/sdo_client.h"

#define TOGGLE 0x10u

static bool is_request(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, SDO_REQUEST_ID) && frame->dlc == 8 &&
           !gate_view(gate)->block_segment;
}

static bool is_response(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, SDO_RESPONSE_ID) && frame->dlc == 8;
}

static bool is_abort(const struct sim_gate *gate, const struct co_frame *frame, uint32_t code)
{
    return is_response(gate, frame) && frame->data[0] == 0x80 &&
           (code == SDO_OK || get_le32(frame->data + 4) == code);
}

static bool answers_segment(const struct sim_gate *gate, const struct co_frame *frame)
{
    const struct sim_device_view *view = gate_view(gate);
    const unsigned ccs = view->request.data[0] >> 5;

    return is_response(gate, frame) && !view->block_segment && (ccs == 0 || ccs == 3) &&
           frame->data[0] >> 5 < 2;
}

static bool keep_upload_toggle(struct sim_gate *gate, struct defect_use *use,
                               struct co_frame *frame)
{
    (void)use;
    if (answers_segment(gate, frame) && frame->data[0] >> 5 == 0)
        frame->data[0] &= (uint8_t)~TOGGLE;
    return true;
}

static bool keep_download_toggle(struct sim_gate *gate, struct defect_use *use,
                                 struct co_frame *frame)
{
    (void)use;
    if (answers_segment(gate, frame) && frame->data[0] >> 5 == 1)
        frame->data[0] &= (uint8_t)~TOGGLE;
    return true;
}

/* The server gets the toggle bit that it expects ... */
static bool mend_toggle(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const unsigned ccs = frame->data[0] >> 5;

    if (!is_request(gate, frame))
        return true;
    if (ccs == 1 || ccs == 2)
        use->on = false;
    if (ccs != 0 && ccs != 3)
        return true;
    use->value = frame->data[0] & TOGGLE;
    frame->data[0] = (uint8_t)((frame->data[0] & ~TOGGLE) | (use->on ? TOGGLE : 0));
    use->on = !use->on;
    return true;
}

/* ... and the client the one that it sent. */
static bool return_toggle(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (answers_segment(gate, frame))
        frame->data[0] = (uint8_t)((frame->data[0] & ~TOGGLE) | use->value);
    return true;
}

static bool alter_abort_code(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (is_abort(gate, frame, use->defect->codes[0]))
        put_le32(frame->data + 4, use->defect->number);
    return true;
}

static bool alter_abort_object(struct sim_gate *gate, struct defect_use *use,
                               struct co_frame *frame)
{
    (void)use;
    if (is_abort(gate, frame, SDO_OK) && gate_view(gate)->request.data[0] == 0x40)
        put_le16(frame->data + 1, (uint16_t)(get_le16(frame->data + 1) ^ 0x0100));
    return true;
}

static bool lengthen_request(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (defect_is_from(gate, frame, SDO_REQUEST_ID))
        frame->dlc = 8;
    return true;
}

static bool lose_unknown(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    return !is_request(gate, frame) || frame->data[0] >> 5 != 7;
}

static bool answer_abort(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    struct co_frame answer;

    (void)use;
    if (is_request(gate, frame) && frame->data[0] == 0x80) {
        answer = defect_answer(gate, 0x80);
        put_le32(answer.data + 4, SDO_COMMAND);
        gate_to_bus(gate, &answer);
    }
    return true;
}

/* A transfer that the client has aborted goes on. */
static bool lose_abort(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    return !is_request(gate, frame) || frame->data[0] != 0x80;
}

static bool alter_size(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_response(gate, frame) && gate_view(gate)->request.data[0] == 0x40 &&
        frame->data[0] == 0x41)
        put_le32(frame->data + 4, get_le32(frame->data + 4) + 1);
    return true;
}

/* "Stop" does not reach the device: it is pre-operational, so that its server answers ... */
static bool hide_stop(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const uint8_t node = gate_view(gate)->node;
    enum nmt_command command;

    if (frame->id != NMT_CAN_ID || !nmt_command_for(frame, node, &command))
        return true;
    use->on = command == NMT_STOP;
    if (use->on)
        *frame = nmt_command_frame(NMT_ENTER_PREOPERATIONAL, node);
    return true;
}

/* ... and nothing else tells. */
static bool look_stopped(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (!use->on)
        return true;
    if (defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID))
        frame->data[0] = (uint8_t)((frame->data[0] & 0x80) | NMT_STOPPED);
    return defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID) || is_response(gate, frame);
}

const struct sim_defect sim_defects_sdo[] = {
    { .name = "sdo-upload-toggle",
      .family = "sdo",
      .from_device = keep_upload_toggle,
      .text = "the toggle bit of uploaded segments is always 0" },
    { .name = "sdo-download-toggle",
      .family = "sdo",
      .from_device = keep_download_toggle,
      .text = "the toggle bit of confirmed segments is always 0" },
    { .name = "sdo-toggle-unchecked",
      .family = "sdo",
      .from_device = return_toggle,
      .to_device = mend_toggle,
      .text = "wrong toggle bits of the client are accepted" },
    { .name = "sdo-abort-code",
      .family = "sdo",
      .from_device = alter_abort_code,
      .codes = { SDO_NO_OBJECT },
      .number = SDO_LOCAL_CONTROL,
      .text = "a missing object is refused with 08000021h" },
    { .name = "sdo-abort-sub",
      .family = "sdo",
      .from_device = alter_abort_code,
      .codes = { SDO_NO_SUB },
      .number = SDO_NO_OBJECT,
      .text = "a missing sub-index is refused with 06020000h" },
    { .name = "sdo-abort-object",
      .family = "sdo",
      .from_device = alter_abort_object,
      .text = "refused uploads name another object" },
    { .name = "sdo-short-answered",
      .family = "sdo",
      .to_device = lengthen_request,
      .text = "requests with less than 8 bytes are answered" },
    { .name = "sdo-unknown-silent",
      .family = "sdo",
      .to_device = lose_unknown,
      .text = "an unknown command is not answered" },
    { .name = "sdo-abort-answered",
      .family = "sdo",
      .to_device = answer_abort,
      .text = "an abort of the client is answered" },
    { .name = "sdo-abort-ignored",
      .family = "sdo",
      .to_device = lose_abort,
      .text = "an abort of the client does not end the transfer" },
    { .name = "sdo-size",
      .family = "sdo",
      .from_device = alter_size,
      .text = "segmented uploads announce a byte too much" },
    { .name = "sdo-length-unchecked",
      .family = "sdo",
      .from_device = defect_confirm_refused,
      .codes = { SDO_TYPE_LENGTH, SDO_TOO_LONG, SDO_TOO_SHORT },
      .text = "writes of a wrong length are confirmed" },
    { .name = "sdo-limits-unchecked",
      .family = "sdo",
      .from_device = defect_confirm_refused,
      .first = 0x1003,
      .last = 0x1003,
      .sub = 0,
      .codes = { SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_VALUE_LOW },
      .text = "bad values for 1003h are confirmed" },
    { .name = "sdo-parameter",
      .family = "sdo",
      .from_device = defect_alter_value,
      .first = 0x1200,
      .last = 0x1200,
      .sub = 1,
      .number = 1,
      .text = "1200h:01 has a wrong COB-ID" },
    { .name = "sdo-stopped",
      .family = "sdo",
      .from_device = look_stopped,
      .to_device = hide_stop,
      .text = "requests are answered in Stopped" },
    { .name = NULL },
};

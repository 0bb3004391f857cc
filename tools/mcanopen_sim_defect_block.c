/* Defects of the SDO server: block transfers. */
#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/sdo_client.h"

static bool is_response(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, SDO_RESPONSE_ID) && frame->dlc == 8;
}

static bool is_block_upload(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, SDO_REQUEST_ID) && frame->dlc == 8 &&
           frame->data[0] >> 5 == 5;
}

static bool is_begin(const struct co_frame *request)
{
    return (request->data[0] & 0xE3) == 0xA0;
}

static bool is_acknowledge(const struct co_frame *request)
{
    return request->data[0] == 0xA2;
}

/* Ends and last segments may look alike: an end comes when the segments are acknowledged. */
static bool alter_crc(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_response(gate, frame) && is_acknowledge(&gate_view(gate)->request) &&
        (frame->data[0] & 0xE3) == 0xC1)
        put_le16(frame->data + 1, get_le16(frame->data + 1) ^ 0x5555);
    return true;
}

static bool confirm_crc(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_response(gate, frame) && frame->data[0] == 0x80 &&
        get_le32(frame->data + 4) == SDO_BLOCK_CRC) {
        *frame = co_frame_make(frame->id, 8);
        frame->data[0] = 0xA1;
    }
    return true;
}

/* The segments of a sub-block that are on their way to the client ... */
static bool count_segments(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const struct co_frame *request = &gate_view(gate)->request;

    if (is_response(gate, frame) && (request->data[0] == 0xA3 || is_acknowledge(request)) &&
        (frame->data[0] & 0x7F) == use->count + 1)
        use->count++;
    return true;
}

/* ... have all arrived, whatever it says. */
static bool acknowledge_all(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (!is_block_upload(gate, frame))
        return true;
    if (is_acknowledge(frame) && frame->data[1] < use->count)
        frame->data[1] = (uint8_t)use->count;
    use->count = 0;
    return true;
}

static bool keep_block_size(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (!is_block_upload(gate, frame))
        return true;
    if (is_begin(frame))
        use->value = frame->data[4];
    else if (is_acknowledge(frame))
        frame->data[2] = (uint8_t)use->value;
    return true;
}

static bool limit_block_size(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_block_upload(gate, frame) && is_begin(frame) &&
        (frame->data[4] == 0 || frame->data[4] > 127))
        frame->data[4] = 127;
    return true;
}

/* What has arrived of a download is acknowledged with the last number, gaps or not. */
static bool hide_gap(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_response(gate, frame) && gate_view(gate)->block_segment && is_acknowledge(frame))
        frame->data[1] = gate_view(gate)->block_seqno;
    return true;
}

static bool confirm_length(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const uint32_t code = get_le32(frame->data + 4);

    (void)use;
    if (is_response(gate, frame) && frame->data[0] == 0x80 &&
        (gate_view(gate)->request.data[0] & 0xE3) == 0xC1 &&
        (code == SDO_TYPE_LENGTH || code == SDO_TOO_LONG || code == SDO_TOO_SHORT)) {
        *frame = co_frame_make(frame->id, 8);
        frame->data[0] = 0xA1;
    }
    return true;
}

const struct sim_defect sim_defects_block[] = {
    { .name = "block-crc",
      .family = "sdo",
      .from_device = alter_crc,
      .text = "the CRC of block uploads is wrong" },
    { .name = "block-crc-unchecked",
      .family = "sdo",
      .from_device = confirm_crc,
      .text = "a wrong CRC of a block download is accepted" },
    { .name = "block-resend",
      .family = "sdo",
      .from_device = count_segments,
      .to_device = acknowledge_all,
      .text = "segments are not sent again that the client misses" },
    { .name = "block-size",
      .family = "sdo",
      .to_device = keep_block_size,
      .text = "the client's new block size has no effect" },
    { .name = "block-size-unchecked",
      .family = "sdo",
      .to_device = limit_block_size,
      .text = "block uploads begin with a block size of 0 or 128" },
    { .name = "block-gap",
      .family = "sdo",
      .from_device = hide_gap,
      .text = "segments that miss in a download are acknowledged" },
    { .name = "block-length-unchecked",
      .family = "sdo",
      .from_device = confirm_length,
      .text = "a block download of a wrong length is accepted" },
    { .name = NULL },
};

/* Defects of the object dictionary, and of storing it. */
#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/sdo_client.h"

static bool is_upload_abort(const struct sim_gate *gate, const struct co_frame *frame,
                            uint32_t code)
{
    return defect_is_from(gate, frame, SDO_RESPONSE_ID) && frame->data[0] == 0x80 &&
           gate_view(gate)->request.data[0] == 0x40 && get_le32(frame->data + 4) == code;
}

/* Refused with the row's code, an upload has a value all the same. */
static bool answer_refused(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (is_upload_abort(gate, frame, use->defect->codes[0]) && defect_concerns(use->defect, frame))
        *frame = defect_answer(gate, 0x4F);
    return true;
}

static bool hide_object(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (defect_is_from(gate, frame, SDO_RESPONSE_ID) && gate_view(gate)->request.data[0] == 0x40 &&
        defect_concerns(use->defect, frame)) {
        *frame = defect_answer(gate, 0x80);
        put_le32(frame->data + 4, SDO_NO_OBJECT);
    }
    return true;
}

static bool lengthen_value(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (defect_is_value(gate, frame) && defect_concerns(use->defect, frame))
        frame->data[0] = 0x43;
    return true;
}

const struct sim_defect sim_defects_od[] = {
    { .name = "od-identity",
      .family = "eds",
      .from_device = defect_alter_value,
      .first = 0x1018,
      .last = 0x1018,
      .sub = 2,
      .number = 1,
      .text = "the product code differs from the EDS" },
    { .name = "od-mandatory",
      .family = "eds",
      .from_device = hide_object,
      .first = 0x1001,
      .last = 0x1001,
      .sub = DEFECT_ANY_SUB,
      .text = "1001h cannot be read" },
    { .name = "od-type",
      .family = "eds",
      .from_device = defect_alter_value,
      .first = 0x1000,
      .last = 0x1000,
      .sub = 0,
      .number = 1,
      .text = "the device type differs from the EDS" },
    { .name = "od-read-only",
      .family = "od",
      .from_device = defect_confirm_refused,
      .codes = { SDO_READ_ONLY },
      .text = "writes of read-only objects are confirmed" },
    { .name = "od-write-only",
      .family = "od",
      .from_device = answer_refused,
      .codes = { SDO_WRITE_ONLY },
      .text = "write-only objects can be read" },
    { .name = "od-undeclared",
      .family = "od",
      .from_device = answer_refused,
      .first = 0x2000,
      .last = 0xFFFF,
      .sub = DEFECT_ANY_SUB,
      .codes = { SDO_NO_OBJECT },
      .text = "objects that are not in the EDS can be read" },
    { .name = "od-length",
      .family = "od",
      .from_device = lengthen_value,
      .first = 0x1001,
      .last = 0x1001,
      .sub = 0,
      .text = "1001h has 4 bytes" },
    { .name = "od-sub0",
      .family = "od",
      .from_device = defect_alter_value,
      .first = 0x1018,
      .last = 0x1018,
      .sub = 0,
      .number = 7,
      .text = "1018h:00 is not the highest sub-index" },
    { .name = "od-default",
      .family = "od",
      .from_device = defect_alter_value,
      .first = 0x2001,
      .last = 0x2003,
      .sub = 0,
      .number = 1,
      .text = "2001h to 2003h do not have the values of the EDS" },
    { .name = "od-limits",
      .family = "od",
      .from_device = defect_confirm_refused,
      .first = 0x2000,
      .last = 0xFFFF,
      .sub = DEFECT_ANY_SUB,
      .codes = { SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_VALUE_LOW },
      .text = "values outside the limits of the EDS are confirmed" },

    { .name = "store-signature",
      .family = "store",
      .from_device = defect_confirm_refused,
      .first = 0x1010,
      .last = 0x1011,
      .sub = DEFECT_ANY_SUB,
      .codes = { SDO_NOT_STORED },
      .text = "a wrong signature is confirmed" },
    { .name = "store-nothing",
      .family = "store",
      .to_device = defect_swallow_write,
      .first = 0x1010,
      .last = 0x1010,
      .sub = DEFECT_ANY_SUB,
      .number = 0x65766173,
      .text = "\"save\" is confirmed and has no effect" },
    { .name = "restore-nothing",
      .family = "store",
      .to_device = defect_swallow_write,
      .first = 0x1011,
      .last = 0x1011,
      .sub = DEFECT_ANY_SUB,
      .number = 0x64616F6C,
      .text = "\"load\" is confirmed and has no effect" },
    { .name = "store-date",
      .family = "store",
      .to_device = defect_swallow_write,
      .first = 0x1020,
      .last = 0x1020,
      .sub = DEFECT_ANY_SUB,
      .text = "the configuration date is confirmed and not kept" },
    { .name = "cob-id-restricted",
      .family = "store",
      .from_device = defect_confirm_refused,
      .first = 0x1005,
      .last = 0x1014,
      .sub = 0,
      .codes = { SDO_INVALID_VALUE },
      .text = "restricted CAN-IDs are confirmed" },
    { .name = NULL },
};

/* Defects of process data. */
#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/nmt.h"
#include "proto/sdo_client.h"

#define SYNC_ID 0x080u

/* PDOs have identifiers of the predefined connection set: 180h, 280h .. of the device; 200h .. */
static bool is_pdo(const struct sim_gate *gate, const struct co_frame *frame, uint32_t first)
{
    const uint32_t base = frame->id - gate_view(gate)->node;

    return (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR)) == 0 && base >= first && base < 0x580 &&
           (base - first) % 0x100 == 0;
}

static bool is_tpdo(const struct sim_gate *gate, const struct co_frame *frame)
{
    return is_pdo(gate, frame, 0x180);
}

static bool is_rpdo(const struct sim_gate *gate, const struct co_frame *frame)
{
    return is_pdo(gate, frame, 0x200);
}

static bool shorten(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_tpdo(gate, frame) && frame->dlc > 0)
        frame->dlc--;
    return true;
}

static bool alter_first_byte(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (is_tpdo(gate, frame) && frame->dlc > 0)
        frame->data[0] ^= (uint8_t)use->defect->number;
    return true;
}

static bool lose_remote(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    return (frame->flags & CO_FRAME_RTR) == 0 || frame->id >= NMT_ERROR_CONTROL_ID;
}

static bool lengthen(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_rpdo(gate, frame))
        frame->dlc = 8;
    return true;
}

/* The first one after each start is heard. */
static bool lose_sync(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    if (frame->id == NMT_CAN_ID && frame->data[0] == NMT_START)
        use->count = 0;
    return frame->id != SYNC_ID || use->count++ % 2 == 0;
}

/*
 * The device is operational where it should be pre-operational or stopped (number), and what does
 * not belong to the defect is kept from the bus, or from the device.
 */
static bool pretend(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const uint8_t node = gate_view(gate)->node;
    enum nmt_command command;

    if (frame->id != NMT_CAN_ID || !nmt_command_for(frame, node, &command))
        return true;
    use->on = nmt_next_state((enum nmt_state)gate_view(gate)->state, command) ==
              (enum nmt_state)use->defect->number;
    if (use->on)
        *frame = nmt_command_frame(NMT_START, node);
    return true;
}

/* After boot-up, too. */
static void start_secretly(struct sim_gate *gate, struct defect_use *use,
                           const struct co_frame *frame)
{
    const struct co_frame start = nmt_command_frame(NMT_START, gate_view(gate)->node);

    if (use->defect->number != NMT_PREOPERATIONAL || frame->data[0] != NMT_INITIALISING)
        return;
    use->on = true;
    gate_to_device(gate, &start);
}

static bool hide_state(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (!defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID))
        return true;
    start_secretly(gate, use, frame);
    if (use->on && (frame->data[0] & 0x7F) == NMT_OPERATIONAL)
        frame->data[0] = (uint8_t)((frame->data[0] & 0x80) | use->defect->number);
    return true;
}

static bool keep_rpdo(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return (!use->on || !is_rpdo(gate, frame)) && pretend(gate, use, frame);
}

static bool keep_tpdo(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return (!use->on || !is_tpdo(gate, frame)) && hide_state(gate, use, frame);
}

/* A stopped device: the server, SYNC and emergencies rest as they should. */
static bool keep_services(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return (!use->on || is_tpdo(gate, frame) ||
            defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID)) &&
           hide_state(gate, use, frame);
}

static bool keep_requests(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return (!use->on || !defect_is_from(gate, frame, SDO_REQUEST_ID)) &&
           keep_rpdo(gate, use, frame);
}

const struct sim_defect sim_defects_pdo[] = {
    { .name = "pdo-default-id",
      .family = "pdo",
      .from_device = defect_alter_value,
      .first = 0x1800,
      .last = 0x1800,
      .sub = 1,
      .number = 0x10,
      .text = "1800h:01 has a wrong COB-ID" },
    { .name = "pdo-length",
      .family = "pdo",
      .from_device = shorten,
      .text = "TPDOs lack their last byte" },
    { .name = "pdo-data",
      .family = "pdo",
      .from_device = alter_first_byte,
      .number = 0x80,
      .text = "TPDOs have other data than their objects" },
    { .name = "pdo-remote",
      .family = "pdo",
      .to_device = lose_remote,
      .text = "TPDOs are not sent on request" },
    { .name = "pdo-sync-half",
      .family = "pdo",
      .to_device = lose_sync,
      .text = "each second SYNC is missed" },
    { .name = "pdo-preoperational",
      .family = "pdo",
      .from_device = hide_state,
      .to_device = keep_rpdo,
      .number = NMT_PREOPERATIONAL,
      .text = "TPDOs are sent in Pre-operational" },
    { .name = "pdo-stopped",
      .family = "pdo",
      .from_device = keep_services,
      .to_device = keep_requests,
      .number = NMT_STOPPED,
      .text = "TPDOs are sent in Stopped" },
    { .name = "pdo-receive-preoperational",
      .family = "pdo",
      .from_device = keep_tpdo,
      .to_device = pretend,
      .number = NMT_PREOPERATIONAL,
      .text = "RPDOs are taken in Pre-operational" },
    { .name = "pdo-short-taken",
      .family = "pdo",
      .to_device = lengthen,
      .text = "RPDOs that are too short are taken" },
    { .name = "pdo-mapping-unchecked",
      .family = "pdo",
      .from_device = defect_confirm_refused,
      .first = 0x1600,
      .last = 0x1BFF,
      .sub = DEFECT_ANY_SUB,
      .codes = { SDO_NOT_MAPPABLE, SDO_PDO_LENGTH, SDO_NO_OBJECT, SDO_NO_SUB, SDO_ACCESS },
      .text = "impossible mappings are confirmed" },
    { .name = "pdo-type-unchecked",
      .family = "pdo",
      .from_device = defect_confirm_refused,
      .first = 0x1400,
      .last = 0x19FF,
      .sub = 2,
      .codes = { SDO_INVALID_VALUE },
      .text = "reserved transmission types are confirmed" },
    { .name = "pdo-cob-id-unchecked",
      .family = "pdo",
      .from_device = defect_confirm_refused,
      .first = 0x1400,
      .last = 0x19FF,
      .sub = 1,
      .codes = { SDO_INVALID_VALUE },
      .text = "the COB-ID of a PDO in use can be changed, to restricted ones, too" },
    { .name = "pdo-inhibit",
      .family = "pdo",
      .to_device = defect_swallow_write,
      .first = 0x1800,
      .last = 0x19FF,
      .sub = 3,
      .text = "the inhibit time is confirmed and has no effect" },
    { .name = "pdo-event-timer",
      .family = "pdo",
      .to_device = defect_swallow_write,
      .first = 0x1800,
      .last = 0x19FF,
      .sub = 5,
      .text = "the event timer is confirmed and has no effect" },
    { .name = "pdo-deadline",
      .family = "pdo",
      .to_device = defect_swallow_write,
      .first = 0x1400,
      .last = 0x15FF,
      .sub = 5,
      .text = "no RPDO is missed" },
    { .name = "pdo-receive-type",
      .family = "pdo",
      .to_device = defect_swallow_write,
      .first = 0x1400,
      .last = 0x15FF,
      .sub = 2,
      .text = "no RPDO waits for the SYNC" },
    { .name = NULL },
};

/* Defects of emergencies, SYNC and error control. */
#include "mcanopen_sim_defect.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "proto/nmt.h"
#include "proto/sdo_client.h"

#define EMCY_ID 0x080u
#define SYNC_ID 0x080u
#define RESET   0x0000u

#define LAST_EMCY_ID   0x0FFu
#define HEARTBEAT_LOST 0x8130u

static bool is_emcy(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, EMCY_ID) && frame->dlc == 8;
}

static bool alter_emcy_code(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_emcy(gate, frame) && get_le16(frame->data) != RESET)
        put_le16(frame->data, 0x1000);
    return true;
}

static bool clear_emcy_register(struct sim_gate *gate, struct defect_use *use,
                                struct co_frame *frame)
{
    (void)use;
    if (is_emcy(gate, frame))
        frame->data[2] = 0;
    return true;
}

static bool shorten_emcy(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_emcy(gate, frame))
        frame->dlc = 5;
    return true;
}

static bool lose_emcy_code(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    return !is_emcy(gate, frame) || get_le16(frame->data) != use->defect->number;
}

/* An error that is told at once, whatever the state. */
static bool tell_in_stopped(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    struct co_frame emcy = co_frame_make(EMCY_ID + gate_view(gate)->node, 8);

    (void)use;
    if (gate_view(gate)->state == NMT_STOPPED && frame->id > NMT_ERROR_CONTROL_ID) {
        put_le16(emcy.data, HEARTBEAT_LOST);
        emcy.data[2] = 0x11;
        gate_to_bus(gate, &emcy);
    }
    return true;
}

/* --- SYNC --- */

static bool is_sync(const struct co_frame *frame, uint8_t dlc)
{
    return frame->id == SYNC_ID && frame->flags == 0 && frame->dlc == dlc;
}

static bool lose_second_sync(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    return !is_sync(frame, 0) || ++use->count % 2 != 0;
}

static bool alter_counter(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    if (is_sync(frame, 1))
        frame->data[0]++;
    return true;
}

static bool drop_counter(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    if (is_sync(frame, 1))
        frame->dlc = 0;
    return true;
}

/* The device goes on as it was, and nothing but SYNC tells. */
static bool ignore_stop(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    enum nmt_command command;

    if (use->on && frame->id > LAST_EMCY_ID && frame->id < NMT_ERROR_CONTROL_ID)
        return false; /* PDOs and SDO */
    if (frame->id != NMT_CAN_ID || !nmt_command_for(frame, gate_view(gate)->node, &command))
        return true;
    use->on = command == NMT_STOP;
    return !use->on;
}

static bool keep_sync(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (!use->on || frame->id == SYNC_ID)
        return true;
    if (!defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID))
        return false;
    frame->data[0] = (uint8_t)((frame->data[0] & 0x80) | NMT_STOPPED);
    return true;
}

/* --- heartbeat and guarding --- */

static bool is_heartbeat(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID) && frame->data[0] != 0;
}

static bool is_guarding(const struct co_frame *frame)
{
    return (frame->flags & CO_FRAME_RTR) != 0 && frame->id > NMT_ERROR_CONTROL_ID;
}

static bool alter_state(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_heartbeat(gate, frame) && (frame->data[0] & 0x7F) == NMT_PREOPERATIONAL)
        frame->data[0] = (uint8_t)((frame->data[0] & 0x80) | NMT_OPERATIONAL);
    return true;
}

/* An answer to node guarding is no heartbeat. */
static bool note_guarding(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    if (is_guarding(frame) && frame->id == NMT_ERROR_CONTROL_ID + gate_view(gate)->node)
        use->on = true;
    return true;
}

static bool lose_second_heartbeat(struct sim_gate *gate, struct defect_use *use,
                                  struct co_frame *frame)
{
    if (!is_heartbeat(gate, frame))
        return true;
    if (use->on) {
        use->on = false;
        return true;
    }
    return use->count++ % 2 == 0;
}

static bool keep_toggle(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_heartbeat(gate, frame))
        frame->data[0] &= 0x7F;
    return true;
}

static bool hear_all_guarding(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_guarding(frame))
        frame->id = NMT_ERROR_CONTROL_ID + gate_view(gate)->node;
    return true;
}

/* Where a heartbeat is sent, a request is answered all the same. */
static bool watch_heartbeat(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    struct co_frame answer;

    if (defect_is_from(gate, frame, SDO_REQUEST_ID) && (frame->data[0] & 0xE0) == 0x20 &&
        get_le16(frame->data + 1) == 0x1017)
        use->on = get_le16(frame->data + 4) != 0;
    if (frame->id == NMT_CAN_ID && frame->data[0] > NMT_ENTER_PREOPERATIONAL)
        use->on = false; /* a reset */
    if (use->on && is_guarding(frame) &&
        frame->id == NMT_ERROR_CONTROL_ID + gate_view(gate)->node) {
        answer = nmt_error_control_frame(gate_view(gate)->node,
                                         gate_view(gate)->state | (use->count++ % 2 ? 0x80 : 0));
        gate_to_bus(gate, &answer);
    }
    return true;
}

/* Heartbeats of others are not heard. */
static bool lose_heartbeats(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    return frame->id <= NMT_ERROR_CONTROL_ID || (frame->flags & CO_FRAME_RTR) != 0;
}

const struct sim_defect sim_defects_errors[] = {
    { .name = "emcy-missing",
      .family = "emcy",
      .from_device = defect_lose,
      .number = EMCY_ID,
      .text = "no emergencies" },
    { .name = "emcy-code",
      .family = "emcy",
      .from_device = alter_emcy_code,
      .text = "all emergencies have the code 1000h" },
    { .name = "emcy-register",
      .family = "emcy",
      .from_device = clear_emcy_register,
      .text = "emergencies have the error register 0" },
    { .name = "emcy-length",
      .family = "emcy",
      .from_device = shorten_emcy,
      .text = "emergencies have 5 bytes" },
    { .name = "emcy-reset-missing",
      .family = "emcy",
      .from_device = lose_emcy_code,
      .number = RESET,
      .text = "the end of an error is not told" },
    { .name = "emcy-id",
      .family = "emcy",
      .from_device = defect_alter_value,
      .first = 0x1014,
      .last = 0x1014,
      .sub = 0,
      .number = 1,
      .text = "1014h is wrong" },
    { .name = "emcy-never-off",
      .family = "emcy",
      .to_device = defect_swallow_write,
      .first = 0x1014,
      .last = 0x1014,
      .sub = 0,
      .text = "1014h is confirmed and has no effect" },
    { .name = "emcy-inhibit",
      .family = "emcy",
      .to_device = defect_swallow_write,
      .first = 0x1015,
      .last = 0x1015,
      .sub = 0,
      .text = "1015h is confirmed and has no effect" },
    { .name = "emcy-stopped",
      .family = "emcy",
      .to_device = tell_in_stopped,
      .text = "emergencies are sent in Stopped" },
    { .name = "error-behaviour",
      .family = "control",
      .to_device = defect_swallow_write,
      .first = 0x1029,
      .last = 0x1029,
      .sub = 1,
      .text = "1029h is confirmed and has no effect" },
    { .name = "error-register",
      .family = "emcy",
      .from_device = defect_alter_value,
      .first = 0x1001,
      .last = 0x1001,
      .sub = 0,
      .number = 1,
      .text = "1001h tells an error where there is none" },
    { .name = "error-field",
      .family = "emcy",
      .to_device = defect_swallow_write,
      .first = 0x1003,
      .last = 0x1003,
      .sub = 0,
      .text = "1003h cannot be cleared" },
    { .name = "error-field-code",
      .family = "emcy",
      .from_device = defect_alter_value,
      .first = 0x1003,
      .last = 0x1003,
      .sub = 1,
      .number = 0x0100,
      .text = "1003h:01 has another code than the emergency" },

    { .name = "sync-id",
      .family = "sync",
      .from_device = defect_alter_value,
      .first = 0x1005,
      .last = 0x1005,
      .sub = 0,
      .number = 1,
      .text = "1005h is wrong" },
    { .name = "sync-period",
      .family = "sync",
      .from_device = lose_second_sync,
      .text = "each second SYNC is not sent" },
    { .name = "sync-period-unchanged",
      .family = "sync",
      .to_device = defect_swallow_write,
      .first = 0x1006,
      .last = 0x1006,
      .sub = 0,
      .text = "1006h is confirmed and has no effect" },
    { .name = "sync-counter",
      .family = "sync",
      .from_device = alter_counter,
      .text = "the counter of SYNC begins with 2" },
    { .name = "sync-counter-missing",
      .family = "sync",
      .from_device = drop_counter,
      .text = "SYNC has no counter" },
    { .name = "sync-overflow-unchecked",
      .family = "sync",
      .from_device = defect_confirm_refused,
      .first = 0x1019,
      .last = 0x1019,
      .sub = 0,
      .codes = { SDO_INVALID_VALUE, SDO_DEVICE_STATE },
      .text = "bad values for 1019h are confirmed, and all while SYNC is sent" },
    { .name = "sync-stopped",
      .family = "sync",
      .from_device = keep_sync,
      .to_device = ignore_stop,
      .text = "SYNC is sent in Stopped" },
    { .name = "sync-length-unchecked",
      .family = "sync",
      .from_device = lose_emcy_code,
      .number = 0x8240,
      .text = "a SYNC of a wrong length is no error" },

    { .name = "heartbeat-state",
      .family = "control",
      .from_device = alter_state,
      .text = "heartbeat and guarding tell Operational in Pre-operational" },
    { .name = "heartbeat-slow",
      .family = "control",
      .from_device = lose_second_heartbeat,
      .to_device = note_guarding,
      .text = "heartbeats come at half the pace" },
    { .name = "heartbeat-unchanged",
      .family = "control",
      .to_device = defect_swallow_write,
      .first = 0x1017,
      .last = 0x1017,
      .sub = 0,
      .text = "1017h is confirmed and has no effect" },
    { .name = "heartbeat-twice",
      .family = "control",
      .from_device = defect_confirm_refused,
      .first = 0x1016,
      .last = 0x1016,
      .sub = DEFECT_ANY_SUB,
      .codes = { SDO_PARAMETER },
      .text = "a node can be watched twice" },
    { .name = "heartbeat-deaf",
      .family = "control",
      .to_device = lose_heartbeats,
      .text = "no heartbeat is watched" },
    { .name = "guard-toggle",
      .family = "control",
      .from_device = keep_toggle,
      .text = "the toggle bit of node guarding is always 0" },
    { .name = "guard-others",
      .family = "control",
      .to_device = hear_all_guarding,
      .text = "guarding requests to other nodes are answered" },
    { .name = "guard-both",
      .family = "control",
      .to_device = watch_heartbeat,
      .text = "guarding is answered while heartbeats are sent" },
    { .name = "guard-life",
      .family = "control",
      .to_device = defect_swallow_write,
      .first = 0x100C,
      .last = 0x100D,
      .sub = 0,
      .text = "100Ch and 100Dh are confirmed and have no effect" },
    { .name = NULL },
};

/* Defects of the NMT slave. */
#include "mcanopen_sim_defect.h"

#include "proto/nmt.h"

static bool is_boot_up(const struct sim_gate *gate, const struct co_frame *frame)
{
    return defect_is_from(gate, frame, NMT_ERROR_CONTROL_ID) && frame->dlc == 1 &&
           frame->data[0] == NMT_INITIALISING;
}

static bool is_command(const struct co_frame *frame)
{
    return frame->id == NMT_CAN_ID && frame->flags == 0;
}

static bool repeat_boot_up(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_boot_up(gate, frame))
        gate_to_bus(gate, frame);
    return true;
}

static bool lose_boot_up(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    return !is_boot_up(gate, frame);
}

static bool obey_all(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)use;
    if (is_command(frame) && frame->dlc == 2)
        frame->data[1] = gate_view(gate)->node;
    return true;
}

static bool ignore_broadcast(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    return !is_command(frame) || frame->dlc != 2 || frame->data[1] != NMT_ALL_NODES;
}

static bool obey_any_length(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    if (is_command(frame))
        frame->dlc = 2;
    return true;
}

static bool obey_unknown(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    (void)use;
    if (is_command(frame) && (frame->data[0] == 3 || frame->data[0] > NMT_RESET_COMMUNICATION))
        frame->data[0] = NMT_STOP;
    return true;
}

static bool ignore_command(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    (void)gate;
    return !is_command(frame) || frame->data[0] != use->defect->number;
}

/* A device that boots whenever it becomes pre-operational: the boot-up message alone. */
static bool boot_unasked(struct sim_gate *gate, struct defect_use *use, struct co_frame *frame)
{
    const struct co_frame boot_up = nmt_error_control_frame(gate_view(gate)->node,
                                                            NMT_INITIALISING);
    enum nmt_command command;

    (void)use;
    if (is_command(frame) && nmt_command_for(frame, gate_view(gate)->node, &command) &&
        command == NMT_ENTER_PREOPERATIONAL)
        gate_to_bus(gate, &boot_up);
    return true;
}

const struct sim_defect sim_defects_nmt[] = {
    { .name = "boot-up-twice",
      .family = "nmt",
      .from_device = repeat_boot_up,
      .text = "the boot-up message is sent twice" },
    { .name = "boot-up-missing",
      .family = "nmt",
      .from_device = lose_boot_up,
      .text = "there is no boot-up message" },
    { .name = "boot-up-unasked",
      .family = "nmt",
      .to_device = boot_unasked,
      .text = "a boot-up message without a reset" },
    { .name = "nmt-others",
      .family = "nmt",
      .to_device = obey_all,
      .text = "commands to other nodes are obeyed" },
    { .name = "nmt-broadcast",
      .family = "nmt",
      .to_device = ignore_broadcast,
      .text = "commands to all nodes are ignored" },
    { .name = "nmt-length",
      .family = "nmt",
      .to_device = obey_any_length,
      .text = "commands of a wrong length are obeyed" },
    { .name = "nmt-unknown",
      .family = "nmt",
      .to_device = obey_unknown,
      .text = "unknown commands stop the device" },
    { .name = "nmt-start",
      .family = "nmt",
      .to_device = ignore_command,
      .number = NMT_START,
      .text = "\"start\" is ignored" },
    { .name = "nmt-stop",
      .family = "nmt",
      .to_device = ignore_command,
      .number = NMT_STOP,
      .text = "\"stop\" is ignored" },
    { .name = "nmt-reset",
      .family = "nmt",
      .to_device = ignore_command,
      .number = NMT_RESET_COMMUNICATION,
      .text = "\"reset communication\" is ignored" },
    { .name = NULL },
};

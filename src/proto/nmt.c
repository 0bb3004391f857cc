#include "proto/nmt.h"

struct co_frame nmt_command_frame(enum nmt_command command, uint8_t node)
{
    struct co_frame frame = co_frame_make(NMT_CAN_ID, 2);

    frame.data[0] = (uint8_t)command;
    frame.data[1] = node;
    return frame;
}

static bool command_from_byte(uint8_t byte, enum nmt_command *ret_command)
{
    const enum nmt_command command = (enum nmt_command)byte;

    switch (command) {
    case NMT_START:
    case NMT_STOP:
    case NMT_ENTER_PREOPERATIONAL:
    case NMT_RESET_NODE:
    case NMT_RESET_COMMUNICATION: *ret_command = command; return true;
    }
    return false;
}

bool nmt_command_for(const struct co_frame *frame, uint8_t node, enum nmt_command *ret_command)
{
    if (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR) || frame->id != NMT_CAN_ID || frame->dlc != 2)
        return false;
    if (frame->data[1] != NMT_ALL_NODES && frame->data[1] != node)
        return false;
    return command_from_byte(frame->data[0], ret_command);
}

enum nmt_state nmt_next_state(enum nmt_state state, enum nmt_command command)
{
    if (state == NMT_INITIALISING)
        return state;
    switch (command) {
    case NMT_START: return NMT_OPERATIONAL;
    case NMT_STOP: return NMT_STOPPED;
    case NMT_ENTER_PREOPERATIONAL: return NMT_PREOPERATIONAL;
    case NMT_RESET_NODE:
    case NMT_RESET_COMMUNICATION: return NMT_INITIALISING;
    }
    return state;
}

struct co_frame nmt_error_control_frame(uint8_t node, uint8_t state)
{
    struct co_frame frame = co_frame_make(NMT_ERROR_CONTROL_ID + node, 1);

    frame.data[0] = state;
    return frame;
}

bool nmt_parse_error_control(const struct co_frame *frame, uint8_t *ret_node, uint8_t *ret_state)
{
    if (frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR) || frame->dlc < 1)
        return false;
    if (frame->id <= NMT_ERROR_CONTROL_ID || frame->id > NMT_ERROR_CONTROL_ID + NMT_NODE_MAX)
        return false;
    *ret_node = (uint8_t)(frame->id - NMT_ERROR_CONTROL_ID);
    *ret_state = frame->data[0] & 0x7F;
    return true;
}

const char *nmt_state_text(uint8_t state)
{
    switch ((enum nmt_state)state) {
    case NMT_INITIALISING: return "initialising";
    case NMT_STOPPED: return "stopped";
    case NMT_OPERATIONAL: return "operational";
    case NMT_PREOPERATIONAL: return "pre-operational";
    }
    return "unknown state";
}

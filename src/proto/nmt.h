/*
 * NMT: states, commands and their frames (CiA 301, 7.2.8). Pure functions, no machine: the state of
 * a local device is in slave/, that of the network in manager/.
 */
#ifndef CO_PROTO_NMT_H
#define CO_PROTO_NMT_H

#include "base/frame.h"

#define NMT_CAN_ID           0x000u
#define NMT_ERROR_CONTROL_ID 0x700u /* + node-ID */
#define NMT_ALL_NODES        0u
#define NMT_NODE_MAX         127u

/* As reported by boot-up and heartbeat. */
enum nmt_state {
    NMT_INITIALISING = 0x00,
    NMT_STOPPED = 0x04,
    NMT_OPERATIONAL = 0x05,
    NMT_PREOPERATIONAL = 0x7F
};

enum nmt_command {
    NMT_START = 0x01,
    NMT_STOP = 0x02,
    NMT_ENTER_PREOPERATIONAL = 0x80,
    NMT_RESET_NODE = 0x81,
    NMT_RESET_COMMUNICATION = 0x82
};

struct co_frame nmt_command_frame(enum nmt_command command, uint8_t node);

/* True for a well-formed command that is meant for this node; ret_command is any of the five. */
bool nmt_command_for(const struct co_frame *frame, uint8_t node, enum nmt_command *ret_command);

/*
 * The state a command leads to; both resets lead to NMT_INITIALISING, which no command leaves: a
 * device does that by itself.
 */
enum nmt_state nmt_next_state(enum nmt_state state, enum nmt_command command);

/* Boot-up is state NMT_INITIALISING. */
struct co_frame nmt_error_control_frame(uint8_t node, uint8_t state);

/* True for a boot-up or heartbeat frame; b7 of the state is masked. At least one byte of data. */
bool nmt_parse_error_control(const struct co_frame *frame, uint8_t *ret_node, uint8_t *ret_state);

const char *nmt_state_text(uint8_t state);

#endif

#include "api/event_map.h"

#include "api/error_map.h"
#include "manager/boot_text.h"
#include "runtime/network.h"

#include <limits.h>
#include <stdio.h>

/* An event about a node; node 0: about the network. */
static EVENT_T make(const struct network_config *config, unsigned node, unsigned long kind,
                    unsigned message)
{
    EVENT_T event = { .event = (long)(kind | message), .net = config->net, .node = (int)node };

    if (node == 0) {
        event.event |= (long)NOD_NOT_VAL;
        event.node = -1;
    }
    return event;
}

/* --- events with one number --- */

enum number { NO_NUMBER, DETAIL, ACTUAL, EXPECTED };

static const struct row {
    uint16_t type;
    uint8_t message;
    uint8_t number; /* enum number: what becomes the member of para */
    bool of_net;    /* not of event->node */
    unsigned long kind;
} rows[] = {
    { MANAGER_NODE_STATE, MCANOPEN_MSG_NODE_STATE, DETAIL, false, PARA_UC },
    { MANAGER_NODE_BOOT_UP, MCANOPEN_MSG_BOOT_UP, NO_NUMBER, false, PARA_UC },
    { MANAGER_STATE, MCANOPEN_MSG_MANAGER_STATE, DETAIL, false, PARA_UC },
    { MANAGER_NETWORK_UP, MCANOPEN_MSG_NETWORK_UP, ACTUAL, true, PARA_UC },
    { MANAGER_NODE_BOOTED, MCANOPEN_MSG_NODE_BOOTED, DETAIL, false, PARA_UC },
    { MANAGER_NODE_SOFTWARE, MCANOPEN_MSG_SOFTWARE_UPDATE, DETAIL, false, PARA_UC },
    { MANAGER_WAITING, MCANOPEN_MSG_NODES_MISSING, ACTUAL, false, PARA_UC },
    { MANAGER_SECOND_MASTER, MCANOPEN_MSG_FOREIGN_COMMAND, DETAIL, false, PARA_UC },
    { MANAGER_NMT_REQUEST, MCANOPEN_MSG_REQUESTED_COMMAND, DETAIL, false, PARA_UC },
    { MANAGER_NODE_UNFOLLOWED, MCANOPEN_MSG_NOT_STARTED, DETAIL, false, PARA_UC },
    { MANAGER_NODE_ID_TAKEN, MCANOPEN_MSG_NODE_ID_TAKEN, DETAIL, false, PARA_UC },
    { MANAGER_SYNC_MISSING, MCANOPEN_MSG_SYNC_MISSING, NO_NUMBER, true, PARA_UC },
    { RUNTIME_BUSY, MCANOPEN_MSG_BUS_BUSY, NO_NUMBER, true, PARA_UC },
    { RUNTIME_BUS_STATE, MCANOPEN_MSG_BUS_STATE, DETAIL, true, PARA_I },
    { MANAGER_NODE_TOGGLE, MCANOPEN_MSG_GUARDING_TOGGLE, ACTUAL, false, PARA_I },
    { MANAGER_DROPPED, MCANOPEN_MSG_FRAMES_LOST, ACTUAL, true, PARA_UL },
    { RUNTIME_FRAMES_LOST, MCANOPEN_MSG_FRAMES_LOST, ACTUAL, true, PARA_UL },
    { RUNTIME_UNSENT, MCANOPEN_MSG_FRAMES_UNSENT, ACTUAL, true, PARA_UL },
    { MANAGER_NODE_UP_TO_DATE, MCANOPEN_MSG_CONFIGURED, NO_NUMBER, false, PARA_UL },
    { MANAGER_NODE_CONFIGURED, MCANOPEN_MSG_CONFIGURED, ACTUAL, false, PARA_UL },
    { MANAGER_NODE_COMPARED, MCANOPEN_MSG_CONFIGURED, ACTUAL, false, PARA_UL },
};

static const struct row *find_row(uint16_t type)
{
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++)
        if (rows[i].type == type)
            return &rows[i];
    return NULL;
}

static uint64_t number_of(enum number number, const struct co_event *event)
{
    switch (number) {
    case DETAIL: return event->detail;
    case ACTUAL: return event->actual;
    case EXPECTED: return event->expected;
    case NO_NUMBER: return 0;
    }
    return 0;
}

/* Numbers too large for their member are the largest that it has. */
static void set_number(EVENT_T *event, unsigned long kind, uint64_t number)
{
    if (kind == PARA_UC)
        event->para.uc = (unsigned char)(number < UCHAR_MAX ? number : UCHAR_MAX);
    else if (kind == PARA_US)
        event->para.us = (unsigned short)(number < USHRT_MAX ? number : USHRT_MAX);
    else if (kind == PARA_I)
        event->para.i = (int)(number < INT_MAX ? number : INT_MAX);
    else
        event->para.ul = (unsigned long)(number < UINT32_MAX ? number : UINT32_MAX);
}

static unsigned put_row(EVENT_T *event, const struct network_config *config, const struct row *row,
                        const struct co_event *from)
{
    *event = make(config, row->of_net ? 0 : from->node, row->kind, row->message);
    set_number(event, row->kind, number_of((enum number)row->number, from));
    return 1;
}

/* --- the others --- */

/* Of error control: heartbeat, or guarding. */
static unsigned put_watch(EVENT_T *event, const struct network_config *config,
                          const struct co_event *from)
{
    const bool guarded = from->actual != 0, lost = from->type == MANAGER_NODE_LOST;
    const unsigned messages[2][2] = { { MCANOPEN_MSG_HEARTBEAT_BACK, MCANOPEN_MSG_GUARDING_BACK },
                                      { MCANOPEN_MSG_HEARTBEAT_LOST, MCANOPEN_MSG_GUARDING_LOST } };
    const struct row row = { .message = (uint8_t)messages[lost][guarded],
                             .number = EXPECTED,
                             .kind = PARA_US };

    return put_row(event, config, &row, from);
}

static unsigned put_halted(EVENT_T *event, const struct network_config *config,
                           const struct co_event *from)
{
    static const struct row over = {
        .message = MCANOPEN_MSG_BOOT_TIME_OVER, .number = EXPECTED, .of_net = true, .kind = PARA_US
    };
    static const struct row halted = { .message = MCANOPEN_MSG_NETWORK_HALTED,
                                       .number = ACTUAL,
                                       .kind = PARA_UC };

    return put_row(event, config, from->expected ? &over : &halted, from);
}

/* Other events tell how a boot ends. */
static unsigned put_step(EVENT_T *event, const struct network_config *config,
                         const struct co_event *from)
{
    static const struct row step = { .message = MCANOPEN_MSG_BOOT_STEP,
                                     .number = DETAIL,
                                     .kind = PARA_UC };

    if (from->detail == MCANOPEN_STEP_READY || from->detail == MCANOPEN_STEP_STARTED)
        return 0;
    return put_row(event, config, &step, from);
}

static unsigned put_written(EVENT_T *event, const struct network_config *config,
                            const struct co_event *from)
{
    *event = make(config, from->node, PARA_WRITE, MCANOPEN_MSG_OBJECT_WRITTEN);
    event->para.write.index = from->index;
    event->para.write.subindex = from->sub;
    error_set(&event->para.write.err, SDO_OK);
    return 1;
}

static unsigned put_text(EVENT_T *event, const struct network_config *config,
                         const struct co_event *from)
{
    char text[BOOT_TEXT_SIZE];
    enum co_severity severity;

    if (!boot_text_event(config, from, &severity, text, sizeof text))
        return 0;
    *event = make(config, from->node, PARA_STR, MCANOPEN_MSG_TEXT);
    snprintf(event->para.str, sizeof event->para.str, "%.63s", text); /* cut to fit */
    return 1;
}

static unsigned aborted(char letter)
{
    switch (letter) {
    case 'J': return MCANOPEN_MSG_CONFIGURATION_ABORTED;
    case 'I': return MCANOPEN_MSG_SOFTWARE_UPDATE_ABORTED;
    default: return MCANOPEN_MSG_BOOT_READ_ABORTED;
    }
}

/* The letter, what the node aborted where it did, and the text. */
static unsigned put_failure(EVENT_T *events, const struct network_config *config,
                            const struct co_event *from)
{
    struct boot_failure failure = boot_failure_of(from);
    unsigned count = 1;

    events[0] = make(config, from->node, PARA_C, MCANOPEN_MSG_BOOT_ERROR);
    events[0].para.c = failure.letter;
    if (failure.outcome == SDO_OUTCOME_ABORTED) {
        EVENT_T *event = &events[count++];

        *event = make(config, from->node, PARA_WRITE, aborted(failure.letter));
        event->para.write.index = failure.index;
        event->para.write.subindex = failure.sub;
        error_set(&event->para.write.err, failure.abort_code);
    }
    return count + put_text(&events[count], config, from);
}

unsigned event_map(const struct network_config *config, const struct co_event *event,
                   EVENT_T ret_events[EVENT_MAP_MAX])
{
    const struct row *row = find_row(event->type);

    if (row)
        return put_row(ret_events, config, row, event);
    switch (event->type) {
    case MANAGER_NODE_FAILED: return put_failure(ret_events, config, event);
    case MANAGER_NODE_STEP: return put_step(ret_events, config, event);
    case MANAGER_NODE_STARTED:
        *ret_events = make(config, event->node, PARA_UC, MCANOPEN_MSG_NODE_STARTED);
        ret_events->para.uc = NMT_OPERATIONAL;
        return 1;
    case MANAGER_NODE_LOST:
    case MANAGER_NODE_BACK: return put_watch(ret_events, config, event);
    case MANAGER_EMCY:
        *ret_events = make(config, event->node, PARA_UL, MCANOPEN_MSG_EMERGENCY);
        ret_events->para.ul = event->code | (unsigned long)event->detail << 16;
        return 1;
    case MANAGER_WRITTEN: return put_written(ret_events, config, event);
    case MANAGER_HALTED: return put_halted(ret_events, config, event);
    case MANAGER_CONFIG_REFUSED: return put_text(ret_events, config, event);
    default: return 0; /* what the node has answered, and what only wakes: not news */
    }
}

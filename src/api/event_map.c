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

static unsigned put_uc(EVENT_T *event, const struct network_config *config, unsigned node,
                       unsigned message, unsigned value)
{
    *event = make(config, node, PARA_UC, message);
    event->para.uc = (unsigned char)value;
    return 1;
}

static unsigned put_us(EVENT_T *event, const struct network_config *config, unsigned node,
                       unsigned message, unsigned value)
{
    *event = make(config, node, PARA_US, message);
    event->para.us = (unsigned short)(value < USHRT_MAX ? value : USHRT_MAX);
    return 1;
}

static unsigned put_ul(EVENT_T *event, const struct network_config *config, unsigned node,
                       unsigned message, unsigned long value)
{
    *event = make(config, node, PARA_UL, message);
    event->para.ul = value;
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

static unsigned put_halted(EVENT_T *event, const struct network_config *config,
                           const struct co_event *from)
{
    if (from->expected)
        return put_us(event, config, 0, MCANOPEN_MSG_BOOT_TIME_OVER, (unsigned)from->expected);
    return put_text(event, config, from);
}

/* The log's line says all that there is to say. */
static bool is_told_by_text(uint16_t type)
{
    static const uint16_t types[] = { MANAGER_NODE_ID_TAKEN, MANAGER_NODE_UNFOLLOWED,
                                      MANAGER_SYNC_MISSING, MANAGER_NMT_REQUEST,
                                      MANAGER_SECOND_MASTER };

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i] == type)
            return true;
    return false;
}

static unsigned map_network_event(const struct network_config *config, const struct co_event *event,
                                  EVENT_T ret_events[EVENT_MAP_MAX])
{
    switch (event->type) {
    case MANAGER_STATE:
        return put_uc(ret_events, config, event->node, MCANOPEN_MSG_MANAGER_STATE, event->detail);
    case MANAGER_NETWORK_UP:
        return put_uc(ret_events, config, 0, MCANOPEN_MSG_NETWORK_UP, (unsigned)event->actual);
    case MANAGER_HALTED: return put_halted(ret_events, config, event);
    case MANAGER_DROPPED:
    case RUNTIME_FRAMES_LOST:
        return put_ul(ret_events, config, 0, MCANOPEN_MSG_FRAMES_LOST,
                      (unsigned long)event->actual);
    case RUNTIME_UNSENT:
        return put_ul(ret_events, config, 0, MCANOPEN_MSG_FRAMES_UNSENT,
                      (unsigned long)event->actual);
    case RUNTIME_BUS_STATE:
        *ret_events = make(config, 0, PARA_I, MCANOPEN_MSG_BUS_STATE);
        ret_events->para.i = event->detail;
        return 1;
    default: /* the steps of a boot are for the log alone */
        return is_told_by_text(event->type) ? put_text(ret_events, config, event) : 0;
    }
}

unsigned event_map(const struct network_config *config, const struct co_event *event,
                   EVENT_T ret_events[EVENT_MAP_MAX])
{
    switch (event->type) {
    case MANAGER_NODE_FAILED: return put_failure(ret_events, config, event);
    case MANAGER_NODE_BOOTED:
        return put_uc(ret_events, config, event->node, MCANOPEN_MSG_NODE_BOOTED, event->detail);
    case MANAGER_NODE_STARTED:
        return put_uc(ret_events, config, event->node, MCANOPEN_MSG_NODE_STARTED, NMT_OPERATIONAL);
    case MANAGER_NODE_STATE:
        return put_uc(ret_events, config, event->node, MCANOPEN_MSG_NODE_STATE, event->detail);
    case MANAGER_NODE_BOOT_UP:
        return put_uc(ret_events, config, event->node, MCANOPEN_MSG_BOOT_UP, 0);
    case MANAGER_NODE_LOST:
        return put_us(ret_events, config, event->node,
                      event->actual ? MCANOPEN_MSG_GUARDING_LOST : MCANOPEN_MSG_HEARTBEAT_LOST,
                      (unsigned)event->expected);
    case MANAGER_NODE_BACK:
        return put_us(ret_events, config, event->node,
                      event->actual ? MCANOPEN_MSG_GUARDING_BACK : MCANOPEN_MSG_HEARTBEAT_BACK,
                      (unsigned)event->expected);
    case MANAGER_NODE_TOGGLE:
        *ret_events = make(config, event->node, PARA_I, MCANOPEN_MSG_GUARDING_TOGGLE);
        ret_events->para.i = (int)event->actual;
        return 1;
    case MANAGER_EMCY:
        return put_ul(ret_events, config, event->node, MCANOPEN_MSG_EMERGENCY,
                      event->code | (unsigned long)event->detail << 16);
    default: return map_network_event(config, event, ret_events);
    }
}

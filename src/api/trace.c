#include "api/trace.h"

#include <stdio.h>
#include <string.h>

bool trace_wanted_by(unsigned mask, const struct co_event *event)
{
    return (mask & (event->node == 0 ? TRACE_RECEIVED : TRACE_SENT)) != 0;
}

bool trace_wanted(const struct network_config *config, const struct co_event *event)
{
    const unsigned manager = config->debug_mask & 0xFFFF, devices = config->debug_mask >> 16;

    if (event->node == 0)
        return trace_wanted_by(manager | devices, event);
    return trace_wanted_by(event->node == config->manager_node_id ? manager : devices, event);
}

void trace_text(const struct co_event *event, char *text, size_t size)
{
    struct co_frame frame = co_frame_make(event->code, (uint8_t)event->index);
    char bytes[CO_FRAME_TEXT_SIZE];

    frame.flags = event->sub;
    memcpy(frame.data, event->data, sizeof frame.data);
    co_frame_format(&frame, bytes, sizeof bytes);
    if (event->node == 0)
        snprintf(text, size, "trace: received %s", bytes);
    else
        snprintf(text, size, "trace: node %u sends %s", event->node, bytes);
}

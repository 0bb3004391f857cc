/* Frames for those who look at them, in builds with MCANOPEN_TRACE. */
#include "runtime/network_internal.h"

#include <string.h>

void network_trace(struct network *self)
{
    lock_take(&self->lock);
    self->is_traced = MCANOPEN_TRACE;
    lock_give(&self->lock);
}

void network_trace_frame(struct network *self, const struct co_frame *frame, uint8_t sender)
{
    struct co_event event = { .type = RUNTIME_FRAME,
                              .node = sender,
                              .index = frame->dlc,
                              .sub = frame->flags,
                              .code = frame->id };

    if (!self->is_traced)
        return;
    memcpy(event.data, frame->data, sizeof event.data);
    network_tell(self, event);
}

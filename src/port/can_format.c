#include "port/can_format.h"

#include <errno.h>
#include <string.h>

struct can_frame can_format_frame(const struct co_frame *frame)
{
    struct can_frame result = { .can_id = frame->id, .len = frame->dlc };

    if (frame->flags & CO_FRAME_EXT)
        result.can_id |= CAN_EFF_FLAG;
    if (frame->flags & CO_FRAME_RTR)
        result.can_id |= CAN_RTR_FLAG;
    else
        memcpy(result.data, frame->data, frame->dlc);
    return result;
}

struct co_frame can_parse_frame(const struct can_frame *frame)
{
    struct co_frame result = { .dlc = frame->len <= 8 ? frame->len : 8 };

    if (frame->can_id & CAN_EFF_FLAG)
        result.flags |= CO_FRAME_EXT;
    result.id = frame->can_id & (result.flags & CO_FRAME_EXT ? CAN_EFF_MASK : CAN_SFF_MASK);
    if (frame->can_id & CAN_RTR_FLAG)
        result.flags |= CO_FRAME_RTR;
    else
        memcpy(result.data, frame->data, result.dlc);
    return result;
}

struct can_filter can_format_filter(const struct bus_filter *filter)
{
    struct can_filter result = { .can_id = filter->id & CAN_EFF_MASK,
                                 .can_mask = filter->mask & CAN_EFF_MASK };

    if (filter->flags & CO_FRAME_EXT)
        result.can_id |= CAN_EFF_FLAG;
    if (filter->flags & CO_FRAME_RTR)
        result.can_id |= CAN_RTR_FLAG;
    if (filter->flags_mask & CO_FRAME_EXT)
        result.can_mask |= CAN_EFF_FLAG;
    if (filter->flags_mask & CO_FRAME_RTR)
        result.can_mask |= CAN_RTR_FLAG;
    return result;
}

enum co_err can_parse_error(int error)
{
    switch (error) {
    case EAGAIN:  /* no frame, or the socket's send buffer is full */
    case ENOBUFS: /* the interface's queue is full */
    case EINTR: return CO_ERR_AGAIN;
    case ENETDOWN: return CO_ERR_DOWN;
    case ENODEV:
    case ENXIO: return CO_ERR_NO_BUS;
    case EACCES:
    case EPERM: return CO_ERR_PERMISSION;
    case ENOMEM: return CO_ERR_MEMORY;
    default: return CO_ERR_IO;
    }
}

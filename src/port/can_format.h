/*
 * Frames, filters and errors as Linux has them, from and to those of the stack. Internal to port/.
 */
#ifndef CO_PORT_CAN_FORMAT_H
#define CO_PORT_CAN_FORMAT_H

#include "port/bus.h"

#include <linux/can.h>

struct can_frame can_format_frame(const struct co_frame *frame);
/* Not of error frames. */
struct co_frame can_parse_frame(const struct can_frame *frame);
struct can_filter can_format_filter(const struct bus_filter *filter);
/* errno of a call on a CAN socket */
enum co_err can_parse_error(int error);

#endif

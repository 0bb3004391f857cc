/*
 * What Debug_Mask and usDebugMask ask for, in builds with MCANOPEN_TRACE: a line of the log for
 * each frame.
 *
 *   in   RUNTIME_FRAME of a network
 *   out  whether it is wanted; its text
 */
#ifndef CO_API_TRACE_H
#define CO_API_TRACE_H

#include "runtime/network.h"

/* Classes: bits of usDebugMask, and of each word of Debug_Mask. */
enum { TRACE_RECEIVED = 1, TRACE_SENT = 2 };

/* Of the manager: the low word is for itself, the high word for local devices. */
bool trace_wanted(const struct network_config *config, const struct co_event *event);
/* Of local devices. */
bool trace_wanted_by(unsigned mask, const struct co_event *event);
void trace_text(const struct co_event *event, char *text, size_t size);

#endif

/*
 * What classic CAN makes of a frame on the wire: how long it is, and who wins against whom.
 */
#ifndef CO_PORT_BUS_TIMING_H
#define CO_PORT_BUS_TIMING_H

#include "base/frame.h"

#include <stdint.h>

/* From start of frame to the end of the intermission, with the stuff bits of these very contents,
 * CRC included: 47..160. */
unsigned bus_frame_bits(const struct co_frame *frame);
/* The bits of the arbitration field; the lowest wins. */
uint32_t bus_frame_priority(const struct co_frame *frame);

#endif

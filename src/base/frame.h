/*
 * A classic CAN frame, and its text in the form of candump logs ("605#4000100000000000").
 */
#ifndef CO_BASE_FRAME_H
#define CO_BASE_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CO_FRAME_EXT 0x01u /* 29-bit identifier */
#define CO_FRAME_RTR 0x02u /* remote frame: dlc without data */
#define CO_FRAME_OWN 0x04u /* sent by the device that receives it: its transmit confirmation */

#define CO_FRAME_TEXT_SIZE 32u /* room for the longest text and its end */

struct co_frame {
    uint32_t id;
    uint8_t flags;
    uint8_t dlc;
    uint8_t tag; /* the local device that sends it, its node-ID; 0: none, a foreign frame */
    uint8_t data[8];
};

/* A data frame with an 11-bit identifier and dlc bytes, all 0. */
struct co_frame co_frame_make(uint32_t id, uint8_t dlc);

/* Same identifier, kind and data; where it came from does not count. */
bool co_frame_equal(const struct co_frame *a, const struct co_frame *b);

/* Writes at most size bytes, the end included; returns text. */
char *co_frame_format(const struct co_frame *self, char *text, size_t size);

/* Reads "ID#DATA" or "ID#R[dlc]"; false and *ret_frame untouched when the text is no frame. */
bool co_frame_parse(const char *text, struct co_frame *ret_frame);

#endif

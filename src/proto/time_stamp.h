/*
 * TIME: the time of day on the bus (CiA 301, 7.2.6; object 1012h).
 *
 *   byte 0..3   ms after midnight, 28 bits; the upper 4 are 0, and not looked at
 *   byte 4..5   days since 1984-01-01
 *
 *   in   the object, frames, the owner's order to send
 *   out  TIME frames; the time of those received
 *
 *   owner    a local device
 *   locking  none; the owner's
 */
#ifndef CO_PROTO_TIME_STAMP_H
#define CO_PROTO_TIME_STAMP_H

#include "base/error.h"
#include "base/outbox.h"

#define TIME_CAN_ID      0x100u /* where nothing says another */
#define TIME_OF_DAY_SIZE 6u
#define TIME_MS_MAX      86399999u /* the last one before midnight */

struct time_of_day {
    uint32_t ms;
    uint16_t days;
};

void time_of_day_encode(const struct time_of_day *self, uint8_t ret_bytes[TIME_OF_DAY_SIZE]);
struct time_of_day time_of_day_decode(const uint8_t bytes[TIME_OF_DAY_SIZE]);

struct time_stamp {
    uint32_t cob_id; /* object 1012h; bit 31: consumes, bit 30: produces */
    bool enabled;    /* NMT state pre-operational or operational */
};

bool time_stamp_consumes(const struct time_stamp *self);
/* True for a TIME while it consumes. */
bool time_stamp_on_frame(const struct time_stamp *self, const struct co_frame *frame,
                         struct time_of_day *ret_time);
/* CO_ERR_STATE: not enabled; CO_ERR_ARG: it is no producer; CO_ERR_AGAIN: no room. */
enum co_err time_stamp_send(const struct time_stamp *self, const struct time_of_day *time,
                            struct co_outbox *out);

#endif

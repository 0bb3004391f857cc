/*
 * What several families of checks use.
 */
#ifndef TOOLS_CONFORM_CHECK_COMMON_H
#define TOOLS_CONFORM_CHECK_COMMON_H

#include "conform.h"

/* Sends "command index sub 00 00 00 00"; answer 0 for silence. */
bool check_ask(struct conform *self, uint8_t command, uint16_t index, uint8_t sub,
               uint8_t ret_answer[8]);
/* Sends eight bytes, and needs an answer whose first byte is this one; else fails. */
bool check_step(struct conform *self, const uint8_t request[8], uint8_t expected,
                uint8_t ret_answer[8]);

/* Ends a transfer of this object that is of no more interest. */
void check_give_up(struct conform *self, const struct conform_object *object);

/* The object has still this value; else fails. */
bool check_unchanged(struct conform *self, const struct conform_object *object,
                     const struct conform_value *before);
/* The next request of another kind is served: reads 1000h. */
bool check_still_serves(struct conform *self);

/* SDO clients may write it, as far as is known. */
bool check_is_writable(const struct conform_object *object);

/* Orders, not values: 1010h and 1011h. */
bool check_takes_signature(uint16_t index);

/* The value has 'least' bytes, and not too many to be kept. NULL: none is known. */
const struct conform_object *check_writable_string(struct conform *self, uint32_t least);

/* Of SDO block transfers: x^16 + x^12 + x^5 + 1, beginning with 0. */
uint16_t check_crc16(const uint8_t *bytes, uint32_t size);

enum check_side { CHECK_ABOVE, CHECK_BELOW };

/* The value beyond the limit that the EDS gives; false: there is none. */
bool check_beyond_limit(const struct conform *self, const struct conform_object *object,
                        enum check_side side, uint8_t ret_bytes[8], uint32_t *ret_size);

#endif

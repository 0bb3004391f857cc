/*
 * The text of a value as the bytes that travel on the bus, for each data type.
 */
#ifndef CO_DCF_DCF_CONVERT_H
#define CO_DCF_DCF_CONVERT_H

#include "dcf/dcf.h"
#include "dcf/dcf_number.h"

/* Fills given, has_node_id, size and bytes. The quirks are told however it ends. */
enum dcf_fit dcf_convert(struct co_pool *pool, struct dcf_slice text, uint8_t type,
                         struct dcf_value *ret_value, unsigned *ret_quirks);

/* What a value of this type may look like, for messages. */
const char *dcf_convert_expected(uint8_t type);

#endif

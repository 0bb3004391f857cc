/*
 * Entries of a concise DCF in JSON.
 */
#ifndef TOOLS_CCFREAD_JSON_H
#define TOOLS_CCFREAD_JSON_H

#include "dcf/ccf.h"

#include <jansson.h>

#define VIEW_JSON_STYLE (JSON_COMPACT | JSON_ENSURE_ASCII)

/* Offset, size, data in hexadecimal, and the value where there is one. NULL: no memory. */
json_t *view_json_of(const struct ccf_entry *entry, size_t offset, uint8_t type);

#endif

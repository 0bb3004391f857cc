/*
 * What the command line tools say in the same way.
 */
#ifndef TOOLS_COMMON_TOOL_H
#define TOOLS_COMMON_TOOL_H

#include <stdbool.h>
#include <stdint.h>

/* "dcf2ccf 0.1.0" to stdout; false: not written. */
bool tool_print_version(const char *tool);

/* Decimal, or hexadecimal with 0x; false and *ret_number untouched: not in this range. */
bool tool_number(const char *text, unsigned least, unsigned most, unsigned *ret_number);

/* 1..127, decimal or with 0x; false and *ret_node_id untouched: none of these. */
bool tool_node_id(const char *text, uint8_t *ret_node_id);

/* "CANOPEN_DCF_OUT_OF_RANGE" for a kind of enum dcf_error; NULL: none. */
const char *tool_dcf_code(int kind);

#endif

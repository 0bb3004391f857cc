/* Bytes as text, for tables. */
#ifndef TEST_SUPPORT_HEX_H
#define TEST_SUPPORT_HEX_H

#include <stddef.h>
#include <stdint.h>

/* "4142" to bytes, "-" to none; the test fails when they do not fit or are malformed. */
size_t hex_parse(const char *text, uint8_t *bytes, size_t room);
char *hex_format(const uint8_t *bytes, size_t count, char *text, size_t size);

/* A generator of its own, so that a seed gives the same numbers everywhere. */
uint32_t noise(uint64_t *seed);

#endif

/*
 * Compares two records of the same conversation on the bus, in candump's form.
 *
 *   in   two texts: lines "(seconds) interface ID#DATA", or "ID#DATA" alone; lines that begin with
 *        '#' are comments
 *   out  the same or not, and where they part
 *
 * Time stamps, and what different nodes say in which order, do not count: nodes boot in parallel.
 * What counts:
 *
 *   - the NMT commands, in order
 *   - for each node its frames (CAN-IDs with its node-ID, and NMT commands to it or all), in order
 *   - for each node the states its heartbeats tell, in order; a state told again is no news
 */
#ifndef TEST_SUPPORT_WIRE_LOG_H
#define TEST_SUPPORT_WIRE_LOG_H

#include <stdbool.h>
#include <stddef.h>

#define WIRE_LOG_DIFFERENCE_SIZE 256u

/* False: 'difference' says what. */
bool wire_log_same(const char *expected, const char *actual, char *difference, size_t size);

/* The text of a file below TEST_DATA_DIR, to be freed; NULL: no such file. */
char *wire_log_read(const char *name);

#endif

/*
 * dcftest --online: a device on a bus against its DCF.
 *
 *   in   a DCF or EDS, a bus, a node-ID
 *   out  what is not in the device as it is in the file
 *
 * The device is only read. It must answer SDO requests (not be stopped), and nobody else may use
 * its SDO server at the same time.
 */
#ifndef TOOLS_DCFTEST_ONLINE_H
#define TOOLS_DCFTEST_ONLINE_H

#include "dcftest.h"

#define DCFTEST_BUS 3 /* exit code: no bus, no answer */

struct online {
    const char *bus;
    unsigned timeout; /* ms */
    bool all;         /* DefaultValues as well */
};

/* The exit code; all messages have been written. */
int online_check(const struct settings *settings, const struct online *online,
                 const struct file *file, const struct writer *writer);

/* dcftest_value.c */

struct value_text {
    char text[96];
};

/* Bytes of a number or time; 0: what has no fixed size. */
uint32_t value_number_size(uint8_t type);
bool value_is_same(uint8_t type, const uint8_t *a, uint32_t a_size, const uint8_t *b,
                   uint32_t b_size);
struct value_text value_show(uint8_t type, const uint8_t *bytes, uint32_t size);

#endif

/*
 * What two concise DCFs do differently: entries that one of them lacks, other values, other order.
 *
 * The last write of an object in one file is compared with the last in the other, the one before
 * with the one before: the last ones are what the device is left with. Of the entries that both
 * files have, as few as possible count as moved.
 */
#ifndef TOOLS_CCFREAD_DIFF_H
#define TOOLS_CCFREAD_DIFF_H

#include "ccfread_input.h"

#include <stdbool.h>

struct diff_item { /* an entry of a file */
    uint32_t offset;
    uint32_t position;   /* among all entries, from 0 */
    uint32_t occurrence; /* of this object, from 1 */
    uint32_t later;      /* writes of this object that follow */
    uint16_t index;
    uint8_t sub;
    bool moved;
};

struct diff_side {
    struct input input;
    struct diff_item *items; /* sorted by object and position */
    uint32_t count;
    bool broken;
};

enum diff_kind { DIFF_REMOVED, DIFF_ADDED, DIFF_CHANGED, DIFF_MOVED };

struct diff {
    struct diff_side a, b;
    const struct dcf *eds; /* NULL: none */
    bool json;
    unsigned long found;
    bool failed; /* standard output, or no memory for JSON */
};

/* Compares and prints; the exit code. */
int diff_files(const char *a, const char *b, const struct dcf *eds, bool json);

/* For the printing part. NULL for a or b: not there. */
void diff_print(struct diff *self, enum diff_kind kind, const struct diff_item *a,
                const struct diff_item *b);
void diff_print_end(struct diff *self);
struct ccf_entry diff_entry(const struct diff_side *side, const struct diff_item *item);

#endif

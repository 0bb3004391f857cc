/*
 * The deadlines of up to 128 machines: which is the earliest, and whose are due, without asking
 * each of them.
 *
 *   in   a machine's deadline, each time that it may have changed
 *   out  the earliest of all; the numbers of those that are due
 *
 *   owner    whoever runs the machines; it numbers them
 *   locking  none; the owner's
 */
#ifndef CO_BASE_DEADLINES_H
#define CO_BASE_DEADLINES_H

#include "base/time.h"

#define CO_DEADLINES 128u

struct co_deadlines {
    co_us_t earliest[2 * CO_DEADLINES]; /* a tree: of 2 i and 2 i + 1 the earlier one is in i */
};

/* All CO_NEVER. */
void co_deadlines_init(struct co_deadlines *self);
void co_deadlines_set(struct co_deadlines *self, unsigned i, co_us_t deadline);
co_us_t co_deadlines_first(const struct co_deadlines *self);
/* The first number from this one on whose deadline has come; CO_DEADLINES: there is none. */
unsigned co_deadlines_due(const struct co_deadlines *self, unsigned from, co_us_t now);

#endif

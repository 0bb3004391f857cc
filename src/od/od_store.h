/*
 * Power-on values other than the DefaultValues: what a device keeps ("save"), and gives back.
 *
 * Kept are parameters: entries that clients can write, but no domains. The power-on value of an
 * entry (od_entry.initial) is its DefaultValue until another one is stored; from then on both are
 * there. It is made in two steps: the plan has all that is needed, so that the second step cannot
 * fail, and what the plan says can be written to a file between them.
 *
 *   owner    as the dictionary
 *   locking  none; the owner's
 */
#ifndef CO_OD_OD_STORE_H
#define CO_OD_OD_STORE_H

#include "od/od.h"

struct od_value {
    const uint8_t *bytes;
    uint32_t size;
};

/* A power-on value to be. */
struct od_planned {
    struct od_entry *entry;
    uint32_t size;
    uint8_t small[OD_SMALL]; /* of a number */
    uint8_t *bytes;          /* of a string; the entry's when it is taken over */
};

struct od_plan {
    struct od_planned *values;
    size_t count, room;
};

bool od_is_parameter(const struct od_entry *entry);
/* That of a parameter. */
struct od_value od_default(const struct od_entry *entry);
struct od_value od_power_on(const struct od_entry *entry);
bool od_same(struct od_value a, struct od_value b);

void od_plan_init(struct od_plan *self);
void od_plan_done(struct od_plan *self);
/*
 * For a parameter. CO_ERR_MEMORY; CO_ERR_VALUE: too long for the memory that the value
 * has after a reset.
 */
enum co_err od_plan_add(struct od_plan *self, struct od_entry *entry, struct od_value value);
/* All planned values become the power-on values; the plan is empty then. */
void od_plan_commit(struct od_plan *self);

/* For a number, at once. */
void od_store_number(struct od_entry *entry, uint64_t number);
/* The power-on value is the DefaultValue again. */
void od_restore_default(struct od_entry *entry);
/* The present values of the parameters first..last become the power-on values. Errors as above. */
enum co_err od_store(struct od *self, uint16_t first, uint16_t last);

#endif

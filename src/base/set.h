/*
 * A set of numbers up to 127, node-IDs for example, that is gone through in order.
 */
#ifndef CO_BASE_SET_H
#define CO_BASE_SET_H

#include <stdbool.h>
#include <stdint.h>

#define CO_SET_SIZE 128u

struct co_set {
    uint32_t bits[CO_SET_SIZE / 32];
};

static inline void co_set_add(struct co_set *self, unsigned i)
{
    self->bits[i / 32] |= UINT32_C(1) << i % 32;
}

static inline void co_set_remove(struct co_set *self, unsigned i)
{
    self->bits[i / 32] &= ~(UINT32_C(1) << i % 32);
}

static inline bool co_set_has(const struct co_set *self, unsigned i)
{
    return (self->bits[i / 32] >> i % 32 & 1) != 0;
}

/* The first one from this one on; CO_SET_SIZE: there is none. */
static inline unsigned co_set_next(const struct co_set *self, unsigned from)
{
    while (from < CO_SET_SIZE) {
        uint32_t rest = self->bits[from / 32] >> from % 32;

        if (rest != 0)
            return from + (unsigned)__builtin_ctz(rest);
        from = (from / 32 + 1) * 32;
    }
    return CO_SET_SIZE;
}

#define CO_SET_EACH(set, i)                                                                        \
    for (unsigned i = co_set_next(set, 0); i < CO_SET_SIZE; i = co_set_next(set, i + 1))

#endif

/*
 * Bytes and texts that are many and small and end together.
 *
 *   in   sizes
 *   out  memory for each, not aligned, not set to 0
 *
 * A pool of zeroes is empty. Its pieces stay where they are until co_pool_done().
 */
#ifndef CO_BASE_POOL_H
#define CO_BASE_POOL_H

#include <stddef.h>

struct co_pool_block;

struct co_pool {
    struct co_pool_block *newest;
};

/* NULL: no memory */
void *co_pool_take(struct co_pool *self, size_t size);
/* Gives the end of what was taken last back, or all of it. */
void co_pool_give_back(struct co_pool *self, size_t size);
void co_pool_done(struct co_pool *self);

#endif

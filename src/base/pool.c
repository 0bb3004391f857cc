#include "base/pool.h"

#include <stdlib.h>

#define SMALLEST 1024u
#define LARGEST  65536u

struct co_pool_block {
    struct co_pool_block *older;
    size_t used, size;
    char bytes[];
};

/* Twice as large as the last one, so that small files take little and large ones few blocks. */
static size_t next_size(const struct co_pool *self, size_t least)
{
    size_t size = self->newest ? 2 * self->newest->size : SMALLEST;

    if (size > LARGEST)
        size = LARGEST;
    return size < least ? least : size;
}

static struct co_pool_block *add_block(struct co_pool *self, size_t least)
{
    size_t size = next_size(self, least);
    struct co_pool_block *block = malloc(sizeof *block + size);

    if (!block)
        return NULL;
    block->older = self->newest;
    block->used = 0;
    block->size = size;
    self->newest = block;
    return block;
}

void *co_pool_take(struct co_pool *self, size_t size)
{
    struct co_pool_block *block = self->newest;

    if (!block || size > block->size - block->used)
        block = add_block(self, size);
    if (!block)
        return NULL;
    block->used += size;
    return block->bytes + block->used - size;
}

void co_pool_give_back(struct co_pool *self, size_t size)
{
    self->newest->used -= size;
}

void co_pool_done(struct co_pool *self)
{
    while (self->newest) {
        struct co_pool_block *block = self->newest;

        self->newest = block->older;
        free(block);
    }
}

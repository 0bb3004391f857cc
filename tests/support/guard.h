/* A copy of bytes that ends where memory ends: reading one byte too many is a crash. */
#ifndef TEST_SUPPORT_GUARD_H
#define TEST_SUPPORT_GUARD_H

#include <stddef.h>

struct guard {
    char *bytes; /* the copy */
    void *pages;
    size_t size; /* of the pages */
};

void guard_init(struct guard *self, const void *bytes, size_t size);
void guard_done(struct guard *self);

#endif

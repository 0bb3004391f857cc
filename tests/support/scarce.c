#include "support/scarce.h"

#include <stddef.h>

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__wrap_realloc(void *memory, size_t size);
char *__real_strdup(const char *text);
char *__wrap_strdup(const char *text);

_Thread_local unsigned memory_left;

bool scarce_fails(unsigned *left)
{
    return *left > 0 && --*left == 0;
}

void *__wrap_malloc(size_t size)
{
    return scarce_fails(&memory_left) ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t count, size_t size)
{
    return scarce_fails(&memory_left) ? NULL : __real_calloc(count, size);
}

void *__wrap_realloc(void *memory, size_t size)
{
    return scarce_fails(&memory_left) ? NULL : __real_realloc(memory, size);
}

char *__wrap_strdup(const char *text)
{
    return scarce_fails(&memory_left) ? NULL : __real_strdup(text);
}

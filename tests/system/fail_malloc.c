/*
 * For LD_PRELOAD: the allocation with the number in FAIL_AT fails, from 1; tells it on stderr. A
 * program that asks for less does not hear of it.
 */
#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

/* Of glibc, behind the names that are taken here. */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);

#define SEEN __attribute__((visibility("default")))

SEEN void *malloc(size_t size);
SEEN void *calloc(size_t count, size_t size);
SEEN void *realloc(void *memory, size_t size);

static bool fails(void)
{
    static const char said[] = "<allocation failed>\n";
    static atomic_long count;
    const char *number = getenv("FAIL_AT");

    if (!number || atomic_fetch_add(&count, 1) + 1 != atol(number))
        return false;
    if (write(STDERR_FILENO, said, sizeof said - 1) < 0)
        abort();
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size)
{
    return fails() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fails() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *memory, size_t size)
{
    return fails() ? NULL : __libc_realloc(memory, size);
}

#include "support/guard.h"

#include <check.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

void guard_init(struct guard *self, const void *bytes, size_t size)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t usable = (size / page + 1) * page;
    char *pages = mmap(NULL, usable + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1,
                       0);

    /* An assertion that holds takes memory, which runs out in some tests. */
    if (pages == MAP_FAILED || mprotect(pages + usable, page, PROT_NONE) != 0)
        ck_abort_msg("no memory with a guard page");
    *self = (struct guard){ pages + usable - size, pages, usable + page };
    if (size > 0)
        memcpy(self->bytes, bytes, size);
}

void guard_done(struct guard *self)
{
    munmap(self->pages, self->size);
}

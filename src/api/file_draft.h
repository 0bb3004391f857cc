/*
 * Replacing a file: whoever looks, also after a power cut at any moment, finds the old one or the
 * new one, whole.
 *
 *     struct file_draft draft;
 *     enum co_err err = file_draft_write(&draft, path, bytes, size);     on the disk, beside it
 *     if (err == CO_OK)
 *         err = file_draft_take(&draft);                                 or file_draft_drop()
 *
 * The draft is called PATH~, so that one that a power cut has left is used again, or removed where
 * it has the mode of a file that is read only. A symbolic link stays, what it leads to is replaced;
 * devices and pipes are not. The new file has the mode of the old one.
 *
 *   owner    of the draft: the caller
 *   locking  the draft is locked (flock): of two writers the second gets CO_ERR_AGAIN
 */
#ifndef CO_API_FILE_DRAFT_H
#define CO_API_FILE_DRAFT_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>

struct file_draft {
    int file;
    char *path, *temporary;
};

/* CO_ERR_NOT_FOUND: no such folder, CO_ERR_PERMISSION, CO_ERR_AGAIN, CO_ERR_IO, CO_ERR_MEMORY */
enum co_err file_draft_write(struct file_draft *self, const char *path, const void *bytes,
                             size_t size);
/* It becomes the file, and ends; CO_ERR_IO: perhaps not. */
enum co_err file_draft_take(struct file_draft *self);
void file_draft_drop(struct file_draft *self);

/* All of it to an open file of whatever kind; false: errno tells. */
bool file_write_all(int file, const char *bytes, size_t size);

#endif

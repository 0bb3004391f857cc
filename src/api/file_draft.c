#include "api/file_draft.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static enum co_err error_of_errno(void)
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR: return CO_ERR_NOT_FOUND;
    case EACCES:
    case EPERM:
    case EROFS: return CO_ERR_PERMISSION;
    case EWOULDBLOCK: return CO_ERR_AGAIN;
    case ENOMEM: return CO_ERR_MEMORY;
    default: return CO_ERR_IO;
    }
}

static void free_names(struct file_draft *self)
{
    free(self->path);
    free(self->temporary);
}

static enum co_err make_names(struct file_draft *self, const char *path)
{
    self->file = -1;
    self->path = realpath(path, NULL); /* not there yet: what the name says */
    if (!self->path)
        self->path = strdup(path);
    if (!self->path || asprintf(&self->temporary, "%s~", self->path) < 0) {
        free(self->path);
        return CO_ERR_MEMORY;
    }
    return CO_OK;
}

static bool is_same_file(int file, const char *name)
{
    struct stat opened, named;

    return fstat(file, &opened) == 0 && stat(name, &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

/* False, with errno: it is another's, or there is none. */
static bool lock_file(struct file_draft *self)
{
    if (flock(self->file, LOCK_EX | LOCK_NB) != 0)
        return false;
    if (is_same_file(self->file, self->temporary))
        return true;
    errno = EWOULDBLOCK; /* another one has just taken it */
    return false;
}

static enum co_err open_and_lock(struct file_draft *self, int flags)
{
    enum co_err err;

    self->file = open(self->temporary, flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (self->file >= 0 && lock_file(self))
        return CO_OK;
    err = error_of_errno();
    if (self->file >= 0)
        close(self->file);
    return err;
}

/* One with the mode of a file that is read only, of somebody who has been interrupted. */
static enum co_err remove_left(struct file_draft *self)
{
    const enum co_err err = open_and_lock(self, O_RDONLY);
    bool gone;

    if (err != CO_OK)
        return err;
    gone = unlink(self->temporary) == 0;
    close(self->file);
    return gone ? CO_OK : CO_ERR_PERMISSION;
}

static enum co_err open_draft(struct file_draft *self)
{
    const int flags = O_WRONLY | O_CREAT;
    enum co_err err = open_and_lock(self, flags), left;

    if (err != CO_ERR_PERMISSION)
        return err;
    left = remove_left(self);
    if (left == CO_OK)
        return open_and_lock(self, flags);
    return left == CO_ERR_AGAIN ? left : err;
}

/* Nothing but a file is replaced; it hands its mode on. */
static enum co_err take_mode(const struct file_draft *self)
{
    struct stat old;

    if (stat(self->path, &old) != 0)
        return errno == ENOENT ? CO_OK : error_of_errno();
    if (!S_ISREG(old.st_mode))
        return CO_ERR_IO;
    return fchmod(self->file, old.st_mode & 07777) == 0 ? CO_OK : error_of_errno();
}

bool file_write_all(int file, const char *bytes, size_t size)
{
    while (size > 0) {
        const ssize_t written = write(file, bytes, size);

        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return false;
        bytes += written;
        size -= (size_t)written;
    }
    return true;
}

static enum co_err fill(const struct file_draft *self, const void *bytes, size_t size)
{
    const enum co_err err = take_mode(self);

    if (err != CO_OK)
        return err;
    if (ftruncate(self->file, 0) == 0 && file_write_all(self->file, bytes, size) &&
        fsync(self->file) == 0)
        return CO_OK;
    return error_of_errno();
}

enum co_err file_draft_write(struct file_draft *self, const char *path, const void *bytes,
                             size_t size)
{
    enum co_err err = make_names(self, path);

    if (err != CO_OK)
        return err;
    err = open_draft(self);
    if (err != CO_OK) {
        free_names(self);
        return err;
    }
    err = fill(self, bytes, size);
    if (err != CO_OK)
        file_draft_drop(self);
    return err;
}

static int open_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    const int file = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;

    free(folder);
    return file;
}

/* The name, too, is to outlive a power cut; of a folder that nobody may read, with all else. */
static bool sync_name(const struct file_draft *self)
{
    const int folder = open_folder(self->path);
    bool good;

    if (folder < 0)
        return syncfs(self->file) == 0;
    good = fsync(folder) == 0;
    close(folder);
    return good;
}

enum co_err file_draft_take(struct file_draft *self)
{
    bool good;

    if (rename(self->temporary, self->path) != 0) {
        file_draft_drop(self);
        return CO_ERR_IO;
    }
    good = sync_name(self);
    close(self->file);
    free_names(self);
    return good ? CO_OK : CO_ERR_IO;
}

/* Its name is given up before its lock. */
void file_draft_drop(struct file_draft *self)
{
    unlink(self->temporary);
    close(self->file);
    free_names(self);
}

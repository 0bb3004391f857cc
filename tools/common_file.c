#include "common_file.h"

#include "api/file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool write_all(int file, const uint8_t *bytes, size_t size)
{
    while (size > 0) {
        ssize_t written = write(file, bytes, size);

        if (written < 0 && errno == EINTR)
            continue;
        if (written < 0)
            return false;
        bytes += written;
        size -= (size_t)written;
    }
    return true;
}

/* mkstemp() makes files for their owner only; others get what a new file would give them. */
static bool set_mode(int file)
{
    mode_t mask = umask(0);

    umask(mask);
    return fchmod(file, 0666 & ~mask) == 0;
}

static enum co_err write_temporary(char *temporary, const char *name, const uint8_t *bytes,
                                   size_t size)
{
    int file = mkstemp(temporary);
    bool good;
    int error;

    if (file < 0)
        return CO_ERR_IO;
    good = write_all(file, bytes, size) && set_mode(file) && fsync(file) == 0;
    error = errno;
    if (close(file) != 0 && good) {
        error = errno;
        good = false;
    }
    if (good && rename(temporary, name) == 0)
        return CO_OK;
    error = good ? errno : error;
    unlink(temporary);
    errno = error;
    return CO_ERR_IO;
}

/* Devices and pipes are written to, not replaced. */
static bool is_special(const char *name)
{
    struct stat status;

    return stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

static enum co_err write_special(const char *name, const uint8_t *bytes, size_t size)
{
    int file = open(name, O_WRONLY | O_CLOEXEC);
    bool good = file >= 0 && write_all(file, bytes, size);
    int error = errno;

    if (file >= 0)
        close(file);
    errno = error;
    return good ? CO_OK : CO_ERR_IO;
}

enum co_err file_write(const char *name, const uint8_t *bytes, size_t size)
{
    char *temporary;
    enum co_err err;
    int error;

    if (is_special(name))
        return write_special(name, bytes, size);
    if (asprintf(&temporary, "%s.XXXXXX", name) < 0)
        return CO_ERR_MEMORY;
    err = write_temporary(temporary, name, bytes, size);
    error = errno;
    free(temporary);
    errno = error;
    return err;
}

char *file_folder(const char *name)
{
    const char *slash = strrchr(name, '/');

    return slash ? strndup(name, (size_t)(slash - name) + 1) : strdup("");
}

void file_report_line(void *context, const struct co_message *message)
{
    (void)context;
    if (message->rule)
        fprintf(stderr, "%s [%s]\n", message->text, message->rule->name);
    else
        fprintf(stderr, "%s\n", message->text);
}

void file_tell(const char *tool, const char *name, enum co_err err)
{
    fprintf(stderr, "%s: %s: %s\n", tool, name,
            err == CO_ERR_IO ? strerror(errno) : file_error_text(err));
}

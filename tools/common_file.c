#include "common_file.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define SUFFIX ".XXXXXX"

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

enum co_err file_write(const char *name, const uint8_t *bytes, size_t size)
{
    char *temporary = malloc(strlen(name) + sizeof SUFFIX);
    enum co_err err;
    int error;

    if (!temporary)
        return CO_ERR_MEMORY;
    strcpy(temporary, name);
    strcat(temporary, SUFFIX);
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

void file_report_line(void *context, enum co_severity severity, const char *text)
{
    (void)context;
    (void)severity;
    fprintf(stderr, "%s\n", text);
}

void file_tell(const char *tool, const char *name, enum co_err err)
{
    fprintf(stderr, "%s: %s: %s\n", tool, name,
            err == CO_ERR_IO ? strerror(errno) : co_err_text(err));
}

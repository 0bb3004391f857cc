#include "api/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static enum co_err error_of_errno(void)
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR: return CO_ERR_NOT_FOUND;
    case EACCES: return CO_ERR_PERMISSION;
    case EISDIR: return CO_ERR_ARG;
    case EOVERFLOW: return CO_ERR_VALUE; /* too large for a 32-bit program to open */
    default: return CO_ERR_IO;
    }
}

struct reading {
    int file;
    struct stat status;
    char *text;
    size_t size, room;
};

/* Room for one byte more than there is, at least. */
static enum co_err make_room(struct reading *self)
{
    const bool tells_size = S_ISREG(self->status.st_mode) && self->status.st_size > 0;
    size_t room = self->room ? 2 * self->room : 65536;
    char *grown;

    if (self->size + 1 < self->room)
        return CO_OK;
    if (self->room == 0 && tells_size)
        room = (size_t)self->status.st_size + 2; /* and the end is seen with the next reading */
    grown = realloc(self->text, room);
    if (!grown)
        return CO_ERR_MEMORY;
    self->text = grown;
    self->room = room;
    return CO_OK;
}

static enum co_err await_more(const struct reading *self, int ms)
{
    struct pollfd poller = { .fd = self->file, .events = POLLIN };
    int ready;

    do
        ready = poll(&poller, 1, ms);
    while (ready < 0 && errno == EINTR);
    if (ready < 0)
        return error_of_errno();
    return ready == 0 ? CO_ERR_TIMEOUT : CO_OK;
}

/* A pipe that nobody has opened for writing yet looks as if it had ended. */
static bool is_end(const struct reading *self, bool waited)
{
    return waited || !S_ISFIFO(self->status.st_mode) || self->size > 0;
}

/* CO_ERR_AGAIN: there is more. */
static enum co_err read_some(struct reading *self, bool *waited)
{
    enum co_err err = make_room(self);
    ssize_t got;

    if (err != CO_OK)
        return err;
    got = read(self->file, self->text + self->size, self->room - self->size - 1);
    if (got < 0 && errno != EAGAIN && errno != EINTR)
        return error_of_errno();
    if (got == 0 && is_end(self, *waited))
        return CO_OK;
    *waited = got <= 0;
    if (got <= 0)
        err = await_more(self, got == 0 ? FILE_WRITER_MS : FILE_SILENCE_MS);
    else
        self->size += (size_t)got;
    if (self->size > FILE_SIZE_MAX)
        return CO_ERR_VALUE;
    return err == CO_OK ? CO_ERR_AGAIN : err;
}

/* Until the end: what cannot tell its size, a pipe, is read as well. */
static enum co_err read_whole(struct reading *self)
{
    bool waited = false;
    enum co_err err;

    if (fstat(self->file, &self->status) != 0)
        return error_of_errno();
    if (S_ISDIR(self->status.st_mode))
        return CO_ERR_ARG;
    if (S_ISREG(self->status.st_mode) && self->status.st_size > (off_t)FILE_SIZE_MAX)
        return CO_ERR_VALUE;
    do
        err = read_some(self, &waited);
    while (err == CO_ERR_AGAIN);
    return err;
}

static enum co_err read_open(int file, char **ret_text, size_t *ret_size)
{
    struct reading reading = { .file = file };
    enum co_err err = read_whole(&reading);
    char *fitting;

    if (err != CO_OK) {
        free(reading.text);
        return err;
    }
    reading.text[reading.size] = '\0';
    fitting = realloc(reading.text, reading.size + 1);
    *ret_text = fitting ? fitting : reading.text;
    *ret_size = reading.size;
    return CO_OK;
}

enum co_err file_read_stream(FILE *stream, char **ret_text, size_t *ret_size)
{
    return read_open(fileno(stream), ret_text, ret_size);
}

enum co_err file_read(const char *path, char **ret_text, size_t *ret_size)
{
    /* A pipe without a writer would keep an open() that waits for one. */
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    enum co_err err;
    int error;

    if (file < 0)
        return error_of_errno();
    err = read_open(file, ret_text, ret_size);
    error = errno;
    close(file);
    errno = error;
    return err;
}

const char *file_error_text(enum co_err err)
{
    if (err == CO_ERR_NOT_FOUND)
        return "no such file";
    if (err == CO_ERR_ARG)
        return "a folder, expected a file";
    if (err == CO_ERR_VALUE)
        return "larger than 64 MiB";
    if (err == CO_ERR_TIMEOUT)
        return "nothing comes out of this pipe or device";
    if (err == CO_ERR_IO && errno != 0)
        return strerror(errno);
    return co_err_text(err);
}

/* "folder/name", the folder up to folder_size; nothing in front where there is no folder. */
static char *join(const char *folder, size_t folder_size, const char *name)
{
    char *path = NULL;

    if (asprintf(&path, "%.*s%s%s", (int)folder_size, folder,
                 folder_size && folder[folder_size - 1] != '/' ? "/" : "", name) < 0)
        return NULL;
    return path;
}

/* Takes the path over when it is a file, frees it else. */
static bool is_there(char *path, char **ret_path)
{
    if (!path || access(path, F_OK) != 0) {
        free(path);
        return false;
    }
    *ret_path = path;
    return true;
}

/* The entry of the folder that has this name, in other cases if need be; NULL: none. */
static char *alike_in(const char *folder, const char *name)
{
    char *exact = join(folder, strlen(folder), name), *found = NULL;
    const struct dirent *entry;
    DIR *entries;

    if (is_there(exact, &found))
        return found;
    entries = opendir(folder[0] != '\0' ? folder : ".");
    while (entries && !found && (entry = readdir(entries)))
        if (strcasecmp(entry->d_name, name) == 0)
            found = join(folder, strlen(folder), entry->d_name);
    if (entries)
        closedir(entries);
    return found;
}

/* As is_there(), for who does not tell cases apart, nor \ from /. */
static bool is_alike(char *path, char **ret_path)
{
    const bool absolute = path && path[0] == '/';
    char *found = path ? strdup(absolute ? "/" : "") : NULL;
    char *rest = NULL;

    for (char *part = path ? strtok_r(path, "/\\", &rest) : NULL; found && part;
         part = strtok_r(NULL, "/\\", &rest)) {
        char *longer = alike_in(found, part);

        free(found);
        found = longer;
    }
    free(path);
    if (found && found[0] == '\0') { /* there was no part */
        free(found);
        found = NULL;
    }
    *ret_path = found;
    return found != NULL;
}

typedef bool looker(char *path, char **ret_path);

static bool find_below(looker *look, const char *folder, size_t folder_size, const char *name,
                       char **ret_path)
{
    return look(join(folder, folder_size, name), ret_path);
}

static bool find(looker *look, const struct network_config *config, const char *xml_path,
                 const char *name, char **ret_path)
{
    const char *slash = strrchr(xml_path, '/');
    const size_t xml_folder = slash ? (size_t)(slash - xml_path) + 1 : 0;
    const char *repository = config->repository;
    char *folder;
    bool found;

    if (look(strdup(name), ret_path))
        return true;
    if (name[0] == '/')
        return false;
    if (repository && find_below(look, repository, strlen(repository), name, ret_path))
        return true;
    if (find_below(look, xml_path, xml_folder, name, ret_path))
        return true;
    if (!repository || repository[0] == '/')
        return false;
    folder = join(xml_path, xml_folder, repository);
    found = folder && find_below(look, folder, strlen(folder), name, ret_path);
    free(folder);
    return found;
}

enum co_err file_find(const struct network_config *config, const char *xml_path, const char *name,
                      char **ret_path)
{
    if (find(is_there, config, xml_path, name, ret_path))
        return CO_OK;
    *ret_path = strdup(name);
    return *ret_path ? CO_OK : CO_ERR_MEMORY;
}

char *file_find_alike(const struct network_config *config, const char *xml_path, const char *name)
{
    char *path = NULL;

    return find(is_alike, config, xml_path, name, &path) ? path : NULL;
}

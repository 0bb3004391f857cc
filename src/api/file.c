#include "api/file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static enum co_err error_of_errno(void)
{
    switch (errno) {
    case ENOENT:
    case ENOTDIR: return CO_ERR_NOT_FOUND;
    case EACCES: return CO_ERR_PERMISSION;
    case EISDIR: return CO_ERR_ARG;
    default: return CO_ERR_IO;
    }
}

/* Until the end: what cannot tell its size, a pipe, is read as well. */
static enum co_err read_stream(FILE *stream, char **text, size_t *size)
{
    size_t room = 0;

    *size = 0;
    do {
        if (*size + 1 >= room) {
            char *grown = realloc(*text, room = room ? 2 * room : 65536);

            if (!grown)
                return CO_ERR_MEMORY;
            *text = grown;
        }
        *size += fread(*text + *size, 1, room - *size - 1, stream);
        if (ferror(stream))
            return error_of_errno();
        if (*size > FILE_SIZE_MAX)
            return CO_ERR_VALUE;
    } while (!feof(stream));
    (*text)[*size] = '\0';
    return CO_OK;
}

enum co_err file_read_stream(FILE *stream, char **ret_text, size_t *ret_size)
{
    char *text = NULL;
    size_t size;
    enum co_err err = read_stream(stream, &text, &size);
    char *fitting;

    if (err != CO_OK) {
        free(text);
        return err;
    }
    fitting = realloc(text, size + 1);
    *ret_text = fitting ? fitting : text;
    *ret_size = size;
    return CO_OK;
}

enum co_err file_read(const char *path, char **ret_text, size_t *ret_size)
{
    FILE *stream = fopen(path, "re");
    enum co_err err;

    if (!stream)
        return error_of_errno();
    err = file_read_stream(stream, ret_text, ret_size);
    fclose(stream);
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

static bool is_below(const char *folder, size_t folder_size, const char *name, char **ret_path)
{
    return is_there(join(folder, folder_size, name), ret_path);
}

enum co_err file_find(const struct network_config *config, const char *xml_path, const char *name,
                      char **ret_path)
{
    const char *slash = strrchr(xml_path, '/');
    size_t xml_folder = slash ? (size_t)(slash - xml_path) + 1 : 0;
    const char *repository = config->repository;

    if (is_there(strdup(name), ret_path))
        return CO_OK;
    if (name[0] != '/') {
        if (repository && is_below(repository, strlen(repository), name, ret_path))
            return CO_OK;
        if (is_below(xml_path, xml_folder, name, ret_path))
            return CO_OK;
        if (repository && repository[0] != '/') {
            char *folder = join(xml_path, xml_folder, repository);
            bool found = folder && is_below(folder, strlen(folder), name, ret_path);

            free(folder);
            if (found)
                return CO_OK;
        }
    }
    *ret_path = strdup(name);
    return *ret_path ? CO_OK : CO_ERR_MEMORY;
}

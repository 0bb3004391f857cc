/*
 * The files that the arguments of dcftest stand for.
 *
 * Links to files count as files; those to folders are not followed, so there are no loops. (The
 * functions of <fts.h> crash where there is no memory.)
 */
#include "dcftest.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static bool add(struct files *self, const char *path, int error)
{
    if (self->count == self->room) {
        const size_t room = self->room ? 2 * self->room : 64;
        struct file *grown = reallocarray(self->list, room, sizeof *grown);

        if (!grown)
            return false;
        self->list = grown;
        self->room = room;
    }
    self->list[self->count].path = strdup(path);
    self->list[self->count].error = error;
    return self->list[self->count].path != NULL && ++self->count > 0;
}

static bool has_ending(const char *name)
{
    const char *dot = strrchr(name, '.');

    return dot && (strcasecmp(dot, ".eds") == 0 || strcasecmp(dot, ".dcf") == 0);
}

static bool add_folder(struct files *self, const char *folder);

static bool add_path(struct files *self, const char *path)
{
    struct stat status;

    if (lstat(path, &status) != 0)
        return add(self, path, errno);
    if (S_ISDIR(status.st_mode))
        return add_folder(self, path);
    if (!has_ending(path))
        return true;
    if (S_ISLNK(status.st_mode) && stat(path, &status) == 0 && !S_ISREG(status.st_mode))
        return true;
    return S_ISREG(status.st_mode) || S_ISLNK(status.st_mode) ? add(self, path, 0) : true;
}

static bool add_name(struct files *self, const char *folder, const char *name)
{
    const size_t size = strlen(folder);
    char *path;
    bool good;

    if (strcmp(name, ".") == 0 || strcmp(name, "..") == 0)
        return true;
    if (asprintf(&path, "%s%s%s", folder, size > 0 && folder[size - 1] == '/' ? "" : "/", name) < 0)
        return false;
    good = add_path(self, path);
    free(path);
    return good;
}

static int by_name(const struct dirent **left, const struct dirent **right)
{
    return strcmp((*left)->d_name, (*right)->d_name);
}

/* As deep as paths can be long. */
static bool add_folder(struct files *self, const char *folder)
{
    struct dirent **names = NULL;
    const int count = scandir(folder, &names, NULL, by_name);
    bool good = true;

    if (count < 0)
        return errno != ENOMEM && add(self, folder, errno);
    for (int i = 0; i < count; i++) {
        good = good && add_name(self, folder, names[i]->d_name);
        free(names[i]);
    }
    free(names);
    return good;
}

static bool add_root(struct files *self, const char *folder)
{
    const size_t before = self->count;

    return add_folder(self, folder) && (self->count > before || add(self, folder, NOTHING_IN_IT));
}

bool files_add(struct files *self, const char *argument)
{
    struct stat status;

    if (strcmp(argument, "-") == 0)
        return add(self, argument, 0);
    if (stat(argument, &status) != 0)
        return add(self, argument, errno);
    return S_ISDIR(status.st_mode) ? add_root(self, argument) : add(self, argument, 0);
}

void files_done(struct files *self)
{
    for (size_t i = 0; i < self->count; i++)
        free(self->list[i].path);
    free(self->list);
    *self = (struct files){ .list = NULL };
}

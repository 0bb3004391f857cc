/* The files that the arguments of dcftest stand for. */
#include "dcftest.h"

#include <errno.h>
#include <fts.h>
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

/* Links to files count as files; those to folders are not followed, so there are no loops. */
static bool is_wanted(const FTSENT *entry)
{
    struct stat status;

    if (!has_ending(entry->fts_name))
        return false;
    if (entry->fts_info == FTS_SL)
        return stat(entry->fts_accpath, &status) != 0 || S_ISREG(status.st_mode);
    return entry->fts_info == FTS_F || entry->fts_info == FTS_SLNONE;
}

static bool add_entry(struct files *self, const FTSENT *entry)
{
    switch (entry->fts_info) {
    case FTS_DNR:
    case FTS_ERR:
    case FTS_NS: return add(self, entry->fts_path, entry->fts_errno);
    default: return is_wanted(entry) ? add(self, entry->fts_path, 0) : true;
    }
}

static int by_name(const FTSENT **left, const FTSENT **right)
{
    return strcmp((*left)->fts_name, (*right)->fts_name);
}

static bool add_folder(struct files *self, const char *folder)
{
    char *const paths[] = { strdup(folder), NULL };
    const size_t before = self->count;
    FTSENT *entry;
    FTS *tree;
    bool good = paths[0] != NULL;

    if (!good)
        return false;
    tree = fts_open(paths, FTS_PHYSICAL | FTS_COMFOLLOW | FTS_NOCHDIR, by_name);
    good = tree != NULL;
    while (good && (errno = 0, entry = fts_read(tree)) != NULL)
        good = add_entry(self, entry);
    if (good && errno != 0)
        good = add(self, folder, errno);
    if (good && self->count == before)
        good = add(self, folder, NOTHING_IN_IT);
    if (tree)
        fts_close(tree);
    free(paths[0]);
    return good;
}

bool files_add(struct files *self, const char *argument)
{
    struct stat status;

    if (stat(argument, &status) != 0)
        return add(self, argument, errno);
    return S_ISDIR(status.st_mode) ? add_folder(self, argument) : add(self, argument, 0);
}

void files_done(struct files *self)
{
    for (size_t i = 0; i < self->count; i++)
        free(self->list[i].path);
    free(self->list);
    *self = (struct files){ .list = NULL };
}

#include "dcf2ccf_files.h"

#include "common_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool tell(const char *name, const char *text)
{
    fprintf(stderr, "dcf2ccf: %s: %s\n", name, text);
    return false;
}

static bool tell_error(const char *name, enum co_err err)
{
    if (err == CO_ERR_NOT_FOUND)
        return tell(name, "no such folder");
    if (err == CO_ERR_AGAIN)
        return tell(name, "another program is writing it");
    file_tell("dcf2ccf", name, err);
    return false;
}

bool ccf_files_read(struct ccf_files *self, const char *name)
{
    char **grown = realloc(self->read, (self->read_count + 1) * sizeof *grown);
    char *copy = strdup(name);

    if (grown)
        self->read = grown;
    if (!grown || !copy) {
        free(copy);
        return tell_error(name, CO_ERR_MEMORY);
    }
    self->read[self->read_count++] = copy;
    return true;
}

static bool is_same_file(const char *name, const struct stat *status)
{
    struct stat other;

    return stat(name, &other) == 0 && other.st_dev == status->st_dev &&
           other.st_ino == status->st_ino;
}

static bool has_read(const struct ccf_files *self, const struct stat *status)
{
    for (size_t i = 0; i < self->read_count; i++) {
        if (is_same_file(self->read[i], status))
            return true;
    }
    return false;
}

static bool write_special(const char *name, const void *bytes, size_t size)
{
    const bool is_stdout = strcmp(name, "-") == 0;
    const int file = is_stdout ? STDOUT_FILENO : open(name, O_WRONLY | O_CLOEXEC);
    const bool good = file >= 0 && file_write_all(file, bytes, size);
    const int error = errno;

    if (file >= 0 && !is_stdout)
        close(file);
    return good || tell(is_stdout ? "standard output" : name, strerror(error));
}

/* Devices and pipes are written to, not replaced. */
static bool is_special(const char *name)
{
    struct stat status;

    return strcmp(name, "-") == 0 ||
           (stat(name, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode));
}

static bool write_one(struct ccf_output *output, const void *bytes, size_t size)
{
    enum co_err err;

    if (is_special(output->name))
        return write_special(output->name, bytes, size);
    err = file_draft_write(&output->draft, output->name, bytes, size);
    output->is_draft = err == CO_OK;
    return output->is_draft || tell_error(output->name, err);
}

static bool may_write(const struct ccf_files *self, const char *name)
{
    struct stat status;

    if (strcmp(name, "-") == 0 || stat(name, &status) != 0)
        return true;
    if (S_ISDIR(status.st_mode))
        return tell(name, "a folder, expected a file");
    if (S_ISREG(status.st_mode) && has_read(self, &status))
        return tell(name, "an input, expected another file as output");
    return true;
}

bool ccf_files_write(struct ccf_files *self, const char *name, const void *bytes, size_t size)
{
    struct ccf_output output = { .is_draft = false };
    struct ccf_output *grown;

    if (!may_write(self, name))
        return false;
    grown = realloc(self->written, (self->written_count + 1) * sizeof *grown);
    if (grown)
        self->written = grown;
    output.name = strdup(name);
    if (!grown || !output.name) {
        free(output.name);
        return tell_error(name, CO_ERR_MEMORY);
    }
    self->written[self->written_count] = output;
    return write_one(&self->written[self->written_count++], bytes, size);
}

/* As make and ninja read names: backslashes mean something before a blank and "#" only. */
static void put_character(FILE *stream, const char *name)
{
    const size_t backslashes = strspn(name, "\\");
    const char next = name[backslashes];

    if (*name == '$')
        fputc('$', stream);
    else if (next == ' ' || next == '#')
        fputc('\\', stream);
    fputc(*name, stream);
}

/* False: such files have no way to write this name. */
static bool put_name(FILE *stream, const char *name)
{
    for (; *name != '\0'; name++) {
        if ((unsigned char)*name < ' ')
            return false;
        put_character(stream, name);
    }
    return true;
}

static bool put_dependencies(const struct ccf_files *self, FILE *stream)
{
    bool good = true;

    for (size_t i = 0; i < self->written_count; i++) {
        good = put_name(stream, self->written[i].name) && good;
        fputs(i + 1 < self->written_count ? " " : ":", stream);
    }
    for (size_t i = 0; i < self->read_count; i++) {
        fputs(" \\\n  ", stream);
        good = put_name(stream, self->read[i]) && good;
    }
    fputc('\n', stream);
    return good;
}

/* One that is gone is no error to make, which then asks anew what the outputs depend on. */
static void put_without_rules(const struct ccf_files *self, FILE *stream)
{
    for (size_t i = 1; i < self->read_count; i++) {
        put_name(stream, self->read[i]);
        fputs(":\n", stream);
    }
}

bool ccf_files_write_rule(struct ccf_files *self, const char *name)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    bool good;

    if (!stream)
        return tell_error(name, CO_ERR_MEMORY);
    good = put_dependencies(self, stream);
    put_without_rules(self, stream);
    if (fclose(stream) != 0) {
        free(text);
        return tell_error(name, CO_ERR_MEMORY);
    }
    good = good ? ccf_files_write(self, name, text, size)
                : tell(name, "a file whose name has control characters cannot stand in it");
    free(text);
    return good;
}

bool ccf_files_take(struct ccf_files *self)
{
    bool good = true;

    for (size_t i = 0; i < self->written_count; i++) {
        struct ccf_output *output = &self->written[i];
        enum co_err err = output->is_draft ? file_draft_take(&output->draft) : CO_OK;

        output->is_draft = false;
        if (err != CO_OK)
            good = tell_error(output->name, err);
    }
    return good;
}

void ccf_files_done(struct ccf_files *self)
{
    for (size_t i = 0; i < self->written_count; i++) {
        if (self->written[i].is_draft)
            file_draft_drop(&self->written[i].draft);
        free(self->written[i].name);
    }
    for (size_t i = 0; i < self->read_count; i++)
        free(self->read[i]);
    free(self->written);
    free(self->read);
}

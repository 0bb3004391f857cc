#include "common_file.h"

#include "api/file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum co_err file_read_input(const char *name, char **ret_text, size_t *ret_size)
{
    if (strcmp(name, "-") == 0)
        return file_read_stream(stdin, ret_text, ret_size);
    return file_read(name, ret_text, ret_size);
}

const char *file_input_name(const char *name)
{
    return strcmp(name, "-") == 0 ? "stdin" : name;
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

void file_report_error(void *context, const struct co_message *message)
{
    if (message->severity == CO_ERROR)
        file_report_line(context, message);
}

void file_tell(const char *tool, const char *name, enum co_err err)
{
    fprintf(stderr, "%s: %s: %s\n", tool, name,
            err == CO_ERR_IO ? strerror(errno) : file_error_text(err));
}

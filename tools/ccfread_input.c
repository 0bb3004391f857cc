#include "ccfread_input.h"

#include "common_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the table has shown by now stands before the message. */
static void tell(void *context, const struct co_message *message)
{
    struct input *self = context;

    if (message->severity == CO_ERROR)
        snprintf(self->error, sizeof self->error, "%s", message->body);
    fflush(stdout);
    file_report_line(NULL, message);
}

static bool read_all(const char *name, char **ret_text, size_t *ret_size)
{
    enum co_err err = file_read_input(name, ret_text, ret_size);

    if (err != CO_OK)
        file_tell("ccfread", file_input_name(name), err);
    return err == CO_OK;
}

bool input_read(struct input *self, const char *name)
{
    char *text;

    *self = (struct input){ .name = file_input_name(name) };
    self->report = (struct co_report){ .file = self->name, .sink = tell, .context = self };
    if (!read_all(name, &text, &self->size))
        return false;
    self->bytes = (uint8_t *)text;
    return true;
}

void input_done(struct input *self)
{
    free(self->bytes);
    self->bytes = NULL;
}

/* Warnings are for dcftest to tell. */
bool input_read_eds(const char *name, struct dcf *ret_dcf)
{
    struct co_report report = { .file = file_input_name(name), .sink = file_report_error };
    enum co_err err;
    size_t size;
    char *text;

    if (!read_all(name, &text, &size))
        return false;
    err = dcf_parse(text, size, &report, ret_dcf);
    free(text);
    if (err == CO_ERR_MEMORY)
        file_tell("ccfread", report.file, err);
    return err == CO_OK;
}

int input_tell_output(void)
{
    fprintf(stderr, "ccfread: standard output: %s\n",
            ferror(stdout) ? strerror(errno) : co_err_text(CO_ERR_MEMORY));
    return EXIT_TROUBLE;
}

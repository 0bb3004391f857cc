#include "dcf2ccf.h"

#include "api/file.h"
#include "common_file.h"
#include "dcf/dcf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* For DownloadFile. */
struct beside {
    const char *folder;
    struct ccf_files *files;
};

static bool is_stream(const char *name)
{
    return strcmp(name, "-") == 0;
}

/* A file named in the DCF, beside it or below. */
static enum co_err read_beside(void *context, const char *name, uint8_t **ret_bytes,
                               size_t *ret_size)
{
    const struct beside *self = context;
    char *path, *text = NULL;
    enum co_err err;

    if (asprintf(&path, "%s%s", self->folder, name) < 0)
        return CO_ERR_MEMORY;
    err = file_read(path, &text, ret_size);
    if (err == CO_OK && !ccf_files_read(self->files, path)) {
        free(text);
        err = CO_ERR_MEMORY;
    }
    if (err == CO_OK)
        *ret_bytes = (uint8_t *)text;
    else
        file_tell("dcf2ccf", path, err);
    free(path);
    return err;
}

static uint8_t find_node_id(const struct dcf2ccf_arguments *arguments, const struct dcf *dcf,
                            struct co_report *report)
{
    if (arguments->node_id != 0)
        return arguments->node_id;
    if (dcf->has_node_id)
        return dcf->node_id;
    co_report_add(report, CO_WARNING, dcf->node_id_line,
                  "a NodeID of 1..127 expected, there is none: give one with -n where $NODEID "
                  "is used");
    return 0;
}

static enum co_err make_ccf(const struct dcf2ccf_arguments *arguments, const struct dcf *dcf,
                            struct ccf_files *files, struct co_report *report, struct ccf *ret_ccf)
{
    char *folder = is_stream(arguments->input) ? strdup("") : file_folder(arguments->input);
    struct beside beside = { .folder = folder, .files = files };
    struct dcf_ccf_options options = { .node_id = find_node_id(arguments, dcf, report),
                                       .old_style = arguments->old_style,
                                       .all = arguments->all,
                                       .read_file = read_beside,
                                       .context = &beside };
    enum co_err err = folder ? dcf_make_ccf(dcf, &options, report, ret_ccf) : CO_ERR_MEMORY;

    free(folder);
    if (err == CO_OK && ccf_count(ret_ccf) == 0)
        co_report_add(report, CO_WARNING, 0, "nothing to write: no writable entry has a %s",
                      arguments->all ? "value"
                                     : "ParameterValue (--all writes DefaultValues as well)");
    return err;
}

static bool convert(const struct dcf2ccf_arguments *arguments, const char *text, size_t size,
                    struct ccf_files *files, struct ccf *ret_ccf)
{
    struct co_report report = { .file = is_stream(arguments->input) ? "stdin" : arguments->input,
                                .sink = arguments->quiet ? file_report_error : file_report_line };
    struct dcf dcf;
    enum co_err err = dcf_parse(text, size, &report, &dcf);

    if (err == CO_OK)
        err = make_ccf(arguments, &dcf, files, &report, ret_ccf);
    if (err == CO_ERR_MEMORY)
        file_tell("dcf2ccf", arguments->input, err);
    dcf_done(&dcf);
    return err == CO_OK;
}

/* INPUT with the ending .ccf; freed by free(). */
static char *default_output(const char *input)
{
    const char *slash = strrchr(input, '/');
    const char *dot = strrchr(input, '.');
    bool ends = dot && dot > (slash ? slash + 1 : input);
    char *output;

    if (is_stream(input))
        return strdup(input);
    if (asprintf(&output, "%.*s.ccf", ends ? (int)(dot - input) : (int)strlen(input), input) < 0)
        return NULL;
    return output;
}

static bool write_output(const struct dcf2ccf_arguments *arguments, const struct ccf *ccf,
                         struct ccf_files *files)
{
    char *name = arguments->output ? strdup(arguments->output) : default_output(arguments->input);
    bool good = false;

    if (name)
        good = ccf_files_write(files, name, ccf->bytes, ccf->size);
    else
        file_tell("dcf2ccf", arguments->input, CO_ERR_MEMORY);
    free(name);
    return good;
}

bool dcf2ccf_convert(const struct dcf2ccf_arguments *arguments, struct ccf_files *files)
{
    const char *name = file_input_name(arguments->input);
    struct ccf ccf;
    char *text;
    size_t size;
    enum co_err err = file_read_input(arguments->input, &text, &size);
    bool good;

    if (err != CO_OK) {
        file_tell("dcf2ccf", name, err);
        return false;
    }
    ccf_init(&ccf);
    good = (is_stream(arguments->input) || ccf_files_read(files, name)) &&
           convert(arguments, text, size, files, &ccf) && write_output(arguments, &ccf, files);
    free(text);
    ccf_done(&ccf);
    return good;
}

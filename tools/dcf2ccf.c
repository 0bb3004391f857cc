/* dcf2ccf: a device configuration file (DCF) as the concise DCF that configures the device. */
#include "api/file.h"
#include "common_file.h"
#include "common_tool.h"
#include "dcf/dcf.h"

#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXIT_TROUBLE 2

struct arguments {
    const char *input;
    const char *output; /* NULL: the input's name with .ccf */
    uint8_t node_id;    /* 0: that of the file */
    bool old_style, all;
};

static const char help[] =
    "Usage: dcf2ccf [OPTION]... INPUT.dcf [OUTPUT.ccf]\n"
    "\n"
    "Converts a device configuration file (CiA 306) to a concise DCF (CiA 302-3): the writes that\n"
    "bring the device to the ParameterValues of the file, in the order that devices need.\n"
    "\n"
    "  -n, --node-id ID   node-ID for $NODEID, 1..127 (default: NodeID of the file)\n"
    "  -o, --output FILE  the file to write (default: INPUT with the ending .ccf)\n"
    "      --all          entries without a ParameterValue as well, with their DefaultValue\n"
    "      --old-style    PDO mapping: the number of entries first, then the entries\n"
    "  -h, --help         shows this\n"
    "      --version      shows the version\n"
    "\n"
    "Exit codes: 0 converted, perhaps with warnings; 2 wrong usage, or an error in a file.\n";

enum { OPTION_ALL = 256, OPTION_OLD_STYLE, OPTION_VERSION };

static const struct option options[] = {
    { "node-id", required_argument, NULL, 'n' },
    { "output", required_argument, NULL, 'o' },
    { "all", no_argument, NULL, OPTION_ALL },
    { "old-style", no_argument, NULL, OPTION_OLD_STYLE },
    { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION },
    { NULL, 0, NULL, 0 },
};

static int usage_error(const char *what)
{
    fprintf(stderr, "dcf2ccf: %s\nTry 'dcf2ccf --help'.\n", what);
    return EXIT_TROUBLE;
}

/* -1: go on; else the exit code */
static int parse_options(int argc, char **argv, struct arguments *arguments)
{
    int option;

    while ((option = getopt_long(argc, argv, "n:o:h", options, NULL)) != -1) {
        switch (option) {
        case 'n':
            if (!tool_node_id(optarg, &arguments->node_id))
                return usage_error("-n: a node-ID of 1..127 expected");
            break;
        case 'o': arguments->output = optarg; break;
        case OPTION_ALL: arguments->all = true; break;
        case OPTION_OLD_STYLE: arguments->old_style = true; break;
        case 'h': return fputs(help, stdout) < 0 ? EXIT_TROUBLE : 0;
        case OPTION_VERSION: return tool_print_version("dcf2ccf") ? 0 : EXIT_TROUBLE;
        default: return usage_error("unknown option, or one without its value");
        }
    }
    return -1;
}

static int parse_arguments(int argc, char **argv, struct arguments *arguments)
{
    int result = parse_options(argc, argv, arguments);

    if (result >= 0)
        return result;
    if (optind < argc)
        arguments->input = argv[optind++];
    if (optind < argc && arguments->output)
        return usage_error("one output file expected, there are two");
    if (optind < argc)
        arguments->output = argv[optind++];
    if (optind < argc)
        return usage_error("more than an input and an output file");
    return arguments->input ? -1 : usage_error("an input file expected");
}

/* A file named in the DCF, beside it or below. */
static enum co_err read_beside(void *context, const char *name, uint8_t **ret_bytes,
                               size_t *ret_size)
{
    const char *folder = context;
    char *path, *text = NULL;
    enum co_err err;

    if (asprintf(&path, "%s%s", folder, name) < 0)
        return CO_ERR_MEMORY;
    err = file_read(path, &text, ret_size);
    if (err == CO_OK)
        *ret_bytes = (uint8_t *)text;
    else
        file_tell("dcf2ccf", path, err);
    free(path);
    return err;
}

static enum co_err make_ccf(const struct arguments *arguments, const struct dcf *dcf,
                            struct co_report *report, struct ccf *ret_ccf)
{
    struct dcf_ccf_options ccf_options = { .node_id = arguments->node_id,
                                           .old_style = arguments->old_style,
                                           .all = arguments->all,
                                           .read_file = read_beside };
    char *folder = file_folder(arguments->input);
    enum co_err err;

    if (!folder)
        return CO_ERR_MEMORY;
    if (ccf_options.node_id == 0 && dcf->has_node_id)
        ccf_options.node_id = dcf->node_id;
    if (ccf_options.node_id == 0)
        co_report_add(report, CO_WARNING, dcf->node_id_line,
                      "a NodeID of 1..127 expected, there is none: give one with -n where $NODEID "
                      "is used");
    ccf_options.context = folder;
    err = dcf_make_ccf(dcf, &ccf_options, report, ret_ccf);
    free(folder);
    return err;
}

static enum co_err convert(const struct arguments *arguments, const char *text, size_t size,
                           struct ccf *ret_ccf)
{
    struct co_report report = { .file = arguments->input, .sink = file_report_line };
    struct dcf dcf;
    enum co_err err = dcf_parse(text, size, &report, &dcf);

    if (err == CO_OK)
        err = make_ccf(arguments, &dcf, &report, ret_ccf);
    if (err == CO_ERR_MEMORY)
        file_tell("dcf2ccf", arguments->input, err);
    dcf_done(&dcf);
    return err;
}

/* INPUT with the ending .ccf; freed by free(). */
static char *default_output(const char *input)
{
    const char *slash = strrchr(input, '/');
    const char *dot = strrchr(input, '.');
    bool ends = dot && dot > (slash ? slash + 1 : input);
    char *output;

    if (asprintf(&output, "%.*s.ccf", ends ? (int)(dot - input) : (int)strlen(input), input) < 0)
        return NULL;
    return output;
}

static enum co_err write_output(const struct arguments *arguments, const struct ccf *ccf)
{
    char *name = arguments->output ? strdup(arguments->output) : default_output(arguments->input);
    enum co_err err = CO_ERR_MEMORY;

    if (!name)
        return err;
    if (strcmp(name, arguments->input) == 0) {
        errno = EEXIST;
        err = CO_ERR_IO;
    } else {
        err = file_write(name, ccf->bytes, ccf->size);
    }
    if (err != CO_OK)
        file_tell("dcf2ccf", name, err);
    free(name);
    return err;
}

static enum co_err run(const struct arguments *arguments)
{
    struct ccf ccf;
    char *text;
    size_t size;
    enum co_err err = file_read(arguments->input, &text, &size);

    if (err != CO_OK) {
        file_tell("dcf2ccf", arguments->input, err);
        return err;
    }
    ccf_init(&ccf);
    err = convert(arguments, text, size, &ccf);
    free(text);
    if (err == CO_OK)
        err = write_output(arguments, &ccf);
    ccf_done(&ccf);
    return err;
}

int main(int argc, char **argv)
{
    struct arguments arguments = { .input = NULL };
    int result;

    if (argc < 2) {
        fputs(help, stderr);
        return EXIT_TROUBLE;
    }
    result = parse_arguments(argc, argv, &arguments);
    if (result >= 0)
        return result;
    return run(&arguments) == CO_OK ? 0 : EXIT_TROUBLE;
}

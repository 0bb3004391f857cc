/* ccfread: what is in concise DCFs, and what two of them do differently. */
#include "ccfread_diff.h"
#include "ccfread_input.h"
#include "ccfread_show.h"
#include "common_tool.h"

#include <getopt.h>
#include <stdio.h>

struct arguments {
    const char *eds; /* NULL: none */
    bool json;
    bool diff;
};

static const char help[] =
    "Usage: ccfread [OPTION]... FILE.ccf...\n"
    "       ccfread [OPTION]... --diff A.ccf B.ccf\n"
    "\n"
    "Shows the entries of concise DCFs (CiA 302-3) in their order: where each begins in the file,\n"
    "index:sub-index, size in bytes, and the value. A damaged file is shown up to the damage.\n"
    "FILE may be -, for stdin.\n"
    "\n"
    "  -e, --eds FILE  takes types and names from this EDS or DCF, and warns about entries that\n"
    "                  it does not have, or has with another size, or read-only\n"
    "      --diff      shows what differs from A to B: entries removed, added, changed or moved\n"
    "      --json      as JSON\n"
    "  -h, --help      shows this\n"
    "      --version   shows the version\n"
    "\n"
    "Exit codes: 0 shown, or no difference; 1 a damaged file, or differences; 2 wrong usage, or a\n"
    "file that cannot be read.\n";

enum { OPTION_JSON = 256, OPTION_DIFF, OPTION_VERSION };

static const struct option options[] = {
    { "eds", required_argument, NULL, 'e' },          { "diff", no_argument, NULL, OPTION_DIFF },
    { "json", no_argument, NULL, OPTION_JSON },       { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION }, { NULL, 0, NULL, 0 },
};

/* NULL: getopt_long() has told it. */
static int usage_error(const char *what)
{
    if (what)
        fprintf(stderr, "ccfread: %s\n", what);
    fputs("Try 'ccfread --help'.\n", stderr);
    return EXIT_TROUBLE;
}

/* -1: go on; else the exit code */
static int parse_arguments(int argc, char **argv, struct arguments *arguments)
{
    int option;

    while ((option = getopt_long(argc, argv, "e:h", options, NULL)) != -1) {
        switch (option) {
        case 'e': arguments->eds = optarg; break;
        case OPTION_DIFF: arguments->diff = true; break;
        case OPTION_JSON: arguments->json = true; break;
        case 'h': return fputs(help, stdout) < 0 ? EXIT_TROUBLE : EXIT_GOOD;
        case OPTION_VERSION: return tool_print_version("ccfread") ? EXIT_GOOD : EXIT_TROUBLE;
        default: return usage_error(NULL);
        }
    }
    if (optind == argc)
        return usage_error("a file expected");
    if (arguments->diff && optind + 2 != argc)
        return usage_error("--diff: two files expected");
    return -1;
}

static int show_files(char **names, const struct arguments *arguments, const struct dcf *eds)
{
    struct show show = { .view = arguments->json ? &view_json : &view_table,
                         .eds = eds,
                         .eds_name = arguments->eds };
    int result = EXIT_GOOD;

    show.failed = !show.view->begin();
    for (; *names && !show.failed; names++) {
        const int code = show_file(&show, *names);

        result = code > result ? code : result;
    }
    if (show.failed || !show.view->end() || fflush(stdout) != 0)
        return input_tell_output();
    return result;
}

int main(int argc, char **argv)
{
    struct arguments arguments = { .eds = NULL };
    struct dcf eds = { .count = 0 };
    const struct dcf *known = NULL;
    int result;

    if (argc < 2) {
        fputs(help, stderr);
        return EXIT_TROUBLE;
    }
    result = parse_arguments(argc, argv, &arguments);
    if (result >= 0)
        return result;
    if (arguments.eds) {
        if (!input_read_eds(arguments.eds, &eds))
            return EXIT_TROUBLE;
        known = &eds;
    }
    result = arguments.diff ? diff_files(argv[optind], argv[optind + 1], known, arguments.json)
                            : show_files(argv + optind, &arguments, known);
    dcf_done(&eds);
    return result;
}

/* dcf2ccf: device configuration files (DCF) as the concise DCFs that configure the devices. */
#include "dcf2ccf.h"

#include "common_tool.h"

#include <getopt.h>
#include <stdio.h>
#include <string.h>

#define EXIT_TROUBLE 2

static const char help[] =
    "Usage: dcf2ccf [OPTION]... INPUT.dcf [OUTPUT.ccf]\n"
    "       dcf2ccf [OPTION]... --from-network NETWORK.xml [-o FOLDER]\n"
    "\n"
    "Converts a device configuration file (CiA 306) to a concise DCF (CiA 302-3): the writes that\n"
    "bring the device to the ParameterValues of the file, in the order that devices need.\n"
    "\n"
    "  -n, --node-id ID   node-ID for $NODEID, 1..127 (default: NodeID of the file)\n"
    "  -o, --output FILE  the file to write (default: INPUT with the ending .ccf)\n"
    "      --all          entries without a ParameterValue as well, with their DefaultValue\n"
    "      --old-style    PDO mapping: the number of entries first, then the entries\n"
    "      --from-network FILE\n"
    "                     each DCF_File of a manager's XML file: what the manager would write at\n"
    "                     boot, with the node-ID and Old_Config_Style that the XML file says.\n"
    "                     Writes node-5.ccf for node 5, net-1-node-5.ccf where the file has more\n"
    "                     than one network, into the folder of -o (default: beside the XML file)\n"
    "      --depfile FILE what the outputs depend on, DownloadFiles as well, for make and ninja\n"
    "  -q, --quiet        errors only, no warnings\n"
    "  -h, --help         shows this\n"
    "      --version      shows the version\n"
    "\n"
    "INPUT and OUTPUT may be -, for stdin and stdout. After an error no output is written, not\n"
    "even that of other files, and older ones stay as they were.\n"
    "\n"
    "Exit codes: 0 converted, perhaps with warnings; 2 wrong usage, or an error in a file.\n";

enum { OPTION_ALL = 256, OPTION_DEPFILE, OPTION_NETWORK, OPTION_OLD_STYLE, OPTION_VERSION };

static const struct option options[] = {
    { "node-id", required_argument, NULL, 'n' },
    { "output", required_argument, NULL, 'o' },
    { "all", no_argument, NULL, OPTION_ALL },
    { "old-style", no_argument, NULL, OPTION_OLD_STYLE },
    { "from-network", required_argument, NULL, OPTION_NETWORK },
    { "depfile", required_argument, NULL, OPTION_DEPFILE },
    { "quiet", no_argument, NULL, 'q' },
    { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION },
    { NULL, 0, NULL, 0 },
};

/* NULL: getopt_long() has told it. */
static int usage_error(const char *what)
{
    if (what)
        fprintf(stderr, "dcf2ccf: %s\n", what);
    fputs("Try 'dcf2ccf --help'.\n", stderr);
    return EXIT_TROUBLE;
}

/* False: the option is not one of these. */
static bool take_option(int option, struct dcf2ccf_arguments *arguments)
{
    switch (option) {
    case 'o': arguments->output = optarg; return true;
    case OPTION_ALL: arguments->all = true; return true;
    case OPTION_OLD_STYLE: arguments->old_style = true; return true;
    case OPTION_NETWORK: arguments->network = optarg; return true;
    case OPTION_DEPFILE: arguments->depfile = optarg; return true;
    case 'q': arguments->quiet = true; return true;
    default: return false;
    }
}

/* -1: go on; else the exit code */
static int parse_options(int argc, char **argv, struct dcf2ccf_arguments *arguments)
{
    int option;

    while ((option = getopt_long(argc, argv, "n:o:qh", options, NULL)) != -1) {
        if (take_option(option, arguments))
            continue;
        if (option == 'h')
            return fputs(help, stdout) < 0 ? EXIT_TROUBLE : 0;
        if (option == OPTION_VERSION)
            return tool_print_version("dcf2ccf") ? 0 : EXIT_TROUBLE;
        if (option != 'n')
            return usage_error(NULL);
        if (!tool_node_id(optarg, &arguments->node_id))
            return usage_error("-n: a node-ID of 1..127 expected");
    }
    return -1;
}

/* -1: go on; else the exit code */
static int parse_names(int argc, char **argv, struct dcf2ccf_arguments *arguments)
{
    if (optind < argc && arguments->network)
        return usage_error("--from-network: no other input expected");
    if (optind < argc)
        arguments->input = argv[optind++];
    if (optind < argc && arguments->output)
        return usage_error("one output file expected, there are two");
    if (optind < argc)
        arguments->output = argv[optind++];
    if (optind < argc)
        return usage_error("more than an input and an output file");
    return arguments->input || arguments->network ? -1 : usage_error("an input file expected");
}

static bool writes_to_stdout(const struct dcf2ccf_arguments *arguments)
{
    const char *output = arguments->output ? arguments->output : arguments->input;

    return output && strcmp(output, "-") == 0;
}

/* -1: go on; else the exit code */
static int check_arguments(const struct dcf2ccf_arguments *arguments)
{
    if (arguments->network && (arguments->node_id || arguments->old_style || arguments->all))
        return usage_error("--from-network: no -n, --old-style or --all expected: it writes what "
                           "the manager would");
    if (arguments->network && writes_to_stdout(arguments))
        return usage_error("--from-network: a folder for -o expected");
    if (arguments->depfile && writes_to_stdout(arguments))
        return usage_error("--depfile: an output file expected, there is only stdout");
    return -1;
}

static bool run(const struct dcf2ccf_arguments *arguments)
{
    struct ccf_files files = { .read = NULL };
    bool good = arguments->network ? dcf2ccf_convert_network(arguments, &files)
                                   : dcf2ccf_convert(arguments, &files);

    if (good && arguments->depfile)
        good = ccf_files_write_rule(&files, arguments->depfile);
    if (good)
        good = ccf_files_take(&files);
    ccf_files_done(&files);
    return good;
}

int main(int argc, char **argv)
{
    struct dcf2ccf_arguments arguments = { .input = NULL };
    int result;

    if (argc < 2) {
        fputs(help, stderr);
        return EXIT_TROUBLE;
    }
    result = parse_options(argc, argv, &arguments);
    if (result < 0)
        result = parse_names(argc, argv, &arguments);
    if (result < 0)
        result = check_arguments(&arguments);
    if (result >= 0)
        return result;
    return run(&arguments) ? 0 : EXIT_TROUBLE;
}

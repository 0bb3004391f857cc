/* dcftest: will the manager take this EDS or DCF file, and what is wrong in it? */
#include "dcftest.h"

#include "common_tool.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "Usage: dcftest [OPTION]... FILE|FOLDER...\n"
    "\n"
    "Checks EDS and DCF files (CiA 306) with the reader of the CANopen manager, and whether what\n"
    "is in them fits together. Of a folder all files that end in .eds or .dcf are checked, and\n"
    "those of the folders in it; links to folders are not followed.\n"
    "\n"
    "Each message is a line \"file:line: severity: text [rule-name]\" on stdout. An error makes\n"
    "the manager refuse the file, what is told as a warning it ignores. What is about the whole\n"
    "file stands at line 1.\n"
    "\n"
    "      --strict         warnings count as errors\n"
    "      --rule NAMES     of the warnings these rules' alone: --rule line-length,comment\n"
    "      --no-rule NAMES  without the warnings of these rules\n"
    "      --list-rules     shows the rules: name, severity, where it is written; with --json\n"
    "                       as JSON\n"
    "  -n, --node-id ID     node-ID for $NODEID, 1..127 (default: NodeID of the file)\n"
    "      --json           the messages as JSON\n"
    "      --sarif          the messages as SARIF 2.1.0\n"
    "  -q, --quiet          no warnings; twice: no output, the exit code tells\n"
    "      --summary        numbers of files, errors and warnings on stderr at the end; without\n"
    "                       it they are there for several files, and on a terminal\n"
    "  -j, --jobs N         check N files at a time (default: as many as there are processors)\n"
    "  -h, --help           shows this\n"
    "      --version        shows the version\n"
    "\n"
    "Exit codes: 0 no errors, perhaps warnings; 1 errors, a file that cannot be read, or, with\n"
    "--strict, warnings; 2 wrong usage, or the output cannot be written.\n";

enum {
    OPTION_STRICT = 256,
    OPTION_RULE,
    OPTION_NO_RULE,
    OPTION_LIST_RULES,
    OPTION_JSON,
    OPTION_SARIF,
    OPTION_SUMMARY,
    OPTION_VERSION
};

static const struct option options[] = {
    { "strict", no_argument, NULL, OPTION_STRICT },
    { "rule", required_argument, NULL, OPTION_RULE },
    { "no-rule", required_argument, NULL, OPTION_NO_RULE },
    { "list-rules", no_argument, NULL, OPTION_LIST_RULES },
    { "node-id", required_argument, NULL, 'n' },
    { "json", no_argument, NULL, OPTION_JSON },
    { "sarif", no_argument, NULL, OPTION_SARIF },
    { "quiet", no_argument, NULL, 'q' },
    { "summary", no_argument, NULL, OPTION_SUMMARY },
    { "jobs", required_argument, NULL, 'j' },
    { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION },
    { NULL, 0, NULL, 0 },
};

#define GO_ON (-1)

struct arguments {
    struct settings settings;
    bool list_rules;
};

static int usage_error(const char *what)
{
    fprintf(stderr, "dcftest: %s\nTry 'dcftest --help'.\n", what);
    return DCFTEST_TROUBLE;
}

/* Who reads the output later must not take a part for the whole. */
static int finish_output(int result, bool good)
{
    if (good && fflush(stdout) == 0 && !ferror(stdout))
        return result;
    perror("dcftest: standard output");
    return DCFTEST_TROUBLE;
}

static int take_jobs(struct settings *settings)
{
    char *end;
    const unsigned long number = strtoul(optarg, &end, 10);

    if (optarg[0] < '0' || optarg[0] > '9' || *end || number < 1 || number > 1024)
        return usage_error("-j: a number of 1..1024 expected");
    settings->jobs = (unsigned)number;
    return GO_ON;
}

static int take_value(struct settings *settings, int option)
{
    switch (option) {
    case 'n':
        return tool_node_id(optarg, &settings->node_id)
                   ? GO_ON
                   : usage_error("-n: a node-ID of 1..127 expected");
    case 'j': return take_jobs(settings);
    case OPTION_RULE:
        return rule_set_add(&settings->rules, "--rule", optarg) ? GO_ON : DCFTEST_TROUBLE;
    case OPTION_NO_RULE:
        return rule_set_add(&settings->rules, "--no-rule", optarg) ? GO_ON : DCFTEST_TROUBLE;
    default: return usage_error("unknown option, or one without its value");
    }
}

static int take_option(struct arguments *self, int option)
{
    switch (option) {
    case OPTION_STRICT: self->settings.strict = true; return GO_ON;
    case OPTION_LIST_RULES: self->list_rules = true; return GO_ON;
    case OPTION_JSON: self->settings.json = true; return GO_ON;
    case OPTION_SARIF: self->settings.sarif = true; return GO_ON;
    case OPTION_SUMMARY: self->settings.summary = true; return GO_ON;
    case 'q': self->settings.quiet++; return GO_ON;
    case 'h': return finish_output(DCFTEST_CLEAN, fputs(help, stdout) >= 0);
    case OPTION_VERSION: return finish_output(DCFTEST_CLEAN, tool_print_version("dcftest"));
    default: return take_value(&self->settings, option);
    }
}

static int parse_options(struct arguments *self, int argc, char **argv)
{
    int option, result = GO_ON;

    while (result == GO_ON && (option = getopt_long(argc, argv, "n:qj:h", options, NULL)) != -1)
        result = take_option(self, option);
    if (result != GO_ON)
        return result;
    if (self->settings.json && self->settings.sarif)
        return usage_error("--json or --sarif expected, not both");
    if (self->list_rules)
        return finish_output(DCFTEST_CLEAN, rules_print(self->settings.json));
    return optind < argc ? GO_ON : usage_error("a file or a folder expected");
}

static bool print_nothing(struct output *self)
{
    (void)self;
    return true;
}

static bool print_no_result(struct output *self, const struct result *result)
{
    (void)self;
    (void)result;
    return true;
}

static const struct writer no_writer = { print_nothing, print_no_result, print_nothing };

static const struct writer *choose_writer(const struct settings *settings)
{
    if (settings->quiet >= 2)
        return &no_writer;
    if (settings->json)
        return &json_writer;
    return settings->sarif ? &sarif_writer : &text_writer;
}

static int check(struct settings *settings, const struct files *files)
{
    struct totals totals;
    bool good;

    settings->summary |= files->count > 1 || isatty(STDERR_FILENO);
    good = run_checks(settings, files, choose_writer(settings), &totals);
    return finish_output(exit_code(settings, &totals), good);
}

int main(int argc, char **argv)
{
    struct arguments arguments = { .list_rules = false };
    struct files files = { .list = NULL };
    bool good = true;
    int result;

    if (argc < 2) {
        fputs(help, stderr);
        return DCFTEST_TROUBLE;
    }
    result = parse_options(&arguments, argc, argv);
    if (result != GO_ON)
        return result;
    for (int i = optind; good && i < argc; i++)
        good = files_add(&files, argv[i]);
    if (good)
        result = check(&arguments.settings, &files);
    else
        fputs("dcftest: out of memory\n", stderr);
    files_done(&files);
    return good ? result : DCFTEST_TROUBLE;
}

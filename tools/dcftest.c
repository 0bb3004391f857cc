/* dcftest: will the manager take this EDS or DCF file, and what is wrong in it? */
#include "dcftest.h"

#include "api/load.h"
#include "common_tool.h"
#include "dcftest_online.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char help[] =
    "Usage: dcftest [OPTION]... FILE|FOLDER...\n"
    "       dcftest --online [-i BUS] [-n ID] [OPTION]... FILE\n"
    "\n"
    "Checks EDS and DCF files (CiA 306) with the reader of the CANopen manager, and whether what\n"
    "is in them fits together. Of a folder all files that end in .eds or .dcf are checked, and\n"
    "those of the folders in it; links to folders are not followed. FILE may be -, for stdin.\n"
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
    "  -e, --eds FILE.eds   compares each file with this one: what is not as in the EDS is told\n"
    "      --json           the messages as JSON\n"
    "      --sarif          the messages as SARIF 2.1.0\n"
    "  -q, --quiet          no warnings; twice: no output, the exit code tells\n"
    "      --summary        numbers of files, errors and warnings on stderr at the end; without\n"
    "                       it they are there for several files, and on a terminal\n"
    "  -j, --jobs N         check N files at a time (default: as many as there are processors)\n"
    "  -h, --help           shows this\n"
    "      --version        shows the version\n"
    "\n"
    "With --online a device is read, by SDO, and what is not in it as it is in the file is told:\n"
    "its type and identity, objects that it does not have, and the values that the DCF configures\n"
    "(ParameterValue). Nothing is written, and no NMT command is sent. What is write-only, "
    "domains\n"
    "and what ObjFlags protects from scans is left out. Nobody else may ask the device meanwhile.\n"
    "\n"
    "      --online         compares a device with its DCF (or EDS)\n"
    "  -i, --bus BUS        can0, vcan0, virtual:NAME, ... (default: MCANOPEN_NET_0, or can0)\n"
    "  -n, --node-id ID     the device (default: NodeID of the file)\n"
    "      --all            DefaultValues as well, where there is no ParameterValue\n"
    "      --timeout MS     for each answer of the device (default: 500)\n"
    "\n"
    "Exit codes: 0 no errors, perhaps warnings; 1 errors, a file that cannot be read, or, with\n"
    "--strict, warnings, with --online differences; 2 wrong usage, or the output cannot be\n"
    "written; 3 with --online: no bus, or no answer.\n";

enum {
    OPTION_STRICT = 256,
    OPTION_RULE,
    OPTION_NO_RULE,
    OPTION_LIST_RULES,
    OPTION_JSON,
    OPTION_SARIF,
    OPTION_SUMMARY,
    OPTION_ONLINE,
    OPTION_ALL,
    OPTION_TIMEOUT,
    OPTION_VERSION
};

static const struct option options[] = {
    { "strict", no_argument, NULL, OPTION_STRICT },
    { "rule", required_argument, NULL, OPTION_RULE },
    { "no-rule", required_argument, NULL, OPTION_NO_RULE },
    { "list-rules", no_argument, NULL, OPTION_LIST_RULES },
    { "node-id", required_argument, NULL, 'n' },
    { "eds", required_argument, NULL, 'e' },
    { "json", no_argument, NULL, OPTION_JSON },
    { "sarif", no_argument, NULL, OPTION_SARIF },
    { "quiet", no_argument, NULL, 'q' },
    { "summary", no_argument, NULL, OPTION_SUMMARY },
    { "online", no_argument, NULL, OPTION_ONLINE },
    { "bus", required_argument, NULL, 'i' },
    { "all", no_argument, NULL, OPTION_ALL },
    { "timeout", required_argument, NULL, OPTION_TIMEOUT },
    { "jobs", required_argument, NULL, 'j' },
    { "help", no_argument, NULL, 'h' },
    { "version", no_argument, NULL, OPTION_VERSION },
    { NULL, 0, NULL, 0 },
};

#define GO_ON         (-1)
#define JOBS_LIMIT    1024u
#define TIMEOUT       500u /* ms */
#define TIMEOUT_LIMIT 60000u

struct arguments {
    struct settings settings;
    const char *eds;
    bool list_rules;
    bool is_online;
    struct online online;
    char bus[64];
};

/* NULL: getopt_long() has told it. */
static int usage_error(const char *what)
{
    if (what)
        fprintf(stderr, "dcftest: %s\n", what);
    fputs("Try 'dcftest --help'.\n", stderr);
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

static int take_number(const char *option, unsigned most, unsigned *ret_number)
{
    char *end;
    const unsigned long number = strtoul(optarg, &end, 10);

    if (optarg[0] >= '0' && optarg[0] <= '9' && !*end && number >= 1 && number <= most) {
        *ret_number = (unsigned)number;
        return GO_ON;
    }
    fprintf(stderr, "dcftest: %s: a number of 1..%u expected\n", option, most);
    return DCFTEST_TROUBLE;
}

static int take_value(struct arguments *self, int option)
{
    struct settings *settings = &self->settings;

    switch (option) {
    case 'n':
        return tool_node_id(optarg, &settings->node_id)
                   ? GO_ON
                   : usage_error("-n: a node-ID of 1..127 expected");
    case 'j': return take_number("-j", JOBS_LIMIT, &settings->jobs);
    case OPTION_TIMEOUT: return take_number("--timeout", TIMEOUT_LIMIT, &self->online.timeout);
    case OPTION_RULE:
        return rule_choice_add(&settings->rules, "--rule", optarg) ? GO_ON : DCFTEST_TROUBLE;
    case OPTION_NO_RULE:
        return rule_choice_add(&settings->rules, "--no-rule", optarg) ? GO_ON : DCFTEST_TROUBLE;
    default: return usage_error(NULL);
    }
}

static bool take_switch(struct arguments *self, int option)
{
    switch (option) {
    case OPTION_STRICT: self->settings.strict = true; return true;
    case OPTION_LIST_RULES: self->list_rules = true; return true;
    case OPTION_JSON: self->settings.json = true; return true;
    case OPTION_SARIF: self->settings.sarif = true; return true;
    case OPTION_SUMMARY: self->settings.summary = true; return true;
    case OPTION_ONLINE: self->is_online = true; return true;
    case OPTION_ALL: self->online.all = true; return true;
    case 'e': self->eds = optarg; return true;
    case 'i': self->online.bus = optarg; return true;
    case 'q': self->settings.quiet++; return true;
    default: return false;
    }
}

static int take_option(struct arguments *self, int option)
{
    if (take_switch(self, option))
        return GO_ON;
    switch (option) {
    case 'h': return finish_output(DCFTEST_CLEAN, fputs(help, stdout) >= 0);
    case OPTION_VERSION: return finish_output(DCFTEST_CLEAN, tool_print_version("dcftest"));
    default: return take_value(self, option);
    }
}

/* Which bus there is without -i is told by the environment, as for all tools. */
static int check_online(struct arguments *self, int files)
{
    const struct network_config config = { .net = 0 };

    if (!self->is_online)
        return self->online.bus || self->online.all || self->online.timeout
                   ? usage_error("-i, --all and --timeout belong to --online")
                   : GO_ON;
    if (files != 1 || self->eds)
        return usage_error("--online: one file expected, and no --eds");
    load_bus_name(&config, self->bus, sizeof self->bus);
    if (!self->online.bus)
        self->online.bus = self->bus;
    if (self->online.timeout == 0)
        self->online.timeout = TIMEOUT;
    self->settings.strict = true; /* a difference is what one looks for */
    return GO_ON;
}

static int parse_options(struct arguments *self, int argc, char **argv)
{
    int option, result = GO_ON;

    while (result == GO_ON && (option = getopt_long(argc, argv, "n:e:qj:i:h", options, NULL)) != -1)
        result = take_option(self, option);
    if (result != GO_ON)
        return result;
    if (self->settings.json && self->settings.sarif)
        return usage_error("--json or --sarif expected, not both");
    if (self->list_rules)
        return finish_output(DCFTEST_CLEAN, rules_print(self->settings.json));
    if (optind == argc)
        return usage_error("a file or a folder expected");
    return check_online(self, argc - optind);
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

static int check_files(struct arguments *self, const struct files *files)
{
    struct settings *settings = &self->settings;
    struct totals totals;
    bool good;

    settings->summary |= files->count > 1 || isatty(STDERR_FILENO);
    good = run_checks(settings, files, choose_writer(settings), &totals);
    return finish_output(exit_code(settings, &totals), good);
}

/* An EDS that cannot be read is an error as in any file: nothing can be compared then. */
static int check_against(struct arguments *self, const struct files *files,
                         const struct file *eds_file)
{
    struct settings *settings = &self->settings;
    struct totals totals;
    struct result result;
    struct dcf eds;
    int code;

    if (!read_eds(settings, eds_file, &result, &eds)) {
        const bool good = write_one(settings, choose_writer(settings), &result, &totals);

        return finish_output(DCFTEST_ERRORS, good);
    }
    result_done(&result);
    settings->eds = &eds;
    code = check_files(self, files);
    dcf_done(&eds);
    return code;
}

static int check_with_eds(struct arguments *self, const struct files *files)
{
    struct files eds = { .list = NULL };
    int code = DCFTEST_TROUBLE;

    if (!files_add(&eds, self->eds))
        fputs("dcftest: out of memory\n", stderr);
    else if (eds.count > 1)
        code = usage_error("--eds: one file expected");
    else
        code = check_against(self, files, &eds.list[0]);
    files_done(&eds);
    return code;
}

static int check(struct arguments *self, const struct files *files)
{
    const struct writer *writer = choose_writer(&self->settings);

    if (self->is_online)
        return finish_output(online_check(&self->settings, &self->online, &files->list[0], writer),
                             true);
    return self->eds ? check_with_eds(self, files) : check_files(self, files);
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
    rules_init(&arguments.settings.rules);
    result = parse_options(&arguments, argc, argv);
    if (result != GO_ON)
        return result;
    for (int i = optind; good && i < argc; i++)
        good = files_add(&files, argv[i]);
    if (good)
        result = check(&arguments, &files);
    else
        fputs("dcftest: out of memory\n", stderr);
    files_done(&files);
    return good ? result : DCFTEST_TROUBLE;
}

/*
 * mcanopen check: will the network that a file describes boot?
 */
#include "mcanopen_check.h"

#include "api/load.h"
#include "common_tool.h"
#include "dcf/dcf_rules.h"
#include "verbs.h"
#include "json/json_text.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char usage[] =
    "Usage: mcanopen check [OPTION]... NETWORK.xml\n"
    "\n"
    "Reads the file and all that it names, as mcanOpenConfig() does, and checks whether the whole\n"
    "will boot and work: identity, configuration, CAN-IDs, PDO links, heartbeats, guarding, SYNC,\n"
    "bus load, boot time. It needs no bus and changes nothing.\n"
    "\n"
    "Each message is a line \"file:line: severity: text [rule-name]\" on stdout. An error: this\n"
    "will not boot, or not work; a warning: doubtful; an info: worth to know. Then come a table\n"
    "of the nodes, and estimates of bus load and boot time.\n"
    "\n"
    "  -e, --eds NODE=FILE  the EDS of a node: describes one with a CCF_File, or without a file;\n"
    "                       a DCF_File is compared with it\n"
    "      --files          all that dcftest has to tell about the files of nodes, not only how\n"
    "                       many warnings there are\n"
    "      --strict         warnings count as errors\n"
    "      --rule NAMES     of the warnings and infos these rules' alone: --rule no-sync,bus-load\n"
    "      --no-rule NAMES  without the messages of these rules\n"
    "      --list-rules     shows the rules: name, severity, where it is written; with --json\n"
    "                       as JSON\n"
    "      --json           all of it as JSON\n"
    "  -q, --quiet          errors alone; twice: no output, the exit code tells\n"
    "  -h, --help           shows this\n"
    "      --version        shows the version\n"
    "\n"
    "Exit codes: 0 it will boot, perhaps with warnings; 1 errors, a file that cannot be read, or,\n"
    "with --strict, warnings; 2 wrong usage, or the output cannot be written.\n";

#define GO_ON (-1)

enum { OPTION_FILES = 256, OPTION_STRICT, OPTION_RULE, OPTION_NO_RULE, OPTION_LIST, OPTION_JSON };

static const struct option options[] = {
    { "eds", required_argument, NULL, 'e' },
    { "files", no_argument, NULL, OPTION_FILES },
    { "strict", no_argument, NULL, OPTION_STRICT },
    { "rule", required_argument, NULL, OPTION_RULE },
    { "no-rule", required_argument, NULL, OPTION_NO_RULE },
    { "list-rules", no_argument, NULL, OPTION_LIST },
    { "json", no_argument, NULL, OPTION_JSON },
    { "quiet", no_argument, NULL, 'q' },
    { "help", no_argument, NULL, 'h' },
    { NULL, 0, NULL, 0 },
};

static const struct rule_list rule_lists[] = {
    { audit_rules, AUDIT_RULE_COUNT, false },
    { &load_file_warnings, 1, true },
    { dcf_rules, DCF_RULE_COUNT, true },
};

_Static_assert(AUDIT_RULE_COUNT + 1 + DCF_RULE_COUNT <= CHOICE_RULES_MAX, "too many rules");

/* --- messages --- */

static bool is_shown(const struct check *self, const struct co_message *message)
{
    return self->quiet == 0 || (self->quiet == 1 && message->severity == CO_ERROR);
}

static void take_message(void *context, const struct co_message *message)
{
    struct check *self = context;

    if (self->audit.tells_files && message->rule == &load_file_warnings)
        return;
    if (!rule_choice_has(&self->rules, message))
        return;
    self->errors += message->severity == CO_ERROR;
    self->warnings += message->severity == CO_WARNING;
    if (!is_shown(self, message))
        return;
    if (self->json)
        self->failed |= !check_add_json(self, message);
    else if (message->rule)
        printf("%s [%s]\n", message->text, message->rule->name);
    else
        puts(message->text);
}

bool check_is_bad(const struct check *self)
{
    return self->errors > 0 || (self->strict && self->warnings > 0);
}

/* --- options --- */

static bool print_rule(const struct check *self, const struct co_rule *rule, bool first)
{
    if (!self->json)
        return printf("%s: %s [%s]\n    %s\n", rule->name, co_severity_text(rule->severity),
                      rule->clause, rule->text) >= 0;
    return fputs(first ? "[\n" : ",\n", stdout) >= 0 &&
           json_write(json_pack("{s:s, s:s, s:s, s:s}", "name", rule->name, "severity",
                                co_severity_text(rule->severity), "clause", rule->clause, "text",
                                rule->text),
                      0, stdout);
}

static int list_rules(const struct check *self)
{
    const struct co_rule *rule;
    bool good = true;

    for (size_t i = 0; good && (rule = rule_choice_at(&self->rules, i)) != NULL; i++)
        good = print_rule(self, rule, i == 0);
    if (good && self->json)
        good = puts("\n]") >= 0;
    return good ? EXIT_UP : EXIT_USAGE;
}

static bool add_eds(struct audit *self, char *argument)
{
    char *equals = strchr(argument, '=');
    struct audit_eds eds = { .node = 0 };
    struct audit_eds *grown;

    if (equals)
        *equals = '\0';
    if (!equals || equals[1] == '\0' || !tool_node_id(argument, &eds.node)) {
        fprintf(stderr, "mcanopen check: --eds: NODE=FILE expected, NODE 1 to 127\n");
        return false;
    }
    eds.file = equals + 1;
    grown = realloc(self->eds, (self->eds_count + 1) * sizeof *grown);
    if (!grown) {
        fputs("mcanopen check: no memory\n", stderr);
        return false;
    }
    self->eds = grown;
    self->eds[self->eds_count++] = eds;
    return true;
}

static int take_switch(struct check *self, int option, bool *list)
{
    switch (option) {
    case OPTION_FILES: self->audit.tells_files = true; break;
    case OPTION_STRICT: self->strict = true; break;
    case OPTION_LIST: *list = true; break;
    case OPTION_JSON: self->json = true; break;
    case 'q': self->quiet++; break;
    case 'h': fputs(usage, stdout); return EXIT_UP;
    default: fputs("Try 'mcanopen check --help'.\n", stderr); return EXIT_USAGE;
    }
    return GO_ON;
}

static int take_option(struct check *self, int option, bool *list)
{
    switch (option) {
    case 'e': return add_eds(&self->audit, optarg) ? GO_ON : EXIT_USAGE;
    case OPTION_RULE: return rule_choice_add(&self->rules, "--rule", optarg) ? GO_ON : EXIT_USAGE;
    case OPTION_NO_RULE:
        return rule_choice_add(&self->rules, "--no-rule", optarg) ? GO_ON : EXIT_USAGE;
    default: return take_switch(self, option, list);
    }
}

static int parse(struct check *self, int argc, char **argv)
{
    bool list = false;
    int option;

    if (argc < 2) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    while ((option = getopt_long(argc, argv, "e:qh", options, NULL)) != -1) {
        const int result = take_option(self, option, &list);

        if (result != GO_ON)
            return result;
    }
    if (list)
        return list_rules(self);
    if (optind + 1 != argc) {
        fputs("mcanopen check: one file expected\nTry 'mcanopen check --help'.\n", stderr);
        return EXIT_USAGE;
    }
    self->audit.xml_path = argv[optind];
    return GO_ON;
}

/* --- all of it --- */

static bool check_eds_used(const struct audit *self)
{
    bool good = true;

    for (size_t i = 0; i < self->eds_count; i++) {
        if (self->eds[i].used)
            continue;
        fprintf(stderr, "mcanopen check: --eds %u: there is no such node\n", self->eds[i].node);
        good = false;
    }
    return good;
}

static void print(struct check *self)
{
    if (self->json)
        self->failed = !check_print_json(self);
    else if (self->quiet == 0)
        check_print_summary(self);
}

/* False: wrong usage. */
static bool check_plant(struct check *self)
{
    const bool opened = audit_open(&self->audit);
    const bool good = !opened || check_eds_used(&self->audit);

    if (opened && good)
        self->failed |= !audit_run(&self->audit);
    if (good && !self->failed)
        print(self);
    if (opened)
        audit_close(&self->audit);
    return good;
}

static int check(struct check *self)
{
    if (!check_plant(self))
        return EXIT_USAGE;
    if (self->failed) {
        fputs("mcanopen check: no memory, or the output cannot be written\n", stderr);
        return EXIT_USAGE;
    }
    return check_is_bad(self) ? EXIT_NOT_UP : EXIT_UP;
}

int verb_check(int argc, char **argv)
{
    struct check *self = calloc(1, sizeof *self);
    int result;

    if (!self)
        return EXIT_USAGE;
    self->rules = (struct rule_choice){ .tool = "mcanopen check",
                                        .lists = rule_lists,
                                        .list_count = sizeof rule_lists / sizeof rule_lists[0] };
    self->report = (struct co_report){ .sink = take_message, .context = self };
    self->audit.report = &self->report;
    result = parse(self, argc, argv);
    if (result == GO_ON)
        result = check(self);
    json_decref(self->messages);
    free(self->audit.eds);
    free(self);
    return result;
}

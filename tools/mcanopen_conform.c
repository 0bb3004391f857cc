/*
 * mcanopen conform: does a device do what CiA 301 asks of a slave?
 */
#include "common_tool.h"
#include "conform/conform.h"
#include "verbs.h"

#include "api/load.h"
#include "proto/nmt.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "Usage: mcanopen conform [OPTION]... -n ID\n"
    "       mcanopen conform --list\n"
    "\n"
    "Tests a CANopen slave on the level of frames: EDS, SDO, dictionary and so on. For the time "
    "of\n"
    "the test the tester is the NMT master and the only SDO client; other masters have to be "
    "quiet.\n"
    "The device is reset before, between and after the tests, and left with the values of a\n"
    "reset. Its outputs may change: test no device that moves something.\n"
    "\n"
    "  -n, --node-id ID   the device under test\n"
    "  -e, --eds FILE     what it says of itself; without it the device is asked, and what only\n"
    "                     the file can tell is skipped\n"
    "  -i, --bus BUS      where (default: the bus of --net)\n"
    "  --net N            N of MCANOPEN_NET_N, can<N> (default: 0)\n"
    "  --only NAMES       these checks and families alone: --only sdo,od-limits\n"
    "  --skip NAMES       all but these\n"
    "  --list             the checks, and what they need\n"
    "  --allow-store      let it write the device's non-volatile memory (1010h, 1011h)\n"
    "  --sdo-timeout MS   for each answer of the device (1000)\n"
    "  --boot-timeout MS  from a reset to the boot-up message (5000)\n"
    "  --json             the results as JSON on stdout\n"
    "  --junit FILE       the results as JUnit XML too\n"
    "  -q, --quiet        only what fails, and the summary\n"
    "  -v, --verbose      the frames of every check\n"
    "  -h, --help         shows this\n"
    "  --version          shows the version\n"
    "\n"
    "PASS, FAIL; SKIP and NEEDS-HELP tell the reason, and are no failures.\n"
    "Exit codes: 0 nothing failed, 1 findings, 2 usage or a fault in a file, 3 no bus or no "
    "node.\n";

#define TIMEOUT_MAX 600000u /* ms */

struct number {
    const char *option;
    unsigned least, most;
};

static bool parse_number(const struct number *range, const char *text, unsigned *ret_value)
{
    if (!tool_number(text, range->least, range->most, ret_value)) {
        fprintf(stderr, "mcanopen conform: %s %s: expected %u..%u\n", range->option, text,
                range->least, range->most);
        return false;
    }
    return true;
}

/* Each name of the list is one of a check or a family. */
static bool check_names(const char *option, const char *list)
{
    char *names = strdup(list), *rest = names;
    const char *name;
    bool good = names != NULL;

    while (good && (name = strsep(&rest, ",")) != NULL) {
        good = false;
        for (size_t i = 0; i < conform_family_count; i++)
            for (size_t k = 0; k < conform_families[i]->count; k++)
                good |= conform_selects(name, conform_families[i], &conform_families[i]->checks[k]);
        if (!good)
            fprintf(stderr, "mcanopen conform: %s: no check and no family \"%s\" (see --list)\n",
                    option, name);
    }
    free(names);
    return good;
}

static void list_checks(void)
{
    for (size_t i = 0; i < conform_family_count; i++)
        for (size_t k = 0; k < conform_families[i]->count; k++) {
            const struct conform_check *check = &conform_families[i]->checks[k];

            printf("%-8s %-32s %s%s%s\n", conform_families[i]->name, check->name, check->title,
                   check->needs & CONFORM_EDS ? " [--eds]" : "",
                   check->needs & CONFORM_STORE ? " [--allow-store]" : "");
        }
}

struct arguments {
    struct conform_options *options;
    unsigned net;
    char bus[64];
};

static bool take_number(struct arguments *self, int option)
{
    struct conform_options *options = self->options;
    unsigned number = 0;
    bool good;

    switch (option) {
    case 'n':
        good = parse_number(&(struct number){ "--node-id", 1, NMT_NODE_MAX }, optarg, &number);
        options->node = (uint8_t)number;
        return good;
    case 'N': return parse_number(&(struct number){ "--net", 0, UINT8_MAX }, optarg, &self->net);
    case 't':
        return parse_number(&(struct number){ "--sdo-timeout", 1, TIMEOUT_MAX }, optarg,
                            &options->sdo_timeout);
    default:
        return parse_number(&(struct number){ "--boot-timeout", 1, TIMEOUT_MAX }, optarg,
                            &options->boot_timeout);
    }
}

static bool take_option(struct arguments *self, int option)
{
    struct conform_options *options = self->options;

    switch (option) {
    case 'n':
    case 'N':
    case 't':
    case 'T': return take_number(self, option);
    case 'e': options->eds = optarg; return true;
    case 'i': options->bus = optarg; return true;
    case 'o': options->only = optarg; return check_names("--only", optarg);
    case 's': options->skip = optarg; return check_names("--skip", optarg);
    default: fputs(usage, stderr); return false;
    }
}

static bool take_switch(struct conform_options *options, int option)
{
    switch (option) {
    case 'l': options->list = true; return true;
    case 'a': options->allow_store = true; return true;
    case 'J': options->json = true; return true;
    case 'q': options->quiet = true; return true;
    case 'v': options->verbose = true; return true;
    default: return false;
    }
}

static bool check_options(struct arguments *self)
{
    struct network_config config = { .net = (uint8_t)self->net };

    if (!self->options->list && self->options->node == 0) {
        fputs(usage, stderr);
        return false;
    }
    if (self->options->eds && access(self->options->eds, R_OK) != 0) {
        perror(self->options->eds);
        return false;
    }
    load_bus_name(&config, self->bus, sizeof self->bus);
    if (!self->options->bus)
        self->options->bus = self->bus;
    return true;
}

static bool parse_options(struct arguments *self, int argc, char **argv)
{
    static const struct option options[] = { { "node-id", required_argument, NULL, 'n' },
                                             { "eds", required_argument, NULL, 'e' },
                                             { "bus", required_argument, NULL, 'i' },
                                             { "net", required_argument, NULL, 'N' },
                                             { "only", required_argument, NULL, 'o' },
                                             { "skip", required_argument, NULL, 's' },
                                             { "list", no_argument, NULL, 'l' },
                                             { "allow-store", no_argument, NULL, 'a' },
                                             { "sdo-timeout", required_argument, NULL, 't' },
                                             { "boot-timeout", required_argument, NULL, 'T' },
                                             { "json", no_argument, NULL, 'J' },
                                             { "junit", required_argument, NULL, 'j' },
                                             { "quiet", no_argument, NULL, 'q' },
                                             { "verbose", no_argument, NULL, 'v' },
                                             { "help", no_argument, NULL, 'h' },
                                             { NULL, 0, NULL, 0 } };
    int option;

    while ((option = getopt_long(argc, argv, "n:i:e:qvh", options, NULL)) != -1) {
        if (option == 'h') {
            fputs(usage, stdout);
            exit(EXIT_UP);
        }
        if (option == 'j')
            self->options->junit = optarg;
        else if (!take_switch(self->options, option) && !take_option(self, option))
            return false;
    }
    if (optind != argc) {
        fprintf(stderr, "mcanopen conform: %s: not expected\n", argv[optind]);
        return false;
    }
    return check_options(self);
}

int verb_conform(int argc, char **argv)
{
    struct conform *self = calloc(1, sizeof *self);
    struct arguments arguments = { .net = 0 };
    int result = EXIT_USAGE;

    if (!self)
        return EXIT_USAGE;
    self->options = (struct conform_options){ .sdo_timeout = 1000, .boot_timeout = 5000 };
    arguments.options = &self->options;
    if (parse_options(&arguments, argc, argv)) {
        if (self->options.list) {
            list_checks();
            result = EXIT_UP;
        } else {
            self->signals = stop_signals();
            result = conform_run(self);
            close(self->signals);
        }
    }
    free(self);
    return result;
}

/*
 * mcanopen boot: boots the networks of an XML file, tells each step, and shows what came of it.
 */
#include "verbs.h"

#include "api/load.h"
#include "api/registry.h"
#include "mcanopen.h"
#include "od/abort.h"
#include "port/clock.h"
#include "proto/nmt.h"

#include <errno.h>
#include <getopt.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

static const char usage[] =
    "Usage: mcanopen boot [OPTION]... NETWORK.xml\n"
    "\n"
    "Boots the networks of the file and tells each step of each node, then shows a table of the\n"
    "nodes; stays and reports what happens until Ctrl-C.\n"
    "\n"
    "  --once           end when each network is up or has failed\n"
    "  --all            the network is up only when the optional nodes are up, too\n"
    "  --timeout SECS   wait at most so long for it to come up\n"
    "                   (default: Boot_Time and 5 s more, 30 s where Boot_Time is 0)\n"
    "  -q, --quiet      no steps, only warnings, errors and the table\n"
    "  -h, --help       shows this\n"
    "  --version        shows the version\n"
    "\n"
    "Bus: <Interface> of the file, else can<Net_No>; the environment overrides both:\n"
    "MCANOPEN_NET_0=vcan0 or MCANOPEN_NET_0=virtual:demo for the network with Net_No 0.\n"
    "\n"
    "Exit codes: 0 up, 1 not all required nodes are up, 2 usage or a fault in a file, 3 bus.\n";

#define NETS_MAX 16

struct boot {
    const char *path;
    bool once, all, quiet;
    co_us_t timeout; /* 0: from the file */
    co_us_t start;
    co_us_t limit; /* for coming up; CO_NEVER afterwards */
    int nets[NETS_MAX];
    unsigned net_count;
    int changed; /* eventfd: something was told */
    int signals; /* signalfd */
};

struct row {
    int node;
    BOOT_RECORD_T record;
};

struct table { /* of one network */
    char heading[160];
    struct row rows[NETWORK_NODE_MAX];
    unsigned count;
};

struct tables {
    struct table of[NETS_MAX];
    unsigned count;
};

/* --- lines --- */

static void print_line(void *context, int level, const char *text)
{
    static const char *const prefixes[] = { "error: ", "warning: ", "" };
    struct boot *self = context;
    co_us_t elapsed = self->start ? clock_now() - self->start : 0;
    const uint64_t one = 1;
    ssize_t written;

    if (!self->start)
        fprintf(stderr, "%s\n", text); /* about the files: has its place and kind already */
    else if (level < MCANOPEN_LOG_INFO || !self->quiet)
        printf("%4u.%03u  %s%s\n", (unsigned)(elapsed / 1000000u),
               (unsigned)(elapsed / 1000u % 1000u), prefixes[level], text);
    fflush(stdout);
    written = write(self->changed, &one, sizeof one);
    (void)written; /* a full counter wakes as well */
}

/* --- state of the networks --- */

/* A mandatory node is missing for good, or with 'all' any one, and every node has had its try. */
static bool has_failed(const struct manager *manager, bool all)
{
    bool failed = false;

    if (manager->state == NETWORK_HALTED)
        return true;
    for (size_t i = 0; i < manager->config->node_count; i++) {
        const struct boot_node *node = &manager->nodes[manager->config->nodes[i].node_id];

        if (boot_node_is_booted_by_master(node) && !node->tried)
            return false;
        failed |= node->step == BOOT_FAILED;
    }
    return all && failed;
}

/* It is up, or will not come up by itself. */
static bool is_decided(const struct manager *manager, bool all)
{
    return manager_is_up(manager, all) || has_failed(manager, all);
}

/* Of all networks. */
static bool are_all(const struct boot *self, bool (*judge)(const struct manager *, bool))
{
    for (unsigned i = 0; i < self->net_count; i++) {
        struct managed *managed;
        bool is;
        co_us_t now;

        if (registry_enter(self->nets[i], true, &managed) != MCANOPEN_OK)
            return false;
        network_enter(managed->network, &now);
        is = judge(managed->manager, self->all);
        network_leave(managed->network, managed->config->manager_node_id);
        registry_leave();
        if (!is)
            return false;
    }
    return true;
}

/* --- the table --- */

/* Where there are several. */
static void head(int net, struct table *table)
{
    struct managed *managed;
    const char *name;

    if (registry_enter(net, false, &managed) != MCANOPEN_OK)
        return;
    name = managed->config->name;
    snprintf(table->heading, sizeof table->heading, "network %d%s%.60s%s on %s", net,
             name ? " \"" : "", name ? name : "", name ? "\"" : "", network_name(managed->network));
    registry_leave();
}

static void collect_nodes(int net, struct table *table)
{
    for (int node = 1; node <= (int)NETWORK_NODE_MAX; node++) {
        struct row *row = &table->rows[table->count];

        row->node = node;
        row->record.size = sizeof row->record;
        if (mcanOpenGetBootRecord(net, node, &row->record) == MCANOPEN_OK)
            table->count++;
    }
}

static void collect(const struct boot *self, struct tables *tables)
{
    tables->count = self->net_count;
    for (unsigned i = 0; i < self->net_count; i++) {
        tables->of[i].count = 0;
        if (self->net_count > 1)
            head(self->nets[i], &tables->of[i]);
        collect_nodes(self->nets[i], &tables->of[i]);
    }
}

static const char *state_name(const BOOT_RECORD_T *record)
{
    switch (record->state) {
    case NMT_OPERATIONAL: return "OPERATIONAL";
    case NMT_PREOPERATIONAL: return "PRE-OPERATIONAL";
    case NMT_STOPPED: return "STOPPED";
    default: return "offline";
    }
}

static const char *result_name(const BOOT_RECORD_T *record)
{
    if (record->booted)
        return "booted";
    if (record->step == MCANOPEN_STEP_IDLE)
        return record->text;
    return record->step == MCANOPEN_STEP_FAILED ? "FAILED" : "MISSING";
}

/* Nodes that have booted, but not at once: somebody may want to know why. */
static void print_troubles(const struct table *table)
{
    bool first = true;

    for (unsigned i = 0; i < table->count; i++) {
        const BOOT_RECORD_T *record = &table->rows[i].record;

        if (!record->booted || record->failures == 0)
            continue;
        printf("%snode %d has booted after %u failed attempt%s, the last one: %s\n",
               first ? "\n" : "", table->rows[i].node, record->failures,
               record->failures == 1 ? "" : "s", record->failedText);
        first = false;
    }
}

/* Several nodes, and not one of them has answered: it is none of them, most likely. */
static bool is_bus_silent(const struct table *table)
{
    unsigned silent = 0;

    for (unsigned i = 0; i < table->count; i++) {
        const BOOT_RECORD_T *record = &table->rows[i].record;

        if (record->step == MCANOPEN_STEP_IDLE)
            continue;
        if (record->booted || record->letter != 'B' || record->abortCode != SDO_TIMEOUT)
            return false;
        silent++;
    }
    return silent > 1;
}

static void print_table(const struct table *table)
{
    size_t width = 4;

    for (unsigned i = 0; i < table->count; i++)
        if (strlen(table->rows[i].record.name) > width)
            width = strlen(table->rows[i].record.name);
    if (table->heading[0])
        printf("\n%s\n", table->heading);
    printf("\nnode  %-*s  kind       state            boot\n", (int)width, "name");
    for (unsigned i = 0; i < table->count; i++) {
        const BOOT_RECORD_T *record = &table->rows[i].record;

        printf("%4d  %-*s  %-9s  %-15s  %s", table->rows[i].node, (int)width, record->name,
               record->mandatory ? "mandatory" : "optional", state_name(record),
               result_name(record));
        if (!record->booted && record->step != MCANOPEN_STEP_IDLE)
            printf(": %s", record->text);
        printf("\n");
    }
    print_troubles(table);
    if (is_bus_silent(table))
        printf("\nno node answers: check the cable, its termination, the power of the nodes, "
               "the bit rate, and that this is their interface\n");
}

static void print_tables(const struct tables *tables)
{
    for (unsigned i = 0; i < tables->count; i++)
        print_table(&tables->of[i]);
    fflush(stdout);
}

/* --- running --- */

static co_us_t time_to_come_up(const struct network_config *config)
{
    co_us_t boot_time = config->boot_time ? CO_MS(config->boot_time) + CO_MS(5000) : CO_MS(30000);

    return CO_MS(config->boot_delay) + boot_time;
}

/* The configured networks, and how long they may take where no time was given. */
static void find_nets(struct boot *self)
{
    co_us_t longest = 0;

    for (int net = 0; net <= UINT8_MAX && self->net_count < NETS_MAX; net++) {
        struct managed *managed;

        if (registry_enter(net, false, &managed) != MCANOPEN_OK)
            continue;
        self->nets[self->net_count++] = net;
        if (time_to_come_up(managed->config) > longest)
            longest = time_to_come_up(managed->config);
        registry_leave();
    }
    if (self->timeout == 0)
        self->timeout = longest;
}

/* With good files it was the bus that could not be opened. */
static int exit_code_of_files(const char *path)
{
    struct co_report silent = { .sink = NULL };
    struct network_config *networks = NULL;
    size_t count = 0;
    int result = load_networks(path, &silent, &networks, &count);

    network_config_free(networks, count);
    return result == MCANOPEN_OK ? EXIT_BUS : EXIT_USAGE;
}

static int poll_timeout(const struct boot *self)
{
    co_us_t now = clock_now();

    if (self->limit == CO_NEVER)
        return -1;
    return self->limit <= now ? 0 : (int)((self->limit - now + 999u) / 1000u);
}

/* Until something was told, a signal came (true), or the time limit. */
static bool wait_for_news(const struct boot *self)
{
    struct pollfd fds[] = { { .fd = self->changed, .events = POLLIN },
                            { .fd = self->signals, .events = POLLIN } };
    uint64_t count;
    ssize_t got = 0;

    if (poll(fds, 2, poll_timeout(self)) < 0)
        return errno != EINTR;
    if (fds[0].revents)
        got = read(self->changed, &count, sizeof count);
    (void)got;
    return fds[1].revents != 0;
}

/* Until each network is up or has failed, or the time is over; false: interrupted. */
static bool wait_until_decided(struct boot *self)
{
    while (!are_all(self, is_decided) && clock_now() < self->limit)
        if (wait_for_news(self))
            return false;
    return true;
}

static int finish(const struct boot *self, struct tables *tables, bool up)
{
    collect(self, tables);
    mcanOpenShutDown(); /* the last lines of the log come before the table */
    print_tables(tables);
    if (!up && clock_now() >= self->limit)
        printf("\nnot up within %u.%u s\n", (unsigned)(self->timeout / 1000000u),
               (unsigned)(self->timeout / 100000u % 10u));
    return up ? EXIT_UP : EXIT_NOT_UP;
}

/* The log has said why not. */
static bool has_started(const struct boot *self)
{
    struct managed *managed;

    if (registry_enter(self->nets[0], true, &managed) != MCANOPEN_OK)
        return false;
    registry_leave();
    return true;
}

static int run(struct boot *self)
{
    static struct tables tables;
    bool go_on;

    self->start = clock_now();
    self->limit = self->start + self->timeout;
    mcanOpenStart();
    if (!has_started(self))
        return EXIT_NOT_UP;
    go_on = wait_until_decided(self);
    if (self->once || !go_on)
        return finish(self, &tables, are_all(self, manager_is_up));
    collect(self, &tables);
    print_tables(&tables);
    self->limit = CO_NEVER;
    while (!wait_for_news(self))
        continue;
    return finish(self, &tables, are_all(self, manager_is_up));
}

static int boot(struct boot *self)
{
    int result;

    self->changed = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    self->signals = stop_signals();
    if (self->changed < 0 || self->signals < 0 || mcanOpenInitialize() != MCANOPEN_OK) {
        fprintf(stderr, "mcanopen boot: out of resources: %s\n", strerror(errno));
        return EXIT_USAGE;
    }
    mcanOpenSetLog(print_line, self);
    if (mcanOpenConfig(self->path) == MCANOPEN_OK) {
        find_nets(self);
        result = run(self);
    } else {
        result = exit_code_of_files(self->path);
    }
    mcanOpenCleanup();
    close(self->changed);
    close(self->signals);
    return result;
}

static bool parse_seconds(const char *text, co_us_t *ret_time)
{
    char *end;
    double seconds = strtod(text, &end);

    if (end == text || *end || !(seconds > 0) || seconds > 86400)
        return false;
    *ret_time = (co_us_t)(seconds * 1e6);
    return true;
}

static int parse_options(struct boot *self, int argc, char **argv)
{
    static const struct option options[] = {
        { "once", no_argument, NULL, 'o' },          { "all", no_argument, NULL, 'a' },
        { "timeout", required_argument, NULL, 't' }, { "quiet", no_argument, NULL, 'q' },
        { "help", no_argument, NULL, 'h' },          { NULL, 0, NULL, 0 }
    };
    int option;

    while ((option = getopt_long(argc, argv, "qh", options, NULL)) != -1) {
        switch (option) {
        case 'o': self->once = true; break;
        case 'a': self->all = true; break;
        case 'q': self->quiet = true; break;
        case 't':
            if (parse_seconds(optarg, &self->timeout))
                break;
            fprintf(stderr, "mcanopen boot: --timeout %s: expected seconds, more than 0\n", optarg);
            return EXIT_USAGE;
        case 'h': fputs(usage, stdout); return EXIT_UP;
        default: fputs(usage, stderr); return EXIT_USAGE;
        }
    }
    if (optind + 1 == argc) {
        self->path = argv[optind];
        return -1;
    }
    fputs(usage, stderr);
    return EXIT_USAGE;
}

int verb_boot(int argc, char **argv)
{
    struct boot self = { .once = false };
    int result = parse_options(&self, argc, argv);

    return result >= 0 ? result : boot(&self);
}

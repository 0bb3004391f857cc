/*
 * mcanopen sim: simulated devices on a bus, each made from its EDS or DCF file alone.
 */
#include "verbs.h"

#include "api/control.h"
#include "api/file.h"
#include "api/load.h"
#include "mcanopen.h"
#include "runtime/network.h"

#include <getopt.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char usage[] =
    "usage: mcanopen sim [options] NETWORK.xml\n"
    "       mcanopen sim [options] --node ID DEVICE.eds [--node ID DEVICE.eds ...]\n"
    "\n"
    "Simulates CANopen devices from their EDS or DCF files: dictionary, SDO server, NMT, boot-up,\n"
    "heartbeat, emergencies. They start with the DefaultValues of the files. Runs until Ctrl-C.\n"
    "\n"
    "  --node ID FILE   a device with this node-ID; with NETWORK.xml it replaces that node's file\n"
    "  --without ID     leave this node of NETWORK.xml out\n"
    "  --bus BUS        where (default: the bus of the network with --net, as 'boot' has it)\n"
    "                   virtual:NAME?bitrate=500000: frames take the time of a real bus\n"
    "  --net N          network of the file (default: the first), or N of MCANOPEN_NET_N, can<N>\n"
    "  -q, --quiet      no warnings about the files\n"
    "  -v, --verbose    tell the NMT states of the devices\n"
    "  -h, --help       this text\n"
    "\n"
    "Exit codes: 0 ended, 2 usage or a fault in a file, 3 bus.\n";

struct sim_device {
    const char *file; /* given with --node; NULL: from the network's file */
    bool wanted, without, made;
    struct od od;
    struct slave slave;
};

struct sim {
    const char *xml;
    const char *bus;
    int net; /* -1: the first */
    bool quiet, verbose;
    struct network_config *networks;
    size_t network_count;
    const struct network_config *config; /* NULL: without a file */
    struct sim_device devices[NMT_NODE_MAX + 1];
    struct network *network;
};

static void print_message(void *context, enum co_severity severity, const char *text)
{
    const struct sim *self = context;

    if (severity == CO_ERROR || !self->quiet)
        fprintf(stderr, "%s\n", text);
}

/* --- devices --- */

/* A node of the network without a file: what every device has, with the identity expected. */
static enum co_err make_bare_od(const struct node_config *node, struct od *od)
{
    const uint32_t identity[] = { node->vendor_id, node->product_code, node->revision_number,
                                  node->serial_number };
    enum co_err err = od_add_number(od, 0x1000, 0, OD_UNSIGNED32, OD_RO, node->device_type);

    if (err == CO_OK)
        err = od_add_number(od, 0x1017, 0, OD_UNSIGNED16, OD_RW, node->consumer_heartbeat_time / 2);
    if (err == CO_OK)
        err = od_add_number(od, 0x1018, 0, OD_UNSIGNED8, OD_RO, 4);
    for (uint8_t sub = 1; sub <= 4 && err == CO_OK; sub++)
        err = od_add_number(od, 0x1018, sub, OD_UNSIGNED32, OD_RO, identity[sub - 1]);
    return err;
}

static int make_file_od(struct sim *self, uint8_t node, const char *path, struct od *od)
{
    struct co_report report = { .sink = print_message, .context = self };
    struct dcf dcf;
    int result = load_dcf(path, &report, &dcf);
    enum co_err err;

    if (result != MCANOPEN_OK)
        return EXIT_USAGE;
    report.file = path;
    err = dcf_make_od(&dcf, node, &report, od);
    dcf_done(&dcf);
    if (err != CO_OK && report.errors == 0)
        fprintf(stderr, "%s: error: %s\n", path, co_err_text(err));
    return err == CO_OK ? EXIT_UP : EXIT_USAGE;
}

static int make_configured_od(struct sim *self, const struct node_config *node, struct od *od)
{
    char *path = NULL;
    int result;

    if (!node->dcf_file) {
        fprintf(stderr,
                "%s:%u: warning: node %u has no DCF_File: simulated with the mandatory "
                "objects only (--node %u FILE gives it one)\n",
                self->xml, node->line, node->node_id, node->node_id);
        return make_bare_od(node, od) == CO_OK ? EXIT_UP : EXIT_USAGE;
    }
    if (file_find(self->config, self->xml, node->dcf_file, &path) != CO_OK)
        return EXIT_USAGE;
    if (access(path, F_OK) == 0) {
        result = make_file_od(self, node->node_id, path, od);
    } else {
        fprintf(stderr, "%s:%u: error: DCF_File: %s: %s\n", self->xml, node->file_line, path,
                file_error_text(CO_ERR_NOT_FOUND));
        result = EXIT_USAGE;
    }
    free(path);
    return result;
}

static int make_device(struct sim *self, uint8_t node)
{
    struct sim_device *device = &self->devices[node];
    int result;
    enum co_err err;

    od_init(&device->od);
    if (device->file)
        result = make_file_od(self, node, device->file, &device->od);
    else
        result = make_configured_od(self, network_config_node(self->config, node), &device->od);
    err = result == EXIT_UP ? slave_init(&device->slave, node, &device->od) : CO_ERR_VALUE;
    if (err == CO_OK) {
        device->made = true;
        device->slave.accept_long = true;
        device->slave.assume_sync = true;
        err = network_add_slave(self->network, &device->slave);
    } else {
        od_done(&device->od);
    }
    return err == CO_OK ? EXIT_UP : EXIT_USAGE;
}

static int make_devices(struct sim *self)
{
    int result = EXIT_UP;

    for (uint8_t node = 1; node <= NMT_NODE_MAX && result == EXIT_UP; node++)
        if (self->devices[node].wanted && !self->devices[node].without)
            result = make_device(self, node);
    return result;
}

static void free_devices(struct sim *self)
{
    for (unsigned node = 1; node <= NMT_NODE_MAX; node++) {
        if (!self->devices[node].made)
            continue;
        slave_done(&self->devices[node].slave);
        od_done(&self->devices[node].od);
    }
}

/* --- running --- */

static void on_event(void *context, struct network *network, const struct co_event *event)
{
    const struct sim *self = context;
    char text[CO_REPORT_TEXT_SIZE];

    if (control_bus_text(network, event, text, sizeof text))
        fprintf(stderr, "%s: warning: %s\n", network_name(network), text);
    if (!self->verbose || event->type != SLAVE_STATE)
        return;
    printf("node %u: %s\n", event->node, nmt_state_text(event->detail));
    fflush(stdout);
}

static int run(struct sim *self)
{
    int signals = stop_signals();
    struct pollfd fd = { .fd = signals, .events = POLLIN };
    unsigned count = 0;

    for (unsigned node = 1; node <= NMT_NODE_MAX; node++)
        count += self->devices[node].made;
    if (signals < 0 || network_start(self->network) != CO_OK) {
        fprintf(stderr, "mcanopen sim: out of resources\n");
        return EXIT_USAGE;
    }
    printf("%u simulated device%s on %s\n", count, count == 1 ? "" : "s",
           network_name(self->network));
    fflush(stdout);
    while (poll(&fd, 1, -1) < 1)
        continue;
    close(signals);
    return EXIT_UP;
}

static int simulate(struct sim *self)
{
    char bus[64], message[512] = "";
    const struct network_config by_net = { .net = (uint8_t)(self->net < 0 ? 0 : self->net) };
    struct network_options options = { .bus = bus, .sink = on_event, .context = self };
    int result;

    load_bus_name(self->config ? self->config : &by_net, bus, sizeof bus);
    if (self->bus)
        snprintf(bus, sizeof bus, "%s", self->bus);
    options.bitrate = self->config ? self->config->baudrate : 0;
    if (network_open(&options, &self->network, message, sizeof message) != CO_OK) {
        fprintf(stderr, "mcanopen sim: %s\n", message);
        return EXIT_BUS;
    }
    result = make_devices(self);
    if (result == EXIT_UP)
        result = run(self);
    network_close(self->network);
    free_devices(self);
    return result;
}

static bool read_network(struct sim *self)
{
    struct co_report report = { .file = self->xml, .sink = print_message, .context = self };
    char *text;
    size_t size;
    enum co_err err = file_read(self->xml, &text, &size);

    if (err != CO_OK) {
        fprintf(stderr, "%s: error: %s\n", self->xml, file_error_text(err));
        return false;
    }
    err = network_config_parse(text, size, &report, &self->networks, &self->network_count);
    free(text);
    for (size_t i = 0; i < self->network_count && !self->config; i++)
        if (self->net < 0 || self->networks[i].net == self->net)
            self->config = &self->networks[i];
    if (err == CO_OK && !self->config)
        fprintf(stderr, "%s: error: no network with Net_No %d\n", self->xml, self->net);
    for (size_t i = 0; self->config && i < self->config->node_count; i++)
        self->devices[self->config->nodes[i].node_id].wanted = true;
    return err == CO_OK && self->config;
}

/* --- options --- */

static bool parse_number(const char *option, const char *text, uint8_t least, uint8_t most,
                         uint8_t *ret_value)
{
    char *end;
    unsigned long value = strtoul(text, &end, 0);

    if (end == text || *end || value < least || value > most) {
        fprintf(stderr, "mcanopen sim: %s %s: expected %u..%u\n", option, text, least, most);
        return false;
    }
    *ret_value = (uint8_t)value;
    return true;
}

/* "--node ID" takes the argument after the ID as well. */
static bool take_node(struct sim *self, int argc, char **argv)
{
    uint8_t node;

    if (!parse_number("--node", optarg, 1, NMT_NODE_MAX, &node))
        return false;
    if (optind >= argc) {
        fprintf(stderr, "mcanopen sim: --node %s: expected a file behind it\n", optarg);
        return false;
    }
    self->devices[node].wanted = true;
    self->devices[node].file = argv[optind++];
    return true;
}

static bool take_option(struct sim *self, int option, int argc, char **argv)
{
    uint8_t number;

    switch (option) {
    case 'n': return take_node(self, argc, argv);
    case 'w':
        if (!parse_number("--without", optarg, 1, NMT_NODE_MAX, &number))
            return false;
        self->devices[number].without = true;
        return true;
    case 'b': self->bus = optarg; return true;
    case 'N':
        if (!parse_number("--net", optarg, 0, UINT8_MAX, &number))
            return false;
        self->net = number;
        return true;
    case 'q': self->quiet = true; return true;
    case 'v': self->verbose = true; return true;
    default: fputs(usage, stderr); return false;
    }
}

static bool parse_options(struct sim *self, int argc, char **argv)
{
    static const struct option options[] = {
        { "node", required_argument, NULL, 'n' }, { "without", required_argument, NULL, 'w' },
        { "bus", required_argument, NULL, 'b' },  { "net", required_argument, NULL, 'N' },
        { "quiet", no_argument, NULL, 'q' },      { "verbose", no_argument, NULL, 'v' },
        { "help", no_argument, NULL, 'h' },       { NULL, 0, NULL, 0 }
    };
    int option;
    bool any = false;

    /* "+": in order, so that a file behind --node is not taken for NETWORK.xml */
    while (optind < argc) {
        option = getopt_long(argc, argv, "+qvh", options, NULL);
        if (option == 'h') {
            fputs(usage, stdout);
            exit(EXIT_UP);
        }
        if (option == -1 && self->xml)
            break;
        if (option == -1)
            self->xml = argv[optind++];
        else if (!take_option(self, option, argc, argv))
            return false;
    }
    for (unsigned node = 1; node <= NMT_NODE_MAX; node++)
        any |= self->devices[node].wanted;
    if (optind == argc && (self->xml || any))
        return true;
    fputs(usage, stderr);
    return false;
}

int verb_sim(int argc, char **argv)
{
    struct sim *self = calloc(1, sizeof *self);
    int result = EXIT_USAGE;

    if (!self)
        return EXIT_USAGE;
    self->net = -1;
    if (parse_options(self, argc, argv) && (!self->xml || read_network(self)))
        result = simulate(self);
    network_config_free(self->networks, self->network_count);
    free(self);
    return result;
}

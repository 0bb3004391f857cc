/*
 * mcanopen sim: simulated devices on a bus, each made from its EDS or DCF file alone.
 */
#include "common_tool.h"
#include "mcanopen_sim_gate.h"
#include "mcanopen_sim_values.h"
#include "verbs.h"

#include "api/file.h"
#include "api/load.h"
#include "mcanopen.h"
#include "port/clock.h"
#include "proto/nmt.h"
#include "scanopen.h"

#include <getopt.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define VALUES_MAX 256u

static const char usage[] =
    "Usage: mcanopen sim [OPTION]... NETWORK.xml\n"
    "       mcanopen sim [OPTION]... -n ID DEVICE.eds [-n ID DEVICE.eds]...\n"
    "\n"
    "Simulates CANopen devices from their EDS or DCF files: dictionary, SDO servers, NMT, "
    "boot-up,\n"
    "heartbeat, emergencies, PDOs, SYNC. They start with the DefaultValues of the files. Runs "
    "until\n"
    "Ctrl-C.\n"
    "\n"
    "  -n, --node-id ID FILE\n"
    "                   a device with this node-ID; with NETWORK.xml it replaces that node's file\n"
    "  --without ID     leave this node of NETWORK.xml out\n"
    "  -i, --bus BUS    where (default: the bus of the network with --net, as 'boot' has it)\n"
    "                   virtual:NAME?bitrate=500000: frames take the time of a real bus\n"
    "  --net N          network of the file (default: the first), or N of MCANOPEN_NET_N, can<N>\n"
    "\n"
    "Values of objects; ID decimal, INDEX and SUB hexadecimal. What is mapped into a PDO is sent:\n"
    "  --set ID:INDEX[:SUB]=VALUE           --set 5:6401:1=1234\n"
    "  --ramp ID:INDEX[:SUB]=A..B/MS[/STEP] from A to B within MS, then anew, a step each STEP ms\n"
    "                                       (100): --ramp 5:6401:1=0..1000/2000\n"
    "  --toggle ID:INDEX[:SUB]=A..B/MS      A and B in turns: --toggle 5:6000:1=0..255/500\n"
    "  --file ID:INDEX[:SUB]=PATH           what masters read and write there (a DOMAIN) is this\n"
    "                                       file: --file 5:2100=firmware.bin\n"
    "\n"
    "  --store DIR      what masters save (1010h) is kept in DIR/node-ID.ccf (ccfread shows it), "
    "and\n"
    "                   is there when the device is started again\n"
    "\n"
    "For tests of testers:\n"
    "  --defect NAME    the one device does this wrong; may be repeated; 'help' lists all\n"
    "\n"
    "  -q, --quiet      no warnings about the files\n"
    "  -v, --verbose    tell the NMT states of the devices\n"
    "  -h, --help       shows this\n"
    "  --version        shows the version\n"
    "\n"
    "Exit codes: 0 ended, 2 usage or a fault in a file, 3 bus.\n";

struct sim_device {
    const char *file; /* given with --node; NULL: from the network's file */
    bool wanted, without;
    HNODE handle; /* NULL: not made */
};

struct sim {
    const char *xml;
    const char *bus;
    const char *store; /* NULL: nothing is kept */
    int net;           /* -1: the first */
    bool quiet, verbose;
    bool opening; /* the bus: what is said then is about it */
    struct network_config *networks;
    size_t network_count;
    const struct network_config *config; /* NULL: without a file */
    struct sim_device devices[NMT_NODE_MAX + 1];
    struct sim_value values[VALUES_MAX];
    unsigned value_count;
    struct sim_gate gate; /* with defects */
    bool gate_open;
};

static void print_line(const struct sim *self, enum co_severity severity, const char *text)
{
    if (severity == CO_ERROR || !self->quiet)
        fprintf(stderr, "%s\n", text);
}

static void print_message(void *context, const struct co_message *message)
{
    print_line(context, message->severity, message->text);
}

/* What the library says. */
static void on_log(void *context, int level, const char *text)
{
    const struct sim *self = context;

    if (self->opening)
        fputs("mcanopen sim: ", stderr);
    print_line(self, level == MCANOPEN_LOG_ERROR ? CO_ERROR : CO_WARNING, text);
}

/* --- devices --- */

static int on_event(SLAVE_EVENT *event)
{
    printf("node %u: %s\n", event->usModId, nmt_state_text((uint8_t)event->ulArg1));
    fflush(stdout);
    return SCANOPEN_OK;
}

static SLAVE_NODE_INFO make_info(const struct sim *self)
{
    return (SLAVE_NODE_INFO){ .ulEventMask = self->verbose ? EV_STATE_CHANGE : 0,
                              .ulOptions = PDO_ACCEPT_LONG };
}

static int network_number(const struct sim *self)
{
    return self->config ? self->config->net : self->net < 0 ? 0 : self->net;
}

/* A node of the network without a file: what every device has, with the identity expected. */
static int make_bare(struct sim *self, const struct node_config *node, HNODE *ret_handle)
{
    SLAVE_NODE_INFO info = make_info(self);

    fprintf(stderr,
            "%s:%u: warning: node %u has no DCF_File: simulated with the mandatory objects only "
            "(--node %u FILE gives it one)\n",
            self->xml, node->line, node->node_id, node->node_id);
    info.ulOptions |= PRODUCER_HEARTBEAT;
    info.ulDeviceType = node->device_type;
    info.usProducerHbTime = (unsigned short)(node->consumer_heartbeat_time / 2);
    info.ucMaxIdentityObject = 4;
    info.ulVendorId = node->vendor_id;
    info.ulProductCode = node->product_code;
    info.ulRevisionNumber = node->revision_number;
    info.ulSerialNumber = node->serial_number;
    return canOpenCreateNodeEx(network_number(self), node->node_id, on_event, &info, ret_handle);
}

static int make_from(struct sim *self, uint8_t node, const char *path, HNODE *ret_handle)
{
    const SLAVE_NODE_INFO info = make_info(self);

    return canOpenCreateNodeFromFile(network_number(self), node, on_event, path, &info, ret_handle);
}

static int make_configured(struct sim *self, const struct node_config *node, HNODE *ret_handle)
{
    char *path = NULL;
    int result = SCANOPEN_WRONG_PARAMETER;

    if (!node->dcf_file)
        return make_bare(self, node, ret_handle);
    if (file_find(self->config, self->xml, node->dcf_file, &path) != CO_OK)
        return SCANOPEN_OUT_OF_MEMORY;
    if (access(path, F_OK) == 0)
        result = make_from(self, node->node_id, path, ret_handle);
    else
        fprintf(stderr, "%s:%u: error: DCF_File: %s: %s\n", self->xml, node->file_line, path,
                file_error_text(CO_ERR_NOT_FOUND));
    free(path);
    return result;
}

/* Devices without 1010h keep nothing. */
static int keep_values(const struct sim *self, uint8_t node, HNODE handle)
{
    char *path = NULL;
    int result;

    if (!self->store)
        return SCANOPEN_OK;
    if (asprintf(&path, "%s/node-%u.ccf", self->store, node) < 0)
        return SCANOPEN_OUT_OF_MEMORY;
    result = canOpenSetStoreFile(handle, path);
    free(path);
    return result == SCANOPEN_SERVICE_NOT_ALLOWED ? SCANOPEN_OK : result;
}

static bool make_device(struct sim *self, uint8_t node)
{
    struct sim_device *device = &self->devices[node];
    int result;

    if (device->file)
        result = make_from(self, node, device->file, &device->handle);
    else
        result = make_configured(self, network_config_node(self->config, node), &device->handle);
    if (result == SCANOPEN_OK)
        result = keep_values(self, node, device->handle);
    if (result == SCANOPEN_OUT_OF_MEMORY)
        fprintf(stderr, "mcanopen sim: out of memory\n");
    if (result == SCANOPEN_CANNOT_START_DAEMON)
        fprintf(stderr, "mcanopen sim: no thread for the files of --store\n");
    return result == SCANOPEN_OK;
}

static bool make_devices(struct sim *self)
{
    bool good = true;

    for (uint8_t node = 1; node <= NMT_NODE_MAX && good; node++)
        if (self->devices[node].wanted && !self->devices[node].without)
            good = make_device(self, node);
    return good;
}

static void free_devices(struct sim *self)
{
    for (unsigned node = 1; node <= NMT_NODE_MAX; node++) {
        if (!self->devices[node].handle)
            continue;
        canOpenResetNode(self->devices[node].handle);
        canOpenDeleteNode(self->devices[node].handle);
    }
}

/* --- values --- */

static bool begin_values(struct sim *self)
{
    bool good = true;

    for (unsigned i = 0; i < self->value_count && good; i++) {
        struct sim_value *value = &self->values[i];
        HNODE handle = self->devices[value->node].handle;

        if (!handle)
            fprintf(stderr, "mcanopen sim: %s: there is no node %u\n", value->option, value->node);
        good = handle && sim_value_begin(value, handle, clock_now());
    }
    return good;
}

/* Returns how long the next one has time, for poll(). */
static int step_values(struct sim *self)
{
    const co_us_t now = clock_now();
    co_us_t next = CO_NEVER;

    for (unsigned i = 0; i < self->value_count; i++) {
        sim_value_step(&self->values[i], now);
        next = co_earlier(next, self->values[i].due);
    }
    return next == CO_NEVER ? -1 : (int)((next - now + 999) / 1000);
}

/* --- running --- */

static bool activate(struct sim *self, unsigned *ret_count)
{
    *ret_count = 0;
    for (unsigned node = 1; node <= NMT_NODE_MAX; node++) {
        if (!self->devices[node].handle)
            continue;
        if (canOpenActivateNode(self->devices[node].handle) != SCANOPEN_OK)
            return false;
        ++*ret_count;
    }
    return true;
}

static int run(struct sim *self, const char *bus)
{
    int signals = stop_signals();
    struct pollfd fd = { .fd = signals, .events = POLLIN };
    unsigned count;

    if (signals < 0 || !activate(self, &count)) {
        fprintf(stderr, "mcanopen sim: out of resources\n");
        return EXIT_USAGE;
    }
    printf("%u simulated device%s on %s\n", count, count == 1 ? "" : "s", bus);
    fflush(stdout);
    while (poll(&fd, 1, step_values(self)) < 1)
        continue;
    close(signals);
    return EXIT_UP;
}

/* The library opens what the environment names for the network. */
static void name_bus(const struct sim *self, char *bus, size_t size)
{
    const struct network_config by_net = { .net = (uint8_t)network_number(self) };
    char variable[32];

    load_bus_name(self->config ? self->config : &by_net, bus, size);
    if (self->bus)
        snprintf(bus, size, "%s", self->bus);
    snprintf(variable, sizeof variable, "MCANOPEN_NET_%d", network_number(self));
    setenv(variable, bus, 1);
}

/* 0: none, or several. */
static uint8_t only_device(const struct sim *self)
{
    uint8_t found = 0;

    for (uint8_t node = 1; node <= NMT_NODE_MAX; node++) {
        if (!self->devices[node].wanted || self->devices[node].without)
            continue;
        if (found)
            return 0;
        found = node;
    }
    return found;
}

static bool check_defects(const struct sim *self)
{
    if (self->gate.use_count == 0 || only_device(self))
        return true;
    fprintf(stderr, "mcanopen sim: --defect: expected one device\n");
    return false;
}

/* Defects are made on the way to the bus: the device gets a bus of its own. */
static bool open_gate(struct sim *self, const char *bus)
{
    char inside[GATE_NAME_SIZE], variable[32];

    if (self->gate.use_count == 0)
        return true;
    if (!sim_gate_open(&self->gate, bus, only_device(self), inside))
        return false;
    self->gate_open = true;
    snprintf(variable, sizeof variable, "MCANOPEN_NET_%d", network_number(self));
    setenv(variable, inside, 1);
    return true;
}

static void close_gate(struct sim *self)
{
    if (self->gate_open)
        sim_gate_close(&self->gate);
}

static int simulate_on(struct sim *self, const char *bus)
{
    SLAVE_NET_INFO info = { .usBaudrate = BAUDRATE_AS_IT_IS };
    int result = EXIT_USAGE;

    if (self->config && self->config->baudrate != 0)
        info.usBaudrate = (unsigned short)self->config->baudrate;
    self->opening = true;
    if (canOpenCreateNetworkEx(network_number(self), &info) != SCANOPEN_OK)
        return EXIT_BUS;
    self->opening = false;
    if (make_devices(self) && begin_values(self))
        result = run(self, bus);
    free_devices(self);
    canOpenRemoveNetwork(network_number(self));
    return result;
}

static int simulate(struct sim *self)
{
    char bus[64];
    int result = EXIT_BUS;

    mcanOpenSetLog(on_log, self);
    name_bus(self, bus, sizeof bus);
    if (open_gate(self, bus))
        result = simulate_on(self, bus);
    close_gate(self);
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
    unsigned value;

    if (!tool_number(text, least, most, &value)) {
        fprintf(stderr, "mcanopen sim: %s %s: expected %u..%u\n", option, text, least, most);
        return false;
    }
    *ret_value = (uint8_t)value;
    return true;
}

/* "--node-id ID" takes the argument after the ID as well. */
static bool take_node(struct sim *self, int argc, char **argv)
{
    uint8_t node;

    if (!parse_number("--node-id", optarg, 1, NMT_NODE_MAX, &node))
        return false;
    if (optind >= argc) {
        fprintf(stderr, "mcanopen sim: --node-id %s: expected a file behind it\n", optarg);
        return false;
    }
    self->devices[node].wanted = true;
    self->devices[node].file = argv[optind++];
    return true;
}

static bool take_value(struct sim *self, enum sim_motion motion)
{
    if (self->value_count == VALUES_MAX) {
        fprintf(stderr, "mcanopen sim: more than %u values\n", VALUES_MAX);
        return false;
    }
    return sim_value_parse(motion, optarg, &self->values[self->value_count++]);
}

static bool take_defect(struct sim *self)
{
    const struct sim_defect *defect = sim_defect_find(optarg);

    if (strcmp(optarg, "help") == 0) {
        sim_defect_list();
        exit(EXIT_UP);
    }
    if (!defect)
        fprintf(stderr, "mcanopen sim: --defect %s: there is none ('help' lists all)\n", optarg);
    else if (sim_gate_add(&self->gate, defect))
        return true;
    else
        fprintf(stderr, "mcanopen sim: more than %u defects\n", DEFECTS_MAX);
    return false;
}

static bool take_store(struct sim *self)
{
    struct stat status;

    self->store = optarg;
    if (stat(optarg, &status) == 0 && S_ISDIR(status.st_mode))
        return true;
    fprintf(stderr, "mcanopen sim: --store %s: expected a folder\n", optarg);
    return false;
}

static bool take_net(struct sim *self)
{
    uint8_t number;

    if (!parse_number("--net", optarg, 0, UINT8_MAX, &number))
        return false;
    self->net = number;
    return true;
}

static bool take_without(struct sim *self)
{
    uint8_t number;

    if (!parse_number("--without", optarg, 1, NMT_NODE_MAX, &number))
        return false;
    self->devices[number].without = true;
    return true;
}

static bool take_option(struct sim *self, int option, int argc, char **argv)
{
    static const char motions[] = "srtf"; /* in the order of enum sim_motion */
    const char *motion = strchr(motions, option);

    if (motion)
        return take_value(self, (enum sim_motion)(motion - motions));
    switch (option) {
    case 'n': return take_node(self, argc, argv);
    case 'w': return take_without(self);
    case 'i': self->bus = optarg; return true;
    case 'N': return take_net(self);
    case 'd': return take_defect(self);
    case 'S': return take_store(self);
    case 'q': self->quiet = true; return true;
    case 'v': self->verbose = true; return true;
    default: fputs(usage, stderr); return false;
    }
}

static bool parse_options(struct sim *self, int argc, char **argv)
{
    static const struct option options[] = {
        { "node-id", required_argument, NULL, 'n' }, { "without", required_argument, NULL, 'w' },
        { "bus", required_argument, NULL, 'i' },     { "net", required_argument, NULL, 'N' },
        { "set", required_argument, NULL, 's' },     { "ramp", required_argument, NULL, 'r' },
        { "toggle", required_argument, NULL, 't' },  { "file", required_argument, NULL, 'f' },
        { "defect", required_argument, NULL, 'd' },  { "store", required_argument, NULL, 'S' },
        { "quiet", no_argument, NULL, 'q' },         { "verbose", no_argument, NULL, 'v' },
        { "help", no_argument, NULL, 'h' },          { NULL, 0, NULL, 0 }
    };
    int option;
    bool any = false;

    /* "+": in order, so that a file behind --node is not taken for NETWORK.xml */
    while (optind < argc) {
        option = getopt_long(argc, argv, "+n:i:qvh", options, NULL);
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
    if (parse_options(self, argc, argv) && (!self->xml || read_network(self)) &&
        check_defects(self))
        result = simulate(self);
    network_config_free(self->networks, self->network_count);
    free(self);
    return result;
}

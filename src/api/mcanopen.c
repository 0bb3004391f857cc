#include "mcanopen.h"

#include "api/control.h"
#include "api/error_map.h"
#include "api/load.h"
#include "api/log.h"
#include "api/nets.h"
#include "api/priority.h"
#include "api/registry.h"
#include "api/scan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int mcanOpenInitialize(void)
{
    enum registry_state state;
    int result;
    struct registry *self = registry_begin_change(&state, &result);

    if (!self)
        return result;
    result = MCANOPEN_OK;
    if (state == REGISTRY_NEW) {
        if (control_init(self) == CO_OK)
            state = REGISTRY_INITIALIZED;
        else
            result = MCAL_OBJ_NO_MEMORY;
    }
    registry_end_change(state);
    return result;
}

/* No event of the network comes any more. */
static void leave_network(struct managed *self)
{
    if (self->placed)
        network_remove(self->network, self->config->manager_node_id);
    self->placed = false;
    if (self->network)
        nets_silence(self->config->net, NET_MANAGER);
}

static void close_managed(struct managed *self)
{
    leave_network(self);
    if (self->network)
        nets_close(self->config->net, NET_MANAGER);
    if (self->manager)
        manager_done(self->manager);
    free(self->manager);
    *self = (struct managed){ .config = NULL };
}

static void close_all(struct registry *self)
{
    for (size_t i = 0; i < self->network_count; i++)
        close_managed(&self->networks[i]);
    self->network_count = 0;
    network_config_free(self->configs, self->config_count);
    self->configs = NULL;
    self->config_count = 0;
}

/* A local slave may have its node-ID. */
static enum co_err take_place(struct managed *self, char *message, size_t size)
{
    const uint8_t node = self->config->manager_node_id;
    const enum co_err err = network_add(self->network, node, control_on_event, self);

    if (err != CO_OK) {
        snprintf(message, size, "Manager_Node_Id: %u is the node-ID of a slave of this process",
                 node);
        return CO_ERR_VALUE;
    }
    self->placed = true;
    if (self->config->debug_mask != 0)
        network_trace(self->network);
    return network_set_manager(self->network, node, self->manager);
}

/* Two masters of one file on one bus: a mistake in the file, not a second master to live with. */
static enum co_err check_bus(const struct managed *self, char *message, size_t size)
{
    const struct registry *registry = self->registry;

    for (size_t i = 0; i < registry->network_count; i++) {
        const struct managed *other = &registry->networks[i];

        if (other == self || !other->network || !other->config->nmt_master ||
            !self->config->nmt_master ||
            strcmp(network_name(other->network), network_name(self->network)) != 0)
            continue;
        snprintf(message, size, "Interface: %s is that of network %u: a bus has one NMT master",
                 network_name(self->network), other->config->net);
        return CO_ERR_VALUE;
    }
    return CO_OK;
}

static int open_bus(struct managed *self, struct co_report *report)
{
    char bus[64], message[CO_REPORT_TEXT_SIZE] = "";
    const struct net_order order = { .number = self->config->net,
                                     .user = NET_MANAGER,
                                     .bus = bus,
                                     .bitrate = self->config->baudrate,
                                     .sink = control_on_event,
                                     .context = self };
    enum co_err err;

    load_bus_name(self->config, bus, sizeof bus);
    err = nets_open(&order, &self->network, message, sizeof message);
    if (err == CO_OK)
        err = check_bus(self, message, sizeof message);
    if (err == CO_OK)
        err = take_place(self, message, sizeof message);
    if (err != CO_OK)
        co_report_add(report, CO_ERROR, self->config->line, "%s",
                      message[0] ? message : co_err_text(err));
    return error_of_bus(err);
}

static int open_managed(struct managed *self, struct network_config *config,
                        struct co_report *report)
{
    struct manager *manager = calloc(1, sizeof *manager);

    self->config = config;
    if (!manager)
        return MCAL_OBJ_NO_MEMORY;
    if (manager_init(manager, config) != CO_OK) {
        free(manager);
        return MCAL_OBJ_NO_MEMORY;
    }
    self->manager = manager;
    return open_bus(self, report);
}

static int configure(struct registry *self, const char *path, struct co_report *report)
{
    int result = load_networks(path, report, &self->configs, &self->config_count);

    event_queue_open(&self->events);
    event_queue_open(&self->logs);
    for (size_t i = 0; i < self->config_count && result == MCANOPEN_OK; i++) {
        struct managed *managed = &self->networks[self->network_count++];

        managed->registry = self;
        result = open_managed(managed, &self->configs[i], report);
    }
    if (result != MCANOPEN_OK && report->errors == 0)
        co_report_add(report, CO_ERROR, 0, "out of memory");
    if (result != MCANOPEN_OK)
        close_all(self);
    return result;
}

int mcanOpenConfig(const char *cfgFile)
{
    struct co_report report = { .sink = log_sink };
    enum registry_state state;
    struct registry *self;
    int result;

    if (!cfgFile)
        return MCAL_PARA_ERROR;
    self = registry_begin_change(&state, &result);
    if (!self)
        return result;
    if (state == REGISTRY_INITIALIZED) {
        result = configure(self, cfgFile, &report);
        if (result == MCANOPEN_OK)
            state = REGISTRY_CONFIGURED;
    } else {
        co_report_add(&report, CO_ERROR, 0, "mcanOpenConfig: %s",
                      state == REGISTRY_NEW ? "mcanOpenInitialize comes first"
                                            : "configured already, mcanOpenShutDown comes first");
    }
    memcpy(self->error_text, report.first_error, sizeof self->error_text);
    registry_end_change(state);
    return result;
}

const char *mcanOpenGetErrorText(void)
{
    return registry_error_text();
}

/* The slaves of this process may have claimed others before. */
static enum co_err set_network_priorities(const struct managed *managed)
{
    const int priority = priority_of_protocol(managed->config);
    int daemons[PRIOS];
    enum co_err err;

    if (priority <= 0)
        return CO_OK;
    err = network_claim_priority(managed->network, priority);
    if (err == CO_OK && priority_of_slaves(managed->config, daemons))
        err = scan_adopt_priorities(managed->config->net, daemons);
    return err;
}

/* One daemon serves all networks. */
static enum co_err set_control_priority(struct registry *self)
{
    int highest = 0;

    for (size_t i = 0; i < self->config_count; i++)
        if (priority_of_control(&self->configs[i]) > highest)
            highest = priority_of_control(&self->configs[i]);
    return thread_set_priority(&self->control, highest);
}

static bool set_priorities(struct registry *self)
{
    bool allowed = set_control_priority(self) == CO_OK;

    for (size_t i = 0; i < self->network_count; i++) {
        const enum co_err err = set_network_priorities(&self->networks[i]);

        if (err == CO_ERR_EXISTS)
            log_put(CO_WARNING, "thread priorities: the slaves of this process have set them "
                                "before; those count");
        else if (err != CO_OK)
            allowed = false;
    }
    return allowed;
}

static bool tried_all(const struct managed *managed)
{
    const struct manager *manager = managed->manager;

    if (!managed->config->nmt_master || manager->bus_lost)
        return true; /* nobody tries them, or nobody can */
    for (size_t i = 0; i < managed->config->node_count; i++) {
        const struct boot_node *node = &manager->nodes[managed->config->nodes[i].node_id];

        if (boot_node_is_booted_by_master(node) && !node->tried)
            return false;
    }
    return true;
}

/* None of the calls that wait must come to its turn because the one before it has ended. */
static void end_calls(const struct managed *self)
{
    co_us_t now;
    struct co_outbox *out = network_enter(self->network, &now);

    manager_shut(self->manager, now, out);
    network_leave(self->network, self->config->manager_node_id);
    network_retire(self->network, self->config->manager_node_id);
}

/* First the calls that wait, then the threads, then what they worked on. */
static void shut_down(struct registry *self)
{
    registry_close();
    event_queue_close(&self->events);
    for (size_t i = 0; i < self->network_count; i++)
        end_calls(&self->networks[i]);
    registry_expel();
    for (size_t i = 0; i < self->network_count; i++)
        leave_network(&self->networks[i]);
    event_queue_close(&self->logs);
    thread_join(&self->control);
    close_all(self);
}

static bool switch_on(struct managed *self)
{
    struct co_outbox *out;
    co_us_t now;

    if (network_run(self->network) != CO_OK)
        return false;
    out = network_enter(self->network, &now);
    manager_start(self->manager, now, out);
    network_leave(self->network, self->config->manager_node_id);
    return true;
}

/* Calls that an event of the first network brings about are let in before the last one runs. */
static bool start_threads(struct registry *self)
{
    if (thread_start(&self->control, "mcan-control", control_run, self) != CO_OK)
        return false;
    registry_set_state(REGISTRY_RUNNING);
    for (size_t i = 0; i < self->network_count; i++)
        if (!switch_on(&self->networks[i]))
            return false;
    return true;
}

static enum registry_state start(struct registry *self)
{
    if (!start_threads(self)) {
        log_put(CO_ERROR, "mcanOpenStart: no memory for the threads: shut down");
        shut_down(self);
        return REGISTRY_INITIALIZED;
    }
    if (!set_priorities(self))
        log_put(CO_WARNING, "no right to set thread priorities (CAP_SYS_NICE, or ulimit -r): the "
                            "threads run with the default ones");
    return REGISTRY_RUNNING;
}

/* Each slave of the network has been tried once, or the network goes away. */
static void wait_for_startup(int net)
{
    struct managed *managed;
    enum co_err err = CO_OK;
    uint8_t self;
    co_us_t now;

    if (registry_enter(net, true, &managed) != MCANOPEN_OK)
        return;
    self = managed->config->manager_node_id;
    network_enter(managed->network, &now);
    while (!tried_all(managed) && err != CO_ERR_STATE)
        err = network_wait(managed->network, self, CO_NEVER);
    network_leave(managed->network, self);
    registry_leave();
}

void mcanOpenStart(void)
{
    int waiting[NETWORK_INSTANCES], result;
    size_t waiting_count = 0;
    enum registry_state state;
    struct registry *self = registry_begin_change(&state, &result);

    if (!self) {
        log_put(CO_ERROR, "mcanOpenStart: not possible now");
        return;
    }
    if (state != REGISTRY_CONFIGURED) {
        log_put(CO_ERROR, state == REGISTRY_RUNNING ? "mcanOpenStart: started already"
                                                    : "mcanOpenStart: nothing is configured");
    } else {
        state = start(self);
        for (size_t i = 0; i < self->network_count; i++)
            if (self->networks[i].config->wait_for_startup)
                waiting[waiting_count++] = self->networks[i].config->net;
    }
    registry_end_change(state);
    for (size_t i = 0; i < waiting_count; i++)
        wait_for_startup(waiting[i]);
}

int mcanOpenShutDown(void)
{
    int result;
    enum registry_state state;
    struct registry *self = registry_begin_change(&state, &result);

    if (!self)
        return result;
    if (state == REGISTRY_CONFIGURED || state == REGISTRY_RUNNING) {
        shut_down(self);
        state = REGISTRY_INITIALIZED;
        result = MCANOPEN_OK;
    }
    registry_end_change(state);
    return result;
}

int mcanOpenCleanup(void)
{
    int result;
    enum registry_state state;
    struct registry *self = registry_begin_change(&state, &result);

    if (!self)
        return result;
    if (state == REGISTRY_CONFIGURED || state == REGISTRY_RUNNING)
        shut_down(self);
    if (state != REGISTRY_NEW) {
        control_done(self);
        self->error_text[0] = '\0';
        log_reset();
        state = REGISTRY_NEW;
        result = MCANOPEN_OK;
    }
    registry_end_change(state);
    return result;
}

int mcanOpenGetVersion(unsigned short *version)
{
    if (!version)
        return MCAL_PARA_ERROR;
    *version = (unsigned short)(MCANOPEN_VERSION_MAJOR << 12 | MCANOPEN_VERSION_MINOR << 8 |
                                MCANOPEN_VERSION_PATCH);
    return MCANOPEN_OK;
}

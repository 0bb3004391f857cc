#include "manager/boot_network.h"

static bool is_booting(const struct manager *self)
{
    return self->state == NETWORK_OFF || self->state == NETWORK_RESETTING ||
           self->state == NETWORK_BOOTING || self->state == NETWORK_HALTED;
}

static bool is_reset(enum nmt_command command)
{
    return command == NMT_RESET_NODE || command == NMT_RESET_COMMUNICATION;
}

bool command_self_is_allowed(const struct manager *self, enum nmt_command command)
{
    if (self->bus_lost)
        return false;
    return is_reset(command) ? self->state != NETWORK_OFF : !is_booting(self);
}

static enum co_err command_self(struct manager *self, enum nmt_command command, co_us_t now)
{
    if (!command_self_is_allowed(self, command))
        return CO_ERR_STATE;
    if (is_reset(command)) {
        slave_command(&self->device, command, now, &self->inner);
        boot_network_begin(self, command, now);
        return CO_OK;
    }
    if (command == NMT_START && !self->complete) {
        boot_network_go_on_booting(self, now);
    } else if (command == NMT_START && self->state != NETWORK_OPERATIONAL) {
        boot_network_go(self, now);
    } else if (command != NMT_START) {
        slave_command(&self->device, command, now, &self->inner);
        self->state = NETWORK_WAITING;
    }
    return CO_OK;
}

static enum co_err send_command(struct manager *self, enum nmt_command command, uint8_t node)
{
    struct co_frame frame = nmt_command_frame(command, node);

    if (!co_outbox_room(&self->inner, 1, 0))
        return CO_ERR_AGAIN;
    co_outbox_put_frame(&self->inner, &frame);
    return CO_OK;
}

/* A broadcast, unless it would start a slave that is not configured. */
static enum co_err start_all(struct manager *self, co_us_t now)
{
    bool is_ready = boot_network_is_ready(self);

    if (!self->complete) {
        boot_network_go_on_booting(self, now);
        return CO_OK;
    }
    if (self->state != NETWORK_OPERATIONAL)
        boot_network_operate(self, now);
    if (is_ready)
        self->start_all_due = true;
    else
        boot_network_start_each(self, now);
    return CO_OK;
}

static enum co_err command_all(struct manager *self, enum nmt_command command, co_us_t now)
{
    enum co_err err;

    if (is_reset(command))
        return command_self(self, command, now);
    if (is_booting(self))
        return CO_ERR_STATE;
    if (command == NMT_START)
        return start_all(self, now);
    err = send_command(self, command, NMT_ALL_NODES);
    if (err == CO_OK)
        FOR_EACH_NODE(self, node)
            boot_node_commanded(node, command);
    return err;
}

/* A reset that begins a new boot of the node. */
static enum co_err reset_node(struct manager *self, struct boot_node *node,
                              enum nmt_command command, co_us_t now)
{
    if (self->state == NETWORK_RESETTING)
        return CO_ERR_STATE;
    boot_network_renew_node(self, node, command, now);
    return CO_OK;
}

static enum co_err command_node(struct manager *self, enum nmt_command command,
                                struct boot_node *node, co_us_t now)
{
    bool ready = node->step == BOOT_READY || node->step == BOOT_STARTED;
    bool booted_here = boot_node_is_booted_by_master(node);
    enum co_err err;

    if (self->state == NETWORK_OFF || (command == NMT_START && self->state != NETWORK_OPERATIONAL))
        return CO_ERR_STATE;
    if (booted_here && is_reset(command) && node->config->auto_start_slave)
        return reset_node(self, node, command, now);
    if (booted_here && !ready && !is_reset(command))
        return CO_ERR_STATE;
    err = send_command(self, command, node->config->node_id);
    if (err == CO_OK)
        boot_node_commanded(node, command);
    return err;
}

/* Where another master commands, only its own state is the application's. */
static enum co_err command_device(struct manager *self, enum nmt_command command, uint8_t node,
                                  co_us_t now)
{
    if (node != self->config->manager_node_id)
        return CO_ERR_STATE;
    slave_command(&self->device, command, now, &self->inner);
    return CO_OK;
}

enum co_err command_execute(struct manager *self, enum nmt_command command, uint8_t node,
                            co_us_t now)
{
    if (!self->config->nmt_master)
        return command_device(self, command, node, now);
    if (self->bus_lost)
        return CO_ERR_STATE;
    if (node == self->config->manager_node_id)
        return command_self(self, command, now);
    if (node == NMT_ALL_NODES)
        return command_all(self, command, now);
    if (node > NETWORK_NODE_MAX || !self->nodes[node].config)
        return CO_ERR_NOT_FOUND;
    manager_touch(self, node);
    return command_node(self, command, &self->nodes[node], now);
}

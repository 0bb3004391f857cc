#include "manager/boot_network.h"

static void put_event(struct manager *self, struct co_event event)
{
    co_outbox_put_event(&self->inner, &event);
}

/* A node has come up, by our reset or by itself. */
static void on_boot_up(struct manager *self, uint8_t node_id, const struct co_frame *frame,
                       co_us_t now)
{
    struct boot_node *node = &self->nodes[node_id];
    const bool is_updated = node->step == BOOT_UPDATE_SOFTWARE; /* to its end, whoever boots it */

    put_event(self, (struct co_event){ .type = MANAGER_NODE_BOOT_UP,
                                       .node = node_id,
                                       .actual = node->config != NULL });
    sdo_channel_forget(&self->channels[node_id]);
    if (!node->config)
        return;
    boot_node_on_boot_up(node, frame, now, &self->inner);
    if (self->state == NETWORK_RESETTING)
        boot_network_on_boot_up(self, now); /* booted at the end of the boot delay */
    if (self->state == NETWORK_OFF || self->state == NETWORK_RESETTING)
        return;
    if (!boot_node_is_booted_by_master(node))
        return;
    if (!node->config->auto_start_slave && !boot_node_is_written(node) && !is_updated)
        return;
    if (is_updated)
        boot_network_go_on_updating(self, node, now);
    else if (node->step != BOOT_RESET)
        boot_network_boot_again(self, node, now);
}

/* A second manager, most often; the answers to SDO requests of both get mixed up. */
static void on_own_id(struct manager *self, uint8_t state)
{
    put_event(self, (struct co_event){ .type = MANAGER_NODE_ID_TAKEN,
                                       .node = self->config->manager_node_id,
                                       .detail = state,
                                       .actual = ++self->taken });
}

void error_control_on_frame(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    uint8_t node_id, state;
    struct boot_node *node;

    if (!nmt_parse_error_control(frame, &node_id, &state))
        return;
    if (node_id == self->config->manager_node_id) {
        on_own_id(self, state);
        return;
    }
    if (state == NMT_INITIALISING) {
        on_boot_up(self, node_id, frame, now);
        return;
    }
    node = &self->nodes[node_id];
    if (node->config)
        boot_node_on_error_control(node, frame, now, &self->inner);
}

/* As it is supervised, which a changed configuration does not change before its next boot. */
static bool is_guarded(const struct boot_node *node)
{
    return node->supervision.heartbeat.period == 0;
}

/* ms until a node counts as lost */
static uint64_t silence_of(const struct boot_node *node)
{
    const struct supervision *supervision = &node->supervision;

    return (is_guarded(node) ? supervision->guard.life_time : supervision->heartbeat.period) /
           CO_MS(1);
}

/*
 * A running node has fallen silent. What a mandatory one means for the network is configured; else
 * the node alone is reset and booted again, for as long as it takes.
 */
void error_control_on_lost(struct manager *self, uint8_t node_id, co_us_t now)
{
    struct boot_node *node = &self->nodes[node_id];
    enum action_on_error action = self->rules.action_on_error;

    if (boot_node_is_without_heartbeat(node) || boot_node_on_silence(node, now, &self->inner))
        return; /* it was not in operation */
    if (!supervision_is_on(&node->supervision))
        return; /* its boot has begun anew since, or it was removed */
    put_event(self, (struct co_event){ .type = MANAGER_NODE_LOST,
                                       .node = node_id,
                                       .detail = node->nmt_state,
                                       .expected = silence_of(node),
                                       .actual = is_guarded(node) });
    node->nmt_state = NMT_INITIALISING;
    node->lost = true;
    if (node->config->mandatory && action == ACTION_STOP_ALL) {
        boot_network_stop(self, now);
    } else if (node->config->mandatory && action == ACTION_RESET_ALL) {
        slave_command(&self->device, NMT_RESET_NODE, now, &self->inner);
        boot_network_begin(self, NMT_RESET_NODE, now);
    } else if (node->config->auto_start_slave && node->config->check_node_state) {
        boot_network_reboot(self, node, now); /* no reset if it is found operational */
    } else if (node->config->auto_start_slave) {
        boot_network_reset_node(self, node, boot_node_reset_command(node), now);
    }
}

void error_control_on_alive(struct manager *self, uint8_t node_id, co_us_t now)
{
    struct boot_node *node = &self->nodes[node_id];

    if (node->lost)
        put_event(self, (struct co_event){ .type = MANAGER_NODE_BACK,
                                           .node = node_id,
                                           .detail = node->nmt_state,
                                           .expected = silence_of(node),
                                           .actual = is_guarded(node) });
    node->lost = false;
    boot_node_on_alive(node, now, &self->inner);
}

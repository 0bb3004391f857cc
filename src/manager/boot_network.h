/*
 * Boot of the network: what the nodes have in common (CiA 302-2, "boot process of the NMT master").
 * Parts of the manager, on its struct; nobody else calls them.
 */
#ifndef CO_MANAGER_BOOT_NETWORK_H
#define CO_MANAGER_BOOT_NETWORK_H

#include "manager/manager.h"

/* A configured node, by its place in the configuration, to act on it. */
static inline struct boot_node *boot_network_node(struct manager *self, size_t i)
{
    uint8_t node = self->config->nodes[i].node_id;

    manager_touch(self, node);
    return &self->nodes[node];
}

/* Runs over the configured nodes, to act on them ... */
#define FOR_EACH_NODE(manager, node)                                                               \
    for (size_t i_ = 0; i_ < (manager)->config->node_count; i_++)                                  \
        for (struct boot_node *node = boot_network_node(manager, i_); node; node = NULL)

/* ... or only to look at them. */
#define LOOK_AT_EACH_NODE(manager, node)                                                           \
    for (size_t i_ = 0; i_ < (manager)->config->node_count; i_++)                                  \
        for (const struct boot_node *node =                                                        \
                 &(manager)->nodes[(manager)->config->nodes[i_].node_id];                          \
             node; node = NULL)

/* All frames and events below go to manager->inner. */

/*
 * At power on, and when the bus is back: resets all nodes (each by itself where one is to be kept
 * alive, that one not), and boots them.
 */
void boot_network_start(struct manager *self, co_us_t now);
/* Resets all nodes with this command and boots them. */
void boot_network_begin(struct manager *self, enum nmt_command command, co_us_t now);
/* Nothing is sent or expected until it is resumed: that boots all anew; STOPPED stays so. */
void boot_network_suspend(struct manager *self, co_us_t now);
void boot_network_resume(struct manager *self, co_us_t now);
/* Decides, after anything has changed, whether the network goes operational or is halted. */
void boot_network_check(struct manager *self, co_us_t now);
/* It was stopped before all mandatory nodes had booted: the start that is ordered has to wait. */
void boot_network_go_on_booting(struct manager *self, co_us_t now);
/* The manager goes operational and starts the slaves that are booted. */
void boot_network_go(struct manager *self, co_us_t now);
/* Operational, but starts nobody; goes on with what was lost while all were stopped. */
void boot_network_operate(struct manager *self, co_us_t now);
/* Starts the booted slaves, each with a command of its own. */
void boot_network_start_each(struct manager *self, co_us_t now);
/* True if a broadcast would start no slave that is not configured. */
bool boot_network_is_ready(const struct manager *self);
/* It is as the configuration wants it in a network that is up. */
bool boot_network_is_node_up(const struct manager *self, const struct boot_node *node);
/* NMT stop for all, the manager too. */
void boot_network_stop(struct manager *self, co_us_t now);
/* A boot-up message in the boot delay. */
void boot_network_on_boot_up(struct manager *self, co_us_t now);
void boot_network_on_time(struct manager *self, co_us_t now);
co_us_t boot_network_deadline(const struct manager *self);

/* Takes the boot request of a node back: its boot stands still. */
void boot_network_take_back(struct manager *self, struct boot_node *node, co_us_t now);
/* The same, and begins its boot anew, with or without a reset. */
void boot_network_reboot(struct manager *self, struct boot_node *node, co_us_t now);
/* Writes its configuration to a node that has booted, or begins that anew. */
void boot_network_configure(struct manager *self, struct boot_node *node, co_us_t now);
/* The same because of its boot-up message, unless that is one too many in mid boot. */
void boot_network_boot_again(struct manager *self, struct boot_node *node, co_us_t now);
/* In the middle of a software update, which goes on. */
void boot_network_go_on_updating(struct manager *self, struct boot_node *node, co_us_t now);
void boot_network_reset_node(struct manager *self, struct boot_node *node, enum nmt_command command,
                             co_us_t now);
/* The same for a boot of its own, not another try: its default values come first again. */
void boot_network_renew_node(struct manager *self, struct boot_node *node, enum nmt_command command,
                             co_us_t now);

/* error_control.c: a boot-up message, a heartbeat, a lost node (CiA 302-2, "error control"). */
void error_control_on_frame(struct manager *self, const struct co_frame *frame, co_us_t now);
void error_control_on_lost(struct manager *self, uint8_t node, co_us_t now);
void error_control_on_alive(struct manager *self, uint8_t node, co_us_t now);

/* command.c: what manager_command() does, without what follows from it. */
enum co_err command_execute(struct manager *self, enum nmt_command command, uint8_t node,
                            co_us_t now);
/* The master would execute a command to itself now, or one to reset all nodes. */
bool command_self_is_allowed(const struct manager *self, enum nmt_command command);

#endif

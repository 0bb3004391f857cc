#include "manager/config_write.h"

#include "base/bytes.h"
#include "manager/boot_network.h"
#include "manager/config_objects.h"

#include <string.h>

/* What one write may put: its answer, and a boot that is begun anew. */
#define ROOM_FRAMES 4u
#define ROOM_EVENTS 8u

/* A node whose configuration was changed, as it was before. */
struct change {
    struct boot_node *node; /* NULL: nothing is different for it */
    bool was_listed, was_booted;
};

/* --- what it means for the node's boot --- */

/* Nobody knows how it will be found: it is reset first, unless it is to be kept alive. */
static void join(struct manager *self, struct boot_node *node, co_us_t now)
{
    if (self->state == NETWORK_OFF || self->state == NETWORK_RESETTING)
        return; /* it is booted with the others */
    if (self->state == NETWORK_STOPPED)
        node->lost = node->config->auto_start_slave; /* the order that starts all boots it */
    else if (node->config->auto_start_slave && !node->config->check_node_state)
        boot_network_reset_node(self, node, boot_node_reset_command(node), now);
    else
        boot_network_reboot(self, node, now);
}

static void leave(struct manager *self, struct boot_node *node, co_us_t now)
{
    boot_network_take_back(self, node, now);
    boot_node_stop(node);
}

/* What it has got so far is of a configuration that is no more. */
static void begin_anew(struct manager *self, struct boot_node *node, co_us_t now)
{
    if (node->step == BOOT_CONFIGURE || node->step == BOOT_SAVE)
        boot_network_reset_node(self, node, boot_node_reset_command(node), now);
    else if (boot_node_is_in_mid_boot(node) || node->step == BOOT_CHECK_STATE)
        boot_network_reboot(self, node, now);
}

static void apply(struct manager *self, const struct change *change, co_us_t now)
{
    struct boot_node *node = change->node;
    bool is_listed, is_booted;

    if (!node)
        return;
    manager_touch(self, node->config->node_id);
    is_listed = node->config->nmt_slave;
    is_booted = is_listed && node->config->auto_start_slave;
    if (change->was_listed && !is_listed)
        leave(self, node, now);
    else if (is_listed && (!change->was_listed || (is_booted && !change->was_booted)))
        join(self, node, now);
    else if (is_listed)
        begin_anew(self, node, now);
}

/* --- the configuration --- */

static struct node_config present(const struct manager *self, uint8_t node_id)
{
    const struct node_config *node = network_config_node(self->config, node_id);

    return node ? *node : network_config_unlisted(node_id);
}

/* The node as it is to be from now on. */
static sdo_abort_t put_node(struct manager *self, const struct node_config *changed,
                            struct change *ret_change)
{
    struct boot_node *node = &self->nodes[changed->node_id];
    struct node_config *config = network_config_take_node(self->config, changed->node_id);

    if (!config)
        return SDO_NO_MEMORY;
    if (!node->config)
        boot_node_init(node, changed->node_id, config);
    *ret_change = (struct change){ .node = node,
                                   .was_listed = config->nmt_slave,
                                   .was_booted = config->nmt_slave && config->auto_start_slave };
    *config = *changed;
    return SDO_OK;
}

static sdo_abort_t write_node(struct manager *self, const struct co_event *event, uint32_t value,
                              struct change *ret_change)
{
    struct node_config changed = present(self, event->sub);
    const uint32_t before = config_object_of_node(event->index, &changed);
    const sdo_abort_t code = config_object_set_node(event->index, &changed, value);

    if (code != SDO_OK || config_object_of_node(event->index, &changed) == before)
        return code;
    if (event->sub == self->config->manager_node_id)
        return SDO_INVALID_VALUE;
    return put_node(self, &changed, ret_change);
}

static sdo_abort_t write_number(struct manager *self, const struct co_event *event, uint32_t value,
                                struct change *ret_change)
{
    if (config_object_is_of_node(event->index))
        return write_node(self, event, value, ret_change);
    return config_object_set_network(event->index, self->config, value);
}

/* --- answers --- */

void config_write_on_verdict(struct manager *self, const struct co_event *event, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    struct change change = { .node = NULL };
    sdo_abort_t code = SDO_LOCAL_CONTROL;
    uint32_t value;

    /* What cannot be answered is not done: the client hears of it when its time is over. */
    if (!slave_waits_for(&self->device, transfer) ||
        !co_outbox_room(&self->inner, ROOM_FRAMES, ROOM_EVENTS))
        return;
    value = (uint32_t)get_le(slave_received(&self->device, transfer), (size_t)event->actual);
    if (self->config->nmt_master)
        code = write_number(self, event, value, &change);
    slave_verdict(&self->device, transfer, code, now, &self->inner);
    if (code != SDO_OK)
        return;
    config_objects_refresh(self->config, &self->od, event->index, event->sub);
    apply(self, &change, now);
}

/* 1005h, 1006h, 1017h: what was written is from now on what a reset brings back. */
void config_write_on_written(struct manager *self, const struct co_event *event)
{
    struct od_entry *entry = od_find(&self->od, event->index, event->sub);

    if (!entry->watched && !entry->fetched && entry->initial && entry->size <= OD_SMALL)
        memcpy(entry->initial, entry->value, entry->size);
}

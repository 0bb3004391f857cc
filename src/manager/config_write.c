#include "manager/config_write.h"

#include "base/bytes.h"
#include "manager/boot_network.h"
#include "manager/config_domains.h"
#include "manager/config_objects.h"
#include "manager/manager_od.h"

#include <stdio.h>
#include <string.h>

/* What one write may put: its answer, and a boot that is begun anew. */
#define ROOM_FRAMES 4u
#define ROOM_EVENTS 8u

#define CONF 0x666E6F63u /* what is to be written to 1F25h: "conf" */

/* A node whose configuration was changed, as it was before. */
struct change {
    struct boot_node *node; /* NULL: nothing is different for it */
    bool was_listed, was_booted;
};

/* --- what it means for the node's boot --- */

/* Nobody knows how it will be found: it is reset first, unless it is to be kept alive. */
static void join(struct manager *self, struct boot_node *node, co_us_t now)
{
    const bool booted = node->config->auto_start_slave;

    if (self->state == NETWORK_RESETTING) {        /* it is booted with the others ... */
        node->absent = booted && self->reset_each; /* ... whose resets it has missed */
        return;
    }
    if (booted && !node->config->check_node_state)
        boot_network_renew_node(self, node, boot_node_reset_command(node), now);
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
    const bool is_written = boot_node_is_written(node);

    if (is_written && !node->config->auto_start_slave) /* 1F25h */
        boot_network_configure(self, node, now);
    else if (is_written)
        boot_network_renew_node(self, node, boot_node_reset_command(node), now);
    else if (boot_node_is_under_way(node))
        boot_network_reboot(self, node, now);
}

static void apply(struct manager *self, const struct change *change, co_us_t now)
{
    struct boot_node *node = change->node;
    bool is_listed;

    if (!node)
        return;
    manager_touch(self, node->config->node_id);
    is_listed = node->config->nmt_slave;
    if (change->was_listed && !is_listed)
        leave(self, node, now);
    else if (is_listed &&
             (!change->was_listed || (node->config->auto_start_slave && !change->was_booted)))
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
                                   .was_booted = config->auto_start_slave };
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

static bool has_nothing(const struct node_config *node)
{
    return ccf_count(&node->ccf) == 0 && !node->dcf_text && !node->software;
}

static void tell_refused(struct manager *self, const struct co_event *event, sdo_abort_t code,
                         const struct co_report *report)
{
    struct network_config *config = self->config;
    const struct co_event refused = { .type = MANAGER_CONFIG_REFUSED,
                                      .node = event->sub,
                                      .index = event->index,
                                      .sub = event->sub,
                                      .code = code,
                                      .actual = config->refused + 1u };

    if (report->errors == 0)
        return;
    config->refused++;
    snprintf(config->refusals[config->refused % NETWORK_REFUSALS], NETWORK_REFUSAL_SIZE, "%s",
             report->first_error);
    co_outbox_put_event(&self->inner, &refused);
}

/* What it replaces is freed; who is just writing that to the node is to be taken back: apply(). */
static sdo_abort_t put_domain(struct manager *self, uint16_t index,
                              const struct node_config *changed, struct change *ret_change)
{
    const struct node_config replaced = present(self, changed->node_id);
    const sdo_abort_t code = put_node(self, changed, ret_change);

    config_domain_free(index, code == SDO_OK ? &replaced : changed);
    return code;
}

static sdo_abort_t write_domain(struct manager *self, const struct co_event *event,
                                const struct slave_value *value, struct change *ret_change)
{
    struct node_config changed = present(self, event->sub);
    char file[8];
    struct co_report report = { .file = file };
    sdo_abort_t code;

    if (event->sub == self->config->manager_node_id)
        return SDO_INVALID_VALUE;
    if (self->nodes[event->sub].step == BOOT_UPDATE_SOFTWARE &&
        !config_is_configuration(event->index))
        return SDO_DEVICE_STATE; /* it is just being written */
    snprintf(file, sizeof file, "%04Xh", event->index);
    code = config_domain_set_node(event->index, self->config, &changed, value, &report);
    if (code != SDO_OK) {
        tell_refused(self, event, code, &report);
        return code;
    }
    if (network_config_node(self->config, event->sub) || !has_nothing(&changed))
        return put_domain(self, event->index, &changed, ret_change);
    config_domain_free(event->index, &changed);
    return SDO_OK;
}

static sdo_abort_t write_object(struct manager *self, const struct co_event *event,
                                const struct slave_value *value, struct change *ret_change)
{
    uint32_t number;

    if (!self->config->nmt_master)
        return SDO_LOCAL_CONTROL;
    if (config_is_domain(event->index))
        return write_domain(self, event, value, ret_change);
    number = (uint32_t)get_le(value->bytes, value->size);
    if (config_object_is_of_node(event->index))
        return write_node(self, event, number, ret_change);
    return config_object_set_network(event->index, self->config, number);
}

/* --- 1F25h --- */

/* Its boot, if it is under way, configures it anyway; a stopped one has no SDO. */
static bool may_be_configured(const struct manager *self, const struct boot_node *node)
{
    const bool has_booted = node->step == BOOT_READY || node->step == BOOT_STARTED;

    return self->state != NETWORK_RESETTING &&
           ((has_booted && node->nmt_state != NMT_STOPPED) || node->step == BOOT_FAILED ||
            node->step == BOOT_RETRY);
}

static sdo_abort_t check_request(const struct manager *self, const struct boot_node *node)
{
    if (!boot_node_is_booted_by_master(node))
        return SDO_INVALID_VALUE;
    if (ccf_count(&node->config->ccf) == 0)
        return SDO_NO_DATA;
    return may_be_configured(self, node) ? SDO_OK : SDO_DEVICE_STATE;
}

/* As far as there is one node for which it comes to something. */
static sdo_abort_t check_requests(const struct manager *self)
{
    sdo_abort_t code = SDO_NO_DATA;

    LOOK_AT_EACH_NODE(self, node)
    {
        if (check_request(self, node) == SDO_OK)
            return SDO_OK;
        if (check_request(self, node) == SDO_DEVICE_STATE)
            code = SDO_DEVICE_STATE;
    }
    return code;
}

static sdo_abort_t check_all(const struct manager *self, const struct co_event *event,
                             const struct slave_value *value)
{
    if (!self->config->nmt_master || get_le(value->bytes, value->size) != CONF)
        return SDO_LOCAL_CONTROL;
    if (event->sub == REQUEST_ALL_NODES)
        return check_requests(self);
    return check_request(self, &self->nodes[event->sub]);
}

static void configure(struct manager *self, struct boot_node *node, co_us_t now)
{
    const bool has_booted = node->step == BOOT_READY || node->step == BOOT_STARTED;

    if (has_booted || !node->config->auto_start_slave)
        boot_network_configure(self, node, now);
    else
        boot_network_renew_node(self, node, boot_node_reset_command(node), now);
}

static void configure_requested(struct manager *self, uint8_t sub, co_us_t now)
{
    FOR_EACH_NODE(self, node) {
        if ((sub == REQUEST_ALL_NODES || sub == node->config->node_id) &&
            check_request(self, node) == SDO_OK)
            configure(self, node, now);
    }
}

/* --- answers --- */

/* What cannot be answered is not done: the client hears of it when its time is over. */
static bool can_be_answered(const struct manager *self, const struct co_event *event,
                            struct slave_transfer transfer)
{
    const bool all = event->index == REQUEST_CONFIGURE && event->sub == REQUEST_ALL_NODES;
    const unsigned nodes = all ? (unsigned)self->config->node_count : 1u;

    return slave_waits_for(&self->device, transfer) &&
           co_outbox_room(&self->inner, nodes * ROOM_FRAMES, nodes * ROOM_EVENTS);
}

static void on_request(struct manager *self, const struct co_event *event,
                       const struct slave_value *value, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    const sdo_abort_t code = check_all(self, event, value);

    slave_verdict(&self->device, transfer, code, now, &self->inner);
    if (code == SDO_OK)
        configure_requested(self, event->sub, now);
}

static void on_value(struct manager *self, const struct co_event *event,
                     const struct slave_value *value, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    struct change change = { .node = NULL };
    const sdo_abort_t code = write_object(self, event, value, &change);

    slave_verdict(&self->device, transfer, code, now, &self->inner);
    if (code == SDO_OK)
        apply(self, &change, now);
}

void config_write_on_verdict(struct manager *self, const struct co_event *event, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    struct slave_value value = { .size = (uint32_t)event->actual };

    if (!can_be_answered(self, event, transfer))
        return;
    value.bytes = slave_received(&self->device, transfer);
    if (event->index == REQUEST_CONFIGURE)
        on_request(self, event, &value, now);
    else
        on_value(self, event, &value, now);
}

void config_write_on_fetch(struct manager *self, const struct co_event *event, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    const struct slave_value value = config_domain_of_node(
        event->index, network_config_node(self->config, event->sub));

    slave_give(&self->device, transfer, &value, now, &self->inner);
}

/* A reset of the manager brings back what was written: 1005h, 1006h and 1017h stay. */
void config_write_on_written(struct manager *self, const struct co_event *event)
{
    struct od_entry *entry = od_find(&self->od, event->index, event->sub);

    memcpy(entry->initial, entry->value, entry->size);
}

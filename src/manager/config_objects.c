#include "manager/config_objects.h"

#include <string.h>

/* Bits of 1F80h. */
#define STARTUP_MASTER     0x01u
#define STARTUP_START_ALL  0x02u
#define STARTUP_ORDERED    0x04u /* the manager goes operational by an order only */
#define STARTUP_START_NONE 0x08u
#define STARTUP_RESET_ALL  0x10u
#define STARTUP_STOP_ALL   0x40u
#define STARTUP_BITS       0x5Fu

/* Bits of 1F81h. */
#define SLAVE_LISTED    0x01u
#define SLAVE_RESERVED  0x02u
#define SLAVE_BOOTED    0x04u
#define SLAVE_MANDATORY 0x08u
#define SLAVE_KEPT      0x10u
#define SLAVE_VERIFIED  0x20u
#define SLAVE_UPDATED   0x40u
#define SLAVE_RESTORED  0x80u

#define RESTORE_SUB_MAX 0x7Fu /* of 1011h */

/* --- 1F80h, 1F89h --- */

static uint32_t startup(const struct network_config *config)
{
    return (config->nmt_master ? STARTUP_MASTER : 0) | (config->start_all ? STARTUP_START_ALL : 0) |
           (config->auto_operational ? 0 : STARTUP_ORDERED) |
           (config->auto_start ? 0 : STARTUP_START_NONE) |
           (config->action_on_error == ACTION_RESET_ALL ? STARTUP_RESET_ALL : 0) |
           (config->action_on_error == ACTION_STOP_ALL ? STARTUP_STOP_ALL : 0);
}

/* Who is the master is not decided over the network: it would be left without one. */
static sdo_abort_t set_startup(struct network_config *config, uint32_t value)
{
    const uint32_t action = value & (STARTUP_RESET_ALL | STARTUP_STOP_ALL);

    if ((value & ~STARTUP_BITS) != 0 || action == (STARTUP_RESET_ALL | STARTUP_STOP_ALL) ||
        ((value & STARTUP_MASTER) != 0) != config->nmt_master)
        return SDO_INVALID_VALUE;
    config->start_all = (value & STARTUP_START_ALL) != 0;
    config->auto_operational = (value & STARTUP_ORDERED) == 0;
    config->auto_start = (value & STARTUP_START_NONE) == 0;
    config->action_on_error = action == STARTUP_RESET_ALL  ? ACTION_RESET_ALL
                              : action == STARTUP_STOP_ALL ? ACTION_STOP_ALL
                                                           : ACTION_RESET_SLAVE;
    return SDO_OK;
}

sdo_abort_t config_object_set_network(uint16_t index, struct network_config *config, uint32_t value)
{
    if (index == CONFIG_STARTUP)
        return set_startup(config, value);
    config->boot_time = value;
    return SDO_OK;
}

static uint32_t of_network(uint16_t index, const struct network_config *config)
{
    return index == CONFIG_STARTUP ? startup(config) : config->boot_time;
}

/* --- 1016h --- */

static uint32_t consumer_heartbeat(const struct node_config *node)
{
    if (node->consumer_heartbeat_time == 0)
        return 0;
    return (uint32_t)node->node_id << 16 | node->consumer_heartbeat_time;
}

/* The sub-index is the node's, so no other one has a place there. */
static sdo_abort_t set_consumer_heartbeat(struct node_config *node, uint32_t value)
{
    const uint32_t node_id = value >> 16;
    const uint16_t time = (uint16_t)(value & 0xFFFFu);

    if (node_id != node->node_id && (node_id != 0 || time != 0))
        return SDO_INVALID_VALUE;
    node->consumer_heartbeat_time = time;
    return SDO_OK;
}

/* --- 1F81h --- */

static uint32_t slave_assignment(const struct node_config *node)
{
    return (node->nmt_slave ? SLAVE_LISTED : 0) | (node->auto_start_slave ? SLAVE_BOOTED : 0) |
           (node->mandatory ? SLAVE_MANDATORY : 0) | (node->check_node_state ? SLAVE_KEPT : 0) |
           (node->verify_software ? SLAVE_VERIFIED : 0) |
           (node->allow_software_update ? SLAVE_UPDATED : 0) |
           (node->restore ? SLAVE_RESTORED : 0) | (uint32_t)node->life_time_factor << 8 |
           (uint32_t)node->guard_time << 16;
}

static sdo_abort_t set_slave_assignment(struct node_config *node, uint32_t value)
{
    if ((value & SLAVE_RESERVED) != 0)
        return SDO_INVALID_VALUE;
    node->nmt_slave = (value & SLAVE_LISTED) != 0;
    node->auto_start_slave = (value & SLAVE_BOOTED) != 0;
    node->mandatory = (value & SLAVE_MANDATORY) != 0;
    node->check_node_state = (value & SLAVE_KEPT) != 0;
    node->verify_software = (value & SLAVE_VERIFIED) != 0;
    node->allow_software_update = (value & SLAVE_UPDATED) != 0;
    node->restore = (value & SLAVE_RESTORED) != 0;
    node->life_time_factor = (uint8_t)(value >> 8 & 0xFFu);
    node->guard_time = (uint16_t)(value >> 16);
    return SDO_OK;
}

/* --- 1F8Ah --- */

static uint32_t restore_sub(const struct node_config *node)
{
    return node->restore_sub;
}

static sdo_abort_t set_restore_sub(struct node_config *node, uint32_t value)
{
    if (value > RESTORE_SUB_MAX)
        return SDO_INVALID_VALUE;
    node->restore_sub = (uint8_t)value;
    return SDO_OK;
}

/* --- 1F21h --- */

/* The format of 1F20h: text as it is, and no other. */
static uint32_t storage_format(const struct node_config *node)
{
    (void)node;
    return 0;
}

static sdo_abort_t set_storage_format(struct node_config *node, uint32_t value)
{
    (void)node;
    return value == 0 ? SDO_OK : SDO_INVALID_VALUE;
}

/* --- the table --- */

#define MEMBER(name) offsetof(struct node_config, name)

/* Each is a member of the node's configuration, or made of several. */
static const struct node_object {
    uint16_t index;
    uint8_t type;
    size_t member; /* a uint32_t; 0: none */
    uint32_t (*get)(const struct node_config *node);
    sdo_abort_t (*set)(struct node_config *node, uint32_t value);
} node_objects[] = {
    { 0x1016, OD_UNSIGNED32, 0, consumer_heartbeat, set_consumer_heartbeat },
    { 0x1F21, OD_UNSIGNED8, 0, storage_format, set_storage_format },
    { 0x1F26, OD_UNSIGNED32, MEMBER(configuration_date), NULL, NULL },
    { 0x1F27, OD_UNSIGNED32, MEMBER(configuration_time), NULL, NULL },
    { 0x1F55, OD_UNSIGNED32, MEMBER(software_identification), NULL, NULL },
    { 0x1F81, OD_UNSIGNED32, 0, slave_assignment, set_slave_assignment },
    { 0x1F84, OD_UNSIGNED32, MEMBER(device_type), NULL, NULL },
    { 0x1F85, OD_UNSIGNED32, MEMBER(vendor_id), NULL, NULL },
    { 0x1F86, OD_UNSIGNED32, MEMBER(product_code), NULL, NULL },
    { 0x1F87, OD_UNSIGNED32, MEMBER(revision_number), NULL, NULL },
    { 0x1F88, OD_UNSIGNED32, MEMBER(serial_number), NULL, NULL },
    { 0x1F8A, OD_UNSIGNED8, 0, restore_sub, set_restore_sub },
};

static const struct node_object *find_object(uint16_t index)
{
    for (size_t i = 0; i < sizeof node_objects / sizeof node_objects[0]; i++)
        if (node_objects[i].index == index)
            return &node_objects[i];
    return NULL;
}

static uint32_t value_of(const struct node_object *object, const struct node_config *node)
{
    uint32_t value;

    if (object->get)
        return object->get(node);
    memcpy(&value, (const char *)node + object->member, sizeof value);
    return value;
}

bool config_object_is_of_node(uint16_t index)
{
    return find_object(index) != NULL;
}

uint32_t config_object_of_node(uint16_t index, const struct node_config *node)
{
    return value_of(find_object(index), node);
}

sdo_abort_t config_object_set_node(uint16_t index, struct node_config *node, uint32_t value)
{
    const struct node_object *object = find_object(index);

    if (object->set)
        return object->set(node, value);
    memcpy((char *)node + object->member, &value, sizeof value);
    return SDO_OK;
}

/* --- the dictionary --- */

static enum co_err add_watched(struct od *od, uint16_t index, uint8_t sub, uint8_t type)
{
    const struct od_spec spec = { .index = index, .sub = sub, .type = type, .access = OD_RW };
    struct od_entry *entry;
    enum co_err err = od_add(od, &spec, &entry);

    if (err == CO_OK)
        entry->watched = true;
    return err;
}

static enum co_err add_node_object(const struct node_object *object, struct od *od)
{
    enum co_err err = od_add_number(od, object->index, 0, OD_UNSIGNED8, OD_CONST, NETWORK_NODE_MAX);

    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = add_watched(od, object->index, id, object->type);
    return err;
}

/* What a reset of the device brings back is the same: it does not change the configuration. */
static void show(struct od *od, uint16_t index, uint8_t sub, uint32_t value)
{
    const struct od_entry *entry = od_find(od, index, sub);

    od_set_number(od, index, sub, value);
    memcpy(entry->initial, entry->value, entry->size);
}

void config_objects_refresh(const struct network_config *config, struct od *od, uint16_t index,
                            uint8_t sub)
{
    const struct node_object *object = find_object(index);
    const struct node_config *node = network_config_node(config, sub);

    if ((index == CONFIG_STARTUP || index == CONFIG_BOOT_TIME) && sub == 0)
        show(od, index, 0, of_network(index, config));
    else if (object && sub >= 1 && sub <= NETWORK_NODE_MAX)
        show(od, index, sub, node ? value_of(object, node) : 0);
}

static void refresh_all(const struct network_config *config, struct od *od)
{
    for (size_t i = 0; i < od->count; i++)
        config_objects_refresh(config, od, od->entries[i]->index, od->entries[i]->sub);
}

enum co_err config_objects_fill(const struct network_config *config, struct od *od)
{
    enum co_err err = add_watched(od, CONFIG_STARTUP, 0, OD_UNSIGNED32);

    if (err == CO_OK)
        err = add_watched(od, CONFIG_BOOT_TIME, 0, OD_UNSIGNED32);
    for (size_t i = 0; i < sizeof node_objects / sizeof node_objects[0] && err == CO_OK; i++)
        err = add_node_object(&node_objects[i], od);
    if (err == CO_OK)
        refresh_all(config, od);
    return err;
}

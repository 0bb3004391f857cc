#include "manager/manager_od.h"

/* Major version in the high word, minor version in the low one. */
#define REVISION ((uint32_t)MCANOPEN_VERSION_MAJOR << 16 | MCANOPEN_VERSION_MINOR)

#define EMCY_COB_ID   0x80u
#define EMCY_NOT_USED 0x80000000u /* bit of 1028h */
#define SYNC_PRODUCER 0x40000000u /* bit of 1005h */

static uint32_t nmt_startup(const struct network_config *config)
{
    return (uint32_t)config->nmt_master | (uint32_t)config->start_all << 1 |
           (uint32_t)!config->auto_operational << 2 | (uint32_t)!config->auto_start << 3 |
           (uint32_t)(config->action_on_error == ACTION_RESET_ALL) << 4 |
           (uint32_t)(config->action_on_error == ACTION_STOP_ALL) << 6;
}

static uint32_t consumer_heartbeat(const struct node_config *node)
{
    if (node->consumer_heartbeat_time == 0)
        return 0;
    return (uint32_t)node->node_id << 16 | node->consumer_heartbeat_time;
}

static uint32_t slave_assignment(const struct node_config *node)
{
    return (uint32_t)node->nmt_slave | (uint32_t)node->auto_start_slave << 2 |
           (uint32_t)node->mandatory << 3 | (uint32_t)node->check_node_state << 4 |
           (uint32_t)node->verify_software << 5 | (uint32_t)node->allow_software_update << 6 |
           (uint32_t)node->life_time_factor << 8 | (uint32_t)node->guard_time << 16;
}

static uint32_t configuration_date(const struct node_config *node)
{
    return node->configuration_date;
}

static uint32_t configuration_time(const struct node_config *node)
{
    return node->configuration_time;
}

static uint32_t software_identification(const struct node_config *node)
{
    return node->software_identification;
}

static uint32_t device_type(const struct node_config *node)
{
    return node->device_type;
}

static uint32_t vendor_id(const struct node_config *node)
{
    return node->vendor_id;
}

static uint32_t product_code(const struct node_config *node)
{
    return node->product_code;
}

static uint32_t revision_number(const struct node_config *node)
{
    return node->revision_number;
}

static uint32_t serial_number(const struct node_config *node)
{
    return node->serial_number;
}

/* Objects with a value for each node, at the node-ID as sub-index. */
static const struct node_object {
    uint16_t index;
    bool only_if_given; /* not there when it is 0 for all nodes */
    uint32_t (*value)(const struct node_config *node);
} node_objects[] = {
    { 0x1016, false, consumer_heartbeat }, { 0x1F26, true, configuration_date },
    { 0x1F27, true, configuration_time },  { 0x1F55, true, software_identification },
    { 0x1F81, false, slave_assignment },   { 0x1F84, false, device_type },
    { 0x1F85, false, vendor_id },          { 0x1F86, false, product_code },
    { 0x1F87, false, revision_number },    { 0x1F88, false, serial_number },
};

static bool is_given(const struct node_object *object, const struct network_config *config)
{
    for (size_t i = 0; i < config->node_count; i++)
        if (object->value(&config->nodes[i]) != 0)
            return true;
    return !object->only_if_given;
}

static enum co_err add_node_object(const struct node_object *object,
                                   const struct network_config *config, struct od *od)
{
    enum co_err err;

    if (!is_given(object, config))
        return CO_OK;
    err = od_add_number(od, object->index, 0, OD_UNSIGNED8, OD_CONST, NETWORK_NODE_MAX);
    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++) {
        const struct node_config *node = network_config_node(config, id);

        err = od_add_number(od, object->index, id, OD_UNSIGNED32, OD_RO,
                            node ? object->value(node) : 0);
    }
    return err;
}

/* Who is heard is who is configured, or everybody. */
static uint32_t heard_emergency(const struct network_config *config, uint8_t node)
{
    const bool is_heard = config->preset_emergency_consumer || network_config_node(config, node);

    return is_heard ? EMCY_COB_ID + node : EMCY_NOT_USED;
}

static enum co_err add_emergency_consumers(const struct network_config *config, struct od *od)
{
    enum co_err err = od_add_number(od, 0x1028, 0, OD_UNSIGNED8, OD_CONST, NETWORK_NODE_MAX);

    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = od_add_number(od, 0x1028, id, OD_UNSIGNED32, OD_RO, heard_emergency(config, id));
    return err;
}

static enum co_err add_nmt_request(struct od *od, uint8_t sub, uint8_t access)
{
    const struct od_spec spec = {
        .index = REQUEST_NMT, .sub = sub, .type = OD_UNSIGNED8, .access = access
    };
    struct od_entry *entry;
    enum co_err err = od_add(od, &spec, &entry);

    if (err == CO_OK)
        entry->watched = true;
    return err;
}

static enum co_err add_requests(struct od *od)
{
    enum co_err err = od_add_number(od, REQUEST_NMT, 0, OD_UNSIGNED8, OD_CONST, REQUEST_ALL_NODES);

    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = add_nmt_request(od, id, OD_RW);
    if (err == CO_OK)
        err = add_nmt_request(od, REQUEST_ALL_NODES, OD_WO);
    if (err == CO_OK)
        err = od_add_number(od, REQUEST_GUARDING, 0, OD_UNSIGNED8, OD_CONST, NETWORK_NODE_MAX);
    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = od_add_number(od, REQUEST_GUARDING, id, OD_UNSIGNED8, OD_RO, 0);
    return err;
}

/* A SYNC producer's, where one is asked for; the object without a period sends none. */
static enum co_err add_sync(const struct network_config *config, struct od *od)
{
    uint32_t cob_id = config->sync_cob_id;
    enum co_err err;

    if (!config->has_sync_interval)
        return CO_OK;
    if (config->sync_interval != 0)
        cob_id |= SYNC_PRODUCER;
    err = od_add_number(od, 0x1005, 0, OD_UNSIGNED32, OD_RW, cob_id);
    if (err == CO_OK)
        err = od_add_number(od, 0x1006, 0, OD_UNSIGNED32, OD_RW, config->sync_interval);
    return err;
}

enum co_err manager_od_fill(const struct network_config *config, struct od *od)
{
    const struct {
        uint16_t index;
        uint8_t sub, type, access;
        uint32_t value;
    } numbers[] = {
        { 0x1000, 0, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1001, 0, OD_UNSIGNED8, OD_RO, 0 },
        { 0x1014, 0, OD_UNSIGNED32, OD_RO, EMCY_COB_ID + config->manager_node_id },
        { 0x1017, 0, OD_UNSIGNED16, OD_RO, config->heartbeat_producer_time },
        { 0x1018, 0, OD_UNSIGNED8, OD_CONST, 4 },
        { 0x1018, 1, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1018, 2, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1018, 3, OD_UNSIGNED32, OD_CONST, REVISION },
        { 0x1018, 4, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1F80, 0, OD_UNSIGNED32, OD_RO, nmt_startup(config) },
        { 0x1F89, 0, OD_UNSIGNED32, OD_RO, config->boot_time },
    };
    enum co_err err = CO_OK;

    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && err == CO_OK; i++)
        err = od_add_number(od, numbers[i].index, numbers[i].sub, numbers[i].type,
                            numbers[i].access, numbers[i].value);
    for (size_t i = 0; i < sizeof node_objects / sizeof *node_objects && err == CO_OK; i++)
        err = add_node_object(&node_objects[i], config, od);
    if (err == CO_OK)
        err = add_emergency_consumers(config, od);
    if (err == CO_OK)
        err = add_requests(od);
    if (err == CO_OK)
        err = add_sync(config, od);
    return err;
}

#include "manager/manager_od.h"

#include "manager/config_domains.h"
#include "manager/config_objects.h"

/* Major version in the high word, minor version in the low one. */
#define REVISION ((uint32_t)MCANOPEN_VERSION_MAJOR << 16 | MCANOPEN_VERSION_MINOR)

#define EMCY_COB_ID   0x80u
#define EMCY_NOT_USED 0x80000000u /* bit of 1028h */
#define SYNC_PRODUCER 0x40000000u /* bit of 1005h */

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

static enum co_err add_request(struct od *od, uint16_t index, uint8_t sub, uint8_t access)
{
    const uint8_t type = index == REQUEST_NMT ? OD_UNSIGNED8 : OD_UNSIGNED32;
    const struct od_spec spec = { .index = index, .sub = sub, .type = type, .access = access };
    struct od_entry *entry;
    enum co_err err = od_add(od, &spec, &entry);

    if (err == CO_OK)
        entry->watched = true;
    return err;
}

/* A request to each node, and one to all of them. */
static enum co_err add_request_object(struct od *od, uint16_t index, uint8_t access)
{
    enum co_err err = od_add_number(od, index, 0, OD_UNSIGNED8, OD_CONST, REQUEST_ALL_NODES);

    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = add_request(od, index, id, access);
    return err == CO_OK ? add_request(od, index, REQUEST_ALL_NODES, OD_WO) : err;
}

static enum co_err add_requests(struct od *od)
{
    enum co_err err = add_request_object(od, REQUEST_CONFIGURE, OD_WO);

    if (err == CO_OK)
        err = add_request_object(od, REQUEST_NMT, OD_RW);
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
        { 0x1017, 0, OD_UNSIGNED16, OD_RW, config->heartbeat_producer_time },
        { 0x1018, 0, OD_UNSIGNED8, OD_CONST, 4 },
        { 0x1018, 1, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1018, 2, OD_UNSIGNED32, OD_CONST, 0 },
        { 0x1018, 3, OD_UNSIGNED32, OD_CONST, REVISION },
        { 0x1018, 4, OD_UNSIGNED32, OD_CONST, 0 },
    };
    enum co_err err = CO_OK;

    for (size_t i = 0; i < sizeof numbers / sizeof *numbers && err == CO_OK; i++)
        err = od_add_number(od, numbers[i].index, numbers[i].sub, numbers[i].type,
                            numbers[i].access, numbers[i].value);
    if (err == CO_OK)
        err = config_objects_fill(config, od);
    if (err == CO_OK)
        err = config_domains_fill(od);
    if (err == CO_OK)
        err = add_emergency_consumers(config, od);
    if (err == CO_OK)
        err = add_requests(od);
    if (err == CO_OK)
        err = add_sync(config, od);
    return err;
}

void manager_od_refresh(const struct network_config *config, struct od *od, uint16_t index,
                        uint8_t sub)
{
    if (index == 0x1028 && sub >= 1 && sub <= NETWORK_NODE_MAX)
        od_set_number(od, index, sub, heard_emergency(config, sub));
    else
        config_objects_refresh(config, od, index, sub);
}

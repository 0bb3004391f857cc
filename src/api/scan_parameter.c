/* Versions and parameters: canOpenGetVersions, canOpenSetParameter, canOpenGetParameter. */
#include "api/scan.h"

#include <string.h>

#define NS_PER_SECOND UINT64_C(1000000000)
#define NS_PER_US     UINT64_C(1000)

void canOpenGetVersions(CANOPEN_VERSIONS *versions)
{
    const unsigned short version = (unsigned short)(MCANOPEN_VERSION_MAJOR << 12 |
                                                    MCANOPEN_VERSION_MINOR << 8 |
                                                    MCANOPEN_VERSION_PATCH);

    if (versions)
        *versions = (CANOPEN_VERSIONS){ version, version, version, version,
                                        version, version, version, version };
}

static int set_parameter(struct scan_node *node, uint32_t command, const void *argument)
{
    const bool hold = command == PARAM_DISABLE_AUTO_TRANSMISSION;
    struct co_outbox *out;
    co_us_t now;

    if ((!hold && command != PARAM_ENABLE_AUTO_TRANSMISSION) || argument)
        return SCANOPEN_WRONG_PARAMETER;
    out = scan_lock(node, &now);
    node->held = hold;
    if (node->active)
        slave_hold_transmission(&node->slave, hold, now, out);
    scan_unlock(node);
    return SCANOPEN_OK;
}

int canOpenSetParameter(HNODE hNode, uint32_t uiCommand, void *pArg)
{
    struct scan_node *node;
    int result = scan_enter(hNode, &node);

    if (result != SCANOPEN_OK)
        return result;
    result = set_parameter(node, uiCommand, pArg);
    scan_leave(node);
    return result;
}

static int get_parameter(struct scan_node *node, uint32_t command, void *argument)
{
    uint64_t value = NS_PER_SECOND;
    co_us_t now;

    if (!argument)
        return SCANOPEN_WRONG_PARAMETER;
    if (command == PARA_GET_TIMESTAMP) {
        scan_lock(node, &now);
        scan_unlock(node);
        value = now * NS_PER_US;
    } else if (command != PARA_GET_TIMESTAMP_FREQUENCY) {
        return SCANOPEN_WRONG_PARAMETER;
    }
    memcpy(argument, &value, sizeof value);
    return SCANOPEN_OK;
}

int canOpenGetParameter(HNODE hNode, uint32_t uiCommand, void *pArg)
{
    struct scan_node *node;
    int result = scan_enter(hNode, &node);

    if (result != SCANOPEN_OK)
        return result;
    result = get_parameter(node, uiCommand, pArg);
    scan_leave(node);
    return result;
}

#include "device.h"

#include <stdio.h>
#include <stdlib.h>

#define IS_WARNING(result) ((result) == SCANOPEN_INHIBITED)

int device_need(const char *what, int result)
{
    if (result < 0 && !IS_WARNING(result)) {
        fprintf(stderr, "%s: error %d\n", what, result);
        exit(1);
    }
    return result;
}

void device_open_network(void)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 1000 };

    device_need("canOpenCreateNetworkEx", canOpenCreateNetworkEx(0, &network));
}

HNODE device_create_node(int node_id, const SLAVE_NODE_INFO *info)
{
    HNODE node = NULL;

    device_need("canOpenCreateNodeEx", canOpenCreateNodeEx(0, node_id, NULL, info, &node));
    return node;
}

static void add_value(HNODE node, unsigned short index, const char *type, int flags,
                      DictionaryData *value, PFN_COS_DATA_HANDLER handler)
{
    device_need("canOpenExtendDictionary", canOpenExtendDictionary(node, index, 0, OBJ_VAR, type));
    device_need("canOpenInitDictionary",
                canOpenInitDictionary(node, index, 0, NULL,
                                      (unsigned short)(READ_ACCESS | WRITE_ACCESS | flags), value,
                                      handler));
}

static void add_object(HNODE node, unsigned short index, const char *type,
                       PFN_COS_DATA_HANDLER handler)
{
    DictionaryData zero = { .uint64 = { 0, 0, 0, 0 } };

    add_value(node, index, type, MAPPABLE, &zero, handler);
}

void device_add_number(HNODE node, unsigned short index)
{
    add_object(node, index, MAP_UINT32, NULL);
}

void device_add_domain(HNODE node, unsigned short index, uint8_t *memory, unsigned long size)
{
    DictionaryData value = { .domain = { memory, size, size } };

    add_value(node, index, MAP_DOMAIN, 0, &value, NULL);
}

static HPDO add_pdo(HNODE node, int mode, unsigned short index)
{
    const unsigned short mapping[] = { index, 0, 0, 0 };
    HPDO pdo = NULL;

    device_need("canOpenDefinePDO", canOpenDefinePDO(node, NULL, DEFAULT_PDO1, (uint16_t)mode, 0, 0,
                                                     0, 0, mapping, &pdo));
    return pdo;
}

void device_create(struct device *self)
{
    self->info.ulOptions |= AUTO_START;
    self->info.ulDeviceType = 0x00020192;
    self->info.ucMaxIdentityObject = 4;
    self->info.ulVendorId = 0x17F;
    self->info.usRxPDO = 4;
    self->info.usTxPDO = 4;
    self->info.usPdoRxQueueSize = 4096; /* one processor: the handlers wait while frames come */
    device_open_network();
    self->node = device_create_node(DEVICE_NODE, &self->info);
    device_add_number(self->node, DEVICE_NUMBER);
    add_object(self->node, DEVICE_OUTPUT, MAP_UINT64, self->told);
    add_object(self->node, DEVICE_INPUT, MAP_UINT64, NULL);
    if (self->told)
        add_pdo(self->node, RECEIVE_PDO | AUTO_NOTIFY_PDO | 255, DEVICE_OUTPUT);
    if (self->transmission >= 0)
        self->sent = add_pdo(self->node, TRANSMIT_PDO | self->transmission, DEVICE_INPUT);
}

void device_run(const struct device *self)
{
    device_need("canOpenActivateNode", canOpenActivateNode(self->node));
    device_need("canOpenWaitForNodeState", canOpenWaitForNodeState(self->node, WFNS_OPERATIONAL));
    puts("ready");
    fflush(stdout);
}

void device_remove(const struct device *self)
{
    device_need("canOpenResetNode", canOpenResetNode(self->node));
    device_need("canOpenDeleteNode", canOpenDeleteNode(self->node));
    device_need("canOpenRemoveNetwork", canOpenRemoveNetwork(0));
}

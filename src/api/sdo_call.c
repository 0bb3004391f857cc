#include "api/sdo_call.h"

#define READ_TIMEOUT  CO_MS(200) /* for nodes that are not in the configuration */
#define WRITE_TIMEOUT CO_MS(2000)

struct sdo_call sdo_call_read(int net, int node, int index, int subindex)
{
    const bool block = subindex >= 0 && (subindex & TYP_BLOCK) != 0;

    return (struct sdo_call){ net, node, index, block ? subindex & ~TYP_BLOCK : subindex, block };
}

int sdo_call_check(const struct sdo_call *call)
{
    if (call->node < 1 || call->node > (int)NMT_NODE_MAX || call->index < 0 ||
        call->index > UINT16_MAX || call->sub < 0 || call->sub > UINT8_MAX)
        return MCAL_PARA_ERROR;
    return MCANOPEN_OK;
}

/* Bytes of a type with a size of its own, 0 for the others, -1: no type. */
static int size_of_type(int type)
{
    switch (type) {
    case TYP_CHAR: return 1;
    case TYP_DATE: return 6;
    case TYP_VIS_STRING:
    case TYP_OCT_STRING:
    case TYP_UNICODE_STRING:
    case TYP_DOMAIN: return 0;
    default: return od_type_known((uint8_t)type) ? (int)od_type_size((uint8_t)type) : -1;
    }
}

int sdo_call_check_type(int type, const void *buffer, int *len)
{
    const int flags = TYP_INDICATE_SIZE | TYP_INDICATE_NO_SIZE | TYP_BLOCK;
    int size = size_of_type(type & 0x7F);

    if (type < 0 || (type & ~(flags | 0x7F)) || size < 0 || !buffer || *len < 0)
        return MCAL_PARA_ERROR;
    if ((type & TYP_INDICATE_SIZE) && (type & TYP_INDICATE_NO_SIZE))
        return MCAL_PARA_ERROR;
    if (*len == 0)
        *len = size;
    return *len > 0 ? MCANOPEN_OK : MCAL_PARA_ERROR;
}

static uint8_t block_size(const struct node_config *config)
{
    return config && config->sdo_block_size > 0 ? config->sdo_block_size : SDO_BLOCK_MAX;
}

void sdo_call_fill(const struct managed *managed, const struct sdo_call *call,
                   struct sdo_transfer *transfer)
{
    const struct node_config *config = network_config_node(managed->config, (uint8_t)call->node);

    transfer->index = (uint16_t)call->index;
    transfer->sub = (uint8_t)call->sub;
    if (call->block)
        transfer->block = block_size(config);
    if (config)
        transfer->timeout = CO_MS(config->sdo_timeout);
    else
        transfer->timeout = transfer->download ? WRITE_TIMEOUT : READ_TIMEOUT;
}

void sdo_call_fill_write(int type, const void *data, int len, struct sdo_transfer *transfer)
{
    transfer->download = true;
    transfer->source = data;
    transfer->size = (uint32_t)len;
    transfer->indicate_size = (type & TYP_INDICATE_SIZE) != 0;
    transfer->hide_size = (type & TYP_INDICATE_NO_SIZE) != 0;
}

#include "mcanopen.h"

#include "api/callback.h"
#include "api/error_map.h"
#include "api/registry.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define READ_TIMEOUT  CO_MS(200) /* for nodes that are not in the configuration */
#define WRITE_TIMEOUT CO_MS(2000)

struct call { /* what both directions have in common */
    int net, node, index, sub;
    bool block;
    ERROR_T *error;
};

static int check(const struct call *call)
{
    if (callback_running())
        return MCAL_UNSUPPORTED;
    if (call->node < 1 || call->node > (int)NMT_NODE_MAX || call->index < 0 ||
        call->index > UINT16_MAX || call->sub < 0 || call->sub > UINT8_MAX)
        return MCAL_PARA_ERROR;
    return MCANOPEN_OK;
}

/* Under the network's lock, as block_size(): other tools may change the configuration. */
static co_us_t timeout_of(const struct managed *managed, int node, co_us_t otherwise)
{
    const struct node_config *config = network_config_node(managed->config, (uint8_t)node);

    return config ? CO_MS(config->sdo_timeout) : otherwise;
}

static uint8_t block_size(const struct managed *managed, int node)
{
    const struct node_config *config = network_config_node(managed->config, (uint8_t)node);

    return config && config->sdo_block_size > 0 ? config->sdo_block_size : SDO_BLOCK_MAX;
}

/* Under the network's lock. */
static int wait_for_end(struct managed *managed, struct sdo_request *request)
{
    enum co_err err = CO_OK;

    while (request->state != REQUEST_DONE) {
        if (err == CO_ERR_STATE)
            return MCAL_NO_NET;
        err = network_wait(managed->network, managed->config->manager_node_id, CO_NEVER);
    }
    return error_of_sdo(&request->result, network_bus_state(managed->network));
}

/* Waits in the queue of the node's channel and for its end; no time-out but the protocol's own. */
static int transfer(struct managed *managed, const struct call *call, struct sdo_request *request,
                    co_us_t timeout)
{
    uint8_t node = (uint8_t)call->node;
    struct co_outbox *out;
    co_us_t now;
    int result;

    out = network_enter_recent(managed->network, &now);
    if (call->block)
        request->transfer.block = block_size(managed, call->node);
    request->transfer.timeout = timeout_of(managed, call->node, timeout);
    manager_submit(managed->manager, node, request, now, out);
    result = wait_for_end(managed, request);
    if (request->state != REQUEST_DONE) { /* time has passed: anew, for it to be right */
        network_leave(managed->network, managed->config->manager_node_id);
        out = network_enter(managed->network, &now);
        manager_cancel(managed->manager, node, request, now, out);
    }
    network_leave(managed->network, managed->config->manager_node_id);
    if (result == MCAL_ABORT_DOMAIN)
        error_set(call->error, request->result.code);
    return result;
}

static int run(const struct call *call, struct sdo_request *request, co_us_t timeout)
{
    struct managed *managed;
    int result = registry_enter(call->net, true, &managed);

    if (result != MCANOPEN_OK)
        return result;
    request->transfer.index = (uint16_t)call->index;
    request->transfer.sub = (uint8_t)call->sub;
    result = transfer(managed, call, request, timeout);
    registry_leave();
    return result;
}

/* The data goes to a buffer of its own first: the caller's is untouched unless all went well. */
static int read_into(const struct call *call, uint8_t *own, void *buffer, int *len)
{
    struct sdo_request request = { .transfer = { .buffer = own, .size = (uint32_t)*len } };
    int result = run(call, &request, READ_TIMEOUT);

    if (result == MCANOPEN_OK) {
        memcpy(buffer, own, (size_t)request.result.actual);
        *len = (int)request.result.actual;
    } else if (result == MCAL_BUFFER_OVERFLOW && request.result.actual > 0 &&
               request.result.actual <= INT_MAX) {
        *len = (int)request.result.actual;
    }
    return result;
}

int mcanOpenReadSDO(unsigned short net, unsigned short modID, int index, int subindex, void *buffer,
                    int *len, ERROR_T *error)
{
    const bool block = subindex >= 0 && (subindex & TYP_BLOCK) != 0;
    const struct call call = { net,   modID, index, block ? subindex & ~TYP_BLOCK : subindex,
                               block, error };
    int result = check(&call);
    uint8_t *own;

    error_set(error, SDO_OK);
    if (result == MCANOPEN_OK && (!buffer || !len || *len < 0))
        result = MCAL_PARA_ERROR;
    if (result != MCANOPEN_OK)
        return result;
    own = malloc(*len > 0 ? (size_t)*len : 1);
    if (!own)
        return MCAL_OBJ_NO_MEMORY;
    result = read_into(&call, own, buffer, len);
    free(own);
    return result;
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

static int check_type(int type, const void *buffer, int *len)
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

int mcanOpenWriteSDO(unsigned short net, unsigned short modID, int index, int subindex, int type,
                     const void *buffer, int len, ERROR_T *error)
{
    const struct call call = { net, modID, index, subindex, (type & TYP_BLOCK) != 0, error };
    struct sdo_request request = { .transfer = { .download = true } };
    int result = check(&call);

    error_set(error, SDO_OK);
    if (result == MCANOPEN_OK)
        result = check_type(type, buffer, &len);
    if (result != MCANOPEN_OK)
        return result;
    request.transfer.source = buffer;
    request.transfer.size = (uint32_t)len;
    request.transfer.indicate_size = (type & TYP_INDICATE_SIZE) != 0;
    request.transfer.hide_size = (type & TYP_INDICATE_NO_SIZE) != 0;
    return run(&call, &request, WRITE_TIMEOUT);
}

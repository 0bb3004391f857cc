#include "mcanopen.h"

#include "api/callback.h"
#include "api/error_map.h"
#include "api/sdo_call.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* Under the network's lock. */
static int wait_for_end(struct managed *managed, struct sdo_request *request)
{
    enum co_err err = CO_OK;

    while (request->state != REQUEST_DONE) {
        if (err == CO_ERR_STATE)
            return MCAL_NO_NET;
        err = network_wait_as(managed->network, managed->config->manager_node_id, request->caller,
                              CO_NEVER);
    }
    return error_of_sdo(&request->result, network_bus_state(managed->network));
}

/* Waits in the queue of the node's channel and for its end; no time-out but the protocol's own. */
static int transfer(struct managed *managed, const struct sdo_call *call,
                    struct sdo_request *request, ERROR_T *error)
{
    uint8_t node = (uint8_t)call->node;
    struct co_outbox *out;
    co_us_t now;
    int result;

    out = network_enter_recent(managed->network, &now);
    sdo_call_fill(managed, call, &request->transfer);
    request->caller = network_caller(managed->network);
    manager_submit(managed->manager, node, request, now, out);
    result = wait_for_end(managed, request);
    if (request->state != REQUEST_DONE) { /* time has passed: anew, for it to be right */
        network_leave(managed->network, managed->config->manager_node_id);
        out = network_enter(managed->network, &now);
        manager_cancel(managed->manager, node, request, now, out);
    }
    network_leave(managed->network, managed->config->manager_node_id);
    if (result == MCAL_ABORT_DOMAIN)
        error_set(error, request->result.code);
    return result;
}

static int run(const struct sdo_call *call, struct sdo_request *request, ERROR_T *error)
{
    struct managed *managed;
    int result = registry_enter(call->net, true, &managed);

    if (result != MCANOPEN_OK)
        return result;
    result = transfer(managed, call, request, error);
    registry_leave();
    return result;
}

static int check(const struct sdo_call *call)
{
    return callback_running() ? MCAL_UNSUPPORTED : sdo_call_check(call);
}

/* The data goes to a buffer of its own first: the caller's is untouched unless all went well. */
static int read_into(const struct sdo_call *call, uint8_t *own, void *buffer, int *len,
                     ERROR_T *error)
{
    struct sdo_request request = { .transfer = { .buffer = own, .size = (uint32_t)*len } };
    int result = run(call, &request, error);

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
    const struct sdo_call call = sdo_call_read(net, modID, index, subindex);
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
    result = read_into(&call, own, buffer, len, error);
    free(own);
    return result;
}

int mcanOpenWriteSDO(unsigned short net, unsigned short modID, int index, int subindex, int type,
                     const void *buffer, int len, ERROR_T *error)
{
    const struct sdo_call call = { net, modID, index, subindex, (type & TYP_BLOCK) != 0 };
    struct sdo_request request = { .state = REQUEST_IDLE };
    int result = check(&call);

    error_set(error, SDO_OK);
    if (result == MCANOPEN_OK)
        result = sdo_call_check_type(type, buffer, &len);
    if (result != MCANOPEN_OK)
        return result;
    sdo_call_fill_write(type, buffer, len, &request.transfer);
    return run(&call, &request, error);
}

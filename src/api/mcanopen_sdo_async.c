#include "mcanopen.h"

#include "api/callback.h"
#include "api/control.h"
#include "api/error_map.h"
#include "api/sdo_call.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct sdo_async {
    struct sdo_async *next;
    struct sdo_request request;
    bool is_judged; /* result says how the request has ended */
    SDO_RESULT_T result;
    MCANOPEN_SDO_DONE_T done;
    void *context;
    uint8_t data[]; /* what is written, or room for what is read */
};

/* --- the list, under the network's lock --- */

static void append(struct sdo_async_list *list, struct sdo_async *async)
{
    if (list->last)
        list->last->next = async;
    else
        list->first = async;
    list->last = async;
    list->count++;
}

static void take_out(struct sdo_async_list *list, struct sdo_async *async)
{
    struct sdo_async *previous = NULL;

    for (struct sdo_async *a = list->first; a != async; a = a->next)
        previous = a;
    if (previous)
        previous->next = async->next;
    else
        list->first = async->next;
    if (list->last == async)
        list->last = previous;
    list->count--;
    async->next = NULL;
}

static struct sdo_async *find(const struct sdo_async_list *list, unsigned number)
{
    struct sdo_async *async = list->first;

    while (async && async->result.number != number)
        async = async->next;
    return async;
}

/* Never 0. */
static unsigned next_number(struct sdo_async_list *list)
{
    if (++list->last_number == 0)
        ++list->last_number;
    return list->last_number;
}

/* --- the way back --- */

/* The length of what was read; where it was too long, the room that it needs. */
static void set_data(SDO_RESULT_T *result, const struct sdo_async *async)
{
    const uint64_t length = async->request.result.actual;

    if (result->write || length > INT_MAX)
        return;
    if (result->result == MCANOPEN_OK)
        result->data = async->data;
    if (result->result == MCANOPEN_OK || result->result == MCAL_BUFFER_OVERFLOW)
        result->len = (int)length;
}

/*
 * At once, as the state of the bus is a part of it, and the daemon may come late. One that was
 * cancelled has its result already.
 */
static void judge(struct sdo_async *async, const struct managed *managed)
{
    const struct sdo_request *request = &async->request;
    SDO_RESULT_T *result = &async->result;

    if (request->state != REQUEST_DONE || async->is_judged)
        return;
    async->is_judged = true;
    result->result = error_of_sdo(&request->result, network_bus_state(managed->network));
    if (result->result == MCAL_ABORT_DOMAIN)
        error_set(&result->error, request->result.code);
    set_data(result, async);
}

/* One mark in the daemon's queue is enough: the rest of it is for lines of the log. */
bool sdo_async_note_end(struct managed *managed)
{
    for (struct sdo_async *async = managed->asyncs.first; async; async = async->next)
        judge(async, managed);
    return managed->asyncs.first && !atomic_exchange(&managed->asyncs.due, true);
}

static bool has_ended(const struct sdo_async *async)
{
    return async->request.state == REQUEST_DONE || async->request.state == REQUEST_IDLE;
}

/* The oldest one that has ended, out of the list; NULL: none. */
static struct sdo_async *take_ended(struct managed *managed)
{
    struct sdo_async *async;

    network_hold(managed->network);
    async = managed->asyncs.first;
    while (async && !has_ended(async))
        async = async->next;
    if (async) {
        take_out(&managed->asyncs, async);
        judge(async, managed);
    }
    network_release(managed->network);
    return async;
}

static void tell(struct sdo_async *async)
{
    callback_begin();
    async->done(async->context, &async->result);
    callback_end();
    free(async);
}

static void tell_ended(struct managed *managed)
{
    struct sdo_async *async;

    while ((async = take_ended(managed)) != NULL)
        tell(async);
}

void sdo_async_tell(struct managed *managed)
{
    if (atomic_exchange(&managed->asyncs.due, false))
        tell_ended(managed);
}

/* manager_shut() has taken them out of their channels: none is under way. */
void sdo_async_tell_rest(struct managed *managed)
{
    tell_ended(managed);
}

/* --- calls --- */

static struct sdo_call call_of(const SDO_REQUEST_T *request, bool write)
{
    if (write)
        return (struct sdo_call){ request->net, request->node, request->index, request->subindex,
                                  (request->type & TYP_BLOCK) != 0 };
    return sdo_call_read(request->net, request->node, request->index, request->subindex);
}

static int check(const SDO_REQUEST_T *request, bool write, struct sdo_call *ret_call, int *ret_len)
{
    int result;

    if (!request || request->size < (int)sizeof *request || !request->done || request->len < 0)
        return MCAL_PARA_ERROR;
    *ret_call = call_of(request, write);
    *ret_len = request->len;
    result = sdo_call_check(ret_call);
    if (result == MCANOPEN_OK && write)
        result = sdo_call_check_type(request->type, request->data, ret_len);
    return result;
}

static struct sdo_async *make(const SDO_REQUEST_T *request, bool write, int len)
{
    struct sdo_async *async = calloc(1, sizeof *async + (size_t)len);

    if (!async)
        return NULL;
    async->done = request->done;
    async->context = request->context;
    async->result = (SDO_RESULT_T){ .net = request->net,
                                    .node = request->node,
                                    .index = request->index,
                                    .subindex = request->subindex & ~TYP_BLOCK,
                                    .write = write,
                                    .result = MCAL_NO_NET }; /* where nothing else comes of it */
    if (write) {
        memcpy(async->data, request->data, (size_t)len);
        sdo_call_fill_write(request->type, async->data, len, &async->request.transfer);
    } else {
        async->request.transfer.buffer = async->data;
        async->request.transfer.size = (uint32_t)len;
    }
    return async;
}

/* Under the network's lock. */
static int submit(struct managed *managed, const struct sdo_call *call, struct sdo_async *async,
                  co_us_t now, struct co_outbox *out)
{
    if (managed->asyncs.count >= MCANOPEN_SDO_REQUESTS)
        return MCAL_SDO_QUEUE_FULL;
    if (managed->manager->shut)
        return MCAL_NO_NET;
    async->result.number = next_number(&managed->asyncs);
    append(&managed->asyncs, async);
    sdo_call_fill(managed, call, &async->request.transfer);
    async->request.caller = network_caller(managed->network); /* its end is for few to look at */
    manager_submit(managed->manager, (uint8_t)call->node, &async->request, now, out);
    return MCANOPEN_OK;
}

/* The end may be told before this returns. */
static int hand_over(struct managed *managed, const struct sdo_call *call, struct sdo_async *async,
                     unsigned *ret_number)
{
    struct co_outbox *out;
    co_us_t now;
    int result;

    out = network_enter(managed->network, &now);
    result = submit(managed, call, async, now, out);
    if (result == MCANOPEN_OK && ret_number)
        *ret_number = async->result.number;
    network_leave(managed->network, managed->config->manager_node_id);
    return result;
}

static int request_transfer(const SDO_REQUEST_T *request, bool write, unsigned *ret_number)
{
    struct sdo_call call;
    struct managed *managed;
    struct sdo_async *async;
    int len, result = check(request, write, &call, &len);

    if (result == MCANOPEN_OK)
        result = registry_enter(request->net, true, &managed);
    if (result != MCANOPEN_OK)
        return result;
    async = make(request, write, len);
    result = async ? hand_over(managed, &call, async, ret_number) : MCAL_OBJ_NO_MEMORY;
    if (result != MCANOPEN_OK)
        free(async);
    registry_leave();
    return result;
}

int mcanOpenReadSDOAsync(const SDO_REQUEST_T *request, unsigned int *number)
{
    return request_transfer(request, false, number);
}

int mcanOpenWriteSDOAsync(const SDO_REQUEST_T *request, unsigned int *number)
{
    return request_transfer(request, true, number);
}

/* Under the network's lock. */
static int cancel(struct managed *managed, unsigned number, co_us_t now, struct co_outbox *out)
{
    struct sdo_async *async = find(&managed->asyncs, number);

    if (!async || has_ended(async))
        return MCAL_NO_EVENT;
    manager_cancel(managed->manager, (uint8_t)async->result.node, &async->request, now, out);
    async->result.result = MCAL_SDO_CANCELLED;
    control_wake(managed);
    return MCANOPEN_OK;
}

int mcanOpenCancelSDO(int net, unsigned int number)
{
    struct managed *managed;
    struct co_outbox *out;
    co_us_t now;
    int result = registry_enter(net, true, &managed);

    if (result != MCANOPEN_OK)
        return result;
    out = network_enter(managed->network, &now);
    result = cancel(managed, number, now, out);
    network_leave(managed->network, managed->config->manager_node_id);
    registry_leave();
    return result;
}

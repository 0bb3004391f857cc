/*
 * Object handlers, in the PDO and the SDO daemon.
 *
 * A daemon gets a token for a node that has something for it, one at a time for each node, so that
 * its queue cannot overflow; what there is stands in the node. Received PDOs wait in a ring of
 * usPdoRxQueueSize; TPDOs whose handlers are wanted have a flag each; of SDO writes one waits for
 * each channel.
 */
#include "api/callback.h"
#include "api/scan.h"

#include <stdlib.h>
#include <string.h>

#define TURN      64u /* calls for one node before the others have their turn */
#define CALLS_MAX PDO_FIELDS_MAX

#define REASON_QUEUE 1u /* of EMCY_MESSAGE_LOST */

/* One call of a handler. */
struct call {
    struct scan_entry handlers;
    uint16_t index;
    uint8_t sub;
    union scan_data data;
};

/* What is called under no lock. */
struct calls {
    int net, node;
    uint64_t time;   /* as handlers get it */
    bool wants_data; /* their Data is NULL */
    unsigned count;
    struct call calls[CALLS_MAX];
};

static uint64_t time_for_handlers(const struct scan_node *node, co_us_t time)
{
    return node->net->options & NORMALIZE_TIMESTAMPS ? time : time * 1000u;
}

static void begin_calls(const struct scan_node *node, co_us_t time, struct calls *calls)
{
    calls->net = node->net->number;
    calls->node = node->id;
    calls->time = time_for_handlers(node, time);
    calls->wants_data = false;
    calls->count = 0;
}

static struct call *add_call(struct calls *calls, const struct od_entry *entry)
{
    struct call *call = &calls->calls[calls->count++];

    call->handlers = *(const struct scan_entry *)entry->owner;
    call->index = entry->index;
    call->sub = entry->sub;
    return call;
}

static int run_call(const struct calls *calls, struct call *call)
{
    void *data = calls->wants_data ? NULL : &call->data;

    if (call->handlers.handler_ts)
        return call->handlers.handler_ts(calls->net, calls->node, call->index, call->sub, data,
                                         calls->time);
    return call->handlers.handler(calls->net, calls->node, call->index, call->sub, data);
}

static void run_calls(struct calls *calls)
{
    callback_begin();
    for (unsigned i = 0; i < calls->count; i++)
        run_call(calls, &calls->calls[i]);
    callback_end();
}

static bool is_handled(const struct pdo_field *field)
{
    return field->entry && field->entry->watched;
}

static bool has_handlers(const struct pdo_map *map)
{
    for (unsigned i = 0; i < map->count; i++)
        if (is_handled(&map->fields[i]))
            return true;
    return false;
}

/* ---- the PDO daemon: under the network's lock, by the protocol thread ---- */

static void call_daemon(struct scan_node *node)
{
    const struct scan_token token = scan_token(node);

    if (node->pdo_called)
        return;
    node->pdo_called = true;
    network_put(node->net->network, &node->net->pdo, &token);
}

static bool is_for_handlers(const struct scan_node *node, const struct rpdo *rpdo)
{
    const struct scan_pdo *pdo = scan_pdo(node, false, rpdo->number);
    bool called;

    if (!pdo || pdo->takers > 0)
        return false;
    called = (pdo->mode & AUTO_NOTIFY_PDO) || rpdo->type <= RPDO_SYNC_TYPE_MAX || pdo->callers > 0;
    return called && has_handlers(&rpdo->map);
}

void scan_on_rpdo(struct scan_node *node, const struct co_event *event)
{
    const struct rpdo *rpdo = slave_rpdo(&node->slave, event->index);
    struct scan_received *place;

    if (!rpdo || !is_for_handlers(node, rpdo))
        return;
    if (node->received_count == node->received_size) {
        node->received_lost++;
        return;
    }
    place = &node->received[(node->received_first + node->received_count++) % node->received_size];
    *place = (struct scan_received){
        .number = event->index, .dlc = event->sub, .generation = event->code, .time = event->actual
    };
    memcpy(place->data, event->data, sizeof place->data);
    call_daemon(node);
}

void scan_on_tpdo_wanted(struct scan_node *node, const struct co_event *event)
{
    struct scan_pdo *pdo = scan_pdo(node, true, event->index);

    if (!pdo)
        return;
    node->asks += pdo->ask == 0;
    pdo->ask = event->code;
    call_daemon(node);
}

/* ---- the PDO daemon: its thread ---- */

struct wanted { /* a TPDO whose handlers are called */
    uint16_t number;
    uint32_t ask; /* 0: it is no TPDO */
};

static void collect_received(struct scan_node *node, struct calls *calls)
{
    const struct scan_received received = node->received[node->received_first];
    const struct rpdo *rpdo = slave_rpdo(&node->slave, received.number);

    node->received_first = (node->received_first + 1) % node->received_size;
    node->received_count--;
    begin_calls(node, received.time, calls);
    if (!rpdo || rpdo->generation != received.generation)
        return; /* it was for another mapping */
    for (unsigned i = 0; i < rpdo->map.count; i++) {
        const struct pdo_field *field = &rpdo->map.fields[i];
        uint8_t bytes[8];

        if (!is_handled(field))
            continue;
        scan_field_bytes(field, received.data, bytes);
        scan_data_from(field->entry->type, bytes, field->entry->size,
                       &add_call(calls, field->entry)->data);
    }
}

static void collect_wanted(struct scan_node *node, co_us_t now, struct calls *calls,
                           struct wanted *ret_wanted)
{
    uint16_t number = 1;
    const struct tpdo *tpdo;

    while (node->tpdos[number - 1].ask == 0)
        number++;
    *ret_wanted = (struct wanted){ .number = number, .ask = node->tpdos[number - 1].ask };
    node->tpdos[number - 1].ask = 0;
    node->asks--;
    begin_calls(node, now, calls);
    calls->wants_data = true;
    tpdo = slave_tpdo(&node->slave, number);
    for (unsigned i = 0; tpdo && i < tpdo->map.count; i++)
        if (is_handled(&tpdo->map.fields[i]))
            add_call(calls, tpdo->map.fields[i].entry);
}

/* What found no room in the ring: an event, and an emergency that is over at once. */
static void tell_lost(struct scan_node *node, co_us_t now, struct co_outbox *out)
{
    const unsigned lost = node->received_lost;
    const struct emcy_message error = { .code = EMCY_MESSAGE_LOST,
                                        .error_register = ERROR_COMMUNICATION,
                                        .field = {
                                            0, EMCY_STICKY_FIFO_OVERRUN, REASON_QUEUE,
                                            (uint8_t)(lost < UINT8_MAX ? lost : UINT8_MAX) } };

    if (lost == 0 || slave_raise_error(&node->slave, &error, now, out) != CO_OK)
        return;
    slave_clear_error(&node->slave, ERROR_COMMUNICATION, now, out);
    node->received_lost = 0;
    scan_tell(node, EV_CAN, EV_PDO_FIFO_OVERRUN, lost);
}

/* False: there is nothing more for this node. SYNC does not wait: TPDOs come first. */
static bool collect(struct scan_node *node, struct calls *calls, struct wanted *ret_wanted)
{
    co_us_t now;
    struct co_outbox *out = scan_lock_untimed(node, &now);
    const bool lost = node->active && node->received_lost > 0;
    bool more;

    if (lost || node->asks > 0)
        now = network_clock(node->net->network);
    *ret_wanted = (struct wanted){ .ask = 0 };
    if (lost)
        tell_lost(node, now, out);
    if (node->active && node->asks > 0)
        collect_wanted(node, now, calls, ret_wanted);
    else if (node->active && node->received_count > 0)
        collect_received(node, calls);
    else
        node->pdo_called = false;
    more = node->pdo_called;
    if (lost)
        scan_unlock(node);
    else
        network_release(node->net->network);
    return more;
}

static void answer(struct scan_node *node, const struct wanted *wanted)
{
    co_us_t now;
    struct co_outbox *out = scan_lock(node, &now);

    if (node->active)
        slave_tpdo_answer(&node->slave, wanted->number, wanted->ask, now, out);
    scan_unlock(node);
}

void scan_pdo_work(void *context, const void *element)
{
    struct scan_net *net = context;
    struct scan_node *node;
    struct calls calls;
    struct wanted wanted;

    if (scan_enter_token(element, &node) != SCANOPEN_OK)
        return;
    for (unsigned i = 0; i < TURN; i++) {
        if (!collect(node, &calls, &wanted))
            goto leave;
        run_calls(&calls);
        if (wanted.ask != 0)
            answer(node, &wanted);
    }
    daemon_put(&net->pdo, element);
leave:
    scan_leave(node);
}

/* ---- the SDO daemon ---- */

bool scan_make_verdicts(struct scan_node *node)
{
    const unsigned count = node->slave.channel_count;
    struct scan_verdict *verdicts = calloc(count, sizeof *verdicts);

    if (!verdicts)
        return false;
    free(node->verdicts);
    node->verdicts = verdicts;
    node->verdict_count = count;
    node->verdict_next = 0;
    return true;
}

void scan_on_verdict(struct scan_node *node, const struct co_event *event, co_us_t now)
{
    const struct scan_token token = scan_token(node);

    node->verdicts[event->detail] = (struct scan_verdict){ .pending = true,
                                                           .index = event->index,
                                                           .sub = event->sub,
                                                           .size = (uint32_t)event->actual,
                                                           .transfer = { event->detail,
                                                                         event->code },
                                                           .time = now };
    if (node->sdo_called)
        return;
    node->sdo_called = true;
    network_put(node->net->network, &node->net->sdo, &token);
}

/* The next one whose client still waits; NULL: there is none. */
static struct scan_verdict *next_verdict(struct scan_node *node)
{
    for (unsigned i = 0; node->active && i < node->verdict_count; i++) {
        struct scan_verdict *verdict = &node->verdicts[node->verdict_next];
        const bool pending = verdict->pending;

        node->verdict_next = (node->verdict_next + 1) % node->verdict_count;
        verdict->pending = false;
        if (pending && slave_waits_for(&node->slave, verdict->transfer))
            return verdict;
    }
    return NULL;
}

/* The bytes of the value; *ret_bytes is to be freed. False: no client waits any more. */
static bool collect_verdict(struct scan_node *node, struct calls *calls,
                            struct slave_transfer *ret_transfer, uint8_t **ret_bytes)
{
    const struct scan_verdict *verdict = next_verdict(node);
    const struct od_entry *entry;

    node->sdo_called = verdict != NULL;
    if (!verdict)
        return false;
    entry = od_find(&node->od, verdict->index, verdict->sub);
    *ret_transfer = verdict->transfer;
    *ret_bytes = malloc(verdict->size + 1u);
    begin_calls(node, verdict->time, calls);
    if (!*ret_bytes || !entry || !entry->owner)
        return true;
    if (verdict->size > 0)
        memcpy(*ret_bytes, slave_received(&node->slave, verdict->transfer), verdict->size);
    (*ret_bytes)[verdict->size] = 0;
    scan_data_from(entry->type, *ret_bytes, verdict->size, &add_call(calls, entry)->data);
    return true;
}

static sdo_abort_t code_of(int result)
{
    if (result > 0)
        return (sdo_abort_t)result;
    switch (result) {
    case SCANOPEN_OK: return SDO_OK;
    case SCANOPEN_VALUE_TOO_HIGH: return SDO_VALUE_HIGH;
    case SCANOPEN_VALUE_TOO_LOW: return SDO_VALUE_LOW;
    case SCANOPEN_WRONG_PARAMETER: return SDO_INVALID_VALUE;
    default: return SDO_NOT_STORED;
    }
}

static sdo_abort_t ask_handler(struct calls *calls)
{
    sdo_abort_t code;

    if (calls->count == 0)
        return SDO_NO_MEMORY;
    callback_begin();
    code = code_of(run_call(calls, &calls->calls[0]));
    callback_end();
    return code;
}

static bool answer_client(struct scan_node *node)
{
    struct slave_transfer transfer;
    struct co_outbox *out;
    struct calls calls;
    uint8_t *bytes;
    unsigned activation;
    sdo_abort_t code;
    co_us_t now;
    bool wanted;

    scan_lock(node, &now);
    wanted = collect_verdict(node, &calls, &transfer, &bytes);
    activation = node->activations;
    network_release(node->net->network);
    if (!wanted)
        return false;
    code = ask_handler(&calls);
    free(bytes);
    out = scan_lock(node, &now);
    if (node->active && node->activations == activation)
        slave_verdict(&node->slave, transfer, code, now, out);
    scan_unlock(node);
    return true;
}

void scan_sdo_work(void *context, const void *element)
{
    struct scan_net *net = context;
    struct scan_node *node;

    if (scan_enter_token(element, &node) != SCANOPEN_OK)
        return;
    if (answer_client(node)) /* then perhaps others; after those of other nodes */
        daemon_put(&net->sdo, element);
    scan_leave(node);
}

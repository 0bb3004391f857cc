/*
 * The PDO daemon, and calls of object handlers.
 *
 * The daemon gets a token for a node that has something for it, one at a time for each node, so
 * that its queue cannot overflow; what there is stands in the node. Received PDOs wait in a ring of
 * usPdoRxQueueSize; TPDOs whose handlers are wanted have a flag each.
 */
#include "api/callback.h"
#include "api/scan.h"

#include <string.h>

#define TURN      64u /* calls for one node before the others have their turn */
#define CALLS_MAX PDO_FIELDS_MAX

/* What is called under no lock. */
struct calls {
    bool wants_data; /* their Data is NULL */
    unsigned count;
    struct scan_call calls[CALLS_MAX];
};

uint64_t scan_time_for_handlers(const struct scan_node *node, co_us_t time)
{
    return node->net->options & NORMALIZE_TIMESTAMPS ? time : time * 1000u;
}

void scan_make_call(const struct scan_node *node, const struct od_entry *entry, co_us_t time,
                    struct scan_call *ret_call)
{
    ret_call->net = node->net->number;
    ret_call->node = node->id;
    ret_call->time = scan_time_for_handlers(node, time);
    ret_call->index = entry->index;
    ret_call->sub = entry->sub;
    ret_call->handlers = *(const struct scan_entry *)entry->owner;
}

int scan_run_call(const struct scan_call *call, void *data)
{
    if (call->handlers.handler_ts)
        return call->handlers.handler_ts(call->net, call->node, call->index, call->sub, data,
                                         call->time);
    return call->handlers.handler(call->net, call->node, call->index, call->sub, data);
}

static struct scan_call *add_call(struct calls *calls, const struct scan_node *node,
                                  const struct od_entry *entry, co_us_t time)
{
    struct scan_call *call = &calls->calls[calls->count++];

    scan_make_call(node, entry, time, call);
    return call;
}

static void run_calls(struct calls *calls)
{
    callback_begin();
    for (unsigned i = 0; i < calls->count; i++)
        scan_run_call(&calls->calls[i], calls->wants_data ? NULL : &calls->calls[i].data);
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
    if (!rpdo || rpdo->generation != received.generation)
        return; /* it was for another mapping */
    for (unsigned i = 0; i < rpdo->map.count; i++) {
        const struct pdo_field *field = &rpdo->map.fields[i];
        uint8_t bytes[8];

        if (!is_handled(field))
            continue;
        scan_field_bytes(field, received.data, bytes);
        scan_data_from(field->entry->type, bytes, field->entry->size,
                       &add_call(calls, node, field->entry, received.time)->data);
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
    calls->wants_data = true;
    tpdo = slave_tpdo(&node->slave, number);
    for (unsigned i = 0; tpdo && i < tpdo->map.count; i++)
        if (is_handled(&tpdo->map.fields[i]))
            add_call(calls, node, tpdo->map.fields[i].entry, now);
}

/* What found no room in the ring, and the end of that: it is empty. */
static void tell_lost(struct scan_node *node, co_us_t now, struct co_outbox *out)
{
    const unsigned lost = node->received_lost;

    if (lost == 0) {
        slave_pdos_taken(&node->slave, now, out);
    } else if (slave_lose_pdos(&node->slave, lost, now, out) == CO_OK) {
        node->received_lost = 0;
        scan_tell(node, EV_CAN, EV_PDO_FIFO_OVERRUN, lost);
    }
}

static bool has_lost(const struct scan_node *node)
{
    const bool over = node->received_count == 0 && node->slave.errors.pdos_lost;

    return node->active && (node->received_lost > 0 || over);
}

/* False: there is nothing more for this node. SYNC does not wait: TPDOs come first. */
static bool collect(struct scan_node *node, struct calls *calls, struct wanted *ret_wanted)
{
    co_us_t now;
    struct co_outbox *out = scan_lock_untimed(node, &now);
    const bool lost = has_lost(node);
    bool more;

    if (lost || node->asks > 0)
        now = network_clock(node->net->network);
    *ret_wanted = (struct wanted){ .ask = 0 };
    calls->count = 0;
    calls->wants_data = false;
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

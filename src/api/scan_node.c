/* A local node's life and state: canOpenCreateNode(Ex) to canOpenDeleteNode. */
#include "api/callback.h"
#include "api/scan.h"

#include <stdlib.h>

#define DEFAULT_QUEUE   256u
#define DEFAULT_MAP_MAX 8u
#define OLD_EVENTS      (EV_GUARDING | EV_STATE_CHANGE | EV_RESET)
#define STATES          (WFNS_INIT | WFNS_STOPPED | WFNS_PRE_OPERATIONAL | WFNS_OPERATIONAL)

int scan_node_state(const struct scan_node *node)
{
    return node->active ? node->slave.state : NodeOffline;
}

/* ---- creating ---- */

static int make_pdo_lists(struct scan_node *node, const SLAVE_NODE_INFO *info)
{
    node->rpdo_max = info->usRxPDO;
    node->tpdo_max = info->usTxPDO;
    node->rpdos = calloc(node->rpdo_max + 1u, sizeof *node->rpdos);
    node->tpdos = calloc(node->tpdo_max + 1u, sizeof *node->tpdos);
    return node->rpdos && node->tpdos ? SCANOPEN_OK : SCANOPEN_OUT_OF_MEMORY;
}

static int make_by_info(struct scan_node *node, const struct scan_order *order)
{
    const struct scan_profile profile = { .info = order->info, .old = order->old, .id = node->id };
    int result = scan_make_objects(&profile, &node->od);

    return result == SCANOPEN_OK ? make_pdo_lists(node, order->info) : result;
}

static int make_parts(struct scan_node *node, const struct scan_order *order)
{
    const SLAVE_NODE_INFO *info = order->info;
    int result = order->file ? scan_make_from_file(node, order->file) : make_by_info(node, order);

    if (result != SCANOPEN_OK)
        return result;
    node->options = info->ulOptions;
    node->event_mask = order->old ? OLD_EVENTS : info->ulEventMask;
    node->map_max = info->ucMaxMapped ? info->ucMaxMapped : DEFAULT_MAP_MAX;
    node->on_event = order->on_event;
    node->on_event_old = order->on_event_old;
    node->received_size = info->usPdoRxQueueSize ? info->usPdoRxQueueSize : DEFAULT_QUEUE;
    node->received = calloc(node->received_size, sizeof *node->received);
    return node->received ? SCANOPEN_OK : SCANOPEN_OUT_OF_MEMORY;
}

static int make_node(struct scan_net *net, const struct scan_order *order,
                     struct scan_node **ret_node)
{
    struct scan_node *node;
    int result = scan_new_node(&node);

    if (result != SCANOPEN_OK)
        return result;
    node->net = net;
    node->id = (uint8_t)order->id;
    result = make_parts(node, order);
    if (result == SCANOPEN_OK &&
        network_add(net->network, node->id, scan_on_node_event, node) != CO_OK)
        result = SCANOPEN_WRONG_PARAMETER; /* the node-ID is in use */
    if (result != SCANOPEN_OK) {
        scan_free_node(node);
        return result;
    }
    net->nodes++;
    *ret_node = node;
    return SCANOPEN_OK;
}

int scan_create_node(const struct scan_order *order, HNODE *ret_handle)
{
    struct scan_net *net;
    struct scan_node *node;
    int result = SCANOPEN_WRONG_PARAMETER;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    if (!order->info || !ret_handle || order->id < 1 || order->id > (int)NMT_NODE_MAX)
        return SCANOPEN_WRONG_PARAMETER;
    scan_begin_change();
    net = scan_net(order->net);
    if (net)
        result = make_node(net, order, &node);
    if (result == SCANOPEN_OK) {
        *ret_handle = scan_node_handle(node);
        scan_open_node(node);
    }
    scan_end_change();
    return result;
}

int canOpenCreateNodeEx(int iNetNo, int iModID, PFN_COS_EVENT_HANDLER EventHandler,
                        const SLAVE_NODE_INFO *pSlaveInfo, HNODE *HNode)
{
    const struct scan_order order = {
        .net = iNetNo, .id = iModID, .info = pSlaveInfo, .on_event = EventHandler
    };

    return scan_create_node(&order, HNode);
}

/* The older form's options are those of the newer one, as far as it has them. */
int canOpenCreateNode(int NetNo, const char *NodeName, int ModID, unsigned long DevType,
                      int Options, int MaxErrors, const char *DeviceName, const char *HardwareVers,
                      const char *SoftwareVers, unsigned short GuardTime, unsigned short LifeTime,
                      unsigned short ServerObjects, unsigned short ClientObjects,
                      PFN_COS_EVENT_HANDLER_OLD EventHandler, HNODE *HNode)
{
    const unsigned long known = BLOCK_TRANSFER | STATE_REGISTER | ERROR_REGISTER | ADDITIONAL_PDOS |
                                SYNCHRON_PDOS | MANUFACTURER_INFO | GUARDING | PARAMETER_STORE |
                                PARAMETER_RESET | ADDITIONAL_SDOS;
    const SLAVE_NODE_INFO info = { .ulOptions = (unsigned long)Options,
                                   .ulDeviceType = DevType,
                                   .usRxPDO = SCAN_PDOS,
                                   .usTxPDO = SCAN_PDOS,
                                   .ucServerSDO = (unsigned char)ServerObjects,
                                   .ucClientSDO = (unsigned char)ClientObjects,
                                   .ucMaxErrors = (unsigned char)MaxErrors,
                                   .ucMaxIdentityObject = 1,
                                   .ulSyncCobID = DEFAULT_SYNC_COBID,
                                   .pszDeviceName = DeviceName,
                                   .pszHwVersion = HardwareVers,
                                   .pszSwVersion = SoftwareVers,
                                   .usGuardTime = GuardTime,
                                   .ucLifeTime = (unsigned char)LifeTime };
    const struct scan_order order = {
        .net = NetNo, .id = ModID, .info = &info, .old = true, .on_event_old = EventHandler
    };

    (void)NodeName; /* for messages, of which there are none */
    if (Options < 0 || ((unsigned long)Options & ~known) != 0)
        return SCANOPEN_WRONG_PARAMETER;
    if (((Options & ERROR_REGISTER) && (MaxErrors < 0 || MaxErrors > UINT8_MAX)) ||
        ((Options & GUARDING) && LifeTime > UINT8_MAX) ||
        ((Options & ADDITIONAL_SDOS) && ServerObjects > UINT8_MAX))
        return SCANOPEN_WRONG_PARAMETER;
    return scan_create_node(&order, HNode);
}

/* ---- on the bus, and off ---- */

/* Under the lock. */
static int activate(struct scan_node *node, co_us_t now, struct co_outbox *out)
{
    enum co_err err;

    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    scan_watch_store(node);
    err = slave_init(&node->slave, node->id, &node->od);
    if (err != CO_OK)
        return SCANOPEN_OUT_OF_MEMORY;
    node->slave.accept_long = (node->options & PDO_ACCEPT_LONG) != 0;
    node->slave.assume_sync = node->from_file; /* many files leave 1005h out */
    slave_serve_blocks(&node->slave, node->from_file || (node->options & BLOCK_TRANSFER) != 0);
    scan_set_pdo_flags(node);
    if (!scan_make_questions(node) ||
        network_set_slave(node->net->network, node->id, &node->slave) != CO_OK) {
        slave_done(&node->slave);
        return SCANOPEN_OUT_OF_MEMORY;
    }
    node->active = true;
    node->activations++;
    slave_switch_on(&node->slave, now, out);
    return SCANOPEN_OK;
}

int canOpenActivateNode(HNODE HNode)
{
    struct co_outbox *out;
    struct scan_node *node;
    co_us_t now;
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    result = scan_enter(HNode, &node);
    if (result != SCANOPEN_OK)
        return result;
    out = scan_lock(node, &now);
    result = activate(node, now, out);
    scan_unlock(node);
    scan_leave(node);
    return result;
}

static void tell_end_of_watching(struct scan_node *node)
{
    for (unsigned i = 0; i < node->slave.consumer_count; i++) {
        const uint8_t watched = slave_watched_node(&node->slave, i);

        if (watched != 0)
            scan_tell(node, EV_CONSUMER_HEARTBEAT, EV_STOP, watched);
    }
    if (node->slave.told_guarding)
        scan_tell(node, EV_GUARDING, EV_STOP, 0);
}

/* Under the lock: off the bus; what the daemons still have of it is nothing any more. */
static void deactivate(struct scan_node *node)
{
    if (!node->active)
        return;
    node->active = false;
    tell_end_of_watching(node);
    network_set_slave(node->net->network, node->id, NULL);
    slave_done(&node->slave);
    od_reset(&node->od, 0, UINT16_MAX);
    scan_end_texts(node);
    scan_count_maps(node);
    node->received_count = node->received_lost = 0;
    for (unsigned i = 0; i < node->question_count; i++)
        node->questions[i].pending = false;
    for (unsigned i = 0; i < node->tpdo_count; i++)
        node->tpdos[i].ask = 0;
    node->asks = 0;
    scan_tell(node, EV_STATE_CHANGE, NodeOffline, 0);
}

static void go_offline(struct scan_node *node)
{
    co_us_t now;

    scan_lock(node, &now);
    scan_wait_stored(node);
    deactivate(node);
    network_poke(node->net->network);
    scan_unlock(node);
}

int canOpenResetNode(HNODE HNode)
{
    struct scan_node *node;
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    result = scan_enter(HNode, &node);
    if (result != SCANOPEN_OK)
        return result;
    go_offline(node);
    scan_leave(node);
    return SCANOPEN_OK;
}

/* Calls that wait for the node return. */
static void retire(struct scan_node *node)
{
    network_retire(node->net->network, node->id);
}

static bool is_offline(struct scan_node *node)
{
    bool offline;

    network_hold(node->net->network);
    offline = !node->active;
    network_release(node->net->network);
    return offline;
}

/* With the change lock: of two calls for one node the second finds it closed. */
static int delete_node(struct scan_node *node)
{
    if (!is_offline(node))
        return SCANOPEN_WRONG_NODESTATE;
    scan_close_node(node, retire);
    go_offline(node); /* where a call that was inside has activated it meanwhile */
    network_remove(node->net->network, node->id);
    node->net->nodes--;
    scan_free_node(node);
    return SCANOPEN_OK;
}

int canOpenDeleteNode(HNODE HNode)
{
    struct scan_node *node;
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    scan_begin_change();
    result = scan_enter(HNode, &node);
    if (result == SCANOPEN_OK) {
        result = delete_node(node);
        if (result != SCANOPEN_OK)
            scan_leave(node);
    }
    scan_end_change();
    return result;
}

/* ---- state ---- */

int canOpenGetNodeInfo(HNODE HNode, int *State, int *LastErr)
{
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    if (result != SCANOPEN_OK)
        return result;
    if (State && LastErr) {
        network_hold(node->net->network);
        *State = scan_node_state(node);
        *LastErr = node->last_error;
        network_release(node->net->network);
    } else {
        result = SCANOPEN_WRONG_PARAMETER;
    }
    scan_leave(node);
    return result;
}

static unsigned bit_of_state(int state)
{
    switch (state) {
    case NodeStopped: return WFNS_STOPPED;
    case NodeOperational: return WFNS_OPERATIONAL;
    case NodePreOperational: return WFNS_PRE_OPERATIONAL;
    default: return WFNS_INIT;
    }
}

static int wait_for_state(struct scan_node *node, unsigned mask)
{
    enum co_err err = CO_OK;
    co_us_t now;
    int state;

    scan_lock(node, &now);
    state = scan_node_state(node);
    while ((bit_of_state(state) & mask) == 0 && err != CO_ERR_STATE) {
        err = network_wait(node->net->network, node->id, CO_NEVER);
        state = scan_node_state(node);
    }
    scan_unlock(node);
    return err == CO_ERR_STATE ? SCANOPEN_INVALID_HANDLE : state;
}

int canOpenWaitForNodeState(HNODE HNode, unsigned short StateMask)
{
    struct scan_node *node;
    int result;

    if (callback_running())
        return SCANOPEN_SERVICE_NOT_ALLOWED;
    result = scan_enter(HNode, &node);
    if (result != SCANOPEN_OK)
        return result;
    if (StateMask == 0 || (StateMask & ~STATES) != 0)
        result = SCANOPEN_WRONG_PARAMETER;
    else
        result = wait_for_state(node, StateMask);
    scan_leave(node);
    return result;
}

/* Node events: what the slave and the network tell, for the node's handler in the NMT daemon. */
#include "api/callback.h"
#include "api/control.h"
#include "api/log.h"
#include "api/scan.h"
#include "api/trace.h"

#include <stdio.h>

#define STORE_PARAMETERS 0x1010u

/* ---- under the network's lock ---- */

bool scan_wants(const struct scan_node *node, unsigned long event)
{
    return (node->event_mask & event) != 0 && (node->on_event || node->on_event_old);
}

static void tell(struct scan_node *node, const struct scan_event_token *told)
{
    struct scan_event_token token = *told;

    if (!scan_wants(node, token.event.ulEvent))
        return;
    token.node = scan_token(node);
    token.event.usNetNo = (unsigned short)node->net->number;
    token.event.usModId = node->id;
    daemon_put(&node->net->nmt, &token);
}

void scan_tell(struct scan_node *node, unsigned long event, unsigned long arg1, unsigned long arg2)
{
    const struct scan_event_token token = {
        .event = { .ulEvent = event, .ulArg1 = arg1, .arg = { .ulArg2 = arg2 } }
    };

    tell(node, &token);
}

static void tell_time(struct scan_node *node, const struct co_event *news)
{
    const struct scan_event_token token = { .event = { .ulEvent = EV_TIME }, .news = *news };

    tell(node, &token);
}

void scan_tell_configuration(struct scan_node *node, const struct co_event *news)
{
    const struct scan_event_token token = {
        .event = { .ulEvent = EV_CONFIGURATION,
                   .ulArg1 = news->index == STORE_PARAMETERS ? EV_STORE : EV_RESTORE,
                   .arg = { .ulArg2 = news->sub } },
        .news = *news
    };

    tell(node, &token);
}

/* The two resets as the application knows them; the state NodeInit is only passed through. */
static void tell_state(struct scan_node *node, const struct co_event *event)
{
    if (event->detail != NodeInit) {
        if (node->resetting) {
            node->resetting = false;
            scan_tell(node, EV_RESET, node->reset_kind, EV_END);
        }
        scan_tell(node, EV_STATE_CHANGE, event->detail, 0);
        return;
    }
    scan_end_texts(node);
    node->resetting = event->sub != 0;
    node->reset_kind = event->sub == NMT_RESET_NODE ? EV_APPLICATION : EV_COMMUNICATION;
    if (node->resetting)
        scan_tell(node, EV_RESET, node->reset_kind, EV_BEGIN);
}

static void tell_pdo_error(struct scan_node *node, const struct co_event *event)
{
    if (event->code == RPDO_FAULT_SHORT)
        scan_tell(node, EV_CAN, EV_PDO_NOT_PROCESSED, event->index);
    else if (event->code == RPDO_FAULT_LONG)
        scan_tell(node, EV_CAN, EV_PDO_LENGTH_EXCEEDED, event->index);
}

/* What enum slave_watching is to the application. */
static unsigned long argument_of(uint8_t watching)
{
    static const unsigned long arguments[] = { [WATCH_BEGINS] = EV_START,
                                               [WATCH_ENDS] = EV_STOP,
                                               [WATCH_BOOT_UP] = EV_BOOTUP,
                                               [WATCH_TIMEOUT] = EV_TIMEOUT };

    return arguments[watching];
}

/* For the log. */
static void put_news(struct scan_net *net, const struct co_event *event)
{
    const struct scan_event_token token = { .news = *event };

    daemon_put(&net->nmt, &token);
}

static void note_written(struct scan_node *node, const struct co_event *event)
{
    const struct od_entry *entry = od_find(&node->od, event->index, event->sub);

    if (entry && scan_is_text(entry->type))
        scan_end_text(entry);
    scan_tell(node, EV_WRITE_DICTIONARY, event->index, event->sub);
}

static void note_confirmed(struct scan_node *node, const struct co_event *event)
{
    struct scan_pdo *pdo = scan_pdo(node, true, event->index);
    const struct tpdo *tpdo = slave_tpdo(&node->slave, event->index);

    if (!pdo || !tpdo || tpdo->sent == pdo->confirmed) /* one that was given up */
        return;
    pdo->confirmed++;
    pdo->confirmed_at = network_time(node->net->network);
}

static void on_supervision(struct scan_node *node, const struct co_event *event)
{
    switch (event->type) {
    case SLAVE_WATCH:
        scan_tell(node, EV_CONSUMER_HEARTBEAT, argument_of(event->detail), event->node);
        break;
    case SLAVE_GUARDING: scan_tell(node, EV_GUARDING, argument_of(event->detail), 0); break;
    case SLAVE_EMCY_HEARD: scan_on_emcy(node, event); break;
    case SLAVE_EMCY_LOST: put_news(node->net, event); break;
    default: break;
    }
}

static void on_pdo_event(struct scan_node *node, const struct co_event *event)
{
    switch (event->type) {
    case SLAVE_RPDO: scan_on_rpdo(node, event); break;
    case SLAVE_TPDO_WANTED: scan_on_tpdo_wanted(node, event); break;
    case SLAVE_TPDO_CONFIRMED: note_confirmed(node, event); break;
    case SLAVE_PDO_ERROR: tell_pdo_error(node, event); break;
    case SLAVE_SYNC_MISSING: scan_tell(node, EV_SYNC, EV_TIMEOUT, 0); break;
    default: on_supervision(node, event); break;
    }
}

void scan_on_node_event(void *context, struct network *network, const struct co_event *event)
{
    struct scan_node *node = context;

    switch (event->type) {
    case SLAVE_STATE: tell_state(node, event); break;
    case SLAVE_WRITTEN: note_written(node, event); break;
    case SLAVE_EMERGENCY: node->last_error = (int)event->code; break;
    case SLAVE_VERDICT:
        if (!scan_on_store(node, event))
            scan_on_question(node, event, network_time(network));
        break;
    case SLAVE_FETCH: scan_on_question(node, event, network_time(network)); break;
    case SLAVE_VERDICT_LATE:
        scan_tell(node, EV_HANDLER, EV_TIMEOUT, (unsigned long)event->index << 8 | event->sub);
        break;
    case SLAVE_TIME: tell_time(node, event); break;
    default: on_pdo_event(node, event); break;
    }
}

struct net_news {
    unsigned long what, number;
};

static void tell_news(struct scan_node *node, const void *context)
{
    const struct net_news *news = context;

    scan_tell(node, EV_CAN, news->what, news->number);
}

static bool is_lost(uint8_t state)
{
    return state == BUS_OFF || state == BUS_DOWN;
}

static void tell_nodes(struct scan_net *net, unsigned long what, unsigned long number)
{
    const struct net_news news = { what, number };

    scan_each_node(net, tell_news, &news);
}

static void on_bus_state(struct scan_net *net, uint8_t state)
{
    const uint8_t before = net->bus_state;

    net->bus_state = state;
    if (is_lost(state) && !is_lost(before))
        tell_nodes(net, EV_CONTROLLER_BUS_OFF, 0);
    if ((is_lost(before) && !is_lost(state)) || (before == BUS_PASSIVE && state < BUS_PASSIVE))
        tell_nodes(net, EV_CONTROLLER_OK, 0);
    if (state == BUS_PASSIVE)
        tell_nodes(net, EV_CONTROLLER_WARN, 0);
}

void scan_on_net_event(void *context, struct network *network, const struct co_event *event)
{
    struct scan_net *net = context;

    if (event->type == RUNTIME_FRAME) {
        if (trace_wanted_by(net->debug_mask, event))
            put_news(net, event);
        return;
    }
    if (!network_has_manager(network)) /* whose daemon logs it */
        put_news(net, event);
    if (event->type == RUNTIME_BUS_STATE)
        on_bus_state(net, event->detail);
    else if (event->type == RUNTIME_FRAMES_LOST)
        tell_nodes(net, EV_FIFO_OVERRUN, (unsigned long)event->actual);
}

/* ---- the NMT daemon ---- */

static void call_old(const struct scan_node *node, const SLAVE_EVENT *event)
{
    const int place = (int)(event->usNetNo << 8 | event->usModId);

    node->on_event_old(place, (int)event->ulEvent, (int)event->ulArg1, (int)event->arg.ulArg2);
}

static void log_news(const struct scan_net *net, const struct co_event *news)
{
    char text[CO_REPORT_TEXT_SIZE], full[CO_REPORT_TEXT_SIZE + 64];

    if (news->type == RUNTIME_FRAME) {
        trace_text(news, text, sizeof text);
        log_put(CO_INFO, text);
        return;
    }
    if (news->type == SLAVE_EMCY_LOST)
        snprintf(text, sizeof text, "node %u: %u emergencies not sent: too many wait already",
                 news->node, (unsigned)news->actual);
    else if (!control_bus_text(net->network, news, text, sizeof text))
        return;
    snprintf(full, sizeof full, "%s: warning: %s", network_name(net->network), text);
    log_put(CO_WARNING, full);
}

int scan_call_handler(const struct scan_token *token, SLAVE_EVENT *event)
{
    struct scan_node *node;
    int result = SCANOPEN_OK;

    if (scan_enter_token(token, &node) != SCANOPEN_OK)
        return result;
    callback_begin();
    if (node->on_event)
        result = node->on_event(event);
    else if (node->on_event_old)
        call_old(node, event);
    callback_end();
    scan_leave(node);
    return result;
}

void scan_nmt_work(void *context, const void *element)
{
    const struct scan_event_token *token = element;
    SLAVE_EVENT event = token->event;
    CAN_TIME_OF_DAY time;
    int result;

    if (token->node.generation == 0) {
        log_news(context, &token->news);
        return;
    }
    time = scan_time_of(&token->news);
    if (event.ulEvent == EV_TIME)
        event.arg.pArg2 = &time;
    result = scan_call_handler(&token->node, &event);
    if (event.ulEvent == EV_CONFIGURATION)
        scan_decide_store(&token->node, &token->news, result);
}

void scan_nmt_lost(void *context, unsigned count)
{
    const struct scan_net *net = context;
    char text[96];

    snprintf(text, sizeof text, "network %d: %u node events lost: the event handler is too slow",
             net->number, count);
    log_put(CO_WARNING, text);
}

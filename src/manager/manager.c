#include "manager/manager.h"

#include "manager/boot_network.h"
#include "manager/config_write.h"
#include "manager/manager_od.h"
#include "manager/nmt_request.h"
#include "proto/event.h"

#include <string.h>

/*
 * Room for what one call may put, with what follows from it: about ten events for each of 127
 * nodes. With less than that nothing new is begun until the owner has taken what is there.
 */
#define EVENT_ROOM (MANAGER_INNER_EVENTS - 256u)

enum co_err manager_init(struct manager *self, struct network_config *config)
{
    enum co_err err;

    memset(self, 0, sizeof *self);
    self->config = config;
    self->deadline = CO_NEVER;
    self->boot_limit = CO_NEVER;
    co_deadlines_init(&self->deadlines);
    co_outbox_init(&self->inner, self->inner_frames, MANAGER_INNER_FRAMES, self->inner_events,
                   MANAGER_INNER_EVENTS);
    for (uint8_t node = 1; node <= NETWORK_NODE_MAX; node++) {
        boot_node_init(&self->nodes[node], node, network_config_node(config, node));
        sdo_channel_init(&self->channels[node], node, &self->block_downloads);
    }
    od_init(&self->od);
    err = manager_od_fill(config, &self->od);
    if (err == CO_OK)
        err = slave_init(&self->device, config->manager_node_id, &self->od);
    if (err != CO_OK) {
        od_done(&self->od);
        return err;
    }
    slave_leave_heartbeats(&self->device);  /* 1F80h says what a lost node means, not 1029h */
    slave_leave_emergencies(&self->device); /* MANAGER_EMCY tells of them */
    return CO_OK;
}

void manager_done(struct manager *self)
{
    slave_done(&self->device);
    od_done(&self->od);
}

/* --- what the machines inside tell --- */

static void on_sdo_done(struct manager *self, const struct co_event *event, co_us_t now)
{
    struct boot_node *node = &self->nodes[event->node];
    struct sdo_request *request = sdo_channel_on_done(&self->channels[event->node], event, now,
                                                      &self->inner);
    struct co_event done = { .type = MANAGER_REQUEST_DONE,
                             .node = event->node,
                             .actual = request ? request->caller : 0 };

    if (request == &node->request)
        boot_node_on_sdo(node, now, &self->inner);
    else if (request)
        co_outbox_put_event(&self->inner, &done);
}

static bool is_power_of_2(uint64_t number)
{
    return (number & (number - 1)) == 0;
}

/* What only an application would want to know of its device. */
static bool is_of_device(uint16_t type)
{
    static const uint16_t types[] = { SLAVE_VERDICT_LATE, SLAVE_EMCY_LOST, SLAVE_WATCH,
                                      SLAVE_GUARDING };

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i] == type)
            return true;
    return false;
}

/* True if the event was for the manager alone. */
static bool consume(struct manager *self, const struct co_event *event, co_us_t now)
{
    manager_touch(self, event->node);
    switch (event->type) {
    case PROTO_SDO_DONE: on_sdo_done(self, event, now); return true;
    case PROTO_HB_STATE:
    case PROTO_GUARD_STATE: error_control_on_alive(self, event->node, now); return true;
    case PROTO_HB_LOST:
    case PROTO_GUARD_LOST: error_control_on_lost(self, event->node, now); return true;
    case SLAVE_VERDICT:
        if (event->index == REQUEST_NMT)
            nmt_request_on_write(self, event, now);
        else
            config_write_on_verdict(self, event, now);
        return true;
    case SLAVE_FETCH: config_write_on_fetch(self, event, now); return true;
    case SLAVE_WRITTEN:
        config_write_on_written(self, event);
        return event->index == REQUEST_NMT; /* MANAGER_NMT_REQUEST tells that */
    case MANAGER_NODE_ID_TAKEN:
    case PROTO_GUARD_TOGGLE: return !is_power_of_2(event->actual); /* told ever more rarely */
    default: return is_of_device(event->type);
    }
}

/* What inner machines tell, as the owner gets it. */
static uint16_t outer_type(uint16_t type)
{
    static const uint16_t types[][2] = { { PROTO_GUARD_TOGGLE, MANAGER_NODE_TOGGLE },
                                         { SLAVE_SYNC_MISSING, MANAGER_SYNC_MISSING },
                                         { SLAVE_EMERGENCY, MANAGER_EMCY },
                                         { SLAVE_WRITTEN, MANAGER_WRITTEN },
                                         { SLAVE_STATE, MANAGER_STATE } };

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (types[i][0] == type)
            return types[i][1];
    return type;
}

static struct co_event translate(const struct manager *self, const struct co_event *event)
{
    struct co_event outer = *event;

    outer.type = outer_type(event->type);
    if (event->type == SLAVE_STATE)
        outer.node = self->config->manager_node_id;
    return outer;
}

static void tell_dropped(struct manager *self, struct co_outbox *out)
{
    struct co_event event = { .type = MANAGER_DROPPED,
                              .actual = self->dropped - self->dropped_told };

    if (self->dropped == self->dropped_told || !co_outbox_room(out, 0, 1))
        return;
    self->dropped_told = self->dropped;
    co_outbox_put_event(out, &event);
}

static co_us_t node_deadline(const struct manager *self, unsigned node)
{
    co_us_t deadline = sdo_client_deadline(&self->channels[node].client);

    if (self->nodes[node].config)
        deadline = co_earlier(deadline, boot_node_deadline(&self->nodes[node]));
    return deadline;
}

static void follow_deadlines(struct manager *self)
{
    CO_SET_EACH(&self->moved, node)
    co_deadlines_set(&self->deadlines, node, node_deadline(self, node));
    self->moved = (struct co_set){ { 0 } };
}

/* Moves frames and events out, in order, until nothing is left or there is no room. */
static void settle(struct manager *self, co_us_t now, struct co_outbox *out)
{
    struct co_frame frame;
    struct co_event event;

    for (;;) {
        while (co_outbox_room(out, 1, 0) && co_outbox_take_frame(&self->inner, &frame))
            co_outbox_put_frame(out, &frame);
        if (!co_outbox_room(out, 0, 1) || !co_outbox_take_event(&self->inner, &event))
            break;
        if (consume(self, &event, now)) {
            boot_network_check(self, now);
        } else {
            struct co_event outer = translate(self, &event);

            co_outbox_put_event(out, &outer);
        }
    }
    tell_dropped(self, out);
    follow_deadlines(self);
}

/* --- frames --- */

static bool is_in_range(const struct co_frame *frame, uint32_t base)
{
    return frame->id > base && frame->id <= base + NETWORK_NODE_MAX &&
           !(frame->flags & (CO_FRAME_EXT | CO_FRAME_RTR));
}

/* Devices of the third edition of CiA 301 start up with an emergency without data. */
static void on_old_boot_up(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    const struct co_frame boot_up = nmt_error_control_frame(frame->id & 0x7Fu, NMT_INITIALISING);

    error_control_on_frame(self, &boot_up, now);
}

static void on_emergency(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    struct co_event event;

    if (frame->dlc == 0)
        on_old_boot_up(self, frame, now);
    if (!emcy_parse(frame, &event))
        return;
    if (!self->nodes[event.node].config && !self->config->preset_emergency_consumer)
        return;
    event.type = MANAGER_EMCY;
    co_outbox_put_event(&self->inner, &event);
}

/* Another master on the bus: not ours to forbid, but to know and to tell. */
static void on_foreign_command(struct manager *self, const struct co_frame *frame)
{
    uint8_t target = frame->data[1];
    struct co_event event = { .type = MANAGER_SECOND_MASTER, .node = target };
    enum nmt_command command;

    if (!nmt_command_for(frame, target, &command))
        return;
    event.detail = (uint8_t)command;
    co_outbox_put_event(&self->inner, &event);
    FOR_EACH_NODE(self, node) {
        if (target == NMT_ALL_NODES || target == node->config->node_id)
            boot_node_commanded(node, command);
    }
}

/*
 * A start command has got on the wire behind the news that its node has restarted: the node is
 * operational without its configuration.
 */
static void on_started(struct manager *self, struct boot_node *node, co_us_t now)
{
    if (boot_node_is_in_mid_boot(node))
        boot_network_reset_node(self, node, boot_node_reset_command(node), now);
}

static void on_own_command(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    uint8_t target = frame->data[1];

    if (frame->id != NMT_CAN_ID || frame->data[0] != NMT_START)
        return;
    if (target != NMT_ALL_NODES && target <= NETWORK_NODE_MAX) {
        on_started(self, &self->nodes[target], now);
        return;
    }
    FOR_EACH_NODE(self, node)
        on_started(self, node, now);
}

bool manager_awaits_wire(const struct manager *self)
{
    for (uint8_t node = 1; node <= NETWORK_NODE_MAX; node++)
        if (sdo_client_awaits_wire(&self->channels[node].client))
            return true;
    return false;
}

void manager_on_handed_over(struct manager *self, co_us_t now)
{
    for (uint8_t node = 1; node <= NETWORK_NODE_MAX && self->inner.frame_count == 0; node++) {
        sdo_client_on_handed_over(&self->channels[node].client, now);
        manager_touch(self, node);
    }
    follow_deadlines(self);
}

/* On a slow bus requests queue for seconds; none of them is stuck as long as one gets through. */
void manager_on_progress(struct manager *self, co_us_t now)
{
    self->progress = now; /* run_node() tells those that need to know */
}

static void on_own_frame(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    if (is_in_range(frame, SDO_REQUEST_ID)) {
        manager_touch(self, frame->id & 0x7Fu);
        manager_on_progress(self, now);
        sdo_client_on_frame(&self->channels[frame->id & 0x7Fu].client, frame, now, &self->inner);
    } else {
        on_own_command(self, frame, now);
    }
}

static void dispatch(struct manager *self, const struct co_frame *frame, co_us_t now)
{
    uint8_t node = frame->id & 0x7Fu;
    bool own = (frame->flags & CO_FRAME_OWN) != 0;

    manager_touch(self, node);
    if (is_in_range(frame, SDO_RESPONSE_ID)) /* also of the own device */
        sdo_client_on_frame(&self->channels[node].client, frame, now, &self->inner);
    else if (own)
        on_own_frame(self, frame, now);
    else if (is_in_range(frame, NMT_ERROR_CONTROL_ID))
        error_control_on_frame(self, frame, now);
    else if (is_in_range(frame, EMCY_CAN_ID))
        on_emergency(self, frame, now);
    else if (frame->id == NMT_CAN_ID && frame->flags == 0 && frame->dlc == 2 &&
             self->config->nmt_master)
        on_foreign_command(self, frame);
}

/* The application may ask for the manager's own dictionary: the device hears that as well. */
static struct co_frame for_device(struct manager *self, const struct co_frame *frame)
{
    struct co_frame heard = *frame;

    if (frame->id == SDO_REQUEST_ID + self->config->manager_node_id) {
        heard.flags &= (uint8_t)~CO_FRAME_OWN;
        nmt_request_refresh(self, frame);
    }
    return heard;
}

void manager_on_frame(struct manager *self, const struct co_frame *frame, co_us_t now,
                      struct co_outbox *out)
{
    struct co_frame heard = for_device(self, frame);

    settle(self, now, out);
    if (!co_outbox_room(&self->inner, 0, EVENT_ROOM)) {
        self->dropped++; /* the owner has not drained us for hundreds of events */
        return;
    }
    if (self->bus_lost)
        return;                                               /* from before */
    if (frame->id != NMT_CAN_ID || !self->config->nmt_master) /* nobody commands the master */
        slave_on_frame(&self->device, &heard, now, &self->inner);
    dispatch(self, frame, now);
    boot_network_check(self, now);
    settle(self, now, out);
}

/* --- orders --- */

void manager_start(struct manager *self, co_us_t now, struct co_outbox *out)
{
    slave_start(&self->device, now, &self->inner);
    if (self->config->nmt_master)
        boot_network_start(self, now);
    else if (self->config->auto_operational)
        slave_command(&self->device, NMT_START, now, &self->inner);
    settle(self, now, out);
}

enum co_err manager_command(struct manager *self, enum nmt_command command, uint8_t node,
                            co_us_t now, struct co_outbox *out)
{
    enum co_err err = command_execute(self, command, node, now);

    boot_network_check(self, now);
    settle(self, now, out);
    return err;
}

static void put_request_done(struct manager *self, uint8_t node)
{
    struct co_event done = { .type = MANAGER_REQUEST_DONE, .node = node };

    if (co_outbox_room(&self->inner, 0, 1)) /* it only wakes who waits: one of many will do */
        co_outbox_put_event(&self->inner, &done);
}

void manager_submit(struct manager *self, uint8_t node, struct sdo_request *request, co_us_t now,
                    struct co_outbox *out)
{
    if (self->shut)
        return;
    manager_touch(self, node);
    if (self->bus_lost) {
        sdo_request_give_up(request, node);
        put_request_done(self, node);
    } else {
        sdo_channel_submit(&self->channels[node], request, now, &self->inner);
    }
    settle(self, now, out);
}

void manager_shut(struct manager *self, co_us_t now, struct co_outbox *out)
{
    self->shut = true;
    for (uint8_t node = 1; node <= NETWORK_NODE_MAX; node++) {
        manager_touch(self, node);
        sdo_channel_clear(&self->channels[node], now, &self->inner);
    }
    settle(self, now, out);
}

void manager_cancel(struct manager *self, uint8_t node, struct sdo_request *request, co_us_t now,
                    struct co_outbox *out)
{
    struct sdo_channel *channel = &self->channels[node];

    if (request->state != REQUEST_QUEUED && request->state != REQUEST_RUNNING)
        return;
    manager_touch(self, node);
    if (!sdo_channel_cancel(channel, request, SDO_TIMEOUT, now, &self->inner))
        sdo_channel_cancel(channel, request, SDO_OK, now, &self->inner);
    settle(self, now, out);
}

/* --- the connection to the bus --- */

static void lose_bus(struct manager *self, co_us_t now)
{
    if (self->config->nmt_master)
        boot_network_suspend(self, now);
    for (uint8_t node = 1; node <= NETWORK_NODE_MAX; node++) {
        manager_touch(self, node);
        while (sdo_channel_give_up(&self->channels[node]))
            put_request_done(self, node);
    }
}

void manager_on_bus(struct manager *self, bool up, co_us_t now, struct co_outbox *out)
{
    settle(self, now, out);
    if (self->bus_lost != up)
        return;
    self->bus_lost = !up;
    if (!up)
        lose_bus(self, now);
    else if (self->config->nmt_master)
        boot_network_resume(self, now);
    settle(self, now, out);
}

bool manager_is_up(const struct manager *self, bool all)
{
    if (!self->config->nmt_master)
        return self->device.state == NMT_OPERATIONAL;
    if (self->state != NETWORK_OPERATIONAL && self->state != NETWORK_WAITING)
        return false;
    LOOK_AT_EACH_NODE(self, node)
    {
        if ((all || node->config->mandatory) && !boot_network_is_node_up(self, node))
            return false;
    }
    return true;
}

/* --- time --- */

static void run_node(struct manager *self, uint8_t node, co_us_t now)
{
    manager_touch(self, node);
    sdo_client_on_progress(&self->channels[node].client, self->progress);
    sdo_client_on_time(&self->channels[node].client, now, &self->inner);
    if (self->nodes[node].config)
        boot_node_on_time(&self->nodes[node], now, &self->inner);
}

void manager_on_time(struct manager *self, co_us_t now, struct co_outbox *out)
{
    settle(self, now, out);
    if (!co_outbox_room(&self->inner, 0, EVENT_ROOM))
        return;
    slave_on_time(&self->device, now, &self->inner);
    for (unsigned node = co_deadlines_due(&self->deadlines, 0, now); node <= NETWORK_NODE_MAX;
         node = co_deadlines_due(&self->deadlines, node + 1, now))
        run_node(self, (uint8_t)node, now);
    boot_network_on_time(self, now);
    boot_network_check(self, now);
    settle(self, now, out);
}

co_us_t manager_deadline(const struct manager *self)
{
    co_us_t deadline = co_earlier(slave_deadline(&self->device), boot_network_deadline(self));

    if (self->inner.frame_count > 0 || self->inner.event_count > 0)
        return 0;
    return co_earlier(deadline, co_deadlines_first(&self->deadlines));
}

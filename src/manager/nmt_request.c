#include "manager/nmt_request.h"

#include "base/bytes.h"
#include "manager/boot_network.h"
#include "manager/manager_od.h"

#define STATE_UNKNOWN 0x00u /* of 1F82h, where the others are those of enum nmt_state */
#define STATE_MISSING 0x01u

/* What one write of 1F82h may put in front of its answer, and the answer. */
#define ROOM_FRAMES 4u
#define ROOM_EVENTS 4u

/* --- read --- */

static uint8_t state_of(const struct manager *self, uint8_t node_id)
{
    const struct boot_node *node = &self->nodes[node_id];

    if (node_id == self->config->manager_node_id)
        return self->device.state;
    if (!node->config)
        return STATE_UNKNOWN;
    if (node->nmt_state != NMT_INITIALISING)
        return node->nmt_state;
    return node->lost || (node->absent && node->tried) ? STATE_MISSING : STATE_UNKNOWN;
}

static bool is_guarded(const struct manager *self, uint8_t node_id)
{
    const struct guard_master *guard = &self->nodes[node_id].supervision.guard;

    return guard->period != 0 && !guard->once;
}

void nmt_request_refresh(struct manager *self, const struct co_frame *request)
{
    const uint16_t index = (uint16_t)get_le(request->data + 1, 2);
    const uint8_t node_id = request->data[3];

    if (index != REQUEST_NMT && index != REQUEST_GUARDING)
        manager_od_refresh(self->config, &self->od, index, node_id);
    else if (node_id >= 1 && node_id <= NETWORK_NODE_MAX)
        od_set_number(&self->od, index, node_id,
                      index == REQUEST_NMT ? state_of(self, node_id) : is_guarded(self, node_id));
}

/* --- write --- */

static bool parse_command(uint8_t value, enum nmt_command *ret_command)
{
    static const struct {
        uint8_t value;
        enum nmt_command command;
    } commands[] = { { 0x04, NMT_STOP },
                     { 0x05, NMT_START },
                     { 0x06, NMT_RESET_NODE },
                     { 0x07, NMT_RESET_COMMUNICATION },
                     { 0x7F, NMT_ENTER_PREOPERATIONAL } };

    for (size_t i = 0; i < sizeof commands / sizeof commands[0]; i++) {
        if (commands[i].value != value)
            continue;
        *ret_command = commands[i].command;
        return true;
    }
    return false;
}

static sdo_abort_t execute(struct manager *self, enum nmt_command command, uint8_t node,
                           co_us_t now)
{
    const struct co_event event = { .type = MANAGER_NMT_REQUEST,
                                    .node = node,
                                    .detail = (uint8_t)command };
    const enum co_err err = command_execute(self, command, node, now);

    if (err != CO_OK)
        return err == CO_ERR_NOT_FOUND ? SDO_INVALID_VALUE : SDO_DEVICE_STATE;
    co_outbox_put_event(&self->inner, &event);
    return SDO_OK;
}

/* A reset of the manager, or its stop, ends the transfer: that is answered before it is done. */
static bool ends_transfer(const struct manager *self, enum nmt_command command, uint8_t node)
{
    const bool is_reset = command == NMT_RESET_NODE || command == NMT_RESET_COMMUNICATION;

    if (node == self->config->manager_node_id)
        return is_reset || command == NMT_STOP;
    return is_reset && node == NMT_ALL_NODES;
}

void nmt_request_on_write(struct manager *self, const struct co_event *event, co_us_t now)
{
    const struct slave_transfer transfer = { event->detail, event->code };
    const uint8_t node = event->sub == REQUEST_ALL_NODES ? NMT_ALL_NODES : event->sub;
    sdo_abort_t code = SDO_OK;
    enum nmt_command command = NMT_START;

    /* What cannot be answered is not done: the client hears of it when its time is over. */
    if (!slave_waits_for(&self->device, transfer) ||
        !co_outbox_room(&self->inner, ROOM_FRAMES, ROOM_EVENTS))
        return;
    if (!self->config->nmt_master)
        code = SDO_LOCAL_CONTROL;
    else if (!parse_command(slave_received(&self->device, transfer)[0], &command))
        code = SDO_INVALID_VALUE;
    else if (!ends_transfer(self, command, node))
        code = execute(self, command, node, now);
    else if (!command_self_is_allowed(self, command))
        code = SDO_DEVICE_STATE;
    slave_verdict(&self->device, transfer, code, now, &self->inner);
    if (code == SDO_OK && ends_transfer(self, command, node))
        execute(self, command, node, now);
}

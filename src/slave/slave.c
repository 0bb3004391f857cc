#include "slave/slave.h"

#include "proto/event.h"
#include "slave/slave_internal.h"

#include <stdlib.h>

#define IS_NMT_MASTER  0x01u /* bits of 1F80h */
#define DOES_NOT_START 0x04u

bool slave_is_on(const struct slave *self)
{
    return self->state != NMT_INITIALISING;
}

static void put_state_event(struct slave *self, struct co_outbox *out)
{
    const struct co_event event = { .type = SLAVE_STATE,
                                    .node = self->node,
                                    .detail = self->state,
                                    .sub = self->boot_up_due ? self->reset_by : 0 };

    co_outbox_put_event(out, &event);
    self->told_state = self->state;
}

static void tell_state(struct slave *self, struct co_outbox *out)
{
    if (self->state != self->told_state && slave_is_on(self) && co_outbox_room(out, 0, 1))
        put_state_event(self, out);
}

void slave_enter_state(struct slave *self, enum nmt_state state, co_us_t now, struct co_outbox *out)
{
    const bool services = state == NMT_PREOPERATIONAL || state == NMT_OPERATIONAL;

    self->state = (uint8_t)state;
    self->heartbeat.state = (uint8_t)state;
    self->guard.state = (uint8_t)state;
    slave_enable_channels(self, services);
    slave_enable_emcy(self);
    slave_enable_sync(self, services);
    self->time.enabled = services;
    tell_state(self, out);
    slave_run_pdos(self, state == NMT_OPERATIONAL, now, out);
}

/* Devices with 1F80h that are not told otherwise go on to operational by themselves. */
static bool starts_itself(const struct slave *self)
{
    return (od_number(self->od, 0x1F80, 0, DOES_NOT_START) & (IS_NMT_MASTER | DOES_NOT_START)) == 0;
}

static void finish_boot_up(struct slave *self, co_us_t now, struct co_outbox *out)
{
    const struct co_frame frame = nmt_error_control_frame(self->node, NMT_INITIALISING);

    if (!self->boot_up_due || !co_outbox_room(out, 1, 2))
        return;
    put_state_event(self, out);
    self->boot_up_due = false;
    co_outbox_put_frame(out, &frame);
    hb_producer_start(&self->heartbeat, slave_heartbeat_period(self), false, now);
    slave_enter_state(self, NMT_PREOPERATIONAL, now, out);
    if (starts_itself(self))
        slave_enter_state(self, NMT_OPERATIONAL, now, out);
}

/* With what the dictionary says now. */
static void boot_up(struct slave *self, co_us_t now, struct co_outbox *out)
{
    slave_enter_state(self, NMT_INITIALISING, now, out);
    hb_producer_start(&self->heartbeat, 0, false, now);
    slave_reset_errors(self);
    slave_reset_consumers(self);
    slave_reset_guarding(self);
    slave_configure_channels(self);
    slave_reset_pdos(self, now);
    slave_configure_sync(self);
    slave_configure_time(self);
    slave_configure_hearing(self);
    slave_watch_consumers(self, now, out); /* that no one is watched any more */
    slave_watch_guarding(self, now, out);
    self->boot_up_due = true;
    finish_boot_up(self, now, out);
}

/* command: NMT_RESET_NODE, NMT_RESET_COMMUNICATION. */
static void reset(struct slave *self, enum nmt_command command, co_us_t now, struct co_outbox *out)
{
    self->reset_by = (uint8_t)command;
    slave_reset_objects(self, command == NMT_RESET_NODE);
    boot_up(self, now, out);
}

static enum co_err add_missing_objects(struct od *od)
{
    static const struct {
        uint16_t index;
        uint8_t sub, type, value;
    } objects[] = { { 0x1000, 0, OD_UNSIGNED32, 0 },
                    { 0x1001, 0, OD_UNSIGNED8, 0 },
                    { 0x1018, 0, OD_UNSIGNED8, 1 },
                    { 0x1018, 1, OD_UNSIGNED32, 0 } };

    for (size_t i = 0; i < sizeof objects / sizeof objects[0]; i++) {
        const enum co_err err = od_add_number(od, objects[i].index, objects[i].sub, objects[i].type,
                                              OD_RO, objects[i].value);

        if (err != CO_OK && err != CO_ERR_EXISTS)
            return err;
    }
    return CO_OK;
}

/* The signatures have a rule of their own; limits of real EDS files give another abort code. */
static void drop_signature_limits(struct od *od)
{
    for (size_t i = 0; i < od->count; i++)
        if (od->entries[i]->index == 0x1010 || od->entries[i]->index == 0x1011) {
            od->entries[i]->has_low = false;
            od->entries[i]->has_high = false;
        }
}

enum co_err slave_init(struct slave *self, uint8_t node, struct od *od)
{
    enum co_err err;

    if (node < 1 || node > NMT_NODE_MAX)
        return CO_ERR_ARG;
    *self = (struct slave){ .node = node, .od = od, .consumer_deadline = CO_NEVER };
    sync_producer_init(&self->sync);
    err = add_missing_objects(od);
    if (err != CO_OK)
        return err;
    drop_signature_limits(od);
    if (slave_make_channels(self) != CO_OK || slave_make_consumers(self) != CO_OK ||
        slave_make_hearing(self) != CO_OK || slave_make_pdos(self) != CO_OK) {
        slave_done(self);
        return CO_ERR_MEMORY;
    }
    hb_producer_init(&self->heartbeat, node);
    guard_slave_init(&self->guard, node);
    emcy_producer_init(&self->emcy, COB_ID_INVALID);
    return CO_OK;
}

void slave_done(struct slave *self)
{
    slave_execute_loads(self);
    slave_free_pdos(self);
    slave_free_channels(self);
    free(self->consumers);
    free(self->heard);
    self->consumers = NULL;
    self->heard = NULL;
}

void slave_start(struct slave *self, co_us_t now, struct co_outbox *out)
{
    slave_reset_objects(self, true);
    slave_switch_on(self, now, out);
}

void slave_switch_on(struct slave *self, co_us_t now, struct co_outbox *out)
{
    self->reset_by = 0;
    boot_up(self, now, out);
}

void slave_command(struct slave *self, enum nmt_command command, co_us_t now, struct co_outbox *out)
{
    const enum nmt_state next = nmt_next_state((enum nmt_state)self->state, command);
    const bool is_reset = command == NMT_RESET_NODE || command == NMT_RESET_COMMUNICATION;

    if (is_reset && (slave_is_on(self) || self->boot_up_due))
        reset(self, command, now, out);
    else if (!is_reset && next != self->state)
        slave_enter_state(self, next, now, out);
}

static void on_error_control(struct slave *self, const struct co_frame *frame, co_us_t now,
                             struct co_outbox *out)
{
    if ((frame->flags & CO_FRAME_RTR) == 0)
        slave_consume_heartbeat(self, frame, now, out);
    else if (frame->id == NMT_ERROR_CONTROL_ID + self->node)
        slave_answer_guarding(self, frame, now, out);
}

/* Frames of NMT, error control and SDO; false for others. */
static bool on_service_frame(struct slave *self, const struct co_frame *frame, co_us_t now,
                             struct co_outbox *out)
{
    struct slave_channel *const channel = slave_channel_of(self, frame->id);
    enum nmt_command command;

    if (frame->id == NMT_CAN_ID) {
        if (nmt_command_for(frame, self->node, &command))
            slave_command(self, command, now, out);
    } else if (channel != NULL) {
        slave_serve(self, channel, frame, now, out);
    } else if ((frame->id & 0x780u) == NMT_ERROR_CONTROL_ID) {
        if (slave_is_on(self))
            on_error_control(self, frame, now, out);
    } else {
        return false;
    }
    return true;
}

void slave_on_frame(struct slave *self, const struct co_frame *frame, co_us_t now,
                    struct co_outbox *out)
{
    const bool own = (frame->flags & CO_FRAME_OWN) != 0;

    slave_step_pdos(self, now, out);
    if (own || (frame->flags & CO_FRAME_EXT) != 0 || !on_service_frame(self, frame, now, out))
        if (own || !(slave_hear_sync(self, frame, now, out) || slave_hear_time(self, frame, out))) {
            slave_hear_emcy(self, frame, now, out);
            slave_hear_pdo(self, frame, now, out);
        }
}

void slave_on_time(struct slave *self, co_us_t now, struct co_outbox *out)
{
    slave_step_pdos(self, now, out);
    finish_boot_up(self, now, out);
    tell_state(self, out);
    slave_step_sync(self, now, out);
    hb_producer_on_time(&self->heartbeat, now, out);
    slave_watch_consumers(self, now, out);
    slave_watch_guarding(self, now, out);
    slave_step_bus(self, now, out);
    slave_step_emcy(self, now, out);
    slave_step_sdo(self, now, out);
}

co_us_t slave_deadline(const struct slave *self)
{
    co_us_t deadline = co_earlier(hb_producer_deadline(&self->heartbeat),
                                  slave_emcy_deadline(self));

    if (self->boot_up_due || self->consumers_due || self->state != self->told_state)
        return 0;
    deadline = co_earlier(deadline, slave_sdo_deadline(self));
    deadline = co_earlier(deadline, slave_sync_deadline(self));
    deadline = co_earlier(deadline, slave_pdo_deadline(self));
    deadline = co_earlier(deadline, slave_guarding_deadline(self));
    deadline = co_earlier(deadline, slave_bus_deadline(self));
    return co_earlier(deadline, self->consumer_deadline);
}

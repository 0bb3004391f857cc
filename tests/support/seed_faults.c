#include "support/seed.h"

#include "base/bytes.h"
#include "support/watch.h"

#include <stdio.h>
#include <string.h>

#define OFF_MAX_MS 3000u

static struct plant_device *device_of(const struct seed *self, const struct seed_node *node)
{
    return self->plant->devices[node->id];
}

static bool is_played(const struct seed *self, const struct seed_node *node)
{
    return seed_is_permanent(node->fault) || self->faulty;
}

/* The node that the frame comes from, or goes to, when its CAN-ID is one of these; else NULL. */
static struct seed_node *node_of(struct seed *self, const struct co_frame *frame, uint32_t base)
{
    const uint32_t node = frame->id - base;

    return frame->id > base && node <= self->node_count ? &self->nodes[node] : NULL;
}

/* --- what a device does otherwise than others --- */

static void reset(struct seed *self, struct seed_node *node)
{
    struct plant_device *device = device_of(self, node);

    if (!device->sim->active || !co_outbox_room(&device->sim->box, 2, 4))
        return;
    slave_command(&device->slave, NMT_RESET_NODE, self->plant->sim.now, &device->sim->box);
    sim_touch(&self->plant->sim, device->sim);
}

static void refuse(struct seed *self, const struct seed_node *node)
{
    struct co_frame frame = co_frame_make(SDO_RESPONSE_ID + node->id, 8);

    frame.data[0] = 0x80;
    put_le16(frame.data + 1, node->index);
    frame.data[3] = node->sub;
    put_le32(frame.data + 4, node->code);
    sim_put(&self->plant->sim, &frame);
}

static bool asks_for(const struct seed_node *node, const struct co_frame *frame)
{
    const unsigned command = frame->data[0] >> 5;
    const bool writes = command == 1 || command == 6, reads = command == 2;

    if (get_le16(frame->data + 1) != node->index || frame->data[3] != node->sub)
        return false;
    return node->index == 0x6200 ? writes : reads;
}

/* True if the device does not hear what is asked of it, and for which it has been waiting. */
static bool strike_at_request(struct seed *self, struct seed_node *node)
{
    switch (node->fault) {
    case SEED_RESETS: reset(self, node); return true;
    case SEED_REFUSES:
    case SEED_NO_IDENTITY:
    case SEED_NO_SOFTWARE: refuse(self, node); return true;
    case SEED_BUSY:
        if (node->strikes == 0)
            return false;
        node->strikes--;
        refuse(self, node);
        return true;
    default: return false;
    }
}

static bool on_request(struct seed *self, struct seed_node *node, const struct co_frame *frame)
{
    struct plant_device *device = device_of(self, node);

    if (!device->sim->active || device->sim->unplugged)
        return false;
    if (node->fault == SEED_LATE && device->sim->hold_until <= self->plant->sim.now)
        device->sim->hold_until = self->plant->sim.now + CO_MS(node->late_ms);
    return asks_for(node, frame) && strike_at_request(self, node);
}

/* True if nobody hears it. */
static bool on_answer(struct seed *self, struct seed_node *node)
{
    if (node->fault == SEED_MUTE)
        return true;
    if (++node->answers != node->at)
        return false;
    if (node->fault == SEED_HANGS)
        plant_power(self->plant, node->id, false);
    else if (node->fault == SEED_RESETS_ONCE)
        reset(self, node);
    return node->fault == SEED_HANGS || node->fault == SEED_RESETS_ONCE;
}

static bool on_life_sign(const struct seed_node *node, const struct co_frame *frame)
{
    return (node->fault == SEED_NO_HEARTBEAT || node->fault == SEED_NO_STATE) &&
           !(frame->flags & CO_FRAME_RTR) && frame->data[0] != NMT_INITIALISING;
}

/* True if its fault keeps the frame from being heard. */
static bool play(struct seed *self, const struct co_frame *frame)
{
    struct seed_node *to = node_of(self, frame, SDO_REQUEST_ID);
    struct seed_node *from = node_of(self, frame, SDO_RESPONSE_ID);
    struct seed_node *alive = node_of(self, frame, NMT_ERROR_CONTROL_ID);

    if (to && is_played(self, to))
        return on_request(self, to, frame);
    if (from && is_played(self, from))
        return on_answer(self, from);
    return alive && is_played(self, alive) && on_life_sign(alive, frame);
}

/* --- frames that get lost --- */

/* What nobody could notice is not lost: CAN repeats what was not heard. */
static bool may_be_lost(struct seed *self, const struct co_frame *frame)
{
    const struct seed_node *alive = node_of(self, frame, NMT_ERROR_CONTROL_ID);

    if (frame->id == NMT_CAN_ID)
        return false;
    if (alive) /* nor a restart between two writes */
        return alive->beats && !boot_node_is_in_mid_boot(plant_node(self->plant, alive->id));
    return true;
}

static bool is_lost(struct seed *self, const struct co_frame *frame)
{
    struct seed_node *node;

    if (!self->faulty || !self->has[SEED_LOSS] || !may_be_lost(self, frame) ||
        !seed_one_in(self, self->loss))
        return false;
    node = node_of(self, frame, frame->id & ~UINT32_C(0x7F));
    if (node)
        node->hit = true;
    return true;
}

static enum sim_fate on_frame(struct plant *plant, const struct co_frame *frame, uint8_t sender)
{
    struct seed *self = plant->fault_context;
    struct seed_node *to = node_of(self, frame, SDO_REQUEST_ID);

    (void)sender;
    if (is_lost(self, frame))
        return seed_one_in(self, 2) ? SIM_LOSE : SIM_UNHEARD;
    if (play(self, frame))
        return SIM_UNHEARD;
    if (to && to->loader && device_of(self, to)->sim->active)
        loader_hear(to->loader, frame);
    return SIM_DELIVER;
}

void seed_play_faults(struct seed *self)
{
    self->plant->fault = on_frame;
    for (unsigned id = 1; id <= self->node_count; id++)
        if (self->nodes[id].fault == SEED_OFF)
            plant_power(self->plant, (uint8_t)id, false);
}

/* --- what happens as time goes on --- */

static co_us_t time_of(const struct seed *self)
{
    return self->plant->sim.now - CO_MS(1000); /* a plant begins with that */
}

static void bring_back(struct seed *self, struct seed_node *node)
{
    struct plant_device *device = device_of(self, node);

    node->back_at = 0;
    device->sim->unplugged = false;
    if (!device->sim->active)
        plant_power(self->plant, node->id, true);
}

static void take_away(struct seed *self, struct seed_node *node)
{
    const co_us_t now = time_of(self);

    node->strikes--;
    node->back_at = now + CO_MS(1 + seed_below(self, OFF_MAX_MS));
    node->at_time = node->back_at + CO_MS(seed_below(self, 5000));
    if (node->fault == SEED_CABLE)
        device_of(self, node)->sim->unplugged = true;
    else
        plant_power(self->plant, node->id, false);
}

static void trouble_node(struct seed *self, struct seed_node *node)
{
    const co_us_t now = time_of(self);
    const bool is_due = node->back_at == 0 && node->at_time <= now && node->strikes > 0;

    if (node->loader)
        loader_step(node->loader);
    if (node->back_at != 0 && node->back_at <= now)
        bring_back(self, node);
    else if (is_due && self->faulty && (node->fault == SEED_POWER || node->fault == SEED_CABLE))
        take_away(self, node);
    else if (is_due && node->fault == SEED_DIES) {
        node->strikes = 0;
        plant_power(self->plant, node->id, false);
    }
}

static void trouble_manager(struct seed *self)
{
    const co_us_t now = time_of(self);
    const bool is_on = self->plant->manager_device->active;

    if (!self->has[SEED_MANAGER])
        return;
    if (is_on && now >= self->manager_off && now < self->manager_on) {
        plant_power_manager(self->plant, false);
        seed_forget_requests(self);
    } else if (!is_on && now >= self->manager_on) {
        plant_power_manager(self->plant, true);
    }
}

static void trouble(struct seed *self)
{
    trouble_manager(self);
    for (unsigned id = 1; id <= self->node_count; id++)
        trouble_node(self, &self->nodes[id]);
}

static void end_faults(struct seed *self)
{
    self->faulty = false;
    for (unsigned id = 1; id <= self->node_count; id++) {
        struct seed_node *node = &self->nodes[id];

        if (node->back_at != 0)
            bring_back(self, node);
        if (node->fault == SEED_LATE)
            device_of(self, node)->sim->hold_until = 0;
    }
}

/* --- its life --- */

static void run_ms(struct seed *self, unsigned ms, unsigned step)
{
    for (unsigned i = 0; i < ms / step; i++) {
        trouble(self);
        seed_apply(self);
        plant_run_ms(self->plant, step);
    }
}

/*
 * What the application has to start, or has stopped, only it starts. The first order may only let a
 * boot go on that was stopped, and that waits for another one then.
 */
static void start_all(struct seed *self)
{
    for (unsigned i = 0; i < 2; i++) {
        plant_command(self->plant, NMT_START, self->plant->config->manager_node_id);
        run_ms(self, 5000, 10);
    }
    for (unsigned id = 1; id <= self->node_count; id++)
        plant_command(self->plant, NMT_START, (uint8_t)id);
    run_ms(self, 1000, 10);
}

void seed_run(struct seed *self)
{
    run_ms(self, SEED_FAULTY_MS, 5);
    end_faults(self);
    run_ms(self, SEED_SETTLED_MS, 20);
    if (self->needs_start)
        start_all(self);
    plant_run_ms(self->plant, 12000); /* requests end */
}

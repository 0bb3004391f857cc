#include "mcanopen_sim_gate.h"

#include "port/clock.h"
#include "proto/nmt.h"
#include "proto/sdo_client.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BUS_NAME_LENGTH 12 /* of the outer name, in that of the bus inside */

enum { DOWNLOAD_SEGMENT, DOWNLOAD, UPLOAD, UPLOAD_SEGMENT, ABORT, BLOCK_UPLOAD, BLOCK_DOWNLOAD };

/* --- what the defects see of the device --- */

static bool is_sdo(const struct co_frame *frame, uint32_t base, uint8_t node)
{
    return frame->id == base + node && frame->flags == 0 && frame->dlc == 8;
}

static void view_request(struct sim_device_view *self, const struct co_frame *frame)
{
    const unsigned kind = frame->data[0] >> 5;

    if (!is_sdo(frame, SDO_REQUEST_ID, self->node))
        return;
    self->request = *frame;
    self->block_segment = self->block_left > 0 && frame->data[0] != ABORT << 5;
    if (self->block_segment) {
        self->block_left--;
        self->block_seqno = frame->data[0] & 0x7F;
        self->block_last = (frame->data[0] & 0x80) != 0;
        if (self->block_last)
            self->block_left = 0;
        return;
    }
    self->block_left = 0;
    if (kind == DOWNLOAD || kind == UPLOAD || kind == BLOCK_DOWNLOAD || kind == BLOCK_UPLOAD) {
        self->initiate = *frame;
        self->block_last = false;
    }
}

static void view_response(struct sim_device_view *self, const struct co_frame *frame)
{
    if (!is_sdo(frame, SDO_RESPONSE_ID, self->node) || self->request.data[0] >> 5 == BLOCK_UPLOAD)
        return;
    if ((frame->data[0] & 0xFB) == 0xA0 && !self->block_last)
        self->block_left = frame->data[4];
    if (frame->data[0] == 0xA2 && !(self->block_last && frame->data[1] == self->block_seqno))
        self->block_left = frame->data[2];
}

static void view_command(struct sim_device_view *self, const struct co_frame *frame)
{
    enum nmt_command command;

    if (frame->id != NMT_CAN_ID || !nmt_command_for(frame, self->node, &command))
        return;
    self->state = (uint8_t)nmt_next_state((enum nmt_state)self->state, command);
    if (self->state == NMT_INITIALISING)
        self->state = NMT_PREOPERATIONAL;
}

/* --- the way of a frame --- */

static enum co_err send_frame(struct bus *to, const struct co_frame *frame)
{
    enum co_err err = bus_send(to, frame);

    while (err == CO_ERR_AGAIN) {
        usleep(1000);
        err = bus_send(to, frame);
    }
    return err;
}

void gate_to_bus(struct sim_gate *self, const struct co_frame *frame)
{
    send_frame(self->outside, frame);
}

void gate_to_device(struct sim_gate *self, const struct co_frame *frame)
{
    send_frame(self->inside, frame);
}

const struct sim_device_view *gate_view(const struct sim_gate *self)
{
    return &self->view;
}

static bool pass(struct sim_gate *self, bool out, struct co_frame *frame)
{
    bool passes = true;

    if (out)
        view_response(&self->view, frame);
    else
        view_request(&self->view, frame);
    for (unsigned i = 0; i < self->use_count && passes; i++) {
        struct defect_use *use = &self->uses[i];
        defect_alter *alter = out ? use->defect->from_device : use->defect->to_device;

        passes = !alter || alter(self, use, frame);
    }
    if (!out)
        view_command(&self->view, frame);
    return passes;
}

static enum co_err hand_on(const struct gate_way *way)
{
    struct bus_rx rx;
    enum co_err err = bus_receive(way->from, &rx);

    if (err == CO_OK && pass(way->gate, way->out, &rx.frame))
        err = send_frame(way->to, &rx.frame);
    return err;
}

static void *run(void *context)
{
    const struct gate_way *way = context;
    struct sim_gate *gate = way->gate;

    while (!atomic_load(&gate->ended)) {
        enum co_err err;

        lock_take(&gate->lock);
        err = hand_on(way);
        lock_give(&gate->lock);
        if (err == CO_ERR_AGAIN)
            err = bus_wait(way->from, CO_NEVER);
        if (err != CO_OK && err != CO_ERR_TIMEOUT)
            bus_wait(way->from, clock_now() + CO_MS(100)); /* the bus is down: later, perhaps */
    }
    return NULL;
}

/* --- opening --- */

bool sim_gate_add(struct sim_gate *self, const struct sim_defect *defect)
{
    if (self->use_count == DEFECTS_MAX)
        return false;
    self->uses[self->use_count++] = (struct defect_use){ .defect = defect };
    return true;
}

static struct bus *open_bus(const char *name)
{
    const struct bus_options options = { .own_frames = false };
    const struct bus_filter all = { .id = 0 };
    char message[512] = "";
    struct bus *bus = NULL;

    if (bus_open(name, &options, &bus, message, sizeof message) != CO_OK) {
        fprintf(stderr, "mcanopen sim: %s\n", message);
        return NULL;
    }
    bus_set_filters(bus, &all, 1);
    return bus;
}

static void name_inside(const char *bus, char *ret_inside)
{
    const char *colon = strchr(bus, ':');
    const char *name = colon ? colon + 1 : bus;
    const int length = (int)strcspn(name, "?");

    snprintf(ret_inside, GATE_NAME_SIZE, "virtual:%.*s-defect-%ld",
             length < BUS_NAME_LENGTH ? length : BUS_NAME_LENGTH, name, (long)getpid());
}

static bool start(struct sim_gate *self)
{
    self->in = (struct gate_way){ .gate = self, .from = self->outside, .to = self->inside };
    self->out = (struct gate_way){
        .gate = self, .from = self->inside, .to = self->outside, .out = true
    };
    return thread_start(&self->in.thread, "gate in", run, &self->in) == CO_OK &&
           thread_start(&self->out.thread, "gate out", run, &self->out) == CO_OK;
}

bool sim_gate_open(struct sim_gate *self, const char *bus, uint8_t node, char *ret_inside)
{
    self->view = (struct sim_device_view){ .node = node, .state = NMT_PREOPERATIONAL };
    if (lock_init(&self->lock) != CO_OK)
        return false;
    name_inside(bus, ret_inside);
    self->outside = open_bus(bus);
    self->inside = self->outside ? open_bus(ret_inside) : NULL;
    if (self->inside && start(self))
        return true;
    sim_gate_close(self);
    return false;
}

void sim_gate_close(struct sim_gate *self)
{
    atomic_store(&self->ended, true);
    if (self->outside)
        bus_wake(self->outside);
    if (self->inside)
        bus_wake(self->inside);
    thread_join(&self->in.thread);
    thread_join(&self->out.thread);
    if (self->outside)
        bus_close(self->outside);
    if (self->inside)
        bus_close(self->inside);
    lock_done(&self->lock);
}

/*
 * A whole network in virtual time: a manager and local devices on one simulated CAN wire.
 *
 *   in   devices, the bit rate, faults
 *   out  the trace of the wire; the manager's events
 *
 * The wire takes the worst-case time of each frame (CiA 301 frame with stuffing) and arbitrates by
 * CAN-ID. Nothing here depends on the machine's speed; the same run gives the same trace.
 */
#ifndef TEST_SUPPORT_SIM_H
#define TEST_SUPPORT_SIM_H

#include "base/deadlines.h"
#include "base/set.h"
#include "manager/manager.h"
#include "slave/slave.h"

#include <stdio.h>

#define SIM_DEVICES 128u
#define SIM_BOX     512u
#define SIM_IDS     2048u /* CAN-IDs of 11 bits */

/* What becomes of a frame on the wire. */
enum sim_fate {
    SIM_DELIVER,
    SIM_LOSE,   /* seen by nobody, its sender included */
    SIM_UNHEARD /* its sender believes it sent, nobody hears it */
};

struct sim_device {
    bool active;         /* powered; others neither send nor receive */
    bool unplugged;      /* it runs, but hears nothing, and what it sends is lost */
    struct slave *slave; /* neither this nor a manager: speaks for sim_say() */
    struct manager *manager;
    uint8_t node;
    co_us_t hold_until; /* sends nothing before */
    unsigned listens;   /* slave.listen_generation for which sim.hearers has it */
    struct co_outbox box;
    struct co_frame frames[SIM_BOX];
    struct co_event events[SIM_BOX];
};

struct sim_line {
    co_us_t time; /* end of the frame on the wire */
    uint8_t sender;
    struct co_frame frame;
};

struct sim {
    co_us_t now;
    unsigned long steps;
    unsigned bitrate; /* bit/s; 0: frames take no time */
    struct sim_device devices[SIM_DEVICES];
    unsigned device_count;
    /* By the number of a device, as far as sim_touch() knows. A frame reaches only those that it
     * concerns: that is the simulation's speed. */
    struct co_deadlines deadlines;
    struct co_set waiting;          /* have something to send */
    struct co_set hearers[SIM_IDS]; /* want to hear frames with this CAN-ID */
    struct co_set managers;         /* want to hear all */
    unsigned box_size;              /* of devices added from now on, at most SIM_BOX */
    struct sim_device *foreign;     /* who says what sim_say() says */
    int sending;                    /* device whose frame is on the wire, -1: idle */
    struct co_frame on_wire;
    co_us_t wire_free; /* end of the frame on the wire */
    co_us_t busy;      /* time the wire was busy */
    struct sim_line *trace;
    size_t trace_count, trace_room;
    /* Decides about each frame at its end. */
    enum sim_fate (*fault)(void *context, const struct co_frame *frame, uint8_t sender);
    void (*on_step)(void *context); /* after each step: the place to check what must always hold */
    void (*on_event)(void *context, const struct co_event *event); /* of the manager */
    void (*on_slave_event)(void *context, const struct co_event *event);
    FILE *log; /* not NULL: each frame goes there at once, as in sim_trace_text() */
    void *context;
};

void sim_init(struct sim *self, unsigned bitrate);
void sim_done(struct sim *self);
/* Devices are the caller's; they are started by sim_power(). */
struct sim_device *sim_add_slave(struct sim *self, struct slave *slave);
struct sim_device *sim_add_manager(struct sim *self, struct manager *manager);
void sim_power(struct sim *self, struct sim_device *device, bool on);
void sim_run(struct sim *self, co_us_t until);
/* Something was done to a slave within a callback; between runs, and to managers, it may be. */
void sim_touch(struct sim *self, struct sim_device *device);
/* Delivers a frame as from a foreign device, at once. */
void sim_inject(struct sim *self, const char *frame);
/* The same, but it waits for the wire like any other; for use within fault(). */
void sim_say(struct sim *self, const char *frame);
void sim_put(struct sim *self, const struct co_frame *frame);
/* The device's outbox to act on it between runs; what is put is sent in the next sim_run(). */
struct co_outbox *sim_box(struct sim *self, struct sim_device *device);
/* The trace as candump text "(seconds) sim ID#DATA", to be freed. */
char *sim_trace_text(const struct sim *self);
/* How long the wire is busy with a frame. */
co_us_t sim_frame_time(const struct sim *self, const struct co_frame *frame);
/* Frames in the trace with this CAN-ID. */
size_t sim_count(const struct sim *self, uint32_t id);

#endif

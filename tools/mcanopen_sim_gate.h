/*
 * The gate of 'mcanopen sim --defect': the simulated device is alone on a bus inside, and the gate
 * hands frames between that bus and the one outside, with the alterations that make the device look
 * defective. The device itself knows nothing of it.
 *
 *   outside  <-- from_device of each defect --  inside  (the device)
 *            --  to_device of each defect  -->
 *
 *   owner    the verb; two threads, one for each direction
 *   locking  inside: defects are called, and frames sent, under the gate's lock
 */
#ifndef TOOLS_MCANOPEN_SIM_GATE_H
#define TOOLS_MCANOPEN_SIM_GATE_H

#include "mcanopen_sim_defect.h"

#include "port/bus.h"
#include "port/thread.h"

#include <stdatomic.h>

#define DEFECTS_MAX    16u
#define GATE_NAME_SIZE 64u

struct gate_way {
    struct sim_gate *gate;
    struct bus *from, *to;
    bool out; /* from the device */
    struct co_thread thread;
};

struct sim_gate {
    struct sim_device_view view;
    struct defect_use uses[DEFECTS_MAX];
    unsigned use_count;
    struct bus *outside, *inside;
    struct gate_way in, out;
    struct co_lock lock;
    atomic_bool ended;
};

/* False: there are no more than DEFECTS_MAX. */
bool sim_gate_add(struct sim_gate *self, const struct sim_defect *defect);

/*
 * bus: outside; ret_inside (GATE_NAME_SIZE) gets the name of the bus for the device. False: a
 * message was given, nothing is open.
 */
bool sim_gate_open(struct sim_gate *self, const char *bus, uint8_t node, char *ret_inside);
void sim_gate_close(struct sim_gate *self);

#endif

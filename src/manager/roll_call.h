/*
 * What of the nodes counts for the network as a whole: how many it waits for.
 *
 *   in   a node, each time that something has happened to it
 *   out  the counts
 */
#ifndef CO_MANAGER_ROLL_CALL_H
#define CO_MANAGER_ROLL_CALL_H

#include "manager/boot_node.h"

struct roll_call {
    unsigned missing;                      /* mandatory nodes that have not booted ... */
    unsigned failed;                       /* ... and will not be tried again */
    unsigned in_progress;                  /* nodes that have not had their first try */
    unsigned down;                         /* mandatory nodes that are not up */
    uint8_t answers[NETWORK_NODE_MAX + 1]; /* by node-ID: for which of these it counts */
};

/* up: all that has to happen to it has. Of nodes that the master does not boot nothing counts. */
void roll_call_count(struct roll_call *self, const struct boot_node *node, bool up);
/* True for a mandatory node that has not booted. */
bool roll_call_is_missing(const struct boot_node *node);

#endif

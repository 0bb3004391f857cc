/*
 * Error control of one node: heartbeat or, where none is configured, node guarding (CiA 302-2).
 *
 *   in   the node's configuration, its error control frames, the time
 *   out  requests of guarding; PROTO_HB_..., PROTO_GUARD_... events
 *
 *   owner    boot_node
 */
#ifndef CO_MANAGER_SUPERVISION_H
#define CO_MANAGER_SUPERVISION_H

#include "manager/network_config.h"
#include "proto/guarding.h"
#include "proto/heartbeat.h"

#define SUPERVISION_ASK_TIMEOUT CO_MS(100) /* CiA 302-2: for the answer of a guarded node */

struct supervision {
    struct hb_consumer heartbeat;
    struct guard_master guard;
    co_us_t last_heartbeat; /* or answer, since the node's last boot-up or reset; 0: none */
    uint8_t last_state;
};

void supervision_init(struct supervision *self, uint8_t node);

/*
 * Supervises from now on. True: the first heartbeat is to be waited for, at most until *ret_limit;
 * one that has come already and is not too old is told at once.
 */
bool supervision_start(struct supervision *self, const struct node_config *config, co_us_t now,
                       struct co_outbox *out, co_us_t *ret_limit);
void supervision_stop(struct supervision *self);
/*
 * Wants to know the state of the node, from a heartbeat or an answer: PROTO_HB_STATE or
 * PROTO_GUARD_STATE tells. The time until which it should have come.
 */
co_us_t supervision_ask(struct supervision *self, const struct node_config *config, co_us_t now,
                        struct co_outbox *out);
/* The node starts anew: what it has said before does not count. */
void supervision_forget(struct supervision *self);
/* True while the node's state is reported, not assumed. */
bool supervision_is_on(const struct supervision *self);
/* A heartbeat has come within the last consumer time. */
bool supervision_is_alive(const struct supervision *self, co_us_t now);

/* Boot-up messages too. */
void supervision_on_frame(struct supervision *self, const struct co_frame *frame, co_us_t now,
                          struct co_outbox *out);
void supervision_on_time(struct supervision *self, co_us_t now, struct co_outbox *out);
co_us_t supervision_deadline(const struct supervision *self);

#endif

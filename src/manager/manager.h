/*
 * The CANopen manager of one network: NMT master and configuration manager (CiA 302-2, 302-3).
 *
 *   in   frames of the bus, the application's orders and SDO requests, the time
 *   out  frames; MANAGER_... events
 *
 *         manager_start()           boot delay over
 *   OFF ----------------> RESETTING ---------------> BOOTING --- all mandatory nodes booted,
 *                             ^                       |   ^      all optional ones tried
 *                             |       Boot_Time over  v   |               |
 *               RESET_ALL     |                     HALTED              WAITING (*)
 *                             |                                           |
 *                             +-------------------------------------- OPERATIONAL --> STOPPED (**)
 *
 *   (*) where NMT_Auto_Operational is FALSE   (**) by STOP_ALL
 *
 * It is a CANopen device as well: 'device' is that, with its own dictionary, boot-up and heartbeat.
 * Each node of the configuration boots in a machine of its own (boot_node), all in parallel; here
 * is what they have in common: who starts when, and what a lost node means for the others.
 *
 *   owner    runtime/, or a test; it owns the configuration
 *   locking  none; the owner's
 */
#ifndef CO_MANAGER_MANAGER_H
#define CO_MANAGER_MANAGER_H

#include "base/deadlines.h"
#include "base/set.h"
#include "manager/boot_node.h"
#include "manager/network_config.h"
#include "manager/roll_call.h"
#include "manager/sdo_channel.h"
#include "slave/slave.h"

#define MANAGER_INNER_FRAMES 512u /* half of them for the segments of block transfers */
#define MANAGER_INNER_EVENTS 2048u

enum boot_network_state {
    NETWORK_OFF,
    NETWORK_RESETTING,
    NETWORK_BOOTING,
    NETWORK_HALTED,
    NETWORK_WAITING,
    NETWORK_OPERATIONAL,
    NETWORK_STOPPED
};

/* What 1F80h and 1F89h say when the boot of the network begins; it holds until the next one. */
struct boot_rules {
    bool start_all, auto_operational, auto_start;
    enum action_on_error action_on_error;
    uint32_t boot_time; /* ms; 0: no limit */
};

struct manager {
    struct network_config *config; /* other tools change it through the dictionary */
    struct boot_rules rules;
    struct od od;
    struct slave device;
    struct boot_node nodes[NETWORK_NODE_MAX + 1];      /* by node-ID */
    struct sdo_channel channels[NETWORK_NODE_MAX + 1]; /* by node-ID */
    unsigned block_downloads;                          /* that run in these */
    /* What concerns one node costs the same however many there are: only those to which something
     * has happened are looked at. See manager_touch(). */
    struct co_set touched;         /* not looked at since */
    struct co_set moved;           /* their deadlines are not in these: */
    struct co_deadlines deadlines; /* of nodes with their channels, by node-ID */
    struct roll_call roll;
    co_us_t progress; /* an SDO request has got on the wire last */
    uint8_t state;    /* enum boot_network_state */
    bool bus_lost;    /* see manager_on_bus() */
    bool complete;   /* since it was begun all mandatory nodes have booted, the others were tried */
    bool up_told;    /* MANAGER_NETWORK_UP was given since the last start */
    bool reset_due;  /* RESETTING: the command is still to be sent */
    bool reset_each; /* ... to each node that has reset_due, not to all */
    bool start_all_due; /* NMT start all is still to be sent */
    bool stop_all_due;  /* NMT stop all is still to be sent */
    bool shut;          /* no more SDO requests of the application */
    uint8_t reset_command;
    unsigned taken;       /* error control frames of another device with the own node-ID */
    co_us_t deadline;     /* RESETTING: end of the boot delay */
    co_us_t deadline_max; /* ... which boot-up messages may put off until then */
    co_us_t boot_limit;   /* BOOTING: end of Boot_Time, CO_NEVER: none */
    co_us_t reminder;     /* BOOTING: when to tell again who is missing */
    co_us_t reminder_interval;
    struct co_outbox inner; /* of the machines inside */
    struct co_frame inner_frames[MANAGER_INNER_FRAMES];
    struct co_event inner_events[MANAGER_INNER_EVENTS];
    unsigned dropped; /* frames that came while nobody took what had been put out */
    unsigned dropped_told;
};

/* For whoever acts on a node (1..127) or its channel: something may be due, its deadline moves. */
static inline void manager_touch(struct manager *self, uint8_t node)
{
    if (node < 1 || node > NETWORK_NODE_MAX)
        return;
    co_set_add(&self->touched, node);
    co_set_add(&self->moved, node);
}

/*
 * CO_ERR_MEMORY. The configuration must stay, it is checked and its CCFs are there; from now on the
 * manager alone changes it.
 */
enum co_err manager_init(struct manager *self, struct network_config *config);
void manager_done(struct manager *self);

/* Powers the device on and, as NMT master, boots the network. */
void manager_start(struct manager *self, co_us_t now, struct co_outbox *out);

/*
 * An NMT command on behalf of the application, for a node, for the manager itself (its node-ID), or
 * for all (0). CO_ERR_NOT_FOUND: node not in the configuration; CO_ERR_STATE: not now, the node or
 * the network is still booting or has failed to; CO_ERR_AGAIN: no room to send it.
 */
enum co_err manager_command(struct manager *self, enum nmt_command command, uint8_t node,
                            co_us_t now, struct co_outbox *out);

/* An SDO request of the application to any node; when it is DONE, MANAGER_REQUEST_DONE follows. */
void manager_submit(struct manager *self, uint8_t node, struct sdo_request *request, co_us_t now,
                    struct co_outbox *out);
/* Takes such a request back; it gives no event any more. */
void manager_cancel(struct manager *self, uint8_t node, struct sdo_request *request, co_us_t now,
                    struct co_outbox *out);

/*
 * The connection to the bus is lost, or back. Without it nobody knows anything about the nodes, so
 * nobody is missed: boots and error control end, SDO requests end with NOT_SENT, orders are refused
 * (CO_ERR_STATE). When it is back, the network is booted as at the start; one that STOP_ALL has
 * stopped is stopped again.
 */
void manager_on_bus(struct manager *self, bool up, co_us_t now, struct co_outbox *out);

/* Takes all requests back, and leaves IDLE those that come from now on: the end is near. */
void manager_shut(struct manager *self, co_us_t now, struct co_outbox *out);

/* True when all nodes that have to be up are: mandatory ones, with 'all' the optional ones too. */
bool manager_is_up(const struct manager *self, bool all);

/* SDO requests were put out, and nothing has shown yet that they are on the wire ... */
bool manager_awaits_wire(const struct manager *self);
/* ... now all frames that were put out are, or will be at once ... */
void manager_on_handed_over(struct manager *self, co_us_t now);
/* ... or some more of them, so that the others are only queued behind these. */
void manager_on_progress(struct manager *self, co_us_t now);

void manager_on_frame(struct manager *self, const struct co_frame *frame, co_us_t now,
                      struct co_outbox *out);
void manager_on_time(struct manager *self, co_us_t now, struct co_outbox *out);
co_us_t manager_deadline(const struct manager *self);

#endif

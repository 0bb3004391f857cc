/*
 * What the manager tells its owner, through the outbox.
 */
#ifndef CO_MANAGER_EVENT_H
#define CO_MANAGER_EVENT_H

enum manager_event {
    MANAGER_STATE = 200,     /* detail: the manager's own NMT state */
    MANAGER_NETWORK_UP,      /* every required node is up: actual: booted nodes, expected: all */
    MANAGER_HALTED,          /* actual: so many mandatory nodes are missing, node: the first of
                                them; expected: Boot_Time, which is over, or 0: failed for good */
    MANAGER_WAITING,         /* for mandatory nodes: actual: how many, node: the first of them;
                                after 5 s, then ever more rarely */
    MANAGER_NODE_STEP,       /* node, detail: enum boot_step entered; CONFIGURE: actual entries */
    MANAGER_NODE_READ,       /* node, index, sub, actual: what the node answered */
    MANAGER_NODE_UP_TO_DATE, /* node: 1020h says that it is configured already */
    MANAGER_NODE_COMPARED,   /* node: its configuration is there; expected: entries, actual: how
                                many of them had to be written */
    MANAGER_NODE_SOFTWARE,   /* node, detail: enum software_phase entered; actual: bytes of its
                                program */
    MANAGER_NODE_FAILED,     /* node, detail: status letter, see struct boot_failure */
    MANAGER_NODE_BOOTED,     /* node, detail: status letter 'L' or 0 */
    MANAGER_NODE_STARTED,    /* node */
    MANAGER_NODE_UNFOLLOWED, /* node, actual: times it was started; detail: the state it is in */
    MANAGER_NODE_STATE,      /* node, detail: NMT state it reports */
    MANAGER_NODE_BOOT_UP,    /* node; actual: 1 if the configuration knows it */
    MANAGER_NODE_LOST,       /* node, expected: ms of silence; detail: its last state; actual: 1 if
                                it was guarded */
    MANAGER_NODE_TOGGLE,     /* node, actual: answers with a wrong toggle bit so far */
    MANAGER_NODE_BACK,       /* node, detail: its state; expected, actual: as with LOST */
    MANAGER_EMCY,            /* node (also the manager's own), code, detail: error register, data: 8
                                bytes */
    MANAGER_SECOND_MASTER,   /* an NMT command of another master: detail: command, node */
    MANAGER_CONFIG_REFUSED,  /* node, index, sub: what another tool has written there is no
                                configuration; actual: number of that, network_config.refusals
                                tells why; code: as it was told */
    MANAGER_NMT_REQUEST,     /* another tool has commanded through 1F82h: detail, node: as above */
    MANAGER_NODE_ID_TAKEN,   /* node: the manager's own; detail: state that another device reports
                                with it; actual: how often so far; told ever more rarely */
    MANAGER_DROPPED,         /* actual: frames not looked at, for want of room for their events */
    MANAGER_REQUEST_DONE,    /* node: a request of the application has ended; actual: its caller */
    MANAGER_SYNC_MISSING,    /* SYNC that the kernel sends for the manager does not come; once */
    MANAGER_NODE_CONFIGURED, /* node: all of its configuration was written; actual: entries */
    MANAGER_WRITTEN, /* node: the manager's own; index, sub: an entry that a client has written */
    MANAGER_EVENTS_END
};

#endif

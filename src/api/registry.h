/*
 * The manager library as the process has it: its state, the configured networks, their queues.
 *
 *   locking  its own lock, the first in the order of docs/threading.md, held for moments only. A
 *            network that a call uses stays until registry_leave(); who shuts down waits for that.
 */
#ifndef CO_API_REGISTRY_H
#define CO_API_REGISTRY_H

#include "api/sdo_async.h"
#include "base/report.h"
#include "manager/manager.h"
#include "mcanopen.h"
#include "runtime/event_queue.h"
#include "runtime/network.h"

struct managed {                         /* one network with its manager */
    const struct network_config *config; /* a part of the registry's */
    struct network *network;
    bool placed; /* the manager is on it */
    struct manager *manager;
    struct sdo_async_list asyncs;
    struct registry *registry;
};

enum registry_state { REGISTRY_NEW, REGISTRY_INITIALIZED, REGISTRY_CONFIGURED, REGISTRY_RUNNING };

struct registry {
    pthread_mutex_t lock; /* of state, changing, open and users */
    pthread_cond_t idle;  /* users is 0 */
    enum registry_state state;
    bool changing; /* a call of Initialize, Config, Start, ShutDown or Cleanup is under way */
    bool open;     /* calls may use the networks */
    unsigned users;
    /* The rest is changed by a call that changes the state, and while not open, only. */
    struct network_config *configs;
    size_t config_count;
    struct managed networks[NETWORK_INSTANCES];
    size_t network_count;
    struct event_queue events; /* EVENT_T, for mcanOpenEvent */
    struct event_queue logs;   /* struct log_event, for the control daemon */
    struct co_thread control;
    char error_text[CO_REPORT_TEXT_SIZE];
};

/*
 * For one call on one network: MCANOPEN_OK, MCAL_SYS_ERROR (not initialized), MCAL_NODE_NOT_FREE
 * ('running' is asked for and mcanOpenStart was not called), MCAL_NO_NET, MCAL_PARA_ERROR. After
 * MCANOPEN_OK registry_leave() must follow.
 */
int registry_enter(int net, bool running, struct managed **ret_managed);
/* The same for a call on the application's event queue. */
int registry_enter_events(struct event_queue **ret_queue);
void registry_leave(void);

/*
 * Calls that change the state come one at a time; no lock is held while they work, so that the log
 * hook may call the library. NULL and *ret_result: not now, or not from a callback.
 */
struct registry *registry_begin_change(enum registry_state *ret_state, int *ret_result);
void registry_end_change(enum registry_state state);
/* During a change: what has come about counts from now on. */
void registry_set_state(enum registry_state state);
/* During a change: no call gets in any more. */
void registry_close(void);
/* Waits until those that are inside have left. */
void registry_expel(void);

/* Of the last configuration. */
const char *registry_error_text(void);

#endif

/*
 * What the files of runtime/network*.c share.
 */
#ifndef CO_RUNTIME_NETWORK_INTERNAL_H
#define CO_RUNTIME_NETWORK_INTERNAL_H

#include "runtime/daemon.h"
#include "runtime/network.h"
#include "runtime/tx_queue.h"

#define OUT_FRAMES 1024u
#define OUT_EVENTS 1024u

#define DAEMONS_MAX 4u

#define FILTERS_MAX 512u /* what a bus takes */

struct filters {
    struct bus_filter list[FILTERS_MAX];
    unsigned count;
    bool too_many;
};

/* A place on the network: a manager or a slave, or neither yet. */
struct device {
    uint8_t node;
    bool retired;        /* nobody waits on it any more */
    struct slave *slave; /* one of these two, or none */
    struct manager *manager;
    co_us_t since;                   /* the slave hears frames from then on */
    unsigned listen_seen, sync_seen; /* of the slave: what was done about them */
    network_sink_fn sink;
    void *context;
};

struct network {
    struct co_lock lock;
    struct co_condition changed;
    struct co_thread thread;
    struct bus *bus;
    struct network_options options;
    struct device devices[NMT_NODE_MAX + 1];
    unsigned device_count;
    uint8_t cyclic_node; /* for this one the kernel sends SYNC; 0: for none */
    bool closing;
    struct co_outbox out; /* of the device being run */
    struct co_frame out_frames[OUT_FRAMES];
    struct co_event out_events[OUT_EVENTS];
    struct filters filters; /* of all devices; its own memory, so that none can be missing */
    struct slave_filter wanted[FILTERS_MAX]; /* of one device, while they are collected */
    struct tx_queue tx;
    co_us_t tx_retry; /* CO_NEVER: nothing waits */
    co_us_t tx_tell;  /* when losses may be told again */
    co_us_t look;     /* when the bus is asked what has left; CO_NEVER: not */
    unsigned backlog; /* what it said last */
    unsigned losses;  /* of tx, as last seen */
    bool busy_told;
    bool receive_fails;
    co_us_t refused_until;    /* 0: it takes frames */
    enum bus_state bus_state; /* as told */
    unsigned outages;         /* of the bus, as last seen */
    bool is_traced;
    uint32_t news;        /* since the last signal of changed: bits of those whom it is for */
    unsigned callers;     /* had numbers */
    co_us_t last_frame;   /* time of the frame delivered last */
    co_us_t now;          /* of the step or call under way */
    co_us_t behind_until; /* nothing is due before this, when there was a stall */
    co_us_t behind_next;  /* ... and no other one is seen before this */
    co_us_t sleeps_until; /* the thread, when the lock is free; 0: it does not sleep */
    struct daemon *woken[DAEMONS_MAX]; /* when the protocol thread gives the lock */
    unsigned woken_count;
    struct co_lock sending; /* who sends without the network's lock has this one */
    bool sender_away;       /* there is such a one */
    bool stepping;          /* the protocol thread has the lock */
    unsigned steps;
    bool has_priority;
    int priority; /* as claimed */
};

/* network.c */
struct device *network_device(struct network *self, uint8_t node);

/* network_send.c */
/* To the network's sink. */
void network_tell(struct network *self, struct co_event event);
/* Sends what this device has put out, and tells its events. */
void network_drain(struct network *self, struct device *device);
/*
 * Gives the lock to send the one frame that the device has put out, where it is just that, and
 * takes it again: the answer may come while the frame is still being sent, and whoever gets it
 * wants the lock. False: nothing is done, it is for network_drain().
 */
bool network_send_apart(struct network *self, struct device *device);
/* Sends what waits, looks at the bus, and tells what is to be told. */
void network_flush(struct network *self, co_us_t now);

/* What a state of the bus is to a slave. */
enum slave_bus network_slave_bus(enum bus_state state);

/* network_trace.c */
/* sender: node-ID of a device here, or 0. Call it where MCANOPEN_TRACE is not 0. */
void network_trace_frame(struct network *self, const struct co_frame *frame, uint8_t sender);

/* network_confirm.c */
/* The device has put out this frame, and the bus or the queue has it. */
void network_expect(struct network *self, const struct device *device,
                    const struct co_frame *frame);
/* Tells the managers what has left, when it is time to ask. */
void network_confirm(struct network *self, co_us_t now);
/* Requests of managers come back from the bus as well. */
bool network_returns_requests(const struct network *self);

/* network_stall.c */
/*
 * The protocol thread has not run for a while (a stopped process or machine), and the frames that
 * it takes now, until 'now', are as old. A request that is sent at their time has been on its way
 * for as long, and would be missed at once: so what is due since 'due' has to wait until all that
 * came in the meantime is known.
 */
bool network_is_behind(struct network *self, co_us_t due, co_us_t now);

/* network_listen.c */
/* The bus lets through what the devices listen to. */
enum co_err network_listen(struct network *self);
/*
 * Answers to what the device has put out may be frames that did not come in before; and no SYNC of
 * the kernel's comes behind the answer that it has ended.
 */
void network_follow(struct network *self, struct device *device);
/* A SYNC that the kernel sends begins behind what the device has put out: its boot-up message. */
void network_follow_sync(struct network *self, struct device *device);
/* Its slave or manager is gone. */
enum co_err network_forget(struct network *self, struct device *device);

#endif

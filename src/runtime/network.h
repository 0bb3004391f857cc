/*
 * One CAN network of this process: its bus, its protocol thread, the devices on it.
 *
 *   in   frames from the bus, orders of API calls, the clock
 *   out  frames to the bus; the devices' events, to the owner's sink
 *
 * The protocol thread owns the receiving side: it hands frames in bus order to all devices, keeps
 * their deadlines and sends what they put out. API calls act on a device between network_enter()
 * and network_leave(), which hold the network's lock and send at once what the device put out.
 *
 *   owner    api/, or a tool
 *   locking  its own lock, see docs/threading.md
 */
#ifndef CO_RUNTIME_NETWORK_H
#define CO_RUNTIME_NETWORK_H

#include "manager/manager.h"
#include "port/bus.h"
#include "port/thread.h"
#include "slave/slave.h"

#define NETWORK_RECENT CO_MS(10) /* the longest tick of the kernel */

enum runtime_event {
    RUNTIME_FRAMES_LOST = 300, /* actual: received frames lost because we were too slow */
    RUNTIME_UNSENT,            /* actual: frames given up because the bus did not take them */
    RUNTIME_BUS_STATE,         /* detail: enum bus_state */
    RUNTIME_BUSY,              /* frames have to wait for the bus; told once */
    RUNTIME_FRAME /* of network_trace(): code: identifier, index: length, sub: CO_FRAME_..., data;
                     node: the device here that sends it, 0: received */
};

struct daemon;
struct network;

/* Called under the network's lock, by the protocol thread or an API call: must not wait. */
typedef void (*network_sink_fn)(void *context, struct network *network,
                                const struct co_event *event);

struct network_options {
    const char *bus;      /* see port/bus.h */
    struct bus *opened;   /* used in its place, and closed with the network; NULL: none */
    unsigned bitrate;     /* kbit/s */
    network_sink_fn sink; /* gets what is about the network as a whole: RUNTIME_... */
    void *context;
};

/* Opens the bus; message gets a line on failure. Errors of bus_open(), CO_ERR_MEMORY. */
enum co_err network_open(const struct network_options *options, struct network **ret_network,
                         char *message, size_t message_size);
/* From now on each frame is told; in builds without MCANOPEN_TRACE it does nothing. */
void network_trace(struct network *self);
/* Ends what waits in network_wait(), now and from now on. */
void network_shut(struct network *self);
/* The same, and ends the thread: no event comes any more. */
void network_stop(struct network *self);
/*
 * Stops the thread and closes the bus; devices stay their owner's. Nobody may be between enter and
 * leave any more. NULL is fine.
 */
void network_close(struct network *self);

/*
 * A place for a device, whose events go to a sink of its own. At any time. CO_ERR_EXISTS: the
 * node-ID is in use.
 */
enum co_err network_add(struct network *self, uint8_t node, network_sink_fn sink, void *context);
/*
 * Between enter and leave: the device of that place; NULL: none. CO_ERR_MEMORY, CO_ERR_IO: the bus
 * does not let through what it listens to, and it is not there.
 */
enum co_err network_set_slave(struct network *self, uint8_t node, struct slave *slave);
enum co_err network_set_manager(struct network *self, uint8_t node, struct manager *manager);
/* Under the lock. */
bool network_has_manager(const struct network *self);
/* Ends what waits in network_wait() for this place, now and from now on. */
void network_retire(struct network *self, uint8_t node);
/* Nobody may wait for the place any more; no event of it comes any more. */
void network_remove(struct network *self, uint8_t node);
/* Starts the thread, if it does not run yet. CO_ERR_MEMORY */
enum co_err network_run(struct network *self);

/* For networks with one owner: a place with its device and the network's sink; as network_add(). */
enum co_err network_add_slave(struct network *self, struct slave *slave);
enum co_err network_add_manager(struct network *self, struct manager *manager);
/* Powers the devices on, in the order they were added, and starts the thread. CO_ERR_MEMORY */
enum co_err network_start(struct network *self);
/*
 * SCHED_FIFO 1..99 for the protocol thread, which runs; 0: as it is. Who comes first decides.
 * CO_ERR_PERMISSION; CO_ERR_EXISTS: another priority was claimed before.
 */
enum co_err network_claim_priority(struct network *self, int native);

const char *network_name(const struct network *self);
/* bus_explain(); from any thread, also from the sink. */
void network_explain(const struct network *self, char *text, size_t size);

/* Takes the lock; the devices' outbox, and the time. */
struct co_outbox *network_enter(struct network *self, co_us_t *ret_now);
/*
 * As network_enter(), for calls that have to be fast and mostly need no time: it is that of the
 * last step or call, until network_clock() is asked.
 */
struct co_outbox *network_enter_untimed(struct network *self, co_us_t *ret_now);
/* As network_enter(), for calls that have to be fast: the time may be NETWORK_RECENT old. */
struct co_outbox *network_enter_recent(struct network *self, co_us_t *ret_now);
/* Between enter and leave: looks at the clock; also what network_time() says from now on. */
co_us_t network_clock(struct network *self);
/* Sends what the device of this node-ID has put out and gives the lock. */
void network_leave(struct network *self, uint8_t node);
/* The lock alone, for a look at a device: nothing may be put out or change its deadlines. */
void network_hold(struct network *self);
void network_release(struct network *self);
/* Under the lock: the time of the step or call that has it. */
co_us_t network_time(const struct network *self);
/* Between enter and leave: those in network_wait() look again. */
void network_poke(struct network *self);
/* Between enter and leave: there is room in the queue for a frame with this identifier. */
bool network_takes(const struct network *self, uint32_t can_id);
/* Between enter and leave: the state of the bus that was told last. */
enum bus_state network_bus_state(const struct network *self);
/*
 * Under the lock: for a daemon. It is woken when the protocol thread has given the lock, which the
 * daemon may want at once; after network_settle() it is woken no more for what was put before.
 */
void network_put(struct network *self, struct daemon *daemon, const void *element);
/* Not under the lock. The thread runs. */
void network_settle(struct network *self);
/*
 * Between enter and leave: waits until something has happened in the network, or the deadline.
 * CO_ERR_TIMEOUT; CO_ERR_STATE: the network is being closed, or the device's place retired.
 */
enum co_err network_wait(struct network *self, uint8_t node, co_us_t deadline);
/*
 * The same for one who waits for the end of a manager's request, which has this number as 'caller'.
 * Others have the same one, now and then, but none too many: who waits is not woken for each.
 */
enum co_err network_wait_as(struct network *self, uint8_t node, uint32_t caller, co_us_t deadline);
uint32_t network_caller(struct network *self);

#endif

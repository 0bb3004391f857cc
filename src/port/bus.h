/*
 * A CAN bus as the stack sees it, whatever is behind it.
 *
 *   "virtual:NAME"             a bus in user space for processes of this machine (bus_virtual.c);
 *                              frames take no time
 *   "virtual:NAME?bitrate=N"   the same; they take the time they would at N bit/s, and wait for
 *                              the wire
 *   anything else              the SocketCAN interface of that name (bus_socketcan.c)
 *
 * One thread receives and waits. bus_wait() runs without the owner's lock, beside all calls but
 * bus_receive() and bus_close(). bus_send() may run without it, too, beside all but itself and
 * bus_close(). bus_wake(), bus_get_state(), bus_outages() and bus_explain() are for any thread at
 * any time; the others take turns, under the owner's lock. Frames of one bus have one order, the
 * same for all who listen.
 */
#ifndef CO_PORT_BUS_H
#define CO_PORT_BUS_H

#include "base/error.h"
#include "base/frame.h"
#include "base/time.h"

#include <stddef.h>

struct bus;

enum bus_state {
    BUS_ACTIVE,
    BUS_WARNING,
    BUS_PASSIVE,
    BUS_OFF,
    BUS_DOWN /* interface down or gone, or at another bit rate; or held by a stopped process */
};

struct bus_options {
    bool own_frames;  /* see bus_set_own_frames() */
    unsigned bitrate; /* kbit/s as configured, compared where the bus knows its own */
};

struct bus_rx {
    struct co_frame frame; /* with the tag it was sent with, where CO_FRAME_OWN is set */
    co_us_t time;          /* of reception, monotonic; on a virtual bus with a bit rate that at
                              which the wire is free again, however late it is fetched */
    unsigned lost;         /* frames lost before this one, because the reader was too slow;
                              on a virtual bus those the filters would have dropped count too */
};

struct bus_filter { /* passes a frame if (id & mask) == (this id & mask) and the kind is equal */
    uint32_t id;
    uint32_t mask;
    uint8_t flags;      /* CO_FRAME_EXT, CO_FRAME_RTR */
    uint8_t flags_mask; /* which of them count */
};

/*
 * CO_ERR_NO_BUS: no such interface; CO_ERR_DOWN: it is down; CO_ERR_PERMISSION; CO_ERR_BITRATE: it
 * runs at another bit rate; CO_ERR_ARG: the name is none; CO_ERR_HELD: a stopped process holds the
 * virtual bus; CO_ERR_STATE: the virtual bus is in use by programs this one cannot share it with;
 * CO_ERR_IO, CO_ERR_MEMORY. message (may be NULL) gets one line of text: what is wrong and the
 * command that mends it.
 */
enum co_err bus_open(const char *name, const struct bus_options *options, struct bus **ret_bus,
                     char *message, size_t message_size);
/* The thread that waited calls this, or has ended. */
void bus_close(struct bus *self);

/* CO_ERR_AGAIN: no room at the moment, try again in a millisecond; CO_ERR_DOWN (bus-off, too),
 * CO_ERR_NO_BUS, CO_ERR_HELD, CO_ERR_IO; CO_ERR_ARG: identifier or dlc out of range. */
enum co_err bus_send(struct bus *self, const struct co_frame *frame);
/* CO_ERR_AGAIN: nothing there; CO_ERR_DOWN, CO_ERR_NO_BUS, CO_ERR_IO. */
enum co_err bus_receive(struct bus *self, struct bus_rx *ret_rx);
/*
 * True: what bus_wait() has fetched is not all received yet, and bus_receive() gives it without a
 * system call. False: there may be more all the same, which the next bus_wait() finds at once, with
 * the call that it makes anyway. So a loop of bus_wait(), and bus_receive() while this is true,
 * needs one system call for a frame or for several. By the thread that receives.
 */
bool bus_has_fetched(struct bus *self);
/*
 * Until a frame is there, the state may have changed, bus_wake() or the deadline; CO_OK,
 * CO_ERR_TIMEOUT (no frame was there when it had come), CO_ERR_IO. A SocketCAN interface that is
 * down or gone is waited for and used again, by its name, when it is back; filters and options
 * stay.
 */
enum co_err bus_wait(struct bus *self, co_us_t deadline);
/* Ends a bus_wait() of another thread, or the next one. */
void bus_wake(struct bus *self);

/*
 * Without filters (count 0) all data frames with 11-bit identifiers pass. Own frames pass the
 * filters like others. CO_ERR_ARG: more than 512; CO_ERR_MEMORY, CO_ERR_IO.
 */
enum co_err bus_set_filters(struct bus *self, const struct bus_filter *filters, size_t count);
/*
 * On: the frames sent here are received here too, marked CO_FRAME_OWN, at their place; a
 * transmit confirmation. Off: they are not, and wake nobody up here. What is on its way at that
 * moment may be received or not, and the tag of such a frame may be 0. CO_ERR_IO: all is as before.
 */
enum co_err bus_set_own_frames(struct bus *self, bool on);

#define BUS_CYCLIC_MAX 240u /* SYNC with a counter has as many different ones */

/*
 * Frames that the kernel sends by itself with its timers, one per period (us), in turns; the first
 * one now. count 0: no more. The call ends what an earlier one has begun. When the bus comes back
 * that was OFF or DOWN, they begin with the first one again. They are received here as if another
 * program had sent them. After an error none are sent. CO_ERR_UNSUPPORTED: this bus or this kernel
 * cannot, the caller has to send them; CO_ERR_ARG: period 0, more than BUS_CYCLIC_MAX, or a frame
 * that bus_send() would refuse so; CO_ERR_MEMORY, CO_ERR_PERMISSION, CO_ERR_IO.
 */
enum co_err bus_set_cyclic(struct bus *self, const struct co_frame *frames, unsigned count,
                           co_us_t period);

/*
 * How much of what was sent has not left this machine, in a measure of the bus's own; 0: all is on
 * the wire, or the controller has it, or the kernel cannot tell.
 */
unsigned bus_backlog(struct bus *self);
enum bus_state bus_get_state(struct bus *self);
/* How often a SocketCAN bus has become OFF or DOWN: some are over before anybody looks. */
unsigned bus_outages(const struct bus *self);
/*
 * One line of text about the state: what is wrong and what mends it; for a bus in order, so much.
 * For any thread.
 */
void bus_explain(struct bus *self, char *message, size_t message_size);
const char *bus_name(const struct bus *self);

#endif

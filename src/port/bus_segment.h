/*
 * The shared memory of a virtual bus: one file /dev/shm/mcanopen-UID-NAME, mapped by all
 * participants. Internal to port/.
 *
 *      +--------+-------+------+------+-----------+---------+------------------------------------+
 *      | header | mutex | wire | head | slots[64] | pending | ring of 65536 records of 32 bytes  |
 *      +--------+-------+------+------+-----------+---------+------------------------------------+
 *                                 |                    ... | h-2 | h-1 | oldest | ...
 *                                 +--------------------------------------^  (modulo the size)
 *
 *   life      Everybody who maps the file holds a shared flock on it, set-up and removal need the
 *             exclusive one: who gets that is alone, whatever state the file is in.
 *   order     Frame number n is in record n % 65536. Writers append under the robust mutex: the
 *             record first, then head. One killed on the way leaves nothing visible.
 *   reading   takes no lock: a record says which number it holds, and that is looked at before and
 *             after it is copied. All shared words are atomic, so an overrun is seen, never a tear.
 *   sleeping  A participant that is about to sleep stores a ticket in its slot, then looks at head
 *             once more. A writer that finds a ticket behind its store of head sends a byte to the
 *             participant's socket and takes the ticket back. The ticket is another one each time,
 *             so nobody can take back the next one by mistake.
 *   wire      With a bit rate (bus_segment_wire.c) a frame waits as pending in its sender's slot
 *             and comes into the ring at the end of its time on the wire. Which frame is on the
 *             wire, and until when, follows from what is pending and when it was sent; nobody
 *             keeps it. So whoever looks moves the frames on that are through by now, under the
 *             mutex, with the times they would have had on a wire, however late he is.
 */
#ifndef CO_PORT_BUS_SEGMENT_H
#define CO_PORT_BUS_SEGMENT_H

#include "base/error.h"
#include "base/frame.h"
#include "base/time.h"
#include "port/bus_ops.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <sys/socket.h>
#include <sys/types.h>
#include <sys/un.h>

#define SEGMENT_RECORDS  65536u
#define SEGMENT_SLOTS    64u
#define SEGMENT_MAGIC    UINT64_C(0x5355424e504f434d) /* "MCOPNBUS" */
#define SEGMENT_VERSION  2u
#define SEGMENT_NAME_MAX 32u
#define SEGMENT_PENDING  32u           /* frames of one participant that wait for the wire */
#define SEGMENT_NOBODY   SEGMENT_SLOTS /* as the sender's slot: a participant that has left */

/* A longer hold is not work but a stopped process. */
#define SEGMENT_HOLD_LIMIT CO_MS(200)

struct segment_record {
    _Atomic uint64_t number; /* of the frame, plus 1; 0: being written */
    _Atomic uint64_t time;
    _Atomic uint64_t head; /* identifier, slot, flags and dlc, tag */
    _Atomic uint64_t data;
};

struct segment_slot {         /* one participant; a cache line */
    _Atomic uint64_t ticket;  /* 0: awake */
    _Atomic uint64_t started; /* when its process was, in the kernel's clock ticks */
    _Atomic uint32_t pid;
    _Atomic uint32_t number;  /* part of its socket's address; 0: the slot is free; stored last */
    _Atomic uint32_t pending; /* bit i: entry i of its pending frames waits for the wire */
    uint32_t unused[9];
};

struct segment_pending { /* under the mutex; counts from when its bit in the slot is set */
    uint64_t order;      /* of sending, of all participants */
    uint64_t sent;       /* ns; lasts 'length' on the wire, ns */
    uint32_t length;
    uint32_t priority; /* lowest first */
    uint32_t slot;     /* of the sender, or SEGMENT_NOBODY */
    struct co_frame frame;
};

/*
 * A frame goes from pending to the ring in steps. 'moving' says which one does, and as which number
 * of the ring, so that who finds a killed holder's work can tell if the frame is in the ring.
 */
struct segment_wire {
    uint32_t bitrate; /* bit/s; 0: frames take no time, and the rest is not used */
    uint64_t free;    /* ns; from when on the wire is free */
    uint64_t next_order;
    uint64_t moving_free;    /* 'free' after the frame that moves */
    _Atomic uint64_t moving; /* 63..16 its number in the ring, 15..0 index of pending plus 1 */
    _Atomic uint64_t due;    /* us; end of the frame on the wire, CO_NEVER: it is idle */
};

struct segment_header {     /* the same in all versions */
    _Atomic uint64_t magic; /* stored last */
    uint32_t version;
    uint32_t mutex_size; /* differs where programs of other word sizes come along */
};

struct segment_map {
    struct segment_header header;
    uint64_t network_space, pid_space; /* inodes; addresses and pids mean nothing elsewhere */
    pthread_mutex_t mutex;
    _Atomic uint32_t holder; /* pid, for messages only */
    uint32_t next_number;    /* under the mutex */
    struct segment_wire wire;
    _Alignas(64) _Atomic uint64_t head; /* number of the next frame */
    _Atomic uint32_t slots_used;        /* no slot from this one on was ever used */
    _Alignas(64) struct segment_slot slots[SEGMENT_SLOTS];
    struct segment_pending pending[SEGMENT_SLOTS * SEGMENT_PENDING];
    _Alignas(64) struct segment_record ring[SEGMENT_RECORDS];
};

struct segment {
    struct segment_map *map;
    char path[32 + SEGMENT_NAME_MAX];
    char name[SEGMENT_NAME_MAX + 1];
    uint32_t bitrate; /* bit/s; 0: none */
    int fd;
};

/* A record as its reader gets it. */
struct segment_frame {
    struct co_frame frame; /* with the sender's tag */
    co_us_t time;
    unsigned slot; /* of the sender */
};

bool segment_name_is_valid(const char *name);
/* bitrate: bit/s, 0: none. CO_ERR_PERMISSION, CO_ERR_IO, CO_ERR_MEMORY, CO_ERR_STATE, CO_ERR_HELD;
 * CO_ERR_BITRATE: those who are there already have another one. */
enum co_err segment_open(struct segment *self, const char *name, uint32_t bitrate,
                         const struct bus_message *message);
/* Removes the file if nobody else is there. */
void segment_close(struct segment *self);

/* limit 0: only if it is free. CO_ERR_HELD, CO_ERR_IO */
enum co_err segment_lock(struct segment *self, co_us_t limit);
void segment_unlock(struct segment *self);

/* Under the lock. A slot that is free or whose process is gone; CO_ERR_MEMORY: there is none. */
enum co_err segment_find_slot(struct segment *self, unsigned *ret_slot);
/* Under the lock. */
void segment_take_slot(struct segment *self, unsigned slot, uint32_t number);
/* Frees the slot if it is still that participant's. Needs no lock. */
void segment_free_slot(struct segment *self, unsigned slot, uint32_t number);
/* The address of a participant's socket; returns its length. */
socklen_t segment_address(const struct segment *self, uint32_t number, struct sockaddr_un *ret);

/* Under the lock. */
void segment_append(struct segment *self, const struct segment_frame *frame);
/*
 * The frame at *cursor or, where it is overwritten, the oldest after it that is not; *cursor moves
 * behind it and *lost grows by those left out. False: there is none.
 */
bool segment_read(struct segment *self, uint64_t *cursor, uint64_t *lost,
                  struct segment_frame *ret_frame);
/* True if all frames up to now are in front of the cursor; orders with the writers' wake-ups. */
bool segment_is_drained(struct segment *self, uint64_t cursor);

/*
 * The wire, with a bit rate only; all but the last under the lock.
 *
 * segment_offer() makes the frame pending, sent at its time, which is not before that of any other
 * call. True in *ret_sooner if the end of the frame on the wire is nearer than before, so that
 * sleepers have to look again. CO_ERR_AGAIN: SEGMENT_PENDING frames of its slot wait already.
 */
enum co_err segment_offer(struct segment *self, const struct segment_frame *frame,
                          bool *ret_sooner);
/* Appends the frames that are through by now. */
void segment_move_on(struct segment *self, co_us_t now);
/* After a holder was killed. */
void segment_mend_wire(struct segment *self);
/* The pending frames of a slot are not its next owner's. */
void segment_disown_pending(struct segment *self, unsigned slot);
/* When the frame on the wire will be through; CO_NEVER: it is idle, or has no bit rate. Orders with
 * the senders' wake-ups. */
co_us_t segment_due(struct segment *self);

#endif

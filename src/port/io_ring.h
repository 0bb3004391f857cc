/*
 * A minimal io_uring: one system call hands requests over, waits, and brings what has come of them.
 *
 *   in   requests, each with a number of its owner's
 *   out  results with these numbers, in the order in which they came about
 *
 * Internal to port/. One thread at a time; the kernel completes a request in the thread that handed
 * it over, when that enters the kernel, and gives up the requests of a thread that ends.
 */
#ifndef CO_PORT_IO_RING_H
#define CO_PORT_IO_RING_H

#include "base/error.h"

#include <linux/io_uring.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct io_ring {
    int fd; /* -1: not open */
    char *queues;
    size_t queues_size;
    struct io_uring_sqe *requests;
    size_t requests_size;
    uint32_t tail;   /* of the requests, as prepared */
    uint32_t handed; /* of these, as handed over */
    struct io_uring_params layout;
};

typedef int io_ring_setup_fn(unsigned entries, struct io_uring_params *params);

/* The system call, for io_ring_open(); ENOSYS under valgrind, too. */
int io_ring_setup(unsigned entries, struct io_uring_params *params);

/*
 * Room for so many requests that are prepared or not finished. Also where it fails it is to be
 * closed. CO_ERR_UNSUPPORTED: the kernel has none, an old one, or does not let us.
 */
enum co_err io_ring_open(struct io_ring *self, unsigned entries, io_ring_setup_fn *setup);
void io_ring_close(struct io_ring *self);

/* How many more can be prepared before the next io_ring_enter() that works. */
unsigned io_ring_room(const struct io_ring *self);
/* The next request, empty but for its number; it and what it points to stay until its result. */
struct io_uring_sqe *io_ring_prepare(struct io_ring *self, unsigned opcode, uint64_t number);
/*
 * Hands over what was prepared, and waits until there are so many results (0: not at all, but what
 * has come is there), or a signal. CO_ERR_IO
 */
enum co_err io_ring_enter(struct io_ring *self, unsigned results);
/* The next result: a number, and what the system call would have returned, or -errno. */
bool io_ring_take(struct io_ring *self, uint64_t *ret_number, int *ret_result);

#endif

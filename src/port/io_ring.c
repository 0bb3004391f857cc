#include "port/io_ring.h"

#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Linux 5.7: sockets are waited for without a thread of the kernel. */
#define NEEDED                                                                                     \
    (IORING_FEAT_SINGLE_MMAP | IORING_FEAT_NODROP | IORING_FEAT_SUBMIT_STABLE |                    \
     IORING_FEAT_FAST_POLL)

/* Valgrind stops all other threads while one waits in io_uring. */
static bool is_under_valgrind(void)
{
    const char *preloaded = getenv("LD_PRELOAD");

    return preloaded && strstr(preloaded, "vgpreload");
}

int io_ring_setup(unsigned entries, struct io_uring_params *params)
{
    if (is_under_valgrind()) {
        errno = ENOSYS;
        return -1;
    }
    return (int)syscall(SYS_io_uring_setup, entries, params);
}

/* --- the shared memory --- */

static _Atomic uint32_t *shared_word(const struct io_ring *self, uint32_t offset)
{
    return (_Atomic uint32_t *)(void *)(self->queues + offset);
}

static uint32_t load(const struct io_ring *self, uint32_t offset)
{
    return atomic_load_explicit(shared_word(self, offset), memory_order_acquire);
}

static void store(const struct io_ring *self, uint32_t offset, uint32_t value)
{
    atomic_store_explicit(shared_word(self, offset), value, memory_order_release);
}

static void *map(int fd, size_t size, off_t which)
{
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, fd, which);

    return memory == MAP_FAILED ? NULL : memory;
}

static enum co_err map_queues(struct io_ring *self)
{
    const struct io_uring_params *layout = &self->layout;
    size_t requests = layout->sq_off.array + layout->sq_entries * sizeof(uint32_t);
    size_t results = layout->cq_off.cqes + layout->cq_entries * sizeof(struct io_uring_cqe);

    self->queues_size = requests > results ? requests : results;
    self->queues = map(self->fd, self->queues_size, IORING_OFF_SQ_RING);
    self->requests_size = layout->sq_entries * sizeof(struct io_uring_sqe);
    self->requests = map(self->fd, self->requests_size, IORING_OFF_SQES);
    if (!self->queues || !self->requests)
        return CO_ERR_UNSUPPORTED;
    for (uint32_t i = 0; i < layout->sq_entries; i++)
        store(self, layout->sq_off.array + i * (uint32_t)sizeof i, i);
    return CO_OK;
}

/* --- opening and closing --- */

/* Without being interrupted for each completion, where the kernel knows how (5.19). */
static int set_up(struct io_ring *self, unsigned entries, io_ring_setup_fn *setup)
{
    int fd;

    self->layout = (struct io_uring_params){ .flags = IORING_SETUP_COOP_TASKRUN };
    fd = setup(entries, &self->layout);
    if (fd >= 0 || errno != EINVAL)
        return fd;
    self->layout = (struct io_uring_params){ .flags = 0 };
    return setup(entries, &self->layout);
}

enum co_err io_ring_open(struct io_ring *self, unsigned entries, io_ring_setup_fn *setup)
{
    enum co_err err;

    memset(self, 0, sizeof *self);
    self->fd = set_up(self, entries, setup);
    if (self->fd < 0 || (self->layout.features & NEEDED) != NEEDED)
        return CO_ERR_UNSUPPORTED;
    err = map_queues(self);
    if (err)
        return err;
    return io_ring_enter(self, 0) == CO_OK ? CO_OK : CO_ERR_UNSUPPORTED;
}

void io_ring_close(struct io_ring *self)
{
    if (self->queues)
        munmap(self->queues, self->queues_size);
    if (self->requests)
        munmap(self->requests, self->requests_size);
    if (self->fd >= 0)
        close(self->fd);
    memset(self, 0, sizeof *self);
    self->fd = -1;
}

/* --- requests and results --- */

unsigned io_ring_room(const struct io_ring *self)
{
    return self->layout.sq_entries - (self->tail - self->handed);
}

struct io_uring_sqe *io_ring_prepare(struct io_ring *self, unsigned opcode, uint64_t number)
{
    struct io_uring_sqe *request = &self->requests[self->tail++ & (self->layout.sq_entries - 1)];

    memset(request, 0, sizeof *request);
    request->opcode = (uint8_t)opcode;
    request->user_data = number;
    return request;
}

enum co_err io_ring_enter(struct io_ring *self, unsigned results)
{
    long count;

    store(self, self->layout.sq_off.tail, self->tail);
    count = syscall(SYS_io_uring_enter, self->fd, self->tail - self->handed, results,
                    IORING_ENTER_GETEVENTS, NULL, 0);
    if (count < 0)
        return errno == EINTR ? CO_OK : CO_ERR_IO;
    self->handed += (uint32_t)count;
    return CO_OK;
}

bool io_ring_take(struct io_ring *self, uint64_t *ret_number, int *ret_result)
{
    const struct io_uring_params *layout = &self->layout;
    uint32_t head = load(self, layout->cq_off.head);
    size_t place = layout->cq_off.cqes;
    struct io_uring_cqe result;

    if (head == load(self, layout->cq_off.tail))
        return false;
    place += (head & (layout->cq_entries - 1)) * sizeof result;
    memcpy(&result, self->queues + place, sizeof result);
    store(self, layout->cq_off.head, head + 1);
    *ret_number = result.user_data;
    *ret_result = result.res;
    return true;
}

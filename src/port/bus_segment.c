#include "port/bus_segment.h"

#include "port/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

_Static_assert(sizeof(struct segment_slot) == 64, "a slot is a cache line");
_Static_assert(sizeof(struct segment_record) == 32, "records do not straddle cache lines");

bool segment_name_is_valid(const char *name)
{
    static const char allowed[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    size_t length = strlen(name);

    return length > 0 && length <= SEGMENT_NAME_MAX && strspn(name, allowed) == length;
}

/* --- the file: everybody holds it shared, who can hold it alone sets it up or removes it --- */

static uint64_t inode_of(const char *path)
{
    struct stat info;

    return stat(path, &info) == 0 ? (uint64_t)info.st_ino : 0;
}

static enum co_err open_file(struct segment *self, const struct bus_message *message)
{
    struct stat info;

    self->fd = open(self->path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (self->fd < 0) {
        return bus_fail(message, errno == EACCES ? CO_ERR_PERMISSION : CO_ERR_IO,
                        "virtual bus %s: cannot open %s: %s", self->name, self->path,
                        strerror(errno));
    }
    if (fstat(self->fd, &info) == 0 && S_ISREG(info.st_mode) && info.st_uid == geteuid() &&
        (info.st_mode & 077) == 0)
        return CO_OK;
    close(self->fd);
    return bus_fail(message, CO_ERR_PERMISSION,
                    "virtual bus %s: %s is not a private file of this user; remove it", self->name,
                    self->path);
}

/* False once the last participant before us has removed it. */
static bool is_still_the_file(const struct segment *self)
{
    struct stat ours, now;

    return fstat(self->fd, &ours) == 0 && stat(self->path, &now) == 0 &&
           ours.st_dev == now.st_dev && ours.st_ino == now.st_ino;
}

static void init_mutex(pthread_mutex_t *mutex)
{
    pthread_mutexattr_t attributes;

    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
    pthread_mutexattr_setrobust(&attributes, PTHREAD_MUTEX_ROBUST);
    pthread_mutex_init(mutex, &attributes);
    pthread_mutexattr_destroy(&attributes);
}

static struct segment_map *map_file(int fd)
{
    void *map = mmap(NULL, sizeof(struct segment_map), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);

    return map == MAP_FAILED ? NULL : (struct segment_map *)map;
}

/* Alone: whatever was in the file belongs to nobody any more. */
static enum co_err set_up(struct segment *self, const struct bus_message *message)
{
    struct segment_map *map;
    int error = ftruncate(self->fd, 0) ? errno : 0;

    if (!error) /* all pages now: a full /dev/shm is an error here, and would be SIGBUS later */
        error = posix_fallocate(self->fd, 0, sizeof(struct segment_map));
    map = error ? NULL : map_file(self->fd);
    if (!map) {
        return bus_fail(message, CO_ERR_MEMORY,
                        "virtual bus %s: no room for %zu KiB in /dev/shm: %s", self->name,
                        sizeof(struct segment_map) / 1024, strerror(error ? error : errno));
    }
    map->header.version = SEGMENT_VERSION;
    map->header.mutex_size = sizeof(pthread_mutex_t);
    map->network_space = inode_of("/proc/self/ns/net");
    map->pid_space = inode_of("/proc/self/ns/pid");
    init_mutex(&map->mutex);
    map->next_number = 1;
    map->wire.bitrate = self->bitrate;
    atomic_store(&map->wire.due, CO_NEVER);
    atomic_store_explicit(&map->header.magic, SEGMENT_MAGIC, memory_order_release);
    munmap(map, sizeof *map);
    return CO_OK;
}

static bool has_our_layout(const struct segment *self)
{
    struct stat info;
    struct segment_header header;

    return fstat(self->fd, &info) == 0 && info.st_size == sizeof(struct segment_map) &&
           pread(self->fd, &header, sizeof header, 0) == sizeof header &&
           header.magic == SEGMENT_MAGIC && header.version == SEGMENT_VERSION &&
           header.mutex_size == sizeof(pthread_mutex_t);
}

/*
 * Sets up if alone, then holds the file shared. The kernel may let somebody in between the two, so
 * what counts is looked at only after this. CO_ERR_AGAIN: start over.
 */
static enum co_err hold_file(struct segment *self, const struct bus_message *message)
{
    co_us_t deadline = clock_now() + SEGMENT_HOLD_LIMIT;
    const struct timespec pause = { .tv_nsec = 1000000 };
    enum co_err err;

    if (flock(self->fd, LOCK_EX | LOCK_NB) == 0) {
        if (!is_still_the_file(self))
            return CO_ERR_AGAIN;
        err = set_up(self, message);
        if (err)
            return err;
    }
    while (flock(self->fd, LOCK_SH | LOCK_NB) != 0) {
        if (clock_now() > deadline)
            return bus_fail(message, CO_ERR_HELD,
                            "virtual bus %s is held by a stopped process that was setting it up",
                            self->name);
        nanosleep(&pause, NULL);
    }
    return is_still_the_file(self) ? CO_OK : CO_ERR_AGAIN;
}

static enum co_err check_bitrate(const struct segment *self, const struct bus_message *message)
{
    uint32_t theirs = self->map->wire.bitrate;
    char asked[48] = "without one";

    if (theirs == self->bitrate)
        return CO_OK;
    if (theirs == 0) {
        return bus_fail(message, CO_ERR_BITRATE,
                        "virtual bus %s is in use without a bit rate, not with %u bit/s; open it "
                        "as \"virtual:%s\"",
                        self->name, self->bitrate, self->name);
    }
    if (self->bitrate != 0)
        snprintf(asked, sizeof asked, "with %u bit/s", self->bitrate);
    return bus_fail(message, CO_ERR_BITRATE,
                    "virtual bus %s is in use with %u bit/s, not %s; open it as "
                    "\"virtual:%s?bitrate=%u\"",
                    self->name, theirs, asked, self->name, theirs);
}

static enum co_err check_sharing(const struct segment *self, const struct bus_message *message)
{
    if (self->map->network_space == inode_of("/proc/self/ns/net") &&
        self->map->pid_space == inode_of("/proc/self/ns/pid"))
        return check_bitrate(self, message);
    return bus_fail(message, CO_ERR_STATE,
                    "virtual bus %s is in use in another network or PID namespace (container)",
                    self->name);
}

static enum co_err join(struct segment *self, const struct bus_message *message)
{
    enum co_err err;

    if (!has_our_layout(self)) {
        return bus_fail(message, CO_ERR_STATE,
                        "virtual bus %s is in use by programs of another version or word size, or "
                        "%s is damaged; end them, or take another name",
                        self->name, self->path);
    }
    self->map = map_file(self->fd);
    if (!self->map)
        return bus_fail(message, CO_ERR_MEMORY, "virtual bus %s: cannot map %s: %s", self->name,
                        self->path, strerror(errno));
    err = check_sharing(self, message);
    if (err)
        munmap(self->map, sizeof *self->map);
    return err;
}

enum co_err segment_open(struct segment *self, const char *name, uint32_t bitrate,
                         const struct bus_message *message)
{
    enum co_err err = CO_ERR_AGAIN;

    self->bitrate = bitrate;
    snprintf(self->name, sizeof self->name, "%s", name);
    snprintf(self->path, sizeof self->path, "/dev/shm/mcanopen-%u-%s", (unsigned)geteuid(), name);
    for (unsigned tries = 0; err == CO_ERR_AGAIN && tries < 100; tries++) {
        err = open_file(self, message);
        if (err)
            return err;
        err = hold_file(self, message);
        if (!err)
            err = join(self, message);
        if (err)
            close(self->fd);
    }
    return err == CO_ERR_AGAIN
               ? bus_fail(message, CO_ERR_IO, "virtual bus %s: %s comes and goes", name, self->path)
               : err;
}

void segment_close(struct segment *self)
{
    munmap(self->map, sizeof *self->map);
    if (flock(self->fd, LOCK_EX | LOCK_NB) == 0 && is_still_the_file(self))
        unlink(self->path);
    close(self->fd);
}

/* --- the lock --- */

#if defined(__SANITIZE_THREAD__)
#define UNDER_THREAD_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define UNDER_THREAD_SANITIZER 1
#endif
#endif

#ifdef UNDER_THREAD_SANITIZER
/* The thread sanitizer does not know pthread_mutex_clocklock() and takes it for no lock at all. */
static int wait_for_mutex(pthread_mutex_t *mutex, co_us_t deadline)
{
    const struct timespec pause = { .tv_nsec = 50000 };
    int error = pthread_mutex_trylock(mutex);

    while (error == EBUSY && clock_now() < deadline) {
        nanosleep(&pause, NULL);
        error = pthread_mutex_trylock(mutex);
    }
    return error;
}
#else
static int wait_for_mutex(pthread_mutex_t *mutex, co_us_t deadline)
{
    const struct timespec until = { .tv_sec = (time_t)(deadline / 1000000u),
                                    .tv_nsec = (long)(deadline % 1000000u) * 1000 };

    return pthread_mutex_clocklock(mutex, CLOCK_MONOTONIC, &until);
}
#endif

static int take_mutex(pthread_mutex_t *mutex, co_us_t limit)
{
    int error = pthread_mutex_trylock(mutex);

    return error == EBUSY && limit > 0 ? wait_for_mutex(mutex, clock_now() + limit) : error;
}

enum co_err segment_lock(struct segment *self, co_us_t limit)
{
    int error = take_mutex(&self->map->mutex, limit);

    if (error == EBUSY || error == ETIMEDOUT)
        return CO_ERR_HELD;
    /* Its holder was killed: what it had begun to append is not visible and needs no mending. */
    if (error == EOWNERDEAD) {
        segment_mend_wire(self);
        error = pthread_mutex_consistent(&self->map->mutex);
    }
    if (error)
        return CO_ERR_IO;
    atomic_store_explicit(&self->map->holder, (uint32_t)getpid(), memory_order_relaxed);
    return CO_OK;
}

void segment_unlock(struct segment *self)
{
    pthread_mutex_unlock(&self->map->mutex);
}

/* --- the participants --- */

/* When a process was started, in clock ticks since boot; 0: there is no such process. */
static uint64_t start_of_process(uint32_t pid)
{
    char path[32], text[512], *field;
    ssize_t size;
    int fd;

    snprintf(path, sizeof path, "/proc/%u/stat", pid);
    fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return 0;
    size = read(fd, text, sizeof text - 1);
    close(fd);
    if (size <= 0)
        return 0;
    text[size] = '\0';
    field = strrchr(text, ')'); /* the end of field 2; the name may contain anything */
    for (unsigned number = 2; field && number < 22; number++)
        field = strchr(field + 1, ' ');
    return field ? strtoull(field + 1, NULL, 10) : 0;
}

/* Where /proc does not tell, a process of that number is taken for the right one. */
static bool is_gone(const struct segment_slot *slot)
{
    uint32_t pid = atomic_load(&slot->pid);
    uint64_t started = atomic_load(&slot->started), now;

    if (kill((pid_t)pid, 0) != 0 && errno == ESRCH)
        return true;
    now = start_of_process(pid);
    return now != 0 && started != 0 && now != started;
}

static bool is_free(const struct segment_slot *slot)
{
    return atomic_load(&slot->number) == 0;
}

/* What its last owner has left on the wire takes no room from the next one. */
static bool is_empty(const struct segment_slot *slot)
{
    return is_free(slot) && atomic_load(&slot->pending) == 0;
}

enum co_err segment_find_slot(struct segment *self, unsigned *ret_slot)
{
    static bool (*const choices[])(const struct segment_slot *) = { is_empty, is_free, is_gone };

    for (unsigned i = 0; i < sizeof choices / sizeof choices[0]; i++) {
        for (unsigned slot = 0; slot < SEGMENT_SLOTS; slot++) {
            if (choices[i](&self->map->slots[slot])) {
                *ret_slot = slot;
                return CO_OK;
            }
        }
    }
    return CO_ERR_MEMORY;
}

void segment_take_slot(struct segment *self, unsigned slot, uint32_t number)
{
    struct segment_slot *taken = &self->map->slots[slot];
    uint32_t pid = (uint32_t)getpid();

    atomic_store(&taken->number, 0);
    atomic_store(&taken->ticket, 0);
    segment_disown_pending(self, slot);
    atomic_store(&taken->pid, pid);
    atomic_store(&taken->started, start_of_process(pid));
    atomic_store(&taken->number, number);
    if (slot >= atomic_load(&self->map->slots_used))
        atomic_store(&self->map->slots_used, slot + 1);
}

void segment_free_slot(struct segment *self, unsigned slot, uint32_t number)
{
    atomic_compare_exchange_strong(&self->map->slots[slot].number, &number, 0);
}

socklen_t segment_address(const struct segment *self, uint32_t number, struct sockaddr_un *ret)
{
    int length;

    *ret = (struct sockaddr_un){ .sun_family = AF_UNIX };
    length = snprintf(ret->sun_path + 1, sizeof ret->sun_path - 1, "mcanopen/%u/%s/%u",
                      (unsigned)geteuid(), self->name, number);
    return (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + (size_t)length);
}

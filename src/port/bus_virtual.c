/* The virtual bus of bus.h on the shared memory of bus_segment.h. */
#include "port/bus_ops.h"
#include "port/bus_segment.h"
#include "port/clock.h"
#include "port/thread.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

/*
 * A sender that is killed or stopped between its frame and its wake-up leaves sleepers behind. They
 * wake up with the next frame, or when they look for themselves after this time.
 */
#define SLEEP_LIMIT CO_MS(1000)
#define HELD_LOOK   CO_MS(100) /* nobody tells when a stopped holder goes on */

/* For one who only listens; later he looks that often, as nobody tells when the holder goes on. */
#define HELD_LIMIT CO_MS(20)

#define WAKE_BYTES_MAX 16 /* more than a socket queues for a sleeping participant */

#define BITRATE_OPTION "?bitrate="
#define BITRATE_MIN    1000u
#define BITRATE_MAX    1000000u

struct bus_name_parts {
    char name[SEGMENT_NAME_MAX + 1];
    uint32_t bitrate; /* bit/s; 0: none */
};

/* Which frames are for us; own ones only if they are asked for. */
struct wanted {
    struct co_lock lock;                        /* of the thread that waits, and those that set */
    struct bus_filter filters[BUS_FILTERS_MAX]; /* its own memory: setting them cannot fail */
    size_t filter_count;
    bool own_frames;
};

struct bus_virtual {
    struct bus bus;
    struct segment segment;
    struct wanted wanted;
    uint64_t cursor; /* number of the next frame to read */
    uint64_t lost;   /* not yet told */
    uint64_t ticket; /* the last one used: our number and a counter */
    unsigned slot;
    uint32_t number;
    int socket;        /* gets the bytes that wake us, sends those that wake others */
    int wake;          /* eventfd of bus_wake() */
    bool stuck;        /* the receiving thread found the bus held */
    _Atomic bool held; /* the last attempt to lock failed */
};

static struct bus_virtual *to_virtual(struct bus *bus)
{
    return (struct bus_virtual *)bus;
}

static void virtual_wake(struct bus *bus)
{
    const uint64_t one = 1;
    ssize_t size = write(to_virtual(bus)->wake, &one, sizeof one);

    (void)size; /* EAGAIN: 2^64 - 2 wake-ups are pending, one more says nothing new */
}

/*
 * Waits for a stopped holder once, and only tries from then on. Whichever thread finds the bus free
 * again, the receiving one is told: its state has changed.
 */
static enum co_err lock_segment(struct bus_virtual *self)
{
    co_us_t limit = atomic_load(&self->held) ? 0 : SEGMENT_HOLD_LIMIT;
    enum co_err err = segment_lock(&self->segment, limit);

    if (atomic_exchange(&self->held, err == CO_ERR_HELD) && err == CO_OK)
        virtual_wake(&self->bus);
    return err;
}

static bool is_wanted(struct bus_virtual *self, const struct co_frame *frame, bool is_own)
{
    struct wanted *wanted = &self->wanted;
    bool result;

    lock_take(&wanted->lock);
    result = (!is_own || wanted->own_frames) &&
             bus_filters_pass(wanted->filter_count > 0 ? wanted->filters : NULL,
                              wanted->filter_count, frame);
    lock_give(&wanted->lock);
    return result;
}

/* --- sending --- */

static void wake_participant(struct bus_virtual *self, unsigned index)
{
    struct segment_slot *slot = &self->segment.map->slots[index];
    uint64_t ticket = atomic_load(&slot->ticket);
    uint32_t number;
    struct sockaddr_un address;
    socklen_t length;
    ssize_t sent;

    if (ticket == 0)
        return;
    number = atomic_load(&slot->number);
    if (number == 0)
        return;
    length = segment_address(&self->segment, number, &address);
    sent = sendto(self->socket, "", 1, MSG_DONTWAIT | MSG_NOSIGNAL,
                  (const struct sockaddr *)&address, length);
    if (sent < 0 && errno == ECONNREFUSED)
        segment_free_slot(&self->segment, index, number);
    if (sent == 1)
        atomic_compare_exchange_strong(&slot->ticket, &ticket, 0);
}

static void wake_participants(struct bus_virtual *self, const struct co_frame *frame)
{
    unsigned count = atomic_load_explicit(&self->segment.map->slots_used, memory_order_relaxed);

    for (unsigned i = 0; i < count && i < SEGMENT_SLOTS; i++) {
        if (i != self->slot || is_wanted(self, frame, true))
            wake_participant(self, i);
    }
}

static enum co_err virtual_send(struct bus *bus, const struct co_frame *frame)
{
    struct bus_virtual *self = to_virtual(bus);
    struct segment_frame record = { .frame = *frame, .slot = self->slot };
    bool news = true; /* for those who sleep */
    enum co_err err = lock_segment(self);

    if (err)
        return err;
    record.frame.flags &= CO_FRAME_EXT | CO_FRAME_RTR;
    record.time = clock_now(); /* in the order of the frames */
    if (self->segment.bitrate != 0)
        err = segment_offer(&self->segment, &record, &news);
    else
        segment_append(&self->segment, &record);
    segment_unlock(&self->segment);
    if (!err && news)
        wake_participants(self, &record.frame);
    return err;
}

/* --- receiving --- */

/* A bus held by a stopped process stands still: its frames come when it goes on. */
static void move_frames_on(struct bus_virtual *self)
{
    if (self->segment.bitrate == 0)
        return;
    self->stuck = segment_lock(&self->segment, self->stuck ? 0 : HELD_LIMIT) != CO_OK;
    if (self->stuck)
        return;
    segment_move_on(&self->segment, clock_now());
    segment_unlock(&self->segment);
}

/* False: there is none by now. */
static bool read_next(struct bus_virtual *self, uint64_t *cursor, uint64_t *lost,
                      struct segment_frame *ret_record)
{
    co_us_t due;

    if (segment_read(&self->segment, cursor, lost, ret_record))
        return true;
    due = segment_due(&self->segment);
    if (due == CO_NEVER || due > clock_now())
        return false;
    move_frames_on(self);
    return segment_read(&self->segment, cursor, lost, ret_record);
}

static enum co_err virtual_receive(struct bus *bus, struct bus_rx *ret_rx)
{
    struct bus_virtual *self = to_virtual(bus);
    struct segment_frame record = { .slot = 0 };

    do {
        if (!read_next(self, &self->cursor, &self->lost, &record))
            return CO_ERR_AGAIN;
    } while (!is_wanted(self, &record.frame, record.slot == self->slot));
    ret_rx->frame = record.frame;
    if (record.slot == self->slot)
        ret_rx->frame.flags |= CO_FRAME_OWN;
    else
        ret_rx->frame.tag = 0;
    ret_rx->time = record.time;
    ret_rx->lost = self->lost < UINT_MAX ? (unsigned)self->lost : UINT_MAX;
    self->lost = 0;
    return CO_OK;
}

/* True if a frame for us is there; those that are not are left behind. */
static bool has_frame(struct bus_virtual *self)
{
    struct segment_frame record = { .slot = 0 };
    uint64_t next = self->cursor;
    uint64_t lost = self->lost;

    while (read_next(self, &next, &lost, &record)) {
        if (is_wanted(self, &record.frame, record.slot == self->slot))
            return true;
        self->cursor = next;
        self->lost = lost;
    }
    self->cursor = next;
    self->lost = lost;
    return false;
}

static bool virtual_has_fetched(struct bus *bus)
{
    return has_frame(to_virtual(bus));
}

static void drain_socket(int fd)
{
    char byte;

    for (unsigned i = 0; i < WAKE_BYTES_MAX && recv(fd, &byte, 1, MSG_DONTWAIT) >= 0; i++)
        ;
}

static bool take_wake(int fd)
{
    uint64_t count;

    return read(fd, &count, sizeof count) == (ssize_t)sizeof count;
}

/* When a frame will be through of which nobody will tell; to be asked with the ticket stored. */
static co_us_t next_look(struct bus_virtual *self)
{
    co_us_t due = segment_due(&self->segment);

    return self->stuck ? clock_now() + HELD_LIMIT : due;
}

/* Sleeps until somebody may have sent or the deadline. */
static enum co_err sleep_until(struct bus_virtual *self, co_us_t deadline, bool *ret_woken)
{
    struct bus_poll poll = { .fd = { self->socket, self->wake, -1 } };
    struct segment_slot *slot = &self->segment.map->slots[self->slot];
    enum co_err err = CO_OK;

    atomic_store(&slot->ticket, ++self->ticket);
    if (segment_is_drained(&self->segment, self->cursor))
        err = bus_poll_until(&poll, co_earlier(deadline, next_look(self)));
    atomic_store(&slot->ticket, 0);
    if (poll.readable[0])
        drain_socket(self->socket);
    *ret_woken = poll.readable[1] && take_wake(self->wake);
    return err;
}

/* --- what is wanted --- */

static enum co_err virtual_set_filters(struct bus *bus, const struct bus_filter *filters,
                                       size_t count)
{
    struct wanted *wanted = &to_virtual(bus)->wanted;

    lock_take(&wanted->lock);
    if (count > 0)
        memcpy(wanted->filters, filters, count * sizeof *filters);
    wanted->filter_count = count;
    lock_give(&wanted->lock);
    return CO_OK;
}

static enum co_err virtual_set_own_frames(struct bus *bus, bool on)
{
    struct wanted *wanted = &to_virtual(bus)->wanted;

    lock_take(&wanted->lock);
    wanted->own_frames = on;
    lock_give(&wanted->lock);
    return CO_OK;
}

/* Nobody but the participants is there to send. */
static enum co_err virtual_set_cyclic(struct bus *bus, const struct co_frame *frames,
                                      unsigned count, co_us_t period)
{
    (void)bus;
    (void)frames;
    (void)period;
    return count > 0 ? CO_ERR_UNSUPPORTED : CO_OK;
}

/* --- state --- */

static unsigned virtual_backlog(struct bus *bus)
{
    const struct bus_virtual *self = to_virtual(bus);

    return atomic_load(&self->segment.map->slots[self->slot].pending);
}

static enum bus_state virtual_get_state(struct bus *bus)
{
    struct bus_virtual *self = to_virtual(bus);

    if (!atomic_load(&self->held))
        return BUS_ACTIVE;
    if (lock_segment(self) != CO_OK)
        return BUS_DOWN;
    segment_unlock(&self->segment);
    return BUS_ACTIVE;
}

/* True if the bus that was held by somebody is free. */
static bool is_free_again(struct bus_virtual *self)
{
    return atomic_load(&self->held) && virtual_get_state(&self->bus) == BUS_ACTIVE;
}

static enum co_err virtual_wait(struct bus *bus, co_us_t deadline)
{
    struct bus_virtual *self = to_virtual(bus);
    bool woken = false;

    while (!has_frame(self)) {
        co_us_t limit = atomic_load(&self->held) ? HELD_LOOK : SLEEP_LIMIT;
        enum co_err err = sleep_until(self, co_earlier(deadline, clock_now() + limit), &woken);

        if (woken)
            return CO_OK;
        if (err && err != CO_ERR_TIMEOUT)
            return err;
        if (err) /* also for what a sender was killed with before it could tell when to look */
            move_frames_on(self);
        if (is_free_again(self))
            return CO_OK;
        if (clock_now() >= deadline)
            return has_frame(self) ? CO_OK : CO_ERR_TIMEOUT;
    }
    return CO_OK;
}

static enum co_err explain_hold(const struct segment *segment, const struct bus_message *message)
{
    unsigned pid = atomic_load(&segment->map->holder);

    return bus_fail(message, CO_ERR_HELD,
                    "virtual bus %s is held by pid %u, which is stopped; continue or kill it",
                    segment->name, pid);
}

static void explain_rate(const struct segment *segment, const struct bus_message *message)
{
    if (segment->bitrate != 0)
        bus_fail(message, CO_OK, "virtual bus %s is up, %u bit/s", segment->name, segment->bitrate);
    else
        bus_fail(message, CO_OK, "virtual bus %s is up", segment->name);
}

static void virtual_explain(struct bus *bus, char *text, size_t size)
{
    const struct bus_message message = { text, size };

    if (virtual_get_state(bus) == BUS_DOWN)
        explain_hold(&to_virtual(bus)->segment, &message);
    else
        explain_rate(&to_virtual(bus)->segment, &message);
}

/* --- opening and closing --- */

static void free_virtual(struct bus_virtual *self)
{
    lock_done(&self->wanted.lock);
    free(self);
}

static void virtual_close(struct bus *bus)
{
    struct bus_virtual *self = to_virtual(bus);

    segment_free_slot(&self->segment, self->slot, self->number);
    close(self->socket);
    close(self->wake);
    segment_close(&self->segment);
    free_virtual(self);
}

static const struct bus_ops virtual_ops = { .close = virtual_close,
                                            .send = virtual_send,
                                            .receive = virtual_receive,
                                            .has_fetched = virtual_has_fetched,
                                            .wait = virtual_wait,
                                            .wake = virtual_wake,
                                            .set_filters = virtual_set_filters,
                                            .set_own_frames = virtual_set_own_frames,
                                            .set_cyclic = virtual_set_cyclic,
                                            .backlog = virtual_backlog,
                                            .get_state = virtual_get_state,
                                            .explain = virtual_explain };

/* A number whose address nobody has bound: a forked child may hold one longer than its bus. */
static enum co_err bind_address(struct bus_virtual *self)
{
    struct sockaddr_un address;

    for (unsigned tries = 0; tries < 2 * SEGMENT_SLOTS; tries++) {
        uint32_t number = self->segment.map->next_number++;
        socklen_t length = segment_address(&self->segment, number, &address);

        if (number != 0 && bind(self->socket, (struct sockaddr *)&address, length) == 0) {
            self->number = number;
            return CO_OK;
        }
    }
    return CO_ERR_IO;
}

static enum co_err register_locked(struct bus_virtual *self, const struct bus_message *message)
{
    if (self->segment.bitrate != 0) /* what was before is not for us */
        segment_move_on(&self->segment, clock_now());
    if (segment_find_slot(&self->segment, &self->slot) != CO_OK) {
        return bus_fail(message, CO_ERR_MEMORY,
                        "virtual bus %s has %u participants, there is no room for another",
                        self->segment.name, SEGMENT_SLOTS);
    }
    if (bind_address(self) != CO_OK)
        return bus_fail(message, CO_ERR_IO, "virtual bus %s: cannot bind a socket: %s",
                        self->segment.name, strerror(errno));
    self->ticket = (uint64_t)self->number << 32;
    self->cursor = atomic_load(&self->segment.map->head);
    segment_take_slot(&self->segment, self->slot, self->number);
    return CO_OK;
}

static enum co_err register_participant(struct bus_virtual *self, const struct bus_message *message)
{
    enum co_err err = segment_lock(&self->segment, SEGMENT_HOLD_LIMIT);

    if (err == CO_ERR_HELD)
        return explain_hold(&self->segment, message);
    if (err)
        return bus_fail(message, err, "virtual bus %s: %s is damaged; remove it",
                        self->segment.name, self->segment.path);
    err = register_locked(self, message);
    segment_unlock(&self->segment);
    return err;
}

static enum co_err open_descriptors(struct bus_virtual *self, const struct bus_message *message)
{
    self->socket = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    self->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (self->socket >= 0 && self->wake >= 0)
        return CO_OK;
    return bus_fail(message, CO_ERR_IO, "virtual bus %s: %s", self->segment.name, strerror(errno));
}

static void close_descriptors(const struct bus_virtual *self)
{
    if (self->socket >= 0)
        close(self->socket);
    if (self->wake >= 0)
        close(self->wake);
}

static enum co_err open_parts(struct bus_virtual *self, const struct bus_name_parts *parts,
                              const struct bus_message *message)
{
    enum co_err err = segment_open(&self->segment, parts->name, parts->bitrate, message);

    if (err)
        return err;
    err = open_descriptors(self, message);
    if (!err)
        err = register_participant(self, message);
    if (err) {
        close_descriptors(self);
        segment_close(&self->segment);
    }
    return err;
}

/* "500000" */
static bool parse_bitrate(const char *text, uint32_t *ret_bitrate)
{
    uint32_t bitrate = 0;

    for (; *text >= '0' && *text <= '9' && bitrate <= BITRATE_MAX; text++)
        bitrate = 10 * bitrate + (uint32_t)(*text - '0');
    if (*text != '\0' || bitrate < BITRATE_MIN || bitrate > BITRATE_MAX)
        return false;
    *ret_bitrate = bitrate;
    return true;
}

/* "NAME" or "NAME?bitrate=N" */
static enum co_err split_name(const char *text, struct bus_name_parts *ret_parts,
                              const struct bus_message *message)
{
    size_t length = strcspn(text, "?");

    ret_parts->bitrate = 0;
    snprintf(ret_parts->name, sizeof ret_parts->name, "%.*s", (int)length, text);
    if (length >= sizeof ret_parts->name || !segment_name_is_valid(ret_parts->name)) {
        return bus_fail(message, CO_ERR_ARG,
                        "\"%s\" cannot name a virtual bus: 1 to %u letters, digits, '-', '_', '.'",
                        text, SEGMENT_NAME_MAX);
    }
    if (text[length] == '\0')
        return CO_OK;
    text += length;
    if (strncmp(text, BITRATE_OPTION, strlen(BITRATE_OPTION)) == 0 &&
        parse_bitrate(text + strlen(BITRATE_OPTION), &ret_parts->bitrate))
        return CO_OK;
    return bus_fail(message, CO_ERR_ARG,
                    "virtual bus %s: \"%s\" is not " BITRATE_OPTION "N, with N from %u to %u bit/s",
                    ret_parts->name, text, BITRATE_MIN, BITRATE_MAX);
}

/* kbit: as configured, 0: any will do; the bus without a bit rate suits all. */
static enum co_err check_configured(const struct bus_name_parts *parts, unsigned kbit,
                                    const struct bus_message *message)
{
    if (parts->bitrate == 0 || kbit == 0 || parts->bitrate == (uint64_t)kbit * 1000u)
        return CO_OK;
    return bus_fail(message, CO_ERR_BITRATE,
                    "virtual bus %s is to run at %u bit/s, but the network is configured for %u "
                    "kbit/s; open it as \"virtual:%s" BITRATE_OPTION "%u000\"",
                    parts->name, parts->bitrate, kbit, parts->name, kbit);
}

static struct bus_virtual *new_virtual(bool own_frames)
{
    struct bus_virtual *self = calloc(1, sizeof *self);

    if (!self)
        return NULL;
    if (lock_init(&self->wanted.lock) != CO_OK) {
        free(self);
        return NULL;
    }
    self->bus.ops = &virtual_ops;
    self->wanted.own_frames = own_frames;
    return self;
}

enum co_err bus_virtual_open(const char *name, const struct bus_options *options,
                             struct bus **ret_bus, const struct bus_message *message)
{
    struct bus_name_parts parts;
    struct bus_virtual *self;
    enum co_err err = split_name(name, &parts, message);

    if (!err)
        err = check_configured(&parts, options->bitrate, message);
    if (err)
        return err;
    self = new_virtual(options->own_frames);
    if (!self)
        return bus_fail(message, CO_ERR_MEMORY, "virtual bus %s: out of memory", parts.name);
    err = open_parts(self, &parts, message);
    if (err) {
        free_virtual(self);
        return err;
    }
    *ret_bus = &self->bus;
    return CO_OK;
}

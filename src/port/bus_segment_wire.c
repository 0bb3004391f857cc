/*
 * The wire of bus_segment.h: frames wait for it, the highest priority goes first, each takes its
 * time. Times are in ns here, in which each bit of the usual rates is a whole number; times of
 * reception are rounded up to us.
 */
#include "port/bus_segment.h"

#include "port/bus_timing.h"

#define NS_PER_S  UINT64_C(1000000000)
#define NS_PER_US 1000u

_Static_assert(SEGMENT_SLOTS *SEGMENT_PENDING < 0xFFFF, "an index of pending fits in 'moving'");

/* --- the pending frames --- */

/* The first one from *index on; false: there is none. */
static bool find_pending(const struct segment_map *map, unsigned *index)
{
    unsigned used = atomic_load_explicit(&map->slots_used, memory_order_relaxed);
    unsigned end = (used < SEGMENT_SLOTS ? used : SEGMENT_SLOTS) * SEGMENT_PENDING;

    while (*index < end) {
        const struct segment_slot *slot = &map->slots[*index / SEGMENT_PENDING];
        uint32_t rest = atomic_load_explicit(&slot->pending, memory_order_relaxed) >>
                        *index % SEGMENT_PENDING;

        if (rest & 1u)
            return true;
        *index += rest ? 1u : SEGMENT_PENDING - *index % SEGMENT_PENDING;
    }
    return false;
}

static bool is_before(const struct segment_pending *a, const struct segment_pending *b)
{
    return a->priority != b->priority ? a->priority < b->priority : a->order < b->order;
}

/* When the next frame starts, or has started: the wire is free and somebody wants it. */
static uint64_t next_start(const struct segment_map *map)
{
    uint64_t first = CO_NEVER;

    for (unsigned index = 0; find_pending(map, &index); index++)
        first = co_earlier(first, map->pending[index].sent);
    return first > map->wire.free ? first : map->wire.free;
}

/* Which one that is; NULL: nothing is pending. */
static const struct segment_pending *find_winner(const struct segment_map *map, uint64_t *ret_end)
{
    const struct segment_pending *winner = NULL;
    uint64_t start = next_start(map);

    for (unsigned index = 0; find_pending(map, &index); index++) {
        const struct segment_pending *entry = &map->pending[index];

        if (entry->sent <= start && (!winner || is_before(entry, winner)))
            winner = entry;
    }
    if (winner)
        *ret_end = start + winner->length;
    return winner;
}

/* --- to the ring --- */

/* The rest of a move, as often as you like. Nothing to do where the frame is not in the ring. */
static void finish_move(struct segment_map *map)
{
    uint64_t moving = atomic_load(&map->wire.moving);
    bool appended = (atomic_load(&map->head) & UINT64_MAX >> 16) != moving >> 16;
    unsigned index;

    if (moving != 0 && appended) {
        index = (unsigned)(moving & 0xFFFFu) - 1;
        map->wire.free = map->wire.moving_free;
        atomic_fetch_and(&map->slots[index / SEGMENT_PENDING].pending,
                         ~(1u << index % SEGMENT_PENDING));
    }
    atomic_store(&map->wire.moving, 0);
}

static void move(struct segment *self, const struct segment_pending *entry, uint64_t end)
{
    struct segment_map *map = self->map;
    const struct segment_frame frame = { .frame = entry->frame,
                                         .time = (end + NS_PER_US - 1) / NS_PER_US,
                                         .slot = entry->slot };
    uint64_t index = (uint64_t)(entry - map->pending);

    map->wire.moving_free = end;
    atomic_store(&map->wire.moving, atomic_load(&map->head) << 16 | (index + 1));
    segment_append(self, &frame);
    finish_move(map);
}

void segment_move_on(struct segment *self, co_us_t now)
{
    struct segment_map *map = self->map;
    const struct segment_pending *winner;
    uint64_t end = 0;

    while ((winner = find_winner(map, &end)) && end <= now * NS_PER_US)
        move(self, winner, end);
    atomic_store(&map->wire.due, winner ? (end + NS_PER_US - 1) / NS_PER_US : CO_NEVER);
}

void segment_mend_wire(struct segment *self)
{
    finish_move(self->map);
    segment_move_on(self, 0); /* which tells when to look */
}

/* --- from the participants --- */

static void fill_pending(struct segment_map *map, struct segment_pending *entry,
                         const struct segment_frame *frame)
{
    uint64_t bits = bus_frame_bits(&frame->frame);

    entry->order = map->wire.next_order++;
    entry->sent = frame->time * NS_PER_US;
    entry->length = (uint32_t)((bits * NS_PER_S + map->wire.bitrate / 2) / map->wire.bitrate);
    entry->priority = bus_frame_priority(&frame->frame);
    entry->slot = frame->slot;
    entry->frame = frame->frame;
}

enum co_err segment_offer(struct segment *self, const struct segment_frame *frame, bool *ret_sooner)
{
    struct segment_map *map = self->map;
    struct segment_slot *slot = &map->slots[frame->slot];
    co_us_t due;
    uint32_t used;
    unsigned entry = 0;

    segment_move_on(self, frame->time);
    due = atomic_load(&map->wire.due);
    used = atomic_load(&slot->pending);
    while (entry < SEGMENT_PENDING && (used >> entry & 1u))
        entry++;
    if (entry == SEGMENT_PENDING)
        return CO_ERR_AGAIN;
    fill_pending(map, &map->pending[frame->slot * SEGMENT_PENDING + entry], frame);
    atomic_store(&slot->pending, used | 1u << entry);
    segment_move_on(self, frame->time);
    *ret_sooner = atomic_load(&map->wire.due) < due;
    return CO_OK;
}

void segment_disown_pending(struct segment *self, unsigned slot)
{
    for (unsigned i = 0; i < SEGMENT_PENDING; i++)
        self->map->pending[slot * SEGMENT_PENDING + i].slot = SEGMENT_NOBODY;
}

co_us_t segment_due(struct segment *self)
{
    return self->map->wire.bitrate ? atomic_load(&self->map->wire.due) : CO_NEVER;
}

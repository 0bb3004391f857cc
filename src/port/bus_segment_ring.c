/* The ring of bus_segment.h: appending under the lock, reading without one. */
#include "port/bus_segment.h"

#include "base/bytes.h"

/* 63..32 identifier, 31..24 slot, 23..16 flags, 15..8 dlc, 7..0 tag */
static uint64_t pack_head(const struct segment_frame *frame)
{
    return (uint64_t)frame->frame.id << 32 | (uint64_t)(frame->slot & 0xFFu) << 24 |
           (uint64_t)frame->frame.flags << 16 | (uint64_t)frame->frame.dlc << 8 | frame->frame.tag;
}

static void unpack_head(uint64_t head, struct segment_frame *ret_frame)
{
    ret_frame->frame.id = (uint32_t)(head >> 32);
    ret_frame->slot = head >> 24 & 0xFFu;
    ret_frame->frame.flags = (uint8_t)(head >> 16);
    ret_frame->frame.dlc = (uint8_t)(head >> 8);
    ret_frame->frame.tag = (uint8_t)head;
}

/*
 * Release order for each word, and acquire order in copy_record(): who sees a word of the new
 * frame also sees that the number has changed.
 */
void segment_append(struct segment *self, const struct segment_frame *frame)
{
    uint64_t number = atomic_load_explicit(&self->map->head, memory_order_relaxed);
    struct segment_record *record = &self->map->ring[number % SEGMENT_RECORDS];

    atomic_store_explicit(&record->number, 0, memory_order_relaxed);
    atomic_store_explicit(&record->time, frame->time, memory_order_release);
    atomic_store_explicit(&record->head, pack_head(frame), memory_order_release);
    atomic_store_explicit(&record->data, get_le(frame->frame.data, 8), memory_order_release);
    atomic_store_explicit(&record->number, number + 1, memory_order_release);
    atomic_store(&self->map->head, number + 1); /* sequentially consistent: tickets are next */
}

static bool copy_record(const struct segment_record *record, uint64_t number,
                        struct segment_frame *ret_frame)
{
    uint64_t head, data;

    if (atomic_load_explicit(&record->number, memory_order_acquire) != number + 1)
        return false;
    ret_frame->time = atomic_load_explicit(&record->time, memory_order_acquire);
    head = atomic_load_explicit(&record->head, memory_order_acquire);
    data = atomic_load_explicit(&record->data, memory_order_acquire);
    if (atomic_load_explicit(&record->number, memory_order_relaxed) != number + 1)
        return false;
    unpack_head(head, ret_frame);
    put_le(ret_frame->frame.data, 8, data);
    return true;
}

bool segment_read(struct segment *self, uint64_t *cursor, uint64_t *lost,
                  struct segment_frame *ret_frame)
{
    uint64_t head = atomic_load_explicit(&self->map->head, memory_order_acquire);

    for (; *cursor != head; head = atomic_load_explicit(&self->map->head, memory_order_acquire)) {
        if (head - *cursor > SEGMENT_RECORDS) {
            *lost += head - SEGMENT_RECORDS - *cursor;
            *cursor = head - SEGMENT_RECORDS;
        }
        if (copy_record(&self->map->ring[*cursor % SEGMENT_RECORDS], *cursor, ret_frame)) {
            (*cursor)++;
            return true;
        }
        (*cursor)++; /* overwritten just now, or begun to be by a writer that was killed */
        (*lost)++;
    }
    return false;
}

bool segment_is_drained(struct segment *self, uint64_t cursor)
{
    return atomic_load(&self->map->head) == cursor;
}

#include "slave/slave_internal.h"

#include "base/bytes.h"

/* What an entry's COB-ID belongs to. RPDOs may share one: a frame is for all of them. */
enum user { NOBODY, RECEIVER, OTHER };

/* When a COB-ID is in use. */
enum use { ALWAYS, UNLESS_INVALID, IF_TAKING_PART };

static const struct holder {
    uint16_t first, last;
    uint8_t first_sub, last_sub;
    enum use use;
    enum user user;
} holders[] = {
    { 0x1005, 0x1005, 0, 0, ALWAYS, OTHER },
    { 0x1012, 0x1012, 0, 0, IF_TAKING_PART, OTHER },
    { 0x1014, 0x1014, 0, 0, UNLESS_INVALID, OTHER },
    { 0x1201, 0x12FF, 1, 2, UNLESS_INVALID, OTHER },
    { 0x1400, 0x15FF, 1, 1, UNLESS_INVALID, RECEIVER },
    { 0x1800, 0x19FF, 1, 1, UNLESS_INVALID, OTHER },
};

static bool is_used(enum use use, uint64_t cob_id)
{
    switch (use) {
    case ALWAYS: break;
    case UNLESS_INVALID: return (cob_id & COB_ID_INVALID) == 0;
    case IF_TAKING_PART: return (cob_id & (COB_ID_INVALID | COB_ID_BIT30)) != 0;
    }
    return true;
}

static bool is_held_by(const struct od_entry *entry, const struct holder *holder)
{
    return entry->index >= holder->first && entry->index <= holder->last &&
           entry->sub >= holder->first_sub && entry->sub <= holder->last_sub;
}

static enum user user_of(const struct od_entry *entry, uint64_t cob_id)
{
    for (size_t i = 0; i < sizeof holders / sizeof holders[0]; i++)
        if (is_held_by(entry, &holders[i]))
            return is_used(holders[i].use, cob_id) ? holders[i].user : NOBODY;
    return NOBODY;
}

static uint32_t cob_id_of(const struct od_entry *entry)
{
    return (uint32_t)get_le(entry->value, entry->size < 4 ? entry->size : 4);
}

#define FIRST_CLIENT 0x1280u /* whose servers may have any identifiers */

bool slave_is_permitted(const struct od_entry *entry, uint32_t cob_id)
{
    const struct od nothing = { .count = 0 };

    return user_of(entry, cob_id) == NOBODY ||
           (entry->index >= FIRST_CLIENT && entry->index < FIRST_RPDO_OBJECT) ||
           slave_may_use(&nothing, cob_id & ~(COB_ID_INVALID | COB_ID_BIT30), true);
}

bool slave_can_id_is_taken(const struct slave_write *write)
{
    const uint32_t can_id = slave_can_id((uint32_t)write->number);
    const enum user user = user_of(write->entry, write->number);

    for (size_t i = 0; user != NOBODY && i < write->od->count; i++) {
        const struct od_entry *entry = write->od->entries[i];
        const enum user other = user_of(entry, cob_id_of(entry));

        if (entry != write->entry && other != NOBODY && slave_can_id(cob_id_of(entry)) == can_id &&
            (user != RECEIVER || other != RECEIVER))
            return true;
    }
    return false;
}

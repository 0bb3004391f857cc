#include "slave/slave_internal.h"

#include "base/bytes.h"

/* What an entry's COB-ID belongs to. RPDOs may share one: a frame is for all of them. */
enum user { NOBODY, RECEIVER, OTHER };

static bool is_between(uint16_t index, uint16_t first, uint16_t last)
{
    return index >= first && index <= last;
}

static enum user user_of(const struct od_entry *entry, uint64_t cob_id)
{
    const bool valid = (cob_id & COB_ID_INVALID) == 0;
    const uint16_t index = entry->index;

    if (index == 0x1005 && entry->sub == 0)
        return OTHER;
    if (index == 0x1012 && entry->sub == 0)
        return (cob_id & (COB_ID_INVALID | COB_ID_BIT30)) != 0 ? OTHER : NOBODY;
    if (index == 0x1014 && entry->sub == 0)
        return valid ? OTHER : NOBODY;
    if (is_between(index, 0x1201, 0x12FF) && (entry->sub == 1 || entry->sub == 2))
        return valid ? OTHER : NOBODY;
    if (is_between(index, 0x1400, 0x15FF) && entry->sub == 1)
        return valid ? RECEIVER : NOBODY;
    if (is_between(index, 0x1800, 0x19FF) && entry->sub == 1)
        return valid ? OTHER : NOBODY;
    return NOBODY;
}

static uint32_t cob_id_of(const struct od_entry *entry)
{
    return (uint32_t)get_le(entry->value, entry->size < 4 ? entry->size : 4);
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

/* COB-IDs, SYNC and error control: what devices take only in a certain order. */
#include "dcf/dcf_maker.h"

#define SYNC_COB_ID   0x1005u
#define SYNC_PERIOD   0x1006u
#define SYNC_OVERFLOW 0x1019u
#define SYNC_PRODUCES 0x40000000u
#define COB_INVALID   0x80000000u
#define COB_FRAME     0x3FFFFFFFu /* CAN-ID, and whether it is an extended one */
#define TIME_COB_ID   0x1012u
#define TIME_IN_USE   0xC0000000u /* consumed, produced */
#define CONSUMER      0x1016u
#define CONSUMERS_MAX 127u

static uint64_t initial_number(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    if (!entry || !entry->initial.given)
        return 0;
    return dcf_value_number(&entry->initial, entry->type, self->options->node_id);
}

/* Of an entry that is written. */
static uint64_t new_number(const struct dcf_maker *self, const struct dcf_entry *entry)
{
    const struct dcf_value *value = dcf_maker_value(self, entry);

    return value ? dcf_value_number(value, entry->type, self->options->node_id) : 0;
}

static bool may_write(const struct dcf_entry *entry)
{
    return entry && dcf_entry_downloads(entry);
}

/* TIME, EMCY, its consumers, SDO channels. PDOs are elsewhere. */
static bool is_switched_cob_id(const struct dcf_entry *entry)
{
    if (entry->type != OD_UNSIGNED32)
        return false;
    if (entry->index == 0x1014 || entry->index == TIME_COB_ID)
        return entry->sub == 0;
    if (entry->index == 0x1028)
        return entry->sub != 0;
    return entry->index > 0x1200 && entry->index <= 0x12FF && (entry->sub == 1 || entry->sub == 2);
}

static bool is_in_use(const struct dcf_entry *entry, uint64_t cob_id)
{
    return entry->index == TIME_COB_ID ? (cob_id & TIME_IN_USE) != 0 : (cob_id & COB_INVALID) == 0;
}

static uint64_t switched_off(const struct dcf_entry *entry, uint64_t cob_id)
{
    return entry->index == TIME_COB_ID ? cob_id & ~(uint64_t)TIME_IN_USE : cob_id | COB_INVALID;
}

/* A device refuses another CAN-ID as long as the old one is in use. */
static bool changes_in_use(const struct dcf_entry *entry, uint64_t before, uint64_t after)
{
    return entry->initial.given && ((before ^ after) & COB_FRAME) != 0 &&
           is_in_use(entry, before) && is_in_use(entry, after);
}

void dcf_maker_put_single(struct dcf_maker *self, const struct dcf_entry *entry)
{
    uint64_t after = new_number(self, entry);

    if (is_switched_cob_id(entry) && changes_in_use(entry, initial_number(self, entry), after))
        dcf_maker_put_number(self, entry, switched_off(entry, after));
    dcf_maker_put(self, entry);
}

/* A producing device refuses another identifier or counter: it is switched off first. */
static bool must_stop(const struct dcf_maker *self, const struct dcf_entry *cob_id)
{
    uint64_t initial = initial_number(self, cob_id);
    bool other_id;

    if (!may_write(cob_id) || !(initial & SYNC_PRODUCES))
        return false;
    other_id = dcf_maker_writes(self, cob_id) &&
               ((new_number(self, cob_id) ^ initial) & ~(uint64_t)SYNC_PRODUCES) != 0;
    return other_id || dcf_maker_find(self, SYNC_OVERFLOW, 0);
}

/* Writes the entry; if 'restore', one without a ParameterValue gets its DefaultValue back. */
static void put_or_restore(struct dcf_maker *self, const struct dcf_entry *entry, bool restore)
{
    if (!entry)
        return;
    if (dcf_maker_writes(self, entry))
        dcf_maker_put(self, entry);
    else if (restore)
        dcf_maker_put_number(self, entry, initial_number(self, entry));
}

void dcf_maker_put_sync(struct dcf_maker *self)
{
    const struct dcf_entry *cob_id = dcf_find(self->dcf, SYNC_COB_ID, 0);
    const struct dcf_entry *period = dcf_find(self->dcf, SYNC_PERIOD, 0);
    const struct dcf_entry *overflow = dcf_maker_find(self, SYNC_OVERFLOW, 0);
    bool stop = must_stop(self, cob_id);
    bool clear = overflow && may_write(period) && (stop || initial_number(self, period) != 0);

    if (stop)
        dcf_maker_put_number(self, cob_id, initial_number(self, cob_id) & ~(uint64_t)SYNC_PRODUCES);
    if (clear)
        dcf_maker_put_number(self, period, 0);
    put_or_restore(self, overflow, false);
    put_or_restore(self, period, clear);
    put_or_restore(self, cob_id, stop);
}

static uint64_t node_of(uint64_t consumer)
{
    return (consumer & 0xFFFF) != 0 ? consumer >> 16 & 0x7F : 0;
}

/* True if a sub-index gets a node that a later one still watches: devices refuse that. */
static bool consumers_collide(const struct dcf_maker *self)
{
    bool given[128] = { false };

    for (uint8_t sub = 1; sub <= CONSUMERS_MAX; sub++) {
        const struct dcf_entry *entry = dcf_maker_find(self, CONSUMER, sub);

        if (!entry)
            continue;
        if (given[node_of(initial_number(self, entry))])
            return true;
        if (node_of(new_number(self, entry)) != 0)
            given[node_of(new_number(self, entry))] = true;
    }
    return false;
}

static void put_consumers(struct dcf_maker *self)
{
    bool collide = consumers_collide(self);

    for (uint8_t sub = 1; collide && sub <= CONSUMERS_MAX; sub++) {
        if (dcf_maker_find(self, CONSUMER, sub))
            dcf_maker_put_number(self, dcf_maker_find(self, CONSUMER, sub), 0);
    }
    for (uint8_t sub = 0; sub <= CONSUMERS_MAX; sub++) {
        if (dcf_maker_find(self, CONSUMER, sub))
            dcf_maker_put(self, dcf_maker_find(self, CONSUMER, sub));
    }
}

void dcf_maker_put_error_control(struct dcf_maker *self)
{
    put_or_restore(self, dcf_maker_find(self, 0x100C, 0), false);
    put_or_restore(self, dcf_maker_find(self, 0x100D, 0), false);
    put_consumers(self);
    put_or_restore(self, dcf_maker_find(self, 0x1017, 0), false);
}

#include "slave/slave_internal.h"

#include <string.h>

#define CAN_ID_MASK  0x000007FFu /* of a COB-ID */
#define CAN_ID_UPPER 0x1FFFF800u
#define FROZEN_BITS  0x3FFFFFFFu /* must not change while the communication object exists */

#define SAVE 0x65766173u /* signatures of 1010h and 1011h */
#define LOAD 0x64616F6Cu

#define ON_COMMAND 0x01u /* bit of 1010h and 1011h */

struct range {
    uint32_t first, last;
};

static bool in_ranges(uint32_t value, const struct range *ranges, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (value >= ranges[i].first && value <= ranges[i].last)
            return true;
    return false;
}

/* Identifiers that belong to services which cannot be configured (CiA 301, 7.3.5). */
static bool is_restricted(uint32_t can_id)
{
    static const struct range restricted[] = {
        { 0x000, 0x07F }, { 0x101, 0x180 }, { 0x581, 0x5FF },
        { 0x601, 0x67F }, { 0x6E0, 0x6FF }, { 0x701, 0x7FF }
    };

    return in_ranges(can_id, restricted, sizeof restricted / sizeof restricted[0]);
}

/* A client's channel to the default server of another node. */
static bool is_default_sdo(uint32_t can_id)
{
    static const struct range ranges[] = { { 0x581, 0x5FF }, { 0x601, 0x67F } };

    return in_ranges(can_id, ranges, sizeof ranges / sizeof ranges[0]);
}

static bool is_base_frame(uint64_t cob_id)
{
    return (cob_id & (COB_ID_EXT | CAN_ID_UPPER)) == 0;
}

bool slave_is_default(const struct od_entry *entry, const uint8_t *value, uint32_t size)
{
    return entry->initial != NULL && entry->initial_size == size && size > 0 &&
           memcmp(entry->initial, value, size) == 0;
}

/* SYNC and PDOs may have 29-bit identifiers, which are restricted nowhere. */
enum frames { BASE_FRAMES, ALL_FRAMES };

static bool is_permitted(uint64_t cob_id, enum frames frames)
{
    if ((cob_id & COB_ID_EXT) != 0)
        return frames == ALL_FRAMES;
    return is_base_frame(cob_id) && !is_restricted((uint32_t)(cob_id & CAN_ID_MASK));
}

bool slave_may_use(const struct od *od, uint32_t cob_id, bool transmit)
{
    struct od_entry entry = { .index = transmit ? 0x1800 : 0x1400, .sub = 1 };
    const struct slave_write write = { .od = od, .entry = &entry, .number = cob_id };

    return (cob_id & COB_ID_INVALID) != 0 ||
           (is_permitted(cob_id, ALL_FRAMES) && !slave_can_id_is_taken(&write));
}

static uint64_t present(const struct slave_write *write)
{
    return od_number(write->od, write->entry->index, write->entry->sub, 0);
}

static bool changes(const struct slave_write *write, uint64_t bits)
{
    return ((present(write) ^ write->number) & bits) != 0;
}

/* Some devices come with identifiers that nobody may give them, or with one for two objects: what
 * is there can be written back. */
static sdo_abort_t check_can_id(const struct slave_write *write, enum frames frames)
{
    const bool own = slave_is_default(write->entry, write->value, write->size);

    if (!changes(write, UINT64_MAX))
        return SDO_OK;
    if (slave_can_id_is_taken(write))
        return SDO_INVALID_VALUE;
    return own || is_permitted(write->number, frames) ? SDO_OK : SDO_INVALID_VALUE;
}

/* Bits that are reserved, but kept where the device description has them set. */
static bool sets(const struct slave_write *write, uint64_t bit)
{
    return (write->number & ~present(write) & bit) != 0;
}

/* SYNC and TIME exist on their own; the bits tell whether the device takes part. */
static sdo_abort_t check_broadcast_cob_id(const struct slave_write *write, uint64_t taking_part,
                                          enum frames frames)
{
    if ((write->number & taking_part) != 0 && (present(write) & taking_part) != 0 &&
        changes(write, FROZEN_BITS & ~taking_part))
        return SDO_INVALID_VALUE;
    return check_can_id(write, frames);
}

static sdo_abort_t check_sync(const struct slave_write *write)
{
    return check_broadcast_cob_id(write, COB_ID_BIT30, ALL_FRAMES);
}

static sdo_abort_t check_time(const struct slave_write *write)
{
    return check_broadcast_cob_id(write, COB_ID_BIT30 | COB_ID_INVALID, BASE_FRAMES);
}

/* Of an object that bit 31 switches off: then its CAN-ID means nothing. */
static sdo_abort_t check_switched_cob_id(const struct slave_write *write, enum frames frames)
{
    if ((write->number & COB_ID_INVALID) != 0)
        return SDO_OK;
    if ((present(write) & COB_ID_INVALID) == 0 && changes(write, FROZEN_BITS))
        return SDO_INVALID_VALUE;
    return check_can_id(write, frames);
}

static sdo_abort_t check_emcy(const struct slave_write *write)
{
    return sets(write, COB_ID_BIT30) ? SDO_INVALID_VALUE
                                     : check_switched_cob_id(write, BASE_FRAMES);
}

static sdo_abort_t check_emcy_consumer(const struct slave_write *write)
{
    return write->entry->sub == 0 ? SDO_OK : check_emcy(write);
}

static sdo_abort_t check_history(const struct slave_write *write)
{
    if (write->entry->sub != 0)
        return SDO_READ_ONLY;
    return write->number == 0 ? SDO_OK : SDO_INVALID_VALUE;
}

/* Many files give no DefaultValue: 0 does not say that the device cannot. */
static bool obeys_command(const struct slave_write *write)
{
    return present(write) == 0 || (present(write) & ON_COMMAND) != 0;
}

static sdo_abort_t check_signature(const struct slave_write *write)
{
    if (write->entry->sub == 0)
        return SDO_READ_ONLY;
    if (!obeys_command(write))
        return SDO_NOT_STORED;
    return write->number == (write->entry->index == 0x1010 ? SAVE : LOAD) ? SDO_OK : SDO_NOT_STORED;
}

static sdo_abort_t check_sync_counter(const struct slave_write *write)
{
    if (write->number == 1 || write->number > 240)
        return SDO_INVALID_VALUE;
    return od_number(write->od, 0x1006, 0, 0) == 0 ? SDO_OK : SDO_DEVICE_STATE;
}

/* The node a value of 1016h watches; 0: none. */
static uint8_t watched_node(uint64_t entry)
{
    const uint8_t node = (uint8_t)(entry >> 16);

    return (entry & 0xFFFFu) != 0 && node <= NMT_NODE_MAX ? node : 0;
}

static sdo_abort_t check_heartbeat_consumer(const struct slave_write *write)
{
    const uint8_t node = watched_node(write->number);

    if (write->entry->sub == 0 || node == 0)
        return SDO_OK;
    for (uint8_t sub = 1; sub <= NMT_NODE_MAX; sub++)
        if (sub != write->entry->sub && watched_node(od_number(write->od, 0x1016, sub, 0)) == node)
            return SDO_PARAMETER;
    return SDO_OK;
}

static sdo_abort_t check_error_behaviour(const struct slave_write *write)
{
    return write->entry->sub != 0 && write->number > 2 && write->number < 128 ? SDO_INVALID_VALUE
                                                                              : SDO_OK;
}

/* The default channel is fixed, even where the device description lets it be written. */
static sdo_abort_t check_default_server(const struct slave_write *write)
{
    return changes(write, UINT64_MAX) ? SDO_READ_ONLY : SDO_OK;
}

static bool channel_exists(const struct slave_write *write)
{
    const uint16_t index = write->entry->index;

    return ((od_number(write->od, index, 1, COB_ID_INVALID) |
             od_number(write->od, index, 2, COB_ID_INVALID)) &
            COB_ID_INVALID) == 0;
}

static sdo_abort_t check_sdo_channel(const struct slave_write *write)
{
    const bool client = write->entry->index >= 0x1280;

    if (write->entry->sub != 1 && write->entry->sub != 2)
        return SDO_OK;
    if ((write->number & COB_ID_INVALID) != 0)
        return SDO_OK;
    if (channel_exists(write) && changes(write, FROZEN_BITS))
        return SDO_INVALID_VALUE;
    if (client && is_base_frame(write->number) &&
        is_default_sdo((uint32_t)(write->number & CAN_ID_MASK)))
        return SDO_OK;
    return check_can_id(write, BASE_FRAMES);
}

static bool pdo_is_valid(const struct slave_write *write)
{
    return (od_number(write->od, write->entry->index, 1, COB_ID_INVALID) & COB_ID_INVALID) == 0;
}

/* Types that wait for a SYNC, on a device that knows none. */
static bool lacks_sync(const struct slave_write *write)
{
    const bool synchronous = write->number <= 240 || write->number == 252;

    return synchronous && !write->assume_sync && !od_has_object(write->od, 0x1005) &&
           !slave_is_default(write->entry, write->value, write->size);
}

static sdo_abort_t check_rpdo(const struct slave_write *write)
{
    if (write->entry->sub == 1)
        return sets(write, COB_ID_BIT30) ? SDO_INVALID_VALUE
                                         : check_switched_cob_id(write, ALL_FRAMES);
    if (write->entry->sub == 2 &&
        ((write->number > 240 && write->number < 254) || lacks_sync(write)))
        return SDO_INVALID_VALUE;
    return SDO_OK;
}

static sdo_abort_t check_transmission_type(const struct slave_write *write)
{
    const bool on_request = write->number == 252 || write->number == 253;
    const uint64_t cob_id = od_number(write->od, write->entry->index, 1, 0);

    if ((write->number > 240 && write->number < 252) || lacks_sync(write))
        return SDO_INVALID_VALUE;
    return on_request && (cob_id & COB_ID_BIT30) != 0 ? SDO_INVALID_VALUE : SDO_OK;
}

static sdo_abort_t check_tpdo(const struct slave_write *write)
{
    switch (write->entry->sub) {
    case 1: return check_switched_cob_id(write, ALL_FRAMES);
    case 2: return check_transmission_type(write);
    case 3: return pdo_is_valid(write) ? SDO_INVALID_VALUE : SDO_OK;
    case 6: return pdo_is_valid(write) || write->number > 240 ? SDO_INVALID_VALUE : SDO_OK;
    default: return SDO_OK;
    }
}

static const struct rule {
    uint16_t first, last;
    sdo_abort_t (*check)(const struct slave_write *write);
} rules[] = {
    { 0x1003, 0x1003, check_history },
    { 0x1005, 0x1005, check_sync },
    { 0x1010, 0x1011, check_signature },
    { 0x1012, 0x1012, check_time },
    { 0x1014, 0x1014, check_emcy },
    { 0x1016, 0x1016, check_heartbeat_consumer },
    { 0x1019, 0x1019, check_sync_counter },
    { 0x1028, 0x1028, check_emcy_consumer },
    { 0x1029, 0x1029, check_error_behaviour },
    { 0x1200, 0x1200, check_default_server },
    { 0x1201, 0x12FF, check_sdo_channel },
    { 0x1400, 0x15FF, check_rpdo },
    { 0x1600, 0x17FF, slave_check_mapping },
    { 0x1800, 0x19FF, check_tpdo },
    { 0x1A00, 0x1BFF, slave_check_mapping },
};

sdo_abort_t slave_check_write(const struct slave_write *write)
{
    const uint16_t index = write->entry->index;

    if (write->entry->frozen != 0 && changes(write, write->entry->frozen))
        return SDO_INVALID_VALUE;
    if (index > LAST_COMMUNICATION_OBJECT)
        return SDO_OK;
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++)
        if (index >= rules[i].first && index <= rules[i].last)
            return rules[i].check(write);
    return SDO_OK;
}

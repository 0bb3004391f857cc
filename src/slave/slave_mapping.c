#include "slave/slave_internal.h"

#include <string.h>

#define MAPPED_MAX    64u /* entries of a PDO, and bits */
#define FIRST_TPDO    0x1A00u
#define COMMUNICATION 0x200u /* so far before its mapping is a PDO's communication parameter */
#define LAST_DUMMY    0x1Fu

/* A mapping entry taken apart. */
struct mapped {
    uint16_t index;
    uint8_t sub;
    uint8_t bits;
};

static struct mapped take_apart(uint64_t entry)
{
    return (struct mapped){ .index = (uint16_t)(entry >> 16),
                            .sub = (uint8_t)(entry >> 8),
                            .bits = (uint8_t)entry };
}

static bool has_length(uint8_t type, uint8_t bits)
{
    return (type == OD_BOOLEAN && bits == 1) || (bits != 0 && od_type_size(type) * 8 == bits);
}

/* The data types 0001h..001Bh as objects: so many bits of an RPDO that nobody takes. */
static sdo_abort_t check_dummy(const struct mapped *mapped, bool transmit)
{
    if (od_type_size((uint8_t)mapped->index) == 0)
        return SDO_NO_OBJECT;
    if (mapped->sub != 0)
        return SDO_NO_SUB;
    return !transmit && has_length((uint8_t)mapped->index, mapped->bits) ? SDO_OK
                                                                         : SDO_NOT_MAPPABLE;
}

static sdo_abort_t check_object(const struct od *od, const struct mapped *mapped, bool transmit)
{
    const struct od_entry *entry = od_find(od, mapped->index, mapped->sub);

    if (mapped->index <= LAST_DUMMY)
        return check_dummy(mapped, transmit);
    if (!od_has_object(od, mapped->index))
        return SDO_NO_OBJECT;
    if (entry == NULL)
        return SDO_NO_SUB;
    if (!entry->mappable || !od_access_fits(entry->access, transmit) ||
        !has_length(entry->type, mapped->bits))
        return SDO_NOT_MAPPABLE;
    return SDO_OK;
}

static bool can_write(const struct od_entry *entry)
{
    return entry->access != OD_RO && entry->access != OD_CONST;
}

/* Mappings whose count is fixed are changed in place: unused entries are 0. */
static bool is_switched_on(const struct od *od, uint16_t index)
{
    const struct od_entry *count = od_find(od, index, 0);

    return count != NULL && can_write(count) && od_number(od, index, 0, 0) != 0;
}

static bool is_same_object(uint64_t entry, const struct mapped *mapped)
{
    const struct mapped other = take_apart(entry);

    return other.index == mapped->index && other.sub == mapped->sub;
}

/* The mapping at this index has the object in force already. */
static bool is_counted(const struct od *od, uint16_t index, const struct mapped *mapped)
{
    const uint64_t count = od_number(od, index, 0, 0);

    for (unsigned sub = 1; sub <= count && sub <= MAPPED_MAX; sub++)
        if (is_same_object(od_number(od, index, (uint8_t)sub, 0), mapped))
            return true;
    return false;
}

/* An object that may be in so many PDOs is in as many others. */
static bool is_used_up(const struct od *od, uint16_t index, const struct mapped *mapped)
{
    const struct od_entry *entry = od_find(od, mapped->index, mapped->sub);

    if (entry == NULL || entry->map_max == 0)
        return false;
    return entry->map_count - (is_counted(od, index, mapped) ? 1 : 0) >= entry->map_max;
}

static sdo_abort_t check_entry(const struct slave_write *write, bool transmit)
{
    const struct mapped mapped = take_apart(write->number);

    if (is_switched_on(write->od, write->entry->index))
        return SDO_ACCESS;
    if (is_used_up(write->od, write->entry->index, &mapped))
        return SDO_NOT_MAPPABLE;
    /* What the device description itself maps is right, whatever it tells about the object. */
    if (write->number == 0 || slave_is_default(write->entry, write->value, write->size))
        return SDO_OK;
    return check_object(write->od, &mapped, transmit);
}

static sdo_abort_t check_counted(const struct od *od, const struct od_entry *entry, bool transmit,
                                 unsigned *bits)
{
    const struct mapped mapped = take_apart(od_number(od, entry->index, entry->sub, 0));

    *bits += mapped.bits;
    if (is_used_up(od, entry->index, &mapped))
        return SDO_NOT_MAPPABLE;
    if (slave_is_default(entry, entry->value, entry->size))
        return mapped.bits != 0 ? SDO_OK : SDO_NO_OBJECT;
    return check_object(od, &mapped, transmit);
}

/* Some of so many entries do not exist. */
static bool has_fewer(const struct od *od, uint16_t index, uint64_t count)
{
    for (unsigned sub = 1; sub <= count; sub++)
        if (od_find(od, index, (uint8_t)sub) == NULL)
            return true;
    return false;
}

static sdo_abort_t check_count(const struct slave_write *write, bool transmit)
{
    unsigned bits = 0;

    if (write->number > MAPPED_MAX || has_fewer(write->od, write->entry->index, write->number))
        return SDO_PDO_LENGTH;
    for (unsigned sub = 1; sub <= write->number; sub++) {
        const struct od_entry *entry = od_find(write->od, write->entry->index, (uint8_t)sub);
        const sdo_abort_t code = check_counted(write->od, entry, transmit, &bits);

        if (code != SDO_OK)
            return code;
    }
    return bits <= MAPPED_MAX ? SDO_OK : SDO_PDO_LENGTH;
}

/* A PDO that cannot be switched off is mapped while it is valid. */
static bool must_be_switched_off(const struct slave_write *write)
{
    const uint16_t communication = (uint16_t)(write->entry->index - COMMUNICATION);
    const struct od_entry *cob_id = od_find(write->od, communication, 1);

    return cob_id != NULL && can_write(cob_id) &&
           (od_number(write->od, communication, 1, 0) & COB_ID_INVALID) == 0;
}

sdo_abort_t slave_check_mapping(const struct slave_write *write)
{
    const bool transmit = write->entry->index >= FIRST_TPDO;

    if (must_be_switched_off(write))
        return SDO_ACCESS;
    return write->entry->sub == 0 ? check_count(write, transmit) : check_entry(write, transmit);
}

sdo_abort_t slave_check_mapped(const struct od *od, uint32_t mapping_entry, bool transmit)
{
    const struct mapped mapped = take_apart(mapping_entry);

    return check_object(od, &mapped, transmit);
}

/*
 * Checks of the mapping parameters of PDOs (1600h.., 1A00h..).
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "od/abort.h"
#include "od/od.h"

#define LAST_DUMMY  0x1Fu
#define MAPPED_MOST 16u /* objects that one check maps, one after the other */

/* --- what is mapped after a reset --- */

/* In bits; 0: it cannot be told. Without an EDS the device is asked, with it the EDS. */
static bool find_length(struct conform *self, uint32_t entry, uint32_t *ret_bits)
{
    const uint16_t index = pdo_entry_index(entry);
    const struct conform_object *object = conform_find(self, index, pdo_entry_sub(entry));
    struct conform_value value;
    uint32_t result;

    *ret_bits = object && object->type != OD_BOOLEAN ? 8 * od_type_size(object->type) : 0;
    if (object || self->has_eds)
        return object != NULL;
    result = conform_read(self, index, pdo_entry_sub(entry), &value);
    *ret_bits = result == SDO_OK && value.size > 1 ? 8 * value.size : 0;
    return result != SDO_NO_OBJECT && result != SDO_NO_SUB;
}

static bool check_entry(struct conform *self, const struct conform_pdo *pdo, uint32_t entry)
{
    uint32_t bits;

    if (pdo_entry_index(entry) <= LAST_DUMMY)
        return true;
    if (!find_length(self, entry, &bits))
        return conform_fail(self, "%04Xh maps %08X: the device has no %04Xh:%02X", pdo_map(pdo),
                            (unsigned)entry, pdo_entry_index(entry), pdo_entry_sub(entry));
    if (bits != 0 && bits != (entry & 0xFF))
        return conform_fail(self, "%04Xh maps %08X: %04Xh:%02X has %u bits", pdo_map(pdo),
                            (unsigned)entry, pdo_entry_index(entry), pdo_entry_sub(entry),
                            (unsigned)bits);
    return true;
}

static bool check_readable_of(struct conform *self, uint16_t direction)
{
    for (uint16_t index = direction; index < direction + 0x200u; index++) {
        struct conform_pdo pdo;

        if (!conform_find(self, index, 1))
            continue;
        if (!conform_read_pdo(self, index, &pdo))
            return false;
        for (unsigned i = 0; i < pdo.count; i++)
            if (!check_entry(self, &pdo, pdo.entries[i]))
                return false;
    }
    return true;
}

static bool check_readable(struct conform *self)
{
    return check_readable_of(self, RPDO) && check_readable_of(self, TPDO);
}

/* --- the procedure --- */

static bool check_procedure_of(struct conform *self, uint16_t direction)
{
    struct conform_pdo pdo;

    return conform_find_pdo(self, direction, &pdo) && conform_unmap_pdo(self, &pdo) &&
           conform_map_pdo(self, &pdo);
}

static bool check_procedure_receive(struct conform *self)
{
    return check_procedure_of(self, RPDO);
}

static bool check_procedure_transmit(struct conform *self)
{
    return check_procedure_of(self, TPDO);
}

/* An entry in force, and then the number of entries of a PDO in use. */
static bool check_locked_of(struct conform *self, uint16_t direction)
{
    const uint32_t *codes = CODES(SDO_ACCESS, SDO_NOT_MAPPABLE, SDO_INVALID_VALUE, SDO_DEVICE_STATE,
                                  SDO_GENERAL);
    struct conform_pdo pdo;

    if (!conform_find_pdo(self, direction, &pdo) || !conform_unmap_pdo(self, &pdo) ||
        !conform_set(self, pdo_map(&pdo), 0, 1, pdo.count))
        return false;
    return conform_must_abort(self, "write an entry while sub-index 0 is not 0",
                              conform_write_number(self, pdo_map(&pdo), 1, 4, pdo.entries[0]),
                              codes) &&
           conform_switch_pdo(self, &pdo, true) &&
           conform_must_abort(self, "write sub-index 0 of a PDO in use",
                              conform_write_number(self, pdo_map(&pdo), 0, 1, 0), codes);
}

static bool check_locked(struct conform *self)
{
    return check_locked_of(self, RPDO) && check_locked_of(self, TPDO);
}

/* --- what cannot be mapped --- */

#define REFUSED                                                                                    \
    CODES(SDO_NO_OBJECT, SDO_NOT_MAPPABLE, SDO_PDO_LENGTH, SDO_NO_SUB, SDO_INVALID_VALUE,          \
          SDO_VALUE_HIGH)

/* Refused as an entry, or at the latest when it is counted. */
static bool refuse(struct conform *self, const struct conform_pdo *pdo, const char *what,
                   uint32_t entry)
{
    uint32_t result = conform_write_number(self, pdo_map(pdo), 1, 4, entry);
    char text[96];

    if (result == SDO_OK)
        result = conform_write_number(self, pdo_map(pdo), 0, 1, 1);
    snprintf(text, sizeof text, "map %08X into %04Xh, %s", (unsigned)entry, pdo_map(pdo), what);
    return conform_must_abort(self, text, result, REFUSED);
}

static bool prepare(struct conform *self, uint16_t direction, struct conform_pdo *ret_pdo)
{
    return conform_find_pdo(self, direction, ret_pdo) && conform_unmap_pdo(self, ret_pdo);
}

static bool check_missing(struct conform *self)
{
    struct conform_pdo pdo;

    return prepare(self, TPDO, &pdo) && refuse(self, &pdo, "which does not exist", 0x5FFE0008) &&
           refuse(self, &pdo, "which does not exist", 0x1018F020);
}

static bool check_length(struct conform *self)
{
    struct conform_pdo pdo;
    uint32_t bits;

    if (!prepare(self, TPDO, &pdo))
        return false;
    bits = pdo.entries[0] & 0xFF;
    return refuse(self, &pdo, "which has another length",
                  (pdo.entries[0] & ~0xFFu) | (bits <= 8 ? 16 : 8));
}

/* More than 64 bits: in the entries, or in their number. */
static bool check_too_long(struct conform *self)
{
    struct conform_pdo pdo;
    unsigned bits = 0, count = 0;
    uint32_t result = SDO_OK;

    if (!prepare(self, TPDO, &pdo))
        return false;
    while (bits <= 64 && result == SDO_OK) {
        result = conform_write_number(self, pdo_map(&pdo), (uint8_t)(count + 1), 4, pdo.entries[0]);
        bits += pdo.entries[0] & 0xFF;
        count++;
    }
    if (result == SDO_OK || result == SDO_NO_SUB)
        result = conform_write_number(self, pdo_map(&pdo), 0, 1, count);
    return conform_must_abort(self, "map more than 64 bits", result, REFUSED) &&
           (conform_number(self, pdo_map(&pdo), 0, 0) == 0 ||
            conform_fail(self, "%04Xh:00 is not 0 after a mapping that was refused",
                         pdo_map(&pdo)));
}

/* The first object with this access right, and mappable or not. */
static const struct conform_object *find_object(struct conform *self, bool mappable,
                                                const uint8_t *rights)
{
    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];
        const uint32_t size = od_type_size(object->type);

        if (!object->entry || object->entry->mappable != mappable || size == 0 || size > 8 ||
            object->type == OD_BOOLEAN)
            continue;
        for (const uint8_t *right = rights; *right != OD_NONE; right++)
            if (object->access == *right)
                return object;
    }
    return NULL;
}

static bool check_not_mappable(struct conform *self)
{
    static const uint8_t any[] = { OD_RO, OD_RW, OD_RWR, OD_RWW, OD_WO, OD_NONE };
    const struct conform_object *object = find_object(self, false, any);
    struct conform_pdo pdo;

    if (!object)
        return conform_skip(self, "all objects of the device may be mapped");
    return prepare(self, RPDO, &pdo) &&
           refuse(self, &pdo, "which may not be mapped", conform_entry(object)) &&
           prepare(self, TPDO, &pdo) &&
           refuse(self, &pdo, "which may not be mapped", conform_entry(object));
}

static bool check_receive_read_only(struct conform *self)
{
    static const uint8_t rights[] = { OD_RO, OD_RWR, OD_NONE };
    const struct conform_object *object = find_object(self, true, rights);
    struct conform_pdo pdo;

    if (!object)
        return conform_skip(self, "no ro or rwr object of the device may be mapped");
    return prepare(self, RPDO, &pdo) &&
           refuse(self, &pdo, "which cannot be written", conform_entry(object));
}

static bool check_transmit_write_only(struct conform *self)
{
    static const uint8_t rights[] = { OD_WO, OD_RWW, OD_NONE };
    const struct conform_object *object = find_object(self, true, rights);
    struct conform_pdo pdo;

    if (!object)
        return conform_skip(self, "no wo or rww object of the device may be mapped");
    return prepare(self, TPDO, &pdo) &&
           refuse(self, &pdo, "which cannot be read", conform_entry(object));
}

/* --- what can be mapped --- */

static bool check_objects_of(struct conform *self, uint16_t direction)
{
    struct conform_pdo pdo;
    unsigned count = 0;

    if (!prepare(self, direction, &pdo))
        return false;
    pdo.count = 1;
    for (size_t i = 0; i < self->object_count && count < MAPPED_MOST; i++) {
        const struct conform_object *object = &self->objects[i];

        /* whether an rw object is for both directions is the device's own business */
        if (!conform_is_mappable(object, direction) || object->access == OD_RW)
            continue;
        pdo.entries[0] = conform_entry(object);
        count++;
        if (!conform_map_pdo(self, &pdo) || !conform_unmap_pdo(self, &pdo))
            return false;
    }
    return count > 0 || conform_skip(self, "the EDS has no mappable object for this direction");
}

static bool check_objects_receive(struct conform *self)
{
    return check_objects_of(self, RPDO);
}

static bool check_objects_transmit(struct conform *self)
{
    return check_objects_of(self, TPDO);
}

static bool check_dummy(struct conform *self)
{
    static const uint8_t bits[] = { 0, 1, 8, 16, 32, 8, 16, 32 };
    struct conform_pdo pdo;
    uint8_t dummy = 2;

    while (dummy < 8 && (self->eds.dummy_usage >> dummy & 1) == 0)
        dummy++;
    if (dummy == 8)
        return conform_skip(self, "the EDS allows no dummy entries");
    if (!prepare(self, RPDO, &pdo))
        return false;
    pdo.count = 1;
    pdo.entries[0] = (uint32_t)dummy << 16 | bits[dummy];
    return conform_map_pdo(self, &pdo) && prepare(self, TPDO, &pdo) &&
           refuse(self, &pdo, "a dummy entry", (uint32_t)dummy << 16 | bits[dummy]);
}

static const struct conform_check checks[] = {
    { "pdo-mapping", "what is mapped after a reset exists and has its length", "CiA 301, 7.5.2.36",
      0, 0, check_readable },
    { "pdo-map-receive", "an RPDO can be mapped anew: off, 0, entries, number, on",
      "CiA 301, 7.5.2.36", CONFORM_RESET, 0, check_procedure_receive },
    { "pdo-map-transmit", "a TPDO can be mapped anew: off, 0, entries, number, on",
      "CiA 301, 7.5.2.38", CONFORM_RESET, 0, check_procedure_transmit },
    { "pdo-map-locked", "a mapping in force cannot be changed", "CiA 301, 7.5.2.36", CONFORM_RESET,
      0, check_locked },
    { "pdo-map-missing", "objects that do not exist cannot be mapped", "CiA 301, 7.5.2.36",
      CONFORM_RESET, 0, check_missing },
    { "pdo-map-length", "an object is mapped with its length", "CiA 301, 7.5.2.36", CONFORM_RESET,
      0, check_length },
    { "pdo-map-too-long", "more than 8 bytes cannot be mapped", "CiA 301, 7.5.2.36", CONFORM_RESET,
      0, check_too_long },
    { "pdo-map-forbidden", "objects with PDOMapping=0 cannot be mapped", "CiA 301, 7.5.2.36",
      CONFORM_EDS | CONFORM_RESET, 0, check_not_mappable },
    { "pdo-map-receive-ro", "an RPDO does not map ro and rwr objects", "CiA 301, 7.5.2.36",
      CONFORM_EDS | CONFORM_RESET, 0, check_receive_read_only },
    { "pdo-map-transmit-wo", "a TPDO does not map wo and rww objects", "CiA 301, 7.5.2.38",
      CONFORM_EDS | CONFORM_RESET, 0, check_transmit_write_only },
    { "pdo-map-receive-all", "an RPDO maps wo and rww objects", "CiA 301, 7.5.2.36",
      CONFORM_EDS | CONFORM_RESET, 0, check_objects_receive },
    { "pdo-map-transmit-all", "a TPDO maps ro and rwr objects", "CiA 301, 7.5.2.38",
      CONFORM_EDS | CONFORM_RESET, 0, check_objects_transmit },
    { "pdo-map-dummy", "an RPDO maps a dummy entry of the EDS, a TPDO none", "CiA 301, 7.5.2.36",
      CONFORM_EDS | CONFORM_RESET, 0, check_dummy },
};

const struct conform_family conform_pdo_mapping = { "pdo", "PDO", checks,
                                                    sizeof checks / sizeof checks[0] };

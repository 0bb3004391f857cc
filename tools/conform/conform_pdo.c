#include "conform_pdo.h"

#include "conform_services.h"

#include "od/abort.h"
#include "od/od.h"

static bool read_entries(struct conform *self, struct conform_pdo *pdo)
{
    uint64_t entry;
    unsigned bits = 0;

    for (unsigned i = 0; i < pdo->count; i++) {
        if (!conform_must_read_number(self, pdo_map(pdo), (uint8_t)(i + 1), &entry))
            return false;
        pdo->entries[i] = (uint32_t)entry;
        bits += entry & 0xFF;
    }
    pdo->bytes = (uint8_t)((bits + 7) / 8);
    return true;
}

bool conform_read_pdo(struct conform *self, uint16_t index, struct conform_pdo *ret_pdo)
{
    uint64_t cob_id, type, count;

    if (!conform_must_read_number(self, index, 1, &cob_id) ||
        !conform_must_read_number(self, index, 2, &type) ||
        !conform_must_read_number(self, (uint16_t)(index + 0x200u), 0, &count))
        return false;
    *ret_pdo = (struct conform_pdo){
        .index = index,
        .cob_id = (uint32_t)cob_id,
        .type = (uint8_t)type,
        .count = count <= PDO_ENTRIES_MAX ? (uint8_t)count : 0 /* an MPDO */
    };
    return read_entries(self, ret_pdo);
}

bool conform_look_for_pdo(struct conform *self, uint16_t direction, conform_fits *fits,
                          struct conform_pdo *ret_pdo)
{
    for (uint16_t index = direction; index < direction + 0x200u; index++) {
        if (!conform_find(self, index, 1))
            continue;
        if (!conform_read_pdo(self, index, ret_pdo))
            return false;
        if ((ret_pdo->cob_id & PDO_INVALID) == 0 && ret_pdo->bytes > 0 &&
            (!fits || fits(self, ret_pdo)))
            return true;
    }
    return false;
}

bool conform_find_fitting_pdo(struct conform *self, uint16_t direction, conform_fits *fits,
                              struct conform_pdo *ret_pdo)
{
    return conform_look_for_pdo(self, direction, fits, ret_pdo) ||
           conform_skip(self, "the device has no %s in use that this check could take",
                        direction == RPDO ? "RPDO" : "TPDO");
}

bool conform_find_pdo(struct conform *self, uint16_t direction, struct conform_pdo *ret_pdo)
{
    return conform_find_fitting_pdo(self, direction, NULL, ret_pdo);
}

/* --- parameters --- */

bool conform_switch_pdo(struct conform *self, const struct conform_pdo *pdo, bool on)
{
    const uint32_t cob_id = on ? pdo->cob_id & ~PDO_INVALID : pdo->cob_id | PDO_INVALID;

    return conform_set(self, pdo->index, 1, 4, cob_id);
}

bool conform_set_pdo_type(struct conform *self, struct conform_pdo *pdo, uint8_t type)
{
    uint32_t result;

    if (!conform_switch_pdo(self, pdo, false))
        return false;
    result = conform_write_number(self, pdo->index, 2, 1, type);
    if (result == SDO_READ_ONLY || result == SDO_INVALID_VALUE || result == SDO_VALUE_HIGH ||
        result == SDO_VALUE_LOW)
        return conform_skip(self, "%04Xh:02 does not take the type %u", pdo->index, type);
    if (result != SDO_OK && !conform_set(self, pdo->index, 2, 1, type))
        return false;
    pdo->type = type;
    return conform_switch_pdo(self, pdo, true);
}

bool conform_unmap_pdo(struct conform *self, const struct conform_pdo *pdo)
{
    uint32_t result = conform_write_number(self, pdo->index, 1, 4, pdo->cob_id | PDO_INVALID);

    if (result == SDO_OK)
        result = conform_write_number(self, pdo_map(pdo), 0, 1, 0);
    if (result == SDO_READ_ONLY || result == SDO_ACCESS)
        return conform_skip(self, "the mapping %04Xh is fixed", pdo_map(pdo));
    return result == SDO_OK || conform_set(self, pdo_map(pdo), 0, 1, 0);
}

bool conform_map_pdo(struct conform *self, struct conform_pdo *pdo)
{
    unsigned bits = 0;

    for (unsigned i = 0; i < pdo->count; i++) {
        if (!conform_set(self, pdo_map(pdo), (uint8_t)(i + 1), 4, pdo->entries[i]))
            return false;
        bits += pdo->entries[i] & 0xFF;
    }
    pdo->bytes = (uint8_t)((bits + 7) / 8);
    return conform_set(self, pdo_map(pdo), 0, 1, pdo->count) && conform_switch_pdo(self, pdo, true);
}

/* A BOOLEAN is one bit for some devices, and eight for others: no check takes it. */
bool conform_is_mappable(const struct conform_object *object, uint16_t direction)
{
    const uint32_t size = od_type_size(object->type);

    if (!object->entry || !object->entry->mappable || object->type == OD_BOOLEAN || size == 0 ||
        size > 8 || object->index < 0x2000)
        return false;
    if (object->access == OD_RW)
        return true;
    return direction == RPDO ? object->access == OD_WO || object->access == OD_RWW
                             : object->access == OD_RO || object->access == OD_RWR;
}

uint32_t conform_entry(const struct conform_object *object)
{
    return (uint32_t)object->index << 16 | (uint32_t)object->sub << 8 |
           8 * od_type_size(object->type);
}

/* --- frames --- */

void conform_barrier(struct conform *self)
{
    conform_number(self, 0x1000, 0, 0);
}

size_t conform_send_rpdo(struct conform *self, const struct conform_pdo *pdo, uint8_t dlc)
{
    const struct co_frame frame = co_frame_make(pdo_id(pdo), dlc);
    const size_t from = conform_send(self, &frame);

    if (pdo->type <= 240)
        conform_send_sync(self);
    return from;
}

bool conform_provoke(struct conform *self, struct conform_pdo *ret_pdo, size_t *ret_from)
{
    if (!conform_find_pdo(self, RPDO, ret_pdo))
        return false;
    conform_nmt(self, CONFORM_START);
    *ret_from = conform_send_rpdo(self, ret_pdo, 0);
    return true;
}

size_t conform_appease(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_send_rpdo(self, pdo, pdo->bytes);
}

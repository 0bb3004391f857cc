/*
 * Checks of the communication parameters of PDOs (1400h.., 1800h..).
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "od/abort.h"

#define PREDEFINED 4u /* PDOs of each direction that have identifiers of their own */

static bool check_cob_ids_of(struct conform *self, uint16_t direction)
{
    const uint32_t first = (direction == RPDO ? 0x200u : 0x180u) + self->options.node;

    for (uint16_t number = 0; number < 512; number++) {
        const uint16_t index = (uint16_t)(direction + number);
        uint64_t cob_id;

        if (!conform_find(self, index, 1))
            continue;
        if (!conform_must_read_number(self, index, 1, &cob_id))
            return false;
        if ((cob_id & PDO_INVALID) == 0 &&
            (number >= PREDEFINED || (cob_id & 0x7FF) != first + 0x100u * number))
            return conform_fail(
                self, "%04Xh:01 is %08X after a reset: expected %s", index, (unsigned)cob_id,
                number < PREDEFINED ? "the predefined identifier, or bit 31" : "bit 31");
    }
    return true;
}

static bool check_cob_ids(struct conform *self)
{
    return check_cob_ids_of(self, RPDO) && check_cob_ids_of(self, TPDO);
}

/* Another identifier that a PDO may have. */
static uint32_t other_id(const struct conform *self)
{
    return 0x680u + self->options.node % 0x50u;
}

static bool check_locked_of(struct conform *self, uint16_t direction)
{
    struct conform_pdo pdo;
    uint32_t result, other;

    if (!conform_find_pdo(self, direction, &pdo))
        return false;
    other = (pdo.cob_id & ~0x7FFu) | other_id(self);
    result = conform_write_number(self, pdo.index, 1, 4, other);
    if (result == SDO_READ_ONLY)
        return conform_skip(self, "%04Xh:01 cannot be written", pdo.index);
    return conform_must_abort(self, "another identifier for a PDO in use", result,
                              CODES(SDO_INVALID_VALUE, SDO_DEVICE_STATE, SDO_GENERAL)) &&
           conform_switch_pdo(self, &pdo, false) &&
           conform_set(self, pdo.index, 1, 4, other | PDO_INVALID) &&
           conform_set(self, pdo.index, 1, 4, other);
}

static bool check_locked_receive(struct conform *self)
{
    return check_locked_of(self, RPDO);
}

static bool check_locked_transmit(struct conform *self)
{
    return check_locked_of(self, TPDO);
}

/* The PDO is switched off. */
static bool refuse_types(struct conform *self, const struct conform_pdo *pdo, const uint8_t *types,
                         size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char what[48];

        snprintf(what, sizeof what, "transmission type %u to %04Xh:02", types[i], pdo->index);
        if (!conform_must_abort(
                self, what, conform_write_number(self, pdo->index, 2, 1, types[i]),
                CODES(SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_READ_ONLY, SDO_GENERAL)))
            return false;
    }
    return true;
}

static bool refuse_types_of(struct conform *self, uint16_t direction, const uint8_t *types,
                            size_t count)
{
    struct conform_pdo pdo;

    return conform_find_pdo(self, direction, &pdo) && conform_switch_pdo(self, &pdo, false) &&
           refuse_types(self, &pdo, types, count);
}

static bool check_types_receive(struct conform *self)
{
    static const uint8_t types[] = { 241, 251, 252, 253 };

    return refuse_types_of(self, RPDO, types, sizeof types);
}

static bool check_types_transmit(struct conform *self)
{
    static const uint8_t types[] = { 241, 251 };

    return refuse_types_of(self, TPDO, types, sizeof types);
}

static bool check_types_remote(struct conform *self)
{
    static const uint8_t types[] = { 252, 253 };
    struct conform_pdo pdo;

    return conform_find_pdo(self, TPDO, &pdo) &&
           conform_set(self, pdo.index, 1, 4, pdo.cob_id | PDO_INVALID | PDO_NO_RTR) &&
           refuse_types(self, &pdo, types, sizeof types);
}

static bool check_sub4(struct conform *self)
{
    struct conform_pdo pdo;
    struct conform_value value;

    if (!conform_find_pdo(self, TPDO, &pdo))
        return false;
    if (self->has_eds && conform_find(self, pdo.index, 4))
        return conform_skip(self, "the EDS has %04Xh:04, a remnant of old versions", pdo.index);
    return conform_must_abort(self, "read 18xxh:04", conform_read(self, pdo.index, 4, &value),
                              CODES(SDO_NO_SUB, SDO_GENERAL));
}

static bool check_start_value(struct conform *self)
{
    struct conform_pdo pdo;

    if (!conform_find_pdo(self, TPDO, &pdo))
        return false;
    if (!conform_find(self, pdo.index, 6))
        return conform_skip(self, "the device has no %04Xh:06", pdo.index);
    return conform_must_abort(self, "write 18xxh:06 of a PDO in use",
                              conform_write_number(self, pdo.index, 6, 1, 1),
                              CODES(SDO_INVALID_VALUE, SDO_DEVICE_STATE, SDO_GENERAL)) &&
           conform_switch_pdo(self, &pdo, false) && conform_set(self, pdo.index, 6, 1, 1) &&
           conform_must_abort(self, "write 241 to 18xxh:06",
                              conform_write_number(self, pdo.index, 6, 1, 241),
                              CODES(SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_GENERAL));
}

static const struct conform_check checks[] = {
    { "pdo-cob-ids", "PDOs 1 to 4 have the predefined identifiers, or are off, as the others are",
      "CiA 301, 7.3.5", 0, 0, check_cob_ids },
    { "pdo-receive-locked", "the identifier of an RPDO in use cannot be changed",
      "CiA 301, 7.5.2.35", CONFORM_RESET, 0, check_locked_receive },
    { "pdo-transmit-locked", "the identifier of a TPDO in use cannot be changed",
      "CiA 301, 7.5.2.37", CONFORM_RESET, 0, check_locked_transmit },
    { "pdo-receive-types", "an RPDO refuses the transmission types 241 to 253", "CiA 301, 7.5.2.35",
      CONFORM_RESET, 0, check_types_receive },
    { "pdo-transmit-types", "a TPDO refuses the transmission types 241 to 251", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0, check_types_transmit },
    { "pdo-remote-types", "a TPDO without remote frames refuses the types 252 and 253",
      "CiA 301, 7.5.2.37", CONFORM_RESET, 0, check_types_remote },
    { "pdo-sub4", "18xxh:04 does not exist", "CiA 301, 7.5.2.37", 0, 0, check_sub4 },
    { "pdo-start-value", "18xxh:06 takes 0 to 240 while the TPDO is off", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0, check_start_value },
};

const struct conform_family conform_pdo_parameter = { "pdo", "PDO", checks,
                                                      sizeof checks / sizeof checks[0] };

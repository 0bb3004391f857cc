/*
 * Checks of COB-IDs: identifiers that nobody may configure.
 */
#include "conform_families.h"
#include "conform_pdo.h"

#include "od/abort.h"

/* The ends of the restricted ranges, and some between them. */
static const uint16_t restricted[] = { 0x000, 0x001, 0x040, 0x07F, 0x101, 0x140, 0x180,
                                       0x581, 0x5C0, 0x5FF, 0x601, 0x640, 0x67F, 0x6E0,
                                       0x6F0, 0x6FF, 0x701, 0x740, 0x77F, 0x780, 0x7FF };

static bool is_given(const struct conform *self, uint16_t index, uint8_t sub, uint32_t id)
{
    const struct conform_object *object = conform_find(self, index, sub);
    uint8_t bytes[8];

    /* what the EDS itself gives the object is right */
    return object && object->entry && object->entry->initial.given &&
           object->entry->initial.size == 4 &&
           dcf_value(&object->entry->initial, self->options.node, bytes) == 4 &&
           (bytes[0] | bytes[1] << 8) == (int)id;
}

static bool refuse_restricted(struct conform *self, uint16_t index, uint8_t sub)
{
    for (size_t i = 0; i < sizeof restricted / sizeof restricted[0]; i++) {
        char what[48];

        if (is_given(self, index, sub, restricted[i]))
            continue;
        snprintf(what, sizeof what, "the restricted CAN-ID %03X to %04Xh:%02X", restricted[i],
                 index, sub);
        if (!conform_must_abort(self, what,
                                conform_write_number(self, index, sub, 4, restricted[i]),
                                CODES(SDO_INVALID_VALUE, SDO_VALUE_LOW, SDO_VALUE_HIGH,
                                      SDO_READ_ONLY, SDO_ACCESS, SDO_GENERAL)))
            return false;
    }
    return true;
}

static bool check_sync(struct conform *self)
{
    return refuse_restricted(self, 0x1005, 0);
}

static bool check_time(struct conform *self)
{
    return refuse_restricted(self, 0x1012, 0);
}

static bool check_emcy(struct conform *self)
{
    return refuse_restricted(self, 0x1014, 0);
}

/* Of a PDO that is off, so that only the identifier can be the reason. */
static bool check_pdo(struct conform *self, uint16_t direction)
{
    struct conform_pdo pdo;

    if (!conform_find_pdo(self, direction, &pdo))
        return false;
    conform_write_number(self, pdo.index, 1, 4, pdo.cob_id | PDO_INVALID);
    return refuse_restricted(self, pdo.index, 1);
}

static bool check_rpdo(struct conform *self)
{
    return check_pdo(self, RPDO);
}

static bool check_tpdo(struct conform *self)
{
    return check_pdo(self, TPDO);
}

static const struct conform_check checks[] = {
    { "cob-sync", "1005h refuses restricted CAN-IDs", "CiA 301, 7.3.5", CONFORM_RESET, 0x1005,
      check_sync },
    { "cob-time", "1012h refuses restricted CAN-IDs", "CiA 301, 7.3.5", CONFORM_RESET, 0x1012,
      check_time },
    { "cob-emcy", "1014h refuses restricted CAN-IDs", "CiA 301, 7.3.5", CONFORM_RESET, 0x1014,
      check_emcy },
    { "cob-receive", "14xxh:01 refuses restricted CAN-IDs", "CiA 301, 7.3.5", CONFORM_RESET, 0,
      check_rpdo },
    { "cob-transmit", "18xxh:01 refuses restricted CAN-IDs", "CiA 301, 7.3.5", CONFORM_RESET, 0,
      check_tpdo },
};

const struct conform_family conform_cob = { "cob", "COB-IDs", checks,
                                            sizeof checks / sizeof checks[0] };

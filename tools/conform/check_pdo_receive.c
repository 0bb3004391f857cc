/*
 * Checks of RPDOs: what the device does with their data.
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "od/abort.h"
#include "od/od.h"

#define DEADLINE 50u /* ms */
#define SETTLE   20u /* ms, for a device whose application takes the data over */

/* An RPDO, and a byte of it that can be read over SDO. */
struct receiver {
    struct conform_pdo pdo;
    uint16_t index;
    uint8_t sub;
    uint8_t at; /* in the frame */
};

/* Without an EDS the device is asked. */
static bool is_readable(struct conform *self, uint32_t entry)
{
    const struct conform_object *object = conform_find(self, pdo_entry_index(entry),
                                                       pdo_entry_sub(entry));
    struct conform_value value;

    if (object || self->has_eds)
        return object && object->access != OD_WO && object->type != OD_BOOLEAN;
    return conform_read(self, pdo_entry_index(entry), pdo_entry_sub(entry), &value) == SDO_OK;
}

static bool find_byte(struct conform *self, struct receiver *receiver)
{
    unsigned bits = 0;

    for (unsigned i = 0; i < receiver->pdo.count; i++) {
        const uint32_t entry = receiver->pdo.entries[i];

        if (bits % 8 == 0 && (entry & 0xFF) >= 8 && is_readable(self, entry)) {
            receiver->index = pdo_entry_index(entry);
            receiver->sub = pdo_entry_sub(entry);
            receiver->at = (uint8_t)(bits / 8);
            return true;
        }
        bits += entry & 0xFF;
    }
    return false;
}

static bool has_byte(struct conform *self, const struct conform_pdo *pdo)
{
    struct receiver receiver = { .pdo = *pdo };

    return find_byte(self, &receiver);
}

static bool find_receiver(struct conform *self, struct receiver *ret_receiver)
{
    return conform_find_fitting_pdo(self, RPDO, has_byte, &ret_receiver->pdo) &&
           find_byte(self, ret_receiver);
}

static size_t send_byte(struct conform *self, const struct receiver *to, uint8_t dlc, uint8_t value)
{
    struct co_frame frame = co_frame_make(pdo_id(&to->pdo), dlc);

    if (to->at < dlc)
        frame.data[to->at] = value;
    return conform_send(self, &frame);
}

static uint8_t read_byte(struct conform *self, const struct receiver *from)
{
    return (uint8_t)conform_number(self, from->index, from->sub, 0xFF);
}

/* Waits, where a device takes its time. */
static bool becomes(struct conform *self, const struct receiver *of, uint8_t value)
{
    bool is_value = read_byte(self, of) == value;

    for (unsigned i = 0; i < 10 && !is_value; i++) {
        conform_listen(self, SETTLE);
        is_value = read_byte(self, of) == value;
    }
    return is_value;
}

static bool expect_byte(struct conform *self, const struct receiver *of, uint8_t value,
                        const char *when)
{
    return becomes(self, of, value) ||
           conform_fail(self, "%s: expected %02X in %04Xh:%02X, received %02X", when, value,
                        of->index, of->sub, read_byte(self, of));
}

static bool expect_unchanged(struct conform *self, const struct receiver *of, uint8_t value,
                             const char *when)
{
    conform_listen(self, SETTLE);
    return expect_byte(self, of, value, when);
}

static bool take_at_once(struct conform *self, struct conform_pdo *pdo)
{
    return pdo->type > 240 || conform_set_pdo_type(self, pdo, 255);
}

/* An RPDO that is taken at once, in Operational, with the value 1. */
static bool begin(struct conform *self, struct receiver *ret_receiver)
{
    if (!find_receiver(self, ret_receiver) || !take_at_once(self, &ret_receiver->pdo))
        return false;
    conform_nmt(self, CONFORM_START);
    send_byte(self, ret_receiver, ret_receiver->pdo.bytes, 1);
    return true;
}

static bool check_taken(struct conform *self)
{
    struct receiver receiver;

    if (!begin(self, &receiver) || !expect_byte(self, &receiver, 1, "after an RPDO"))
        return false;
    send_byte(self, &receiver, receiver.pdo.bytes, 2);
    return expect_byte(self, &receiver, 2, "after an RPDO");
}

/* Where an RPDO does not arrive at all, one check tells. */
static bool begin_taken(struct conform *self, struct receiver *ret_receiver)
{
    return begin(self, ret_receiver) &&
           (becomes(self, ret_receiver, 1) ||
            conform_skip(self, "an RPDO is not taken at all: see pdo-receive"));
}

static bool check_state(struct conform *self, uint8_t command)
{
    struct receiver receiver;

    if (!begin_taken(self, &receiver))
        return false;
    conform_nmt(self, command);
    send_byte(self, &receiver, receiver.pdo.bytes, 3);
    conform_nmt(self, CONFORM_PREOP); /* for SDO */
    return expect_unchanged(self, &receiver, 1, "after an RPDO that is out of place");
}

static bool check_preoperational(struct conform *self)
{
    return check_state(self, CONFORM_PREOP);
}

static bool check_stopped(struct conform *self)
{
    return check_state(self, CONFORM_STOP);
}

static bool check_short(struct conform *self)
{
    struct receiver receiver;

    if (!begin_taken(self, &receiver))
        return false;
    send_byte(self, &receiver, (uint8_t)(receiver.pdo.bytes - 1), 3);
    return expect_unchanged(self, &receiver, 1, "after an RPDO that is a byte too short");
}

static bool is_not_full(struct conform *self, const struct conform_pdo *pdo)
{
    return pdo->bytes < 8 && has_byte(self, pdo);
}

/* Where all are full one is made shorter. */
static bool find_short(struct conform *self, struct receiver *ret_receiver)
{
    struct conform_pdo *pdo = &ret_receiver->pdo;

    if (conform_look_for_pdo(self, RPDO, is_not_full, pdo))
        return find_byte(self, ret_receiver);
    if (!find_receiver(self, ret_receiver) || !conform_unmap_pdo(self, pdo))
        return false;
    pdo->count--;
    return find_byte(self, ret_receiver)
               ? conform_map_pdo(self, pdo)
               : conform_skip(self, "no RPDO has room for a byte too much");
}

static bool check_long(struct conform *self)
{
    struct receiver receiver;

    if (!find_short(self, &receiver) || !take_at_once(self, &receiver.pdo))
        return false;
    conform_nmt(self, CONFORM_START);
    send_byte(self, &receiver, (uint8_t)(receiver.pdo.bytes + 1), 4);
    return expect_byte(self, &receiver, 4, "after an RPDO that is a byte too long");
}

static bool check_sync(struct conform *self)
{
    struct receiver receiver;
    uint8_t before;

    if (!find_receiver(self, &receiver) || !conform_set_pdo_type(self, &receiver.pdo, 1))
        return false;
    conform_nmt(self, CONFORM_START);
    before = read_byte(self, &receiver);
    send_byte(self, &receiver, receiver.pdo.bytes, before == 5 ? 7 : 5);
    send_byte(self, &receiver, receiver.pdo.bytes, before == 6 ? 8 : 6);
    if (!expect_unchanged(self, &receiver, before, "before the SYNC"))
        return false;
    conform_send_sync(self);
    return expect_byte(self, &receiver, before == 6 ? 8 : 6, "after the SYNC");
}

static bool has_deadline(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_find(self, pdo->index, 5) != NULL;
}

static bool check_deadline(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from, at;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_find_fitting_pdo(self, RPDO, has_deadline, &pdo) ||
        !conform_set(self, pdo.index, 5, 2, DEADLINE))
        return false;
    conform_nmt(self, CONFORM_START);
    from = conform_send_rpdo(self, &pdo, pdo.bytes);
    if (!conform_expect_emcy(self, from, 0x8250, &at))
        return false;
    return conform_frame(self, at)->data[2] & 0x10 ||
           conform_fail(self, "EMCY 8250h: expected bit 4 of the error register, received %02X",
                        conform_frame(self, at)->data[2]);
}

static const struct conform_check checks[] = {
    { "pdo-receive", "the data of an RPDO is that of its objects", "CiA 301, 7.2.2", CONFORM_RESET,
      0, check_taken },
    { "pdo-receive-preoperational", "an RPDO in pre-operational is ignored", "CiA 301, 7.3.2.2",
      CONFORM_RESET, 0, check_preoperational },
    { "pdo-receive-stopped", "an RPDO in Stopped is ignored", "CiA 301, 7.3.2.2", CONFORM_RESET, 0,
      check_stopped },
    { "pdo-receive-short", "an RPDO that is too short is not taken", "CiA 301, 7.2.2.3",
      CONFORM_RESET, 0, check_short },
    { "pdo-receive-long", "of an RPDO that is too long the first bytes are taken",
      "CiA 301, 7.2.2.3", CONFORM_RESET, 0, check_long },
    { "pdo-receive-sync", "transmission type 1: the last RPDO before the SYNC is taken with it",
      "CiA 301, 7.5.2.35", CONFORM_RESET, 0, check_sync },
    { "pdo-receive-deadline", "14xxh:05: an RPDO that does not come: EMCY 8250h",
      "CiA 301, 7.5.2.35", CONFORM_RESET, 0, check_deadline },
};

const struct conform_family conform_pdo_receive = { "pdo", "PDO", checks,
                                                    sizeof checks / sizeof checks[0] };

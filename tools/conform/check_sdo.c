/*
 * Checks of the default SDO server: expedited transfers, what they refuse, commands.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define REQUEST(self)  (0x600u + (self)->options.node)
#define RESPONSE(self) (0x580u + (self)->options.node)

static const uint32_t sizes[] = { 1, 2, 4 };
#define SIZES (sizeof sizes / sizeof sizes[0])

static bool skip_writable(struct conform *self)
{
    return conform_skip(self, "no object is known that can be written back without harm: give one "
                              "with --eds FILE");
}

/* --- reading --- */

static bool check_expedited_read(struct conform *self)
{
    const struct dcf_entry *entry = self->has_eds ? dcf_find(&self->eds, 0x1000, 0) : NULL;
    uint8_t request[8], answer[8];

    conform_request(request, 0x40, 0x1000, 0);
    if (!check_step(self, request, 0x43, answer))
        return false;
    if (memcmp(answer + 1, request + 1, 3) != 0)
        return conform_fail(self, "read 1000h:00: the answer is for %04Xh:%02X",
                            get_le16(answer + 1), answer[3]);
    if (entry && entry->initial.given && entry->initial.size == 4 &&
        memcmp(entry->initial.bytes, answer + 4, 4) != 0)
        return conform_fail(self, "1000h: the EDS says %08X, received %08X",
                            (unsigned)get_le32(entry->initial.bytes),
                            (unsigned)get_le32(answer + 4));
    return true;
}

/* Not more, too: else two devices have this node-ID, or one answers twice. */
static bool check_one_answer(struct conform *self)
{
    uint8_t answer[8];
    size_t first;

    if (!check_ask(self, 0x40, 0x1000, 0, answer))
        return conform_fail(self, "read 1000h:00: no answer");
    first = conform_await(self, 0, RESPONSE(self), 0);
    return conform_expect_none(self, first + 1, RESPONSE(self), CONFORM_QUIET);
}

/* Of a value, of an abort, and of a segment where the device has a longer value. */
static bool check_answer_length(struct conform *self)
{
    const struct conform_object *object = conform_long_object(self, 5);
    uint8_t answer[8];

    check_ask(self, 0x40, 0x1000, 0, answer);
    check_ask(self, 0x40, 0x1000, 1, answer);
    if (object && check_ask(self, 0x40, object->index, object->sub, answer)) {
        check_ask(self, 0x60, 0, 0, answer);
        check_give_up(self, object);
    }
    for (size_t at = 0; (at = conform_await(self, at, RESPONSE(self), 0)) != CONFORM_NOTHING; at++)
        if (conform_frame(self, at)->dlc != 8)
            return conform_fail(self, "an answer has %u bytes, expected 8",
                                conform_frame(self, at)->dlc);
    return true;
}

static bool check_read_write_only(struct conform *self)
{
    unsigned count = 0;

    for (size_t i = 0; i < self->object_count; i++) {
        const struct conform_object *object = &self->objects[i];
        struct conform_value value;
        char what[32];

        if (object->access != OD_WO)
            continue;
        count++;
        snprintf(what, sizeof what, "read %04Xh:%02X", object->index, object->sub);
        if (!conform_must_abort(self, what, conform_read(self, object->index, object->sub, &value),
                                CODES(SDO_WRITE_ONLY, SDO_ACCESS, SDO_GENERAL)))
            return false;
    }
    return count > 0 || conform_skip(self, "the EDS has no object that is only written");
}

static bool check_missing_sub(struct conform *self)
{
    struct conform_value value;

    return conform_must_abort(self, "read 1000h:01", conform_read(self, 0x1000, 1, &value),
                              CODES(SDO_NO_SUB, SDO_GENERAL));
}

static bool names_object(struct conform *self, uint16_t index, uint8_t sub)
{
    uint8_t answer[8];

    if (!check_ask(self, 0x40, index, sub, answer) || answer[0] != 0x80)
        return true; /* findings of other checks */
    if (get_le16(answer + 1) == index && answer[3] == sub)
        return true;
    return conform_fail(self,
                        "the refused read of %04Xh:%02X: expected an abort for it, received "
                        "one for %04Xh:%02X",
                        index, sub, get_le16(answer + 1), answer[3]);
}

static bool check_abort_object(struct conform *self)
{
    return names_object(self, 0x1000, 1) && names_object(self, 0x1004, 0);
}

static bool check_missing_object(struct conform *self)
{
    static const uint16_t candidates[] = { 0x1004, 0x100E, 0x100F, 0x10FE, 0x1F00 };
    struct conform_value value;

    for (size_t i = 0; i < sizeof candidates / sizeof candidates[0]; i++) {
        char what[32];

        if (conform_has(self, candidates[i]))
            continue;
        snprintf(what, sizeof what, "read %04Xh:00", candidates[i]);
        return conform_must_abort(self, what, conform_read(self, candidates[i], 0, &value),
                                  CODES(SDO_NO_OBJECT, SDO_GENERAL)) &&
               conform_must_abort(self, what, conform_write_number(self, candidates[i], 0, 2, 0),
                                  CODES(SDO_NO_OBJECT, SDO_GENERAL));
    }
    return conform_skip(self, "the device has all objects that usually miss");
}

/* --- writing --- */

static bool check_write_back(struct conform *self)
{
    unsigned count = 0;

    for (size_t i = 0; i < SIZES; i++) {
        const struct conform_object *object = conform_writable(self, sizes[i]);
        uint64_t number;

        if (!object)
            continue;
        count++;
        if (!conform_must_read_number(self, object->index, object->sub, &number) ||
            !conform_must_write(self, object->index, object->sub, sizes[i], number))
            return false;
    }
    return count > 0 || skip_writable(self);
}

static bool check_write_read_only(struct conform *self)
{
    struct conform_value before;
    const struct conform_object device_type = { .index = 0x1000 };

    return conform_must_read(self, 0x1000, 0, &before) &&
           conform_must_abort(self, "write 1000h:00", conform_write_number(self, 0x1000, 0, 4, 1),
                              CODES(SDO_READ_ONLY, SDO_ACCESS, SDO_GENERAL)) &&
           check_unchanged(self, &device_type, &before);
}

struct wrong_size {
    uint32_t written;
    const uint32_t *sizes; /* of the objects; 0 at the end */
    const uint32_t *codes;
};

/* Writes the present value, longer or shorter than it is. */
static bool check_wrong_size(struct conform *self, const struct wrong_size *wrong)
{
    unsigned count = 0;

    for (size_t i = 0; wrong->sizes[i] != 0; i++) {
        const struct conform_object *object = conform_writable(self, wrong->sizes[i]);
        struct conform_value before;
        char what[64];

        if (!object)
            continue;
        count++;
        snprintf(what, sizeof what, "write of %u bytes to %04Xh:%02X, which has %u",
                 (unsigned)wrong->written, object->index, object->sub, (unsigned)wrong->sizes[i]);
        if (!conform_must_read(self, object->index, object->sub, &before) ||
            !conform_must_abort(
                self, what,
                conform_write(self, object->index, object->sub, before.bytes, wrong->written),
                wrong->codes) ||
            !check_unchanged(self, object, &before))
            return false;
    }
    return count > 0 || skip_writable(self);
}

static bool check_too_long(struct conform *self)
{
    static const uint32_t shorter[] = { 1, 2, 0 };

    return check_wrong_size(
        self,
        &(struct wrong_size){ 4, shorter, CODES(SDO_TOO_LONG, SDO_TYPE_LENGTH, SDO_GENERAL) });
}

static bool check_too_short(struct conform *self)
{
    static const uint32_t longer[] = { 2, 4, 0 };

    return check_wrong_size(
        self,
        &(struct wrong_size){ 1, longer, CODES(SDO_TOO_SHORT, SDO_TYPE_LENGTH, SDO_GENERAL) });
}

/* Command 22: the server takes as many bytes as the object has. */
static bool check_no_size(struct conform *self)
{
    unsigned count = 0;

    for (size_t i = 0; i < SIZES; i++) {
        const struct conform_object *object = conform_writable(self, sizes[i]);
        struct conform_value before;
        uint8_t request[8], answer[8];

        if (!object)
            continue;
        count++;
        if (!conform_must_read(self, object->index, object->sub, &before))
            return false;
        conform_request(request, 0x22, object->index, object->sub);
        memcpy(request + 4, before.bytes, 4);
        if (!check_step(self, request, 0x60, answer) || !check_unchanged(self, object, &before))
            return false;
    }
    return count > 0 || skip_writable(self);
}

/* --- limits --- */

static bool refuses_beyond(struct conform *self, const struct conform_object *object,
                           enum check_side side, const uint32_t *codes)
{
    uint8_t bytes[8];
    uint32_t size;
    struct conform_value before;
    char what[64];

    if (!check_beyond_limit(self, object, side, bytes, &size))
        return false;
    snprintf(what, sizeof what, "write %04Xh:%02X %s its limit", object->index, object->sub,
             side == CHECK_ABOVE ? "above" : "below");
    return conform_must_read(self, object->index, object->sub, &before) &&
           conform_must_abort(
               self, what, conform_write(self, object->index, object->sub, bytes, size), codes) &&
           check_unchanged(self, object, &before);
}

/* The first object with such a limit; NULL: there is none. */
static const struct conform_object *limited(const struct conform *self, enum check_side side)
{
    uint8_t bytes[8];
    uint32_t size;

    for (size_t i = 0; i < self->object_count; i++)
        if (check_is_writable(&self->objects[i]) &&
            !check_takes_signature(self->objects[i].index) &&
            check_beyond_limit(self, &self->objects[i], side, bytes, &size))
            return &self->objects[i];
    return NULL;
}

static bool check_above_limit(struct conform *self)
{
    const struct conform_object *object = limited(self, CHECK_ABOVE);
    const uint32_t *codes = CODES(SDO_VALUE_HIGH, SDO_INVALID_VALUE, SDO_GENERAL);

    if (object)
        return refuses_beyond(self, object, CHECK_ABOVE, codes);
    object = conform_find(self, 0x1003, 0);
    if (!object || (object->access != CONFORM_UNKNOWN && !check_is_writable(object)))
        return conform_skip(self, "no object with a HighLimit is known: give one with --eds FILE");
    return conform_must_abort(self, "write FF to 1003h:00",
                              conform_write_number(self, 0x1003, 0, 1, 0xFF), codes);
}

static bool check_below_limit(struct conform *self)
{
    const struct conform_object *object = limited(self, CHECK_BELOW);

    if (!object)
        return conform_skip(self, "no object with a LowLimit is known: give one with --eds FILE");
    return refuses_beyond(self, object, CHECK_BELOW,
                          CODES(SDO_VALUE_LOW, SDO_INVALID_VALUE, SDO_GENERAL));
}

/* --- commands and frames --- */

static bool check_unknown_command(struct conform *self)
{
    uint8_t answer[8];

    check_ask(self, 0xE0, 0x1000, 0, answer);
    return conform_must_answer_abort(self, "command E0", answer, CODES(SDO_COMMAND, SDO_GENERAL)) &&
           check_still_serves(self);
}

/* Ends and answers of block transfers, of which none runs. */
static bool check_block_end_idle(struct conform *self)
{
    static const uint8_t commands[] = { 0xC1, 0xA1, 0xA2, 0xA3 };

    for (size_t i = 0; i < sizeof commands; i++) {
        uint8_t answer[8];
        char what[48];

        snprintf(what, sizeof what, "command %02X without a block transfer", commands[i]);
        check_ask(self, commands[i], 0, 0, answer);
        if (!conform_must_answer_abort(self, what, answer, CODES(SDO_COMMAND, SDO_GENERAL)))
            return false;
    }
    return check_still_serves(self);
}

static bool check_abort_silent(struct conform *self)
{
    uint8_t request[8];
    size_t from;

    conform_request(request, 0x80, 0x1000, 0);
    put_le32(request + 4, SDO_TIMEOUT);
    from = conform_send_data(self, REQUEST(self), request, 8);
    return conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET) &&
           check_still_serves(self);
}

static bool check_short_frames(struct conform *self)
{
    uint8_t request[8];
    size_t from;

    conform_request(request, 0x40, 0x1000, 0);
    from = conform_send_data(self, REQUEST(self), request, 7);
    conform_send_data(self, REQUEST(self), request, 0);
    return conform_expect_none(self, from, RESPONSE(self), CONFORM_QUIET) &&
           check_still_serves(self);
}

static bool check_stopped(struct conform *self)
{
    uint8_t request[8];
    size_t from;
    bool silent;

    conform_request(request, 0x40, 0x1000, 0);
    conform_nmt(self, CONFORM_STOP);
    from = conform_send_data(self, REQUEST(self), request, 8);
    silent = conform_expect_none(self, from, RESPONSE(self), 2 * CONFORM_QUIET);
    conform_nmt(self, CONFORM_PREOP);
    return silent && check_still_serves(self);
}

static bool check_operational(struct conform *self)
{
    bool good;

    conform_nmt(self, CONFORM_START);
    good = check_still_serves(self);
    conform_nmt(self, CONFORM_PREOP);
    return good;
}

static const struct conform_check checks[] = {
    { "sdo-read-expedited", "1000h is read in one answer, with its size", "CiA 301, 7.2.4.3", 0, 0,
      check_expedited_read },
    { "sdo-one-answer", "a request has one answer", "CiA 301, 7.2.4.3", 0, 0, check_one_answer },
    { "sdo-answer-length", "answers have 8 bytes", "CiA 301, 7.2.4.3", 0, 0, check_answer_length },
    { "sdo-write-back", "what was read can be written back", "CiA 301, 7.2.4.3", 0, 0,
      check_write_back },
    { "sdo-write-read-only", "a write to 1000h is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_write_read_only },
    { "sdo-read-write-only", "a read of what is only written is refused", "CiA 301, 7.2.4.3.17",
      CONFORM_EDS, 0, check_read_write_only },
    { "sdo-missing-sub", "a sub-index that does not exist is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_missing_sub },
    { "sdo-missing-object", "an object that does not exist is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_missing_object },
    { "sdo-abort-object", "the abort of a refused request names its object", "CiA 301, 7.2.4.3.17",
      0, 0, check_abort_object },
    { "sdo-too-long", "4 bytes for an object of 1 or 2 are refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_too_long },
    { "sdo-too-short", "1 byte for an object of 2 or 4 is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_too_short },
    { "sdo-no-size", "a write without its size takes that of the object", "CiA 301, 7.2.4.3", 0, 0,
      check_no_size },
    { "sdo-above-limit", "a value above the limit is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_above_limit },
    { "sdo-below-limit", "a value below the limit is refused", "CiA 301, 7.2.4.3.17", 0, 0,
      check_below_limit },
    { "sdo-unknown-command", "a command that does not exist is refused", "CiA 301, 7.2.4.3", 0, 0,
      check_unknown_command },
    { "sdo-block-end-idle", "the end of a block transfer that does not run is refused",
      "CiA 301, 7.2.4.3", 0, 0, check_block_end_idle },
    { "sdo-abort-silent", "an abort is not answered", "CiA 301, 7.2.4.3.17", 0, 0,
      check_abort_silent },
    { "sdo-short-frames", "requests of less than 8 bytes are ignored", "CiA 301, 7.2.4.3", 0, 0,
      check_short_frames },
    { "sdo-stopped", "there is no SDO in the state stopped", "CiA 301, 7.3.2.2", CONFORM_RESET, 0,
      check_stopped },
    { "sdo-operational", "there is SDO in the state operational", "CiA 301, 7.3.2.2", CONFORM_RESET,
      0, check_operational },
};

const struct conform_family conform_sdo = { "sdo", "SDO", checks,
                                            sizeof checks / sizeof checks[0] };

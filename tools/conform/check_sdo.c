/*
 * Checks of the default SDO server: expedited transfers, access rights, commands.
 */
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

static bool check_expedited_read(struct conform *self)
{
    const struct dcf_entry *entry = self->has_eds ? dcf_find(&self->eds, 0x1000, 0) : NULL;
    uint8_t request[8], answer[8];

    conform_request(request, 0x40, 0x1000, 0);
    if (!conform_exchange(self, request, answer))
        return conform_fail(self, "read 1000h:00: no answer");
    if (answer[0] != 0x43 || memcmp(answer + 1, request + 1, 3) != 0)
        return conform_fail(self,
                            "read 1000h:00: expected 43 00 10 00 ..., received %02X %02X "
                            "%02X %02X ...",
                            answer[0], answer[1], answer[2], answer[3]);
    if (entry && entry->initial.given && entry->initial.size == 4 &&
        memcmp(entry->initial.bytes, answer + 4, 4) != 0)
        return conform_fail(self, "1000h: the EDS says %08X, received %08X",
                            (unsigned)get_le32(entry->initial.bytes),
                            (unsigned)get_le32(answer + 4));
    return true;
}

static bool check_unknown_command(struct conform *self)
{
    uint8_t request[8], answer[8];

    conform_request(request, 0xE0, 0x1000, 0);
    conform_exchange(self, request, answer);
    return conform_must_answer_abort(self, "command E0", answer, CODES(SDO_COMMAND, SDO_GENERAL));
}

static const struct conform_check checks[] = {
    { "sdo-read-expedited", "1000h is read in one answer, with its size", "CiA 301, 7.2.4.3", 0, 0,
      check_expedited_read },
    { "sdo-unknown-command", "a command that does not exist is refused", "CiA 301, 7.2.4.3", 0, 0,
      check_unknown_command },
};

const struct conform_family conform_sdo = { "sdo", "SDO", checks,
                                            sizeof checks / sizeof checks[0] };

/*
 * Checks of SDO server parameters: the default channel, and the additional ones.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

#define FIRST_SERVER   0x1201u
#define LAST_SERVER    0x127Fu
#define COB_ID_INVALID 0x80000000u

/* Identifiers that no predefined service of any node has. */
#define REQUEST_ID  0x6A0u
#define RESPONSE_ID 0x6A1u

static bool check_default_channel(struct conform *self)
{
    const uint32_t expected[] = { 0x600u + self->options.node, 0x580u + self->options.node };

    for (uint8_t sub = 1; sub <= 2; sub++) {
        uint64_t number;

        if (!conform_must_read_number(self, 0x1200, sub, &number))
            return false;
        if (number != expected[sub - 1])
            return conform_fail(self, "1200h:%02X: expected %08X, received %08X", sub,
                                (unsigned)expected[sub - 1], (unsigned)number);
    }
    return true;
}

static bool check_default_fixed(struct conform *self)
{
    const uint32_t *codes = CODES(SDO_READ_ONLY, SDO_ACCESS, SDO_INVALID_VALUE, SDO_DEVICE_STATE,
                                  SDO_GENERAL);

    return conform_must_abort(self, "write 1200h:01",
                              conform_write_number(self, 0x1200, 1, 4, REQUEST_ID), codes) &&
           conform_must_abort(self, "write 1200h:02",
                              conform_write_number(self, 0x1200, 2, 4, RESPONSE_ID), codes) &&
           check_default_channel(self);
}

/* Each server of the EDS is there, and no other one. */
static bool check_servers(struct conform *self)
{
    for (uint32_t index = FIRST_SERVER; index <= LAST_SERVER; index++) {
        const bool expected = conform_has(self, (uint16_t)index);
        struct conform_value value;
        uint32_t result = conform_read(self, (uint16_t)index, 1, &value);
        char text[CONFORM_RESULT_SIZE];

        if ((result == SDO_OK) != expected)
            return conform_fail(self, "read %04Xh:01: expected %s, received %s", (unsigned)index,
                                expected ? "success" : "abort 06020000",
                                conform_result_text(result, text, sizeof text));
    }
    return true;
}

/* A server whose channel the tester may switch on; 0: none, told. */
static uint16_t free_server(struct conform *self)
{
    for (uint32_t index = FIRST_SERVER; index <= LAST_SERVER; index++) {
        const struct conform_object *object = conform_find(self, (uint16_t)index, 1);

        if (!object || object->access == OD_RO || object->access == OD_CONST)
            continue;
        if (conform_number(self, (uint16_t)index, 1, 0) & COB_ID_INVALID)
            return (uint16_t)index;
    }
    conform_skip(self, "the device has no additional SDO server that is free");
    return 0;
}

static bool set_channel(struct conform *self, uint16_t index, uint32_t bit)
{
    return conform_must_write(self, index, 1, 4, REQUEST_ID | bit) &&
           conform_must_write(self, index, 2, 4, RESPONSE_ID | bit);
}

/* 1000h through the other channel; the default one stays silent. */
static bool use_channel(struct conform *self)
{
    uint8_t request[8];
    size_t from, at;

    conform_request(request, 0x40, 0x1000, 0);
    from = conform_send_data(self, REQUEST_ID, request, 8);
    at = conform_await(self, from, RESPONSE_ID, self->options.sdo_timeout);
    if (at == CONFORM_NOTHING)
        return conform_fail(self, "read 1000h through %03X: no answer on %03X", REQUEST_ID,
                            RESPONSE_ID);
    if (conform_frame(self, at)->data[0] != 0x43)
        return conform_fail(self, "read 1000h through %03X: expected 43, received %02X", REQUEST_ID,
                            conform_frame(self, at)->data[0]);
    return conform_expect_none(self, from, 0x580u + self->options.node, 0) &&
           check_still_serves(self);
}

static bool check_second_channel(struct conform *self)
{
    const uint16_t index = free_server(self);

    return index != 0 && set_channel(self, index, COB_ID_INVALID) && set_channel(self, index, 0) &&
           use_channel(self) && set_channel(self, index, COB_ID_INVALID);
}

/* Half a channel is none. */
static bool check_half_channel(struct conform *self)
{
    const uint16_t index = free_server(self);
    uint8_t request[8];
    size_t from;

    if (index == 0 || !set_channel(self, index, COB_ID_INVALID) ||
        !conform_must_write(self, index, 1, 4, REQUEST_ID))
        return false;
    conform_request(request, 0x40, 0x1000, 0);
    from = conform_send_data(self, REQUEST_ID, request, 8);
    return conform_expect_none(self, from, RESPONSE_ID, CONFORM_QUIET) &&
           set_channel(self, index, COB_ID_INVALID);
}

#define CLAUSE "CiA 301, 7.5.2; objects 1200h to 127Fh"

static const struct conform_check checks[] = {
    { "sdo-default-channel", "1200h tells the default channel", CLAUSE, 0, 0x1200,
      check_default_channel },
    { "sdo-default-fixed", "the default channel cannot be changed", CLAUSE, CONFORM_RESET, 0x1200,
      check_default_fixed },
    { "sdo-servers", "the additional servers are those of the EDS", CLAUSE, CONFORM_EDS, 0,
      check_servers },
    { "sdo-second-channel", "an additional server answers on its own channel", CLAUSE,
      CONFORM_RESET, 0, check_second_channel },
    { "sdo-half-channel", "a channel with one identifier does not exist", CLAUSE, CONFORM_RESET, 0,
      check_half_channel },
};

const struct conform_family conform_sdo_channel = { "sdo", "SDO channels", checks,
                                                    sizeof checks / sizeof checks[0] };

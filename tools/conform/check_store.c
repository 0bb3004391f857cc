/*
 * Checks of storing parameters and of restoring their defaults. Those that write non-volatile
 * memory leave the device with its defaults.
 */
#include "conform_families.h"
#include "conform_services.h"

#include "od/abort.h"

#define SAVE  0x65766173u
#define LOAD  0x64616F6Cu
#define WRONG 0x6E6F7277u

#define STORE         0x1010u
#define RESTORE       0x1011u
#define ON_COMMAND    1u
#define AUTONOMOUSLY  2u
#define DATE          0x1020u
#define SYNC_OVERFLOW 4u

static bool refuse_signature(struct conform *self, uint16_t index)
{
    for (uint8_t sub = 1; sub <= 127; sub++) {
        char what[48];

        if (!conform_find(self, index, sub))
            continue;
        snprintf(what, sizeof what, "a wrong signature to %04Xh:%02X", index, sub);
        if (!conform_must_abort(self, what, conform_write_number(self, index, sub, 4, WRONG),
                                CODES(SDO_NOT_STORED, SDO_GENERAL)))
            return false;
    }
    return true;
}

static bool check_store_signature(struct conform *self)
{
    return refuse_signature(self, STORE);
}

static bool check_capability(struct conform *self)
{
    uint64_t capability;

    return conform_must_read_number(self, STORE, 1, &capability) &&
           ((capability & ~(uint64_t)(ON_COMMAND | AUTONOMOUSLY)) == 0 ||
            conform_fail(self, "1010h:01 is %08X: bits 2 to 31 are reserved",
                         (unsigned)capability));
}

static bool stores_on_command(struct conform *self)
{
    uint64_t capability;

    if (!conform_must_read_number(self, STORE, 1, &capability))
        return false;
    if (capability & AUTONOMOUSLY)
        return conform_skip(self, "the device stores by itself: 1010h:01 has bit 1");
    return (capability & ON_COMMAND) != 0 ||
           conform_skip(self, "the device does not store on command: 1010h:01 has not bit 0");
}

/* --- values that outlive a reset --- */

/* A communication parameter, its value after a reset and another one. */
struct parameter {
    const struct conform_object *object;
    uint64_t initial, other;
};

static bool find_parameter(struct conform *self, struct parameter *ret_parameter)
{
    ret_parameter->object = conform_writable(self, 2);
    if (!ret_parameter->object || ret_parameter->object->index >= 0x2000)
        return conform_skip(self, "no communication parameter of 2 bytes can be written");
    if (!conform_must_read_number(self, ret_parameter->object->index, ret_parameter->object->sub,
                                  &ret_parameter->initial))
        return false;
    ret_parameter->other = ret_parameter->initial == 1234 ? 4321 : 1234;
    return true;
}

static bool set_parameter(struct conform *self, const struct parameter *parameter)
{
    return conform_set(self, parameter->object->index, parameter->object->sub, 2, parameter->other);
}

static bool expect_parameter(struct conform *self, const struct parameter *parameter,
                             uint64_t expected, const char *when)
{
    uint64_t found;

    if (!conform_must_read_number(self, parameter->object->index, parameter->object->sub, &found))
        return false;
    return found == expected || conform_fail(self, "%s: expected %u in %04Xh:%02X, received %u",
                                             when, (unsigned)expected, parameter->object->index,
                                             parameter->object->sub, (unsigned)found);
}

static bool save(struct conform *self)
{
    return conform_set(self, STORE, 1, 4, SAVE);
}

/* The defaults, whatever the check has found: what it says first counts. */
static bool clean_up(struct conform *self, bool result)
{
    conform_write_number(self, RESTORE, 1, 4, LOAD);
    return conform_reset(self, CONFORM_RESET_NODE) && result;
}

static bool has_both(struct conform *self)
{
    return conform_need_object(self, RESTORE) && stores_on_command(self);
}

static bool save_and_reset(struct conform *self, uint8_t reset, const char *when)
{
    struct parameter parameter;

    return find_parameter(self, &parameter) && set_parameter(self, &parameter) && save(self) &&
           conform_reset(self, reset) && expect_parameter(self, &parameter, parameter.other, when);
}

static bool check_save(struct conform *self)
{
    return has_both(self) && clean_up(self, save_and_reset(self, CONFORM_RESET_NODE,
                                                           "after \"save\" and reset node"));
}

static bool check_save_communication(struct conform *self)
{
    return has_both(self) &&
           clean_up(self, save_and_reset(self, CONFORM_RESET_COMM,
                                         "after \"save\" and reset communication"));
}

static bool save_and_refuse(struct conform *self)
{
    struct parameter parameter;

    return find_parameter(self, &parameter) && set_parameter(self, &parameter) && save(self) &&
           refuse_signature(self, RESTORE) && conform_reset(self, CONFORM_RESET_NODE) &&
           expect_parameter(self, &parameter, parameter.other,
                            "after a wrong signature to 1011h and a reset");
}

static bool check_restore_signature(struct conform *self)
{
    return has_both(self) && clean_up(self, save_and_refuse(self));
}

static bool save_and_load(struct conform *self)
{
    struct parameter parameter;

    return find_parameter(self, &parameter) && set_parameter(self, &parameter) && save(self) &&
           conform_set(self, RESTORE, 1, 4, LOAD) &&
           expect_parameter(self, &parameter, parameter.other,
                            "after \"load\", before the reset") &&
           conform_reset(self, CONFORM_RESET_NODE) &&
           expect_parameter(self, &parameter, parameter.initial, "after \"load\" and reset node");
}

static bool check_restore(struct conform *self)
{
    return has_both(self) && clean_up(self, save_and_load(self));
}

/* --- 1020h --- */

static bool expect_date(struct conform *self, uint64_t date, uint64_t time, const char *when)
{
    uint64_t found_date, found_time;

    if (!conform_must_read_number(self, DATE, 1, &found_date) ||
        !conform_must_read_number(self, DATE, 2, &found_time))
        return false;
    return (found_date == date && found_time == time) ||
           conform_fail(self, "1020h %s: expected %u and %u, received %u and %u", when,
                        (unsigned)date, (unsigned)time, (unsigned)found_date, (unsigned)found_time);
}

static bool save_date(struct conform *self)
{
    struct parameter parameter;

    return find_parameter(self, &parameter) && conform_set(self, DATE, 1, 4, 12345) &&
           conform_set(self, DATE, 2, 4, 67890) && save(self) &&
           conform_reset(self, CONFORM_RESET_NODE) &&
           expect_date(self, 12345, 67890, "after \"save\" and reset node") &&
           set_parameter(self, &parameter) &&
           expect_date(self, 0, 0, "after another parameter was written");
}

static bool check_date(struct conform *self)
{
    return has_both(self) && conform_need_object(self, DATE) && clean_up(self, save_date(self));
}

/* --- SYNC --- */

static bool save_producer(struct conform *self)
{
    size_t from, at;

    if (!conform_set(self, 0x1006, 0, 4, 0) || !conform_set(self, 0x1019, 0, 1, SYNC_OVERFLOW) ||
        !conform_set(self, 0x1006, 0, 4, 20000))
        return false;
    if (conform_write_number(self, 0x1005, 0, 4, 0x40000080) != SDO_OK)
        return conform_skip(self, "the device produces no SYNC: 1005h refuses bit 30");
    if (!save(self))
        return false;
    from = conform_mark(self);
    if (!conform_reset(self, CONFORM_RESET_NODE))
        return false;
    at = conform_await_byte(self, from, conform_control_id(self), 0x00, 0);
    at = conform_await(self, at, 0x080, 1000);
    if (at == CONFORM_NOTHING || conform_frame(self, at)->dlc != 1 ||
        conform_frame(self, at)->data[0] != 1)
        return conform_fail(self, "the SYNC that was saved does not begin with the counter 1 "
                                  "after the reset");
    return true;
}

static bool check_sync(struct conform *self)
{
    return has_both(self) && conform_need_object(self, 0x1019) &&
           conform_need_object(self, 0x1006) && clean_up(self, save_producer(self));
}

static const struct conform_check checks[] = {
    { "store-signature", "1010h refuses a wrong signature", "CiA 301, 7.5.2.13", 0, STORE,
      check_store_signature },
    { "store-capability", "1010h:01 tells when the device stores, and nothing else",
      "CiA 301, 7.5.2.13", 0, STORE, check_capability },
    { "store-save", "what is saved is there after reset node", "CiA 301, 7.5.2.13",
      CONFORM_STORE | CONFORM_RESET, STORE, check_save },
    { "store-save-communication", "what is saved is there after reset communication",
      "CiA 301, 7.5.2.13", CONFORM_STORE | CONFORM_RESET, STORE, check_save_communication },
    { "store-sync", "a SYNC producer that is saved works after reset node", "CiA 301, 7.5.2.13",
      CONFORM_STORE | CONFORM_RESET, STORE, check_sync },
    { "store-date", "1020h is saved, and 0 when a parameter is changed", "CiA 301, 7.5.2.23",
      CONFORM_STORE | CONFORM_RESET, STORE, check_date },
    { "store-load-signature", "1011h refuses a wrong signature, and nothing changes",
      "CiA 301, 7.5.2.14", CONFORM_STORE | CONFORM_RESET, STORE, check_restore_signature },
    { "store-load", "\"load\": the defaults are there after reset node, and not before",
      "CiA 301, 7.5.2.14", CONFORM_STORE | CONFORM_RESET, STORE, check_restore },
};

const struct conform_family conform_store = { "store", "Store and restore", checks,
                                              sizeof checks / sizeof checks[0] };

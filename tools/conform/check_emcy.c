/*
 * Checks of emergencies, the error register and the history of errors. The error that is provoked
 * is an RPDO without data.
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"

#define INHIBIT_MS  100u
#define HISTORY_MAX 32u /* more errors are not provoked */

static bool check_cob_id(struct conform *self)
{
    uint64_t cob_id;

    if (!conform_must_read_number(self, 0x1014, 0, &cob_id))
        return false;
    if (cob_id != 0x80u + self->options.node)
        return conform_fail(self, "1014h: expected %08X, received %08X", 0x80u + self->options.node,
                            (unsigned)cob_id);
    return true;
}

static bool expect_register(struct conform *self, uint8_t expected, const char *when)
{
    uint64_t value;

    if (!conform_must_read_number(self, 0x1001, 0, &value))
        return false;
    if (value != expected)
        return conform_fail(self, "1001h %s: expected %02X, received %02X", when, expected,
                            (unsigned)value);
    return true;
}

static bool check_register_clear(struct conform *self)
{
    return expect_register(self, 0, "without an error");
}

/* The error, and the emergency that tells it. Where there is none, one check tells. */
static bool provoke(struct conform *self, struct conform_pdo *ret_pdo, size_t *ret_at)
{
    size_t from;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_provoke(self, ret_pdo, &from))
        return false;
    *ret_at = conform_find_emcy(self, from, EMCY_SHORT_PDO);
    return *ret_at != CONFORM_NOTHING ||
           conform_skip(self, "an RPDO without data gives no EMCY 8210h: see emcy-sent");
}

static bool check_sent(struct conform *self)
{
    struct conform_pdo pdo;
    const struct co_frame *frame;
    size_t from, at;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_provoke(self, &pdo, &from) ||
        !conform_expect_emcy(self, from, EMCY_SHORT_PDO, &at))
        return false;
    frame = conform_frame(self, at);
    if (frame->dlc != 8)
        return conform_fail(self, "the emergency has %u bytes, expected 8", frame->dlc);
    if ((frame->data[2] & 0x01) == 0)
        return conform_fail(self, "the emergency's error register is %02X: expected bit 0 set",
                            frame->data[2]);
    return true;
}

static bool check_once(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    return provoke(self, &pdo, &at) &&
           conform_expect_no_emcy(self, at + 1, EMCY_SHORT_PDO, CONFORM_QUIET);
}

static bool check_register(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    return provoke(self, &pdo, &at) &&
           expect_register(self, conform_frame(self, at)->data[2], "after the emergency");
}

static bool check_gone(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    if (!provoke(self, &pdo, &at))
        return false;
    return conform_expect_emcy(self, conform_appease(self, &pdo), 0x0000, &at) &&
           expect_register(self, 0, "after the error");
}

/* --- 1003h --- */

static bool check_history_empty(struct conform *self)
{
    struct conform_value value;
    uint64_t count;

    if (!conform_must_read_number(self, 0x1003, 0, &count))
        return false;
    if (count != 0)
        return conform_fail(self, "1003h:00 is %u without an error: expected 0", (unsigned)count);
    return conform_must_abort(self, "read 1003h:01 without an error",
                              conform_read(self, 0x1003, 1, &value),
                              CODES(SDO_NO_DATA, SDO_GENERAL));
}

static bool expect_count(struct conform *self, unsigned expected, const char *when)
{
    uint64_t count;

    if (!conform_must_read_number(self, 0x1003, 0, &count))
        return false;
    if (count != expected)
        return conform_fail(self, "1003h:00 %s: expected %u, received %u", when, expected,
                            (unsigned)count);
    return true;
}

static bool expect_entry(struct conform *self, uint8_t sub, uint16_t code)
{
    uint64_t entry;

    if (!conform_must_read_number(self, 0x1003, sub, &entry))
        return false;
    if ((entry & 0xFFFF) != code)
        return conform_fail(self, "1003h:%02X: expected the code %04X, received %08X", sub, code,
                            (unsigned)entry);
    return true;
}

static bool check_history(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    return provoke(self, &pdo, &at) && expect_count(self, 1, "after an error") &&
           expect_entry(self, 1, EMCY_SHORT_PDO);
}

static bool check_history_kept(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    if (!provoke(self, &pdo, &at))
        return false;
    conform_appease(self, &pdo);
    return expect_count(self, 1, "after the error has gone") &&
           expect_entry(self, 1, EMCY_SHORT_PDO);
}

static bool check_history_clear(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    return provoke(self, &pdo, &at) &&
           conform_must_abort(self, "write 1 to 1003h:00",
                              conform_write_number(self, 0x1003, 0, 1, 1),
                              CODES(SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_GENERAL)) &&
           conform_set(self, 0x1003, 0, 1, 0) && expect_count(self, 0, "after 0 was written to it");
}

static unsigned history_size(struct conform *self)
{
    unsigned size = 0;

    while (size < 254 && conform_find(self, 0x1003, (uint8_t)(size + 1)))
        size++;
    return size;
}

static bool check_history_full(struct conform *self)
{
    const unsigned size = history_size(self);
    struct conform_pdo pdo;
    size_t at;

    if (size == 0 || size > HISTORY_MAX)
        return conform_skip(self, "1003h has %u entries, this check knows 1 to %u", size,
                            HISTORY_MAX);
    for (unsigned i = 0; i < size + 2; i++) {
        if (!provoke(self, &pdo, &at))
            return false;
        conform_appease(self, &pdo);
    }
    return expect_count(self, size, "after more errors than it has entries") &&
           expect_entry(self, (uint8_t)size, EMCY_SHORT_PDO);
}

static bool check_history_order(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from, at;

    if (!conform_need_object(self, 0x1016) || history_size(self) < 2)
        return conform_skip(self, "it takes two kinds of errors: 1016h, and two entries");
    if (!provoke(self, &pdo, &at) || !conform_set(self, 0x1016, 1, 4, 0x7E0064))
        return false;
    from = conform_send_data(self, 0x77E, (uint8_t[]){ STATE_OPERATIONAL }, 1);
    return conform_expect_emcy(self, from, 0x8130, &at) && expect_entry(self, 1, 0x8130) &&
           expect_entry(self, 2, EMCY_SHORT_PDO);
}

/* --- 1014h and 1015h --- */

static bool check_inhibit(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from, first, second;
    co_us_t gap;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_set(self, 0x1015, 0, 2, INHIBIT_MS * 10) ||
        !conform_provoke(self, &pdo, &from))
        return false;
    conform_appease(self, &pdo);
    first = conform_await(self, from, id, EMCY_WAIT);
    if (first == CONFORM_NOTHING)
        return conform_skip(self, "an RPDO without data gives no emergency: see emcy-sent");
    second = conform_await(self, first + 1, id, EMCY_WAIT);
    if (second == CONFORM_NOTHING)
        return conform_skip(self, "the end of the error is no second emergency");
    gap = conform_time(self, second) - conform_time(self, first);
    if (gap < CO_MS(INHIBIT_MS / 2))
        return conform_fail(self, "1015h is %u ms: received two emergencies within %u us",
                            INHIBIT_MS, (unsigned)gap);
    return true;
}

static bool check_off(struct conform *self)
{
    const uint32_t id = 0x80u + self->options.node;
    struct conform_pdo pdo;
    size_t from;

    if (conform_write_number(self, 0x1014, 0, 4, id | 0x80000000u) == SDO_READ_ONLY)
        return conform_skip(self, "1014h cannot be written");
    return conform_set(self, 0x1014, 0, 4, id | 0x80000000u) &&
           conform_provoke(self, &pdo, &from) && conform_expect_none(self, from, id, CONFORM_QUIET);
}

static const struct conform_check checks[] = {
    { "emcy-cob-id", "1014h is 80h + node-ID", "CiA 301, 7.5.2.17", 0, 0x1014, check_cob_id },
    { "emcy-register-clear", "1001h is 0 without an error", "CiA 301, 7.5.2.2", 0, 0,
      check_register_clear },
    { "emcy-sent", "an RPDO without data: EMCY 8210h with its error register", "CiA 301, 7.2.7",
      CONFORM_RESET, 0x1014, check_sent },
    { "emcy-once", "an emergency is sent once", "CiA 301, 7.2.7", CONFORM_RESET, 0x1014,
      check_once },
    { "emcy-register", "1001h is the error register of the last emergency", "CiA 301, 7.5.2.2",
      CONFORM_RESET, 0x1014, check_register },
    { "emcy-gone", "the end of the error: EMCY 0000h, 1001h is 0", "CiA 301, 7.2.7", CONFORM_RESET,
      0x1014, check_gone },
    { "emcy-history-empty", "1003h is empty without an error", "CiA 301, 7.5.2.4", 0, 0x1003,
      check_history_empty },
    { "emcy-history", "1003h:01 has the code of the error", "CiA 301, 7.5.2.4", CONFORM_RESET,
      0x1003, check_history },
    { "emcy-history-kept", "1003h keeps an error that has gone", "CiA 301, 7.5.2.4", CONFORM_RESET,
      0x1003, check_history_kept },
    { "emcy-history-clear", "1003h:00 takes 0, which clears it, and nothing else",
      "CiA 301, 7.5.2.4", CONFORM_RESET, 0x1003, check_history_clear },
    { "emcy-history-full", "more errors than 1003h has entries: the oldest are forgotten",
      "CiA 301, 7.5.2.4", CONFORM_EDS | CONFORM_RESET, 0x1003, check_history_full },
    { "emcy-history-order", "the newest error is 1003h:01", "CiA 301, 7.5.2.4",
      CONFORM_EDS | CONFORM_RESET, 0x1003, check_history_order },
    { "emcy-inhibit", "emergencies keep the distance of 1015h", "CiA 301, 7.5.2.18", CONFORM_RESET,
      0x1015, check_inhibit },
    { "emcy-off", "1014h with bit 31: no emergencies", "CiA 301, 7.5.2.17", CONFORM_RESET, 0x1014,
      check_off },
};

const struct conform_family conform_emcy = { "emcy", "EMCY", checks,
                                             sizeof checks / sizeof checks[0] };

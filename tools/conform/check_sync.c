/*
 * Checks of SYNC: producer, counter, and the consumer's look at the length.
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"

#define PERIOD   20u /* ms */
#define PRODUCER 0x40000000u
#define OVERFLOW 5u
#define ANSWER   1000u

static bool check_cob_id(struct conform *self)
{
    uint64_t cob_id;

    if (!conform_must_read_number(self, 0x1005, 0, &cob_id))
        return false;
    if ((cob_id & 0x7FFFFFFFu) != 0x80)
        return conform_fail(self, "1005h: expected 00000080, received %08X", (unsigned)cob_id);
    return true;
}

static bool set_overflow(struct conform *self, uint8_t overflow)
{
    if (conform_number(self, 0x1019, 0, 0) == overflow)
        return true;
    return conform_need_object(self, 0x1019) && conform_set(self, 0x1006, 0, 4, 0) &&
           conform_set(self, 0x1019, 0, 1, overflow);
}

/* Some devices are consumers only. */
static bool produce(struct conform *self, uint8_t overflow)
{
    uint32_t result;

    if (!conform_need_object(self, 0x1006))
        return false;
    if (!set_overflow(self, overflow))
        return false;
    if (!conform_set(self, 0x1006, 0, 4, 1000 * PERIOD))
        return false;
    result = conform_write_number(self, 0x1005, 0, 4, PRODUCER | 0x80);
    if (result == SDO_INVALID_VALUE || result == SDO_READ_ONLY)
        return conform_skip(self, "the device produces no SYNC: 1005h refuses bit 30");
    return result == SDO_OK || conform_set(self, 0x1005, 0, 4, PRODUCER | 0x80);
}

static bool check_producer(struct conform *self)
{
    if (!produce(self, 0) || !conform_expect_period(self, 0x80, 20, PERIOD))
        return false;
    conform_nmt(self, CONFORM_START);
    return conform_expect_period(self, 0x80, 5, PERIOD);
}

static bool expect_sync(struct conform *self, size_t from, size_t *ret_at)
{
    *ret_at = conform_await(self, from, 0x80, ANSWER);
    return *ret_at != CONFORM_NOTHING ||
           conform_fail(self, "expected SYNC each %u ms, received none", PERIOD);
}

static bool check_off(struct conform *self)
{
    size_t at;

    if (!produce(self, 0) || !expect_sync(self, conform_mark(self), &at) ||
        !conform_set(self, 0x1006, 0, 4, 0) ||
        !conform_expect_none(self, conform_mark(self), 0x80, 5 * PERIOD))
        return false;
    if (!conform_set(self, 0x1006, 0, 4, 1000 * PERIOD) ||
        !expect_sync(self, conform_mark(self), &at))
        return false;
    return conform_set(self, 0x1005, 0, 4, 0x80) &&
           conform_expect_none(self, conform_mark(self), 0x80, 5 * PERIOD);
}

static bool check_plain(struct conform *self)
{
    size_t at;

    if (!produce(self, 0) || !expect_sync(self, conform_mark(self), &at))
        return false;
    if (conform_frame(self, at)->dlc != 0)
        return conform_fail(self, "1019h is 0: expected SYNC without data, received %u bytes",
                            conform_frame(self, at)->dlc);
    return true;
}

/* The next SYNCs have the counter's values from 1 on. */
static bool expect_counter(struct conform *self, size_t from, unsigned count)
{
    for (unsigned i = 0; i < count; i++) {
        const unsigned expected = i % OVERFLOW + 1;
        const struct co_frame *frame;
        size_t at;

        if (!expect_sync(self, from, &at))
            return false;
        frame = conform_frame(self, at);
        if (frame->dlc != 1 || frame->data[0] != expected)
            return conform_fail(self, "SYNC %u: expected the counter %u, received %u byte%s %02X",
                                i + 1, expected, frame->dlc, frame->dlc == 1 ? "" : "s",
                                frame->data[0]);
        from = at + 1;
    }
    return true;
}

static bool check_counter(struct conform *self)
{
    const size_t from = conform_mark(self);

    return produce(self, OVERFLOW) && expect_counter(self, from, OVERFLOW + 1);
}

static bool check_overflow_values(struct conform *self)
{
    static const uint8_t values[] = { 1, 241, 255 };

    for (size_t i = 0; i < sizeof values; i++)
        if (!conform_must_abort(
                self, "write a reserved value to 1019h",
                conform_write_number(self, 0x1019, 0, 1, values[i]),
                CODES(SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_VALUE_LOW, SDO_GENERAL)))
            return false;
    return true;
}

static bool check_overflow_locked(struct conform *self)
{
    return conform_need_object(self, 0x1006) && conform_set(self, 0x1006, 0, 4, 1000 * PERIOD) &&
           conform_must_abort(self, "write 1019h while 1006h is not 0",
                              conform_write_number(self, 0x1019, 0, 1, OVERFLOW),
                              CODES(SDO_DEVICE_STATE, SDO_GENERAL));
}

static bool check_stopped(struct conform *self)
{
    size_t from, at;

    if (!conform_watch_state(self) || !produce(self, 0) ||
        !expect_sync(self, conform_mark(self), &at))
        return false;
    conform_await_state(self, conform_nmt(self, CONFORM_STOP), STATE_STOPPED);
    from = conform_mark(self);
    if (!conform_expect_none(self, from, 0x80, 5 * PERIOD))
        return false;
    return expect_sync(self, conform_nmt(self, CONFORM_PREOP), &at);
}

static bool check_counter_restart(struct conform *self)
{
    size_t at;

    if (!conform_watch_state(self) || !produce(self, OVERFLOW) ||
        !expect_sync(self, conform_mark(self), &at) || !expect_sync(self, at + 1, &at))
        return false;
    conform_await_state(self, conform_nmt(self, CONFORM_STOP), STATE_STOPPED);
    return expect_counter(self, conform_nmt(self, CONFORM_PREOP), 2);
}

static bool check_length(struct conform *self)
{
    struct conform_pdo pdo;
    uint32_t id;
    size_t from, at;

    if (!conform_emcy_id(self, &id) || !conform_find_pdo(self, TPDO, &pdo))
        return false;
    if (!set_overflow(self, 0))
        return false;
    if (conform_write_number(self, pdo.index, 2, 1, 1) != SDO_OK)
        return conform_skip(self, "the device takes no synchronous TPDO: it needs no SYNC");
    conform_nmt(self, CONFORM_START);
    from = conform_send_data(self, 0x80, (uint8_t[]){ 1 }, 1);
    return conform_expect_emcy(self, from, 0x8240, &at);
}

static const struct conform_check checks[] = {
    { "sync-cob-id", "1005h is 80h, and the device no producer, after a reset", "CiA 301, 7.5.2.5",
      0, 0x1005, check_cob_id },
    { "sync-producer", "SYNC is sent in the period of 1006h", "CiA 301, 7.5.2.6", CONFORM_RESET,
      0x1005, check_producer },
    { "sync-off", "1006h 0 stops SYNC, and so does bit 30 of 1005h", "CiA 301, 7.5.2.6",
      CONFORM_RESET, 0x1005, check_off },
    { "sync-plain", "without 1019h SYNC has no data", "CiA 301, 7.2.5", CONFORM_RESET, 0x1005,
      check_plain },
    { "sync-counter", "the counter goes from 1 to 1019h and begins anew", "CiA 301, 7.2.5",
      CONFORM_RESET, 0x1019, check_counter },
    { "sync-counter-restart", "the counter begins with 1 when Stopped is left", "CiA 301, 7.2.5",
      CONFORM_RESET, 0x1019, check_counter_restart },
    { "sync-overflow-values", "1019h refuses 1 and what is more than 240", "CiA 301, 7.5.2.22",
      CONFORM_RESET, 0x1019, check_overflow_values },
    { "sync-overflow-locked", "1019h cannot be changed while 1006h is not 0", "CiA 301, 7.5.2.22",
      CONFORM_RESET, 0x1019, check_overflow_locked },
    { "sync-stopped", "no SYNC in Stopped; it goes on after it", "CiA 301, 7.3.2.2", CONFORM_RESET,
      0x1005, check_stopped },
    { "sync-length", "SYNC with data where none is expected: EMCY 8240h", "CiA 301, 7.2.5",
      CONFORM_RESET, 0x1019, check_length },
};

const struct conform_family conform_sync = { "sync", "SYNC", checks,
                                             sizeof checks / sizeof checks[0] };

#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"

#define STATE_WAIT 1000u /* ms; a heartbeat that cannot be set may be slow */
#define ANSWER     500u  /* ms, for a remote frame */

#define PERIOD_ATTEMPTS 3u

bool conform_set(struct conform *self, uint16_t index, uint8_t sub, uint32_t size, uint64_t number)
{
    static const uint32_t limits[] = { SDO_READ_ONLY, SDO_VALUE_HIGH, SDO_VALUE_LOW };
    const uint32_t result = conform_write_number(self, index, sub, size, number);

    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
        if (result == limits[i])
            return conform_skip(self, "%04Xh:%02X does not take %u: %s", index, sub,
                                (unsigned)number, sdo_abort_text(result));
    return result == SDO_OK || conform_must_write(self, index, sub, size, number);
}

/* --- states --- */

uint32_t conform_control_id(const struct conform *self)
{
    return 0x700u + self->options.node;
}

const char *conform_state_text(uint8_t state)
{
    switch (state) {
    case STATE_STOPPED: return "Stopped";
    case STATE_OPERATIONAL: return "Operational";
    case STATE_PREOP: return "Pre-operational";
    case 0x00: return "boot-up";
    default: return "an unknown state";
    }
}

bool conform_watch_state(struct conform *self)
{
    return !conform_has(self, 0x1017) || conform_set(self, 0x1017, 0, 2, HEARTBEAT_FAST);
}

static bool fail_state(struct conform *self, size_t at, uint8_t state, const char *when)
{
    if (at == CONFORM_NOTHING)
        return conform_fail(self, "%s: expected %s, received neither heartbeat nor answer", when,
                            conform_state_text(state));
    return conform_fail(self, "%s: expected %s, received %03X with %02X (%s)", when,
                        conform_state_text(state), (unsigned)conform_control_id(self),
                        conform_frame(self, at)->data[0],
                        conform_state_text(conform_frame(self, at)->data[0] & 0x7F));
}

static bool ask_state(struct conform *self, uint8_t state, const char *when)
{
    const uint32_t id = conform_control_id(self);
    const size_t at = conform_await(self, conform_send_rtr(self, id, 1), id, ANSWER);

    if (at != CONFORM_NOTHING && (conform_frame(self, at)->data[0] & 0x7F) == state)
        return true;
    return fail_state(self, at, state, when);
}

bool conform_expect_state(struct conform *self, size_t from, uint8_t state, const char *when)
{
    const uint32_t id = conform_control_id(self);
    size_t at;

    if (!conform_has(self, 0x1017))
        return ask_state(self, state, when);
    if (conform_await_byte(self, from, id, state, STATE_WAIT) != CONFORM_NOTHING)
        return true;
    at = conform_await(self, from, id, 0);
    return at == CONFORM_NOTHING ? ask_state(self, state, when) : fail_state(self, at, state, when);
}

bool conform_expect_still(struct conform *self, size_t from, uint8_t state, const char *when)
{
    const uint32_t id = conform_control_id(self);

    if (!conform_has(self, 0x1017)) {
        conform_listen(self, HEARTBEAT_FAST);
        return ask_state(self, state, when);
    }
    for (unsigned i = 0; i < 2; i++) {
        const size_t at = conform_await(self, from, id, STATE_WAIT);

        if (at == CONFORM_NOTHING)
            return ask_state(self, state, when);
        if (conform_frame(self, at)->data[0] != state)
            return fail_state(self, at, state, when);
        from = at + 1;
    }
    return true;
}

void conform_await_state(struct conform *self, size_t from, uint8_t state)
{
    const uint32_t id = conform_control_id(self);

    if (!conform_has(self, 0x1017) ||
        conform_await_byte(self, from, id, state, ANSWER) == CONFORM_NOTHING)
        conform_await(self, conform_send_rtr(self, id, 1), id, ANSWER);
}

bool conform_go(struct conform *self, uint8_t command, uint8_t state)
{
    const char *when = command == CONFORM_START  ? "after NMT start"
                       : command == CONFORM_STOP ? "after NMT stop"
                                                 : "after NMT enter pre-operational";

    return conform_expect_state(self, conform_nmt(self, command), state, when);
}

/* --- emergencies --- */

bool conform_emcy_id(struct conform *self, uint32_t *ret_id)
{
    uint64_t cob_id;

    if (!conform_need_object(self, 0x1014) || !conform_must_read_number(self, 0x1014, 0, &cob_id))
        return false;
    if (cob_id & 0x80000000u)
        return conform_skip(self, "1014h is %08X: the device sends no emergencies",
                            (unsigned)cob_id);
    *ret_id = (uint32_t)cob_id & 0x7FFu;
    return true;
}

static bool is_emcy(const struct co_frame *frame, uint16_t code)
{
    return frame->dlc >= 2 && get_le16(frame->data) == code;
}

/* The number of one with this code; the last other one is in ret_other. */
static size_t await_emcy(struct conform *self, size_t from, uint16_t code, unsigned ms,
                         size_t *ret_other)
{
    const uint32_t id = (uint32_t)conform_number(self, 0x1014, 0, 0x80u + self->options.node) &
                        0x7FFu;
    size_t at = conform_await(self, from, id, ms);

    *ret_other = CONFORM_NOTHING;
    while (at != CONFORM_NOTHING && !is_emcy(conform_frame(self, at), code)) {
        *ret_other = at;
        at = conform_await(self, at + 1, id, ms);
    }
    return at;
}

bool conform_expect_emcy(struct conform *self, size_t from, uint16_t code, size_t *ret_at)
{
    char text[CO_FRAME_TEXT_SIZE] = "none";
    size_t other;

    *ret_at = await_emcy(self, from, code, EMCY_WAIT, &other);
    if (*ret_at != CONFORM_NOTHING)
        return true;
    if (other != CONFORM_NOTHING)
        co_frame_format(conform_frame(self, other), text, sizeof text);
    return conform_fail(self, "expected an emergency with the code %04X, received %s", code, text);
}

size_t conform_find_emcy(struct conform *self, size_t from, uint16_t code)
{
    size_t other;

    return await_emcy(self, from, code, EMCY_WAIT, &other);
}

bool conform_expect_no_emcy(struct conform *self, size_t from, uint16_t code, unsigned ms)
{
    char text[CO_FRAME_TEXT_SIZE];
    size_t other;
    const size_t at = await_emcy(self, from, code, ms, &other);

    if (at == CONFORM_NOTHING)
        return true;
    return conform_fail(self, "expected no emergency with the code %04X, received %s", code,
                        co_frame_format(conform_frame(self, at), text, sizeof text));
}

/* --- SYNC --- */

size_t conform_send_sync(struct conform *self)
{
    return conform_send_data(self, 0x080, NULL, 0);
}

/* --- periods --- */

/* In us; 0: they do not come. */
static co_us_t average_period(struct conform *self, uint32_t id, unsigned count, unsigned patience)
{
    const size_t first = conform_await(self, conform_mark(self), id, patience);
    size_t last = first;

    for (unsigned i = 1; i < count && last != CONFORM_NOTHING; i++)
        last = conform_await(self, last + 1, id, patience);
    if (last == CONFORM_NOTHING)
        return 0;
    return (conform_time(self, last) - conform_time(self, first)) / (count - 1);
}

bool conform_expect_period(struct conform *self, uint32_t id, unsigned count, unsigned ms)
{
    const co_us_t expected = CO_MS(ms), tolerance = expected / 5 + CO_MS(5);
    const unsigned patience = 10 * ms + 500;
    co_us_t average = 1;

    for (unsigned i = 0; i < PERIOD_ATTEMPTS && average != 0; i++) {
        average = average_period(self, id, count, patience);
        if (average + tolerance >= expected && average <= expected + tolerance)
            return true;
    }
    if (average == 0)
        return conform_fail(self, "expected frames %03X each %u ms, received none within %u ms",
                            (unsigned)id, ms, patience);
    return conform_fail(self, "expected frames %03X each %u ms, received them each %u.%03u ms",
                        (unsigned)id, ms, (unsigned)(average / 1000), (unsigned)(average % 1000));
}

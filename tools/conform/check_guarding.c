/*
 * Checks of error control by node guarding and life guarding. The family is "control", as that of
 * the heartbeat: a device has the one, the other, or both, one at a time.
 */
#include "conform_families.h"
#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"

#define ANSWER     500u /* ms */
#define GUARD_TIME 50u  /* ms; the life time is twice as long */
#define EMCY_LIFE  0x8130u

/* A device without node guarding does not know its parameters; what it does then is its own. */
static bool need_guarding(struct conform *self)
{
    return conform_need_object(self, 0x100C) && conform_need_object(self, 0x100D);
}

static size_t ask(struct conform *self)
{
    const uint32_t id = conform_control_id(self);

    return conform_await(self, conform_send_rtr(self, id, 1), id, ANSWER);
}

/* An answer with this toggle bit and state. */
static bool expect_answer(struct conform *self, uint8_t toggle, uint8_t state)
{
    const size_t at = ask(self);
    char text[CO_FRAME_TEXT_SIZE] = "no answer";

    if (at != CONFORM_NOTHING) {
        const struct co_frame *frame = conform_frame(self, at);

        if (frame->dlc == 1 && frame->data[0] == (toggle | state))
            return true;
        co_frame_format(frame, text, sizeof text);
    }
    return conform_fail(self, "node guarding: expected %03X#%02X, received %s",
                        (unsigned)conform_control_id(self), toggle | state, text);
}

static bool check_default(struct conform *self)
{
    uint64_t guard_time, factor;

    if (!need_guarding(self) || !conform_must_read_number(self, 0x100C, 0, &guard_time) ||
        !conform_must_read_number(self, 0x100D, 0, &factor))
        return false;
    if (guard_time != 0 || factor != 0)
        return conform_fail(self, "100Ch is %u, 100Dh is %u: expected 0", (unsigned)guard_time,
                            (unsigned)factor);
    return true;
}

static bool no_heartbeat(struct conform *self)
{
    return !conform_has(self, 0x1017) || conform_number(self, 0x1017, 0, 0) == 0 ||
           conform_set(self, 0x1017, 0, 2, 0);
}

/* The toggle bit is as after a reset, and the state known where a device starts by itself. */
static bool begin(struct conform *self)
{
    if (!conform_reset(self, CONFORM_RESET_COMM))
        return false;
    conform_nmt(self, CONFORM_PREOP);
    return no_heartbeat(self);
}

static bool check_first(struct conform *self)
{
    return begin(self) && expect_answer(self, 0x00, STATE_PREOP);
}

static bool check_toggle(struct conform *self)
{
    if (!begin(self))
        return false;
    for (unsigned i = 0; i < 10; i++)
        if (!expect_answer(self, (uint8_t)(i % 2 << 7), STATE_PREOP))
            return false;
    return true;
}

static bool check_states(struct conform *self)
{
    if (!begin(self))
        return false;
    conform_nmt(self, CONFORM_START);
    if (!expect_answer(self, 0x00, STATE_OPERATIONAL))
        return false;
    conform_nmt(self, CONFORM_STOP);
    return expect_answer(self, 0x80, STATE_STOPPED);
}

static bool check_others(struct conform *self)
{
    const uint8_t node = self->options.node;
    const uint8_t others[] = { node > 1 ? (uint8_t)(node - 1) : 2,
                               node < 127 ? (uint8_t)(node + 1) : 126 };
    const size_t from = conform_mark(self);

    if (!no_heartbeat(self))
        return false;
    for (size_t i = 0; i < sizeof others; i++)
        conform_send_rtr(self, 0x700u + others[i], 1);
    return conform_expect_none(self, from, conform_control_id(self), CONFORM_QUIET);
}

static bool set_guarding(struct conform *self)
{
    return no_heartbeat(self) && conform_set(self, 0x100C, 0, 2, GUARD_TIME) &&
           conform_set(self, 0x100D, 0, 1, 2);
}

static bool check_restored(struct conform *self)
{
    uint64_t guard_time, factor;

    if (!need_guarding(self) || !set_guarding(self) ||
        !conform_must_read_number(self, 0x100C, 0, &guard_time) ||
        !conform_must_read_number(self, 0x100D, 0, &factor))
        return false;
    if (guard_time != GUARD_TIME || factor != 2)
        return conform_fail(self, "100Ch and 100Dh: wrote %u and 2, read %u and %u", GUARD_TIME,
                            (unsigned)guard_time, (unsigned)factor);
    return conform_reset(self, CONFORM_RESET_COMM) && check_default(self);
}

/* --- life guarding --- */

static bool check_life_first(struct conform *self)
{
    uint32_t id;

    return need_guarding(self) && conform_emcy_id(self, &id) && set_guarding(self) &&
           conform_expect_no_emcy(self, conform_mark(self), EMCY_LIFE, 4 * GUARD_TIME);
}

/* Operational, guarded once, and then no more. */
static bool lose_guard(struct conform *self, size_t *ret_from)
{
    size_t at;
    uint32_t id;

    if (!need_guarding(self) || !conform_emcy_id(self, &id) || !set_guarding(self))
        return false;
    conform_nmt(self, CONFORM_START);
    *ret_from = conform_mark(self);
    if (ask(self) == CONFORM_NOTHING)
        return conform_fail(self, "node guarding: no answer");
    return conform_expect_emcy(self, *ret_from, EMCY_LIFE, &at);
}

static bool check_life(struct conform *self)
{
    size_t from, at;

    if (!lose_guard(self, &from))
        return false;
    from = conform_mark(self);
    at = ask(self);
    if (at == CONFORM_NOTHING || (conform_frame(self, at)->data[0] & 0x7F) != STATE_PREOP)
        return conform_fail(self, "after the life guarding error: expected Pre-operational");
    return conform_expect_emcy(self, from, 0x0000, &at);
}

static bool check_behaviour(struct conform *self)
{
    static const uint8_t states[] = { STATE_PREOP, STATE_OPERATIONAL, STATE_STOPPED };

    if (!conform_need_object(self, 0x1029))
        return false;
    for (uint8_t behaviour = 0; behaviour < sizeof states; behaviour++) {
        size_t from, at;

        if (!conform_set(self, 0x1029, 1, 1, behaviour) || !lose_guard(self, &from))
            return false;
        at = ask(self);
        if (at == CONFORM_NOTHING || (conform_frame(self, at)->data[0] & 0x7F) != states[behaviour])
            return conform_fail(self, "life guarding error, 1029h:01 is %u: expected %s", behaviour,
                                conform_state_text(states[behaviour]));
        if (!conform_reset(self, CONFORM_RESET_NODE))
            return false;
    }
    return true;
}

/* --- guarding and heartbeat --- */

static bool check_one(struct conform *self)
{
    const uint32_t id = conform_control_id(self);
    size_t from;
    unsigned count;

    if (!conform_need_object(self, 0x1017) || !conform_set(self, 0x1017, 0, 2, 1000))
        return false;
    from = conform_mark(self);
    for (unsigned i = 0; i < 3; i++)
        conform_send_rtr(self, id, 1);
    count = conform_count(self, from, id, CONFORM_QUIET);
    if (count > 1)
        return conform_fail(self, "1017h is 1000: received %u answers to node guarding", count);
    return conform_set(self, 0x1017, 0, 2, 0) &&
           (ask(self) != CONFORM_NOTHING ||
            conform_fail(self, "1017h is 0 again: no answer to node guarding"));
}

static const struct conform_check checks[] = {
    { "guard-default", "100Ch and 100Dh are 0 after a reset", "CiA 301, 7.5.2.11", 0, 0x100C,
      check_default },
    { "guard-first", "the first answer after a reset has the toggle bit 0", "CiA 301, 7.2.8.3.1",
      CONFORM_RESET, 0x100C, check_first },
    { "guard-toggle", "the toggle bit alternates", "CiA 301, 7.2.8.3.1", CONFORM_RESET, 0x100C,
      check_toggle },
    { "guard-states", "the answers tell the state, in Stopped too", "CiA 301, 7.2.8.3.1",
      CONFORM_RESET, 0x100C, check_states },
    { "guard-others", "requests to other nodes are not answered", "CiA 301, 7.2.8.3.1", 0, 0,
      check_others },
    { "guard-restored", "100Ch and 100Dh can be written; a reset restores them",
      "CiA 301, 7.5.2.11", CONFORM_RESET, 0x100C, check_restored },
    { "guard-life-first", "life guarding begins with the first request", "CiA 301, 7.2.8.2.2.1",
      CONFORM_RESET, 0x100C, check_life_first },
    { "guard-life", "no request for the life time: EMCY 8130h; the next one: EMCY 0000h",
      "CiA 301, 7.2.8.2.2.1", CONFORM_RESET, 0x100C, check_life },
    { "guard-behaviour", "1029h:01 decides on the state after a life guarding error",
      "CiA 301, 7.5.2.29", CONFORM_RESET, 0x100C, check_behaviour },
    { "guard-heartbeat", "guarding is not answered while heartbeats are sent", "CiA 301, 7.2.8.2",
      CONFORM_RESET, 0x100C, check_one },
};

const struct conform_family conform_guarding = { "control", "Error control", checks,
                                                 sizeof checks / sizeof checks[0] };

/*
 * Checks of error control by heartbeat: producer and consumer.
 */
#include "conform_families.h"
#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"

#define PERIOD        50u  /* ms, of the device's heartbeat */
#define WATCHED       200u /* ms, in which the device misses a heartbeat of ours */
#define EMCY_LOST     0x8130u
#define ATTEMPTS      3u
#define IN_TIME_COUNT 8u

static bool check_default(struct conform *self)
{
    const uint64_t guard_time = conform_number(self, 0x100C, 0, 0);
    const uint64_t factor = conform_number(self, 0x100D, 0, 0);
    uint64_t period;

    if (!conform_must_read_number(self, 0x1017, 0, &period))
        return false;
    if (period != 0 && guard_time * factor != 0)
        return conform_fail(self, "1017h is %u, 100Ch is %u, 100Dh is %u: expected one to be 0",
                            (unsigned)period, (unsigned)guard_time, (unsigned)factor);
    return true;
}

static bool check_period(struct conform *self)
{
    return conform_set(self, 0x1017, 0, 2, PERIOD) &&
           conform_expect_period(self, conform_control_id(self), 12, PERIOD);
}

static bool check_off(struct conform *self)
{
    const uint32_t id = conform_control_id(self);

    if (!conform_set(self, 0x1017, 0, 2, PERIOD))
        return false;
    if (conform_await(self, conform_mark(self), id, 1000) == CONFORM_NOTHING)
        return conform_fail(self, "1017h is %u: expected heartbeats, received none", PERIOD);
    return conform_set(self, 0x1017, 0, 2, 0) &&
           conform_expect_none(self, conform_mark(self), id, 4 * PERIOD);
}

static bool check_states(struct conform *self)
{
    const size_t from = conform_mark(self);

    return conform_watch_state(self) &&
           conform_expect_state(self, from, STATE_PREOP, "in pre-operational") &&
           conform_go(self, CONFORM_START, STATE_OPERATIONAL) &&
           conform_go(self, CONFORM_STOP, STATE_STOPPED);
}

/* --- consumer --- */

/* A node that is not the device's. */
static uint8_t producer(const struct conform *self)
{
    return self->options.node == 0x47 ? 0x48 : 0x47;
}

static uint32_t watch(const struct conform *self, unsigned ms)
{
    return (uint32_t)producer(self) << 16 | ms;
}

static size_t send_heartbeat(struct conform *self)
{
    return conform_send_data(self, 0x700u + producer(self), (uint8_t[]){ STATE_OPERATIONAL }, 1);
}

static bool check_duplicate(struct conform *self)
{
    if (!conform_find(self, 0x1016, 2))
        return conform_skip(self, "1016h has one entry");
    return conform_set(self, 0x1016, 1, 4, watch(self, 1000)) &&
           conform_must_abort(self, "write 1016h:02: the node of 1016h:01",
                              conform_write_number(self, 0x1016, 2, 4, watch(self, 1000)),
                              CODES(SDO_PARAMETER, SDO_GENERAL));
}

static bool check_not_before(struct conform *self)
{
    uint32_t id;

    return conform_emcy_id(self, &id) && conform_set(self, 0x1016, 1, 4, watch(self, 50)) &&
           conform_expect_no_emcy(self, conform_mark(self), EMCY_LOST, CONFORM_QUIET);
}

/* The longest time between our heartbeats, as the bus saw them, in us. */
static co_us_t send_heartbeats(struct conform *self, unsigned pause)
{
    co_us_t longest = 0, last = 0;

    for (unsigned i = 0; i < IN_TIME_COUNT; i++) {
        const size_t at = send_heartbeat(self) - 1;

        if (i > 0 && conform_time(self, at) - last > longest)
            longest = conform_time(self, at) - last;
        last = conform_time(self, at);
        conform_listen(self, pause);
    }
    return longest;
}

static bool check_in_time(struct conform *self)
{
    uint32_t id;

    if (!conform_emcy_id(self, &id))
        return false;
    for (unsigned i = 0; i < ATTEMPTS && self->end == CONFORM_RUNS; i++) {
        size_t from;

        if (!conform_set(self, 0x1016, 1, 4, watch(self, WATCHED)))
            return false;
        from = conform_mark(self);
        if (send_heartbeats(self, WATCHED / 5) < CO_MS(WATCHED * 4 / 5))
            return conform_set(self, 0x1016, 1, 4, 0) &&
                   conform_expect_no_emcy(self, from, EMCY_LOST, 0);
        conform_set(self, 0x1016, 1, 4, 0);
    }
    return conform_skip(self, "this machine is too slow to send heartbeats each %u ms",
                        WATCHED / 5);
}

/* Operational, with a heartbeat that has just been lost; the number behind the last one. */
static bool lose_heartbeat(struct conform *self, size_t *ret_from)
{
    size_t at;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_watch_state(self) ||
        !conform_set(self, 0x1016, 1, 4, watch(self, WATCHED / 2)) ||
        !conform_go(self, CONFORM_START, STATE_OPERATIONAL))
        return false;
    *ret_from = send_heartbeat(self);
    return conform_expect_emcy(self, *ret_from, EMCY_LOST, &at);
}

/* By 1029h: 0, or without it: pre-operational, 1: as it is, 2: stopped. */
static const uint8_t states[] = { STATE_PREOP, STATE_OPERATIONAL, STATE_STOPPED };

static bool check_lost(struct conform *self)
{
    const uint64_t behaviour = conform_number(self, 0x1029, 1, 0);
    size_t from;

    return lose_heartbeat(self, &from) &&
           conform_expect_state(self, from, states[behaviour < sizeof states ? behaviour : 0],
                                "after a heartbeat was lost");
}

static bool check_back(struct conform *self)
{
    size_t from, at;

    if (!lose_heartbeat(self, &from))
        return false;
    from = send_heartbeat(self);
    return conform_expect_emcy(self, from, 0x0000, &at);
}

static bool check_behaviour(struct conform *self)
{
    if (!conform_need_object(self, 0x1029))
        return false;
    for (uint8_t behaviour = 0; behaviour < sizeof states; behaviour++) {
        size_t from;

        if (!conform_set(self, 0x1029, 1, 1, behaviour) || !lose_heartbeat(self, &from) ||
            !conform_expect_state(self, from, states[behaviour],
                                  behaviour == 0   ? "heartbeat lost, 1029h:01 is 0"
                                  : behaviour == 1 ? "heartbeat lost, 1029h:01 is 1"
                                                   : "heartbeat lost, 1029h:01 is 2"))
            return false;
        if (!conform_reset(self, CONFORM_RESET_NODE))
            return false;
    }
    return true;
}

/* The error is told by the next emergency at the earliest when Stopped has been left. */
static bool check_stopped(struct conform *self)
{
    size_t from;
    uint32_t id;

    if (!conform_emcy_id(self, &id) || !conform_set(self, 0x1016, 1, 4, watch(self, WATCHED / 2)))
        return false;
    from = conform_nmt(self, CONFORM_STOP);
    send_heartbeat(self);
    return conform_expect_none(self, from, id, WATCHED);
}

static const struct conform_check checks[] = {
    { "heartbeat-default", "heartbeat and life guarding are not both on after a reset",
      "CiA 301, 7.2.8.2", 0, 0x1017, check_default },
    { "heartbeat-period", "heartbeats come in the period of 1017h", "CiA 301, 7.2.8.3.2",
      CONFORM_RESET, 0x1017, check_period },
    { "heartbeat-off", "1017h 0 stops them", "CiA 301, 7.5.2.19", CONFORM_RESET, 0x1017,
      check_off },
    { "heartbeat-states", "heartbeats tell the state, in Stopped too", "CiA 301, 7.2.8.3.2",
      CONFORM_RESET, 0x1017, check_states },
    { "heartbeat-watched-twice", "1016h refuses a node that it has already", "CiA 301, 7.5.2.18",
      CONFORM_RESET, 0x1016, check_duplicate },
    { "heartbeat-watched-first", "no error before the first heartbeat of the node watched",
      "CiA 301, 7.5.2.18", CONFORM_RESET, 0x1016, check_not_before },
    { "heartbeat-watched-in-time", "no error while the heartbeats come in time",
      "CiA 301, 7.5.2.18", CONFORM_RESET, 0x1016, check_in_time },
    { "heartbeat-watched-lost", "a lost heartbeat: EMCY 8130h, and the state that 1029h says",
      "CiA 301, 7.2.8.2.2.2", CONFORM_RESET, 0x1016, check_lost },
    { "heartbeat-watched-back", "the heartbeat is back: EMCY 0000h", "CiA 301, 7.2.7",
      CONFORM_RESET, 0x1016, check_back },
    { "heartbeat-watched-stopped", "a heartbeat that is lost in Stopped: no emergency there",
      "CiA 301, 7.3.2.2", CONFORM_RESET, 0x1016, check_stopped },
    { "heartbeat-behaviour", "1029h:01 decides on the state after an error", "CiA 301, 7.5.2.29",
      CONFORM_RESET, 0x1016, check_behaviour },
};

const struct conform_family conform_heartbeat = { "control", "Error control", checks,
                                                  sizeof checks / sizeof checks[0] };

/*
 * Checks of TPDOs as they are sent: on events, timers, SYNC and remote frames.
 */
#include "conform_families.h"
#include "conform_pdo.h"
#include "conform_services.h"

#include "base/bytes.h"
#include "od/abort.h"
#include "od/od.h"

#include <string.h>

#define ANSWER      500u /* ms, to a SYNC or a remote frame */
#define EVENT_TIMER 20u  /* ms */
#define INHIBIT     100u /* ms */
#define EVENT_TYPE  255u

/* --- an event-driven TPDO --- */

static bool has_event_timer(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_find(self, pdo->index, 5) != NULL;
}

static bool clear(struct conform *self, const struct conform_pdo *pdo, uint8_t sub)
{
    return conform_number(self, pdo->index, sub, 0) == 0 ||
           (conform_switch_pdo(self, pdo, false) && conform_set(self, pdo->index, sub, 2, 0));
}

/* A TPDO that its timer sends, and no inhibit time holds back; the device is pre-operational. */
static bool set_event_timer(struct conform *self, struct conform_pdo *ret_pdo)
{
    return conform_find_fitting_pdo(self, TPDO, has_event_timer, ret_pdo) &&
           clear(self, ret_pdo, 3) && conform_set_pdo_type(self, ret_pdo, EVENT_TYPE) &&
           conform_set(self, ret_pdo->index, 5, 2, EVENT_TIMER);
}

/* All that is to be sent for the start itself has been. */
static void start(struct conform *self)
{
    conform_nmt(self, CONFORM_START);
    conform_barrier(self);
}

static bool check_event_timer(struct conform *self)
{
    struct conform_pdo pdo;

    if (!set_event_timer(self, &pdo))
        return false;
    start(self);
    return conform_expect_period(self, pdo_id(&pdo), 15, EVENT_TIMER);
}

/* What was set before Operational holds in it after a stop, too. */
static bool check_kept(struct conform *self)
{
    struct conform_pdo pdo;

    if (!set_event_timer(self, &pdo))
        return false;
    conform_nmt(self, CONFORM_START);
    conform_nmt(self, CONFORM_STOP);
    start(self);
    return conform_expect_period(self, pdo_id(&pdo), 5, EVENT_TIMER);
}

/* The timer, a SYNC and a remote frame: no reason for a TPDO in this state. */
static bool check_silent(struct conform *self, const struct conform_pdo *pdo)
{
    const size_t from = conform_mark(self);

    conform_send_rtr(self, pdo_id(pdo), pdo->bytes);
    conform_send_sync(self);
    return conform_expect_none(self, from, pdo_id(pdo), CONFORM_QUIET);
}

static bool check_silent_after(struct conform *self, uint8_t command, uint8_t state)
{
    struct conform_pdo pdo;

    if (!conform_watch_state(self) || !set_event_timer(self, &pdo))
        return false;
    start(self);
    if (conform_await(self, conform_mark(self), pdo_id(&pdo), ANSWER) == CONFORM_NOTHING)
        return conform_skip(self, "the TPDO is not sent in Operational: see pdo-event-timer");
    conform_await_state(self, conform_nmt(self, command), state);
    return check_silent(self, &pdo);
}

static bool check_preoperational(struct conform *self)
{
    struct conform_pdo pdo;

    return set_event_timer(self, &pdo) && check_silent(self, &pdo) &&
           check_silent_after(self, CONFORM_PREOP, STATE_PREOP);
}

static bool check_stopped(struct conform *self)
{
    return check_silent_after(self, CONFORM_STOP, STATE_STOPPED);
}

/* --- remote frames --- */

static bool answers_remote(struct conform *self, const struct conform_pdo *pdo)
{
    (void)self;
    return (pdo->cob_id & PDO_NO_RTR) == 0;
}

static bool check_remote(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    if (!conform_find_fitting_pdo(self, TPDO, answers_remote, &pdo))
        return false;
    start(self);
    at = conform_await(self, conform_send_rtr(self, pdo_id(&pdo), pdo.bytes), pdo_id(&pdo), ANSWER);
    if (at == CONFORM_NOTHING)
        return conform_fail(self, "%04Xh:01 bit 30 is 0: no answer to a remote frame", pdo.index);
    return true;
}

static bool check_no_remote(struct conform *self)
{
    struct conform_pdo pdo;

    if (!conform_find_pdo(self, TPDO, &pdo) || !clear(self, &pdo, 5) ||
        !conform_set(self, pdo.index, 1, 4, pdo.cob_id | PDO_INVALID | PDO_NO_RTR) ||
        !conform_set(self, pdo.index, 1, 4, pdo.cob_id | PDO_NO_RTR))
        return false;
    start(self);
    return conform_expect_none(self, conform_send_rtr(self, pdo_id(&pdo), pdo.bytes), pdo_id(&pdo),
                               CONFORM_QUIET);
}

/* --- SYNC --- */

static bool set_synchronous(struct conform *self, uint8_t type, struct conform_pdo *ret_pdo)
{
    if (!conform_find_pdo(self, TPDO, ret_pdo) || !conform_set_pdo_type(self, ret_pdo, type))
        return false;
    start(self);
    return true;
}

static unsigned count_from(struct conform *self, size_t from, uint32_t id)
{
    return conform_count(self, from, id, 0);
}

/* So many SYNCs, and how many TPDOs they bring in the end. */
static bool expect_ratio(struct conform *self, const struct conform_pdo *pdo, unsigned syncs,
                         unsigned expected)
{
    const size_t from = conform_mark(self);
    unsigned count, waits = 0;

    for (unsigned i = 0; i < syncs; i++) {
        conform_send_sync(self);
        conform_listen(self, 2);
    }
    while (count_from(self, from, pdo_id(pdo)) < expected && waits++ < 25)
        conform_listen(self, ANSWER / 25);
    count = conform_count(self, from, pdo_id(pdo), 2 * EVENT_TIMER);
    return count == expected ||
           conform_fail(self, "transmission type %u, %u SYNCs: expected %u TPDOs, received %u",
                        pdo->type, syncs, expected, count);
}

static bool check_each_sync(struct conform *self)
{
    struct conform_pdo pdo;

    return set_synchronous(self, 1, &pdo) &&
           conform_expect_none(self, conform_mark(self), pdo_id(&pdo), CONFORM_QUIET) &&
           expect_ratio(self, &pdo, 5, 5);
}

static bool check_fifth_sync(struct conform *self)
{
    struct conform_pdo pdo;

    return set_synchronous(self, 5, &pdo) && expect_ratio(self, &pdo, 50, 10);
}

static size_t send_counter(struct conform *self, uint8_t counter)
{
    return conform_send_data(self, 0x080, &counter, 1);
}

static bool has_start_value(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_find(self, pdo->index, 6) != NULL;
}

static bool check_start_value(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from;

    if (!conform_find_fitting_pdo(self, TPDO, has_start_value, &pdo) ||
        !conform_set(self, 0x1019, 0, 1, 5) || !conform_switch_pdo(self, &pdo, false) ||
        !conform_set(self, pdo.index, 6, 1, 3) || !conform_set_pdo_type(self, &pdo, 1))
        return false;
    start(self);
    from = conform_mark(self);
    for (uint8_t counter = 1; counter < 3; counter++)
        send_counter(self, counter);
    if (!conform_expect_none(self, from, pdo_id(&pdo), CONFORM_QUIET))
        return false;
    from = send_counter(self, 3);
    return conform_await(self, from, pdo_id(&pdo), ANSWER) != CONFORM_NOTHING ||
           conform_fail(self, "%04Xh:06 is 3, SYNC with the counter 3: no TPDO", pdo.index);
}

/* --- data, and events that an SDO write makes --- */

static bool has_room(struct conform *self, const struct conform_pdo *pdo)
{
    return pdo->count < 4 && conform_find(self, pdo_map(pdo), (uint8_t)(pdo->count + 1));
}

/* A TPDO of objects that can be written, so that a write changes its data. */
static bool map_writable(struct conform *self, struct conform_pdo *ret_pdo)
{
    unsigned bits = 0;

    if (!conform_find_pdo(self, TPDO, ret_pdo))
        return false;
    ret_pdo->count = 0;
    for (size_t i = 0; i < self->object_count && has_room(self, ret_pdo); i++) {
        const struct conform_object *object = &self->objects[i];
        const uint32_t entry = conform_entry(object);

        if (!conform_is_mappable(object, TPDO) || object->access == OD_RO ||
            bits + (entry & 0xFF) > 64)
            continue;
        ret_pdo->entries[ret_pdo->count++] = entry;
        bits += entry & 0xFF;
    }
    if (ret_pdo->count == 0)
        return conform_skip(self, "the EDS has no object for TPDOs that SDO can write");
    return conform_unmap_pdo(self, ret_pdo) && conform_map_pdo(self, ret_pdo);
}

static bool write_entry(struct conform *self, uint32_t entry, uint64_t number)
{
    return conform_set(self, pdo_entry_index(entry), pdo_entry_sub(entry), (entry & 0xFF) / 8,
                       number);
}

/* What the mapping makes of the values that SDO reads. */
static bool expect_data(struct conform *self, const struct conform_pdo *pdo,
                        const struct co_frame *frame)
{
    char text[CO_FRAME_TEXT_SIZE], wanted[CO_FRAME_TEXT_SIZE];
    struct co_frame expected = co_frame_make(pdo_id(pdo), pdo->bytes);
    unsigned bits = 0;

    for (unsigned i = 0; i < pdo->count; i++) {
        const uint32_t entry = pdo->entries[i];
        uint64_t number;

        if (!conform_must_read_number(self, pdo_entry_index(entry), pdo_entry_sub(entry), &number))
            return false;
        for (unsigned bit = 0; bit < (entry & 0xFF) && bits < 64; bit++, bits++)
            expected.data[bits / 8] |= (uint8_t)((number >> bit & 1) << bits % 8);
    }
    if (co_frame_equal(frame, &expected))
        return true;
    return conform_fail(self, "expected the TPDO %s, received %s",
                        co_frame_format(&expected, wanted, sizeof wanted),
                        co_frame_format(frame, text, sizeof text));
}

static bool check_data(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    if (!map_writable(self, &pdo) || !conform_set_pdo_type(self, &pdo, 1))
        return false;
    for (unsigned i = 0; i < pdo.count; i++)
        if (!write_entry(self, pdo.entries[i], 0x31 + 0x11 * i))
            return false;
    start(self);
    at = conform_await(self, conform_send_sync(self), pdo_id(&pdo), ANSWER);
    if (at == CONFORM_NOTHING)
        return conform_skip(self, "no TPDO after a SYNC: see pdo-each-sync");
    return expect_data(self, &pdo, conform_frame(self, at));
}

/* Where the mapping is as it is: nothing but the length can be judged. */
static bool check_length(struct conform *self)
{
    struct conform_pdo pdo;
    size_t at;

    if (!set_synchronous(self, 1, &pdo))
        return false;
    at = conform_await(self, conform_send_sync(self), pdo_id(&pdo), ANSWER);
    if (at == CONFORM_NOTHING)
        return conform_skip(self, "no TPDO after a SYNC: see pdo-each-sync");
    if (conform_frame(self, at)->dlc != pdo.bytes)
        return conform_fail(self, "%u bytes are mapped, received %u", pdo.bytes,
                            conform_frame(self, at)->dlc);
    return true;
}

static bool check_acyclic(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from;

    if (!map_writable(self, &pdo) || !conform_set_pdo_type(self, &pdo, 0))
        return false;
    start(self);
    conform_send_sync(self); /* the start may be an event */
    conform_listen(self, EVENT_TIMER);
    from = conform_mark(self);
    if (!write_entry(self, pdo.entries[0], 0x41) ||
        !conform_expect_none(self, from, pdo_id(&pdo), CONFORM_QUIET))
        return false;
    from = conform_send_sync(self);
    return conform_await(self, from, pdo_id(&pdo), ANSWER) != CONFORM_NOTHING ||
           conform_fail(self, "transmission type 0: an event and a SYNC, and no TPDO");
}

static bool has_inhibit_time(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_find(self, pdo->index, 3) != NULL;
}

static bool set_inhibit_time(struct conform *self, struct conform_pdo *pdo)
{
    if (!has_inhibit_time(self, pdo))
        return conform_skip(self, "the device has no %04Xh:03", pdo->index);
    return conform_set_pdo_type(self, pdo, EVENT_TYPE) && conform_switch_pdo(self, pdo, false) &&
           conform_set(self, pdo->index, 3, 2, INHIBIT * 10) && conform_switch_pdo(self, pdo, true);
}

static bool check_distance(struct conform *self, const struct conform_pdo *pdo, size_t first,
                           size_t second)
{
    const co_us_t gap = conform_time(self, second) - conform_time(self, first);

    if (gap < CO_MS(INHIBIT / 2))
        return conform_fail(self, "%04Xh:03 is %u ms: received two TPDOs within %u us", pdo->index,
                            INHIBIT, (unsigned)gap);
    return conform_frame(self, second)->data[0] == 0x43 ||
           conform_fail(self, "the TPDO at the end of the inhibit time has not the last value");
}

static bool check_inhibit(struct conform *self)
{
    struct conform_pdo pdo;
    size_t from, first, second;

    if (!map_writable(self, &pdo) || !set_inhibit_time(self, &pdo))
        return false;
    start(self);
    conform_listen(self, 2 * INHIBIT); /* that of the start is over */
    from = conform_mark(self);
    if (!write_entry(self, pdo.entries[0], 0x42) || !write_entry(self, pdo.entries[0], 0x43))
        return false;
    first = conform_await(self, from, pdo_id(&pdo), ANSWER);
    second = first == CONFORM_NOTHING ? first
                                      : conform_await(self, first + 1, pdo_id(&pdo), ANSWER);
    if (second == CONFORM_NOTHING)
        return conform_skip(self, "a write over SDO is no event for the device");
    return check_distance(self, &pdo, first, second);
}

static const struct conform_check checks[] = {
    { "pdo-event-timer", "a TPDO is sent in the period of its event timer", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0, check_event_timer },
    { "pdo-kept", "the parameters of a TPDO outlive stop and start", "CiA 301, 7.3.2",
      CONFORM_RESET, 0, check_kept },
    { "pdo-preoperational", "no TPDO in pre-operational", "CiA 301, 7.3.2.2", CONFORM_RESET, 0,
      check_preoperational },
    { "pdo-stopped", "no TPDO in Stopped", "CiA 301, 7.3.2.2", CONFORM_RESET, 0, check_stopped },
    { "pdo-remote", "a remote frame asks for a TPDO", "CiA 301, 7.2.2.5", CONFORM_RESET, 0,
      check_remote },
    { "pdo-no-remote", "bit 30 of the COB-ID: a remote frame is not answered", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0, check_no_remote },
    { "pdo-each-sync", "transmission type 1: a TPDO after each SYNC, and none without",
      "CiA 301, 7.5.2.37", CONFORM_RESET, 0, check_each_sync },
    { "pdo-fifth-sync", "transmission type 5: a TPDO after each fifth SYNC", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0, check_fifth_sync },
    { "pdo-sync-start", "18xxh:06: the first TPDO with that SYNC", "CiA 301, 7.5.2.37",
      CONFORM_RESET, 0x1019, check_start_value },
    { "pdo-length", "a TPDO is as long as its mapping", "CiA 301, 7.5.2.38", CONFORM_RESET, 0,
      check_length },
    { "pdo-data", "a TPDO has the values of its objects, in the order of its mapping",
      "CiA 301, 7.5.2.38", CONFORM_EDS | CONFORM_RESET, 0, check_data },
    { "pdo-acyclic", "transmission type 0: a TPDO after an event and a SYNC", "CiA 301, 7.5.2.37",
      CONFORM_EDS | CONFORM_RESET, 0, check_acyclic },
    { "pdo-inhibit", "TPDOs keep the distance of 18xxh:03, the last value wins",
      "CiA 301, 7.5.2.37", CONFORM_EDS | CONFORM_RESET, 0, check_inhibit },
};

const struct conform_family conform_pdo_transmit = { "pdo", "PDO", checks,
                                                     sizeof checks / sizeof checks[0] };

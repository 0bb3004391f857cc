/*
 * Own frames of a virtual bus, switched while another thread waits: who gets them, and who is woken
 * up for them.
 */
#include "port/bus_segment.h"
#include "port/clock.h"
#include "port/thread.h"
#include "support/bus_fixture.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define PATIENCE CO_MS(20000)

static const struct bus_filter only_10 = { 0x10, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR };

START_TEST(own_frames_are_switched)
{
    struct bus *bus = fixture_open(false);
    struct bus_rx rx;

    fixture_send(bus, "181#01", 7);
    fixture_expect_nothing(bus);
    ck_assert_int_eq(bus_set_own_frames(bus, true), CO_OK);
    fixture_send(bus, "182#02", 8);
    rx = fixture_expect(bus, "182#02");
    ck_assert_uint_eq(rx.frame.flags, CO_FRAME_OWN);
    ck_assert_uint_eq(rx.frame.tag, 8);
    ck_assert_int_eq(bus_set_own_frames(bus, false), CO_OK);
    fixture_send(bus, "183#03", 9);
    ck_assert_int_eq(bus_wait(bus, clock_now() + CO_MS(5)), CO_ERR_TIMEOUT);
    fixture_expect_nothing(bus);
    bus_close(bus);
}
END_TEST

START_TEST(others_hear_them_in_any_case)
{
    struct bus *bus = fixture_open(false), *other = fixture_open(false);

    fixture_send(bus, "181#01", 7);
    ck_assert_int_eq(bus_set_own_frames(bus, true), CO_OK);
    fixture_send(bus, "182#02", 7);
    fixture_expect(other, "181#01");
    fixture_expect(other, "182#02");
    bus_close(bus);
    bus_close(other);
}
END_TEST

/* --- waking up --- */

/* A thread that waits on a bus, and what it shows to the others while it sleeps. */
struct sleeper {
    struct bus *bus;
    struct segment segment;
    pthread_t thread;
    enum co_err result;
};

static void *sleep_on_bus(void *context)
{
    struct sleeper *self = context;

    self->result = bus_wait(self->bus, clock_now() + PATIENCE);
    return NULL;
}

static uint64_t ticket_of(const struct sleeper *self)
{
    return atomic_load(&self->segment.map->slots[0].ticket);
}

/* Returns its ticket, which whoever wakes it takes. */
static uint64_t start_sleeper(struct sleeper *self)
{
    const struct bus_message nowhere = { NULL, 0 };
    const char *name = strchr(fixture_name(), ':') + 1;
    uint64_t ticket;

    ck_assert_int_eq(segment_open(&self->segment, name, 0, &nowhere), CO_OK);
    ck_assert_int_eq(pthread_create(&self->thread, NULL, sleep_on_bus, self), 0);
    do
        ticket = ticket_of(self);
    while (ticket == 0);
    return ticket;
}

static void end_sleeper(struct sleeper *self)
{
    bus_wake(self->bus);
    ck_assert_int_eq(pthread_join(self->thread, NULL), 0);
    ck_assert_int_eq(self->result, CO_OK);
    segment_close(&self->segment);
    bus_close(self->bus);
}

static const struct {
    bool own_frames;
    bool has_filter;
    const char *frame;
    bool wakes;
} wake_cases[] = {
    { false, false, "010#", false }, { true, false, "010#", true },  { true, true, "010#", true },
    { true, true, "011#", false },   { false, true, "010#", false },
};

START_TEST(only_wanted_frames_wake_their_sender)
{
    struct sleeper sleeper = { .bus = fixture_open(!wake_cases[_i].own_frames) };
    uint64_t ticket;

    ck_assert_int_eq(bus_set_own_frames(sleeper.bus, wake_cases[_i].own_frames), CO_OK);
    if (wake_cases[_i].has_filter)
        ck_assert_int_eq(bus_set_filters(sleeper.bus, &only_10, 1), CO_OK);
    ticket = start_sleeper(&sleeper);
    fixture_send(sleeper.bus, wake_cases[_i].frame, 1);
    ck_assert_int_eq(ticket_of(&sleeper) != ticket, wake_cases[_i].wakes);
    end_sleeper(&sleeper);
}
END_TEST

/* --- while another thread waits --- */

#define ROUNDS 3000u

struct listener {
    struct bus *bus;
    struct co_lock lock; /* the owner's */
    _Atomic bool ended;
    unsigned received, strange;
};

static void *listen_to_bus(void *context)
{
    struct listener *self = context;
    struct bus_rx rx;

    while (!self->ended) {
        lock_take(&self->lock);
        while (bus_receive(self->bus, &rx) == CO_OK) {
            self->received++;
            self->strange += rx.frame.id != 0x10 || rx.frame.tag != 3;
        }
        lock_give(&self->lock);
        bus_wait(self->bus, clock_now() + PATIENCE);
    }
    return NULL;
}

/* As devices come and go: the thread that waits is not asked. */
START_TEST(switching_needs_no_pause)
{
    static const struct bus_filter none = { 0x7FF, 0x7FF, CO_FRAME_RTR, CO_FRAME_RTR };
    struct listener listener = { .bus = fixture_open(false) };
    pthread_t thread;

    ck_assert_int_eq(lock_init(&listener.lock), CO_OK);
    ck_assert_int_eq(bus_set_filters(listener.bus, &none, 1), CO_OK);
    ck_assert_int_eq(pthread_create(&thread, NULL, listen_to_bus, &listener), 0);
    for (unsigned i = 0; i < ROUNDS; i++) {
        lock_take(&listener.lock);
        ck_assert_int_eq(bus_set_own_frames(listener.bus, i % 2 == 0), CO_OK);
        ck_assert_int_eq(bus_set_filters(listener.bus, i % 3 == 0 ? &only_10 : &none, 1), CO_OK);
        fixture_send(listener.bus, i % 5 == 0 ? "011#" : "010#", 3);
        lock_give(&listener.lock);
    }
    listener.ended = true;
    bus_wake(listener.bus);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    ck_assert_uint_eq(listener.strange, 0);
    lock_done(&listener.lock);
    bus_close(listener.bus);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("virtual bus");
    int failed;

    fixture_choose_name();
    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, fixture_remove_file, NULL);
    tcase_add_test(tests, own_frames_are_switched);
    tcase_add_test(tests, others_hear_them_in_any_case);
    tcase_add_loop_test(tests, only_wanted_frames_wake_their_sender, 0,
                        sizeof wake_cases / sizeof wake_cases[0]);
    tcase_add_test(tests, switching_needs_no_pause);
    failed = suite_run("bus_own_frames", tests);
    fixture_remove_file();
    return failed;
}

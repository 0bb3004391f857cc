/*
 * The virtual bus between processes, and what happens to the others when one is killed or stopped
 * at an unlucky moment.
 */
#include "port/bus.h"

#include "port/bus_segment.h"
#include "port/clock.h"
#include "support/bus_fixture.h"
#include "support/peer.h"

#include <check.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define PATIENCE CO_MS(30000) /* a test that waits longer has failed */

/* --- the parts that other processes play; they report by their exit status --- */

static struct bus *peer_open(const char *bus_name)
{
    const struct bus_options options = { .own_frames = false };
    char message[200] = "";
    struct bus *bus = NULL;

    if (bus_open(bus_name, &options, &bus, message, sizeof message) != CO_OK) {
        fprintf(stderr, "peer: %s\n", message);
        exit(2);
    }
    return bus;
}

/* Sends frames with the number of each in its data. Busy moments of the lock are no failure. */
static bool peer_send(struct bus *bus, uint32_t id, uint32_t number)
{
    struct co_frame frame = co_frame_make(id, 8);
    enum co_err err = CO_ERR_HELD;

    memcpy(frame.data, &number, sizeof number);
    number = ~number;
    memcpy(frame.data + 4, &number, sizeof number);
    for (unsigned tries = 0; err == CO_ERR_HELD && tries < 1000; tries++) {
        err = bus_send(bus, &frame);
        if (err == CO_ERR_HELD)
            usleep(1000);
    }
    return err == CO_OK;
}

/* arguments: identifier, count (0: for ever), frames between pauses (0: none) */
static int play_sender(const char *bus_name, char **arguments)
{
    struct bus *bus = peer_open(bus_name);
    uint32_t id = (uint32_t)atoi(arguments[0]), count = (uint32_t)atoi(arguments[1]);
    uint32_t burst = (uint32_t)atoi(arguments[2]);

    for (uint32_t n = 0; count == 0 || n < count; n++) {
        if (!peer_send(bus, id, n))
            return 3;
        if (burst != 0 && n % burst == burst - 1)
            usleep(500);
    }
    bus_close(bus);
    return 0;
}

/* Comes and goes, often as the first or the last one. */
static int play_visitor(const char *bus_name)
{
    for (uint32_t n = 0; n < 300; n++) {
        struct bus *bus = peer_open(bus_name);

        if (!peer_send(bus, 0x111, n))
            return 3;
        bus_close(bus);
    }
    return 0;
}

static struct segment *peer_lock(const char *bus_name)
{
    static struct segment segment;
    const struct bus_message message = { NULL, 0 };

    if (segment_open(&segment, bus_name + strlen("virtual:"), 0, &message) != CO_OK ||
        segment_lock(&segment, CO_MS(1000)) != CO_OK)
        exit(4);
    return &segment;
}

/* Stops with the lock taken; when continued, gives it back. */
static int play_holder(const char *bus_name)
{
    struct segment *segment = peer_lock(bus_name);

    raise(SIGSTOP);
    segment_unlock(segment);
    segment_close(segment);
    return 0;
}

/* Dies with half a record written. */
static int play_half_writer(const char *bus_name)
{
    struct segment_map *map = peer_lock(bus_name)->map;
    struct segment_record *record = &map->ring[map->head % SEGMENT_RECORDS];

    record->number = 0;
    record->time = 1;
    record->head = UINT64_MAX;
    raise(SIGKILL);
    return 5;
}

/* Dies with its frame visible and nobody woken. */
static int play_mute_writer(const char *bus_name)
{
    const struct segment_frame frame = { .frame = co_frame_make(0x321, 1),
                                         .time = clock_now(),
                                         .slot = SEGMENT_SLOTS };
    struct segment *segment = peer_lock(bus_name);

    usleep(50000); /* most likely the reader sleeps by now; correct either way */
    segment_append(segment, &frame);
    raise(SIGKILL);
    return 5;
}

/* Takes part, and stops or dies without leaving. */
static int play_participant(const char *bus_name, int signal_number)
{
    peer_open(bus_name);
    raise(signal_number);
    return 0;
}

static int play(char **arguments)
{
    const char *part = arguments[0], *bus_name = arguments[1];

    if (strcmp(part, "sender") == 0)
        return play_sender(bus_name, arguments + 2);
    if (strcmp(part, "visitor") == 0)
        return play_visitor(bus_name);
    if (strcmp(part, "holder") == 0)
        return play_holder(bus_name);
    if (strcmp(part, "half") == 0)
        return play_half_writer(bus_name);
    if (strcmp(part, "mute") == 0)
        return play_mute_writer(bus_name);
    if (strcmp(part, "sleeper") == 0)
        return play_participant(bus_name, SIGSTOP);
    if (strcmp(part, "casualty") == 0)
        return play_participant(bus_name, SIGKILL);
    return 1;
}

static pid_t start(const char *part)
{
    const char *const arguments[] = { part, fixture_name(), NULL };

    return peer_start(arguments);
}

static pid_t start_sender(unsigned id, unsigned count, unsigned burst)
{
    char numbers[3][16];
    const char *const arguments[] = { "sender",   fixture_name(), numbers[0],
                                      numbers[1], numbers[2],     NULL };

    snprintf(numbers[0], sizeof numbers[0], "%u", id);
    snprintf(numbers[1], sizeof numbers[1], "%u", count);
    snprintf(numbers[2], sizeof numbers[2], "%u", burst);
    return peer_start(arguments);
}

static void expect_success(pid_t pid)
{
    int status = peer_wait(pid);

    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), 0);
}

static void expect_killed(pid_t pid)
{
    int status = peer_wait(pid);

    ck_assert(WIFSIGNALED(status));
    ck_assert_int_eq(WTERMSIG(status), SIGKILL);
}

/* --- this side --- */

static struct bus *open_bus(void)
{
    return peer_open(fixture_name());
}

static enum co_err send_one(struct bus *bus)
{
    const struct co_frame frame = co_frame_make(0x100, 0);

    return bus_send(bus, &frame);
}

/* The next frame, waiting for it. Checks that the halves of its data belong together. */
static struct bus_rx receive(struct bus *bus, uint32_t *ret_number)
{
    co_us_t deadline = clock_now() + PATIENCE;
    struct bus_rx rx = { .lost = 0 };
    uint32_t inverse;

    while (bus_receive(bus, &rx) == CO_ERR_AGAIN)
        ck_assert_int_eq(bus_wait(bus, deadline), CO_OK);
    memcpy(ret_number, rx.frame.data, sizeof *ret_number);
    memcpy(&inverse, rx.frame.data + 4, sizeof inverse);
    ck_assert_uint_eq(inverse, ~*ret_number);
    return rx;
}

START_TEST(all_processes_see_one_order)
{
    enum { SENDERS = 3, EACH = 4000 };
    struct bus *first = open_bus(), *second = open_bus();
    uint32_t next[SENDERS] = { 0 }, number, same;
    pid_t senders[SENDERS];

    for (unsigned i = 0; i < SENDERS; i++)
        senders[i] = start_sender(0x200 + i, EACH, 0);
    for (unsigned n = 0; n < SENDERS * EACH; n++) {
        struct bus_rx rx = receive(first, &number);
        unsigned sender = rx.frame.id - 0x200;

        ck_assert_uint_lt(sender, SENDERS);
        ck_assert_uint_eq(number, next[sender]++);
        ck_assert_uint_eq(rx.lost, 0);
        ck_assert_uint_eq(receive(second, &same).frame.id, rx.frame.id);
        ck_assert_uint_eq(same, number);
    }
    for (unsigned i = 0; i < SENDERS; i++)
        expect_success(senders[i]);
    bus_close(first);
    bus_close(second);
}
END_TEST

START_TEST(losses_are_exact_while_writers_overrun_the_reader)
{
    enum { COUNT = 400000 };
    struct bus *bus = open_bus();
    pid_t sender = start_sender(0x200, COUNT, 0);
    uint32_t number, next = 0;
    unsigned lost = 0;

    while (next < COUNT) {
        struct bus_rx rx = receive(bus, &number);

        ck_assert_uint_eq(number, next + rx.lost);
        lost += rx.lost;
        next = number + 1;
        if (next % 8192 == 0)
            usleep(20000); /* long enough to be overrun, and more than once */
    }
    ck_assert_uint_gt(lost, 0);
    expect_success(sender);
    bus_close(bus);
}
END_TEST

START_TEST(a_writer_killed_in_its_record_leaves_nothing)
{
    struct bus *sender = open_bus(), *reader = open_bus();
    uint32_t number;

    ck_assert(peer_send(sender, 0x101, 1));
    expect_killed(start("half"));
    ck_assert(peer_send(sender, 0x102, 2));
    ck_assert_uint_eq(receive(reader, &number).frame.id, 0x101);
    ck_assert_uint_eq(receive(reader, &number).frame.id, 0x102);
    ck_assert_uint_eq(number, 2);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(a_record_spoilt_by_a_killed_writer_is_counted)
{
    struct bus *sender = open_bus(), *reader = open_bus();
    struct bus_rx rx;
    uint32_t number;

    for (uint32_t n = 0; n < SEGMENT_RECORDS; n++)
        ck_assert(peer_send(sender, 0x101, n));
    expect_killed(start("half")); /* it began to overwrite the oldest */
    rx = receive(reader, &number);
    ck_assert_uint_eq(rx.lost, 1);
    ck_assert_uint_eq(number, 1);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(a_frame_whose_writer_woke_nobody_is_found)
{
    struct bus *reader = open_bus();
    pid_t mute = start("mute");
    co_us_t deadline = clock_now() + PATIENCE;
    struct bus_rx rx;

    ck_assert_int_eq(bus_wait(reader, deadline), CO_OK);
    ck_assert_uint_lt(clock_now(), deadline);
    ck_assert_int_eq(bus_receive(reader, &rx), CO_OK);
    ck_assert_uint_eq(rx.frame.id, 0x321);
    expect_killed(mute);
    bus_close(reader);
}
END_TEST

static void expect_held(struct bus *bus, pid_t holder)
{
    char expected[100], message[200] = "";
    const struct bus_options options = { .own_frames = false };
    struct bus *other = NULL;
    co_us_t start;

    snprintf(expected, sizeof expected, "%s is held by pid %d", fixture_name() + strlen("virtual:"),
             (int)holder);
    ck_assert_int_eq(send_one(bus), CO_ERR_HELD);
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    bus_explain(bus, message, sizeof message);
    ck_assert_ptr_nonnull(strstr(message, expected));
    start = clock_now();
    for (unsigned i = 0; i < 50; i++)
        ck_assert_int_eq(send_one(bus), CO_ERR_HELD);
    ck_assert_uint_lt(clock_now() - start, 25 * SEGMENT_HOLD_LIMIT); /* waits only once */
    message[0] = '\0';
    ck_assert_int_eq(bus_open(fixture_name(), &options, &other, message, sizeof message),
                     CO_ERR_HELD);
    ck_assert_ptr_nonnull(strstr(message, expected));
}

START_TEST(a_stopped_holder_is_named_and_may_go_on)
{
    struct bus *bus = open_bus(), *reader = open_bus();
    pid_t holder = start("holder");
    struct bus_rx rx;

    peer_wait_stopped(holder);
    expect_held(bus, holder);
    ck_assert_int_eq(bus_get_state(reader), BUS_ACTIVE); /* readers are not concerned */
    kill(holder, SIGCONT);
    expect_success(holder);
    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
    ck_assert_int_eq(bus_wait(bus, clock_now() + CO_MS(20000)), CO_OK); /* its thread is told */
    ck_assert_int_eq(send_one(bus), CO_OK);
    ck_assert_int_eq(bus_receive(reader, &rx), CO_OK);
    bus_close(bus);
    bus_close(reader);
}
END_TEST

START_TEST(a_stopped_holder_may_be_killed)
{
    struct bus *bus = open_bus();
    pid_t holder = start("holder");

    peer_wait_stopped(holder);
    ck_assert_int_eq(send_one(bus), CO_ERR_HELD);
    kill(holder, SIGKILL);
    expect_killed(holder);
    ck_assert_int_eq(send_one(bus), CO_OK);
    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
    bus_close(bus);
}
END_TEST

START_TEST(nobody_waits_for_a_stopped_reader)
{
    struct bus *bus = open_bus();
    pid_t sleeper = start("sleeper");

    peer_wait_stopped(sleeper);
    for (unsigned i = 0; i < SEGMENT_RECORDS + 10; i++)
        ck_assert_int_eq(send_one(bus), CO_OK);
    kill(sleeper, SIGKILL);
    expect_killed(sleeper);
    ck_assert_int_eq(send_one(bus), CO_OK);
    bus_close(bus);
}
END_TEST

START_TEST(slots_of_the_dead_are_used_again)
{
    struct bus *bus = open_bus(), *last;

    for (unsigned i = 0; i < SEGMENT_SLOTS + 5; i++)
        expect_killed(start("casualty"));
    last = open_bus();
    ck_assert_int_eq(send_one(bus), CO_OK);
    ck_assert_int_eq(bus_wait(last, clock_now() + PATIENCE), CO_OK);
    bus_close(bus);
    bus_close(last);
}
END_TEST

START_TEST(all_may_come_and_go_at_once)
{
    pid_t visitors[3];
    struct bus *bus;

    for (unsigned i = 0; i < 3; i++)
        visitors[i] = start("visitor");
    for (unsigned i = 0; i < 3; i++)
        expect_success(visitors[i]);
    bus = open_bus();
    ck_assert_int_eq(send_one(bus), CO_OK);
    bus_close(bus);
}
END_TEST

START_TEST(a_bus_left_by_the_dead_is_set_up_anew)
{
    struct bus *bus;

    expect_killed(start("half"));
    ck_assert_int_eq(access(fixture_path(), F_OK), 0);
    bus = open_bus();
    ck_assert_int_eq(send_one(bus), CO_OK);
    bus_close(bus);
}
END_TEST

/* What the reader knows of each sender while some of them are killed. */
struct ledger {
    uint32_t next[0x800]; /* by identifier */
    uint64_t gaps;        /* frames missing in the senders' numbers ... */
    uint64_t lost;        /* ... and those the bus has told of */
};

static void enter(struct ledger *self, const struct bus_rx *rx, uint32_t number)
{
    uint32_t *next = &self->next[rx->frame.id];

    ck_assert_uint_ge(number, *next);
    self->gaps += number - *next;
    self->lost += rx->lost;
    ck_assert_uint_le(self->gaps, self->lost);
    *next = number + 1;
}

static void read_for(struct bus *bus, struct ledger *ledger, co_us_t deadline)
{
    struct bus_rx rx;
    uint32_t number;

    while (clock_now() < deadline) {
        if (bus_receive(bus, &rx) == CO_OK) {
            memcpy(&number, rx.frame.data, sizeof number);
            enter(ledger, &rx, number);
        } else {
            enum co_err err = bus_wait(bus, deadline);

            ck_assert(err == CO_OK || err == CO_ERR_TIMEOUT);
        }
    }
}

START_TEST(killed_writers_harm_nobody)
{
    enum { ROUNDS = 60, STEADY = 2, EACH = 10000 };
    static struct ledger ledger;
    struct bus *bus = open_bus();
    pid_t steady[STEADY];
    unsigned seed = 1;

    for (unsigned i = 0; i < STEADY; i++)
        steady[i] = start_sender(1 + i, EACH, 10);
    for (unsigned round = 0; round < ROUNDS; round++) {
        pid_t victims[2];

        for (unsigned i = 0; i < 2; i++)
            victims[i] = start_sender(0x100 + 2 * round + i, 0, 0);
        read_for(bus, &ledger, clock_now() + CO_MS(5) + (co_us_t)rand_r(&seed) % 20000);
        for (unsigned i = 0; i < 2; i++)
            kill(victims[i], SIGKILL);
        for (unsigned i = 0; i < 2; i++)
            expect_killed(victims[i]);
    }
    for (unsigned i = 0; i < STEADY; i++)
        expect_success(steady[i]);
    read_for(bus, &ledger, clock_now() + CO_MS(10));
    expect_success(start_sender(0x7FF, 100, 0));
    while (ledger.next[0x7FF] < 100)
        read_for(bus, &ledger, clock_now() + CO_MS(1));
    bus_close(bus);
}
END_TEST

int main(int argc, char **argv)
{
    Suite *suite;
    TCase *tests;
    SRunner *runner;
    int failed;

    if (argc > 2)
        return play(argv + 1);
    fixture_choose_name();
    suite = suite_create("bus_virtual_processes");
    tests = tcase_create("processes");
    tcase_set_timeout(tests, 100);
    tcase_add_checked_fixture(tests, fixture_remove_file, NULL);
    tcase_add_test(tests, all_processes_see_one_order);
    tcase_add_test(tests, losses_are_exact_while_writers_overrun_the_reader);
    tcase_add_test(tests, a_writer_killed_in_its_record_leaves_nothing);
    tcase_add_test(tests, a_record_spoilt_by_a_killed_writer_is_counted);
    tcase_add_test(tests, a_frame_whose_writer_woke_nobody_is_found);
    tcase_add_test(tests, a_stopped_holder_is_named_and_may_go_on);
    tcase_add_test(tests, a_stopped_holder_may_be_killed);
    tcase_add_test(tests, nobody_waits_for_a_stopped_reader);
    tcase_add_test(tests, slots_of_the_dead_are_used_again);
    tcase_add_test(tests, all_may_come_and_go_at_once);
    tcase_add_test(tests, a_bus_left_by_the_dead_is_set_up_anew);
    tcase_add_test(tests, killed_writers_harm_nobody);
    suite_add_tcase(suite, tests);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    fixture_remove_file();
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

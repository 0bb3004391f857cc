/*
 * The virtual bus with a bit rate between processes: arbitration, and what the others see when one
 * is killed or stopped at an unlucky moment.
 */
#include "port/bus.h"

#include "port/bus_segment.h"
#include "port/bus_timing.h"
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
#define BITRATE  1000000u
#define NS       UINT64_C(1000)

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

/* With its number in the data; waits for room. */
static bool peer_send(struct bus *bus, uint32_t id, uint32_t number)
{
    struct co_frame frame = co_frame_make(id, 8);
    enum co_err err = CO_ERR_AGAIN;

    memcpy(frame.data, &number, sizeof number);
    for (unsigned tries = 0; err != CO_OK && tries < 10000; tries++) {
        err = bus_send(bus, &frame);
        if (err != CO_OK && err != CO_ERR_AGAIN && err != CO_ERR_HELD)
            return false;
        if (err != CO_OK)
            usleep(500);
    }
    return err == CO_OK;
}

/* arguments: first identifier, step to the next one, count (0: for ever), number of a pause, what
 * to do at the end: the signal to itself, 0: none */
static int play_sender(const char *bus_name, char **arguments)
{
    struct bus *bus = peer_open(bus_name);
    uint32_t id = (uint32_t)atoi(arguments[0]), step = (uint32_t)atoi(arguments[1]);
    uint32_t count = (uint32_t)atoi(arguments[2]);
    int end = atoi(arguments[3]);

    for (uint32_t n = 0; count == 0 || n < count; n++, id += step) {
        if (!peer_send(bus, id, n))
            return 3;
        if (n % 8 == 7)
            usleep(700);
    }
    if (end != 0)
        raise(end);
    bus_close(bus);
    return 0;
}

static int play_listener(const char *bus_name)
{
    struct bus *bus = peer_open(bus_name);
    struct bus_rx rx;

    for (;;) {
        while (bus_receive(bus, &rx) == CO_OK)
            ;
        if (bus_wait(bus, CO_NEVER) != CO_OK)
            return 3;
    }
}

static struct segment *peer_lock(const char *bus_name)
{
    static struct segment segment;
    const struct bus_message message = { NULL, 0 };
    char name[64];

    snprintf(name, sizeof name, "%s", bus_name + strlen(BUS_VIRTUAL_PREFIX));
    name[strcspn(name, "?")] = '\0';
    if (segment_open(&segment, name, BITRATE, &message) != CO_OK ||
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

static void die(void)
{
    raise(SIGKILL);
}

/*
 * The steps of a frame on its way, with the killer behind one of them. The slot is the highest one,
 * which is nobody's.
 */
static int play_victim(const char *bus_name, unsigned last_step)
{
    struct segment *segment = peer_lock(bus_name);
    struct segment_map *map = segment->map;
    const unsigned slot = SEGMENT_SLOTS - 1, index = slot * SEGMENT_PENDING;
    const struct segment_frame frame = { .frame = co_frame_make(0x321, 0),
                                         .time = clock_now(),
                                         .slot = slot };
    bool sooner;

    map->slots_used = SEGMENT_SLOTS;
    segment_offer(segment, &frame, &sooner);
    map->slots[slot].pending = last_step > 0; /* 0: all is written, but it does not count */
    if (last_step <= 1)                       /* 1: pending, and nobody was told when to look */
        map->wire.due = CO_NEVER;
    if (last_step <= 1)
        die();
    map->wire.moving_free = map->pending[index].sent + map->pending[index].length;
    map->wire.moving = map->head << 16 | (index + 1);
    if (last_step == 2)
        die();
    segment_append(segment, &(struct segment_frame){ .frame = frame.frame,
                                                     .time = map->wire.moving_free / NS,
                                                     .slot = slot });
    if (last_step == 3)
        die();
    map->wire.free = map->wire.moving_free;
    map->slots[slot].pending = 0;
    die();
    return 5;
}

static int play(char **arguments)
{
    const char *part = arguments[0], *bus_name = arguments[1];

    if (strcmp(part, "sender") == 0)
        return play_sender(bus_name, arguments + 2);
    if (strcmp(part, "listener") == 0)
        return play_listener(bus_name);
    if (strcmp(part, "holder") == 0)
        return play_holder(bus_name);
    if (strcmp(part, "victim") == 0)
        return play_victim(bus_name, (unsigned)atoi(arguments[2]));
    return 1;
}

static pid_t start(const char *part, unsigned step)
{
    char number[16];
    const char *const arguments[] = { part, fixture_name(), number, NULL };

    snprintf(number, sizeof number, "%u", step);
    return peer_start(arguments);
}

static pid_t start_sender(unsigned id, int step, unsigned count, int end)
{
    char numbers[4][16];
    const char *const arguments[] = { "sender",   fixture_name(), numbers[0], numbers[1],
                                      numbers[2], numbers[3],     NULL };

    snprintf(numbers[0], sizeof numbers[0], "%u", id);
    snprintf(numbers[1], sizeof numbers[1], "%d", step);
    snprintf(numbers[2], sizeof numbers[2], "%u", count);
    snprintf(numbers[3], sizeof numbers[3], "%d", end);
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

static co_us_t time_of(const struct co_frame *frame)
{
    return bus_frame_bits(frame); /* at 1 Mbit/s */
}

static struct bus_rx receive(struct bus *bus)
{
    co_us_t deadline = clock_now() + PATIENCE;
    struct bus_rx rx = { .lost = 0 };

    while (bus_receive(bus, &rx) == CO_ERR_AGAIN)
        ck_assert_int_eq(bus_wait(bus, deadline), CO_OK);
    ck_assert_uint_eq(rx.lost, 0);
    ck_assert_uint_le(rx.time, clock_now());
    return rx;
}

static uint32_t number_of(const struct bus_rx *rx)
{
    uint32_t number;

    memcpy(&number, rx->frame.data, sizeof number);
    return number;
}

/* Nothing gets through before this time, us; what waits then is arbitrated. */
static void hold_wire(co_us_t until)
{
    struct segment *segment = peer_lock(fixture_name());

    segment->map->wire.free = until * NS;
    segment_move_on(segment, clock_now());
    segment_unlock(segment);
    segment_close(segment);
}

START_TEST(arbitration_is_between_all_processes)
{
    enum { SENDERS = 3, EACH = 20 };
    struct bus *first = open_bus(), *second = open_bus();
    pid_t senders[SENDERS];
    co_us_t free = 0;

    hold_wire(clock_now() + CO_MS(3600000));
    for (unsigned i = 0; i < SENDERS; i++) /* 205, 202, 1FF ...; 206, 203 ...; 207 ... */
        senders[i] = start_sender(0x205 + i, -3, EACH, 0);
    for (unsigned i = 0; i < SENDERS; i++)
        expect_success(senders[i]); /* what they have sent goes out without them */
    hold_wire(free = clock_now());
    for (unsigned n = 0; n < SENDERS * EACH; n++) {
        struct bus_rx rx = receive(first), same = receive(second);

        ck_assert_uint_eq(rx.frame.id, 0x205 - 3 * (EACH - 1) + n);
        free += time_of(&rx.frame);
        ck_assert_uint_eq(rx.time, free);
        ck_assert(co_frame_equal(&same.frame, &rx.frame));
        ck_assert_uint_eq(same.time, rx.time);
    }
    bus_close(first);
    bus_close(second);
}
END_TEST

START_TEST(what_others_have_left_takes_no_room)
{
    struct bus *reader = open_bus();

    hold_wire(clock_now() + CO_MS(3600000));
    for (unsigned i = 0; i < 3; i++)
        expect_success(start_sender(0x301 + i, 0, SEGMENT_PENDING, 0));
    hold_wire(clock_now());
    for (unsigned n = 0; n < 3 * SEGMENT_PENDING; n++)
        ck_assert_uint_eq(receive(reader).frame.id, 0x301 + n / SEGMENT_PENDING);
    bus_close(reader);
}
END_TEST

START_TEST(what_a_killed_sender_has_sent_goes_out)
{
    struct bus *reader = open_bus();
    co_us_t free;

    hold_wire(clock_now() + CO_MS(3600000));
    expect_killed(start_sender(0x301, 0, SEGMENT_PENDING, SIGKILL));
    hold_wire(free = clock_now());
    for (unsigned n = 0; n < SEGMENT_PENDING; n++) {
        struct bus_rx rx = receive(reader);

        free += time_of(&rx.frame);
        ck_assert_uint_eq(number_of(&rx), n);
        ck_assert_uint_eq(rx.time, free);
    }
    bus_close(reader);
}
END_TEST

START_TEST(a_stopped_sender_holds_up_nobody)
{
    struct bus *reader = open_bus(), *other = open_bus();
    pid_t stopped = start_sender(0x301, 0, 5, SIGSTOP);

    peer_wait_stopped(stopped);
    for (unsigned n = 0; n < 5; n++)
        ck_assert_uint_eq(number_of(&(struct bus_rx){ receive(reader).frame, 0, 0 }), n);
    ck_assert(peer_send(other, 0x100, 7));
    ck_assert_uint_eq(receive(reader).frame.id, 0x100);
    kill(stopped, SIGKILL);
    expect_killed(stopped);
    bus_close(reader);
    bus_close(other);
}
END_TEST

/* What comes of the victim's frame, by the step behind which it died. */
static const unsigned frames_of_victim[] = { 0, 1, 1, 1, 1 };

START_TEST(a_frame_whose_mover_is_killed_comes_once_or_never)
{
    struct bus *reader = open_bus();
    co_us_t before = clock_now();
    struct bus_rx rx;

    expect_killed(start("victim", (unsigned)_i));
    for (unsigned n = 0; n < frames_of_victim[_i]; n++) {
        rx = receive(reader);
        ck_assert_uint_eq(rx.frame.id, 0x321);
        ck_assert_uint_ge(rx.time, before);
        before = rx.time;
    }
    ck_assert(peer_send(reader, 0x100, 7)); /* mends the rest */
    expect_success(start_sender(0x101, 0, 1, 0));
    rx = receive(reader);
    ck_assert_uint_eq(rx.frame.id, 0x101);
    ck_assert_uint_ge(rx.time, before + time_of(&rx.frame));
    bus_close(reader);
}
END_TEST

/* It dies while the reader sleeps, with nothing said about when to look. */
START_TEST(a_sleeper_finds_what_nobody_told)
{
    struct bus *reader = open_bus();
    pid_t victim = start("victim", 1);
    co_us_t deadline = clock_now() + PATIENCE;

    ck_assert_int_eq(bus_wait(reader, deadline), CO_OK);
    ck_assert_uint_lt(clock_now(), deadline);
    ck_assert_uint_eq(receive(reader).frame.id, 0x321);
    expect_killed(victim);
    bus_close(reader);
}
END_TEST

START_TEST(a_stopped_holder_stops_the_wire_not_the_readers)
{
    struct bus *sender = open_bus(), *reader = open_bus();
    co_us_t before = clock_now(), after, started;
    struct bus_rx rx;
    pid_t holder;

    ck_assert(peer_send(sender, 0x100, 1));
    after = clock_now();
    holder = start("holder", 0);
    peer_wait_stopped(holder);
    usleep(1000); /* through by now, and nobody has looked */
    started = clock_now();
    for (unsigned i = 0; i < 1000; i++)
        ck_assert_int_eq(bus_receive(reader, &rx), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_wait(reader, clock_now() + CO_MS(50)), CO_ERR_TIMEOUT);
    ck_assert_uint_lt(clock_now() - started, CO_MS(5000)); /* waits for the holder only once */
    kill(holder, SIGCONT);
    rx = receive(reader);
    ck_assert_uint_ge(rx.time, before + time_of(&rx.frame));
    ck_assert_uint_le(rx.time, after + time_of(&rx.frame));
    expect_success(holder);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

/* --- killed at any instant --- */

struct ledger {
    uint32_t next[0x800]; /* by identifier */
    co_us_t last;         /* end of the last frame */
};

/* All come, once and in order, and none while another is on the wire. */
static void read_for(struct bus *bus, struct ledger *ledger, co_us_t deadline)
{
    struct bus_rx rx;

    while (clock_now() < deadline) {
        while (bus_receive(bus, &rx) == CO_OK) {
            ck_assert_uint_eq(rx.lost, 0);
            ck_assert_uint_eq(number_of(&rx), ledger->next[rx.frame.id]++);
            ck_assert_uint_ge(rx.time, ledger->last + time_of(&rx.frame));
            ledger->last = rx.time;
        }
        bus_wait(bus, deadline);
    }
}

START_TEST(the_killed_harm_nobody)
{
    enum { ROUNDS = 50, STEADY = 2, EACH = 3000 };
    static struct ledger ledger;
    struct bus *bus = open_bus();
    pid_t steady[STEADY], victims[3];
    co_us_t deadline;
    unsigned seed = 1;

    for (unsigned i = 0; i < STEADY; i++)
        steady[i] = start_sender(0x700 + i, 0, EACH, 0);
    for (unsigned round = 0; round < ROUNDS; round++) {
        victims[0] = start_sender(0x100 + 2 * round, 0, 0, 0);
        victims[1] = start_sender(0x101 + 2 * round, 0, 0, 0);
        victims[2] = start("listener", 0);
        read_for(bus, &ledger, clock_now() + CO_MS(5) + (co_us_t)rand_r(&seed) % 20000);
        for (unsigned i = 0; i < 3; i++)
            kill(victims[i], SIGKILL);
        for (unsigned i = 0; i < 3; i++)
            expect_killed(victims[i]);
    }
    deadline = clock_now() + PATIENCE;
    while (ledger.next[0x700] + ledger.next[0x701] < STEADY * EACH && clock_now() < deadline)
        read_for(bus, &ledger, clock_now() + CO_MS(10));
    ck_assert_uint_eq(ledger.next[0x700], EACH);
    ck_assert_uint_eq(ledger.next[0x701], EACH);
    for (unsigned i = 0; i < STEADY; i++)
        expect_success(steady[i]);
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
    fixture_choose_bitrate(BITRATE);
    suite = suite_create("bus_bitrate_processes");
    tests = tcase_create("processes");
    tcase_set_timeout(tests, 100);
    tcase_add_checked_fixture(tests, fixture_remove_file, NULL);
    tcase_add_test(tests, arbitration_is_between_all_processes);
    tcase_add_test(tests, what_others_have_left_takes_no_room);
    tcase_add_test(tests, what_a_killed_sender_has_sent_goes_out);
    tcase_add_test(tests, a_stopped_sender_holds_up_nobody);
    tcase_add_loop_test(tests, a_frame_whose_mover_is_killed_comes_once_or_never, 0,
                        sizeof frames_of_victim / sizeof frames_of_victim[0]);
    tcase_add_test(tests, a_sleeper_finds_what_nobody_told);
    tcase_add_test(tests, a_stopped_holder_stops_the_wire_not_the_readers);
    tcase_add_test(tests, the_killed_harm_nobody);
    suite_add_tcase(suite, tests);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    fixture_remove_file();
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

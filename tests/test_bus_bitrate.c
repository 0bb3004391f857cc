/* The virtual bus with a bit rate, within one process: names, times, waiting. */
#include "port/bus.h"

#include "port/bus_segment.h"
#include "port/bus_timing.h"
#include "port/clock.h"
#include "support/bus_fixture.h"

#include <check.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define PATIENCE CO_MS(20000) /* a test that waits longer has failed */

static co_us_t time_of(const struct co_frame *frame, unsigned bitrate)
{
    return bus_frame_bits(frame) * UINT64_C(1000000) / bitrate;
}

static struct bus_rx wait_for_frame(struct bus *bus)
{
    co_us_t deadline = clock_now() + PATIENCE;
    struct bus_rx rx;

    while (bus_receive(bus, &rx) == CO_ERR_AGAIN)
        ck_assert_int_eq(bus_wait(bus, deadline), CO_OK);
    return rx;
}

/* --- names and rates --- */

static const struct {
    const char *option;
    unsigned kbit; /* as configured */
    const char *message;
} refused[] = {
    { "?bitrate=", 0, "\"?bitrate=\" is not ?bitrate=N, with N from 1000 to 1000000" },
    { "?", 0, "is not ?bitrate=N" },
    { "?rate=500000", 0, "is not ?bitrate=N" },
    { "?bitrate=500k", 0, "is not ?bitrate=N" },
    { "?bitrate=-1", 0, "is not ?bitrate=N" },
    { "?bitrate=999", 0, "is not ?bitrate=N" },
    { "?bitrate=1000001", 0, "is not ?bitrate=N" },
    { "?bitrate=42949672960500000", 0, "is not ?bitrate=N" },
    { "?bitrate=500000&x=1", 0, "is not ?bitrate=N" },
    { "?bitrate=500000", 250, "is to run at 500000 bit/s, but the network is configured for 250" },
    { "?bitrate=500000", 500000, "configured for 500000 kbit/s" },
};

static enum co_err try_open(const char *option, unsigned kbit, char *message, size_t size)
{
    const struct bus_options options = { .bitrate = kbit };
    struct bus *bus = NULL;
    char name[128];
    enum co_err err;

    fixture_choose_bitrate(0);
    snprintf(name, sizeof name, "%s%s", fixture_name(), option);
    err = bus_open(name, &options, &bus, message, size);
    bus_close(bus);
    return err;
}

START_TEST(what_is_no_rate_or_not_the_networks_is_refused)
{
    char text[300] = "";
    enum co_err expected = refused[_i].kbit ? CO_ERR_BITRATE : CO_ERR_ARG;

    ck_assert_int_eq(try_open(refused[_i].option, refused[_i].kbit, text, sizeof text), expected);
    ck_assert_msg(strstr(text, refused[_i].message) != NULL, "%s", text);
    ck_assert_int_eq(try_open(refused[_i].option, refused[_i].kbit, NULL, 0), expected);
}
END_TEST

static const struct {
    const char *option;
    unsigned kbit;
} accepted[] = { { "?bitrate=1000", 0 },     { "?bitrate=1000000", 1000 }, { "?bitrate=500000", 0 },
                 { "?bitrate=500000", 500 }, { "?bitrate=0125000", 125 },  { "", 250 } };

START_TEST(rates_are_taken)
{
    char text[300] = "";

    ck_assert_msg(try_open(accepted[_i].option, accepted[_i].kbit, text, sizeof text) == CO_OK,
                  "%s", text);
}
END_TEST

/* The first one's, those of the next, and what the next is told. */
static const struct {
    unsigned first;
    const char *option;
    const char *told[3];
} mismatches[] = {
    { 500000, "?bitrate=250000", { "500000 bit/s", "250000 bit/s", "?bitrate=500000\"" } },
    { 500000, "", { "500000 bit/s", "without one", "?bitrate=500000\"" } },
    { 0, "?bitrate=125000", { "without a bit rate", "125000 bit/s", "open it as" } },
};

START_TEST(all_have_the_rate_of_the_first)
{
    char text[300] = "", name[64];
    struct bus *first;

    fixture_choose_bitrate(mismatches[_i].first);
    snprintf(name, sizeof name, "%s", fixture_name());
    first = fixture_open(false);
    ck_assert_int_eq(try_open(mismatches[_i].option, 0, text, sizeof text), CO_ERR_BITRATE);
    for (unsigned i = 0; i < 3; i++)
        ck_assert_msg(strstr(text, mismatches[_i].told[i]) != NULL, "%s", text);
    ck_assert_int_eq(fixture_try_open(name, NULL, 0), CO_OK);
    bus_close(first);
    ck_assert_int_eq(try_open(mismatches[_i].option, 0, text, sizeof text), CO_OK);
}
END_TEST

START_TEST(the_bus_tells_its_rate)
{
    struct bus *bus;
    char text[100];

    fixture_choose_bitrate(1000000);
    bus = fixture_open(false);
    ck_assert_str_eq(bus_name(bus), fixture_name());
    bus_explain(bus, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "is up, 1000000 bit/s"));
    bus_close(bus);
}
END_TEST

/* --- times --- */

START_TEST(a_frame_comes_at_the_end_of_its_time)
{
    struct bus *sender, *reader;
    struct bus_rx rx;
    co_us_t before, after, length;

    fixture_choose_bitrate(10000);
    sender = fixture_open(true);
    reader = fixture_open(false);
    before = clock_now();
    fixture_send(sender, "605#4000100000000000", 9); /* 12.4 ms */
    after = clock_now();
    rx = wait_for_frame(reader);
    length = time_of(&rx.frame, 10000);
    ck_assert_uint_eq(length, 12400);
    ck_assert_uint_ge(clock_now(), rx.time);
    ck_assert_uint_ge(rx.time, before + length);
    ck_assert_uint_le(rx.time, after + length);
    ck_assert_uint_eq(rx.frame.flags, 0);
    before = rx.time;
    rx = wait_for_frame(sender);
    ck_assert_uint_eq(rx.time, before);
    ck_assert_uint_eq(rx.frame.flags, CO_FRAME_OWN);
    ck_assert_uint_eq(rx.frame.tag, 9);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(the_backlog_waits_for_the_wire)
{
    struct bus *sender, *reader;
    unsigned both;

    fixture_choose_bitrate(10000);
    sender = fixture_open(true);
    reader = fixture_open(false);
    ck_assert_uint_eq(bus_backlog(sender), 0);
    fixture_send(sender, "605#4000100000000000", 9); /* 12.4 ms */
    fixture_send(sender, "606#4000100000000000", 9);
    both = bus_backlog(sender);
    ck_assert_uint_ne(both, 0);
    ck_assert_uint_eq(bus_backlog(reader), 0);
    wait_for_frame(sender);
    ck_assert_uint_ne(bus_backlog(sender), both);
    wait_for_frame(sender);
    ck_assert_uint_eq(bus_backlog(sender), 0);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(nobody_sees_a_frame_before)
{
    struct bus *sender, *reader;
    struct bus_rx rx;
    co_us_t sent;

    fixture_choose_bitrate(10000);
    sender = fixture_open(false);
    reader = fixture_open(false);
    fixture_send(sender, "7FF#FFFFFFFFFFFFFFFF", 0); /* 12.6 ms */
    sent = clock_now();
    while (bus_receive(reader, &rx) == CO_ERR_AGAIN)
        ck_assert_uint_lt(clock_now(), sent + PATIENCE);
    ck_assert_uint_ge(clock_now(), rx.time);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

static const unsigned rates[] = { 125000, 500000, 1000000 };

/* Sends as fast as it goes, and notes when. */
static void send_next(struct bus *bus, unsigned *count, co_us_t *ret_sent, unsigned end)
{
    struct co_frame frame = co_frame_make(0x123, 8);

    while (*count < end) {
        memcpy(frame.data, count, sizeof *count);
        if (bus_send(bus, &frame) != CO_OK)
            return;
        ret_sent[(*count)++] = clock_now();
    }
}

/*
 * By the time stamps, so that it does not matter how busy the machine is: each frame has exactly
 * its time behind the one before; or, where the sender was too late for that, behind its sending.
 */
START_TEST(frames_follow_each_other_without_a_gap)
{
    enum { COUNT = 1000 };
    static co_us_t sent[COUNT];
    struct bus *sender, *reader;
    unsigned count = 0, gaps = 0;
    co_us_t last = 0;

    fixture_choose_bitrate(rates[_i]);
    sender = fixture_open(false);
    reader = fixture_open(false);
    for (unsigned n = 0; n < COUNT; n++) {
        struct bus_rx rx;
        co_us_t length, start;

        send_next(sender, &count, sent, COUNT);
        rx = wait_for_frame(reader);
        length = time_of(&rx.frame, rates[_i]);
        start = rx.time - length;
        ck_assert_int_eq(memcmp(rx.frame.data, &n, sizeof n), 0);
        ck_assert_uint_ge(start, last);
        if (start != last) {
            ck_assert_uint_le(start, sent[n]);
            gaps++;
        }
        last = rx.time;
    }
    ck_assert_uint_lt(gaps, COUNT); /* the first, and where this process did not run */
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(a_full_queue_says_so_and_empties)
{
    const struct co_frame frame = co_frame_make(0x7FF, 8);
    struct bus *sender, *other;
    co_us_t last = 0;
    unsigned count = 0;

    fixture_choose_bitrate(10000); /* 11 ms each: none is through before the queue is full */
    sender = fixture_open(true);
    other = fixture_open(false);
    while (bus_send(sender, &frame) == CO_OK)
        count++;
    ck_assert_uint_ge(count, SEGMENT_PENDING);
    ck_assert_int_eq(bus_send(sender, &frame), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_send(other, &frame), CO_OK);
    ck_assert_int_eq(bus_get_state(sender), BUS_ACTIVE);
    for (unsigned i = 0; i <= count; i++) {
        struct bus_rx rx = wait_for_frame(sender);

        ck_assert_uint_eq(rx.frame.flags, i < count ? CO_FRAME_OWN : 0);
        ck_assert(i == 0 || rx.time == last + time_of(&frame, 10000));
        last = rx.time;
    }
    ck_assert_int_eq(bus_send(sender, &frame), CO_OK);
    bus_close(sender);
    bus_close(other);
}
END_TEST

START_TEST(a_newcomer_hears_nothing_of_before)
{
    struct bus *sender, *newcomer;
    struct bus_rx rx;
    co_us_t due;

    fixture_choose_bitrate(10000);
    sender = fixture_open(true);
    fixture_send(sender, "000#0100", 0);
    due = clock_now() + CO_MS(8);
    while (clock_now() < due) /* through, and nobody has looked */
        ;
    newcomer = fixture_open(false);
    fixture_send(sender, "123#", 0);
    rx = wait_for_frame(newcomer);
    ck_assert_uint_eq(rx.frame.id, 0x123);
    ck_assert_uint_eq(rx.lost, 0);
    bus_close(sender);
    bus_close(newcomer);
}
END_TEST

/* --- waiting --- */

START_TEST(wait_ends_at_its_deadline_before_the_frame)
{
    struct bus *sender, *reader;
    struct bus_rx rx;
    co_us_t deadline, sent;

    fixture_choose_bitrate(1000); /* 126 ms */
    sender = fixture_open(false);
    reader = fixture_open(false);
    sent = clock_now();
    fixture_send(sender, "7FF#FFFFFFFFFFFFFFFF", 0);
    deadline = sent + CO_MS(10);
    ck_assert_int_eq(bus_wait(reader, deadline), CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
    if (clock_now() < sent + CO_MS(126)) /* but for a very busy machine */
        ck_assert_int_eq(bus_receive(reader, &rx), CO_ERR_AGAIN);
    ck_assert_uint_eq(wait_for_frame(reader).frame.id, 0x7FF);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

START_TEST(wake_ends_a_wait_for_the_wire)
{
    struct bus *sender, *reader;

    fixture_choose_bitrate(1000);
    sender = fixture_open(false);
    reader = fixture_open(false);
    fixture_send(sender, "7FF#FFFFFFFFFFFFFFFF", 0);
    bus_wake(reader);
    ck_assert_int_eq(bus_wait(reader, CO_NEVER), CO_OK);
    ck_assert_int_eq(bus_wait(reader, CO_NEVER), CO_OK);
    ck_assert_uint_eq(wait_for_frame(reader).frame.id, 0x7FF);
    bus_close(sender);
    bus_close(reader);
}
END_TEST

#define ROUNDS 3000u

static void *answer_all(void *context)
{
    for (uint32_t n = 0; n < ROUNDS; n++) {
        wait_for_frame(context);
        fixture_send_number(context, n);
    }
    return NULL;
}

/*
 * Each frame finds the other one asleep, or about to be. A missed wake-up is seen by its price: a
 * second, until the sleeper looks for itself.
 */
START_TEST(no_sleeper_is_forgotten)
{
    struct bus *bus, *other;
    unsigned missed = 0;
    pthread_t thread;

    fixture_choose_bitrate(1000000);
    bus = fixture_open(false);
    other = fixture_open(false);
    ck_assert_int_eq(pthread_create(&thread, NULL, answer_all, other), 0);
    for (uint32_t n = 0; n < ROUNDS; n++) {
        co_us_t start = clock_now();
        struct bus_rx rx;

        for (volatile unsigned delay = n % 100 * 100; delay > 0; delay--)
            ;
        fixture_send_number(bus, n);
        rx = wait_for_frame(bus);
        ck_assert_uint_eq(fixture_number_of(&rx), n);
        missed += clock_now() - start > CO_MS(950);
        ck_assert_uint_lt(missed, 3); /* a very busy machine can take a second, too */
    }
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    bus_close(bus);
    bus_close(other);
}
END_TEST

static co_us_t cpu_time(long *ret_switches)
{
    struct rusage usage;

    ck_assert_int_eq(getrusage(RUSAGE_SELF, &usage), 0);
    *ret_switches = usage.ru_nvcsw;
    return (co_us_t)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) * 1000000u +
           (co_us_t)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* Once with nothing ever sent, once with all frames through. */
START_TEST(an_idle_bus_costs_nothing)
{
    struct bus *sender, *reader;
    long before, after;
    co_us_t cpu;

    fixture_choose_bitrate(1000000);
    sender = fixture_open(false);
    reader = fixture_open(false);
    for (unsigned i = 0; i < 2; i++) {
        cpu = cpu_time(&before);
        ck_assert_int_eq(bus_wait(reader, clock_now() + CO_MS(300)), CO_ERR_TIMEOUT);
        ck_assert_uint_lt(cpu_time(&after) - cpu, CO_MS(20));
        ck_assert_int_le(after - before, 5); /* it went to sleep that often */
        fixture_send(sender, "123#", 0);
        wait_for_frame(reader);
    }
    bus_close(sender);
    bus_close(reader);
}
END_TEST

static Suite *suite_of_all(void)
{
    Suite *suite = suite_create("bus_bitrate");
    TCase *tests = tcase_create("one process");

    tcase_set_timeout(tests, 100);
    tcase_add_checked_fixture(tests, fixture_remove_file, NULL);
    tcase_add_loop_test(tests, what_is_no_rate_or_not_the_networks_is_refused, 0,
                        sizeof refused / sizeof refused[0]);
    tcase_add_loop_test(tests, rates_are_taken, 0, sizeof accepted / sizeof accepted[0]);
    tcase_add_loop_test(tests, all_have_the_rate_of_the_first, 0,
                        sizeof mismatches / sizeof mismatches[0]);
    tcase_add_test(tests, the_bus_tells_its_rate);
    tcase_add_test(tests, the_backlog_waits_for_the_wire);
    tcase_add_test(tests, a_frame_comes_at_the_end_of_its_time);
    tcase_add_test(tests, nobody_sees_a_frame_before);
    tcase_add_loop_test(tests, frames_follow_each_other_without_a_gap, 0,
                        sizeof rates / sizeof rates[0]);
    tcase_add_test(tests, a_full_queue_says_so_and_empties);
    tcase_add_test(tests, a_newcomer_hears_nothing_of_before);
    tcase_add_test(tests, wait_ends_at_its_deadline_before_the_frame);
    tcase_add_test(tests, wake_ends_a_wait_for_the_wire);
    tcase_add_test(tests, no_sleeper_is_forgotten);
    tcase_add_test(tests, an_idle_bus_costs_nothing);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner;
    int failed;

    fixture_choose_name();
    runner = srunner_create(suite_of_all());
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    fixture_remove_file();
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

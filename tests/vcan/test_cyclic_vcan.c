/*
 * Frames that the kernel sends by itself, on a real vcan0, which tests/vcan/run.sh provides in a
 * place of its own.
 */
#include "port/clock.h"
#include "support/suite.h"
#include "support/vcan.h"

#define SHORT CO_MS(2)
#define LONG  CO_MS(3600000)

static struct co_frame syncs[BUS_CYCLIC_MAX];
static struct bus *bus, *other;

static void set_up(void)
{
    for (unsigned i = 0; i < BUS_CYCLIC_MAX; i++) {
        syncs[i] = co_frame_make(0x80, 1);
        syncs[i].data[0] = (uint8_t)(i + 1);
    }
    bus = vcan_open("vcan0", true);
    other = vcan_open("vcan0", false);
}

static void tear_down(void)
{
    bus_close(bus);
    bus_close(other);
}

/* The next SYNC with this counter; its time. */
static co_us_t expect_sync(struct bus *reader, unsigned counter)
{
    struct bus_rx rx = vcan_receive(reader);

    ck_assert_uint_eq(rx.frame.id, 0x80);
    ck_assert_uint_eq(rx.frame.dlc, 1);
    ck_assert_uint_eq(rx.frame.data[0], counter);
    ck_assert_uint_eq(rx.frame.flags, 0); /* not an own one */
    ck_assert_uint_eq(rx.frame.tag, 0);
    ck_assert_uint_eq(rx.lost, 0);
    return rx.time;
}

static void expect_silence(struct bus *reader)
{
    struct bus_rx rx;

    while (bus_receive(reader, &rx) == CO_OK)
        ;
    ck_assert_int_eq(bus_wait(reader, clock_now() + 10 * SHORT), CO_ERR_TIMEOUT);
}

START_TEST(all_counters_in_turn)
{
    co_us_t begin, end = 0;

    ck_assert_int_eq(bus_set_cyclic(bus, syncs, BUS_CYCLIC_MAX, SHORT), CO_OK);
    begin = expect_sync(other, 1);
    for (unsigned i = 1; i < BUS_CYCLIC_MAX + 10; i++)
        end = expect_sync(other, i % BUS_CYCLIC_MAX + 1);
    ck_assert_uint_ge(end - begin + CO_MS(5), (BUS_CYCLIC_MAX + 9) * SHORT);
    for (unsigned i = 0; i < BUS_CYCLIC_MAX + 10; i++) /* who has begun it hears them, too */
        expect_sync(bus, i % BUS_CYCLIC_MAX + 1);
}
END_TEST

START_TEST(the_first_one_comes_at_once)
{
    for (unsigned i = 0; i < 3; i++) {
        ck_assert_int_eq(bus_set_cyclic(bus, syncs, 3, LONG), CO_OK);
        expect_sync(other, 1);
        vcan_expect_nothing(other);
    }
    ck_assert_int_eq(bus_wait(other, clock_now() + CO_MS(20)), CO_ERR_TIMEOUT);
}
END_TEST

START_TEST(another_period)
{
    co_us_t begin, end = 0;

    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 3, LONG), CO_OK);
    expect_sync(other, 1);
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 4, SHORT), CO_OK);
    for (unsigned i = 0; i < 6; i++)
        expect_sync(other, i % 4 + 1);
    ck_assert_int_eq(bus_set_cyclic(bus, &syncs[100], 2, 20 * SHORT), CO_OK);
    while (vcan_receive(other).frame.data[0] != 101) /* late ones of before */
        ;
    begin = expect_sync(other, 102);
    for (unsigned i = 0; i < 3; i++)
        end = expect_sync(other, 101 + i % 2);
    ck_assert_uint_ge(end - begin + CO_MS(5), 3 * 20 * SHORT);
}
END_TEST

START_TEST(it_ends)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 2, SHORT), CO_OK);
    expect_sync(other, 1);
    ck_assert_int_eq(bus_set_cyclic(bus, NULL, 0, 0), CO_OK);
    expect_silence(other);
}
END_TEST

START_TEST(it_ends_with_the_bus)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, 2, SHORT), CO_OK);
    expect_sync(other, 1);
    bus_close(bus);
    expect_silence(other);
    bus = vcan_open("vcan0", true);
    expect_silence(other);
}
END_TEST

/* --- the interface comes and goes --- */

static void begin_on_vcan8(void)
{
    bus_close(bus);
    bus_close(other);
    vcan_run("ip link add vcan8 type vcan && ip link set vcan8 up");
    bus = vcan_open("vcan8", true);
    other = vcan_open("vcan8", false);
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, BUS_CYCLIC_MAX, SHORT), CO_OK);
    for (unsigned i = 0; i < 5; i++)
        expect_sync(other, i + 1);
}

/* The connection was lost, and is back. */
static void wait_back(struct bus *reader)
{
    co_us_t deadline = clock_now() + VCAN_PATIENCE;
    struct bus_rx rx;

    do {
        while (bus_receive(reader, &rx) == CO_OK)
            ;
        ck_assert_int_eq(bus_wait(reader, deadline), CO_OK);
    } while (bus_outages(reader) == 0 || bus_get_state(reader) != BUS_ACTIVE);
}

/* From the first one on, whatever the kernel has sent before the bus had heard of the end. */
static void expect_begin(struct bus *reader)
{
    struct bus_rx rx;

    do
        rx = vcan_receive(reader);
    while (rx.frame.data[0] != 1);
    for (unsigned i = 1; i < 5; i++)
        expect_sync(reader, i + 1);
}

START_TEST(down_and_up)
{
    begin_on_vcan8();
    vcan_run("ip link set vcan8 down");
    vcan_wait_state(bus, BUS_DOWN);
    vcan_wait_state(other, BUS_DOWN);
    vcan_run("ip link set vcan8 up");
    vcan_wait_state(other, BUS_ACTIVE);
    expect_silence(other); /* until the owner has heard of it */
    vcan_wait_state(bus, BUS_ACTIVE);
    expect_sync(other, 1);
    expect_sync(other, 2);
    vcan_run("ip link del vcan8");
}
END_TEST

START_TEST(down_and_up_unseen)
{
    begin_on_vcan8();
    vcan_run("ip link set vcan8 down && ip link set vcan8 up");
    wait_back(other);
    wait_back(bus);
    expect_begin(other);
    vcan_run("ip link del vcan8");
}
END_TEST

START_TEST(removed_and_made_again)
{
    begin_on_vcan8();
    vcan_run("ip link del vcan8");
    vcan_wait_state(bus, BUS_DOWN);
    vcan_wait_state(other, BUS_DOWN);
    vcan_run("ip link add vcan8 type vcan && ip link set vcan8 up");
    vcan_wait_state(other, BUS_ACTIVE);
    vcan_wait_state(bus, BUS_ACTIVE);
    expect_sync(other, 1);
    expect_sync(other, 2);
    vcan_run("ip link del vcan8");
}
END_TEST

START_TEST(bus_off)
{
    ck_assert_int_eq(bus_set_cyclic(bus, syncs, BUS_CYCLIC_MAX, SHORT), CO_OK);
    expect_sync(other, 1);
    vcan_run("cansend vcan0 20000040#0000000000000000");
    vcan_wait_state(bus, BUS_OFF);
    vcan_wait_state(other, BUS_OFF);
    expect_silence(other);
    vcan_run("cansend vcan0 20000100#0000000000000000");
    vcan_wait_state(bus, BUS_ACTIVE);
    expect_sync(other, 1);
    expect_sync(other, 2);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("vcan0");

    tcase_set_timeout(tests, 50);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, all_counters_in_turn);
    tcase_add_test(tests, the_first_one_comes_at_once);
    tcase_add_test(tests, another_period);
    tcase_add_test(tests, it_ends);
    tcase_add_test(tests, it_ends_with_the_bus);
    tcase_add_test(tests, down_and_up);
    tcase_add_test(tests, down_and_up_unseen);
    tcase_add_test(tests, removed_and_made_again);
    tcase_add_test(tests, bus_off);
    return suite_run("cyclic_vcan", tests);
}

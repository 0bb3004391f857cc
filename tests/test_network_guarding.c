/* A device behind a network on a virtual bus: which remote frames reach it, and what it answers. */
#include "runtime/network.h"

#include "port/clock.h"
#include "support/bus_fixture.h"
#include "support/suite.h"

#include <check.h>
#include <stdlib.h>

#define NODE 5

static struct od od;
static struct slave slave;
static struct network *network;
static struct bus *peer;

static void expect(const char *text)
{
    ck_assert_int_eq(bus_wait(peer, clock_now() + CO_MS(5000)), CO_OK);
    fixture_expect(peer, text);
}

static void set_up(void)
{
    const struct network_options options = { .bus = fixture_name(), .bitrate = 500 };
    char message[200];

    fixture_remove_file();
    od_init(&od);
    ck_assert_int_eq(slave_init(&slave, NODE, &od), CO_OK);
    peer = fixture_open(false);
    ck_assert_int_eq(network_open(&options, &network, message, sizeof message), CO_OK);
    ck_assert_int_eq(network_add_slave(network, &slave), CO_OK);
    ck_assert_int_eq(network_start(network), CO_OK);
    expect("705#00");
}

static void tear_down(void)
{
    network_close(network);
    bus_close(peer);
    slave_done(&slave);
    od_done(&od);
}

/* Remote frames are let in where guarding needs them. */
START_TEST(a_device_is_guarded)
{
    fixture_send(peer, "705#R1", 0);
    expect("705#7F");
    fixture_send(peer, "705#R0", 0);
    expect("705#FF");
}
END_TEST

START_TEST(other_remote_frames_are_nobodys)
{
    static const char *const frames[] = { "000#R2", "605#R8", "704#R1", "00000705#R1", "085#R" };

    for (size_t i = 0; i < sizeof frames / sizeof frames[0]; i++)
        fixture_send(peer, frames[i], 0);
    fixture_send(peer, "605#4000100000000000", 0); /* answered behind the others */
    expect("585#4300100000000000");
    fixture_expect_nothing(peer);
}
END_TEST

START_TEST(commands_are_in_order)
{
    fixture_send(peer, "000#0105", 0);
    fixture_send(peer, "705#R1", 0);
    fixture_send(peer, "000#0205", 0);
    fixture_send(peer, "705#R1", 0);
    expect("705#05");
    expect("705#84");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("network_guarding");

    fixture_choose_name();
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, a_device_is_guarded);
    tcase_add_test(tcase, other_remote_frames_are_nobodys);
    tcase_add_test(tcase, commands_are_in_order);
    return suite_run("network_guarding", tcase);
}

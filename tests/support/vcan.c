#include "support/vcan.h"

#include "port/bus_socketcan.h"
#include "port/clock.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>

bool vcan_has_io_uring(void)
{
    struct io_ring ring;
    bool has_one = io_ring_open(&ring, 8, io_ring_setup) == CO_OK;

    io_ring_close(&ring);
    if (!has_one)
        printf("not run by io_uring: this kernel has none for us\n");
    return has_one;
}

/* Without it the bus would go on by poll(). */
static int set_up_ring(unsigned entries, struct io_uring_params *params)
{
    int fd = io_ring_setup(entries, params);

    ck_assert_int_ge(fd, 0);
    return fd;
}

static struct socketcan_calls calls; /* NULL in them: none was chosen */

void vcan_choose(bool io_uring)
{
    calls = socketcan_system_calls;
    calls.io_uring_setup = io_uring ? set_up_ring : NULL;
}

struct bus *vcan_open(const char *name, bool own_frames)
{
    const struct bus_options options = { .own_frames = own_frames };
    char text[200] = "";
    const struct bus_message message = { text, sizeof text };
    const struct socketcan_calls *chosen = calls.socket ? &calls : &socketcan_system_calls;
    struct bus *bus = NULL;
    enum co_err err = bus_socketcan_open_with(chosen, name, &options, &bus, &message);

    ck_assert_msg(err == CO_OK, "%s", text);
    return bus;
}

void vcan_run(const char *command)
{
    ck_assert_msg(system(command) == 0, "%s", command);
}

enum co_err vcan_send(struct bus *bus, const char *text, uint8_t tag)
{
    struct co_frame frame;

    ck_assert(co_frame_parse(text, &frame));
    frame.tag = tag;
    return bus_send(bus, &frame);
}

struct bus_rx vcan_receive(struct bus *bus)
{
    co_us_t deadline = clock_now() + VCAN_PATIENCE;
    struct bus_rx rx = { .lost = 0 };

    while (bus_receive(bus, &rx) == CO_ERR_AGAIN)
        ck_assert_int_eq(bus_wait(bus, deadline), CO_OK);
    return rx;
}

struct bus_rx vcan_expect(struct bus *bus, const char *text)
{
    struct bus_rx rx = vcan_receive(bus);
    char got[CO_FRAME_TEXT_SIZE];

    ck_assert_str_eq(co_frame_format(&rx.frame, got, sizeof got), text);
    return rx;
}

void vcan_expect_nothing(struct bus *bus)
{
    struct bus_rx rx;

    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
}

void vcan_wait_state(struct bus *bus, enum bus_state state)
{
    co_us_t deadline = clock_now() + VCAN_PATIENCE;
    struct bus_rx rx;

    while (bus_get_state(bus) != state) {
        while (bus_receive(bus, &rx) == CO_OK)
            ;
        if (bus_get_state(bus) != state)
            ck_assert_int_eq(bus_wait(bus, deadline), CO_OK);
    }
}

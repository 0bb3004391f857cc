#include "support/vcan.h"

#include "port/clock.h"

#include <check.h>
#include <stdlib.h>

struct bus *vcan_open(const char *name, bool own_frames)
{
    const struct bus_options options = { .own_frames = own_frames };
    char message[200] = "";
    struct bus *bus = NULL;
    enum co_err err = bus_open(name, &options, &bus, message, sizeof message);

    ck_assert_msg(err == CO_OK, "%s", message);
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

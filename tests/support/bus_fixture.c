#include "support/bus_fixture.h"

#include <check.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static char run_name[64];
static char run_path[80];

const char *fixture_name(void)
{
    return run_name;
}

const char *fixture_path(void)
{
    return run_path;
}

void fixture_choose_name(void)
{
    snprintf(run_name, sizeof run_name, "virtual:test-%d", (int)getpid());
    snprintf(run_path, sizeof run_path, "/dev/shm/mcanopen-%u-test-%d", (unsigned)geteuid(),
             (int)getpid());
}

void fixture_choose_bitrate(unsigned bitrate)
{
    size_t length = strcspn(run_name, "?");

    run_name[length] = '\0';
    if (bitrate != 0)
        snprintf(run_name + length, sizeof run_name - length, "?bitrate=%u", bitrate);
}

void fixture_remove_file(void)
{
    unlink(run_path);
}

struct bus *fixture_open(bool own_frames)
{
    const struct bus_options options = { .own_frames = own_frames };
    char message[200] = "";
    struct bus *bus = NULL;
    enum co_err err = bus_open(run_name, &options, &bus, message, sizeof message);

    ck_assert_msg(err == CO_OK, "%s", message);
    return bus;
}

enum co_err fixture_try_open(const char *name, char *message, size_t size)
{
    const struct bus_options options = { .own_frames = false };
    struct bus *bus = NULL;
    enum co_err err = bus_open(name, &options, &bus, message, size);

    bus_close(bus);
    return err;
}

void fixture_send(struct bus *bus, const char *text, uint8_t tag)
{
    struct co_frame frame;

    ck_assert(co_frame_parse(text, &frame));
    frame.tag = tag;
    ck_assert_int_eq(bus_send(bus, &frame), CO_OK);
}

void fixture_send_number(struct bus *bus, uint32_t number)
{
    struct co_frame frame = co_frame_make(0x123, 4);

    memcpy(frame.data, &number, sizeof number);
    ck_assert_int_eq(bus_send(bus, &frame), CO_OK);
}

uint32_t fixture_number_of(const struct bus_rx *rx)
{
    uint32_t number;

    memcpy(&number, rx->frame.data, sizeof number);
    return number;
}

struct bus_rx fixture_expect(struct bus *bus, const char *text)
{
    struct bus_rx rx = { .lost = 0 };
    char got[CO_FRAME_TEXT_SIZE];

    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_str_eq(co_frame_format(&rx.frame, got, sizeof got), text);
    return rx;
}

void fixture_expect_nothing(struct bus *bus)
{
    struct bus_rx rx;

    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
}

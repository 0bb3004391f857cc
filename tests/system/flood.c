/*
 * flood BUS COUNT FRAME ...: sends the frames in turn, COUNT in all, eight each millisecond: about
 * what a bus at 1 Mbit/s can carry. "flooding" on stdout when it has begun.
 */
#include "port/bus.h"
#include "port/clock.h"

#include <stdio.h>
#include <stdlib.h>

#define BURST 8u

static int flood(struct bus *bus, unsigned long count, char **texts, unsigned text_count)
{
    enum co_err err = CO_OK;
    struct co_frame frame;
    co_us_t next = clock_now();

    for (unsigned long i = 0; i < count; i++) {
        if (!co_frame_parse(texts[i % text_count], &frame))
            return EXIT_FAILURE;
        do
            err = bus_send(bus, &frame);
        while (err == CO_ERR_AGAIN);
        if (err != CO_OK)
            return EXIT_FAILURE;
        if (i == BURST) {
            printf("flooding\n");
            fflush(stdout);
        }
        if (i % BURST == 0)
            bus_wait(bus, next += CO_MS(1)); /* frames that come are no matter */
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    const struct bus_options options = { .own_frames = false };
    const struct bus_filter nothing = { .id = 0x7FF, .mask = 0x7FF };
    char message[512] = "";
    struct bus *bus = NULL;
    int result;

    if (argc < 4 || bus_open(argv[1], &options, &bus, message, sizeof message) != CO_OK ||
        bus_set_filters(bus, &nothing, 1) != CO_OK) {
        fprintf(stderr, "flood: %s\n", message);
        return EXIT_FAILURE;
    }
    result = flood(bus, strtoul(argv[2], NULL, 10), argv + 3, (unsigned)argc - 3);
    bus_close(bus);
    return result;
}

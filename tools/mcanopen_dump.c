/*
 * mcanopen dump: the frames of a bus in candump's log format.
 */
#include "verbs.h"

#include "port/bus.h"
#include "port/clock.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>

static const char usage[] =
    "usage: mcanopen dump [options] BUS\n"
    "\n"
    "Prints each frame as \"(seconds) BUS ID#DATA\", the log format of candump -L.\n"
    "The time is that of the monotonic clock.\n"
    "\n"
    "  -n, --count N    end after N frames\n"
    "  -h, --help       this text\n"
    "\n"
    "Exit codes: 0 ended by -n, 2 usage, 3 bus error.\n";

static void print(const char *bus, const struct bus_rx *rx)
{
    char text[CO_FRAME_TEXT_SIZE];

    if (rx->lost)
        fprintf(stderr, "mcanopen dump: %u frames lost\n", rx->lost);
    printf("(%llu.%06llu) %s %s\n", (unsigned long long)(rx->time / 1000000u),
           (unsigned long long)(rx->time % 1000000u), bus,
           co_frame_format(&rx->frame, text, sizeof text));
    fflush(stdout);
}

static int dump(struct bus *bus, const char *name, unsigned long count)
{
    struct bus_rx rx;
    enum co_err err = CO_OK;

    for (unsigned long i = 0; count == 0 || i < count;) {
        err = bus_receive(bus, &rx);
        if (err == CO_ERR_AGAIN)
            err = bus_wait(bus, CO_NEVER);
        else if (err == CO_OK && ++i)
            print(name, &rx);
        if (err != CO_OK) {
            fprintf(stderr, "%s: %s\n", name, co_err_text(err));
            return EXIT_BUS;
        }
    }
    return EXIT_UP;
}

int verb_dump(int argc, char **argv)
{
    static const struct option options[] = { { "count", required_argument, NULL, 'n' },
                                             { "help", no_argument, NULL, 'h' },
                                             { NULL, 0, NULL, 0 } };
    struct bus_options bus_options = { .own_frames = false };
    unsigned long count = 0;
    char message[512] = "";
    struct bus *bus;
    int option, result;

    while ((option = getopt_long(argc, argv, "n:h", options, NULL)) != -1) {
        if (option == 'n') {
            count = strtoul(optarg, NULL, 10);
        } else {
            fputs(usage, option == 'h' ? stdout : stderr);
            return option == 'h' ? EXIT_UP : EXIT_USAGE;
        }
    }
    if (optind + 1 != argc) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    if (bus_open(argv[optind], &bus_options, &bus, message, sizeof message) != CO_OK) {
        fprintf(stderr, "mcanopen dump: %s\n", message);
        return EXIT_BUS;
    }
    result = dump(bus, argv[optind], count);
    bus_close(bus);
    return result;
}

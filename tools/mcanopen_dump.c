/*
 * mcanopen dump: the frames of a bus in candump's log format.
 */
#include "verbs.h"

#include "port/bus.h"
#include "port/thread.h"

#include <getopt.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/signalfd.h>
#include <unistd.h>

static const char usage[] =
    "Usage: mcanopen dump [OPTION]... BUS\n"
    "\n"
    "Prints each frame as \"(seconds) BUS ID#DATA\", the log format of candump -L.\n"
    "The time is that of the monotonic clock. Tells on stderr when it listens. Ctrl-C ends it,\n"
    "with all printed that came until then. On \"virtual:NAME?bitrate=N\" the time is that at "
    "which\n"
    "the wire was free again after the frame.\n"
    "\n"
    "  -n, --count N    end after N frames\n"
    "  -h, --help       shows this\n"
    "  --version        shows the version\n"
    "\n"
    "Exit codes: 0 ended by -n or Ctrl-C, 2 usage, 3 bus error.\n";

struct dump {
    const char *name;
    unsigned long count; /* 0: without end */
    struct bus *bus;
    int signals;
    atomic_bool interrupted;
    struct co_thread watcher;
};

/* A signal, or end() at the end, ends the wait for frames. */
static void *watch_signals(void *context)
{
    struct dump *self = context;
    struct signalfd_siginfo info;
    ssize_t size = read(self->signals, &info, sizeof info);

    (void)size;
    atomic_store(&self->interrupted, true);
    bus_wake(self->bus);
    return NULL;
}

static void end(struct dump *self)
{
    kill(getpid(), SIGTERM); /* blocked: it only reaches the watcher */
    thread_join(&self->watcher);
    close(self->signals);
    bus_close(self->bus);
}

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

static int dump(struct dump *self)
{
    struct bus_rx rx;
    bool last = false; /* what is there when the signal came is printed still */

    for (unsigned long i = 0; self->count == 0 || i < self->count;) {
        enum co_err err = bus_receive(self->bus, &rx);

        if (err == CO_OK && ++i)
            print(self->name, &rx);
        if (err == CO_ERR_AGAIN && last)
            break;
        if (err == CO_ERR_AGAIN) {
            last = atomic_load(&self->interrupted);
            err = last ? CO_OK : bus_wait(self->bus, CO_NEVER);
        }
        if (err != CO_OK) {
            fprintf(stderr, "%s: %s\n", self->name, co_err_text(err));
            return EXIT_BUS;
        }
    }
    return EXIT_UP;
}

static int listen_to_bus(struct dump *self)
{
    struct bus_options options = { .own_frames = false };
    char message[512] = "";
    int result;

    if (bus_open(self->name, &options, &self->bus, message, sizeof message) != CO_OK) {
        fprintf(stderr, "mcanopen dump: %s\n", message);
        return EXIT_BUS;
    }
    self->signals = stop_signals();
    if (self->signals < 0 ||
        thread_start(&self->watcher, "signals", watch_signals, self) != CO_OK) {
        fprintf(stderr, "mcanopen dump: out of resources\n");
        bus_close(self->bus);
        return EXIT_BUS;
    }
    fprintf(stderr, "mcanopen dump: listening on %s\n", self->name);
    result = dump(self);
    end(self);
    return result;
}

static bool parse_count(const char *text, unsigned long *ret_count)
{
    char *end;

    *ret_count = strtoul(text, &end, 10);
    return text[0] != '-' && *ret_count > 0 && *end == '\0';
}

int verb_dump(int argc, char **argv)
{
    static const struct option options[] = { { "count", required_argument, NULL, 'n' },
                                             { "help", no_argument, NULL, 'h' },
                                             { NULL, 0, NULL, 0 } };
    struct dump self = { .count = 0 };
    int option;

    while ((option = getopt_long(argc, argv, "n:h", options, NULL)) != -1) {
        if (option == 'n') {
            if (parse_count(optarg, &self.count))
                continue;
            fprintf(stderr, "mcanopen dump: -n %s: expected a number, more than 0\n", optarg);
            return EXIT_USAGE;
        } else {
            fputs(usage, option == 'h' ? stdout : stderr);
            return option == 'h' ? EXIT_UP : EXIT_USAGE;
        }
    }
    if (optind + 1 != argc) {
        fputs(usage, stderr);
        return EXIT_USAGE;
    }
    self.name = argv[optind];
    return listen_to_bus(&self);
}

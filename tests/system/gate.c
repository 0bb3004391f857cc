/*
 * gate A B FRAME [N]: hands the frames of bus A to bus B and back. The first, or the N-th, that
 * begins like FRAME stops at the gate: "at FRAME" on stdout, then it waits for a line on stdin and
 * lets it pass. So a test can do something while one device, alone on bus B, is at a certain step.
 * Ended by a signal.
 */
#include "port/bus.h"
#include "port/thread.h"

#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct way {
    struct bus *from, *to;
};

static const char *held;
static atomic_int until_held = 1;

static void hold(const struct co_frame *frame)
{
    char text[CO_FRAME_TEXT_SIZE], line[16];

    co_frame_format(frame, text, sizeof text);
    if (strncmp(text, held, strlen(held)) != 0 || atomic_fetch_sub(&until_held, 1) != 1)
        return;
    printf("at %s\n", text);
    fflush(stdout);
    if (!fgets(line, sizeof line, stdin))
        exit(EXIT_SUCCESS); /* the test has ended */
}

/* The bus is full, or has a participant that was stopped in the middle of a frame. */
static bool is_passing(enum co_err err)
{
    return err == CO_ERR_AGAIN || err == CO_ERR_HELD;
}

static enum co_err hand_on(struct bus *to, const struct co_frame *frame)
{
    enum co_err err;

    while (is_passing(err = bus_send(to, frame)))
        sched_yield();
    return err;
}

static void *run(void *context)
{
    const struct way *way = context;
    enum co_err err = CO_OK;
    struct bus_rx rx;

    while (err == CO_OK || is_passing(err)) {
        err = bus_receive(way->from, &rx);
        if (err == CO_OK) {
            hold(&rx.frame);
            err = hand_on(way->to, &rx.frame);
        } else if (is_passing(err)) {
            err = bus_wait(way->from, CO_NEVER);
        }
    }
    fprintf(stderr, "gate: %s\n", co_err_text(err));
    exit(EXIT_FAILURE);
}

static struct bus *open_bus(const char *name)
{
    const struct bus_options options = { .own_frames = false };
    char message[512] = "";
    struct bus *bus = NULL;

    if (bus_open(name, &options, &bus, message, sizeof message) != CO_OK) {
        fprintf(stderr, "gate: %s\n", message);
        exit(EXIT_FAILURE);
    }
    return bus;
}

int main(int argc, char **argv)
{
    struct way to, back;
    struct co_thread thread;

    if (argc != 4 && argc != 5)
        return EXIT_FAILURE;
    held = argv[3];
    if (argc == 5)
        until_held = atoi(argv[4]);
    to = (struct way){ open_bus(argv[1]), open_bus(argv[2]) };
    back = (struct way){ to.to, to.from };
    if (thread_start(&thread, "back", run, &back) != CO_OK)
        return EXIT_FAILURE;
    printf("open\n");
    fflush(stdout);
    run(&to);
    return EXIT_FAILURE;
}

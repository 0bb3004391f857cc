/*
 * Conversations with a machine, written in tables that read like a candump log:
 *
 *     { "wrong toggle bit", {
 *         { 0, CALL, "read 1008:00 16" },          its owner calls the machine
 *         { 0, SENT, "605#4008100000000000" },     the machine sends
 *         { 2, GOT,  "585#4108100009000000" },     the machine receives
 *         { 2, SENT, "605#6000000000000000" },
 *         { 4, GOT,  "585#1031323334353637" },
 *         { 4, SENT, "605#8008100000000305" },
 *         { 4, TOLD, "toggle 05030000 0" } } },    an event, as the test describes it
 *
 * Time is virtual, in ms from the start of the conversation. The machine's timer is called exactly
 * when it is due, and in addition one microsecond earlier, where nothing may happen. Every frame
 * and every event has to be in the table, with its time: what is not there must not come. A frame
 * that is received when the timer is due comes first.
 *
 * With a stalled outbox each call meets an outbox without room first, which opens right after: the
 * conversation must be the same.
 */
#ifndef TEST_SUPPORT_TALK_H
#define TEST_SUPPORT_TALK_H

#include "base/outbox.h"
#include "base/time.h"

#define TALK_LINES_MAX 48

enum talk_verb {
    END,   /* of the table */
    CALL,  /* something that the owner does, see talk_machine.call */
    GOT,   /* a frame from another device */
    ECHO,  /* an own frame comes back from the bus; text NULL: the one sent last */
    SENT,  /* a frame that the machine sends */
    TOLD,  /* an event */
    QUIET, /* nothing happens up to this time, and in it */
    IDLE   /* the same, and the machine has no deadline */
};

struct talk_line {
    unsigned at; /* ms */
    enum talk_verb verb;
    const char *text;
};

struct talk {
    const char *name;
    struct talk_line lines[TALK_LINES_MAX];
};

/* The machine under test; a call that returns false found no room and is made again. */
struct talk_machine {
    void *self;
    bool (*call)(void *self, const char *text, co_us_t now, struct co_outbox *out);
    bool (*on_frame)(void *self, const struct co_frame *frame, co_us_t now, struct co_outbox *out);
    void (*on_time)(void *self, co_us_t now, struct co_outbox *out);
    co_us_t (*deadline)(const void *self);
    void (*describe)(void *self, const struct co_event *event, char *text, size_t size);
};

enum talk_stall { TALK_OPEN, TALK_NO_FRAMES, TALK_NO_EVENTS, TALK_CLOSED };
#define TALK_STALLS 4

/* Fails the running test at the first line that is not as written. */
void talk_run(const struct talk *self, const struct talk_machine *machine, enum talk_stall stall);

/* Parses a frame of a test, which has to be right. */
struct co_frame talk_frame(const char *text);

#endif

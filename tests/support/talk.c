#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define OUT_MAX  8
#define TEXT_MAX 700
#define PATIENCE 1000 /* calls of on_time at one instant, before it counts as hanging */

struct run {
    const struct talk *talk;
    const struct talk_machine *machine;
    enum talk_stall stall;
    const struct talk_line *line; /* the next one */
    co_us_t now;
    struct co_frame last; /* sent last */
    struct co_outbox out;
    struct co_frame frames[OUT_MAX];
    struct co_event events[OUT_MAX];
};

struct co_frame talk_frame(const char *text)
{
    struct co_frame frame = { .id = 0 };

    if (!co_frame_parse(text, &frame))
        ck_abort_msg("\"%s\" is no frame", text);
    return frame;
}

static void complain(const struct run *self, const char *what, const char *text)
{
    const struct talk_line *line = self->line;

    ck_abort_msg("\"%s\", outbox %d, line %d (%u ms, %s): %s %s at %u.%03u ms", self->talk->name,
                 (int)self->stall, (int)(line - self->talk->lines), line->at,
                 line->text ? line->text : "-", what, text, (unsigned)(self->now / 1000),
                 (unsigned)(self->now % 1000));
}

static void expect(struct run *self, enum talk_verb verb, const char *text)
{
    const struct talk_line *line = self->line;

    if (line->verb != verb || CO_MS(line->at) != self->now || strcmp(line->text, text) != 0)
        complain(self, verb == SENT ? "sent" : "told", text);
    self->line++;
}

static void drain(struct run *self)
{
    char text[TEXT_MAX];
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &self->last))
        expect(self, SENT, co_frame_format(&self->last, text, sizeof text));
    while (co_outbox_take_event(&self->out, &event)) {
        self->machine->describe(self->machine->self, &event, text, sizeof text);
        expect(self, TOLD, text);
    }
}

static void set_room(struct run *self, enum talk_stall stall)
{
    co_outbox_init(&self->out, self->frames,
                   stall == TALK_NO_FRAMES || stall == TALK_CLOSED ? 0 : OUT_MAX, self->events,
                   stall == TALK_NO_EVENTS || stall == TALK_CLOSED ? 0 : OUT_MAX);
}

/* Calls the timer while it is due at this instant. */
static void settle(struct run *self)
{
    const struct talk_machine *machine = self->machine;

    drain(self);
    for (unsigned i = 0; machine->deadline(machine->self) <= self->now; i++) {
        if (i > PATIENCE)
            complain(self, "hangs", "");
        machine->on_time(machine->self, self->now, &self->out);
        drain(self);
    }
}

/* As settle(), but at first without room: the machine must stay due, and do the same later. */
static void stalled_settle(struct run *self)
{
    const struct talk_machine *machine = self->machine;

    set_room(self, self->stall);
    if (machine->deadline(machine->self) <= self->now)
        machine->on_time(machine->self, self->now, &self->out);
    drain(self);
    set_room(self, TALK_OPEN);
    settle(self);
}

static void check_too_early(struct run *self, co_us_t deadline)
{
    const struct talk_machine *machine = self->machine;

    if (deadline <= self->now)
        return;
    self->now = deadline - 1;
    machine->on_time(machine->self, self->now, &self->out);
    drain(self);
    if (machine->deadline(machine->self) != deadline)
        complain(self, "moved its deadline", "too early");
}

/* Lets the time pass, with what is due on the way; what is due at its end only if asked for. */
static void pass_time(struct run *self, co_us_t until, bool inclusive)
{
    const struct talk_machine *machine = self->machine;
    co_us_t due = machine->deadline(machine->self);

    while (due < until || (inclusive && due == until)) {
        check_too_early(self, due);
        self->now = due > self->now ? due : self->now;
        stalled_settle(self);
        due = machine->deadline(machine->self);
    }
    if (until > self->now)
        self->now = until;
}

static bool do_line(struct run *self, const struct talk_line *line)
{
    const struct talk_machine *machine = self->machine;
    struct co_frame frame = self->last;

    if (line->verb == CALL)
        return machine->call(machine->self, line->text, self->now, &self->out);
    if (line->text)
        frame = talk_frame(line->text);
    if (line->verb == ECHO)
        frame.flags |= CO_FRAME_OWN;
    return machine->on_frame(machine->self, &frame, self->now, &self->out);
}

/* A line in which the machine is called. */
static void act(struct run *self)
{
    const struct talk_line *line = self->line++;

    set_room(self, self->stall);
    if (!do_line(self, line)) {
        set_room(self, TALK_OPEN);
        if (!do_line(self, line))
            complain(self, "refused", line->text);
    }
    drain(self);
    set_room(self, TALK_OPEN);
    settle(self);
}

static void step(struct run *self)
{
    const struct talk_machine *machine = self->machine;
    const struct talk_line *line = self->line;
    const bool call = line->verb == CALL || line->verb == GOT || line->verb == ECHO;

    pass_time(self, CO_MS(line->at), !call);
    if (line != self->line)
        return;
    if (line->verb == SENT || line->verb == TOLD)
        complain(self, "nothing", "came");
    if (line->verb == IDLE && machine->deadline(machine->self) != CO_NEVER)
        complain(self, "has", "a deadline");
    if (call)
        act(self);
    else
        self->line++;
}

void talk_run(const struct talk *self, const struct talk_machine *machine, enum talk_stall stall)
{
    struct run run = { .talk = self, .machine = machine, .stall = stall, .line = self->lines };

    set_room(&run, TALK_OPEN);
    while (run.line->verb != END)
        step(&run);
    drain(&run);
}

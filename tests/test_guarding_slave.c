/* Guarding: the device that is node 5, and master and device in a loop. */
#include "proto/guarding.h"

#include "proto/event.h"
#include "proto/nmt.h"
#include "support/suite.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))
#define NODE         5

/* ---- slave --------------------------------------------------------------------------------- */

/* clang-format off */
static const struct talk slave_talks[] = {
    { "answers alternate, whatever the length asked for", {
        { 0, CALL, "state 127" },
        { 1, GOT,  "705#R1" },
        { 1, SENT, "705#7F" },
        { 2, GOT,  "705#R0" },
        { 2, SENT, "705#FF" },
        { 3, CALL, "state 5" },
        { 3, GOT,  "705#R8" },
        { 3, SENT, "705#05" },
        { 4, CALL, "state 4" },
        { 4, GOT,  "705#R1" },
        { 4, SENT, "705#84" },
        { 60000, IDLE, NULL } } },
    { "frames that are no requests to this node", {
        { 0, CALL, "life 100" },
        { 1, GOT,  "704#R1" },
        { 1, GOT,  "706#R1" },
        { 1, GOT,  "700#R1" },
        { 1, GOT,  "605#R1" },
        { 1, GOT,  "00000705#R1" },
        { 1, GOT,  "705#05" },
        { 1, GOT,  "705#" },
        { 60000, IDLE, NULL } } },
    { "no life guarding before the first request", {
        { 0, CALL, "state 5" },
        { 0, CALL, "life 200" },
        { 10000, IDLE, NULL },
        { 10000, GOT,  "705#R1" },
        { 10000, SENT, "705#05" },
        { 10200, GOT,  "705#R1" }, /* at the last moment */
        { 10200, SENT, "705#85" },
        { 10399, QUIET, NULL },
        { 10400, TOLD, "lost" },
        { 20000, IDLE, NULL },
        { 20000, GOT,  "705#R1" },
        { 20000, SENT, "705#05" },
        { 20000, TOLD, "back" },
        { 20199, QUIET, NULL },
        { 20200, TOLD, "lost" } } },
    { "another life time counts from the next request on", {
        { 0, CALL, "state 5" },
        { 0, CALL, "life 200" },
        { 0, GOT,  "705#R1" },
        { 0, SENT, "705#05" },
        { 10, CALL, "life 50" },
        { 199, QUIET, NULL },
        { 199, GOT,  "705#R1" },
        { 199, SENT, "705#85" },
        { 248, QUIET, NULL },
        { 249, TOLD, "lost" },
        { 250, CALL, "life 0" },
        { 260, GOT,  "705#R1" },
        { 260, SENT, "705#05" },
        { 260, TOLD, "back" },
        { 60000, IDLE, NULL } } },
    { "stopped, and begun again with the next request; the toggle bit goes on", {
        { 0, CALL, "state 5" },
        { 0, CALL, "life 200" },
        { 0, GOT,  "705#R1" },
        { 0, SENT, "705#05" },
        { 10, CALL, "stop" },
        { 9000, IDLE, NULL },
        { 9000, GOT,  "705#R1" },
        { 9000, SENT, "705#85" },
        { 9200, TOLD, "lost" },
        { 9300, CALL, "stop" },
        { 9300, TOLD, "back" },
        { 60000, IDLE, NULL } } },
};
/* clang-format on */

static bool slave_call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct guard_slave *self = machine;
    const char *number = strchr(text, ' ');

    (void)now;
    if (number == NULL)
        guard_slave_stop(self, out);
    else if (text[0] == 's')
        self->state = (uint8_t)atoi(number);
    else
        self->life_time = CO_MS(atoi(number));
    return true;
}

static bool slave_on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                           struct co_outbox *out)
{
    guard_slave_on_frame(machine, frame, now, out);
    return true;
}

static void slave_on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    guard_slave_on_time(machine, now, out);
}

static co_us_t slave_deadline(const void *machine)
{
    return guard_slave_deadline(machine);
}

static void slave_describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    (void)machine;
    ck_assert_uint_eq(event->node, NODE);
    ck_assert(event->type == PROTO_LIFE_LOST || event->type == PROTO_LIFE_BACK);
    snprintf(text, size, "%s", event->type == PROTO_LIFE_LOST ? "lost" : "back");
}

START_TEST(slave_conversation)
{
    struct guard_slave slave;
    const struct talk_machine machine = { .self = &slave,
                                          .call = slave_call,
                                          .on_frame = slave_on_frame,
                                          .on_time = slave_on_time,
                                          .deadline = slave_deadline,
                                          .describe = slave_describe };

    guard_slave_init(&slave, NODE);
    talk_run(&slave_talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* Requests while there is no room: one answer, with the state of then; the master is not lost. */
START_TEST(slave_full_outbox)
{
    const struct co_frame request = talk_frame("705#R1");
    struct guard_slave slave;
    struct co_frame frames[4];
    struct co_event events[4];
    struct co_outbox out;

    guard_slave_init(&slave, NODE);
    slave.life_time = 100;
    slave.state = NMT_PREOPERATIONAL;
    co_outbox_init(&out, frames, 0, events, 0);
    guard_slave_on_frame(&slave, &request, 0, &out);
    guard_slave_on_frame(&slave, &request, 50, &out);
    guard_slave_on_time(&slave, 150, &out);            /* lost ... */
    guard_slave_on_frame(&slave, &request, 160, &out); /* ... but nobody knows */
    slave.state = NMT_OPERATIONAL;
    ck_assert_uint_eq(guard_slave_deadline(&slave), 0);
    co_outbox_init(&out, frames, 4, events, 4);
    guard_slave_on_time(&slave, 170, &out);
    ck_assert_uint_eq(out.frame_count, 1);
    ck_assert_uint_eq(out.event_count, 0);
    ck_assert_uint_eq(frames[0].data[0], NMT_OPERATIONAL);
    ck_assert_uint_eq(guard_slave_deadline(&slave), 260);
}
END_TEST

/* ---- both ---------------------------------------------------------------------------------- */

/* A wire between the two that loses what the test wants, and takes no time. */
struct pair {
    struct guard_master master;
    struct guard_slave slave;
    struct co_frame frames[4];
    struct co_event events[4];
    struct co_outbox out;
    co_us_t now;
    unsigned requests, answers, states, losses, toggles, life_losses, life_backs;
    bool requests_lost, answers_lost;
};

static void pair_init(struct pair *self)
{
    *self = (struct pair){ .now = 0 };
    co_outbox_init(&self->out, self->frames, 4, self->events, 4);
    guard_master_init(&self->master, NODE);
    guard_slave_init(&self->slave, NODE);
    self->slave.state = NMT_PREOPERATIONAL;
}

static void pair_count(struct pair *self, const struct co_event *event)
{
    self->states += event->type == PROTO_GUARD_STATE;
    self->losses += event->type == PROTO_GUARD_LOST;
    self->toggles += event->type == PROTO_GUARD_TOGGLE;
    self->life_losses += event->type == PROTO_LIFE_LOST;
    self->life_backs += event->type == PROTO_LIFE_BACK;
}

/* Everybody hears what the other says. */
static void pair_carry(struct pair *self)
{
    struct co_frame frame;
    struct co_event event;

    while (co_outbox_take_frame(&self->out, &frame)) {
        const bool request = (frame.flags & CO_FRAME_RTR) != 0;

        self->requests += request;
        self->answers += !request;
        if (request && !self->requests_lost)
            guard_slave_on_frame(&self->slave, &frame, self->now, &self->out);
        if (!request && !self->answers_lost)
            guard_master_on_frame(&self->master, &frame, self->now, &self->out);
    }
    while (co_outbox_take_event(&self->out, &event))
        pair_count(self, &event);
}

static co_us_t pair_deadline(const struct pair *self)
{
    return co_earlier(guard_master_deadline(&self->master), guard_slave_deadline(&self->slave));
}

static void pair_run(struct pair *self, co_us_t until)
{
    while (pair_deadline(self) <= until) {
        ck_assert_uint_ge(pair_deadline(self), self->now);
        self->now = pair_deadline(self);
        guard_master_on_time(&self->master, self->now, &self->out);
        pair_carry(self);
        guard_slave_on_time(&self->slave, self->now, &self->out);
        pair_carry(self);
    }
    self->now = until;
}

START_TEST(loop_of_a_minute)
{
    struct pair pair;

    pair_init(&pair);
    pair.slave.life_time = CO_MS(200);
    guard_master_start(&pair.master, CO_MS(100), 2, 0);
    pair_run(&pair, CO_MS(30000));
    pair.slave.state = NMT_OPERATIONAL;
    pair_run(&pair, CO_MS(60000));
    ck_assert_uint_eq(pair.requests, 601);
    ck_assert_uint_eq(pair.answers, 601);
    ck_assert_uint_eq(pair.states, 2);
    ck_assert_uint_eq(pair.losses + pair.toggles + pair.life_losses, 0);
}
END_TEST

START_TEST(loop_with_losses)
{
    struct pair pair;

    pair_init(&pair);
    pair.slave.life_time = CO_MS(150);
    guard_master_start(&pair.master, CO_MS(100), 3, 0);
    pair_run(&pair, CO_MS(1050));
    pair.requests_lost = true; /* one: only the device sees it, the toggle bits agree */
    pair_run(&pair, CO_MS(1150));
    ck_assert_uint_eq(pair.life_losses, 1);
    ck_assert_uint_eq(pair.losses, 0);
    pair.requests_lost = false;
    pair_run(&pair, CO_MS(2050));
    ck_assert_uint_eq(pair.life_backs, 1);
    ck_assert_uint_eq(pair.states, 1);
    ck_assert_uint_eq(pair.toggles, 0);
    pair.answers_lost = true; /* one: a toggle bit too many; three: lost */
    pair_run(&pair, CO_MS(2150));
    pair.answers_lost = false;
    pair_run(&pair, CO_MS(3050));
    ck_assert_uint_eq(pair.toggles, 1);
    ck_assert_uint_eq(pair.losses, 0);
    pair.answers_lost = true;
    pair_run(&pair, CO_MS(3299));
    ck_assert_uint_eq(pair.losses, 0);
    pair_run(&pair, CO_MS(3300));
    ck_assert_uint_eq(pair.losses, 1);
    pair.answers_lost = false;
    pair_run(&pair, CO_MS(5000));
    ck_assert_uint_eq(pair.losses, 1);
    ck_assert_uint_eq(pair.states, 2);
    ck_assert_uint_eq(pair.life_losses, 1);
}
END_TEST

/* A restarted master asks a node that runs, finds it operational and guards it on. */
START_TEST(loop_of_keep_alive)
{
    struct pair pair;

    pair_init(&pair);
    pair.slave.state = NMT_OPERATIONAL;
    pair.slave.toggle = _i != 0;
    guard_master_ask(&pair.master, CO_MS(100), 0);
    pair_run(&pair, CO_MS(500));
    ck_assert_uint_eq(pair.requests, 1);
    ck_assert_uint_eq(pair.states, 1);
    guard_master_start(&pair.master, CO_MS(100), 2, CO_MS(500));
    pair_run(&pair, CO_MS(1000));
    ck_assert_uint_eq(pair.requests, 7);
    ck_assert_uint_eq(pair.states, 2);
    ck_assert_uint_eq(pair.toggles + pair.losses, 0);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("guarding_slave");

    tcase_add_loop_test(tcase, slave_conversation, 0, COUNT(slave_talks) * TALK_STALLS);
    tcase_add_test(tcase, slave_full_outbox);
    tcase_add_test(tcase, loop_of_a_minute);
    tcase_add_test(tcase, loop_with_losses);
    tcase_add_loop_test(tcase, loop_of_keep_alive, 0, 2);
    return suite_run("guarding_slave", tcase);
}

/* A transmitted PDO with one number of 16 bits: when it goes out, and with what. */
#include "proto/tpdo.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER 512
#define FIELDS 2

/*
 * "set COB-ID TYPE START INHIBIT PERIOD": its parameters, times in ms; "sync COUNTER ANSWER WINDOW"
 * with the times from now, 0: no window; "value X": what the dictionary has now; "missed N".
 */
/* clang-format off */
static const struct talk talks[] = {
    { "not started, not valid, nothing mapped", {
        { 0, CALL, "set 185 255 0 0 0" }, { 0, CALL, "trigger" }, { 1, IDLE, NULL },
        { 2, CALL, "start" }, { 2, CALL, "set 80000185 255 0 0 0" }, { 2, CALL, "trigger" },
        { 3, CALL, "request" }, { 3, CALL, "sync 0 10 0" }, { 4, IDLE, NULL },
        { 5, CALL, "set 185 255 0 0 0" }, { 5, CALL, "map 0" }, { 5, CALL, "trigger" },
        { 5, CALL, "request" }, { 6, IDLE, NULL },
        { 7, CALL, "map 2" }, { 7, CALL, "trigger" }, { 7, SENT, "185#00000000" },
        { 8, CALL, "stop" }, { 8, CALL, "trigger" }, { 9, IDLE, NULL } } },
    { "events", {
        { 0, CALL, "set 185 254 0 0 0" }, { 0, CALL, "start" }, { 0, CALL, "value 1234" },
        { 1, CALL, "trigger" }, { 1, SENT, "185#3412" },
        { 2, CALL, "value 5678" }, { 2, CALL, "trigger" }, { 2, SENT, "185#7856" },
        { 3, CALL, "sync 0 10 0" }, { 9, IDLE, NULL } } },
    { "a 29-bit identifier", {
        { 0, CALL, "set 72345678 255 0 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "trigger" }, { 1, SENT, "12345678#0000" } } },
    { "one that notifies is sent when it starts, or becomes valid", {
        { 0, CALL, "notify 1" }, { 0, CALL, "set 185 255 0 0 0" }, { 0, CALL, "start" },
        { 0, SENT, "185#0000" },
        { 1, CALL, "set 80000185 255 0 0 0" }, { 2, CALL, "set 185 255 0 0 0" },
        { 2, SENT, "185#0000" },
        { 3, CALL, "set 185 255 0 0 0" }, { 4, CALL, "set 185 254 0 0 0" },
        { 4, SENT, "185#0000" }, { 5, CALL, "set 185 1 0 0 0" }, { 6, IDLE, NULL } } },
    { "inhibit time: one frame at its end, with the latest data", {
        { 0, CALL, "set 185 255 0 10 0" }, { 0, CALL, "start" },
        { 5, CALL, "trigger" }, { 5, SENT, "185#0000" },
        { 6, CALL, "value 0001" }, { 6, CALL, "trigger" }, { 9, CALL, "trigger" },
        { 10, CALL, "value 0002" }, { 14, QUIET, NULL }, { 15, SENT, "185#0200" },
        { 30, IDLE, NULL }, { 40, CALL, "trigger" }, { 40, SENT, "185#0200" } } },
    { "an event within the inhibit time is gone with the state, the time itself too", {
        { 0, CALL, "set 185 255 0 10 0" }, { 0, CALL, "start" },
        { 1, CALL, "trigger" }, { 1, SENT, "185#0000" },
        { 2, CALL, "trigger" }, { 3, CALL, "stop" }, { 4, CALL, "start" }, { 5, IDLE, NULL },
        { 6, CALL, "trigger" }, { 6, SENT, "185#0000" } } },
    { "another inhibit time counts from the last frame", {
        { 0, CALL, "set 185 255 0 10 0" }, { 0, CALL, "start" },
        { 1, CALL, "trigger" }, { 1, SENT, "185#0000" },
        { 2, CALL, "trigger" }, { 3, CALL, "set 185 255 0 20 0" },
        { 20, QUIET, NULL }, { 21, SENT, "185#0000" } } },
    { "event timer: from the start on, and from each frame", {
        { 0, CALL, "set 185 255 0 0 100" }, { 10, CALL, "start" },
        { 109, QUIET, NULL }, { 110, SENT, "185#0000" }, { 210, SENT, "185#0000" },
        { 250, CALL, "trigger" }, { 250, SENT, "185#0000" },
        { 349, QUIET, NULL }, { 350, SENT, "185#0000" },
        { 360, CALL, "request" }, { 360, SENT, "185#0000" }, { 460, SENT, "185#0000" },
        { 470, CALL, "set 185 255 0 0 20" }, { 490, SENT, "185#0000" }, { 510, SENT, "185#0000" },
        { 511, CALL, "set 185 255 0 0 0" }, { 900, IDLE, NULL } } },
    { "the inhibit time wins against the event timer", {
        { 0, CALL, "set 185 255 0 30 10" }, { 0, CALL, "start" },
        { 10, SENT, "185#0000" }, { 40, SENT, "185#0000" }, { 70, SENT, "185#0000" } } },
    { "event timer and others' types", {
        { 0, CALL, "set 185 1 0 0 10" }, { 0, CALL, "start" }, { 99, IDLE, NULL },
        { 100, CALL, "set 185 253 0 0 10" }, { 199, IDLE, NULL },
        { 200, CALL, "set 185 255 0 0 10" }, { 210, SENT, "185#0000" },
        { 215, CALL, "stop" }, { 300, IDLE, NULL } } },
    { "type 0: with the SYNC after an event, and once after the start", {
        { 0, CALL, "set 185 0 0 0 0" }, { 0, CALL, "start" }, { 1, IDLE, NULL },
        { 1, CALL, "sync 0 10 0" }, { 1, SENT, "185#0000" },
        { 2, CALL, "sync 0 10 0" }, { 3, CALL, "value 0001" }, { 4, CALL, "sync 0 10 0" },
        { 5, CALL, "trigger" }, { 6, CALL, "trigger" }, { 7, CALL, "value 0002" },
        { 8, CALL, "sync 0 10 0" }, { 8, SENT, "185#0200" }, { 9, CALL, "sync 0 10 0" },
        { 10, IDLE, NULL } } },
    { "type 0 knows no inhibit time", {
        { 0, CALL, "set 185 0 0 100 0" }, { 0, CALL, "start" },
        { 1, CALL, "sync 0 10 0" }, { 1, SENT, "185#0000" },
        { 2, CALL, "trigger" }, { 3, CALL, "sync 0 10 0" }, { 3, SENT, "185#0000" } } },
    { "type 1: with each SYNC, whatever happens", {
        { 0, CALL, "set 185 1 0 0 0" }, { 0, CALL, "start" }, { 0, CALL, "trigger" },
        { 1, CALL, "sync 0 10 0" }, { 1, SENT, "185#0000" },
        { 2, CALL, "sync 0 10 0" }, { 2, SENT, "185#0000" }, { 3, IDLE, NULL } } },
    { "type 3: with each third; anew after the start", {
        { 0, CALL, "set 185 3 0 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "sync 0 10 0" }, { 2, CALL, "sync 0 10 0" },
        { 3, CALL, "sync 0 10 0" }, { 3, SENT, "185#0000" },
        { 4, CALL, "sync 0 10 0" }, { 5, CALL, "stop" }, { 6, CALL, "start" },
        { 7, CALL, "sync 0 10 0" }, { 8, CALL, "sync 0 10 0" },
        { 9, CALL, "sync 0 10 0" }, { 9, SENT, "185#0000" } } },
    { "SYNC start value: that one is its first", {
        { 0, CALL, "set 185 2 3 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "sync 1 10 0" }, { 2, CALL, "sync 2 10 0" }, { 3, CALL, "sync 3 10 0" },
        { 4, CALL, "sync 4 10 0" }, { 4, SENT, "185#0000" },
        { 5, CALL, "sync 1 10 0" }, { 6, CALL, "sync 2 10 0" }, { 6, SENT, "185#0000" } } },
    { "SYNC start value: SYNCs without counter", {
        { 0, CALL, "set 185 1 9 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "sync 0 10 0" }, { 1, SENT, "185#0000" } } },
    { "SYNC start value that does not come", {
        { 0, CALL, "set 185 1 9 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "sync 1 10 0" }, { 2, CALL, "sync 8 10 0" }, { 3, IDLE, NULL } } },
    { "requests: forbidden, and while it is off", {
        { 0, CALL, "set 40000185 255 0 0 0" }, { 0, CALL, "request" },
        { 0, CALL, "start" }, { 1, CALL, "request" }, { 2, IDLE, NULL },
        { 3, CALL, "set 185 255 0 0 0" }, { 3, CALL, "value 1234" }, { 3, CALL, "request" },
        { 3, SENT, "185#3412" } } },
    { "requests do not care about the inhibit time, but it runs from them", {
        { 0, CALL, "set 185 255 0 10 0" }, { 0, CALL, "start" },
        { 1, CALL, "trigger" }, { 1, SENT, "185#0000" }, { 2, CALL, "request" },
        { 2, SENT, "185#0000" },
        { 3, CALL, "trigger" }, { 11, QUIET, NULL }, { 12, SENT, "185#0000" },
        { 13, CALL, "trigger" }, { 14, CALL, "value 0001" },
        { 15, CALL, "request" }, { 15, SENT, "185#0100" }, { 50, IDLE, NULL } } },
    { "types 0 and 253 answer with what is there, and that is no event", {
        { 0, CALL, "set 185 0 0 0 0" }, { 0, CALL, "start" }, { 0, CALL, "value 0001" },
        { 1, CALL, "request" }, { 1, SENT, "185#0100" },
        { 2, CALL, "sync 0 10 0" }, { 2, SENT, "185#0100" },
        { 3, CALL, "set 185 253 0 0 0" }, { 3, CALL, "trigger" }, { 3, CALL, "sync 0 10 0" },
        { 4, CALL, "value 0002" }, { 4, CALL, "request" }, { 4, SENT, "185#0200" } } },
    { "cyclic types answer with what the SYNC sent", {
        { 0, CALL, "set 185 2 0 0 0" }, { 0, CALL, "start" }, { 0, CALL, "value 0001" },
        { 1, CALL, "request" }, { 1, SENT, "185#0100" },
        { 2, CALL, "sync 0 10 0" }, { 3, CALL, "sync 0 10 0" }, { 3, SENT, "185#0100" },
        { 4, CALL, "value 0002" }, { 4, CALL, "request" }, { 4, SENT, "185#0100" } } },
    { "type 252: the sample of the last SYNC", {
        { 0, CALL, "set 185 252 0 0 0" }, { 0, CALL, "start" }, { 0, CALL, "value 0001" },
        { 1, CALL, "request" }, { 1, SENT, "185#0100" },
        { 2, CALL, "sync 0 10 0" }, { 3, CALL, "value 0002" },
        { 4, CALL, "request" }, { 4, SENT, "185#0100" },
        { 5, CALL, "sync 0 10 0" }, { 6, CALL, "value 0003" },
        { 7, CALL, "request" }, { 7, SENT, "185#0200" },
        { 8, CALL, "trigger" }, { 9, CALL, "stop" }, { 9, CALL, "start" },
        { 10, CALL, "request" }, { 10, SENT, "185#0300" } } },
    { "asked before it goes out with a SYNC", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 1 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 5 0" }, { 10, TOLD, "wanted 512 1" },
        { 12, CALL, "value 0001" }, { 12, CALL, "answer 1" }, { 12, SENT, "185#0100" },
        { 20, CALL, "sync 0 5 0" }, { 20, TOLD, "wanted 512 2" },
        { 21, CALL, "answer 1" }, { 22, CALL, "answer 3" },
        { 24, CALL, "answer 2" }, { 24, SENT, "185#0100" }, { 24, CALL, "missed 0" },
        { 30, IDLE, NULL } } },
    { "no answer in time: sent with what is there, and counted", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 1 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 5 5" }, { 10, TOLD, "wanted 512 1" }, { 11, CALL, "value 0009" },
        { 14, QUIET, NULL }, { 15, SENT, "185#0900" }, { 15, CALL, "missed 1" },
        { 16, CALL, "answer 1" }, { 30, IDLE, NULL } } },
    { "another SYNC while it asks: no second question", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 1 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 10 0" }, { 10, TOLD, "wanted 512 1" },
        { 15, CALL, "sync 0 10 0" }, { 15, CALL, "missed 1" },
        { 20, SENT, "185#0000" }, { 20, CALL, "missed 2" }, { 50, IDLE, NULL } } },
    { "type 0 asks only when there was an event, and its answer is none", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 0 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 5 0" }, { 10, TOLD, "wanted 512 1" }, { 11, CALL, "trigger" },
        { 12, CALL, "answer 1" }, { 12, SENT, "185#0000" },
        { 20, CALL, "sync 0 5 0" }, { 25, IDLE, NULL } } },
    { "a sample is asked for", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 252 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 5 0" }, { 10, TOLD, "wanted 512 1" },
        { 11, CALL, "request" }, { 12, CALL, "value 0001" }, { 12, CALL, "answer 1" },
        { 12, SENT, "185#0100" }, { 13, CALL, "value 0002" },
        { 14, CALL, "request" }, { 14, SENT, "185#0100" },
        { 20, CALL, "sync 0 5 0" }, { 20, TOLD, "wanted 512 2" },
        { 25, QUIET, NULL }, { 25, CALL, "missed 1" },
        { 26, CALL, "request" }, { 26, SENT, "185#0200" }, { 30, IDLE, NULL } } },
    { "a request asks, for 10 ms", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 253 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "request" }, { 10, TOLD, "wanted 512 1" }, { 11, CALL, "request" },
        { 12, CALL, "answer 1" }, { 12, SENT, "185#0000" },
        { 20, CALL, "request" }, { 20, TOLD, "wanted 512 2" },
        { 29, QUIET, NULL }, { 30, SENT, "185#0000" }, { 30, CALL, "missed 1" } } },
    { "events do not ask; what changes while it asks goes out with the answer", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 255 0 0 0" }, { 0, CALL, "start" },
        { 1, CALL, "trigger" }, { 1, SENT, "185#0000" },
        { 2, CALL, "request" }, { 2, TOLD, "wanted 512 1" },
        { 3, CALL, "value 0001" }, { 3, CALL, "trigger" }, { 4, CALL, "trigger" },
        { 5, CALL, "answer 1" }, { 5, SENT, "185#0100" }, { 30, IDLE, NULL } } },
    { "the event timer asks only where it is to", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 255 0 0 50" }, { 0, CALL, "start" },
        { 50, SENT, "185#0000" }, { 60, CALL, "timer_asks 1" },
        { 100, TOLD, "wanted 512 1" }, { 103, CALL, "value 0001" }, { 103, CALL, "answer 1" },
        { 103, SENT, "185#0100" },
        { 150, TOLD, "wanted 512 2" }, { 159, QUIET, NULL }, { 160, SENT, "185#0100" },
        { 160, CALL, "missed 1" }, { 200, TOLD, "wanted 512 3" }, { 201, CALL, "answer 3" },
        { 201, SENT, "185#0100" } } },
    { "the event timer asks when the inhibit time is over", {
        { 0, CALL, "asks 1" }, { 0, CALL, "timer_asks 1" }, { 0, CALL, "set 185 255 0 30 10" },
        { 0, CALL, "start" },
        { 10, TOLD, "wanted 512 1" }, { 12, CALL, "answer 1" }, { 12, SENT, "185#0000" },
        { 42, TOLD, "wanted 512 2" }, { 42, CALL, "answer 2" }, { 42, SENT, "185#0000" } } },
    { "what it asks for is dropped by the end, or another type", {
        { 0, CALL, "asks 1" }, { 0, CALL, "set 185 1 0 0 0" }, { 0, CALL, "start" },
        { 10, CALL, "sync 0 5 0" }, { 10, TOLD, "wanted 512 1" }, { 11, CALL, "stop" },
        { 12, CALL, "answer 1" }, { 12, CALL, "start" }, { 13, CALL, "answer 1" },
        { 20, CALL, "sync 0 5 0" }, { 20, TOLD, "wanted 512 2" },
        { 21, CALL, "set 185 2 0 0 0" }, { 22, CALL, "answer 2" }, { 50, IDLE, NULL },
        { 50, CALL, "missed 0" } } },
    { "reserved types do nothing", {
        { 0, CALL, "set 185 241 0 0 10" }, { 0, CALL, "start" }, { 1, CALL, "trigger" },
        { 1, CALL, "sync 1 5 0" }, { 20, CALL, "set 185 251 0 0 10" }, { 21, CALL, "trigger" },
        { 21, CALL, "sync 1 5 0" }, { 90, IDLE, NULL } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

struct bench {
    struct tpdo tpdo;
    struct pdo_field fields[FIELDS];
    struct od od;
};

static void map_entries(struct bench *self, unsigned count, co_us_t now)
{
    pdo_map_clear(&self->tpdo.map);
    for (unsigned i = 0; i < count; i++)
        ck_assert(pdo_map_add(&self->tpdo.map, self->od.entries[i], 16));
    tpdo_remapped(&self->tpdo, now);
}

static void configure(struct bench *self, const char *text, co_us_t now)
{
    struct tpdo_parameters parameters = { .type = 0 };
    unsigned cob_id = 0, type = 0, start = 0, inhibit = 0, period = 0;

    ck_assert_int_eq(sscanf(text, "set %x %u %u %u %u", &cob_id, &type, &start, &inhibit, &period),
                     5);
    parameters.cob_id = cob_id;
    parameters.type = (uint8_t)type;
    parameters.sync_start = (uint8_t)start;
    parameters.inhibit = CO_MS(inhibit);
    parameters.period = CO_MS(period);
    tpdo_configure(&self->tpdo, &parameters, now);
}

static void synchronize(struct bench *self, const char *text, co_us_t now)
{
    unsigned counter = 0, answer = 0, window = 0;
    struct tpdo_sync sync = { .window_end = CO_NEVER };

    ck_assert_int_eq(sscanf(text, "sync %u %u %u", &counter, &answer, &window), 3);
    sync.counter = (uint8_t)counter;
    sync.answer_end = now + CO_MS(answer);
    if (window > 0)
        sync.window_end = now + CO_MS(window);
    tpdo_on_sync(&self->tpdo, &sync);
}

static bool set_flag(struct tpdo *tpdo, const char *text)
{
    const bool on = text[strlen(text) - 1] == '1';

    if (strncmp(text, "asks", 4) == 0)
        tpdo->asks = on;
    else if (strncmp(text, "timer_asks", 10) == 0)
        tpdo->timer_asks = on;
    else if (strncmp(text, "notify", 6) == 0)
        tpdo->notify = on;
    else
        return false;
    return true;
}

static bool call_with_number(struct bench *self, const char *text, co_us_t now)
{
    unsigned number = 0;

    if (sscanf(text, "answer %u", &number) == 1)
        tpdo_answer(&self->tpdo, number);
    else if (sscanf(text, "value %x", &number) == 1)
        od_set_number(&self->od, 0x2000, 0, number);
    else if (sscanf(text, "map %u", &number) == 1)
        map_entries(self, number, now);
    else if (sscanf(text, "missed %u", &number) == 1)
        ck_assert_uint_eq(self->tpdo.missed, number);
    else
        return false;
    return true;
}

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct bench *self = machine;

    (void)out;
    if (strcmp(text, "start") == 0)
        tpdo_start(&self->tpdo, now);
    else if (strcmp(text, "stop") == 0)
        tpdo_stop(&self->tpdo);
    else if (strcmp(text, "trigger") == 0)
        tpdo_trigger(&self->tpdo);
    else if (strcmp(text, "request") == 0)
        tpdo_on_request(&self->tpdo);
    else if (strncmp(text, "set", 3) == 0)
        configure(self, text, now);
    else if (strncmp(text, "sync", 4) == 0)
        synchronize(self, text, now);
    else if (!set_flag(&self->tpdo, text))
        ck_assert_msg(call_with_number(self, text, now), "%s?", text);
    return true;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    struct bench *self = machine;

    tpdo_on_time(&self->tpdo, now, out);
}

static co_us_t deadline(const void *machine)
{
    const struct bench *self = machine;

    return tpdo_deadline(&self->tpdo);
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    (void)machine;
    ck_assert_uint_eq(event->type, PROTO_TPDO_WANTED);
    snprintf(text, size, "wanted %u %u", event->index, event->code);
}

static void bench_init(struct bench *self)
{
    memset(self, 0, sizeof *self);
    od_init(&self->od);
    for (uint16_t index = 0x2000; index < 0x2000 + FIELDS; index++)
        ck_assert_int_eq(od_add_number(&self->od, index, 0, OD_UNSIGNED16, OD_RWR, 0), CO_OK);
    tpdo_init(&self->tpdo, NUMBER, self->fields, FIELDS);
    map_entries(self, 1, 0);
}

START_TEST(conversation)
{
    struct bench bench;
    const struct talk_machine machine = {
        .self = &bench, .call = call, .on_time = on_time, .deadline = deadline, .describe = describe
    };

    bench_init(&bench);
    talk_run(&talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
    od_done(&bench.od);
}
END_TEST

/* Behind its window a frame waits for the next SYNC. */
START_TEST(no_room_within_the_window)
{
    struct bench bench;
    struct co_frame frames[1], frame;
    struct co_outbox full, out;

    bench_init(&bench);
    co_outbox_init(&full, NULL, 0, NULL, 0);
    co_outbox_init(&out, frames, 1, NULL, 0);
    configure(&bench, "set 185 1 0 0 0", 0);
    tpdo_start(&bench.tpdo, 0);
    for (unsigned late = 0; late < 2; late++) {
        synchronize(&bench, "sync 0 1 1", CO_MS(10));
        tpdo_on_time(&bench.tpdo, CO_MS(10), &full);
        ck_assert_uint_eq(tpdo_deadline(&bench.tpdo), 0);
        tpdo_on_time(&bench.tpdo, CO_MS(11) + late, &out);
        ck_assert_int_eq(co_outbox_take_frame(&out, &frame), !late);
        ck_assert_uint_eq(bench.tpdo.missed, late);
        ck_assert_uint_eq(tpdo_deadline(&bench.tpdo), CO_NEVER);
    }
    synchronize(&bench, "sync 0 1 0", CO_MS(20));
    tpdo_on_time(&bench.tpdo, CO_MS(20), &full);
    synchronize(&bench, "sync 0 1 0", CO_MS(30)); /* the window was up to this one */
    tpdo_on_time(&bench.tpdo, CO_MS(30), &out);
    ck_assert(co_outbox_take_frame(&out, &frame));
    ck_assert_uint_eq(bench.tpdo.missed, 2);
    od_done(&bench.od);
}
END_TEST

/* Each type, over 240 SYNCs with a request and an event in between. */
START_TEST(every_type)
{
    struct bench bench;
    struct co_frame frames[2], frame;
    struct co_outbox out;
    char text[32];
    unsigned sent = 0, expected = 0;

    bench_init(&bench);
    co_outbox_init(&out, frames, 2, NULL, 0);
    snprintf(text, sizeof text, "set 185 %d 0 0 0", _i);
    configure(&bench, text, 0);
    tpdo_start(&bench.tpdo, 0);
    for (unsigned i = 0; i < 240; i++) {
        synchronize(&bench, "sync 0 1 0", i);
        tpdo_on_time(&bench.tpdo, i, &out);
        sent += co_outbox_take_frame(&out, &frame);
    }
    if (_i <= 240)
        expected = _i == 0 ? 1 : 240 / (unsigned)_i;
    ck_assert_uint_eq(sent, expected);
    tpdo_on_request(&bench.tpdo);
    tpdo_on_time(&bench.tpdo, 240, &out);
    ck_assert(co_outbox_take_frame(&out, &frame));
    tpdo_trigger(&bench.tpdo);
    tpdo_on_time(&bench.tpdo, 240, &out);
    ck_assert_int_eq(co_outbox_take_frame(&out, &frame), _i >= 254);
    od_done(&bench.od);
}
END_TEST

/* A frame that is late makes the next one no later; after a stall none is made up for. */
START_TEST(event_timer_keeps_its_pace)
{
    struct bench bench;
    struct co_frame frames[1], frame;
    struct co_outbox out;

    bench_init(&bench);
    co_outbox_init(&out, frames, 1, NULL, 0);
    configure(&bench, "set 185 255 0 0 10", 0);
    tpdo_start(&bench.tpdo, 0);
    for (co_us_t due = CO_MS(10); due < CO_MS(1000); due += CO_MS(10)) {
        ck_assert_uint_eq(tpdo_deadline(&bench.tpdo), due);
        tpdo_on_time(&bench.tpdo, due + 300, &out);
        ck_assert(co_outbox_take_frame(&out, &frame));
    }
    tpdo_on_time(&bench.tpdo, CO_MS(1055), &out);
    ck_assert(co_outbox_take_frame(&out, &frame));
    ck_assert_uint_eq(tpdo_deadline(&bench.tpdo), CO_MS(1065));
    od_done(&bench.od);
}
END_TEST

START_TEST(reset_forgets)
{
    struct bench bench;

    bench_init(&bench);
    configure(&bench, "set 185 255 0 10 10", 0);
    tpdo_start(&bench.tpdo, 0);
    tpdo_trigger(&bench.tpdo);
    bench.tpdo.confirms = 1;
    bench.tpdo.not_before = 5;
    tpdo_reset(&bench.tpdo);
    ck_assert_uint_eq(tpdo_deadline(&bench.tpdo), CO_NEVER);
    ck_assert_uint_eq(bench.tpdo.confirms, 0);
    ck_assert_uint_eq(bench.tpdo.not_before, 0);
    od_done(&bench.od);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("tpdo");
    TCase *tcase = tcase_create("tpdo");

    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * TALK_STALLS);
    tcase_add_loop_test(tcase, every_type, 0, 256);
    tcase_add_test(tcase, no_room_within_the_window);
    tcase_add_test(tcase, event_timer_keeps_its_pace);
    tcase_add_test(tcase, reset_forgets);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(make_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

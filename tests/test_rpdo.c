/* A received PDO with two numbers of 16 bits: when its data is taken over, and what is wrong. */
#include "proto/rpdo.h"

#include "base/bytes.h"
#include "proto/event.h"
#include "support/hex.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER 300
#define FIELDS 2

/* "set ID TYPE TIMEOUT": its parameters; "is A B": the values in the dictionary. */
/* clang-format off */
static const struct talk talks[] = {
    { "not started, not valid, nothing mapped", {
        { 0, CALL, "set 205 255 0" },
        { 1, GOT, "205#11223344" }, { 1, CALL, "is 0000 0000" },
        { 2, CALL, "start" }, { 2, CALL, "set 80000205 255 0" },
        { 3, GOT, "205#11223344" }, { 3, CALL, "is 0000 0000" },
        { 4, CALL, "set 205 255 0" }, { 4, CALL, "map 0" },
        { 5, GOT, "205#" }, { 5, GOT, "205#11" }, { 5, CALL, "counts 0 0 0 0" },
        { 9, IDLE, NULL } } },
    { "at once", {
        { 0, CALL, "set 205 255 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#11223344" }, { 1, CALL, "is 2211 4433" },
        { 2, GOT, "205#55667788" }, { 2, CALL, "is 6655 8877" }, { 2, CALL, "counts 2 0 0 0" },
        { 3, CALL, "stop" }, { 4, GOT, "205#00000000" }, { 4, CALL, "is 6655 8877" },
        { 5, IDLE, NULL } } },
    { "told to its owner", {
        { 0, CALL, "set 205 254 0" }, { 0, CALL, "start" }, { 0, CALL, "notify 1" },
        { 1, GOT, "205#11223344" }, { 1, TOLD, "rpdo 300 11223344 generation 1 at 1" },
        { 2, GOT, "205#11223344" }, { 2, TOLD, "rpdo 300 11223344 generation 1 at 2" },
        { 3, CALL, "notify 0" }, { 3, GOT, "205#00000000" },
        { 4, CALL, "wait 1" },
        { 5, GOT, "205#01000200" }, { 5, TOLD, "rpdo 300 01000200 generation 1 at 5" },
        { 6, CALL, "wait 0" }, { 6, GOT, "205#55667788" },
        { 7, CALL, "wait 1" }, { 7, CALL, "map 1" },
        { 8, GOT, "205#ABCD" }, { 8, TOLD, "rpdo 300 ABCD generation 2 at 8" } } },
    { "with the next SYNC, the last one of several", {
        { 0, CALL, "set 205 0 0" }, { 0, CALL, "start" }, { 0, CALL, "notify 1" },
        { 1, CALL, "sync" },
        { 2, GOT, "205#11223344" }, { 3, GOT, "205#55667788" }, { 3, CALL, "is 0000 0000" },
        { 4, CALL, "sync" }, { 4, TOLD, "rpdo 300 55667788 generation 1 at 3" },
        { 4, CALL, "is 6655 8877" }, { 4, CALL, "counts 1 0 1 0" },
        { 5, CALL, "sync" }, { 6, IDLE, NULL } } },
    { "the highest synchronous type", {
        { 0, CALL, "set 205 240 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#11223344" }, { 1, CALL, "is 0000 0000" },
        { 2, CALL, "sync" }, { 2, CALL, "is 2211 4433" } } },
    { "behind the window", {
        { 0, CALL, "set 205 1 0" }, { 0, CALL, "start" },
        { 1, CALL, "discard" }, { 1, CALL, "counts 0 0 0 1" }, { 2, CALL, "sync" },
        { 2, CALL, "is 0000 0000" },
        { 3, CALL, "stop" }, { 3, CALL, "discard" }, { 3, CALL, "counts 0 0 0 1" } } },
    { "what waits is dropped by the end, another type, another mapping", {
        { 0, CALL, "set 205 1 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#11223344" }, { 1, CALL, "stop" }, { 2, CALL, "start" },
        { 2, CALL, "sync" }, { 2, CALL, "is 0000 0000" },
        { 3, GOT, "205#11223344" }, { 3, CALL, "set 205 255 0" },
        { 4, CALL, "sync" }, { 4, CALL, "is 0000 0000" },
        { 5, CALL, "set 205 1 0" }, { 5, GOT, "205#11223344" }, { 5, CALL, "map 2" },
        { 6, CALL, "sync" }, { 6, CALL, "is 0000 0000" }, { 7, IDLE, NULL } } },
    { "too short: once, until it is right", {
        { 0, CALL, "set 205 255 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#112233" }, { 1, TOLD, "fault 300 8210 was 0000 3 of 4" },
        { 2, GOT, "205#" }, { 2, GOT, "205#1122" }, { 2, CALL, "is 0000 0000" },
        { 3, GOT, "205#11223344" }, { 3, TOLD, "fault 300 0000 was 8210 2 of 4" },
        { 3, CALL, "is 2211 4433" }, { 3, CALL, "counts 1 3 0 0" },
        { 4, GOT, "205#" }, { 4, TOLD, "fault 300 8210 was 0000 0 of 4" } } },
    { "too long", {
        { 0, CALL, "set 205 255 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#1122334455" }, { 1, TOLD, "fault 300 8220 was 0000 5 of 4" },
        { 2, GOT, "205#1122334455667788" }, { 2, CALL, "is 0000 0000" },
        { 3, GOT, "205#112233" }, { 3, TOLD, "fault 300 8210 was 8220 3 of 4" },
        { 4, CALL, "long 1" },
        { 4, GOT, "205#1122334455667788" }, { 4, TOLD, "fault 300 0000 was 8210 3 of 4" },
        { 4, CALL, "is 2211 4433" } } },
    { "a long one is taken over as far as mapped", {
        { 0, CALL, "set 205 1 0" }, { 0, CALL, "start" }, { 0, CALL, "long 1" },
        { 0, CALL, "notify 1" },
        { 1, GOT, "205#1122334455667788" }, { 2, CALL, "sync" },
        { 2, TOLD, "rpdo 300 11223344 generation 1 at 1" } } },
    { "a wrong one leaves what waits", {
        { 0, CALL, "set 205 1 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#11223344" },
        { 2, GOT, "205#11" }, { 2, TOLD, "fault 300 8210 was 0000 1 of 4" },
        { 3, CALL, "sync" }, { 3, CALL, "is 2211 4433" } } },
    { "silent: not before it was heard", {
        { 0, CALL, "set 205 255 100" }, { 0, CALL, "start" },
        { 1000, IDLE, NULL },
        { 1000, GOT, "205#11223344" }, { 1099, GOT, "205#11223344" }, { 1198, QUIET, NULL },
        { 1199, TOLD, "fault 300 8250 was 0000 0 of 4" },
        { 5000, IDLE, NULL },
        { 5001, GOT, "205#11223344" }, { 5001, TOLD, "fault 300 0000 was 8250 0 of 4" },
        { 5101, TOLD, "fault 300 8250 was 0000 0 of 4" } } },
    { "a wrong one is as none to the deadline", {
        { 0, CALL, "set 205 255 100" }, { 0, CALL, "start" },
        { 10, GOT, "205#11223344" },
        { 60, GOT, "205#11" }, { 60, TOLD, "fault 300 8210 was 0000 1 of 4" },
        { 110, TOLD, "fault 300 8250 was 8210 0 of 4" } } },
    { "the deadline of a synchronous one runs from the frame", {
        { 0, CALL, "set 205 1 100" }, { 0, CALL, "start" },
        { 10, GOT, "205#11223344" }, { 50, CALL, "sync" },
        { 110, TOLD, "fault 300 8250 was 0000 0 of 4" } } },
    { "the deadline ends with the state, and with another time", {
        { 0, CALL, "set 205 255 100" }, { 0, CALL, "start" },
        { 10, GOT, "205#11223344" }, { 20, CALL, "stop" }, { 30, IDLE, NULL },
        { 40, CALL, "start" }, { 50, IDLE, NULL },
        { 60, GOT, "205#11223344" }, { 70, CALL, "set 205 255 20" }, { 200, IDLE, NULL },
        { 200, GOT, "205#11223344" }, { 220, TOLD, "fault 300 8250 was 0000 0 of 4" } } },
    { "a new start, COB-ID or mapping is right until the next frame", {
        { 0, CALL, "set 205 255 0" }, { 0, CALL, "start" },
        { 1, GOT, "205#" }, { 1, TOLD, "fault 300 8210 was 0000 0 of 4" },
        { 2, CALL, "stop" }, { 3, QUIET, NULL },
        { 4, CALL, "start" }, { 4, TOLD, "fault 300 0000 was 8210 0 of 4" },
        { 5, GOT, "205#" }, { 5, TOLD, "fault 300 8210 was 0000 0 of 4" },
        { 6, CALL, "set 80000205 255 0" }, { 6, TOLD, "fault 300 0000 was 8210 0 of 4" },
        { 7, CALL, "set 205 255 0" },
        { 7, GOT, "205#" }, { 7, TOLD, "fault 300 8210 was 0000 0 of 4" },
        { 8, CALL, "map 1" }, { 8, TOLD, "fault 300 0000 was 8210 0 of 2" },
        { 9, GOT, "205#" }, { 9, TOLD, "fault 300 8210 was 0000 0 of 2" },
        { 10, CALL, "reset" }, { 20, IDLE, NULL } } },
};
/* clang-format on */

#define TALKS ((int)(sizeof talks / sizeof talks[0]))

struct bench {
    struct rpdo rpdo;
    struct pdo_field fields[FIELDS];
    struct od od;
    bool accept_long;
};

static void map_entries(struct bench *self, unsigned count)
{
    pdo_map_clear(&self->rpdo.map);
    for (unsigned i = 0; i < count; i++)
        ck_assert(pdo_map_add(&self->rpdo.map, self->od.entries[i], 16));
    rpdo_remapped(&self->rpdo);
}

static void configure(struct bench *self, const char *text)
{
    struct rpdo_parameters parameters = { .type = 0 };
    unsigned cob_id = 0, type = 0, timeout = 0;

    ck_assert_int_eq(sscanf(text, "set %x %u %u", &cob_id, &type, &timeout), 3);
    parameters.cob_id = cob_id;
    parameters.type = (uint8_t)type;
    parameters.timeout = CO_MS(timeout);
    rpdo_configure(&self->rpdo, &parameters);
}

static void compare(struct bench *self, const char *text)
{
    const struct rpdo *rpdo = &self->rpdo;
    char present[64];

    if (text[0] == 'i')
        snprintf(present, sizeof present, "is %04X %04X",
                 (unsigned)od_number(&self->od, 0x2000, 0, 0),
                 (unsigned)od_number(&self->od, 0x2001, 0, 0));
    else
        snprintf(present, sizeof present, "counts %u %u %u %u", rpdo->received, rpdo->errors,
                 rpdo->replaced, rpdo->discarded);
    ck_assert_str_eq(present, text);
}

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct bench *self = machine;
    const char *space = strchr(text, ' ');
    const unsigned number = space ? (unsigned)atoi(space) : 0;

    (void)now;
    (void)out;
    if (strcmp(text, "start") == 0)
        rpdo_start(&self->rpdo);
    else if (strcmp(text, "stop") == 0)
        rpdo_stop(&self->rpdo);
    else if (strcmp(text, "reset") == 0)
        rpdo_reset(&self->rpdo);
    else if (strcmp(text, "sync") == 0)
        rpdo_on_sync(&self->rpdo);
    else if (strcmp(text, "discard") == 0)
        rpdo_discard(&self->rpdo);
    else if (strncmp(text, "set", 3) == 0)
        configure(self, text);
    else if (strncmp(text, "map", 3) == 0)
        map_entries(self, number);
    else if (strncmp(text, "notify", 6) == 0)
        self->rpdo.notify = number > 0;
    else if (strncmp(text, "wait", 4) == 0)
        self->rpdo.waiters = number;
    else if (strncmp(text, "long", 4) == 0)
        self->accept_long = number > 0;
    else
        compare(self, text);
    return true;
}

static bool on_frame(void *machine, const struct co_frame *frame, co_us_t now,
                     struct co_outbox *out)
{
    struct bench *self = machine;

    rpdo_on_frame(&self->rpdo, frame, self->accept_long, now, out);
    return true;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    struct bench *self = machine;

    rpdo_on_time(&self->rpdo, now, out);
}

static co_us_t deadline(const void *machine)
{
    const struct bench *self = machine;

    return rpdo_deadline(&self->rpdo);
}

static void describe(void *machine, const struct co_event *event, char *text, size_t size)
{
    char data[20];

    (void)machine;
    hex_format(event->data, event->sub, data, sizeof data);
    if (event->type == PROTO_RPDO)
        snprintf(text, size, "rpdo %u %s generation %u at %u", event->index, data, event->code,
                 (unsigned)(event->actual / 1000));
    else if (event->type == PROTO_RPDO_FAULT)
        snprintf(text, size, "fault %u %04X was %04X %u of %u", event->index, event->code,
                 (unsigned)event->expected, event->detail, event->sub);
    else
        snprintf(text, size, "event %u", event->type);
}

static void bench_init(struct bench *self)
{
    memset(self, 0, sizeof *self);
    od_init(&self->od);
    for (uint16_t index = 0x2000; index < 0x2000 + FIELDS; index++)
        ck_assert_int_eq(od_add_number(&self->od, index, 0, OD_UNSIGNED16, OD_RWW, 0), CO_OK);
    rpdo_init(&self->rpdo, NUMBER, self->fields, FIELDS);
    map_entries(self, FIELDS);
}

START_TEST(conversation)
{
    struct bench bench;
    const struct talk_machine machine = { .self = &bench,
                                          .call = call,
                                          .on_frame = on_frame,
                                          .on_time = on_time,
                                          .deadline = deadline,
                                          .describe = describe };

    bench_init(&bench);
    talk_run(&talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
    od_done(&bench.od);
}
END_TEST

/* All types: those up to 240 wait for the SYNC. */
START_TEST(every_type)
{
    struct bench bench;
    char text[32];
    const struct co_frame frame = talk_frame("205#11223344");
    struct co_outbox out;

    co_outbox_init(&out, NULL, 0, NULL, 0);
    bench_init(&bench);
    snprintf(text, sizeof text, "set 205 %d 0", _i);
    configure(&bench, text);
    rpdo_start(&bench.rpdo);
    rpdo_on_frame(&bench.rpdo, &frame, false, 0, &out);
    compare(&bench, _i <= 240 ? "is 0000 0000" : "is 2211 4433");
    rpdo_on_sync(&bench.rpdo);
    rpdo_on_time(&bench.rpdo, 0, &out);
    compare(&bench, "is 2211 4433");
    od_done(&bench.od);
}
END_TEST

START_TEST(requests)
{
    struct bench bench;
    struct co_frame frame;
    char text[32];

    bench_init(&bench);
    configure(&bench, "set 205 255 0");
    frame = rpdo_request_frame(&bench.rpdo);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "205#R4");
    configure(&bench, "set 3FFFFFFF 255 0");
    frame = rpdo_request_frame(&bench.rpdo);
    ck_assert_str_eq(co_frame_format(&frame, text, sizeof text), "1FFFFFFF#R4");
    od_done(&bench.od);
}
END_TEST

/* No room for the event: the data waits, and what comes behind takes its place. */
START_TEST(replaced_while_waiting_for_room)
{
    struct bench bench;
    struct co_frame frame = talk_frame("205#11223344");
    struct co_event events[1], event;
    struct co_outbox full, out;

    bench_init(&bench);
    co_outbox_init(&full, NULL, 0, NULL, 0);
    co_outbox_init(&out, NULL, 0, events, 1);
    configure(&bench, "set 205 255 0");
    bench.rpdo.notify = true;
    rpdo_start(&bench.rpdo);
    rpdo_on_frame(&bench.rpdo, &frame, false, 1, &full);
    compare(&bench, "is 0000 0000");
    ck_assert_uint_eq(rpdo_deadline(&bench.rpdo), 0);
    frame = talk_frame("205#55667788");
    rpdo_on_frame(&bench.rpdo, &frame, false, 2, &full);
    rpdo_on_time(&bench.rpdo, 3, &out);
    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.actual, 2);
    compare(&bench, "is 6655 8877");
    compare(&bench, "counts 1 0 1 0");
    ck_assert_uint_eq(rpdo_deadline(&bench.rpdo), CO_NEVER);
    od_done(&bench.od);
}
END_TEST

static Suite *make_suite(void)
{
    Suite *suite = suite_create("rpdo");
    TCase *tcase = tcase_create("rpdo");

    suite_add_tcase(suite, tcase);
    tcase_add_loop_test(tcase, conversation, 0, TALKS * TALK_STALLS);
    tcase_add_loop_test(tcase, every_type, 0, 256);
    tcase_add_test(tcase, requests);
    tcase_add_test(tcase, replaced_while_waiting_for_room);
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

/* Emergencies: the producer's queue and inhibit time, frames of others, texts. */
#include "proto/emcy.h"

#include "proto/event.h"
#include "support/hex.h"
#include "support/talk.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

/* clang-format off */
static const struct talk talks[] = {
    { "at once, in order", {
        { 0, CALL, "enable" },
        { 1, CALL, "raise 8130 11" },
        { 1, SENT, "085#3081110102030405" },
        { 2, CALL, "raise 0000 00" },
        { 2, SENT, "085#0000000102030405" },
        { 9, IDLE, NULL } } },
    { "not before the device is pre-operational", {
        { 1, CALL, "raise 8130 11" },
        { 1, CALL, "raise 8110 11" },
        { 5, IDLE, NULL },
        { 6, CALL, "enable" },
        { 6, SENT, "085#3081110102030405" },
        { 6, SENT, "085#1081110102030405" },
        { 7, CALL, "disable" },
        { 8, CALL, "raise 8140 11" },
        { 9, IDLE, NULL } } },
    { "inhibit time: each event has its frame", {
        { 0, CALL, "enable" },
        { 0, CALL, "inhibit 100" },
        { 10, CALL, "raise 8110 11" },
        { 10, SENT, "085#1081110102030405" },
        { 20, CALL, "raise 8120 11" },
        { 30, CALL, "raise 8130 11" },
        { 109, QUIET, NULL },
        { 110, SENT, "085#2081110102030405" },
        { 209, QUIET, NULL },
        { 210, SENT, "085#3081110102030405" },
        { 309, IDLE, NULL },
        { 309, CALL, "raise 8140 11" },
        { 310, SENT, "085#4081110102030405" },
        { 500, CALL, "raise 8150 11" },
        { 500, SENT, "085#5081110102030405" } } },
    { "another inhibit time holds for the emergency sent last", {
        { 0, CALL, "enable" },
        { 0, CALL, "inhibit 1000" },
        { 10, CALL, "raise 8110 11" },
        { 10, SENT, "085#1081110102030405" },
        { 20, CALL, "raise 8120 11" },
        { 30, CALL, "inhibit 50" },
        { 59, QUIET, NULL },
        { 60, SENT, "085#2081110102030405" },
        { 61, CALL, "raise 8130 11" },
        { 61, CALL, "inhibit 0" },
        { 61, SENT, "085#3081110102030405" } } },
    { "1014h", {
        { 0, CALL, "enable" },
        { 0, CALL, "cob_id 1A5" },
        { 1, CALL, "raise 1000 01" },
        { 1, SENT, "1A5#0010010102030405" },
        { 2, CALL, "cob_id 3abcdef1" },
        { 2, CALL, "raise 1000 01" },
        { 2, SENT, "1ABCDEF1#0010010102030405" },
        { 3, CALL, "cob_id 80000085" },
        { 3, CALL, "raise 1000 01" },
        { 3, CALL, "cob_id 85" },
        { 9, IDLE, NULL } } },
    { "1014h made invalid drops what waits", {
        { 1, CALL, "raise 1000 01" },
        { 2, CALL, "cob_id 80000085" },
        { 3, CALL, "cob_id 85" },
        { 4, CALL, "enable" },
        { 9, IDLE, NULL } } },
};
/* clang-format on */

#define TALK_COUNT ((int)(sizeof talks / sizeof talks[0]))

static void raise_error(struct emcy_producer *self, unsigned code, unsigned error_register)
{
    const struct emcy_message message = { .code = (uint16_t)code,
                                          .error_register = (uint8_t)error_register,
                                          .field = { 1, 2, 3, 4, 5 } };

    emcy_producer_raise(self, &message);
}

static bool call(void *machine, const char *text, co_us_t now, struct co_outbox *out)
{
    struct emcy_producer *self = machine;
    unsigned code = 0, error_register = 0;

    (void)now;
    (void)out;
    if (sscanf(text, "raise %x %x", &code, &error_register) == 2)
        raise_error(self, code, error_register);
    else if (sscanf(text, "inhibit %u", &code) == 1)
        emcy_producer_configure(self, self->cob_id, CO_MS(code));
    else if (sscanf(text, "cob_id %x", &code) == 1)
        emcy_producer_configure(self, code, self->inhibit);
    else
        emcy_producer_enable(self, strcmp(text, "enable") == 0);
    return true;
}

static void on_time(void *machine, co_us_t now, struct co_outbox *out)
{
    emcy_producer_on_time(machine, now, out);
}

static co_us_t deadline(const void *machine)
{
    return emcy_producer_deadline(machine);
}

START_TEST(test_producer)
{
    struct emcy_producer producer;
    const struct talk_machine machine = {
        .self = &producer, .call = call, .on_time = on_time, .deadline = deadline
    };

    emcy_producer_init(&producer, 0x85);
    talk_run(&talks[_i / TALK_STALLS], &machine, (enum talk_stall)(_i % TALK_STALLS));
}
END_TEST

/* The queue is bounded; the first errors are kept, and the last one; the others are counted. */
START_TEST(test_queue_full)
{
    struct emcy_producer producer;
    struct co_frame frames[2], frame;
    struct co_outbox out;
    unsigned sent;

    emcy_producer_init(&producer, 0x85);
    emcy_producer_enable(&producer, true);
    for (unsigned round = 0; round < 3; round++) { /* the ring turns */
        for (unsigned i = 0; i < EMCY_QUEUE_MAX + round; i++)
            raise_error(&producer, 0x1000 + i, 1);
        ck_assert(emcy_producer_is_full(&producer));
        sent = 0;
        for (unsigned i = 0; emcy_producer_deadline(&producer) != CO_NEVER; i++) {
            co_outbox_init(&out, frames, 1 + i % 2, NULL, 0);
            emcy_producer_on_time(&producer, 5, &out);
            for (; co_outbox_take_frame(&out, &frame); sent++)
                ck_assert_uint_eq(frame.data[0], sent < EMCY_QUEUE_MAX - 1 ? sent : sent + round);
            ck_assert(!emcy_producer_is_full(&producer));
        }
        ck_assert_uint_eq(sent, EMCY_QUEUE_MAX);
    }
    ck_assert_uint_eq(producer.lost, 0 + 1 + 2);
}
END_TEST

static const struct {
    const char *frame;
    uint8_t node; /* 0: no emergency */
    uint16_t code;
    uint8_t error_register;
    const char *data;
} frames[] = {
    { "085#3081110102030405", 5, 0x8130, 0x11, "3081110102030405" },
    { "081#0000000000000000", 1, 0, 0, "0000000000000000" },
    { "0FF#00FF80", 127, 0xFF00, 0x80, "00FF800000000000" },
    { "085#3081", 5, 0x8130, 0, "3081000000000000" },
    { "085#30", 0, 0, 0, "" },
    { "085#", 0, 0, 0, "" }, /* boot-up of an old device */
    { "080#3081110102030405", 0, 0, 0, "" },
    { "100#3081110102030405", 0, 0, 0, "" },
    { "085#R8", 0, 0, 0, "" },
    { "00000085#3081110102030405", 0, 0, 0, "" },
};

START_TEST(test_parse)
{
    const struct co_frame frame = talk_frame(frames[_i].frame);
    struct co_event event = { .node = 0 };
    char text[17];

    ck_assert_int_eq(emcy_parse(&frame, &event), frames[_i].node != 0);
    ck_assert_uint_eq(event.node, frames[_i].node);
    ck_assert_uint_eq(event.code, frames[_i].code);
    ck_assert_uint_eq(event.detail, frames[_i].error_register);
    if (frames[_i].node == 0)
        return;
    ck_assert_uint_eq(event.type, PROTO_EMCY);
    ck_assert_str_eq(hex_format(event.data, 8, text, sizeof text), frames[_i].data);
}
END_TEST

static const struct {
    uint16_t code;
    const char *text;
} texts[] = {
    { 0x0000, "error reset or no error" },
    { 0x0012, "error reset or no error" },
    { 0x1000, "generic error" },
    { 0x10FF, "generic error" },
    { 0x2310, "current, device output side" },
    { 0x3210, "voltage inside the device" },
    { 0x4210, "device temperature" },
    { 0x5441, "device hardware" },
    { 0x6320, "data set" },
    { 0x7305, "additional modules" },
    { 0x8000, "monitoring" },
    { 0x8100, "communication" },
    { 0x8110, "CAN overrun, objects lost" },
    { 0x8120, "CAN controller in error passive mode" },
    { 0x8130, "heartbeat or life guarding error" },
    { 0x8131, "communication" },
    { 0x8140, "recovered from bus-off" },
    { 0x8150, "CAN-ID collision" },
    { 0x8210, "PDO not processed because of its length" },
    { 0x8220, "PDO length exceeded" },
    { 0x8230, "multiplexed PDO not processed, no such object" },
    { 0x8240, "unexpected SYNC data length" },
    { 0x8250, "RPDO time-out" },
    { 0x8611, "monitoring" },
    { 0x9000, "external error" },
    { 0xF001, "additional functions" },
    { 0xFF05, "device specific" },
    { 0xA000, "unknown error code" },
    { 0x0100, "unknown error code" },
};

START_TEST(test_texts)
{
    ck_assert_str_eq(emcy_text(texts[_i].code), texts[_i].text);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("emcy");
    TCase *tcase = tcase_create("emcy");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_producer, 0, TALK_COUNT * TALK_STALLS);
    tcase_add_test(tcase, test_queue_full);
    tcase_add_loop_test(tcase, test_parse, 0, sizeof frames / sizeof frames[0]);
    tcase_add_loop_test(tcase, test_texts, 0, sizeof texts / sizeof texts[0]);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* SDO client against SDO server: every size there and back, also with frames that get lost. */
#include "proto/event.h"
#include "proto/sdo_client.h"
#include "proto/sdo_server.h"
#include "support/hex.h"

#include <check.h>
#include <string.h>

#define NODE    5
#define SIZES   300u
#define LARGE   20000u /* far more than 255 segments */
#define TIMEOUT CO_MS(100)

struct loop {
    struct od od;
    struct od_entry *entry;
    struct sdo_client client;
    struct sdo_server server;
    struct co_outbox to_server, to_client;
    struct co_frame frames[2][2];
    struct co_event events[2][2];
    uint8_t server_buffer[LARGE];
    uint8_t data[LARGE];
    uint64_t seed;
    unsigned loss; /* one frame of so many is lost; 0: none */
    struct co_event end;
    unsigned toggles[2]; /* upload segments seen with either toggle bit */
    co_us_t now;
};

static struct loop loop;

static void setup(void)
{
    const struct od_spec spec = {
        .index = 0x2000, .type = OD_DOMAIN, .access = OD_RW, .capacity = LARGE
    };

    memset(&loop, 0, sizeof loop);
    loop.seed = 1;
    od_init(&loop.od);
    ck_assert_int_eq(od_add(&loop.od, &spec, &loop.entry), CO_OK);
    sdo_server_init(&loop.server, &loop.od, NODE, loop.server_buffer, LARGE);
    sdo_server_enable(&loop.server, true);
    sdo_client_init(&loop.client, NODE);
    co_outbox_init(&loop.to_server, loop.frames[0], 2, loop.events[0], 2);
    co_outbox_init(&loop.to_client, loop.frames[1], 2, loop.events[1], 2);
}

static void teardown(void)
{
    od_done(&loop.od);
}

static bool is_lost(void)
{
    return loop.loss != 0 && noise(&loop.seed) % loop.loss == 0;
}

static void serve_writes(void)
{
    struct co_event event;

    while (co_outbox_take_event(&loop.to_client, &event)) {
        ck_assert_uint_eq(event.type, PROTO_SDO_WRITE);
        sdo_server_verdict(
            &loop.server,
            od_set(loop.entry, sdo_server_value(&loop.server), (uint32_t)event.actual), loop.now,
            &loop.to_client);
    }
}

/* All frames that are on the way, and their answers. */
static void exchange(void)
{
    struct co_frame frame;

    while (loop.to_server.frame_count > 0 || loop.to_client.frame_count > 0) {
        while (co_outbox_take_frame(&loop.to_server, &frame)) {
            if (!is_lost())
                sdo_server_on_frame(&loop.server, &frame, loop.now, &loop.to_client);
            frame.flags |= CO_FRAME_OWN;
            sdo_client_on_frame(&loop.client, &frame, loop.now, &loop.to_server);
            serve_writes();
        }
        while (co_outbox_take_frame(&loop.to_client, &frame)) {
            loop.toggles[frame.data[0] >> 4 & 1] += frame.data[0] < 0x20;
            if (!is_lost())
                sdo_client_on_frame(&loop.client, &frame, loop.now, &loop.to_server);
        }
    }
}

static void run(const struct sdo_transfer *transfer)
{
    sdo_client_start(&loop.client, transfer, loop.now, &loop.to_server);
    while (sdo_client_busy(&loop.client)) {
        exchange();
        loop.now += CO_MS(1);
        sdo_client_on_time(&loop.client, loop.now, &loop.to_server);
        sdo_server_on_time(&loop.server, loop.now, &loop.to_client);
        exchange();
    }
    ck_assert(co_outbox_take_event(&loop.to_server, &loop.end));
    ck_assert_uint_eq(loop.end.type, PROTO_SDO_DONE);
    ck_assert(!co_outbox_take_event(&loop.to_server, &loop.end));
}

static void download(uint32_t size, bool indicate_size)
{
    const struct sdo_transfer transfer = { .download = true,
                                           .indicate_size = indicate_size,
                                           .index = 0x2000,
                                           .source = loop.data,
                                           .size = size,
                                           .timeout = TIMEOUT };

    for (uint32_t i = 0; i < size; i++)
        loop.data[i] = (uint8_t)noise(&loop.seed);
    run(&transfer);
}

static void upload(uint32_t room)
{
    const struct sdo_transfer transfer = {
        .index = 0x2000, .buffer = loop.data, .size = room, .timeout = TIMEOUT
    };

    memset(loop.data, 0xA5, sizeof loop.data);
    run(&transfer);
}

static void check_there_and_back(uint32_t size, bool indicate_size)
{
    download(size, indicate_size);
    ck_assert_uint_eq(loop.end.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(loop.end.actual, size);
    ck_assert_uint_eq(loop.entry->size, size);
    ck_assert_mem_eq(loop.entry->value, loop.data, size);
    upload(size);
    ck_assert_uint_eq(loop.end.detail, SDO_OUTCOME_OK);
    ck_assert_uint_eq(loop.end.actual, size);
    ck_assert_mem_eq(loop.entry->value, loop.data, size);
    ck_assert_uint_eq(loop.data[size], 0xA5);
}

START_TEST(test_all_sizes)
{
    for (uint32_t size = 0; size <= SIZES; size++)
        check_there_and_back(size, _i != 0);
    ck_assert_uint_eq(loop.client.late, 0);
    ck_assert_uint_eq(loop.server.dropped, 0);
}
END_TEST

/* K51: the toggle bit alternates throughout a transfer of more than 255 segments. */
START_TEST(test_large)
{
    const unsigned segments = (LARGE - 1 + 6) / 7;

    check_there_and_back(LARGE - 1, true);
    ck_assert_uint_eq(loop.toggles[0], (segments + 1) / 2);
    ck_assert_uint_eq(loop.toggles[1], segments / 2);
}
END_TEST

START_TEST(test_overflow)
{
    download(50, true);
    upload(49);
    ck_assert_uint_eq(loop.end.detail, SDO_OUTCOME_OVERFLOW);
    ck_assert_uint_eq(loop.end.actual, 50);
    ck_assert_uint_eq(loop.server.state, SDO_SERVER_IDLE);
    check_there_and_back(50, false);
}
END_TEST

/* With frames lost every transfer ends, and what went well is complete. */
START_TEST(test_losses)
{
    unsigned good = 0, bad = 0;

    loop.seed = (uint64_t)_i + 1;
    loop.loss = 20;
    for (unsigned i = 0; i < 400; i++) {
        const uint32_t size = noise(&loop.seed) % 60;

        download(size, i % 2);
        if (loop.end.detail == SDO_OUTCOME_OK)
            ck_assert_mem_eq(loop.entry->value, loop.data, size);
        upload(60);
        if (loop.end.detail == SDO_OUTCOME_OK) {
            ck_assert_uint_eq(loop.end.actual, loop.entry->size);
            ck_assert_mem_eq(loop.entry->value, loop.data, loop.entry->size);
            good++;
        } else {
            bad++;
        }
        loop.now += CO_MS(2000);
        sdo_server_on_time(&loop.server, loop.now, &loop.to_client);
        exchange();
    }
    ck_assert_uint_gt(good, 50);
    ck_assert_uint_gt(bad, 50);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_loop");
    TCase *tcase = tcase_create("sdo_loop");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_loop_test(tcase, test_all_sizes, 0, 2);
    tcase_add_test(tcase, test_large);
    tcase_add_test(tcase, test_overflow);
    tcase_add_loop_test(tcase, test_losses, 0, 4);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

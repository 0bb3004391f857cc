#include "manager/sdo_channel.h"

#include "proto/event.h"
#include "support/suite.h"

#include <stdlib.h>
#include <string.h>

#define NODE 5

/* A channel, three requests, and what comes out; 'now' is the test's. */
static struct sdo_channel channel;
static unsigned block_downloads;
static struct sdo_request requests[4];
static uint8_t buffers[4][8];
static struct co_frame frames[8];
static struct co_event events[8];
static struct co_outbox out;
static co_us_t now;

static void set_up_with_room(unsigned frame_room, unsigned event_room)
{
    memset(requests, 0, sizeof requests);
    co_outbox_init(&out, frames, frame_room, events, event_room);
    block_downloads = 0;
    sdo_channel_init(&channel, NODE, &block_downloads);
    now = CO_MS(1000);
}

static void set_up(void)
{
    set_up_with_room(8, 8);
}

static void fill(unsigned i)
{
    requests[i].transfer = (struct sdo_transfer){
        .index = (uint16_t)(0x2000 + i), .buffer = buffers[i], .size = 8, .timeout = CO_MS(100)
    };
}

static void submit(unsigned i)
{
    fill(i);
    sdo_channel_submit(&channel, &requests[i], now, &out);
}

static void submit_block(unsigned i)
{
    requests[i].transfer = (struct sdo_transfer){ .index = (uint16_t)(0x2000 + i),
                                                  .block = 8,
                                                  .buffer = buffers[i],
                                                  .size = 8,
                                                  .timeout = CO_MS(100) };
    sdo_channel_submit(&channel, &requests[i], now, &out);
}

/* Without a bus: the number of the request that ended. */
static int give_up(void)
{
    struct sdo_request *request = sdo_channel_give_up(&channel);

    return request ? (int)(request - requests) : -1;
}

static void expect_frame(const char *text)
{
    struct co_frame frame, expected;
    char is[CO_FRAME_TEXT_SIZE];

    ck_assert_msg(co_outbox_take_frame(&out, &frame), "no %s", text);
    ck_assert(co_frame_parse(text, &expected));
    ck_assert_msg(co_frame_equal(&frame, &expected), "%s, not %s",
                  co_frame_format(&frame, is, sizeof is), text);
}

static void expect_silence(void)
{
    struct co_frame frame;

    ck_assert(!co_outbox_take_frame(&out, &frame));
}

static void receive(const char *text, bool own)
{
    struct co_frame frame;

    ck_assert(co_frame_parse(text, &frame));
    if (own)
        frame.flags |= CO_FRAME_OWN;
    sdo_client_on_frame(&channel.client, &frame, now, &out);
}

/* Hands the client's next event over; the number of the request that has ended, -1: none. */
static int next_done(void)
{
    struct co_event event;
    struct sdo_request *request;

    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.type, PROTO_SDO_DONE);
    request = sdo_channel_on_done(&channel, &event, now, &out);
    return request ? (int)(request - requests) : -1;
}

static void expect_no_event(void)
{
    ck_assert_uint_eq(out.event_count, 0);
}

/* --- the queue --- */

START_TEST(test_one_at_a_time)
{
    submit(0);
    submit(1);
    submit(2);
    ck_assert_int_eq(requests[0].state, REQUEST_RUNNING);
    ck_assert_int_eq(requests[1].state, REQUEST_QUEUED);
    expect_frame("605#4000200000000000");
    expect_silence();
    receive("585#4F00200007000000", false);
    expect_silence();
    ck_assert_int_eq(next_done(), 0);
    ck_assert_int_eq(requests[0].state, REQUEST_DONE);
    ck_assert_uint_eq(requests[0].result.actual, 1);
    ck_assert_uint_eq(buffers[0][0], 7);
    expect_frame("605#4001200000000000");
    expect_silence();
    receive("585#8001200011000906", false);
    ck_assert_int_eq(next_done(), 1);
    ck_assert_uint_eq(requests[1].result.code, SDO_NO_SUB);
    expect_frame("605#4002200000000000");
    receive("585#4F02200009000000", false);
    ck_assert_int_eq(next_done(), 2);
    expect_silence();
    expect_no_event();
    submit(0); /* and again */
    expect_frame("605#4000200000000000");
}
END_TEST

/* Before those that wait, not before the one that runs; alone, and behind nothing, as well. */
START_TEST(test_first)
{
    if (_i == 1)
        submit(0);
    if (_i == 1)
        submit(1);
    fill(2);
    sdo_channel_submit_first(&channel, &requests[2], now, &out);
    if (_i == 1) {
        expect_frame("605#4000200000000000");
        expect_silence();
        receive("585#4F00200007000000", false);
        ck_assert_int_eq(next_done(), 0);
    }
    expect_frame("605#4002200000000000");
    submit(3);
    receive("585#4F02200009000000", false);
    ck_assert_int_eq(next_done(), 2);
    if (_i == 1) {
        expect_frame("605#4001200000000000");
        receive("585#4F01200009000000", false);
        ck_assert_int_eq(next_done(), 1);
    }
    expect_frame("605#4003200000000000");
    expect_silence();
}
END_TEST

/* The time-out begins when the turn has come, and the request is on the wire. */
START_TEST(test_time_out)
{
    submit(0);
    submit(1);
    now += CO_MS(500);
    receive("605#4000200000000000", true);
    expect_frame("605#4000200000000000");
    now += CO_MS(100) - 1;
    sdo_client_on_time(&channel.client, now, &out);
    expect_no_event();
    now += 1;
    sdo_client_on_time(&channel.client, now, &out);
    expect_frame("605#8000200000000405");
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_NO_ANSWER);
    expect_frame("605#4001200000000000");
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), now + SDO_SEND_TIMEOUT);
}
END_TEST

/* Where no frame comes back the owner knows when the request has left. */
START_TEST(test_handed_over)
{
    submit(0);
    ck_assert(sdo_client_awaits_wire(&channel.client));
    now += CO_MS(500);
    sdo_client_on_handed_over(&channel.client, now);
    ck_assert(!sdo_client_awaits_wire(&channel.client));
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), now + CO_MS(100));
    now += CO_MS(100) - 1;
    sdo_client_on_handed_over(&channel.client, now); /* it was, before: nothing new */
    expect_frame("605#4000200000000000");
    now++;
    sdo_client_on_time(&channel.client, now, &out);
    expect_frame("605#8000200000000405");
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_NO_ANSWER);
    sdo_client_on_handed_over(&channel.client, now);
    ck_assert(!sdo_client_awaits_wire(&channel.client));
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), CO_NEVER);
}
END_TEST

/* What has found no room in the outbox has not left. */
START_TEST(test_handed_over_without_room)
{
    co_outbox_init(&out, NULL, 0, NULL, 0);
    submit(0);
    ck_assert(!sdo_client_awaits_wire(&channel.client));
    sdo_client_on_handed_over(&channel.client, now);
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), 0);
    sdo_client_on_time(&channel.client, now + SDO_SEND_TIMEOUT - 1, &out);
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), 0);
}
END_TEST

/* A request that is only queued for the wire is patient as long as others get there. */
START_TEST(test_progress)
{
    submit(0);
    now += SDO_SEND_TIMEOUT - 1;
    sdo_client_on_progress(&channel.client, now);
    now += SDO_SEND_TIMEOUT - 1;
    sdo_client_on_time(&channel.client, now, &out);
    expect_no_event();
    receive("605#4000200000000000", true);
    sdo_client_on_progress(&channel.client, now); /* no longer: now it is the server's time */
    now += CO_MS(100);
    sdo_client_on_time(&channel.client, now, &out);
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_NO_ANSWER);
    sdo_client_on_progress(&channel.client, now);
    ck_assert_uint_eq(sdo_client_deadline(&channel.client), CO_NEVER);
}
END_TEST

/* ... but not for ever: it may have been lost. */
START_TEST(test_progress_has_a_limit)
{
    co_us_t begin = now;

    submit(0);
    while (now < begin + SDO_SEND_LIMIT - 1) {
        now = co_earlier(now + CO_MS(100), begin + SDO_SEND_LIMIT - 1);
        sdo_client_on_progress(&channel.client, now);
        sdo_client_on_time(&channel.client, now, &out);
        expect_no_event();
    }
    now++;
    sdo_client_on_time(&channel.client, now, &out);
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(requests[0].result.detail, SDO_OUTCOME_NOT_SENT);
}
END_TEST

/* --- taking back --- */

/* The first, the middle, the last one of those that wait. */
START_TEST(test_cancel_waiting)
{
    static const int order[3][2] = { { 1, 2 }, { 2, 1 }, { 1, -1 } };
    struct sdo_request *victim = &requests[order[_i][0]];

    submit(0);
    submit(1);
    if (_i < 2)
        submit(2);
    ck_assert(sdo_channel_cancel(&channel, victim, SDO_TIMEOUT, now, &out));
    ck_assert_int_eq(victim->state, REQUEST_IDLE);
    expect_no_event();
    expect_frame("605#4000200000000000");
    receive("585#4F00200007000000", false);
    ck_assert_int_eq(next_done(), 0);
    if (order[_i][1] < 0) {
        expect_silence();
        submit(2); /* the end of the queue is where it should be */
        ck_assert_int_eq(requests[2].state, REQUEST_RUNNING);
        return;
    }
    ck_assert_int_eq(requests[order[_i][1]].state, REQUEST_RUNNING);
    submit((unsigned)order[_i][0]);
    ck_assert_int_eq(victim->state, REQUEST_QUEUED);
}
END_TEST

/* A running one, with and without telling the server; the next one starts and is not confused. */
START_TEST(test_cancel_running)
{
    submit(0);
    submit(1);
    expect_frame("605#4000200000000000");
    ck_assert(sdo_channel_cancel(&channel, &requests[0], _i ? SDO_TIMEOUT : SDO_OK, now, &out));
    ck_assert_int_eq(requests[0].state, REQUEST_IDLE);
    ck_assert_int_eq(requests[1].state, REQUEST_RUNNING);
    expect_frame("605#4001200000000000");
    receive("585#4F00200007000000", false); /* late */
    if (_i)
        ck_assert_int_eq(next_done(), -1);
    expect_no_event();
    receive("585#4F01200008000000", false);
    ck_assert_int_eq(next_done(), 1);
    ck_assert_uint_eq(buffers[1][0], 8);
}
END_TEST

/* In the middle of segments the server is told. */
START_TEST(test_cancel_segments)
{
    submit(0);
    expect_frame("605#4000200000000000");
    receive("585#4000200000000000", false);
    expect_frame("605#6000000000000000");
    ck_assert(sdo_channel_cancel(&channel, &requests[0], SDO_TIMEOUT, now, &out));
    expect_frame("605#8000200000000405");
    ck_assert_int_eq(next_done(), -1);
}
END_TEST

/*
 * It has ended, but its owner has not heard of it yet when it is taken back: that end is nobody
 * else's.
 */
START_TEST(test_cancel_ended)
{
    submit(0);
    submit(1);
    expect_frame("605#4000200000000000");
    receive("585#4F00200007000000", false);
    ck_assert(sdo_channel_cancel(&channel, &requests[0], _i ? SDO_TIMEOUT : SDO_OK, now, &out));
    ck_assert_int_eq(requests[0].state, REQUEST_IDLE);
    ck_assert_int_eq(next_done(), -1);
    ck_assert_int_eq(requests[1].state, REQUEST_RUNNING);
    expect_frame("605#4001200000000000");
    receive("585#4F01200008000000", false);
    ck_assert_int_eq(next_done(), 1);
    submit(0);
    ck_assert_int_eq(requests[0].state, REQUEST_RUNNING);
}
END_TEST

/* A node that has no blocks is asked for them once, until it may be another one. */
START_TEST(test_no_blocks)
{
    submit_block(0);
    expect_frame("605#A400200008000000");
    submit_block(1);
    submit_block(2);
    receive("585#8000200001000405", false);
    expect_frame("605#4000200000000000");
    receive("585#4F00200007000000", false);
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(buffers[0][0], 7);
    expect_frame("605#4001200000000000");
    ck_assert_int_eq(give_up(), 1);
    sdo_channel_forget(&channel);
    ck_assert_int_eq(give_up(), 2);
    submit_block(0);
    expect_frame("605#A400200008000000");
}
END_TEST

static void submit_block_download(unsigned i)
{
    requests[i].transfer = (struct sdo_transfer){ .download = true,
                                                  .block = 8,
                                                  .index = (uint16_t)(0x2000 + i),
                                                  .source = buffers[i],
                                                  .size = 8,
                                                  .timeout = CO_MS(100) };
    sdo_channel_submit(&channel, &requests[i], now, &out);
}

/* Many others run: in segments. However a block download ends, it counts no longer. */
START_TEST(test_block_downloads_are_few)
{
    block_downloads = SDO_CHANNEL_BLOCK_DOWNLOADS;
    submit_block_download(0);
    expect_frame("605#2000200000000000");
    receive("585#8000200022000008", false);
    ck_assert_int_eq(next_done(), 0);
    submit_block(0);
    expect_frame("605#A400200008000000");
    ck_assert(sdo_channel_cancel(&channel, &requests[0], SDO_OK, now, &out));
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS);
    block_downloads--;
    submit_block_download(0);
    expect_frame("605#C600200008000000");
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS);
    receive("585#8000200022000008", false);
    ck_assert_int_eq(next_done(), 0);
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS - 1);
    submit_block_download(0);
    ck_assert_int_eq(give_up(), 0);
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS - 1);
}
END_TEST

/* Taken out, and the next one starts at once, in blocks again. */
START_TEST(test_block_download_is_cancelled)
{
    block_downloads = SDO_CHANNEL_BLOCK_DOWNLOADS - 1;
    submit_block_download(0);
    submit_block_download(1);
    expect_frame("605#C600200008000000");
    ck_assert(sdo_channel_cancel(&channel, &requests[0], _i ? SDO_TIMEOUT : SDO_OK, now, &out));
    if (_i)
        expect_frame("605#8000200000000405");
    expect_frame("605#C601200008000000");
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS);
    if (_i)
        ck_assert_int_eq(next_done(), -1);
    receive("585#8001200022000008", false);
    ck_assert_int_eq(next_done(), 1);
    ck_assert_uint_eq(block_downloads, SDO_CHANNEL_BLOCK_DOWNLOADS - 1);
}
END_TEST

/* No room to tell the server: not now, and nothing has changed. */
START_TEST(test_cancel_without_room)
{
    struct co_frame frame = co_frame_make(0x123, 0);

    set_up_with_room(1, 1);
    submit(0);
    submit(1);
    expect_frame("605#4000200000000000");
    receive("585#4000200000000000", false); /* the next request fills the outbox */
    ck_assert(!sdo_channel_cancel(&channel, &requests[0], SDO_TIMEOUT, now, &out));
    ck_assert_int_eq(requests[0].state, REQUEST_RUNNING);
    expect_frame("605#6000000000000000");
    ck_assert(sdo_channel_cancel(&channel, &requests[0], SDO_TIMEOUT, now, &out));
    expect_frame("605#8000200000000405");
    co_outbox_put_frame(&out, &frame);
    ck_assert_int_eq(next_done(), -1);
    ck_assert_int_eq(requests[1].state, REQUEST_RUNNING);
    expect_frame("123#");
    sdo_client_on_time(&channel.client, now, &out);
    expect_frame("605#4001200000000000");
}
END_TEST

/* The end of a transfer finds no room for its event. */
START_TEST(test_cancel_with_end_untold)
{
    const struct co_event filler = { .type = PROTO_SDO_DONE, .node = 99 };
    struct co_event event;

    set_up_with_room(8, 1);
    submit(0);
    submit(1);
    co_outbox_put_event(&out, &filler);
    receive("585#4F00200007000000", false);
    ck_assert(sdo_channel_cancel(&channel, &requests[0], SDO_OK, now, &out));
    ck_assert_int_eq(requests[1].state, REQUEST_RUNNING);
    ck_assert(co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(event.node, 99);
    receive("585#4F01200008000000", false);
    ck_assert_int_eq(next_done(), 1);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("sdo_channel");

    tcase_add_checked_fixture(tcase, set_up, NULL);
    tcase_add_test(tcase, test_one_at_a_time);
    tcase_add_loop_test(tcase, test_first, 0, 2);
    tcase_add_test(tcase, test_time_out);
    tcase_add_test(tcase, test_handed_over);
    tcase_add_test(tcase, test_handed_over_without_room);
    tcase_add_test(tcase, test_progress);
    tcase_add_test(tcase, test_progress_has_a_limit);
    tcase_add_loop_test(tcase, test_cancel_waiting, 0, 3);
    tcase_add_loop_test(tcase, test_cancel_running, 0, 2);
    tcase_add_test(tcase, test_cancel_segments);
    tcase_add_loop_test(tcase, test_cancel_ended, 0, 2);
    tcase_add_test(tcase, test_no_blocks);
    tcase_add_test(tcase, test_block_downloads_are_few);
    tcase_add_loop_test(tcase, test_block_download_is_cancelled, 0, 2);
    tcase_add_test(tcase, test_cancel_without_room);
    tcase_add_test(tcase, test_cancel_with_end_untold);
    return suite_run("sdo_channel", tcase);
}

/* SDO client against SDO server in blocks: sizes, sizes of sub-blocks, outboxes, lost frames. */
#include "support/hex.h"
#include "support/sdo_loop.h"

#include <check.h>

#define SIZES 2000u
#define DENSE 900u  /* all sizes up to here, which is more than a sub-block */
#define ALONE 0x81u /* a segment that is the first and the last one of its sub-block */

static const unsigned rooms[] = { 1, 2, 7, LOOP_ROOM };
#define ROOMS ((int)(sizeof rooms / sizeof rooms[0]))

static struct sdo_loop loop;

static void setup(unsigned room, unsigned block)
{
    sdo_loop_init(&loop, room);
    loop.indicate_size = true;
    loop.block = (uint8_t)block;
    loop.server.block_limit = (uint8_t)block;
}

static void teardown(void)
{
    sdo_loop_done(&loop);
}

/* Sizes in the largest sub-blocks, or with every size of these in turn. */
START_TEST(test_all_sizes)
{
    setup(rooms[_i], SDO_BLOCK_MAX);
    for (uint32_t size = 0; size <= SIZES; size += size < DENSE ? 1 : 11) {
        if (_i % 2)
            loop.block = loop.server.block_limit = (uint8_t)(1 + size % SDO_BLOCK_MAX);
        loop.indicate_size = size % 3 != 0;
        sdo_loop_check(&loop, size);
    }
    ck_assert_uint_eq(loop.client.late, 0);
    ck_assert_uint_eq(loop.server.dropped, 0);
    ck_assert_uint_eq(loop.now, 0);
    teardown();
}
END_TEST

START_TEST(test_large)
{
    setup(rooms[_i], SDO_BLOCK_MAX);
    sdo_loop_check(&loop, _i % 2 ? LOOP_LARGE : 100000);
    ck_assert_uint_eq(loop.now, 0);
    teardown();
}
END_TEST

/* With room for a sub-block all of it comes in one call: two for each segment, and little else. */
START_TEST(test_room_is_used)
{
    const uint32_t segments = (100000 + 6) / 7;

    setup(LOOP_ROOM, SDO_BLOCK_MAX);
    sdo_loop_download(&loop, 100000);
    ck_assert_uint_lt(loop.calls, segments + segments / 50);
    sdo_loop_upload(&loop, 100000);
    ck_assert_uint_lt(loop.calls, segments + segments / 50);
    teardown();
}
END_TEST

static unsigned segments_lost;

static bool is_segment(const struct sdo_loop *self, bool to_server)
{
    return to_server ? self->client.state == SDO_CLIENT_BLOCK_DOWN
                     : self->server.state == SDO_SERVER_BLOCK_UP;
}

/*
 * The only frame that gets lost has the number 'loss', from 1. A segment that was alone in its
 * sub-block is none that is sent again: nothing was heard of this.
 */
static bool loses_one(struct sdo_loop *self, const struct co_frame *frame, bool to_server)
{
    const bool lost = self->count == self->loss;

    segments_lost += lost && is_segment(self, to_server) && frame->data[0] != ALONE;
    return lost;
}

static void check_end(bool must_be_good, uint32_t size)
{
    if (must_be_good)
        ck_assert_uint_eq(loop.end.detail, SDO_OUTCOME_OK);
    if (loop.end.detail != SDO_OUTCOME_OK)
        return;
    ck_assert_uint_eq(loop.end.actual, size);
    ck_assert_uint_eq(loop.entry->size, size);
    ck_assert_mem_eq(loop.entry->value, loop.data, size);
}

/*
 * Each frame of a transfer gets lost once. A segment is sent again; what else gets lost may cost
 * the transfer, not the next one.
 */
START_TEST(test_each_frame_lost)
{
    static const uint32_t sizes[] = { 0, 1, 7, 8, 14, 69, 70, 71, 140, 200 };
    const uint32_t size = sizes[_i];
    const uint32_t segments = size == 0 ? 1 : (size + 6) / 7;
    unsigned lost = 0, frames;

    setup(2, 10);
    sdo_loop_download(&loop, size);
    loop.loses = loses_one;
    for (frames = loop.count; lost < frames; lost++) {
        segments_lost = 0;
        loop.loss = lost + 1;
        sdo_loop_download(&loop, size);
        check_end(segments_lost > 0, size);
        sdo_loop_rest(&loop);
        loop.loss = 0;
        sdo_loop_check(&loop, size);
    }
    ck_assert_uint_gt(frames, segments + 3);
    for (lost = 0; lost < frames; lost++) {
        segments_lost = 0;
        loop.loss = lost + 1;
        sdo_loop_upload(&loop, size);
        check_end(segments_lost > 0, size);
        sdo_loop_rest(&loop);
    }
    teardown();
}
END_TEST

static unsigned largest;

/* Another size for each sub-block, from both sides; and some segments get lost. */
static bool changes_sizes(struct sdo_loop *self, const struct co_frame *frame, bool to_server)
{
    self->client.transfer.block = (uint8_t)(1 + noise(&self->seed) % SDO_BLOCK_MAX);
    self->server.block_limit = (uint8_t)(1 + noise(&self->seed) % SDO_BLOCK_MAX);
    if (!is_segment(self, to_server))
        return false;
    largest = frame->data[0] > largest && frame->data[0] < 0x80 ? frame->data[0] : largest;
    return noise(&self->seed) % 100 == 0;
}

START_TEST(test_changing_sizes)
{
    largest = 0;
    setup(rooms[_i % ROOMS], 4);
    loop.seed = (uint64_t)_i + 1;
    loop.loses = changes_sizes;
    for (unsigned i = 0; i < 20; i++)
        sdo_loop_check(&loop, noise(&loop.seed) % 20000);
    ck_assert_uint_gt(largest, 100);
    teardown();
}
END_TEST

/* A server that has no blocks, or not these. */
START_TEST(test_without_blocks)
{
    setup(2, 4);
    loop.server.block = false;
    sdo_loop_check(&loop, 100);
    ck_assert_uint_eq(loop.end.expected, 1);
    loop.block = 0;
    sdo_loop_check(&loop, 100);
    ck_assert_uint_eq(loop.end.expected, 0);
    teardown();
}
END_TEST

/* Where a transfer of almost 4 GiB ends, what its segments would reach is no 32-bit number. */
START_TEST(test_end_of_the_largest)
{
    static const uint8_t bytes[16];
    struct block_sender sender;

    block_sender_init(&sender, bytes, UINT32_MAX - 1, false);
    sender.position = sender.size - 8; /* a segment, and a byte */
    ck_assert_uint_eq(block_sender_begin(&sender, SDO_BLOCK_MAX), SDO_OK);
    sender.sent = 1;
    ck_assert(block_sender_has_segment(&sender));
    sender.sent = 2;
    ck_assert(!block_sender_has_segment(&sender));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sdo_loop_block");
    TCase *tcase = tcase_create("sdo_loop_block");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(tcase, test_all_sizes, 0, ROOMS);
    tcase_add_loop_test(tcase, test_large, 0, ROOMS);
    tcase_add_test(tcase, test_room_is_used);
    tcase_add_loop_test(tcase, test_each_frame_lost, 0, 10);
    tcase_add_loop_test(tcase, test_changing_sizes, 0, 8);
    tcase_add_test(tcase, test_without_blocks);
    tcase_add_test(tcase, test_end_of_the_largest);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

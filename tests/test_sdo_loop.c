/* SDO client against SDO server: every size there and back, also with frames that get lost. */
#include "support/hex.h"
#include "support/sdo_loop.h"

#include <check.h>
#include <string.h>

#define SIZES 300u

static struct sdo_loop loop;

static void setup(void)
{
    sdo_loop_init(&loop, 2);
}

static void teardown(void)
{
    sdo_loop_done(&loop);
}

static bool loses_some(struct sdo_loop *self, const struct co_frame *frame, bool to_server)
{
    (void)frame;
    (void)to_server;
    return noise(&self->seed) % self->loss == 0;
}

START_TEST(test_all_sizes)
{
    loop.indicate_size = _i != 0;
    for (uint32_t size = 0; size <= SIZES; size++)
        sdo_loop_check(&loop, size);
    ck_assert_uint_eq(loop.client.late, 0);
    ck_assert_uint_eq(loop.server.dropped, 0);
}
END_TEST

static unsigned toggles[2]; /* upload segments seen with either toggle bit */

static bool loses_none(struct sdo_loop *self, const struct co_frame *frame, bool to_server)
{
    (void)self;
    toggles[frame->data[0] >> 4 & 1] += !to_server && frame->data[0] < 0x20;
    return false;
}

/* K51: the toggle bit alternates throughout a transfer of more than 255 segments. */
START_TEST(test_large)
{
    static const uint32_t sizes[] = { 19999, LOOP_LARGE };
    const unsigned segments = (sizes[_i] + 6) / 7;

    memset(toggles, 0, sizeof toggles);
    loop.loses = loses_none;
    loop.indicate_size = true;
    sdo_loop_check(&loop, sizes[_i]);
    ck_assert_uint_eq(toggles[0], (segments + 1) / 2);
    ck_assert_uint_eq(toggles[1], segments / 2);
}
END_TEST

START_TEST(test_overflow)
{
    loop.block = (uint8_t)_i;
    loop.indicate_size = true;
    sdo_loop_download(&loop, 50);
    sdo_loop_upload(&loop, 49);
    ck_assert_uint_eq(loop.end.detail, SDO_OUTCOME_OVERFLOW);
    ck_assert_uint_eq(loop.end.actual, 50);
    ck_assert_uint_eq(loop.server.state, SDO_SERVER_IDLE);
    sdo_loop_check(&loop, 50);
}
END_TEST

/* With frames lost every transfer ends, and what went well is complete. */
START_TEST(test_losses)
{
    unsigned good = 0, bad = 0;

    loop.seed = (uint64_t)_i / 2 + 1;
    loop.loses = loses_some;
    loop.loss = 20;
    loop.block = _i % 2 ? 3 : 0;
    for (unsigned i = 0; i < 400; i++) {
        const uint32_t size = noise(&loop.seed) % 60;

        loop.indicate_size = i % 2;
        sdo_loop_download(&loop, size);
        if (loop.end.detail == SDO_OUTCOME_OK)
            ck_assert_mem_eq(loop.entry->value, loop.data, size);
        sdo_loop_upload(&loop, 60);
        if (loop.end.detail == SDO_OUTCOME_OK) {
            ck_assert_uint_eq(loop.end.actual, loop.entry->size);
            ck_assert_mem_eq(loop.entry->value, loop.data, loop.entry->size);
            good++;
        } else {
            bad++;
        }
        sdo_loop_rest(&loop);
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
    tcase_add_loop_test(tcase, test_large, 0, 2);
    tcase_add_loop_test(tcase, test_overflow, 0, 2);
    tcase_add_loop_test(tcase, test_losses, 0, 8);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

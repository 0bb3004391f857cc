/* Outbox: room, order, and both queues around their ends. */
#include "base/outbox.h"

#include <check.h>

START_TEST(test_room)
{
    struct co_frame frames[2], frame = co_frame_make(1, 0);
    struct co_event events[1], event = { .type = 1 };
    struct co_outbox out;

    co_outbox_init(&out, frames, 2, events, 1);
    ck_assert(co_outbox_room(&out, 2, 1));
    ck_assert(!co_outbox_room(&out, 3, 0));
    ck_assert(!co_outbox_room(&out, 0, 2));
    co_outbox_put_frame(&out, &frame);
    ck_assert(co_outbox_room(&out, 1, 1));
    ck_assert(!co_outbox_room(&out, 2, 1));
    co_outbox_put_event(&out, &event);
    ck_assert(co_outbox_room(&out, 1, 0));
    ck_assert(!co_outbox_room(&out, 1, 1));
    ck_assert(co_outbox_room(&out, 0, 0));
}
END_TEST

START_TEST(test_none)
{
    struct co_outbox out;
    struct co_frame frame = co_frame_make(7, 0);
    struct co_event event = { .type = 7 };

    co_outbox_init(&out, NULL, 0, NULL, 0);
    ck_assert(co_outbox_room(&out, 0, 0));
    ck_assert(!co_outbox_room(&out, 1, 0));
    ck_assert(!co_outbox_room(&out, 0, 1));
    ck_assert(!co_outbox_take_frame(&out, &frame));
    ck_assert(!co_outbox_take_event(&out, &event));
    ck_assert_uint_eq(frame.id, 7);
    ck_assert_uint_eq(event.type, 7);
}
END_TEST

/* Puts as many as fit, takes some, again and again: everything comes out once and in order. */
START_TEST(test_order)
{
    struct co_frame frames[3], frame;
    struct co_event events[5], event;
    struct co_outbox out;
    unsigned frames_put = 0, frames_taken = 0;
    uint16_t events_put = 0, events_taken = 0;

    co_outbox_init(&out, frames, 3, events, 5);
    for (unsigned round = 0; round < 50; round++) {
        for (; co_outbox_room(&out, 1, 0); frames_put++) {
            frame = co_frame_make(frames_put, 0);
            co_outbox_put_frame(&out, &frame);
        }
        for (; co_outbox_room(&out, 0, 1); events_put++) {
            event = (struct co_event){ .type = events_put };
            co_outbox_put_event(&out, &event);
        }
        for (unsigned i = 0; i <= round % 4 && co_outbox_take_frame(&out, &frame); i++)
            ck_assert_uint_eq(frame.id, frames_taken++);
        for (unsigned i = 0; i <= round % 6 && co_outbox_take_event(&out, &event); i++)
            ck_assert_uint_eq(event.type, events_taken++);
    }
    ck_assert_uint_eq(frames_put - frames_taken, out.frame_count);
    ck_assert_uint_eq(events_put - events_taken, out.event_count);
    ck_assert_uint_gt(frames_taken, 90);
    ck_assert_uint_gt(events_taken, 140);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("outbox");
    TCase *tcase = tcase_create("outbox");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_test(tcase, test_room);
    tcase_add_test(tcase, test_none);
    tcase_add_test(tcase, test_order);
    suite_add_tcase(suite, tcase);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

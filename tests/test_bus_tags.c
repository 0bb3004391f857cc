#include "port/bus_tags.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

/* A step: "+TEXT" sends with the tag, "-TEXT" takes back, "=TEXT" comes back and has the tag. */
struct step {
    const char *what;
    uint8_t tag;
};

static const struct {
    const char *name;
    struct step steps[12];
} cases[] = {
    { "in order", { { "+101#01", 1 }, { "+101#02", 2 }, { "=101#01", 1 }, { "=101#02", 2 } } },
    { "the same twice",
      { { "+101#01", 1 }, { "+101#01", 2 }, { "=101#01", 1 }, { "=101#01", 2 } } },
    { "overtaken", { { "+101#01", 1 }, { "+102#01", 2 }, { "=102#01", 2 }, { "=101#01", 1 } } },
    { "unknown", { { "=101#01", 0 }, { "+101#01", 1 }, { "=101#02", 0 }, { "=101#01", 1 } } },
    { "only once", { { "+101#01", 1 }, { "=101#01", 1 }, { "=101#01", 0 } } },
    { "kinds differ",
      { { "+101#", 1 },
        { "+101#R0", 2 },
        { "+00000101#", 3 },
        { "=00000101#", 3 },
        { "=101#R0", 2 } } },
    { "a lost one does not shift its successors",
      { { "+101#01", 1 },
        { "+102#01", 9 },
        { "+101#02", 2 },
        { "=101#02", 2 },
        { "+101#01", 3 },
        { "=101#01", 3 },
        { "=102#01", 9 } } },
    { "a lost 11-bit one is no predecessor of a 29-bit one",
      { { "+101#01", 1 }, { "+00000101#02", 2 }, { "=00000101#02", 2 }, { "=101#01", 1 } } },
    { "taken back",
      { { "+101#01", 1 },
        { "+101#01", 2 },
        { "-101#01", 0 },
        { "=101#01", 1 },
        { "=101#01", 0 } } },
    { "nothing to take back",
      { { "-101#01", 0 }, { "+102#01", 1 }, { "-101#01", 0 }, { "=102#01", 1 } } },
};

static struct bus_tags tags;

static void take_step(const struct step *step)
{
    struct co_frame frame;

    ck_assert(co_frame_parse(step->what + 1, &frame));
    frame.tag = step->tag;
    if (step->what[0] == '+') {
        bus_tags_push(&tags, &frame);
    } else if (step->what[0] == '-') {
        bus_tags_take_back(&tags, &frame);
    } else {
        frame.tag = 0;
        ck_assert_uint_eq(bus_tags_confirm(&tags, &frame), step->tag);
    }
}

START_TEST(tags_follow_their_frames)
{
    memset(&tags, 0, sizeof tags);
    for (unsigned i = 0; cases[_i].steps[i].what; i++)
        take_step(&cases[_i].steps[i]);
}
END_TEST

START_TEST(the_oldest_is_forgotten)
{
    static const struct step first = { "+101#01", 1 }, other = { "+102#01", 2 };

    memset(&tags, 0, sizeof tags);
    take_step(&first);
    for (unsigned i = 0; i < BUS_TAGS_MAX - 1; i++)
        take_step(&other);
    take_step(&(struct step){ "=101#01", 1 });
    take_step(&first);
    take_step(&other);
    take_step(&(struct step){ "=101#01", 1 });
    take_step(&(struct step){ "=102#01", 2 });
    memset(&tags, 0, sizeof tags);
    take_step(&first);
    for (unsigned i = 0; i < BUS_TAGS_MAX; i++)
        take_step(&other);
    take_step(&(struct step){ "=101#01", 0 });
    ck_assert_uint_eq(tags.count, BUS_TAGS_MAX);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("bus_tags");
    TCase *tests = tcase_create("all");
    SRunner *runner;
    int failed;

    tcase_add_loop_test(tests, tags_follow_their_frames, 0, (int)(sizeof cases / sizeof cases[0]));
    tcase_add_test(tests, the_oldest_is_forgotten);
    suite_add_tcase(suite, tests);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

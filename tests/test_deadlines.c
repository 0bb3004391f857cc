/* The earliest deadline, and those that are due; a set of numbers. */
#include "base/deadlines.h"
#include "base/set.h"
#include "support/suite.h"

START_TEST(test_none)
{
    struct co_deadlines deadlines;

    co_deadlines_init(&deadlines);
    ck_assert_uint_eq(co_deadlines_first(&deadlines), CO_NEVER);
    ck_assert_uint_eq(co_deadlines_due(&deadlines, 0, CO_NEVER - 1), CO_DEADLINES);
}
END_TEST

/* From each number on, against looking at all of them. */
static void check(const struct co_deadlines *deadlines, const co_us_t *wanted, co_us_t now)
{
    co_us_t first = CO_NEVER;
    unsigned due = CO_DEADLINES;

    for (unsigned i = CO_DEADLINES; i-- > 0;) {
        first = co_earlier(first, wanted[i]);
        due = wanted[i] <= now ? i : due;
        ck_assert_uint_eq(co_deadlines_due(deadlines, i, now), due);
    }
    ck_assert_uint_eq(co_deadlines_first(deadlines), first);
    ck_assert_uint_eq(co_deadlines_due(deadlines, CO_DEADLINES, now), CO_DEADLINES);
}

START_TEST(test_any)
{
    struct co_deadlines deadlines;
    co_us_t wanted[CO_DEADLINES];
    uint32_t random = 1;

    co_deadlines_init(&deadlines);
    for (unsigned i = 0; i < CO_DEADLINES; i++)
        wanted[i] = CO_NEVER;
    for (unsigned i = 0; i < 300; i++) {
        unsigned number;

        random = random * 1664525u + 1013904223u;
        number = random >> 16 & (CO_DEADLINES - 1);
        wanted[number] = random % 5 == 0 ? CO_NEVER : random >> 10 & 63;
        co_deadlines_set(&deadlines, number, wanted[number]);
        check(&deadlines, wanted, random >> 20 & 63);
    }
}
END_TEST

START_TEST(test_set)
{
    static const unsigned numbers[] = { 0, 1, 31, 32, 63, 64, 126, 127 };
    struct co_set set = { { 0 } };
    unsigned count = 0;

    ck_assert_uint_eq(co_set_next(&set, 0), CO_SET_SIZE);
    for (unsigned i = 0; i < 8; i++)
        co_set_add(&set, numbers[i]);
    CO_SET_EACH(&set, i)
    ck_assert_uint_eq(i, numbers[count++]);
    ck_assert_uint_eq(count, 8);
    co_set_remove(&set, 64);
    ck_assert(!co_set_has(&set, 64));
    ck_assert(co_set_has(&set, 63));
    ck_assert_uint_eq(co_set_next(&set, 64), 126);
    ck_assert_uint_eq(co_set_next(&set, CO_SET_SIZE), CO_SET_SIZE);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("deadlines");

    tcase_add_test(tcase, test_none);
    tcase_add_test(tcase, test_any);
    tcase_add_test(tcase, test_set);
    return suite_run("deadlines", tcase);
}

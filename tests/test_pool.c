#include "base/pool.h"

#include <check.h>
#include <stdbool.h>
#include <string.h>

#define PIECES 2000

static struct co_pool pool;
static bool no_memory;

void *__real_malloc(size_t size);
void *__wrap_malloc(size_t size);

void *__wrap_malloc(size_t size)
{
    return no_memory ? NULL : __real_malloc(size);
}

static char *take(size_t size, int mark)
{
    char *piece = co_pool_take(&pool, size);

    ck_assert_ptr_nonnull(piece);
    memset(piece, mark, size);
    return piece;
}

static size_t size_of(size_t i)
{
    return i % 100 == 99 ? 100000 : i % 37;
}

START_TEST(test_pieces_stay)
{
    static char *pieces[PIECES];

    for (size_t i = 0; i < PIECES; i++)
        pieces[i] = take(size_of(i), (int)(i & 0x7F));
    for (size_t i = 0; i < PIECES; i++) {
        size_t same = 0;

        while (same < size_of(i) && pieces[i][same] == (char)(i & 0x7F))
            same++;
        ck_assert_uint_eq(same, size_of(i));
    }
    co_pool_done(&pool);
}
END_TEST

START_TEST(test_give_back)
{
    char *first = take(100, 1), *second;

    co_pool_give_back(&pool, 96);
    second = take(8, 2);
    ck_assert_ptr_eq(second, first + 4);
    ck_assert_int_eq(first[3], 1);
    co_pool_give_back(&pool, 8);
    ck_assert_ptr_eq(take(8, 3), second);
    co_pool_done(&pool);
}
END_TEST

START_TEST(test_empty)
{
    ck_assert_ptr_null(pool.newest);
    co_pool_done(&pool);
    ck_assert_ptr_nonnull(co_pool_take(&pool, 0));
    co_pool_done(&pool);
    ck_assert_ptr_null(pool.newest);
}
END_TEST

/* The test itself needs memory, too. */
static void *take_without_memory(size_t size)
{
    void *piece;

    no_memory = true;
    piece = co_pool_take(&pool, size);
    no_memory = false;
    return piece;
}

START_TEST(test_no_memory)
{
    ck_assert_ptr_null(take_without_memory(10));
    take(10, 1);
    ck_assert_ptr_null(take_without_memory(100000));
    ck_assert_ptr_nonnull(take_without_memory(10)); /* of what there is */
    co_pool_done(&pool);
}
END_TEST

static Suite *pool_suite(void)
{
    Suite *suite = suite_create("pool");
    TCase *tests = tcase_create("pool");

    tcase_add_test(tests, test_pieces_stay);
    tcase_add_test(tests, test_give_back);
    tcase_add_test(tests, test_empty);
    tcase_add_test(tests, test_no_memory);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(pool_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

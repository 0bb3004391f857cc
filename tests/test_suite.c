/*
 * What the runner of test programs does with files: none is left, and leaving some is a failure.
 */
#include "support/suite.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void make_temporary(void)
{
    char path[SUITE_PATH_SIZE];

    suite_temporary("left", path);
    ck_assert_ptr_nonnull(mkdtemp(path));
}

START_TEST(leaves_nothing)
{
    char path[SUITE_PATH_SIZE];

    suite_temporary("removed", path);
    ck_assert_ptr_nonnull(mkdtemp(path));
    ck_assert_int_eq(remove(path), 0);
}
END_TEST

START_TEST(leaves_a_folder)
{
    make_temporary();
}
END_TEST

START_TEST(fails_half_way)
{
    make_temporary();
    ck_abort_msg("on purpose");
}
END_TEST

static int run(const char *name, const TTest *test)
{
    TCase *tcase = tcase_create(name);

    tcase_add_test(tcase, test);
    return suite_run(name, tcase);
}

static unsigned count_temporary(const char *path)
{
    DIR *folder = opendir(path);
    unsigned count = 0;

    while (folder && readdir(folder))
        count++;
    if (folder)
        closedir(folder);
    return count;
}

static int judge(const char *what, bool is_right)
{
    if (!is_right)
        printf("wrong: %s\n", what);
    return !is_right;
}

int main(void)
{
    char path[SUITE_PATH_SIZE];
    int wrong = 0;

    suite_temporary("suite", path);
    if (!mkdtemp(path))
        return EXIT_FAILURE;
    setenv("TMPDIR", path, 1);
    setenv("CK_VERBOSITY", "silent", 1); /* the failures of these are none of this program */
    wrong += judge("nothing left", run("clean", leaves_nothing) == 0);
    wrong += judge("a folder left", run("leaving", leaves_a_folder) != 0);
    wrong += judge("failed", run("failing", fails_half_way) != 0);
    wrong += judge("TMPDIR is as before", strcmp(getenv("TMPDIR"), path) == 0);
    wrong += judge("all is gone", count_temporary(path) == 2); /* "." and ".." */
    remove(path);
    return wrong ? EXIT_FAILURE : EXIT_SUCCESS;
}

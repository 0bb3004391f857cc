#include "support/suite.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

void suite_temporary(const char *name, char ret_path[SUITE_PATH_SIZE])
{
    const char *folder = getenv("TMPDIR");
    const int length = snprintf(ret_path, SUITE_PATH_SIZE, "%s/mcanopen-%s-XXXXXX",
                                folder ? folder : "/tmp", name);

    if (length >= SUITE_PATH_SIZE) {
        fprintf(stderr, "TMPDIR is too long: %s\n", folder);
        abort();
    }
}

/* Tests that change the user have to get there as well. */
static void make_folder(const char *name, char ret_path[SUITE_PATH_SIZE])
{
    suite_temporary(name, ret_path);
    if (!mkdtemp(ret_path) || chmod(ret_path, 0711) != 0 || setenv("TMPDIR", ret_path, 1) != 0) {
        perror(ret_path);
        abort();
    }
}

static int count_files(const char *path)
{
    DIR *folder = opendir(path);
    int count = 0;

    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        printf("left behind: %s/%s\n", path, entry->d_name);
        count++;
    }
    if (folder)
        closedir(folder);
    return count;
}

/* 0: it is gone. */
static int remove_folder(char *path)
{
    char command[SUITE_PATH_SIZE + 16];

    snprintf(command, sizeof command, "rm -rf '%s'", path);
    *strrchr(path, '/') = '\0';
    setenv("TMPDIR", path, 1);
    return system(command) != 0;
}

int suite_run(const char *name, TCase *tcase)
{
    Suite *suite = suite_create(name);
    char folder[SUITE_PATH_SIZE];
    SRunner *runner;
    int failed;

    make_folder(name, folder);
    suite_add_tcase(suite, tcase);
    runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed == 0)
        failed = count_files(folder);
    failed += remove_folder(folder);
    return failed != 0;
}

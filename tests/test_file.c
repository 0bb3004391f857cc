/* Reading files whole, and finding those that a configuration names. */
#include "api/file.h"

#include "support/suite.h"

#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char folder[SUITE_PATH_SIZE];

static void set_up(void)
{
    suite_temporary("file", folder);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
}

static void tear_down(void)
{
    char command[sizeof folder + 16];

    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static void write_file(const char *name, const char *bytes, size_t size)
{
    FILE *file = fopen(name, "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
}

/* --- reading --- */

static const size_t sizes[] = { 0, 1, 65534, 65535, 65536, 65537, 300000 };

START_TEST(a_file_is_read_whole)
{
    const size_t size = sizes[_i];
    char *bytes = malloc(size + 1), *text = NULL;
    size_t read = 7;

    ck_assert_ptr_nonnull(bytes);
    for (size_t i = 0; i < size; i++)
        bytes[i] = (char)(i * 31); /* NULs too */
    write_file("some", bytes, size);
    ck_assert_int_eq(file_read("some", &text, &read), CO_OK);
    ck_assert_uint_eq(read, size);
    ck_assert_int_eq(memcmp(text, bytes, size), 0);
    ck_assert_int_eq(text[size], 0);
    free(text);
    free(bytes);
}
END_TEST

START_TEST(what_cannot_be_read)
{
    char *text = NULL;
    size_t size = 7;

    write_file("file", "x", 1);
    ck_assert_int_eq(file_read("none", &text, &size), CO_ERR_NOT_FOUND);
    ck_assert_int_eq(file_read("file/none", &text, &size), CO_ERR_NOT_FOUND);
    ck_assert_int_eq(file_read("", &text, &size), CO_ERR_NOT_FOUND);
    ck_assert_int_eq(file_read(".", &text, &size), CO_ERR_ARG);
    ck_assert_ptr_null(text);
    ck_assert_uint_eq(size, 7);
}
END_TEST

START_TEST(a_file_without_the_right_to_read_it)
{
    char *text = NULL;
    size_t size;

    write_file("secret", "x", 1);
    ck_assert_int_eq(chmod("secret", 0), 0);
    ck_assert_int_eq(chmod(folder, 0755), 0);
    if (geteuid() == 0)
        ck_assert_int_eq(seteuid(65534), 0);
    ck_assert_int_eq(file_read("secret", &text, &size), CO_ERR_PERMISSION);
    ck_assert_int_eq(seteuid(getuid()), 0);
}
END_TEST

/* Sparse: takes no room on the disk. */
START_TEST(a_file_that_is_too_large)
{
    char *text = NULL;
    size_t size;

    write_file("large", "x", 1);
    ck_assert_int_eq(truncate("large", (off_t)FILE_SIZE_MAX + 1), 0);
    ck_assert_int_eq(file_read("large", &text, &size), CO_ERR_VALUE);
    ck_assert_ptr_null(text);
}
END_TEST

/* --- what is no plain file --- */

static int patience; /* what was asked for last; the time is over at once */
static bool is_patient;

int __wrap_poll(struct pollfd *files, nfds_t count, int ms);
int __real_poll(struct pollfd *files, nfds_t count, int ms);

int __wrap_poll(struct pollfd *files, nfds_t count, int ms)
{
    patience = ms;
    return __real_poll(files, count, is_patient ? ms : 0);
}

START_TEST(a_pipe_that_nobody_writes)
{
    char *text = NULL;
    size_t size;

    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    ck_assert_int_eq(file_read("pipe", &text, &size), CO_ERR_TIMEOUT);
    ck_assert_int_eq(patience, FILE_WRITER_MS);
    ck_assert_ptr_null(text);
}
END_TEST

START_TEST(a_pipe_with_a_silent_writer)
{
    char *text = NULL;
    size_t size;
    int writer;

    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    writer = open("pipe", O_RDWR);
    ck_assert_int_eq(write(writer, "half", 4), 4);
    ck_assert_int_eq(file_read("pipe", &text, &size), CO_ERR_TIMEOUT);
    ck_assert_int_eq(patience, FILE_SILENCE_MS);
    ck_assert_ptr_null(text);
    close(writer);
}
END_TEST

/* The child opens it when the parent waits, or before, and writes in two steps. */
START_TEST(a_pipe_is_read_to_its_end)
{
    char *text = NULL;
    size_t size = 0;
    pid_t child;

    is_patient = true;
    ck_assert_int_eq(mkfifo("pipe", 0600), 0);
    child = fork();
    if (child == 0) {
        int writer = open("pipe", O_WRONLY);
        bool good = write(writer, "one", 3) == 3 && write(writer, "two", 3) == 3;

        _exit(good ? 0 : 1);
    }
    ck_assert_int_eq(file_read("pipe", &text, &size), CO_OK);
    ck_assert_uint_eq(size, 6);
    ck_assert_str_eq(text, "onetwo");
    free(text);
    ck_assert_int_eq(waitpid(child, NULL, 0), child);
}
END_TEST

/* As shells name it: <(...). Whoever wrote has gone already. */
START_TEST(a_pipe_whose_writer_has_gone)
{
    char *text = NULL, name[32];
    size_t size = 0;
    int ends[2];

    ck_assert_int_eq(pipe(ends), 0);
    ck_assert_int_eq(write(ends[1], "text", 4), 4);
    close(ends[1]);
    snprintf(name, sizeof name, "/dev/fd/%d", ends[0]);
    ck_assert_int_eq(file_read(name, &text, &size), CO_OK);
    ck_assert_str_eq(text, "text");
    free(text);
    close(ends[0]);
}
END_TEST

START_TEST(devices)
{
    char *text = NULL;
    size_t size = 7;

    ck_assert_int_eq(file_read("/dev/zero", &text, &size), CO_ERR_VALUE);
    ck_assert_ptr_null(text);
    ck_assert_int_eq(file_read("/dev/null", &text, &size), CO_OK);
    ck_assert_uint_eq(size, 0);
    ck_assert_str_eq(text, "");
    free(text);
}
END_TEST

/* Its size is told as 0. */
START_TEST(a_file_of_the_kernel)
{
    char *text = NULL;
    size_t size = 0;

    ck_assert_int_eq(file_read("/proc/self/status", &text, &size), CO_OK);
    ck_assert_uint_gt(size, 100);
    ck_assert_uint_eq(strlen(text), size);
    free(text);
}
END_TEST

/* --- finding --- */

static const struct find {
    const char *there; /* the files, separated by blanks */
    const char *repository;
    const char *xml, *name;
    const char *found;
} finds[] = {
    { "a.dcf r/a.dcf x/a.dcf", "r", "x/n.xml", "a.dcf", "a.dcf" },
    { "r/a.dcf x/a.dcf x/r/a.dcf", "r", "x/n.xml", "a.dcf", "r/a.dcf" },
    { "r/a.dcf", "r/", "n.xml", "a.dcf", "r/a.dcf" },
    { "x/a.dcf x/r/a.dcf", "r", "x/n.xml", "a.dcf", "x/a.dcf" },
    { "x/r/a.dcf", "r", "x/n.xml", "a.dcf", "x/r/a.dcf" },
    { "x/a.dcf", NULL, "x/n.xml", "a.dcf", "x/a.dcf" },
    { "x/d/a.dcf", NULL, "x/n.xml", "d/a.dcf", "x/d/a.dcf" },
    { "r/a.dcf", NULL, "x/n.xml", "a.dcf", "a.dcf" }, /* nowhere: as given */
    { "r/a.dcf", "r", "x/n.xml", "b.dcf", "b.dcf" },
    { "r/tmp/a.dcf", "r", "x/n.xml", "/tmp/a.dcf", "/tmp/a.dcf" }, /* absolute: nowhere else */
    { "r/a.dcf", "", "n.xml", "a.dcf", "a.dcf" },
};

/* With the folders on the way. */
static void make_files(const char *names)
{
    char list[200], *rest = list, *name;

    snprintf(list, sizeof list, "%s", names);
    while ((name = strsep(&rest, " ")) != NULL) {
        for (char *slash = strchr(name, '/'); slash; slash = strchr(slash + 1, '/')) {
            *slash = '\0';
            mkdir(name, 0700);
            *slash = '/';
        }
        write_file(name, "", 0);
    }
}

START_TEST(a_file_is_found_where_it_is_looked_for_first)
{
    const struct find *row = &finds[_i];
    char repository[20] = "";
    const struct network_config config = { .repository = row->repository ? repository : NULL };
    char *path = NULL;

    snprintf(repository, sizeof repository, "%s", row->repository ? row->repository : "");
    make_files(row->there);
    ck_assert_int_eq(file_find(&config, row->xml, row->name, &path), CO_OK);
    ck_assert_str_eq(path, row->found);
    free(path);
}
END_TEST

static const struct alike {
    const char *there, *repository, *name, *found;
} alikes[] = {
    { "pump.dcf", NULL, "Pump.DCF", "pump.dcf" },
    { "eds/pump.dcf", NULL, "EDS\\Pump.dcf", "eds/pump.dcf" },
    { "eds/pump.dcf", NULL, "./EDS/pump.dcf", "./eds/pump.dcf" },
    { "plant/pump.dcf", NULL, "PUMP.dcf", "plant/pump.dcf" },
    { "repo/pump.dcf", "repo", "PUMP.dcf", "repo/pump.dcf" },
    { "plant/repo/pump.dcf", "repo", "PUMP.dcf", "plant/repo/pump.dcf" },
    { "eds/pump.dcf", NULL, "C:\\eds\\pump.dcf", NULL },
    { "eds/pump.dcf", NULL, "/nowhere/pump.dcf", NULL },
    { "eds/pump.dcf", NULL, "pump.dcf", NULL },
    { "pump.dcf", NULL, "\\", NULL },
};

START_TEST(a_file_of_other_cases_is_known)
{
    const struct alike *row = &alikes[_i];
    char repository[20] = "";
    const struct network_config config = { .repository = row->repository ? repository : NULL };
    char *path;

    snprintf(repository, sizeof repository, "%s", row->repository ? row->repository : "");
    make_files(row->there);
    path = file_find_alike(&config, "plant/network.xml", row->name);
    ck_assert_pstr_eq(path, row->found);
    free(path);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("file");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, a_file_is_read_whole, 0, (int)(sizeof sizes / sizeof *sizes));
    tcase_add_test(tests, what_cannot_be_read);
    tcase_add_test(tests, a_file_without_the_right_to_read_it);
    tcase_add_test(tests, a_file_that_is_too_large);
    tcase_add_test(tests, a_pipe_that_nobody_writes);
    tcase_add_test(tests, a_pipe_with_a_silent_writer);
    tcase_add_test(tests, a_pipe_is_read_to_its_end);
    tcase_add_test(tests, a_pipe_whose_writer_has_gone);
    tcase_add_test(tests, devices);
    tcase_add_test(tests, a_file_of_the_kernel);
    tcase_add_loop_test(tests, a_file_is_found_where_it_is_looked_for_first, 0,
                        (int)(sizeof finds / sizeof *finds));
    tcase_add_loop_test(tests, a_file_of_other_cases_is_known, 0,
                        (int)(sizeof alikes / sizeof *alikes));
    return suite_run("file", tests);
}

/*
 * Replacing a file: it is the old one or the new one, whatever fails and whenever the process ends.
 * The linker leads the calls that change files here (--wrap).
 */
#include "api/file_draft.h"

#include "support/suite.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

/* --- the linker's part --- */

enum { NOTHING, FAIL, END };

static unsigned countdown; /* calls up to the one where it happens; 0: never */
static int what;
static char order[64]; /* a letter for each call */

static bool happens(char letter)
{
    const size_t length = strlen(order);

    if (length + 1 < sizeof order)
        order[length] = letter;
    if (countdown == 0 || --countdown > 0)
        return false;
    if (what == END)
        _exit(0);
    errno = EIO;
    return true;
}

int __real_ftruncate(int file, off_t size);
int __wrap_ftruncate(int file, off_t size);
ssize_t __real_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size);
int __real_fsync(int file);
int __wrap_fsync(int file);
int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

int __wrap_ftruncate(int file, off_t size)
{
    return happens('t') ? -1 : __real_ftruncate(file, size);
}

/* Not more than a part at once. */
ssize_t __wrap_write(int file, const void *bytes, size_t size)
{
    return happens('w') ? -1 : __real_write(file, bytes, size > 4 ? 4 : size);
}

int __wrap_fsync(int file)
{
    return happens('s') ? -1 : __real_fsync(file);
}

int __wrap_rename(const char *from, const char *to)
{
    return happens('r') ? -1 : __real_rename(from, to);
}

/* --- */

#define OLD   "the old bytes"
#define NEW   "what is new"
#define CALLS 8 /* of one replacement: t www s r s, and none more */

static char folder[SUITE_PATH_SIZE];

static void put(const char *name, const char *text)
{
    const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0666);

    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(__real_write(file, text, strlen(text)), (ssize_t)strlen(text));
    ck_assert_int_eq(close(file), 0);
}

static void set_up(void)
{
    suite_temporary("draft", folder);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
    countdown = 0;
    memset(order, 0, sizeof order);
    put("file", OLD);
}

static void tear_down(void)
{
    char command[sizeof folder + 16];

    countdown = 0;
    snprintf(command, sizeof command, "rm -rf %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static const char *content(const char *name)
{
    static char text[64];
    const int file = open(name, O_RDONLY);
    ssize_t size;

    if (file < 0)
        return "none";
    size = read(file, text, sizeof text - 1);
    close(file);
    ck_assert_int_ge(size, 0);
    text[size] = '\0';
    return text;
}

static bool is_there(const char *name)
{
    struct stat status;

    return lstat(name, &status) == 0;
}

static enum co_err replace(const char *name, const char *text)
{
    struct file_draft draft;
    const enum co_err err = file_draft_write(&draft, name, text, strlen(text));

    return err == CO_OK ? file_draft_take(&draft) : err;
}

START_TEST(a_file_is_replaced)
{
    ck_assert_int_eq(replace("file", NEW), CO_OK);
    ck_assert_str_eq(content("file"), NEW);
    ck_assert(!is_there("file~"));
    ck_assert_str_eq(order, "twwwsrs"); /* on the disk before it has the name */
    ck_assert_int_eq(replace("file", ""), CO_OK);
    ck_assert_str_eq(content("file"), "");
}
END_TEST

START_TEST(a_new_file)
{
    struct stat status;
    const mode_t mask = umask(027);

    ck_assert_int_eq(replace("new", NEW), CO_OK);
    umask(mask);
    ck_assert_str_eq(content("new"), NEW);
    ck_assert_int_eq(stat("new", &status), 0);
    ck_assert_int_eq(status.st_mode & 07777, 0640);
    ck_assert_int_eq(replace("nowhere/new", NEW), CO_ERR_NOT_FOUND);
    ck_assert_int_eq(replace("file/new", NEW), CO_ERR_NOT_FOUND);
    ck_assert(!is_there("nowhere"));
}
END_TEST

START_TEST(the_mode_stays)
{
    struct stat status;

    ck_assert_int_eq(chmod("file", 0604), 0);
    ck_assert_int_eq(replace("file", NEW), CO_OK);
    ck_assert_int_eq(stat("file", &status), 0);
    ck_assert_int_eq(status.st_mode & 07777, 0604);
}
END_TEST

START_TEST(a_draft_that_is_dropped)
{
    struct file_draft draft;

    ck_assert_int_eq(file_draft_write(&draft, "file", NEW, strlen(NEW)), CO_OK);
    ck_assert_str_eq(content("file"), OLD);
    file_draft_drop(&draft);
    ck_assert_str_eq(content("file"), OLD);
    ck_assert(!is_there("file~"));
}
END_TEST

START_TEST(one_at_a_time)
{
    struct file_draft first, second;

    ck_assert_int_eq(file_draft_write(&first, "file", NEW, strlen(NEW)), CO_OK);
    ck_assert_int_eq(file_draft_write(&second, "file", "other", 5), CO_ERR_AGAIN);
    ck_assert_int_eq(file_draft_take(&first), CO_OK);
    ck_assert_str_eq(content("file"), NEW);
    ck_assert_int_eq(replace("file", "other"), CO_OK);
    ck_assert_str_eq(content("file"), "other");
}
END_TEST

START_TEST(a_link_stays)
{
    struct stat status;

    ck_assert_int_eq(mkdir("folder", 0777), 0);
    put("folder/real", OLD);
    ck_assert_int_eq(symlink("folder/real", "link"), 0);
    ck_assert_int_eq(replace("link", NEW), CO_OK);
    ck_assert_int_eq(lstat("link", &status), 0);
    ck_assert(S_ISLNK(status.st_mode));
    ck_assert_str_eq(content("folder/real"), NEW);
    ck_assert(!is_there("folder/real~"));
}
END_TEST

START_TEST(what_is_no_file_stays)
{
    ck_assert_int_eq(mkdir("folder", 0777), 0);
    ck_assert_int_eq(mkfifo("pipe", 0666), 0);
    ck_assert_int_eq(replace("folder", NEW), CO_ERR_IO);
    ck_assert_int_eq(replace("pipe", NEW), CO_ERR_IO);
    ck_assert_int_eq(replace("/dev/null", NEW), CO_ERR_IO);
    ck_assert(!is_there("folder~") && !is_there("pipe~") && !is_there("/dev/null~"));
}
END_TEST

/* Root may do all. */
static void become_nobody(void)
{
    ck_assert_int_eq(chmod(folder, 0755), 0);
    if (geteuid() == 0)
        ck_assert_int_eq(seteuid(65534), 0);
}

static void become_root(void)
{
    ck_assert_int_eq(seteuid(getuid()), 0);
}

static void give_away(const char *name, mode_t mode)
{
    if (geteuid() == 0)
        ck_assert_int_eq(chown(name, 65534, (gid_t)-1), 0);
    ck_assert_int_eq(chmod(name, mode), 0);
}

/* It has been replaced: nobody may be told that it has not. */
START_TEST(a_folder_that_cannot_be_read)
{
    enum co_err err;

    ck_assert_int_eq(mkdir("folder", 0777), 0);
    put("folder/file", OLD);
    give_away("folder/file", 0666);
    give_away("folder", 0300);
    become_nobody();
    err = replace("folder/file", NEW);
    become_root();
    ck_assert_int_eq(chmod("folder", 0700), 0);
    ck_assert_int_eq(err, CO_OK);
    ck_assert_str_eq(content("folder/file"), NEW);
    ck_assert(!is_there("folder/file~"));
}
END_TEST

/* With the mode of a file that is read only: in the way only while it is used. */
START_TEST(a_draft_that_cannot_be_written)
{
    struct file_draft draft;
    enum co_err first, meanwhile, next;

    ck_assert_int_eq(mkdir("folder", 0777), 0);
    put("folder/file", OLD);
    put("folder/file~", "left");
    give_away("folder/file", 0444);
    give_away("folder/file~", 0444);
    give_away("folder", 0700);
    become_nobody();
    first = file_draft_write(&draft, "folder/file", NEW, strlen(NEW));
    meanwhile = first == CO_OK ? replace("folder/file", "other") : first;
    next = first == CO_OK ? file_draft_take(&draft) : first;
    become_root();
    ck_assert_int_eq(first, CO_OK);
    ck_assert_int_eq(meanwhile, CO_ERR_AGAIN);
    ck_assert_int_eq(next, CO_OK);
    ck_assert_str_eq(content("folder/file"), NEW);
    ck_assert(!is_there("folder/file~"));
}
END_TEST

START_TEST(each_call_fails_once)
{
    enum co_err err;

    what = FAIL;
    countdown = (unsigned)_i + 1;
    err = replace("file", NEW);
    if (_i < CALLS - 1) {
        ck_assert_int_eq(err, CO_ERR_IO);
        ck_assert_str_eq(content("file"), _i < CALLS - 2 ? OLD : NEW);
    } else {
        ck_assert_int_eq(err, CO_OK);
    }
    ck_assert(!is_there("file~"));
    countdown = 0;
    ck_assert_int_eq(replace("file", "again"), CO_OK);
    ck_assert_str_eq(content("file"), "again");
}
END_TEST

/* What it leaves is in nobody's way. */
START_TEST(it_ends_at_each_call)
{
    const pid_t child = fork();
    int status;

    ck_assert_int_ge(child, 0);
    if (child == 0) {
        what = END;
        countdown = (unsigned)_i + 1;
        _exit(replace("file", NEW) == CO_OK ? 1 : 2);
    }
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert_int_eq(status, _i < CALLS - 1 ? 0 : 1 << 8);
    ck_assert_str_eq(content("file"), _i < CALLS - 2 ? OLD : NEW);
    ck_assert_int_eq(replace("file", "more than the draft that was left"), CO_OK);
    ck_assert_str_eq(content("file"), "more than the draft that was left");
    ck_assert(!is_there("file~"));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("file_draft");

    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, a_file_is_replaced);
    tcase_add_test(tcase, a_new_file);
    tcase_add_test(tcase, the_mode_stays);
    tcase_add_test(tcase, a_draft_that_is_dropped);
    tcase_add_test(tcase, one_at_a_time);
    tcase_add_test(tcase, a_link_stays);
    tcase_add_test(tcase, what_is_no_file_stays);
    tcase_add_test(tcase, a_folder_that_cannot_be_read);
    tcase_add_test(tcase, a_draft_that_cannot_be_written);
    tcase_add_loop_test(tcase, each_call_fails_once, 0, CALLS);
    tcase_add_loop_test(tcase, it_ends_at_each_call, 0, CALLS);
    return suite_run("file_draft", tcase);
}

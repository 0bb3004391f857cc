/*
 * Power-on values in a file, when the power fails, or a call about the file: the linker leads those
 * calls here (--wrap).
 */
#include "support/store_node.h"
#include "support/suite.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#define HARDWARE 0x06060000U

/* --- the linker's part --- */

enum { NOTHING, FAILS, ENDS };

static _Atomic unsigned countdown; /* calls about files up to the one where it happens; 0: never */
static _Atomic int what;
static _Atomic int unsynced = -1; /* file whose bytes a power cut would take */
static _Atomic bool slow;
static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static bool is_file(int file)
{
    struct stat status;

    return fstat(file, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
}

int __real_ftruncate(int file, off_t size);
int __wrap_ftruncate(int file, off_t size);
ssize_t __real_write(int file, const void *bytes, size_t size);
ssize_t __wrap_write(int file, const void *bytes, size_t size);
int __real_fsync(int file);
int __wrap_fsync(int file);
int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);

/* What was not on the disk is lost with the power. */
static bool happens(void)
{
    if (countdown == 0 || --countdown > 0)
        return false;
    if (what == ENDS) {
        if (unsynced >= 0)
            __real_ftruncate(unsynced, 0);
        _exit(0);
    }
    errno = ENOSPC;
    return true;
}

int __wrap_ftruncate(int file, off_t size)
{
    return is_file(file) && happens() ? -1 : __real_ftruncate(file, size);
}

/* Byte for byte. */
ssize_t __wrap_write(int file, const void *bytes, size_t size)
{
    if (!is_file(file))
        return __real_write(file, bytes, size);
    unsynced = file;
    return happens() ? -1 : __real_write(file, bytes, size > 1 ? 1 : size);
}

int __wrap_fsync(int file)
{
    if (slow)
        scan_note("writes");
    pthread_mutex_lock(&gate);
    pthread_mutex_unlock(&gate);
    if (happens())
        return -1;
    unsynced = -1;
    return __real_fsync(file);
}

int __wrap_rename(const char *from, const char *to)
{
    return happens() ? -1 : __real_rename(from, to);
}

/* --- a call fails --- */

#define CALLS_MAX 100u

/* Each call of writing fails once: the old values or the new ones, as the client was told. */
START_TEST(each_call_fails)
{
    unsigned failures = 0, stored = 1;

    store_set_up();
    store_start();
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
    what = FAILS;
    for (unsigned i = 1; i < CALLS_MAX; i++) {
        uint32_t code;

        store_change(i + 1);
        countdown = i;
        code = store_save(1);
        failures += code != 0;
        stored = code == 0 ? i + 1 : stored;
        ck_assert(code == 0 || code == HARDWARE);
        ck_assert_uint_eq(store_files(), 1);
        store_reset("000#8105");
        store_expect_changed(stored);
        if (countdown > 0)
            break; /* it was not reached any more */
    }
    ck_assert_uint_gt(countdown, 0);
    ck_assert_uint_gt(failures, 30); /* the bytes, and what comes before and behind */
    countdown = 0;
    store_restart();
    store_expect_changed(stored);
    store_tear_down();
}
END_TEST

/* --- the power fails --- */

/* In a process of its own, which ends in the i-th call about the file. */
static int run_until(unsigned i)
{
    const pid_t child = fork();
    int status = 0;

    ck_assert_int_ge(child, 0);
    if (child == 0) {
        store_plant = scan_plant_new(0);
        store_start();
        store_change(2);
        what = ENDS;
        countdown = i;
        _exit(store_save(1) == 0 ? 1 : 2);
    }
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void in_a_process(void (*run)(void))
{
    const pid_t child = fork();
    int status = 0;

    ck_assert_int_ge(child, 0);
    if (child == 0) {
        store_plant = scan_plant_new(0);
        run();
        scan_plant_free(store_plant);
        _exit(0);
    }
    ck_assert_int_eq(waitpid(child, &status, 0), child);
    ck_assert(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

static void save_first(void)
{
    store_start();
    store_change(1);
    ck_assert_uint_eq(store_save(1), 0);
}

static void find_old_or_new(void)
{
    store_start();
    ck_assert(!store_log_has(""));
    if (!store_is_changed(1))
        store_expect_changed(2);
}

static void find_new(void)
{
    store_start();
    store_expect_changed(2);
}

START_TEST(the_power_fails_at_each_call)
{
    unsigned i = 0;
    int status = 0;

    store_make_folder();
    in_a_process(save_first);
    while (status == 0 && i < CALLS_MAX) {
        status = run_until(++i);
        in_a_process(find_old_or_new);
    }
    ck_assert_int_eq(status, 1);
    ck_assert_uint_gt(i, 30);
    in_a_process(find_new);
    ck_assert_uint_eq(store_files(), 1);
    store_remove_folder();
}
END_TEST

/* --- while it is written --- */

/* The protocol goes on, the node's client waits; who takes the node from the bus waits, too. */
static void *reset_node(void *context)
{
    (void)context;
    ck_assert_int_eq(canOpenResetNode(store_node), SCANOPEN_OK);
    scan_note("reset");
    return NULL;
}

START_TEST(a_slow_disk)
{
    pthread_t thread;
    uint32_t value = 0;

    store_set_up();
    store_start();
    store_change(1);
    pthread_mutex_lock(&gate);
    slow = true;
    scan_send(store_plant, "605#2310100173617665");
    scan_expect_note("writes");
    slow = false;
    scan_operational(store_plant, store_node); /* NMT goes on */
    scan_sdo_read(store_plant, 5, 0x2000, 0, &value);
    ck_assert_uint_eq(value, 2221); /* and SDO: that has ended the client's transfer */
    ck_assert_int_eq(pthread_create(&thread, NULL, reset_node, NULL), 0);
    scan_expect_no_note();
    pthread_mutex_unlock(&gate);
    pthread_join(thread, NULL);
    scan_expect_note("reset");
    store_expect_changed(1); /* what is in the file is what the node has */
    store_restart();
    store_expect_changed(1);
    store_tear_down();
}
END_TEST

/* Two clients at once, on two channels: one after the other is served, and both are answered. */
START_TEST(two_clients)
{
    SLAVE_NODE_INFO info = store_info(0);

    store_make_folder();
    store_plant = scan_plant_new(0);
    info.ulOptions |= ADDITIONAL_SDOS;
    info.ucServerSDO = 2;
    store_node = scan_node(store_plant, 5, &info);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1201, 1, 4, 0x680), 0);
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, 0x1201, 2, 4, 0x681), 0);
    pthread_mutex_lock(&gate);
    slow = true;
    scan_send(store_plant, "605#2310100173617665");
    scan_expect_note("writes");
    scan_forget(store_plant);
    scan_send(store_plant, "680#231110016C6F6164");
    pthread_mutex_unlock(&gate);
    scan_expect(store_plant, "585#6010100100000000");
    scan_expect(store_plant, "681#6011100100000000");
    slow = false;
    ck_assert_uint_eq(store_files(), 1);
    store_tear_down();
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("power");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_test(tcase, each_call_fails);
    tcase_add_test(tcase, the_power_fails_at_each_call);
    tcase_add_test(tcase, a_slow_disk);
    tcase_add_test(tcase, two_clients);
    return suite_run("scan_store_power", tcase);
}

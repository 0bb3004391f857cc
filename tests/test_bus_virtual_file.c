/* The file a virtual bus lives in: its name, who may use it, how it comes and goes. */
#include "port/bus_segment.h"
#include "support/bus_fixture.h"

#include <check.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct {
    const char *name;
    enum co_err err;
} name_cases[] = {
    { "virtual:", CO_ERR_ARG },
    { "virtual:a/b", CO_ERR_ARG },
    { "virtual:a b", CO_ERR_ARG },
    { "virtual:?bitrate=500000", CO_ERR_ARG },
    { "virtual:\xC3\xA4", CO_ERR_ARG },
    { "virtual:test-123456789012345678901234567", CO_OK },
    { "virtual:test-1234567890123456789012345678", CO_ERR_ARG },
    { "virtual:test-A_z.9", CO_OK },
};

START_TEST(names_are_checked)
{
    char message[200] = "";

    ck_assert_int_eq(fixture_try_open(name_cases[_i].name, message, sizeof message),
                     name_cases[_i].err);
    if (name_cases[_i].err)
        ck_assert_ptr_nonnull(strstr(message, "cannot name a virtual bus"));
    ck_assert_int_eq(fixture_try_open(name_cases[_i].name, NULL, 0), name_cases[_i].err);
}
END_TEST

START_TEST(the_bus_tells_its_name_and_state)
{
    struct bus *bus = fixture_open(false);
    char text[100];

    ck_assert_str_eq(bus_name(bus), fixture_name());
    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
    bus_explain(bus, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "is up"));
    bus_close(bus);
    bus_close(NULL);
}
END_TEST

START_TEST(the_last_one_removes_the_file)
{
    struct bus *first = fixture_open(false), *second = fixture_open(false);

    ck_assert_int_eq(access(fixture_path(), F_OK), 0);
    bus_close(first);
    ck_assert_int_eq(access(fixture_path(), F_OK), 0);
    bus_close(second);
    ck_assert_int_ne(access(fixture_path(), F_OK), 0);
}
END_TEST

START_TEST(a_file_that_replaced_ours_is_not_removed)
{
    struct bus *first = fixture_open(false), *second, *third;

    ck_assert_int_eq(unlink(fixture_path()), 0);
    second = fixture_open(false);
    bus_close(first);
    third = fixture_open(false);
    fixture_send_number(second, 1);
    fixture_expect(third, "123#01000000");
    bus_close(second);
    bus_close(third);
}
END_TEST

static void *open_in_thread(void *context)
{
    (void)context;
    return fixture_open(false);
}

START_TEST(a_file_removed_while_we_wait_for_it_is_not_joined)
{
    int fd = open(fixture_path(), O_RDWR | O_CREAT, 0600);
    struct bus *other;
    pthread_t opener;
    void *bus;

    ck_assert_int_eq(flock(fd, LOCK_EX), 0);
    ck_assert_int_eq(pthread_create(&opener, NULL, open_in_thread, NULL), 0);
    usleep(20000); /* most likely it waits by now; correct either way */
    ck_assert_int_eq(unlink(fixture_path()), 0);
    close(fd);
    ck_assert_int_eq(pthread_join(opener, &bus), 0);
    other = fixture_open(false);
    fixture_send_number(other, 1);
    fixture_expect(bus, "123#01000000");
    bus_close(bus);
    bus_close(other);
}
END_TEST

START_TEST(buses_are_private)
{
    struct bus *bus = fixture_open(false);
    struct stat info;

    ck_assert_int_eq(stat(fixture_path(), &info), 0);
    ck_assert_uint_eq(info.st_mode & 0777, 0600);
    bus_close(bus);
}
END_TEST

START_TEST(participants_are_bounded)
{
    struct bus *all[SEGMENT_SLOTS];
    char message[200];

    for (unsigned i = 0; i < SEGMENT_SLOTS; i++)
        all[i] = fixture_open(false);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_MEMORY);
    ck_assert_ptr_nonnull(strstr(message, "has 64 participants"));
    fixture_send_number(all[63], 1);
    fixture_expect(all[0], "123#01000000");
    bus_close(all[5]);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_OK);
    all[5] = fixture_open(true);
    for (unsigned i = 0; i < SEGMENT_SLOTS; i++)
        bus_close(all[i]);
}
END_TEST

static void write_file(const char *text, mode_t mode)
{
    int fd = open(fixture_path(), O_WRONLY | O_CREAT, 0600);

    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(write(fd, text, strlen(text)), (ssize_t)strlen(text));
    ck_assert_int_eq(fchmod(fd, mode), 0);
    close(fd);
}

START_TEST(a_damaged_file_nobody_uses_is_set_up_anew)
{
    struct bus *first, *second;

    write_file("this is not a bus", 0600);
    first = fixture_open(false);
    second = fixture_open(false);
    fixture_send_number(first, 5);
    fixture_expect(second, "123#05000000");
    bus_close(first);
    bus_close(second);
}
END_TEST

START_TEST(a_damaged_file_in_use_is_refused)
{
    struct bus *bus = fixture_open(false);
    char message[300];

    write_file("damaged!", 0600);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_STATE);
    ck_assert_ptr_nonnull(strstr(message, "is damaged"));
    bus_close(bus);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_OK);
}
END_TEST

START_TEST(a_bus_of_another_namespace_is_refused)
{
    const struct bus_message none = { NULL, 0 };
    struct segment segment;
    char message[300];

    ck_assert_int_eq(segment_open(&segment, fixture_name() + strlen(BUS_VIRTUAL_PREFIX), 0, &none),
                     CO_OK);
    segment.map->network_space++;
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_STATE);
    ck_assert_ptr_nonnull(strstr(message, "namespace"));
    segment.map->network_space--;
    segment.map->pid_space++;
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_STATE);
    segment.map->pid_space--;
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_OK);
    segment_close(&segment);
}
END_TEST

START_TEST(a_bus_never_set_up_does_not_hang)
{
    int fd = open(fixture_path(), O_RDWR | O_CREAT, 0600);
    char message[300];

    ck_assert_int_eq(flock(fd, LOCK_EX), 0); /* as a process does that is stopped in its set-up */
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_HELD);
    ck_assert_ptr_nonnull(strstr(message, "setting it up"));
    close(fd);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_OK);
}
END_TEST

START_TEST(a_file_others_can_write_is_refused)
{
    char message[300];

    write_file("", 0666);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_PERMISSION);
    ck_assert_ptr_nonnull(strstr(message, "not a private file"));
}
END_TEST

START_TEST(a_link_is_refused)
{
    char message[300];

    ck_assert_int_eq(symlink("/dev/null", fixture_path()), 0);
    ck_assert_int_eq(fixture_try_open(fixture_name(), message, sizeof message), CO_ERR_IO);
    ck_assert_ptr_nonnull(strstr(message, fixture_path()));
}
END_TEST

static Suite *suite_of_all(void)
{
    Suite *suite = suite_create("bus_virtual_file");
    TCase *tests = tcase_create("one process");

    tcase_set_timeout(tests, 100);
    tcase_add_checked_fixture(tests, fixture_remove_file, NULL);
    tcase_add_loop_test(tests, names_are_checked, 0, sizeof name_cases / sizeof name_cases[0]);
    tcase_add_test(tests, the_bus_tells_its_name_and_state);
    tcase_add_test(tests, the_last_one_removes_the_file);
    tcase_add_test(tests, a_file_that_replaced_ours_is_not_removed);
    tcase_add_test(tests, a_file_removed_while_we_wait_for_it_is_not_joined);
    tcase_add_test(tests, buses_are_private);
    tcase_add_test(tests, participants_are_bounded);
    tcase_add_test(tests, a_damaged_file_nobody_uses_is_set_up_anew);
    tcase_add_test(tests, a_damaged_file_in_use_is_refused);
    tcase_add_test(tests, a_bus_of_another_namespace_is_refused);
    tcase_add_test(tests, a_bus_never_set_up_does_not_hang);
    tcase_add_test(tests, a_file_others_can_write_is_refused);
    tcase_add_test(tests, a_link_is_refused);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(suite_of_all());
    int failed;

    fixture_choose_name();
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    fixture_remove_file();
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

/*
 * The priorities that the manager's file gives: those of the threads themselves, as the kernel has
 * them. Where the right to set them is missing, what the library has asked for counts: the linker
 * leads its calls here (--wrap).
 */
#include "support/api_plant.h"
#include "support/suite.h"

#include "scanopen.h"

#include <dirent.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ASKED 16u

static struct api_plant *plant;

static struct { /* in vain */
    char name[16];
    int priority;
} asked[ASKED];
static unsigned asked_count;

int __real_pthread_setschedparam(pthread_t thread, int policy, const struct sched_param *param);
int __wrap_pthread_setschedparam(pthread_t thread, int policy, const struct sched_param *param);

int __wrap_pthread_setschedparam(pthread_t thread, int policy, const struct sched_param *param)
{
    if (__real_pthread_setschedparam(thread, policy, param) == 0)
        return 0;
    ck_assert_uint_lt(asked_count, ASKED);
    pthread_getname_np(thread, asked[asked_count].name, sizeof asked[0].name);
    asked[asked_count++].priority = policy == SCHED_FIFO ? param->sched_priority : 0;
    return 0;
}

static void set_up(void)
{
    plant = api_plant_new();
    api_add_device(plant, 5);
    api_devices_start(plant);
    ck_assert_int_eq(setenv("MCANOPEN_NET_0", plant->bus, 1), 0);
}

static void tear_down(void)
{
    canOpenRemoveNetwork(0);
    api_plant_free(plant);
}

static bool has_name(int thread, const char *name)
{
    char path[64], text[32] = "";
    FILE *file;

    snprintf(path, sizeof path, "/proc/self/task/%d/comm", thread);
    file = fopen(path, "r");
    if (!file)
        return false;
    if (!fgets(text, sizeof text, file))
        text[0] = '\0';
    fclose(file);
    text[strcspn(text, "\n")] = '\0';
    return strcmp(text, name) == 0;
}

/* The highest of the threads with this name (the plant's own network has one, too); 0: none. */
static int priority_of(const char *name)
{
    DIR *folder = opendir("/proc/self/task");
    int highest = 0;

    ck_assert_ptr_nonnull(folder);
    for (struct dirent *entry; (entry = readdir(folder)) != NULL;) {
        const int thread = atoi(entry->d_name);
        struct sched_param param;

        if (thread > 0 && has_name(thread, name) && sched_getscheduler(thread) == SCHED_FIFO &&
            sched_getparam(thread, &param) == 0 && param.sched_priority > highest)
            highest = param.sched_priority;
    }
    closedir(folder);
    for (unsigned i = 0; i < asked_count; i++)
        if (strcmp(asked[i].name, name) == 0 && asked[i].priority > highest)
            highest = asked[i].priority;
    return highest;
}

#define MANAGER "<Manager_Thread_Priorities>3:20:5</Manager_Thread_Priorities>"
#define SLAVES  "<Slave_Thread_Priorities>4:8:12:16</Slave_Thread_Priorities>"
#define NATIVE  "<Native_Thread_Priorities>TRUE</Native_Thread_Priorities>"

/* The scale 0..31 is 1..49 of the kernel. */
START_TEST(manager_thread_priorities)
{
    api_boot(plant, MANAGER API_NODE(5));
    ck_assert_int_eq(priority_of("mcan-control"), 5);
    ck_assert_int_eq(priority_of("mcanopen"), 31); /* the highest of all */
}
END_TEST

START_TEST(native_thread_priorities)
{
    api_boot(plant, MANAGER NATIVE API_NODE(5));
    ck_assert_int_eq(priority_of("mcan-control"), 3);
    ck_assert_int_eq(priority_of("mcanopen"), 20);
}
END_TEST

/* Of a network of slaves that comes before the manager, between its calls, or behind them. */
START_TEST(slave_thread_priorities)
{
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    if (_i == 0)
        ck_assert_int_eq(canOpenCreateNetwork(0, "slaves", 500), SCANOPEN_OK);
    ck_assert_msg(api_config(plant, SLAVES API_NODE(5)) == MCANOPEN_OK, "%s",
                  mcanOpenGetErrorText());
    if (_i == 1)
        ck_assert_int_eq(canOpenCreateNetwork(0, "slaves", 500), SCANOPEN_OK);
    mcanOpenStart();
    if (_i == 2)
        ck_assert_int_eq(canOpenCreateNetwork(0, "slaves", 500), SCANOPEN_OK);
    ck_assert_int_eq(priority_of("mcan-nmt"), 7);
    ck_assert_int_eq(priority_of("mcan-pdo"), 13);
    ck_assert_int_eq(priority_of("mcan-sdo"), 19);
    ck_assert_int_eq(priority_of("mcan-emcy"), 25);
    ck_assert_int_eq(priority_of("mcanopen"), 25);
}
END_TEST

/* The first one's count. */
START_TEST(slaves_with_priorities_of_their_own)
{
    const SLAVE_NET_INFO info = { .ulOptions = THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE,
                                  .usBaudrate = 500,
                                  .sPrioNMT = 2,
                                  .sPrioSDO = 3,
                                  .sPrioPDO = 4,
                                  .sPrioEMCY = 6 };
    const bool before = _i == 0;

    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    if (before)
        ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    ck_assert_int_eq(api_config(plant, SLAVES API_NODE(5)), MCANOPEN_OK);
    mcanOpenStart();
    if (!before)
        ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    ck_assert_int_eq(priority_of("mcan-emcy"), before ? 6 : 25);
    ck_assert_int_eq(priority_of("mcanopen"), before ? 6 : 25);
    ck_assert_uint_eq(api_log_count(plant, "1 thread priorities: the "), 1);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("priorities");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, manager_thread_priorities);
    tcase_add_test(tests, native_thread_priorities);
    tcase_add_loop_test(tests, slave_thread_priorities, 0, 3);
    tcase_add_loop_test(tests, slaves_with_priorities_of_their_own, 0, 2);
    return suite_run("api_priorities", tests);
}

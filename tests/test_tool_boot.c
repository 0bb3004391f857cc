/*
 * mcanopen boot where the system refuses threads, which the linker leads here (--wrap): it must not
 * wait for a network that cannot come up.
 */
#include "../tools/verbs.h"
#include "support/api_plant.h"
#include "support/suite.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <sys/eventfd.h>

#define THREADS 2 /* of the control daemon, and of the network */

static _Thread_local int threads_left; /* until one fails; 0: none does */

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context)
{
    if (threads_left > 0 && --threads_left == 0)
        return EAGAIN;
    return __real_pthread_create(thread, attributes, run, context);
}

/* No signal comes. */
int stop_signals(void)
{
    return eventfd(0, EFD_CLOEXEC);
}

START_TEST(without_threads_it_ends_at_once)
{
    struct api_plant *plant = api_plant_new();
    char verb[] = "boot", once[] = "--once", timeout[] = "--timeout", hour[] = "3600";
    char path[SUITE_PATH_SIZE + 64], text[2000];
    char *arguments[] = { verb, once, timeout, hour, path, NULL };

    snprintf(path, sizeof path, "%s", api_path(plant, "network.xml"));
    snprintf(text, sizeof text, "<CANopen_Manager>%s</CANopen_Manager>",
             api_network(plant, 0, API_NODE(5)));
    api_write(plant, "network.xml", text);
    threads_left = _i;
    ck_assert_int_eq(verb_boot(5, arguments), EXIT_NOT_UP);
    ck_assert_int_eq(threads_left, 0);
    api_plant_free(plant);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("tool boot");

    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, without_threads_it_ends_at_once, 1, THREADS + 1);
    return suite_run("tool_boot", tests);
}

/*
 * What the system refuses: memory and threads. The linker leads the library's allocations here
 * (--wrap), where each of a call fails once: the call says so, and leaves nothing behind.
 */
#include "support/scan_plant.h"
#include "support/scarce.h"
#include "support/suite.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define MOST         10000u /* allocations of one call */

/* --- the linker's part, besides memory --- */

static _Thread_local unsigned threads_left; /* until one fails; 0: none does */

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context);

int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
                          void *(*run)(void *context), void *context)
{
    return scarce_fails(&threads_left) ? EAGAIN
                                       : __real_pthread_create(thread, attributes, run, context);
}

/* --- the calls --- */

static struct scan_plant *plant;
static HNODE node, other;
static char store[SUITE_PATH_SIZE];

/* All is there but what the call makes: network 1, a second node, an object, a file, a PDO. */
static void set_up(void)
{
    DictionaryData nothing = { .domain = { NULL, 0, 0 } };
    SLAVE_NODE_INFO info = scan_info();
    FILE *file;

    info.ulOptions |= PARAMETER_STORE;
    plant = scan_plant_new(0);
    node = scan_node(plant, 5, &info);
    scan_number(node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    ck_assert_int_eq(canOpenExtendDictionary(node, 0x2002, 0, OBJ_VAR, MAP_DOMAIN), SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(node, 0x2002, 0, NULL, READ_ACCESS, &nothing, NULL),
                     SCANOPEN_OK);
    suite_temporary("failures", store);
    file = fdopen(mkstemp(store), "w");
    fwrite("\1\0\0\0\5\x10\0\4\0\0\0\x81\0\0\0", 1, 15, file); /* 1005h */
    fclose(file);
}

static void tear_down(void)
{
    unlink(store);
    scan_plant_free(plant);
}

static int create_network(void)
{
    return canOpenCreateNetwork(1, "name", SCAN_BITRATE);
}

static int create_network_ex(void)
{
    const SLAVE_NET_INFO info = { .pNetName = "name", .usBaudrate = SCAN_BITRATE };

    return canOpenCreateNetworkEx(1, &info);
}

static int create_node(void)
{
    return canOpenCreateNode(0, "old", 6, 0x191, MANUFACTURER_INFO, 0, "device", "h", "s", 0, 0, 0,
                             0, NULL, &other);
}

static int create_node_ex(void)
{
    const SLAVE_NODE_INFO info = scan_info();

    return canOpenCreateNodeEx(0, 6, scan_on_event, &info, &other);
}

static int activate_node(void)
{
    return canOpenActivateNode(node);
}

static int extend_dictionary(void)
{
    return canOpenExtendDictionary(node, 0x2001, 20, OBJ_ARRAY, MAP_UINT64);
}

static int set_domain_file(void)
{
    return canOpenSetDomainFile(node, 0x2002, 0, "file", 10);
}

static int define_pdo(void)
{
    const uint16_t mapping[] = { 0x2000, 0, 0, 0 };
    HPDO pdo;

    return canOpenDefinePDO(node, NULL, DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, 0, 0, mapping,
                            &pdo);
}

static int remove_network(void)
{
    return canOpenRemoveNetwork(1);
}

static int delete_node(void)
{
    return canOpenDeleteNode(other);
}

static int reset_node(void)
{
    return canOpenResetNode(node);
}

static int set_store_file(void)
{
    return canOpenSetStoreFile(node, store);
}

struct call {
    int (*run)(void);
    int (*undo)(void);
};

static const struct call in_need_of_memory[] = {
    { create_network, remove_network }, { create_network_ex, remove_network },
    { create_node, delete_node },       { create_node_ex, delete_node },
    { activate_node, reset_node },      { extend_dictionary, NULL },
    { set_domain_file, NULL },          { define_pdo, NULL },
    { set_store_file, NULL },
};

static const struct call in_need_of_threads[] = {
    { create_network, remove_network },
    { create_network_ex, remove_network },
    { set_store_file, NULL },
};

/*
 * One after the other of what the call asks for is refused; the last time nothing is. It fails with
 * this code, but may do without some; without memory a thread may not start, too.
 */
static void refuse_each(const struct call *call, unsigned *left, int code)
{
    struct scan_plant *bus = scan_plant_bare(1);
    unsigned refusals = 0, told = 0;
    bool refused = true;
    int result = code;

    while (refused && refusals < MOST) {
        *left = refusals + 1;
        result = call->run();
        refused = *left == 0;
        *left = 0;
        refusals += refused;
        told += result == code;
        if (result == SCANOPEN_OK && call->undo)
            ck_assert_int_eq(call->undo(), SCANOPEN_OK);
        else if (refused && result != SCANOPEN_OK && result != code &&
                 result != SCANOPEN_CANNOT_START_DAEMON)
            ck_abort_msg("refusal %u: %d", refusals, result);
    }
    ck_assert_int_eq(result, SCANOPEN_OK);
    ck_assert_uint_ge(told, 1);
    scan_plant_free(bus);
}

START_TEST(memory_runs_out)
{
    refuse_each(&in_need_of_memory[_i], &memory_left, SCANOPEN_OUT_OF_MEMORY);
}
END_TEST

START_TEST(no_thread_can_be_started)
{
    refuse_each(&in_need_of_threads[_i], &threads_left, SCANOPEN_CANNOT_START_DAEMON);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("failures");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_loop_test(tcase, memory_runs_out, 0, COUNT(in_need_of_memory));
    tcase_add_loop_test(tcase, no_thread_can_be_started, 0, COUNT(in_need_of_threads));
    return suite_run("scan_failures", tcase);
}

#include "support/store_node.h"

#include "mcanopen.h"

#include <dirent.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BOTH (READ_ACCESS | WRITE_ACCESS)

struct scan_plant *store_plant;
HNODE store_node;
char store_folder[SUITE_PATH_SIZE], store_path[SUITE_PATH_SIZE + 16];

static pthread_mutex_t log_lock = PTHREAD_MUTEX_INITIALIZER;
static char log_text[4000];

static void on_log(void *context, int level, const char *text)
{
    size_t length;

    (void)context;
    (void)level;
    pthread_mutex_lock(&log_lock);
    length = strlen(log_text);
    snprintf(log_text + length, sizeof log_text - length, "%s\n", text);
    pthread_mutex_unlock(&log_lock);
}

bool store_log_has(const char *text)
{
    bool has;

    pthread_mutex_lock(&log_lock);
    has = log_text[0] != '\0' && strstr(log_text, text) != NULL;
    pthread_mutex_unlock(&log_lock);
    return has;
}

void store_log_clear(void)
{
    pthread_mutex_lock(&log_lock);
    log_text[0] = '\0';
    pthread_mutex_unlock(&log_lock);
}

void store_make_folder(void)
{
    suite_temporary("store", store_folder);
    ck_assert_ptr_nonnull(mkdtemp(store_folder));
    snprintf(store_path, sizeof store_path, "%s/node-5.ccf", store_folder);
    store_log_clear();
    mcanOpenSetLog(on_log, NULL);
}

void store_remove_folder(void)
{
    char command[sizeof store_folder + 16];

    snprintf(command, sizeof command, "rm -rf %s", store_folder);
    ck_assert_int_eq(system(command), 0);
    mcanOpenSetLog(NULL, NULL);
}

void store_set_up(void)
{
    store_make_folder();
    store_plant = scan_plant_new(0);
}

void store_tear_down(void)
{
    scan_plant_free(store_plant);
    store_remove_folder();
}

SLAVE_NODE_INFO store_info(unsigned long mask)
{
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= PARAMETER_STORE | PARAMETER_RESET | PRODUCER_HEARTBEAT;
    info.ulEventMask = mask;
    return info;
}

static void make_text(void)
{
    static char memory[16];
    DictionaryData data = { .visstring = { memory, sizeof memory, 3 } };

    memcpy(memory, "abc", 4);
    ck_assert_int_eq(canOpenExtendDictionary(store_node, 0x2001, 0, OBJ_VAR, MAP_VIS_STRING),
                     SCANOPEN_OK);
    ck_assert_int_eq(canOpenInitDictionary(store_node, 0x2001, 0, NULL, BOTH, &data, NULL),
                     SCANOPEN_OK);
}

void store_make(unsigned long mask)
{
    const SLAVE_NODE_INFO info = store_info(mask);

    store_node = scan_node(store_plant, 5, &info);
    scan_number(store_node, 0x2000, TYP_UINT16, BOTH, 20, NULL);
    scan_number(store_node, 0x2002, TYP_UINT16, READ_ACCESS, 1, NULL);
    scan_number(store_node, 0x6000, TYP_UINT16, BOTH, 60, NULL);
    make_text();
}

void store_start(void)
{
    store_make(0);
    ck_assert_int_eq(canOpenSetStoreFile(store_node, store_path), SCANOPEN_OK);
    scan_activate(store_plant, store_node);
}

void store_restart(void)
{
    scan_plant_free(store_plant);
    store_plant = scan_plant_new(0);
    store_start();
}

void store_reset(const char *command)
{
    scan_send(store_plant, command);
    scan_await(store_plant, "705#00");
}

void store_put(unsigned index, unsigned size, uint32_t value)
{
    ck_assert_uint_eq(scan_sdo_write(store_plant, 5, index, 0, size, value), 0);
}

uint32_t store_save(unsigned sub)
{
    return scan_sdo_write(store_plant, 5, 0x1010, sub, 4, STORE_SAVE);
}

uint32_t store_load(unsigned sub)
{
    return scan_sdo_write(store_plant, 5, 0x1011, sub, 4, STORE_LOAD);
}

void store_change(unsigned by)
{
    store_put(0x1017, 2, 30000 + by);
    store_put(0x2000, 2, 2220 + by);
    store_put(0x6000, 2, 6660 + by);
}

bool store_is(uint32_t communication, uint32_t manufacturer, uint32_t application)
{
    return scan_get(store_node, 0x1017, 0) == communication &&
           scan_get(store_node, 0x2000, 0) == manufacturer &&
           scan_get(store_node, 0x6000, 0) == application;
}

void store_expect(uint32_t communication, uint32_t manufacturer, uint32_t application)
{
    ck_assert_msg(store_is(communication, manufacturer, application), "%u %u %u",
                  scan_get(store_node, 0x1017, 0), scan_get(store_node, 0x2000, 0),
                  scan_get(store_node, 0x6000, 0));
}

bool store_is_changed(unsigned by)
{
    return store_is(30000 + by, 2220 + by, 6660 + by);
}

void store_expect_changed(unsigned by)
{
    store_expect(30000 + by, 2220 + by, 6660 + by);
}

void store_expect_defaults(void)
{
    store_expect(0, 20, 60);
}

unsigned store_files(void)
{
    DIR *entries = opendir(store_folder);
    unsigned count = 0;

    while (readdir(entries))
        count++;
    closedir(entries);
    return count - 2; /* "." and ".." */
}

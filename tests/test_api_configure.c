/* A network whose file knows no node: its application configures it by the manager's dictionary. */
#include "port/thread.h"
#include "support/api_plant.h"
#include "support/suite.h"

#include <stdatomic.h>
#include <string.h>

#define SELF 127
#define CONF "conf"

/* 2001h = 9 */
static const unsigned char concise[] = { 1, 0, 0, 0, 0x01, 0x20, 0, 1, 0, 0, 0, 9 };

static struct api_plant *plant;

static void set_up(void)
{
    plant = api_plant_new();
    api_add_device(plant, 5);
    api_add_number(plant, 5, 0x2001, 1, 0x11);
    api_devices_start(plant);
}

static void tear_down(void)
{
    api_plant_free(plant);
}

static void put(int index, int sub, int type, const void *bytes, int size)
{
    ERROR_T error;

    ck_assert_int_eq(mcanOpenWriteSDO(0, SELF, index, sub, type, bytes, size, &error), MCANOPEN_OK);
}

static void expect_value(unsigned value)
{
    uint8_t read = 0;

    ck_assert_uint_eq(api_get(plant, 5, 0x2001, &read, 1), 1);
    ck_assert_uint_eq(read, value);
}

static void list_node(unsigned char node)
{
    put(0x1F22, node, TYP_DOMAIN, concise, sizeof concise);
    put(0x1F81, node, TYP_UINT32, "\5\0\0\0", 4);
}

START_TEST(a_network_without_nodes_gets_one)
{
    BOOT_RECORD_T record = { .size = sizeof record };
    unsigned char other[sizeof concise];

    api_start(plant, "");
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCAL_NODE_NOT_EXISTEND);
    list_node(5);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STARTED), 5);
    expect_value(9);
    ck_assert_int_eq(mcanOpenGetBootRecord(0, 5, &record), MCANOPEN_OK);
    ck_assert_uint_eq(record.entries, 1);
    ck_assert_str_eq(record.file, "");
    memcpy(other, concise, sizeof other);
    other[sizeof other - 1] = 8;
    put(0x1F22, 5, TYP_DOMAIN, other, sizeof other);
    put(0x1F25, 5, TYP_UINT32, CONF, 4);
    api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_CONFIGURED), 5);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STARTED), 5);
    expect_value(8);
}
END_TEST

START_TEST(what_is_wrong_with_it_is_told)
{
    EVENT_T event;
    ERROR_T error;

    api_start(plant, "");
    ck_assert_int_eq(mcanOpenWriteSDO(0, SELF, 0x1F20, 5, TYP_DOMAIN, "nothing", 7, &error),
                     MCAL_ABORT_DOMAIN);
    ck_assert_uint_eq(error.eclass, 8);
    event = api_wait_event(API_EVENT(PARA_STR, MCANOPEN_MSG_TEXT), 5);
    ck_assert_str_eq(event.para.str,
                     "node 5: what a tool has written to 1F20h:05 is refused: 1F20h: ");
    api_wait_log(plant, "1 node 5: what a tool has written to 1F20h:05 is refused: 1F20h: error: "
                        "EDS or DCF text expected, there is no section in it");
}
END_TEST

/* --- while others ask --- */

static atomic_bool over;

static void *ask(void *context)
{
    (void)context;
    while (!atomic_load(&over)) {
        BOOT_RECORD_T record = { .size = sizeof record };
        unsigned char buffer[4];
        int len = sizeof buffer, state;

        for (int node = 5; node < 9; node++) {
            mcanOpenGetBootRecord(0, node, &record);
            mcanOpenGetNodeState(0, node, &state);
        }
        mcanOpenReadSDO(0, 5, 0x2001, 0, buffer, &len, NULL);
    }
    return NULL;
}

START_TEST(others_ask_meanwhile)
{
    struct co_thread thread;

    atomic_store(&over, false);
    api_start(plant, "");
    ck_assert_int_eq(thread_start(&thread, "ask", ask, NULL), CO_OK);
    for (unsigned char node = 5; node < 9; node++)
        list_node(node);
    api_wait_event(API_EVENT(PARA_UC, MCANOPEN_MSG_NODE_STARTED), 5);
    for (unsigned char node = 5; node < 9; node++)
        put(0x1F22, node, TYP_DOMAIN, concise, sizeof concise);
    put(0x1F81, 6, TYP_UINT32, "\0\0\0\0", 4);
    atomic_store(&over, true);
    thread_join(&thread);
    expect_value(9);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("configure");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, a_network_without_nodes_gets_one);
    tcase_add_test(tests, what_is_wrong_with_it_is_told);
    tcase_add_test(tests, others_ask_meanwhile);
    return suite_run("api_configure", tests);
}

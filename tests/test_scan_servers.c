/* SDO servers of a node besides the default one, and block transfers: what the options say. */
#include "support/dcf_file.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define BOTH      (READ_ACCESS | WRITE_ACCESS)
#define NO_OBJECT 0x06020000
#define READ_TYPE "#4000100000000000" /* 1000h */
#define THE_TYPE  "#4300100092010200"

static struct scan_plant *plant;
static HNODE node;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

static void make(unsigned long options, unsigned servers)
{
    SLAVE_NODE_INFO info = scan_info();

    info.ulOptions |= options;
    info.ucServerSDO = (unsigned char)servers;
    node = scan_node(plant, 5, &info);
}

/* By a client of the default one: 1200h + number answers 'request' with 'response'. */
static void open_server(unsigned number, uint32_t request, uint32_t response)
{
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1200 + number, 1, 4, request), 0);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1200 + number, 2, 4, response), 0);
}

START_TEST(a_client_opens_a_server)
{
    make(ADDITIONAL_SDOS, 3);
    scan_activate(plant, node);
    scan_send(plant, "6A2" READ_TYPE);
    scan_expect_nothing_more(plant, node);
    open_server(2, 0x6A2, 0x6A3);
    scan_send(plant, "6A2" READ_TYPE);
    scan_expect(plant, "6A3" THE_TYPE);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1202, 2, 4, 0x6A4), 0x06090030);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1201, 1, 4, 0x6A2), 0x06090030);
    ck_assert_uint_eq(scan_sdo_write(plant, 5, 0x1202, 2, 4, 0x800006A3), 0);
    scan_send(plant, "6A2" READ_TYPE);
    scan_expect_nothing_more(plant, node);
}
END_TEST

/* All that there can be; the first one is included. */
START_TEST(how_many_servers)
{
    static const unsigned counts[] = { 1, 2, 127 };
    const unsigned count = counts[_i];
    char frame[32];
    uint32_t value;

    make(ADDITIONAL_SDOS, count);
    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1200 + count, 0, &value), NO_OBJECT);
    for (unsigned i = 1; i < count; i++)
        open_server(i, 0x200 + i, 0x280 + i);
    for (unsigned i = 1; i < count; i++) {
        snprintf(frame, sizeof frame, "%03X" READ_TYPE, 0x200 + i);
        scan_send(plant, frame);
        snprintf(frame, sizeof frame, "%03X" THE_TYPE, 0x280 + i);
        scan_expect(plant, frame);
    }
}
END_TEST

START_TEST(servers_of_an_older_node)
{
    uint32_t value;

    ck_assert_int_eq(canOpenCreateNode(0, "old", 5, 0x20192, ADDITIONAL_SDOS | BLOCK_TRANSFER, 0,
                                       NULL, NULL, NULL, 0, 0, 2, 0, NULL, &node),
                     SCANOPEN_OK);
    scan_plant_keep(plant, node, 5);
    scan_activate(plant, node);
    open_server(1, 0x6A2, 0x6A3);
    scan_send(plant, "6A2" READ_TYPE);
    scan_expect(plant, "6A3" THE_TYPE);
    ck_assert_uint_eq(scan_sdo_read(plant, 5, 0x1202, 0, &value), NO_OBJECT);
    scan_send(plant, "6A2#A000100004000000");
    scan_expect(plant, "6A3#C600100004000000");
}
END_TEST

/* --- handlers that are asked by several clients --- */

static struct {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool open;
} gate = { .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER };

static void set_gate(bool open)
{
    pthread_mutex_lock(&gate.lock);
    gate.open = open;
    pthread_cond_broadcast(&gate.changed);
    pthread_mutex_unlock(&gate.lock);
}

/* Odd values are refused. */
static int on_value(int net, int id, int index, int sub, void *data)
{
    const unsigned value = *(const uint16_t *)data;

    scan_note("%d/%d %04X:%02X asked %04X", net, id, (unsigned)index, (unsigned)sub, value);
    pthread_mutex_lock(&gate.lock);
    while (!gate.open)
        pthread_cond_wait(&gate.changed, &gate.lock);
    pthread_mutex_unlock(&gate.lock);
    return value % 2 ? SCANOPEN_VALUE_TOO_HIGH : SCANOPEN_OK;
}

/* A node with two more servers, and an object whose handler stands at the gate. */
static void make_asked(void)
{
    make(ADDITIONAL_SDOS, 3);
    scan_number(node, 0x2000, TYP_UINT16, BOTH, 0x1111, on_value);
    scan_activate(plant, node);
    open_server(1, 0x6A0, 0x6A1);
    open_server(2, 0x6A2, 0x6A3);
    scan_forget(plant);
    scan_await_note("event 0/5 WRITE_DICTIONARY 4610 2");
    set_gate(false);
}

/* What was sent before has come to the node. */
static void pass_time(void)
{
    scan_send(plant, "000#0105");
    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_OPERATIONAL), NodeOperational);
}

/* Three clients wait at the same time: each gets its own answer, and the last value stays. */
START_TEST(a_handler_answers_each_client)
{
    make_asked();
    scan_send(plant, "605#2B00200002000000");
    scan_await_note("0/5 2000:00 asked 0002");
    scan_send(plant, "6A2#2B00200003000000");
    scan_send(plant, "6A0#2B00200004000000");
    pass_time();
    set_gate(true);
    scan_await_note("0/5 2000:00 asked 0004"); /* channels have their turns */
    scan_await_note("0/5 2000:00 asked 0003");
    scan_expect(plant, "585#6000200000000000");
    scan_expect(plant, "6A1#6000200000000000");
    scan_expect(plant, "6A3#8000200031000906");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 4);
}
END_TEST

/* One of them begins anew, one is closed: the others get their answers. */
START_TEST(a_client_that_goes_on_harms_no_other)
{
    make_asked();
    scan_send(plant, "6A0#2B00200002000000");
    scan_await_note("0/5 2000:00 asked 0002");
    scan_send(plant, "6A2#2B00200004000000");
    scan_send(plant, "605#2B00200008000000");
    scan_send(plant, "605#2B0020000A000000");
    scan_send(plant, "6A0" READ_TYPE);
    scan_expect(plant, "6A1" THE_TYPE);
    pass_time();
    set_gate(true);
    scan_expect(plant, "6A3#6000200000000000");
    scan_expect(plant, "585#6000200000000000");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 10);
    ck_assert_uint_eq(scan_count_notes("0/5 2000:00 asked 0008"), 0);
}
END_TEST

START_TEST(a_node_that_goes_offline_forgets_them)
{
    make_asked();
    scan_send(plant, "605#2B00200002000000");
    scan_await_note("0/5 2000:00 asked 0002");
    scan_send(plant, "6A0#2B00200004000000");
    pass_time();
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    scan_activate(plant, node);
    scan_send(plant, "605#2B00200006000000");
    set_gate(true);
    scan_expect(plant, "585#6000200000000000");
    scan_expect_nothing_more(plant, node);
    ck_assert_uint_eq(scan_get(node, 0x2000, 0), 6);
    ck_assert_uint_eq(scan_count_notes("0/5 2000:00 asked 0004"), 0);
}
END_TEST

/* --- block transfers --- */

START_TEST(block_transfers_are_an_option)
{
    const bool wanted = _i != 0;

    make(wanted ? BLOCK_TRANSFER : 0, 0);
    scan_activate(plant, node);
    scan_send(plant, "605#A000100004000000");
    scan_expect(plant, wanted ? "585#C600100004000000" : "585#8000100001000405");
}
END_TEST

/* --- from a file --- */

#define SERVER                                                                                     \
    "[1203]\nParameterName=Server\nObjectType=9\nSubNumber=4\n" VAR(                               \
        "1203sub0", "5",                                                                           \
        "const") "DefaultValue=3\n" VAR("1203sub1", "7",                                           \
                                        "rw") "DefaultValue=$NODEID+0x6A0\n" VAR("1203sub2", "7",  \
                                                                                 "rw") "DefaultVa" \
                                                                                       "lue="      \
                                                                                       "0x6B0"     \
                                                                                       "\n" VAR(   \
                                                                                           "1203s" \
                                                                                           "ub3",  \
                                                                                           "5",    \
                                                                                           "rw")

/* The servers that it has are open from the beginning, and serve block transfers. */
START_TEST(servers_of_a_file)
{
    static const char text[] = FILE_INFO DEVICE_INFO LISTS
        "[OptionalObjects]\nSupportedObjects=1\n1=0x1203\n" MANDATORY SERVER;
    char name[SUITE_PATH_SIZE];
    int file;

    suite_temporary("servers", name);
    file = mkstemp(name);
    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(write(file, text, sizeof text - 1), (ssize_t)sizeof text - 1);
    close(file);
    ck_assert_int_eq(canOpenCreateNodeFromFile(0, 5, scan_on_event, name, NULL, &node),
                     SCANOPEN_OK);
    unlink(name);
    scan_plant_keep(plant, node, 5);
    scan_activate(plant, node);
    scan_send(plant, "6A5" READ_TYPE);
    scan_expect(plant, "6B0#4300100001000000");
    scan_send(plant, "6A5#A000100004000000");
    scan_expect(plant, "6B0#C600100004000000");
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("scan_servers");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, a_client_opens_a_server);
    tcase_add_loop_test(tcase, how_many_servers, 0, 3);
    tcase_add_test(tcase, servers_of_an_older_node);
    tcase_add_test(tcase, a_handler_answers_each_client);
    tcase_add_test(tcase, a_client_that_goes_on_harms_no_other);
    tcase_add_test(tcase, a_node_that_goes_offline_forgets_them);
    tcase_add_loop_test(tcase, block_transfers_are_an_option, 0, 2);
    tcase_add_test(tcase, servers_of_a_file);
    return suite_run("scan_servers", tcase);
}

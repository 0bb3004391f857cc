/*
 * What the functions for networks and nodes refuse, and handles that are none, in all functions.
 */
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <stdlib.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))
#define FOREIGN      ((uintptr_t)0x4711) /* a handle that nobody has given out */

static struct scan_plant *plant;

static void set_up(void)
{
    plant = scan_plant_new(0);
}

static void tear_down(void)
{
    scan_plant_free(plant);
}

/* --- handles --- */

static int on_time(int net, int node, int index, int sub, void *data, uint64_t time)
{
    scan_note("time %d", time != 0);
    return scan_on_data(net, node, index, sub, data);
}

static DictionaryData number = { .uint8 = { .val = 1, .defval = 1 } };

static int get_node_info(HNODE node)
{
    int state, error;

    return canOpenGetNodeInfo(node, &state, &error);
}

static int wait_for_node_state(HNODE node)
{
    return canOpenWaitForNodeState(node, WFNS_INIT);
}

static int extend_dictionary(HNODE node)
{
    return canOpenExtendDictionary(node, 0x3000, 0, OBJ_VAR, MAP_UINT8);
}

static int init_dictionary(HNODE node)
{
    return canOpenInitDictionary(node, 0x2000, 0, NULL, READ_ACCESS, &number, scan_on_data);
}

static int init_dictionary_ts(HNODE node)
{
    return canOpenInitDictionaryTs(node, 0x2000, 0, NULL, READ_ACCESS, &number, on_time);
}

static int init_dictionary_TS(HNODE node)
{
    return canOpenInitDictionaryTS(node, 0x2000, 0, NULL, READ_ACCESS, &number, on_time);
}

static int read_dictionary(HNODE node)
{
    uint8_t value;

    return canOpenReadDictionary(node, 0x2000, 0, &value);
}

static int write_dictionary(HNODE node)
{
    uint8_t value = 1;

    return canOpenWriteDictionary(node, 0x2000, 0, &value);
}

static int get_dictionary_handle(HNODE node)
{
    HDICT entry;

    return canOpenGetDictionaryHnd(node, 0x2000, 0, &entry);
}

static int define_pdo(HNODE node)
{
    HPDO pdo;

    return canOpenDefinePDO(node, NULL, DEFAULT_PDO1, RECEIVE_PDO | 255, 0, 0, 0, 0, NULL, &pdo);
}

static int set_parameter(HNODE node)
{
    return canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, NULL);
}

static int set_domain_file(HNODE node)
{
    return canOpenSetDomainFile(node, 0x2000, 0, "file", 100);
}

static int get_parameter(HNODE node)
{
    uint64_t value;

    return canOpenGetParameter(node, PARA_GET_TIMESTAMP, &value);
}

static int read_entry(HDICT entry)
{
    uint8_t value;

    return canOpenReadDictionaryHnd(entry, &value);
}

static int write_entry(HDICT entry)
{
    uint8_t value = 1;

    return canOpenWriteDictionaryHnd(entry, &value);
}

static int write_pdo(HPDO pdo)
{
    return canOpenWritePDO(pdo, NULL);
}

static int read_pdo(HPDO pdo)
{
    return canOpenReadPDO(pdo, NULL);
}

static int request_pdo(HPDO pdo)
{
    return canOpenRequestPDO(pdo, NULL);
}

/* The node's own come last: the first of them ends its handle. */
static int (*const of_node[])(HNODE) = {
    get_node_info,      wait_for_node_state, extend_dictionary, init_dictionary,
    init_dictionary_ts, init_dictionary_TS,  read_dictionary,   write_dictionary,
    define_pdo,         set_parameter,       get_parameter,     get_dictionary_handle,
    set_domain_file,    canOpenResetNode,    canOpenDeleteNode, canOpenActivateNode,
};
static int (*const of_entry[])(HDICT) = { read_entry, write_entry };
static int (*const of_pdo[])(HPDO) = { write_pdo, read_pdo, request_pdo };

struct handles {
    HNODE node;
    HDICT entry;
    HPDO pdo;
};

static struct handles make_handles(void)
{
    struct handles made = { .node = scan_node(plant, 5, NULL) };

    scan_number(made.node, 0x2000, TYP_UINT8, READ_ACCESS | MAPPABLE, 1, NULL);
    ck_assert_int_eq(canOpenGetDictionaryHnd(made.node, 0x2000, 0, &made.entry), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDefinePDO(made.node, NULL, DEFAULT_PDO1, TRANSMIT_PDO | 255, 0, 0, 0, 0,
                                      NULL, &made.pdo),
                     SCANOPEN_OK);
    return made;
}

static void expect_refused(HNODE node, HDICT entry, HPDO pdo)
{
    for (unsigned i = 0; i < COUNT(of_node); i++)
        ck_assert_msg(of_node[i](node) == SCANOPEN_INVALID_HANDLE, "node function %u", i);
    for (unsigned i = 0; i < COUNT(of_entry); i++)
        ck_assert_msg(of_entry[i](entry) == SCANOPEN_INVALID_HANDLE, "entry function %u", i);
    for (unsigned i = 0; i < COUNT(of_pdo); i++)
        ck_assert_msg(of_pdo[i](pdo) == SCANOPEN_INVALID_HANDLE, "PDO function %u", i);
}

START_TEST(handles_that_are_none)
{
    expect_refused(NULL, NULL, NULL);
    expect_refused((HNODE)FOREIGN, (HDICT)FOREIGN, (HPDO)FOREIGN);
    expect_refused((HNODE)UINTPTR_MAX, (HDICT)UINTPTR_MAX, (HPDO)UINTPTR_MAX);
    make_handles();
    expect_refused((HNODE)FOREIGN, (HDICT)FOREIGN, (HPDO)FOREIGN);
    expect_refused((HNODE)UINTPTR_MAX, (HDICT)UINTPTR_MAX, (HPDO)UINTPTR_MAX);
}
END_TEST

START_TEST(handles_of_another_kind)
{
    struct handles made = make_handles();

    expect_refused((HNODE)(uintptr_t)made.pdo, (HDICT)(uintptr_t)made.node,
                   (HPDO)(uintptr_t)made.entry);
    expect_refused((HNODE)(uintptr_t)made.entry, (HDICT)(uintptr_t)made.pdo,
                   (HPDO)(uintptr_t)made.node);
    ck_assert_int_eq(scan_state(made.node), NodeOffline);
}
END_TEST

/* Also behind a successor in the same place. */
START_TEST(handles_of_a_deleted_node)
{
    struct handles made = make_handles(), next;

    ck_assert_int_eq(canOpenDeleteNode(made.node), SCANOPEN_OK);
    expect_refused(made.node, made.entry, made.pdo);
    for (unsigned i = 0; i < 100; i++) {
        next = make_handles();
        ck_assert_ptr_ne(next.node, made.node);
        ck_assert_ptr_ne(next.entry, made.entry);
        ck_assert_ptr_ne(next.pdo, made.pdo);
        expect_refused(made.node, made.entry, made.pdo);
        ck_assert_int_eq(scan_state(next.node), NodeOffline);
        ck_assert_int_eq(canOpenDeleteNode(next.node), SCANOPEN_OK);
    }
}
END_TEST

static void *wait_operational(void *node)
{
    return (void *)(intptr_t)canOpenWaitForNodeState(node, WFNS_OPERATIONAL);
}

START_TEST(a_node_deleted_while_its_state_is_waited_for)
{
    HNODE node = scan_node(plant, 5, NULL);
    pthread_t thread;
    void *result;

    ck_assert_int_eq(pthread_create(&thread, NULL, wait_operational, node), 0);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    ck_assert_int_eq(pthread_join(thread, &result), 0);
    ck_assert_int_eq((intptr_t)result, SCANOPEN_INVALID_HANDLE);
}
END_TEST

/* --- networks --- */

static int open_network(int net, const char *name, unsigned short bitrate, bool old)
{
    SLAVE_NET_INFO info = { .pNetName = name, .usBaudrate = bitrate };

    return old ? canOpenCreateNetwork(net, name, bitrate) : canOpenCreateNetworkEx(net, &info);
}

static const int no_networks[] = { -1, 256, INT32_MAX, INT32_MIN, 0 /* exists */ };

START_TEST(networks_that_cannot_be_created)
{
    for (unsigned i = 0; i < COUNT(no_networks); i++)
        for (int old = 0; old < 2; old++)
            ck_assert_int_eq(open_network(no_networks[i], NULL, SCAN_BITRATE, old),
                             SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenCreateNetworkEx(1, NULL), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

static const unsigned short no_bitrates[] = { 0, 1, 9, 11, 499, 501, 999, 1001, 65534 };

START_TEST(bit_rates_that_are_none)
{
    struct scan_plant *other = scan_plant_bare(1);

    for (unsigned i = 0; i < COUNT(no_bitrates); i++)
        for (int old = 0; old < 2; old++)
            ck_assert_int_eq(open_network(1, "other", no_bitrates[i], old),
                             SCANOPEN_WRONG_BAUDRATE);
    ck_assert_int_eq(open_network(1, "other", SCAN_BITRATE, true), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_OK);
    scan_plant_free(other);
}
END_TEST

/* One that knows its bit rate. */
START_TEST(the_bus_has_another_bit_rate)
{
    struct scan_plant *slow = scan_plant_slow(1, 125);

    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_OK);
    for (int old = 0; old < 2; old++)
        ck_assert_int_eq(open_network(1, NULL, 250, old), SCANOPEN_WRONG_BAUDRATE);
    scan_plant_free(slow);
}
END_TEST

START_TEST(there_is_no_such_interface)
{
    ck_assert_int_eq(setenv("MCANOPEN_NET_1", "no-such-can", 1), 0);
    for (int old = 0; old < 2; old++)
        ck_assert_int_eq(open_network(1, NULL, SCAN_BITRATE, old), SCANOPEN_INIT_ERRORS);
    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

static const struct net_row {
    unsigned long options;
    short prio;
} net_rows[] = {
    { 0x08, 0 },
    { 0x80000000UL, 0 },
    { THREAD_PRIOS_OVERWRITE, -1 },
    { THREAD_PRIOS_OVERWRITE, 32 },
    { THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE, -1 },
    { THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE, 100 },
};

/* Each of the four priorities. */
START_TEST(network_options_that_are_none)
{
    const struct net_row *row = &net_rows[_i];
    struct scan_plant *other = scan_plant_bare(1);

    for (unsigned i = 0; i < 4; i++) {
        SLAVE_NET_INFO info = { .ulOptions = row->options, .usBaudrate = SCAN_BITRATE };

        info.sPrioNMT = i == 0 ? row->prio : 1;
        info.sPrioSDO = i == 1 ? row->prio : 1;
        info.sPrioPDO = i == 2 ? row->prio : 1;
        info.sPrioEMCY = i == 3 ? row->prio : 1;
        ck_assert_int_eq(canOpenCreateNetworkEx(1, &info), SCANOPEN_WRONG_PARAMETER);
    }
    scan_plant_free(other);
}
END_TEST

START_TEST(networks_that_cannot_be_removed)
{
    HNODE node = scan_node(plant, 5, NULL);

    ck_assert_int_eq(canOpenRemoveNetwork(-1), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenRemoveNetwork(256), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenRemoveNetwork(1), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_SERVICE_NOT_ALLOWED);
    scan_activate(plant, node); /* and it lives on */
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_SERVICE_NOT_ALLOWED);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* --- nodes --- */

static int create_old(int net, int id, HNODE *node)
{
    return canOpenCreateNode(net, "old", id, 0x191, 0, 0, NULL, NULL, NULL, 0, 0, 0, 0, NULL, node);
}

static int create(int net, int id, HNODE *node)
{
    const SLAVE_NODE_INFO info = scan_info();

    return canOpenCreateNodeEx(net, id, NULL, &info, node);
}

static int (*const creates[])(int net, int id, HNODE *node) = { create, create_old };

START_TEST(nodes_that_cannot_be_created)
{
    int (*make)(int net, int id, HNODE *node) = creates[_i];
    HNODE node = NULL;

    ck_assert_int_eq(make(0, 0, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(0, -1, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(0, 128, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(0, 256 + 5, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(-1, 5, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(1, 5, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(256, 5, &node), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(make(0, 5, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenCreateNodeEx(0, 5, NULL, NULL, &node), SCANOPEN_WRONG_PARAMETER);
    scan_node(plant, 5, NULL);
    ck_assert_int_eq(make(0, 5, &node), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* Once a network of the process is full, others are, too. */
START_TEST(too_many_nodes)
{
    int (*make)(int net, int id, HNODE *node) = creates[_i];
    struct scan_plant *others[2] = { scan_plant_new(1), scan_plant_new(2) };
    HNODE node = NULL;

    for (int id = 1; id <= 127; id++) {
        scan_node(plant, id, NULL);
        scan_node(others[0], id, NULL);
    }
    node = scan_node(others[1], 9, NULL);
    ck_assert_int_eq(make(2, 10, &node), SCANOPEN_TOO_MANY_OBJECTS);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    scan_node(others[1], 10, NULL);
    scan_plant_free(others[1]);
    scan_plant_free(others[0]);
}
END_TEST

START_TEST(not_in_this_state)
{
    HNODE node = scan_node(plant, 5, NULL);

    scan_activate(plant, node);
    for (int state = 0; state < 3; state++) {
        ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(extend_dictionary(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(init_dictionary(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(init_dictionary_ts(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(init_dictionary_TS(node), SCANOPEN_WRONG_NODESTATE);
        ck_assert_int_eq(define_pdo(node), SCANOPEN_WRONG_NODESTATE);
        if (state == 0)
            scan_operational(plant, node);
        else
            scan_stop(plant, node);
    }
}
END_TEST

START_TEST(arguments_about_the_state)
{
    HNODE node = scan_node(plant, 5, NULL);
    int state = -7, error = -7;

    ck_assert_int_eq(canOpenGetNodeInfo(node, NULL, &error), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetNodeInfo(node, &state, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(state, -7);
    ck_assert_int_eq(error, -7);
    ck_assert_int_eq(canOpenWaitForNodeState(node, 0), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenWaitForNodeState(node, 0x10), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenWaitForNodeState(node, 0xFFFF), SCANOPEN_WRONG_PARAMETER);
}
END_TEST

/* --- versions and parameters --- */

START_TEST(arguments_about_parameters)
{
    HNODE node = scan_node(plant, 5, NULL);
    uint64_t value = 7;

    ck_assert_int_eq(canOpenSetParameter(node, 0, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetParameter(node, PARA_GET_TIMESTAMP, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, &value),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenSetParameter(node, PARAM_ENABLE_AUTO_TRANSMISSION, &value),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetParameter(node, 0, &value), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetParameter(node, PARAM_DISABLE_AUTO_TRANSMISSION, &value),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetParameter(node, PARA_GET_TIMESTAMP, NULL), SCANOPEN_WRONG_PARAMETER);
    ck_assert_int_eq(canOpenGetParameter(node, PARA_GET_TIMESTAMP_FREQUENCY, NULL),
                     SCANOPEN_WRONG_PARAMETER);
    ck_assert_uint_eq(value, 7);
}
END_TEST

START_TEST(versions_are_those_of_the_library)
{
    CANOPEN_VERSIONS versions = { 0 };

    canOpenGetVersions(NULL);
    canOpenGetVersions(&versions);
    ck_assert_uint_eq(versions.cos, MCANOPEN_VERSION_MAJOR << 12 | MCANOPEN_VERSION_MINOR << 8 |
                                        MCANOPEN_VERSION_PATCH);
    ck_assert_uint_eq(versions.sdm, versions.cos);
    ck_assert_uint_eq(versions.pdm, versions.cos);
    ck_assert_uint_eq(versions.nmt, versions.cos);
    ck_assert_uint_eq(versions.dbt, versions.cos);
    ck_assert_uint_eq(versions.cms, versions.cos);
    ck_assert_uint_eq(versions.sys, versions.cos);
    ck_assert_uint_eq(versions.can, versions.cos);
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("errors");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_test(tcase, handles_that_are_none);
    tcase_add_test(tcase, handles_of_another_kind);
    tcase_add_test(tcase, handles_of_a_deleted_node);
    tcase_add_test(tcase, a_node_deleted_while_its_state_is_waited_for);
    tcase_add_test(tcase, networks_that_cannot_be_created);
    tcase_add_test(tcase, bit_rates_that_are_none);
    tcase_add_test(tcase, the_bus_has_another_bit_rate);
    tcase_add_test(tcase, there_is_no_such_interface);
    tcase_add_loop_test(tcase, network_options_that_are_none, 0, COUNT(net_rows));
    tcase_add_test(tcase, networks_that_cannot_be_removed);
    tcase_add_loop_test(tcase, nodes_that_cannot_be_created, 0, COUNT(creates));
    tcase_add_loop_test(tcase, too_many_nodes, 0, COUNT(creates));
    tcase_add_test(tcase, not_in_this_state);
    tcase_add_test(tcase, arguments_about_the_state);
    tcase_add_test(tcase, arguments_about_parameters);
    tcase_add_test(tcase, versions_are_those_of_the_library);
    return suite_run("scan_errors", tcase);
}

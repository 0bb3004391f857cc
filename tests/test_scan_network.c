/*
 * Networks of the slave API: created, removed, shared with a manager, with priorities; as many
 * nodes on as many networks as there may be.
 */
#include "mcanopen.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <pthread.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

/* Warnings and errors become notes "log LEVEL". */
static void on_log(void *context, int level, const char *text)
{
    (void)context;
    (void)text;
    if (level <= MCANOPEN_LOG_WARNING)
        scan_note("log %d", level);
}

static void set_up(void)
{
    ck_assert_int_eq(mcanOpenSetLog(on_log, NULL), MCANOPEN_OK);
}

static void tear_down(void)
{
    mcanOpenCleanup();
    mcanOpenSetLog(NULL, NULL);
}

static void expect_alive(struct scan_plant *plant, HNODE node)
{
    uint32_t type = 0;

    scan_activate(plant, node);
    ck_assert_uint_eq(scan_sdo_read(plant, scan_id(plant, node), 0x1000, 0, &type), 0);
    ck_assert_uint_eq(type, 0x00020192);
}

START_TEST(a_network_of_the_older_form)
{
    struct scan_plant *plant = scan_plant_bare(3);

    ck_assert_int_eq(canOpenCreateNetwork(3, "test", SCAN_BITRATE), SCANOPEN_OK);
    expect_alive(plant, scan_node(plant, 5, NULL));
    scan_plant_free(plant);
    ck_assert_int_eq(canOpenRemoveNetwork(3), SCANOPEN_OK);
    ck_assert_int_eq(canOpenCreateNetwork(3, NULL, SCAN_BITRATE), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(3), SCANOPEN_OK);
}
END_TEST

START_TEST(a_network_is_used_again)
{
    struct scan_plant *plant = scan_plant_bare(255);
    const SLAVE_NET_INFO info = { .pNetName = "test",
                                  .usBaudrate = SCAN_BITRATE,
                                  .usDebugMask = 0xFFFF };

    for (unsigned i = 0; i < 5; i++) {
        HNODE node;

        ck_assert_int_eq(canOpenCreateNetworkEx(255, &info), SCANOPEN_OK);
        node = scan_node(plant, 5, NULL);
        expect_alive(plant, node);
        ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
        ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
        ck_assert_int_eq(canOpenRemoveNetwork(255), SCANOPEN_OK);
    }
    scan_plant_free(plant);
}
END_TEST

/* A network that is gone hears nothing. */
START_TEST(a_removed_network_is_silent)
{
    struct scan_plant *plant = scan_plant_new(0);
    HNODE node = scan_node(plant, 5, NULL);

    scan_activate(plant, node);
    ck_assert_int_eq(canOpenResetNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    scan_forget(plant);
    scan_send(plant, "605#4000100000000000");
    ck_assert(!scan_await_within(plant, "585#*", 0));
    scan_plant_free(plant);
}
END_TEST

static const unsigned short bitrates[] = { 10, 20, 50, 100, 125, 250, 500, 800, 1000 };

START_TEST(the_bit_rates_of_canopen)
{
    struct scan_plant *plant = scan_plant_bare(0);
    SLAVE_NET_INFO info = { .usBaudrate = bitrates[_i] };

    ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    ck_assert_int_eq(canOpenCreateNetwork(0, NULL, bitrates[_i]), SCANOPEN_OK);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    scan_plant_free(plant);
}
END_TEST

/* --- priorities --- */

static bool may_set_priorities(void)
{
    const struct sched_param wish = { .sched_priority = 1 }, usual = { .sched_priority = 0 };

    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &wish) != 0)
        return false;
    pthread_setschedparam(pthread_self(), SCHED_OTHER, &usual);
    return true;
}

static const struct prio_row {
    unsigned long options;
    short priority;
} prio_rows[] = {
    { THREAD_PRIOS_OVERWRITE, 0 },
    { THREAD_PRIO_OVERWRITE, 31 },
    { THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE, 0 },
    { THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE, 1 },
    { THREAD_PRIOS_OVERWRITE | THREAD_PRIOS_NATIVE, 99 },
    { 0, 1000 }, /* not looked at */
};

/* Native 0 is the normal scheduler, for which no right is needed. */
static unsigned warnings_of(const struct prio_row *row)
{
    bool wanted = (row->options & THREAD_PRIOS_OVERWRITE) != 0 &&
                  !((row->options & THREAD_PRIOS_NATIVE) != 0 && row->priority == 0);

    return wanted && !may_set_priorities() ? 1 : 0;
}

START_TEST(priorities_of_the_threads)
{
    const struct prio_row *row = &prio_rows[_i];
    struct scan_plant *plant = scan_plant_bare(0);
    const SLAVE_NET_INFO info = { .ulOptions = row->options,
                                  .usBaudrate = SCAN_BITRATE,
                                  .sPrioNMT = row->priority,
                                  .sPrioSDO = row->priority,
                                  .sPrioPDO = row->priority,
                                  .sPrioEMCY = row->priority };
    char warning[16];

    snprintf(warning, sizeof warning, "log %d", MCANOPEN_LOG_WARNING);
    ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    expect_alive(plant, scan_node(plant, 5, NULL));
    scan_plant_free(plant);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    ck_assert_uint_eq(scan_count_notes(warning), warnings_of(row));
}
END_TEST

/* --- in company with a manager --- */

/* Network 0 on the bus that the environment names; the manager is node 127. */
static int configure_manager(unsigned bitrate)
{
    char path[SUITE_PATH_SIZE];
    int file, result;
    char text[600];
    int length = snprintf(text, sizeof text,
                          "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No>"
                          "<Baudrate>%u</Baudrate><Boot_Delay>20</Boot_Delay>"
                          "<Manager_Node_Id>127</Manager_Node_Id>"
                          "<Node_Instance><Node_Id>5</Node_Id></Node_Instance>"
                          "</Manager_Instance></CANopen_Manager>\n",
                          bitrate);

    suite_temporary("scan", path);
    file = mkstemp(path);
    ck_assert_int_ge(file, 0);
    ck_assert_int_eq(write(file, text, (size_t)length), length);
    ck_assert_int_eq(close(file), 0);
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    result = mcanOpenConfig(path);
    ck_assert_int_eq(unlink(path), 0);
    return result;
}

static void wait_for_manager(int state)
{
    EVENT_T event;
    int is = -1;

    while (is != state) {
        ck_assert_int_eq(mcanOpenGetNodeState(0, 5, &is), MCANOPEN_OK);
        if (is != state)
            ck_assert_int_eq(mcanOpenEvent(&event, 1), MCANOPEN_OK);
    }
}

/* Its own slave is booted by the manager of the same process, whoever comes first. */
START_TEST(a_manager_on_the_same_network)
{
    const SLAVE_NET_INFO info = { .usBaudrate = SCAN_BITRATE };
    struct scan_plant *plant = scan_plant_bare(0);
    HNODE node, other;

    if (_i == 1)
        ck_assert_int_eq(configure_manager(SCAN_BITRATE), MCANOPEN_OK);
    ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    if (_i == 0)
        ck_assert_msg(configure_manager(SCAN_BITRATE) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    node = scan_node(plant, 5, NULL);
    ck_assert_int_eq(
        canOpenCreateNodeEx(0, 127, NULL, &(SLAVE_NODE_INFO){ .ulVendorId = 1 }, &other),
        SCANOPEN_WRONG_PARAMETER); /* the manager's own */
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(canOpenWaitForNodeState(node, WFNS_OPERATIONAL), NodeOperational);
    wait_for_manager(NodeOperational);
    mcanOpenShutDown();
    ck_assert_int_eq(scan_state(node), NodeOperational);
    scan_plant_free(plant);
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
}
END_TEST

/* The slaves go, the manager stays. */
START_TEST(the_manager_goes_on)
{
    const SLAVE_NET_INFO info = { .usBaudrate = SCAN_BITRATE };
    struct scan_plant *plant = scan_plant_bare(0);

    ck_assert_int_eq(configure_manager(SCAN_BITRATE), MCANOPEN_OK);
    ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
    mcanOpenStart();
    ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    scan_forget(plant);
    scan_await(plant, "605#4000100000000000"); /* it asks for the slave that is not there */
    scan_await(plant, "605#4000100000000000");
    scan_plant_free(plant);
}
END_TEST

START_TEST(a_manager_with_another_bit_rate)
{
    const SLAVE_NET_INFO info = { .usBaudrate = 250 };
    struct scan_plant *plant = scan_plant_bare(0);

    if (_i == 0) {
        ck_assert_int_eq(configure_manager(SCAN_BITRATE), MCANOPEN_OK);
        ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_WRONG_BAUDRATE);
        ck_assert_int_eq(canOpenCreateNetwork(0, NULL, 250), SCANOPEN_WRONG_BAUDRATE);
    } else {
        ck_assert_int_eq(canOpenCreateNetworkEx(0, &info), SCANOPEN_OK);
        ck_assert_int_eq(configure_manager(SCAN_BITRATE), CANOPEN_DCF_WRONG_BAUDRATE);
        ck_assert_int_eq(canOpenRemoveNetwork(0), SCANOPEN_OK);
    }
    scan_plant_free(plant);
}
END_TEST

/* --- many --- */

#define NETS 16

/* 16 on each network but the last, that makes 255. */
START_TEST(as_many_nodes_as_there_may_be)
{
    struct scan_plant *plants[NETS];
    HNODE nodes[NETS][16];

    for (int net = 0; net < NETS; net++) {
        plants[net] = scan_plant_new(net);
        for (int i = 0; i < (net < NETS - 1 ? 16 : 15); i++)
            nodes[net][i] = scan_node(plants[net], 1 + i, NULL);
    }
    for (int net = 0; net < NETS; net++)
        for (int i = 0; i < (net < NETS - 1 ? 16 : 15); i++)
            expect_alive(plants[net], nodes[net][i]);
    for (int net = 0; net < NETS; net++)
        scan_plant_free(plants[net]);
}
END_TEST

static void add_tests(TCase *tcase)
{
    tcase_add_test(tcase, a_network_of_the_older_form);
    tcase_add_test(tcase, a_network_is_used_again);
    tcase_add_test(tcase, a_removed_network_is_silent);
    tcase_add_loop_test(tcase, the_bit_rates_of_canopen, 0, COUNT(bitrates));
    tcase_add_loop_test(tcase, priorities_of_the_threads, 0, COUNT(prio_rows));
    tcase_add_loop_test(tcase, a_manager_on_the_same_network, 0, 2);
    tcase_add_test(tcase, the_manager_goes_on);
    tcase_add_loop_test(tcase, a_manager_with_another_bit_rate, 0, 2);
    tcase_add_test(tcase, as_many_nodes_as_there_may_be);
}

int main(void)
{
    TCase *tcase = tcase_create("network");

    tcase_set_timeout(tcase, SCAN_LIMIT);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    add_tests(tcase);
    return suite_run("scan_network", tcase);
}

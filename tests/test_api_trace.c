/*
 * Debug_Mask and usDebugMask: lines of the log for frames, in builds with MCANOPEN_TRACE; in others
 * none.
 */
#include "support/api_plant.h"
#include "support/scan_plant.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

static struct api_plant *plant;

/* Node 5 is a device elsewhere, node 6 one of this process. */
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

static HNODE start_slave(unsigned short mask)
{
    const SLAVE_NET_INFO network = { .usBaudrate = 500, .usDebugMask = mask };
    const SLAVE_NODE_INFO info = scan_info();
    HNODE node = NULL;

    ck_assert_int_eq(canOpenCreateNetworkEx(0, &network), SCANOPEN_OK);
    ck_assert_int_eq(canOpenCreateNodeEx(0, 6, scan_on_event, &info, &node), SCANOPEN_OK);
    ck_assert_int_eq(canOpenActivateNode(node), SCANOPEN_OK);
    return node;
}

static const struct row {
    const char *mask;
    const char *line;
    const char *others[2];
} rows[] = {
    { "0x1", "2 trace: received 705#00\n", { "sends", "sends" } },
    { "0x2", "2 trace: node 127 sends 000#0105\n", { "received", "node 6 sends" } },
    { "0x10000", "2 trace: received 705#00\n", { "sends", "sends" } },
    { "0x20000", "2 trace: node 6 sends 706#00\n", { "received", "node 127 sends" } },
    { "0", NULL, { "trace", "trace" } },
};

START_TEST(frames_of_the_manager)
{
    const struct row *row = &rows[_i];
    char text[300];
    HNODE node;

    snprintf(text, sizeof text, "<Debug_Mask>%s</Debug_Mask>" API_NODE(5), row->mask);
    api_start(plant, text);
    node = start_slave(0);
    api_wait_event(API_NETWORK_UP, -1);
    api_wait_log(plant, "network is up");
    if (row->line && MCANOPEN_TRACE)
        api_wait_log(plant, row->line);
    for (int i = 0; i < ROWS(row->others); i++)
        ck_assert_uint_eq(api_log_count(plant, row->others[i]), 0);
    ck_assert(MCANOPEN_TRACE || api_log_count(plant, "trace") == 0);
    canOpenResetNode(node);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
}
END_TEST

START_TEST(frames_of_a_network_of_slaves)
{
    HNODE node = start_slave(_i == 0 ? 1 : 2);

    api_start(plant, API_NODE(5));
    api_wait_event(API_NETWORK_UP, -1);
    api_wait_log(plant, "network is up");
    if (MCANOPEN_TRACE)
        api_wait_log(plant, _i == 0 ? "2 trace: received 705#00" : "2 trace: node 6 sends 706#00");
    ck_assert_uint_eq(api_log_count(plant, _i == 0 ? "sends" : "received"), 0);
    canOpenResetNode(node);
    ck_assert_int_eq(canOpenDeleteNode(node), SCANOPEN_OK);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("trace");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, frames_of_the_manager, 0, ROWS(rows));
    tcase_add_loop_test(tests, frames_of_a_network_of_slaves, 0, 2);
    return suite_run("api_trace", tests);
}

/* Several networks in one file and process: each has its own nodes, events, bus and fate. */
#include "port/bus_segment.h"
#include "port/clock.h"
#include "support/api_plant.h"
#include "support/api_wire.h"
#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define NETS      3u
#define TEXT_SIZE 16000u

static const int numbers[NETS] = { 0, 3, 255 };
static struct api_plant *plants[NETS]; /* the hook is that of the last one */
static struct api_wire *wires[NETS];

/* In each of them a node 5, whose 2001h is the number of the network. */
static void set_up(void)
{
    for (unsigned i = 0; i < NETS; i++) {
        plants[i] = api_plant_new();
        wires[i] = api_wire_open(plants[i]->bus);
        api_add_device(plants[i], 5);
        api_add_number(plants[i], 5, 0x2001, 1, (uint32_t)numbers[i]);
        api_devices_start(plants[i]);
    }
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
}

static void tear_down(void)
{
    for (unsigned i = 0; i < NETS; i++) {
        api_plant_free(plants[i]);
        api_wire_close(wires[i]);
    }
}

static int configure(const char *const inner[NETS])
{
    char text[TEXT_SIZE] = "<CANopen_Manager>";

    for (unsigned i = 0; i < NETS; i++)
        strncat(text, api_network(plants[i], numbers[i], inner[i]), sizeof text - strlen(text) - 1);
    strncat(text, "</CANopen_Manager>", sizeof text - strlen(text) - 1);
    return api_config_text(plants[0], text);
}

static void wait_for(unsigned long kind, int net, int node)
{
    EVENT_T event;

    do
        event = api_wait_event(kind, node);
    while (event.net != net);
}

/* Events of one network may come before those of another: each is waited for on its way. */
static void wait_until_up(void)
{
    bool up[NETS] = { false };

    for (unsigned left = NETS; left > 0;) {
        const EVENT_T event = api_wait_event(API_NETWORK_UP, -1);

        for (unsigned i = 0; i < NETS; i++) {
            left -= event.net == numbers[i] && !up[i];
            up[i] |= event.net == numbers[i];
        }
    }
}

static void boot(void)
{
    const char *const inner[NETS] = { API_NODE(5), API_NODE(5) API_NODE(6), API_NODE(5) };

    ck_assert_msg(configure(inner) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart();
    wait_until_up();
}

static int read_2001(int net, int *value)
{
    unsigned char buffer[4];
    int len = sizeof buffer;
    const int result = mcanOpenReadSDO((unsigned short)net, 5, 0x2001, 0, buffer, &len, NULL);

    *value = result == MCANOPEN_OK ? buffer[0] : -1;
    return result;
}

static struct {
    struct co_lock lock;
    struct co_condition changed;
    unsigned right, count;
} ends;

static void note_end(void *context, const SDO_RESULT_T *result)
{
    (void)context;
    lock_take(&ends.lock);
    ends.count++;
    ends.right += result->result == MCANOPEN_OK &&
                  *(const unsigned char *)result->data == result->net;
    condition_signal(&ends.changed);
    lock_give(&ends.lock);
}

static void wait_for_ends(unsigned count)
{
    const co_us_t limit = clock_now() + API_PATIENCE;
    enum co_err err = CO_OK;

    lock_take(&ends.lock);
    while (ends.count < count && err != CO_ERR_TIMEOUT)
        err = condition_wait(&ends.changed, &ends.lock, limit);
    lock_give(&ends.lock);
}

START_TEST(each_has_its_own_nodes_and_data)
{
    BOOT_RECORD_T record = { .size = sizeof record };
    int value, state;

    boot();
    ck_assert_int_eq(lock_init(&ends.lock), CO_OK);
    ck_assert_int_eq(condition_init(&ends.changed), CO_OK);
    ends.count = ends.right = 0;
    for (unsigned i = 0; i < NETS; i++) {
        const SDO_REQUEST_T request = { .size = sizeof request,
                                        .net = numbers[i],
                                        .node = 5,
                                        .index = 0x2001,
                                        .len = 1,
                                        .done = note_end };

        ck_assert_int_eq(read_2001(numbers[i], &value), MCANOPEN_OK);
        ck_assert_int_eq(value, numbers[i]);
        for (unsigned j = 0; j < 20; j++)
            ck_assert_int_eq(mcanOpenReadSDOAsync(&request, NULL), MCANOPEN_OK);
        ck_assert_int_eq(mcanOpenGetBootRecord(numbers[i], 6, &record),
                         i == 1 ? MCANOPEN_OK : MCAL_NODE_NOT_EXISTEND);
    }
    wait_for_ends(20 * NETS); /* a stopped node does not answer */
    ck_assert_int_eq(mcanOpenStopNode(3, 5), MCANOPEN_OK);
    api_wire_wait(wires[1], "000#0205", 1);
    ck_assert_int_eq(mcanOpenGetNodeState(3, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_STOPPED);
    ck_assert_int_eq(mcanOpenGetNodeState(255, 5, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_uint_eq(api_wire_count(wires[0], "000#0205"), 0);
    ck_assert_int_eq(mcanOpenStopNode(7, 5), MCAL_NO_NET);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_uint_eq(ends.count, 20 * NETS);
    ck_assert_uint_eq(ends.right, 20 * NETS);
    condition_done(&ends.changed);
    lock_done(&ends.lock);
}
END_TEST

START_TEST(events_tell_their_network)
{
    EVENT_T event;

    boot();
    for (unsigned i = 0; i < NETS; i++) {
        api_wire_say(wires[i], "085#1081110000000000");
        event = api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_EMERGENCY), 5);
        ck_assert_int_eq(event.net, numbers[i]);
    }
}
END_TEST

/* --- one bus is lost --- */

START_TEST(a_lost_bus_is_that_of_one_network)
{
    const struct bus_message message = { NULL, 0 };
    const unsigned resets = 1; /* at the start */
    struct segment segment;
    int value;

    boot();
    ck_assert_int_eq(segment_open(&segment, plants[1]->bus + strlen("virtual:"), 0, &message),
                     CO_OK);
    while (segment_lock(&segment, SEGMENT_HOLD_LIMIT) != CO_OK)
        continue;
    ck_assert_int_eq(read_2001(3, &value), MCAL_CAN_TX_ERROR);
    wait_for(API_EVENT(PARA_I, MCANOPEN_MSG_BUS_STATE), 3, -1);
    ck_assert_int_eq(mcanOpenStopNode(3, 5), MCAL_CAN_TX_ERROR);
    for (unsigned i = 0; i < NETS; i += 2) { /* the others go on */
        ck_assert_int_eq(read_2001(numbers[i], &value), MCANOPEN_OK);
        ck_assert_int_eq(value, numbers[i]);
    }
    segment_unlock(&segment);
    segment_close(&segment);
    wait_for(API_NETWORK_UP, 3, -1);
    ck_assert_int_eq(read_2001(3, &value), MCANOPEN_OK);
    ck_assert_uint_eq(api_wire_count(wires[0], "000#82"), resets);
    ck_assert_uint_eq(api_wire_count(wires[2], "000#82"), resets);
    api_wire_wait(wires[1], "000#82", resets + 1);
}
END_TEST

/* --- one network does not come up --- */

START_TEST(a_halted_network_is_that_of_one)
{
    const char *const inner[NETS] = { API_NODE(5),
                                      API_NODE_WITH(
                                          5, "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>"
                                             "<Vendor_Identification>1</Vendor_Identification>"),
                                      "<Wait_For_Startup>TRUE</Wait_For_Startup>" API_NODE(5) };
    int state;

    ck_assert_msg(configure(inner) == MCANOPEN_OK, "%s", mcanOpenGetErrorText());
    mcanOpenStart(); /* waits for the third alone */
    wait_for(API_EVENT(PARA_UC, MCANOPEN_MSG_NETWORK_HALTED), 3, 5);
    api_wait_state(0, 5, MCANOPEN_STATE_OPERATIONAL);
    api_wait_state(255, 5, MCANOPEN_STATE_OPERATIONAL);
    ck_assert_int_eq(mcanOpenGetNodeState(3, 127, &state), MCANOPEN_OK);
    ck_assert_int_eq(state, MCANOPEN_STATE_PREOPERATIONAL);
    ck_assert_uint_eq(api_wire_count(wires[1], "000#01"), 0);
}
END_TEST

/* --- files --- */

static const struct {
    int first, second;
    bool one_bus;
    const char *error; /* NULL: none */
    const char *more;  /* of the second */
} files[] = {
    { 0, 0, false, "Net_No", "" },
    { 0, 1, true, "is that of network 0: a bus has one NMT master", "" },
    { 0, 1, true, NULL, "<NMT_Master>FALSE</NMT_Master><Manager_Node_Id>126</Manager_Node_Id>" },
};

START_TEST(two_networks_in_a_file)
{
    char text[TEXT_SIZE] = "<CANopen_Manager>", inner[500];
    int result;

    snprintf(inner, sizeof inner, "%s" API_NODE(5), files[_i].more);
    strncat(text, api_network(plants[0], files[_i].first, API_NODE(5)), 7000);
    strncat(text, api_network(plants[files[_i].one_bus ? 0 : 1], files[_i].second, inner), 7000);
    strncat(text, "</CANopen_Manager>", 100);
    result = api_config_text(plants[0], text);
    ck_assert_int_eq(result, files[_i].error ? MCAL_PARA_ERROR : MCANOPEN_OK);
    if (files[_i].error)
        ck_assert_msg(strstr(mcanOpenGetErrorText(), files[_i].error), "%s",
                      mcanOpenGetErrorText());
}
END_TEST

/* --- shut down --- */

struct reader {
    struct co_thread thread;
    int net, result;
};

static void *read_absent(void *context)
{
    struct reader *self = context;
    char buffer[4];
    int len = sizeof buffer;

    self->result = mcanOpenReadSDO((unsigned short)self->net, 9, 0x2000, 0, buffer, &len, NULL);
    return NULL;
}

START_TEST(shut_down_ends_calls_in_all)
{
    const char *const silent = API_NODE_WITH(9, "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
                                                "<SDO_Timeout>60000</SDO_Timeout>");
    const char *const inner[NETS] = { silent, silent, silent };
    struct reader readers[NETS] = { { .net = 0 } };

    ck_assert_int_eq(configure(inner), MCANOPEN_OK);
    mcanOpenStart();
    wait_until_up();
    for (unsigned i = 0; i < NETS; i++) {
        readers[i].net = numbers[i];
        ck_assert_int_eq(thread_start(&readers[i].thread, "reader", read_absent, &readers[i]),
                         CO_OK);
        api_wire_wait(wires[i], "609#40", 1);
    }
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    for (unsigned i = 0; i < NETS; i++) {
        thread_join(&readers[i].thread);
        ck_assert_int_eq(readers[i].result, MCAL_NO_NET);
    }
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("networks");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, each_has_its_own_nodes_and_data);
    tcase_add_test(tests, events_tell_their_network);
    tcase_add_test(tests, a_lost_bus_is_that_of_one_network);
    tcase_add_test(tests, a_halted_network_is_that_of_one);
    tcase_add_loop_test(tests, two_networks_in_a_file, 0, ROWS(files));
    tcase_add_test(tests, shut_down_ends_calls_in_all);
    return suite_run("api_networks", tests);
}

/*
 * What the manager makes of its bus, at the API: a network on a CAN interface whose kernel is
 * played (support/played_kernel.h); tests/CMakeLists.txt leads bus_socketcan_open() here.
 */
#include "api/registry.h"
#include "support/api_plant.h"
#include "support/played_kernel.h"
#include "support/suite.h"

#include <errno.h>
#include <linux/can/error.h>
#include <stdlib.h>

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

enum co_err __wrap_bus_socketcan_open(const char *name, const struct bus_options *options,
                                      struct bus **ret_bus, const struct bus_message *message);

enum co_err __wrap_bus_socketcan_open(const char *name, const struct bus_options *options,
                                      struct bus **ret_bus, const struct bus_message *message)
{
    return bus_socketcan_open_with(&played_calls, name, options, ret_bus, message);
}

static struct api_plant *plant;

/* Node 5 is nobody's slave, and so may be commanded at any time. */
static void set_up(void)
{
    played_reset();
    ck_assert_int_eq(setenv("MCANOPEN_NET_0", "can0", 1), 0);
    plant = api_plant_new();
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
    ck_assert_int_eq(api_config_text(plant,
                                     "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No>"
                                     "<Baudrate>250</Baudrate>" API_NODE_WITH(
                                         5, "<NMT_Slave>FALSE</NMT_Slave>") "</Manager_Instance>"
                                                                            "</CANopen_Manager>"),
                     MCANOPEN_OK);
    mcanOpenStart();
    api_wait_event(API_NETWORK_UP, -1);
}

static void tear_down(void)
{
    api_plant_free(plant);
}

/* Frames are not taken any more: they wait in the queue. */
static void stop_sending(void)
{
    struct managed *managed;
    co_us_t now;

    ck_assert_int_eq(registry_enter(0, false, &managed), MCANOPEN_OK);
    network_enter(managed->network, &now);
    kernel.send_error = ENOBUFS;
    network_leave(managed->network, managed->config->manager_node_id);
    registry_leave();
}

static void expect_state(int state)
{
    EVENT_T event = api_wait_event(API_EVENT(PARA_I, MCANOPEN_MSG_BUS_STATE), -1);

    ck_assert_int_eq(event.node, -1);
    ck_assert_int_eq(event.para.i, state);
}

/* --- calls --- */

static int call_read(void)
{
    unsigned char buffer[4];
    int len = sizeof buffer;

    return mcanOpenReadSDO(0, 5, 0x1000, 0, buffer, &len, NULL);
}

static int call_write(void)
{
    return mcanOpenWriteSDO(0, 5, 0x2000, 0, TYP_UINT8, "A", 0, NULL);
}

static int call_start(void)
{
    return mcanOpenStartNode(0, 5);
}

static int call_stop(void)
{
    return mcanOpenStopNode(0, 5);
}

static int call_reset(void)
{
    return mcanOpenResetNode(0, 5);
}

static int call_preop(void)
{
    return mcanOpenEnterPreop(0, 5);
}

typedef int call_fn(void);

static call_fn *const transfers[] = { call_read, call_write };
static call_fn *const commands[] = { call_start, call_stop, call_reset, call_preop };

static void expect_all(int result)
{
    for (int i = 0; i < ROWS(transfers); i++)
        ck_assert_int_eq(transfers[i](), result);
    for (int i = 0; i < ROWS(commands); i++)
        ck_assert_int_eq(commands[i](), result);
}

START_TEST(the_states_of_a_controller)
{
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING);
    expect_state(MCANOPEN_BUS_WARNING);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    expect_state(MCANOPEN_BUS_PASSIVE);
    played_error_frame(CAN_ERR_BUSOFF, 0);
    expect_state(MCANOPEN_BUS_OFF);
    played_error_frame(CAN_ERR_RESTARTED, 0);
    expect_state(MCANOPEN_BUS_ACTIVE);
    played_set_up(false);
    expect_state(MCANOPEN_BUS_DOWN);
}
END_TEST

START_TEST(nothing_is_sent_when_bus_off)
{
    played_error_frame(CAN_ERR_BUSOFF, 0);
    expect_state(MCANOPEN_BUS_OFF);
    expect_all(MCAL_CAN_CONTR_OFF_BUS);
}
END_TEST

START_TEST(nothing_is_sent_when_the_interface_is_down)
{
    played_set_up(false);
    expect_state(MCANOPEN_BUS_DOWN);
    expect_all(MCAL_CAN_TX_ERROR);
}
END_TEST

static void *write_beside(void *context)
{
    int *result = context;

    *result = mcanOpenWriteSDO(0, 6, 0x2000, 0, TYP_UINT8, "A", 0, NULL);
    return NULL;
}

/* Both at the same time, to different nodes: that is 2 s. */
static void expect_unsent(int result)
{
    struct co_thread thread;
    int written = 0;

    stop_sending();
    ck_assert_int_eq(thread_start(&thread, "write", write_beside, &written), CO_OK);
    ck_assert_int_eq(call_read(), result);
    thread_join(&thread);
    ck_assert_int_eq(written, result);
}

START_TEST(requests_that_do_not_get_out)
{
    expect_unsent(MCAL_CAN_TX_TIMEOUT);
}
END_TEST

START_TEST(requests_that_do_not_get_out_when_error_passive)
{
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    expect_state(MCANOPEN_BUS_PASSIVE);
    expect_unsent(MCAL_CAN_CONTR_WARN);
}
END_TEST

START_TEST(commands_fill_the_queue)
{
    stop_sending();
    for (int i = 0; i < ROWS(commands); i++)
        ck_assert_int_eq(commands[i](), MCANOPEN_OK);
    while (call_preop() == MCANOPEN_OK)
        continue;
    for (int i = 0; i < ROWS(commands); i++)
        ck_assert_int_eq(commands[i](), MCAL_CAN_CONTR_BUSY);
}
END_TEST

START_TEST(frames_that_the_interface_has_lost)
{
    struct delivery frame = played_frame(0x705, 0x05);
    EVENT_T event;

    frame.drops = 3;
    played_deliver(&frame);
    event = api_wait_event(API_EVENT(PARA_UL, MCANOPEN_MSG_FRAMES_LOST), -1);
    ck_assert_int_eq(event.node, -1);
    ck_assert_uint_eq(event.para.ul, 3);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("bus");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_test(tests, the_states_of_a_controller);
    tcase_add_test(tests, nothing_is_sent_when_bus_off);
    tcase_add_test(tests, nothing_is_sent_when_the_interface_is_down);
    tcase_add_test(tests, requests_that_do_not_get_out);
    tcase_add_test(tests, requests_that_do_not_get_out_when_error_passive);
    tcase_add_test(tests, commands_fill_the_queue);
    tcase_add_test(tests, frames_that_the_interface_has_lost);
    return suite_run("api_bus", tests);
}

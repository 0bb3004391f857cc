/* runtime/network: when a manager learns that its SDO requests have left. A played SocketCAN. */
#include "manager/event.h"
#include "manager/manager.h"
#include "port/clock.h"
#include "runtime/network.h"
#include "support/config_text.h"
#include "support/played_kernel.h"
#include "support/suite.h"

#include <errno.h>
#include <linux/can/error.h>
#include <stdlib.h>
#include <time.h>

#define MANAGER  127
#define SERVER   6
#define REQUEST  (0x600u + SERVER)
#define TIMEOUT  CO_MS(10)
#define PATIENCE CO_MS(30000)
#define SOME     768u /* what a frame may take of the socket's memory */

static struct network *network;
static struct network_config *config;
static struct manager *manager;
static struct sdo_request request;
static uint8_t buffer[4];

static void set_up(void)
{
    struct network_options options = { .bus = NULL };

    played_reset();
    options.opened = played_open();
    config = config_parse_one(NET("<NMT_Master>FALSE</NMT_Master>\n" ONE));
    manager = calloc(1, sizeof *manager);
    ck_assert_ptr_nonnull(manager);
    ck_assert_int_eq(manager_init(manager, config), CO_OK);
    ck_assert_int_eq(network_open(&options, &network, NULL, 0), CO_OK);
    ck_assert_int_eq(network_add_manager(network, manager), CO_OK);
    ck_assert_int_eq(network_start(network), CO_OK);
}

static void tear_down(void)
{
    network_close(network);
    manager_done(manager);
    free(manager);
    network_config_free(config, 1);
}

static void enter(void)
{
    co_us_t now;

    network_enter(network, &now);
}

static void leave(void)
{
    network_leave(network, MANAGER);
}

static void set_backlog(unsigned backlog)
{
    enter();
    kernel.backlog = backlog;
    leave();
}

static void ask(unsigned backlog)
{
    struct co_outbox *out;
    co_us_t now;

    request = (struct sdo_request){
        .transfer = { .index = 0x2000, .buffer = buffer, .size = 4, .timeout = TIMEOUT }
    };
    out = network_enter(network, &now);
    kernel.backlog = backlog;
    manager_submit(manager, SERVER, &request, now, out);
    leave();
}

/* Until the bus was asked so often. */
static void wait_asked(unsigned times)
{
    const co_us_t limit = clock_now() + PATIENCE;
    unsigned asked;

    enter();
    asked = kernel.backlog_asked;
    while (kernel.backlog_asked < asked + times && clock_now() < limit) {
        struct timespec pause = { .tv_nsec = 1000000 };

        leave();
        nanosleep(&pause, NULL);
        enter();
    }
    ck_assert_uint_ge(kernel.backlog_asked, asked + times);
    leave();
}

static void expect_running(void)
{
    enter();
    ck_assert_int_eq(request.state, REQUEST_RUNNING);
    leave();
}

static void expect_end(unsigned outcome)
{
    const co_us_t limit = clock_now() + PATIENCE;
    enum co_err err = CO_OK;

    enter();
    while (request.state != REQUEST_DONE && err != CO_ERR_TIMEOUT)
        err = network_wait(network, MANAGER, limit);
    ck_assert_int_eq(request.state, REQUEST_DONE);
    ck_assert_uint_eq(request.result.detail, outcome);
    leave();
}

static bool listens_to(canid_t id, canid_t mask)
{
    bool found = false;

    enter();
    for (size_t i = 0; i < kernel.filter_count; i++)
        found |= kernel.filters[i].can_id == id && (kernel.filters[i].can_mask & 0x7FF) == mask;
    leave();
    return found;
}

static void wait_until_requests_come_back(bool come_back)
{
    const struct timespec pause = { .tv_nsec = 1000000 };
    const co_us_t limit = clock_now() + PATIENCE;

    while (listens_to(0x600, 0x780) != come_back && clock_now() < limit)
        nanosleep(&pause, NULL);
    ck_assert(listens_to(0x600, 0x780) == come_back);
}

START_TEST(requests_do_not_come_back)
{
    ck_assert(listens_to(0x580, 0x780));
    ck_assert(listens_to(0x600 + MANAGER, 0x7FF));
    ck_assert(!listens_to(0x600, 0x780));
}
END_TEST

START_TEST(what_has_left_is_waited_for_as_long_as_told)
{
    const co_us_t begin = clock_now();

    ask(0);
    expect_end(SDO_OUTCOME_NO_ANSWER);
    ck_assert_uint_ge(clock_now() - begin, TIMEOUT);
    ck_assert_uint_ge(kernel.backlog_asked, 1);
}
END_TEST

START_TEST(the_time_of_what_waits_has_not_begun)
{
    co_us_t begin;

    ask(SOME);
    wait_asked(4);
    expect_running();
    begin = clock_now();
    set_backlog(0);
    expect_end(SDO_OUTCOME_NO_ANSWER);
    ck_assert_uint_ge(clock_now() - begin, TIMEOUT);
}
END_TEST

START_TEST(what_never_leaves_was_not_sent)
{
    ask(SOME);
    expect_end(SDO_OUTCOME_NOT_SENT);
}
END_TEST

START_TEST(an_answer_says_it_too)
{
    struct delivery answer = played_frame(0x580 + SERVER, 0x43);

    ask(SOME);
    answer.frame = (struct can_frame){ .can_id = 0x580 + SERVER,
                                       .len = 8,
                                       .data = { 0x43, 0x00, 0x20, 0, 1, 2, 3, 4 } };
    played_deliver(&answer);
    expect_end(SDO_OUTCOME_OK);
}
END_TEST

START_TEST(what_waits_in_our_own_queue_has_not_left)
{
    enter();
    kernel.send_error = ENOBUFS;
    leave();
    ask(0);
    wait_asked(4);
    expect_running();
    enter();
    kernel.send_error = 0;
    leave();
    expect_end(SDO_OUTCOME_NO_ANSWER);
}
END_TEST

/* It may have them for ever: so they come back, each to say for itself that it was sent. */
START_TEST(an_error_passive_controller_is_not_believed)
{
    struct delivery back = { .flags = MSG_CONFIRM, .size = CAN_MTU };

    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
    wait_until_requests_come_back(true);
    ask(0);
    wait_asked(4);
    expect_running();
    enter();
    back.frame = kernel.sent;
    leave();
    ck_assert_uint_eq(back.frame.can_id, REQUEST);
    played_deliver(&back);
    expect_end(SDO_OUTCOME_NO_ANSWER);
    played_error_frame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE);
    wait_until_requests_come_back(false);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("when requests have left");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, requests_do_not_come_back);
    tcase_add_test(tests, what_has_left_is_waited_for_as_long_as_told);
    tcase_add_test(tests, the_time_of_what_waits_has_not_begun);
    tcase_add_test(tests, what_never_leaves_was_not_sent);
    tcase_add_test(tests, an_answer_says_it_too);
    tcase_add_test(tests, what_waits_in_our_own_queue_has_not_left);
    tcase_add_test(tests, an_error_passive_controller_is_not_believed);
    return suite_run("network_confirm", tests);
}

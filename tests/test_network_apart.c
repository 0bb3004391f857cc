/* runtime/network: a request that is sent without the network's lock. A played SocketCAN, which
 * keeps the caller in send() for as long as the test likes. */
#include "manager/manager.h"
#include "port/clock.h"
#include "runtime/network.h"
#include "support/config_text.h"
#include "support/played_kernel.h"
#include "support/suite.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <time.h>

#define MANAGER  127
#define SERVER   6
#define REQUEST  (0x600u + SERVER)
#define COMMAND  0x000
#define TIMEOUT  CO_MS(10)
#define PATIENCE CO_MS(30000)
#define WHILE    CO_MS(20)

static struct network *network;
static struct network_config *config;
static struct manager *manager;
static struct sdo_request request;
static uint8_t buffer[4];
static struct co_thread caller;

/* What the first of those who send waits for. */
static struct {
    struct co_lock lock;
    struct co_condition changed;
    unsigned sends;
    bool open;
} gate;

static void go_through(void)
{
    bool is_first;

    lock_take(&gate.lock);
    is_first = ++gate.sends == 1;
    condition_signal(&gate.changed);
    while (is_first && !gate.open)
        condition_wait(&gate.changed, &gate.lock, CO_NEVER);
    lock_give(&gate.lock);
}

static void open_gate(void)
{
    lock_take(&gate.lock);
    gate.open = true;
    condition_signal(&gate.changed);
    lock_give(&gate.lock);
}

static void wait_for_sends(unsigned count)
{
    const co_us_t limit = clock_now() + PATIENCE;
    enum co_err err = CO_OK;

    lock_take(&gate.lock);
    while (gate.sends < count && err != CO_ERR_TIMEOUT)
        err = condition_wait(&gate.changed, &gate.lock, limit);
    ck_assert_uint_ge(gate.sends, count);
    lock_give(&gate.lock);
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

static void pause_for(co_us_t time)
{
    const struct timespec pause = { .tv_nsec = (long)(time * 1000u) };

    nanosleep(&pause, NULL);
}

static void set_up(void)
{
    struct network_options options = { .bus = NULL };

    played_reset();
    options.opened = played_open();
    gate.sends = 0;
    gate.open = false;
    ck_assert_int_eq(lock_init(&gate.lock), CO_OK);
    ck_assert_int_eq(condition_init(&gate.changed), CO_OK);
    config = config_parse_one(NET("<NMT_Master>FALSE</NMT_Master>\n" ONE));
    manager = calloc(1, sizeof *manager);
    ck_assert_ptr_nonnull(manager);
    ck_assert_int_eq(manager_init(manager, config), CO_OK);
    ck_assert_int_eq(network_open(&options, &network, NULL, 0), CO_OK);
    ck_assert_int_eq(network_add_manager(network, manager), CO_OK);
    ck_assert_int_eq(network_start(network), CO_OK);
    enter();
    kernel.sent_count = 0; /* without the boot-up message */
    kernel.on_send = go_through;
    leave();
}

static void tear_down(void)
{
    network_close(network);
    manager_done(manager);
    free(manager);
    network_config_free(config, 1);
}

/* As mcanOpenReadSDO does. */
static void *call(void *context)
{
    struct co_outbox *out;
    co_us_t now;

    (void)context;
    out = network_enter(network, &now);
    request.caller = network_caller(network);
    manager_submit(manager, SERVER, &request, now, out);
    while (request.state != REQUEST_DONE)
        network_wait_as(network, MANAGER, request.caller, CO_NEVER);
    leave();
    return NULL;
}

static void start_call_as(void *(*run)(void *), co_us_t timeout)
{
    request = (struct sdo_request){
        .transfer = { .index = 0x2000, .buffer = buffer, .size = 4, .timeout = timeout }
    };
    ck_assert_int_eq(thread_start(&caller, "caller", run, NULL), CO_OK);
}

static void start_call(co_us_t timeout)
{
    start_call_as(call, timeout);
}

static void expect_end(unsigned outcome)
{
    thread_join(&caller);
    ck_assert_uint_eq(request.result.detail, outcome);
}

static void answer(void)
{
    struct delivery delivery = played_frame(0x580 + SERVER, 0x43);

    delivery.frame = (struct can_frame){ .can_id = 0x580 + SERVER,
                                         .len = 8,
                                         .data = { 0x43, 0x00, 0x20, 0, 1, 2, 3, 4 } };
    played_deliver(&delivery);
}

/* For this the network's lock has to be free. */
static void wait_until_done(void)
{
    const co_us_t limit = clock_now() + PATIENCE;
    bool done = false;

    while (!done && clock_now() < limit) {
        enter();
        done = request.state == REQUEST_DONE;
        leave();
        pause_for(1000);
    }
    ck_assert(done);
}

/* Without the abort that follows where no answer comes. */
static unsigned requests_sent(void)
{
    unsigned count = 0;

    enter();
    for (unsigned i = 0; i < kernel.sent_count; i++)
        count += kernel.log[i].can_id == REQUEST && kernel.log[i].data[0] == 0x40;
    leave();
    return count;
}

START_TEST(the_answer_may_come_while_the_request_is_still_being_sent)
{
    start_call(PATIENCE);
    wait_for_sends(1);
    answer();
    wait_until_done();
    open_gate();
    expect_end(SDO_OUTCOME_OK);
    ck_assert_uint_eq(buffer[3], 4);
}
END_TEST

static _Atomic unsigned interruptions;

static void on_signal(int number)
{
    (void)number;
    atomic_fetch_add(&interruptions, 1);
}

static void *call_with_signals(void *context)
{
    sigset_t none;

    sigemptyset(&none);
    pthread_sigmask(SIG_SETMASK, &none, NULL);
    return call(context);
}

/* Wherever it is: one that waits is woken, and waits on. */
START_TEST(signals_do_not_end_a_call)
{
    const struct sigaction action = { .sa_handler = on_signal };

    ck_assert_int_eq(sigaction(SIGUSR1, &action, NULL), 0);
    open_gate();
    start_call_as(call_with_signals, PATIENCE);
    wait_for_sends(1);
    for (unsigned i = 1; i <= 20; i++) {
        ck_assert_int_eq(pthread_kill(caller.id, SIGUSR1), 0);
        while (atomic_load(&interruptions) < i)
            pause_for(100);
    }
    answer();
    expect_end(SDO_OUTCOME_OK);
}
END_TEST

static _Atomic bool command_is_due;

static void *command(void *context)
{
    struct co_frame frame = co_frame_make(COMMAND, 2);
    co_us_t now;

    (void)context;
    frame.data[0] = 1;
    co_outbox_put_frame(network_enter(network, &now), &frame);
    atomic_store(&command_is_due, true);
    leave();
    return NULL;
}

/* The pause only gives what would be wrong the time to happen. */
START_TEST(what_others_send_comes_behind_it)
{
    struct co_thread commander = { .running = false };

    atomic_store(&command_is_due, false);
    start_call(PATIENCE);
    wait_for_sends(1);
    ck_assert_int_eq(thread_start(&commander, "commander", command, NULL), CO_OK);
    while (!atomic_load(&command_is_due))
        pause_for(1000);
    pause_for(WHILE);
    open_gate();
    thread_join(&commander);
    answer();
    expect_end(SDO_OUTCOME_OK);
    ck_assert_uint_eq(kernel.sent_count, 2);
    ck_assert_uint_eq(kernel.log[0].can_id, REQUEST);
    ck_assert_uint_eq(kernel.log[1].can_id, COMMAND);
}
END_TEST

START_TEST(what_the_bus_does_not_take_is_sent_later)
{
    enter();
    kernel.send_error = ENOBUFS;
    leave();
    open_gate();
    start_call(PATIENCE);
    wait_for_sends(3);
    ck_assert_uint_eq(requests_sent(), 0);
    enter();
    kernel.send_error = 0;
    leave();
    while (requests_sent() == 0)
        pause_for(1000);
    answer();
    expect_end(SDO_OUTCOME_OK);
    ck_assert_uint_eq(requests_sent(), 1);
}
END_TEST

static unsigned times_asked(void)
{
    unsigned asked;

    enter();
    asked = kernel.backlog_asked;
    leave();
    return asked;
}

START_TEST(it_has_not_left_before)
{
    const co_us_t limit = clock_now() + PATIENCE;

    start_call(TIMEOUT);
    wait_for_sends(1);
    while (times_asked() < 3 && clock_now() < limit)
        pause_for(1000);
    enter();
    ck_assert_int_eq(request.state, REQUEST_RUNNING);
    leave();
    open_gate();
    expect_end(SDO_OUTCOME_NO_ANSWER);
}
END_TEST

START_TEST(when_the_bus_is_lost_meanwhile_it_is_not_kept)
{
    start_call(TIMEOUT);
    wait_for_sends(1);
    played_set_up(false);
    wait_until_done();
    kernel.send_error = ENETDOWN;
    open_gate();
    expect_end(SDO_OUTCOME_NOT_SENT);
    enter();
    kernel.send_error = 0;
    leave();
    played_set_up(true);
    do {
        start_call(TIMEOUT);
        thread_join(&caller);
    } while (request.result.detail == SDO_OUTCOME_NOT_SENT);
    ck_assert_uint_eq(requests_sent(), 1);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("requests sent apart");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_add_test(tests, the_answer_may_come_while_the_request_is_still_being_sent);
    tcase_add_test(tests, signals_do_not_end_a_call);
    tcase_add_test(tests, what_others_send_comes_behind_it);
    tcase_add_test(tests, what_the_bus_does_not_take_is_sent_later);
    tcase_add_test(tests, it_has_not_left_before);
    tcase_add_test(tests, when_the_bus_is_lost_meanwhile_it_is_not_kept);
    return suite_run("network_apart", tests);
}

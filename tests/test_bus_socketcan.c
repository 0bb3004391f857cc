/*
 * SocketCAN without a CAN kernel: the system calls are played here, over a socket pair. The real
 * thing is tested in vcan/test_socketcan_vcan.c.
 */
#include "port/bus_socketcan.h"

#include "port/clock.h"

#include <check.h>
#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if_arp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

/* What the played kernel gives with recvmsg(). */
struct delivery {
    int error; /* errno instead of a frame */
    int flags; /* MSG_CONFIRM */
    uint32_t drops;
    struct timespec stamp; /* 0: none */
    size_t size;
    struct can_frame frame;
};

static struct {
    /* errors, as errno; 0: the call works */
    int socket_error, index_error, bind_error, send_error, option_error, failing_option;
    unsigned short hardware;
    short flags;
    int index;
    /* what was asked for */
    struct can_filter filters[600];
    size_t filter_count;
    int raw_options[8], socket_options[80];
    struct can_frame sent;
    unsigned sent_count;
    int pair[2]; /* the bus reads from the first one */
} kernel;

#define LENGTH(array) ((int)(sizeof(array) / sizeof((array)[0])))

static int failure(int error)
{
    errno = error;
    return -1;
}

static int play_socket(int family, int type, int protocol)
{
    if (kernel.socket_error)
        return failure(kernel.socket_error);
    ck_assert_int_eq(family, PF_CAN);
    ck_assert_int_eq(type, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK);
    ck_assert_int_eq(protocol, CAN_RAW);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, kernel.pair), 0);
    return kernel.pair[0];
}

static int play_request(int fd, unsigned long request, struct ifreq *interface)
{
    ck_assert_int_eq(fd, kernel.pair[0]);
    ck_assert_str_eq(interface->ifr_name, "can0");
    if (kernel.index_error)
        return failure(kernel.index_error);
    if (request == SIOCGIFINDEX)
        interface->ifr_ifindex = kernel.index;
    else if (request == SIOCGIFHWADDR)
        interface->ifr_hwaddr.sa_family = kernel.hardware;
    else if (request == SIOCGIFFLAGS)
        interface->ifr_flags = kernel.flags;
    else
        return failure(ENOTTY);
    return 0;
}

static int play_bind(int fd, const struct sockaddr *address, socklen_t size)
{
    struct sockaddr_can can;

    ck_assert_int_eq(fd, kernel.pair[0]);
    ck_assert_uint_eq(size, sizeof can);
    memcpy(&can, address, sizeof can);
    ck_assert_int_eq(can.can_family, AF_CAN);
    ck_assert_int_eq(can.can_ifindex, kernel.index);
    return kernel.bind_error ? failure(kernel.bind_error) : 0;
}

static void note_filters(const void *value, socklen_t size)
{
    ck_assert_uint_le(size, sizeof kernel.filters);
    memcpy(kernel.filters, value, size);
    kernel.filter_count = size / sizeof kernel.filters[0];
}

static int play_setsockopt(int fd, int level, int option, const void *value, socklen_t size)
{
    int number = 0;

    ck_assert_int_eq(fd, kernel.pair[0]);
    if (kernel.option_error && option == kernel.failing_option)
        return failure(kernel.option_error);
    if (size == sizeof number)
        memcpy(&number, value, sizeof number);
    if (level == SOL_CAN_RAW && option == CAN_RAW_FILTER)
        note_filters(value, size);
    else if (level == SOL_CAN_RAW)
        kernel.raw_options[option] = number;
    else
        kernel.socket_options[option] = number;
    return 0;
}

static ssize_t play_send(int fd, const void *data, size_t size, int flags)
{
    ck_assert_int_eq(fd, kernel.pair[0]);
    ck_assert_uint_eq(size, CAN_MTU);
    ck_assert_int_eq(flags, 0);
    if (kernel.send_error)
        return failure(kernel.send_error);
    memcpy(&kernel.sent, data, size);
    kernel.sent_count++;
    return (ssize_t)size;
}

static void add_control(struct msghdr *message, size_t *used, int type, const void *data,
                        size_t size)
{
    struct cmsghdr *part = (struct cmsghdr *)(void *)((char *)message->msg_control + *used);

    ck_assert_uint_le(*used + CMSG_SPACE(size), message->msg_controllen);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = type;
    part->cmsg_len = CMSG_LEN(size);
    memcpy(CMSG_DATA(part), data, size);
    *used += CMSG_SPACE(size);
}

static ssize_t play_recvmsg(int fd, struct msghdr *message, int flags)
{
    struct delivery delivery;
    size_t used = 0;

    ck_assert_int_eq(flags, 0);
    if (recv(fd, &delivery, sizeof delivery, 0) != (ssize_t)sizeof delivery)
        return failure(EAGAIN);
    if (delivery.error)
        return failure(delivery.error);
    memcpy(message->msg_iov->iov_base, &delivery.frame,
           delivery.size < CAN_MTU ? delivery.size : CAN_MTU);
    if (delivery.drops != 0)
        add_control(message, &used, SO_RXQ_OVFL, &delivery.drops, sizeof delivery.drops);
    if (delivery.stamp.tv_sec != 0)
        add_control(message, &used, SCM_TIMESTAMPNS, &delivery.stamp, sizeof delivery.stamp);
    message->msg_controllen = used;
    message->msg_flags = delivery.flags;
    return (ssize_t)delivery.size;
}

static const struct socketcan_calls calls = { .socket = play_socket,
                                              .request = play_request,
                                              .bind = play_bind,
                                              .setsockopt = play_setsockopt,
                                              .send = play_send,
                                              .recvmsg = play_recvmsg };

static void set_up(void)
{
    memset(&kernel, 0, sizeof kernel);
    kernel.hardware = ARPHRD_CAN;
    kernel.flags = IFF_UP;
    kernel.index = 7;
}

static enum co_err try_open(const char *name, struct bus **ret_bus, char *text, size_t size)
{
    const struct bus_options options = { .own_frames = true, .bitrate = 250 };
    const struct bus_message message = { text, size };

    return bus_socketcan_open_with(&calls, name, &options, ret_bus, &message);
}

static struct bus *open_bus(void)
{
    char text[200] = "";
    struct bus *bus = NULL;

    ck_assert_msg(try_open("can0", &bus, text, sizeof text) == CO_OK, "%s", text);
    return bus;
}

static void close_bus(struct bus *bus)
{
    bus_close(bus);
    close(kernel.pair[1]);
}

static struct co_frame parse(const char *text)
{
    struct co_frame frame = { .id = 0 };

    ck_assert(co_frame_parse(text, &frame));
    return frame;
}

static void deliver(const struct delivery *delivery)
{
    ck_assert_int_eq(write(kernel.pair[1], delivery, sizeof *delivery), sizeof *delivery);
}

static struct delivery delivery_of(canid_t can_id, uint8_t first)
{
    return (struct delivery){ .size = CAN_MTU,
                              .frame = { .can_id = can_id, .len = 1, .data = { first } } };
}

static enum co_err send_tagged(struct bus *bus, const char *text, uint8_t tag)
{
    struct co_frame frame = parse(text);

    frame.tag = tag;
    return bus_send(bus, &frame);
}

/* The confirmation of a frame with one byte of data; returns the tag it is reported with. */
static uint8_t confirm(struct bus *bus, canid_t can_id, uint8_t first)
{
    struct delivery delivery = delivery_of(can_id, first);
    struct bus_rx rx;

    delivery.flags = MSG_CONFIRM;
    deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_eq(rx.frame.flags & CO_FRAME_OWN, CO_FRAME_OWN);
    return rx.frame.tag;
}

/* --- opening --- */

static const struct {
    int socket_error, index_error, bind_error;
    unsigned short hardware;
    short flags;
    enum co_err err;
    const char *text;
} open_cases[] = {
    { EAFNOSUPPORT, 0, 0, ARPHRD_CAN, IFF_UP, CO_ERR_NO_BUS, "\"virtual:NAME\" works without" },
    { EPROTONOSUPPORT, 0, 0, ARPHRD_CAN, IFF_UP, CO_ERR_NO_BUS, "modprobe can_raw" },
    { EPERM, 0, 0, ARPHRD_CAN, IFF_UP, CO_ERR_PERMISSION, "cannot open a CAN socket" },
    { EMFILE, 0, 0, ARPHRD_CAN, IFF_UP, CO_ERR_IO, "Too many open files" },
    { 0, ENODEV, 0, ARPHRD_CAN, IFF_UP, CO_ERR_NO_BUS, "can0: no such CAN interface; ip -br link" },
    { 0, 0, 0, ARPHRD_ETHER, IFF_UP, CO_ERR_NO_BUS, "can0 is not a CAN interface" },
    { 0, 0, 0, ARPHRD_CAN, 0, CO_ERR_DOWN, "ip link set can0 up type can bitrate 250000" },
    { 0, 0, ENODEV, ARPHRD_CAN, IFF_UP, CO_ERR_NO_BUS, "No such device" },
    { 0, 0, 0, ARPHRD_CAN, IFF_UP, CO_OK, "" },
};

START_TEST(opening_tells_what_is_wrong)
{
    char text[200] = "";
    struct bus *bus = NULL;

    kernel.socket_error = open_cases[_i].socket_error;
    kernel.index_error = open_cases[_i].index_error;
    kernel.bind_error = open_cases[_i].bind_error;
    kernel.hardware = open_cases[_i].hardware;
    kernel.flags = open_cases[_i].flags;
    ck_assert_int_eq(try_open("can0", &bus, text, sizeof text), open_cases[_i].err);
    ck_assert_msg(strstr(text, open_cases[_i].text) != NULL, "%s", text);
    ck_assert((bus != NULL) == (open_cases[_i].err == CO_OK));
    bus_close(bus);
}
END_TEST

START_TEST(options_that_fail_are_errors)
{
    static const int options[] = { SO_RXQ_OVFL, SO_TIMESTAMPNS, CAN_RAW_RECV_OWN_MSGS,
                                   CAN_RAW_FILTER };
    struct bus *bus = NULL;

    kernel.option_error = ENOPROTOOPT;
    kernel.failing_option = options[_i];
    ck_assert_int_eq(try_open("can0", &bus, NULL, 0), CO_ERR_IO);
    ck_assert_ptr_null(bus);
}
END_TEST

static const char *const bad_names[] = { "", "a-name-too-long-", "can0/x", "can 0", "udp:x" };

START_TEST(names_are_checked)
{
    const struct bus_options options = { .own_frames = false };
    char text[200] = "";
    struct bus *bus = NULL;

    ck_assert_int_eq(bus_open(bad_names[_i], &options, &bus, text, sizeof text), CO_ERR_ARG);
    ck_assert_ptr_nonnull(strstr(text, "is no name of an interface"));
    ck_assert_int_eq(bus_open("nocan0", &options, &bus, text, sizeof text), CO_ERR_NO_BUS);
    ck_assert_ptr_nonnull(strstr(text, "virtual:NAME"));
}
END_TEST

START_TEST(the_socket_is_set_up)
{
    struct bus *bus = open_bus();

    ck_assert_int_eq(kernel.raw_options[CAN_RAW_RECV_OWN_MSGS], 1);
    ck_assert_int_eq(kernel.socket_options[SO_RXQ_OVFL], 1);
    ck_assert_int_ge(kernel.socket_options[SO_RCVBUFFORCE], 1 << 20);
    ck_assert_uint_eq(kernel.filter_count, 1);
    ck_assert_uint_eq(kernel.filters[0].can_id, 0);
    ck_assert_uint_eq(kernel.filters[0].can_mask, CAN_EFF_FLAG | CAN_RTR_FLAG);
    close_bus(bus);
}
END_TEST

START_TEST(the_buffer_is_as_large_as_allowed)
{
    kernel.option_error = EPERM;
    kernel.failing_option = SO_RCVBUFFORCE;
    close_bus(open_bus());
    ck_assert_int_ge(kernel.socket_options[SO_RCVBUF], 1 << 20);
}
END_TEST

/* --- frames --- */

static const struct {
    const char *text;
    canid_t can_id;
} frame_cases[] = {
    { "605#4000100000000000", 0x605 },
    { "7FF#", 0x7FF },
    { "00000605#01", 0x605 | CAN_EFF_FLAG },
    { "1FFFFFFF#0102030405060708", 0x1FFFFFFF | CAN_EFF_FLAG },
    { "705#R1", 0x705 | CAN_RTR_FLAG },
    { "00000705#R8", 0x705 | CAN_RTR_FLAG | CAN_EFF_FLAG },
};

START_TEST(frames_are_translated_both_ways)
{
    struct bus *bus = open_bus();
    struct delivery delivery = { .size = CAN_MTU };
    char text[CO_FRAME_TEXT_SIZE];
    struct bus_rx rx;

    ck_assert_int_eq(send_tagged(bus, frame_cases[_i].text, 0), CO_OK);
    ck_assert_uint_eq(kernel.sent.can_id, frame_cases[_i].can_id);
    delivery.frame = kernel.sent;
    deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_str_eq(co_frame_format(&rx.frame, text, sizeof text), frame_cases[_i].text);
    ck_assert_uint_eq(rx.frame.flags & CO_FRAME_OWN, 0);
    ck_assert_uint_eq(rx.frame.tag, 0);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
    close_bus(bus);
}
END_TEST

static const struct {
    int error;
    enum co_err err;
} error_cases[] = {
    { EAGAIN, CO_ERR_AGAIN },  { ENOBUFS, CO_ERR_AGAIN },     { EINTR, CO_ERR_AGAIN },
    { ENETDOWN, CO_ERR_DOWN }, { ENODEV, CO_ERR_NO_BUS },     { ENXIO, CO_ERR_NO_BUS },
    { EIO, CO_ERR_IO },        { EACCES, CO_ERR_PERMISSION }, { ENOMEM, CO_ERR_MEMORY },
};

START_TEST(errors_are_translated)
{
    struct bus *bus = open_bus();
    struct delivery delivery = { .error = error_cases[_i].error };
    struct bus_rx rx;

    kernel.send_error = error_cases[_i].error;
    ck_assert_int_eq(send_tagged(bus, "123#01", 1), error_cases[_i].err);
    deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), error_cases[_i].err);
    kernel.send_error = 0;
    ck_assert_int_eq(send_tagged(bus, "123#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x123, 1), 2); /* what was not sent is not waited for */
    close_bus(bus);
}
END_TEST

START_TEST(what_is_no_classic_frame_is_left_out)
{
    struct bus *bus = open_bus();
    struct delivery error_frame = delivery_of(CAN_ERR_FLAG | CAN_ERR_CRTL, 0);
    struct delivery short_frame = delivery_of(0x123, 0);
    struct bus_rx rx;

    deliver(&error_frame);
    short_frame.size = 8;
    deliver(&short_frame);
    for (unsigned i = 0; i < 2; i++)
        ck_assert_int_eq(bus_receive(bus, &rx), CO_ERR_AGAIN);
    ck_assert_int_eq(bus_wait(bus, 0), CO_ERR_TIMEOUT);
    close_bus(bus);
}
END_TEST

START_TEST(losses_are_differences_of_the_socket_s_counter)
{
    static const struct {
        uint32_t drops;
        unsigned lost;
    } steps[] = {
        { 0, 0 }, { 3, 3 }, { 3, 0 }, { 10, 7 }, { UINT32_MAX, UINT32_MAX - 10 }, { 4, 5 }
    };
    struct bus *bus = open_bus();
    struct bus_rx rx;

    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        struct delivery delivery = delivery_of(0x123, 0);

        delivery.drops = steps[i].drops;
        deliver(&delivery);
        ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
        ck_assert_uint_eq(rx.lost, steps[i].lost);
    }
    close_bus(bus);
}
END_TEST

/* The time reported for a frame stamped so long ago, relative to now. */
static int64_t age_reported(struct bus *bus, int seconds_ago)
{
    struct delivery delivery = delivery_of(0x123, 0);
    struct bus_rx rx;

    clock_gettime(CLOCK_REALTIME, &delivery.stamp);
    delivery.stamp.tv_sec -= seconds_ago;
    deliver(&delivery);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    return (int64_t)(clock_now() - rx.time);
}

START_TEST(time_stamps_become_monotonic)
{
    struct bus *bus = open_bus();
    struct delivery unstamped = delivery_of(0x123, 0);
    struct bus_rx rx;

    ck_assert_int_ge(age_reported(bus, 2), 2000000);
    ck_assert_int_lt(age_reported(bus, 2), 3000000);
    ck_assert_int_lt(age_reported(bus, -2), 1000000);   /* the wall clock was set back ... */
    ck_assert_int_lt(age_reported(bus, 3600), 1000000); /* ... or forth */
    deliver(&unstamped);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    ck_assert_uint_lt(clock_now() - rx.time, CO_MS(1000));
    close_bus(bus);
}
END_TEST

/* --- tags of own frames --- */

START_TEST(confirmations_bring_their_tags)
{
    const struct bus_filter all = { 0, 0, 0, 0 };
    struct bus *bus = open_bus();

    ck_assert_int_eq(bus_set_filters(bus, &all, 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "00000101#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x101 | CAN_EFF_FLAG, 1), 2);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 0);
    close_bus(bus);
}
END_TEST

START_TEST(frames_the_filters_drop_are_not_waited_for)
{
    const struct bus_filter filter = { 0x101, 0x7FF, 0, 3 };
    struct bus *bus = open_bus();

    ck_assert_int_eq(bus_set_filters(bus, &filter, 1), CO_OK);
    ck_assert_int_eq(send_tagged(bus, "101#01", 1), CO_OK);
    for (unsigned i = 0; i < 5000; i++)
        ck_assert_int_eq(send_tagged(bus, "102#01", 2), CO_OK);
    ck_assert_uint_eq(confirm(bus, 0x101, 1), 1);
    close_bus(bus);
}
END_TEST

/* --- filters, waiting, state --- */

START_TEST(filters_are_exact)
{
    const struct bus_filter filters[] = { { 0x605, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
                                          { 0x700, 0x780, CO_FRAME_RTR, CO_FRAME_RTR },
                                          { 0x1234567, 0x1FFFFFFF, CO_FRAME_EXT, CO_FRAME_EXT } };
    static const struct bus_filter many[BUS_FILTERS_MAX + 1];
    struct bus *bus = open_bus();

    ck_assert_int_eq(bus_set_filters(bus, filters, 3), CO_OK);
    ck_assert_uint_eq(kernel.filters[0].can_id, 0x605);
    ck_assert_uint_eq(kernel.filters[0].can_mask, 0x7FF | CAN_EFF_FLAG | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[1].can_id, 0x700 | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[1].can_mask, 0x780 | CAN_RTR_FLAG);
    ck_assert_uint_eq(kernel.filters[2].can_id, 0x1234567 | CAN_EFF_FLAG);
    ck_assert_uint_eq(kernel.filters[2].can_mask, 0x1FFFFFFF | CAN_EFF_FLAG);
    ck_assert_int_eq(bus_set_filters(bus, many, BUS_FILTERS_MAX + 1), CO_ERR_ARG);
    ck_assert_int_eq(bus_set_filters(bus, many, BUS_FILTERS_MAX), CO_OK);
    ck_assert_uint_eq(kernel.filter_count, BUS_FILTERS_MAX);
    ck_assert_int_eq(bus_set_filters(bus, NULL, 0), CO_OK);
    ck_assert_uint_eq(kernel.filter_count, 1);
    kernel.option_error = EINVAL;
    kernel.failing_option = CAN_RAW_FILTER;
    ck_assert_int_eq(bus_set_filters(bus, filters, 3), CO_ERR_IO);
    close_bus(bus);
}
END_TEST

START_TEST(waiting_ends_with_a_frame_a_wake_or_the_deadline)
{
    struct bus *bus = open_bus();
    struct delivery delivery = delivery_of(0x123, 0);
    co_us_t deadline = clock_now() + CO_MS(20);
    struct bus_rx rx;

    ck_assert_int_eq(bus_wait(bus, deadline), CO_ERR_TIMEOUT);
    ck_assert_uint_ge(clock_now(), deadline);
    bus_wake(bus);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(bus_wait(bus, 0), CO_ERR_TIMEOUT);
    deliver(&delivery);
    ck_assert_int_eq(bus_wait(bus, CO_NEVER), CO_OK);
    ck_assert_int_eq(bus_receive(bus, &rx), CO_OK);
    close_bus(bus);
}
END_TEST

START_TEST(the_state_is_that_of_the_interface)
{
    struct bus *bus = open_bus();
    char text[200];

    ck_assert_int_eq(bus_get_state(bus), BUS_ACTIVE);
    bus_explain(bus, text, sizeof text);
    ck_assert_str_eq(text, "can0 is up");
    kernel.flags = 0;
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    bus_explain(bus, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "can0 is down; run: ip link set can0 up"));
    kernel.flags = IFF_UP;
    kernel.index = 8; /* unplugged and plugged in: another interface of the same name */
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    kernel.index_error = ENODEV;
    ck_assert_int_eq(bus_get_state(bus), BUS_DOWN);
    bus_explain(bus, text, sizeof text);
    ck_assert_ptr_nonnull(strstr(text, "no such CAN interface"));
    close_bus(bus);
}
END_TEST

static Suite *suite_of_all(void)
{
    Suite *suite = suite_create("bus_socketcan");
    TCase *tests = tcase_create("played kernel");

    tcase_set_timeout(tests, 60);
    tcase_add_checked_fixture(tests, set_up, NULL);
    tcase_add_loop_test(tests, opening_tells_what_is_wrong, 0, LENGTH(open_cases));
    tcase_add_loop_test(tests, options_that_fail_are_errors, 0, 4);
    tcase_add_loop_test(tests, names_are_checked, 0, LENGTH(bad_names));
    tcase_add_test(tests, the_socket_is_set_up);
    tcase_add_test(tests, the_buffer_is_as_large_as_allowed);
    tcase_add_loop_test(tests, frames_are_translated_both_ways, 0, LENGTH(frame_cases));
    tcase_add_loop_test(tests, errors_are_translated, 0, LENGTH(error_cases));
    tcase_add_test(tests, what_is_no_classic_frame_is_left_out);
    tcase_add_test(tests, losses_are_differences_of_the_socket_s_counter);
    tcase_add_test(tests, time_stamps_become_monotonic);
    tcase_add_test(tests, confirmations_bring_their_tags);
    tcase_add_test(tests, frames_the_filters_drop_are_not_waited_for);
    tcase_add_test(tests, filters_are_exact);
    tcase_add_test(tests, waiting_ends_with_a_frame_a_wake_or_the_deadline);
    tcase_add_test(tests, the_state_is_that_of_the_interface);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(suite_of_all());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

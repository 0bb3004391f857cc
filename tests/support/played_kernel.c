#include "support/played_kernel.h"

#include "support/link_message.h"

#include <check.h>
#include <errno.h>
#include <linux/can/raw.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <linux/sock_diag.h>
#include <string.h>
#include <unistd.h>

struct played_kernel kernel;

static int failure(int error)
{
    errno = error;
    return -1;
}

/* For a job of its own; the one before has ended. */
static int play_bcm_socket(int type)
{
    ck_assert_int_eq(type, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK);
    ck_assert(!played_job_runs());
    if (kernel.bcm_error)
        return failure(kernel.bcm_error);
    if (kernel.bcm[1] > 0)
        close(kernel.bcm[1]);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, kernel.bcm), 0);
    kernel.job.index = 0;
    return kernel.bcm[0];
}

static int play_socket(int family, int type, int protocol)
{
    bool is_can = family == PF_CAN;
    int error = is_can ? kernel.socket_error : kernel.netlink_error;
    int *pair = is_can ? kernel.can : kernel.netlink;

    if (is_can && protocol == CAN_BCM)
        return play_bcm_socket(type);
    if (error)
        return failure(error);
    ck_assert(is_can || family == AF_NETLINK);
    ck_assert_int_eq(type, SOCK_RAW | SOCK_CLOEXEC | (is_can ? 0 : SOCK_NONBLOCK));
    ck_assert_int_eq(protocol, is_can ? CAN_RAW : NETLINK_ROUTE);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, pair), 0);
    return pair[0];
}

static int bind_netlink(const struct sockaddr *address, socklen_t size)
{
    struct sockaddr_nl netlink;

    ck_assert_uint_eq(size, sizeof netlink);
    memcpy(&netlink, address, sizeof netlink);
    ck_assert_int_eq(netlink.nl_family, AF_NETLINK);
    ck_assert_uint_eq(netlink.nl_groups, RTMGRP_LINK);
    return 0;
}

static int play_bind(int fd, const struct sockaddr *address, socklen_t size)
{
    struct sockaddr_can can;

    if (fd == kernel.netlink[0])
        return bind_netlink(address, size);
    ck_assert_int_eq(fd, kernel.can[0]);
    ck_assert_uint_eq(size, sizeof can);
    memcpy(&can, address, sizeof can);
    ck_assert_int_eq(can.can_family, AF_CAN);
    kernel.binds++;
    if (kernel.bind_error)
        return failure(kernel.bind_error);
    if (can.can_ifindex != kernel.link.index)
        return failure(ENODEV);
    kernel.bound = can.can_ifindex;
    return 0;
}

static int play_connect(int fd, const struct sockaddr *address, socklen_t size)
{
    struct sockaddr_can can;

    ck_assert_int_eq(fd, kernel.bcm[0]);
    ck_assert_uint_eq(size, sizeof can);
    memcpy(&can, address, sizeof can);
    ck_assert_int_eq(can.can_family, AF_CAN);
    if (kernel.connect_error)
        return failure(kernel.connect_error);
    if (can.can_ifindex != kernel.link.index)
        return failure(ENODEV);
    kernel.job.index = can.can_ifindex;
    return 0;
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

    ck_assert_int_eq(fd, kernel.can[0]);
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

static int play_getsockopt(int fd, int level, int option, void *value, socklen_t *size)
{
    uint32_t memory[SK_MEMINFO_VARS] = { [SK_MEMINFO_WMEM_ALLOC] = kernel.backlog };

    ck_assert_int_eq(fd, kernel.can[0]);
    ck_assert_int_eq(level, SOL_SOCKET);
    ck_assert_int_eq(option, SO_MEMINFO);
    ck_assert_uint_eq(*size, sizeof memory);
    kernel.backlog_asked++;
    if (kernel.backlog_error)
        return failure(kernel.backlog_error);
    memcpy(value, memory, sizeof memory);
    return 0;
}

static ssize_t answer_request(const void *data, size_t size)
{
    uint8_t expected[CAN_LINK_REQUEST_MAX];

    ck_assert_uint_eq(size, can_link_request("can0", expected));
    ck_assert_mem_eq(data, expected, size);
    kernel.requests++;
    if (!kernel.is_mute)
        played_tell();
    return (ssize_t)size;
}

static void note_job(const struct bcm_msg_head *head, const void *frames)
{
    struct played_job *job = &kernel.job;

    job->opcode = head->opcode;
    job->flags = head->flags;
    job->count = head->count;
    job->first_periods = head->ival1;
    job->period = head->ival2;
    job->can_id = head->can_id;
    job->frame_count = head->nframes;
    memcpy(job->frames, frames, head->nframes * CAN_MTU);
    job->started++;
}

static ssize_t start_job(const void *data, size_t size)
{
    struct bcm_msg_head head;

    ck_assert_uint_ge(size, sizeof head);
    memcpy(&head, data, sizeof head);
    ck_assert_uint_le(head.nframes, BUS_CYCLIC_MAX);
    ck_assert_uint_eq(size, sizeof head + head.nframes * CAN_MTU);
    if (kernel.job_error)
        return failure(kernel.job_error);
    note_job(&head, (const char *)data + sizeof head);
    return (ssize_t)size;
}

static ssize_t play_send(int fd, const void *data, size_t size, int flags)
{
    ck_assert_int_eq(flags, fd == kernel.can[0] ? MSG_DONTWAIT : 0);
    if (fd == kernel.netlink[0])
        return answer_request(data, size);
    if (fd == kernel.bcm[0] && kernel.job.index != 0)
        return start_job(data, size);
    ck_assert_int_eq(fd, kernel.can[0]);
    ck_assert_uint_eq(size, CAN_MTU);
    if (kernel.on_send)
        kernel.on_send();
    if (kernel.send_error)
        return failure(kernel.send_error);
    memcpy(&kernel.sent, data, size);
    kernel.log[kernel.sent_count++ % PLAYED_LOG] = kernel.sent;
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

static ssize_t receive_news(const struct msghdr *message)
{
    int error = kernel.news_error;

    kernel.news_error = 0;
    return error
               ? failure(error)
               : recv(kernel.netlink[0], message->msg_iov->iov_base, message->msg_iov->iov_len, 0);
}

static ssize_t play_recvmsg(int fd, struct msghdr *message, int flags)
{
    ck_assert_int_eq(fd, kernel.netlink[0]);
    ck_assert_int_eq(flags, 0);
    return receive_news(message);
}

static ssize_t receive_delivery(int fd, struct msghdr *message)
{
    struct delivery delivery;
    size_t used = 0;

    if (recv(fd, &delivery, sizeof delivery, MSG_DONTWAIT) != (ssize_t)sizeof delivery)
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

/* As Linux does, it forgets an error that comes behind messages until the next call. */
static int play_recvmmsg(int fd, struct mmsghdr *messages, unsigned count, int flags,
                         struct timespec *timeout)
{
    unsigned done = 0;

    ck_assert_int_eq(fd, kernel.can[0]);
    ck_assert_int_eq(flags, MSG_DONTWAIT);
    ck_assert_ptr_null(timeout);
    if (kernel.late_error != 0) {
        errno = kernel.late_error;
        kernel.late_error = 0;
        return -1;
    }
    while (done < count) {
        ssize_t size = receive_delivery(fd, &messages[done].msg_hdr);

        if (size < 0)
            break;
        messages[done++].msg_len = (unsigned)size;
    }
    if (done > 0 && done < count && errno != EAGAIN)
        kernel.late_error = errno;
    return done > 0 ? (int)done : -1;
}

const struct socketcan_calls played_calls = { .socket = play_socket,
                                              .connect = play_connect,
                                              .bind = play_bind,
                                              .setsockopt = play_setsockopt,
                                              .getsockopt = play_getsockopt,
                                              .send = play_send,
                                              .recvmsg = play_recvmsg,
                                              .recvmmsg = play_recvmmsg };

void played_reset(void)
{
    memset(&kernel, 0, sizeof kernel);
    kernel.link = (struct can_link){ .name = "can0",
                                     .index = 7,
                                     .is_can = true,
                                     .is_controller = true,
                                     .is_up = true,
                                     .bitrate = 250000,
                                     .restart_ms = 100,
                                     .queue_length = 1000 };
}

enum co_err played_try_open(const char *name, struct bus **ret_bus, char *text, size_t size)
{
    const struct bus_options options = { .own_frames = true, .bitrate = 250 };
    const struct bus_message message = { text, size };

    return bus_socketcan_open_with(&played_calls, name, &options, ret_bus, &message);
}

struct bus *played_open(void)
{
    char text[400] = "";
    struct bus *bus = NULL;

    ck_assert_msg(played_try_open("can0", &bus, text, sizeof text) == CO_OK, "%s", text);
    return bus;
}

void played_close(struct bus *bus)
{
    bus_close(bus);
    close(kernel.can[1]);
    close(kernel.netlink[1]);
}

bool played_job_runs(void)
{
    char byte;

    return kernel.job.index != 0 && recv(kernel.bcm[1], &byte, 1, 0) < 0; /* 0: it was closed */
}

void played_deliver(const struct delivery *delivery)
{
    ck_assert_int_eq(write(kernel.can[1], delivery, sizeof *delivery), sizeof *delivery);
}

struct delivery played_frame(canid_t can_id, uint8_t first)
{
    return (struct delivery){ .size = CAN_MTU,
                              .frame = { .can_id = can_id, .len = 1, .data = { first } } };
}

void played_error_frame(canid_t class, uint8_t second)
{
    struct delivery delivery = played_frame(CAN_ERR_FLAG | class, 0);

    delivery.frame.len = CAN_MAX_DLEN;
    delivery.frame.data[1] = second;
    played_deliver(&delivery);
}

void played_fail(int error)
{
    const struct delivery delivery = { .error = error };

    played_deliver(&delivery);
}

void played_bytes(const uint8_t *data, size_t size)
{
    ck_assert_int_eq(write(kernel.netlink[1], data, size), (ssize_t)size);
}

static void send_news(const struct can_link_news *news)
{
    uint8_t data[CAN_LINK_MESSAGE_MAX];

    played_bytes(data, link_message_add(data, 0, news));
}

void played_news(enum can_link_news_type type, const struct can_link *link)
{
    const struct can_link_news news = { .type = type, .link = *link };

    if (type == CAN_LINK_GONE && link->index == kernel.bound) { /* as Linux does */
        kernel.bound = 0;
        kernel.filter_count = 0;
    }
    send_news(&news);
}

void played_tell(void)
{
    const struct can_link_news absent = { .type = CAN_LINK_REFUSED, .error = ENODEV };

    if (kernel.link.index == 0)
        send_news(&absent);
    else
        played_news(CAN_LINK_IS, &kernel.link);
}

void played_set_up(bool up)
{
    kernel.link.is_up = up;
    kernel.link.controller = BUS_ACTIVE;
    played_tell();
}

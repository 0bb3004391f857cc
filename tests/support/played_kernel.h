/*
 * SocketCAN without a CAN kernel: the system calls of bus_socketcan are played here, over socket
 * pairs; what goes wrong is the test's choice.
 */
#ifndef TEST_SUPPORT_PLAYED_KERNEL_H
#define TEST_SUPPORT_PLAYED_KERNEL_H

#include "port/bus_socketcan.h"
#include "port/can_link.h"

#include <linux/can.h>
#include <linux/can/bcm.h>
#include <time.h>

/* What a recvmsg() on the CAN socket gives. */
struct delivery {
    int error; /* errno instead of a frame */
    int flags; /* MSG_CONFIRM */
    uint32_t drops;
    struct timespec stamp; /* 0: none */
    size_t size;
    struct can_frame frame;
};

#define PLAYED_LOG 256u /* frames sent that are kept */

/* What CAN_BCM was told last, and where. */
struct played_job {
    unsigned started; /* how often one was */
    int index;
    uint32_t opcode, flags, count, frame_count;
    struct bcm_timeval first_periods, period;
    canid_t can_id;
    struct can_frame frames[BUS_CYCLIC_MAX];
};

struct played_kernel {
    /* errors, as errno; 0: the call works */
    int socket_error, netlink_error, bind_error, send_error, option_error, failing_option;
    int bcm_error, connect_error, job_error; /* of the three calls that start a job */
    int late_error;                          /* of the next recvmmsg() */
    int news_error;                          /* of the next recvmsg() on the netlink socket */
    struct can_link link;                    /* can0, index 0: there is none */
    bool is_mute;                            /* answers no requests */
    /* what was asked for */
    struct can_filter filters[600];
    size_t filter_count;
    int raw_options[8], socket_options[80];
    int bound;         /* index */
    unsigned binds;    /* how often */
    unsigned requests; /* for the interface */
    unsigned backlog;  /* bytes of the socket that wait to be sent */
    int backlog_error;
    unsigned backlog_asked; /* how often */
    struct can_frame sent;  /* the last one */
    struct can_frame log[PLAYED_LOG];
    unsigned sent_count;
    void (*on_send)(void); /* before a frame; NULL: nobody */
    struct played_job job;
    int can[2], netlink[2], bcm[2]; /* the bus has the first ones */
};

extern struct played_kernel kernel;
extern const struct socketcan_calls played_calls;

/* can0 with index 7, up at 250 kbit/s, a queue of 1000 frames, restart after 100 ms. */
void played_reset(void);
enum co_err played_try_open(const char *name, struct bus **ret_bus, char *text, size_t size);
struct bus *played_open(void);
void played_close(struct bus *bus);

void played_deliver(const struct delivery *delivery);
struct delivery played_frame(canid_t can_id, uint8_t first);
/* An error frame with the second byte of its data. */
void played_error_frame(canid_t class, uint8_t second);
/* The kernel sends frames by itself at the moment. */
bool played_job_runs(void);
/* recvmsg() fails so. */
void played_fail(int error);

/* News about an interface. */
void played_news(enum can_link_news_type type, const struct can_link *link);
/* News about can0 as it is in kernel.link now. */
void played_tell(void);
/* can0 goes down or up, with news of it. */
void played_set_up(bool up);
/* Bytes of any kind on the netlink socket. */
void played_bytes(const uint8_t *data, size_t size);

#endif

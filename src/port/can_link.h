/*
 * What the kernel tells about CAN interfaces (rtnetlink), as functions on bytes: no system calls.
 *
 *   in   messages of the kernel: the answer to a request, news about any interface
 *   out  the state of the interface that a message is about; requests
 *
 * Internal to port/. Bytes that are no message of interest, or damaged, are left out.
 */
#ifndef CO_PORT_CAN_LINK_H
#define CO_PORT_CAN_LINK_H

#include "port/bus.h"

#include <net/if.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CAN_LINK_MESSAGE_MAX 16384u /* more than the kernel tells in one datagram */
#define CAN_LINK_REQUEST_MAX 64u

struct can_link {
    char name[IFNAMSIZ];
    int index;                 /* another one each time an interface is made or plugged in */
    bool is_can;               /* else no CAN interface at all */
    bool is_controller;        /* has bit rate and error states; vcan has not */
    bool is_up;                /* by the administrator */
    uint32_t bitrate;          /* bit/s; 0: none is set */
    uint32_t restart_ms;       /* after bus-off; 0: an administrator has to */
    uint32_t queue_length;     /* frames that wait in the kernel */
    enum bus_state controller; /* as of this message: BUS_ACTIVE .. BUS_OFF */
};

enum can_link_news_type {
    CAN_LINK_IS,     /* there, in this state: an answer, or something has changed */
    CAN_LINK_GONE,   /* removed, unplugged or given to another network namespace */
    CAN_LINK_REFUSED /* the request failed; error tells why */
};

struct can_link_news {
    enum can_link_news_type type;
    struct can_link link; /* GONE: name and index; REFUSED: nothing */
    int error;            /* errno of REFUSED: ENODEV where there is no interface of this name */
};

struct can_link_reader { /* over what one recvmsg() has brought */
    const uint8_t *data;
    size_t size;
};

/* The next message of interest; false at the end. */
bool can_link_next(struct can_link_reader *self, struct can_link_news *ret_news);

/* Asks for the interface of this name (shorter than IFNAMSIZ); returns the size. */
size_t can_link_request(const char *name, uint8_t ret_data[CAN_LINK_REQUEST_MAX]);

/* The bit rate is set and not that one; kbit 0: any is right. A calculated rate may be 1 % off. */
bool can_link_has_other_bitrate(const struct can_link *self, unsigned kbit);

#endif

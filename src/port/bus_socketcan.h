/*
 * The system calls of bus_socketcan.c in one table, so that tests can let them fail where no
 * hardware would on demand. Internal to port/.
 */
#ifndef CO_PORT_BUS_SOCKETCAN_H
#define CO_PORT_BUS_SOCKETCAN_H

#include "port/bus_ops.h"
#include "port/io_ring.h"

#include <sys/socket.h>

struct socketcan_calls {
    int (*socket)(int family, int type, int protocol);
    int (*connect)(int fd, const struct sockaddr *address, socklen_t size);
    int (*bind)(int fd, const struct sockaddr *address, socklen_t size);
    int (*setsockopt)(int fd, int level, int option, const void *value, socklen_t size);
    int (*getsockopt)(int fd, int level, int option, void *value, socklen_t *size);
    ssize_t (*send)(int fd, const void *data, size_t size, int flags);
    ssize_t (*recvmsg)(int fd, struct msghdr *message, int flags);
    int (*recvmmsg)(int fd, struct mmsghdr *messages, unsigned count, int flags,
                    struct timespec *timeout);
    io_ring_setup_fn *io_uring_setup; /* NULL: there is none, and none of the calls goes round it */
};

/* The real ones. */
extern const struct socketcan_calls socketcan_system_calls;

/* As bus_socketcan_open(), which gives the real calls. They must outlive the bus. */
enum co_err bus_socketcan_open_with(const struct socketcan_calls *calls, const char *name,
                                    const struct bus_options *options, struct bus **ret_bus,
                                    const struct bus_message *message);

#endif

/*
 * The networks that this process has open. The manager and the slave interface share them: whoever
 * comes first opens the bus, whoever goes last closes it.
 *
 *   in   orders to open and close
 *   out  struct network; what is about a network as a whole goes to the sinks of all its users
 *
 *   locking  its own lock, before all others of docs/threading.md: held while a bus is opened or
 *            closed, never by a thread of the library
 */
#ifndef CO_API_NETS_H
#define CO_API_NETS_H

#include "runtime/network.h"

enum net_user { NET_MANAGER, NET_SLAVES, NET_USERS };

struct net_order {
    int number;
    enum net_user user;
    const char *bus;  /* NULL: as the other user has it, or what the environment says */
    unsigned bitrate; /* kbit/s */
    network_sink_fn sink;
    void *context;
};

/*
 * CO_ERR_EXISTS: this user has the network already; CO_ERR_BITRATE, CO_ERR_VALUE: the other user
 * has it at another bit rate, or on another bus; else as network_open().
 */
enum co_err nets_open(const struct net_order *order, struct network **ret_network, char *message,
                      size_t message_size);
/* Nothing where this user does not have it. Its sink gets nothing any more. */
void nets_close(int number, enum net_user user);
/* Its sink gets nothing any more; the network stays. */
void nets_silence(int number, enum net_user user);

#endif

#include "api/nets.h"

#include "api/load.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct user {
    bool present;
    network_sink_fn sink; /* under the network's lock */
    void *context;
};

struct net {
    struct net *next;
    int number;
    unsigned bitrate;
    struct network *network;
    struct user users[NET_USERS];
};

static struct {
    pthread_mutex_t lock;
    struct net *first;
} nets = { .lock = PTHREAD_MUTEX_INITIALIZER };

/* Under the network's lock. */
static void tell_users(void *context, struct network *network, const struct co_event *event)
{
    const struct net *self = context;

    for (unsigned i = 0; i < NET_USERS; i++)
        if (self->users[i].sink)
            self->users[i].sink(self->users[i].context, network, event);
}

static void set_sink(struct net *self, enum net_user user, network_sink_fn sink, void *context)
{
    co_us_t now;

    network_enter(self->network, &now);
    self->users[user].sink = sink;
    self->users[user].context = context;
    network_leave(self->network, 0);
}

static struct net **find(int number)
{
    struct net **place = &nets.first;

    while (*place && (*place)->number != number)
        place = &(*place)->next;
    return place;
}

static enum co_err open_new(const struct net_order *order, struct net **place, char *message,
                            size_t message_size)
{
    const struct network_config by_number = { .net = (uint8_t)order->number };
    char bus[64];
    struct network_options options = { .bitrate = order->bitrate, .sink = tell_users };
    struct net *self = calloc(1, sizeof *self);
    enum co_err err;

    if (!self)
        return CO_ERR_MEMORY;
    load_bus_name(&by_number, bus, sizeof bus);
    options.bus = order->bus ? order->bus : bus;
    options.context = self;
    self->number = order->number;
    self->bitrate = order->bitrate;
    err = network_open(&options, &self->network, message, message_size);
    if (err == CO_OK)
        *place = self;
    else
        free(self);
    return err;
}

static enum co_err check_shared(const struct net *self, const struct net_order *order,
                                char *message, size_t message_size)
{
    if (self->users[order->user].present) {
        snprintf(message, message_size, "network %d is open already", order->number);
        return CO_ERR_EXISTS;
    }
    if (self->bitrate != order->bitrate && self->bitrate != 0 && order->bitrate != 0) {
        snprintf(message, message_size,
                 "network %d is open at %u kbit/s in this process, %u kbit/s are asked for",
                 order->number, self->bitrate, order->bitrate);
        return CO_ERR_BITRATE;
    }
    if (order->bus && strcmp(order->bus, network_name(self->network)) != 0) {
        snprintf(message, message_size, "network %d is open on %s in this process, %s is asked for",
                 order->number, network_name(self->network), order->bus);
        return CO_ERR_VALUE;
    }
    return CO_OK;
}

static enum co_err join(const struct net_order *order, struct network **ret_network, char *message,
                        size_t message_size)
{
    struct net **place = find(order->number);
    enum co_err err;

    if (*place)
        err = check_shared(*place, order, message, message_size);
    else
        err = open_new(order, place, message, message_size);
    if (err != CO_OK)
        return err;
    (*place)->users[order->user].present = true;
    set_sink(*place, order->user, order->sink, order->context);
    *ret_network = (*place)->network;
    return CO_OK;
}

enum co_err nets_open(const struct net_order *order, struct network **ret_network, char *message,
                      size_t message_size)
{
    enum co_err err;

    pthread_mutex_lock(&nets.lock);
    err = join(order, ret_network, message, message_size);
    pthread_mutex_unlock(&nets.lock);
    return err;
}

static bool is_used(const struct net *self)
{
    return self->users[NET_MANAGER].present || self->users[NET_SLAVES].present;
}

static void leave(struct net **place, enum net_user user)
{
    struct net *self = *place;

    set_sink(self, user, NULL, NULL);
    self->users[user].present = false;
    if (is_used(self))
        return;
    *place = self->next;
    network_close(self->network);
    free(self);
}

void nets_close(int number, enum net_user user)
{
    struct net **place;

    pthread_mutex_lock(&nets.lock);
    place = find(number);
    if (*place && (*place)->users[user].present)
        leave(place, user);
    pthread_mutex_unlock(&nets.lock);
}

void nets_silence(int number, enum net_user user)
{
    struct net **place;

    pthread_mutex_lock(&nets.lock);
    place = find(number);
    if (*place && (*place)->users[user].present)
        set_sink(*place, user, NULL, NULL);
    pthread_mutex_unlock(&nets.lock);
}

/*
 * What an implementation of bus.h gives to bus.c. Internal to port/.
 *
 * Each implementation embeds struct bus as its first member; bus.c fills name.
 */
#ifndef CO_PORT_BUS_OPS_H
#define CO_PORT_BUS_OPS_H

#include "port/bus.h"

#define BUS_VIRTUAL_PREFIX "virtual:"
#define BUS_NAME_SIZE      64u  /* the prefix, 32 characters, "?bitrate=1000000" and the end */
#define BUS_FILTERS_MAX    512u /* what Linux accepts for one CAN_RAW socket */

struct bus_ops {
    void (*close)(struct bus *self);
    enum co_err (*send)(struct bus *self, const struct co_frame *frame);
    enum co_err (*receive)(struct bus *self, struct bus_rx *ret_rx);
    bool (*has_fetched)(struct bus *self);
    enum co_err (*wait)(struct bus *self, co_us_t deadline);
    void (*wake)(struct bus *self);
    enum co_err (*set_filters)(struct bus *self, const struct bus_filter *filters, size_t count);
    enum co_err (*set_own_frames)(struct bus *self, bool on);
    enum co_err (*set_cyclic)(struct bus *self, const struct co_frame *frames, unsigned count,
                              co_us_t period); /* arguments are right */
    unsigned (*backlog)(struct bus *self);
    enum bus_state (*get_state)(struct bus *self);
    void (*explain)(struct bus *self, char *message, size_t message_size);
};

struct bus {
    const struct bus_ops *ops;
    char name[BUS_NAME_SIZE];
    _Atomic unsigned outages; /* see bus_outages() */
};

/* Where bus_open() puts its line of text; text may be NULL. */
struct bus_message {
    char *text;
    size_t size;
};

/* Formats the line and returns err, so that a failure is one statement. */
enum co_err bus_fail(const struct bus_message *message, enum co_err err, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Passes if no filters are set (NULL) and it is a data frame with an 11-bit identifier, or if one
 * of the filters matches. */
bool bus_filters_pass(const struct bus_filter *filters, size_t count, const struct co_frame *frame);

/*
 * One poll of descriptors (-1: none), until one is readable or the deadline. CO_OK, CO_ERR_TIMEOUT,
 * CO_ERR_IO; a signal ends it with CO_OK and nothing readable.
 */
#define BUS_POLL_MAX 3

struct bus_poll {
    int fd[BUS_POLL_MAX];
    bool readable[BUS_POLL_MAX];
};
enum co_err bus_poll_until(struct bus_poll *self, co_us_t deadline);

/* name: without the prefix */
enum co_err bus_virtual_open(const char *name, const struct bus_options *options,
                             struct bus **ret_bus, const struct bus_message *message);
enum co_err bus_socketcan_open(const char *name, const struct bus_options *options,
                               struct bus **ret_bus, const struct bus_message *message);

#endif

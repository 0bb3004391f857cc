/*
 * The control daemon: takes what the managers report to the application's event queue and log hook,
 * and the ends of SDO requests to the application's functions.
 *
 *   in   events of the managers, from the protocol threads
 *   out  EVENT_T in the application's queue; from its own thread: lines of text to the log hook,
 *        ends of SDO requests
 */
#ifndef CO_API_CONTROL_H
#define CO_API_CONTROL_H

#include "api/registry.h"

#define CONTROL_EVENTS     4096u /* in the application's queue: two boots of a full network */
#define CONTROL_LOG_EVENTS 4096u

/* CO_ERR_MEMORY */
enum co_err control_init(struct registry *registry);
void control_done(struct registry *registry);

/* A network_sink_fn; context: struct managed. */
void control_on_event(void *context, struct network *network, const struct co_event *event);

/* Under the network's lock: an SDO request for which no call waits has ended. */
void control_wake(struct managed *managed);

/* What happens to the bus, as a line; false for other events. */
bool control_bus_text(const struct network *network, const struct co_event *event, char *text,
                      size_t size);

/* The daemon, until its queue is closed; context: struct registry. */
void *control_run(void *context);

#endif

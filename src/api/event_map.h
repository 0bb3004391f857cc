/*
 * Events of the manager as the application gets them.
 */
#ifndef CO_API_EVENT_MAP_H
#define CO_API_EVENT_MAP_H

#include "base/outbox.h"
#include "manager/network_config.h"
#include "mcanopen.h"

#define EVENT_MAP_MAX 3u

/* Writes 0..EVENT_MAP_MAX events for one of the manager's; their number. */
unsigned event_map(const struct network_config *config, const struct co_event *event,
                   EVENT_T ret_events[EVENT_MAP_MAX]);

#endif

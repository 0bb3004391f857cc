/*
 * What the manager reports, as lines for people: who, what, expected, actual, and what to do about
 * it.
 *
 *   in   events of the manager, the configuration
 *   out  text; nothing is decided here
 */
#ifndef CO_MANAGER_BOOT_TEXT_H
#define CO_MANAGER_BOOT_TEXT_H

#include "base/report.h"
#include "manager/boot_node.h"

#include <stddef.h>

#define BOOT_TEXT_SIZE 320u

/* "node 5 "pump": boot error D: ..."; false: the event is nothing to be told. */
bool boot_text_event(const struct network_config *config, const struct co_event *event,
                     enum co_severity *ret_severity, char *text, size_t size);

/*
 * What went wrong in the last attempt, or what the node's step waits for; without the node's name.
 */
void boot_text_node(const struct boot_node *node, char *text, size_t size);

/* What went wrong in an attempt, likewise; "" where nothing has. */
void boot_text_failure(const struct node_config *config, const struct boot_failure *failure,
                       char *text, size_t size);

#endif

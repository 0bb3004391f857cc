/*
 * Configuration over the network: what other tools write to the manager's dictionary, and what that
 * means for the boots that run.
 *
 *   in   SLAVE_VERDICT, SLAVE_FETCH and SLAVE_WRITTEN of the manager's device
 *   out  the changed configuration, the answers; boots begun anew; MANAGER_CONFIG_REFUSED
 *
 * A write changes the configuration whole, or not at all. A node in the middle of its boot begins
 * it anew, so that no boot sees two configurations; one that has booted goes on as it is until its
 * next boot. At once counts only what makes a node part of the network (1F81h bits 0 and 2: it is
 * booted; without bit 0 it is left alone) and bit 3 (mandatory). 1F80h and 1F89h wait for the next
 * boot of the network.
 *
 * 1F25h asks for a node's configuration to be written to it, as it is now: one that runs leaves
 * the state operational for that time; one that has failed is booted anew.
 *
 * Parts of the manager, on its struct; nobody else calls them.
 */
#ifndef CO_MANAGER_CONFIG_WRITE_H
#define CO_MANAGER_CONFIG_WRITE_H

#include "manager/manager.h"

/* A value for an object of the configuration has come: the answer says whether it was taken. */
void config_write_on_verdict(struct manager *self, const struct co_event *event, co_us_t now);
/* A domain of the configuration is read. */
void config_write_on_fetch(struct manager *self, const struct co_event *event, co_us_t now);
/* The device has taken a value for itself: resets keep it. */
void config_write_on_written(struct manager *self, const struct co_event *event);

#endif

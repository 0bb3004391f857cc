/*
 * What a node's configuration has of bytes, as objects of the manager's dictionary (CiA 302-3):
 * 1F20h (text of a DCF), 1F22h (concise DCF), 1F58h (program).
 *
 *   in   a node's configuration; bytes that other tools of the network write
 *   out  what the objects say; a changed node, or the abort code of the refusal, and what was wrong
 *
 * 1F20h and 1F22h are two ways to write one configuration: a text becomes the concise DCF that is
 * read at 1F22h; a concise DCF that is written ends the text. A text has no way to files.
 */
#ifndef CO_MANAGER_CONFIG_DOMAINS_H
#define CO_MANAGER_CONFIG_DOMAINS_H

#include "manager/network_config.h"
#include "slave/slave.h"

#define CONFIG_DOMAIN_MAX (1u << 20) /* most bytes of one */

/* Adds them to a dictionary, for each node. CO_ERR_MEMORY, CO_ERR_EXISTS */
enum co_err config_domains_fill(struct od *od);

bool config_is_domain(uint16_t index);
/* True for those that are what is written to the device: not its program. */
bool config_is_configuration(uint16_t index);

/* node NULL: one without configuration. The bytes are the node's. */
struct slave_value config_domain_of_node(uint16_t index, const struct node_config *node);

/*
 * Makes the node one with these bytes. What it had before is not freed: *node is a copy, and when
 * it has taken the place of the other one, that one is for config_domain_free().
 */
sdo_abort_t config_domain_set_node(uint16_t index, const struct network_config *config,
                                   struct node_config *node, const struct slave_value *value,
                                   struct co_report *report);
void config_domain_free(uint16_t index, const struct node_config *replaced);

#endif

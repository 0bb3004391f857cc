/*
 * What can be wrong with the elements of a configuration file together, each of them being right.
 *
 * Internal to network_config.
 */
#ifndef CO_MANAGER_NETWORK_CONFIG_CHECK_H
#define CO_MANAGER_NETWORK_CONFIG_CHECK_H

#include "manager/network_config.h"
#include "manager/network_config_elements.h"

/* Where numbers that must not be given twice stand; 0: not given. */
struct unique_lines {
    unsigned nets[UINT8_MAX + 1];
    unsigned nodes[NETWORK_NODE_MAX + 1]; /* of the present network */
};

void check_mandatory(const struct element_table *table, const struct element_lines *lines,
                     unsigned line, struct faults *faults);
void check_node(const struct node_config *config, const struct element_lines *lines,
                struct unique_lines *unique, struct faults *faults);
/* After its nodes. */
void check_network(const struct network_config *config, const struct element_lines *lines,
                   struct unique_lines *unique, struct faults *faults);

#endif

/*
 * A manager's configuration from its files: the XML file, and for each node its DCF or CCF.
 *
 *   in   paths
 *   out  networks ready for the manager, or all that is wrong, and the code for it
 */
#ifndef CO_API_LOAD_H
#define CO_API_LOAD_H

#include "base/report.h"
#include "dcf/dcf.h"
#include "manager/network_config.h"

/* Warnings about a file are one message with their number. */
extern const struct co_rule load_file_warnings;

/*
 * Returns MCANOPEN_OK or an error code of mcanOpenConfig(). report->file is set here; its sink gets
 * every message, first_error has the first one.
 */
int load_networks(const char *path, struct co_report *report, struct network_config **ret_networks,
                  size_t *ret_count);

/*
 * Its two steps, for those who go on after errors: the XML file, and then what a node's files give
 * into 'node'. *ret_dcf, unless NULL, becomes what the DCF file says, also where the manager
 * refuses it for this node; it is left as it is where there is none that can be read.
 */
int load_xml(const char *path, struct co_report *report, struct network_config **ret_networks,
             size_t *ret_count);
int load_node(const char *xml_path, const struct network_config *config, struct node_config *node,
              struct co_report *report, struct dcf *ret_dcf);

/* One EDS or DCF file. An error code of mcanOpenConfig(); messages as above. */
int load_dcf(const char *path, struct co_report *report, struct dcf *ret_dcf);

/* The bus of a network: MCANOPEN_NET_<n> of the environment, <Interface>, or "can<n>". */
void load_bus_name(const struct network_config *config, char *name, size_t size);

#endif

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

/*
 * Returns MCANOPEN_OK or an error code of mcanOpenConfig(). report->file is set here; its sink gets
 * every message, first_error has the first one.
 */
int load_networks(const char *path, struct co_report *report, struct network_config **ret_networks,
                  size_t *ret_count);

/* One EDS or DCF file. An error code of mcanOpenConfig(); messages as above. */
int load_dcf(const char *path, struct co_report *report, struct dcf *ret_dcf);

/* The bus of a network: MCANOPEN_NET_<n> of the environment, <Interface>, or "can<n>". */
void load_bus_name(const struct network_config *config, char *name, size_t size);

#endif

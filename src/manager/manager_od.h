/*
 * The manager's own object dictionary, as its configuration describes it (CiA 302-2, 302-3).
 *
 *   in   the configuration of a network
 *   out  1000h..1018h of a CANopen device, and 1F26h..1F89h of a manager
 *
 * All of it can only be read: the XML file is the one place of the configuration. Objects with a
 * sub-index for each node have all 127 of them; those of nodes without configuration are 0.
 */
#ifndef CO_MANAGER_MANAGER_OD_H
#define CO_MANAGER_MANAGER_OD_H

#include "manager/network_config.h"
#include "od/od.h"

/*
 * Adds the objects to a dictionary that has none of them. CO_ERR_MEMORY, CO_ERR_EXISTS: the
 * dictionary then holds a part of them.
 */
enum co_err manager_od_fill(const struct network_config *config, struct od *od);

#endif

/*
 * The manager's own object dictionary, as its configuration describes it (CiA 302-2, 302-3).
 *
 *   in   the configuration of a network
 *   out  1000h..1028h of a CANopen device, and 1F20h..1F89h of a manager
 *
 * Objects with a sub-index for each node have all 127 of them; those of nodes without configuration
 * are 0. Of writes to 1F20h..1F89h the manager is told (SLAVE_VERDICT), who changes the
 * configuration (config_write.h), and what is read is what that says, see manager_od_refresh().
 * 1005h, 1006h and 1017h are the device's own, and keep what is written to them.
 */
#ifndef CO_MANAGER_MANAGER_OD_H
#define CO_MANAGER_MANAGER_OD_H

#include "manager/network_config.h"
#include "od/od.h"

#define REQUEST_NMT       0x1F82u
#define REQUEST_GUARDING  0x1F83u
#define REQUEST_CONFIGURE 0x1F25u
#define REQUEST_ALL_NODES 0x80u /* sub-index of 1F82h and 1F25h */

/*
 * Adds the objects to a dictionary that has none of them. CO_ERR_MEMORY, CO_ERR_EXISTS: the
 * dictionary then holds a part of them.
 */
enum co_err manager_od_fill(const struct network_config *config, struct od *od);

/* An entry is about to be read: it says what the configuration says now. */
void manager_od_refresh(const struct network_config *config, struct od *od, uint16_t index,
                        uint8_t sub);

#endif

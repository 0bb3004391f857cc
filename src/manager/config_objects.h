/*
 * The numbers of the configuration as objects of the manager's dictionary (CiA 302-2, 302-3).
 *
 *   in   a configuration; values that other tools of the network write
 *   out  what the objects say; a changed configuration, or the abort code of the refusal
 *
 * Nothing is kept here: an object says what the configuration says, whoever has changed it.
 */
#ifndef CO_MANAGER_CONFIG_OBJECTS_H
#define CO_MANAGER_CONFIG_OBJECTS_H

#include "manager/network_config.h"
#include "od/od.h"

#define CONFIG_STARTUP   0x1F80u
#define CONFIG_BOOT_TIME 0x1F89u

/* Adds them to a dictionary; it is to be told of each write. CO_ERR_MEMORY, CO_ERR_EXISTS */
enum co_err config_objects_fill(const struct network_config *config, struct od *od);

/* Brings the entry that is about to be read up to date; others are left alone. */
void config_objects_refresh(const struct network_config *config, struct od *od, uint16_t index,
                            uint8_t sub);

/* True for those with a value for each node, at its node-ID as sub-index. */
bool config_object_is_of_node(uint16_t index);
/* One of them. */
uint32_t config_object_of_node(uint16_t index, const struct node_config *node);
/* Changes the node, or nothing. */
sdo_abort_t config_object_set_node(uint16_t index, struct node_config *node, uint32_t value);

/* 1F80h, 1F89h. Changes the configuration, or nothing. */
sdo_abort_t config_object_set_network(uint16_t index, struct network_config *config,
                                      uint32_t value);

#endif

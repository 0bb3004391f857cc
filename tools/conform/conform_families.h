/*
 * The families of checks, each in files check_<family>*.c.
 */
#ifndef TOOLS_CONFORM_FAMILIES_H
#define TOOLS_CONFORM_FAMILIES_H

#include "conform.h"

extern const struct conform_family conform_eds;
extern const struct conform_family conform_sdo;
extern const struct conform_family conform_sdo_segment;
extern const struct conform_family conform_sdo_block_upload;
extern const struct conform_family conform_sdo_block_download;
extern const struct conform_family conform_sdo_channel;
extern const struct conform_family conform_od;
extern const struct conform_family conform_pdo_parameter;
extern const struct conform_family conform_pdo_mapping;
extern const struct conform_family conform_pdo_transmit;
extern const struct conform_family conform_pdo_receive;
extern const struct conform_family conform_emcy;
extern const struct conform_family conform_sync;
extern const struct conform_family conform_nmt_slave;
extern const struct conform_family conform_heartbeat;
extern const struct conform_family conform_guarding;
extern const struct conform_family conform_cob;
extern const struct conform_family conform_store;

#endif

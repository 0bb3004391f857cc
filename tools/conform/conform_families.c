#include "conform_families.h"

/* In the order in which they run. */
const struct conform_family *const conform_families[] = {
    &conform_eds,
    &conform_sdo,
    &conform_sdo_segment,
    &conform_sdo_block_upload,
    &conform_sdo_block_download,
    &conform_sdo_channel,
    &conform_od,
    &conform_pdo_parameter,
    &conform_pdo_mapping,
    &conform_pdo_transmit,
    &conform_pdo_receive,
    &conform_emcy,
    &conform_sync,
    &conform_nmt_slave,
    &conform_heartbeat,
    &conform_guarding,
    &conform_cob,
    &conform_store,
};

const size_t conform_family_count = sizeof conform_families / sizeof conform_families[0];

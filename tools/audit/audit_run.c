#include "audit.h"

static void (*const steps[])(struct audit_network *self) = {
    audit_collect_pdos,        audit_collect_uses,     audit_check_nodes,    audit_check_identity,
    audit_check_configuration, audit_check_heartbeats, audit_check_guarding, audit_check_can_ids,
    audit_check_sync,          audit_check_mapping,    audit_check_links,    audit_check_load,
    audit_check_boot_time,
};

bool audit_run(struct audit *self)
{
    for (size_t i = 0; i < self->count; i++) {
        struct audit_network *network = &self->networks[i];

        for (size_t k = 0; k < sizeof steps / sizeof steps[0] && !network->no_memory; k++)
            steps[k](network);
        if (network->no_memory)
            return false;
    }
    return true;
}

/* The manager's configuration file from any bytes: a message or a configuration, nothing else. */
#include "manager/network_config.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What a result must be; the caller of the parser relies on it. */
static void check(const struct network_config *networks, size_t count)
{
    if (count == 0 || count > NETWORK_INSTANCES)
        abort();
    for (size_t i = 0; i < count; i++) {
        if (networks[i].node_count > NETWORK_NODE_MAX || networks[i].baudrate == 0 ||
            networks[i].manager_node_id == 0 || networks[i].manager_node_id > NETWORK_NODE_MAX)
            abort();
        for (size_t n = 0; n < networks[i].node_count; n++)
            if (network_config_node(&networks[i], networks[i].nodes[n].node_id) !=
                    &networks[i].nodes[n] ||
                networks[i].nodes[n].sdo_timeout == 0)
                abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct co_report report = { .file = "fuzz.xml" };
    struct network_config *networks = NULL;
    size_t count = 0;
    enum co_err err = network_config_parse((const char *)data, size, &report, &networks, &count);

    if ((err == CO_OK) != (report.errors == 0) || (err == CO_OK) != (networks != NULL))
        abort();
    if (err == CO_OK)
        check(networks, count);
    if (report.errors + report.warnings > NETWORK_MESSAGES + 1)
        abort();
    network_config_free(networks, count);
    return 0;
}

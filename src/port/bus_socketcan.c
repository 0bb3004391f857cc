/* SocketCAN interfaces: not there yet, and refused with a message that says so. */
#include "port/bus_ops.h"

enum co_err bus_socketcan_open(const char *name, const struct bus_options *options,
                               struct bus **ret_bus, const struct bus_message *message)
{
    (void)options;
    (void)ret_bus;
    return bus_fail(message, CO_ERR_NO_BUS,
                    "%s: CAN interfaces are not supported yet; \"virtual:NAME\" needs none", name);
}

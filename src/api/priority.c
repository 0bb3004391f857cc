#include "api/priority.h"

#include "runtime/network.h"

static int native_of(const struct network_config *config, int value)
{
    return config->native_priorities ? value : thread_native_priority(value);
}

static int highest_of(const int16_t *values, unsigned count)
{
    int highest = 0;

    for (unsigned i = 0; i < count; i++)
        if (values[i] > highest)
            highest = values[i];
    return highest;
}

int priority_of_protocol(const struct network_config *config)
{
    int manager = highest_of(config->manager_priorities, 3);
    int slaves = highest_of(config->slave_priorities, 4);

    if (!config->has_manager_priorities && !config->has_slave_priorities)
        return 0;
    return native_of(config, manager > slaves ? manager : slaves); /* all 0 where not given */
}

int priority_of_control(const struct network_config *config)
{
    return config->has_manager_priorities ? native_of(config, config->manager_priorities[0]) : 0;
}

bool priority_of_slaves(const struct network_config *config, int native[PRIOS])
{
    static const unsigned places[PRIOS] = {
        [PRIO_NMT] = 0, [PRIO_PDO] = 1, [PRIO_SDO] = 2, [PRIO_EMCY] = 3
    };

    if (!config->has_slave_priorities)
        return false;
    for (unsigned i = 0; i < PRIOS; i++)
        native[i] = native_of(config, config->slave_priorities[places[i]]);
    return true;
}

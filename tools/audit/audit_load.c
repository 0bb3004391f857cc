/* How much of the bus is taken by what is sent without being asked for. */
#include "audit.h"

#define LONG_ID      0x20000000u
#define PER_SECOND   1000000000ull /* thousandths of a bit in a second, for one in a microsecond */
#define PDO_SIZE_MAX 8u

unsigned audit_frame_bits(bool is_long, unsigned size, bool stuffed)
{
    const unsigned bits = (is_long ? 67 : 47) + 8 * size;
    const unsigned most = ((is_long ? 53 : 33) + 8 * size) / 4;

    return stuffed ? bits + most : bits;
}

/* One frame in each period, us. */
static uint64_t rate_of(uint32_t can_id, unsigned size, uint64_t period)
{
    return period == 0
               ? 0
               : audit_frame_bits((can_id & LONG_ID) != 0, size, true) * PER_SECOND / period;
}

static void add(struct audit_load *self, uint64_t rate)
{
    self->cyclic += rate;
    self->most += rate;
}

/* Not more often than its inhibit time lets it, or at each SYNC. */
static uint64_t least_period(const struct audit_pdo *pdo, uint64_t period)
{
    if (pdo->has_type && pdo->type == 0)
        return pdo->node->network->load.sync_period;
    if (pdo->has_type && pdo->type >= 254 && pdo->inhibit_time != 0 &&
        (period == 0 || pdo->inhibit_time < period))
        return pdo->inhibit_time;
    return period;
}

static void add_pdo(struct audit_load *self, const struct audit_pdo *pdo)
{
    const unsigned bytes = (pdo->bits + 7) / 8;
    const unsigned size = pdo->is_mapped && bytes < PDO_SIZE_MAX ? bytes : PDO_SIZE_MAX;
    const uint64_t period = audit_pdo_period(pdo), least = least_period(pdo, period);

    self->cyclic += rate_of(pdo->cob_id, size, period);
    self->most += rate_of(pdo->cob_id, size, least);
    if (!pdo->has_type || (pdo->type >= 254 && pdo->inhibit_time == 0))
        self->unbounded++;
}

static void add_node(struct audit_load *self, const struct audit_node *node)
{
    const int32_t heartbeat = audit_heartbeat_time(node);

    if (heartbeat > 0)
        add(self, rate_of(0, 1, (uint64_t)heartbeat * 1000));
    else if (audit_is_guarded(node))
        add(self, rate_of(0, 0, node->config->guard_time * 1000ull) +
                      rate_of(0, 1, node->config->guard_time * 1000ull));
    self->unknown += !audit_is_known(node);
}

static void add_sync(struct audit_load *self, const struct audit_use *sync)
{
    const bool counts = sync->node && audit_number(sync->node, 0x1019, 0, 0) != 0;

    add(self, rate_of(sync->can_id, counts, self->sync_period));
}

void audit_check_load(struct audit_network *self)
{
    const struct network_config *config = self->config;
    const uint64_t bus = config->baudrate * 1000000ull; /* thousandths of a bit in a second */
    const struct audit_use *sync = audit_find_sync(self);
    struct audit_load *load = &self->load;

    add(load, rate_of(0, 1, config->heartbeat_producer_time * 1000ull));
    if (sync)
        add_sync(load, sync);
    for (size_t i = 0; i < self->node_count; i++)
        add_node(load, &self->nodes[i]);
    for (size_t i = 0; i < self->producer_count; i++)
        add_pdo(load, self->producers[i]);
    if (load->cyclic > bus)
        audit_tell(self, audit_network_place(self, "Baudrate"), AUDIT_RULE_BUS_OVERLOAD,
                   "timers and SYNC ask for %lu %% of the bus at %u kbit/s: less than 100 expected",
                   (unsigned long)(load->cyclic * 100 / bus), config->baudrate);
    else if (load->cyclic * 10 > bus * 7)
        audit_tell(self, audit_network_place(self, "Baudrate"), AUDIT_RULE_BUS_LOAD,
                   "timers and SYNC take %lu %% of the bus at %u kbit/s: at most 70 expected",
                   (unsigned long)(load->cyclic * 100 / bus), config->baudrate);
}

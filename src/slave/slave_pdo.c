#include "slave/slave_pdo.h"

#include "slave/slave_internal.h"

/* Not yet. */
void slave_pdo_set_flags(struct slave *self, enum pdo_direction direction, uint16_t number,
                         uint8_t flags)
{
    (void)self, (void)direction, (void)number, (void)flags;
}

struct rpdo *slave_rpdo(const struct slave *self, uint16_t number)
{
    (void)self, (void)number;
    return NULL;
}

struct tpdo *slave_tpdo(const struct slave *self, uint16_t number)
{
    (void)self, (void)number;
    return NULL;
}

enum co_err slave_pdo_send(struct slave *self, uint16_t number, co_us_t now, struct co_outbox *out)
{
    (void)self, (void)number, (void)now, (void)out;
    return CO_ERR_ARG;
}

enum co_err slave_entry_changed(struct slave *self, struct od_entry *entry, co_us_t now,
                                struct co_outbox *out)
{
    (void)self, (void)entry, (void)now, (void)out;
    return CO_OK;
}

bool slave_entry_is_sent(const struct slave *self, const struct od_entry *entry)
{
    (void)self, (void)entry;
    return false;
}

void slave_hold_transmission(struct slave *self, bool hold, co_us_t now, struct co_outbox *out)
{
    (void)self, (void)hold, (void)now, (void)out;
}

void slave_tpdo_answer(struct slave *self, uint16_t number, uint32_t ask, co_us_t now,
                       struct co_outbox *out)
{
    (void)self, (void)number, (void)ask, (void)now, (void)out;
}

enum co_err slave_rpdo_request(struct slave *self, uint16_t number, co_us_t now,
                               struct co_outbox *out)
{
    (void)self, (void)number, (void)now, (void)out;
    return CO_ERR_ARG;
}

unsigned slave_listens(const struct slave *self, struct slave_filter *ret_filters, unsigned max)
{
    (void)self, (void)ret_filters, (void)max;
    return 0;
}

void slave_sync_plan(const struct slave *self, struct slave_sync_plan *ret_plan)
{
    (void)self;
    *ret_plan = (struct slave_sync_plan){ .active = false };
}

void slave_sync_external(struct slave *self, bool external)
{
    (void)self, (void)external;
}

sdo_abort_t slave_check_mapped(const struct od *od, uint32_t mapping_entry, bool transmit)
{
    (void)od, (void)mapping_entry, (void)transmit;
    return SDO_NOT_MAPPABLE;
}

void slave_verdict(struct slave *self, uint32_t number, sdo_abort_t code, co_us_t now,
                   struct co_outbox *out)
{
    (void)self, (void)number, (void)code, (void)now, (void)out;
}

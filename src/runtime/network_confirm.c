/*
 * When the SDO requests of managers are on the wire. They do not come back: that would cost each of
 * them as much as its answer. So the bus is asked, now and then, for those that have no answer yet.
 */
#include "runtime/network_internal.h"

#include "proto/sdo_client.h"

/* What a time-out may be late. Long enough for a controller whose frames nobody acknowledges to say
 * that it is error passive, at 125 kbit/s. */
#define LOOK CO_MS(20)

static bool is_request(const struct co_frame *frame)
{
    return frame->flags == 0 && (frame->id & ~0x7Fu) == SDO_REQUEST_ID;
}

void network_expect(struct network *self, const struct device *device, const struct co_frame *frame)
{
    if (device->manager && self->look == CO_NEVER && is_request(frame))
        self->look = self->now + LOOK;
}

/* An error passive controller may have frames for as long as it likes. */
bool network_returns_requests(const struct network *self)
{
    return self->bus_state >= BUS_PASSIVE;
}

static void confirm(struct network *self, struct manager *manager, unsigned backlog, co_us_t now)
{
    if (!manager_awaits_wire(manager))
        return;
    if (backlog == 0 && !network_returns_requests(self)) {
        manager_on_handed_over(manager, now);
        return;
    }
    if (backlog != self->backlog)
        manager_on_progress(manager, now);
    self->look = now + LOOK;
}

/* A request that was lost has not left: all that wait are left to their time. */
static bool has_lost(struct network *self)
{
    bool is_new = self->losses != self->tx.losses;

    self->losses = self->tx.losses;
    return is_new;
}

void network_confirm(struct network *self, co_us_t now)
{
    unsigned backlog;

    if (now < self->look)
        return;
    self->look = CO_NEVER;
    if (has_lost(self))
        return;
    backlog = self->tx.count + self->sender_away + bus_backlog(self->bus);
    for (unsigned i = 0; i < self->device_count; i++)
        if (self->devices[i].manager)
            confirm(self, self->devices[i].manager, backlog, now);
    self->backlog = backlog;
}

/* What the bus lets through to the devices, and SYNC that the kernel sends for one of them. */
#include "runtime/network_internal.h"

#include "proto/sdo_client.h"

static const struct bus_filter everything = { .mask = 0 };

/* A manager listens to ranges: NMT, emergencies and SYNC, answers of SDO servers, error control
 * with the requests of guarding. */
static const struct bus_filter of_manager[] = {
    { 0x000, 0x7FF, 0, CO_FRAME_EXT | CO_FRAME_RTR },
    { 0x080, 0x780, 0, CO_FRAME_EXT | CO_FRAME_RTR },
    { 0x580, 0x780, 0, CO_FRAME_EXT | CO_FRAME_RTR },
    { 0x700, 0x780, 0, CO_FRAME_EXT },
};

static bool is_same(const struct bus_filter *a, const struct bus_filter *b)
{
    return a->id == b->id && a->mask == b->mask && a->flags == b->flags &&
           a->flags_mask == b->flags_mask;
}

static void add(struct filters *self, const struct bus_filter *filter)
{
    for (unsigned i = 0; i < self->count; i++)
        if (is_same(&self->list[i], filter))
            return;
    if (self->count < FILTERS_MAX)
        self->list[self->count++] = *filter;
    else
        self->too_many = true;
}

static void add_slave(struct network *network, const struct slave *slave)
{
    struct filters *self = &network->filters;
    const struct slave_filter *wanted = network->wanted;
    const unsigned count = slave_listens(slave, network->wanted, FILTERS_MAX);

    self->too_many |= count > FILTERS_MAX;
    for (unsigned i = 0; i < count && !self->too_many; i++) {
        struct bus_filter filter = { .id = wanted[i].id,
                                     .flags_mask = CO_FRAME_EXT | CO_FRAME_RTR };

        filter.mask = wanted[i].ext ? 0x1FFFFFFF : 0x7FF;
        filter.flags = (uint8_t)((wanted[i].ext ? CO_FRAME_EXT : 0u) |
                                 (wanted[i].rtr ? CO_FRAME_RTR : 0u));
        add(self, &filter);
    }
}

/* And to what its own device does; to all SDO requests, where its own are to come back. */
static void add_manager(struct network *self, const struct device *device)
{
    static const struct bus_filter requests = { SDO_REQUEST_ID, 0x780, 0,
                                                CO_FRAME_EXT | CO_FRAME_RTR };

    for (size_t i = 0; i < sizeof of_manager / sizeof of_manager[0]; i++)
        add(&self->filters, &of_manager[i]);
    if (network_returns_requests(self))
        add(&self->filters, &requests);
    add_slave(self, &device->manager->device);
}

static void add_device(struct network *self, const struct device *device)
{
    if (device->manager)
        add_manager(self, device);
    else if (device->slave)
        add_slave(self, device->slave);
}

/* A device alone that does not wait for its frames to be sent is spared their return. */
static bool wants_own_frames(const struct network *self)
{
    unsigned present = 0;

    for (unsigned i = 0; i < self->device_count; i++) {
        const struct device *device = &self->devices[i];

        if (device->manager || (device->slave && slave_wants_own_frames(device->slave)))
            return true;
        present += device->slave != NULL;
    }
    return present > 1;
}

enum co_err network_listen(struct network *self)
{
    struct filters *filters = &self->filters;
    enum co_err err;

    filters->count = 0;
    filters->too_many = false;
    for (unsigned i = 0; i < self->device_count; i++)
        add_device(self, &self->devices[i]);
    if (filters->count == 0) /* nobody is there */
        add(filters, &of_manager[0]);
    err = filters->too_many ? bus_set_filters(self->bus, &everything, 1)
                            : bus_set_filters(self->bus, filters->list, filters->count);
    if (err == CO_OK)
        err = bus_set_own_frames(self->bus, wants_own_frames(self));
    return err;
}

/* ---- SYNC ---- */

static void end_cyclic(struct network *self, const struct device *device)
{
    if (self->cyclic_node != device->node)
        return;
    self->cyclic_node = 0;
    bus_set_cyclic(self->bus, NULL, 0, 0);
}

static enum co_err begin_cyclic(struct network *self, const struct slave_sync_plan *plan)
{
    struct co_frame frames[BUS_CYCLIC_MAX];
    const unsigned count = plan->overflow > 0 ? plan->overflow : 1;

    for (unsigned i = 0; i < count; i++) {
        frames[i] = co_frame_make(plan->cob_id, plan->overflow > 0 ? 1 : 0);
        frames[i].flags = plan->ext ? CO_FRAME_EXT : 0;
        frames[i].data[0] = (uint8_t)(plan->overflow > 0 ? i + 1 : 0);
    }
    return bus_set_cyclic(self->bus, frames, count, plan->period);
}

/* The kernel sends for one device, others do it themselves, and all where it cannot. */
static void follow_sync(struct network *self, const struct device *device, struct slave *slave)
{
    struct slave_sync_plan plan;
    bool external = false;

    slave_sync_plan(slave, &plan);
    if (!plan.active) {
        end_cyclic(self, device);
    } else if (self->cyclic_node == 0 || self->cyclic_node == device->node) {
        external = begin_cyclic(self, &plan) == CO_OK;
        self->cyclic_node = external ? device->node : 0;
    }
    slave_sync_external(slave, external);
}

static struct slave *slave_of(const struct device *device)
{
    return device->manager ? &device->manager->device : device->slave;
}

void network_follow(struct network *self, struct device *device)
{
    const struct slave *slave = slave_of(device);

    if (!slave)
        return;
    if (slave->sync_generation != device->sync_seen)
        end_cyclic(self, device);
    if (slave->listen_generation != device->listen_seen) {
        device->listen_seen = slave->listen_generation;
        network_listen(self);
    }
}

void network_follow_sync(struct network *self, struct device *device)
{
    struct slave *slave = slave_of(device);

    if (!slave || slave->sync_generation == device->sync_seen)
        return;
    device->sync_seen = slave->sync_generation;
    follow_sync(self, device, slave);
}

enum co_err network_forget(struct network *self, struct device *device)
{
    end_cyclic(self, device);
    return network_listen(self);
}

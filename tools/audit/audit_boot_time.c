/* How long the requests take that the manager sends while it boots the network. */
#include "audit.h"

#define SEGMENT   7u
#define BLOCK     127u /* segments, as most devices want them */
#define EXPEDITED 4u

struct cost {        /* of booting one node */
    uint64_t frames; /* of 8 bytes */
    uint64_t answers;
    uint64_t wait; /* us, besides */
};

static void ask(struct cost *self, uint64_t requests)
{
    self->frames += 2 * requests;
    self->answers += requests;
}

static void add_write(struct cost *self, const struct node_config *config, uint32_t size)
{
    const uint64_t segments = ((uint64_t)size + SEGMENT - 1) / SEGMENT;

    if (size <= EXPEDITED) {
        ask(self, 1);
    } else if (config->sdo_block_size == 0) {
        ask(self, 1 + segments);
    } else {
        ask(self, 2); /* initiate, end */
        self->frames += segments + (segments + BLOCK - 1) / BLOCK;
        self->answers += (segments + BLOCK - 1) / BLOCK;
    }
}

static void add_identity(struct cost *self, const struct node_config *config)
{
    ask(self, 1u + (config->vendor_id != 0) + (config->product_code != 0) +
                  (config->revision_number != 0) + (config->serial_number != 0) +
                  config->verify_software);
}

/* As if nothing of it were there: all is written. */
static void add_configuration(struct cost *self, const struct audit_node *node)
{
    const struct node_config *config = node->config;
    struct ccf_reader reader;
    struct ccf_entry entry;

    if (ccf_count(&config->ccf) == 0)
        return;
    if (audit_number(node, 0x1020, 1, 0) != 0 || config->configuration_date != 0)
        ask(self, 2);
    ccf_reader_init(&reader, &config->ccf);
    while (ccf_read(&reader, &entry)) {
        if (config->verify_configuration)
            add_write(self, config, entry.size); /* reading takes what writing does */
        add_write(self, config, entry.size);
    }
    ask(self, (unsigned)config->save_configuration + (config->restore_sub != 0));
    if (config->restore_sub != 0)
        self->wait += config->boot_delay * 1000ull;
}

static void add_heartbeat(struct cost *self, const struct audit_node *node)
{
    const int32_t time = audit_heartbeat_time(node);

    if (node->config->consumer_heartbeat_time != 0 && time > 0)
        self->wait += (uint64_t)time * 1000;
}

static uint64_t larger(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

static uint64_t wire_time(const struct audit_network *self, uint64_t frames, bool stuffed)
{
    return frames * audit_frame_bits(false, 8, stuffed) * 1000 / self->config->baudrate;
}

static void add_node(struct audit_network *self, const struct audit_node *node, uint64_t *frames)
{
    struct audit_boot *boot = &self->boot;
    struct cost cost = { .frames = 0 };
    uint64_t least, likely;

    add_identity(&cost, node->config);
    add_configuration(&cost, node);
    least = wire_time(self, cost.frames, false);
    add_heartbeat(&cost, node);
    likely = wire_time(self, cost.frames, true) + cost.answers * AUDIT_ANSWER_TIME + cost.wait;
    *frames += cost.frames;
    boot->requests += (unsigned)cost.answers;
    boot->least = larger(boot->least, least);
    boot->likely = larger(boot->likely, likely);
    if (node->config->mandatory) {
        boot->least_mandatory = larger(boot->least_mandatory, least);
        boot->likely_mandatory = larger(boot->likely_mandatory, likely);
    }
}

static void compare(const struct audit_network *self)
{
    const struct audit_boot *boot = &self->boot;
    const uint64_t limit = self->config->boot_time * 1000ull;
    const struct audit_place place = audit_network_place(self, "Boot_Time");

    if (limit == 0)
        return;
    if (boot->least_mandatory > limit)
        audit_tell(self, place, AUDIT_RULE_BOOT_TIME,
                   "Boot_Time: %u ms, but the requests to the mandatory nodes take %lu ms on the "
                   "wire alone",
                   (unsigned)self->config->boot_time,
                   (unsigned long)(boot->least_mandatory / 1000));
    else if (boot->likely_mandatory > limit)
        audit_tell(self, place, AUDIT_RULE_BOOT_TIME_MARGIN,
                   "Boot_Time: %u ms, but the mandatory nodes are estimated to take %lu ms",
                   (unsigned)self->config->boot_time,
                   (unsigned long)(boot->likely_mandatory / 1000));
}

/* All nodes are booted at the same time: the slowest one counts, unless the bus is. */
void audit_check_boot_time(struct audit_network *self)
{
    struct audit_boot *boot = &self->boot;
    uint64_t frames = 0;

    for (size_t i = 0; i < self->node_count; i++)
        if (self->config->nmt_master && self->nodes[i].config->nmt_slave &&
            self->nodes[i].config->auto_start_slave)
            add_node(self, &self->nodes[i], &frames);
    boot->least = larger(boot->least, wire_time(self, frames, false));
    boot->likely = larger(boot->likely, wire_time(self, frames, true));
    if (boot->likely_mandatory != 0)
        boot->likely_mandatory = larger(boot->likely_mandatory, wire_time(self, frames, true));
    compare(self);
}

/* Heartbeats: who waits for whom, and for how long. */
#include "audit.h"

#define CONSUMERS_MAX 127u

struct watch { /* somebody waits for heartbeats */
    const struct audit_network *network;
    struct audit_place place;
    struct audit_label consumer;
    unsigned consumer_time; /* ms */
    struct audit_label producer;
    unsigned producer_time;
    const char *consequence;
};

static void compare_times(const struct watch *self)
{
    if (self->consumer_time <= self->producer_time)
        audit_tell(self->network, self->place, AUDIT_RULE_HEARTBEAT_TIME,
                   "%s waits %u ms for the heartbeat of %s, which comes each %u ms only: %s",
                   self->consumer.text, self->consumer_time, self->producer.text,
                   self->producer_time, self->consequence);
    else if (self->consumer_time * 2 < self->producer_time * 3)
        audit_tell(self->network, self->place, AUDIT_RULE_HEARTBEAT_MARGIN,
                   "%s waits %u ms for the heartbeat of %s, which comes each %u ms: at least %u ms "
                   "(1.5 times) expected, for one that is late",
                   self->consumer.text, self->consumer_time, self->producer.text,
                   self->producer_time, (self->producer_time * 3 + 1) / 2);
}

/* --- the manager waits --- */

static void check_manager_waits(const struct audit_node *self)
{
    const int32_t time = audit_heartbeat_time(self);
    struct watch watch = { .network = self->network,
                           .place = audit_node_place(self, "Consumer_Heartbeat_Time"),
                           .consumer = { "the manager" },
                           .consumer_time = self->config->consumer_heartbeat_time,
                           .producer = audit_label(self),
                           .producer_time = time > 0 ? (unsigned)time : 0,
                           .consequence = "the node will be lost again and again" };

    if (watch.consumer_time == 0 || !self->config->nmt_slave || time < 0)
        return;
    if (time > 0)
        compare_times(&watch);
    else
        audit_tell(self->network, audit_entry_place(self, 0x1017, 0), AUDIT_RULE_NO_HEARTBEAT,
                   "%s sends no heartbeat (1017h %s), but the manager waits %u ms for it "
                   "(Consumer_Heartbeat_Time, %s:%u): boot error K",
                   watch.producer.text, audit_has(self, 0x1017, 0) ? "is 0" : "is not there",
                   watch.consumer_time, watch.place.file, watch.place.line);
}

/* --- a node waits --- */

static void name_manager(const struct audit_network *self, struct watch *watch)
{
    watch->producer = (struct audit_label){ "the manager" };
    watch->producer_time = self->config->heartbeat_producer_time;
}

/* False: it is not known who that is, or how often. */
static bool find_producer(const struct audit_network *self, unsigned id, struct watch *watch)
{
    const struct audit_node *producer = audit_find_node(self, id);
    int32_t time;

    if (id == self->config->manager_node_id) {
        name_manager(self, watch);
        return true;
    }
    if (!producer) {
        audit_tell(self, watch->place, AUDIT_RULE_HEARTBEAT_NODE,
                   "%s waits for heartbeats of node %u, which is not in the network",
                   watch->consumer.text, id);
        return false;
    }
    time = audit_heartbeat_time(producer);
    watch->producer = audit_label(producer);
    watch->producer_time = time > 0 ? (unsigned)time : 0;
    return time >= 0;
}

static void check_consumer(const struct audit_node *self, uint8_t sub,
                           const struct audit_value *value)
{
    const unsigned id = value->number >> 16 & 0xFF;
    struct watch watch = { .network = self->network,
                           .place = value->place,
                           .consumer = audit_label(self),
                           .consumer_time = value->number & UINT16_MAX,
                           .consequence = "it will report the loss (8130h) again and again" };

    if (id == self->config->node_id) {
        audit_tell(self->network, value->place, AUDIT_RULE_HEARTBEAT_NODE,
                   "%s waits for its own heartbeat (1016h:%02X)", watch.consumer.text, sub);
        return;
    }
    if (!find_producer(self->network, id, &watch))
        return;
    if (watch.producer_time > 0)
        compare_times(&watch);
    else
        audit_tell(self->network, value->place, AUDIT_RULE_HEARTBEAT_SILENT,
                   "%s waits for heartbeats of %s (1016h:%02X), which sends none: %s",
                   watch.consumer.text, watch.producer.text, sub,
                   id == self->network->config->manager_node_id
                       ? "Heartbeat_Producer_Time is not given"
                       : "its 1017h is 0");
}

/* A device refuses a second entry for a node. */
static void check_consumers(const struct audit_node *self)
{
    uint8_t seen[UINT8_MAX + 1] = { 0 };

    for (uint8_t sub = 1; sub <= CONSUMERS_MAX; sub++) {
        const struct audit_value value = audit_value(self, 0x1016, sub);
        const unsigned id = value.number >> 16 & 0xFF;

        if (!value.known || id == 0 || (value.number & UINT16_MAX) == 0)
            continue;
        if (seen[id] != 0)
            audit_tell(self->network, value.place, AUDIT_RULE_HEARTBEAT_TWICE,
                       "%s: 1016h:%02X waits for node %u as 1016h:%02X does: the device refuses "
                       "that (06040043h)",
                       audit_label(self).text, sub, id, seen[id]);
        else
            check_consumer(self, sub, &value);
        seen[id] = sub;
    }
}

void audit_check_heartbeats(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++) {
        check_manager_waits(&self->nodes[i]);
        check_consumers(&self->nodes[i]);
    }
}

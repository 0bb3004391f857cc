/* Node guarding and life guarding. */
#include "audit.h"

bool audit_is_guarded(const struct audit_node *self)
{
    const struct node_config *config = self->config;

    return config->nmt_slave && config->consumer_heartbeat_time == 0 && config->guard_time != 0 &&
           config->life_time_factor != 0;
}

static void check_master(const struct audit_node *self)
{
    const struct node_config *config = self->config;
    const int32_t heartbeat = audit_heartbeat_time(self);

    if ((config->guard_time != 0) != (config->life_time_factor != 0))
        audit_tell(self->network,
                   audit_node_place(self, config->guard_time ? "Guard_Time" : "Life_Time_Factor"),
                   AUDIT_RULE_GUARDING_OFF, "%s is not guarded: %s is 0, or not given",
                   audit_label(self).text, config->guard_time ? "Life_Time_Factor" : "Guard_Time");
    if (audit_is_guarded(self) && heartbeat > 0)
        audit_tell(self->network, audit_node_place(self, "Guard_Time"),
                   AUDIT_RULE_GUARDING_HEARTBEAT,
                   "%s is to be guarded, but sends heartbeats (1017h is %d ms, %s:%u): it does not "
                   "answer to guarding, and will be lost; give Consumer_Heartbeat_Time instead",
                   audit_label(self).text, (int)heartbeat, audit_entry_place(self, 0x1017, 0).file,
                   audit_entry_place(self, 0x1017, 0).line);
}

/* Default values that nobody has chosen are not worth a word. */
static void check_slave(const struct audit_node *self)
{
    const struct audit_value time = audit_value(self, 0x100C, 0);
    const struct audit_value factor = audit_value(self, 0x100D, 0);
    const struct audit_value *given = time.written ? &time : &factor;
    const uint64_t life_time = time.number * factor.number;

    if (!time.known || !factor.known)
        return;
    if ((time.written || factor.written) && (time.number != 0) != (factor.number != 0))
        audit_tell(self->network, given->place, AUDIT_RULE_GUARDING_OFF,
                   "%s has no life guarding: 100Ch is %u ms, 100Dh is %u, one of them is 0",
                   audit_label(self).text, (unsigned)time.number, (unsigned)factor.number);
    if (life_time == 0)
        return;
    if (!audit_is_guarded(self)) {
        if (time.written || factor.written)
            audit_tell(self->network, given->place, AUDIT_RULE_LIFE_GUARDING,
                       "%s has a life time of %lu ms (100Ch, 100Dh), but the manager does not "
                       "guard it: it will not notice a loss of the manager",
                       audit_label(self).text, (unsigned long)life_time);
    } else if (life_time <= self->config->guard_time) {
        audit_tell(
            self->network, given->place, AUDIT_RULE_LIFE_TIME,
            "%s has a life time of %lu ms (100Ch, 100Dh), but is guarded each %u ms only: it "
            "will report the loss of the manager again and again",
            audit_label(self).text, (unsigned long)life_time, self->config->guard_time);
    }
}

static void check_supervision(const struct audit_node *self)
{
    const struct node_config *config = self->config;

    if (config->mandatory && config->nmt_slave && config->consumer_heartbeat_time == 0 &&
        !audit_is_guarded(self))
        audit_tell(self->network, audit_node_place(self, "NMT_Mandatory_Slave"),
                   AUDIT_RULE_NOT_SUPERVISED,
                   "%s: neither Consumer_Heartbeat_Time nor guarding: its loss is not noticed",
                   audit_label(self).text);
}

void audit_check_guarding(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++) {
        check_master(&self->nodes[i]);
        check_slave(&self->nodes[i]);
        check_supervision(&self->nodes[i]);
    }
}

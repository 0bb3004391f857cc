/* SYNC and time stamps: who sends them, and who needs them. */
#include "audit.h"

#define BIT30        0x40000000u
#define IDENTIFIER   0x3FFFFFFFu
#define DEFAULT_SYNC 0x80u

static struct audit_label name_of(const struct audit_use *use)
{
    return use->node ? audit_label(use->node) : (struct audit_label){ "the manager" };
}

static const struct audit_use *find_sender(const struct audit_network *self,
                                           enum audit_service service, enum audit_rule rule,
                                           const char *what)
{
    const struct audit_use *first = NULL;

    for (size_t i = 0; i < self->use_count; i++) {
        const struct audit_use *use = &self->uses[i];

        if (use->service != service || !use->sends)
            continue;
        if (first)
            audit_tell(self, use->place, rule, "%s sends %s, but so does %s (%s:%u)",
                       name_of(use).text, what, name_of(first).text, first->place.file,
                       first->place.line);
        else
            first = use;
    }
    return first;
}

const struct audit_use *audit_find_sync(const struct audit_network *self)
{
    for (size_t i = 0; i < self->use_count; i++)
        if (self->uses[i].service == AUDIT_SYNC && self->uses[i].sends)
            return &self->uses[i];
    return NULL;
}

static uint64_t period_of(const struct audit_network *self, const struct audit_use *use)
{
    if (!use)
        return 0;
    return use->node ? audit_number(use->node, 0x1006, 0, 0) : self->config->sync_interval;
}

static void check_period(const struct audit_node *self)
{
    const struct audit_value id = audit_value(self, 0x1005, 0);

    if (id.known && (id.number & BIT30) != 0 && audit_number(self, 0x1006, 0, 1) == 0)
        audit_tell(self->network, id.place, AUDIT_RULE_SYNC_PERIOD,
                   "%s is to send SYNC (bit 30 of 1005h), but its period 1006h is 0",
                   audit_label(self).text);
}

/* One that nobody has touched may be there for nothing. */
static const struct audit_pdo *find_synchronous(const struct audit_network *self,
                                                const struct audit_node *node)
{
    for (size_t i = 0; i < self->pdo_count; i++)
        if (self->pdos[i].node == node && self->pdos[i].is_meant &&
            audit_is_synchronous(&self->pdos[i]))
            return &self->pdos[i];
    return NULL;
}

static void check_listener(const struct audit_node *node, const struct audit_pdo *pdo,
                           const struct audit_use *sender)
{
    const struct audit_network *self = node->network;
    const struct audit_value value = audit_value(node, 0x1005, 0);
    const uint32_t heard = value.known ? (uint32_t)value.number & IDENTIFIER : DEFAULT_SYNC;

    if (!sender) {
        if (audit_knows_all(self))
            audit_tell(self, pdo->type_place, AUDIT_RULE_NO_SYNC,
                       "%s: %s has transmission type %u, but nobody sends SYNC (Sync_Interval of "
                       "the network, or 1005h and 1006h of a node)",
                       audit_label(node).text, audit_pdo_label(pdo).text, pdo->type);
    } else if (heard != sender->can_id) {
        audit_tell(self, value.known ? value.place : pdo->type_place, AUDIT_RULE_SYNC_ID,
                   "%s listens to SYNC with CAN-ID %s (1005h), but %s sends it with %s",
                   audit_label(node).text, audit_can_id(heard).text, name_of(sender).text,
                   audit_can_id(sender->can_id).text);
    }
}

static void check_time(const struct audit_network *self)
{
    const struct audit_use *sender = find_sender(self, AUDIT_TIME, AUDIT_RULE_TIME_PRODUCERS,
                                                 "time stamps");

    for (size_t i = 0; i < self->use_count && !sender && audit_knows_all(self); i++)
        if (self->uses[i].service == AUDIT_TIME && self->uses[i].is_chosen)
            audit_tell(self, self->uses[i].place, AUDIT_RULE_NO_TIME,
                       "%s listens to time stamps (1012h), which nobody sends",
                       name_of(&self->uses[i]).text);
}

void audit_check_sync(struct audit_network *self)
{
    const struct audit_use *sender = find_sender(self, AUDIT_SYNC, AUDIT_RULE_SYNC_PRODUCERS,
                                                 "SYNC");

    self->load.sync_period = period_of(self, sender);
    for (size_t i = 0; i < self->node_count; i++) {
        const struct audit_pdo *pdo = find_synchronous(self, &self->nodes[i]);

        check_period(&self->nodes[i]);
        if (pdo)
            check_listener(&self->nodes[i], pdo, sender);
    }
    check_time(self);
}

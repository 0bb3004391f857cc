/* CAN-IDs that several devices or services claim for themselves. */
#include "audit.h"

#include "slave/slave_pdo.h"

#include <stdio.h>

#define INVALID       0x80000000u
#define IDENTIFIER    0x3FFFFFFFu
#define CONSUMERS_MAX 127u

struct user {
    char text[160];
};

static void name_sdo(const struct audit_use *use, char *text, size_t size)
{
    if (use->index != 0)
        snprintf(text, size, "an SDO channel (%04Xh:%02X)", use->index, use->sub);
    else
        snprintf(text, size, "the SDO requests");
}

static void name_service(const struct audit_use *use, char *text, size_t size)
{
    switch (use->service) {
    case AUDIT_NMT: snprintf(text, size, "the NMT commands"); break;
    case AUDIT_SYNC: snprintf(text, size, "SYNC (1005h)"); break;
    case AUDIT_TIME: snprintf(text, size, "the time stamp (1012h)"); break;
    case AUDIT_EMCY:
        snprintf(text, size, use->sends ? "the emergencies (1014h)" : "1028h:%02X", use->sub);
        break;
    case AUDIT_PDO:
        snprintf(text, size, "%s %u (%04Xh:01)", use->sends ? "TPDO" : "RPDO",
                 (use->index & 0x1FFu) + 1, use->index);
        break;
    case AUDIT_SDO_REQUEST:
    case AUDIT_SDO_ANSWER: name_sdo(use, text, size); break;
    case AUDIT_ERROR_CONTROL: snprintf(text, size, "heartbeat and boot-up"); break;
    }
}

static struct user name_user(const struct audit_use *use)
{
    struct user user;
    char service[64];

    name_service(use, service, sizeof service);
    snprintf(user.text, sizeof user.text, "%s of %s", service,
             use->node ? audit_label(use->node).text : "the manager");
    return user;
}

static bool is_default_channel(const struct audit_use *use)
{
    return use->index == 0x1200 || use->index >= 0x1280;
}

static bool is_restricted(const struct audit_use *use)
{
    const struct od nothing = { .count = 0 };
    const bool is_sdo = use->service == AUDIT_SDO_REQUEST || use->service == AUDIT_SDO_ANSWER;

    return use->is_chosen && !(is_sdo && is_default_channel(use)) && use->node &&
           use->index != 0x1028 && !slave_may_use(&nothing, use->can_id, true);
}

static void check_restricted(const struct audit_network *self, const struct audit_use *use)
{
    if (is_restricted(use))
        audit_tell(self, use->place, AUDIT_RULE_RESTRICTED_ID,
                   "CAN-ID %s of %s belongs to other services: the device refuses it (06090030h)",
                   audit_can_id(use->can_id).text, name_user(use).text);
}

static void tell(const struct audit_network *self, enum audit_rule rule,
                 const struct audit_use *first, const struct audit_use *second, const char *what)
{
    const struct audit_use *changed = second->is_chosen || !first->is_chosen ? second : first;
    const struct audit_use *kept = changed == second ? first : second;

    if (is_restricted(changed)) /* told already */
        return;
    audit_tell(self, changed->place, rule, "CAN-ID %s of %s is that of %s as well%s",
               audit_can_id(changed->can_id).text, name_user(changed).text, name_user(kept).text,
               what);
}

/* Both send, for the same service. SYNC and TIME have rules of their own. */
static void tell_senders(const struct audit_network *self, const struct audit_use *first,
                         const struct audit_use *second)
{
    switch (second->service) {
    case AUDIT_SYNC:
    case AUDIT_TIME: break;
    case AUDIT_PDO:
        tell(self, AUDIT_RULE_PDO_PRODUCERS, first, second, ": a PDO has one producer");
        break;
    case AUDIT_SDO_REQUEST:
        tell(self, AUDIT_RULE_SDO_CLIENTS, first, second,
             ": their requests disturb each other while the network boots");
        break;
    case AUDIT_NMT:
    case AUDIT_EMCY:
    case AUDIT_SDO_ANSWER:
    case AUDIT_ERROR_CONTROL: tell(self, AUDIT_RULE_ID_COLLISION, first, second, ""); break;
    }
}

/* What a device comes with is its maker's to know, and dcftest's. */
static bool are_one_devices(const struct audit_use *first, const struct audit_use *second)
{
    return first->node && first->node == second->node && !first->is_chosen && !second->is_chosen;
}

static bool are_two_servers(const struct audit_use *first, const struct audit_use *second)
{
    return first->service == AUDIT_SDO_REQUEST && !first->sends && !second->sends;
}

/* All uses of one CAN-ID; the first one sends, if any does. */
static void check_id(const struct audit_network *self, const struct audit_use *uses, size_t count)
{
    unsigned told = 0; /* services of receivers */

    for (size_t i = 1; i < count; i++) {
        const struct audit_use *use = &uses[i];
        const unsigned bit = 1u << use->service;

        if (are_one_devices(&uses[0], use))
            continue;
        if (use->service == uses[0].service) {
            if (use->sends)
                tell_senders(self, &uses[0], use);
            else if (are_two_servers(&uses[i - 1], use))
                tell(self, AUDIT_RULE_ID_COLLISION, &uses[i - 1], use, "");
        } else if (use->sends || (told & bit) == 0) {
            told |= use->sends ? 0 : bit;
            tell(self, AUDIT_RULE_ID_COLLISION, &uses[0], use, "");
        }
    }
}

/* The manager listens to 80h + node-ID. */
static void check_emergency(const struct audit_network *self, const struct audit_use *use)
{
    const unsigned expected = use->node ? 0x80u + use->node->config->node_id : 0;

    if (use->service == AUDIT_EMCY && use->sends && use->node && use->can_id != expected)
        audit_tell(self, use->place, AUDIT_RULE_EMCY_ID,
                   "%s has CAN-ID %s for its emergencies (1014h): the manager does not hear them, "
                   "it listens to %03Xh",
                   audit_label(use->node).text, audit_can_id(use->can_id).text, expected);
}

static bool is_sent(const struct audit_network *self, uint32_t can_id)
{
    size_t low = 0, high = self->use_count;

    while (low < high) {
        const size_t middle = low + (high - low) / 2;

        if (self->uses[middle].can_id < can_id)
            low = middle + 1;
        else
            high = middle;
    }
    return low < self->use_count && self->uses[low].can_id == can_id && self->uses[low].sends;
}

/* A list that is there for all nodes is one finding. */
static void check_emergency_consumers(const struct audit_node *self)
{
    struct audit_value first = { .known = false };
    unsigned count = 0;
    uint8_t at = 0;

    for (uint8_t sub = 1; sub <= CONSUMERS_MAX; sub++) {
        const struct audit_value value = audit_value(self, 0x1028, sub);
        const uint32_t can_id = (uint32_t)value.number & IDENTIFIER;

        if (!value.chosen || can_id == 0 || (value.number & INVALID) != 0 ||
            is_sent(self->network, can_id))
            continue;
        if (count++ == 0) {
            first = value;
            at = sub;
        }
    }
    if (count > 0)
        audit_tell(self->network, first.place, AUDIT_RULE_EMCY_PRODUCER,
                   "%s waits for emergencies with CAN-ID %s (1028h:%02X)%s, which no node sends",
                   audit_label(self).text, audit_can_id((uint32_t)first.number & IDENTIFIER).text,
                   at, count > 1 ? " and others" : "");
}

void audit_check_can_ids(struct audit_network *self)
{
    size_t first = 0;

    for (size_t i = 0; i < self->use_count; i++) {
        check_restricted(self, &self->uses[i]);
        check_emergency(self, &self->uses[i]);
        if (i + 1 < self->use_count && self->uses[i + 1].can_id == self->uses[first].can_id)
            continue;
        check_id(self, &self->uses[first], i + 1 - first);
        first = i + 1;
    }
    for (size_t i = 0; i < self->node_count; i++)
        check_emergency_consumers(&self->nodes[i]);
}

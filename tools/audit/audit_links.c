/* PDOs between nodes: does the consumer get what it expects? */
#include "audit.h"

#include "od/od.h"

#include <stdio.h>
#include <string.h>

#define DUMMY_END 0x20u

struct link {
    const struct audit_pdo *producer;
    const struct audit_pdo *consumer;
};

struct ends { /* of a link, for messages */
    char text[440];
};

static struct ends name_ends(const struct link *self)
{
    struct ends ends;

    snprintf(ends.text, sizeof ends.text, "%s of %s gets %s of %s (CAN-ID %s)",
             audit_pdo_label(self->consumer).text, audit_label(self->consumer->node).text,
             audit_pdo_label(self->producer).text, audit_label(self->producer->node).text,
             audit_can_id(self->consumer->cob_id).text);
    return ends;
}

/* --- lengths and layout --- */

static uint8_t type_of(const struct audit_pdo *pdo, uint32_t mapped)
{
    const struct dcf_entry *entry = NULL;

    if (pdo->node->described)
        entry = dcf_find(&pdo->node->description, (uint16_t)(mapped >> 16), (uint8_t)(mapped >> 8));
    return entry ? entry->type : 0;
}

static bool are_alike(const struct link *self, uint32_t sent, uint32_t received)
{
    const uint8_t from = type_of(self->producer, sent), to = type_of(self->consumer, received);

    if ((sent & 0xFF) != (received & 0xFF))
        return false;
    return received >> 16 < DUMMY_END || from == 0 || to == 0 || from == to;
}

static const char *shown_type(uint8_t type)
{
    return type != 0 ? od_type_name(type) : "unknown type";
}

static void compare_layout(const struct link *self)
{
    const struct audit_pdo *from = self->producer, *to = self->consumer;
    unsigned bits = 0;

    for (uint8_t i = 0; i < from->count && i < to->count; i++) {
        const uint32_t sent = from->mapped[i], received = to->mapped[i];

        if (!are_alike(self, sent, received)) {
            audit_tell(to->node->network,
                       audit_value(to->node, audit_mapping_index(to), (uint8_t)(i + 1)).place,
                       AUDIT_RULE_PDO_LAYOUT,
                       "%s: at bit %u it expects %04Xh:%02X (%u bits, %s), there comes %04Xh:%02X "
                       "(%u bits, %s)",
                       name_ends(self).text, bits, received >> 16, received >> 8 & 0xFF,
                       received & 0xFF, shown_type(type_of(to, received)), sent >> 16,
                       sent >> 8 & 0xFF, sent & 0xFF, shown_type(type_of(from, sent)));
            return;
        }
        bits += sent & 0xFF;
    }
}

static void compare_lengths(const struct link *self)
{
    const struct audit_pdo *from = self->producer, *to = self->consumer;
    const unsigned sent = (from->bits + 7) / 8, expected = (to->bits + 7) / 8;
    const struct audit_place place = audit_value(to->node, audit_mapping_index(to), 0).place;

    if (!from->is_mapped || !to->is_mapped)
        return;
    if (sent < expected)
        audit_tell(to->node->network, place, AUDIT_RULE_PDO_LENGTH,
                   "%s: %u bytes expected, %u come: it is not processed (emergency 8210h)",
                   name_ends(self).text, expected, sent);
    else if (sent > expected)
        audit_tell(to->node->network, place, AUDIT_RULE_PDO_EXCESS,
                   "%s: %u bytes expected, %u come: the last ones are ignored, or all of it "
                   "(emergency 8220h)",
                   name_ends(self).text, expected, sent);
    else
        compare_layout(self);
}

/* --- times --- */

static void compare_times(const struct link *self)
{
    const struct audit_pdo *from = self->producer, *to = self->consumer;
    const uint64_t period = audit_pdo_period(from), deadline = (uint64_t)to->event_timer * 1000;
    const uint16_t index = (uint16_t)(0x1400 + to->number - 1);

    if (from->has_type && (from->type == 252 || from->type == 253))
        audit_tell(from->node->network, from->type_place, AUDIT_RULE_PDO_REQUEST,
                   "%s, but that is sent on request only (transmission type %u), and nobody asks",
                   name_ends(self).text, from->type);
    if (period != 0 && deadline != 0 && deadline <= period)
        audit_tell(to->node->network, audit_value(to->node, index, 5).place,
                   AUDIT_RULE_PDO_DEADLINE,
                   "%s: it waits %u ms (%04Xh:05), but that comes each %lu.%lu ms only: emergency "
                   "8250h again and again",
                   name_ends(self).text, to->event_timer, index, (unsigned long)(period / 1000),
                   (unsigned long)(period / 100 % 10));
}

/* --- RPDOs --- */

static bool has_default_id(const struct audit_pdo *pdo)
{
    return !pdo->is_chosen || (pdo->number <= 4 && pdo->cob_id == 0x100u + 0x100u * pdo->number +
                                                                      pdo->node->config->node_id);
}

/* True: somebody sends it. */
static bool check_consumer(const struct audit_network *self, const struct audit_pdo *consumer)
{
    size_t count;
    const struct audit_pdo *const *producers = audit_find_producers(self, consumer->cob_id, &count);
    bool found = false;

    for (size_t i = 0; i < count; i++) {
        const struct link link = { producers[i], consumer };

        if (link.producer->node == consumer->node)
            continue;
        found = true;
        compare_lengths(&link);
        compare_times(&link);
    }
    return found;
}

static void add_open(const struct audit_pdo *pdo, char *text, size_t size)
{
    const size_t used = strlen(text);

    snprintf(text + used, size - used, "%s%u (%s)", used > 0 ? ", " : "", pdo->number,
             audit_can_id(pdo->cob_id).text);
}

static void check_node(const struct audit_network *self, const struct audit_node *node)
{
    char open[200] = "";

    for (size_t i = 0; i < self->pdo_count; i++) {
        const struct audit_pdo *pdo = &self->pdos[i];

        if (pdo->node != node || pdo->transmit || check_consumer(self, pdo) ||
            !audit_knows_all(self))
            continue;
        if (has_default_id(pdo))
            add_open(pdo, open, sizeof open);
        else
            audit_tell(self, pdo->place, AUDIT_RULE_NO_PRODUCER,
                       "%s: %s has CAN-ID %s, which no node sends", audit_label(node).text,
                       audit_pdo_label(pdo).text, audit_can_id(pdo->cob_id).text);
    }
    if (open[0] != '\0')
        audit_tell(self, audit_node_place(node, "DCF_File"), AUDIT_RULE_OPEN_RPDO,
                   "%s: no node sends RPDO %s: it is the application's to do",
                   audit_label(node).text, open);
}

void audit_check_links(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++)
        check_node(self, &self->nodes[i]);
}

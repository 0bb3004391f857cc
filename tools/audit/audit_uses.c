/* Which CAN-ID is used by whom, and for what. */
#include "audit.h"

#include <stdlib.h>

#define INVALID    0x80000000u
#define BIT30      0x40000000u
#define IDENTIFIER 0x3FFFFFFFu

#define EMCY       0x080u
#define SDO_ANSWER 0x580u
#define SDO        0x600u
#define CONTROL    0x700u
#define SUBS_MAX   127u

static void add(struct audit_network *self, struct audit_use use)
{
    use.can_id &= IDENTIFIER;
    if (self->use_count == self->use_room) {
        size_t room = self->use_room ? 2 * self->use_room : 256;
        struct audit_use *grown = realloc(self->uses, room * sizeof *grown);

        if (!grown) {
            self->no_memory = true;
            return;
        }
        self->uses = grown;
        self->use_room = room;
    }
    self->uses[self->use_count++] = use;
}

/* What a node uses whatever its configuration says. */
static void add_fixed(struct audit_network *self, const struct audit_node *node, uint8_t id)
{
    const struct audit_place place = node ? audit_node_place(node, "Node_Id")
                                          : audit_network_place(self, "Manager_Node_Id");

    add(self,
        (struct audit_use){ CONTROL + id, AUDIT_ERROR_CONTROL, true, node, 0, 0, false, place });
    add(self,
        (struct audit_use){ SDO + id, AUDIT_SDO_REQUEST, false, node, 0x1200, 1, false, place });
    add(self, (struct audit_use){ SDO_ANSWER + id, AUDIT_SDO_ANSWER, true, node, 0x1200, 2, false,
                                  place });
}

static void add_manager(struct audit_network *self)
{
    const struct network_config *config = self->config;
    const struct audit_place place = audit_network_place(self, "Manager_Node_Id");

    add(self, (struct audit_use){ 0, AUDIT_NMT, true, NULL, 0, 0, false, place });
    add_fixed(self, NULL, config->manager_node_id);
    add(self, (struct audit_use){ EMCY + config->manager_node_id, AUDIT_EMCY, true, NULL, 0x1014, 0,
                                  false, place });
    for (size_t i = 0; i < self->node_count; i++)
        add(self,
            (struct audit_use){ SDO + self->nodes[i].config->node_id, AUDIT_SDO_REQUEST, true, NULL,
                                0, 0, false, audit_node_place(&self->nodes[i], "Node_Id") });
    if (config->has_sync_interval && config->sync_interval != 0)
        add(self, (struct audit_use){ config->sync_cob_id, AUDIT_SYNC, true, NULL, 0x1005, 0, true,
                                      audit_network_place(self, "Sync_Interval") });
}

static void add_value(struct audit_network *self, const struct audit_node *node,
                      const struct audit_value *value, struct audit_use use)
{
    use.can_id = (uint32_t)value->number;
    use.node = node;
    use.is_chosen = value->chosen;
    use.place = value->place;
    add(self, use);
}

/* A device that is said to send emergencies, or of which nothing is said. */
static void add_emergencies(struct audit_network *self, const struct audit_node *node)
{
    const struct audit_use use = { .service = AUDIT_EMCY, .sends = true, .index = 0x1014 };
    struct audit_value value = audit_value(node, 0x1014, 0);

    if (!value.known && !audit_lacks(node, 0x1014, 0)) {
        value.known = true;
        value.number = EMCY + node->config->node_id;
        value.place = audit_node_place(node, "Node_Id");
    }
    if (value.known && (value.number & INVALID) == 0)
        add_value(self, node, &value, use);
    for (uint8_t sub = 1; sub <= SUBS_MAX; sub++) {
        const struct audit_use hears = { .service = AUDIT_EMCY, .index = 0x1028, .sub = sub };

        value = audit_value(node, 0x1028, sub);
        if (value.known && (value.number & INVALID) == 0 && value.number != 0)
            add_value(self, node, &value, hears);
    }
}

/* Channels behind the default one: of servers 1201h.., of clients 1280h.. */
static void add_channel(struct audit_network *self, const struct audit_node *node, uint16_t index)
{
    const bool is_client = index >= 0x1280;
    const struct audit_value request = audit_value(node, index, 1);
    const struct audit_value answer = audit_value(node, index, 2);
    const struct audit_use asks = {
        .service = AUDIT_SDO_REQUEST, .sends = is_client, .index = index, .sub = 1
    };
    const struct audit_use answers = {
        .service = AUDIT_SDO_ANSWER, .sends = !is_client, .index = index, .sub = 2
    };

    if (!request.known || !answer.known || ((request.number | answer.number) & INVALID) != 0 ||
        request.number == 0)
        return;
    add_value(self, node, &request, asks);
    add_value(self, node, &answer, answers);
}

static void add_sync_and_time(struct audit_network *self, const struct audit_node *node)
{
    const struct audit_value sync = audit_value(node, 0x1005, 0);
    const struct audit_value time = audit_value(node, 0x1012, 0);
    const bool sends_sync = (sync.number & BIT30) != 0 && audit_number(node, 0x1006, 0, 0) != 0;

    if (sync.known)
        add_value(
            self, node, &sync,
            (struct audit_use){ .service = AUDIT_SYNC, .sends = sends_sync, .index = 0x1005 });
    if (time.known && (time.number & (BIT30 | INVALID)) != 0)
        add_value(self, node, &time,
                  (struct audit_use){ .service = AUDIT_TIME,
                                      .sends = (time.number & BIT30) != 0,
                                      .index = 0x1012 });
}

static void add_node(struct audit_network *self, const struct audit_node *node)
{
    add_fixed(self, node, node->config->node_id);
    add_emergencies(self, node);
    add_sync_and_time(self, node);
    for (uint16_t index = 0x1201; index <= 0x12FF; index++)
        add_channel(self, node, index);
}

static int compare(const void *a, const void *b)
{
    const struct audit_use *left = a, *right = b;

    if (left->can_id != right->can_id)
        return left->can_id > right->can_id ? 1 : -1;
    if (left->sends != right->sends)
        return left->sends ? -1 : 1;
    if (left->is_chosen != right->is_chosen) /* what cannot be changed comes first */
        return left->is_chosen ? 1 : -1;
    if (left->node != right->node)
        return !left->node || (right->node && left->node < right->node) ? -1 : 1;
    return (left->index << 8 | left->sub) - (right->index << 8 | right->sub);
}

void audit_collect_uses(struct audit_network *self)
{
    add_manager(self);
    for (size_t i = 0; i < self->node_count; i++)
        add_node(self, &self->nodes[i]);
    for (size_t i = 0; i < self->pdo_count; i++) {
        const struct audit_pdo *pdo = &self->pdos[i];
        const uint16_t index = (uint16_t)((pdo->transmit ? 0x1800 : 0x1400) + pdo->number - 1);

        add(self, (struct audit_use){ pdo->cob_id, AUDIT_PDO, pdo->transmit, pdo->node, index, 1,
                                      pdo->is_chosen, pdo->place });
    }
    if (!self->no_memory)
        qsort(self->uses, self->use_count, sizeof *self->uses, compare);
}

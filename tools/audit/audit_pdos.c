/* The PDOs of all nodes, as they will be when the nodes are configured. */
#include "audit.h"

#include <stdio.h>
#include <stdlib.h>

#define PDOS_MAX 512u /* in each direction */

#define INVALID    0x80000000u
#define IDENTIFIER 0x3FFFFFFFu /* with bit 29 */

enum { COB_ID = 1, TYPE = 2, INHIBIT_TIME = 3, EVENT_TIMER = 5 };

static struct audit_pdo *new_pdo(struct audit_network *self)
{
    if (self->pdo_count == self->pdo_room) {
        size_t room = self->pdo_room ? 2 * self->pdo_room : 64;
        struct audit_pdo *grown = realloc(self->pdos, room * sizeof *grown);

        if (!grown) {
            self->no_memory = true;
            return NULL;
        }
        self->pdos = grown;
        self->pdo_room = room;
    }
    return &self->pdos[self->pdo_count++];
}

/* 0: no number that is known, or one of a multiplexed PDO. */
static void read_mapping(const struct audit_node *node, uint16_t index, struct audit_pdo *pdo)
{
    const struct audit_value count = audit_value(node, index, 0);

    pdo->is_mapped = count.known && count.number <= AUDIT_MAPPED_MAX;
    pdo->is_meant |= count.written;
    for (uint8_t i = 0; pdo->is_mapped && i < count.number; i++) {
        const struct audit_value value = audit_value(node, index, (uint8_t)(i + 1));

        pdo->is_mapped = value.known;
        pdo->is_meant |= value.written;
        pdo->mapped[i] = (uint32_t)value.number;
        pdo->bits += value.number & 0xFF;
        pdo->count++;
    }
}

static void read_parameters(const struct audit_node *node, uint16_t index, struct audit_pdo *pdo)
{
    const struct audit_value type = audit_value(node, index, TYPE);

    pdo->has_type = type.known;
    pdo->type = (uint8_t)type.number;
    pdo->type_place = type.place;
    pdo->is_meant |= type.written;
    pdo->inhibit_time = (uint32_t)(audit_value(node, index, INHIBIT_TIME).number & UINT16_MAX) *
                        100;
    pdo->event_timer = (uint32_t)(audit_value(node, index, EVENT_TIMER).number & UINT16_MAX);
}

/* One that is switched off, or has nothing in it, is none. */
static void collect(struct audit_network *self, const struct audit_node *node, uint16_t index)
{
    const struct audit_value cob_id = audit_value(node, index, COB_ID);
    struct audit_pdo pdo = { .node = node };
    struct audit_pdo *added;

    if (!cob_id.known || (cob_id.number & INVALID) != 0)
        return;
    if (!cob_id.chosen && (cob_id.number & IDENTIFIER) == 0) /* so some files say "none" */
        return;
    pdo.transmit = index >= 0x1800;
    pdo.number = (uint16_t)((index & 0x1FF) + 1);
    pdo.cob_id = (uint32_t)cob_id.number & IDENTIFIER;
    pdo.is_chosen = cob_id.chosen;
    pdo.is_meant = cob_id.written;
    pdo.place = cob_id.place;
    read_parameters(node, index, &pdo);
    read_mapping(node, (uint16_t)(index + 0x200), &pdo);
    if (pdo.is_mapped && pdo.count == 0)
        return;
    added = new_pdo(self);
    if (added)
        *added = pdo;
}

static int compare(const void *a, const void *b)
{
    const struct audit_pdo *left = *(const struct audit_pdo *const *)a;
    const struct audit_pdo *right = *(const struct audit_pdo *const *)b;

    if (left->cob_id != right->cob_id)
        return left->cob_id > right->cob_id ? 1 : -1;
    return (left > right) - (left < right);
}

static void sort_producers(struct audit_network *self)
{
    self->producers = calloc(self->pdo_count + 1, sizeof *self->producers);
    if (!self->producers) {
        self->no_memory = true;
        return;
    }
    for (size_t i = 0; i < self->pdo_count; i++)
        if (self->pdos[i].transmit)
            self->producers[self->producer_count++] = &self->pdos[i];
    qsort(self->producers, self->producer_count, sizeof *self->producers, compare);
}

void audit_collect_pdos(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++)
        for (unsigned n = 0; n < 2 * PDOS_MAX && !self->no_memory; n++)
            collect(self, &self->nodes[i],
                    (uint16_t)(n < PDOS_MAX ? 0x1400 + n : 0x1800 + n - PDOS_MAX));
    if (!self->no_memory)
        sort_producers(self);
}

const struct audit_pdo *const *audit_find_producers(const struct audit_network *self,
                                                    uint32_t can_id, size_t *ret_count)
{
    size_t low = 0, high = self->producer_count, end;

    while (low < high) {
        const size_t middle = low + (high - low) / 2;

        if (self->producers[middle]->cob_id < can_id)
            low = middle + 1;
        else
            high = middle;
    }
    end = low;
    while (end < self->producer_count && self->producers[end]->cob_id == can_id)
        end++;
    *ret_count = end - low;
    return self->producers + low;
}

uint64_t audit_pdo_period(const struct audit_pdo *self)
{
    if (!self->has_type || self->type == 0)
        return 0;
    if (audit_is_synchronous(self))
        return self->node->network->load.sync_period * self->type;
    return self->type >= 254 ? (uint64_t)self->event_timer * 1000 : 0;
}

struct audit_label audit_pdo_label(const struct audit_pdo *self)
{
    struct audit_label label;

    snprintf(label.text, sizeof label.text, "%s %u", self->transmit ? "TPDO" : "RPDO",
             self->number);
    return label;
}

uint16_t audit_mapping_index(const struct audit_pdo *self)
{
    return (uint16_t)((self->transmit ? 0x1A00 : 0x1600) + self->number - 1);
}

bool audit_is_synchronous(const struct audit_pdo *self)
{
    return self->has_type && self->type <= 240;
}

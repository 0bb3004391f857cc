#include "slave/slave_internal.h"

#include <stdlib.h>
#include <string.h>

#define TABLE_SIZE     2048u /* places by CAN-ID */
#define SUB_COB_ID     1u
#define SUB_TYPE       2u
#define SUB_INHIBIT    3u
#define SUB_TIMER      5u
#define SUB_SYNC_START 6u
#define LAST_DUMMY     0x1Fu

/* Objects of one direction. */
struct direction {
    uint16_t communication, mapping;
};

static const struct direction receive = { FIRST_RPDO_OBJECT, FIRST_RPDO_MAPPING };
static const struct direction transmit = { FIRST_TPDO_OBJECT, FIRST_TPDO_MAPPING };

uint32_t slave_can_id(uint32_t cob_id)
{
    return cob_id & ((cob_id & COB_ID_EXT) != 0 ? COB_ID_EXT | 0x1FFFFFFFu : 0x7FFu);
}

/* ---- which there are ---- */

/* Has each PDO exactly once. */
static bool is_pdo(const struct od_entry *entry, const struct direction *direction)
{
    return entry->sub == SUB_COB_ID && entry->index >= direction->communication &&
           entry->index < direction->communication + SLAVE_PDO_NUMBER_MAX;
}

static uint16_t number_of(const struct od_entry *entry, const struct direction *direction)
{
    return (uint16_t)(entry->index - direction->communication + 1);
}

static uint8_t mapping_room(const struct od *od, const struct direction *direction, uint16_t number)
{
    uint8_t room = 0;

    while (room < PDO_FIELDS_MAX &&
           od_find(od, (uint16_t)(direction->mapping + number - 1), (uint8_t)(room + 1)) != NULL)
        room++;
    return room;
}

static unsigned count_pdos(const struct od *od, const struct direction *direction,
                           size_t *ret_fields)
{
    unsigned count = 0;

    *ret_fields = 0;
    for (size_t i = 0; i < od->count; i++)
        if (is_pdo(od->entries[i], direction)) {
            *ret_fields += mapping_room(od, direction, number_of(od->entries[i], direction));
            count++;
        }
    return count;
}

static void init_pdos(struct slave_pdos *pdos, const struct od *od)
{
    struct pdo_field *fields = pdos->fields;
    struct rpdo *rpdo = pdos->rpdos;
    struct tpdo *tpdo = pdos->tpdos;

    for (size_t i = 0; i < od->count; i++) {
        if (is_pdo(od->entries[i], &receive)) {
            const uint16_t number = number_of(od->entries[i], &receive);

            rpdo_init(rpdo, number, fields, mapping_room(od, &receive, number));
            fields += rpdo++->map.room;
        } else if (is_pdo(od->entries[i], &transmit)) {
            const uint16_t number = number_of(od->entries[i], &transmit);

            tpdo_init(tpdo, number, fields, mapping_room(od, &transmit, number));
            fields += tpdo++->map.room;
        }
    }
}

/* One that is never empty: NULL tells that there is no memory. */
static void *make_array(size_t count, size_t size)
{
    return calloc(count > 0 ? count : 1, size);
}

static bool make_arrays(struct slave_pdos *pdos, size_t received, size_t sent)
{
    const size_t slots = pdos->rpdo_count + pdos->tpdo_count;

    pdos->rpdos = make_array(pdos->rpdo_count, sizeof *pdos->rpdos);
    pdos->tpdos = make_array(pdos->tpdo_count, sizeof *pdos->tpdos);
    pdos->fields = make_array(received + sent, sizeof *pdos->fields);
    pdos->mapped = make_array(sent, sizeof *pdos->mapped);
    pdos->first = make_array(TABLE_SIZE, sizeof *pdos->first);
    pdos->next = make_array(slots, sizeof *pdos->next);
    return pdos->rpdos && pdos->tpdos && pdos->fields && pdos->mapped && pdos->first && pdos->next;
}

enum co_err slave_make_pdos(struct slave *self)
{
    struct slave_pdos *pdos = calloc(1, sizeof *pdos);
    size_t received, sent;

    self->pdos = pdos;
    if (pdos == NULL)
        return CO_ERR_MEMORY;
    pdos->deadline = CO_NEVER;
    pdos->rpdo_count = count_pdos(self->od, &receive, &received);
    pdos->tpdo_count = count_pdos(self->od, &transmit, &sent);
    if (!make_arrays(pdos, received, sent))
        return CO_ERR_MEMORY;
    init_pdos(pdos, self->od);
    for (size_t i = 0; i < self->od->count; i++)
        self->od->entries[i]->map_count = 0;
    return CO_OK;
}

void slave_free_pdos(struct slave *self)
{
    if (self->pdos == NULL)
        return;
    free(self->pdos->rpdos);
    free(self->pdos->tpdos);
    free(self->pdos->fields);
    free(self->pdos->mapped);
    free(self->pdos->first);
    free(self->pdos->next);
    free(self->pdos);
    self->pdos = NULL;
}

/* Numbers rise, so none stands behind the place that it has without gaps. */
static unsigned last_place(uint16_t number, unsigned count)
{
    return number < count ? number : count;
}

struct rpdo *slave_rpdo(const struct slave *self, uint16_t number)
{
    struct rpdo *rpdos = self->pdos->rpdos;

    for (unsigned i = last_place(number, self->pdos->rpdo_count); i > 0; i--)
        if (rpdos[i - 1].number <= number)
            return rpdos[i - 1].number == number ? &rpdos[i - 1] : NULL;
    return NULL;
}

struct tpdo *slave_tpdo(const struct slave *self, uint16_t number)
{
    struct tpdo *tpdos = self->pdos->tpdos;

    for (unsigned i = last_place(number, self->pdos->tpdo_count); i > 0; i--)
        if (tpdos[i - 1].number <= number)
            return tpdos[i - 1].number == number ? &tpdos[i - 1] : NULL;
    return NULL;
}

void slave_pdo_set_flags(struct slave *self, enum pdo_direction direction, uint16_t number,
                         uint8_t flags)
{
    struct rpdo *rpdo = slave_rpdo(self, number);
    struct tpdo *tpdo = slave_tpdo(self, number);

    if (direction == PDO_RECEIVE && rpdo != NULL)
        rpdo->notify = (flags & SLAVE_PDO_NOTIFY) != 0;
    if (direction == PDO_TRANSMIT && tpdo != NULL) {
        tpdo->notify = (flags & SLAVE_PDO_NOTIFY) != 0;
        tpdo->confirm = (flags & SLAVE_PDO_CONFIRM) != 0;
        tpdo->timer_asks = (flags & SLAVE_PDO_TIMER_ASKS) != 0;
        self->listen_generation++;
    }
}

bool slave_wants_own_frames(const struct slave *self)
{
    for (unsigned i = 0; i < self->pdos->rpdo_count; i++)
        if (self->pdos->rpdos[i].askers > 0)
            return true;
    for (unsigned i = 0; i < self->pdos->tpdo_count; i++)
        if (self->pdos->tpdos[i].confirm)
            return true;
    return false;
}

/* ---- by CAN-ID ---- */

static unsigned place_of(uint32_t can_id)
{
    return (can_id ^ can_id >> 11 ^ can_id >> 22) % TABLE_SIZE;
}

/* Slots of one place stand in their order. */
static void add_slot(struct slave_pdos *pdos, unsigned slot, uint32_t cob_id)
{
    uint16_t *link = &pdos->first[place_of(slave_can_id(cob_id))];

    pdos->next[slot] = 0;
    if ((cob_id & COB_ID_INVALID) != 0)
        return;
    while (*link != 0)
        link = &pdos->next[*link - 1];
    *link = (uint16_t)(slot + 1);
}

static void fill_table(struct slave *self)
{
    struct slave_pdos *pdos = self->pdos;

    memset(pdos->first, 0, TABLE_SIZE * sizeof *pdos->first);
    for (unsigned i = 0; i < pdos->rpdo_count; i++)
        add_slot(pdos, i, pdos->rpdos[i].cob_id);
    for (unsigned i = 0; i < pdos->tpdo_count; i++)
        add_slot(pdos, pdos->rpdo_count + i, pdos->tpdos[i].cob_id);
    slave_update_sync_consumer(self);
}

unsigned slave_first_slot(const struct slave_pdos *pdos, uint32_t can_id)
{
    return pdos->first[place_of(can_id)];
}

/* ---- which TPDOs map an entry ---- */

static int compare_mapped(const void *left, const void *right)
{
    const struct slave_mapped *a = left, *b = right;
    const uintptr_t entry_a = (uintptr_t)a->entry, entry_b = (uintptr_t)b->entry;

    if (entry_a != entry_b)
        return entry_a < entry_b ? -1 : 1;
    return (a->tpdo > b->tpdo) - (a->tpdo < b->tpdo);
}

/* The field is the first one of its mapping with this entry. */
static bool is_first(const struct pdo_map *map, unsigned field)
{
    const struct od_entry *entry = map->fields[field].entry;

    if (entry == NULL)
        return false;
    for (unsigned i = 0; i < field; i++)
        if (map->fields[i].entry == entry)
            return false;
    return true;
}

static void collect_mapped(struct slave_pdos *pdos)
{
    pdos->mapped_count = 0;
    for (unsigned i = 0; i < pdos->tpdo_count; i++) {
        const struct pdo_map *map = &pdos->tpdos[i].map;

        for (unsigned field = 0; field < map->count; field++)
            if (is_first(map, field))
                pdos->mapped[pdos->mapped_count++] = (struct slave_mapped){
                    .entry = map->fields[field].entry, .tpdo = (uint16_t)i
                };
    }
    qsort(pdos->mapped, pdos->mapped_count, sizeof *pdos->mapped, compare_mapped);
    pdos->mapped_stale = false;
}

const struct slave_mapped *slave_tpdos_of(struct slave_pdos *pdos, const struct od_entry *entry)
{
    const uintptr_t wanted = (uintptr_t)entry;
    unsigned low = 0, high;

    if (pdos->mapped_stale)
        collect_mapped(pdos);
    high = pdos->mapped_count;
    while (low < high) {
        const unsigned middle = (low + high) / 2;

        if ((uintptr_t)pdos->mapped[middle].entry < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return pdos->mapped + low;
}

/* ---- mappings ---- */

static void count_entries(const struct pdo_map *map, int step)
{
    for (unsigned i = 0; i < map->count; i++)
        if (is_first(map, i))
            map->fields[i].entry->map_count = (uint16_t)(map->fields[i].entry->map_count + step);
}

static void fill_map(const struct od *od, struct pdo_map *map, uint16_t index)
{
    const uint64_t count = od_number(od, index, 0, 0);

    pdo_map_clear(map);
    for (unsigned sub = 1; sub <= count && sub <= map->room; sub++) {
        const uint64_t mapped = od_number(od, index, (uint8_t)sub, 0);
        const uint16_t object = (uint16_t)(mapped >> 16);
        struct od_entry *entry = object > LAST_DUMMY ? od_find(od, object, (uint8_t)(mapped >> 8))
                                                     : NULL;

        pdo_map_add(map, entry, (uint8_t)mapped);
    }
}

/* Counts above that are no numbers of entries, but other kinds of PDOs. */
static void remap(struct slave *self, struct pdo_map *map, uint16_t index)
{
    count_entries(map, -1);
    if (od_number(self->od, index, 0, 0) <= PDO_FIELDS_MAX)
        fill_map(self->od, map, index);
    else
        pdo_map_clear(map);
    count_entries(map, 1);
    self->pdos->mapped_stale = true;
}

static bool has_watched(const struct pdo_map *map)
{
    for (unsigned i = 0; i < map->count; i++)
        if (map->fields[i].entry != NULL && map->fields[i].entry->watched)
            return true;
    return false;
}

static void remap_rpdo(struct slave *self, struct rpdo *rpdo)
{
    remap(self, &rpdo->map, (uint16_t)(FIRST_RPDO_MAPPING + rpdo->number - 1));
    rpdo_remapped(rpdo);
}

static void remap_tpdo(struct slave *self, struct tpdo *tpdo, co_us_t now)
{
    remap(self, &tpdo->map, (uint16_t)(FIRST_TPDO_MAPPING + tpdo->number - 1));
    tpdo->asks = has_watched(&tpdo->map);
    tpdo_remapped(tpdo, now);
}

/* ---- parameters ---- */

static void configure_rpdo(const struct od *od, struct rpdo *rpdo)
{
    const uint16_t index = (uint16_t)(FIRST_RPDO_OBJECT + rpdo->number - 1);
    const struct rpdo_parameters parameters = {
        .cob_id = (uint32_t)od_number(od, index, SUB_COB_ID, COB_ID_INVALID),
        .type = (uint8_t)od_number(od, index, SUB_TYPE, UINT8_MAX),
        .timeout = CO_MS(od_number(od, index, SUB_TIMER, 0))
    };

    rpdo_configure(rpdo, &parameters);
}

static void configure_tpdo(const struct od *od, struct tpdo *tpdo, co_us_t now)
{
    const uint16_t index = (uint16_t)(FIRST_TPDO_OBJECT + tpdo->number - 1);
    const struct tpdo_parameters parameters = {
        .cob_id = (uint32_t)od_number(od, index, SUB_COB_ID, COB_ID_INVALID),
        .type = (uint8_t)od_number(od, index, SUB_TYPE, UINT8_MAX),
        .sync_start = (uint8_t)od_number(od, index, SUB_SYNC_START, 0),
        .inhibit = od_number(od, index, SUB_INHIBIT, 0) * 100,
        .period = CO_MS(od_number(od, index, SUB_TIMER, 0))
    };

    tpdo_configure(tpdo, &parameters, now);
}

void slave_reset_pdos(struct slave *self, co_us_t now)
{
    struct slave_pdos *pdos = self->pdos;

    for (unsigned i = 0; i < pdos->rpdo_count; i++) {
        configure_rpdo(self->od, &pdos->rpdos[i]);
        remap_rpdo(self, &pdos->rpdos[i]);
        rpdo_reset(&pdos->rpdos[i]);
    }
    for (unsigned i = 0; i < pdos->tpdo_count; i++) {
        configure_tpdo(self->od, &pdos->tpdos[i], now);
        remap_tpdo(self, &pdos->tpdos[i], now);
        tpdo_reset(&pdos->tpdos[i]);
    }
    pdos->deadline = CO_NEVER;
    fill_table(self);
}

/* A mapping with a fixed count changes with its entries, the others with their count. */
static bool maps_anew(const struct od *od, uint16_t index, uint8_t sub)
{
    return sub == 0 || od_number(od, index, 0, 0) != 0;
}

static void change_rpdo(struct slave *self, struct rpdo *rpdo, bool mapping, co_us_t now,
                        struct co_outbox *out)
{
    if (mapping)
        remap_rpdo(self, rpdo);
    else
        configure_rpdo(self->od, rpdo);
    slave_step_rpdo(self, rpdo, now, out);
}

static void change_tpdo(struct slave *self, struct tpdo *tpdo, bool mapping, co_us_t now,
                        struct co_outbox *out)
{
    if (mapping)
        remap_tpdo(self, tpdo, now);
    else
        configure_tpdo(self->od, tpdo, now);
    slave_step_tpdo(self, tpdo, now, out);
}

void slave_configure_pdo(struct slave *self, uint16_t index, uint8_t sub, co_us_t now,
                         struct co_outbox *out)
{
    const uint16_t number = (uint16_t)(index % SLAVE_PDO_NUMBER_MAX + 1);
    const bool mapping = (index & SLAVE_PDO_NUMBER_MAX) != 0;
    struct rpdo *rpdo = index < FIRST_TPDO_OBJECT ? slave_rpdo(self, number) : NULL;
    struct tpdo *tpdo = index < FIRST_TPDO_OBJECT ? NULL : slave_tpdo(self, number);

    if (mapping && !maps_anew(self->od, index, sub))
        return;
    if (rpdo != NULL)
        change_rpdo(self, rpdo, mapping, now, out);
    if (tpdo != NULL)
        change_tpdo(self, tpdo, mapping, now, out);
    fill_table(self);
}

static bool is_synchronous(uint32_t cob_id, uint8_t type)
{
    return (cob_id & COB_ID_INVALID) == 0 && type <= TPDO_SYNC_TYPE_MAX;
}

bool slave_has_synchronous_pdo(const struct slave *self)
{
    const struct slave_pdos *pdos = self->pdos;

    for (unsigned i = 0; i < pdos->rpdo_count; i++)
        if (is_synchronous(pdos->rpdos[i].cob_id, pdos->rpdos[i].type))
            return true;
    for (unsigned i = 0; i < pdos->tpdo_count; i++)
        if (is_synchronous(pdos->tpdos[i].cob_id, pdos->tpdos[i].type) ||
            (pdos->tpdos[i].type == TPDO_SYNC_REQUEST && tpdo_is_valid(&pdos->tpdos[i])))
            return true;
    return false;
}

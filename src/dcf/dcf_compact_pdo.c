/* Compact PDOs: the file only tells their number and which parameters they have. */
#include "dcf/dcf_build.h"

#include "base/bytes.h"

#include <stdlib.h>

#define PDOS_MAX       512u
#define PREDEFINED_PDO 4u
#define MAPPING_BITS   64u
#define MAPPING_OFFSET 0x200u
#define EVENT_DRIVEN   0xFFu

static const struct {
    uint8_t bit;
    uint8_t sub;
    uint8_t type;
    const char *name;
} pdo_subs[] = {
    { 0, 1, OD_UNSIGNED32, "COB-ID" },       { 1, 2, OD_UNSIGNED8, "Transmission type" },
    { 2, 3, OD_UNSIGNED16, "Inhibit time" }, { 3, 4, OD_UNSIGNED8, "Reserved" },
    { 4, 5, OD_UNSIGNED16, "Event timer" },  { 5, 6, OD_UNSIGNED8, "SYNC start value" },
};

#define PDO_SUB_COUNT (sizeof pdo_subs / sizeof pdo_subs[0])

static struct dcf_entry *build_number(struct dcf_builder *self, uint16_t index, unsigned sub,
                                      uint8_t type, const char *name)
{
    struct dcf_entry *entry = dcf_build_entry(self, index, (uint8_t)sub);

    if (!entry)
        return NULL;
    entry->type = type;
    entry->access = OD_RW;
    if (sub == 0)
        entry->object_type = OBJECT_RECORD;
    dcf_set_text(self, &entry->name, name);
    dcf_set_number(self, &entry->initial, od_type_size(type), 0);
    return entry;
}

/* The first four PDOs have the identifiers of the pre-defined connection set, the others none. */
static void set_cob_id(struct dcf_entry *entry, unsigned number)
{
    bool transmit = entry->index >= 0x1800;
    uint32_t base = (transmit ? 0x180u : 0x200u) + 0x100u * number;

    if (!entry->initial.given)
        return;
    entry->initial.has_node_id = number < PREDEFINED_PDO;
    put_le32(entry->initial.bytes, number < PREDEFINED_PDO ? base : 0x80000000u);
}

static void build_parameter(struct dcf_builder *self, uint16_t index, unsigned number, size_t place)
{
    uint8_t sub = pdo_subs[place].sub;
    struct dcf_entry *entry = build_number(self, index, sub, pdo_subs[place].type,
                                           pdo_subs[place].name);

    if (!entry || !entry->initial.given)
        return;
    if (sub == 1)
        set_cob_id(entry, number);
    if (sub == 2)
        entry->initial.bytes[0] = EVENT_DRIVEN;
}

static void build_communication(struct dcf_builder *self, uint16_t index, unsigned number)
{
    struct dcf_entry *entry = build_number(self, index, 0, OD_UNSIGNED8, "Highest sub-index");

    if (!entry)
        return;
    entry->access = OD_CONST;
    for (size_t i = 0; i < PDO_SUB_COUNT; i++) {
        if (entry->initial.given && (self->compact_pdo >> pdo_subs[i].bit & 1))
            entry->initial.bytes[0] = pdo_subs[i].sub;
    }
    for (size_t i = 0; i < PDO_SUB_COUNT; i++) {
        if (self->compact_pdo >> pdo_subs[i].bit & 1)
            build_parameter(self, index, number, i);
    }
}

static void build_mapping(struct dcf_builder *self, uint16_t index)
{
    unsigned granularity = self->dcf->granularity;
    unsigned count = granularity ? MAPPING_BITS / granularity : MAPPING_BITS / 8;

    build_number(self, index, 0, OD_UNSIGNED8, "Number of mapped objects");
    for (unsigned sub = 1; sub <= count && !self->no_memory; sub++)
        build_number(self, index, sub, OD_UNSIGNED32, "Mapped object");
}

static bool is_described(const struct dcf_builder *self, size_t described, unsigned index)
{
    struct dcf file = { .entries = self->dcf->entries, .count = described };

    return dcf_has_object(&file, (uint16_t)index);
}

/* Adds the parts without a section: of PDOs that have one of both, and as many as are announced. */
static void build_pdos(struct dcf_builder *self, unsigned first, unsigned announced,
                       size_t described)
{
    unsigned count = 0;

    for (unsigned i = 0; i < PDOS_MAX; i++)
        count += is_described(self, described, first + i) ||
                 is_described(self, described, first + MAPPING_OFFSET + i);
    for (unsigned i = 0; i < PDOS_MAX && !self->no_memory; i++) {
        unsigned mapping = first + MAPPING_OFFSET + i;
        bool has_communication = is_described(self, described, first + i);
        bool has_mapping = is_described(self, described, mapping);

        if (!has_communication && !has_mapping && count++ >= announced)
            continue;
        if (!has_communication)
            build_communication(self, (uint16_t)(first + i), i);
        if (!has_mapping)
            build_mapping(self, (uint16_t)mapping);
    }
}

void dcf_build_compact_pdos(struct dcf_builder *self)
{
    struct dcf *dcf = self->dcf;
    size_t described = dcf->count;

    if (self->compact_pdo == 0)
        return;
    build_pdos(self, 0x1400, dcf->rx_pdos, described);
    build_pdos(self, 0x1800, dcf->tx_pdos, described);
    if (dcf->count > described)
        dcf_sort_entries(self);
}

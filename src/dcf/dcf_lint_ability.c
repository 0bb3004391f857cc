/* What the device says it can do with PDOs against its PDOs. */
#include "dcf/dcf_lint_parts.h"

struct ability {
    const struct dcf_lint *lint;
    bool has_rpdo, has_tpdo;
    const struct dcf_entry *mapping; /* the first PDO mapping, and the first one writable */
    const struct dcf_entry *writable;
    const struct dcf_entry *lost[2]; /* the first entry for a TPDO, for an RPDO that is not there */
    unsigned lost_count[2];
};

enum { FOR_TPDO, FOR_RPDO };

static void look_at_pdo(struct ability *self, const struct dcf_entry *entry)
{
    if (!self->mapping)
        self->mapping = entry;
    if (!self->writable && entry->sub > 0 && dcf_lint_is_writable(entry))
        self->writable = entry;
}

static bool is_lost(const struct ability *self, const struct dcf_entry *entry, unsigned *ret_for)
{
    bool for_rpdo = entry->access == OD_WO || entry->access == OD_RWW;

    if (!entry->mappable || entry->access == OD_RW)
        return false;
    *ret_for = for_rpdo ? FOR_RPDO : FOR_TPDO;
    return for_rpdo ? !self->has_rpdo : !self->has_tpdo;
}

static void look_at(struct ability *self, const struct dcf_entry *entry)
{
    unsigned direction;

    if (dcf_lint_is_mapping(entry->index))
        look_at_pdo(self, entry);
    if (is_lost(self, entry, &direction) && self->lost_count[direction]++ == 0)
        self->lost[direction] = entry;
}

static void tell_lost(const struct ability *self, unsigned direction)
{
    const struct dcf_entry *entry = self->lost[direction];

    if (entry)
        dcf_tell(self->lint->report, DCF_RULE_MAPPABLE_WITHOUT_PDO, entry->line,
                 "%04Xh:%02X PDOMapping: 0 expected (%s, and the device has no %s), there is 1 (%u "
                 "such entries)",
                 entry->index, entry->sub, dcf_access_text(entry->access),
                 direction == FOR_TPDO ? "TPDO" : "RPDO", self->lost_count[direction]);
}

static void check_granularity(const struct ability *self)
{
    const struct dcf *dcf = self->lint->dcf;

    if (dcf->granularity_line == 0 || !self->mapping)
        return;
    if (dcf->granularity == 0 && self->writable)
        dcf_tell(self->lint->report, DCF_RULE_GRANULARITY, dcf->granularity_line,
                 "[DeviceInfo] Granularity: 1..64 expected (the mapping can be changed, %04Xh:%02X "
                 "is %s), there is 0",
                 self->writable->index, self->writable->sub,
                 dcf_access_text(self->writable->access));
    if (dcf->granularity != 0 && !self->writable)
        dcf_tell(self->lint->report, DCF_RULE_GRANULARITY, dcf->granularity_line,
                 "[DeviceInfo] Granularity: 0 expected (no mapping can be changed, %04Xh is "
                 "read-only), there is %u",
                 self->mapping->index, dcf->granularity);
}

static bool has_pdos(const struct dcf *dcf, uint16_t first, unsigned announced)
{
    size_t place = dcf_place(dcf, first, 0);

    return announced > 0 || (place < dcf->count && dcf->entries[place].index <= first + 0x1FF);
}

void dcf_lint_abilities(const struct dcf_lint *self)
{
    struct ability ability = { .lint = self };

    ability.has_rpdo = has_pdos(self->dcf, 0x1400, self->dcf->rx_pdos);
    ability.has_tpdo = has_pdos(self->dcf, 0x1800, self->dcf->tx_pdos);
    for (size_t i = 0; i < self->dcf->count; i++)
        look_at(&ability, &self->dcf->entries[i]);
    tell_lost(&ability, FOR_TPDO);
    tell_lost(&ability, FOR_RPDO);
    check_granularity(&ability);
}

/* What a configuration writes into PDOs: will the device take it? */
#include "audit.h"

#include "od/od.h"

#define BITS_MAX  64u
#define DUMMY_END 0x20u /* data types as objects */

static bool has_size(const struct dcf_entry *entry, unsigned bits)
{
    if (entry->type == OD_BOOLEAN && bits == 1)
        return true;
    return od_type_size(entry->type) != 0 && od_type_size(entry->type) * 8 == bits;
}

static bool has_direction(const struct dcf_entry *entry, bool transmit)
{
    switch ((enum od_access)entry->access) {
    case OD_RO:
    case OD_CONST:
    case OD_RWR: return transmit;
    case OD_WO:
    case OD_RWW: return !transmit;
    case OD_RW:
    case OD_NONE: return true;
    }
    return true;
}

static const char *judge_dummy(const struct audit_pdo *pdo, uint16_t index)
{
    if (pdo->transmit)
        return "a dummy may be in an RPDO only";
    if (index < 8 && (pdo->node->description.dummy_usage & 1u << index) == 0)
        return "[DummyUsage] does not allow this dummy";
    return NULL;
}

/* Why the device will refuse to map this; NULL: it will not. */
static const char *judge(const struct audit_pdo *pdo, uint32_t mapped)
{
    const uint16_t index = (uint16_t)(mapped >> 16);
    const struct dcf_entry *entry = dcf_find(&pdo->node->description, index,
                                             (uint8_t)(mapped >> 8));

    if (index < DUMMY_END)
        return judge_dummy(pdo, index);
    if (!entry)
        return "the device has no such entry";
    if (!entry->mappable)
        return "its PDOMapping is 0";
    if (!has_direction(entry, pdo->transmit))
        return pdo->transmit ? "it is for RPDOs only" : "it is for TPDOs only";
    return has_size(entry, mapped & 0xFF) ? NULL : "the entry has another size";
}

static void check(const struct audit_pdo *pdo)
{
    const struct audit_node *node = pdo->node;
    const uint16_t index = (uint16_t)((pdo->transmit ? 0x1A00 : 0x1600) + pdo->number - 1);
    const struct audit_value count = audit_value(node, index, 0);

    for (uint8_t i = 0; node->described && i < pdo->count; i++) {
        const struct audit_value value = audit_value(node, index, (uint8_t)(i + 1));
        const char *why = value.written ? judge(pdo, pdo->mapped[i]) : NULL;

        if (why)
            audit_tell(node->network, value.place, AUDIT_RULE_PDO_MAPPING,
                       "%s: %04Xh:%02X maps %04Xh:%02X with %u bits into %s, but %s: boot error J",
                       audit_label(node).text, index, i + 1u, pdo->mapped[i] >> 16,
                       pdo->mapped[i] >> 8 & 0xFF, pdo->mapped[i] & 0xFF, audit_pdo_label(pdo).text,
                       why);
    }
    if (pdo->is_mapped && pdo->bits > BITS_MAX && pdo->is_meant)
        audit_tell(node->network, count.place, AUDIT_RULE_PDO_MAPPING,
                   "%s: %04Xh maps %u bits into %s, 64 expected at most", audit_label(node).text,
                   index, pdo->bits, audit_pdo_label(pdo).text);
}

static void check_type(const struct audit_pdo *pdo)
{
    if (pdo->has_type && pdo->is_meant && pdo->type > 240 && pdo->type < 252)
        audit_tell(pdo->node->network, pdo->type_place, AUDIT_RULE_PDO_TYPE,
                   "%s: transmission type %u of %s is reserved: 0 to 240 and 252 to 255 expected",
                   audit_label(pdo->node).text, pdo->type, audit_pdo_label(pdo).text);
}

void audit_check_mapping(struct audit_network *self)
{
    for (size_t i = 0; i < self->pdo_count; i++) {
        check(&self->pdos[i]);
        check_type(&self->pdos[i]);
    }
}

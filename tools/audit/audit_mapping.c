/* What a configuration writes into PDOs: will the device take it? */
#include "audit.h"

#include "od/od.h"

#define BITS_MAX    64u
#define DUMMY_END   0x20u /* data types as objects */
#define MULTIPLEXED 0xFEu /* no number of objects from here on */

/* A maker who lets strings and domains be mapped knows how much of them. */
static bool has_size(const struct dcf_entry *entry, unsigned bits)
{
    return od_type_size(entry->type) == 0 || od_type_size(entry->type) * 8 >= bits;
}

static bool is_part(const struct audit_pdo *pdo, uint32_t mapped)
{
    const struct dcf_entry *entry = dcf_find(&pdo->node->description, (uint16_t)(mapped >> 16),
                                             (uint8_t)(mapped >> 8));

    return entry && entry->type != OD_BOOLEAN && mapped >> 16 >= DUMMY_END &&
           (mapped & 0xFF) < od_type_size(entry->type) * 8;
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
    if (!od_access_fits(entry->access, pdo->transmit))
        return pdo->transmit ? "it is for RPDOs only" : "it is for TPDOs only";
    return has_size(entry, mapped & 0xFF) ? NULL : "the entry has fewer";
}

static void check_entry(const struct audit_pdo *pdo, uint8_t sub, const struct audit_value *value)
{
    const struct audit_node *node = pdo->node;
    const uint32_t mapped = pdo->mapped[sub - 1];
    const char *why = judge(pdo, mapped);

    if (why)
        audit_tell(node->network, value->place, AUDIT_RULE_PDO_MAPPING,
                   "%s: %04Xh:%02X maps %04Xh:%02X with %u bits into %s, but %s: boot error J",
                   audit_label(node).text, audit_mapping_index(pdo), sub, mapped >> 16,
                   mapped >> 8 & 0xFF, mapped & 0xFF, audit_pdo_label(pdo).text, why);
    else if (is_part(pdo, mapped))
        audit_tell(node->network, value->place, AUDIT_RULE_PDO_PART,
                   "%s: %04Xh:%02X maps %04Xh:%02X with %u bits into %s, the entry has more: most "
                   "devices refuse that (boot error J)",
                   audit_label(node).text, audit_mapping_index(pdo), sub, mapped >> 16,
                   mapped >> 8 & 0xFF, mapped & 0xFF, audit_pdo_label(pdo).text);
}

static void check_count(const struct audit_pdo *pdo)
{
    const uint16_t index = audit_mapping_index(pdo);
    const struct audit_value count = audit_value(pdo->node, index, 0);

    if (count.chosen && count.number > 0 && count.number < MULTIPLEXED &&
        audit_lacks(pdo->node, index, (uint8_t)count.number))
        audit_tell(pdo->node->network, count.place, AUDIT_RULE_PDO_MAPPING,
                   "%s: %04Xh:00 maps %u objects into %s, but the device has no %04Xh:%02X: boot "
                   "error J",
                   audit_label(pdo->node).text, index, (unsigned)count.number,
                   audit_pdo_label(pdo).text, index, (unsigned)count.number);
}

static void check(const struct audit_pdo *pdo)
{
    const struct audit_node *node = pdo->node;
    const uint16_t index = audit_mapping_index(pdo);

    for (uint8_t sub = 1; node->described && sub <= pdo->count; sub++) {
        const struct audit_value value = audit_value(node, index, sub);

        if (value.chosen)
            check_entry(pdo, sub, &value);
    }
    if (pdo->is_mapped && pdo->bits > BITS_MAX && pdo->is_meant)
        audit_tell(node->network, audit_value(node, index, 0).place, AUDIT_RULE_PDO_MAPPING,
                   "%s: %04Xh maps %u bits into %s, 64 expected at most", audit_label(node).text,
                   index, pdo->bits, audit_pdo_label(pdo).text);
}

static void check_type(const struct audit_pdo *pdo)
{
    const uint8_t event = pdo->transmit ? 252 : 254; /* 252 and 253 are requests, for TPDOs only */

    if (pdo->has_type && pdo->is_meant && pdo->type > 240 && pdo->type < event)
        audit_tell(pdo->node->network, pdo->type_place, AUDIT_RULE_PDO_TYPE,
                   "%s: transmission type %u of %s is reserved: 0 to 240 and %u to 255 expected",
                   audit_label(pdo->node).text, pdo->type, audit_pdo_label(pdo).text, event);
}

void audit_check_mapping(struct audit_network *self)
{
    for (size_t i = 0; i < self->pdo_count; i++) {
        check(&self->pdos[i]);
        check_count(&self->pdos[i]);
        check_type(&self->pdos[i]);
    }
}

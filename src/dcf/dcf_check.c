/* Values against their limits; which entries a configuration writes. */
#include "dcf/dcf_build.h"

#include "base/bytes.h"

#include <stdio.h>
#include <string.h>

#define FLAG_NO_DOWNLOAD 1u

static bool is_left_alone(uint16_t index)
{
    switch (index) {
    case 0x1000:
    case 0x1001:
    case 0x1010: /* a configuration does not save ... */
    case 0x1011: /* ... or restore */
    case 0x1018:
    case 0x1200:
    case 0x1F50: /* programs are no configuration */
    case 0x1F51: return true;
    default: return false;
    }
}

bool dcf_entry_downloads(const struct dcf_entry *entry)
{
    return entry->access != OD_RO && entry->access != OD_CONST &&
           !(entry->flags & FLAG_NO_DOWNLOAD) && !is_left_alone(entry->index);
}

bool dcf_stays_below(const char *name)
{
    const char *part = name;

    if (name[0] == '/' || name[0] == '\\' || (name[0] != '\0' && name[1] == ':'))
        return false;
    while (*part != '\0') {
        size_t size = strcspn(part, "/\\");

        if (size == 2 && memcmp(part, "..", 2) == 0)
            return false;
        part += size;
        part += *part != '\0';
    }
    return name[0] != '\0';
}

uint64_t dcf_value_number(const struct dcf_value *value, uint8_t type, uint8_t node_id)
{
    uint64_t number = get_le(value->bytes, value->size);
    unsigned bits = 8 * value->size;

    if (value->has_node_id)
        number += node_id;
    if (bits >= 64 || bits == 0)
        return number;
    number &= ((uint64_t)1 << bits) - 1;
    if (od_type_signed(type) && number >> (bits - 1))
        number |= UINT64_MAX << bits;
    return number;
}

static double real_of(const struct dcf_value *value, uint8_t type)
{
    uint64_t bits = get_le(value->bytes, value->size);
    uint32_t bits32 = (uint32_t)bits;
    float single;
    double number;

    if (type == OD_REAL32) {
        memcpy(&single, &bits32, sizeof single);
        return (double)single;
    }
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* As by strcmp(). A REAL that is no number is outside of nothing. */
static int compare(const struct dcf_value *left, const struct dcf_value *right, uint8_t type,
                   uint8_t node_id)
{
    uint64_t a, b;

    if (type == OD_REAL32 || type == OD_REAL64)
        return (real_of(left, type) > real_of(right, type)) -
               (real_of(left, type) < real_of(right, type));
    a = dcf_value_number(left, type, node_id);
    b = dcf_value_number(right, type, node_id);
    if (od_type_signed(type))
        return ((int64_t)a > (int64_t)b) - ((int64_t)a < (int64_t)b);
    return (a > b) - (a < b);
}

struct dcf_shown dcf_number_text(const struct dcf_value *value, uint8_t type, uint8_t node_id)
{
    struct dcf_shown shown = { "(none)" };
    uint64_t number;

    if (!value->given)
        return shown;
    number = dcf_value_number(value, type, node_id);
    if (type == OD_REAL32 || type == OD_REAL64)
        snprintf(shown.text, sizeof shown.text, "%g", real_of(value, type));
    else if (od_type_signed(type))
        snprintf(shown.text, sizeof shown.text, "%lld", (long long)number);
    else
        snprintf(shown.text, sizeof shown.text, "%llu", (unsigned long long)number);
    return shown;
}

bool dcf_value_outside(const struct dcf_entry *entry, const struct dcf_value *value,
                       uint8_t node_id)
{
    return value->given &&
           ((entry->low.given && compare(value, &entry->low, entry->type, node_id) < 0) ||
            (entry->high.given && compare(value, &entry->high, entry->type, node_id) > 0));
}

static void check_limits(struct dcf_builder *self, struct dcf_entry *entry, uint8_t node_id)
{
    if (!entry->low.given || !entry->high.given ||
        compare(&entry->low, &entry->high, entry->type, node_id) <= 0)
        return;
    dcf_tell(self->report, DCF_RULE_LIMIT_ORDER, entry->low.line,
             "%04Xh:%02X: LowLimit up to HighLimit expected, there are %s and %s: both are "
             "ignored",
             entry->index, entry->sub, dcf_number_text(&entry->low, entry->type, node_id).text,
             dcf_number_text(&entry->high, entry->type, node_id).text);
    entry->low.given = false;
    entry->high.given = false;
}

static void check_value(struct dcf_builder *self, const struct dcf_entry *entry,
                        const struct dcf_value *value, uint8_t node_id)
{
    bool parameter = value == &entry->parameter;
    enum dcf_rule rule = !parameter                   ? DCF_RULE_DEFAULT_LIMITS
                         : dcf_entry_downloads(entry) ? DCF_RULE_PARAMETER_LIMITS
                                                      : DCF_RULE_UNWRITTEN_LIMITS;
    char text[300];

    if (!dcf_value_outside(entry, value, node_id))
        return;
    snprintf(text, sizeof text, "%s: %s to %s expected (its limits), there is %s",
             parameter ? "ParameterValue" : "DefaultValue",
             dcf_number_text(&entry->low, entry->type, node_id).text,
             dcf_number_text(&entry->high, entry->type, node_id).text,
             dcf_number_text(value, entry->type, node_id).text);
    dcf_tell(self->report, rule, value->line, "%04Xh:%02X %s", entry->index, entry->sub, text);
}

bool dcf_formula_fits(const struct dcf_value *value, uint8_t node_id)
{
    uint64_t most = value->size >= 8 ? UINT64_MAX : ((uint64_t)1 << 8 * value->size) - 1;

    return !value->given || !value->has_node_id ||
           get_le(value->bytes, value->size) <= most - node_id;
}

static void check_formula(struct dcf_builder *self, const struct dcf_entry *entry,
                          const struct dcf_value *value, uint8_t node_id)
{
    if (!dcf_formula_fits(value, node_id))
        dcf_tell(self->report, DCF_RULE_NODE_ID_FORMULA, value->line,
                 "%04Xh:%02X: a value of %s expected, with node-ID %u this is too large",
                 entry->index, entry->sub, od_type_name(entry->type), node_id);
}

void dcf_check_values(struct dcf_builder *self)
{
    dcf_check_values_from(self, 0);
}

void dcf_check_values_from(struct dcf_builder *self, size_t first)
{
    struct dcf *dcf = self->dcf;
    uint8_t node_id = dcf->has_node_id ? dcf->node_id : 1;

    for (size_t i = first; i < dcf->count; i++) {
        struct dcf_entry *entry = &dcf->entries[i];

        check_limits(self, entry, node_id);
        check_value(self, entry, &entry->initial, node_id);
        check_value(self, entry, &entry->parameter, node_id);
        if (dcf->has_node_id)
            check_formula(self, entry, &entry->parameter, node_id);
    }
}

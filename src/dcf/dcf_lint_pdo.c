/* Communication parameters of PDOs. */
#include "dcf/dcf_lint_parts.h"

#define MAPPING_OFFSET 0x200u
#define FIRST_TRANSMIT 0x1800u
#define COB_NO_RTR     0x40000000u
#define SYNC_LAST      240u
#define RTR_SYNC       252u
#define RTR_EVENT      253u
#define EVENT_FIRST    254u

struct pdo {
    const struct dcf_lint *lint;
    const struct dcf_lint_object *object;
    uint16_t index;
    bool transmit;
};

static bool effective(const struct pdo *self, unsigned sub, uint64_t *ret_number,
                      unsigned *ret_line)
{
    const struct dcf_entry *entry = dcf_lint_sub(self->object, sub);
    const struct dcf_value *value = entry ? dcf_lint_effective(entry) : NULL;

    if (!value || !dcf_lint_number(self->lint, entry, value, ret_number))
        return false;
    *ret_line = value->line;
    return true;
}

static bool is_reserved(const struct pdo *self, uint64_t type)
{
    return type > SYNC_LAST && type < (self->transmit ? RTR_SYNC : EVENT_FIRST);
}

static void check_type_value(const struct pdo *self, const struct dcf_entry *entry,
                             const struct dcf_value *value)
{
    uint64_t type;

    if (dcf_lint_number(self->lint, entry, value, &type) && is_reserved(self, type))
        dcf_tell(self->lint->report, DCF_RULE_TRANSMISSION_TYPE, value->line,
                 "%04Xh:02: a transmission type of 0..240%s, 254 or 255 expected, there is %u",
                 self->index, self->transmit ? ", 252, 253" : "", (unsigned)type);
}

/* What the type asks for: SYNC, or a request that the COB-ID refuses. */
static void check_type(const struct pdo *self, uint64_t cob_id)
{
    uint64_t type;
    unsigned line;

    if (!effective(self, 2, &type, &line))
        return;
    if (self->transmit && (type == RTR_SYNC || type == RTR_EVENT) && (cob_id & COB_NO_RTR))
        dcf_tell(self->lint->report, DCF_RULE_TYPE_WITHOUT_RTR, line,
                 "%04Xh:02: a COB-ID that allows RTR (bit 30 is 0) expected for transmission type "
                 "%u",
                 self->index, (unsigned)type);
    if ((type <= SYNC_LAST || (self->transmit && type == RTR_SYNC)) &&
        !dcf_has_object(self->lint->dcf, 0x1005))
        dcf_tell(self->lint->report, DCF_RULE_TYPE_WITHOUT_SYNC, line,
                 "%04Xh:02: an object 1005h (COB-ID SYNC) expected for transmission type %u",
                 self->index, (unsigned)type);
}

static void check_times(const struct pdo *self)
{
    uint64_t inhibit, event;
    unsigned line;

    if (effective(self, 3, &inhibit, &line) && effective(self, 5, &event, &line) && event > 0 &&
        10 * event < inhibit)
        dcf_tell(self->lint->report, DCF_RULE_EVENT_AND_INHIBIT, line,
                 "%04Xh:05: an event timer not below the inhibit time (%u x 100 us) expected, "
                 "there are %u ms",
                 self->index, (unsigned)inhibit, (unsigned)event);
}

static void check_start(const struct pdo *self)
{
    const struct dcf_entry *overflow = dcf_find(self->lint->dcf, 0x1019, 0);
    uint64_t start, counts;
    unsigned line;

    if (!effective(self, 6, &start, &line) || start == 0)
        return;
    if (overflow && dcf_lint_number(self->lint, overflow, dcf_lint_effective(overflow), &counts) &&
        counts > 1 && start > counts)
        dcf_tell(self->lint->report, DCF_RULE_SYNC_START, line,
                 "%04Xh:06: a SYNC start value of 0..%u expected (1019h), there is %u", self->index,
                 (unsigned)counts, (unsigned)start);
    else if (start > SYNC_LAST)
        dcf_tell(self->lint->report, DCF_RULE_SYNC_START, line,
                 "%04Xh:06: a SYNC start value of 0..240 expected, there is %u", self->index,
                 (unsigned)start);
}

static void check_enabled(const struct pdo *self)
{
    uint64_t cob_id;
    unsigned line;

    if (!effective(self, 1, &cob_id, &line) || (cob_id & DCF_LINT_COB_INVALID))
        return;
    check_type(self, cob_id);
    if (self->transmit) {
        check_times(self);
        check_start(self);
    }
}

void dcf_lint_communication(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    struct pdo pdo = { .lint = self, .object = object, .index = object->entries->index };
    const struct dcf_entry *type = dcf_lint_sub(object, 2);

    pdo.transmit = pdo.index >= FIRST_TRANSMIT;
    if (type) {
        check_type_value(&pdo, type, &type->initial);
        check_type_value(&pdo, type, &type->parameter);
    }
    check_enabled(&pdo);
    if (!dcf_has_object(self->dcf, (uint16_t)(pdo.index + MAPPING_OFFSET)))
        dcf_tell(self->report, DCF_RULE_PDO_WITHOUT_MAPPING, object->entries->line,
                 "%04Xh: an object %04Xh (PDO mapping) expected, it is missing", pdo.index,
                 pdo.index + MAPPING_OFFSET);
}

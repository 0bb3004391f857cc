/* What PDOs map: whether it is there, can be mapped in this direction, and fits into 64 bits. */
#include "dcf/dcf_lint_parts.h"

#define MAPPING_OFFSET 0x200u
#define FIRST_TRANSMIT 0x1A00u
#define MAPPED_MAX     64u
#define BITS_MAX       64u
#define MPDO_SOURCE    0xFEu /* in sub-index 0: kinds of MPDO */
#define DUMMY_LAST     0x1Fu /* data types as objects */

struct mapping {
    const struct dcf_lint *lint;
    const struct dcf_lint_object *object;
    bool transmit;
    bool configured; /* the ParameterValues count, else the DefaultValues alone */
    bool enabled;
    unsigned count;
    bool has_count; /* the file tells it */
};

struct mapped { /* one entry */
    const struct dcf_entry *entry;
    unsigned line;
    uint16_t index;
    uint8_t sub;
    uint8_t bits;
};

static const struct dcf_value *value_of(const struct mapping *self, const struct dcf_entry *entry)
{
    if (!entry)
        return NULL;
    if (self->configured)
        return dcf_lint_effective(entry);
    return entry->initial.given ? &entry->initial : NULL;
}

static bool number_of(const struct mapping *self, const struct dcf_entry *entry,
                      uint64_t *ret_number)
{
    return dcf_lint_number(self->lint, entry, value_of(self, entry), ret_number);
}

/* --- one mapped object --- */

static bool fits(unsigned bits, uint8_t type)
{
    return bits == 8 * od_type_size(type) || (type == OD_BOOLEAN && bits == 1);
}

static void tell_length(const struct mapping *self, const struct mapped *mapped, uint8_t type)
{
    unsigned bits = type == OD_BOOLEAN ? 1 : 8 * od_type_size(type);

    if (od_type_size(type) == 0 || fits(mapped->bits, type))
        return;
    dcf_tell(self->lint->report, DCF_RULE_MAPPING_LENGTH, mapped->line,
             "%04Xh:%02X: %u bits of %04Xh:%02X expected (it is %s), there are %u",
             mapped->entry->index, mapped->entry->sub, bits, mapped->index, mapped->sub,
             od_type_name(type), mapped->bits);
}

static void check_dummy(const struct mapping *self, const struct mapped *mapped)
{
    const struct dcf *dcf = self->lint->dcf;

    if (self->transmit)
        dcf_tell(self->lint->report, DCF_RULE_DUMMY_IN_TPDO, mapped->line,
                 "%04Xh:%02X: an object expected, a TPDO cannot have the dummy %04Xh",
                 mapped->entry->index, mapped->entry->sub, mapped->index);
    else if (mapped->index < 8 && !(dcf->dummy_usage >> mapped->index & 1))
        dcf_tell(self->lint->report, DCF_RULE_DUMMY_USAGE, mapped->line,
                 "%04Xh:%02X: an object expected, [DummyUsage] does not allow the dummy %04Xh",
                 mapped->entry->index, mapped->entry->sub, mapped->index);
    tell_length(self, mapped, (uint8_t)mapped->index);
}

static void check_target(const struct mapping *self, const struct mapped *mapped,
                         const struct dcf_entry *target)
{
    struct co_report *report = self->lint->report;

    tell_length(self, mapped, target->type);
    if (!self->enabled)
        return;
    if (!target->mappable)
        dcf_tell(report, DCF_RULE_MAPPED_NOT_MAPPABLE, mapped->line,
                 "%04Xh:%02X: an object with PDOMapping=1 expected, %04Xh:%02X has 0",
                 mapped->entry->index, mapped->entry->sub, mapped->index, mapped->sub);
    else if (!od_access_fits(target->access, self->transmit))
        dcf_tell(report, DCF_RULE_MAPPING_DIRECTION, mapped->line,
                 "%04Xh:%02X: an object that can be %s expected in %s, %04Xh:%02X is %s",
                 mapped->entry->index, mapped->entry->sub, self->transmit ? "read" : "written",
                 self->transmit ? "a TPDO" : "an RPDO", mapped->index, mapped->sub,
                 dcf_access_text(target->access));
}

static void check_granularity(const struct mapping *self, const struct mapped *mapped)
{
    if (self->enabled && mapped->bits < self->lint->dcf->granularity)
        dcf_tell(self->lint->report, DCF_RULE_MAPPING_GRANULARITY, mapped->line,
                 "%04Xh:%02X: at least %u bits expected (Granularity), there are %u",
                 mapped->entry->index, mapped->entry->sub, self->lint->dcf->granularity,
                 mapped->bits);
}

static void check_mapped(const struct mapping *self, const struct mapped *mapped)
{
    const struct dcf_entry *target = dcf_find(self->lint->dcf, mapped->index, mapped->sub);

    if (mapped->index <= DUMMY_LAST)
        check_dummy(self, mapped);
    else if (target)
        check_target(self, mapped, target);
    else if (self->enabled)
        dcf_tell(self->lint->report, DCF_RULE_MAPPED_MISSING, mapped->line,
                 "%04Xh:%02X: an object of this file expected, there is no %04Xh:%02X",
                 mapped->entry->index, mapped->entry->sub, mapped->index, mapped->sub);
    if (mapped->bits > 0)
        check_granularity(self, mapped);
}

/* --- all of them --- */

static void tell_gap(const struct mapping *self, unsigned sub, const char *what)
{
    const struct dcf_entry *first = self->object->entries;
    const struct dcf_value *value = value_of(self, first);

    dcf_tell(self->lint->report, DCF_RULE_MAPPING_GAP, value ? value->line : first->line,
             "%04Xh: %u mapped objects expected (sub-index 0), sub-index %u is %s", first->index,
             self->count, sub, what);
}

static bool same_as_initial(const struct mapping *self, const struct dcf_entry *entry)
{
    uint64_t number, initial;

    return dcf_lint_number(self->lint, entry, &entry->initial, &initial) &&
           number_of(self, entry, &number) && number == initial;
}

/* True for what the look at the DefaultValues has found already. */
static bool is_told(const struct mapping *self, const struct mapping *before,
                    const struct dcf_entry *entry)
{
    return before && before->enabled >= self->enabled && entry->sub <= before->count &&
           same_as_initial(self, entry);
}

/*
 * The sum of the bits; what is behind a gap is not looked at. A PDO that is off may have a number
 * of mapped objects and none of them: whoever switches it on gives them.
 */
static unsigned check_entries(const struct mapping *self, const struct mapping *before)
{
    unsigned bits = 0;

    for (unsigned sub = 1; sub <= self->count; sub++) {
        const struct dcf_entry *entry = dcf_lint_sub(self->object, sub);
        uint64_t number = 0;
        struct mapped mapped;

        if (!entry || (number_of(self, entry, &number) && number == 0)) {
            if (self->enabled || sub > 1)
                tell_gap(self, sub, entry ? "empty" : "missing");
            return bits;
        }
        if (number == 0)
            continue;
        mapped = (struct mapped){ .entry = entry,
                                  .line = value_of(self, entry)->line,
                                  .index = (uint16_t)(number >> 16),
                                  .sub = (uint8_t)(number >> 8),
                                  .bits = (uint8_t)number };
        bits += mapped.bits;
        if (!is_told(self, before, entry))
            check_mapped(self, &mapped);
    }
    return bits;
}

static void check_count(const struct mapping *self, const struct mapping *before)
{
    const struct dcf_entry *first = self->object->entries;
    const struct dcf_value *value = value_of(self, first);
    bool told = before && is_told(self, before, first);
    unsigned line = value ? value->line : first->line;
    unsigned bits;

    if (self->count >= MPDO_SOURCE) {
        if (self->enabled && !told && !self->lint->dcf->group_messaging)
            dcf_tell(self->lint->report, DCF_RULE_MPDO, line,
                     "%04Xh:00: GroupMessaging=1 in [DeviceInfo] expected, this is an MPDO",
                     first->index);
        return;
    }
    if (self->count > MAPPED_MAX) {
        dcf_tell(self->lint->report, DCF_RULE_MAPPING_COUNT, line,
                 "%04Xh:00: at most %u mapped objects expected, or 254 or 255, there are %u",
                 first->index, MAPPED_MAX, self->count);
        return;
    }
    bits = check_entries(self, before);
    if (bits > BITS_MAX)
        dcf_tell(self->lint->report, DCF_RULE_MAPPING_SIZE, line,
                 "%04Xh: at most %u mapped bits expected, there are %u", first->index, BITS_MAX,
                 bits);
}

/* Where sub-index 0 tells nothing: up to the first one that is not used. */
static void find_count(struct mapping *self)
{
    const struct dcf_lint_object *object = self->object;
    uint64_t number;

    self->has_count = object->entries->sub == 0 && number_of(self, object->entries, &number);
    if (self->has_count) {
        self->count = (unsigned)(number & 0xFF);
        return;
    }
    self->count = 0;
    while (self->count < MAPPED_MAX &&
           number_of(self, dcf_lint_sub(object, self->count + 1), &number) && number != 0)
        self->count++;
}

static struct mapping look(const struct dcf_lint *lint, const struct dcf_lint_object *object,
                           bool configured)
{
    uint16_t index = object->entries->index;
    struct mapping self = { .lint = lint,
                            .object = object,
                            .transmit = index >= FIRST_TRANSMIT,
                            .configured = configured };
    const struct dcf_entry *cob_id = dcf_find(lint->dcf, (uint16_t)(index - MAPPING_OFFSET), 1);
    uint64_t number = 0;

    self.enabled = !number_of(&self, cob_id, &number) || !(number & DCF_LINT_COB_INVALID);
    find_count(&self);
    return self;
}

static bool is_configured(const struct mapping *self)
{
    const struct dcf_lint_object *object = self->object;
    uint16_t index = object->entries->index;
    const struct dcf_entry *cob_id = dcf_find(self->lint->dcf, (uint16_t)(index - MAPPING_OFFSET),
                                              1);

    for (size_t i = 0; i < object->count; i++) {
        if (object->entries[i].parameter.given)
            return true;
    }
    return cob_id && cob_id->parameter.given;
}

static const struct dcf_entry *first_writable(const struct dcf_lint_object *object)
{
    for (size_t i = 0; i < object->count; i++) {
        if (object->entries[i].sub > 0 && dcf_lint_is_writable(&object->entries[i]))
            return &object->entries[i];
    }
    return NULL;
}

/* What is mapped can be changed only while its number is 0 and the PDO is off. */
static void check_access(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    const struct dcf_entry *first = object->entries, *writable = first_writable(object);
    const struct dcf_entry *cob_id = dcf_find(self->dcf, (uint16_t)(first->index - MAPPING_OFFSET),
                                              1);

    if (writable && first->sub == 0 && !dcf_lint_is_writable(first))
        dcf_tell(self->report, DCF_RULE_MAPPING_ACCESS, first->line,
                 "%04Xh:00: a writable number of mapped objects expected (%02X is %s), it is %s",
                 first->index, writable->sub, dcf_access_text(writable->access),
                 dcf_access_text(first->access));
    if (writable && cob_id && !dcf_lint_is_writable(cob_id))
        dcf_tell(self->report, DCF_RULE_MAPPING_COB_ID, cob_id->line,
                 "%04Xh:01: a writable COB-ID expected (%04Xh:%02X is %s), it is %s", cob_id->index,
                 writable->index, writable->sub, dcf_access_text(writable->access),
                 dcf_access_text(cob_id->access));
}

void dcf_lint_mapping(const struct dcf_lint *self, const struct dcf_lint_object *object)
{
    struct mapping initial = look(self, object, false);
    struct mapping configured = look(self, object, true);
    uint16_t communication = (uint16_t)(object->entries->index - MAPPING_OFFSET);

    check_count(&initial, NULL);
    if (is_configured(&initial))
        check_count(&configured, &initial);
    check_access(self, object);
    if (!dcf_has_object(self->dcf, communication))
        dcf_tell(self->report, DCF_RULE_MAPPING_WITHOUT_PDO, object->entries->line,
                 "%04Xh: an object %04Xh (PDO communication parameters) expected, it is missing",
                 object->entries->index, communication);
}

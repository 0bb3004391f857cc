/*
 * Checks of the object dictionary: it is what the EDS says.
 */
#include "check_common.h"
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <stdarg.h>
#include <string.h>

/* Objects that do not do as they are told; for all of them one verdict. */
struct findings {
    struct conform *self;
    unsigned count;
    char text[800];
    size_t length;
};

static void find(struct findings *findings, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

static void find(struct findings *findings, const char *format, ...)
{
    const size_t room = sizeof findings->text - findings->length;
    va_list args;

    findings->count++;
    if (room < 120)
        return;
    va_start(args, format);
    findings->length += (size_t)vsnprintf(findings->text + findings->length, 119, format, args);
    va_end(args);
    findings->text[findings->length++] = '\n';
    findings->text[findings->length] = '\0';
}

static bool conclude(struct conform *self, const struct findings *findings, const char *what)
{
    if (findings->count == 0)
        return true;
    return conform_fail(self, "%u objects %s:\n%s", findings->count, what, findings->text);
}

/* For each object, until the run ends; the frames of those that pass are not kept. */
static void look_at_all(struct findings *findings,
                        void (*look)(struct findings *findings,
                                     const struct conform_object *object))
{
    struct conform *self = findings->self;

    for (size_t i = 0; i < self->object_count && self->end == CONFORM_RUNS; i++) {
        const unsigned before = findings->count;
        const size_t from = conform_mark(self);

        look(findings, &self->objects[i]);
        if (findings->count == before)
            conform_drop(self, from);
    }
}

static void find_result(struct findings *findings, const struct conform_object *object,
                        const char *expected, uint32_t result)
{
    char text[CONFORM_RESULT_SIZE];

    find(findings, "%04Xh:%02X: expected %s, received %s", object->index, object->sub, expected,
         conform_result_text(result, text, sizeof text));
}

static bool is_one_of(uint32_t result, const uint32_t *codes)
{
    while (*codes != 0 && *codes != result)
        codes++;
    return *codes != 0;
}

/* --- reading --- */

/* What may have no data at the moment, or be too much to have it all. */
static bool may_refuse(const struct conform_object *object, uint32_t result)
{
    if (object->index == 0x1003 || od_type_size(object->type) == 0)
        return is_one_of(result, CODES(SDO_NO_DATA, SDO_GENERAL, SDO_NOT_STORED, SDO_DEVICE_STATE,
                                       SDO_LOCAL_CONTROL));
    return false;
}

static void look_at_read(struct findings *findings, const struct conform_object *object)
{
    const uint32_t size = od_type_size(object->type);
    struct conform_value value;
    uint32_t result;

    if (object->access == OD_WO)
        return;
    result = conform_read(findings->self, object->index, object->sub, &value);
    if (result != SDO_OK && !may_refuse(object, result))
        find_result(findings, object, "a value", result);
    if (result == SDO_OK && size != 0 && value.size != size)
        find(findings, "%04Xh:%02X: %s has %u bytes, received %u", object->index, object->sub,
             od_type_name(object->type), (unsigned)size, (unsigned)value.size);
}

static bool check_read(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_read);
    return conclude(self, &findings, "cannot be read as the EDS says");
}

/* Values that live, or belong to this one device. */
static bool has_own_value(const struct conform_object *object)
{
    static const uint16_t living[] = { 0x1001, 0x1002, 0x1003, 0x1010, 0x1011, 0x1013, 0x1F82 };

    for (size_t i = 0; i < sizeof living / sizeof living[0]; i++)
        if (object->index == living[i])
            return true;
    return (object->index == 0x1018 && object->sub == 4) || object->access == OD_WO ||
           (object->access == OD_RO && object->index >= 0x2000 && object->sub != 0);
}

static size_t first_eight(uint32_t size)
{
    return size < 8 ? size : 8;
}

static void look_at_default(struct findings *findings, const struct conform_object *object)
{
    const struct dcf_entry *entry = object->entry;
    uint8_t bytes[CONFORM_VALUE_MAX];
    struct conform_value value;

    if (has_own_value(object) || (entry->flags & 2u) != 0 || !entry->initial.given ||
        entry->initial.size > sizeof bytes || (object->access == OD_RO && entry->mappable))
        return;
    if (conform_read(findings->self, object->index, object->sub, &value) != SDO_OK)
        return; /* a finding of od-read */
    dcf_value(&entry->initial, findings->self->options.node, bytes);
    if (value.size != entry->initial.size || memcmp(value.bytes, bytes, value.size) != 0)
        find(findings, "%04Xh:%02X: the EDS says %llXh, received %llXh", object->index, object->sub,
             (unsigned long long)get_le(bytes, first_eight(entry->initial.size)),
             (unsigned long long)get_le(value.bytes, first_eight(value.size)));
}

static bool check_defaults(struct conform *self)
{
    struct findings findings = { .self = self };

    if (!conform_reset(self, CONFORM_RESET_NODE))
        return false;
    conform_nmt(self, CONFORM_PREOP);
    look_at_all(&findings, look_at_default);
    return conclude(self, &findings,
                    "do not have their DefaultValue after a reset (or have saved values)");
}

/* --- access rights --- */

static void look_at_read_only(struct findings *findings, const struct conform_object *object)
{
    struct conform_value value = { .size = od_type_size(object->type) };
    uint32_t result;

    if (object->access != OD_RO && object->access != OD_CONST)
        return;
    conform_read(findings->self, object->index, object->sub, &value);
    if (value.size == 0 || value.size > CONFORM_VALUE_MAX)
        value.size = od_type_size(object->type) ? od_type_size(object->type) : 1;
    result = conform_write(findings->self, object->index, object->sub, value.bytes, value.size);
    if (!is_one_of(result, CODES(SDO_READ_ONLY, SDO_ACCESS, SDO_GENERAL)))
        find_result(findings, object, "abort 06010002 of a write", result);
}

static bool check_read_only(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_read_only);
    return conclude(self, &findings, "are not as read-only as the EDS says");
}

/* --- limits --- */

static void look_beyond(struct findings *findings, const struct conform_object *object,
                        enum check_side side)
{
    struct conform *self = findings->self;
    uint8_t bytes[8];
    uint32_t size, result;

    if (!check_beyond_limit(self, object, side, bytes, &size))
        return;
    result = conform_write(self, object->index, object->sub, bytes, size);
    if (!is_one_of(result, CODES(SDO_INVALID_VALUE, SDO_VALUE_HIGH, SDO_VALUE_LOW, SDO_GENERAL)))
        find_result(findings, object,
                    side == CHECK_ABOVE ? "abort 06090031 above its limit"
                                        : "abort 06090032 below its limit",
                    result);
}

static void look_at_limits(struct findings *findings, const struct conform_object *object)
{
    if ((!check_is_writable(object) && object->access != OD_WO) ||
        check_takes_signature(object->index))
        return;
    look_beyond(findings, object, CHECK_ABOVE);
    look_beyond(findings, object, CHECK_BELOW);
}

static bool check_limits(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_limits);
    return conclude(self, &findings, "take values outside their limits");
}

/* --- writing the defaults --- */

/* Signatures, the error history, programs, and what is refused while its PDO is valid. */
static bool needs_procedure(const struct conform_object *object)
{
    const uint16_t index = object->index;

    return check_takes_signature(index) || index == 0x1003 ||
           (index >= 0x1F50 && index <= 0x1F58) || (index >= 0x1600 && index <= 0x17FF) ||
           (index >= 0x1A00 && index <= 0x1BFF) ||
           (index >= 0x1800 && index <= 0x19FF && (object->sub == 3 || object->sub == 6));
}

static void look_at_write_default(struct findings *findings, const struct conform_object *object)
{
    const struct dcf_entry *entry = object->entry;
    uint8_t bytes[CONFORM_VALUE_MAX];
    uint32_t result;

    if (!check_is_writable(object) || needs_procedure(object) || (entry->flags & 1u) != 0 ||
        !entry->initial.given || entry->initial.size == 0 || entry->initial.size > sizeof bytes ||
        object->type == OD_DOMAIN)
        return;
    dcf_value(&entry->initial, findings->self->options.node, bytes);
    result = conform_write(findings->self, object->index, object->sub, bytes, entry->initial.size);
    if (!is_one_of(result, CODES(SDO_DEVICE_STATE, SDO_LOCAL_CONTROL)) && result != SDO_OK)
        find_result(findings, object, "success of writing its DefaultValue", result);
}

static bool check_write_defaults(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_write_default);
    return conclude(self, &findings, "do not take their DefaultValue");
}

/* --- structure --- */

static bool is_first(const struct conform *self, const struct conform_object *object)
{
    return object == self->objects || object[-1].index != object->index;
}

/* The type of a VAR or of an array's elements; 0: a record, whose type is not known. */
static uint8_t type_of(const struct conform *self, const struct conform_object *object)
{
    const struct conform_object *element = conform_find(self, object->index, 1);

    if (object->entry->object_type == 7)
        return object->type;
    return object->entry->object_type == 8 && element ? element->type : 0;
}

static void look_at_structure(struct findings *findings, const struct conform_object *object)
{
    struct conform_value value;
    uint32_t result;
    uint8_t type;

    if (!is_first(findings->self, object) || object->sub != 0)
        return;
    type = type_of(findings->self, object);
    result = conform_read(findings->self, object->index, 0xFF, &value);
    if (is_one_of(result, CODES(SDO_NO_SUB, SDO_GENERAL)))
        return;
    if (result != SDO_OK)
        find(findings, "%04Xh:FF: expected abort 06090011, or its structure; received %08X",
             object->index, (unsigned)result);
    else if (value.size != 4 || value.bytes[0] != object->entry->object_type ||
             (type != 0 && value.bytes[1] != type))
        find(findings, "%04Xh:FF: expected type %02X and code %02X, received %02X and %02X",
             object->index, type, object->entry->object_type, value.bytes[1], value.bytes[0]);
}

static bool check_structure(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_structure);
    return conclude(self, &findings, "do not have the structure of the EDS");
}

/* In these sub-index 0 counts what is in use. */
static bool counts_in_use(uint16_t index)
{
    return index == 0x1003 || (index >= 0x1600 && index <= 0x17FF) ||
           (index >= 0x1A00 && index <= 0x1BFF);
}

static uint8_t highest_sub(const struct conform *self, const struct conform_object *object)
{
    const struct conform_object *end = self->objects + self->object_count;
    uint8_t highest = 0;

    for (const struct conform_object *at = object; at < end && at->index == object->index; at++)
        if (at->sub != 0xFF)
            highest = at->sub;
    return highest;
}

static void look_at_sub_count(struct findings *findings, const struct conform_object *object)
{
    struct conform *self = findings->self;
    const uint8_t highest = highest_sub(self, object);
    struct conform_value value;
    uint32_t result;

    if (!is_first(self, object) || object->sub != 0 || highest == 0 || counts_in_use(object->index))
        return;
    result = conform_read(self, object->index, 0, &value);
    if (result != SDO_OK) {
        find_result(findings, object, "the highest sub-index", result);
        return;
    }
    if (value.size != 1 || value.bytes[0] != highest) {
        find(findings, "%04Xh:00: expected %02X, received %02X in %u bytes", object->index, highest,
             value.bytes[0], (unsigned)value.size);
        return;
    }
    result = conform_read(self, object->index, (uint8_t)(highest + 1), &value);
    if (highest < 0xFE && !is_one_of(result, CODES(SDO_NO_SUB, SDO_GENERAL)))
        find(findings, "%04Xh:%02X: expected abort 06090011, received %08X", object->index,
             highest + 1, (unsigned)result);
}

static bool check_sub_count(struct conform *self)
{
    struct findings findings = { .self = self };

    look_at_all(&findings, look_at_sub_count);
    return conclude(self, &findings, "have another highest sub-index");
}

/* Strides through all indexes, for a sample of about 160. */
static bool check_absent(struct conform *self)
{
    struct findings findings = { .self = self };

    for (uint32_t index = 0x1000; index <= 0xFFFF && self->end == CONFORM_RUNS; index += 389) {
        const struct conform_object object = { .index = (uint16_t)index };
        struct conform_value value;
        uint32_t result;

        if (conform_has(self, object.index))
            continue;
        result = conform_read(self, object.index, 0, &value);
        if (!is_one_of(result, CODES(SDO_NO_OBJECT, SDO_GENERAL)))
            find_result(&findings, &object, "abort 06020000", result);
    }
    return conclude(self, &findings, "are there, but not in the EDS");
}

#define CLAUSE "CiA 301, 7.4"

static const struct conform_check checks[] = {
    { "od-defaults", "after a reset the values are the DefaultValues", CLAUSE, CONFORM_EDS, 0,
      check_defaults },
    { "od-read", "each object is read, with the length of its type", CLAUSE, CONFORM_EDS, 0,
      check_read },
    { "od-read-only", "what is read-only is not written", CLAUSE, CONFORM_EDS, 0, check_read_only },
    { "od-structure", "sub-index FF tells type and code, or does not exist", CLAUSE, CONFORM_EDS, 0,
      check_structure },
    { "od-sub-count", "sub-index 0 is the highest sub-index", CLAUSE, 0, 0, check_sub_count },
    { "od-absent", "other objects do not exist", CLAUSE, CONFORM_EDS, 0, check_absent },
    { "od-limits", "values outside the limits are refused", CLAUSE, CONFORM_EDS | CONFORM_RESET, 0,
      check_limits },
    { "od-write-defaults", "the DefaultValues can be written", CLAUSE, CONFORM_EDS | CONFORM_RESET,
      0, check_write_defaults },
};

const struct conform_family conform_od = { "od", "object dictionary", checks,
                                           sizeof checks / sizeof checks[0] };

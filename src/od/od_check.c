#include "od/od.h"

#include "base/bytes.h"

#include <math.h>
#include <string.h>

static sdo_abort_t find_for_access(const struct od *self, uint16_t index, uint8_t sub,
                                   struct od_entry **ret_entry)
{
    struct od_entry *entry = od_find(self, index, sub);

    if (!entry)
        return od_has_object(self, index) ? SDO_NO_SUB : SDO_NO_OBJECT;
    *ret_entry = entry;
    return SDO_OK;
}

sdo_abort_t od_check_read(const struct od *self, uint16_t index, uint8_t sub,
                          struct od_entry **ret_entry)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = find_for_access(self, index, sub, &entry);

    if (code != SDO_OK)
        return code;
    if (entry->access == OD_NONE)
        return SDO_ACCESS;
    if (entry->access == OD_WO)
        return SDO_WRITE_ONLY;
    *ret_entry = entry;
    return SDO_OK;
}

sdo_abort_t od_check_write(const struct od *self, uint16_t index, uint8_t sub,
                           struct od_entry **ret_entry)
{
    struct od_entry *entry = NULL;
    sdo_abort_t code = find_for_access(self, index, sub, &entry);

    if (code != SDO_OK)
        return code;
    if (entry->access == OD_NONE)
        return SDO_ACCESS;
    if (entry->access == OD_RO || entry->access == OD_CONST)
        return SDO_READ_ONLY;
    *ret_entry = entry;
    return SDO_OK;
}

sdo_abort_t od_check_size(const struct od_entry *entry, uint32_t size)
{
    if (size > entry->capacity)
        return SDO_TOO_LONG;
    if (size < od_type_size(entry->type))
        return SDO_TOO_SHORT;
    return SDO_OK;
}

static int64_t sign_extend(uint64_t value, uint32_t size)
{
    uint64_t sign = UINT64_C(1) << (8 * size - 1);

    return (int64_t)((value ^ sign) - sign);
}

int64_t od_entry_signed(const struct od_entry *entry)
{
    uint32_t size = entry->size < 8 ? entry->size : 8;
    uint64_t value = get_le(entry->value, size);

    if (size == 0 || !od_type_signed(entry->type))
        return (int64_t)value;
    return sign_extend(value, size);
}

static sdo_abort_t check_signed(const struct od_entry *entry, int64_t value)
{
    if (entry->has_high && value > entry->high)
        return SDO_VALUE_HIGH;
    if (entry->has_low && value < entry->low)
        return SDO_VALUE_LOW;
    return SDO_OK;
}

static sdo_abort_t check_unsigned(const struct od_entry *entry, uint64_t value)
{
    if (entry->has_high && value > (uint64_t)entry->high)
        return SDO_VALUE_HIGH;
    if (entry->has_low && value < (uint64_t)entry->low)
        return SDO_VALUE_LOW;
    return SDO_OK;
}

static double real_from_bits(uint8_t type, uint64_t bits)
{
    uint32_t short_bits = (uint32_t)bits;
    float short_value;
    double value;

    if (type == OD_REAL32) {
        memcpy(&short_value, &short_bits, sizeof short_value);
        return (double)short_value;
    }
    memcpy(&value, &bits, sizeof value);
    return value;
}

static sdo_abort_t check_real(const struct od_entry *entry, uint64_t bits)
{
    double value = real_from_bits(entry->type, bits);

    if (isnan(value))
        return entry->has_low || entry->has_high ? SDO_INVALID_VALUE : SDO_OK;
    if (entry->has_high && value > real_from_bits(entry->type, (uint64_t)entry->high))
        return SDO_VALUE_HIGH;
    if (entry->has_low && value < real_from_bits(entry->type, (uint64_t)entry->low))
        return SDO_VALUE_LOW;
    return SDO_OK;
}

sdo_abort_t od_check_value(const struct od_entry *entry, const uint8_t *value, uint32_t size)
{
    uint32_t fixed = od_type_size(entry->type);
    sdo_abort_t code = od_check_size(entry, size);
    uint64_t number;

    if (code != SDO_OK || fixed == 0)
        return code;
    number = get_le(value, fixed);
    if (entry->type == OD_BOOLEAN && number > 1)
        return SDO_INVALID_VALUE;
    if (entry->type == OD_REAL32 || entry->type == OD_REAL64)
        return check_real(entry, number);
    if (od_type_signed(entry->type))
        return check_signed(entry, sign_extend(number, fixed));
    return check_unsigned(entry, number);
}

#include "api/scan.h"

#include "base/bytes.h"

#include <string.h>

static bool is_time(uint8_t type)
{
    return type == OD_TIME_OF_DAY || type == OD_TIME_DIFFERENCE;
}

bool scan_is_text(uint8_t type)
{
    return od_type_size(type) == 0;
}

size_t scan_size(uint8_t type)
{
    const size_t bytes = od_type_size(type);

    if (bytes == 0 || is_time(type))
        return 0;
    if (bytes == 3)
        return 4;
    return bytes > 4 ? 8 : bytes;
}

static uint64_t extend(uint8_t type, uint64_t value)
{
    const unsigned bits = 8 * od_type_size(type);
    const uint64_t sign = UINT64_C(1) << (bits - 1);

    return od_type_signed(type) ? (value ^ sign) - sign : value;
}

void scan_number_from(uint8_t type, const uint8_t *bytes, union scan_number *ret_number)
{
    const uint64_t value = extend(type, get_le(bytes, od_type_size(type)));

    memset(ret_number, 0, sizeof *ret_number);
    if (is_time(type)) {
        ret_number->time.ulMs = get_le32(bytes) & 0x0FFFFFFFu;
        ret_number->time.usDays = get_le16(bytes + 4);
        return;
    }
    switch (scan_size(type)) {
    case 1: ret_number->u8 = (uint8_t)value; break;
    case 2: ret_number->u16 = (uint16_t)value; break;
    case 4: ret_number->u32 = (uint32_t)value; break;
    default: ret_number->u64 = value; break;
    }
}

void scan_number_to(uint8_t type, const void *number, uint8_t ret_bytes[8])
{
    union scan_number own = { .u64 = 0 };
    uint64_t value;

    memset(ret_bytes, 0, 8);
    if (is_time(type)) {
        memcpy(&own.time, number, sizeof own.time);
        put_le32(ret_bytes, (uint32_t)own.time.ulMs & 0x0FFFFFFFu);
        put_le16(ret_bytes + 4, own.time.usDays);
        return;
    }
    memcpy(&own, number, scan_size(type));
    switch (scan_size(type)) {
    case 1: value = own.u8; break;
    case 2: value = own.u16; break;
    case 4: value = own.u32; break;
    default: value = own.u64; break;
    }
    put_le(ret_bytes, od_type_size(type), value);
}

void scan_data_from(uint8_t type, uint8_t *bytes, uint32_t size, union scan_data *ret_data)
{
    if (scan_is_text(type))
        ret_data->text = (RecOctString){ .pData = bytes, .ulSize = size, .ulLength = size };
    else
        scan_number_from(type, bytes, &ret_data->number);
}

sdo_abort_t scan_code_of(int result)
{
    if (result > 0)
        return (sdo_abort_t)result;
    switch (result) {
    case SCANOPEN_OK: return SDO_OK;
    case SCANOPEN_VALUE_TOO_HIGH: return SDO_VALUE_HIGH;
    case SCANOPEN_VALUE_TOO_LOW: return SDO_VALUE_LOW;
    case SCANOPEN_WRONG_PARAMETER: return SDO_INVALID_VALUE;
    default: return SDO_NOT_STORED;
    }
}

void scan_end_text(const struct od_entry *entry)
{
    if (entry->referred && entry->access != OD_RO && entry->access != OD_NONE &&
        entry->size < entry->capacity)
        entry->value[entry->size] = 0;
}

void scan_field_bytes(const struct pdo_field *field, const uint8_t data[8], uint8_t ret_bytes[8])
{
    const uint64_t mask = UINT64_MAX >> (64 - field->bits);

    put_le(ret_bytes, 8, get_le(data, 8) >> field->first & mask);
}

sdo_abort_t scan_take_field(const struct pdo_field *field, const uint8_t data[8], bool store)
{
    uint8_t bytes[8];

    if (!field->entry)
        return SDO_OK;
    scan_field_bytes(field, data, bytes);
    return store ? od_set(field->entry, bytes, field->entry->size)
                 : od_check_value(field->entry, bytes, field->entry->size);
}

int scan_error_of_value(sdo_abort_t code)
{
    switch (code) {
    case SDO_OK: return SCANOPEN_OK;
    case SDO_VALUE_HIGH: return SCANOPEN_VALUE_TOO_HIGH;
    case SDO_VALUE_LOW: return SCANOPEN_VALUE_TOO_LOW;
    default: return SCANOPEN_WRONG_PARAMETER;
    }
}

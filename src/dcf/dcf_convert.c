#include "dcf/dcf_convert.h"

#include "base/bytes.h"
#include "dcf/dcf_utf8.h"

#include <string.h>

#define TIME_SIZE 6u /* u32 milliseconds, u16 days */

static void append(struct dcf_value *value, uint64_t number, uint32_t size)
{
    put_le(value->bytes + value->size, size, number);
    value->size += size;
}

static size_t count_digits(struct dcf_slice text, size_t most)
{
    size_t digits = 0;

    while (digits < most && digits < text.size && dcf_hex_digit(text.text[digits]) >= 0)
        digits++;
    return digits;
}

/* Groups of hexadecimal digits with blanks between, unit digits to a number. */
static bool convert_hex(struct dcf_slice text, size_t unit, struct dcf_value *value)
{
    unsigned number;

    value->size = 0;
    if (dcf_slice_begins(text, "0x"))
        text = dcf_slice_skip(text, 2);
    while (text.size > 0) {
        if (count_digits(text, unit) < unit)
            return false;
        dcf_slice_hex(dcf_slice_cut(text, unit), unit, &number);
        append(value, number, (uint32_t)unit / 2);
        text = dcf_slice_trim(dcf_slice_skip(text, unit));
    }
    return value->size > 0;
}

static enum dcf_fit convert_octets(struct dcf_slice text, struct dcf_value *value, unsigned *quirks)
{
    unsigned digit;

    if (convert_hex(text, 2, value))
        return DCF_FITS;
    if (dcf_slice_hex(text, 1, &digit)) { /* "0" is meant as a byte, not as a character */
        value->size = 0;
        append(value, digit, 1);
        return DCF_FITS;
    }
    *quirks |= DCF_QUIRK_TEXT;
    memcpy(value->bytes, text.text, text.size);
    value->size = (uint32_t)text.size;
    return DCF_FITS;
}

static enum dcf_fit convert_unicode(struct dcf_slice text, struct dcf_value *value,
                                    unsigned *quirks)
{
    struct dcf_characters characters = dcf_characters_of(text);
    uint32_t character;

    if (convert_hex(text, 4, value))
        return DCF_FITS;
    *quirks |= DCF_QUIRK_TEXT;
    value->size = 0;
    while (dcf_characters_next(&characters, &character)) {
        if (character > 0xFFFF) {
            append(value, 0xD800u + ((character - 0x10000u) >> 10), 2);
            character = 0xDC00u + (character & 0x3FFu);
        }
        append(value, character, 2);
    }
    return DCF_FITS;
}

/* "365 43200000": days and milliseconds; or 12 hexadecimal digits; or one number. */
static enum dcf_fit convert_time(struct dcf_slice text, struct dcf_value *value, unsigned *quirks)
{
    struct dcf_number number;
    size_t blank = 0;
    unsigned days, ms;

    text = dcf_number_uncomment(text, quirks);
    while (blank < text.size && !dcf_is_blank(text.text[blank]))
        blank++;
    if (dcf_slice_decimal(dcf_slice_cut(text, blank), UINT16_MAX, &days) &&
        dcf_slice_decimal(dcf_slice_trim(dcf_slice_skip(text, blank)), 0xFFFFFFF, &ms)) {
        append(value, ms, 4);
        append(value, days, 2);
        return DCF_FITS;
    }
    if (!dcf_slice_begins(text, "0x") && convert_hex(text, 2, value) && value->size == TIME_SIZE)
        return DCF_FITS;
    value->size = TIME_SIZE;
    if (!dcf_number_parse(text, &number) || number.has_node_id)
        return DCF_NO_VALUE;
    *quirks |= number.quirks;
    return dcf_number_store(&number, OD_UNSIGNED48, value->bytes);
}

static enum dcf_fit convert_integer(struct dcf_slice text, uint8_t type, struct dcf_value *value,
                                    unsigned *quirks)
{
    struct dcf_number number;

    if (type == OD_BOOLEAN ? !dcf_number_parse_flag(text, &number)
                           : !dcf_number_parse(text, &number))
        return DCF_NO_VALUE;
    dcf_number_narrow(&number, type);
    *quirks |= number.quirks;
    value->has_node_id = number.has_node_id;
    value->size = od_type_size(type);
    return dcf_number_store(&number, type, value->bytes);
}

static enum dcf_fit convert_string(struct dcf_slice text, struct dcf_value *value, unsigned *quirks)
{
    if (text.size > 1 && text.text[0] == '"' && text.text[text.size - 1] == '"')
        *quirks |= DCF_QUIRK_QUOTES;
    memcpy(value->bytes, text.text, text.size);
    value->size = (uint32_t)text.size;
    return DCF_FITS;
}

static enum dcf_fit convert(struct dcf_slice text, uint8_t type, struct dcf_value *value,
                            unsigned *quirks)
{
    switch (type) {
    case OD_VISIBLE_STRING: return convert_string(text, value, quirks);
    case OD_OCTET_STRING: return convert_octets(text, value, quirks);
    case OD_UNICODE_STRING: return convert_unicode(text, value, quirks);
    case OD_DOMAIN:
        *quirks |= DCF_QUIRK_DOMAIN;
        return convert_hex(text, 2, value) ? DCF_FITS : DCF_NO_VALUE;
    case OD_TIME_OF_DAY:
    case OD_TIME_DIFFERENCE: return convert_time(text, value, quirks);
    case OD_REAL32:
    case OD_REAL64:
        value->size = od_type_size(type);
        return dcf_real_parse(text, type, value->bytes, quirks);
    default: return od_type_known(type) ? convert_integer(text, type, value, quirks) : DCF_NO_VALUE;
    }
}

enum dcf_fit dcf_convert(struct co_pool *pool, struct dcf_slice text, uint8_t type,
                         struct dcf_value *ret_value, unsigned *ret_quirks)
{
    struct dcf_value value = { .given = true };
    size_t room = 2 * text.size + 16; /* a character may become two bytes, a digit four */
    enum dcf_fit fit;

    *ret_quirks = 0;
    if (text.size > UINT32_MAX / 4)
        return DCF_OUT_OF_RANGE;
    value.bytes = co_pool_take(pool, room);
    if (!value.bytes)
        return DCF_NO_MEMORY;
    fit = convert(text, type, &value, ret_quirks);
    if (fit == DCF_FITS)
        *ret_value = value;
    co_pool_give_back(pool, fit == DCF_FITS ? room - value.size : room);
    return fit;
}

const char *dcf_convert_expected(uint8_t type)
{
    switch (type) {
    case OD_BOOLEAN: return "0 or 1";
    case OD_REAL32:
    case OD_REAL64: return "a decimal fraction or a hexadecimal bit pattern";
    case OD_TIME_OF_DAY:
    case OD_TIME_DIFFERENCE: return "days and milliseconds, or 12 hexadecimal digits";
    case OD_DOMAIN: return "pairs of hexadecimal digits";
    default: return od_type_known(type) ? "a number" : "a data type of CiA 301";
    }
}

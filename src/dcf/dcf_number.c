#include "dcf/dcf_number.h"

#include "base/bytes.h"
#include "od/od.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NODE_ID        "$NODEID"
#define REAL_TEXT_SIZE 128u

static bool begins_comment(const char *text, const char *end)
{
    return *text == ';' || *text == '#' || (*text == '/' && end - text > 1 && text[1] == '/');
}

struct dcf_slice dcf_number_uncomment(struct dcf_slice text, unsigned *ret_quirks)
{
    size_t size = 0;

    while (size < text.size && !begins_comment(text.text + size, text.text + text.size))
        size++;
    if (size < text.size)
        *ret_quirks |= DCF_QUIRK_COMMENT;
    return dcf_slice_trim(dcf_slice_cut(text, size));
}

/* Takes the sign and "0x" off. */
static struct dcf_slice parse_prefix(struct dcf_slice text, struct dcf_number *number)
{
    if (text.size > 0 && (text.text[0] == '-' || text.text[0] == '+')) {
        number->negative = text.text[0] == '-';
        text = dcf_slice_skip(text, 1);
    }
    if (text.size < 2 || text.text[0] != '0')
        return text;
    number->hex = text.text[1] == 'x' || text.text[1] == 'X';
    if (number->hex)
        return dcf_slice_skip(text, 2);
    number->quirks |= DCF_QUIRK_LEADING_ZERO;
    return text;
}

static bool is_suffix(char c)
{
    return c == 'L' || c == 'l' || c == 'U' || c == 'u';
}

/* The suffixes of C's integers, which some tools leave in their files. */
static struct dcf_slice cut_suffix(struct dcf_slice text, struct dcf_number *number)
{
    size_t size = text.size;

    while (size > 1 && size + 3 > text.size && is_suffix(text.text[size - 1]))
        size--;
    if (size < text.size)
        number->quirks |= DCF_QUIRK_SUFFIX;
    return dcf_slice_cut(text, size);
}

static bool parse_integer(struct dcf_slice text, struct dcf_number *number)
{
    uint64_t magnitude = 0, base, most;

    *number = (struct dcf_number){ .magnitude = 0 };
    text = cut_suffix(parse_prefix(text, number), number);
    base = number->hex ? 16 : 10;
    most = UINT64_MAX / base;
    for (size_t i = 0; i < text.size; i++) {
        unsigned digit = (unsigned)dcf_hex_digit(text.text[i]);

        if (digit >= base)
            return false;
        if (magnitude >= most && magnitude > (UINT64_MAX - digit) / base)
            number->too_large = true;
        magnitude = magnitude * base + digit;
    }
    number->magnitude = magnitude;
    return text.size > 0;
}

/* Takes the name of the node-ID and its "+" off one end; what is left is the number. */
static bool take_name(struct dcf_slice *text, const char *name)
{
    struct dcf_slice rest;

    if (dcf_slice_begins(*text, name)) {
        rest = dcf_slice_trim(dcf_slice_skip(*text, strlen(name)));
        if (rest.size > 0 && rest.text[0] != '+')
            return false;
        *text = dcf_slice_of("0");
        if (rest.size > 0)
            *text = dcf_slice_trim(dcf_slice_skip(rest, 1));
        return true;
    }
    if (!dcf_slice_ends(*text, name))
        return false;
    rest = dcf_slice_trim(dcf_slice_cut(*text, text->size - strlen(name)));
    if (!dcf_slice_ends(rest, "+"))
        return false;
    *text = dcf_slice_trim(dcf_slice_cut(rest, rest.size - 1));
    return true;
}

static struct dcf_slice cut_around(struct dcf_slice text, const char *pair)
{
    if (text.size < 2 || text.text[0] != pair[0] || text.text[text.size - 1] != pair[1])
        return text;
    return dcf_slice_trim(dcf_slice_cut(dcf_slice_skip(text, 1), text.size - 2));
}

static bool take_node_id(struct dcf_slice *text, unsigned *quirks)
{
    static const char *const others[] = { NODE_ID,  "$NODE_ID", "$NODE-ID",
                                          "NODEID", "NODE_ID",  "NODE-ID" };
    struct dcf_slice formula = cut_around(*text, "()");

    if (take_name(text, NODE_ID))
        return true;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (!take_name(&formula, others[i]))
            continue;
        *quirks |= DCF_QUIRK_FORM;
        *text = formula;
        return true;
    }
    return false;
}

/* "1Ah", "C0h", "FFh", but not "each": no word begins with F or has digits. */
static bool parse_assembler(struct dcf_slice text, struct dcf_number *number)
{
    bool is_word = !dcf_slice_begins(text, "f");

    *number = (struct dcf_number){ .hex = true };
    if (text.size < 2 || !dcf_slice_ends(text, "h"))
        return false;
    for (size_t i = 0; i + 1 < text.size; i++) {
        int digit = dcf_hex_digit(text.text[i]);

        if (digit < 0)
            return false;
        is_word &= digit > 9;
        number->too_large |= number->magnitude >> 60 != 0;
        number->magnitude = number->magnitude << 4 | (unsigned)digit;
    }
    return !is_word;
}

/* "26.0" */
static bool parse_whole_fraction(struct dcf_slice text, struct dcf_number *number)
{
    size_t size = text.size;

    while (size > 0 && text.text[size - 1] == '0')
        size--;
    return size > 1 && text.text[size - 1] == '.' &&
           parse_integer(dcf_slice_cut(text, size - 1), number) && !number->hex &&
           !(number->quirks & DCF_QUIRK_SUFFIX);
}

bool dcf_number_parse(struct dcf_slice text, struct dcf_number *ret_number)
{
    struct dcf_slice quoted;
    struct dcf_number number;
    unsigned quirks = 0;
    bool has_node_id;

    text = dcf_slice_trim(text);
    if (parse_integer(text, &number)) { /* as nearly all are */
        *ret_number = number;
        return true;
    }
    quoted = dcf_number_uncomment(text, &quirks);
    text = cut_around(quoted, "\"\"");
    if (text.size < quoted.size)
        quirks |= DCF_QUIRK_FORM;
    has_node_id = take_node_id(&text, &quirks);
    if (!parse_integer(text, &number)) {
        if (!parse_assembler(text, &number) && !parse_whole_fraction(text, &number))
            return false;
        quirks |= DCF_QUIRK_FORM;
    }
    number.has_node_id = has_node_id;
    number.quirks |= quirks;
    *ret_number = number;
    return true;
}

bool dcf_number_parse_flag(struct dcf_slice text, struct dcf_number *ret_number)
{
    static const char *const words[][3] = { { "false", "no", "off" }, { "true", "yes", "on" } };

    if (dcf_number_parse(text, ret_number))
        return true;
    for (unsigned i = 0; i < 6; i++) {
        if (!dcf_slice_is(text, words[i / 3][i % 3]))
            continue;
        *ret_number = (struct dcf_number){ .magnitude = i / 3, .quirks = DCF_QUIRK_FORM };
        return true;
    }
    return false;
}

struct dcf_shown dcf_number_show(const struct dcf_number *self)
{
    struct dcf_shown shown;

    snprintf(shown.text, sizeof shown.text, self->hex ? "%s%s0x%llX" : "%s%s%llu",
             self->has_node_id ? "$NODEID+" : "", self->negative ? "-" : "",
             (unsigned long long)self->magnitude);
    return shown;
}

/* The 16, 32 or 64 bits of a negative number that a shorter type can have: 0xFFFFFFFE. */
static bool is_widened(const struct dcf_number *self, uint8_t type)
{
    unsigned sign = 8 * od_type_size(type) - 1;

    for (unsigned bits = 16; bits <= 64; bits *= 2) {
        if (bits > sign + 1 && self->magnitude >> sign == UINT64_MAX >> (64 - bits + sign))
            return true;
    }
    return false;
}

void dcf_number_narrow(struct dcf_number *self, uint8_t type)
{
    if (!od_type_signed(type) || !self->hex || self->negative || self->too_large ||
        !is_widened(self, type))
        return;
    self->magnitude &= ((uint64_t)1 << 8 * od_type_size(type)) - 1;
    self->quirks |= DCF_QUIRK_WIDE;
}

enum dcf_fit dcf_number_store(const struct dcf_number *self, uint8_t type, uint8_t *bytes)
{
    uint32_t size = od_type_size(type);
    uint64_t most = size >= 8 ? UINT64_MAX : ((uint64_t)1 << 8 * size) - 1;
    uint64_t value = self->negative ? 0 - self->magnitude : self->magnitude;

    if (self->too_large)
        return DCF_OUT_OF_RANGE;
    if (type == OD_BOOLEAN)
        most = 1;
    if (od_type_signed(type) && self->negative)
        most = most / 2 + 1;
    else if (od_type_signed(type) && !self->hex)
        most = most / 2;
    else if (self->negative)
        most = 0;
    if (self->magnitude > most)
        return DCF_OUT_OF_RANGE;
    put_le(bytes, size, value);
    return DCF_FITS;
}

static size_t count_digits(struct dcf_slice text)
{
    size_t count = 0;

    while (count < text.size && text.text[count] >= '0' && text.text[count] <= '9')
        count++;
    return count;
}

static struct dcf_slice skip_sign(struct dcf_slice text)
{
    bool sign = text.size > 0 && (text.text[0] == '-' || text.text[0] == '+');

    return dcf_slice_skip(text, sign ? 1 : 0);
}

/* [+-] digits [. digits] [e [+-] digits], with a digit before or behind the point */
static bool is_fraction(struct dcf_slice text)
{
    size_t digits, behind = 0;

    text = skip_sign(text);
    digits = count_digits(text);
    text = dcf_slice_skip(text, digits);
    if (dcf_slice_begins(text, ".")) {
        text = dcf_slice_skip(text, 1);
        behind = count_digits(text);
        text = dcf_slice_skip(text, behind);
    }
    if (digits + behind == 0)
        return false;
    if (!dcf_slice_begins(text, "e"))
        return text.size == 0;
    text = skip_sign(dcf_slice_skip(text, 1));
    return text.size > 0 && count_digits(text) == text.size;
}

/* In the C locale, whatever the process's. */
static enum dcf_fit convert_fraction(const char *text, uint8_t type, uint8_t *bytes)
{
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    bool fits;

    if (c_locale == (locale_t)0)
        return DCF_NO_MEMORY;
    if (type == OD_REAL32) {
        float value = strtof_l(text, NULL, c_locale);
        uint32_t bits;

        memcpy(&bits, &value, sizeof bits);
        put_le32(bytes, bits);
        fits = isfinite(value);
    } else {
        double value = strtod_l(text, NULL, c_locale);
        uint64_t bits;

        memcpy(&bits, &value, sizeof bits);
        put_le(bytes, sizeof bits, bits);
        fits = isfinite(value);
    }
    freelocale(c_locale);
    return fits ? DCF_FITS : DCF_OUT_OF_RANGE;
}

enum dcf_fit dcf_real_parse(struct dcf_slice text, uint8_t type, uint8_t *bytes,
                            unsigned *ret_quirks)
{
    struct dcf_number pattern;
    char copy[REAL_TEXT_SIZE];

    text = dcf_number_uncomment(dcf_slice_trim(text), ret_quirks);
    if (dcf_slice_begins(text, "0x")) {
        if (!parse_integer(text, &pattern))
            return DCF_NO_VALUE;
        return dcf_number_store(&pattern, type == OD_REAL32 ? OD_UNSIGNED32 : OD_UNSIGNED64, bytes);
    }
    if (!is_fraction(text) || text.size >= sizeof copy)
        return DCF_NO_VALUE;
    memcpy(copy, text.text, text.size);
    copy[text.size] = '\0';
    return convert_fraction(copy, type, bytes);
}

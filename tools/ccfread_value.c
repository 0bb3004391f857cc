#include "ccfread_value.h"

#include "base/bytes.h"
#include "od/od.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER_SIZE  8u
#define TEXT_LEAST   4u /* shorter ones that could be text are numbers, as a rule */
#define TIME_MS_MASK 0x0FFFFFFFu

bool value_fits(const struct ccf_entry *entry, uint8_t type)
{
    const uint32_t size = od_type_size(type);

    return size == 0 || size == entry->size;
}

int64_t value_signed(const struct ccf_entry *entry)
{
    const unsigned unused = 64 - 8 * (unsigned)entry->size;
    const uint64_t shifted = get_le(entry->value, entry->size) << unused;
    int64_t value;

    memcpy(&value, &shifted, sizeof value);
    return value / (int64_t)(UINT64_C(1) << unused);
}

double value_real(const struct ccf_entry *entry)
{
    const uint32_t bits32 = get_le32(entry->value);
    uint64_t bits64;
    double real64;
    float real32;

    if (entry->size == sizeof real32) {
        memcpy(&real32, &bits32, sizeof real32);
        return (double)real32;
    }
    bits64 = get_le(entry->value, sizeof real64);
    memcpy(&real64, &bits64, sizeof real64);
    return real64;
}

static void add_hex(struct text *text, const struct ccf_entry *entry)
{
    text_add(text, " (%0*" PRIX64 "h)", (int)(2 * entry->size), get_le(entry->value, entry->size));
}

static void add_unsigned(struct text *text, const struct ccf_entry *entry)
{
    text_add(text, "%" PRIu64, get_le(entry->value, entry->size));
    add_hex(text, entry);
}

static void add_boolean(struct text *text, const struct ccf_entry *entry)
{
    if (entry->value[0] > 1) {
        add_unsigned(text, entry);
        return;
    }
    text_add(text, entry->value[0] ? "TRUE" : "FALSE");
    add_hex(text, entry);
}

/* In as few digits as bring the same number back. */
static void add_real(struct text *text, const struct ccf_entry *entry)
{
    const double value = value_real(entry);
    const bool single = entry->size == sizeof(float);
    char digits[40];
    double back = 0;

    for (int precision = 6; precision <= 17; precision++) {
        snprintf(digits, sizeof digits, "%.*g", precision, value);
        back = single ? (double)strtof(digits, NULL) : strtod(digits, NULL);
        if (!(back < value) && !(back > value))
            break;
    }
    text_add(text, "%s", digits);
    add_hex(text, entry);
}

void value_add_time(struct text *text, const struct ccf_entry *entry, uint8_t type)
{
    const uint16_t days = get_le16(entry->value + 4);

    if (type == OD_TIME_OF_DAY)
        text_add_date(text, days);
    else
        text_add(text, "%u days", days);
    text_add(text, " ");
    text_add_clock(text, get_le32(entry->value) & TIME_MS_MASK);
}

static void add_typed(struct text *text, const struct ccf_entry *entry, uint8_t type)
{
    switch (type) {
    case OD_BOOLEAN: add_boolean(text, entry); return;
    case OD_REAL32:
    case OD_REAL64: add_real(text, entry); return;
    case OD_VISIBLE_STRING: text_add_string(text, entry->value, entry->size, false); return;
    case OD_UNICODE_STRING: text_add_string(text, entry->value, entry->size, true); return;
    case OD_TIME_OF_DAY:
    case OD_TIME_DIFFERENCE: value_add_time(text, entry, type); return;
    case OD_OCTET_STRING:
    case OD_DOMAIN: text_add_dump(text, entry->value, entry->size); return;
    default: break;
    }
    if (od_type_signed(type)) {
        text_add(text, "%" PRId64, value_signed(entry));
        add_hex(text, entry);
    } else {
        add_unsigned(text, entry);
    }
}

static bool is_printable(const struct ccf_entry *entry)
{
    for (uint32_t i = 0; i < entry->size; i++) {
        if (entry->value[i] < 0x20 || entry->value[i] > 0x7E)
            return false;
    }
    return entry->size >= TEXT_LEAST;
}

static void add_untyped(struct text *text, const struct ccf_entry *entry)
{
    const bool number = entry->size > 0 && entry->size <= NUMBER_SIZE;
    const bool printable = is_printable(entry);

    if (number)
        add_unsigned(text, entry);
    if (printable) {
        text_add(text, number ? " " : "");
        text_add_string(text, entry->value, entry->size, false);
    } else if (entry->size == 0) {
        text_add(text, "nothing");
    } else if (!number) {
        text_add_dump(text, entry->value, entry->size);
    }
}

void value_add(struct text *text, const struct ccf_entry *entry, uint8_t type)
{
    if (!od_type_known(type) || !value_fits(entry, type))
        add_untyped(text, entry);
    else
        add_typed(text, entry, type);
}

void value_put_name(const char *name)
{
    for (; *name; name++)
        putchar((unsigned char)*name < 0x20 || *name == 0x7F ? '.' : *name);
}

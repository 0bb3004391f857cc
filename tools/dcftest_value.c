/* Values of objects: as text for messages, and whether two are the same. */
#include "dcftest_online.h"

#include "base/bytes.h"
#include "od/od.h"

#include <stdio.h>
#include <string.h>

#define SHOWN_MAX 24u /* bytes of a long value */

static bool is_text(uint8_t type)
{
    return type == OD_VISIBLE_STRING || type == OD_UNICODE_STRING;
}

uint32_t value_number_size(uint8_t type)
{
    switch (type) {
    case OD_VISIBLE_STRING:
    case OD_OCTET_STRING:
    case OD_UNICODE_STRING:
    case OD_DOMAIN: return 0;
    default: return od_type_size(type);
    }
}

/* Devices fill up their texts. */
static uint32_t without_end(uint8_t type, const uint8_t *bytes, uint32_t size)
{
    while (is_text(type) && size > 0 && bytes[size - 1] == 0)
        size--;
    return size;
}

bool value_is_same(uint8_t type, const uint8_t *a, uint32_t a_size, const uint8_t *b,
                   uint32_t b_size)
{
    a_size = without_end(type, a, a_size);
    b_size = without_end(type, b, b_size);
    return a_size == b_size && (a_size == 0 || memcmp(a, b, a_size) == 0);
}

static void print_real(uint8_t type, uint64_t bits, struct value_text *shown)
{
    uint32_t bits32 = (uint32_t)bits;
    float single;
    double number;

    memcpy(&single, &bits32, sizeof single);
    memcpy(&number, &bits, sizeof number);
    snprintf(shown->text, sizeof shown->text, "%.9g", type == OD_REAL32 ? (double)single : number);
}

static void print_number(uint8_t type, uint64_t bits, uint32_t size, struct value_text *shown)
{
    const unsigned shift = 64 - 8 * size;

    if (type == OD_REAL32 || type == OD_REAL64)
        print_real(type, bits, shown);
    else if (od_type_signed(type))
        snprintf(shown->text, sizeof shown->text, "%lld",
                 (long long)((int64_t)(bits << shift) / ((int64_t)1 << shift)));
    else if (bits < 10)
        snprintf(shown->text, sizeof shown->text, "%llu", (unsigned long long)bits);
    else
        snprintf(shown->text, sizeof shown->text, "%llu (%llXh)", (unsigned long long)bits,
                 (unsigned long long)bits);
}

static void print_text(const uint8_t *bytes, uint32_t size, struct value_text *shown)
{
    const uint32_t count = size < SHOWN_MAX ? size : SHOWN_MAX;
    char text[SHOWN_MAX + 1];

    for (uint32_t i = 0; i < count; i++)
        text[i] = (char)(bytes[i] >= 0x20 && bytes[i] < 0x7F ? bytes[i] : '.');
    text[count] = '\0';
    snprintf(shown->text, sizeof shown->text, "\"%s%s\"", text, size > count ? "..." : "");
}

static void print_bytes(const uint8_t *bytes, uint32_t size, struct value_text *shown)
{
    const uint32_t count = size < SHOWN_MAX ? size : SHOWN_MAX;
    char text[3 * SHOWN_MAX + 1] = " empty";

    for (uint32_t i = 0; i < count; i++)
        snprintf(text + (size_t)3 * i, 4, " %02X", bytes[i]);
    snprintf(shown->text, sizeof shown->text, "%s%s", text + 1, size > count ? " ..." : "");
}

struct value_text value_show(uint8_t type, const uint8_t *bytes, uint32_t size)
{
    struct value_text shown;

    if (type == OD_VISIBLE_STRING)
        print_text(bytes, without_end(type, bytes, size), &shown);
    else if (value_number_size(type) == size && size > 0 && size <= 8 && type != OD_TIME_OF_DAY &&
             type != OD_TIME_DIFFERENCE)
        print_number(type, get_le(bytes, size), size, &shown);
    else
        print_bytes(bytes, size, &shown);
    return shown;
}

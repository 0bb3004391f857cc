#include "dcf/dcf_utf8.h"

#include <string.h>

#define ASCII_LAST     0x7Fu
#define UNICODE_LAST   0x10FFFFu
#define SURROGATE      0xD800u
#define SURROGATE_LAST 0xDFFFu

/* 80h to 9Fh of Windows-1252; the five without a character stay what they are in Latin-1. */
static const uint16_t windows_1252[32] = {
    0x20AC, 0x0081, 0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
    0x2039, 0x0152, 0x008D, 0x017D, 0x008F, 0x0090, 0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
    0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0x009D, 0x017E, 0x0178,
};

/* Bytes of the character that begins so, or 0: none does. */
static size_t size_of(uint8_t first)
{
    if (first <= ASCII_LAST)
        return 1;
    if (first >= 0xC2 && first < 0xE0)
        return 2;
    if (first >= 0xE0 && first < 0xF0)
        return 3;
    return first >= 0xF0 && first < 0xF5 ? 4 : 0;
}

/* The number of bytes of the UTF-8 character at the beginning; 0: there is none. */
static size_t decode(struct dcf_slice text, uint32_t *ret_character)
{
    static const uint32_t smallest[] = { 0, 0, 0x80, 0x800, 0x10000 };
    uint8_t first = (uint8_t)text.text[0];
    size_t size = size_of(first);
    uint32_t character = size < 2 ? first : first & (0xFFu >> (size + 1));

    if (size == 0 || size > text.size)
        return 0;
    for (size_t i = 1; i < size; i++) {
        if (((uint8_t)text.text[i] & 0xC0) != 0x80)
            return 0;
        character = character << 6 | ((uint8_t)text.text[i] & 0x3Fu);
    }
    if (character < smallest[size] || character > UNICODE_LAST ||
        (character >= SURROGATE && character <= SURROGATE_LAST))
        return 0;
    *ret_character = character;
    return size;
}

static struct dcf_slice skip_ascii(struct dcf_slice text)
{
    size_t count = 0;

    while (count < text.size && (uint8_t)text.text[count] <= ASCII_LAST)
        count++;
    return dcf_slice_skip(text, count);
}

static bool is_utf8(struct dcf_slice text)
{
    uint32_t character;

    text = skip_ascii(text);
    while (text.size > 0) {
        size_t size = decode(text, &character);

        if (size == 0)
            return false;
        text = dcf_slice_skip(text, size);
    }
    return true;
}

struct dcf_characters dcf_characters_of(struct dcf_slice text)
{
    return (struct dcf_characters){ text, is_utf8(text) };
}

bool dcf_characters_next(struct dcf_characters *self, uint32_t *ret_character)
{
    uint8_t byte;

    if (self->rest.size == 0)
        return false;
    if (self->is_utf8) {
        self->rest = dcf_slice_skip(self->rest, decode(self->rest, ret_character));
        return true;
    }
    byte = (uint8_t)self->rest.text[0];
    *ret_character = byte >= 0x80 && byte < 0xA0 ? windows_1252[byte - 0x80] : byte;
    self->rest = dcf_slice_skip(self->rest, 1);
    return true;
}

unsigned dcf_utf8_put(uint32_t character, char *bytes)
{
    unsigned size = character <= ASCII_LAST ? 1
                    : character < 0x800     ? 2
                    : character < 0x10000   ? 3
                                            : 4;

    if (size == 1) {
        bytes[0] = (char)character;
        return 1;
    }
    for (unsigned i = size - 1; i > 0; i--) {
        bytes[i] = (char)(0x80u | (character & 0x3Fu));
        character >>= 6;
    }
    bytes[0] = (char)(0xFFu << (8 - size) | character);
    return size;
}

char *dcf_utf8_copy(struct co_pool *pool, struct dcf_slice text)
{
    struct dcf_characters characters = dcf_characters_of(text);
    size_t room = (characters.is_utf8 ? text.size : 3 * text.size) + DCF_UTF8_SIZE_MAX, used = 0;
    char *copy = co_pool_take(pool, room);
    uint32_t character;

    if (!copy)
        return NULL;
    if (characters.is_utf8) {
        memcpy(copy, text.text, text.size);
        used = text.size;
    } else {
        while (dcf_characters_next(&characters, &character))
            used += dcf_utf8_put(character, copy + used);
    }
    copy[used] = '\0';
    co_pool_give_back(pool, room - used - 1);
    return copy;
}

#include "dcf/dcf_slice.h"

#include "dcf/dcf_utf8.h"

#include <stdlib.h>
#include <string.h>

static char fold(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

struct dcf_slice dcf_slice_trim_blanks(struct dcf_slice self)
{
    while (self.size > 0 && dcf_is_blank(self.text[0]))
        self = dcf_slice_skip(self, 1);
    while (self.size > 0 && dcf_is_blank(self.text[self.size - 1]))
        self.size--;
    return self;
}

static bool same(char a, char b)
{
    return a == b || fold(a) == fold(b);
}

int dcf_slice_compare(struct dcf_slice a, struct dcf_slice b)
{
    size_t size = a.size < b.size ? a.size : b.size;
    size_t i = 0;

    while (i + 8 <= size && memcmp(a.text + i, b.text + i, 8) == 0)
        i += 8;
    for (; i < size; i++) {
        if (!same(a.text[i], b.text[i]))
            return fold(a.text[i]) - fold(b.text[i]);
    }
    return (a.size > b.size) - (a.size < b.size);
}

/* How much of 'text' is at the beginning. */
static size_t count_common(struct dcf_slice self, const char *text)
{
    size_t count = 0;

    while (count < self.size && text[count] != '\0' && same(self.text[count], text[count]))
        count++;
    return count;
}

bool dcf_slice_is(struct dcf_slice self, const char *text)
{
    size_t common = count_common(self, text);

    return common == self.size && text[common] == '\0';
}

bool dcf_slice_begins(struct dcf_slice self, const char *text)
{
    return text[count_common(self, text)] == '\0';
}

bool dcf_slice_ends(struct dcf_slice self, const char *text)
{
    size_t size = strlen(text);

    return self.size >= size && dcf_slice_is(dcf_slice_skip(self, self.size - size), text);
}

bool dcf_slice_decimal(struct dcf_slice self, unsigned most, unsigned *ret_number)
{
    unsigned number = 0;

    for (size_t i = 0; i < self.size; i++) {
        if (self.text[i] < '0' || self.text[i] > '9')
            return false;
        number = 10 * number + (unsigned)(self.text[i] - '0');
        if (number > most)
            return false;
    }
    if (self.size == 0)
        return false;
    *ret_number = number;
    return true;
}

bool dcf_slice_hex(struct dcf_slice self, size_t digits, unsigned *ret_number)
{
    unsigned number = 0;

    if (self.size == 0 || self.size > digits)
        return false;
    for (size_t i = 0; i < self.size; i++) {
        int digit = dcf_hex_digit(self.text[i]);

        if (digit < 0)
            return false;
        number = number << 4 | (unsigned)digit;
    }
    *ret_number = number;
    return true;
}

static bool is_control(uint32_t character)
{
    return character < 0x20 || (character >= 0x7F && character < 0xA0);
}

/* More than can be shown, but not all of a name of megabytes, nor a part of a character. */
static struct dcf_slice cut_to_show(struct dcf_slice text)
{
    size_t least = sizeof(struct dcf_shown), size = DCF_UTF8_SIZE_MAX * least;

    if (text.size <= size)
        return text;
    while (size > least && ((unsigned char)text.text[size] & 0xC0) == 0x80)
        size--;
    return dcf_slice_cut(text, size);
}

struct dcf_shown dcf_show(struct dcf_slice self)
{
    struct dcf_characters characters = dcf_characters_of(cut_to_show(self));
    struct dcf_shown shown;
    size_t used = 0, whole = 0; /* whole: what is left when dots have to follow */
    char bytes[DCF_UTF8_SIZE_MAX];
    uint32_t character;

    while (dcf_characters_next(&characters, &character)) {
        unsigned size = dcf_utf8_put(is_control(character) ? '?' : character, bytes);

        if (used + size >= sizeof shown.text) {
            memcpy(shown.text + whole, "...", sizeof "...");
            return shown;
        }
        memcpy(shown.text + used, bytes, size);
        used += size;
        if (used + sizeof "..." <= sizeof shown.text)
            whole = used;
    }
    shown.text[used] = '\0';
    return shown;
}

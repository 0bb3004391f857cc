#include "dcf/dcf_slice.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool dcf_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0';
}

static char fold(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

int dcf_hex_digit(char c)
{
    char folded = fold(c);

    if (folded >= '0' && folded <= '9')
        return folded - '0';
    if (folded >= 'a' && folded <= 'f')
        return folded - 'a' + 10;
    return -1;
}

struct dcf_slice dcf_slice_of(const char *text)
{
    return (struct dcf_slice){ text, strlen(text) };
}

struct dcf_slice dcf_slice_trim(struct dcf_slice self)
{
    while (self.size > 0 && dcf_is_blank(self.text[0]))
        self = dcf_slice_skip(self, 1);
    while (self.size > 0 && dcf_is_blank(self.text[self.size - 1]))
        self.size--;
    return self;
}

struct dcf_slice dcf_slice_skip(struct dcf_slice self, size_t count)
{
    return (struct dcf_slice){ self.text + count, self.size - count };
}

struct dcf_slice dcf_slice_cut(struct dcf_slice self, size_t size)
{
    return (struct dcf_slice){ self.text, size };
}

int dcf_slice_compare(struct dcf_slice a, struct dcf_slice b)
{
    size_t size = a.size < b.size ? a.size : b.size;

    for (size_t i = 0; i < size; i++) {
        int difference = fold(a.text[i]) - fold(b.text[i]);

        if (difference != 0)
            return difference;
    }
    return (a.size > b.size) - (a.size < b.size);
}

bool dcf_slice_is(struct dcf_slice self, const char *text)
{
    return dcf_slice_compare(self, dcf_slice_of(text)) == 0;
}

bool dcf_slice_begins(struct dcf_slice self, const char *text)
{
    size_t size = strlen(text);

    return self.size >= size && dcf_slice_is(dcf_slice_cut(self, size), text);
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

char *dcf_slice_copy(struct dcf_slice self)
{
    char *copy = malloc(self.size + 1);

    if (!copy)
        return NULL;
    if (self.size > 0)
        memcpy(copy, self.text, self.size);
    copy[self.size] = '\0';
    return copy;
}

struct dcf_shown dcf_show(struct dcf_slice self)
{
    struct dcf_shown shown;
    size_t size = self.size < sizeof shown.text ? self.size : sizeof shown.text - 4;

    for (size_t i = 0; i < size; i++) {
        unsigned char c = (unsigned char)self.text[i];

        shown.text[i] = c < 0x20 || c == 0x7F ? '?' : (char)c;
    }
    snprintf(shown.text + size, sizeof shown.text - size, "%s", size < self.size ? "..." : "");
    return shown;
}

/*
 * A piece of the file's text: not copied, not ended by 0, its bytes as they are in the file.
 */
#ifndef CO_DCF_DCF_SLICE_H
#define CO_DCF_DCF_SLICE_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

struct dcf_slice {
    const char *text;
    size_t size;
};

struct dcf_shown { /* for messages: UTF-8, cut, without control characters */
    char text[64];
};

static inline bool dcf_is_blank(char c)
{
    return (unsigned char)c <= ' ' &&
           (c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0');
}

static inline struct dcf_slice dcf_slice_of(const char *text)
{
    return (struct dcf_slice){ text, strlen(text) };
}

static inline struct dcf_slice dcf_slice_skip(struct dcf_slice self, size_t count)
{
    return (struct dcf_slice){ self.text + count, self.size - count };
}

static inline struct dcf_slice dcf_slice_cut(struct dcf_slice self, size_t size)
{
    return (struct dcf_slice){ self.text, size };
}

struct dcf_slice dcf_slice_trim_blanks(struct dcf_slice self);

static inline struct dcf_slice dcf_slice_trim(struct dcf_slice self)
{
    bool has_none = self.size > 0 && self.text[0] > ' ' && self.text[self.size - 1] > ' ';

    return has_none ? self : dcf_slice_trim_blanks(self); /* most have none */
}

static inline int dcf_hex_digit(char c) /* -1: none */
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return c >= 'a' && c <= 'f' ? c - 'a' + 10 : -1;
}

/* Of ASCII letters only, whatever the locale. */
int dcf_slice_compare(struct dcf_slice a, struct dcf_slice b);
bool dcf_slice_is(struct dcf_slice self, const char *text);
bool dcf_slice_begins(struct dcf_slice self, const char *text);
bool dcf_slice_ends(struct dcf_slice self, const char *text);
/* All of it decimal digits and at most 'most'; false and *ret_number untouched otherwise. */
bool dcf_slice_decimal(struct dcf_slice self, unsigned most, unsigned *ret_number);
/* All of it hexadecimal digits, at least one and not more than 'digits'. */
bool dcf_slice_hex(struct dcf_slice self, size_t digits, unsigned *ret_number);
struct dcf_shown dcf_show(struct dcf_slice self);

#endif

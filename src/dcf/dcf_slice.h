/*
 * A piece of the file's text: not copied, not ended by 0, its bytes as they are in the file.
 */
#ifndef CO_DCF_DCF_SLICE_H
#define CO_DCF_DCF_SLICE_H

#include <stdbool.h>
#include <stddef.h>

struct dcf_slice {
    const char *text;
    size_t size;
};

struct dcf_shown { /* for messages: UTF-8, cut, without control characters */
    char text[64];
};

struct dcf_slice dcf_slice_of(const char *text);
struct dcf_slice dcf_slice_trim(struct dcf_slice self);
struct dcf_slice dcf_slice_skip(struct dcf_slice self, size_t count);
struct dcf_slice dcf_slice_cut(struct dcf_slice self, size_t size);
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

bool dcf_is_blank(char c);
int dcf_hex_digit(char c); /* -1: none */

#endif

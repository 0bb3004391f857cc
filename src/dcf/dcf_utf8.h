/*
 * The characters of a file's texts: the one place where bytes become UTF-8.
 *
 * A text that is valid UTF-8 is taken so; in any other one each byte is a character of
 * Windows-1252, which has Latin-1 in it. What travels to a device keeps its bytes and does not
 * come here.
 */
#ifndef CO_DCF_DCF_UTF8_H
#define CO_DCF_DCF_UTF8_H

#include "base/pool.h"
#include "dcf/dcf_slice.h"

#include <stdbool.h>
#include <stdint.h>

#define DCF_UTF8_SIZE_MAX 4u /* bytes of a character */

struct dcf_characters { /* of a text, to be taken one by one */
    struct dcf_slice rest;
    bool is_utf8;
};

struct dcf_characters dcf_characters_of(struct dcf_slice text);
/* The next one, or false at the end. */
bool dcf_characters_next(struct dcf_characters *self, uint32_t *ret_character);

/* Writes a character as UTF-8 to bytes of at least DCF_UTF8_SIZE_MAX; their number. */
unsigned dcf_utf8_put(uint32_t character, char *bytes);

/* A copy in UTF-8 ended by 0, or NULL: no memory. */
char *dcf_utf8_copy(struct co_pool *pool, struct dcf_slice text);

#endif

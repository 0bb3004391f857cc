/*
 * A line of text that grows up to its end; what does not fit is cut.
 */
#ifndef TOOLS_CCFREAD_TEXT_H
#define TOOLS_CCFREAD_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define TEXT_SIZE 1400u

struct text {
    char line[TEXT_SIZE];
    size_t length;
};

void text_clear(struct text *self);
void text_add(struct text *self, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* In quotes, with escapes; the first characters of many. Wide: UTF-16, as UNICODE_STRING has it. */
void text_add_string(struct text *self, const uint8_t *bytes, size_t size, bool wide);
/* 48 65 6C |Hel|; the first bytes of many */
void text_add_dump(struct text *self, const uint8_t *bytes, size_t size);

/* Since 1984-01-01, as CiA 301 counts; milliseconds since midnight. */
void text_add_date(struct text *self, uint32_t days);
void text_add_clock(struct text *self, uint32_t ms);

#endif

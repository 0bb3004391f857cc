#include "ccfread_text.h"

#include "base/bytes.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

#define STRING_BYTES 160u /* each of them, escaped, has 6 characters at most */
#define DUMP_BYTES   16u
#define DAYS_SHOWN   0x1FFFFu

void text_clear(struct text *self)
{
    self->line[0] = '\0';
    self->length = 0;
}

void text_add(struct text *self, const char *format, ...)
{
    const size_t room = sizeof self->line - self->length;
    va_list args;
    int length;

    va_start(args, format);
    length = vsnprintf(self->line + self->length, room, format, args);
    va_end(args);
    if (length > 0)
        self->length += (size_t)length < room ? (size_t)length : room - 1;
}

static void add_character(struct text *self, unsigned character, bool wide)
{
    switch (character) {
    case '"': text_add(self, "\\\""); return;
    case '\\': text_add(self, "\\\\"); return;
    case '\n': text_add(self, "\\n"); return;
    case '\r': text_add(self, "\\r"); return;
    case '\t': text_add(self, "\\t"); return;
    default: break;
    }
    if (character >= 0x20 && character <= 0x7E)
        text_add(self, "%c", (char)character);
    else if (wide)
        text_add(self, "\\u%04X", character);
    else
        text_add(self, "\\x%02X", character);
}

void text_add_string(struct text *self, const uint8_t *bytes, size_t size, bool wide)
{
    const size_t width = wide ? 2 : 1, whole = size - size % width;
    size_t i = 0;

    text_add(self, "\"");
    for (; i < whole && i < STRING_BYTES; i += width)
        add_character(self, wide ? get_le16(bytes + i) : bytes[i], wide);
    text_add(self, "\"%s", i < whole ? "..." : "");
    if (whole < size)
        text_add(self, " and half a character, %02Xh", bytes[whole]);
}

void text_add_dump(struct text *self, const uint8_t *bytes, size_t size)
{
    const size_t shown = size < DUMP_BYTES ? size : DUMP_BYTES;

    for (size_t i = 0; i < shown; i++)
        text_add(self, "%02X ", bytes[i]);
    text_add(self, "%s|", shown < size ? "... " : "");
    for (size_t i = 0; i < shown; i++)
        text_add(self, "%c", bytes[i] < 0x20 || bytes[i] > 0x7E ? '.' : (char)bytes[i]);
    text_add(self, "|");
}

static bool is_leap(unsigned year)
{
    return year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
}

static unsigned days_of_month(unsigned year, unsigned month)
{
    static const unsigned days[] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };

    return days[month] + (month == 1 && is_leap(year));
}

/* Not by gmtime(): time_t may end in 2038, 16 bits of days do in 2163. */
void text_add_date(struct text *self, uint32_t days)
{
    unsigned year = 1984, month = 0;

    if (days > DAYS_SHOWN) {
        text_add(self, "%lu days from 1984-01-01", (unsigned long)days);
        return;
    }
    for (; days >= (is_leap(year) ? 366u : 365u); year++)
        days -= is_leap(year) ? 366u : 365u;
    for (; days >= days_of_month(year, month); month++)
        days -= days_of_month(year, month);
    text_add(self, "%04u-%02u-%02u", year, month + 1, (unsigned)days + 1);
}

void text_add_clock(struct text *self, uint32_t ms)
{
    text_add(self, "%02" PRIu32 ":%02" PRIu32 ":%02" PRIu32 ".%03" PRIu32, ms / 3600000,
             ms / 60000 % 60, ms / 1000 % 60, ms % 1000);
}

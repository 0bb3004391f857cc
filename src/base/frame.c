#include "base/frame.h"

#include <stdio.h>
#include <string.h>

struct co_frame co_frame_make(uint32_t id, uint8_t dlc)
{
    struct co_frame frame = { .id = id, .dlc = dlc };

    return frame;
}

bool co_frame_equal(const struct co_frame *a, const struct co_frame *b)
{
    const uint8_t kind = CO_FRAME_EXT | CO_FRAME_RTR;

    if (a->id != b->id || a->dlc != b->dlc || (a->flags & kind) != (b->flags & kind))
        return false;
    return (a->flags & CO_FRAME_RTR) != 0 || memcmp(a->data, b->data, a->dlc) == 0;
}

char *co_frame_format(const struct co_frame *self, char *text, size_t size)
{
    char digits[2 * sizeof self->data + 1] = "";

    if (self->flags & CO_FRAME_RTR)
        snprintf(digits, sizeof digits, "R%u", self->dlc);
    for (unsigned i = 0; !(self->flags & CO_FRAME_RTR) && i < self->dlc && i < 8; i++)
        snprintf(digits + 2 * i, sizeof digits - 2 * i, "%02X", self->data[i]);
    snprintf(text, size, self->flags & CO_FRAME_EXT ? "%08X#%s" : "%03X#%s", self->id, digits);
    return text;
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return -1;
}

static const char *parse_id(const char *text, struct co_frame *frame)
{
    unsigned digits = 0;

    for (; hex_digit(*text) >= 0 && digits < 9; digits++)
        frame->id = frame->id << 4 | (uint32_t)hex_digit(*text++);
    if (*text != '#' || (digits != 3 && digits != 8))
        return NULL;
    if (digits == 8)
        frame->flags |= CO_FRAME_EXT;
    return frame->id <= (digits == 8 ? 0x1FFFFFFFu : 0x7FFu) ? text + 1 : NULL;
}

static const char *parse_data(const char *text, struct co_frame *frame)
{
    if (*text == 'R') {
        frame->flags |= CO_FRAME_RTR;
        text++;
        if (*text >= '0' && *text <= '8')
            frame->dlc = (uint8_t)(*text++ - '0');
        return text;
    }
    for (; hex_digit(text[0]) >= 0 && frame->dlc < 8; text += 2) {
        if (hex_digit(text[1]) < 0)
            return NULL;
        frame->data[frame->dlc++] = (uint8_t)(hex_digit(text[0]) << 4 | hex_digit(text[1]));
    }
    return text;
}

bool co_frame_parse(const char *text, struct co_frame *ret_frame)
{
    struct co_frame frame = { .id = 0 };
    const char *rest = parse_id(text, &frame);

    if (rest)
        rest = parse_data(rest, &frame);
    if (!rest || *rest != '\0')
        return false;
    *ret_frame = frame;
    return true;
}

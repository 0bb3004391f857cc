#include "support/hex.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

size_t hex_parse(const char *text, uint8_t *bytes, size_t room)
{
    size_t count = strcmp(text, "-") == 0 ? 0 : strlen(text) / 2;

    ck_assert_uint_le(count, room);
    for (size_t i = 0; i < count; i++) {
        unsigned byte = 0;

        ck_assert_int_eq(sscanf(text + 2 * i, "%2x", &byte), 1);
        bytes[i] = (uint8_t)byte;
    }
    return count;
}

char *hex_format(const uint8_t *bytes, size_t count, char *text, size_t size)
{
    ck_assert_uint_lt(2 * count, size);
    text[0] = '\0';
    for (size_t i = 0; i < count; i++)
        snprintf(text + 2 * i, size - 2 * i, "%02X", bytes[i]);
    return text;
}

uint32_t noise(uint64_t *seed)
{
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(*seed >> 33);
}

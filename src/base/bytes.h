/*
 * Little-endian numbers in byte buffers: the only way in which this code reads or writes wire data.
 */
#ifndef CO_BASE_BYTES_H
#define CO_BASE_BYTES_H

#include <stddef.h>
#include <stdint.h>

static inline uint16_t get_le16(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | bytes[1] << 8);
}

static inline uint32_t get_le32(const uint8_t *bytes)
{
    return get_le16(bytes) | (uint32_t)get_le16(bytes + 2) << 16;
}

/* The first size (0..8) bytes as an unsigned number. */
static inline uint64_t get_le(const uint8_t *bytes, size_t size)
{
    uint64_t value = 0;

    for (size_t i = size; i > 0; i--)
        value = value << 8 | bytes[i - 1];
    return value;
}

static inline void put_le(uint8_t *bytes, size_t size, uint64_t value)
{
    for (size_t i = 0; i < size; i++, value >>= 8)
        bytes[i] = (uint8_t)value;
}

static inline void put_le16(uint8_t *bytes, uint16_t value)
{
    put_le(bytes, 2, value);
}

static inline void put_le32(uint8_t *bytes, uint32_t value)
{
    put_le(bytes, 4, value);
}

#endif

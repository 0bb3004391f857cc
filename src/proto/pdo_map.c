#include "proto/pdo_map.h"

#include "base/bytes.h"

#include <string.h>

void pdo_map_init(struct pdo_map *self, struct pdo_field *fields, uint8_t room)
{
    *self = (struct pdo_map){ .fields = fields, .room = room };
}

void pdo_map_clear(struct pdo_map *self)
{
    self->count = 0;
    self->bits = 0;
}

/* Whole bytes at their place, and a number of just that size: they need no shifting. */
static bool is_copied(const struct pdo_map *self, const struct od_entry *entry, uint8_t bits)
{
    if ((self->bits & 7u) != 0 || (bits & 7u) != 0)
        return false;
    return entry == NULL || (entry->type != OD_BOOLEAN && od_type_size(entry->type) * 8u == bits);
}

bool pdo_map_add(struct pdo_map *self, struct od_entry *entry, uint8_t bits)
{
    if (self->count == self->room || bits == 0 || bits > PDO_FIELDS_MAX - self->bits)
        return false;
    self->fields[self->count] = (struct pdo_field){
        .entry = entry, .first = self->bits, .bits = bits, .bytes = is_copied(self, entry, bits)
    };
    self->bits = (uint8_t)(self->bits + bits);
    self->count++;
    return true;
}

bool pdo_map_contains(const struct pdo_map *self, const struct od_entry *entry)
{
    for (unsigned i = 0; i < self->count; i++)
        if (self->fields[i].entry == entry)
            return true;
    return false;
}

uint8_t pdo_map_size(const struct pdo_map *self)
{
    return (uint8_t)((self->bits + 7u) / 8u);
}

static uint64_t mask_of(unsigned bits)
{
    return bits < 64 ? (UINT64_C(1) << bits) - 1 : UINT64_MAX;
}

static uint64_t entry_number(const struct od_entry *entry)
{
    return get_le(entry->value, entry->size < OD_SMALL ? entry->size : OD_SMALL);
}

/* What a field carries, as a number. */
static uint64_t field_value(const struct pdo_field *field)
{
    const struct od_entry *entry = field->entry;

    if (entry == NULL)
        return 0;
    if (od_type_signed(entry->type))
        return (uint64_t)od_entry_signed(entry) & mask_of(field->bits);
    return entry_number(entry) & mask_of(field->bits);
}

static void or_bits(uint8_t *data, unsigned first, uint64_t value, unsigned bits)
{
    for (unsigned done = 0; done < bits;) {
        const unsigned bit = (first + done) & 7u;

        data[(first + done) / 8] |= (uint8_t)(value << bit);
        value >>= 8 - bit;
        done += 8 - bit;
    }
}

static uint64_t get_bits(const uint8_t *data, unsigned first, unsigned bits)
{
    return get_le(data, PDO_SIZE_MAX) >> first & mask_of(bits);
}

void pdo_map_read(const struct pdo_map *self, uint8_t data[PDO_SIZE_MAX])
{
    memset(data, 0, PDO_SIZE_MAX);
    for (const struct pdo_field *field = self->fields; field < self->fields + self->count; field++)
        if (!field->bytes)
            or_bits(data, field->first, field_value(field), field->bits);
        else if (field->entry != NULL)
            memcpy(data + field->first / 8, field->entry->value, field->bits / 8);
}

/* Few bytes, very often: calls of memcmp() and memcpy() would cost more. */
static bool replace_bytes(uint8_t *bytes, const uint8_t *others, unsigned size)
{
    unsigned different = 0;

    for (unsigned i = 0; i < size; i++) {
        different |= (unsigned)(bytes[i] ^ others[i]);
        bytes[i] = others[i];
    }
    return different != 0;
}

/* Bits that are no number of just this size: BOOLEAN, strings, lengths that do not fit. */
static bool set_number(const struct pdo_field *field, uint64_t value)
{
    struct od_entry *entry = field->entry;
    const uint64_t sign = UINT64_C(1) << (field->bits - 1);
    uint32_t size = od_type_size(entry->type);
    uint8_t bytes[OD_SMALL];
    bool resized;

    if (size == 0)
        size = (field->bits + 7u) / 8u;
    if (size > entry->capacity)
        size = entry->capacity;
    if (entry->type == OD_BOOLEAN)
        value = value != 0;
    else if (od_type_signed(entry->type))
        value = (value ^ sign) - sign;
    put_le(bytes, sizeof bytes, value);
    resized = entry->size != size;
    entry->size = size;
    return replace_bytes(entry->value, bytes, size) || resized;
}

static bool set_field(const struct pdo_field *field, const uint8_t *data)
{
    if (field->entry == NULL)
        return false;
    if (field->bytes)
        return replace_bytes(field->entry->value, data + field->first / 8, field->bits / 8);
    return set_number(field, get_bits(data, field->first, field->bits));
}

uint64_t pdo_map_write(const struct pdo_map *self, const uint8_t data[PDO_SIZE_MAX])
{
    uint64_t changed = 0;

    for (unsigned i = 0; i < self->count; i++)
        if (set_field(&self->fields[i], data))
            changed |= UINT64_C(1) << i;
    return changed;
}

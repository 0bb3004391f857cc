/*
 * The mapping of one PDO: which entries of the dictionary its bits belong to (CiA 301, 7.4.9.2).
 *
 *       byte 0     1        2        3
 *      +--------+--------+--------+-------x+
 *      | u8     | i16 low  i16 hi | bool   |     bits follow one another, the lowest ones first;
 *      +--------+--------+--------+--------+     what is left of the last byte is 0
 *
 *   in   entries and their lengths, one after the other
 *   out  the data of a frame from the dictionary's values, and the other way round
 *
 *   owner    a PDO; its owner brings the fields
 *   locking  none; the owner's
 */
#ifndef CO_PROTO_PDO_MAP_H
#define CO_PROTO_PDO_MAP_H

#include "od/od.h"

#define PDO_SIZE_MAX   8u  /* bytes */
#define PDO_FIELDS_MAX 64u /* and bits */

struct pdo_field {
    struct od_entry *entry; /* NULL: bits that nobody gives or takes */
    uint8_t first;          /* bit in the PDO */
    uint8_t bits;           /* 1..64 */
    bool bytes;             /* whole bytes on byte boundaries, and as many as the number has */
};

struct pdo_map {
    struct pdo_field *fields;
    uint8_t room;
    uint8_t count;
    uint8_t bits; /* of all fields */
};

void pdo_map_init(struct pdo_map *self, struct pdo_field *fields, uint8_t room);
void pdo_map_clear(struct pdo_map *self);
/* False, and nothing changed: no room for the field, or it makes more than 64 bits or none. */
bool pdo_map_add(struct pdo_map *self, struct od_entry *entry, uint8_t bits);
bool pdo_map_contains(const struct pdo_map *self, const struct od_entry *entry);
/* Bytes of the PDO. */
uint8_t pdo_map_size(const struct pdo_map *self);

/* The values of the dictionary; bytes that are not mapped become 0. */
void pdo_map_read(const struct pdo_map *self, uint8_t data[PDO_SIZE_MAX]);
/*
 * Sets the values of the dictionary; returns which fields have got another one, as bits. A number
 * longer than its field is extended by its sign, a BOOLEAN is true when any bit is.
 */
uint64_t pdo_map_write(const struct pdo_map *self, const uint8_t data[PDO_SIZE_MAX]);

#endif

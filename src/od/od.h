/*
 * Object dictionary: the entries of one device, with types, access rights, limits and values.
 *
 *   in   entries from a device description, values from SDO, PDO and the application
 *   out  values, or the abort code that CiA 301 gives for the refusal
 *
 * Values are kept as they travel: little-endian bytes, numbers with exactly the size of their type.
 * Entries are found by index and sub-index; their addresses stay valid until od_done(). A string or
 * domain may live in memory of the application (od_refer()).
 *
 *   owner    a local device
 *   locking  none; the owner's
 */
#ifndef CO_OD_OD_H
#define CO_OD_OD_H

#include "base/error.h"
#include "od/abort.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* CiA 301 data type indices. */
enum od_type {
    OD_BOOLEAN = 0x01,
    OD_INTEGER8 = 0x02,
    OD_INTEGER16 = 0x03,
    OD_INTEGER32 = 0x04,
    OD_UNSIGNED8 = 0x05,
    OD_UNSIGNED16 = 0x06,
    OD_UNSIGNED32 = 0x07,
    OD_REAL32 = 0x08,
    OD_VISIBLE_STRING = 0x09,
    OD_OCTET_STRING = 0x0A,
    OD_UNICODE_STRING = 0x0B,
    OD_TIME_OF_DAY = 0x0C,
    OD_TIME_DIFFERENCE = 0x0D,
    OD_DOMAIN = 0x0F,
    OD_INTEGER24 = 0x10,
    OD_REAL64 = 0x11,
    OD_INTEGER40 = 0x12,
    OD_INTEGER48 = 0x13,
    OD_INTEGER56 = 0x14,
    OD_INTEGER64 = 0x15,
    OD_UNSIGNED24 = 0x16,
    OD_UNSIGNED40 = 0x18,
    OD_UNSIGNED48 = 0x19,
    OD_UNSIGNED56 = 0x1A,
    OD_UNSIGNED64 = 0x1B
};

/* OD_NONE: for the device itself and PDOs, not for SDO clients. */
enum od_access { OD_RO, OD_WO, OD_RW, OD_RWR, OD_RWW, OD_CONST, OD_NONE };

#define OD_SMALL 8u /* bytes of the longest number */

struct od_entry {
    uint16_t index;
    uint8_t sub;
    uint8_t type;   /* enum od_type */
    uint8_t access; /* enum od_access */
    bool mappable;
    bool has_low, has_high;
    bool referred;    /* the value's bytes are the application's */
    bool watched;     /* the application is to be asked before a client's value is stored, and
                           for new data of a TPDO */
    bool fetched;     /* its bytes are with the owner, who is asked for them when a client reads */
    uint16_t map_max; /* how many PDOs it may be in; 0: any number */
    uint16_t map_count; /* how many it is in */
    uint32_t frozen;    /* bits of a number that clients cannot change */
    /* Of the type's own sign: unsigned types as uint64_t in the same bits; REAL32 and REAL64: the
     * bits of the value in the type's own format. */
    int64_t low, high;
    uint32_t capacity; /* most bytes a value may have; the type's size for numbers */
    uint32_t size;     /* bytes of the present value */
    uint8_t *value;
    uint32_t initial_size;     /* the power-on value, what a reset brings back */
    uint8_t *initial;          /* NULL: the bytes a reset brings back are those at initial_value */
    uint8_t *initial_value;    /* referred: where the value was to begin with */
    uint32_t initial_capacity; /* ... and how much room was there */
    uint32_t default_size;
    uint8_t *defaults;          /* the DefaultValue; NULL: initial is it */
    uint8_t small[3][OD_SMALL]; /* value, initial and defaults of a number */
    char *name;                 /* ParameterName, or NULL */
    uint32_t handle;            /* the number its owner has given it; 0: none */
    void *owner;                /* what the owner of the dictionary keeps with it; NULL */
};

struct od {
    struct od_entry **entries; /* sorted by index and sub-index */
    size_t count;
    size_t room;
};

/* Describes a new entry. */
struct od_spec {
    uint16_t index;
    uint8_t sub;
    uint8_t type;
    uint8_t access;
    bool mappable;
    bool has_low, has_high;
    int64_t low, high;
    const uint8_t *value; /* NULL: zeros for numbers, empty for the others */
    uint32_t size;
    uint32_t capacity; /* 0: the type's size; for strings and domains 'size', at least 64 */
    const char *name;  /* copied; may be NULL */
};

void od_init(struct od *self);
void od_done(struct od *self);

/* CO_ERR_EXISTS: there already; CO_ERR_ARG: unknown type, value of wrong size; CO_ERR_MEMORY */
enum co_err od_add(struct od *self, const struct od_spec *spec, struct od_entry **ret_entry);

/* Adds an UNSIGNED8, 16 or 32 (by size 1, 2, 4), for objects that the stack itself brings. */
enum co_err od_add_number(struct od *self, uint16_t index, uint8_t sub, uint8_t type,
                          enum od_access access, uint64_t value);

/* Takes an object out, with all its entries; forget gets their owners that are not NULL. */
void od_remove_object(struct od *self, uint16_t index, void (*forget)(void *owner));

struct od_entry *od_find(const struct od *self, uint16_t index, uint8_t sub);
bool od_has_object(const struct od *self, uint16_t index);

/*
 * From now on the value is 'size' bytes in the application's memory, which has room for 'capacity'.
 * 'initial': they are the power-on value, too. For strings and domains. CO_ERR_MEMORY
 */
enum co_err od_refer(struct od_entry *entry, uint8_t *bytes, uint32_t size, uint32_t capacity,
                     bool initial);
/*
 * From now on, up to an od_refer(), the owner has the value, of 'capacity' bytes at most, and the
 * entry none: it is 'fetched'. For domains.
 */
void od_fetch(struct od_entry *entry, uint32_t capacity);

/* The number in an entry (the first 8 bytes of a longer one); 'missing' if there is none. */
uint64_t od_number(const struct od *self, uint16_t index, uint8_t sub, uint64_t missing);
/* The number in an entry's present value, sign-extended for signed types. */
int64_t od_entry_signed(const struct od_entry *entry);

/*
 * The checks in the order of CiA 301, each with its abort code: object exists, sub-index exists,
 * access right. SDO_OK and the entry, or the code and *ret_entry untouched.
 */
sdo_abort_t od_check_read(const struct od *self, uint16_t index, uint8_t sub,
                          struct od_entry **ret_entry);
sdo_abort_t od_check_write(const struct od *self, uint16_t index, uint8_t sub,
                           struct od_entry **ret_entry);
/* Length and limits of a value for this entry. */
sdo_abort_t od_check_size(const struct od_entry *entry, uint32_t size);
sdo_abort_t od_check_value(const struct od_entry *entry, const uint8_t *value, uint32_t size);

/* Sets a value whatever the access right; length and limits are checked. */
sdo_abort_t od_set(struct od_entry *entry, const uint8_t *value, uint32_t size);
/*
 * Sets a number, in the size of the entry's type, without looking at limits; an entry that does not
 * exist, or is a string or domain, is left out.
 */
void od_set_number(struct od *self, uint16_t index, uint8_t sub, uint64_t value);

/* Brings the power-on value back, and those of the objects first..last. */
void od_reset_entry(struct od_entry *entry);
void od_reset(struct od *self, uint16_t first, uint16_t last);
/* The description of an entry was changed: its power-on value is its DefaultValue. */
void od_forget_default(struct od_entry *entry);

/* Clients have the right to write it. */
bool od_can_be_written(const struct od_entry *entry);

/* An entry of this access (enum od_access) may be mapped into a TPDO, or else an RPDO. */
bool od_access_fits(uint8_t access, bool transmit);

/* Bytes of a value of this type; 0: varies (strings, domain) or no type of CiA 301. */
uint32_t od_type_size(uint8_t type);
bool od_type_known(uint8_t type);
bool od_type_signed(uint8_t type);
const char *od_type_name(uint8_t type);

#endif

/*
 * PDOs of the device under test, as its communication and mapping parameters say.
 */
#ifndef TOOLS_CONFORM_PDO_H
#define TOOLS_CONFORM_PDO_H

#include "conform.h"

#define RPDO 0x1400u /* communication parameters; the mapping is 200h further on */
#define TPDO 0x1800u

#define PDO_INVALID 0x80000000u /* bits of a COB-ID */
#define PDO_NO_RTR  0x40000000u

#define PDO_ENTRIES_MAX 64u

#define EMCY_SHORT_PDO 0x8210u

struct conform_pdo {
    uint16_t index; /* of the communication parameter */
    uint32_t cob_id;
    uint8_t type;
    uint8_t count; /* of mapped objects */
    uint8_t bytes;
    uint32_t entries[PDO_ENTRIES_MAX]; /* index << 16 | sub << 8 | bits */
};

static inline uint32_t pdo_id(const struct conform_pdo *pdo)
{
    return pdo->cob_id & 0x7FFu;
}

static inline uint16_t pdo_map(const struct conform_pdo *pdo)
{
    return (uint16_t)(pdo->index + 0x200u);
}

static inline uint16_t pdo_entry_index(uint32_t entry)
{
    return (uint16_t)(entry >> 16);
}

static inline uint8_t pdo_entry_sub(uint32_t entry)
{
    return (uint8_t)(entry >> 8);
}

/* False and told: what must be readable is not. */
bool conform_read_pdo(struct conform *self, uint16_t index, struct conform_pdo *ret_pdo);
/* The first PDO of a direction that is in use: valid, with something mapped. Else SKIP. */
bool conform_find_pdo(struct conform *self, uint16_t direction, struct conform_pdo *ret_pdo);
typedef bool conform_fits(struct conform *self, const struct conform_pdo *pdo);
/* The first one that fits, too; else SKIP. */
bool conform_find_fitting_pdo(struct conform *self, uint16_t direction, conform_fits *fits,
                              struct conform_pdo *ret_pdo);
/* The same; where there is none nothing is told. */
bool conform_look_for_pdo(struct conform *self, uint16_t direction, conform_fits *fits,
                          struct conform_pdo *ret_pdo);

/* Bit 31 of its COB-ID; what else the COB-ID has is that of 'pdo'. */
bool conform_switch_pdo(struct conform *self, const struct conform_pdo *pdo, bool on);
/* Transmission type; the PDO is switched off for it, and on. */
bool conform_set_pdo_type(struct conform *self, struct conform_pdo *pdo, uint8_t type);

/* Switched off and unmapped, so that its mapping can be set. Else SKIP: the mapping is fixed. */
bool conform_unmap_pdo(struct conform *self, const struct conform_pdo *pdo);
/* The entries of 'pdo', and on. It counts its bytes. */
bool conform_map_pdo(struct conform *self, struct conform_pdo *pdo);

/* Of this device: the object may be mapped into a PDO of this direction; by the EDS. */
bool conform_is_mappable(const struct conform_object *object, uint16_t direction);
/* The entry that maps it. */
uint32_t conform_entry(const struct conform_object *object);

/* The device has done what it was told until now. */
void conform_barrier(struct conform *self);

/* All zeros, so many bytes. */
size_t conform_send_rpdo(struct conform *self, const struct conform_pdo *pdo, uint8_t dlc);

/*
 * Starts the device and sends it an RPDO without data. ret_from is behind that frame. Else SKIP: it
 * has no RPDO in use.
 */
bool conform_provoke(struct conform *self, struct conform_pdo *ret_pdo, size_t *ret_from);
/* The RPDO again, as it should be. */
size_t conform_appease(struct conform *self, const struct conform_pdo *pdo);

#endif

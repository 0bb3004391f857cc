#include "conform_pdo.h"

#include "conform_services.h"

static bool read_entries(struct conform *self, struct conform_pdo *pdo)
{
    uint64_t entry;
    unsigned bits = 0;

    for (unsigned i = 0; i < pdo->count; i++) {
        if (!conform_must_read_number(self, pdo_map(pdo), (uint8_t)(i + 1), &entry))
            return false;
        pdo->entries[i] = (uint32_t)entry;
        bits += entry & 0xFF;
    }
    pdo->bytes = (uint8_t)((bits + 7) / 8);
    return true;
}

bool conform_read_pdo(struct conform *self, uint16_t index, struct conform_pdo *ret_pdo)
{
    uint64_t cob_id, type, count;

    if (!conform_must_read_number(self, index, 1, &cob_id) ||
        !conform_must_read_number(self, index, 2, &type) ||
        !conform_must_read_number(self, (uint16_t)(index + 0x200u), 0, &count))
        return false;
    *ret_pdo = (struct conform_pdo){
        .index = index,
        .cob_id = (uint32_t)cob_id,
        .type = (uint8_t)type,
        .count = count <= PDO_ENTRIES_MAX ? (uint8_t)count : 0 /* an MPDO */
    };
    return read_entries(self, ret_pdo);
}

bool conform_find_pdo(struct conform *self, uint16_t direction, struct conform_pdo *ret_pdo)
{
    for (uint16_t index = direction; index < direction + 0x200u; index++) {
        if (!conform_find(self, index, 1))
            continue;
        if (!conform_read_pdo(self, index, ret_pdo))
            return false;
        if ((ret_pdo->cob_id & PDO_INVALID) == 0 && ret_pdo->bytes > 0)
            return true;
    }
    return conform_skip(self, "the device has no %s in use after a reset",
                        direction == RPDO ? "RPDO" : "TPDO");
}

size_t conform_send_rpdo(struct conform *self, const struct conform_pdo *pdo, uint8_t dlc)
{
    const struct co_frame frame = co_frame_make(pdo_id(pdo), dlc);
    const size_t from = conform_send(self, &frame);

    if (pdo->type <= 240)
        conform_send_sync(self);
    return from;
}

bool conform_provoke(struct conform *self, struct conform_pdo *ret_pdo, size_t *ret_from)
{
    if (!conform_find_pdo(self, RPDO, ret_pdo))
        return false;
    conform_nmt(self, CONFORM_START);
    *ret_from = conform_send_rpdo(self, ret_pdo, 0);
    return true;
}

size_t conform_appease(struct conform *self, const struct conform_pdo *pdo)
{
    return conform_send_rpdo(self, pdo, pdo->bytes);
}

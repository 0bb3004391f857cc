/* Reading and writing the dictionary of a local node. */
#include "api/scan.h"

#include <string.h>

#define MANUFACTURER_STATUS                                                                        \
    0x1002u /* of the library's own objects, the one the application writes */
#define FIRST_APPLICATION 0x2000u

/* An entry by its place, or by its handle. */
struct place {
    uint16_t index, sub;
    uint32_t handle; /* 0: by index and sub-index */
};

static int find_entry(const struct scan_node *node, const struct place *place,
                      struct od_entry **ret_entry)
{
    if (place->handle != 0) {
        if (place->handle > node->handle_count)
            return SCANOPEN_INVALID_HANDLE;
        *ret_entry = node->handles[place->handle - 1];
        return SCANOPEN_OK;
    }
    *ret_entry = place->sub <= UINT8_MAX ? od_find(&node->od, place->index, (uint8_t)place->sub)
                                         : NULL;
    if (*ret_entry)
        return SCANOPEN_OK;
    return od_has_object(&node->od, place->index) ? SCANOPEN_WRONG_SUBINDEX : SCANOPEN_WRONG_INDEX;
}

int canOpenGetDictionaryHnd(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            HDICT *HDict)
{
    const struct place place = { .index = Index, .sub = Subindex };
    struct od_entry *entry;
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    if (HDict)
        *HDict = NULL;
    if (result != SCANOPEN_OK)
        return result;
    network_hold(node->net->network);
    result = HDict ? find_entry(node, &place, &entry) : SCANOPEN_WRONG_PARAMETER;
    if (result == SCANOPEN_OK)
        result = scan_entry_handle(node, entry, HDict);
    network_release(node->net->network);
    scan_leave(node);
    return result;
}

/* ---- reading ---- */

/* Entries that canOpenInitDictionary has to make first, and those whose value is in a file. */
static bool is_missing(const struct od_entry *entry)
{
    const struct scan_entry *owner = entry->owner;

    return (owner && !owner->initialized) || entry->fetched;
}

static void give_pointer(const void *pointer, void *data)
{
    memcpy(data, &pointer, sizeof pointer);
}

static int read_entry(struct od_entry *entry, void *data)
{
    struct scan_entry *owner = entry->owner;
    union scan_number number;

    if (is_missing(entry))
        return SCANOPEN_WRONG_TYPE;
    if (entry->access == OD_WO)
        return SCANOPEN_ACCESS_ERROR;
    if (scan_is_text(entry->type)) {
        give_pointer(entry->value, data);
        return SCANOPEN_OK;
    }
    scan_number_from(entry->type, entry->value, &number);
    if (scan_size(entry->type) != 0) {
        memcpy(data, number.bytes, scan_size(entry->type));
    } else if (owner) {
        owner->time = number.time;
        give_pointer(&owner->time, data);
    } else {
        return SCANOPEN_WRONG_TYPE;
    }
    return SCANOPEN_OK;
}

static int read_place(struct scan_node *node, const struct place *place, void *data)
{
    struct od_entry *entry;
    int result = SCANOPEN_WRONG_PARAMETER;

    if (data) {
        network_hold(node->net->network);
        result = find_entry(node, place, &entry);
        if (result == SCANOPEN_OK)
            result = read_entry(entry, data);
        network_release(node->net->network);
    }
    scan_leave(node);
    return result;
}

int canOpenReadDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex, void *Data)
{
    const struct place place = { .index = Index, .sub = Subindex };
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    return result == SCANOPEN_OK ? read_place(node, &place, Data) : result;
}

int canOpenReadDictionaryHnd(HDICT HDict, void *Data)
{
    struct place place = { .index = 0 };
    struct scan_node *node;
    int result = scan_enter_entry(HDict, &node, &place.handle);

    return result == SCANOPEN_OK ? read_place(node, &place, Data) : result;
}

/* ---- writing ---- */

/* The application's: its own objects, and the status register. */
static bool may_write(const struct od_entry *entry)
{
    if (entry->access == OD_CONST)
        return false;
    return entry->owner || entry->index >= FIRST_APPLICATION || entry->index == MANUFACTURER_STATUS;
}

static int write_text(struct od_entry *entry, const void *data)
{
    const RecOctString *text = data;

    if (text->ulLength > text->ulSize || text->ulSize > UINT32_MAX ||
        (!text->pData && text->ulSize > 0))
        return SCANOPEN_WRONG_PARAMETER;
    if (od_refer(entry, text->pData, (uint32_t)text->ulLength, (uint32_t)text->ulSize, false) !=
        CO_OK)
        return SCANOPEN_OUT_OF_MEMORY;
    scan_end_text(entry);
    return SCANOPEN_OK;
}

static int write_number(struct od_entry *entry, const void *data)
{
    uint8_t bytes[8];

    scan_number_to(entry->type, data, bytes);
    return scan_error_of_value(od_set(entry, bytes, od_type_size(entry->type)));
}

static int write_entry(struct od_entry *entry, const void *data)
{
    if (is_missing(entry))
        return SCANOPEN_WRONG_TYPE;
    if (!may_write(entry))
        return SCANOPEN_ACCESS_ERROR;
    return scan_is_text(entry->type) ? write_text(entry, data) : write_number(entry, data);
}

/* The device is told of the change; what is sent because of it may have to be waited for. */
static int announce_change(struct scan_node *node, struct od_entry *entry, co_us_t now,
                           struct co_outbox *out)
{
    int result;

    if (!node->active)
        return SCANOPEN_OK;
    result = scan_error_of_send(slave_entry_changed(&node->slave, entry, now, out));
    if (scan_node_state(node) != NodeOperational)
        return SCANOPEN_OK;
    return scan_wait_sent(node, entry, result);
}

/* Without data the entry's PDOs go out as they are. */
static int announce(struct scan_node *node, struct od_entry *entry, const void *data, co_us_t now,
                    struct co_outbox *out)
{
    if (data)
        return announce_change(node, entry, now, out);
    if (!scan_is_sent(node, entry))
        return SCANOPEN_WRONG_PARAMETER;
    if (scan_node_state(node) != NodeOperational)
        return SCANOPEN_WRONG_NODESTATE;
    return announce_change(node, entry, now, out);
}

static int write_place(struct scan_node *node, const struct place *place, const void *data)
{
    struct od_entry *entry;
    struct co_outbox *out;
    co_us_t now;
    int result;

    out = scan_lock_untimed(node, &now);
    result = find_entry(node, place, &entry);
    if (result == SCANOPEN_OK && node->active && slave_entry_is_timed(&node->slave, entry))
        now = network_clock(node->net->network);
    if (result == SCANOPEN_OK && data)
        result = write_entry(entry, data);
    if (result == SCANOPEN_OK)
        result = announce(node, entry, data, now, out);
    scan_unlock(node);
    scan_leave(node);
    return result;
}

int canOpenWriteDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                           const void *Data)
{
    const struct place place = { .index = Index, .sub = Subindex };
    struct scan_node *node;
    int result = scan_enter(HNode, &node);

    return result == SCANOPEN_OK ? write_place(node, &place, Data) : result;
}

int canOpenWriteDictionaryHnd(HDICT HDict, const void *Data)
{
    struct place place = { .index = 0 };
    struct scan_node *node;
    int result = scan_enter_entry(HDict, &node, &place.handle);

    return result == SCANOPEN_OK ? write_place(node, &place, Data) : result;
}

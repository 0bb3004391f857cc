/* Making entries: canOpenExtendDictionary, canOpenInitDictionary; reading and writing them is in
 * scan_access.c. */
#include "api/scan.h"

#include <stdlib.h>
#include <string.h>

/* In C11 a macro of the header, so that descriptors may be arrays of pointers. */
#undef canOpenExtendDictionary

#define FIRST_OBJECT 0x2000u
#define LAST_OBJECT  0x9FFFu
#define SUBS_MAX     254u
#define STRUCTURE    0xFFu /* the sub-index that describes an object */
#define FLAGS        (READ_ACCESS | WRITE_ACCESS | MAPPABLE | MULTI_MAP)

/* ---- canOpenExtendDictionary ---- */

struct object {
    uint16_t index, kind;
    unsigned subs; /* the highest */
    const char *types;
};

/* A type of the slave interface as the dictionary has it; 0: there is none. */
static uint8_t type_of(char descriptor)
{
    static const char types[] = {
        TYP_BOOL,       TYP_INT8,        TYP_INT16,           TYP_INT32, TYP_INT64,  TYP_UINT8,
        TYP_UINT16,     TYP_UINT32,      TYP_UINT64,          TYP_FLOAT, TYP_DOUBLE, TYP_VIS_STRING,
        TYP_OCT_STRING, TYP_TIME_OF_DAY, TYP_TIME_DIFFERENCE, TYP_DOMAIN
    };

    if (descriptor == TYP_CHAR)
        return OD_INTEGER8;
    return memchr(types, descriptor, sizeof types) ? (uint8_t)descriptor : 0;
}

static int check_types(const struct object *object)
{
    const size_t count = strnlen(object->types, SUBS_MAX + 2);

    for (size_t i = 0; i < count; i++)
        if (type_of(object->types[i]) == 0)
            return SCANOPEN_WRONG_TYPE;
    if (object->kind != OBJ_RECORD)
        return count == 1 ? SCANOPEN_OK : SCANOPEN_WRONG_TYPE;
    if (count == object->subs && count > 0)
        return SCANOPEN_OK; /* without sub-index 0 */
    return count == object->subs + 1 && object->types[0] == TYP_UINT8 ? SCANOPEN_OK
                                                                      : SCANOPEN_WRONG_TYPE;
}

static int check_object(const struct scan_node *node, const struct object *object)
{
    if (object->index < FIRST_OBJECT || object->index > LAST_OBJECT ||
        od_has_object(&node->od, object->index))
        return SCANOPEN_WRONG_INDEX;
    if (object->kind != OBJ_VAR && object->kind != OBJ_ARRAY && object->kind != OBJ_RECORD)
        return SCANOPEN_WRONG_OBJECT_TYPE;
    if (object->subs > SUBS_MAX || (object->kind == OBJ_VAR && object->subs != 0))
        return SCANOPEN_WRONG_SUBINDEX;
    return check_types(object);
}

static uint8_t type_at(const struct object *object, unsigned sub)
{
    const size_t count = strnlen(object->types, SUBS_MAX + 2);

    if (object->kind != OBJ_RECORD)
        return type_of(object->types[0]);
    return type_of(object->types[count == object->subs ? sub - 1 : sub]);
}

/* An entry that waits for canOpenInitDictionary. */
static enum co_err add_entry(struct od *od, const struct object *object, unsigned sub)
{
    const struct od_spec spec = {
        .index = object->index, .sub = (uint8_t)sub, .type = type_at(object, sub), .access = OD_NONE
    };
    struct scan_entry *owner = calloc(1, sizeof *owner);
    struct od_entry *entry = NULL;
    enum co_err err = owner ? od_add(od, &spec, &entry) : CO_ERR_MEMORY;

    if (err == CO_OK)
        entry->owner = owner;
    else
        free(owner);
    return err;
}

static enum co_err add_fixed(struct od *od, uint16_t index, unsigned sub, uint8_t type,
                             uint32_t value)
{
    return od_add_number(od, index, (uint8_t)sub, type, OD_CONST, value);
}

static enum co_err add_object(struct od *od, const struct object *object)
{
    const bool has_count = object->kind == OBJ_ARRAY;
    const bool is_bare = object->kind == OBJ_RECORD && object->types[object->subs] == '\0';
    const uint32_t type = object->kind == OBJ_RECORD ? 0u : type_at(object, 0);
    enum co_err err = CO_OK;

    if (has_count)
        err = add_fixed(od, object->index, 0, OD_UNSIGNED8, object->subs);
    for (unsigned sub = has_count || is_bare ? 1 : 0; sub <= object->subs && err == CO_OK; sub++)
        err = add_entry(od, object, sub);
    if (err == CO_OK)
        err = add_fixed(od, object->index, STRUCTURE, OD_UNSIGNED32, type << 8 | object->kind);
    return err;
}

static int extend(struct scan_node *node, const struct object *object)
{
    int result = check_object(node, object);

    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    if (result != SCANOPEN_OK)
        return result;
    if (add_object(&node->od, object) == CO_OK)
        return SCANOPEN_OK;
    od_remove_object(&node->od, object->index, scan_free_entry);
    return SCANOPEN_OUT_OF_MEMORY;
}

int canOpenExtendDictionary(HNODE HNode, unsigned short Index, unsigned short Subentries,
                            unsigned short ObjectType, const char *DataType)
{
    const struct object object = {
        .index = Index, .kind = ObjectType, .subs = Subentries, .types = DataType
    };
    struct scan_node *node;
    int result = scan_enter(HNode, &node);
    co_us_t now;

    if (result != SCANOPEN_OK)
        return result;
    scan_lock(node, &now);
    result = DataType ? extend(node, &object) : SCANOPEN_WRONG_PARAMETER;
    scan_unlock(node);
    scan_leave(node);
    return result;
}

/* ---- canOpenInitDictionary ---- */

struct init {
    uint16_t index, sub;
    const char *name;
    unsigned flags;
    const DictionaryData *data;
    struct scan_entry handlers;
};

/* The numbers of *Data, as they travel. */
enum { VALUE, INITIAL, LOWEST, HIGHEST, NUMBERS };

struct numbers {
    uint8_t bytes[NUMBERS][8];
    bool limited;
};

static void read_numbers(uint8_t type, const DictionaryData *data, struct numbers *ret_numbers)
{
    const bool has_limits = type != OD_BOOLEAN && scan_size(type) != 0;
    const size_t step = scan_size(type) != 0 ? scan_size(type) : sizeof(CAN_TIME_OF_DAY);
    const char *place = (const char *)data;

    *ret_numbers = (struct numbers){ .limited = false };
    for (unsigned i = 0; i < (has_limits ? NUMBERS : LOWEST); i++)
        scan_number_to(type, place + i * step, ret_numbers->bytes[i]);
    for (unsigned i = 0; has_limits && i < 8; i++)
        if (ret_numbers->bytes[LOWEST][i] != 0 || ret_numbers->bytes[HIGHEST][i] != 0)
            ret_numbers->limited = true;
}

static int64_t limit_of(uint8_t type, const uint8_t bytes[8])
{
    struct od_entry entry = { .type = type, .size = od_type_size(type) };

    entry.value = entry.small[0];
    memcpy(entry.value, bytes, 8);
    return od_entry_signed(&entry);
}

/* What the entry will be, to check the values against. */
static int set_limits(struct od_entry *entry, const struct numbers *numbers)
{
    const uint32_t size = od_type_size(entry->type);

    entry->has_low = entry->has_high = numbers->limited;
    entry->low = limit_of(entry->type, numbers->bytes[LOWEST]);
    entry->high = limit_of(entry->type, numbers->bytes[HIGHEST]);
    if (numbers->limited && od_check_value(entry, numbers->bytes[LOWEST], size) != SDO_OK)
        return SCANOPEN_WRONG_PARAMETER; /* minimum above maximum */
    for (unsigned i = VALUE; i <= INITIAL; i++) {
        const sdo_abort_t code = od_check_value(entry, numbers->bytes[i], size);

        if (code != SDO_OK)
            return scan_error_of_value(code);
    }
    return SCANOPEN_OK;
}

static int init_number(struct od_entry *entry, const struct init *init)
{
    const uint32_t size = od_type_size(entry->type);
    struct od_entry plan = *entry;
    struct numbers numbers;
    int result;

    read_numbers(entry->type, init->data, &numbers);
    result = set_limits(&plan, &numbers);
    if (result != SCANOPEN_OK)
        return result;
    entry->has_low = plan.has_low;
    entry->has_high = plan.has_high;
    entry->low = plan.low;
    entry->high = plan.high;
    memcpy(entry->value, numbers.bytes[VALUE], size);
    memcpy(entry->initial, numbers.bytes[INITIAL], size);
    od_forget_default(entry);
    return SCANOPEN_OK;
}

static int init_text(struct od_entry *entry, const struct init *init)
{
    const RecOctString *text = &init->data->octstring;

    if (text->ulLength > text->ulSize || text->ulSize > UINT32_MAX ||
        (!text->pData && text->ulSize > 0))
        return SCANOPEN_WRONG_PARAMETER;
    if (od_refer(entry, text->pData, (uint32_t)text->ulLength, (uint32_t)text->ulSize, true) !=
        CO_OK)
        return SCANOPEN_OUT_OF_MEMORY;
    scan_end_text(entry);
    return SCANOPEN_OK;
}

static enum od_access access_of(unsigned flags)
{
    switch (flags & (READ_ACCESS | WRITE_ACCESS)) {
    case READ_ACCESS: return OD_RO;
    case WRITE_ACCESS: return OD_WO;
    case READ_ACCESS | WRITE_ACCESS: return OD_RW;
    default: return OD_NONE;
    }
}

static int set_name(struct od_entry *entry, const char *name)
{
    char *copy = name ? strdup(name) : NULL;

    if (name && !copy)
        return SCANOPEN_OUT_OF_MEMORY;
    free(entry->name);
    entry->name = copy;
    return SCANOPEN_OK;
}

static int init_entry(struct scan_node *node, struct od_entry *entry, const struct init *init)
{
    struct scan_entry *owner = entry->owner;
    const uint8_t before = entry->access;
    int result = set_name(entry, init->name);

    entry->access = (uint8_t)access_of(init->flags); /* decides what od_refer() keeps */
    if (result == SCANOPEN_OK)
        result = scan_is_text(entry->type) ? init_text(entry, init) : init_number(entry, init);
    if (result != SCANOPEN_OK) {
        entry->access = before;
        return result;
    }
    entry->mappable = (init->flags & (MAPPABLE | MULTI_MAP)) != 0;
    entry->map_max = init->flags & MULTI_MAP ? node->map_max : 1;
    entry->watched = init->handlers.handler || init->handlers.handler_ts;
    free(owner->domain);
    owner->domain = NULL;
    owner->initialized = true;
    owner->handler = init->handlers.handler;
    owner->handler_ts = init->handlers.handler_ts;
    return SCANOPEN_OK;
}

static int init_dictionary(struct scan_node *node, const struct init *init)
{
    struct od_entry *entry = init->sub < STRUCTURE
                                 ? od_find(&node->od, init->index, (uint8_t)init->sub)
                                 : NULL;

    if (!init->data || (init->flags & ~(unsigned)FLAGS) != 0)
        return SCANOPEN_WRONG_PARAMETER;
    if (node->active)
        return SCANOPEN_WRONG_NODESTATE;
    if (init->index < FIRST_OBJECT || !od_has_object(&node->od, init->index))
        return SCANOPEN_WRONG_INDEX;
    if (!entry || !entry->owner)
        return SCANOPEN_WRONG_SUBINDEX;
    return init_entry(node, entry, init);
}

static int init_call(HNODE handle, const struct init *init)
{
    struct scan_node *node;
    int result = scan_enter(handle, &node);
    co_us_t now;

    if (result != SCANOPEN_OK)
        return result;
    scan_lock(node, &now);
    result = init_dictionary(node, init);
    scan_unlock(node);
    scan_leave(node);
    return result;
}

int canOpenInitDictionary(HNODE HNode, unsigned short Index, unsigned short Subindex,
                          const char *EntryName, unsigned short Flags, pDictionaryData Data,
                          PFN_COS_DATA_HANDLER Handler)
{
    const struct init init = { .index = Index,
                               .sub = Subindex,
                               .name = EntryName,
                               .flags = Flags,
                               .data = Data,
                               .handlers = { .handler = Handler } };

    return init_call(HNode, &init);
}

int canOpenInitDictionaryTs(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            const char *EntryName, unsigned short Flags, pDictionaryData Data,
                            PFN_COS_DATA_HANDLER_TS Handler)
{
    const struct init init = { .index = Index,
                               .sub = Subindex,
                               .name = EntryName,
                               .flags = Flags,
                               .data = Data,
                               .handlers = { .handler_ts = Handler } };

    return init_call(HNode, &init);
}

int canOpenInitDictionaryTS(HNODE HNode, unsigned short Index, unsigned short Subindex,
                            const char *EntryName, unsigned short Flags, pDictionaryData Data,
                            PFN_COS_DATA_HANDLER_TS Handler)
{
    return canOpenInitDictionaryTs(HNode, Index, Subindex, EntryName, Flags, Data, Handler);
}

#include "od/od.h"

struct type {
    uint8_t size;
    bool is_signed;
    const char *name; /* NULL: CiA 301 knows no such type */
};

/* Asked with every access to an entry: no search. */
static const struct type types[] = {
    [OD_BOOLEAN] = { 1, false, "BOOLEAN" },
    [OD_INTEGER8] = { 1, true, "INTEGER8" },
    [OD_INTEGER16] = { 2, true, "INTEGER16" },
    [OD_INTEGER32] = { 4, true, "INTEGER32" },
    [OD_UNSIGNED8] = { 1, false, "UNSIGNED8" },
    [OD_UNSIGNED16] = { 2, false, "UNSIGNED16" },
    [OD_UNSIGNED32] = { 4, false, "UNSIGNED32" },
    [OD_REAL32] = { 4, false, "REAL32" },
    [OD_VISIBLE_STRING] = { 0, false, "VISIBLE_STRING" },
    [OD_OCTET_STRING] = { 0, false, "OCTET_STRING" },
    [OD_UNICODE_STRING] = { 0, false, "UNICODE_STRING" },
    [OD_TIME_OF_DAY] = { 6, false, "TIME_OF_DAY" },
    [OD_TIME_DIFFERENCE] = { 6, false, "TIME_DIFFERENCE" },
    [OD_DOMAIN] = { 0, false, "DOMAIN" },
    [OD_INTEGER24] = { 3, true, "INTEGER24" },
    [OD_REAL64] = { 8, false, "REAL64" },
    [OD_INTEGER40] = { 5, true, "INTEGER40" },
    [OD_INTEGER48] = { 6, true, "INTEGER48" },
    [OD_INTEGER56] = { 7, true, "INTEGER56" },
    [OD_INTEGER64] = { 8, true, "INTEGER64" },
    [OD_UNSIGNED24] = { 3, false, "UNSIGNED24" },
    [OD_UNSIGNED40] = { 5, false, "UNSIGNED40" },
    [OD_UNSIGNED48] = { 6, false, "UNSIGNED48" },
    [OD_UNSIGNED56] = { 7, false, "UNSIGNED56" },
    [OD_UNSIGNED64] = { 8, false, "UNSIGNED64" },
};

static const struct type *find_type(uint8_t type)
{
    static const struct type unknown = { 0 };

    return type < sizeof types / sizeof types[0] ? &types[type] : &unknown;
}

uint32_t od_type_size(uint8_t type)
{
    return find_type(type)->size;
}

bool od_type_known(uint8_t type)
{
    return find_type(type)->name != NULL;
}

bool od_type_signed(uint8_t type)
{
    return find_type(type)->is_signed;
}

const char *od_type_name(uint8_t type)
{
    return od_type_known(type) ? find_type(type)->name : "unknown type";
}

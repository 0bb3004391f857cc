/*
 * What ccfread shows of a file, as a table or as JSON.
 *
 *   in   the file, its entries up to the damage, what is left behind that
 *   out  stdout
 */
#ifndef TOOLS_CCFREAD_VIEW_H
#define TOOLS_CCFREAD_VIEW_H

#include "dcf/dcf.h"

#include <stdbool.h>
#include <stddef.h>

struct view_file {
    const char *name;
    const uint8_t *bytes;
    size_t size;
    uint32_t count; /* as the file has it; 0 where it is too short for one */
    bool is_first;
};

struct view_entry {
    const struct ccf_entry *entry;
    const struct dcf_entry *described; /* in the EDS; NULL: not there, or no EDS */
    size_t offset;
    bool extra;          /* behind the entries of the count */
    bool is_first;       /* of its file */
    const char *warning; /* NULL: none */
};

struct view_rest {
    const uint8_t *bytes; /* that are no entry */
    size_t offset, size;
};

/* Each returns false where it cannot write, or there is no memory. */
struct view {
    bool (*begin)(void);
    bool (*open)(const struct view_file *file, bool has_eds);
    bool (*show)(const struct view_entry *entry, bool has_eds);
    bool (*close)(const struct view_file *file, const struct view_rest *rest, const char *error);
    bool (*end)(void);
};

extern const struct view view_table, view_json;

/* The type in the EDS, if the value fits it; else 0. */
uint8_t view_type(const struct view_entry *entry);

#endif

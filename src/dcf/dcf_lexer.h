/*
 * The lines of an EDS or DCF file: sections and their keys, with line numbers.
 *
 *   in   the bytes of the file
 *   out  sections, known by their names, sorted; keys of each section as in the file or, where they
 *        are many, sorted: numbers last, the shorter names first, then by the alphabet
 *
 * Sections and keys that come twice are merged, the last one wins. Names are compared without
 * regard to case. Slices point into the file's text, which has to stay.
 */
#ifndef CO_DCF_DCF_LEXER_H
#define CO_DCF_DCF_LEXER_H

#include "base/error.h"
#include "base/report.h"
#include "dcf/dcf_slice.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What no description of a device has, and would take much memory. */
#define DCF_TEXT_MAX     (16u << 20) /* bytes */
#define DCF_SECTIONS_MAX (1u << 19)
#define DCF_KEYS_MAX     (1u << 21)

enum dcf_section_kind {
    DCF_SECTION_FILE_INFO,
    DCF_SECTION_DEVICE_INFO,
    DCF_SECTION_DUMMY_USAGE,
    DCF_SECTION_COMMISSIONING,
    DCF_SECTION_MANDATORY,
    DCF_SECTION_OPTIONAL,
    DCF_SECTION_MANUFACTURER,
    DCF_SECTION_SUPPORTED_MODULES,
    DCF_SECTION_CONNECTED_MODULES,
    DCF_SECTION_COMMENTS,
    DCF_SECTION_DYNAMIC_CHANNELS,
    DCF_SECTION_TOOLS,
    DCF_SECTION_OBJECT, /* [1018] */
    DCF_SECTION_SUB,    /* [1018sub1] */
    DCF_SECTION_NAME,   /* [1016Name] and the following: of compact objects */
    DCF_SECTION_VALUE,
    DCF_SECTION_DENOTATION,
    DCF_SECTION_LINKS,       /* [1018ObjectLinks] */
    DCF_SECTION_MODULE_INFO, /* [M1ModuleInfo] and the following: of modules, by their number */
    DCF_SECTION_MODULE_COMMENTS,
    DCF_SECTION_FIXED_LIST,     /* [M1FixedObjects] */
    DCF_SECTION_EXTENSION_LIST, /* [M1SubExtends] */
    DCF_SECTION_FIXED,          /* [M1Fixed2000] */
    DCF_SECTION_FIXED_SUB,      /* [M1Fixed2000sub1] */
    DCF_SECTION_EXTENSION,      /* [M1SubExt6000] */
    DCF_SECTION_TOOL,           /* [Tool1] */
    DCF_SECTION_UNKNOWN
};

struct dcf_key {
    struct dcf_slice name;
    struct dcf_slice value;
    uint32_t tag; /* of its name */
    unsigned line;
    bool used; /* somebody asked for it */
};

struct dcf_section {
    struct dcf_slice name; /* as in the file, without the brackets */
    unsigned line;
    enum dcf_section_kind kind;
    uint16_t part;  /* number of the module or tool; 0: the device itself */
    uint16_t index; /* of object sections */
    uint8_t sub;
    bool listed;    /* for who reads lists: its index was in one */
    uint64_t order; /* equal for sections that are the same one */
    uint32_t tags;  /* of all keys, a bit each: dcf_tag_bit() */
    struct dcf_key *keys;
    size_t count;
};

struct dcf_text {
    struct dcf_section *sections;
    size_t section_count, section_room;
    struct dcf_key *keys;
    size_t key_count, key_room;
};

/* CO_ERR_FORMAT: this is no text of sections, or there is too much of it; CO_ERR_MEMORY */
enum co_err dcf_lex(const char *text, size_t size, struct co_report *report,
                    struct dcf_text *ret_text);
void dcf_text_done(struct dcf_text *self);

/* The section of an information kind, or the first tool, or NULL. */
struct dcf_section *dcf_text_find(const struct dcf_text *self, enum dcf_section_kind kind);

/* Different for most different names; of a name that the compiler knows it is a constant. */
static inline uint32_t dcf_name_tag(struct dcf_slice name)
{
    return (uint32_t)name.size << 16 | (uint32_t)(name.text[0] & 0xDF) << 8 |
           (uint32_t)(name.text[name.size - 1] & 0xDF);
}

static inline uint32_t dcf_tag_bit(uint32_t tag)
{
    return (uint32_t)1 << (tag * 2654435761u >> 27);
}

/* For dcf_section_find() */
const struct dcf_key *dcf_section_look(struct dcf_section *self, struct dcf_slice name,
                                       uint32_t tag);

/* The key, marked as used, or NULL where it is missing or empty. */
static inline const struct dcf_key *dcf_section_find(struct dcf_section *self, const char *name)
{
    struct dcf_slice wanted = dcf_slice_of(name);
    uint32_t tag = dcf_name_tag(wanted);

    return self->tags & dcf_tag_bit(tag) ? dcf_section_look(self, wanted, tag) : NULL;
}

/* For dcf_lex(): what the name of the section tells. */
void dcf_section_know(struct dcf_section *section, struct co_report *report);

/* For dcf_lex(): knows the sections, sorts and merges sections and keys. */
enum co_err dcf_text_sort(struct dcf_text *self, struct co_report *report);

#endif

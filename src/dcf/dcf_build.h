/*
 * Building the description: what the parts of the reader share. Only for src/dcf/.
 */
#ifndef CO_DCF_DCF_BUILD_H
#define CO_DCF_DCF_BUILD_H

#include "dcf/dcf.h"
#include "dcf/dcf_convert.h"
#include "dcf/dcf_lexer.h"
#include "dcf/dcf_rules.h"

#define DCF_ENTRIES_MAX 131072u /* what two lines can ask for must not take all memory */

#define OBJECT_DOMAIN    2u
#define OBJECT_DEFTYPE   5u
#define OBJECT_DEFSTRUCT 6u
#define OBJECT_VAR       7u
#define OBJECT_ARRAY     8u
#define OBJECT_RECORD    9u

#define EDS_VERSION_3 30u /* where the file tells none */
#define EDS_VERSION_4 40u

struct dcf_builder {
    struct dcf *dcf;
    struct dcf_text text;
    struct co_report *report;
    bool no_memory;      /* once set, the rest is only passed through */
    uint8_t compact_pdo; /* [DeviceInfo] CompactPDO */
    uint8_t eds_version; /* 40: 4.0 */
    unsigned no_name;    /* sections without ParameterName, and the first one's line */
    unsigned no_name_line;
};

/* dcf_info.c: [FileInfo], [DeviceInfo], [DummyUsage] */
void dcf_build_info(struct dcf_builder *self);

/* dcf_commissioning.c */
void dcf_build_commissioning(struct dcf_builder *self);

/* dcf_numbered.c: sections with a number of entries and the keywords 1, 2, 3, ... */
struct dcf_numbered {
    const char *count_key;       /* "SupportedObjects" */
    const char *other_count_key; /* as some files spell it, or NULL */
    const char *prefix;          /* "Line" in front of the numbers, or "" */
    bool may_be_empty;
    enum dcf_rule rule; /* for a count that is wrong */
    /* Gets each entry, or NULL. */
    void (*take)(void *context, const struct dcf_section *section, const struct dcf_key *key,
                 unsigned number);
};

/* Uses these keywords, tells a wrong count or a gap. */
void dcf_read_numbered(struct dcf_builder *self, struct dcf_section *section,
                       const struct dcf_numbered *form, void *context);
/* False: the key is no index (told). */
bool dcf_key_index(struct dcf_builder *self, const struct dcf_section *section,
                   const struct dcf_key *key, uint16_t *ret_index);

/* dcf_notes.c: comments, tools, dynamic channels, object links */
void dcf_check_notes(struct dcf_builder *self);
void dcf_check_comments(struct dcf_builder *self, struct dcf_section *section);

/* dcf_lists.c: object lists against sections; NrOfRXPDO and NrOfTXPDO */
void dcf_check_lists(struct dcf_builder *self);

/* dcf_modules.c: checks all modules, adds what those in use add to the device */
void dcf_build_modules(struct dcf_builder *self);

/* dcf_objects.c */
void dcf_build_objects(struct dcf_builder *self);
void dcf_tell_no_names(struct dcf_builder *self);
/* The object at this place of the sections; the place of the next one. */
size_t dcf_build_group(struct dcf_builder *self, size_t place);
/* A new entry at the end, or NULL: too many or no memory. */
struct dcf_entry *dcf_build_entry(struct dcf_builder *self, uint16_t index, uint8_t sub);
void dcf_sort_entries(struct dcf_builder *self);

/* dcf_entry.c: one section's keys into an entry, whose index, sub-index and object type are set */
void dcf_fill_entry(struct dcf_builder *self, struct dcf_section *section, struct dcf_entry *entry);

/* The ParameterName of a section, or NULL for who only wants to know that it is there. */
void dcf_read_name(struct dcf_builder *self, struct dcf_section *section, char **name);
/* The ObjectType of a section, OBJECT_VAR where there is none. */
uint8_t dcf_read_object_type(struct dcf_builder *self, struct dcf_section *section);

const char *dcf_access_text(uint8_t access);

/* dcf_compact.c */
void dcf_build_compact(struct dcf_builder *self, struct dcf_section *section, unsigned count);
/* A sub-index as the pattern describes it, with its number behind the name. */
void dcf_build_element(struct dcf_builder *self, const struct dcf_entry *pattern, unsigned sub);
void dcf_apply_compact_lists(struct dcf_builder *self);

/* dcf_compact_pdo.c */
void dcf_build_compact_pdos(struct dcf_builder *self);

/* dcf_check.c: limits against values, when all sections have been read */
void dcf_check_values(struct dcf_builder *self);
void dcf_check_values_from(struct dcf_builder *self, size_t first);

/* dcf_keys.c: keys of a section as numbers and texts, with their messages */

/* The number of a key; 'missing' where there is no key, or no number up to 'most' (warning). */
uint32_t dcf_number_of_key(struct dcf_builder *self, const struct dcf_section *section,
                           const struct dcf_key *key, uint32_t most, uint32_t missing);
/* Replaces *text by a copy of the key's value, where there is a key. */
void dcf_text_of_key(struct dcf_builder *self, const struct dcf_key *key, char **text);

/* The same by name. */
static inline uint32_t dcf_key_number(struct dcf_builder *self, struct dcf_section *section,
                                      const char *name, uint32_t most, uint32_t missing)
{
    return dcf_number_of_key(self, section, dcf_section_find(section, name), most, missing);
}

static inline bool dcf_key_flag(struct dcf_builder *self, struct dcf_section *section,
                                const char *name)
{
    return dcf_key_number(self, section, name, 1, 0) != 0;
}

static inline void dcf_key_text(struct dcf_builder *self, struct dcf_section *section,
                                const char *name, char **text)
{
    dcf_text_of_key(self, dcf_section_find(section, name), text);
}

/* 0: not given */
unsigned dcf_key_line(struct dcf_section *section, const char *name);

/* The key as a value of an entry: one that is not valid is an error if 'strict', else a warning. */
void dcf_key_value(struct dcf_builder *self, const struct dcf_section *section,
                   const struct dcf_key *key, uint8_t type, bool strict, struct dcf_value *value);
/* What was tolerated in the key's value: DCF_QUIRK_... */
void dcf_tell_quirks(const struct dcf_builder *self, const struct dcf_section *section,
                     const struct dcf_key *key, unsigned quirks);
void dcf_tell_unused(struct dcf_builder *self, const struct dcf_section *section);
/* The name of the file, or an empty one. */
struct dcf_slice dcf_report_file(const struct dcf_builder *self);
/* Keys that nobody reads here. */
void dcf_use_keys(struct dcf_section *section, const char *const *names, size_t count);
/* Tells which of the keys are missing (or empty), in one message. */
void dcf_expect_keys(struct dcf_builder *self, struct dcf_section *section,
                     const char *const *names, size_t count, bool may_be_empty);

/* A number or text that is not in the file. */
void dcf_set_number(struct dcf_builder *self, struct dcf_value *value, uint32_t size,
                    uint32_t number);
void dcf_set_text(struct dcf_builder *self, char **text, const char *value);

/* dcf.c */
/* The first entry that is not before index:sub; self->count: none. */
size_t dcf_place(const struct dcf *self, uint16_t index, uint8_t sub);
/* The entries of one object, or NULL and a count of 0. */
const struct dcf_entry *dcf_object(const struct dcf *self, uint16_t index, size_t *ret_count);
bool dcf_has_object(const struct dcf *self, uint16_t index);

/* dcf_check.c */

/*
 * True for what a configuration writes: not ro or const, not refused by ObjFlags, not an object
 * that configurations leave alone (1010h, 1018h, ...).
 */
bool dcf_entry_downloads(const struct dcf_entry *entry);
/* A file beside the DCF or below: relative, and without ".." in it. */
bool dcf_stays_below(const char *name);
/* A number as people write it; "(none)". */
struct dcf_shown dcf_number_text(const struct dcf_value *value, uint8_t type, uint8_t node_id);
/* An integer value, sign-extended, with the node-ID added. */
uint64_t dcf_value_number(const struct dcf_value *value, uint8_t type, uint8_t node_id);
/* True for a value that its entry's limits refuse. */
bool dcf_value_outside(const struct dcf_entry *entry, const struct dcf_value *value,
                       uint8_t node_id);
/* False: a formula that leaves its type with this node-ID. */
bool dcf_formula_fits(const struct dcf_value *value, uint8_t node_id);

#endif

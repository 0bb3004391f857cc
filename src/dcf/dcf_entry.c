/* One object or sub-index section as an entry. */
#include "dcf/dcf_build.h"

#include "base/bytes.h"

#include <string.h>

/* Data types of the manufacturer and of device profiles. */
#define FIRST_OWN_TYPE 0x40u
#define LAST_OWN_TYPE  0x25Fu

#define FLAGS_KNOWN 3u

static const struct {
    const char *name;
    uint8_t object_type;
} object_types[] = {
    { "DOMAIN", OBJECT_DOMAIN }, { "DEFTYPE", OBJECT_DEFTYPE }, { "DEFSTRUCT", OBJECT_DEFSTRUCT },
    { "VAR", OBJECT_VAR },       { "ARRAY", OBJECT_ARRAY },     { "RECORD", OBJECT_RECORD },
};

#define OBJECT_TYPE_COUNT (sizeof object_types / sizeof object_types[0])

static bool begins_word(struct dcf_slice text)
{
    return text.text[0] >= 'A';
}

uint8_t dcf_read_object_type(struct dcf_builder *self, struct dcf_section *section)
{
    const struct dcf_key *key = dcf_section_find(section, "ObjectType");

    for (size_t i = 0; key && begins_word(key->value) && i < OBJECT_TYPE_COUNT; i++) {
        if (!dcf_slice_is(key->value, object_types[i].name))
            continue;
        dcf_tell(self->report, DCF_RULE_OBJECT_TYPE, key->line,
                 "[%s] ObjectType: a number expected, there is \"%s\": taken as %u",
                 dcf_show(section->name).text, dcf_show(key->value).text,
                 object_types[i].object_type);
        return object_types[i].object_type;
    }
    return (uint8_t)dcf_number_of_key(self, section, key, UINT8_MAX, OBJECT_VAR);
}

static const struct {
    const char *text;
    enum od_access access;
} accesses[] = {
    { "ro", OD_RO },   { "wo", OD_WO },   { "rw", OD_RW },
    { "rwr", OD_RWR }, { "rww", OD_RWW }, { "const", OD_CONST },
};

const char *dcf_access_text(uint8_t access)
{
    for (size_t i = 0; i < sizeof accesses / sizeof accesses[0]; i++) {
        if (accesses[i].access == access)
            return accesses[i].text;
    }
    return "none";
}

/* Other words for them that leave no doubt. */
static const struct {
    const char *text;
    enum od_access access;
} other_accesses[] = {
    { "r", OD_RO },         { "w", OD_WO },          { "r/w", OD_RW },
    { "w/r", OD_RW },       { "wr", OD_RW },         { "readonly", OD_RO },
    { "read only", OD_RO }, { "read-only", OD_RO },  { "constant", OD_CONST },
    { "writeonly", OD_WO }, { "write only", OD_WO }, { "write-only", OD_WO },
    { "readwrite", OD_RW }, { "read/write", OD_RW },
};

static enum od_access parse_other_access(struct dcf_slice text)
{
    for (size_t i = 0; i < sizeof other_accesses / sizeof other_accesses[0]; i++) {
        if (dcf_slice_is(text, other_accesses[i].text))
            return other_accesses[i].access;
    }
    return OD_RO;
}

/* The letters at the beginning: "rw # comment" is "rw". */
static struct dcf_slice first_word(struct dcf_slice text)
{
    size_t size = 0;

    while (size < text.size && ((text.text[size] >= 'a' && text.text[size] <= 'z') ||
                                (text.text[size] >= 'A' && text.text[size] <= 'Z')))
        size++;
    return dcf_slice_cut(text, size);
}

static enum od_access parse_access(struct dcf_builder *self, const struct dcf_section *section,
                                   const struct dcf_key *key)
{
    struct dcf_slice word = first_word(key->value);
    enum od_access access;

    for (size_t i = 0; i < sizeof accesses / sizeof accesses[0]; i++) {
        if (!dcf_slice_is(word, accesses[i].text))
            continue;
        if (word.size != key->value.size)
            dcf_tell(self->report, DCF_RULE_ACCESS_TYPE, key->line,
                     "[%s] AccessType: %s alone expected, there is \"%s\"",
                     dcf_show(section->name).text, accesses[i].text, dcf_show(key->value).text);
        return accesses[i].access;
    }
    access = parse_other_access(key->value);
    dcf_tell(self->report, DCF_RULE_ACCESS_TYPE, key->line,
             "[%s] AccessType: ro, wo, rw, rwr, rww or const expected, there is \"%s\": "
             "taken as %s",
             dcf_show(section->name).text, dcf_show(key->value).text,
             dcf_access_text((uint8_t)access));
    return access;
}

static void fill_access(struct dcf_builder *self, struct dcf_section *section,
                        struct dcf_entry *entry)
{
    const struct dcf_key *key = dcf_section_find(section, "AccessType");

    entry->access = entry->object_type == OBJECT_DOMAIN ? OD_RW : OD_RO;
    if (key)
        entry->access = (uint8_t)parse_access(self, section, key);
    else if (entry->object_type != OBJECT_DOMAIN)
        dcf_tell(self->report, DCF_RULE_ACCESS_MISSING, section->line,
                 "[%s]: AccessType expected, it is missing: taken as ro",
                 dcf_show(section->name).text);
}

/* The unsigned type of so many bits, or 0. */
static uint8_t type_of_bits(uint64_t bits)
{
    static const uint8_t types[] = { OD_BOOLEAN,    OD_UNSIGNED8,  OD_UNSIGNED16,
                                     OD_UNSIGNED24, OD_UNSIGNED32, OD_UNSIGNED40,
                                     OD_UNSIGNED48, OD_UNSIGNED56, OD_UNSIGNED64 };

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        if (bits == (types[i] == OD_BOOLEAN ? 1 : 8 * od_type_size(types[i])))
            return types[i];
    }
    return 0;
}

/*
 * A data type of the device or its profile has an object (DEFTYPE), whose value is its size in
 * bits; sections are sorted, so it has been read before. 0: there is none.
 */
static uint8_t find_defined_type(const struct dcf_builder *self, uint64_t type)
{
    const struct dcf_entry *entry = NULL;

    if (type >= FIRST_OWN_TYPE && type <= LAST_OWN_TYPE)
        entry = dcf_find(self->dcf, (uint16_t)type, 0);
    if (!entry || entry->object_type != OBJECT_DEFTYPE || !entry->initial.given ||
        entry->initial.size > 8)
        return 0;
    return type_of_bits(get_le(entry->initial.bytes, entry->initial.size));
}

static uint8_t find_type(struct dcf_slice name)
{
    for (unsigned type = 1; type <= UINT8_MAX; type++) {
        if (od_type_known((uint8_t)type) && dcf_slice_is(name, od_type_name((uint8_t)type)))
            return (uint8_t)type;
    }
    return 0;
}

/* 0: none of CiA 301 (not told) */
static uint8_t parse_type(struct dcf_builder *self, const struct dcf_section *section,
                          const struct dcf_key *key)
{
    struct dcf_number number;
    uint8_t type = begins_word(key->value) ? find_type(key->value) : 0;

    if (type != 0) {
        dcf_tell(self->report, DCF_RULE_DATA_TYPE, key->line,
                 "[%s] DataType: a number expected, there is \"%s\": taken as 0x%04X",
                 dcf_show(section->name).text, dcf_show(key->value).text, type);
        return type;
    }
    if (!dcf_number_parse(key->value, &number) || number.has_node_id || number.negative)
        return 0;
    type = find_defined_type(self, number.magnitude);
    if (number.magnitude <= UINT8_MAX && od_type_known((uint8_t)number.magnitude))
        type = (uint8_t)number.magnitude;
    if (type != 0)
        dcf_tell_quirks(self, section, key, number.quirks);
    return type;
}

static void fill_type(struct dcf_builder *self, struct dcf_section *section,
                      struct dcf_entry *entry)
{
    const struct dcf_key *key = dcf_section_find(section, "DataType");

    if (key)
        entry->type = parse_type(self, section, key);
    else if (entry->object_type == OBJECT_DOMAIN)
        entry->type = OD_DOMAIN;
    if (entry->type != 0)
        return;
    if (entry->sub == 0 &&
        (section->kind == DCF_SECTION_SUB || section->kind == DCF_SECTION_FIXED_SUB))
        entry->type = OD_UNSIGNED8;
    dcf_tell(self->report, DCF_RULE_DATA_TYPE, key ? key->line : section->line,
             "[%s] DataType: a data type of CiA 301 expected, %s%s: %s",
             dcf_show(section->name).text, key ? "there is " : "it is missing",
             key ? dcf_show(key->value).text : "",
             entry->type ? "taken as UNSIGNED8" : "the entry cannot be used");
}

void dcf_read_name(struct dcf_builder *self, struct dcf_section *section, char **name)
{
    const struct dcf_key *key = dcf_section_find(section, "ParameterName");

    if (!key && self->no_name++ == 0)
        self->no_name_line = section->line;
    if (name)
        dcf_text_of_key(self, key, name);
}

static void fill_flags(struct dcf_builder *self, struct dcf_section *section,
                       struct dcf_entry *entry)
{
    entry->mappable = dcf_key_flag(self, section, "PDOMapping");
    entry->flags = dcf_key_number(self, section, "ObjFlags", UINT32_MAX, 0);
    if (entry->flags & ~FLAGS_KNOWN)
        dcf_tell(self->report, DCF_RULE_OBJECT_FLAGS, dcf_section_find(section, "ObjFlags")->line,
                 "[%s] ObjFlags: 0..3 expected, there is %lX: bits 2 to 31 are ignored",
                 dcf_show(section->name).text, (unsigned long)entry->flags);
}

static void fill_value(struct dcf_builder *self, const struct dcf_section *section,
                       const struct dcf_key *key, const struct dcf_entry *entry,
                       struct dcf_value *value)
{
    bool strict = value == &entry->parameter && dcf_entry_downloads(entry);

    if (key && (entry->type != 0 || strict)) /* what has no type was told */
        dcf_key_value(self, section, key, entry->type, strict, value);
}

static bool has_limits(uint8_t type)
{
    return od_type_size(type) != 0 && type != OD_TIME_OF_DAY && type != OD_TIME_DIFFERENCE;
}

/* Where one limit is nonsense the other one means nothing. */
static void fill_limits(struct dcf_builder *self, struct dcf_section *section,
                        struct dcf_entry *entry)
{
    const struct dcf_key *low = dcf_section_find(section, "LowLimit");
    const struct dcf_key *high = dcf_section_find(section, "HighLimit");

    if (!has_limits(entry->type))
        return;
    fill_value(self, section, low, entry, &entry->low);
    fill_value(self, section, high, entry, &entry->high);
    if ((low && !entry->low.given) || (high && !entry->high.given)) {
        entry->low.given = false;
        entry->high.given = false;
    }
}

/* A file for the value: of a DOMAIN that can be transferred in that direction. */
static void fill_file(struct dcf_builder *self, struct dcf_section *section, const char *name,
                      const struct dcf_entry *entry, char **file)
{
    const struct dcf_key *key = dcf_section_find(section, name);
    bool is_download = file == &entry->download_file;
    bool is_refused = is_download ? entry->access == OD_RO || entry->access == OD_CONST
                                  : entry->access == OD_WO;

    if (!key)
        return;
    if (entry->type != OD_DOMAIN) {
        dcf_tell(self->report, DCF_RULE_DOWNLOAD_TYPE, key->line,
                 "[%s] %s: expected for a DOMAIN only, this is %s: ignored",
                 dcf_show(section->name).text, name, od_type_name(entry->type));
        return;
    }
    if (is_refused)
        dcf_tell(self->report, DCF_RULE_FILE_ACCESS, key->line,
                 "[%s] %s: expected for what can be %s, AccessType is %s",
                 dcf_show(section->name).text, name, is_download ? "written" : "read",
                 dcf_access_text(entry->access));
    dcf_text_of_key(self, key, file);
    if (!is_download && *file && !dcf_stays_below(*file))
        dcf_tell(self->report, DCF_RULE_UPLOAD_FOLDER, key->line,
                 "[%s] UploadFile: a name below the folder of this file expected, there is \"%s\"",
                 dcf_show(section->name).text, dcf_show(key->value).text);
}

void dcf_fill_entry(struct dcf_builder *self, struct dcf_section *section, struct dcf_entry *entry)
{
    entry->line = section->line;
    dcf_read_name(self, section, &entry->name);
    fill_type(self, section, entry);
    fill_access(self, section, entry);
    fill_flags(self, section, entry);
    fill_limits(self, section, entry);
    dcf_key_text(self, section, "Denotation", &entry->denotation);
    fill_value(self, section, dcf_section_find(section, "DefaultValue"), entry, &entry->initial);
    fill_value(self, section, dcf_section_find(section, "ParameterValue"), entry,
               &entry->parameter);
    fill_file(self, section, "DownloadFile", entry, &entry->download_file);
    fill_file(self, section, "UploadFile", entry, &entry->upload_file);
    dcf_section_find(section, "ParamRefd");
}

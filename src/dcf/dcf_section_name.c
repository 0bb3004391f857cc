/* Knows the names of sections. */
#include "dcf/dcf_lexer.h"

#include "dcf/dcf_rules.h"

#include <stdio.h>

#define INDEX_DIGITS 4u

static const struct {
    const char *name;
    enum dcf_section_kind kind;
} known[] = {
    { "FileInfo", DCF_SECTION_FILE_INFO },
    { "DeviceInfo", DCF_SECTION_DEVICE_INFO },
    { "DummyUsage", DCF_SECTION_DUMMY_USAGE },
    { "DeviceComissioning", DCF_SECTION_COMMISSIONING },
    { "DeviceCommissioning", DCF_SECTION_COMMISSIONING },
    { "MandatoryObjects", DCF_SECTION_MANDATORY },
    { "OptionalObjects", DCF_SECTION_OPTIONAL },
    { "ManufacturerObjects", DCF_SECTION_MANUFACTURER },
    { "SupportedModules", DCF_SECTION_SUPPORTED_MODULES },
    { "ConnectedModules", DCF_SECTION_CONNECTED_MODULES },
    { "Comments", DCF_SECTION_COMMENTS },
    { "DynamicChannels", DCF_SECTION_DYNAMIC_CHANNELS },
    { "Tools", DCF_SECTION_TOOLS },
};

static const struct {
    const char *suffix;
    enum dcf_section_kind kind;
} object_parts[] = {
    { "", DCF_SECTION_OBJECT },           { "Name", DCF_SECTION_NAME },
    { "Value", DCF_SECTION_VALUE },       { "Denotation", DCF_SECTION_DENOTATION },
    { "ObjectLinks", DCF_SECTION_LINKS },
};

static const struct {
    const char *name; /* behind "M12" */
    enum dcf_section_kind kind;
} module_parts[] = {
    { "ModuleInfo", DCF_SECTION_MODULE_INFO },
    { "Comments", DCF_SECTION_MODULE_COMMENTS },
    { "FixedObjects", DCF_SECTION_FIXED_LIST },
    { "SubExtends", DCF_SECTION_EXTENSION_LIST },
};

/* "sub1F", also "sub01" and "sub 1". */
static bool is_sub(struct dcf_slice rest, struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice digits;
    char module[16] = "";
    unsigned sub;
    bool is_exact;

    if (!dcf_slice_begins(rest, "sub"))
        return false;
    digits = dcf_slice_trim(dcf_slice_skip(rest, 3));
    if (!dcf_slice_hex(digits, INDEX_DIGITS, &sub) || sub > 0xFF)
        return false;
    if (section->part > 0)
        snprintf(module, sizeof module, "M%uFixed", section->part);
    is_exact = section->part > 0 ? rest.size == 3 + digits.size
                                 : section->name.size == INDEX_DIGITS + 3 + digits.size;
    if (!is_exact || (digits.size > 1 && digits.text[0] == '0'))
        dcf_tell(report, DCF_RULE_SECTION_NAME, section->line,
                 "[%s%04Xsub%X] expected, there is [%s]", module, section->index, sub,
                 dcf_show(section->name).text);
    section->sub = (uint8_t)sub;
    return true;
}

static bool take_index(struct dcf_slice *name, struct dcf_section *section)
{
    unsigned index;

    if (name->size < INDEX_DIGITS ||
        !dcf_slice_hex(dcf_slice_cut(*name, INDEX_DIGITS), INDEX_DIGITS, &index))
        return false;
    section->index = (uint16_t)index;
    *name = dcf_slice_trim(dcf_slice_skip(*name, INDEX_DIGITS));
    return true;
}

/* A section whose name begins with an index. */
static bool is_object(struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice name = section->name;

    if (dcf_slice_begins(name, "0x"))
        name = dcf_slice_skip(name, 2);
    if (!take_index(&name, section))
        return false;
    for (size_t i = 0; i < sizeof object_parts / sizeof object_parts[0]; i++) {
        if (!dcf_slice_is(name, object_parts[i].suffix))
            continue;
        section->kind = object_parts[i].kind;
        if (section->name.size != INDEX_DIGITS + name.size)
            dcf_tell(report, DCF_RULE_SECTION_NAME, section->line,
                     "[%04X%s] expected, there is [%s]", section->index, object_parts[i].suffix,
                     dcf_show(section->name).text);
        return true;
    }
    section->kind = DCF_SECTION_SUB;
    return is_sub(name, report, section);
}

static bool is_known(struct dcf_section *section)
{
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        if (dcf_slice_is(section->name, known[i].name)) {
            section->kind = known[i].kind;
            return true;
        }
    }
    return false;
}

/* Takes a letter or word and the number behind it off. */
static bool take_part(struct dcf_slice *name, const char *word, struct co_report *report,
                      struct dcf_section *section)
{
    size_t start = dcf_slice_of(word).size, end = start;
    unsigned part;

    if (!dcf_slice_begins(*name, word))
        return false;
    while (end < name->size && name->text[end] >= '0' && name->text[end] <= '9')
        end++;
    if (!dcf_slice_decimal(dcf_slice_skip(dcf_slice_cut(*name, end), start), UINT16_MAX, &part) ||
        part == 0)
        return false;
    if (name->text[start] == '0')
        dcf_tell(report, DCF_RULE_SECTION_NAME, section->line, "[%s%u...] expected, there is [%s]",
                 word, part, dcf_show(section->name).text);
    section->part = (uint16_t)part;
    *name = dcf_slice_skip(*name, end);
    return true;
}

/* "M1ModuleInfo", "M12Fixed6000sub1", "M2SubExt6000" */
static bool is_module(struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice name = section->name;

    if (!take_part(&name, "M", report, section))
        return false;
    for (size_t i = 0; i < sizeof module_parts / sizeof module_parts[0]; i++) {
        if (dcf_slice_is(name, module_parts[i].name)) {
            section->kind = module_parts[i].kind;
            return true;
        }
    }
    section->kind = dcf_slice_begins(name, "Fixed") ? DCF_SECTION_FIXED : DCF_SECTION_EXTENSION;
    if (section->kind == DCF_SECTION_EXTENSION && !dcf_slice_begins(name, "SubExt"))
        return false;
    name = dcf_slice_skip(name, section->kind == DCF_SECTION_FIXED ? 5 : 6);
    if (!take_index(&name, section))
        return false;
    if (name.size == 0)
        return true;
    if (section->kind == DCF_SECTION_EXTENSION)
        return false;
    section->kind = DCF_SECTION_FIXED_SUB;
    return is_sub(name, report, section);
}

static bool is_tool(struct co_report *report, struct dcf_section *section)
{
    struct dcf_slice name = section->name;

    section->kind = DCF_SECTION_TOOL;
    return take_part(&name, "Tool", report, section) && name.size == 0;
}

void dcf_section_know(struct dcf_section *section, struct co_report *report)
{
    if (is_object(report, section) || is_module(report, section) || is_tool(report, section))
        return;
    if (!is_known(section)) {
        dcf_tell(report, DCF_RULE_UNKNOWN_SECTION, section->line,
                 "a section of CiA 306 expected, there is [%s]: ignored",
                 dcf_show(section->name).text);
        section->kind = DCF_SECTION_UNKNOWN;
        return;
    }
    if (dcf_slice_is(section->name, "DeviceCommissioning"))
        dcf_tell(report, DCF_RULE_COMMISSIONING_NAME, section->line,
                 "[DeviceComissioning] expected (so the standard spells it), there is [%s]",
                 dcf_show(section->name).text);
}

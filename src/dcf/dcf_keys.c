#include "dcf/dcf_build.h"

#include "base/bytes.h"
#include "dcf/dcf_utf8.h"

#include <stdio.h>
#include <string.h>

static const struct {
    unsigned quirk;
    enum dcf_rule rule;
    const char *expected;
    const char *done;
} quirk_texts[] = {
    { DCF_QUIRK_COMMENT, DCF_RULE_VALUE_COMMENT, "a number alone", "what follows it is ignored" },
    { DCF_QUIRK_LEADING_ZERO, DCF_RULE_LEADING_ZERO, "no leading zero",
      "read as a decimal number" },
    { DCF_QUIRK_SUFFIX, DCF_RULE_NUMBER_SUFFIX, "a number without suffix",
      "the suffix is ignored" },
    { DCF_QUIRK_FORM, DCF_RULE_NUMBER_FORM, "a number like 26 or 0x1A", NULL },
    { DCF_QUIRK_WIDE, DCF_RULE_NUMBER_FORM, "not more digits than its type has",
      "those before are ignored" },
    { DCF_QUIRK_TEXT, DCF_RULE_HEX_BYTES, "hexadecimal digits", "taken as text" },
    { DCF_QUIRK_QUOTES, DCF_RULE_QUOTES, "text without quotes", "the quotes count as characters" },
    { DCF_QUIRK_DOMAIN, DCF_RULE_DOMAIN_VALUE, "a DownloadFile as value of a DOMAIN",
      "taken as bytes" },
};

static struct dcf_shown read_as(struct dcf_slice text)
{
    struct dcf_number number = { .magnitude = 0 };
    struct dcf_shown shown;

    dcf_number_parse_flag(text, &number);
    snprintf(shown.text, sizeof shown.text, "read as %.40s", dcf_number_show(&number).text);
    return shown;
}

void dcf_tell_quirks(const struct dcf_builder *self, const struct dcf_section *section,
                     const struct dcf_key *key, unsigned quirks)
{
    for (size_t i = 0; quirks && i < sizeof quirk_texts / sizeof quirk_texts[0]; i++) {
        if (quirks & quirk_texts[i].quirk)
            dcf_tell(self->report, quirk_texts[i].rule, key->line,
                     "[%s] %s: %s expected, there is "
                     "\"%s\": %s",
                     dcf_show(section->name).text, dcf_show(key->name).text,
                     quirk_texts[i].expected, dcf_show(key->value).text,
                     quirk_texts[i].done ? quirk_texts[i].done : read_as(key->value).text);
    }
}

uint32_t dcf_number_of_key(struct dcf_builder *self, const struct dcf_section *section,
                           const struct dcf_key *key, uint32_t most, uint32_t missing)
{
    struct dcf_number number;

    if (!key)
        return missing;
    if (!(most == 1 ? dcf_number_parse_flag(key->value, &number)
                    : dcf_number_parse(key->value, &number)) ||
        number.has_node_id || number.negative || number.too_large || number.magnitude > most) {
        dcf_tell(self->report, DCF_RULE_KEY_NUMBER, key->line,
                 "[%s] %s: a number of 0..%lu expected, there is \"%s\": ignored",
                 dcf_show(section->name).text, dcf_show(key->name).text, (unsigned long)most,
                 dcf_show(key->value).text);
        return missing;
    }
    dcf_tell_quirks(self, section, key, number.quirks);
    return (uint32_t)number.magnitude;
}

unsigned dcf_key_line(struct dcf_section *section, const char *name)
{
    const struct dcf_key *key = dcf_section_find(section, name);

    return key ? key->line : 0;
}

void dcf_use_keys(struct dcf_section *section, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        dcf_section_find(section, names[i]);
}

struct dcf_slice dcf_report_file(const struct dcf_builder *self)
{
    return dcf_slice_of(self->report->file ? self->report->file : "");
}

/* True for a key that is there, also empty. */
static bool has_key(const struct dcf_section *section, const char *name)
{
    for (size_t i = 0; i < section->count; i++) {
        if (dcf_slice_is(section->keys[i].name, name))
            return true;
    }
    return false;
}

void dcf_expect_keys(struct dcf_builder *self, struct dcf_section *section,
                     const char *const *names, size_t count, bool may_be_empty)
{
    char missing[400] = "";
    size_t used = 0, left = 0;

    for (size_t i = 0; i < count; i++) {
        bool there = dcf_section_find(section, names[i]) ||
                     (may_be_empty && has_key(section, names[i]));

        if (there || used >= sizeof missing)
            continue;
        used += (size_t)snprintf(missing + used, sizeof missing - used, "%s%s", left++ ? ", " : "",
                                 names[i]);
    }
    if (left > 0)
        dcf_tell(self->report, DCF_RULE_KEY_MISSING, section->line,
                 "[%s]: %s expected, %s missing%s", dcf_show(section->name).text, missing,
                 left > 1 ? "they are" : "it is", may_be_empty ? "" : " or empty");
}

void dcf_text_of_key(struct dcf_builder *self, const struct dcf_key *key, char **text)
{
    char *copy;

    if (!key)
        return;
    copy = dcf_utf8_copy(&self->dcf->pool, key->value);
    if (copy)
        *text = copy;
    else
        self->no_memory = true;
}

void dcf_set_number(struct dcf_builder *self, struct dcf_value *value, uint32_t size,
                    uint32_t number)
{
    value->bytes = co_pool_take(&self->dcf->pool, size);
    if (!value->bytes) {
        self->no_memory = true;
        return;
    }
    put_le(value->bytes, size, number);
    value->size = size;
    value->given = true;
}

void dcf_set_text(struct dcf_builder *self, char **text, const char *value)
{
    size_t size = strlen(value) + 1;

    *text = co_pool_take(&self->dcf->pool, size);
    if (*text)
        memcpy(*text, value, size);
    else
        self->no_memory = true;
}

static void tell_misfit(struct dcf_builder *self, const struct dcf_section *section,
                        const struct dcf_key *key, uint8_t type, bool strict, enum dcf_fit fit)
{
    struct dcf_shown in = dcf_show(section->name), name = dcf_show(key->name);
    struct dcf_shown value = dcf_show(key->value);
    const char *expected = dcf_convert_expected(type);

    if (!strict && fit == DCF_OUT_OF_RANGE)
        dcf_tell(self->report, DCF_RULE_VALUE_RANGE, key->line,
                 "[%s] %s: %s (%s) expected, there is \"%s\", which does not fit the type: ignored",
                 in.text, name.text, expected, od_type_name(type), value.text);
    else if (!strict)
        dcf_tell(self->report, DCF_RULE_VALUE_FORMAT, key->line,
                 "[%s] %s: %s (%s) expected, there is \"%s\": ignored", in.text, name.text,
                 expected, od_type_name(type), value.text);
    else if (fit == DCF_OUT_OF_RANGE)
        dcf_tell(self->report, DCF_RULE_PARAMETER_RANGE, key->line,
                 "[%s] %s: %s in the range of %s expected, there is \"%s\"", in.text, name.text,
                 expected, od_type_name(type), value.text);
    else
        dcf_tell(self->report, DCF_RULE_PARAMETER_FORMAT, key->line,
                 "[%s] %s: %s (%s) expected, there is \"%s\"", in.text, name.text, expected,
                 od_type_name(type), value.text);
}

void dcf_key_value(struct dcf_builder *self, const struct dcf_section *section,
                   const struct dcf_key *key, uint8_t type, bool strict, struct dcf_value *value)
{
    struct dcf_value converted;
    unsigned quirks;
    enum dcf_fit fit = dcf_convert(&self->dcf->pool, key->value, type, &converted, &quirks);

    switch (fit) {
    case DCF_FITS:
        dcf_tell_quirks(self, section, key, quirks);
        *value = converted;
        value->line = key->line;
        break;
    case DCF_NO_VALUE:
    case DCF_OUT_OF_RANGE: tell_misfit(self, section, key, type, strict, fit); break;
    case DCF_NO_MEMORY: self->no_memory = true; break;
    }
}

void dcf_tell_unused(struct dcf_builder *self, const struct dcf_section *section)
{
    for (size_t i = 0; i < section->count; i++) {
        const struct dcf_key *key = &section->keys[i];

        if (!key->used)
            dcf_tell(self->report, DCF_RULE_UNKNOWN_KEY, key->line,
                     "[%s]: a keyword of CiA 306 for this section expected, there is "
                     "\"%s\": ignored",
                     dcf_show(section->name).text, dcf_show(key->name).text);
    }
}

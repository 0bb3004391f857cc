/*
 * What a file tells beside its objects: comments, tools, dynamic channels, links between objects.
 * Nobody here has a use for them; their form is checked.
 */
#include "dcf/dcf_build.h"

#include <stdio.h>

static const struct dcf_numbered comment_form = {
    .count_key = "Lines",
    .prefix = "Line",
    .may_be_empty = true,
    .rule = DCF_RULE_ENTRY_COUNT,
};

void dcf_check_comments(struct dcf_builder *self, struct dcf_section *section)
{
    dcf_read_numbered(self, section, &comment_form, NULL);
    dcf_tell_unused(self, section);
}

/* [Tool1], [Tool2], ... as many as there are Items. */
static void check_tools(struct dcf_builder *self)
{
    static const char *const texts[] = { "Name", "Command" };
    struct dcf_section *tools = dcf_text_find(&self->text, DCF_SECTION_TOOLS);
    struct dcf_section *tool = dcf_text_find(&self->text, DCF_SECTION_TOOL);
    const struct dcf_section *end = self->text.sections + self->text.section_count;
    unsigned count = 0;
    uint32_t items = 0;

    for (; tool && tool < end && tool->kind == DCF_SECTION_TOOL; tool++) {
        dcf_expect_keys(self, tool, texts, sizeof texts / sizeof texts[0], false);
        dcf_tell_unused(self, tool);
        count++;
        if (tool->part != count)
            dcf_tell(self->report, DCF_RULE_LIST_NUMBERS, tool->line,
                     "[%s]: [Tool%u] expected as the next one", dcf_show(tool->name).text, count);
    }
    if (tools) {
        items = dcf_key_number(self, tools, "Items", UINT16_MAX, 0);
        dcf_tell_unused(self, tools);
    }
    tool = dcf_text_find(&self->text, DCF_SECTION_TOOL);
    if (items != count)
        dcf_tell(self->report, DCF_RULE_ENTRY_COUNT, tools ? tools->line : tool->line,
                 "[Tools] Items: %u expected (so many sections [Tooln] are there), it is %lu",
                 count, (unsigned long)items);
}

static void take_link(void *context, const struct dcf_section *section, const struct dcf_key *key,
                      unsigned number)
{
    struct dcf_builder *self = context;
    uint16_t index;

    (void)number;
    if (!dcf_key_index(self, section, key, &index) || dcf_has_object(self->dcf, index))
        return;
    dcf_tell(self->report, DCF_RULE_OBJECT_LINK, key->line,
             "[%s] %s: an object of this file expected, %04Xh is not in it",
             dcf_show(section->name).text, dcf_show(key->name).text, index);
}

static void check_links(struct dcf_builder *self)
{
    static const struct dcf_numbered form = {
        .count_key = "ObjectLinks", .prefix = "", .rule = DCF_RULE_ENTRY_COUNT, .take = take_link
    };

    for (size_t i = 0; i < self->text.section_count; i++) {
        struct dcf_section *section = &self->text.sections[i];

        if (section->kind != DCF_SECTION_LINKS)
            continue;
        if (!dcf_has_object(self->dcf, section->index))
            dcf_tell(self->report, DCF_RULE_OBJECT_MISSING, section->line,
                     "[%s]: a section [%04X] for its object expected, it is missing",
                     dcf_show(section->name).text, section->index);
        dcf_read_numbered(self, section, &form, self);
        dcf_tell_unused(self, section);
    }
}

/* "0xA000-0xA03F" */
static bool is_range(struct dcf_slice text)
{
    struct dcf_number first, last;
    size_t dash = 0;

    while (dash < text.size && text.text[dash] != '-')
        dash++;
    return dash < text.size && dcf_number_parse(dcf_slice_cut(text, dash), &first) &&
           dcf_number_parse(dcf_slice_skip(text, dash + 1), &last) && !first.has_node_id &&
           !last.has_node_id && !last.negative && last.magnitude <= UINT16_MAX &&
           first.magnitude <= last.magnitude;
}

/* "0" or "0,1": where the segment begins, and how far its variables are apart. */
static bool is_offset(struct dcf_slice text)
{
    struct dcf_number number;
    size_t comma = 0;

    while (comma < text.size && text.text[comma] != ',')
        comma++;
    if (!dcf_number_parse(dcf_slice_cut(text, comma), &number) || number.has_node_id ||
        number.negative)
        return false;
    return comma == text.size ||
           (dcf_number_parse(dcf_slice_skip(text, comma + 1), &number) && !number.has_node_id);
}

static bool is_type(struct dcf_slice text)
{
    struct dcf_number number;

    return dcf_number_parse(text, &number) && !number.has_node_id && !number.negative &&
           number.magnitude <= UINT8_MAX && od_type_known((uint8_t)number.magnitude);
}

static bool is_direction(struct dcf_slice text)
{
    return dcf_slice_is(text, "ro") || dcf_slice_is(text, "wo") || dcf_slice_is(text, "rw") ||
           dcf_slice_is(text, "rwr") || dcf_slice_is(text, "rww");
}

static const struct {
    const char *name;
    const char *expected;
    bool (*fits)(struct dcf_slice text);
} channel_keys[] = {
    { "Type", "a data type of CiA 301", is_type },
    { "Dir", "ro, wo, rw, rwr or rww", is_direction },
    { "Range", "two indices like 0xA000-0xA03F", is_range },
    { "PPOffset", "an offset, or two numbers with a comma between", is_offset },
};

#define CHANNEL_KEY_COUNT (sizeof channel_keys / sizeof channel_keys[0])

static void check_segment(struct dcf_builder *self, struct dcf_section *section, unsigned number)
{
    char name[32];

    for (size_t i = 0; i < CHANNEL_KEY_COUNT; i++) {
        const struct dcf_key *key;

        snprintf(name, sizeof name, "%s%u", channel_keys[i].name, number);
        key = dcf_section_find(section, name);
        if (!key || !channel_keys[i].fits(key->value))
            dcf_tell(self->report, DCF_RULE_CHANNEL, key ? key->line : section->line,
                     "[%s] %s: %s expected, %s%s", dcf_show(section->name).text, name,
                     channel_keys[i].expected, key ? "there is " : "it is missing",
                     key ? dcf_show(key->value).text : "");
    }
}

static void check_channels(struct dcf_builder *self)
{
    struct dcf_section *section = dcf_text_find(&self->text, DCF_SECTION_DYNAMIC_CHANNELS);
    struct dcf_section *device = dcf_text_find(&self->text, DCF_SECTION_DEVICE_INFO);
    uint32_t count;

    if (!section)
        return;
    count = dcf_key_number(self, section, "NrOfSeg", UINT8_MAX, 0);
    if (count > 0 && device && !dcf_key_flag(self, device, "DynamicChannelsSupported"))
        dcf_tell(self->report, DCF_RULE_CHANNEL, section->line,
                 "[%s]: DynamicChannelsSupported=1 in [DeviceInfo] expected, it is not there",
                 dcf_show(section->name).text);
    for (unsigned number = 1; number <= count; number++)
        check_segment(self, section, number);
    dcf_tell_unused(self, section);
}

void dcf_check_notes(struct dcf_builder *self)
{
    struct dcf_section *comments = dcf_text_find(&self->text, DCF_SECTION_COMMENTS);

    if (comments)
        dcf_check_comments(self, comments);
    check_tools(self);
    check_channels(self);
    check_links(self);
}

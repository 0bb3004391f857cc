/* [FileInfo], [DeviceInfo], [DummyUsage] and [DeviceComissioning]. */
#include "dcf/dcf_build.h"

#include <stdio.h>
#include <string.h>

#define GRANULARITY_MAX 64u
#define PDOS_MAX        512u
#define DUMMY_LAST      0x1Bu /* data type index of the last simple type */

static const unsigned bit_rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };

#define BIT_RATE_COUNT (sizeof bit_rates / sizeof bit_rates[0])

static struct dcf_section *find_section(struct dcf_builder *self, enum dcf_section_kind kind,
                                        const char *name)
{
    struct dcf_section *section = dcf_text_find(&self->text, kind);

    if (!section)
        dcf_tell(self->report, DCF_RULE_SECTION_MISSING, 0,
                 "a section [%s] expected, it is missing", name);
    return section;
}

/* 0: not given */
static unsigned line_of(struct dcf_section *section, const char *name)
{
    const struct dcf_key *key = dcf_section_find(section, name);

    return key ? key->line : 0;
}

static void expect_text(struct dcf_builder *self, struct dcf_section *section, const char *name)
{
    if (!dcf_section_find(section, name))
        dcf_tell(self->report, DCF_RULE_TEXT_MISSING, section->line,
                 "[%s] %s: a text expected, it is missing or empty", dcf_show(section->name).text,
                 name);
}

static void use_keys(struct dcf_section *section, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        dcf_section_find(section, names[i]);
}

/* '9' stands for a digit, 'x' for A or P. */
static bool looks_like(struct dcf_slice text, const char *pattern)
{
    if (text.size != strlen(pattern))
        return false;
    for (size_t i = 0; i < text.size; i++) {
        char c = text.text[i], wanted = pattern[i];
        bool digit = c >= '0' && c <= '9';
        bool am_pm = c == 'A' || c == 'P' || c == 'a' || c == 'p';

        if (wanted == '9' ? !digit : wanted == 'x' ? !am_pm : c != wanted && c != wanted + 32)
            return false;
    }
    return true;
}

static void check_form(struct dcf_builder *self, struct dcf_section *section, enum dcf_rule rule,
                       const char *name, const char *pattern, const char *form)
{
    const struct dcf_key *key = dcf_section_find(section, name);

    if (key && !looks_like(key->value, pattern))
        dcf_tell(self->report, rule, key->line, "[%s] %s: %s expected, there is \"%s\"",
                 dcf_show(section->name).text, name, form, dcf_show(key->value).text);
}

static void build_file_info(struct dcf_builder *self)
{
    static const char *const others[] = { "Description", "CreatedBy", "ModifiedBy" };
    struct dcf_section *section = find_section(self, DCF_SECTION_FILE_INFO, "FileInfo");

    if (!section)
        return;
    expect_text(self, section, "FileName");
    dcf_key_text(self, section, "FileName", &self->dcf->file_name);
    dcf_key_text(self, section, "LastEDS", &self->dcf->last_eds);
    self->dcf->file_name_line = line_of(section, "FileName");
    self->dcf->last_eds_line = line_of(section, "LastEDS");
    dcf_key_number(self, section, "FileVersion", UINT8_MAX, 0);
    dcf_key_number(self, section, "FileRevision", UINT8_MAX, 0);
    check_form(self, section, DCF_RULE_EDS_VERSION, "EDSVersion", "9.9", "3.0 or 4.0");
    check_form(self, section, DCF_RULE_DATE_AND_TIME, "CreationTime", "99:99xM", "hh:mm(AM|PM)");
    check_form(self, section, DCF_RULE_DATE_AND_TIME, "CreationDate", "99-99-9999", "mm-dd-yyyy");
    check_form(self, section, DCF_RULE_DATE_AND_TIME, "ModificationTime", "99:99xM",
               "hh:mm(AM|PM)");
    check_form(self, section, DCF_RULE_DATE_AND_TIME, "ModificationDate", "99-99-9999",
               "mm-dd-yyyy");
    dcf_key_text(self, section, "ModificationTime", &self->dcf->modification_time);
    dcf_key_text(self, section, "ModificationDate", &self->dcf->modification_date);
    use_keys(section, others, sizeof others / sizeof others[0]);
    dcf_tell_unused(self, section);
}

static void build_bit_rates(struct dcf_builder *self, struct dcf_section *section)
{
    char name[32];

    for (size_t i = 0; i < BIT_RATE_COUNT; i++) {
        snprintf(name, sizeof name, "BaudRate_%u", bit_rates[i]);
        if (dcf_key_flag(self, section, name))
            self->dcf->bit_rates |= (uint16_t)(1u << i);
    }
}

static void build_device_info(struct dcf_builder *self)
{
    static const char *const others[] = { "OrderCode",         "SimpleBootUpMaster",
                                          "SimpleBootUpSlave", "DynamicChannelsSupported",
                                          "LSS_Supported",     "CANopenSafetySupported" };
    struct dcf_section *section = find_section(self, DCF_SECTION_DEVICE_INFO, "DeviceInfo");
    struct dcf *dcf = self->dcf;

    if (!section)
        return;
    dcf->has_device_info = true;
    expect_text(self, section, "VendorName");
    expect_text(self, section, "ProductName");
    dcf_key_text(self, section, "VendorName", &dcf->vendor_name);
    dcf_key_text(self, section, "ProductName", &dcf->product_name);
    dcf->vendor_number = dcf_key_number(self, section, "VendorNumber", UINT32_MAX, 0);
    dcf->product_number = dcf_key_number(self, section, "ProductNumber", UINT32_MAX, 0);
    dcf->revision_number = dcf_key_number(self, section, "RevisionNumber", UINT32_MAX, 0);
    dcf->vendor_number_line = line_of(section, "VendorNumber");
    dcf->product_number_line = line_of(section, "ProductNumber");
    dcf->revision_number_line = line_of(section, "RevisionNumber");
    dcf->granularity_line = line_of(section, "Granularity");
    dcf->group_messaging = dcf_key_flag(self, section, "GroupMessaging");
    build_bit_rates(self, section);
    dcf->granularity = (uint8_t)dcf_key_number(self, section, "Granularity", GRANULARITY_MAX, 0);
    dcf->rx_pdos = (uint16_t)dcf_key_number(self, section, "NrOfRXPDO", PDOS_MAX, 0);
    dcf->tx_pdos = (uint16_t)dcf_key_number(self, section, "NrOfTXPDO", PDOS_MAX, 0);
    self->compact_pdo = (uint8_t)dcf_key_number(self, section, "CompactPDO", UINT8_MAX, 0);
    use_keys(section, others, sizeof others / sizeof others[0]);
    dcf_tell_unused(self, section);
}

static void build_dummy_usage(struct dcf_builder *self)
{
    struct dcf_section *section = find_section(self, DCF_SECTION_DUMMY_USAGE, "DummyUsage");
    char name[32];

    if (!section)
        return;
    for (unsigned i = 0; i <= DUMMY_LAST; i++) {
        snprintf(name, sizeof name, "Dummy%04X", i);
        if (dcf_key_flag(self, section, name) && i < 8)
            self->dcf->dummy_usage |= (uint8_t)(1u << i);
    }
    dcf_tell_unused(self, section);
}

static void build_node_id(struct dcf_builder *self, struct dcf_section *section)
{
    const struct dcf_key *key = dcf_section_find(section, "NodeID");
    struct dcf_number number;
    bool is_number;

    self->dcf->node_id_line = key ? key->line : section->line;
    if (!key) {
        dcf_tell(self->report, DCF_RULE_NODE_ID_MISSING, section->line,
                 "[%s] NodeID: 1..127 expected, it is missing or empty",
                 dcf_show(section->name).text);
        return;
    }
    is_number = dcf_number_parse(key->value, &number) && !number.has_node_id && !number.negative;
    if (is_number && number.magnitude >= 1 && number.magnitude <= 127) {
        self->dcf->has_node_id = true;
        self->dcf->node_id = (uint8_t)number.magnitude;
    } else if (is_number && (number.magnitude == 0 || number.magnitude == 255)) {
        dcf_tell(self->report, DCF_RULE_NODE_ID_UNSET, key->line,
                 "[%s] NodeID: 1..127 expected, there is \"%s\": taken as not configured",
                 dcf_show(section->name).text, dcf_show(key->value).text);
    } else {
        dcf_tell(self->report, is_number ? DCF_RULE_NODE_ID : DCF_RULE_NODE_ID_FORMAT, key->line,
                 "[%s] NodeID: 1..127 expected, there is \"%s\"", dcf_show(section->name).text,
                 dcf_show(key->value).text);
    }
}

#define BIT_RATES "10, 20, 50, 125, 250, 500, 800 or 1000"

/* 0 where the text is none of the rates in kbit/s. */
static unsigned parse_bit_rate(struct dcf_slice text, bool *ret_is_zero)
{
    struct dcf_number number;

    *ret_is_zero = false;
    if (!dcf_number_parse(text, &number) || number.has_node_id || number.negative)
        return 0;
    *ret_is_zero = number.magnitude == 0;
    for (size_t i = 0; i < BIT_RATE_COUNT; i++) {
        if (number.magnitude == bit_rates[i])
            return bit_rates[i];
    }
    return 0;
}

static void build_bit_rate(struct dcf_builder *self, struct dcf_section *section)
{
    const struct dcf_key *key = dcf_section_find(section, "Baudrate");
    bool is_zero = false;

    self->dcf->baudrate_line = key ? key->line : section->line;
    if (key)
        self->dcf->baudrate = parse_bit_rate(key->value, &is_zero);
    if (!key || is_zero)
        dcf_tell(self->report, DCF_RULE_BIT_RATE_UNSET, self->dcf->baudrate_line,
                 "[%s] Baudrate: " BIT_RATES " expected, there is %s: not configured",
                 dcf_show(section->name).text, key ? "0" : "none");
    else if (self->dcf->baudrate == 0)
        dcf_tell(self->report, DCF_RULE_BIT_RATE, key->line,
                 "[%s] Baudrate: " BIT_RATES " expected, there is \"%s\"",
                 dcf_show(section->name).text, dcf_show(key->value).text);
}

static void build_commissioning(struct dcf_builder *self)
{
    static const char *const others[] = { "NetNumber", "NetworkName", "LSS_SerialNumber",
                                          "NodeRefd", "NetRefd" };
    struct dcf_section *section = dcf_text_find(&self->text, DCF_SECTION_COMMISSIONING);

    if (!section)
        return;
    self->dcf->is_dcf = true;
    build_node_id(self, section);
    build_bit_rate(self, section);
    dcf_key_text(self, section, "NodeName", &self->dcf->node_name);
    self->dcf->is_manager = dcf_key_flag(self, section, "CANopenManager");
    self->dcf->is_manager_line = line_of(section, "CANopenManager");
    use_keys(section, others, sizeof others / sizeof others[0]);
    dcf_tell_unused(self, section);
}

void dcf_build_info(struct dcf_builder *self)
{
    build_file_info(self);
    build_device_info(self);
    build_dummy_usage(self);
    build_commissioning(self);
}

/* [FileInfo], [DeviceInfo] and [DummyUsage]. */
#include "dcf/dcf_build.h"

#include <stdio.h>
#include <string.h>

#define GRANULARITY_MAX 64u
#define PDOS_MAX        512u
#define COMPACT_PDO_MAX 0x3Fu

/* Data types that a dummy may have. */
#define DUMMY_LAST_OF_FIRST   0x07u
#define DUMMY_FIRST_OF_OTHERS 0x10u
#define DUMMY_LAST            0x1Bu

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

/* The number of two digits at a place. */
static unsigned digits_at(struct dcf_slice text, size_t place)
{
    unsigned number = 0;

    dcf_slice_decimal(dcf_slice_cut(dcf_slice_skip(text, place), 2), 99, &number);
    return number;
}

/* '9' stands for a digit; other characters for themselves, whatever their case. */
static bool looks_like(struct dcf_slice text, const char *pattern)
{
    if (text.size != strlen(pattern))
        return false;
    for (size_t i = 0; i < text.size; i++) {
        bool digit = text.text[i] >= '0' && text.text[i] <= '9';

        if (pattern[i] == '9' ? !digit : pattern[i] != text.text[i])
            return false;
    }
    return true;
}

static bool is_time(struct dcf_slice text)
{
    return text.size == 7 && looks_like(dcf_slice_cut(text, 5), "99:99") &&
           digits_at(text, 0) <= 12 && digits_at(text, 3) <= 59 &&
           (dcf_slice_ends(text, "AM") || dcf_slice_ends(text, "PM"));
}

static bool is_date(struct dcf_slice text)
{
    return looks_like(text, "99-99-9999") && digits_at(text, 0) >= 1 && digits_at(text, 0) <= 12 &&
           digits_at(text, 3) >= 1 && digits_at(text, 3) <= 31;
}

static void check_moment(struct dcf_builder *self, struct dcf_section *section, const char *name)
{
    const struct dcf_key *key = dcf_section_find(section, name);
    bool time = dcf_slice_ends(dcf_slice_of(name), "Time");

    if (key && !(time ? is_time(key->value) : is_date(key->value)))
        dcf_tell(self->report, DCF_RULE_DATE_AND_TIME, key->line,
                 "[%s] %s: %s expected, there is \"%s\"", dcf_show(section->name).text, name,
                 time ? "hh:mm(AM|PM)" : "mm-dd-yyyy", dcf_show(key->value).text);
}

static void build_version(struct dcf_builder *self, struct dcf_section *section)
{
    const struct dcf_key *key = dcf_section_find(section, "EDSVersion");

    if (!key || dcf_slice_is(key->value, "3.0"))
        return;
    self->eds_version = EDS_VERSION_4;
    if (!dcf_slice_is(key->value, "4.0"))
        dcf_tell(self->report, DCF_RULE_EDS_VERSION, key->line,
                 "[%s] EDSVersion: 3.0 or 4.0 expected, there is \"%s\"",
                 dcf_show(section->name).text, dcf_show(key->value).text);
}

static void build_file_info(struct dcf_builder *self)
{
    static const char *const demanded[] = { "FileName", "FileVersion", "FileRevision", "LastEDS" };
    static const char *const others[] = { "Description", "CreatedBy", "ModifiedBy" };
    static const char *const moments[] = { "CreationTime", "CreationDate", "ModificationTime",
                                           "ModificationDate" };
    struct dcf_section *section = find_section(self, DCF_SECTION_FILE_INFO, "FileInfo");
    bool is_dcf = dcf_text_find(&self->text, DCF_SECTION_COMMISSIONING) != NULL;

    if (!section)
        return;
    dcf_expect_keys(self, section, demanded, is_dcf ? 4 : 3, false);
    dcf_key_text(self, section, "FileName", &self->dcf->file_name);
    dcf_key_text(self, section, "LastEDS", &self->dcf->last_eds);
    self->dcf->file_name_line = dcf_key_line(section, "FileName");
    self->dcf->last_eds_line = dcf_key_line(section, "LastEDS");
    dcf_key_number(self, section, "FileVersion", UINT8_MAX, 0);
    dcf_key_number(self, section, "FileRevision", UINT8_MAX, 0);
    build_version(self, section);
    for (size_t i = 0; i < sizeof moments / sizeof moments[0]; i++)
        check_moment(self, section, moments[i]);
    dcf_key_text(self, section, "ModificationTime", &self->dcf->modification_time);
    dcf_key_text(self, section, "ModificationDate", &self->dcf->modification_date);
    dcf_use_keys(section, others, sizeof others / sizeof others[0]);
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

/* Of earlier versions of the standard. */
static void tell_reserved(struct dcf_builder *self, struct dcf_section *section)
{
    static const char *const names[] = { "ExtendedBootUpMaster", "ExtendedBootUpSlave",
                                         "ProductVersion",       "ProductRevision",
                                         "LMT_ManufacturerName", "LMT_ProductName" };

    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const struct dcf_key *key = dcf_section_find(section, names[i]);

        if (key)
            dcf_tell(self->report, DCF_RULE_RESERVED_KEY, key->line,
                     "[%s] %s: not expected any more, kept free for old files: ignored",
                     dcf_show(section->name).text, names[i]);
    }
}

static void build_pdos(struct dcf_builder *self, struct dcf_section *section)
{
    struct dcf *dcf = self->dcf;
    const struct dcf_key *key = dcf_section_find(section, "CompactPDO");

    dcf->granularity_line = dcf_key_line(section, "Granularity");
    dcf->granularity = (uint8_t)dcf_key_number(self, section, "Granularity", GRANULARITY_MAX, 0);
    dcf->rx_pdos = (uint16_t)dcf_key_number(self, section, "NrOfRXPDO", PDOS_MAX, 0);
    dcf->tx_pdos = (uint16_t)dcf_key_number(self, section, "NrOfTXPDO", PDOS_MAX, 0);
    self->compact_pdo = (uint8_t)dcf_key_number(self, section, "CompactPDO", UINT8_MAX, 0);
    if (self->compact_pdo > COMPACT_PDO_MAX)
        dcf_tell(
            self->report, DCF_RULE_COMPACT_PDO, key->line,
            "[%s] CompactPDO: up to 3Fh expected (one bit for each sub-index), there is %02Xh: "
            "the others are ignored",
            dcf_show(section->name).text, self->compact_pdo);
    if (self->compact_pdo != 0 && dcf->rx_pdos == 0 && dcf->tx_pdos == 0)
        dcf_tell(self->report, DCF_RULE_COMPACT_PDO, key->line,
                 "[%s] CompactPDO: NrOfRXPDO or NrOfTXPDO expected with it, there are no PDOs",
                 dcf_show(section->name).text);
}

static void build_device_info(struct dcf_builder *self)
{
    static const char *const demanded[] = {
        "VendorName",        "VendorNumber", "ProductName",  "ProductNumber", "RevisionNumber",
        "OrderCode",         "BaudRate_10",  "BaudRate_20",  "BaudRate_50",   "BaudRate_125",
        "BaudRate_250",      "BaudRate_500", "BaudRate_800", "BaudRate_1000", "SimpleBootUpMaster",
        "SimpleBootUpSlave", "Granularity",  "NrOfRXPDO",    "NrOfTXPDO",     "LSS_Supported"
    };
    static const char *const flags[] = { "SimpleBootUpMaster", "SimpleBootUpSlave",
                                         "DynamicChannelsSupported", "LSS_Supported",
                                         "CANopenSafetySupported" };
    struct dcf_section *section = find_section(self, DCF_SECTION_DEVICE_INFO, "DeviceInfo");
    struct dcf *dcf = self->dcf;

    if (!section)
        return;
    dcf->has_device_info = true;
    dcf_expect_keys(self, section, demanded, sizeof demanded / sizeof demanded[0], false);
    dcf_key_text(self, section, "VendorName", &dcf->vendor_name);
    dcf_key_text(self, section, "ProductName", &dcf->product_name);
    dcf->vendor_number = dcf_key_number(self, section, "VendorNumber", UINT32_MAX, 0);
    dcf->product_number = dcf_key_number(self, section, "ProductNumber", UINT32_MAX, 0);
    dcf->revision_number = dcf_key_number(self, section, "RevisionNumber", UINT32_MAX, 0);
    dcf->vendor_number_line = dcf_key_line(section, "VendorNumber");
    dcf->product_number_line = dcf_key_line(section, "ProductNumber");
    dcf->revision_number_line = dcf_key_line(section, "RevisionNumber");
    dcf->group_messaging = dcf_key_flag(self, section, "GroupMessaging");
    build_bit_rates(self, section);
    build_pdos(self, section);
    for (size_t i = 0; i < sizeof flags / sizeof flags[0]; i++)
        dcf_key_flag(self, section, flags[i]);
    tell_reserved(self, section);
    dcf_tell_unused(self, section);
}

static void build_dummy_usage(struct dcf_builder *self)
{
    struct dcf_section *section = find_section(self, DCF_SECTION_DUMMY_USAGE, "DummyUsage");
    char name[32];

    if (!section)
        return;
    for (unsigned i = 0; i <= DUMMY_LAST; i++) {
        if (i > DUMMY_LAST_OF_FIRST && i < DUMMY_FIRST_OF_OTHERS)
            continue;
        snprintf(name, sizeof name, "Dummy%04X", i);
        if (dcf_key_flag(self, section, name) && i < 8)
            self->dcf->dummy_usage |= (uint8_t)(1u << i);
    }
    dcf_tell_unused(self, section);
}

void dcf_build_info(struct dcf_builder *self)
{
    self->eds_version = EDS_VERSION_3;
    build_file_info(self);
    build_device_info(self);
    build_dummy_usage(self);
}

/* [DeviceComissioning]: which node of which network. */
#include "dcf/dcf_build.h"

static const unsigned bit_rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };

#define BIT_RATE_COUNT (sizeof bit_rates / sizeof bit_rates[0])

static bool parse_number(struct dcf_slice text, struct dcf_number *ret_number)
{
    return dcf_number_parse(text, ret_number) && !ret_number->has_node_id &&
           !ret_number->negative && !ret_number->too_large;
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
    is_number = parse_number(key->value, &number);
    if (is_number && number.magnitude >= 1 && number.magnitude <= 127) {
        self->dcf->has_node_id = true;
        self->dcf->node_id = (uint8_t)number.magnitude;
        dcf_tell_quirks(self, section, key, number.quirks);
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

/* "500k", "500 kbit/s" */
static struct dcf_slice cut_unit(struct dcf_slice text)
{
    size_t size = 0;

    while (size < text.size && text.text[size] >= '0' && text.text[size] <= '9')
        size++;
    return dcf_slice_begins(dcf_slice_trim(dcf_slice_skip(text, size)), "k")
               ? dcf_slice_cut(text, size)
               : text;
}

struct bit_rate {
    unsigned kbit; /* 0: none of those of CiA 301 */
    bool is_zero;
    bool has_unit; /* or is in bit/s */
    unsigned quirks;
};

static struct bit_rate parse_bit_rate(struct dcf_slice text)
{
    struct bit_rate rate = { .kbit = 0 };
    struct dcf_slice digits = cut_unit(text);
    struct dcf_number number;

    if (!parse_number(digits, &number))
        return rate;
    rate.is_zero = number.magnitude == 0;
    rate.quirks = number.quirks;
    for (size_t i = 0; i < BIT_RATE_COUNT; i++) {
        bool in_bits = digits.size == text.size && number.magnitude == 1000u * bit_rates[i];

        if (!in_bits && number.magnitude != bit_rates[i])
            continue;
        rate.kbit = bit_rates[i];
        rate.has_unit = in_bits || digits.size < text.size;
    }
    return rate;
}

static void tell_bit_rate(struct dcf_builder *self, const struct dcf_section *section,
                          const struct dcf_key *key, const struct bit_rate *rate)
{
    if (rate->has_unit)
        dcf_tell(self->report, DCF_RULE_BIT_RATE_UNIT, key->line,
                 "[%s] Baudrate: %u expected (kbit/s), there is \"%s\"",
                 dcf_show(section->name).text, rate->kbit, dcf_show(key->value).text);
    else if (rate->kbit != 0)
        dcf_tell_quirks(self, section, key, rate->quirks);
    else
        dcf_tell(self->report, DCF_RULE_BIT_RATE, key->line,
                 "[%s] Baudrate: " BIT_RATES " expected, there is \"%s\"",
                 dcf_show(section->name).text, dcf_show(key->value).text);
}

static void build_bit_rate(struct dcf_builder *self, struct dcf_section *section)
{
    const struct dcf_key *key = dcf_section_find(section, "Baudrate");
    struct bit_rate rate = { .is_zero = true };

    if (key)
        rate = parse_bit_rate(key->value);
    self->dcf->baudrate_line = key ? key->line : section->line;
    self->dcf->baudrate = rate.kbit;
    if (rate.is_zero)
        dcf_tell(self->report, DCF_RULE_BIT_RATE_UNSET, self->dcf->baudrate_line,
                 "[%s] Baudrate: " BIT_RATES " expected, there is %s: not configured",
                 dcf_show(section->name).text, key ? "0" : "none");
    else
        tell_bit_rate(self, section, key, &rate);
}

void dcf_build_commissioning(struct dcf_builder *self)
{
    static const char *const demanded[] = { "NodeName", "NetNumber", "NetworkName",
                                            "CANopenManager" };
    static const char *const others[] = { "NetworkName", "NodeRefd", "NetRefd" };
    struct dcf_section *section = dcf_text_find(&self->text, DCF_SECTION_COMMISSIONING);

    if (!section && dcf_slice_ends(dcf_report_file(self), ".dcf"))
        dcf_tell(self->report, DCF_RULE_SECTION_MISSING, 0,
                 "a section [DeviceComissioning] expected in a DCF, it is missing");
    if (!section)
        return;
    self->dcf->is_dcf = true;
    build_node_id(self, section);
    build_bit_rate(self, section);
    dcf_key_text(self, section, "NodeName", &self->dcf->node_name);
    dcf_key_number(self, section, "NetNumber", UINT32_MAX, 0);
    self->dcf->is_manager = dcf_key_flag(self, section, "CANopenManager");
    self->dcf->is_manager_line = dcf_key_line(section, "CANopenManager");
    dcf_key_number(self, section, "LSS_SerialNumber", UINT32_MAX, 0);
    dcf_use_keys(section, others, sizeof others / sizeof others[0]);
    dcf_expect_keys(self, section, demanded, sizeof demanded / sizeof demanded[0], true);
    dcf_tell_unused(self, section);
}

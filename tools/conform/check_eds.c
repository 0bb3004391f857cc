/*
 * Checks of the EDS (protocol family "eds"): the file itself, and what it says of the identity.
 */
#include "conform_families.h"

#include "base/bytes.h"
#include "od/abort.h"

#include <string.h>

static bool check_valid(struct conform *self)
{
    if (!self->options.eds)
        return conform_skip(self, "give --eds FILE");
    if (!self->has_eds)
        return conform_fail(self, "the file has errors:\n%s",
                            self->eds_messages ? self->eds_messages : "");
    return true;
}

static bool check_standard(struct conform *self)
{
    char text[900] = "";
    size_t used = 0;
    unsigned count = 0;

    for (const char *line = self->eds_messages; line && *line;) {
        const size_t length = strcspn(line, "\n");

        if (length > 0) {
            count++;
            if (used + length + 2 < sizeof text)
                used += (size_t)snprintf(text + used, sizeof text - used, "\n%.*s", (int)length,
                                         line);
        }
        line += length + (line[length] == '\n');
    }
    return count == 0 || conform_fail(self, "the reader has %u objections:%s", count, text);
}

static bool check_mandatory(struct conform *self)
{
    static const struct {
        uint16_t index;
        uint8_t sub;
    } mandatory[] = { { 0x1000, 0 }, { 0x1001, 0 }, { 0x1018, 0 }, { 0x1018, 1 } };

    for (size_t i = 0; i < sizeof mandatory / sizeof mandatory[0]; i++) {
        struct conform_value value;

        if (self->has_eds && !dcf_find(&self->eds, mandatory[i].index, mandatory[i].sub))
            return conform_fail(self, "the EDS has no %04Xh:%02X", mandatory[i].index,
                                mandatory[i].sub);
        if (!conform_must_read(self, mandatory[i].index, mandatory[i].sub, &value))
            return false;
    }
    return true;
}

static bool compare_identity(struct conform *self, uint8_t sub, uint32_t expected)
{
    uint64_t number;

    if (!conform_find(self, 0x1018, sub))
        return true;
    if (!conform_must_read_number(self, 0x1018, sub, &number))
        return false;
    if (number != expected)
        return conform_fail(self, "1018h:%02X: the EDS says %08X, received %08X", sub,
                            (unsigned)expected, (unsigned)number);
    return true;
}

static bool check_identity(struct conform *self)
{
    return compare_identity(self, 1, self->eds.vendor_number) &&
           compare_identity(self, 2, self->eds.product_number) &&
           compare_identity(self, 3, self->eds.revision_number);
}

static bool check_bit_rates(struct conform *self)
{
    static const unsigned rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };
    char text[128] = "";
    int length = 0;

    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++)
        if (self->eds.bit_rates >> i & 1)
            length += snprintf(text + length, sizeof text - (size_t)length, " %u", rates[i]);
    if (length == 0)
        return conform_fail(self, "the EDS names no bit rate that the device supports");
    return conform_help(self,
                        "the EDS names%s kbit/s: set the device to each of them, and run the "
                        "tester there",
                        text);
}

static const struct conform_check checks[] = {
    { "eds-valid", "the EDS can be read", "CiA 306", 0, 0, check_valid },
    { "eds-standard", "the EDS is as the standard has it", "CiA 306", CONFORM_EDS, 0,
      check_standard },
    { "eds-mandatory", "the mandatory objects are in the EDS and in the device", "CiA 301, 7.5.2",
      0, 0, check_mandatory },
    { "eds-identity", "vendor, product and revision are those of the EDS", "CiA 306, DeviceInfo",
      CONFORM_EDS, 0, check_identity },
    { "eds-bit-rates", "the device works at the bit rates of the EDS", "CiA 306, DeviceInfo",
      CONFORM_EDS, 0, check_bit_rates },
};

const struct conform_family conform_eds = { "eds", "EDS", checks,
                                            sizeof checks / sizeof checks[0] };

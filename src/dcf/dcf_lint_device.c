/* What the file tells of the device and its place in the network against its objects. */
#include "dcf/dcf_lint_parts.h"

#define HEARTBEAT_CONSUMER 0x1016u
#define NODE_ID_MAX        127u

static bool effective_number(const struct dcf_lint *self, uint16_t index, uint8_t sub,
                             uint64_t *ret_number, unsigned *ret_line)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, index, sub);
    const struct dcf_value *value = entry ? dcf_lint_effective(entry) : NULL;

    if (!value || !dcf_lint_number(self, entry, value, ret_number))
        return false;
    *ret_line = value->line;
    return true;
}

static void check_last_eds(const struct dcf_lint *self)
{
    const struct dcf *dcf = self->dcf;

    if (dcf->last_eds && !dcf->is_dcf)
        dcf_tell(self->report, DCF_RULE_LAST_EDS, dcf->last_eds_line,
                 "[FileInfo] LastEDS: expected in a DCF only, this file has no "
                 "[DeviceComissioning]");
}

/* --- identity and bit rates --- */

static void check_identity(const struct dcf_lint *self, uint8_t sub, const char *name,
                           unsigned line, uint32_t number)
{
    const struct dcf_entry *entry = dcf_find(self->dcf, 0x1018, sub);
    uint64_t own;

    if (line != 0 && entry && dcf_lint_number(self, entry, &entry->initial, &own) && own != number)
        dcf_tell(self->report, DCF_RULE_IDENTITY, line,
                 "[DeviceInfo] %s: 0x%lX expected (DefaultValue of 1018h:%02X), there is 0x%lX",
                 name, (unsigned long)own, sub, (unsigned long)number);
}

static void check_bit_rates(const struct dcf_lint *self)
{
    static const unsigned rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };
    const struct dcf *dcf = self->dcf;

    if (!dcf->has_device_info)
        return;
    if (dcf->bit_rates == 0) {
        dcf_tell(self->report, DCF_RULE_NO_BIT_RATE, 0,
                 "[DeviceInfo]: a BaudRate_... with 1 expected, there is none");
        return;
    }
    for (size_t i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        if (dcf->baudrate == rates[i] && !(dcf->bit_rates >> i & 1))
            dcf_tell(self->report, DCF_RULE_BIT_RATE_UNSUPPORTED, dcf->baudrate_line,
                     "[DeviceComissioning] Baudrate: a bit rate of the device expected, "
                     "BaudRate_%u is 0",
                     rates[i]);
    }
}

static void check_manager(const struct dcf_lint *self)
{
    const struct dcf *dcf = self->dcf;

    if (dcf->is_manager && !dcf_has_object(dcf, 0x1F80))
        dcf_tell(self->report, DCF_RULE_MANAGER, dcf->is_manager_line,
                 "[DeviceComissioning] CANopenManager: 0 expected (the device has no 1F80h), there "
                 "is 1");
}

/* --- what its profile asks for --- */

static const struct duty {
    uint16_t profile;
    uint32_t ability; /* a bit of the device type; 0: all of this profile */
    uint16_t index;
    const char *name;
} duties[] = {
    { 401, 0x10000, 0x6000, "digital inputs" },  { 401, 0x20000, 0x6200, "digital outputs" },
    { 401, 0x40000, 0x6401, "analogue inputs" }, { 401, 0x80000, 0x6411, "analogue outputs" },
    { 402, 0, 0x6040, "controlword" },           { 402, 0, 0x6041, "statusword" },
};

static void check_profile(const struct dcf_lint *self)
{
    uint64_t type;
    unsigned line;

    if (!effective_number(self, 0x1000, 0, &type, &line))
        return;
    for (size_t i = 0; i < sizeof duties / sizeof duties[0]; i++) {
        const struct duty *duty = &duties[i];

        if ((type & 0xFFFF) != duty->profile || (type & duty->ability) != duty->ability ||
            dcf_has_object(self->dcf, duty->index))
            continue;
        dcf_tell(self->report, DCF_RULE_PROFILE_OBJECT, line,
                 "1000h: an object %04Xh (%s) expected for device type 0x%lX, it is missing",
                 duty->index, duty->name, (unsigned long)type);
    }
}

/* --- error control --- */

static void check_error_control(const struct dcf_lint *self)
{
    uint64_t heartbeat, guard_time, factor;
    unsigned line;
    bool guarding = dcf_has_object(self->dcf, 0x100C) && dcf_has_object(self->dcf, 0x100D);

    if (!guarding && !dcf_has_object(self->dcf, 0x1017))
        dcf_tell(self->report, DCF_RULE_NO_ERROR_CONTROL, 0,
                 "an object 1017h (heartbeat) expected, or 100Ch and 100Dh (guarding), there is "
                 "neither");
    if (effective_number(self, 0x100D, 0, &factor, &line) && factor != 0 &&
        effective_number(self, 0x1017, 0, &heartbeat, &line) && heartbeat != 0 &&
        effective_number(self, 0x100C, 0, &guard_time, &line) && guard_time != 0)
        dcf_tell(self->report, DCF_RULE_HEARTBEAT_AND_GUARDING, line,
                 "100Ch: 0 expected where there is a heartbeat (1017h is %u ms), there are %u ms: "
                 "heartbeat counts",
                 (unsigned)heartbeat, (unsigned)guard_time);
}

struct watched {
    const struct dcf_entry *by[NODE_ID_MAX + 1];
};

static void check_consumer(const struct dcf_lint *self, const struct dcf_entry *entry,
                           struct watched *watched)
{
    const struct dcf_value *value = dcf_lint_effective(entry);
    uint64_t number;
    unsigned node;

    if (!dcf_lint_number(self, entry, value, &number) || (number & 0xFFFF) == 0)
        return;
    node = (unsigned)(number >> 16 & 0xFF);
    if (number >> 24 != 0 || node > NODE_ID_MAX) {
        dcf_tell(self->report, DCF_RULE_HEARTBEAT_CONSUMER, value->line,
                 "1016h:%02X: a node-ID of 1..127 in bits 16 to 31 expected, there is %04lXh",
                 entry->sub, (unsigned long)(number >> 16));
    } else if (node != 0 && watched->by[node]) {
        dcf_tell(self->report, DCF_RULE_HEARTBEAT_CONSUMER_TWICE, value->line,
                 "1016h:%02X: a node that is not watched yet expected, node %u is by sub-index %u",
                 entry->sub, node, watched->by[node]->sub);
    } else {
        watched->by[node] = node != 0 ? entry : NULL;
    }
}

static void check_consumers(const struct dcf_lint *self)
{
    struct watched watched = { { NULL } };
    size_t count;
    const struct dcf_entry *entries = dcf_object(self->dcf, HEARTBEAT_CONSUMER, &count);

    for (size_t i = 0; i < count; i++) {
        if (entries[i].sub != 0 && entries[i].sub <= NODE_ID_MAX)
            check_consumer(self, &entries[i], &watched);
    }
}

static void check_sync(const struct dcf_lint *self)
{
    uint64_t number;
    unsigned line;

    if (effective_number(self, 0x1019, 0, &number, &line) && (number == 1 || number > 240))
        dcf_tell(self->report, DCF_RULE_SYNC_COUNTER, line,
                 "1019h: 0 or 2..240 expected, there is %u", (unsigned)number);
    if (effective_number(self, 0x1005, 0, &number, &line) && (number & 0x40000000u) &&
        !dcf_has_object(self->dcf, 0x1006))
        dcf_tell(self->report, DCF_RULE_SYNC_PERIOD, line,
                 "1005h: an object 1006h (communication cycle period) expected, the device is to "
                 "send SYNC");
}

void dcf_lint_device(const struct dcf_lint *self)
{
    const struct dcf *dcf = self->dcf;

    check_last_eds(self);
    check_identity(self, 1, "VendorNumber", dcf->vendor_number_line, dcf->vendor_number);
    check_identity(self, 2, "ProductNumber", dcf->product_number_line, dcf->product_number);
    check_identity(self, 3, "RevisionNumber", dcf->revision_number_line, dcf->revision_number);
    check_bit_rates(self);
    check_manager(self);
    check_profile(self);
    check_error_control(self);
    check_consumers(self);
    check_sync(self);
}

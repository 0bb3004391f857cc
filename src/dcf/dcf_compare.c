#include "dcf/dcf_compare.h"

#include "dcf/dcf_build.h"

#include <stdio.h>
#include <string.h>

struct comparison {
    const struct dcf *dcf, *eds;
    struct co_report *report;
    uint8_t node_id;
    unsigned left_out; /* entries that only the EDS has */
    const struct dcf_entry *first_left_out;
};

static struct dcf_shown show(const struct dcf_value *value, uint8_t type)
{
    struct dcf_shown shown = { "" };
    size_t used;

    if (type == OD_VISIBLE_STRING)
        return dcf_show((struct dcf_slice){ (const char *)value->bytes, value->size });
    used = (size_t)snprintf(shown.text, sizeof shown.text, "%s0x",
                            value->has_node_id ? "$NODEID+" : "");
    for (uint32_t i = value->size; i > 0 && used + 2 < sizeof shown.text; i--, used += 2)
        snprintf(shown.text + used, sizeof shown.text - used, "%02X", value->bytes[i - 1]);
    return shown;
}

/* Tools that make DCFs put in the node-ID. */
static bool same_value(const struct comparison *self, const struct dcf_value *a,
                       const struct dcf_value *b, uint8_t type)
{
    if (a->size != b->size)
        return false;
    if (a->has_node_id != b->has_node_id)
        return dcf_value_number(a, type, self->node_id) == dcf_value_number(b, type, self->node_id);
    return memcmp(a->bytes, b->bytes, a->size) == 0;
}

static void compare_values(const struct comparison *self, const struct dcf_entry *entry,
                           const struct dcf_entry *original)
{
    if (entry->initial.given && original->initial.given &&
        !same_value(self, &entry->initial, &original->initial, entry->type))
        dcf_tell(self->report, DCF_RULE_EDS_DEFAULT, entry->initial.line,
                 "%04Xh:%02X DefaultValue: %s expected (so the EDS has it), there is %s",
                 entry->index, entry->sub, show(&original->initial, entry->type).text,
                 show(&entry->initial, entry->type).text);
    if (dcf_entry_downloads(entry) && dcf_value_outside(original, &entry->parameter, self->node_id))
        dcf_tell(self->report, DCF_RULE_EDS_LIMITS, entry->parameter.line,
                 "%04Xh:%02X ParameterValue: %s to %s expected (the limits of the EDS), there is "
                 "%s",
                 entry->index, entry->sub,
                 dcf_number_text(&original->low, entry->type, self->node_id).text,
                 dcf_number_text(&original->high, entry->type, self->node_id).text,
                 dcf_number_text(&entry->parameter, entry->type, self->node_id).text);
}

static void compare_entries(const struct comparison *self, const struct dcf_entry *entry,
                            const struct dcf_entry *original)
{
    if (entry->object_type != original->object_type)
        dcf_tell(self->report, DCF_RULE_EDS_OBJECT_TYPE, entry->line,
                 "%04Xh:%02X ObjectType: %u expected (so the EDS has it), there is %u",
                 entry->index, entry->sub, original->object_type, entry->object_type);
    if (entry->access != original->access)
        dcf_tell(self->report, DCF_RULE_EDS_ACCESS, entry->line,
                 "%04Xh:%02X AccessType: %s expected (so the EDS has it), there is %s",
                 entry->index, entry->sub, dcf_access_text(original->access),
                 dcf_access_text(entry->access));
    if (entry->mappable != original->mappable)
        dcf_tell(self->report, DCF_RULE_EDS_PDO_MAPPING, entry->line,
                 "%04Xh:%02X PDOMapping: %u expected (so the EDS has it), there is %u",
                 entry->index, entry->sub, original->mappable, entry->mappable);
    if (entry->type == original->type)
        compare_values(self, entry, original);
    else
        dcf_tell(self->report, DCF_RULE_EDS_DATA_TYPE, entry->line,
                 "%04Xh:%02X DataType: %s expected (so the EDS has it), there is %s", entry->index,
                 entry->sub, od_type_name(original->type), od_type_name(entry->type));
}

/* Of an object that the EDS does not have at all only its first entry is told. */
static void tell_extra(const struct comparison *self, const struct dcf_entry *entry)
{
    bool known = dcf_has_object(self->eds, entry->index);

    if (known)
        dcf_tell(self->report, DCF_RULE_EDS_EXTRA, entry->line,
                 "%04Xh:%02X: a sub-index of the EDS expected, it does not have this one",
                 entry->index, entry->sub);
    else if (entry == self->dcf->entries || entry[-1].index != entry->index)
        dcf_tell(self->report, DCF_RULE_EDS_EXTRA, entry->line,
                 "%04Xh: an object of the EDS expected, it does not have this one", entry->index);
}

static void leave_out(struct comparison *self, const struct dcf_entry *original)
{
    if (self->left_out++ == 0)
        self->first_left_out = original;
}

static int order(const struct dcf_entry *a, const struct dcf_entry *b)
{
    if (a->index != b->index)
        return a->index < b->index ? -1 : 1;
    return (a->sub > b->sub) - (a->sub < b->sub);
}

static void walk(struct comparison *self)
{
    const struct dcf *dcf = self->dcf, *eds = self->eds;
    size_t i = 0, k = 0;

    while (i < dcf->count && k < eds->count) {
        int difference = order(&dcf->entries[i], &eds->entries[k]);

        if (difference < 0)
            tell_extra(self, &dcf->entries[i++]);
        else if (difference > 0)
            leave_out(self, &eds->entries[k++]);
        else
            compare_entries(self, &dcf->entries[i++], &eds->entries[k++]);
    }
    while (i < dcf->count)
        tell_extra(self, &dcf->entries[i++]);
    while (k < eds->count)
        leave_out(self, &eds->entries[k++]);
}

static void compare_number(const struct comparison *self, const char *name, unsigned line,
                           uint32_t number, uint32_t original)
{
    if (number != original)
        dcf_tell(self->report, DCF_RULE_EDS_IDENTITY, line,
                 "[DeviceInfo] %s: 0x%lX expected (so the EDS has it), there is 0x%lX", name,
                 (unsigned long)original, (unsigned long)number);
}

static void compare_identity(const struct comparison *self)
{
    const struct dcf *dcf = self->dcf, *eds = self->eds;

    if (dcf->vendor_number_line && eds->vendor_number_line)
        compare_number(self, "VendorNumber", dcf->vendor_number_line, dcf->vendor_number,
                       eds->vendor_number);
    if (dcf->product_number_line && eds->product_number_line)
        compare_number(self, "ProductNumber", dcf->product_number_line, dcf->product_number,
                       eds->product_number);
    if (dcf->revision_number_line && eds->revision_number_line)
        compare_number(self, "RevisionNumber", dcf->revision_number_line, dcf->revision_number,
                       eds->revision_number);
}

static void compare_name(const struct comparison *self)
{
    const char *last = self->dcf->last_eds, *name = self->eds->file_name;

    if (last && name && dcf_slice_compare(dcf_slice_of(last), dcf_slice_of(name)) != 0)
        dcf_tell(self->report, DCF_RULE_EDS_NAME, self->dcf->last_eds_line,
                 "[FileInfo] LastEDS: \"%s\" expected (FileName of the EDS), there is \"%s\"",
                 dcf_show(dcf_slice_of(name)).text, dcf_show(dcf_slice_of(last)).text);
}

void dcf_compare(const struct dcf *dcf, const struct dcf *eds, struct co_report *report)
{
    struct comparison self = {
        .dcf = dcf, .eds = eds, .report = report, .node_id = dcf->has_node_id ? dcf->node_id : 1
    };

    compare_name(&self);
    compare_identity(&self);
    walk(&self);
    if (self.left_out > 0)
        dcf_tell(report, DCF_RULE_EDS_LEFT_OUT, 0,
                 "all entries of the EDS expected, %u are missing, the first is %04Xh:%02X",
                 self.left_out, self.first_left_out->index, self.first_left_out->sub);
}

/* What the manager writes to a device, against what the device has. */
#include "audit.h"

#include "base/bytes.h"
#include "od/od.h"

#include <stdio.h>

/* --- a CCF against the device's EDS --- */

static int64_t signed_number(uint64_t number, uint8_t type)
{
    const unsigned unused = 64 - 8 * od_type_size(type);

    return od_type_signed(type) ? (int64_t)(number << unused) >> unused : (int64_t)number;
}

static bool is_integer(uint8_t type)
{
    return od_type_known(type) && od_type_size(type) != 0 && type != OD_REAL32 &&
           type != OD_REAL64 && type != OD_TIME_OF_DAY && type != OD_TIME_DIFFERENCE;
}

static bool is_beyond(const struct dcf_value *limit, uint8_t type, uint8_t node, uint64_t number,
                      bool above)
{
    uint8_t bytes[8];
    uint64_t bound;

    if (!limit->given || limit->size > sizeof bytes)
        return false;
    bound = get_le(bytes, dcf_value(limit, node, bytes));
    if (od_type_signed(type)) {
        const int64_t left = signed_number(number, type), right = signed_number(bound, type);

        return above ? left > right : left < right;
    }
    return above ? number > bound : number < bound;
}

/* Why the device will refuse this; NULL: it will not. */
static const char *refusal(const struct audit_node *self, const struct ccf_entry *entry)
{
    const struct dcf_entry *there = dcf_find(&self->description, entry->index, entry->sub);
    const uint8_t node = self->config->node_id;
    uint64_t number;

    if (!there)
        return dcf_find(&self->description, entry->index, 0)
                   ? "the object has no such sub-index (06090011h)"
                   : "there is no such object (06020000h)";
    if (there->access == OD_RO || there->access == OD_CONST)
        return "the entry is read-only (06010002h)";
    if (od_type_size(there->type) != 0 && od_type_size(there->type) != entry->size)
        return "the entry has another size (06070010h)";
    if (!is_integer(there->type))
        return NULL;
    number = get_le(entry->value, entry->size);
    if (is_beyond(&there->high, there->type, node, number, true))
        return "the value is above its high limit (06090031h)";
    if (is_beyond(&there->low, there->type, node, number, false))
        return "the value is below its low limit (06090032h)";
    return NULL;
}

static void check_writes(const struct audit_node *self)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    unsigned number = 0;

    if (!self->described || !self->config->ccf_file)
        return;
    ccf_reader_init(&reader, &self->config->ccf);
    while (ccf_read(&reader, &entry)) {
        const char *why = refusal(self, &entry);

        number++;
        if (why)
            audit_tell(
                self->network, audit_node_place(self, "CCF_File"), AUDIT_RULE_REFUSED_WRITE,
                "%s: entry %u of %s writes %lu bytes to %04Xh:%02X, but in %s %s: boot error "
                "J",
                audit_label(self).text, number, self->file, (unsigned long)entry.size, entry.index,
                entry.sub, self->description_file, why);
    }
}

/* --- objects that elements need --- */

static void need(const struct audit_node *self, bool wanted, const char *element,
                 enum audit_rule rule, uint32_t object)
{
    const uint16_t index = (uint16_t)(object >> 8);
    const uint8_t sub = object & 0xFF;

    if (wanted && audit_lacks(self, index, sub))
        audit_tell(self->network, audit_node_place(self, element), rule,
                   "%s: %s needs %04Xh:%02X, which the device does not have in %s",
                   audit_label(self).text, element, index, sub, self->description_file);
}

/* Where the configuration says so itself there is no element. */
static void check_date(const struct audit_node *self)
{
    const struct node_config *config = self->config;
    const bool by_file = config->configuration_date == 0 && audit_value(self, 0x1020, 1).written &&
                         audit_value(self, 0x1020, 1).number != 0;

    need(self, config->configuration_date != 0, "Configuration_Date", AUDIT_RULE_DATE_OBJECT,
         0x102001);
    need(self, config->configuration_date != 0, "Configuration_Time", AUDIT_RULE_DATE_OBJECT,
         0x102002);
    if (by_file && !audit_value(self, 0x1020, 2).written)
        audit_tell(self->network, audit_value(self, 0x1020, 1).place, AUDIT_RULE_DATE_OBJECT,
                   "%s: the configuration writes a date to 1020h:01, but no time to 1020h:02: it "
                   "is configured at each boot",
                   audit_label(self).text);
}

void audit_check_configuration(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++) {
        const struct audit_node *node = &self->nodes[i];
        const struct node_config *config = node->config;

        if (!config->nmt_slave || !config->auto_start_slave)
            continue;
        check_writes(node);
        check_date(node);
        need(node, config->save_configuration, "Save_Configuration", AUDIT_RULE_SAVE_OBJECT,
             0x101001);
        need(node, config->restore_sub != 0, "Restore_Configuration", AUDIT_RULE_RESTORE_OBJECT,
             0x101100u | config->restore_sub);
        need(node, config->verify_software, "NMT_Verify_Software", AUDIT_RULE_SOFTWARE_OBJECT,
             0x1F5601);
        need(node, config->allow_software_update, "NMT_Allow_Software_Update",
             AUDIT_RULE_UPDATE_OBJECT, 0x1F5001);
        need(node, config->allow_software_update, "NMT_Allow_Software_Update",
             AUDIT_RULE_UPDATE_OBJECT, 0x1F5101);
    }
}

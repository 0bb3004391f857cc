/* Nodes and their identity: what the manager compares before it configures a device. */
#include "audit.h"

#include <stdio.h>
#include <string.h>

/* --- nodes --- */

/* Why a file cannot be read has been told. */
static void check_known(const struct audit_node *self)
{
    const struct node_config *config = self->config;

    if (self->described || config->dcf_file || !self->configured)
        return;
    audit_tell(self->network, audit_node_place(self, config->ccf_file ? "CCF_File" : "Node_Id"),
               AUDIT_RULE_UNKNOWN_NODE, "%s: %s: --eds %u=FILE describes the device",
               audit_label(self).text,
               config->ccf_file ? "the default values behind its CCF_File are not known"
                                : "without DCF_File it is not known what it sends and receives",
               config->node_id);
}

static void check_role(const struct audit_node *self)
{
    const struct node_config *config = self->config;
    const char *const file = config->dcf_file ? "DCF_File" : "CCF_File";

    if (config->mandatory && !config->nmt_slave)
        audit_tell(self->network, audit_node_place(self, "NMT_Mandatory_Slave"),
                   AUDIT_RULE_MANDATORY_SLAVE,
                   "%s: NMT_Mandatory_Slave has no effect with NMT_Slave FALSE: the network starts "
                   "without it",
                   audit_label(self).text);
    if (self->file && (!config->nmt_slave || !config->auto_start_slave))
        audit_tell(self->network, audit_node_place(self, file), AUDIT_RULE_NOT_CONFIGURED,
                   "%s: %s is not written to the device: %s is FALSE", audit_label(self).text, file,
                   config->nmt_slave ? "NMT_Auto_Start_Slave" : "NMT_Slave");
}

/* As bit_rates of struct dcf has them. */
static const unsigned bit_rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };

#define RATES (sizeof bit_rates / sizeof bit_rates[0])

static void name_rates(unsigned rates, char *text, size_t size)
{
    size_t used = 0;

    text[0] = '\0';
    for (size_t i = 0; i < RATES && used < size; i++)
        if ((rates & 1u << i) != 0)
            used += (size_t)snprintf(text + used, size - used, "%s%u", used ? ", " : "",
                                     bit_rates[i]);
}

static void check_bit_rate(const struct audit_node *self)
{
    const unsigned wanted = self->network->config->baudrate;
    const unsigned rates = self->description.bit_rates;
    char text[64];

    if (!self->described || rates == 0)
        return;
    for (size_t i = 0; i < RATES; i++)
        if (bit_rates[i] == wanted && (rates & 1u << i) == 0) {
            name_rates(rates, text, sizeof text);
            audit_tell(self->network, audit_network_place(self->network, "Baudrate"),
                       AUDIT_RULE_BIT_RATE,
                       "%u kbit/s, but %s has %s only (BaudRate_%u is not 1 in %s)", wanted,
                       audit_label(self).text, text, wanted, self->description_file);
        }
}

void audit_check_nodes(struct audit_network *self)
{
    if (!self->config->nmt_master && self->node_count > 0)
        audit_tell(self, audit_network_place(self, "NMT_Master"), AUDIT_RULE_NO_MASTER,
                   "NMT_Master is FALSE: none of the nodes is booted, configured or started");
    for (size_t i = 0; i < self->node_count; i++) {
        check_known(&self->nodes[i]);
        check_role(&self->nodes[i]);
        check_bit_rate(&self->nodes[i]);
    }
}

/* --- identity --- */

struct identity { /* an element and what it is compared with */
    const char *element;
    uint16_t index;
    uint8_t sub;
    char letter;
    enum audit_rule rule;
    uint32_t expected;
    uint32_t info; /* the same in [DeviceInfo]; 0: not there */
};

/* 1018h without a DefaultValue, or with 0, says nothing; a device type of 0 is one. */
static bool tells(const struct identity *self, const struct audit_value *value)
{
    return value->known && (value->number != 0 || self->index == 0x1000);
}

static void check_identity(const struct audit_node *node, const struct identity *self)
{
    struct audit_value value = audit_value(node, self->index, self->sub);
    const struct audit_place place = audit_node_place(node, self->element);
    const char *name = node->description_file;

    if (self->expected == 0 || !node->described)
        return;
    if (!audit_has(node, self->index, self->sub)) {
        audit_tell(node->network, place,
                   self->index == 0x1000 ? AUDIT_RULE_DEVICE_TYPE : AUDIT_RULE_IDENTITY,
                   "%s: %s: the device has no %04Xh:%02X in %s: boot error %c",
                   audit_label(node).text, self->element, self->index, self->sub, name,
                   self->letter);
        return;
    }
    if (!tells(self, &value)) {
        value.number = self->info;
        value.known = self->info != 0;
    }
    if (value.known && value.number != self->expected)
        audit_tell(node->network, place, self->rule,
                   "%s: %s: 0x%X expected, %04Xh:%02X is 0x%X in %s: boot error %c",
                   audit_label(node).text, self->element, (unsigned)self->expected, self->index,
                   self->sub, (unsigned)value.number, name, self->letter);
}

static void check_node(const struct audit_node *self)
{
    const struct node_config *config = self->config;
    const struct dcf *info = &self->description;
    const struct identity rows[] = {
        { "Device_Type_Identification", 0x1000, 0, 'C', AUDIT_RULE_DEVICE_TYPE, config->device_type,
          0 },
        { "Vendor_Identification", 0x1018, 1, 'D', AUDIT_RULE_IDENTITY, config->vendor_id,
          info->vendor_number },
        { "Product_Code", 0x1018, 2, 'M', AUDIT_RULE_IDENTITY, config->product_code,
          info->product_number },
        { "Revision_Number", 0x1018, 3, 'N', AUDIT_RULE_IDENTITY, config->revision_number,
          info->revision_number },
        { "Serial_Number", 0x1018, 4, 'O', AUDIT_RULE_SERIAL_NUMBER, config->serial_number, 0 },
    };
    uint32_t any = 0;

    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_identity(self, &rows[i]);
        any |= rows[i].expected;
    }
    if (any == 0 && config->mandatory && config->nmt_slave)
        audit_tell(self->network, audit_node_place(self, "NMT_Mandatory_Slave"),
                   AUDIT_RULE_NO_IDENTITY,
                   "%s: nothing of its identity is compared: any device with this node-ID is taken "
                   "for it",
                   audit_label(self).text);
}

void audit_check_identity(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++)
        if (self->nodes[i].config->nmt_slave && self->nodes[i].config->auto_start_slave)
            check_node(&self->nodes[i]);
}

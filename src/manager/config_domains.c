#include "manager/config_domains.h"

#include "dcf/dcf.h"
#include "dcf/dcf_rules.h"

#include <stdlib.h>
#include <string.h>

#define DCF_TEXT 0x1F20u
#define CONCISE  0x1F22u
#define PROGRAM  0x1F58u

static const uint16_t domains[] = { DCF_TEXT, CONCISE, PROGRAM };

bool config_is_domain(uint16_t index)
{
    return index == PROGRAM || config_is_configuration(index);
}

bool config_is_configuration(uint16_t index)
{
    return index == DCF_TEXT || index == CONCISE;
}

/* --- the dictionary --- */

static enum co_err add_domain(struct od *od, uint16_t index, uint8_t sub)
{
    const struct od_spec spec = { .index = index, .sub = sub, .type = OD_DOMAIN, .access = OD_RW };
    struct od_entry *entry;
    enum co_err err = od_add(od, &spec, &entry);

    if (err == CO_OK)
        od_fetch(entry, CONFIG_DOMAIN_MAX);
    return err;
}

static enum co_err add_object(struct od *od, uint16_t index)
{
    enum co_err err = od_add_number(od, index, 0, OD_UNSIGNED8, OD_CONST, NETWORK_NODE_MAX);

    for (uint8_t id = 1; id <= NETWORK_NODE_MAX && err == CO_OK; id++)
        err = add_domain(od, index, id);
    return err;
}

enum co_err config_domains_fill(struct od *od)
{
    enum co_err err = CO_OK;

    for (size_t i = 0; i < sizeof domains / sizeof domains[0] && err == CO_OK; i++)
        err = add_object(od, domains[i]);
    return err;
}

/* --- read --- */

static struct slave_value bytes_or_none(const uint8_t *bytes, uint32_t size)
{
    return (struct slave_value){ bytes ? SDO_OK : SDO_NO_DATA, bytes, size };
}

struct slave_value config_domain_of_node(uint16_t index, const struct node_config *node)
{
    static const uint8_t no_entries[4] = { 0 };

    if (index == CONCISE && (!node || node->ccf.size == 0))
        return bytes_or_none(no_entries, sizeof no_entries);
    if (!node)
        return bytes_or_none(NULL, 0);
    if (index == CONCISE)
        return bytes_or_none(node->ccf.bytes, (uint32_t)node->ccf.size);
    if (index == DCF_TEXT)
        return bytes_or_none(node->dcf_text, node->dcf_text_size);
    return bytes_or_none(node->software, node->software_size);
}

/* --- write --- */

/* A copy of the bytes; none of them: NULL. */
static sdo_abort_t copy_bytes(const struct slave_value *value, uint8_t **ret_copy,
                              uint32_t *ret_size)
{
    uint8_t *copy = NULL;

    if (value->size > 0) {
        copy = malloc(value->size);
        if (!copy)
            return SDO_NO_MEMORY;
        memcpy(copy, value->bytes, value->size);
    }
    *ret_copy = copy;
    *ret_size = value->size;
    return SDO_OK;
}

static void put_configuration(struct node_config *node, const struct ccf *ccf)
{
    node->ccf = *ccf;
    node->dcf_text = NULL;
    node->dcf_text_size = 0;
    node->dcf_file = NULL;
    node->ccf_file = NULL;
}

static sdo_abort_t set_concise(struct node_config *node, const struct slave_value *value,
                               struct co_report *report)
{
    struct ccf ccf;
    enum co_err err = ccf_parse(value->bytes, value->size, report, &ccf);

    if (err == CO_ERR_MEMORY)
        return SDO_NO_MEMORY;
    if (err != CO_OK)
        return report->error_kind == CCF_TRUNCATED ? SDO_TOO_SHORT : SDO_NOT_STORED;
    put_configuration(node, &ccf);
    return SDO_OK;
}

/* The text must be one for this node on this network. */
static bool is_commissioned(const struct dcf *dcf, const struct network_config *config,
                            const struct node_config *node, struct co_report *report)
{
    if (dcf->has_node_id && dcf->node_id != node->node_id)
        dcf_tell(report, DCF_RULE_OTHER_NODE_ID, dcf->node_id_line,
                 "NodeID is %u, but this is for node %u", dcf->node_id, node->node_id);
    else if (dcf->baudrate && dcf->baudrate != config->baudrate)
        dcf_tell(report, DCF_RULE_OTHER_BIT_RATE, dcf->baudrate_line,
                 "Baudrate is %u kbit/s, but the network has %u kbit/s", dcf->baudrate,
                 config->baudrate);
    return report->errors == 0;
}

/* DownloadFile: who is on the network has no business with the files of this computer. */
static enum co_err refuse_file(void *context, const char *name, uint8_t **ret_bytes,
                               size_t *ret_size)
{
    (void)context;
    (void)name;
    (void)ret_bytes;
    (void)ret_size;
    return CO_ERR_PERMISSION;
}

static enum co_err translate(const struct slave_value *text, const struct network_config *config,
                             const struct node_config *node, struct co_report *report,
                             struct ccf *ret_ccf)
{
    const struct dcf_ccf_options options = { .node_id = node->node_id,
                                             .old_style = node->old_config_style,
                                             .read_file = refuse_file };
    struct dcf dcf;
    enum co_err err = dcf_parse((const char *)text->bytes, text->size, report, &dcf);

    if (err != CO_OK)
        return err;
    err = CO_ERR_VALUE;
    if (is_commissioned(&dcf, config, node, report))
        err = dcf_make_ccf(&dcf, &options, report, ret_ccf);
    dcf_done(&dcf);
    return err;
}

static sdo_abort_t set_text(const struct network_config *config, struct node_config *node,
                            const struct slave_value *value, struct co_report *report)
{
    struct ccf ccf;
    enum co_err err = CO_OK;

    ccf_init(&ccf);
    if (value->size > 0)
        err = translate(value, config, node, report, &ccf);
    if (err != CO_OK)
        return err == CO_ERR_MEMORY ? SDO_NO_MEMORY : SDO_NOT_STORED;
    put_configuration(node, &ccf);
    if (copy_bytes(value, &node->dcf_text, &node->dcf_text_size) == SDO_OK)
        return SDO_OK;
    ccf_done(&ccf);
    return SDO_NO_MEMORY;
}

sdo_abort_t config_domain_set_node(uint16_t index, const struct network_config *config,
                                   struct node_config *node, const struct slave_value *value,
                                   struct co_report *report)
{
    if (index == CONCISE)
        return set_concise(node, value, report);
    if (index == DCF_TEXT)
        return set_text(config, node, value, report);
    node->software_file = NULL;
    return copy_bytes(value, &node->software, &node->software_size);
}

void config_domain_free(uint16_t index, const struct node_config *replaced)
{
    struct ccf ccf = replaced->ccf;

    if (index == PROGRAM) {
        free(replaced->software_file);
        free(replaced->software);
        return;
    }
    ccf_done(&ccf);
    free(replaced->dcf_text);
    free(replaced->dcf_file);
    free(replaced->ccf_file);
}

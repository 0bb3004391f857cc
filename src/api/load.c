#include "api/load.h"

#include "api/error_map.h"
#include "api/file.h"
#include "base/bytes.h"
#include "dcf/dcf_rules.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What loading one node's file needs to know. */
struct loader {
    const char *xml_path;
    const struct network_config *config;
    struct node_config *node;
    struct co_report *xml_report;
    struct dcf *dcf;    /* NULL: only what the manager needs of it is kept */
    const char *folder; /* of the DCF, for DownloadFile */
    size_t folder_size;
};

/* Messages about another file, into the same sink, counted in the same report. */
static struct co_report report_for(const struct co_report *report, const char *file)
{
    return (struct co_report){ .file = file, .sink = report->sink, .context = report->context };
}

static void add_up(struct co_report *self, const struct co_report *other)
{
    if (self->errors == 0 && other->errors > 0)
        memcpy(self->first_error, other->first_error, sizeof self->first_error);
    self->errors += other->errors;
    self->warnings += other->warnings;
}

const struct co_rule load_file_warnings = { "file-warnings", CO_WARNING, 0, "CiA 306-1",
                                            "A DCF or EDS file is one about which dcftest has "
                                            "nothing to tell." };

static void pass_on_errors(void *context, const struct co_message *message)
{
    const struct co_report *outer = context;

    if (message->severity == CO_ERROR && outer->sink)
        outer->sink(outer->context, message);
}

/*
 * What a vendor's file does against the standard, and is read all the same, is nothing that whoever
 * boots a plant can mend; with many nodes it would hide what matters. One line tells where it is.
 */
static int parse_dcf(const char *path, const char *text, size_t size, struct co_report *report,
                     struct dcf *ret_dcf)
{
    struct co_report own = { .file = path, .sink = pass_on_errors, .context = report };
    enum co_err err = dcf_parse(text, size, &own, ret_dcf);
    unsigned warnings = own.warnings;

    own.sink = report->sink;
    own.context = report->context;
    if (warnings > 0 && err == CO_OK)
        co_report_rule(&own, &load_file_warnings, 0,
                       "%u warning%s about this file, which is used as far as it is understood: "
                       "\"dcftest %s\" shows them",
                       warnings, warnings == 1 ? "" : "s", path);
    add_up(report, &own);
    if (err == CO_OK)
        return MCANOPEN_OK;
    return err == CO_ERR_MEMORY ? CANOPEN_DCF_OUT_OF_MEMORY
                                : error_of_dcf((enum dcf_error)own.error_kind);
}

int load_dcf(const char *path, struct co_report *report, struct dcf *ret_dcf)
{
    struct co_report own = report_for(report, path);
    char *text = NULL;
    size_t size;
    enum co_err err = file_read(path, &text, &size);
    int result;

    if (err != CO_OK) {
        co_report_add(&own, CO_ERROR, 0, "%s", file_error_text(err));
        add_up(report, &own);
        return CANOPEN_DCF_INIT_ERROR;
    }
    result = parse_dcf(path, text, size, report, ret_dcf);
    free(text);
    return result;
}

/* DownloadFile: dcf/ has refused names that leave the folder. */
static enum co_err read_download_file(void *context, const char *name, uint8_t **ret_bytes,
                                      size_t *ret_size)
{
    const struct loader *self = context;
    char *path = NULL, *text = NULL;
    enum co_err err;

    if (asprintf(&path, "%.*s%s", (int)self->folder_size, self->folder, name) < 0)
        return CO_ERR_MEMORY;
    err = file_read(path, &text, ret_size);
    free(path);
    if (err == CO_OK)
        *ret_bytes = (uint8_t *)text;
    return err;
}

/* The DCF must be one for this node on this network. */
static int check_commissioning(const struct loader *self, const struct dcf *dcf,
                               struct co_report *report)
{
    if (dcf->has_node_id && dcf->node_id != self->node->node_id) {
        dcf_tell(report, DCF_RULE_OTHER_NODE_ID, dcf->node_id_line,
                 "NodeID is %u, but %s:%u configures node %u with this file", dcf->node_id,
                 self->xml_path, self->node->file_line, self->node->node_id);
        return CANOPEN_DCF_WRONG_NODE_ID;
    }
    if (dcf->baudrate && dcf->baudrate != self->config->baudrate) {
        dcf_tell(report, DCF_RULE_OTHER_BIT_RATE, dcf->baudrate_line,
                 "Baudrate is %u kbit/s, but the network in %s has %u kbit/s", dcf->baudrate,
                 self->xml_path, self->config->baudrate);
        return CANOPEN_DCF_WRONG_BAUDRATE;
    }
    return MCANOPEN_OK;
}

static int make_ccf(struct loader *self, const struct dcf *dcf, const char *path)
{
    struct co_report own = report_for(self->xml_report, path);
    const char *slash = strrchr(path, '/');
    struct dcf_ccf_options options = { .node_id = self->node->node_id,
                                       .old_style = self->node->old_config_style,
                                       .read_file = read_download_file,
                                       .context = self };
    int result = check_commissioning(self, dcf, &own);
    enum co_err err;

    self->folder = path;
    self->folder_size = slash ? (size_t)(slash - path) + 1 : 0;
    if (result == MCANOPEN_OK) {
        err = dcf_make_ccf(dcf, &options, &own, &self->node->ccf);
        if (err != CO_OK)
            result = err == CO_ERR_MEMORY ? CANOPEN_DCF_OUT_OF_MEMORY
                                          : error_of_dcf((enum dcf_error)own.error_kind);
    }
    add_up(self->xml_report, &own);
    return result;
}

static int load_node_dcf(struct loader *self, const char *path, const char *text, size_t size)
{
    struct dcf dcf;
    int result = parse_dcf(path, text, size, self->xml_report, &dcf);

    if (result != MCANOPEN_OK)
        return result;
    result = make_ccf(self, &dcf, path);
    if (self->dcf)
        *self->dcf = dcf;
    else
        dcf_done(&dcf);
    return result;
}

static int load_node_ccf(struct loader *self, const char *path, const char *text, size_t size)
{
    struct co_report own = report_for(self->xml_report, path);
    enum co_err err = ccf_parse((const uint8_t *)text, size, &own, &self->node->ccf);

    add_up(self->xml_report, &own);
    if (err == CO_OK)
        return MCANOPEN_OK;
    return err == CO_ERR_MEMORY ? CANOPEN_DCF_OUT_OF_MEMORY : CANOPEN_DCF_WRONG_PARAMETER;
}

/* A file that the XML names. Many come from machines that do not tell cases apart. */
static void tell_unread(const struct loader *self, unsigned line, const char *element,
                        const char *path, enum co_err err)
{
    struct co_report own = report_for(self->xml_report, self->xml_path);
    const char *text = file_error_text(err);
    char *alike = NULL;

    if (err == CO_ERR_NOT_FOUND)
        alike = file_find_alike(self->config, self->xml_path, path);
    co_report_add(&own, CO_ERROR, line, "%s: %s: %s%s%s", element, path, text,
                  alike ? "; there is " : "", alike ? alike : "");
    free(alike);
    add_up(self->xml_report, &own);
}

static int load_node_file(struct loader *self, const char *path)
{
    char *text = NULL;
    size_t size;
    enum co_err err = file_read(path, &text, &size);
    int result;

    if (err != CO_OK) {
        tell_unread(self, self->node->file_line, self->node->dcf_file ? "DCF_File" : "CCF_File",
                    path, err);
        return CANOPEN_DCF_INIT_ERROR;
    }
    result = self->node->dcf_file ? load_node_dcf(self, path, text, size)
                                  : load_node_ccf(self, path, text, size);
    free(text);
    return result;
}

static uint32_t ccf_number(const struct ccf *ccf, uint16_t index, uint8_t sub)
{
    struct ccf_reader reader;
    struct ccf_entry entry;
    uint32_t number = 0;

    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry))
        if (entry.index == index && entry.sub == sub && entry.size == 4)
            number = get_le32(entry.value);
    return number;
}

/* Date and time that the download does not leave in the device spare no later download. */
static void check_date(const struct loader *self)
{
    const struct node_config *node = self->node;
    struct co_report own = report_for(self->xml_report, self->xml_path);

    if (node->configuration_date == 0 || ccf_count(&node->ccf) == 0)
        return;
    if (ccf_number(&node->ccf, 0x1020, 1) != node->configuration_date ||
        ccf_number(&node->ccf, 0x1020, 2) != node->configuration_time)
        co_report_add(&own, CO_WARNING, node->line,
                      "Configuration_Date, Configuration_Time: %s does not write them to 1020h of "
                      "node %u: it will be configured at each boot, unless somebody else does",
                      node->dcf_file ? node->dcf_file : node->ccf_file, node->node_id);
    add_up(self->xml_report, &own);
}

static int read_software(const struct loader *self, const char *path)
{
    struct co_report own = report_for(self->xml_report, self->xml_path);
    char *bytes = NULL;
    size_t size;
    enum co_err err = file_read(path, &bytes, &size);

    if (err != CO_OK) {
        tell_unread(self, self->node->software_line, "Software_File", path, err);
        return CANOPEN_DCF_INIT_ERROR;
    }
    if (size == 0) {
        free(bytes);
        co_report_add(&own, CO_ERROR, self->node->software_line,
                      "Software_File: %s: the file is empty", path);
        add_up(self->xml_report, &own);
        return CANOPEN_DCF_INIT_ERROR;
    }
    self->node->software = (uint8_t *)bytes;
    self->node->software_size = (uint32_t)size;
    return MCANOPEN_OK;
}

/* The program of the device. */
static int load_software(const struct loader *self)
{
    char *path = NULL;
    int result;

    if (!self->node->software_file)
        return MCANOPEN_OK;
    if (file_find(self->config, self->xml_path, self->node->software_file, &path) != CO_OK)
        return MCAL_OBJ_NO_MEMORY;
    result = read_software(self, path);
    free(path);
    return result;
}

static int load_configuration(struct loader *self)
{
    const char *name = self->node->dcf_file ? self->node->dcf_file : self->node->ccf_file;
    char *path = NULL;
    int result;

    if (!name)
        return MCANOPEN_OK;
    if (file_find(self->config, self->xml_path, name, &path) != CO_OK)
        return MCAL_OBJ_NO_MEMORY;
    result = load_node_file(self, path);
    if (result == MCANOPEN_OK)
        check_date(self);
    free(path);
    return result;
}

int load_node(const char *xml_path, const struct network_config *config, struct node_config *node,
              struct co_report *report, struct dcf *ret_dcf)
{
    struct loader loader = {
        .xml_path = xml_path, .config = config, .node = node, .xml_report = report, .dcf = ret_dcf
    };
    int configuration = load_configuration(&loader);
    int software = load_software(&loader);

    return configuration != MCANOPEN_OK ? configuration : software;
}

/* All nodes are looked at; the first error counts. */
static int load_nodes(const char *path, struct network_config *config, struct co_report *report)
{
    int result = MCANOPEN_OK;

    for (size_t i = 0; i < config->node_count; i++) {
        int one = load_node(path, config, &config->nodes[i], report, NULL);

        if (result == MCANOPEN_OK)
            result = one;
    }
    return result;
}

int load_xml(const char *path, struct co_report *report, struct network_config **ret_networks,
             size_t *ret_count)
{
    char *text = NULL;
    size_t size;
    enum co_err err = file_read(path, &text, &size);

    report->file = path;
    if (err != CO_OK) {
        co_report_add(report, CO_ERROR, 0, "%s", file_error_text(err));
        return error_of_xml(err == CO_ERR_MEMORY ? err : CO_ERR_IO);
    }
    err = network_config_parse(text, size, report, ret_networks, ret_count);
    free(text);
    if (err == CO_ERR_VALUE && report->error_kind)
        err = (enum co_err)report->error_kind;
    return error_of_xml(err);
}

int load_networks(const char *path, struct co_report *report, struct network_config **ret_networks,
                  size_t *ret_count)
{
    struct network_config *networks = NULL;
    size_t count = 0;
    int result;

    result = load_xml(path, report, &networks, &count);
    if (result != MCANOPEN_OK)
        return result;
    for (size_t i = 0; i < count; i++) {
        int one = load_nodes(path, &networks[i], report);

        if (result == MCANOPEN_OK)
            result = one;
    }
    if (result != MCANOPEN_OK) {
        network_config_free(networks, count);
        return result;
    }
    *ret_networks = networks;
    *ret_count = count;
    return MCANOPEN_OK;
}

void load_bus_name(const struct network_config *config, char *name, size_t size)
{
    char variable[32];
    const char *from_environment;

    snprintf(variable, sizeof variable, "MCANOPEN_NET_%u", config->net);
    from_environment = getenv(variable);
    if (from_environment && from_environment[0])
        snprintf(name, size, "%s", from_environment);
    else if (config->interface)
        snprintf(name, size, "%s", config->interface);
    else
        snprintf(name, size, "can%u", config->net);
}

/* A plant from its files: as the manager reads them, but all is kept, and one error is no end. */
#include "audit.h"

#include "api/error_map.h"
#include "api/file.h"
#include "api/load.h"
#include "manager/network_config_elements.h"
#include "manager/network_config_xml.h"

#include <stdlib.h>
#include <string.h>

/* --- the lines of elements --- */

static const xmlNode *next_named(const xmlNode *node, const char *name)
{
    while (node && (node->type != XML_ELEMENT_NODE || strcmp(network_xml_name(node), name) != 0))
        node = node->next;
    return node;
}

static struct audit_place place_of(const struct audit_network *self, const xmlNode *holder,
                                   const struct element_table *table, const char *name)
{
    const struct element *row = element_find(table, name);
    const xmlNode *found = NULL;

    if (holder)
        found = next_named(holder->children, name);
    if (holder && !found && row && row->alias)
        found = next_named(holder->children, row->alias);
    if (!found)
        found = holder;
    return (struct audit_place){ self->audit->xml_path, found ? network_xml_line(found) : 0 };
}

struct audit_place audit_node_place(const struct audit_node *self, const char *element)
{
    return place_of(self->network, self->element, &node_elements, element);
}

struct audit_place audit_network_place(const struct audit_network *self, const char *element)
{
    return place_of(self, self->element, &network_elements, element);
}

/* --- one node's files --- */

static int compare(const void *a, const void *b)
{
    const struct audit_written *left = a, *right = b;

    if (left->address != right->address)
        return left->address > right->address ? 1 : -1;
    return (left->bytes > right->bytes) - (left->bytes < right->bytes);
}

/* Of several writes of an entry the last one counts. */
static size_t keep_last(struct audit_written *written, size_t count)
{
    size_t kept = 0;

    for (size_t i = 0; i < count; i++) {
        if (i + 1 < count && written[i].address == written[i + 1].address)
            continue;
        written[kept++] = written[i];
    }
    return kept;
}

static bool index_writes(struct audit_node *self)
{
    const struct ccf *ccf = &self->config->ccf;
    struct ccf_reader reader;
    struct ccf_entry entry;
    size_t count = 0;

    if (ccf_count(ccf) == 0)
        return true;
    self->written = calloc(ccf_count(ccf), sizeof *self->written);
    if (!self->written)
        return false;
    ccf_reader_init(&reader, ccf);
    while (ccf_read(&reader, &entry)) {
        struct audit_written *written = &self->written[count++];

        written->address = (uint32_t)entry.index << 8 | entry.sub;
        written->size = entry.size;
        written->bytes = entry.value;
        written->line = ccf_line(ccf, (uint32_t)count);
    }
    qsort(self->written, count, sizeof *self->written, compare);
    self->written_count = keep_last(self->written, count);
    return true;
}

/* The others can be judged as if this file were right for the node. */
static bool guess_writes(struct audit_node *self)
{
    const struct dcf_ccf_options options = { .node_id = self->config->node_id,
                                             .old_style = self->config->old_config_style };
    struct co_report silent = { .file = NULL };
    enum co_err err = dcf_make_ccf(&self->description, &options, &silent, &self->config->ccf);

    self->configured = err == CO_OK;
    return err != CO_ERR_MEMORY;
}

static struct audit_eds *find_eds(const struct audit_node *self)
{
    const struct audit *audit = self->network->audit;

    for (size_t i = 0; i < audit->eds_count; i++)
        if (audit->eds[i].node == self->config->node_id)
            return &audit->eds[i];
    return NULL;
}

static bool describe_by_eds(struct audit_node *self, const char *file)
{
    int result;

    self->description_file = strdup(file);
    if (!self->description_file)
        return false;
    result = load_dcf(file, self->network->report, &self->description);
    self->described = result == MCANOPEN_OK;
    return result != CANOPEN_DCF_OUT_OF_MEMORY;
}

static bool use_eds(struct audit_node *self)
{
    struct audit_eds *eds = find_eds(self);

    if (!eds)
        return true;
    eds->used = true;
    return self->described ? audit_compare_file(self, eds->file) : describe_by_eds(self, eds->file);
}

static bool find_file(struct audit_node *self)
{
    const struct node_config *config = self->config;
    const char *name = config->dcf_file ? config->dcf_file : config->ccf_file;

    return !name || file_find(self->network->config, self->network->audit->xml_path, name,
                              &self->file) == CO_OK;
}

static bool is_memory_error(int result)
{
    return result == MCAL_OBJ_NO_MEMORY || result == CANOPEN_DCF_OUT_OF_MEMORY;
}

static bool read_node(struct audit_node *self)
{
    const struct audit *audit = self->network->audit;
    int result = load_node(audit->xml_path, self->network->config, self->config,
                           self->network->report, &self->description);

    if (is_memory_error(result) || !find_file(self))
        return false;
    self->configured = !self->file || self->config->ccf.size > 0;
    self->described = self->file && self->description.count > 0;
    self->has_dcf = self->described;
    if (self->described) {
        self->description_file = strdup(self->file);
        if (!self->description_file || (!self->configured && !guess_writes(self)))
            return false;
    }
    return use_eds(self) && (!audit->tells_files || audit_tell_file(self)) && index_writes(self);
}

/* --- the file --- */

static bool open_nodes(struct audit_network *self)
{
    const xmlNode *network = self->element;
    const xmlNode *element = network ? network->children : NULL;

    self->nodes = calloc(self->config->node_count + 1, sizeof *self->nodes);
    if (!self->nodes)
        return false;
    for (size_t i = 0; i < self->config->node_count; i++) {
        struct audit_node *node = &self->nodes[self->node_count++];

        element = next_named(element, node_elements.parent);
        node->network = self;
        node->config = &self->config->nodes[i];
        node->element = element;
        if (!read_node(node))
            return false;
        element = element ? element->next : NULL;
    }
    return true;
}

static bool open_networks(struct audit *self, size_t count)
{
    const xmlNode *root = self->doc ? xmlDocGetRootElement(self->doc) : NULL;
    const xmlNode *element = root ? root->children : NULL;

    self->networks = calloc(count, sizeof *self->networks);
    if (!self->networks)
        return false;
    for (size_t i = 0; i < count; i++) {
        struct audit_network *network = &self->networks[i];

        element = next_named(element, network_elements.parent);
        *network = (struct audit_network){
            .audit = self, .report = self->report, .config = &self->configs[i], .element = element
        };
        if (!open_nodes(network))
            return false;
        element = element ? element->next : NULL;
    }
    return true;
}

/* The reader keeps no lines of single elements: the file is looked at once more for them. */
static bool read_lines(struct audit *self)
{
    struct co_report silent = { .file = NULL };
    struct faults faults = { .report = &silent };
    char *text = NULL;
    size_t size;

    if (file_read(self->xml_path, &text, &size) != CO_OK)
        return false;
    self->doc = network_xml_read(text, size, &faults);
    free(text);
    return !faults.no_memory;
}

static bool refuse(struct audit *self)
{
    self->report->file = self->xml_path;
    co_report_add(self->report, CO_ERROR, 0, "not checked: %s", co_err_text(CO_ERR_MEMORY));
    return false;
}

bool audit_open(struct audit *self)
{
    const unsigned errors = self->report->errors;
    size_t count = 0;

    self->doc = NULL;
    self->configs = NULL;
    self->networks = NULL;
    self->count = 0;
    if (load_xml(self->xml_path, self->report, &self->configs, &count) != MCANOPEN_OK)
        return self->report->errors == errors && refuse(self);
    self->count = count;
    if (read_lines(self) && open_networks(self, count))
        return true;
    audit_close(self);
    return refuse(self);
}

static void close_network(struct audit_network *self)
{
    for (size_t i = 0; i < self->node_count; i++) {
        struct audit_node *node = &self->nodes[i];

        free(node->file);
        free(node->description_file);
        free(node->written);
        dcf_done(&node->description);
    }
    free(self->nodes);
    free(self->pdos);
    free(self->producers);
    free(self->uses);
}

void audit_close(struct audit *self)
{
    for (size_t i = 0; self->networks && i < self->count; i++)
        close_network(&self->networks[i]);
    free(self->networks);
    network_config_free(self->configs, self->count);
    xmlFreeDoc(self->doc);
    self->doc = NULL;
    self->configs = NULL;
    self->networks = NULL;
    self->count = 0;
}

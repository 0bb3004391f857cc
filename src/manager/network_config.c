#include "manager/network_config.h"

#include "manager/network_config_check.h"
#include "manager/network_config_elements.h"
#include "manager/network_config_xml.h"

#include <stdlib.h>
#include <string.h>

struct scope {                         /* one of the elements that hold others, while it is read */
    const struct element_table *table; /* what it may hold; NULL: only the inner elements */
    const char *name, *inner;          /* inner: the element that holds others in it, or NULL */
    void *base;                        /* where the values go */
    struct element_lines lines;
};

static const char root_name[] = "CANopen_Manager";
static const char schema_space[] = "http://www.w3.org/2001/XMLSchema-instance";

/* The element's name belongs elsewhere. Returns where, or NULL. */
static const char *find_home(const char *name)
{
    if (strcmp(name, "Node_Instance") == 0)
        return network_elements.parent;
    if (strcmp(name, network_elements.parent) == 0)
        return root_name;
    if (element_find(&node_elements, name))
        return node_elements.parent;
    return element_find(&network_elements, name) ? network_elements.parent : NULL;
}

static void tell_stranger(const xmlNode *node, const struct scope *scope, struct faults *faults)
{
    const char *name = network_xml_name(node);
    const char *home = find_home(name);
    const char *nearest = scope->table ? element_nearest(scope->table, name) : NULL;
    unsigned line = network_xml_line(node);
    char excerpt[FAULTS_EXCERPT_SIZE];

    faults_excerpt(name, excerpt);
    if (home)
        faults_error(faults, CO_ERR_VALUE, line, "%s: belongs into %s, not into %s", excerpt, home,
                     scope->name);
    else if (nearest)
        faults_error(faults, CO_ERR_VALUE, line, "%s: unknown element, did you mean %s?", excerpt,
                     nearest);
    else
        faults_error(faults, CO_ERR_VALUE, line, "%s: unknown element in %s", excerpt, scope->name);
}

static bool is_of_schemas(const xmlNs *space)
{
    return space && space->prefix && strcmp((const char *)space->href, schema_space) == 0;
}

/* The root may tell editors where the schema is; nothing is looked for there. */
static bool is_for_editors(const xmlAttr *attribute)
{
    return attribute->parent->parent->type == XML_DOCUMENT_NODE && is_of_schemas(attribute->ns) &&
           strcmp((const char *)attribute->name, "noNamespaceSchemaLocation") == 0;
}

static bool has_strange_space(const xmlNode *node)
{
    const bool is_root = node->parent->type == XML_DOCUMENT_NODE;
    const xmlNs *space = node->nsDef;

    while (space && is_root && is_of_schemas(space))
        space = space->next;
    return space != NULL;
}

/* No other element of this file has attributes, and none has a prefix. */
static void check_attributes(const xmlNode *node, struct faults *faults)
{
    char element[FAULTS_EXCERPT_SIZE], excerpt[FAULTS_EXCERPT_SIZE];
    unsigned line = network_xml_line(node);

    faults_excerpt(network_xml_name(node), element);
    if (has_strange_space(node))
        faults_error(faults, CO_ERR_VALUE, line, "%s: unknown attribute xmlns", element);
    if (node->ns && node->ns->prefix)
        faults_error(faults, CO_ERR_VALUE, line, "%s: unknown with the prefix %s", element,
                     faults_excerpt((const char *)node->ns->prefix, excerpt));
    for (const xmlAttr *attribute = node->properties; attribute; attribute = attribute->next)
        if (!is_for_editors(attribute))
            faults_error(faults, CO_ERR_VALUE, line, "%s: unknown attribute %s", element,
                         faults_excerpt((const char *)attribute->name, excerpt));
}

static bool holds_only_text(const xmlNode *node, struct faults *faults)
{
    char excerpt[FAULTS_EXCERPT_SIZE];

    for (const xmlNode *child = node->children; child; child = child->next) {
        if (child->type != XML_ELEMENT_NODE)
            continue;
        faults_error(faults, CO_ERR_VALUE, network_xml_line(child),
                     "%s: a value is expected, not the element %s", network_xml_name(node),
                     faults_excerpt(network_xml_name(child), excerpt));
        return false;
    }
    return true;
}

static void read_value(const xmlNode *node, const struct element *element, struct scope *scope,
                       struct faults *faults)
{
    const size_t row = (size_t)(element - scope->table->rows);
    const unsigned errors = faults->errors;
    unsigned line = network_xml_line(node);
    char *text;

    if (scope->lines.any[row] != 0) {
        faults_error(faults, CO_ERR_VALUE, line, "%s: already given in line %u",
                     network_xml_name(node), scope->lines.any[row]);
        return;
    }
    scope->lines.any[row] = line;
    if (!holds_only_text(node, faults))
        return;
    text = network_xml_text(node, faults);
    if (text)
        element_set(element, text, line, scope->base, faults);
    xmlFree(text);
    if (faults->errors == errors)
        scope->lines.valid[row] = line;
}

static void check_stray_text(const xmlNode *node, const struct scope *scope, struct faults *faults)
{
    char *text = network_xml_text(node, faults);
    char excerpt[FAULTS_EXCERPT_SIZE];

    if (text && *text != '\0')
        faults_error(faults, CO_ERR_VALUE, network_xml_line(node),
                     "%s: there is text between the elements: '%s'", scope->name,
                     faults_excerpt(text, excerpt));
    xmlFree(text);
}

/* The next element that holds others, at or behind the child; all before it is read. */
static const xmlNode *read_until_inner(const xmlNode *child, struct scope *scope,
                                       struct faults *faults)
{
    for (; child && !faults->full; child = child->next) {
        const struct element *element;

        if (child->type == XML_TEXT_NODE || child->type == XML_CDATA_SECTION_NODE)
            check_stray_text(child, scope, faults);
        if (child->type != XML_ELEMENT_NODE)
            continue;
        check_attributes(child, faults);
        if (scope->inner && strcmp(network_xml_name(child), scope->inner) == 0)
            return child;
        element = scope->table ? element_find(scope->table, network_xml_name(child)) : NULL;
        if (element)
            read_value(child, element, scope, faults);
        else
            tell_stranger(child, scope, faults);
    }
    return NULL;
}

static unsigned valid_line(const struct scope *scope, const char *name)
{
    return scope->lines.valid[element_find(scope->table, name) - scope->table->rows];
}

static void read_node(const xmlNode *node, struct node_config *config, struct unique_lines *unique,
                      struct faults *faults)
{
    struct scope scope = { .table = &node_elements, .name = node_elements.parent, .base = config };

    config->line = network_xml_line(node);
    elements_preset(&node_elements, config);
    read_until_inner(node->children, &scope, faults);
    config->file_line = valid_line(&scope, config->dcf_file ? "DCF_File" : "CCF_File");
    config->software_line = valid_line(&scope, "Software_File");
    config->restore = config->restore_sub != 0;
    check_node(config, &scope.lines, unique, faults);
}

static bool make_room_for_nodes(struct network_config *config)
{
    if (config->nodes)
        return config->node_count < config->node_room;
    config->nodes = calloc(NETWORK_NODE_MAX, sizeof *config->nodes);
    config->node_room = config->nodes ? NETWORK_NODE_MAX : 0;
    return config->nodes != NULL;
}

static void add_node(const xmlNode *node, struct network_config *config,
                     struct unique_lines *unique, struct faults *faults)
{
    if (config->node_count == NETWORK_NODE_MAX)
        faults_error(faults, CO_ERR_VALUE, network_xml_line(node),
                     "Node_Instance: more than %u in one Manager_Instance", NETWORK_NODE_MAX);
    else if (make_room_for_nodes(config))
        read_node(node, &config->nodes[config->node_count++], unique, faults);
    else
        faults->no_memory = true;
}

static void read_network(const xmlNode *node, struct network_config *config,
                         struct unique_lines *unique, struct faults *faults)
{
    struct scope scope = { .table = &network_elements,
                           .name = network_elements.parent,
                           .inner = node_elements.parent,
                           .base = config };
    const xmlNode *inner = node->children;

    config->line = network_xml_line(node);
    elements_preset(&network_elements, config);
    while ((inner = read_until_inner(inner, &scope, faults)) != NULL) {
        add_node(inner, config, unique, faults);
        inner = inner->next;
    }
    check_network(config, &scope.lines, unique, faults);
}

struct networks { /* the result while it grows */
    struct network_config *configs;
    size_t count;
    struct unique_lines unique;
};

static void add_network(const xmlNode *node, struct networks *networks, struct faults *faults)
{
    struct network_config *configs;

    if (networks->count == NETWORK_INSTANCES) {
        faults_error(faults, CO_ERR_AGAIN, network_xml_line(node),
                     "Manager_Instance: more than %u in one file", NETWORK_INSTANCES);
        return;
    }
    configs = realloc(networks->configs, (networks->count + 1) * sizeof *configs);
    if (!configs) {
        faults->no_memory = true;
        return;
    }
    networks->configs = configs;
    configs[networks->count] = (struct network_config){ .line = 0 };
    read_network(node, &configs[networks->count++], &networks->unique, faults);
}

/* False: this is no configuration at all. */
static bool read_root(const xmlNode *root, struct networks *networks, struct faults *faults)
{
    struct scope scope = { .name = root_name, .inner = network_elements.parent };
    const xmlNode *inner = root->children;
    char excerpt[FAULTS_EXCERPT_SIZE];

    if (strcmp(network_xml_name(root), root_name) != 0) {
        faults_error(faults, CO_ERR_FORMAT, network_xml_line(root),
                     "the root element is %s, expected %s: no configuration of a CANopen manager",
                     faults_excerpt(network_xml_name(root), excerpt), root_name);
        return false;
    }
    check_attributes(root, faults);
    while ((inner = read_until_inner(inner, &scope, faults)) != NULL) {
        add_network(inner, networks, faults);
        inner = inner->next;
    }
    if (networks->count == 0)
        faults_error(faults, CO_ERR_VALUE, network_xml_line(root), "%s: %s is missing", root_name,
                     network_elements.parent);
    return true;
}

static enum co_err outcome(const struct faults *faults, bool malformed)
{
    if (faults->no_memory)
        return CO_ERR_MEMORY;
    if (faults->errors == 0)
        return CO_OK;
    return malformed ? CO_ERR_FORMAT : CO_ERR_VALUE;
}

enum co_err network_config_parse(const char *text, size_t size, struct co_report *report,
                                 struct network_config **ret_networks, size_t *ret_count)
{
    struct faults faults = { .report = report };
    struct networks networks = { .configs = NULL };
    xmlDoc *doc = network_xml_read(text, size, &faults);
    bool is_ours = doc && read_root(xmlDocGetRootElement(doc), &networks, &faults);
    enum co_err err = outcome(&faults, !is_ours);

    xmlFreeDoc(doc);
    if (err != CO_OK) {
        network_config_free(networks.configs, networks.count);
        return err;
    }
    *ret_networks = networks.configs;
    *ret_count = networks.count;
    return CO_OK;
}

static void free_network(struct network_config *config)
{
    for (size_t i = 0; i < config->node_count; i++) {
        elements_free(&node_elements, &config->nodes[i]);
        ccf_done(&config->nodes[i].ccf);
        free(config->nodes[i].software);
        free(config->nodes[i].dcf_text);
    }
    free(config->nodes);
    elements_free(&network_elements, config);
}

void network_config_free(struct network_config *networks, size_t count)
{
    for (size_t i = 0; i < count; i++)
        free_network(&networks[i]);
    free(networks);
}

const struct node_config *network_config_node(const struct network_config *self, uint8_t node_id)
{
    for (size_t i = 0; i < self->node_count; i++)
        if (self->nodes[i].node_id == node_id)
            return &self->nodes[i];
    return NULL;
}

struct node_config network_config_unlisted(uint8_t node_id)
{
    struct node_config node = { .line = 0 };

    elements_preset(&node_elements, &node);
    node.node_id = node_id;
    node.nmt_slave = false;
    node.auto_start_slave = false;
    return node;
}

static struct node_config *find_node(struct network_config *self, uint8_t node_id)
{
    for (size_t i = 0; i < self->node_count; i++)
        if (self->nodes[i].node_id == node_id)
            return &self->nodes[i];
    return NULL;
}

struct node_config *network_config_take_node(struct network_config *self, uint8_t node_id)
{
    struct node_config *node = find_node(self, node_id);

    if (node)
        return node;
    if (!make_room_for_nodes(self))
        return NULL;
    node = &self->nodes[self->node_count++];
    *node = network_config_unlisted(node_id);
    return node;
}

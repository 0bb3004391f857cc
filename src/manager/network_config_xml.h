/*
 * XML text to a tree of libxml2, with its messages as ours.
 *
 * Nothing is fetched and nothing expanded: a document type declaration ends the reading, so there
 * are no entities but the five of XML. Internal to network_config.
 */
#ifndef CO_MANAGER_NETWORK_CONFIG_XML_H
#define CO_MANAGER_NETWORK_CONFIG_XML_H

#include "manager/network_config_faults.h"

#include <libxml/tree.h>
#include <stddef.h>

/* The document, for xmlFreeDoc(); NULL: the faults tell why. */
xmlDoc *network_xml_read(const char *text, size_t size, struct faults *faults);

const char *network_xml_name(const xmlNode *node);
unsigned network_xml_line(const xmlNode *node);

/*
 * The text of an element that has no children but text, without blanks around it, for xmlFree().
 * NULL: no memory, and the faults know.
 */
char *network_xml_text(const xmlNode *node, struct faults *faults);

#endif

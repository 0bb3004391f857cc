#include "manager/network_config_xml.h"

#include "manager/network_config.h"

#include <libxml/SAX2.h>
#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* One mistake makes libxml2 stumble several times; only the first ones help. */
#define XML_MESSAGES 10u

/* libxml2 compares each attribute of a tag with all others of it. */
#define TAG_PARTS 1000u

struct reading { /* what the callbacks know, behind the parser context's _private */
    struct faults *faults;
    unsigned messages;
    bool doctype;
};

/* The first line of a message. */
static const char *first_line(const char *message, char *text, size_t size)
{
    size_t n = 0;

    for (; message[n] != '\0' && message[n] != '\n' && n < size - 1; n++)
        text[n] = message[n] >= ' ' && message[n] <= '~' ? message[n] : '?';
    while (n > 0 && (text[n - 1] == ' ' || text[n - 1] == '.'))
        n--;
    text[n] = '\0';
    return text;
}

/* What a name such as "pump & valve" needs; libxml2 tells what its parser has not found. */
static bool is_lone_ampersand(const xmlError *error)
{
    return (error->code == XML_ERR_NAME_REQUIRED ||
            error->code == XML_ERR_ENTITYREF_SEMICOL_MISSING) &&
           error->message && strstr(error->message, "EntityRef");
}

static void on_message(void *context, const xmlError *error)
{
    xmlParserCtxt *parser = context;
    struct reading *reading = parser->_private;
    unsigned line = error->line > 0 ? (unsigned)error->line : 0;
    char text[200];

    if (error->code == XML_ERR_NO_MEMORY)
        reading->faults->no_memory = true;
    if (reading->doctype || reading->messages >= XML_MESSAGES)
        return;
    reading->messages++;
    first_line(error->message ? error->message : "malformed", text, sizeof text);
    if (is_lone_ampersand(error))
        snprintf(text, sizeof text, "&amp; expected, there is a single &");
    if (error->level >= XML_ERR_ERROR)
        faults_error(reading->faults, CO_ERR_FORMAT, line, "XML: %s", text);
    else
        faults_note(reading->faults, CO_WARNING, line, "XML: %s", text);
}

static void on_doctype(void *context, const xmlChar *name, const xmlChar *external,
                       const xmlChar *system)
{
    xmlParserCtxt *parser = context;
    struct reading *reading = parser->_private;

    (void)name;
    (void)external;
    (void)system;
    faults_error(reading->faults, CO_ERR_FORMAT, (unsigned)xmlSAX2GetLineNumber(parser),
                 "XML: a document type declaration (<!DOCTYPE>) is not accepted");
    reading->doctype = true;
    xmlStopParser(parser);
}

static unsigned line_at(const char *text, const char *end)
{
    unsigned line = 1;

    for (; text < end; text++)
        line += *text == '\n';
    return line;
}

struct scan { /* of a text that nobody has parsed yet */
    unsigned parts, parts_of_tag;
    bool in_tag;
    char quote; /* that ends the value; 0: in no value */
};

static void scan_tag(struct scan *self, char c)
{
    if (self->quote != '\0') {
        self->quote = c == self->quote ? '\0' : self->quote;
    } else if (c == '"' || c == '\'') {
        self->quote = c;
    } else if (c == '=') {
        self->parts++;
        self->parts_of_tag++;
    } else if (c == '>') {
        self->in_tag = false;
    }
}

/*
 * Where there is too much of what becomes nodes of libxml2's tree, each of 100 bytes and more: "<"
 * may begin an element or a comment, "=" an attribute. NULL: nowhere. In comments there may be
 * anything, so this is a guess, but "<" always begins anew.
 */
static const char *find_excess(const char *text, size_t size)
{
    struct scan scan = { .parts = 0 };

    for (const char *at = text; at < text + size; at++) {
        const char next = at + 1 < text + size ? at[1] : '\0';

        if (*at == '<')
            scan = (struct scan){ .parts = scan.parts + (next != '/'),
                                  .in_tag = next != '!' && next != '?' };
        else if (scan.in_tag)
            scan_tag(&scan, *at);
        if (scan.parts > NETWORK_PARTS || scan.parts_of_tag > TAG_PARTS)
            return at;
    }
    return NULL;
}

/* What libxml2 would take for the end of the text, or cannot take at all. */
static bool is_readable(const char *text, size_t size, struct faults *faults)
{
    const char *nul = size > 0 ? memchr(text, '\0', size) : NULL;
    const char *excess = size <= NETWORK_FILE_SIZE ? find_excess(text, size) : NULL;

    if (size == 0)
        faults_error(faults, CO_ERR_FORMAT, 0, "the file is empty");
    else if (size > NETWORK_FILE_SIZE)
        faults_error(faults, CO_ERR_FORMAT, 0, "the file is larger than %u bytes",
                     NETWORK_FILE_SIZE);
    else if (nul)
        faults_error(faults, CO_ERR_FORMAT, line_at(text, nul),
                     "there is a NUL byte: this is no text in UTF-8");
    else if (excess)
        faults_error(faults, CO_ERR_FORMAT, line_at(text, excess),
                     "more than %u elements, or %u attributes in one: this is no configuration",
                     NETWORK_PARTS, TAG_PARTS);
    else
        return true;
    return false;
}

static xmlParserCtxt *new_parser(struct reading *reading)
{
    xmlParserCtxt *parser;

    xmlInitParser();
    parser = xmlNewParserCtxt();
    if (!parser)
        return NULL;
    parser->_private = reading;
    /* The parameter became const in libxml2 2.12: the cast serves both. */
    parser->sax->serror = (xmlStructuredErrorFunc)on_message;
    parser->sax->internalSubset = on_doctype;
    return parser;
}

xmlDoc *network_xml_read(const char *text, size_t size, struct faults *faults)
{
    const int options = XML_PARSE_NONET | XML_PARSE_BIG_LINES;
    struct reading reading = { .faults = faults };
    xmlParserCtxt *parser;
    xmlDoc *doc;

    if (!is_readable(text, size, faults))
        return NULL;
    parser = new_parser(&reading);
    if (!parser) {
        faults->no_memory = true;
        return NULL;
    }
    doc = xmlCtxtReadMemory(parser, text, (int)size, NULL, NULL, options);
    xmlFreeParserCtxt(parser);
    if (doc && faults->errors == 0)
        return doc;
    xmlFreeDoc(doc);
    if (faults->errors == 0)
        faults->no_memory = true;
    return NULL;
}

const char *network_xml_name(const xmlNode *node)
{
    return (const char *)node->name;
}

static const char blanks[] = " \t\r\n";

unsigned network_xml_line(const xmlNode *node)
{
    long line = xmlGetLineNo(node);
    const char *text = (const char *)node->content;

    /* Where a text ends: go back to where it begins. */
    if (node->type == XML_TEXT_NODE && text)
        for (text += strspn(text, blanks); *text != '\0'; text++)
            line -= *text == '\n';
    return line > 0 ? (unsigned)line : 0;
}

char *network_xml_text(const xmlNode *node, struct faults *faults)
{
    char *text = (char *)xmlNodeGetContent(node);
    size_t first, size;

    if (!text) {
        faults->no_memory = true;
        return NULL;
    }
    first = strspn(text, blanks);
    size = strlen(text + first);
    while (size > 0 && strchr(blanks, text[first + size - 1]))
        size--;
    memmove(text, text + first, size);
    text[size] = '\0';
    return text;
}

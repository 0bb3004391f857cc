#include "support/schema.h"

#include "support/config_text.h"

#include <check.h>
#include <libxml/parser.h>
#include <libxml/xmlschemas.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define SCHEMA     TEST_DATA_DIR "/../../docs/network.xsd"
#define XSI        "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance'"
#define TEXT(text) text, sizeof text - 1
#define MORE(...)  NET("<Node_Instance>" __VA_ARGS__ "</Node_Instance>")

const struct schema_difference schema_differences[] = {
    { "is the manager's own (default of Manager_Node_Id)",
      "a default counts for nothing in identity constraints",
      TEXT(MORE("<Node_Id>127</Node_Id>")) },
    { "Configuration_Date: needs Configuration_Time", "one element cannot ask for another",
      TEXT(NODE("<Configuration_Date>1</Configuration_Date>")) },
    { "Configuration_Time: needs Configuration_Date", "one element cannot ask for another",
      TEXT(NODE("<Configuration_Time>1</Configuration_Time>")) },
    { "is out of range 0..31 (Native_Thread_Priorities is FALSE)",
      "the range depends on another element",
      TEXT(NET("<Manager_Thread_Priorities>1:2:32</Manager_Thread_Priorities>")) },
    { "belongs to other services, or is no identifier", "these are no range",
      TEXT(NET("<Sync_Cob_Id>0x581</Sync_Cob_Id>")) },
    { "Node_Id: 5 is already given", "5 and 0x5 are other texts",
      TEXT(NET(ONE "<Node_Instance><Node_Id>0x5</Node_Id></Node_Instance>")) },
    { "Node_Id: 5 is the manager's own (Manager_Node_Id", "5 and 0x5 are other texts",
      TEXT(NET("<Manager_Node_Id>0x5</Manager_Node_Id>" ONE)) },
    { "' is too long", "it counts characters, not bytes", NULL, 0 },
    { "unknown attribute xmlns", "to a schema this is no attribute",
      TEXT(NET("<Name xmlns:a='urn:a'>a</Name>")) },
    { "unknown attribute noNamespaceSchemaLocation", "any element may have it",
      TEXT(NET("<Name " XSI " xsi:noNamespaceSchemaLocation='a.xsd'>a</Name>")) },
    { "unknown attribute schemaLocation", "any element may have it",
      TEXT("<CANopen_Manager " XSI " xsi:schemaLocation='urn:a a.xsd'><Manager_Instance>"
           "<Net_No>0</Net_No><Baudrate>500</Baudrate></Manager_Instance></CANopen_Manager>") },
    { "a document type declaration (<!DOCTYPE>) is not accepted", "it does not see that",
      TEXT("<!DOCTYPE CANopen_Manager>\n" NET(ONE)) },
    { "this is no text in UTF-8", "it does not see the encoding", NULL, 0 },
    { "the file is larger than", "it does not see the size", NULL, 0 },
    { "too many messages", "it has no warnings", NULL, 0 },
};
const size_t schema_difference_count = sizeof schema_differences / sizeof *schema_differences;

static xmlSchema *schema;

void schema_load(void)
{
    xmlSchemaParserCtxt *parser = xmlSchemaNewParserCtxt(SCHEMA);

    ck_assert_ptr_nonnull(parser);
    schema = xmlSchemaParse(parser);
    xmlSchemaFreeParserCtxt(parser);
    ck_assert_ptr_nonnull(schema);
}

void schema_free(void)
{
    xmlSchemaFree(schema);
}

static void ignore(void *context, const char *format, ...)
{
    (void)context;
    (void)format;
}

bool schema_takes(const char *text, size_t size)
{
    xmlDoc *doc = xmlReadMemory(text, (int)size, NULL, NULL,
                                XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
                                    XML_PARSE_NOENT);
    xmlSchemaValidCtxt *context;
    int result;

    if (!doc)
        return false;
    context = xmlSchemaNewValidCtxt(schema);
    ck_assert_ptr_nonnull(context);
    xmlSchemaSetValidErrors(context, ignore, ignore, NULL);
    result = xmlSchemaValidateDoc(context, doc);
    xmlSchemaFreeValidCtxt(context);
    ck_assert_int_ge(result, 0);
    xmlFreeDoc(doc);
    return result == 0;
}

bool reader_takes(const char *text, size_t size)
{
    struct config_result *result = config_parse_bytes(text, size);

    network_config_free(result->networks, result->count);
    return result->err == CO_OK;
}

static bool is_listed(const char *message, size_t size)
{
    for (size_t i = 0; i < schema_difference_count; i++)
        if (memmem(message, size, schema_differences[i].message,
                   strlen(schema_differences[i].message)))
            return true;
    return false;
}

/* Errors of the reader for which the schema has no excuse. */
static unsigned plain_errors(const char *messages)
{
    unsigned count = 0;

    for (const char *end; (end = strchr(messages, '\n')) != NULL; messages = end + 1)
        count += memmem(messages, (size_t)(end - messages), " error: ", 8) &&
                 !is_listed(messages, (size_t)(end - messages));
    return count;
}

bool schema_agrees(const char *text)
{
    const size_t size = strlen(text);
    const bool valid = schema_takes(text, size);
    struct config_result *result = config_parse_bytes(text, size);

    network_config_free(result->networks, result->count);
    ck_assert_msg(valid || result->err != CO_OK, "the schema refuses what the reader takes:\n%s",
                  text);
    ck_assert_msg(!valid || plain_errors(result->messages) == 0,
                  "the schema takes what the reader refuses:\n%s%s", text, result->messages);
    return valid;
}

void schema_put(struct schema_text *self, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    self->size += (size_t)vsnprintf(self->bytes + self->size, SCHEMA_TEXT_SIZE - self->size, format,
                                    args);
    va_end(args);
    ck_assert_uint_lt(self->size, SCHEMA_TEXT_SIZE);
}

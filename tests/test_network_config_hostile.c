#include "support/config_text.h"

#include <check.h>
#include <libxml/parser.h>
#include <libxml/xmlIO.h>
#include <libxml/xmlmemory.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The words are libxml2's and change with its version; the place does not. */
static const struct malformed {
    const char *text, *begin;
} malformed[] = {
    { "<CANopen_Manager>\n<Manager_Instance>\n</CANopen_Manager>\n", "3: error: XML: " },
    { "<a:CANopen_Manager/>", "1: error: XML: " },
    { NET("<Name>&b;</Name>\n" ONE), "5: error: XML: " },
    { NET("<Name>pump & valve</Name>\n" ONE),
      "5: error: XML: &amp; expected, there is a single &" },
    { NET("<Name>pump&valve</Name>\n" ONE), "5: error: XML: &amp; expected, there is a single &" },
    { NET("<Name>\xFF\xFE</Name>\n" ONE), "5: error: XML: " },
    { NET("<Name>a&#0;b</Name>\n" ONE), "5: error: XML: " },
    { NET("<Name>a\x01</Name>\n" ONE), "5: error: XML: " },
    { NET("<Name a='1' a='2'>x</Name>\n" ONE), "5: error: XML: " },
    { NET(ONE) "<more/>", "8: error: XML: " },
    { NET(ONE) "\nmore", "9: error: XML: " },
    { "<?xml version=\"1.0\" encoding=\"none-such\"?>\n" NET(ONE), "1: error: XML: " },
    { "plain text", "1: error: XML: " },
    { "\xFF\xFE<", "1: error: XML: " },
    { " ", "1: error: XML: " },
};

START_TEST(test_malformed)
{
    const char *begin = malformed[_i].begin;
    struct config_result *result = config_parse(malformed[_i].text);

    ck_assert_msg(strncmp(result->messages, begin, strlen(begin)) == 0, "%s", result->messages);
    ck_assert_int_eq(result->err, CO_ERR_FORMAT);
    ck_assert_int_eq(result->report.error_kind, CO_ERR_FORMAT);
    ck_assert_uint_le(result->report.errors, 10);
    ck_assert_ptr_null(result->networks);
}
END_TEST

/* Sends stderr to a file and back; what was written, in bytes. */
static FILE *muffled;
static int kept_stderr;

static void muffle_stderr(void)
{
    fflush(stderr);
    muffled = tmpfile();
    kept_stderr = dup(STDERR_FILENO);
    ck_assert_ptr_nonnull(muffled);
    dup2(fileno(muffled), STDERR_FILENO);
}

static long restore_stderr(void)
{
    long size;

    fflush(stderr);
    dup2(kept_stderr, STDERR_FILENO);
    close(kept_stderr);
    fseek(muffled, 0, SEEK_END);
    size = ftell(muffled);
    fclose(muffled);
    return size;
}

START_TEST(test_nothing_on_stderr)
{
    muffle_stderr();
    for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++)
        config_parse(malformed[i].text);
    ck_assert_int_eq(restore_stderr(), 0);
}
END_TEST

static long allocations_left = -1; /* of libxml2, then one fails; negative: none does */

static void *poor_malloc(size_t size)
{
    return allocations_left-- == 0 ? NULL : malloc(size);
}

static void *poor_realloc(void *old, size_t size)
{
    return allocations_left-- == 0 ? NULL : realloc(old, size);
}

static char *poor_strdup(const char *text)
{
    return allocations_left-- == 0 ? NULL : strdup(text);
}

/* One failing allocation of libxml2, whichever: said, or without effect; never half a result. */
START_TEST(test_no_memory)
{
    unsigned failures = 0;

    ck_assert_int_eq(xmlMemSetup(free, poor_malloc, poor_realloc, poor_strdup), 0);
    muffle_stderr(); /* libxml2 complains there when it is out of memory */
    for (long n = 0; n < 1000; n++) {
        struct config_result *result;

        allocations_left = n;
        result = config_parse(NODE("<Name>pump</Name>\n"));
        failures += result->err == CO_ERR_MEMORY;
        ck_assert(result->err == CO_ERR_MEMORY || result->err == CO_OK);
        if (result->err == CO_OK)
            ck_assert_str_eq(result->networks->nodes[0].name, "pump");
        network_config_free(result->networks, result->count);
        if (allocations_left >= 0)
            break;
    }
    restore_stderr();
    ck_assert_uint_gt(failures, 10);
    ck_assert_int_ge(allocations_left, 0);
    allocations_left = -1;
}
END_TEST

/* A file cut off anywhere is malformed, but for its last line end. */
START_TEST(test_truncated)
{
    static const char text[] = "<?xml version=\"1.0\"?>\n" NODE(
        "<!-- a --><Name><![CDATA[b]]>&amp;</Name>\n<Guard_Time>0x10</Guard_Time>\n");

    for (size_t size = 0; size < sizeof text - 2; size++) {
        struct config_result *result = config_parse_bytes(text, size);

        ck_assert_int_eq(result->err, CO_ERR_FORMAT);
        ck_assert_uint_ge(result->report.errors, 1);
    }
}
END_TEST

START_TEST(test_nul)
{
    static const char text[] = "<CANopen_Manager>\n<Manager_Instance>\0</Manager_Instance>";
    struct config_result *result = config_parse_bytes(text, sizeof text - 1);

    ck_assert_str_eq(result->messages, "2: error: there is a NUL byte: this is no text in UTF-8\n");
    ck_assert_int_eq(result->err, CO_ERR_FORMAT);
}
END_TEST

/* begin, count times unit, end */
static char *repeat(const char *begin, const char *unit, size_t count, const char *end)
{
    size_t size = strlen(unit);
    char *text = malloc(strlen(begin) + count * size + strlen(end) + 1);
    char *place;

    ck_assert_ptr_nonnull(text);
    place = stpcpy(text, begin);
    for (size_t i = 0; i < count; i++, place += size)
        memcpy(place, unit, size);
    strcpy(place, end);
    return text;
}

static struct config_result *parse_repeated(const char *begin, const char *unit, size_t count,
                                            const char *end)
{
    char *text = repeat(begin, unit, count, end);
    struct config_result *result = config_parse(text);

    free(text);
    return result;
}

static const char head[] = "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No>"
                           "<Baudrate>500</Baudrate>";
static const char tail[] = "</Manager_Instance></CANopen_Manager>";

START_TEST(test_deep_nesting)
{
    struct config_result *result = parse_repeated(head, "<a>", 1000000, "");

    ck_assert_int_eq(result->err, CO_ERR_FORMAT);
    ck_assert_uint_le(result->report.errors, 10);
}
END_TEST

START_TEST(test_too_large)
{
    char expected[100];
    struct config_result *result = parse_repeated(head, "    ", NETWORK_FILE_SIZE / 4, tail);

    snprintf(expected, sizeof expected, " error: the file is larger than %u bytes\n",
             NETWORK_FILE_SIZE);
    ck_assert_str_eq(result->messages, expected);
    ck_assert_int_eq(result->err, CO_ERR_FORMAT);
}
END_TEST

START_TEST(test_long_text)
{
    char *begin = repeat(head, "", 0, "<Name>");
    char *end = repeat("</Name>" ONE, "", 0, tail);
    struct config_result *result = parse_repeated(begin, "a", 4095, end);

    ck_assert_int_eq(result->err, CO_OK);
    ck_assert_uint_eq(strlen(result->networks->name), 4095);
    network_config_free(result->networks, 1);
    result = parse_repeated(begin, "a", 4000000, end);
    ck_assert_str_eq(result->messages, "1: error: Name: 'aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa"
                                       "aaaa...' is too long\n");
    free(begin);
    free(end);
}
END_TEST

START_TEST(test_long_name)
{
    char *begin = repeat(head, "", 0, "\n<Net_No");
    struct config_result *result = parse_repeated(begin, "o", 40000,
                                                  "/></Manager_Instance>"
                                                  "</CANopen_Manager>");
    static const char expected[] = "2: error: Net_Nooooooooooooooooooooooooooooooooooooooo...: "
                                   "unknown element in Manager_Instance\n";

    ck_assert_int_eq(strncmp(result->messages, expected, sizeof expected - 1), 0);
    free(begin);
}
END_TEST

/* As many messages as there may be, and one that says so. */
START_TEST(test_too_many_messages)
{
    static const char last[] = "\n error: too many messages, the rest is left out\n";
    struct config_result *result = parse_repeated(head, "<a/>\n", 1000, tail);

    ck_assert_uint_eq(result->report.errors, NETWORK_MESSAGES + 1);
    ck_assert_int_eq(result->err, CO_ERR_VALUE);
    ck_assert_str_eq(result->messages + strlen(result->messages) - (sizeof last - 1), last);
}
END_TEST

/* What would be a tree of hundreds of MiB, or take libxml2 minutes, is not begun. */
static const struct excess {
    const char *begin, *unit, *end, *message;
    size_t count; /* of units: as many as there may be */
} excesses[] = {
    { "<a>", "<b/>", "</a>", "the root element is a", NETWORK_PARTS - 1 },
    { "<a>", "<b>c</b>", "</a>", "the root element is a", NETWORK_PARTS - 1 },
    { "<a>\n", "<!---->", "</a>", "the root element is a", NETWORK_PARTS - 1 },
    { "<a>\n", "<?b?>", "</a>", "the root element is a", NETWORK_PARTS - 1 },
    { "<a>\n", "<![CDATA[]]>", "</a>", "the root element is a", NETWORK_PARTS - 1 },
    { "<a ", "b='' ", "/>", "XML: ", 1000 },
    { "<a>\n<b ", "c='>'\n", "/></a>", "XML: ", 1000 },
    { "<a><!-- <b \" --><b ", "c='' ", "/></a>", "XML: ", 1000 },
    { "<a ", "xmlns:b='' ", "/>", "XML: ", 1000 },
};

START_TEST(test_excess)
{
    static const char expected[] = ": error: more than 200000 elements, or 1000 attributes in one: "
                                   "this is no configuration\n";
    const struct excess *it = &excesses[_i];
    struct config_result *result = parse_repeated(it->begin, it->unit, it->count, it->end);

    ck_assert_ptr_nonnull(strstr(result->messages, it->message));
    result = parse_repeated(it->begin, it->unit, it->count + 1, it->end);
    ck_assert_msg(strstr(result->messages, expected) != NULL, "%s", result->messages);
    ck_assert_int_eq(result->err, CO_ERR_FORMAT);
    ck_assert_uint_eq(result->report.errors, 1);
}
END_TEST

/* Rulers in comments and in values are none. */
START_TEST(test_no_excess)
{
    char *begin = repeat(head, "<!-- ", 1, "");
    struct config_result *result = parse_repeated(
        begin, "=", 300000, " -->" ONE "</Manager_Instance></CANopen_Manager>");

    ck_assert_str_eq(result->messages, "");
    network_config_free(result->networks, result->count);
    free(begin);
    begin = repeat(head, "<Name>", 1, "");
    result = parse_repeated(begin, "=", 4095,
                            "</Name>" ONE "</Manager_Instance></CANopen_Manager>");
    ck_assert_str_eq(result->messages, "");
    network_config_free(result->networks, result->count);
    free(begin);
}
END_TEST

START_TEST(test_too_many_warnings)
{
    struct config_result *result = parse_repeated(
        head, "<Node_Instance><NMT_Slave>true</NMT_Slave></Node_Instance>", 1000, tail);

    ck_assert_uint_eq(result->report.errors + result->report.warnings, NETWORK_MESSAGES + 1);
    ck_assert_int_eq(result->err, CO_ERR_VALUE);
}
END_TEST

START_TEST(test_too_many_nodes)
{
    char text[20000] = "";
    size_t used = 0;
    struct config_result *result;

    for (unsigned id = 1; id <= 126; id++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "<Node_Instance><Node_Id>%u</Node_Id></Node_Instance>", id);
    result = parse_repeated(head, text, 1, tail);
    ck_assert_str_eq(result->messages, "");
    ck_assert_uint_eq(result->networks->node_count, 126);
    network_config_free(result->networks, 1);
    strcat(text, ONE "<Node_Instance><Node_Id>6</Node_Id></Node_Instance>");
    result = parse_repeated(head, text, 1, tail);
    ck_assert_str_eq(result->messages, "1: error: Node_Id: 5 is already given in line 1\n2: error: "
                                       "Node_Instance: more than 127 in one Manager_Instance\n");
}
END_TEST

START_TEST(test_too_many_networks)
{
    char text[4000] = "<CANopen_Manager>\n";
    size_t used = strlen(text);
    struct config_result *result;

    for (unsigned net = 0; net <= NETWORK_INSTANCES; net++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "<Manager_Instance><Net_No>%u</Net_No><Baudrate>10</Baudrate>" ONE
                                 "</Manager_Instance>",
                                 net);
    strcat(text, "</CANopen_Manager>");
    result = config_parse(text);
    ck_assert_str_eq(result->messages, "18: error: Manager_Instance: more than 16 in one file\n");
}
END_TEST

/* libxml2 counts to 65535 unless it is asked for more. */
START_TEST(test_big_lines)
{
    struct config_result *result = parse_repeated(head, "\n", 100000,
                                                  "<Boot_Time>1</Boot_Time>\n<x>1</x>\n<y/>" ONE
                                                  "</Manager_Instance></CANopen_Manager>");

    ck_assert_str_eq(result->messages,
                     "100001: error: Boot_Time: 1 is out of range 0 or 100..65535\n"
                     "100002: error: x: unknown element in Manager_Instance\n"
                     "100003: error: y: unknown element in Manager_Instance\n");
}
END_TEST

/* Documents that ask for more than there is in them, and what is said of it. */
#define XSI   "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance'"
#define PLACE "file:///etc/hostname"
static const struct asking {
    const char *text, *message; /* NULL: it is read, and nothing else */
} asking[] = {
    { "<!DOCTYPE a SYSTEM '" PLACE "'>\n" NET(ONE), "1: error: XML: a document type" },
    { "<!DOCTYPE a PUBLIC 'a' 'http://none.invalid/a.dtd'>\n" NET(ONE),
      "1: error: XML: a document type" },
    { "<!DOCTYPE a [<!ENTITY b SYSTEM '" PLACE "'>]>\n" NET("<Name>&b;</Name>" ONE),
      "1: error: XML: a document type" },
    { "<!DOCTYPE a [<!ENTITY % b SYSTEM '" PLACE "'> %b;]>\n" NET(ONE),
      "1: error: XML: a document type" },
    { "<!DOCTYPE a [<!ENTITY b 'bbbbbbbbbb'><!ENTITY c '&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;'>"
      "<!ENTITY d '&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;'><!ENTITY e '&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;'>"
      "<!ENTITY f '&e;&e;&e;&e;&e;&e;&e;&e;&e;&e;'><!ENTITY g '&f;&f;&f;&f;&f;&f;&f;&f;&f;&f;'>"
      "<!ENTITY h '&g;&g;&g;&g;&g;&g;&g;&g;&g;&g;'><!ENTITY i '&h;&h;&h;&h;&h;&h;&h;&h;&h;&h;'>]>"
      "\n" NET("<Name>&i;</Name>" ONE),
      "1: error: XML: a document type" },
    { NET("<xi:include href='" PLACE "' parse='text' "
          "xmlns:xi='http://www.w3.org/2001/XInclude'/>" ONE),
      "5: error: include: unknown attribute xmlns" },
    { NET("<Name xml:base='" PLACE "'>a</Name>" ONE), "5: error: Name: unknown attribute base" },
    { "<?xml version='1.0'?><?xml-model href='" PLACE "'?>\n"
      "<?xml-stylesheet type='text/xsl' href='" PLACE "'?>\n" NET(ONE),
      NULL },
    { "<CANopen_Manager " XSI " xsi:noNamespaceSchemaLocation='" PLACE "'><Manager_Instance>"
      "<Net_No>0</Net_No><Baudrate>500</Baudrate>" ONE "</Manager_Instance></CANopen_Manager>",
      NULL },
};

static unsigned openings;

static int count_opening(const char *name)
{
    (void)name;
    openings++;
    return 0;
}

static xmlParserInput *count_entity(const char *url, const char *id, xmlParserCtxt *parser)
{
    (void)url;
    (void)id;
    (void)parser;
    openings++;
    return NULL;
}

START_TEST(test_nothing_is_fetched)
{
    const char *message = asking[_i].message;
    struct config_result *result;

    ck_assert_int_ge(xmlRegisterInputCallbacks(count_opening, NULL, NULL, NULL), 0);
    xmlSetExternalEntityLoader(count_entity);
    result = config_parse(asking[_i].text);
    ck_assert_uint_eq(openings, 0);
    ck_assert_int_eq(result->err == CO_OK, message == NULL);
    ck_assert_msg(strncmp(result->messages, message ? message : "",
                          message ? strlen(message) : sizeof result->messages) == 0,
                  "%s", result->messages);
    network_config_free(result->networks, result->count);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("network_config_hostile");
    TCase *all = tcase_create("all");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_set_timeout(all, 30);
    tcase_add_loop_test(all, test_malformed, 0, (int)(sizeof malformed / sizeof *malformed));
    tcase_add_test(all, test_nothing_on_stderr);
    tcase_add_test(all, test_no_memory);
    tcase_add_test(all, test_truncated);
    tcase_add_test(all, test_nul);
    tcase_add_test(all, test_deep_nesting);
    tcase_add_test(all, test_too_large);
    tcase_add_test(all, test_long_text);
    tcase_add_test(all, test_long_name);
    tcase_add_test(all, test_too_many_messages);
    tcase_add_loop_test(all, test_excess, 0, (int)(sizeof excesses / sizeof *excesses));
    tcase_add_test(all, test_no_excess);
    tcase_add_test(all, test_too_many_warnings);
    tcase_add_test(all, test_too_many_nodes);
    tcase_add_test(all, test_too_many_networks);
    tcase_add_test(all, test_big_lines);
    tcase_add_loop_test(all, test_nothing_is_fetched, 0, (int)(sizeof asking / sizeof *asking));
    suite_add_tcase(suite, all);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/*
 * docs/network.xsd, the schema for editors, takes what the reader takes: for each element of the
 * reader's table, for documents that are wrong as a whole, and for all that are here as files.
 */
#include "manager/network_config_elements.h"
#include "support/config_text.h"
#include "support/schema.h"
#include "support/suite.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PROJECT TEST_DATA_DIR "/../.."

/* A document with this in its network, and this in its only node, but for an element that is
 * mandatory otherwise. */
static bool agree_with(const char *without, const char *in_network, const char *in_node)
{
    static struct schema_text text;

    text.size = 0;
    schema_put(&text, "<CANopen_Manager>\n<Manager_Instance>\n");
    if (strcmp(without, "Net_No") != 0)
        schema_put(&text, "<Net_No>3</Net_No>\n");
    if (strcmp(without, "Baudrate") != 0)
        schema_put(&text, "<Baudrate>250</Baudrate>\n");
    schema_put(&text, "%s<Node_Instance>\n%s", in_network, in_node);
    if (strcmp(without, "Node_Id") != 0)
        schema_put(&text, "<Node_Id>5</Node_Id>\n");
    schema_put(&text, "</Node_Instance>\n</Manager_Instance>\n</CANopen_Manager>\n");
    return schema_agrees(text.bytes);
}

struct place { /* of an element that is tested */
    const struct element_table *table;
    const struct element *row;
    const char *name;
};

static bool agree_on(const struct place *place, const char *inside)
{
    const bool in_node = place->table == &node_elements;

    return agree_with(place->row->mandatory ? place->row->name : "", in_node ? "" : inside,
                      in_node ? inside : "");
}

static bool agree_on_value(const struct place *place, const char *value)
{
    static struct schema_text inside;

    inside.size = 0;
    schema_put(&inside, "<%s>%s</%s>\n", place->name, value, place->name);
    return agree_on(place, inside.bytes);
}

/* ---- each element ---- */

static const char *const values[] = {
    "",
    " ",
    "\n",
    "0",
    "1",
    "127",
    "128",
    "255",
    "256",
    "100",
    "65535",
    "65536",
    "4294967295",
    "4294967296",
    "18446744073709551616",
    "99999999999999999999999999",
    "-0",
    "-1",
    "+1",
    "--1",
    "00000000000000000000000000000000000001",
    "0x00000000000000000000000000000000000001",
    "0x",
    "0X7f",
    "0x7F",
    "0xFFFFFFFF",
    "0x100000000",
    "-0x0",
    "-0x1",
    "0xG",
    "x10",
    "10h",
    "$10",
    "0b1",
    "1 2",
    "1,0",
    "1.0",
    "1e1",
    " \t\r\n10\n ",
    "0 10",
    "\xD9\xA1",
    "\xC2\xA0"
    "1",
    "TRUE",
    "FALSE",
    "true",
    "False",
    " tRuE\n",
    "TRUEE",
    "TRUE FALSE",
    "yes",
    "RESET_SLAVE",
    "RESET_ALL",
    "STOP_ALL",
    "\tSTOP_ALL ",
    "reset_all",
    "STOP_ALLL",
    "RESET ALL",
    "1:2:3",
    "1:2:3:4",
    "1:2",
    "1:2:3:4:5",
    ":1:2:3",
    "1:2:3:",
    "1::3",
    " 1 : 2:\n3 ",
    "1 1:2:3",
    "0x1:0x2:0x1f",
    "-1:2:3",
    "a:b:c",
    "a text",
    "a  text ",
    "\n a text \n",
    "a\ntext",
    "a\ttext",
    "a\rtext",
    "a&#13;text",
    "a&#10;text",
    "&#127;",
    "a&#127;",
    "&#128;",
    "&lt;&amp;&gt;&quot;&apos;",
    "&#x31;0",
    "\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80",
    "<![CDATA[10]]>",
    "1<![CDATA[0]]>",
    "<![CDATA[ ]]>",
    "<!-- 5 -->10",
    "1<!-- 5 -->0",
    "<!-- 5 -->",
    "<?a 5?>10",
    "<Net_No>10</Net_No>",
    "10<a/>",
    "<a>10</a>",
};

static void test_values(const struct place *place)
{
    for (size_t i = 0; i < sizeof values / sizeof *values; i++)
        agree_on_value(place, values[i]);
}

/* In decimal and both kinds of hexadecimal digits, with and without more zeros. */
static bool agree_on_number(const struct place *place, int64_t number)
{
    static const char *const forms[] = { "%lld", "0x%llx", "0X%llX", "0x000%llX" };
    char value[40];
    bool accepted = false;

    for (size_t i = 0; i < sizeof forms / sizeof *forms && (number >= 0 || i == 0); i++) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        snprintf(value, sizeof value, forms[i], (long long)number);
#pragma GCC diagnostic pop
        accepted = agree_on_value(place, value);
    }
    return accepted;
}

static void test_range(const struct place *place)
{
    const struct element *row = place->row;
    const bool is_cob_id = strcmp(row->name, "Sync_Cob_Id") == 0;
    const uint32_t high = is_cob_id ? 0x57F : row->high; /* see the differences */

    ck_assert(agree_on_number(place, high));
    ck_assert(is_cob_id || agree_on_number(place, row->low));
    ck_assert(!agree_on_number(place, (int64_t)row->low - 1) || row->preset + 1 == row->low);
    ck_assert(!agree_on_number(place, (int64_t)row->high + 1));
    if (!row->mandatory && row->preset != 0)
        ck_assert(agree_on_number(place, row->preset));
    for (int64_t number = 2; number < (int64_t)1 << 36 && !is_cob_id; number *= 2) {
        agree_on_number(place, number - 1);
        agree_on_number(place, number);
    }
}

static void test_bit_rates(const struct place *place)
{
    for (int64_t number = -1; number < 1100; number++)
        agree_on_number(place, number);
}

/* Native, so that all numbers of 16 bits may come; without, the reader is narrower. */
static void test_lists(const struct place *place)
{
    static const int numbers[] = { -32769, -32768, -32767, -4096, -1000, -1,    0,     9,
                                   10,     999,    1000,   10000, 29999, 32766, 32767, 32768 };
    static struct schema_text inside;

    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        for (unsigned form = 0; form < 2; form++) {
            inside.size = 0;
            schema_put(&inside, "<Native_Thread_Priorities>TRUE</Native_Thread_Priorities><%s>1: ",
                       place->name);
            schema_put(&inside, form ? "%s0X%x:3" : "%s%d:3", numbers[i] < 0 && form ? "-" : "",
                       form ? abs(numbers[i]) : numbers[i]);
            schema_put(&inside, "%s</%s>", place->row->size == 6 ? "" : ": 4", place->name);
            ck_assert(agree_on(place, inside.bytes) ==
                      (numbers[i] >= INT16_MIN && numbers[i] <= INT16_MAX));
        }
}

static void test_long_text(const struct place *place)
{
    static char value[4097];

    memset(value, 'a', 4096);
    ck_assert(!agree_on_value(place, value));
    value[4095] = '\0';
    ck_assert(agree_on_value(place, value));
}

static const char *good_value(const struct element *row)
{
    switch (row->kind) {
    case ELEMENT_NUMBER: return "100";
    case ELEMENT_BITRATE: return "100";
    case ELEMENT_INT16: return row->size == 6 ? "1:2:3" : "1:2:3:4";
    case ELEMENT_BOOL: return "FALSE";
    case ELEMENT_ASCII: return "a";
    case ELEMENT_ACTION: return "STOP_ALL";
    }
    return "";
}

/* Each with the element's name, its value, and the name again: what is wrong with it? */
static const char *const frames[] = {
    "<%s a='b'>%s</%s>",
    "<%s xml:space='preserve'>%s</%s>",
    "<a/><%s>%s</%s>",
    "text <%s>%s</%s>",
    "<%s>%s</%s> text",
    "<![CDATA[text]]><%s>%s</%s>",
    "<%s/><!-- %s %s -->",
    "<%s>%s</%s><Node_Id/>",
    "<%s>%s</%s><Net_No/>",
    "<Node_Instance><%s>%s</%s></Node_Instance>",
    "<Manager_Instance><%s>%s</%s></Manager_Instance>",
    "<%s.>%s</%s.>",
    "<_%s>%s</_%s>",
};

static void test_frames(const struct place *place)
{
    const char *value = good_value(place->row);
    static struct schema_text inside;

    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        inside.size = 0;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
        schema_put(&inside, frames[i], place->name, value, place->name);
#pragma GCC diagnostic pop
        ck_assert(!agree_on(place, inside.bytes));
    }
}

/* Twice, also by its other name; not at all; where the others of its kind are not. */
static void test_count_and_place(const struct place *place)
{
    const struct element *row = place->row;
    const char *value = good_value(row), *other = row->alias ? row->alias : row->name;
    static struct schema_text inside;

    inside.size = 0;
    schema_put(&inside, "<%s>%s</%s>", place->name, value, place->name);
    if (strcmp(row->name, "Sync_Cob_Id") != 0 && strncmp(row->name, "Configuration_", 14) != 0)
        ck_assert(agree_on(place, inside.bytes));
    if (!element_find(&network_elements, row->name) || !element_find(&node_elements, row->name)) {
        const bool in_node = place->table == &node_elements;

        ck_assert(!agree_with("", in_node ? inside.bytes : "", in_node ? "" : inside.bytes));
    }
    schema_put(&inside, "<!-- again --><%s>%s</%s>", other, value, other);
    ck_assert(!agree_on(place, inside.bytes));
    ck_assert(agree_with(row->mandatory ? row->name : "", "", "") == !row->mandatory);
}

static void test_element(const struct place *place)
{
    test_values(place);
    test_frames(place);
    test_count_and_place(place);
    switch (place->row->kind) {
    case ELEMENT_NUMBER: test_range(place); break;
    case ELEMENT_BITRATE: test_bit_rates(place); break;
    case ELEMENT_INT16: test_lists(place); break;
    case ELEMENT_ASCII: test_long_text(place); break;
    case ELEMENT_BOOL:
    case ELEMENT_ACTION: break;
    }
}

START_TEST(each_element)
{
    const struct element_table *table = _i == 0 ? &network_elements : &node_elements;

    for (size_t i = 0; i < table->count; i++) {
        struct place place = { table, &table->rows[i], table->rows[i].name };

        test_element(&place);
        place.name = place.row->alias;
        if (place.name)
            test_element(&place);
    }
}
END_TEST

/* ---- whole documents ---- */

#define XSI      "xmlns:xsi='http://www.w3.org/2001/XMLSchema-instance'"
#define LOCATION "xsi:noNamespaceSchemaLocation='network.xsd'"
#define IN(root)                                                                                   \
    "<CANopen_Manager" root "><Manager_Instance><Net_No>0</Net_No><Baudrate>500</Baudrate>"
#define OUT "</Manager_Instance></CANopen_Manager>"
#define NET_NO(n)                                                                                  \
    "<Manager_Instance><Net_No>" n "</Net_No><Baudrate>50</Baudrate></Manager_Instance>"

static const struct whole {
    bool good;
    const char *text;
} wholes[] = {
    { false, "" },
    { false, "<CANopen_Manager/>" },
    { false, "<CANopen_Manager></CANopen_Manager>" },
    { false, "<CANopen_Manager>text</CANopen_Manager>" },
    { false, "<CANopen_Manager><Manager_Instance/></CANopen_Manager>" },
    { false, "<Manager_Instance><Net_No>0</Net_No><Baudrate>500</Baudrate></Manager_Instance>" },
    { false, "<Node_Instance><Node_Id>5</Node_Id></Node_Instance>" },
    { false, "<Net_No>0</Net_No>" },
    { false, "<canopen_manager>" NET_NO("1") "</canopen_manager>" },
    { false, "<CANopen_Manager><Node_Instance><Node_Id>5</Node_Id></Node_Instance>"
             "</CANopen_Manager>" },
    { false, "<CANopen_Manager>" NET_NO("1") "<Net_No>1</Net_No></CANopen_Manager>" },
    { false, "<CANopen_Manager>" NET_NO("1") "<a/></CANopen_Manager>" },
    { true, IN("") OUT },
    { true, "<?xml version='1.0' encoding='ISO-8859-1'?>" IN("") "<Name>\xE4</Name>" OUT },
    { false, IN("") "<Name>\xE4</Name>" OUT },
    { true, "\xEF\xBB\xBF" IN("") OUT },
    /* where editors look for the schema */
    { true, IN(" " XSI) OUT },
    { true, IN(" " XSI " " LOCATION) OUT },
    { true, IN(" xmlns:x='http://www.w3.org/2001/XMLSchema-instance'"
               " x:noNamespaceSchemaLocation='http://none.invalid/a.xsd'") OUT },
    { true, "<?xml version='1.0'?>\n<?xml-model href='network.xsd'?>\n" IN("") OUT "<?x?>" },
    { false, IN(" noNamespaceSchemaLocation='network.xsd'") OUT },
    { false, IN(" " LOCATION) OUT },
    { false, IN(" xmlns='http://www.w3.org/2001/XMLSchema-instance'") OUT },
    { false, IN(" xmlns='urn:a'") OUT },
    { false, IN(" " XSI " xsi:type='xs:string'") OUT },
    { false, IN(" " XSI " xsi:other='a'") OUT },
    { false, IN(" " XSI) "<xsi:Name>a</xsi:Name>" OUT },
    { false, "<a:CANopen_Manager xmlns:a='http://www.w3.org/2001/XMLSchema-instance'>" NET_NO(
                 "1") "</a:CANopen_Manager>" },
    { false, IN("") "<xi:include href='a.xml' xmlns:xi='http://www.w3.org/2001/XInclude'/>" OUT },
    /* several of a kind */
    { true, "<CANopen_Manager>" NET_NO("1") NET_NO("2") "</CANopen_Manager>" },
    { false, "<CANopen_Manager>" NET_NO("1") NET_NO("1") "</CANopen_Manager>" },
    { false, "<CANopen_Manager>" NET_NO("1") NET_NO("01") "</CANopen_Manager>" },
    { true, NET(ONE "<Node_Instance><Node_Id>6</Node_Id></Node_Instance>") },
    { false, NET(ONE ONE) },
    { false, NET(ONE "<Node_Instance><Node_Id>005</Node_Id></Node_Instance>") },
    { false, NET(ONE "<Node_Instance></Node_Instance>") },
    { false, NET(ONE "<Node_Instance/>") },
    { false, NET(ONE "<Node_Instance>text</Node_Instance>") },
    { false, NET(ONE "<Manager_Node_Id>5</Manager_Node_Id>") },
    { true, NET(ONE "<Manager_Node_Id>6</Manager_Node_Id>") },
    { false, NET("<Manager_Node_Id>127</Manager_Node_Id><Manager_Node_Id>126</Manager_Node_Id>") },
    { false, NODE("<DCF_File>a</DCF_File><CCF_File>a</CCF_File>") },
    { false, NODE("<CCF_File>a</CCF_File><DCF_File>b</DCF_File>") },
    { true, NODE("<Configuration_Date>1</Configuration_Date>"
                 "<Configuration_Time>1</Configuration_Time>") },
    { true, NET("<Name>a</Name>" ONE "<Interface>b</Interface>") },
    { true, NET("<Sync_Cob_Id>0x4000007F</Sync_Cob_Id><Sync_Interval>1</Sync_Interval>") },
};

START_TEST(whole_documents)
{
    for (size_t i = 0; i < sizeof wholes / sizeof *wholes; i++)
        ck_assert_msg(schema_agrees(wholes[i].text) == wholes[i].good, "%s", wholes[i].text);
}
END_TEST

/* One more than there is room for. */
START_TEST(many_networks)
{
    static struct schema_text text;

    for (unsigned count = 15; count <= 17; count++) {
        text.size = 0;
        schema_put(&text, "<CANopen_Manager>");
        for (unsigned i = 0; i < count; i++)
            schema_put(&text, NET_NO("%u"), i);
        schema_put(&text, "</CANopen_Manager>");
        ck_assert(schema_agrees(text.bytes) == (count <= NETWORK_INSTANCES));
    }
}
END_TEST

START_TEST(many_nodes)
{
    static struct schema_text text;

    for (unsigned last = 125; last <= 128; last++) {
        text.size = 0;
        schema_put(&text, IN("") "<Manager_Node_Id>127</Manager_Node_Id>");
        for (unsigned id = 1; id <= last; id++)
            schema_put(&text, "<Node_Instance><Node_Id>%u</Node_Id></Node_Instance>", id);
        schema_put(&text, OUT);
        ck_assert(schema_agrees(text.bytes) == (last <= 126));
    }
}
END_TEST

/* Each is one, and stands for something that the reader still says. */
START_TEST(the_differences)
{
    for (size_t i = 0; i < schema_difference_count; i++) {
        const struct schema_difference *it = &schema_differences[i];

        if (!it->document)
            continue;
        ck_assert_msg(schema_takes(it->document, it->size), "no difference: %s", it->message);
        ck_assert_msg(strstr(config_parse_bytes(it->document, it->size)->messages, it->message),
                      "not said: %s", it->message);
    }
}
END_TEST

/* ---- files ---- */

static char *read_text(const char *path)
{
    FILE *file = fopen(path, "r");
    char *text = calloc(1, SCHEMA_TEXT_SIZE);

    ck_assert_msg(file && text, "%s", path);
    ck_assert_uint_lt(fread(text, 1, SCHEMA_TEXT_SIZE, file), SCHEMA_TEXT_SIZE);
    fclose(file);
    return text;
}

static bool is_xml(const char *name)
{
    const char *dot = strrchr(name, '.');

    return dot && strcmp(dot, ".xml") == 0;
}

/* The number of XML files in a folder; 'good': all of them are right. */
static unsigned agree_on_folder(const char *folder, bool good)
{
    DIR *entries = opendir(folder);
    unsigned count = 0;
    char path[2000];

    for (struct dirent *entry; entries && (entry = readdir(entries)) != NULL;) {
        char *text;

        if (!is_xml(entry->d_name))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        text = read_text(path);
        ck_assert_msg(schema_agrees(text) || !good, "%s", path);
        free(text);
        count++;
    }
    if (entries)
        closedir(entries);
    return count;
}

START_TEST(files_of_the_project)
{
    static const char examples[] = PROJECT "/examples";
    DIR *entries = opendir(examples);
    unsigned count = 0;
    char path[2000];

    ck_assert_ptr_nonnull(entries);
    for (struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        snprintf(path, sizeof path, "%s/%s", examples, entry->d_name);
        if (entry->d_name[0] != '.')
            count += agree_on_folder(path, true);
    }
    closedir(entries);
    ck_assert_uint_ge(count, 4);
    ck_assert_uint_ge(agree_on_folder(PROJECT "/tests/fuzz/corpus/network_config", false), 9);
    ck_assert_uint_ge(agree_on_folder(PROJECT "/tests/bench", true), 1);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("schema");

    tcase_add_checked_fixture(tests, schema_load, schema_free);
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, each_element, 0, 2);
    tcase_add_test(tests, whole_documents);
    tcase_add_test(tests, many_networks);
    tcase_add_test(tests, many_nodes);
    tcase_add_test(tests, the_differences);
    tcase_add_test(tests, files_of_the_project);
    return suite_run("network_schema", tests);
}

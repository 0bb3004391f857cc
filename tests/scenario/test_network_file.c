/*
 * The network's file, as people write it: one with every element boots its plant; a slip of the pen
 * in any of them is refused with its line; what is only strange is told, and the plant boots.
 */
#include "support/suite.h"
#include "support/watch.h"

#include "support/config_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- a file with every element --- */

enum kind { K_NUMBER, K_BOOL, K_TEXT, K_WORD, K_LIST };

static const struct line {
    bool in_node;
    enum kind kind;
    const char *name, *value;
} lines[] = {
    { false, K_NUMBER, "Net_No", "0" },
    { false, K_NUMBER, "Baudrate", "1000" },
    { false, K_NUMBER, "Manager_Node_Id", "0x7f" },
    { false, K_TEXT, "Name", "line 7" },
    { false, K_TEXT, "Interface", "can0" },
    { false, K_TEXT, "Config_File_Path", "files" },
    { false, K_NUMBER, "Heartbeat_Producer_Time", "500" },
    { false, K_NUMBER, "Boot_Time", "0" },
    { false, K_BOOL, "NMT_Master", "TRUE" },
    { false, K_BOOL, "NMT_Start_All", "TRUE" },
    { false, K_BOOL, "NMT_Auto_Operational", "TRUE" },
    { false, K_BOOL, "NMT_Auto_Start", "TRUE" },
    { false, K_WORD, "NMT_Action_On_Error", "STOP_ALL" },
    { false, K_NUMBER, "Boot_Delay", "0100" },
    { false, K_BOOL, "Wait_For_Startup", "FALSE" },
    { false, K_BOOL, "NMT_Reset_All", "TRUE" },
    { false, K_BOOL, "Preset_Emergency_Consumer", "TRUE" },
    { false, K_NUMBER, "Sync_Interval", "10000" },
    { false, K_NUMBER, "Sync_Cob_Id", "0x80" },
    { false, K_LIST, "Manager_Thread_Priorities", "1 : 2: 31" },
    { false, K_LIST, "Slave_Thread_Priorities", "1:2:3:4" },
    { false, K_BOOL, "Native_Thread_Priorities", "FALSE" },
    { false, K_NUMBER, "Debug_Mask", "0xFFFFFFFF" },
    { true, K_NUMBER, "Node_Id", "5" },
    { true, K_BOOL, "NMT_Slave", "TRUE" },
    { true, K_BOOL, "NMT_Auto_Start_Slave", "TRUE" },
    { true, K_BOOL, "NMT_Mandatory_Slave", "TRUE" },
    { true, K_NUMBER, "Guard_Time", "100" },
    { true, K_NUMBER, "Life_Time_Factor", "3" },
    { true, K_BOOL, "NMT_Check_Nodestate", "FALSE" },
    { true, K_BOOL, "NMT_Verify_Software", "FALSE" },
    { true, K_BOOL, "NMT_Allow_Software_Update", "FALSE" },
    { true, K_NUMBER, "Consumer_Heartbeat_Time", "0" },
    { true, K_NUMBER, "Device_Type_Identification", "0x20192" },
    { true, K_NUMBER, "Vendor_Identification", "0x29A" },
    { true, K_NUMBER, "Product_Code", "1" },
    { true, K_NUMBER, "Revision_Number", "0x10001" },
    { true, K_NUMBER, "Serial_Number", "5" },
    { true, K_TEXT, "DCF_File", "pump.dcf" },
    { true, K_BOOL, "Old_Config_Style", "FALSE" },
    { true, K_BOOL, "NMT_Reset_Node", "FALSE" },
    { true, K_NUMBER, "SDO_Timeout", "500" },
    { true, K_BOOL, "SDO_Segmented_Size_Indication", "TRUE" },
    { true, K_NUMBER, "SDO_Block_Size", "0" },
    { true, K_BOOL, "Save_Configuration", "FALSE" },
    { true, K_BOOL, "Verify_Configuration", "FALSE" },
    { true, K_NUMBER, "Configuration_Date", "0" },
    { true, K_NUMBER, "Configuration_Time", "0" },
    { true, K_NUMBER, "Software_Identification", "7" },
};

#define LINES (sizeof lines / sizeof lines[0])

enum slip {
    NONE,
    LEFT_OUT, /* only what is mandatory is missed */
    TWICE,
    EMPTY,
    MISSPELT,
    ELSEWHERE,
    CHILD,
    ATTRIBUTE,
    GARBAGE,
    TOO_LARGE,
    NEGATIVE,
    UNCLOSED,
    SLIPS
};

/* N: the element's name, S: that without its last letter, V: its value, G: none, Z: very long */
static const char *const forms[SLIPS] = {
    [NONE] = "<N> V </N>",        [LEFT_OUT] = "",
    [TWICE] = "<N>V</N><N>0</N>", [EMPTY] = "<N>\t</N>",
    [MISSPELT] = "<S>V</S>",      [ELSEWHERE] = "",
    [CHILD] = "<N>V<b>1</b></N>", [ATTRIBUTE] = "<N unit='ms'>V</N>",
    [GARBAGE] = "<N>G</N>",       [TOO_LARGE] = "<N>Z</N>",
    [NEGATIVE] = "<N>-1</N>",     [UNCLOSED] = "<N>V",
};

static void write_slipped(FILE *file, const struct line *line, enum slip slip)
{
    for (const char *c = forms[slip]; *c != '\0'; c++) {
        switch (*c) {
        case 'N': fputs(line->name, file); break;
        case 'S': fprintf(file, "%.*s", (int)strlen(line->name) - 1, line->name); break;
        case 'V': fputs(line->value, file); break;
        case 'G': fputs(line->kind == K_TEXT ? "a&#9;b" : "1O", file); break;
        case 'Z': fprintf(file, "%0*d", 5000, 9); break;
        default: fputc(*c, file);
        }
    }
    fputc('\n', file);
}

static void write_lines(FILE *file, bool in_node, size_t slipped, enum slip slip)
{
    for (size_t i = 0; i < LINES; i++)
        if (lines[i].in_node == in_node)
            write_slipped(file, &lines[i], i == slipped ? slip : NONE);
    if (slip == ELSEWHERE && lines[slipped].in_node != in_node)
        write_slipped(file, &lines[slipped], NONE);
}

/* The slip is in this line of 'lines'; to be freed. */
static char *write_file(size_t slipped, enum slip slip)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);

    ck_assert_ptr_nonnull(file);
    fprintf(file, "<?xml version=\"1.0\"?>\n<CANopen_Manager>\n<Manager_Instance>\n");
    write_lines(file, false, slipped, slip);
    fprintf(file, "<Node_Instance>\n");
    write_lines(file, true, slipped, slip);
    fprintf(file, "</Node_Instance></Manager_Instance></CANopen_Manager>\n");
    fclose(file);
    return text;
}

/* --- what follows from a file --- */

/* Its first network, with a device for node 5, boots. */
static void expect_boot(struct network_config *config, const char *text)
{
    struct plant *plant = plant_new("", 1000000);
    struct network_config *empty = plant->config;

    plant_add_device(plant, 5);
    plant->config = config;
    plant_power_on(plant);
    plant_run_ms(plant, 2000);
    ck_assert_msg(plant->manager->device.state == NMT_OPERATIONAL, "%s", text);
    for (size_t i = 0; i < config->node_count; i++)
        ck_assert_msg(plant_node(plant, config->nodes[i].node_id)->booted ||
                          config->nodes[i].node_id != 5,
                      "%s:\n%s", text, plant->events);
    plant->config = empty;
    plant_free(plant);
}

START_TEST(test_every_element)
{
    char *text = write_file(0, NONE);
    struct config_result *result = config_parse(text);

    ck_assert_msg(result->err == CO_OK, "%s", result->messages);
    ck_assert_str_eq(result->messages, "");
    expect_boot(result->networks, text);
    network_config_free(result->networks, result->count);
    free(text);
}
END_TEST

/* Not every slip is one: a name may be any text, and two elements are in both places. */
static bool is_fault(const struct line *line, enum slip slip)
{
    bool in_both = strcmp(line->name, "Name") == 0 || strcmp(line->name, "Boot_Delay") == 0;
    bool mandatory = strcmp(line->name, "Net_No") == 0 || strcmp(line->name, "Baudrate") == 0 ||
                     strcmp(line->name, "Node_Id") == 0;

    if (slip == LEFT_OUT)
        return mandatory;
    if (slip == ELSEWHERE)
        return !in_both;
    if (slip == TOO_LARGE) /* so many zeros in front of a number do not matter */
        return line->kind != K_NUMBER || strcmp(line->name, "Baudrate") == 0 ||
               strcmp(line->name, "Boot_Time") == 0 ||
               strcmp(line->name, "Heartbeat_Producer_Time") == 0;
    return slip != NEGATIVE || line->kind != K_TEXT;
}

static void expect_refusal(const struct line *line, enum slip slip, unsigned number)
{
    char *text = write_file((size_t)(line - lines), slip);
    struct config_result *result = config_parse(text);
    const size_t same = strlen(line->name) < 6 ? 3 : 5; /* it may be misspelt behind that */
    char where[16];

    snprintf(where, sizeof where, "%u: error: ", number);
    ck_assert_msg(result->err != CO_OK, "%s, slip %d: accepted", line->name, (int)slip);
    if (slip != LEFT_OUT && slip != ELSEWHERE && slip != UNCLOSED)
        ck_assert_msg(strncmp(result->messages, where, strlen(where)) == 0 &&
                          strncmp(result->messages + strlen(where), line->name, same) == 0,
                      "%s, slip %d: %s%s", line->name, (int)slip, where, result->messages);
    ck_assert_ptr_nonnull(strstr(result->messages, "error: "));
    free(text);
}

START_TEST(test_slips)
{
    const struct line *line = &lines[_i];

    for (int slip = LEFT_OUT; slip < SLIPS; slip++)
        if (is_fault(line, (enum slip)slip))
            expect_refusal(line, (enum slip)slip, (unsigned)_i + 4u + line->in_node);
}
END_TEST

/* --- files that are wrong as a whole, and values that do not fit together --- */

static const struct {
    const char *text;
    const char *says; /* in its messages */
} refused[] = {
    { "", "the file is empty" },
    { "<a/>", "the root element is a, expected CANopen_Manager" },
    { "<!DOCTYPE a><CANopen_Manager/>", "a document type declaration" },
    { "<CANopen_Manager/>", "Manager_Instance is missing" },
    { "<CANopen_Manager xmlns='urn:a'/>", "unknown attribute xmlns" },
    { "<CANopen_Manager>Net_No</CANopen_Manager>", "there is text between the elements" },
    { "<CANopen_Manager><Net_No>0</Net_No></CANopen_Manager>", "belongs into Manager_Instance" },
    { "<CANopen_Manager><Node_Instance/></CANopen_Manager>", "belongs into Manager_Instance" },
    { NET("<Manager_Instance/>" ONE), "belongs into CANopen_Manager" },
    { NET("<![CDATA[text]]>" ONE), "there is text between the elements: 'text'" },
    { NET("<!-- fine --><Colour_Of_The_Cable>1</Colour_Of_The_Cable>" ONE),
      "Colour_Of_The_Cable: unknown element in Manager_Instance" },
    { NET("<Gr\xC3\xBC\xC3\x9F"
          "e>1</Gr\xC3\xBC\xC3\x9F"
          "e>" ONE),
      "unknown element in Manager_Instance" },
    { NET("<An_Element_Whose_Name_Is_So_Long_That_Nobody_Could_Have_Meant_Any_Other>1"
          "</An_Element_Whose_Name_Is_So_Long_That_Nobody_Could_Have_Meant_Any_Other>" ONE),
      "...: unknown element" },
    { NET("<NMT_Action_On_Error>RESET</NMT_Action_On_Error>" ONE), "is none of RESET_SLAVE" },
    { NET("<Boot_Time>99</Boot_Time>" ONE), "99 is out of range 0 or 100..65535" },
    { NET("<Debug_Mask>0x100000000</Debug_Mask>" ONE), "is out of range 0..0xFFFFFFFF" },
    { NET("<Debug_Mask>0x</Debug_Mask>" ONE), "'0x' is not a number" },
    { NET("<Debug_Mask>0xfG</Debug_Mask>" ONE), "'0xfG' is not a number" },
    { NET("<Debug_Mask>99999999999999999999999</Debug_Mask>" ONE), "is out of range" },
    { NET("<Sync_Cob_Id>0x80000080</Sync_Cob_Id>" ONE), "belongs to other services" },
    { NET("<Sync_Cob_Id>0x601</Sync_Cob_Id>" ONE), "belongs to other services" },
    { NET("<Manager_Thread_Priorities>1:2</Manager_Thread_Priorities>" ONE), "not 3 numbers" },
    { NET("<Manager_Thread_Priorities>1:2:3:4</Manager_Thread_Priorities>" ONE), "not 3 numbers" },
    { NET("<Manager_Thread_Priorities>1::3</Manager_Thread_Priorities>" ONE), "not 3 numbers" },
    { NET("<Manager_Thread_Priorities>1:99999999999999999999999992:3</"
          "Manager_Thread_Priorities>" ONE),
      "out of range -32768..32767" },
    { NET("<Manager_Thread_Priorities>1:2:32</Manager_Thread_Priorities>" ONE), "32 is out of" },
    { NET("<Slave_Thread_Priorities>-1:2:3:4</Slave_Thread_Priorities>" ONE), "-1 is out of" },
    { NET("<Slave_Thread_Priorities>1:2:3:40000</Slave_Thread_Priorities>" ONE), "-32768..32767" },
    { NET("<Slave_Thread_Priorities>1:-40000:3:4</Slave_Thread_Priorities>" ONE), "-32768..32767" },
    { NET("<Manager_Node_Id>5</Manager_Node_Id>" ONE), "5 is the manager's own (Manager_Node_Id" },
    { NET(ONE "<Node_Instance><Node_Id>127</Node_Id></Node_Instance>"), "(default of Manager_" },
    { NET(ONE ONE), "Node_Id: 5 is already given in line 5" },
    { NODE("<DCF_File>a</DCF_File>\n<CCF_File>b</CCF_File>"), "there is a DCF_File in line 7" },
    { NODE("<CCF_File>b</CCF_File>\n<DCF_File>a</DCF_File>"), "there is a CCF_File in line 7" },
    { NODE("<Configuration_Date>1</Configuration_Date>"), "needs Configuration_Time too" },
    { NODE("<Configuration_Time>1</Configuration_Time>"), "needs Configuration_Date too" },
    { NODE("<Name>a\x7F</Name>"), "another control character" },
    { NODE("<Boot_Delay>5</Boot_Delay"), "XML: " },
    { NET("<Name>pump & valve</Name>" ONE), "XML: &amp; expected, there is a single &" },
    { NET("<Name>pump&valve</Name>" ONE), "XML: &amp; expected, there is a single &" },
    { NET("&a;&b;&c;&d;&e;&f;&g;&h;&i;&j;&k;&l;&m;" ONE), "XML: Entity 'a' not defined" },
    { NET("<\xC3\xBC>\n\xFF</\xC3\xBC>" ONE), "XML: " },
    { NET("<Debug_Mask xml:space='x'>1</Debug_Mask>" ONE), "warning: XML: " },
    { NET("<Debug_Mask>0X1g</Debug_Mask>" ONE), "'0X1g' is not a number" },
    { NET("<Debug_Mask>0x/</Debug_Mask>" ONE), "'0x/' is not a number" },
    { NET("<Debug_Mask>0x@</Debug_Mask>" ONE), "'0x@' is not a number" },
    { NET("<Debug_Mask>01</Debug_Mask><NMT_Master>TRUER</NMT_Master>" ONE), "neither TRUE nor" },
    { NET("<NMT_Master>TRU</NMT_Master>" ONE), "neither TRUE nor" },
    { NET("<NMT_Master>{rue</NMT_Master>" ONE), "neither TRUE nor" },
};

START_TEST(test_refused)
{
    struct config_result *result = config_parse(refused[_i].text);

    ck_assert_msg(result->err != CO_OK, "%s", refused[_i].text);
    ck_assert_msg(strstr(result->messages, refused[_i].says) != NULL, "%s:\n%s", refused[_i].text,
                  result->messages);
}
END_TEST

#define VERIFY "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"
#define ALLOW  "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>"
#define IDENT  "<Software_Identification>1</Software_Identification>"
#define FILE_  "<Software_File>a.bin</Software_File>"
#define CHECK  "<NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
#define GUARD  "<Guard_Time>100</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>"
#define BEAT   "<Consumer_Heartbeat_Time>500</Consumer_Heartbeat_Time>"

/* Strange, but not wrong; "": nothing to be told. */
static const struct {
    const char *text;
    const char *says;
    bool boots; /* node 5 as well */
} strange[] = {
    { NET(""), "without any Node_Instance", true },
    { NET("<NMT_Start_All>true</NMT_Start_All>" ONE), "'true' is taken as TRUE", true },
    { NET("<NMT_Start_All>faLse</NMT_Start_All>" ONE), "'faLse' is taken as FALSE", true },
    { NET("<Sync_Cob_Id>0x40000080</Sync_Cob_Id>" ONE), "no effect without Sync_Interval", true },
    { NET("<Slave_Thread_Priorities>-1:99:3:4</Slave_Thread_Priorities>"
          "<Native_Thread_Priorities>TRUE</Native_Thread_Priorities>" ONE),
      "", true },
    { NODE("<CCF_File>a</CCF_File><Old_Config_Style>TRUE</Old_Config_Style>"),
      "Old_Config_Style: has no effect on a CCF_File", true },
    { NODE("<DCF_File>a</DCF_File><Old_Config_Style>TRUE</Old_Config_Style>"), "", true },
    { NODE("<Configuration_Date>1</Configuration_Date><Configuration_Time>1</Configuration_Time>"),
      "", true },
    { NODE(GUARD BEAT), "Guard_Time: not used", false },
    { NODE("<Guard_Time>100</Guard_Time>" BEAT), "", false },
    { NODE(CHECK), "the state is asked for by guarding", true },
    { NODE(CHECK "<Guard_Time>100</Guard_Time>"), "the state is asked for by guarding", true },
    { NODE(CHECK GUARD), "", true },
    { NODE(VERIFY), "(boot error G)", false },
    { NODE(VERIFY IDENT), "", false },
    { NODE(ALLOW), "no effect without NMT_Verify_Software", true },
    { NODE(VERIFY IDENT ALLOW), "there is no Software_File", false },
    { NODE(VERIFY IDENT ALLOW CHECK GUARD FILE_), "no effect on a node with NMT_Check", false },
    { NODE(VERIFY IDENT ALLOW FILE_), "", false },
    { NODE(FILE_), "no effect without NMT_Allow_Software_Update", true },
    { "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" NODE("<Name>\xFC</Name>"), "", true },
    { "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>100</Baudrate>"
      "</Manager_Instance></CANopen_Manager>",
      "100 is no bit rate of CANopen", true },
};

START_TEST(test_strange)
{
    struct config_result *result = config_parse(strange[_i].text);

    ck_assert_msg(result->err == CO_OK, "%s:\n%s", strange[_i].text, result->messages);
    if (strange[_i].says[0] == '\0')
        ck_assert_str_eq(result->messages, "");
    ck_assert_msg(strstr(result->messages, strange[_i].says) != NULL, "%s:\n%s", strange[_i].text,
                  result->messages);
    if (strange[_i].boots)
        expect_boot(result->networks, strange[_i].text);
    network_config_free(result->networks, result->count);
}
END_TEST

/* --- too much of it --- */

static void expect_too_many(const char *head, const char *each, unsigned count, const char *tail,
                            const char *says)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    struct config_result *result;

    ck_assert_ptr_nonnull(file);
    fputs(head, file);
    for (unsigned i = 0; i < count; i++)
        fprintf(file, each, i, i, i);
    fputs(tail, file);
    fclose(file);
    result = config_parse(text);
    ck_assert_int_ne(result->err, CO_OK);
    ck_assert_msg(strstr(result->messages, says) != NULL, "%s", result->messages);
    free(text);
}

START_TEST(test_too_many)
{
    static const char nothing[4] = { 'a', '\n', 0, 'b' };
    char *large = calloc(1, NETWORK_FILE_SIZE + 1);

    expect_too_many("<CANopen_Manager><Manager_Instance>",
                    "<Node_Instance><Node_Id>%u</Node_Id></Node_Instance>", 130,
                    "</Manager_Instance></CANopen_Manager>",
                    "Node_Instance: more than 127 in one Manager_Instance");
    expect_too_many("<CANopen_Manager>",
                    "<Manager_Instance><Net_No>%u</Net_No><Baudrate>1000</Baudrate>"
                    "</Manager_Instance>",
                    17, "</CANopen_Manager>", "Manager_Instance: more than 16 in one file");
    expect_too_many("<CANopen_Manager>&", "a%u", 100, ";</CANopen_Manager>", "XML: Entity 'a0a1");
    expect_too_many("<CANopen_Manager>", "<a%u/>\n", 200, "</CANopen_Manager>",
                    "too many messages, the rest is left out");
    ck_assert_ptr_nonnull(
        strstr(config_parse_bytes(nothing, 4)->messages, "2: error: there is a NUL"));
    ck_assert_ptr_nonnull(large);
    ck_assert_ptr_nonnull(strstr(config_parse_bytes(large, NETWORK_FILE_SIZE + 1)->messages,
                                 "the file is larger than"));
    free(large);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tcase = tcase_create("network_file");

    tcase_add_test(tcase, test_every_element);
    tcase_add_loop_test(tcase, test_slips, 0, (int)LINES);
    tcase_add_loop_test(tcase, test_refused, 0, ROWS(refused));
    tcase_add_loop_test(tcase, test_strange, 0, ROWS(strange));
    tcase_add_test(tcase, test_too_many);
    return suite_run("network_file", tcase);
}

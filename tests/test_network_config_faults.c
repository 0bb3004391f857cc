#include "support/config_text.h"

#include <check.h>

static const struct fault {
    const char *text;
    const char *messages;
    enum co_err err;
    enum co_err kind; /* of the first error */
} faults[] = {
    /* what the elements may be */
    { NET("<Gard_Time>5</Gard_Time>\n" ONE),
      "5: error: Gard_Time: unknown element in Manager_Instance\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NODE("<Gard_Time>5</Gard_Time>\n"),
      "7: error: Gard_Time: unknown element, did you mean Guard_Time?\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("\n<guard_time>5</guard_time>\n"),
      "8: error: guard_time: unknown element, did you mean Guard_Time?\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET("<NMT_StartAll>TRUE</NMT_StartAll>\n" ONE),
      "5: error: NMT_StartAll: unknown element, did you mean NMT_Start_All?\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<Config_File_Pathes/>\n"),
      "7: error: Config_File_Pathes: unknown element in Node_Instance\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET("<Guard_Time>5</Guard_Time>\n" ONE),
      "5: error: Guard_Time: belongs into Node_Instance, not into Manager_Instance\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<Boot_Time>5</Boot_Time>\n"),
      "7: error: Boot_Time: belongs into Manager_Instance, not into Node_Instance\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE(ONE), "7: error: Node_Instance: belongs into Manager_Instance, not into Node_Instance\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Manager_Instance/>\n" ONE),
      "5: error: Manager_Instance: belongs into CANopen_Manager, not into Manager_Instance\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { "<CANopen_Manager>\n<Net_No>0</Net_No>\n</CANopen_Manager>",
      "2: error: Net_No: belongs into Manager_Instance, not into CANopen_Manager\n"
      "1: error: CANopen_Manager: Manager_Instance is missing\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { "<CANopen_Manager/>", "1: error: CANopen_Manager: Manager_Instance is missing\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("stray\n" ONE),
      "5: error: Manager_Instance: there is text between the elements: 'stray'\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<![CDATA[ x ]]>\n"),
      "7: error: Node_Instance: there is text between the elements: 'x'\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<Boot_Delay>1<b/></Boot_Delay>\n"),
      "7: error: Boot_Delay: a value is expected, not the element b\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<Boot_Delay unit=\"s\" x='y'>1</Boot_Delay>\n"),
      "7: error: Boot_Delay: unknown attribute unit\n7: error: Boot_Delay: unknown attribute x\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { "<CANopen_Manager xmlns:x='http://www.w3.org/2001/XMLSchema-instance' x:other='1'>\n"
      "<x:Manager_Instance><Net_No>1</Net_No><Baudrate>10</Baudrate></x:Manager_Instance>"
      "</CANopen_Manager>",
      "1: error: CANopen_Manager: unknown attribute other\n"
      "2: error: Manager_Instance: unknown with the prefix x\n"
      "2: warning: Manager_Instance: without any Node_Instance there is nothing to manage until "
      "other tools configure it\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { "<CANopen_Manager xmlns='urn:x'>\n</CANopen_Manager>",
      "1: error: CANopen_Manager: unknown attribute xmlns\n"
      "1: error: CANopen_Manager: Manager_Instance is missing\n",
      CO_ERR_VALUE, CO_ERR_VALUE },

    /* what must be there, and once */
    { "<CANopen_Manager>\n<Manager_Instance>\n" ONE "</Manager_Instance>\n</CANopen_Manager>",
      "2: error: Manager_Instance: Net_No is missing\n"
      "2: error: Manager_Instance: Baudrate is missing\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Node_Instance/>\n"), "5: error: Node_Instance: Node_Id is missing\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<Boot_Delay>1</Boot_Delay>\n<Name>n</Name>\n<Boot_Delay>2</Boot_Delay>\n"),
      "9: error: Boot_Delay: already given in line 7\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Config_File_Path>a</Config_File_Path>\n"
          "<Config_File_Repository>b</Config_File_Repository>\n" ONE),
      "6: error: Config_File_Repository: already given in line 5\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NET(ONE "\n" ONE), "7: error: Node_Id: 5 is already given in line 5\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET("<Node_Instance>\n<Node_Id>127</Node_Id></Node_Instance>\n"),
      "6: error: Node_Id: 127 is the manager's own (default of Manager_Node_Id)\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("</Node_Instance>\n<Manager_Node_Id>5</Manager_Node_Id><Node_Instance>"
           "<Node_Id>6</Node_Id>"),
      "6: error: Node_Id: 5 is the manager's own (Manager_Node_Id in line 8)\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET(ONE "</Manager_Instance>\n<Manager_Instance><Net_No> 0x0 </Net_No>"
              "<Baudrate>500</Baudrate>" ONE),
      "7: error: Net_No: 0 is already given in line 3\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NODE("<DCF_File>a</DCF_File>\n<CCF_File>b</CCF_File>\n"),
      "8: error: CCF_File: there is a DCF_File in line 7 already\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NODE("<CCF_File>a</CCF_File>\n<DCF_File>b</DCF_File>\n"),
      "8: error: DCF_File: there is a CCF_File in line 7 already\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NODE("<Configuration_Date>9000</Configuration_Date>\n"),
      "7: error: Configuration_Date: needs Configuration_Time too\n", CO_ERR_VALUE, CO_ERR_VALUE },
    { NODE("<Configuration_Time>9000</Configuration_Time>\n"),
      "7: error: Configuration_Time: needs Configuration_Date too\n", CO_ERR_VALUE, CO_ERR_VALUE },

    /* values */
    { NODE("<Name>\n</Name>\n"), "7: error: Name: the element is empty\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<DCF_File/>\n"), "7: error: DCF_File: the element is empty\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NODE("<DCF_File>a&#9;b</DCF_File>\n"),
      "7: error: DCF_File: 'a?b' is text with a line end or another control character\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<NMT_Action_On_Error>RESET</NMT_Action_On_Error>\n" ONE),
      "5: error: NMT_Action_On_Error: 'RESET' is none of RESET_SLAVE, RESET_ALL, STOP_ALL\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<NMT_Action_On_Error/>\n" ONE), "5: error: NMT_Action_On_Error: the element is empty\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Manager_Thread_Priorities>1:2</Manager_Thread_Priorities>\n" ONE),
      "5: error: Manager_Thread_Priorities: '1:2' is not 3 numbers separated by colons\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Manager_Thread_Priorities>1:2:3:4</Manager_Thread_Priorities>\n" ONE),
      "5: error: Manager_Thread_Priorities: '1:2:3:4' is not 3 numbers separated by colons\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Slave_Thread_Priorities>1::3:4</Slave_Thread_Priorities>\n" ONE),
      "5: error: Slave_Thread_Priorities: '1::3:4' is not 4 numbers separated by colons\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Slave_Thread_Priorities>1:2:3:32768</Slave_Thread_Priorities>\n" ONE),
      "5: error: Slave_Thread_Priorities: 1:2:3:32768 is out of range -32768..32767\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Manager_Thread_Priorities>0:31:32</Manager_Thread_Priorities>\n" ONE),
      "5: error: Manager_Thread_Priorities: 32 is out of range 0..31 "
      "(Native_Thread_Priorities is FALSE)\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Slave_Thread_Priorities>-1:0:0:0</Slave_Thread_Priorities>\n" ONE),
      "5: error: Slave_Thread_Priorities: -1 is out of range 0..31 "
      "(Native_Thread_Priorities is FALSE)\n",
      CO_ERR_VALUE, CO_ERR_VALUE },
    { NET("<Node_Instance>\n<Node_Id>0</Node_Id></Node_Instance>\n"),
      "6: error: Node_Id: 0 is out of range 1..127\n", CO_ERR_VALUE, CO_ERR_ARG },
    { NET("<Node_Instance>\n<Node_Id>128</Node_Id></Node_Instance>\n<Boot_Time>9</Boot_Time>\n"),
      "6: error: Node_Id: 128 is out of range 1..127\n"
      "7: error: Boot_Time: 9 is out of range 0 or 100..65535\n",
      CO_ERR_VALUE, CO_ERR_ARG },

    { NET("<Sync_Interval>1000</Sync_Interval>\n<Sync_Cob_Id>0x705</Sync_Cob_Id>\n" ONE),
      "6: error: Sync_Cob_Id: 0x705 belongs to other services, or is no identifier\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET("<Sync_Cob_Id>0x800</Sync_Cob_Id>\n" ONE),
      "5: error: Sync_Cob_Id: 0x800 belongs to other services, or is no identifier\n", CO_ERR_VALUE,
      CO_ERR_VALUE },
    { NET("<Sync_Cob_Id>0x80000080</Sync_Cob_Id>\n" ONE),
      "5: error: Sync_Cob_Id: 0x80000080 belongs to other services, or is no identifier\n",
      CO_ERR_VALUE, CO_ERR_VALUE },

    /* no configuration at all */
    { "", " error: the file is empty\n", CO_ERR_FORMAT, CO_ERR_FORMAT },
    { "<Manager/>",
      "1: error: the root element is Manager, expected CANopen_Manager: "
      "no configuration of a CANopen manager\n",
      CO_ERR_FORMAT, CO_ERR_FORMAT },
    { "<!DOCTYPE CANopen_Manager SYSTEM 'file:///etc/passwd'>\n<CANopen_Manager/>",
      "1: error: XML: a document type declaration (<!DOCTYPE>) is not accepted\n", CO_ERR_FORMAT,
      CO_ERR_FORMAT },
    { "\n<!DOCTYPE a [<!ENTITY b 'bb'><!ENTITY c '&b;&b;&b;'>]>\n<a>&c;&c;</a>",
      "2: error: XML: a document type declaration (<!DOCTYPE>) is not accepted\n", CO_ERR_FORMAT,
      CO_ERR_FORMAT },
};

START_TEST(test_faults)
{
    const struct fault *row = &faults[_i];
    struct config_result *result = config_parse(row->text);

    ck_assert_str_eq(result->messages, row->messages);
    ck_assert_int_eq(result->err, row->err);
    ck_assert_int_eq(result->report.error_kind, row->kind);
    ck_assert_ptr_null(result->networks);
}
END_TEST

#define CHECKED                                                                                    \
    "<NMT_Verify_Software>TRUE</NMT_Verify_Software>"                                              \
    "<Software_Identification>1</Software_Identification>\n"

static const struct note { /* accepted, with a word about it */
    const char *text, *messages;
    unsigned warnings;
} notes[] = {
    { NET(""),
      "2: warning: Manager_Instance: without any Node_Instance there is nothing to "
      "manage until other tools configure it\n",
      1 },
    { NODE("<CCF_File>a</CCF_File>\n<Old_Config_Style>TRUE</Old_Config_Style>\n"),
      "8: warning: Old_Config_Style: has no effect on a CCF_File\n", 1 },
    { NET("<Sync_Cob_Id>0x80</Sync_Cob_Id>\n" ONE),
      "5: warning: Sync_Cob_Id: has no effect without Sync_Interval\n", 1 },
    { NODE("<Guard_Time>9</Guard_Time><Life_Time_Factor>3</Life_Time_Factor>\n"
           "<Consumer_Heartbeat_Time>9</Consumer_Heartbeat_Time>\n"),
      "7: info: Guard_Time: not used, Consumer_Heartbeat_Time takes its place\n", 0 },
    { NODE("<Guard_Time>9</Guard_Time>\n"), "", 0 },
    { NODE("<Life_Time_Factor>9</Life_Time_Factor>\n"), "", 0 },
    { NODE("<CCF_File>a</CCF_File><Old_Config_Style>FALSE</Old_Config_Style>\n"), "", 0 },
    { NODE("<NMT_Verify_Software>TRUE</NMT_Verify_Software>\n"),
      "7: warning: NMT_Verify_Software: without Software_Identification the node does not boot "
      "(boot error G)\n",
      1 },
    { NODE("<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>\n"),
      "7: warning: NMT_Allow_Software_Update: has no effect without NMT_Verify_Software\n", 1 },
    { NODE(CHECKED "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>\n"),
      "8: warning: NMT_Allow_Software_Update: there is no Software_File to update it with\n", 1 },
    { NODE(CHECKED "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>\n"
                   "<Software_File>a</Software_File><NMT_Check_Nodestate>TRUE</NMT_Check_Nodestate>"
                   "<Consumer_Heartbeat_Time>9</Consumer_Heartbeat_Time>\n"),
      "8: warning: NMT_Allow_Software_Update: has no effect on a node with NMT_Check_Nodestate\n",
      1 },
    { NODE(CHECKED "<Software_File>a</Software_File>\n"),
      "8: warning: Software_File: has no effect without NMT_Allow_Software_Update\n", 1 },
    { NODE(CHECKED "<Software_File>a</Software_File>"
                   "<NMT_Allow_Software_Update>TRUE</NMT_Allow_Software_Update>\n"),
      "", 0 },
    { NODE("<NMT_Slave> true </NMT_Slave>\n"), "7: warning: NMT_Slave: 'true' is taken as TRUE\n",
      1 },
};

START_TEST(test_notes)
{
    struct config_result *result = config_parse(notes[_i].text);

    ck_assert_str_eq(result->messages, notes[_i].messages);
    ck_assert_uint_eq(result->report.warnings, notes[_i].warnings);
    ck_assert_int_eq(result->err, CO_OK);
    network_config_free(result->networks, result->count);
}
END_TEST

/* Written after the example of the manual. */
#define EXAMPLE_NODE(id, control, file)                                                            \
    "    <Node_Instance>\n      <Node_Id>" id "</Node_Id>\n"                                       \
    "      <NMT_Slave>TRUE</NMT_Slave>\n"                                                          \
    "      <NMT_Mandatory_Slave>FALSE</NMT_Mandatory_Slave>\n" control                             \
    "      <Device_Type_Identification>0x00000191</Device_Type_Identification>\n"                  \
    "      <Vendor_Identification>0x17</Vendor_Identification>\n"                                  \
    "      <NMT_Check_Nodestate>FALSE</NMT_Check_Nodestate>\n" file "    </Node_Instance>\n"
#define CONTROL(guard, factor, heartbeat)                                                          \
    "      <Guard_Time>" guard "</Guard_Time>\n"                                                   \
    "      <Life_Time_Factor>" factor "</Life_Time_Factor>\n"                                      \
    "      <Consumer_Heartbeat_Time>" heartbeat "</Consumer_Heartbeat_Time>\n"
#define EXAMPLE(control)                                                                           \
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CANopen_Manager>\n"                              \
    "  <Manager_Instance>\n    <Net_No>0</Net_No>\n    <Baudrate>500</Baudrate>\n"                 \
    "    <Manager_Node_Id>127</Manager_Node_Id>\n"                                                 \
    "    <Config_File_Path>./dcf</Config_File_Path>\n"                                             \
    "    <Boot_Time>20000</Boot_Time>\n"                                                           \
    "    <Heartbeat_Producer_Time>5000</Heartbeat_Producer_Time>\n"                                \
    "    <NMT_Start_All>TRUE</NMT_Start_All>\n"                                                    \
    "    <NMT_Action_On_Error>STOP_ALL</NMT_Action_On_Error>\n" EXAMPLE_NODE(                      \
        "1", CONTROL("0", "0", "3000"), "      <DCF_File>asyncio.dcf</DCF_File>\n")                \
        EXAMPLE_NODE("2", CONTROL("0", "0", "3000"), "      <CCF_File>asyncio.ccf</CCF_File>\n")   \
            EXAMPLE_NODE("3", control,                                                             \
                         "      <DCF_File>asyncio2.dcf</DCF_File>\n") "  "                         \
                                                                      "</Manager_Instance>\n</"    \
                                                                      "CANopen_Manager>\n"

START_TEST(test_example)
{
    struct config_result *result = config_parse(EXAMPLE(CONTROL("2000", "2", "0")));
    struct network_config *config;

    ck_assert_str_eq(result->messages, "");
    ck_assert_int_eq(result->err, CO_OK);
    ck_assert_uint_eq(result->networks[0].nodes[2].guard_time, 2000);
    ck_assert_uint_eq(result->networks[0].nodes[2].life_time_factor, 2);
    network_config_free(result->networks, result->count);
    config = config_parse_one(EXAMPLE(CONTROL("0", "0", "2000")));
    ck_assert_uint_eq(config->node_count, 3);
    ck_assert_str_eq(config->repository, "./dcf");
    ck_assert_str_eq(config->nodes[1].ccf_file, "asyncio.ccf");
    ck_assert_uint_eq(config->nodes[2].consumer_heartbeat_time, 2000);
    ck_assert_uint_eq(config->nodes[2].line, 36);
    network_config_free(config, 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("network_config_faults");
    TCase *all = tcase_create("all");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_loop_test(all, test_faults, 0, (int)(sizeof faults / sizeof *faults));
    tcase_add_loop_test(all, test_notes, 0, (int)(sizeof notes / sizeof *notes));
    tcase_add_test(all, test_example);
    suite_add_tcase(suite, all);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

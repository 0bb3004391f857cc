#include "support/config_text.h"

#include <check.h>
#include <stdio.h>

START_TEST(test_network_defaults)
{
    struct network_config *config = config_parse_one(NET(ONE));

    ck_assert_uint_eq(config->line, 2);
    ck_assert_uint_eq(config->net, 0);
    ck_assert_uint_eq(config->baudrate, 500);
    ck_assert_uint_eq(config->manager_node_id, 127);
    ck_assert_ptr_null(config->name);
    ck_assert_ptr_null(config->interface);
    ck_assert_ptr_null(config->repository);
    ck_assert_uint_eq(config->heartbeat_producer_time, 0);
    ck_assert_uint_eq(config->boot_time, 0);
    ck_assert(config->nmt_master);
    ck_assert(!config->start_all);
    ck_assert(config->auto_operational);
    ck_assert(config->auto_start);
    ck_assert_int_eq(config->action_on_error, ACTION_RESET_SLAVE);
    ck_assert_uint_eq(config->boot_delay, 200);
    ck_assert(!config->wait_for_startup);
    ck_assert(!config->reset_all);
    ck_assert(!config->preset_emergency_consumer);
    ck_assert(!config->has_sync_interval);
    ck_assert_uint_eq(config->sync_cob_id, 0x80);
    ck_assert(!config->has_manager_priorities);
    ck_assert(!config->has_slave_priorities);
    ck_assert(!config->native_priorities);
    ck_assert_uint_eq(config->debug_mask, 0);
    ck_assert_uint_eq(config->node_count, 1);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_node_defaults)
{
    struct network_config *config = config_parse_one(NODE(""));
    const struct node_config *node = &config->nodes[0];

    ck_assert_uint_eq(node->line, 5);
    ck_assert_uint_eq(node->node_id, 5);
    ck_assert_ptr_null(node->name);
    ck_assert(node->nmt_slave);
    ck_assert(node->auto_start_slave);
    ck_assert(!node->mandatory);
    ck_assert_uint_eq(node->guard_time, 0);
    ck_assert_uint_eq(node->life_time_factor, 0);
    ck_assert(!node->check_node_state);
    ck_assert(!node->verify_software);
    ck_assert(!node->allow_software_update);
    ck_assert_uint_eq(node->consumer_heartbeat_time, 0);
    ck_assert_uint_eq(node->device_type, 0);
    ck_assert_uint_eq(node->vendor_id, 0);
    ck_assert_uint_eq(node->product_code, 0);
    ck_assert_uint_eq(node->revision_number, 0);
    ck_assert_uint_eq(node->serial_number, 0);
    ck_assert_ptr_null(node->dcf_file);
    ck_assert_ptr_null(node->ccf_file);
    ck_assert_uint_eq(node->file_line, 0);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_node_defaults_of_the_boot)
{
    struct network_config *config = config_parse_one(NODE(""));
    const struct node_config *node = &config->nodes[0];

    ck_assert(!node->old_config_style);
    ck_assert(!node->reset_node);
    ck_assert_uint_eq(node->boot_delay, 200);
    ck_assert_uint_eq(node->sdo_timeout, 200);
    ck_assert(node->indicate_size);
    ck_assert(!node->save_configuration);
    ck_assert_uint_eq(node->configuration_date, 0);
    ck_assert_uint_eq(node->configuration_time, 0);
    ck_assert_uint_eq(node->software_identification, 0);
    ck_assert_ptr_null(node->software_file);
    ck_assert(!node->verify_configuration);
    ck_assert_uint_eq(node->sdo_block_size, 0);
    network_config_free(config, 1);
}
END_TEST

static const char all_of_network[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<CANopen_Manager><Manager_Instance>\n"
    "<Net_No>255</Net_No><Baudrate> 0x3E8 </Baudrate><Manager_Node_Id>1</Manager_Node_Id>"
    "<Name>press line</Name><Interface>virtual:demo</Interface>"
    "<Config_File_Repository>\n  ./dcf &amp; <!-- so --><![CDATA[<more>]]>\n"
    "</Config_File_Repository>"
    "<Heartbeat_Producer_Time>1500</Heartbeat_Producer_Time><Boot_Time>20000</Boot_Time>"
    "<NMT_Master>FALSE</NMT_Master><NMT_Start_All>TRUE</NMT_Start_All>"
    "<NMT_Auto_Operational>FALSE</NMT_Auto_Operational><NMT_Auto_Start>FALSE</NMT_Auto_Start>"
    "<NMT_Action_On_Error>STOP_ALL</NMT_Action_On_Error><Boot_Delay>0300</Boot_Delay>"
    "<Wait_For_Startup>TRUE</Wait_For_Startup><NMT_Reset_All>TRUE</NMT_Reset_All>"
    "<Preset_Emergency_Consumer>TRUE</Preset_Emergency_Consumer>"
    "<Manager_Thread_Priorities>-10:0x14: 30 </Manager_Thread_Priorities>"
    "<Slave_Thread_Priorities>1:-32768:32767:4</Slave_Thread_Priorities>"
    "<Native_Thread_Priorities>TRUE</Native_Thread_Priorities>"
    "<Debug_Mask>0xffFFffFE</Debug_Mask>\n" ONE "</Manager_Instance></CANopen_Manager>\n";

START_TEST(test_network_values)
{
    struct network_config *config = config_parse_one(all_of_network);

    ck_assert_uint_eq(config->net, 255);
    ck_assert_uint_eq(config->baudrate, 1000);
    ck_assert_uint_eq(config->manager_node_id, 1);
    ck_assert_str_eq(config->name, "press line");
    ck_assert_str_eq(config->interface, "virtual:demo");
    ck_assert_str_eq(config->repository, "./dcf & <more>");
    ck_assert_uint_eq(config->heartbeat_producer_time, 1500);
    ck_assert_uint_eq(config->boot_time, 20000);
    ck_assert(!config->nmt_master);
    ck_assert(config->start_all);
    ck_assert(!config->auto_operational);
    ck_assert(!config->auto_start);
    ck_assert_int_eq(config->action_on_error, ACTION_STOP_ALL);
    ck_assert_uint_eq(config->boot_delay, 300); /* not octal */
    ck_assert(config->wait_for_startup);
    ck_assert(config->reset_all);
    ck_assert(config->preset_emergency_consumer);
    ck_assert_uint_eq(config->debug_mask, 0xFFFFFFFEu);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_priorities)
{
    struct network_config *config = config_parse_one(all_of_network);

    ck_assert(config->has_manager_priorities);
    ck_assert_int_eq(config->manager_priorities[0], -10);
    ck_assert_int_eq(config->manager_priorities[1], 20);
    ck_assert_int_eq(config->manager_priorities[2], 30);
    ck_assert(config->has_slave_priorities);
    ck_assert_int_eq(config->slave_priorities[0], 1);
    ck_assert_int_eq(config->slave_priorities[1], -32768);
    ck_assert_int_eq(config->slave_priorities[2], 32767);
    ck_assert_int_eq(config->slave_priorities[3], 4);
    ck_assert(config->native_priorities);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_node_values)
{
    struct network_config *config = config_parse_one(
        NODE("<Name>pump</Name><NMT_Slave>FALSE</NMT_Slave>"
             "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>"
             "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave><Guard_Time>500</Guard_Time>"
             "<Consumer_Heartbeat_Time>3000</Consumer_Heartbeat_Time>"
             "<Device_Type_Identification>0x00000191</Device_Type_Identification>"
             "<Vendor_Identification>0x17</Vendor_Identification><Product_Code>2</Product_Code>"
             "<Revision_Number>3</Revision_Number><Serial_Number>4294967295</Serial_Number>\n"
             "<DCF_File>pump \xC3\xA4.dcf</DCF_File><Old_Config_Style>TRUE</Old_Config_Style>"
             "<NMT_Reset_Node>TRUE</NMT_Reset_Node><Boot_Delay>1</Boot_Delay>"));
    const struct node_config *node = &config->nodes[0];

    ck_assert_str_eq(node->name, "pump");
    ck_assert(!node->nmt_slave);
    ck_assert(!node->auto_start_slave);
    ck_assert(node->mandatory);
    ck_assert_uint_eq(node->guard_time, 500);
    ck_assert_uint_eq(node->consumer_heartbeat_time, 3000);
    ck_assert_uint_eq(node->device_type, 0x191);
    ck_assert_uint_eq(node->vendor_id, 0x17);
    ck_assert_uint_eq(node->product_code, 2);
    ck_assert_uint_eq(node->revision_number, 3);
    ck_assert_uint_eq(node->serial_number, 0xFFFFFFFFu);
    ck_assert_str_eq(node->dcf_file, "pump \xC3\xA4.dcf");
    ck_assert_uint_eq(node->file_line, 8);
    ck_assert(node->old_config_style);
    ck_assert(node->reset_node);
    ck_assert_uint_eq(node->boot_delay, 1);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_more_node_values)
{
    struct network_config *config = config_parse_one(
        NODE("<Life_Time_Factor>3</Life_Time_Factor>\n<CCF_File>a.ccf</CCF_File>"
             "<SDO_Timeout>1000</SDO_Timeout>"
             "<SDO_Segmented_Size_Indication>FALSE</SDO_Segmented_Size_Indication>"
             "<Save_Configuration>TRUE</Save_Configuration>"
             "<Restore_Configuration>3</Restore_Configuration>"
             "<Configuration_Date>9000</Configuration_Date>"
             "<Configuration_Time>43200000</Configuration_Time>"));
    const struct node_config *node = &config->nodes[0];

    ck_assert_uint_eq(node->life_time_factor, 3);
    ck_assert_str_eq(node->ccf_file, "a.ccf");
    ck_assert_uint_eq(node->file_line, 8);
    ck_assert_uint_eq(node->sdo_timeout, 1000);
    ck_assert(!node->indicate_size);
    ck_assert(node->save_configuration);
    ck_assert(node->restore);
    ck_assert_uint_eq(node->restore_sub, 3);
    ck_assert_uint_eq(node->configuration_date, 9000);
    ck_assert_uint_eq(node->configuration_time, 43200000);
    network_config_free(config, 1);
}
END_TEST

START_TEST(test_several_networks)
{
    struct config_result *result = config_parse(
        "<CANopen_Manager>\n"
        "<Manager_Instance><Net_No>1</Net_No><Baudrate>125</Baudrate>\n"
        "<Node_Instance><Node_Id>2</Node_Id></Node_Instance>\n"
        "<Node_Instance><Node_Id>1</Node_Id></Node_Instance></Manager_Instance>\n"
        "<Manager_Instance><Net_No>0</Net_No><Baudrate>250</Baudrate>\n"
        "<Node_Instance><Node_Id>2</Node_Id></Node_Instance></Manager_Instance>\n"
        "</CANopen_Manager>\n");

    ck_assert_str_eq(result->messages, "");
    ck_assert_uint_eq(result->count, 2);
    ck_assert_uint_eq(result->networks[0].net, 1);
    ck_assert_uint_eq(result->networks[0].nodes[0].node_id, 2);
    ck_assert_uint_eq(result->networks[1].baudrate, 250);
    ck_assert_uint_eq(result->networks[1].line, 5);
    ck_assert_ptr_eq(network_config_node(result->networks, 1), &result->networks[0].nodes[1]);
    ck_assert_ptr_null(network_config_node(&result->networks[1], 1));
    network_config_free(result->networks, result->count);
}
END_TEST

/* Each number: the ends of its range, what lies just outside, and how that is told. */
static const struct bounds {
    const char *element;
    bool in_node;
    const char *low, *high, *below, *above, *range;
    int kind;
} bounds[] = {
    { "Manager_Node_Id", false, "1", "127", "0", "128", "1..127", CO_ERR_ARG },
    { "Heartbeat_Producer_Time", false, "100", "65535", "99", "65536", "0 or 100..65535", 0 },
    { "Heartbeat_Producer_Time", false, "0", "0xFFFF", "1", "0x10000", "0 or 100..65535", 0 },
    { "Boot_Time", false, "100", "65535", "99", "65536", "0 or 100..65535", 0 },
    { "Boot_Time", false, "0", "65535", "-1", "65536", "0 or 100..65535", 0 },
    { "Boot_Delay", false, "0", "65535", "-1", "65536", "0..65535", 0 },
    { "Debug_Mask", false, "0", "4294967295", "-1", "0x100000000", "0..0xFFFFFFFF", 0 },
    { "Guard_Time", true, "0", "65535", "-1", "70000", "0..65535", 0 },
    { "Life_Time_Factor", true, "0", "255", "-1", "256", "0..255", 0 },
    { "Consumer_Heartbeat_Time", true, "0", "65535", "-1", "65536", "0..65535", 0 },
    { "Device_Type_Identification", true, "0x0", "0xFFFFFFFF", "-1", "99999999999999999999999",
      "0..0xFFFFFFFF", 0 },
    { "Vendor_Identification", true, "0", "0xFFFFFFFF", "-1", "4294967296", "0..0xFFFFFFFF", 0 },
    { "Product_Code", true, "0", "0xFFFFFFFF", "-1", "4294967296", "0..0xFFFFFFFF", 0 },
    { "Revision_Number", true, "0", "0xFFFFFFFF", "-1", "4294967296", "0..0xFFFFFFFF", 0 },
    { "Serial_Number", true, "0", "0xFFFFFFFF", "-1", "4294967296", "0..0xFFFFFFFF", 0 },
    { "Boot_Delay", true, "0", "65535", "-1", "65536", "0..65535", 0 },
    { "SDO_Timeout", true, "1", "65535", "0", "65536", "1..65535", 0 },
    { "SDO_Block_Size", true, "0", "0", "-1", "128", "0..127", 0 },
    { "Software_Identification", true, "0", "0x0", "-1", "4294967296", "0..0xFFFFFFFF", 0 },
};

/* Line 7 holds the element, whichever it is in. */
static const char *element_file(const struct bounds *row, const char *value)
{
    static const char *const in_network = NET(ONE "\n<%s>%s</%s>\n"), *const in_node = NODE(
                                                                          "<%s>%s</%s>\n");
    static char text[1000];

    snprintf(text, sizeof text, row->in_node ? in_node : in_network, row->element, value,
             row->element);
    return text;
}

static void check_out_of_range(const struct bounds *row, const char *value)
{
    struct config_result *result = config_parse(element_file(row, value));
    char expected[200];

    snprintf(expected, sizeof expected, "7: error: %s: %s is out of range %s\n", row->element,
             value, row->range);
    ck_assert_str_eq(result->messages, expected);
    ck_assert_int_eq(result->err, CO_ERR_VALUE);
    ck_assert_int_eq(result->report.error_kind, row->kind ? row->kind : CO_ERR_VALUE);
}

START_TEST(test_bounds)
{
    const struct bounds *row = &bounds[_i];
    char expected[200];

    network_config_free(config_parse_one(element_file(row, row->low)), 1);
    network_config_free(config_parse_one(element_file(row, row->high)), 1);
    check_out_of_range(row, row->below);
    check_out_of_range(row, row->above);
    snprintf(expected, sizeof expected, "7: error: %s: '12a' is not a number\n", row->element);
    ck_assert_str_eq(config_parse(element_file(row, "12a"))->messages, expected);
    snprintf(expected, sizeof expected, "7: error: %s: the element is empty\n", row->element);
    ck_assert_str_eq(config_parse(element_file(row, " \t "))->messages, expected);
}
END_TEST

START_TEST(test_not_numbers)
{
    static const char *const texts[] = { "x", "0x", "-", "0xG", "+5", "1 2", "1.5", "5h", "$5" };
    const struct bounds row = { .element = "Guard_Time", .in_node = true };
    char expected[200];

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        snprintf(expected, sizeof expected, "7: error: Guard_Time: '%s' is not a number\n",
                 texts[i]);
        ck_assert_str_eq(config_parse(element_file(&row, texts[i]))->messages, expected);
    }
}
END_TEST

static const struct bounds bools[] = {
    { .element = "NMT_Master" },
    { .element = "NMT_Start_All" },
    { .element = "NMT_Auto_Operational" },
    { .element = "NMT_Auto_Start" },
    { .element = "Wait_For_Startup" },
    { .element = "NMT_Reset_All" },
    { .element = "Preset_Emergency_Consumer" },
    { .element = "Native_Thread_Priorities" },
    { .element = "NMT_Slave", .in_node = true },
    { .element = "NMT_Auto_Start_Slave", .in_node = true },
    { .element = "NMT_Mandatory_Slave", .in_node = true },
    { .element = "NMT_Check_Nodestate", .in_node = true },
    { .element = "NMT_Verify_Software", .in_node = true },
    { .element = "NMT_Allow_Software_Update", .in_node = true },
    { .element = "Old_Config_Style", .in_node = true },
    { .element = "NMT_Reset_Node", .in_node = true },
    { .element = "SDO_Segmented_Size_Indication", .in_node = true },
    { .element = "Save_Configuration", .in_node = true },
    { .element = "Verify_Configuration", .in_node = true },
};

START_TEST(test_bools)
{
    const struct bounds *row = &bools[_i];
    struct config_result *result;
    char expected[200];

    network_config_free(config_parse_one(element_file(row, "FALSE")), 1);
    result = config_parse(element_file(row, "False"));
    snprintf(expected, sizeof expected, "7: warning: %s: 'False' is taken as FALSE\n",
             row->element);
    ck_assert_str_eq(result->messages, expected);
    ck_assert_int_eq(result->err, CO_OK);
    network_config_free(result->networks, result->count);
    result = config_parse(element_file(row, "YES"));
    snprintf(expected, sizeof expected, "7: error: %s: 'YES' is neither TRUE nor FALSE\n",
             row->element);
    ck_assert_str_eq(result->messages, expected);
    ck_assert_int_eq(result->err, CO_ERR_VALUE);
}
END_TEST

START_TEST(test_net_numbers)
{
    static const char file[] = "<CANopen_Manager>\n<Manager_Instance>\n<Net_No>%s</Net_No>\n"
                               "<Baudrate>500</Baudrate>" ONE
                               "</Manager_Instance></CANopen_Manager>";
    char text[sizeof file + 10];
    struct config_result *result;

    snprintf(text, sizeof text, file, "256");
    result = config_parse(text);
    ck_assert_str_eq(result->messages, "3: error: Net_No: 256 is out of range 0..255\n");
    ck_assert_int_eq(result->report.error_kind, CO_ERR_VALUE);
    snprintf(text, sizeof text, file, "255");
    network_config_free(config_parse_one(text), 1);
}
END_TEST

START_TEST(test_bit_rates)
{
    static const unsigned rates[] = { 10, 20, 50, 125, 250, 500, 800, 1000 };
    static const char file[] = "<CANopen_Manager>\n<Manager_Instance>\n<Net_No>0</Net_No>\n"
                               "<Baudrate>%u</Baudrate>" ONE
                               "</Manager_Instance></CANopen_Manager>";
    char text[sizeof file + 10];
    struct config_result *result;

    for (size_t i = 0; i < sizeof rates / sizeof *rates; i++) {
        struct network_config *config;

        snprintf(text, sizeof text, file, rates[i]);
        config = config_parse_one(text);
        ck_assert_uint_eq(config->baudrate, rates[i]);
        network_config_free(config, 1);
    }
    snprintf(text, sizeof text, file, 100u);
    result = config_parse(text);
    ck_assert_str_eq(result->messages, "4: warning: Baudrate: 100 is no bit rate of CANopen; "
                                       "some devices have it all the same\n");
    ck_assert_uint_eq(result->networks[0].baudrate, 100);
    network_config_free(result->networks, result->count);
    snprintf(text, sizeof text, file, 300u);
    result = config_parse(text);
    ck_assert_str_eq(result->messages, "4: error: Baudrate: 300 is no bit rate of CANopen "
                                       "(10, 20, 50, 125, 250, 500, 800, 1000)\n");
    ck_assert_int_eq(result->report.error_kind, CO_ERR_BITRATE);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("network_config");
    TCase *values = tcase_create("values");
    SRunner *runner = srunner_create(suite);
    int failed;

    tcase_add_test(values, test_network_defaults);
    tcase_add_test(values, test_node_defaults);
    tcase_add_test(values, test_node_defaults_of_the_boot);
    tcase_add_test(values, test_network_values);
    tcase_add_test(values, test_priorities);
    tcase_add_test(values, test_node_values);
    tcase_add_test(values, test_more_node_values);
    tcase_add_test(values, test_several_networks);
    tcase_add_loop_test(values, test_bounds, 0, (int)(sizeof bounds / sizeof *bounds));
    tcase_add_test(values, test_not_numbers);
    tcase_add_loop_test(values, test_bools, 0, (int)(sizeof bools / sizeof *bools));
    tcase_add_test(values, test_net_numbers);
    tcase_add_test(values, test_bit_rates);
    suite_add_tcase(suite, values);
    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

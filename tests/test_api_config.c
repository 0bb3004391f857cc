/* mcanOpenConfig: the code, the error text and the log line for each thing that can be wrong. */
#include "support/api_plant.h"
#include "support/dcf_file.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct api_plant *plant;

static void set_up(void)
{
    plant = api_plant_new();
    ck_assert_int_eq(mcanOpenInitialize(), MCANOPEN_OK);
}

static void tear_down(void)
{
    api_plant_free(plant);
}

/* Compares the error text, without the folder in front of file names. */
static void expect_text(const char *expected)
{
    const char *from = mcanOpenGetErrorText();
    char text[600] = "", line[2000];
    size_t folder = strlen(plant->folder);

    while (*from) {
        if (strncmp(from, plant->folder, folder) == 0)
            from += folder + 1;
        else
            strncat(text, from++, 1);
    }
    ck_assert_str_eq(text, expected);
    snprintf(line, sizeof line, "0 %s\n", mcanOpenGetErrorText());
    ck_assert_msg(api_log_count(plant, line) == 1, "in the log:\n%s", plant->log);
}

static unsigned error_lines(void)
{
    return (plant->log[0] == '0') + api_log_count(plant, "\n0 ");
}

/* --- the XML file --- */

static const struct fault {
    const char *inner;
    int result;
    const char *text;
} faults[] = {
    { "<Gard>1</Gard>", MCAL_PARA_ERROR,
      "network.xml:7: error: Gard: unknown element in Manager_Instance" },
    { "<Boot_Delay>1</Boot_Delay>", MCAL_PARA_ERROR,
      "network.xml:7: error: Boot_Delay: already given in line 6" },
    { "<Boot_Time>70000</Boot_Time>", MCAL_PARA_ERROR,
      "network.xml:7: error: Boot_Time: 70000 is out of range 0 or 100..65535" },
    { "<NMT_Master>perhaps</NMT_Master>", MCAL_PARA_ERROR,
      "network.xml:7: error: NMT_Master: 'perhaps' is neither TRUE nor FALSE" },
    { API_NODE(5) API_NODE(5), MCAL_PARA_ERROR,
      "network.xml:8: error: Node_Id: 5 is already given in line 7" },
    { API_NODE(127), MCAL_PARA_ERROR,
      "network.xml:7: error: Node_Id: 127 is the manager's own (default of Manager_Node_Id)" },
    { API_NODE(0), CANOPEN_DCF_WRONG_MODULE_NO,
      "network.xml:7: error: Node_Id: 0 is out of range 1..127" },
    { API_NODE(128), CANOPEN_DCF_WRONG_MODULE_NO,
      "network.xml:7: error: Node_Id: 128 is out of range 1..127" },
    { "<Manager_Node_Id>128</Manager_Node_Id>", CANOPEN_DCF_WRONG_MODULE_NO,
      "network.xml:7: error: Manager_Node_Id: 128 is out of range 1..127" },
    { "<Boot_Time>", MCAL_SYS_ERROR, NULL },
    { "&nothing;", MCAL_SYS_ERROR, NULL },
};

START_TEST(faults_of_the_xml_file)
{
    const struct fault *row = &faults[_i];

    ck_assert_int_eq(api_config(plant, row->inner), row->result);
    if (row->text)
        expect_text(row->text);
    else
        ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "network.xml:7: error: "));
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
    ck_assert_str_eq(mcanOpenGetErrorText(), "");
}
END_TEST

static const struct fault files[] = {
    { "", MCAL_SYS_ERROR, NULL },
    { "<Something/>", MCAL_SYS_ERROR, NULL },
    { "<CANopen_Manager></CANopen_Manager>", MCAL_PARA_ERROR,
      "network.xml:1: error: CANopen_Manager: Manager_Instance is missing" },
    { "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No><Baudrate>123</Baudrate>"
      "</Manager_Instance></CANopen_Manager>",
      CANOPEN_DCF_WRONG_BAUDRATE, NULL },
    { "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No></Manager_Instance></CANopen_Manager>",
      MCAL_PARA_ERROR, "network.xml:1: error: Manager_Instance: Baudrate is missing" },
    { "<CANopen_Manager><Manager_Instance><Net_No>256</Net_No><Baudrate>500</Baudrate>"
      "</Manager_Instance></CANopen_Manager>",
      MCAL_PARA_ERROR, "network.xml:1: error: Net_No: 256 is out of range 0..255" },
};

START_TEST(faults_of_whole_files)
{
    const struct fault *row = &files[_i];

    ck_assert_int_eq(api_config_text(plant, row->inner), row->result);
    if (row->text)
        expect_text(row->text);
    else
        ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "error: "));
}
END_TEST

START_TEST(more_networks_than_there_can_be)
{
    char *text = calloc(17, 400);
    size_t at;

    ck_assert_ptr_nonnull(text);
    at = (size_t)sprintf(text, "<CANopen_Manager>");
    for (unsigned i = 0; i < 17; i++)
        at += (size_t)sprintf(text + at, "%s", api_network(plant, (int)i, ""));
    sprintf(text + at, "</CANopen_Manager>");
    ck_assert_int_eq(api_config_text(plant, text), CANOPEN_DCF_WRONG_NET_NO);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "more than 16 in one file"));
    free(text);
}
END_TEST

START_TEST(an_xml_file_that_is_not_there)
{
    ck_assert_int_eq(mcanOpenConfig(api_path(plant, "none.xml")), MCAL_SYS_ERROR);
    expect_text("none.xml: error: no such file");
    ck_assert_int_eq(mcanOpenConfig(plant->folder), MCAL_SYS_ERROR);
    ck_assert_int_eq(mcanOpenConfig(""), MCAL_SYS_ERROR);
    expect_text(": error: no such file");
}
END_TEST

START_TEST(an_xml_file_without_the_right_to_read_it)
{
    const char *path = api_path(plant, "secret.xml");

    api_write(plant, "secret.xml", "<CANopen_Manager/>");
    ck_assert_int_eq(chmod(path, 0), 0);
    ck_assert_int_eq(chmod(plant->folder, 0755), 0);
    if (geteuid() == 0)
        ck_assert_int_eq(seteuid(65534), 0);
    ck_assert_int_eq(mcanOpenConfig(path), MCAL_SYS_ERROR);
    ck_assert_int_eq(seteuid(getuid()), 0);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "secret.xml: error: "));
}
END_TEST

/* --- interfaces --- */

static const char on_interface[] = "<CANopen_Manager><Manager_Instance>\n<Net_No>0</Net_No>"
                                   "<Baudrate>500</Baudrate><Interface>%s</Interface>\n"
                                   "</Manager_Instance></CANopen_Manager>";

static const char *const interfaces[] = {
    "no-such-can9",
    "virtual:",
    "virtual:no/such",
    "a-name-that-is-much-longer-than-any-interface-of-linux-may-have-and-longer-than-that",
};

START_TEST(interfaces_that_cannot_be_opened)
{
    char text[400];

    snprintf(text, sizeof text, on_interface, interfaces[_i]);
    ck_assert_int_eq(api_config_text(plant, text), MCAL_SYS_ERROR);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "network.xml:1: error: "));
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
}
END_TEST

START_TEST(the_first_of_two_networks_is_given_back_when_the_second_fails)
{
    char text[2000];

    snprintf(text, sizeof text,
             "<CANopen_Manager>%s<Manager_Instance><Net_No>1</Net_No><Baudrate>500</Baudrate>"
             "<Interface>no-such-can9</Interface></Manager_Instance></CANopen_Manager>",
             api_network(plant, 0, API_NODE(5)));
    ck_assert_int_eq(api_config_text(plant, text), MCAL_SYS_ERROR);
    ck_assert_int_eq(api_config(plant, API_NODE(5)), MCANOPEN_OK);
}
END_TEST

START_TEST(the_environment_goes_before_the_file)
{
    char text[400];

    snprintf(text, sizeof text, on_interface, "no-such-can9");
    ck_assert_int_eq(setenv("MCANOPEN_NET_0", plant->bus, 1), 0);
    ck_assert_int_eq(api_config_text(plant, text), MCANOPEN_OK);
    ck_assert_int_eq(mcanOpenShutDown(), MCANOPEN_OK);
    ck_assert_int_eq(setenv("MCANOPEN_NET_0", "", 1), 0); /* as if it were not there */
    ck_assert_int_eq(api_config_text(plant, text), MCAL_SYS_ERROR);
    ck_assert_int_eq(unsetenv("MCANOPEN_NET_0"), 0);
    ck_assert_int_eq(setenv("MCANOPEN_NET_1", plant->bus, 1), 0); /* another network */
    ck_assert_int_eq(api_config_text(plant, text), MCAL_SYS_ERROR);
}
END_TEST

/* --- DCF and CCF files --- */

#define COMMISSIONING(id, rate) "[DeviceComissioning]\nNodeID=" id "\nBaudrate=" rate "\n"
#define VALUE(value)                                                                               \
    OBJECT("2000", VAR("2000", "5", "rw") "LowLimit=1\nHighLimit=9\nParameterValue=" value         \
                                          "\n" COMMISSIONING("5", "500"))

static const struct fault dcfs[] = {
    { VALUE("2"), MCANOPEN_OK, NULL },
    { LINES(COMMISSIONING("6", "500")), CANOPEN_DCF_WRONG_NODE_ID, NULL },
    { LINES(COMMISSIONING("5", "250")), CANOPEN_DCF_WRONG_BAUDRATE, NULL },
    { LINES(COMMISSIONING("128", "500")), CANOPEN_DCF_WRONG_MODULE_NO, NULL },
    { "no section at all\n", CANOPEN_DCF_MISSING_SECTION, NULL },
    { VALUE("abc"), CANOPEN_DCF_WRONG_PARAMETER, NULL },
    { VALUE("256"), CANOPEN_DCF_OUT_OF_RANGE, NULL },
    { VALUE("10"), CANOPEN_DCF_OUT_OF_LIMITS, NULL },
};

#define WITH_DCF API_NODE_WITH(5, "<DCF_File>a.dcf</DCF_File>")
#define WITH_CCF API_NODE_WITH(5, "<CCF_File>a.ccf</CCF_File>")

START_TEST(faults_of_dcf_files)
{
    const struct fault *row = &dcfs[_i];
    int result;

    api_write(plant, "a.dcf", row->inner);
    result = api_config(plant, WITH_DCF);
    ck_assert_msg(result == row->result, "row %d: %d, not %d: %s", _i, result, row->result,
                  mcanOpenGetErrorText());
    if (result != MCANOPEN_OK)
        ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "/a.dcf"));
    ck_assert_int_eq(error_lines() > 0, result != MCANOPEN_OK);
}
END_TEST

START_TEST(files_that_are_not_there)
{
    ck_assert_int_eq(api_config(plant, WITH_DCF), CANOPEN_DCF_INIT_ERROR);
    expect_text("network.xml:7: error: DCF_File: a.dcf: no such file");
    ck_assert_int_eq(api_config(plant, WITH_CCF), CANOPEN_DCF_INIT_ERROR);
    expect_text("network.xml:7: error: CCF_File: a.ccf: no such file");
    ck_assert_int_eq(mkdir(api_path(plant, "a.dcf"), 0700), 0);
    ck_assert_int_eq(api_config(plant, WITH_DCF), CANOPEN_DCF_INIT_ERROR);
}
END_TEST

START_TEST(a_ccf_file_that_is_none)
{
    api_write(plant, "a.ccf", "nonsense");
    ck_assert_int_eq(api_config(plant, WITH_CCF), CANOPEN_DCF_WRONG_PARAMETER);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "/a.ccf"));
}
END_TEST

START_TEST(all_errors_are_logged_and_the_first_one_counts)
{
    api_write(plant, "a.dcf", LINES(COMMISSIONING("6", "500")));
    ck_assert_int_eq(api_config(plant, WITH_DCF API_NODE_WITH(6, "<CCF_File>b.ccf</CCF_File>")),
                     CANOPEN_DCF_WRONG_NODE_ID);
    ck_assert_ptr_nonnull(strstr(mcanOpenGetErrorText(), "NodeID is 6, but"));
    ck_assert_uint_eq(api_log_count(plant, "b.ccf: no such file"), 1);
    ck_assert_uint_eq(error_lines(), 2);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("config");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, API_LIMIT);
    tcase_add_loop_test(tests, faults_of_the_xml_file, 0, ROWS(faults));
    tcase_add_loop_test(tests, faults_of_whole_files, 0, ROWS(files));
    tcase_add_test(tests, more_networks_than_there_can_be);
    tcase_add_test(tests, an_xml_file_that_is_not_there);
    tcase_add_test(tests, an_xml_file_without_the_right_to_read_it);
    tcase_add_loop_test(tests, interfaces_that_cannot_be_opened, 0, ROWS(interfaces));
    tcase_add_test(tests, the_first_of_two_networks_is_given_back_when_the_second_fails);
    tcase_add_test(tests, the_environment_goes_before_the_file);
    tcase_add_loop_test(tests, faults_of_dcf_files, 0, ROWS(dcfs));
    tcase_add_test(tests, files_that_are_not_there);
    tcase_add_test(tests, a_ccf_file_that_is_none);
    tcase_add_test(tests, all_errors_are_logged_and_the_first_one_counts);
    return suite_run("api_config", tests);
}

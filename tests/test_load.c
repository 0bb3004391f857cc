/* Networks from files: which file counts for a node, what is in it, and the name of the bus. */
#include "api/load.h"

#include "mcanopen.h"
#include "support/dcf_file.h"
#include "support/messages.h"
#include "support/suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define XML(inner)                                                                                 \
    "<CANopen_Manager><Manager_Instance><Net_No>3</Net_No><Baudrate>500</Baudrate>\n" inner        \
    "</Manager_Instance></CANopen_Manager>"
#define NODE(id, file) "<Node_Instance><Node_Id>" #id "</Node_Id>" file "</Node_Instance>\n"
#define DCF_OF(value)                                                                              \
    OBJECT("2000",                                                                                 \
           VAR("2000", "5", "rw") "ParameterValue=" value "\n"                                     \
                                  "[DeviceComissioning]\nBaudrate=500\nNodeID=5\n"                 \
                                  "NodeName=\nNetNumber=1\nNetworkName=\nCANopenManager=0\n")

static char folder[SUITE_PATH_SIZE];
static struct messages messages;
static struct network_config *networks;
static size_t count;

static void set_up(void)
{
    suite_temporary("load", folder);
    ck_assert_ptr_nonnull(mkdtemp(folder));
    ck_assert_int_eq(chdir(folder), 0);
    messages_init(&messages);
    networks = NULL;
    count = 0;
}

static void tear_down(void)
{
    char command[sizeof folder + 16];

    network_config_free(networks, count);
    snprintf(command, sizeof command, "rm -r %s", folder);
    ck_assert_int_eq(system(command), 0);
}

static void write_bytes(const char *name, const char *bytes, size_t size)
{
    FILE *file = fopen(name, "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
}

static void write_text(const char *name, const char *text)
{
    write_bytes(name, text, strlen(text));
}

static int load(const char *xml)
{
    write_text("n.xml", xml);
    return load_networks("n.xml", &messages.report, &networks, &count);
}

/* The only value that node i, in the order of the file, gets for 2000h. */
static unsigned value_of(unsigned i)
{
    const struct ccf *ccf = &networks[0].nodes[i].ccf;
    struct ccf_reader reader;
    struct ccf_entry entry;

    ck_assert_uint_eq(ccf_count(ccf), 1);
    ccf_reader_init(&reader, ccf);
    ck_assert(ccf_read(&reader, &entry));
    ck_assert_uint_eq(entry.index, 0x2000);
    ck_assert_uint_eq(entry.size, 1);
    return entry.value[0];
}

START_TEST(each_node_has_its_file)
{
    static const char ccf[] = "\1\0\0\0"
                              "\0\x20"
                              "\0"
                              "\1\0\0\0"
                              "\x22";

    write_text("a.dcf", DCF_OF("0x11"));
    write_bytes("b.ccf", ccf, sizeof ccf - 1);
    ck_assert_int_eq(load(XML(NODE(5, "<DCF_File>a.dcf</DCF_File>")
                                  NODE(6, "<CCF_File>b.ccf</CCF_File>") NODE(7, ""))),
                     MCANOPEN_OK);
    ck_assert_str_eq(messages.text, "");
    ck_assert_uint_eq(count, 1);
    ck_assert_uint_eq(networks[0].node_count, 3);
    ck_assert_uint_eq(value_of(0), 0x11);
    ck_assert_uint_eq(value_of(1), 0x22);
    ck_assert_uint_eq(ccf_count(&networks[0].nodes[2].ccf), 0);
}
END_TEST

/* Else the date spares the device no later download. */
START_TEST(the_date_is_what_the_file_writes)
{
    static const char ccf[] = "\2\0\0\0"
                              "\x20\x10\1\4\0\0\0\5\0\0\0"
                              "\x20\x10\2\4\0\0\0\6\0\0\0";

    write_bytes("b.ccf", ccf, sizeof ccf - 1);
    ck_assert_int_eq(load(XML(NODE(5, "<CCF_File>b.ccf</CCF_File>"
                                      "<Configuration_Date>5</Configuration_Date>"
                                      "<Configuration_Time>6</Configuration_Time>"))),
                     MCANOPEN_OK);
    ck_assert_str_eq(messages.text, "");
    network_config_free(networks, count);
    ck_assert_int_eq(load(XML(NODE(5, "<CCF_File>b.ccf</CCF_File>"
                                      "<Configuration_Date>5</Configuration_Date>"
                                      "<Configuration_Time>7</Configuration_Time>"))),
                     MCANOPEN_OK);
    ck_assert_str_eq(messages.text,
                     "xml:2: warning: Configuration_Date, Configuration_Time: b.ccf does not "
                     "write them to 1020h of node 5: it will be configured at each boot, unless "
                     "somebody else does\n");
}
END_TEST

START_TEST(files_come_from_the_repository)
{
    ck_assert_int_eq(mkdir("r", 0700), 0);
    write_text("r/a.dcf", DCF_OF("0x33"));
    ck_assert_int_eq(load(XML("<Config_File_Repository>r</Config_File_Repository>\n" NODE(
                         5, "<DCF_File>a.dcf</DCF_File>"))),
                     MCANOPEN_OK);
    ck_assert_uint_eq(value_of(0), 0x33);
}
END_TEST

#define DOWNLOAD(name)                                                                             \
    OBJECT("2000", "[2000]\nParameterName=x\nObjectType=2\nDataType=15\nAccessType=rw\n"           \
                   "DownloadFile=" name "\n[DeviceComissioning]\nNodeID=5\nBaudrate=500\n")
#define WITH_R XML(NODE(5, "<DCF_File>r/a.dcf</DCF_File>"))

START_TEST(a_download_file_is_beside_its_dcf)
{
    ck_assert_int_eq(mkdir("r", 0700), 0);
    write_text("r/a.dcf", DOWNLOAD("p.bin"));
    write_text("p.bin", "wrong");
    write_text("r/p.bin", "\x44");
    ck_assert_int_eq(load(WITH_R), MCANOPEN_OK);
    ck_assert_uint_eq(value_of(0), 0x44);
}
END_TEST

static const char *const outside[] = { "../p.bin", "/etc/hostname", "gone.bin" };

START_TEST(a_download_file_outside_is_refused)
{
    char text[4000];

    ck_assert_int_eq(mkdir("r", 0700), 0);
    snprintf(text, sizeof text, DOWNLOAD("%s"), outside[_i]);
    write_text("r/a.dcf", text);
    write_text("p.bin", "\x44");
    ck_assert_int_eq(load(WITH_R), CANOPEN_DCF_WRONG_PARAMETER);
    ck_assert_ptr_nonnull(strstr(messages.text, "DownloadFile"));
    ck_assert_ptr_null(networks);
}
END_TEST

START_TEST(errors_of_all_files_are_told)
{
    write_text("a.dcf", DCF_OF("256"));
    ck_assert_int_eq(
        load(XML(NODE(5, "<DCF_File>a.dcf</DCF_File>") NODE(6, "<DCF_File>none.dcf</DCF_File>")
                     NODE(7, "<CCF_File>none.ccf</CCF_File>"))),
        CANOPEN_DCF_OUT_OF_RANGE);
    ck_assert_uint_eq(messages.report.errors, 3);
    ck_assert_ptr_nonnull(strstr(messages.report.first_error, "a.dcf:"));
    ck_assert_ptr_null(networks);
    ck_assert_uint_eq(count, 0);
}
END_TEST

START_TEST(one_dcf_alone)
{
    struct dcf dcf;

    write_text("a.dcf", DCF_OF("1"));
    ck_assert_int_eq(load_dcf("a.dcf", &messages.report, &dcf), MCANOPEN_OK);
    ck_assert_uint_eq(dcf.node_id, 5);
    ck_assert_ptr_nonnull(dcf_find(&dcf, 0x2000, 0));
    dcf_done(&dcf);
    ck_assert_int_eq(load_dcf("none.dcf", &messages.report, &dcf), CANOPEN_DCF_INIT_ERROR);
    ck_assert_str_eq(messages.report.first_error, "none.dcf: error: no such file");
    write_text("a.dcf", DCF_OF("256"));
    ck_assert_int_eq(load_dcf("a.dcf", &messages.report, &dcf), CANOPEN_DCF_OUT_OF_RANGE);
    ck_assert_uint_eq(messages.report.errors, 2);
}
END_TEST

/* Whoever boots a plant is told of them, in one line. */
START_TEST(warnings_about_a_dcf_are_counted)
{
    struct dcf dcf;

    write_text("a.dcf", DCF_OF("07") "Foo=1\nFoo=2\n");
    ck_assert_int_eq(load_dcf("a.dcf", &messages.report, &dcf), MCANOPEN_OK);
    dcf_done(&dcf);
    ck_assert_str_eq(messages.text,
                     "dcf: warning: 3 warnings about this file, which is used as far as it is "
                     "understood: \"dcftest a.dcf\" shows them\n");
    messages_init(&messages);
    write_text("a.dcf", DCF_OF("256") "Foo=1\n");
    ck_assert_int_eq(load_dcf("a.dcf", &messages.report, &dcf), CANOPEN_DCF_OUT_OF_RANGE);
    ck_assert_str_eq(messages.text,
                     "dcf:67: error: [2000] ParameterValue: a number in the range of UNSIGNED8 "
                     "expected, there is \"256\"\n"); /* it is not used */
}
END_TEST

static const struct name {
    const char *environment, *interface, *bus;
} names[] = {
    { NULL, NULL, "can3" },
    { NULL, "vcan7", "vcan7" },
    { "virtual:a", NULL, "virtual:a" },
    { "virtual:a", "vcan7", "virtual:a" },
    { "", "vcan7", "vcan7" },
};

START_TEST(the_name_of_a_bus)
{
    char interface[20] = "", bus[20];
    const struct network_config config = { .net = 3,
                                           .interface = names[_i].interface ? interface : NULL };

    snprintf(interface, sizeof interface, "%s", names[_i].interface ? names[_i].interface : "");
    ck_assert_int_eq(setenv("MCANOPEN_NET_30", "other", 1), 0);
    if (names[_i].environment)
        ck_assert_int_eq(setenv("MCANOPEN_NET_3", names[_i].environment, 1), 0);
    else
        ck_assert_int_eq(unsetenv("MCANOPEN_NET_3"), 0);
    load_bus_name(&config, bus, sizeof bus);
    ck_assert_str_eq(bus, names[_i].bus);
}
END_TEST

#define SOFTWARE(name) NODE(5, "<Software_File>" name "</Software_File>")

static void expect_no_software(const char *xml, const char *message)
{
    ck_assert_int_eq(load(xml), CANOPEN_DCF_INIT_ERROR);
    ck_assert_ptr_nonnull(strstr(messages.text, message));
    ck_assert_ptr_null(networks);
}

/* As it is, from where a DCF would come. */
START_TEST(software_is_in_memory)
{
    const struct node_config *node;

    ck_assert_int_eq(mkdir("r", 0700), 0);
    write_bytes("r/p.bin", "\0\xFF\0", 3);
    ck_assert_int_eq(load(XML("<Config_File_Repository>r</Config_File_Repository>\n" NODE(
                         5, "<DCF_File>a.dcf</DCF_File><Software_File>p.bin</Software_File>"))),
                     CANOPEN_DCF_INIT_ERROR);
    write_text("a.dcf", DCF_OF("0x33"));
    ck_assert_int_eq(load(XML("<Config_File_Repository>r</Config_File_Repository>\n" NODE(
                         5, "<DCF_File>a.dcf</DCF_File><Software_File>p.bin</Software_File>"))),
                     MCANOPEN_OK);
    node = &networks[0].nodes[0];
    ck_assert_uint_eq(node->software_size, 3);
    ck_assert_mem_eq(node->software, "\0\xFF\0", 3);
    ck_assert_uint_eq(value_of(0), 0x33);
}
END_TEST

START_TEST(software_that_is_not_there)
{
    write_text("empty.bin", "");
    expect_no_software(XML(SOFTWARE("p.bin")), "xml:2: error: Software_File: p.bin: no such file");
    expect_no_software(XML(SOFTWARE("empty.bin")),
                       "xml:2: error: Software_File: empty.bin: the file is empty");
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("load");

    tcase_add_checked_fixture(tests, set_up, tear_down);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, each_node_has_its_file);
    tcase_add_test(tests, the_date_is_what_the_file_writes);
    tcase_add_test(tests, files_come_from_the_repository);
    tcase_add_test(tests, a_download_file_is_beside_its_dcf);
    tcase_add_loop_test(tests, a_download_file_outside_is_refused, 0, ROWS(outside));
    tcase_add_test(tests, errors_of_all_files_are_told);
    tcase_add_test(tests, one_dcf_alone);
    tcase_add_test(tests, warnings_about_a_dcf_are_counted);
    tcase_add_test(tests, software_is_in_memory);
    tcase_add_test(tests, software_that_is_not_there);
    tcase_add_loop_test(tests, the_name_of_a_bus, 0, ROWS(names));
    return suite_run("load", tests);
}

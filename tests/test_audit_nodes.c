/* mcanopen check: nodes, identity, configuration, error control. */
#include "audit/audit_plant.h"

#include "support/suite.h"

#include <stdio.h>
#include <string.h>

#define ROWS(table) (sizeof(table) / sizeof *(table))

#define MANDATORY "<NMT_Mandatory_Slave>TRUE</NMT_Mandatory_Slave>\n"
#define NO_SLAVE  "<NMT_Slave>FALSE</NMT_Slave>\n"
#define VENDOR(n) "<Vendor_Identification>" n "</Vendor_Identification>\n"
#define WAIT(n)   "<Consumer_Heartbeat_Time>" n "</Consumer_Heartbeat_Time>\n"
#define GUARD(n)  "<Guard_Time>" n "</Guard_Time>\n"
#define LIFE(n)   "<Life_Time_Factor>" n "</Life_Time_Factor>\n"
#define BEAT(n)   U16("1017", IS("0") SET(n))

static const struct audit_case nodes[] = {
    { .xml5 = "", .dcf5 = "", .rules = "" },
    { .xml5 = "", .rules = "unknown-node" },
    { .xml5 = VENDOR("0x11") WAIT("500") MANDATORY, .dcf5 = BEAT("200"), .rules = "" },
    { .xml5 = VENDOR("0x11") MANDATORY NO_SLAVE,
      .dcf5 = "",
      .rules = "mandatory-slave, not-configured",
      .text = "n.xml:8: warning: node 5: NMT_Mandatory_Slave has no effect with NMT_Slave FALSE: "
              "the network starts without it [mandatory-slave]\n"
              "n.xml:10: warning: node 5: DCF_File is not written to the device: NMT_Slave is "
              "FALSE [not-configured]\n" },
    { .xml5 = "<NMT_Auto_Start_Slave>FALSE</NMT_Auto_Start_Slave>\n",
      .dcf5 = "",
      .rules = "not-configured" },
    { .network = "<NMT_Master>FALSE</NMT_Master>\n",
      .xml5 = "",
      .dcf5 = "",
      .rules = "no-master",
      .text = "n.xml:5: warning: NMT_Master is FALSE" },
    { .network = "<NMT_Master>FALSE</NMT_Master>\n", .rules = "" },
};

START_TEST(who_is_booted)
{
    audit_plant_check(&nodes[_i]);
}
END_TEST

#define ELEMENT(name, n) "<" name ">" n "</" name ">\n"
#define TYPE(n)          ELEMENT("Device_Type_Identification", n)
#define PRODUCT(n)       ELEMENT("Product_Code", n)
#define REVISION(n)      ELEMENT("Revision_Number", n)
#define SERIAL(n)        ELEMENT("Serial_Number", n)
#define HAS_SERIAL(n)    VAR("1018sub4", "7", "ro", IS(n))

static const struct audit_case identities[] = {
    { .xml5 = TYPE("0x191") VENDOR("0x11") PRODUCT("0x22") REVISION("0x33") SERIAL("7"),
      .dcf5 = HAS_SERIAL("7"),
      .rules = "" },
    { .xml5 = TYPE("0x192"),
      .dcf5 = "",
      .rules = "device-type",
      .text = "n.xml:7: error: node 5: Device_Type_Identification: 0x192 expected, 1000h:00 is "
              "0x191 in 5.dcf: boot error C [device-type]\n" },
    { .xml5 = VENDOR("0x12"), .dcf5 = "", .rules = "wrong-identity", .text = "boot error D" },
    { .xml5 = VENDOR("0x12") NO_SLAVE, .dcf5 = "", .rules = "not-configured" }, /* not compared */
    { .xml5 = PRODUCT("0x12"), .dcf5 = "", .rules = "wrong-identity", .text = "boot error M" },
    { .xml5 = REVISION("0x12"), .dcf5 = "", .rules = "wrong-identity", .text = "boot error N" },
    { .xml5 = SERIAL("7"),
      .dcf5 = "",
      .rules = "wrong-identity",
      .text = "the device has no 1018h:04 in 5.dcf: boot error O" },
    { .xml5 = SERIAL("7"), .dcf5 = HAS_SERIAL("8"), .rules = "serial-number" },
    { .xml5 = SERIAL("7"), .dcf5 = HAS_SERIAL("0"), .rules = "" }, /* of no certain device */
    { .xml5 = MANDATORY WAIT("500"), .dcf5 = BEAT("200"), .rules = "no-identity" },
};

START_TEST(identity_is_that_of_the_file)
{
    audit_plant_check(&identities[_i]);
}
END_TEST

#define DATE(n) ELEMENT("Configuration_Date", n) ELEMENT("Configuration_Time", n)
#define VERIFIES                                                                                   \
    ELEMENT("NMT_Verify_Software", "TRUE")                                                         \
    ELEMENT("Software_Identification", "1")                                                        \
    ELEMENT("NMT_Allow_Software_Update", "TRUE") ELEMENT("Software_File", "n.xml")

static const struct audit_case needs[] = {
    { .xml5 = ELEMENT("Save_Configuration", "TRUE"), .dcf5 = "", .rules = "save-object" },
    { .xml5 = ELEMENT("Save_Configuration", "TRUE"),
      .dcf5 = OBJECT("1010", "2") U32("1010sub1", IS("1")),
      .rules = "" },
    { .xml5 = ELEMENT("Restore_Configuration", "2"),
      .dcf5 = OBJECT("1011", "2") U32("1011sub1", IS("1")),
      .rules = "restore-object",
      .text = "n.xml:7: error: node 5: Restore_Configuration needs 1011h:02, which the device does "
              "not have in 5.dcf" },
    { .xml5 = ELEMENT("Restore_Configuration", "1"),
      .dcf5 = OBJECT("1011", "2") U32("1011sub1", IS("1")),
      .rules = "" },
    { .xml5 = DATE("9"), .dcf5 = "", .rules = "date-object, date-object" },
    { .xml5 = DATE("9"),
      .dcf5 = OBJECT("1020", "3") U32("1020sub1", SET("9")) U32("1020sub2", SET("9")),
      .rules = "" },
    { .xml5 = "",
      .dcf5 = OBJECT("1020", "3") U32("1020sub1", SET("9")) U32("1020sub2", IS("0")),
      .rules = "date-object",
      .text = "5.dcf:" },
    { .xml5 = VERIFIES, .dcf5 = "", .rules = "software-object, update-object, update-object" },
    { .xml5 = VERIFIES,
      .dcf5 = OBJECT("1F50", "2") VAR("1F50sub1", "0xF", "wo", "") OBJECT("1F51", "2")
          U8("1F51sub1", IS("1")) OBJECT("1F56", "2") U32("1F56sub1", IS("1")),
      .rules = "" },
};

START_TEST(elements_need_objects)
{
    audit_plant_check(&needs[_i]);
}
END_TEST

static const struct audit_case heartbeats[] = {
    { .xml5 = WAIT("300"), .dcf5 = BEAT("200"), .rules = "" },
    { .xml5 = WAIT("299"),
      .dcf5 = BEAT("200"),
      .rules = "heartbeat-margin",
      .text = "n.xml:7: warning: the manager waits 299 ms for the heartbeat of node 5, which comes "
              "each 200 ms: at least 300 ms (1.5 times) expected" },
    { .xml5 = WAIT("200"), .dcf5 = BEAT("200"), .rules = "heartbeat-time" },
    { .xml5 = WAIT("500"),
      .dcf5 = U16("1017", IS("0")),
      .rules = "no-heartbeat",
      .text = "5.dcf:70: error: node 5 sends no heartbeat (1017h is 0), but the manager waits 500 "
              "ms for it "
              "(Consumer_Heartbeat_Time, n.xml:7): boot error K" },
    { .xml5 = WAIT("500"),
      .dcf5 = U16("1017", ""),
      .rules = "no-heartbeat",
      .text = "5.dcf:65: error" },
    { .xml5 = WAIT("500"), .dcf5 = "", .rules = "no-heartbeat", .text = "is not there" },
    { .xml5 = WAIT("500"), .dcf5 = U16("1017", IS("200")), .rules = "" },
    { .xml5 = WAIT("500"), .rules = "unknown-node" },
};

START_TEST(the_manager_waits_for_heartbeats)
{
    audit_plant_check(&heartbeats[_i]);
}
END_TEST

#define CONSUMES(n)      OBJECT("1016", "3") U32("1016sub1", SET(n)) U32("1016sub2", IS("0"))
#define CONSUMES_2(a, b) OBJECT("1016", "3") U32("1016sub1", SET(a)) U32("1016sub2", SET(b))
#define BEATS            ELEMENT("Heartbeat_Producer_Time", "1000")

static const struct audit_case consumers[] = {
    { .network = BEATS, .xml5 = "", .dcf5 = CONSUMES("0x007F05DC"), .rules = "" },
    { .network = BEATS, .xml5 = "", .dcf5 = CONSUMES("0x007F05DB"), .rules = "heartbeat-margin" },
    { .network = BEATS,
      .xml5 = "",
      .dcf5 = CONSUMES("0x007F03E8"),
      .rules = "heartbeat-time",
      .text =
          "node 5 waits 1000 ms for the heartbeat of the manager, which comes each 1000 ms only: "
          "it will report the loss (8130h) again and again" },
    { .xml5 = "",
      .dcf5 = CONSUMES("0x007F05DC"),
      .rules = "heartbeat-silent",
      .text = "Heartbeat_Producer_Time is not given" },
    { .xml5 = "", .dcf5 = CONSUMES("0x000605DC"), .xml6 = "", .dcf6 = BEAT("1000"), .rules = "" },
    { .xml5 = "",
      .dcf5 = CONSUMES("0x000605DC"),
      .xml6 = "",
      .dcf6 = "",
      .rules = "heartbeat-silent",
      .text =
          "node 5 waits for heartbeats of node 6 (1016h:01), which sends none: its 1017h is 0" },
    { .xml5 = "", .dcf5 = CONSUMES("0x00060001"), .xml6 = "", .rules = "unknown-node" },
    { .xml5 = "", .dcf5 = CONSUMES("0x000705DC"), .rules = "heartbeat-node" },
    { .xml5 = "", .dcf5 = CONSUMES("0x000505DC"), .rules = "heartbeat-node" },
    { .xml5 = "", .dcf5 = CONSUMES("0x00000064"), .rules = "" }, /* not used */
    { .network = BEATS,
      .xml5 = "",
      .dcf5 = CONSUMES_2("0x007F05DC", "0x007F0BB8"),
      .rules = "heartbeat-twice",
      .text = "1016h:02 waits for node 127 as 1016h:01 does" },
};

START_TEST(nodes_wait_for_heartbeats)
{
    audit_plant_check(&consumers[_i]);
}
END_TEST

#define LIVES(time, factor) U16("100C", SET(time)) U8("100D", SET(factor))

static const struct audit_case guarding[] = {
    { .xml5 = GUARD("100") LIFE("3"), .dcf5 = "", .rules = "" },
    { .xml5 = GUARD("100"),
      .dcf5 = "",
      .rules = "guarding-off",
      .text = "node 5 is not guarded: Life_Time_Factor is 0, or not given" },
    { .xml5 = LIFE("3"), .dcf5 = "", .rules = "guarding-off" },
    { .xml5 = GUARD("100") LIFE("3"), .dcf5 = BEAT("200"), .rules = "guarding-heartbeat" },
    { .xml5 = GUARD("100") LIFE("3"), .dcf5 = LIVES("100", "3"), .rules = "" },
    { .xml5 = GUARD("100") LIFE("3"), .dcf5 = LIVES("50", "2"), .rules = "life-time" },
    { .xml5 = GUARD("100") LIFE("3"), .dcf5 = LIVES("50", "0"), .rules = "guarding-off" },
    { .xml5 = "", .dcf5 = LIVES("100", "3"), .rules = "life-guarding" },
    { .xml5 = "", .dcf5 = U16("100C", IS("100")) U8("100D", IS("3")), .rules = "" },
    { .xml5 = MANDATORY VENDOR("0x11"), .dcf5 = "", .rules = "not-supervised" },
    { .xml5 = MANDATORY VENDOR("0x11") GUARD("100") LIFE("3"), .dcf5 = "", .rules = "" },
};

START_TEST(guarding_has_what_it_needs)
{
    audit_plant_check(&guarding[_i]);
}
END_TEST

START_TEST(a_bit_rate_is_one_of_the_device)
{
    struct audit_case plant = { .xml5 = "", .dcf5 = "", .rules = "" };
    struct audit_told told;

    audit_plant_write_case(&plant);
    audit_plant_write("n.xml", "<CANopen_Manager><Manager_Instance><Net_No>0</Net_No>\n"
                               "<Baudrate>125</Baudrate><Node_Instance><Node_Id>5</Node_Id>\n"
                               "<DCF_File>5.dcf</DCF_File></Node_Instance></Manager_Instance>\n"
                               "</CANopen_Manager>");
    audit_told_init(&told);
    audit_plant_run(&told);
    ck_assert_str_eq(told.text, "n.xml:2: error: 125 kbit/s, but node 5 has 250, 500 only "
                                "(BaudRate_125 is not 1 in 5.dcf) [network-bit-rate]\n");
}
END_TEST

/* --- files --- */

static void write_ccf(const char *bytes, size_t size)
{
    FILE *file = fopen("5.ccf", "w");

    ck_assert_ptr_nonnull(file);
    ck_assert_uint_eq(fwrite(bytes, 1, size, file), size);
    ck_assert_int_eq(fclose(file), 0);
}

#define WRITE_CCF(bytes) write_ccf(bytes, sizeof(bytes) - 1)

static const struct {
    const char *bytes;
    size_t size;
    const char *why; /* NULL: none */
} writes[] = {
#define ROW(bytes, why)                                                                            \
    {                                                                                              \
        "\1\0\0\0" bytes, sizeof("\1\0\0\0" bytes) - 1, why                                        \
    }
    ROW("\x17\x10\0\2\0\0\0\x64\0", NULL),
    ROW("\x17\x10\0\4\0\0\0\x64\0\0\0", "the entry has another size (06070010h)"),
    ROW("\x17\x10\1\2\0\0\0\x64\0", "the object has no such sub-index (06090011h)"),
    ROW("\x18\x10\1\4\0\0\0\x64\0\0\0", "the entry is read-only (06010002h)"),
    ROW("\0\x20\0\2\0\0\0\x64\0", "there is no such object (06020000h)"),
    ROW("\1\x21\0\1\0\0\0\x02", NULL),
    ROW("\1\x21\0\1\0\0\0\xFA", NULL),
    ROW("\1\x21\0\1\0\0\0\x01", "the value is below its low limit (06090032h)"),
    ROW("\1\x21\0\1\0\0\0\xFB", "the value is above its high limit (06090031h)"),
    ROW("\0\x21\0\1\0\0\0\x0A", NULL),
    ROW("\0\x21\0\1\0\0\0\xFE", NULL), /* -2 */
    ROW("\0\x21\0\1\0\0\0\x0B", "the value is above its high limit (06090031h)"),
    ROW("\0\x21\0\1\0\0\0\xFD", "the value is below its low limit (06090032h)"),
#undef ROW
};

START_TEST(a_ccf_is_compared_with_the_eds)
{
    const struct audit_case plant = {
        .xml5 = "<CCF_File>5.ccf</CCF_File>\n",
        .xml6 = "",
        .dcf6 = BEAT("0") VAR("2100", "2", "rw", IS("0") "LowLimit=-2\nHighLimit=10\n")
            VAR("2101", "5", "rw", IS("5") "LowLimit=2\nHighLimit=250\n")
    };
    struct audit_eds eds[] = { { .node = 5, .file = "6.dcf" } };
    static struct audit_told told;
    struct audit audit = {
        .xml_path = "n.xml", .report = &told.report, .eds = eds, .eds_count = 1
    };

    audit_told_init(&told);
    audit_plant_write_case(&plant);
    write_ccf(writes[_i].bytes, writes[_i].size);
    ck_assert(audit_open(&audit));
    ck_assert(eds[0].used);
    ck_assert(audit_run(&audit));
    audit_close(&audit);
    ck_assert_str_eq(told.rules, writes[_i].why ? "refused-write" : "");
    ck_assert(!writes[_i].why || strstr(told.text, writes[_i].why));
    ck_assert(!writes[_i].why || strstr(told.text, "n.xml:7: error: node 5: entry 1 of 5.ccf"));
}
END_TEST

/* Its values count, and without an EDS nothing else is known. */
START_TEST(a_ccf_alone)
{
    const struct audit_case plant = {
        .xml5 = "<CCF_File>5.ccf</CCF_File>\n" WAIT("100"),
        .rules = "unknown-node, heartbeat-time",
        .text = "n.xml:7: info: node 5: the default values behind its "
                "CCF_File are not known: --eds 5=FILE"
    };

    WRITE_CCF("\1\0\0\0\x17\x10\0\2\0\0\0\x64\0");
    audit_plant_check(&plant);
}
END_TEST

START_TEST(errors_in_one_file_leave_the_others)
{
    const struct audit_case plant = { .xml5 = "<DCF_File>none.dcf</DCF_File>\n",
                                      .xml6 = VENDOR("0x12"),
                                      .dcf6 = "",
                                      .rules = "none, wrong-identity",
                                      .text = "n.xml:7: error: DCF_File: none.dcf: no such file" };

    audit_plant_check(&plant);
}
END_TEST

START_TEST(a_name_from_a_machine_without_cases)
{
    const struct audit_case plant = {
        .xml5 = "<DCF_File>EDS\\6.DCF</DCF_File>\n",
        .xml6 = "",
        .dcf6 = "",
        .rules = "none",
        .text = "n.xml:7: error: DCF_File: EDS\\6.DCF: no such file [none]",
    };
    const struct audit_case in_other_cases = {
        .xml5 = "<DCF_File>.\\6.DCF</DCF_File>\n",
        .xml6 = "",
        .dcf6 = "",
        .rules = "none",
        .text = "n.xml:7: error: DCF_File: .\\6.DCF: no such file; there is ./6.dcf [none]",
    };

    audit_plant_check(&plant);
    audit_plant_check(&in_other_cases);
}
END_TEST

/* A DCF for another node is told by the reader, and the rest is judged as if it were right. */
START_TEST(a_file_for_another_node)
{
    const struct audit_case plant = { .xml5 = WAIT("100"),
                                      .dcf5 = BEAT("200") "[DeviceComissioning]\nNodeID=7\n",
                                      .rules = "heartbeat-time" };
    static struct audit_told told;

    audit_told_init(&told);
    audit_plant_write_case(&plant);
    audit_plant_run(&told);
    ck_assert_uint_eq(told.report.errors, 2);
    ck_assert(strstr(told.rules, "heartbeat-time"));
}
END_TEST

/* A DCF that cannot be used tells what it would have written; a CCF that is missing does not. */
START_TEST(what_a_file_was_to_write)
{
    const struct audit_case plant = {
        .xml5 = WAIT("100"),
        .dcf5 = BEAT("200") "[2001]\nParameterName=x\nObjectType=2\nDataType=15\n"
                            "AccessType=rw\nDownloadFile=none.bin\n",
    };
    static struct audit_told told;

    audit_told_init(&told);
    audit_plant_write_case(&plant);
    audit_plant_run(&told);
    ck_assert_uint_eq(told.report.errors, 2); /* and that there is no none.bin */
    ck_assert_str_eq(told.rules, "heartbeat-time");
}
END_TEST

START_TEST(without_a_readable_xml_file_there_is_no_plant)
{
    static struct audit_told told;
    struct audit audit = { .xml_path = "n.xml", .report = &told.report };

    audit_told_init(&told);
    ck_assert(!audit_open(&audit));
    ck_assert_str_eq(told.text, "n.xml: error: no such file [none]\n");
    audit_plant_write("n.xml", "<CANopen_Manager><Manager_Instance>");
    ck_assert(!audit_open(&audit));
}
END_TEST

START_TEST(each_network_has_its_own_lines)
{
    static struct audit_told told;

    audit_plant_write("n.xml", "<CANopen_Manager>\n<!-- -->\n<Manager_Instance><Net_No>0</Net_No>\n"
                               "<Baudrate>500</Baudrate>\n"
                               "<Node_Instance><Node_Id>5</Node_Id></Node_Instance>\n"
                               "</Manager_Instance>\n"
                               "<Manager_Instance><Net_No>1</Net_No><Baudrate>500</Baudrate>"
                               "<Name>mill</Name>\n"
                               "<Node_Instance>\n<Node_Id>5</Node_Id></Node_Instance>\n"
                               "<Node_Instance>\n<Node_Id>6</Node_Id></Node_Instance>\n"
                               "</Manager_Instance></CANopen_Manager>\n");
    audit_told_init(&told);
    audit_plant_run(&told);
    ck_assert_str_eq(told.rules, "unknown-node, unknown-node, unknown-node");
    ck_assert(strstr(told.text, "n.xml:5: info: network 0: node 5"));
    ck_assert(strstr(told.text, "n.xml:9: info: mill: node 5"));
    ck_assert(strstr(told.text, "n.xml:11: info: mill: node 6"));
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("audit-nodes");

    tcase_add_checked_fixture(tests, audit_plant_set_up, audit_plant_tear_down);
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, who_is_booted, 0, ROWS(nodes));
    tcase_add_loop_test(tests, identity_is_that_of_the_file, 0, ROWS(identities));
    tcase_add_loop_test(tests, elements_need_objects, 0, ROWS(needs));
    tcase_add_loop_test(tests, the_manager_waits_for_heartbeats, 0, ROWS(heartbeats));
    tcase_add_loop_test(tests, nodes_wait_for_heartbeats, 0, ROWS(consumers));
    tcase_add_loop_test(tests, guarding_has_what_it_needs, 0, ROWS(guarding));
    tcase_add_test(tests, a_bit_rate_is_one_of_the_device);
    tcase_add_loop_test(tests, a_ccf_is_compared_with_the_eds, 0, ROWS(writes));
    tcase_add_test(tests, a_ccf_alone);
    tcase_add_test(tests, errors_in_one_file_leave_the_others);
    tcase_add_test(tests, a_name_from_a_machine_without_cases);
    tcase_add_test(tests, a_file_for_another_node);
    tcase_add_test(tests, what_a_file_was_to_write);
    tcase_add_test(tests, without_a_readable_xml_file_there_is_no_plant);
    tcase_add_test(tests, each_network_has_its_own_lines);
    return suite_run("audit-nodes", tests);
}

/* A DCF against its EDS. */
#include "support/lint.h"
#include "support/suite.h"

#include <string.h>

#define U8(rest)        ENTRY("2000", "5", "rw", rest)
#define COMMISSIONED    "[DeviceComissioning]\nNodeID=5\nBaudrate=500\n"
#define DEVICE(numbers) "[DeviceInfo]\n" numbers

static const struct {
    const char *name, *dcf, *eds, *messages;
} rows[] = {
    { "the same", U8("DefaultValue=1"), U8("DefaultValue=1"), "" },
    { "a value", U8("DefaultValue=1\nParameterValue=2"), U8("DefaultValue=1"), "" },
    { "another default", U8("DefaultValue=2"), U8("DefaultValue=1"),
      "5 eds-default: 2000h:00 DefaultValue: 0x01 expected (so the EDS has it), there is 0x02\n" },
    { "a default less", U8(""), U8("DefaultValue=1"), "" },
    { "another text", ENTRY("2000", "9", "rw", "DefaultValue=ab"),
      ENTRY("2000", "9", "rw", "DefaultValue=a"),
      "5 eds-default: 2000h:00 DefaultValue: a expected (so the EDS has it), there is ab\n" },
    { "the node-ID put in", ENTRY("2000", "6", "rw", "DefaultValue=0x185") COMMISSIONED,
      ENTRY("2000", "6", "rw", "DefaultValue=$NODEID+0x180"), "" },
    { "another node-ID put in", ENTRY("2000", "6", "rw", "DefaultValue=0x186") COMMISSIONED,
      ENTRY("2000", "6", "rw", "DefaultValue=$NODEID+0x180"),
      "5 eds-default: 2000h:00 DefaultValue: $NODEID+0x0180 expected (so the EDS has it), there is "
      "0x0186\n" },
    { "another type", ENTRY("2000", "6", "rw", "DefaultValue=1"), U8("DefaultValue=2"),
      "1 eds-data-type: 2000h:00 DataType: UNSIGNED8 expected (so the EDS has it), there is "
      "UNSIGNED16\n" },
    { "another access", ENTRY("2000", "5", "rww", ""), U8(""),
      "1 eds-access: 2000h:00 AccessType: rw expected (so the EDS has it), there is rww\n" },
    { "another mapping", U8("PDOMapping=1"), U8(""),
      "1 eds-pdo-mapping: 2000h:00 PDOMapping: 0 expected (so the EDS has it), there is 1\n" },
    { "another object type", RECORD_OF("2000", 1) VALUE("2000sub0", "5", "ro", "0"),
      ARRAY_OF("2000", 1) VALUE("2000sub0", "5", "ro", "0"),
      "5 eds-object-type: 2000h:00 ObjectType: 8 expected (so the EDS has it), there is 9\n" },
    { "within the limits", U8("ParameterValue=9"), U8("LowLimit=1\nHighLimit=9"), "" },
    { "outside the limits", U8("ParameterValue=10"), U8("LowLimit=1\nHighLimit=9"),
      "5 eds-limits: 2000h:00 ParameterValue: 1 to 9 expected (the limits of the EDS), there is "
      "10\n" },
    { "outside the limits, and not written", U8("ParameterValue=10\nObjFlags=1"),
      U8("LowLimit=1\nHighLimit=9"), "" },
    { "an object more",
      RECORD_OF("2000", 2) VALUE("2000sub0", "5", "ro", "1") VALUE("2000sub1", "5", "ro", "1"), "",
      "5 eds-extra: 2000h: an object of the EDS expected, it does not have this one\n" },
    { "a sub-index more",
      RECORD_OF("2000", 2) VALUE("2000sub0", "5", "ro", "1") VALUE("2000sub1", "5", "ro", "1"),
      RECORD_OF("2000", 1) VALUE("2000sub0", "5", "ro", "1"),
      "10 eds-extra: 2000h:01: a sub-index of the EDS expected, it does not have this one\n" },
    { "objects less", VALUE("2001", "5", "ro", "1"),
      RECORD_OF("2000", 2) VALUE("2000sub0", "5", "ro", "1") VALUE("2000sub1", "5", "ro", "1")
          VALUE("2001", "5", "ro", "1") VALUE("2002", "5", "ro", "1"),
      "0 eds-left-out: all entries of the EDS expected, 3 are missing, the first is 2000h:00\n" },
    { "its name", "[FileInfo]\nLastEDS=A.EDS\n", "", "" },
    { "another name", "[FileInfo]\nLastEDS=b.eds\n", "",
      "2 eds-name: [FileInfo] LastEDS: \"a.eds\" expected (FileName of the EDS), there is "
      "\"b.eds\"\n" },
    { "another device", DEVICE("VendorNumber=1\nProductNumber=2\nRevisionNumber=0x10003\n"),
      DEVICE("ProductNumber=3\nRevisionNumber=0x10004\n"),
      "2 eds-identity: [DeviceInfo] VendorNumber: 0x17 expected (so the EDS has it), there is 0x1\n"
      "3 eds-identity: [DeviceInfo] ProductNumber: 0x3 expected (so the EDS has it), there is 0x2\n"
      "4 eds-identity: [DeviceInfo] RevisionNumber: 0x10004 expected (so the EDS has it), there is "
      "0x10003\n" },
    { "an identity that one of them does not tell", DEVICE("ProductNumber=2\n"), "", "" },
};

START_TEST(comparisons)
{
    const char *messages = comparison_of(rows[_i].dcf, rows[_i].eds);

    ck_assert_msg(strcmp(messages, rows[_i].messages) == 0, "%s:\n%s", rows[_i].name, messages);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("dcf_compare");

    tcase_add_loop_test(tests, comparisons, 0, sizeof rows / sizeof rows[0]);
    return suite_run("dcf_compare", tests);
}

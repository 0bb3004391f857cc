/* CAN-IDs of a device. */
#include "support/lint.h"
#include "support/suite.h"

#define COMMISSIONED "[DeviceComissioning]\nNodeID=5\nBaudrate=500\n"
#define SYNC(cob_id) VALUE("1005", "7", "rw", cob_id)
#define TIME(cob_id) VALUE("1012", "7", "rw", cob_id)
#define EMCY(cob_id) VALUE("1014", "7", "rw", cob_id)
#define SDO(name, one, two)                                                                        \
    RECORD_OF(name, 3)                                                                             \
    VALUE(name "sub0", "5", "ro", "2")                                                             \
    VALUE(name "sub1", "7", "ro", one) VALUE(name "sub2", "7", "ro", two)
#define CONSUMERS(one, two)                                                                        \
    ARRAY_OF("1028", 3)                                                                            \
    VALUE("1028sub0", "5", "ro", "2")                                                              \
    VALUE("1028sub1", "7", "rw", one) VALUE("1028sub2", "7", "rw", two)
#define PDO(name, mapping, cob_id)                                                                 \
    RECORD_OF(name, 3)                                                                             \
    VALUE(name "sub0", "5", "ro", "2")                                                             \
    VALUE(name "sub1", "7", "rw", cob_id)                                                          \
    VALUE(name "sub2", "5", "rw", "255") RECORD_OF(mapping, 1) VALUE(mapping "sub0", "5", "rw", "0")
#define RESTRICTED(index, sub, id)                                                                 \
    " cob-id-restricted: " index "h:" sub ": a CAN-ID that CiA 301 does not keep for other "       \
    "services expected, there is " id "h"
#define TWICE(index, sub, id, other)                                                               \
    " cob-id-twice: " index "h:" sub ": a CAN-ID of its own expected, " id "h is that of " other   \
    " as well\n"

static const struct lint_row restricted_rows[] = {
    { "those of the standard",
      SYNC("0x80") TIME("0x40000100") EMCY("$NODEID+0x80")
          SDO("1200", "$NODEID+0x600", "$NODEID+0x580") PDO("1400", "1600", "$NODEID+0x200")
              PDO("1800", "1A00", "$NODEID+0x180") CONSUMERS("0x81", "0x80000000"),
      "" },
    { "SYNC of NMT", SYNC("0x40000000") VALUE("1006", "7", "rw", "1000"),
      "5" RESTRICTED("1005", "00", "000") ": without use it is 80000000h\n" },
    { "TIME of a boot-up", TIME("0x80000705"), "5" RESTRICTED("1012", "00", "705") "\n" },
    { "TIME that is not used", TIME("0x705"), "" },
    { "EMCY without node-ID", EMCY("0x7F"), "5" RESTRICTED("1014", "00", "07F") "\n" },
    { "EMCY that is off", EMCY("0x80000000"), "" },
    { "a TPDO without node-ID", PDO("1800", "1A00", "0x180"),
      "14" RESTRICTED("1800", "01", "180") "\n" },
    { "a TPDO for the first node-IDs", PDO("1800", "1A00", "$NODEID+0x680"),
      "14" RESTRICTED("1800", "01", "6FF") "\n" },
    { "... is one for node 5", PDO("1800", "1A00", "$NODEID+0x680") COMMISSIONED, "" },
    { "an RPDO that is off", PDO("1400", "1600", "0x80000000"), "" },
    { "an RPDO of 29 bits", PDO("1400", "1600", "0x20000001"), "" },
    { "no bit 29", PDO("1400", "1600", "0x00010201"),
      "14 cob-id-bits: 1400h:01: a CAN-ID of 11 bits expected, or bit 29 set, there is "
      "00010201h\n" },
    { "an SDO server", SDO("1201", "0x605", "0x680"), "14" RESTRICTED("1201", "01", "605") "\n" },
    { "half an SDO server is none", SDO("1201", "0x605", "0x80000000"), "" },
    { "a client of a default server", SDO("1280", "0x605", "0x585"), "" },
    { "a client of no server, told once", SDO("1280", "0", "0"),
      "14" RESTRICTED("1280", "01", "000") ": without use it is 80000000h\n" },
    { "a client of no default server", SDO("1280", "0x6E1", "0x581"),
      "14" RESTRICTED("1280", "01", "6E1") "\n" },
    { "the last CAN-ID of 11 bits", PDO("1400", "1600", "0x7FF"),
      "14" RESTRICTED("1400", "01", "7FF") "\n" },
    { "a client that is not told",
      RECORD_OF("1280", 3) VALUE("1280sub0", "5", "ro", "2") VALUE("1280sub1", "7", "rw", "1")
          ENTRY("1280sub2", "7", "rw", ""),
      "" },
    { "a value to be written",
      RECORD_OF("1400", 3) VALUE("1400sub0", "5", "ro", "2")
          ENTRY("1400sub1", "7", "rw", "DefaultValue=0x205\nParameterValue=0x601") VALUE(
              "1400sub2", "5", "rw", "255") RECORD_OF("1600", 1) VALUE("1600sub0", "5", "rw", "0"),
      "15" RESTRICTED("1400", "01", "601") "\n" },
};

START_TEST(restricted)
{
    lint_check(&restricted_rows[_i]);
}
END_TEST

static const struct lint_row twice_rows[] = {
    { "two TPDOs", PDO("1800", "1A00", "$NODEID+0x180") PDO("1801", "1A01", "$NODEID+0x180"),
      "42" TWICE("1801", "01", "181", "1800h:01") },
    { "a TPDO and an RPDO", PDO("1400", "1600", "0x200") PDO("1801", "1A01", "0x200"),
      "42" TWICE("1801", "01", "200", "1400h:01") },
    { "two RPDOs", PDO("1400", "1600", "0x200") PDO("1401", "1601", "0x200"), "" },
    { "another RPDO and SYNC", SYNC("0x80") PDO("1401", "1601", "0x80"),
      "19" TWICE("1401", "01", "080", "1005h:00") },
    { "EMCY and SYNC", SYNC("0x80") EMCY("0x80"), "10" TWICE("1014", "00", "080", "1005h:00") },
    { "EMCY and an RPDO", EMCY("0x81") PDO("1400", "1600", "0x81"),
      "19" TWICE("1400", "01", "081", "1014h:00") },
    { "its own EMCY", EMCY("0x81") CONSUMERS("0x81", "0x80000000"), "" },
    { "the same number with 29 bits",
      PDO("1800", "1A00", "0x20000200") PDO("1400", "1600", "0x200"), "" },
    { "a node-ID that happens to be the same",
      PDO("1800", "1A00", "$NODEID+0x180") PDO("1400", "1600", "0x181"), "" },
    { "a node-ID that is the same",
      PDO("1800", "1A00", "$NODEID+0x180") PDO("1400", "1600", "0x185") COMMISSIONED,
      "14" TWICE("1800", "01", "185", "1400h:01") },
    { "one of them is off",
      PDO("1800", "1A00", "$NODEID+0x180") PDO("1801", "1A01", "$NODEID+0x80000180"), "" },
};

START_TEST(twice)
{
    lint_check(&twice_rows[_i]);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("dcf_lint_cob");

    tcase_add_loop_test(tests, restricted, 0, ROWS(restricted_rows));
    tcase_add_loop_test(tests, twice, 0, ROWS(twice_rows));
    return suite_run("dcf_lint_cob", tests);
}

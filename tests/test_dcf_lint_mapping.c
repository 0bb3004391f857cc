/* What PDOs map. */
#include "support/lint.h"
#include "support/suite.h"

#define COMMISSIONED "[DeviceComissioning]\nNodeID=5\nBaudrate=500\n"
#define SYNC         VALUE("1005", "7", "rw", "0x80")
/* Communication parameters and what they have besides. */
#define PDO(name, count, highest, cob_id, type)                                                    \
    RECORD_OF(name, count)                                                                         \
    VALUE(name "sub0", "5", "ro", highest)                                                         \
    VALUE(name "sub1", "7", "rw", cob_id) VALUE(name "sub2", "5", "rw", type)
#define RPDO PDO("1400", 3, "2", "$NODEID+0x200", "255")
#define TPDO PDO("1800", 3, "2", "$NODEID+0x180", "255")
#define OFF  PDO("1400", 3, "2", "0x80000200", "255")
/* From line 18 on; the values are in lines 26, 30, ... behind 22 for the number. */
#define MAPPING(name, used, one, two)                                                              \
    RECORD_OF(name, 3)                                                                             \
    ENTRY(name "sub0", "5", "rw", used)                                                            \
    ENTRY(name "sub1", "7", "rw", one) ENTRY(name "sub2", "7", "rw", two)
#define D(value)                            "DefaultValue=" value
#define P(value)                            "\nParameterValue=" value
#define TARGET(name, type, access, mapping) ENTRY(name, type, access, "PDOMapping=" mapping)
#define U8_TARGET                           TARGET("2000", "5", "rw", "1")
#define U16_TARGET                          TARGET("2001", "6", "rw", "1")

static const struct lint_row mappings_rows[] = {
    { "two objects",
      RPDO MAPPING("1600", D("2"), D("0x20000008"), D("0x20010010")) U8_TARGET U16_TARGET, "" },
    { "none used", RPDO MAPPING("1600", D("0"), D("0x20000010"), D("0")) U8_TARGET, "" },
    { "no number of objects", RPDO MAPPING("1600", "", D("0x20000008"), D("0")) U8_TARGET, "" },
    { "no number of objects, one that is not there",
      RPDO MAPPING("1600", "", D("0x20000008"), D("0")),
      "33 mapped-missing: 1600h:01: an object of this file expected, there is no 2000h:00\n" },
    { "a default that the file does not tell",
      RPDO MAPPING("1600", D("2"), D("0x20000008"), "") U8_TARGET, "" },
    { "one that is not there behind a default that the file does not tell",
      RPDO MAPPING("1600", D("2"), "", D("0x20010008")),
      "38 mapped-missing: 1600h:02: an object of this file expected, there is no 2001h:00\n" },
    { "as many as there can be", RPDO MAPPING("1600", D("64"), D("0x20000008"), D("0")) U8_TARGET,
      "28 mapping-gap: 1600h: 64 mapped objects expected (sub-index 0), sub-index 2 is empty\n" },
    { "a gap", RPDO MAPPING("1600", D("2"), D("0x20000008"), D("0")) U8_TARGET,
      "28 mapping-gap: 1600h: 2 mapped objects expected (sub-index 0), sub-index 2 is empty\n" },
    { "more than there are",
      RPDO MAPPING("1600", D("3"), D("0x20000008"), D("0x20010010")) U8_TARGET U16_TARGET,
      "28 mapping-gap: 1600h: 3 mapped objects expected (sub-index 0), sub-index 3 is missing\n" },
    { "nothing mapped", RPDO MAPPING("1600", D("2"), D("0"), D("0")),
      "28 mapping-gap: 1600h: 2 mapped objects expected (sub-index 0), sub-index 1 is empty\n" },
    { "nothing mapped in one that is off", OFF MAPPING("1600", D("2"), D("0"), D("0")), "" },
    { "far too many", RPDO MAPPING("1600", D("65"), D("0"), D("0")),
      "28 mapping-count: 1600h:00: at most 64 mapped objects expected, or 254 or 255, there are "
      "65\n" },
    { "an MPDO", RPDO MAPPING("1600", D("255"), D("0"), D("0")) "[DeviceInfo]\nGroupMessaging=1\n",
      "" },
    { "an MPDO of the other kind of a device without",
      RPDO MAPPING("1600", D("254"), D("0"), D("0")),
      "28 mpdo: 1600h:00: GroupMessaging=1 in [DeviceInfo] expected, this is an MPDO\n" },
    { "an MPDO of a device without", RPDO MAPPING("1600", D("255"), D("0"), D("0")),
      "28 mpdo: 1600h:00: GroupMessaging=1 in [DeviceInfo] expected, this is an MPDO\n" },
    { "an object that is not there",
      RPDO MAPPING("1600", D("1"), D("0x20000108"), D("0")) U8_TARGET,
      "33 mapped-missing: 1600h:01: an object of this file expected, there is no 2000h:01\n" },
    { "an object that is not there in one that is off",
      OFF MAPPING("1600", D("1"), D("0x20000108"), D("0")) U8_TARGET, "" },
    { "another length", RPDO MAPPING("1600", D("1"), D("0x20000010"), D("0")) U8_TARGET,
      "33 mapping-length: 1600h:01: 8 bits of 2000h:00 expected (it is UNSIGNED8), there are "
      "16\n" },
    { "another length in one that is off",
      OFF MAPPING("1600", D("1"), D("0x20000010"), D("0")) U8_TARGET,
      "33 mapping-length: 1600h:01: 8 bits of 2000h:00 expected (it is UNSIGNED8), there are "
      "16\n" },
    { "a BOOLEAN of a bit",
      RPDO MAPPING("1600", D("1"), D("0x20000001"), D("0")) TARGET("2000", "1", "rw", "1"), "" },
    { "a BOOLEAN of a byte",
      RPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) TARGET("2000", "1", "rw", "1"), "" },
    { "a BOOLEAN of two bits",
      RPDO MAPPING("1600", D("1"), D("0x20000002"), D("0")) TARGET("2000", "1", "rw", "1"),
      "33 mapping-length: 1600h:01: 1 bits of 2000h:00 expected (it is BOOLEAN), there are 2\n" },
    { "one that cannot be mapped",
      RPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) TARGET("2000", "5", "rw", "0"),
      "33 mapped-not-mappable: 1600h:01: an object with PDOMapping=1 expected, 2000h:00 has 0\n" },
    { "one that cannot be mapped where it is off",
      OFF MAPPING("1600", D("1"), D("0x20000008"), D("0")) TARGET("2000", "5", "rw", "0"), "" },
    { "rww and wo in an RPDO",
      RPDO MAPPING("1600", D("2"), D("0x20000008"), D("0x20010008")) TARGET("2000", "5", "rww", "1")
          TARGET("2001", "5", "wo", "1"),
      "" },
    { "rwr in an RPDO",
      RPDO TPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) TARGET("2000", "5", "rwr", "1")
          RECORD_OF("1A00", 1) VALUE("1A00sub0", "5", "rw", "0"),
      "52 mapping-direction: 1600h:01: an object that can be written expected in an RPDO, 2000h:00 "
      "is rwr\n" },
    { "ro, const and rwr in a TPDO",
      TPDO MAPPING("1A00", D("2"), D("0x20000008"), D("0x20010008")) TARGET("2000", "5", "rwr", "1")
          TARGET("2001", "5", "const", "1"),
      "" },
    { "wo in a TPDO",
      TPDO RPDO MAPPING("1A00", D("1"), D("0x20000008"), D("0")) TARGET("2000", "5", "wo", "1")
          RECORD_OF("1600", 1) VALUE("1600sub0", "5", "rw", "0"),
      "52 mapping-direction: 1A00h:01: an object that can be read expected in a TPDO, 2000h:00 is "
      "wo\n" },
    { "64 bits",
      RPDO MAPPING("1600", D("2"), D("0x20000020"), D("0x20000020")) TARGET("2000", "7", "rw", "1"),
      "" },
    { "more than 64 bits",
      RPDO MAPPING("1600", D("2"), D("0x20000040"), D("0x20010008")) TARGET("2000", "27", "rw", "1")
          TARGET("2001", "5", "rw", "1"),
      "28 mapping-size: 1600h: at most 64 mapped bits expected, there are 72\n" },
    { "a number that cannot be changed",
      RPDO RECORD_OF("1600", 2) VALUE("1600sub0", "5", "const", "1")
          VALUE("1600sub1", "7", "rw", "0x20000008") U8_TARGET,
      "24 mapping-access: 1600h:00: a writable number of mapped objects expected (01 is rw), it is "
      "const\n" },
    { "a PDO that cannot be switched off",
      RECORD_OF("1400", 3) VALUE("1400sub0", "5", "ro", "2")
          VALUE("1400sub1", "7", "const", "$NODEID+0x200") VALUE("1400sub2", "5", "rw", "255")
              MAPPING("1600", D("0"), D("0"), D("0")),
      "10 mapping-cob-id: 1400h:01: a writable COB-ID expected (1600h:01 is rw), it is const\n" },
    { "a mapping that cannot be changed",
      RPDO RECORD_OF("1600", 2) VALUE("1600sub0", "5", "const", "1")
          VALUE("1600sub1", "7", "ro", "0x20000008") U8_TARGET,
      "" },
};

START_TEST(mappings)
{
    lint_check(&mappings_rows[_i]);
}
END_TEST

static const struct lint_row dummies_rows[] = {
    { "a dummy", RPDO MAPPING("1600", D("1"), D("0x00050008"), D("0")), "" },
    { "a dummy that is not allowed", RPDO MAPPING("1600", D("1"), D("0x00060010"), D("0")),
      "33 dummy-usage: 1600h:01: an object expected, [DummyUsage] does not allow the dummy "
      "0006h\n" },
    { "a dummy of which [DummyUsage] does not speak",
      RPDO MAPPING("1600", D("1"), D("0x00080020"), D("0")), "" },
    { "a dummy of another length", RPDO MAPPING("1600", D("1"), D("0x00050010"), D("0")),
      "33 mapping-length: 1600h:01: 8 bits of 0005h:00 expected (it is UNSIGNED8), there are "
      "16\n" },
    { "a dummy in a TPDO", TPDO MAPPING("1A00", D("1"), D("0x00050008"), D("0")),
      "33 dummy-in-tpdo: 1A00h:01: an object expected, a TPDO cannot have the dummy 0005h\n" },
};

START_TEST(dummies)
{
    lint_check(&dummies_rows[_i]);
}
END_TEST

static const struct lint_row configured_rows[] = {
    { "other objects",
      RPDO MAPPING("1600", D("1") P("2"), D("0x20000008"), D("0") P("0x20010010"))
          U8_TARGET U16_TARGET,
      "" },
    { "a gap", RPDO MAPPING("1600", D("1") P("2"), D("0x20000008"), D("0")) U8_TARGET,
      "29 mapping-gap: 1600h: 2 mapped objects expected (sub-index 0), sub-index 2 is empty\n" },
    { "what is wrong by default is told once",
      RPDO MAPPING("1600", D("1") P("2"), D("0x20000008") P("0x20000008"), D("0") P("0x20010008"))
          TARGET("2000", "5", "rw", "0") U16_TARGET,
      "34 mapped-not-mappable: 1600h:01: an object with PDOMapping=1 expected, 2000h:00 has 0\n41 "
      "mapping-length: 1600h:02: 16 bits of 2001h:00 expected (it is UNSIGNED16), there are 8\n" },
    { "what was off is switched on",
      RECORD_OF("1400", 3) VALUE("1400sub0", "5", "ro", "2")
          ENTRY("1400sub1", "7", "rw", "DefaultValue=0x80000000\nParameterValue=0x205")
              VALUE("1400sub2", "5", "rw", "255") MAPPING("1600", D("1"), D("0x20020008"), D("0")),
      "34 mapped-missing: 1600h:01: an object of this file expected, there is no 2002h:00\n" },
    { "values that are not written",
      RPDO RECORD_OF("1600", 2) ENTRY("1600sub0", "5", "ro", D("1"))
          ENTRY("1600sub1", "7", "ro", D("0x20000008") P("0x20010008")) U8_TARGET U16_TARGET,
      "" },
};

START_TEST(configured)
{
    lint_check(&configured_rows[_i]);
}
END_TEST

static const struct lint_row abilities_rows[] = {
    { "a granularity",
      RPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) U8_TARGET
      "[DeviceInfo]\nGranularity=8\n",
      "" },
    { "less than the granularity",
      RPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) U8_TARGET
      "[DeviceInfo]\nGranularity=16\n",
      "33 mapping-granularity: 1600h:01: at least 16 bits expected (Granularity), there are 8\n" },
    { "no granularity for a mapping that can be changed",
      RPDO MAPPING("1600", D("1"), D("0x20000008"), D("0")) U8_TARGET
      "[DeviceInfo]\nGranularity=0\n",
      "45 granularity: [DeviceInfo] Granularity: 1..64 expected (the mapping can be changed, "
      "1600h:01 is rw), there is 0\n" },
    { "a granularity for one that cannot be changed",
      RPDO RECORD_OF("1600", 2) VALUE("1600sub0", "5", "const", "1")
          VALUE("1600sub1", "7", "ro", "0x20000008") U8_TARGET "[DeviceInfo]\nGranularity=8\n",
      "40 granularity: [DeviceInfo] Granularity: 0 expected (no mapping can be changed, 1600h is "
      "read-only), there is 8\n" },
    { "not all of a fixed mapping",
      RPDO RECORD_OF("1600", 3) VALUE("1600sub0", "5", "const", "1")
          VALUE("1600sub1", "7", "ro", "0x20000008") VALUE("1600sub2", "7", "ro", "0x20000008")
              U8_TARGET "[DeviceInfo]\nGranularity=0\n",
      "28 sub-0-default: 1600h:00 DefaultValue: 2 expected (the highest sub-index), there is 1\n" },
    { "not all of a mapping of which the file does not tell whether it is fixed",
      RPDO RECORD_OF("1600", 3) VALUE("1600sub0", "5", "const", "1") VALUE(
          "1600sub1", "7", "ro", "0x20000008") VALUE("1600sub2", "7", "ro", "0x20000008") U8_TARGET,
      "" },
    { "for a TPDO that is not there",
      RPDO MAPPING("1600", D("0"), D("0"), D("0")) TARGET("2000", "5", "ro", "1")
          TARGET("2001", "5", "rwr", "1"),
      "39 mappable-without-pdo: 2000h:00 PDOMapping: 0 expected (ro, and the device has no TPDO), "
      "there is 1 (2 such entries)\n" },
    { "for an RPDO that is not there",
      TPDO MAPPING("1A00", D("0"), D("0"), D("0")) TARGET("2000", "5", "wo", "1"),
      "39 mappable-without-pdo: 2000h:00 PDOMapping: 0 expected (wo, and the device has no RPDO), "
      "there is 1 (1 such entries)\n" },
    { "for PDOs that are announced only",
      "[DeviceInfo]\nNrOfTXPDO=1\n" TARGET("2000", "5", "ro", "1"), "" },
};

START_TEST(abilities)
{
    lint_check(&abilities_rows[_i]);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("dcf_lint_mapping");

    tcase_add_loop_test(tests, mappings, 0, ROWS(mappings_rows));
    tcase_add_loop_test(tests, dummies, 0, ROWS(dummies_rows));
    tcase_add_loop_test(tests, configured, 0, ROWS(configured_rows));
    tcase_add_loop_test(tests, abilities, 0, ROWS(abilities_rows));
    return suite_run("dcf_lint_mapping", tests);
}

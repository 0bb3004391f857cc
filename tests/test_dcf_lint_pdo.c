/* Communication parameters of PDOs. */
#include "support/lint.h"
#include "support/suite.h"

#define COMMISSIONED "[DeviceComissioning]\nNodeID=5\nBaudrate=500\n"
#define SYNC         VALUE("1005", "7", "rw", "0x80")
/* Communication parameters and what they have besides. */
#define PDO(name, count, highest, cob_id, type)                                                    \
    RECORD_OF(name, count)                                                                         \
    VALUE(name "sub0", "5", "ro", highest)                                                         \
    VALUE(name "sub1", "7", "rw", cob_id) VALUE(name "sub2", "5", "rw", type)
#define NO_MAPPING(name)   RECORD_OF(name, 1) VALUE(name "sub0", "5", "rw", "0")
#define RPDO(type)         PDO("1400", 3, "2", "$NODEID+0x200", type) NO_MAPPING("1600")
#define TPDO(cob_id, type) PDO("1800", 3, "2", cob_id, type) NO_MAPPING("1A00")
#define TIMES(inhibit, event)                                                                      \
    PDO("1800", 5, "5", "$NODEID+0x180", "255")                                                    \
    VALUE("1800sub3", "6", "rw", inhibit) VALUE("1800sub5", "6", "rw", event) NO_MAPPING("1A00")
#define START(value)                                                                               \
    PDO("1800", 4, "6", "$NODEID+0x180", "255")                                                    \
    VALUE("1800sub6", "5", "rw", value) NO_MAPPING("1A00")

static const struct lint_row parameters_rows[] = {
    { "an RPDO", RPDO("255"), "" },
    { "without mapping", PDO("1400", 3, "2", "$NODEID+0x200", "254"),
      "5 pdo-without-mapping: 1400h: an object 1600h (PDO mapping) expected, it is missing\n" },
    { "the last RPDO without mapping", PDO("15FF", 3, "2", "0x201", "254"),
      "5 pdo-without-mapping: 15FFh: an object 17FFh (PDO mapping) expected, it is missing\n" },
    { "the last TPDO without mapping", PDO("19FF", 3, "2", "0x201", "254"),
      "5 pdo-without-mapping: 19FFh: an object 1BFFh (PDO mapping) expected, it is missing\n" },
    { "the last mappings alone", NO_MAPPING("17FF") NO_MAPPING("1BFF"),
      "5 mapping-without-pdo: 17FFh: an object 15FFh (PDO communication parameters) expected, it "
      "is missing\n"
      "14 mapping-without-pdo: 1BFFh: an object 19FFh (PDO communication parameters) expected, it "
      "is missing\n" },
    { "a mapping alone", NO_MAPPING("1A00"),
      "5 mapping-without-pdo: 1A00h: an object 1800h (PDO communication parameters) expected, it "
      "is missing\n" },
    { "no transmission type",
      RECORD_OF("1400", 2) VALUE("1400sub0", "5", "ro", "1")
          VALUE("1400sub1", "7", "rw", "$NODEID+0x200") NO_MAPPING("1600"),
      "5 known-sub: 1400h: a sub-index 2 expected (CiA 301), it is missing\n" },
    { "a reserved type", RPDO("241"),
      "19 transmission-type: 1400h:02: a transmission type of 0..240, 254 or 255 expected, there "
      "is 241\n" },
    { "RTR for an RPDO", RPDO("253"),
      "19 transmission-type: 1400h:02: a transmission type of 0..240, 254 or 255 expected, there "
      "is 253\n" },
    { "a reserved type of a TPDO", TPDO("0x80000000", "251"),
      "19 transmission-type: 1800h:02: a transmission type of 0..240, 252, 253, 254 or 255 "
      "expected, there is 251\n" },
    { "a reserved type to be written",
      RECORD_OF("1400", 3) VALUE("1400sub0", "5", "ro", "2") VALUE("1400sub1", "7", "rw",
                                                                   "$NODEID+0x200")
          ENTRY("1400sub2", "5", "rw", "DefaultValue=255\nParameterValue=252") NO_MAPPING("1600"),
      "20 transmission-type: 1400h:02: a transmission type of 0..240, 254 or 255 expected, there "
      "is 252\n" },
    { "RTR for a TPDO", TPDO("$NODEID+0x180", "253"), "" },
    { "RTR for a TPDO that refuses it", TPDO("$NODEID+0x40000180", "253"),
      "19 type-without-rtr: 1800h:02: a COB-ID that allows RTR (bit 30 is 0) expected for "
      "transmission type 253\n" },
    { "SYNC", TPDO("$NODEID+0x180", "240") SYNC, "" },
    { "no SYNC", TPDO("$NODEID+0x180", "240"),
      "19 type-without-sync: 1800h:02: an object 1005h (COB-ID SYNC) expected for transmission "
      "type 240\n" },
    { "no SYNC for one that is off", TPDO("0x80000000", "240"), "" },
    { "an event timer", TIMES("1000", "100"), "" },
    { "no event timer", TIMES("1000", "0"), "" },
    { "an event timer that is too short", TIMES("1001", "100"),
      "29 event-and-inhibit: 1800h:05: an event timer not below the inhibit time (1001 x 100 us) "
      "expected, there are 100 ms\n" },
    { "a start value", START("240"), "" },
    { "a start value to which the counter comes", START("10") VALUE("1019", "5", "rw", "10"), "" },
    { "a start value to which the counter does not come",
      START("11") VALUE("1019", "5", "rw", "10"),
      "24 sync-start: 1800h:06: a SYNC start value of 0..10 expected (1019h), there is 11\n" },
    { "a start value that is too high", START("241"),
      "24 sync-start: 1800h:06: a SYNC start value of 0..240 expected, there is 241\n" },
};

START_TEST(parameters)
{
    lint_check(&parameters_rows[_i]);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("dcf_lint_pdo");

    tcase_add_loop_test(tests, parameters, 0, ROWS(parameters_rows));
    return suite_run("dcf_lint_pdo", tests);
}

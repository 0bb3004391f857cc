#include "dcf/dcf.h"
#include "support/ccf_make.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct ccf_make makes[] = {
    { "nothing", U16("1017", D("500")), "", "" },
    { "by index, whatever the order of the file",
      U8("2001", P("1")) U8("2000", P("2")) RECORD("3000") U8("3000subA", P("10"))
          U8("3000sub2", P("2")),
      "2000:00 02\n2001:00 01\n3000:02 02\n3000:0A 0A\n", "" },
    { "the reference example",
      U16("1017", D("0") P("500")) RPDO(D("$NODEID+0x200") P("$NODEID+0x200"))
          U8("1400sub2", D("255") P("1")),
      "1017:00 F401\n1400:01 05020080\n1400:02 01\n1400:01 05020000\n", "" },
    { "the example with a mapping",
      U16("1017", D("0") P("500")) RPDO(D("$NODEID+0x200") P("$NODEID+0x200"))
          U8("1400sub2", D("255") P("1")) MAPPING(P("2"), P("0x62000108"), P("0x62000208")),
      "1017:00 F401\n1400:01 05020080\n1400:02 01\n1600:00 00\n1600:01 08010062\n"
      "1600:02 08020062\n1600:00 02\n1400:01 05020000\n",
      "" },
    { "all types, in the size of the type",
      ENTRY("2000", "1", "rw", P("1")) ENTRY("2001", "4", "rw", P("-2"))
          ENTRY("2002", "9", "rw", P("text")) ENTRY("2003", "0x15", "rw", P("-1"))
              ENTRY("2004", "8", "rw", P("1.5")) ENTRY("2005", "0x16", "rw", P("$NODEID")),
      "2000:00 01\n2001:00 FEFFFFFF\n2002:00 74657874\n2003:00 FFFFFFFFFFFFFFFF\n"
      "2004:00 0000C03F\n2005:00 050000\n",
      "" },
    { "a transmit PDO: sub-indices 2, 3, 5, 6; bit 30 kept",
      RECORD("1801") U32("1801sub1", P("0x40000181")) U8("1801sub6", P("1"))
          U16("1801sub5", P("100")) U16("1801sub3", P("50")) U8("1801sub2", P("254")),
      "1801:01 810100C0\n1801:02 FE\n1801:03 3200\n1801:05 6400\n1801:06 01\n"
      "1801:01 81010040\n",
      "" },
    { "bit 29 kept", RPDO(P("0x3FFFFFFF")), "1400:01 FFFFFFBF\n1400:01 FFFFFF3F\n", "" },
    { "another emergency COB-ID: switched off first", U32("1014", D("$NODEID+0x80") P("0xA0")),
      "1014:00 A0000080\n1014:00 A0000000\n", "" },
    { "an emergency consumer of another node, one of none yet",
      RECORD("1028") U32("1028sub1", D("0x81") P("0x82"))
          U32("1028sub2", D("0x80000000") P("0x83")),
      "1028:01 82000080\n1028:01 82000000\n1028:02 83000000\n", "" },
    { "the same emergency COB-ID, or switched off",
      U32("1014", D("$NODEID+0x80") P("$NODEID+0x80")) RECORD("1028")
          U32("1028sub1", D("0x81") P("0x80000082")),
      "1014:00 85000000\n1028:01 82000080\n", "" },
    { "the COB-IDs of another SDO: switched off first",
      RECORD("1201") U32("1201sub1", D("0x601") P("0x602")) U32("1201sub2", D("0x581") P("0x582"))
          U8("1201sub3", P("7")),
      "1201:01 02060080\n1201:01 02060000\n1201:02 82050080\n1201:02 82050000\n1201:03 07\n", "" },
    { "a PDO that stays off", RPDO(P("0x80000205")) U8("1400sub2", P("1")),
      "1400:01 05020080\n1400:02 01\n", "" },
    { "only the mapping: the default COB-ID",
      RPDO(D("$NODEID+0x200")) MAPPING(P("1"), P("0x62000108"), ""),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:00 01\n1400:01 05020000\n", "" },
    { "only the mapping, off by default",
      RPDO(D("$NODEID+0x80000200")) MAPPING(P("1"), P("0x62000108"), ""),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:00 01\n", "" },
    { "only the number of mapped objects",
      RPDO(D("0x205")) MAPPING(D("2") P("1"), D("0x62000108"), D("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:00 01\n1400:01 05020000\n", "" },
    { "a mapping of nothing", RPDO(D("0x205")) MAPPING(P("0"), P("0"), P("0")),
      "1400:01 05020080\n1600:00 00\n1400:01 05020000\n", "" },
    { "mapped objects beyond their number",
      RPDO(D("0x205")) MAPPING(P("1"), P("0x62000108"), P("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:00 01\n1400:01 05020000\n",
      "26: warning: 1600h:02: at most 1 mapped objects expected (sub-index 0), this is one more: "
      "not written\n" },
    { "the number of mapped objects is missing",
      RPDO(D("0x205")) MAPPING("", P("0x62000108"), P("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:02 08020062\n1600:00 02\n"
      "1400:01 05020000\n",
      "12: warning: 1600h:00 ParameterValue: the number of mapped objects expected, it is "
      "missing: taken as 2\n" },
    { "a compact mapping, which has no value for that number",
      RPDO(D("0x205")) U32("1600", "ObjectType=8\nCompactSubObj=4\n[1600Value]\n1=0x62000108\n"
                                   "2=0x62000208\n"),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:02 08020062\n1600:00 02\n"
      "1400:01 05020000\n",
      "" },
    { "one of two default mappings changed",
      RPDO(D("0x205")) MAPPING(D("2"), P("0x20000108"), D("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:01 08010020\n1600:00 02\n1400:01 05020000\n",
      "12: warning: 1600h:00 ParameterValue: the number of mapped objects expected, it is "
      "missing: taken as 2\n" },
    { "a COB-ID without a value", RPDO("") U8("1400sub2", P("1")), "1400:02 01\n",
      "4: warning: 1400h:01: a writable COB-ID with a value expected, there is none: the PDO is "
      "configured without switching it off\n" },
    { "a COB-ID that is fixed",
      RECORD("1400") ENTRY("1400sub1", "7", "const", D("0x205")) U8("1400sub2", P("1")),
      "1400:02 01\n",
      "4: warning: 1400h:01: a writable COB-ID with a value expected, there is none: the PDO is "
      "configured without switching it off\n" },
    { "a fixed mapping",
      RPDO(D("0x205") P("0x206")) RECORD("1600") ENTRY("1600sub0", "5", "const", D("1") P("1"))
          ENTRY("1600sub1", "7", "ro", D("0x62000108") P("0x62000108")),
      "1400:01 06020080\n1400:01 06020000\n", "" },
    { "the reserved sub-index of a PDO", RPDO(D("0x205")) U8("1400sub4", P("1")),
      "1400:01 05020080\n1400:01 05020000\n",
      "13: warning: 1400h:04 ParameterValue: none expected, the sub-index is reserved: not "
      "written\n" },
    { "two PDOs, receive before transmit",
      RECORD("1800") U32("1800sub1", P("0x185")) RECORD("1401") U32("1401sub1", P("0x305"))
          RPDO(P("0x205")),
      "1400:01 05020080\n1400:01 05020000\n1401:01 05030080\n1401:01 05030000\n"
      "1800:01 85010080\n1800:01 85010000\n",
      "" },
    { "SYNC behind the others, before the PDOs",
      U32("1005", P("0x40000080")) U32("1006", P("1000")) U8("1019", P("10")) U32("1007", P("5"))
          U8("2000", P("1")) RPDO(P("0x205")),
      "1007:00 05000000\n2000:00 01\n1019:00 0A\n1006:00 E8030000\n1005:00 80000040\n"
      "1400:01 05020080\n1400:01 05020000\n",
      "" },
    { "SYNC counter of a device that produces by default",
      U32("1005", D("0x40000080") P("0x40000080")) U32("1006", D("1000") P("2000"))
          U8("1019", D("0") P("10")),
      "1005:00 80000000\n1006:00 00000000\n1019:00 0A\n1006:00 D0070000\n1005:00 80000040\n", "" },
    { "only the SYNC counter of such a device",
      U32("1005", D("0x40000080")) U32("1006", D("1000")) U8("1019", D("0") P("10")),
      "1005:00 80000000\n1006:00 00000000\n1019:00 0A\n1006:00 E8030000\n1005:00 80000040\n", "" },
    { "another SYNC identifier for such a device",
      U32("1005", D("0x40000080") P("0x40000081")) U32("1006", D("1000")),
      "1005:00 80000000\n1005:00 81000040\n", "" },
    { "such a device stops producing", U32("1005", D("0x40000080") P("0x80")), "1005:00 80000000\n",
      "" },
    { "the counter where only the period has a default",
      U32("1005", D("0x80")) U32("1006", D("1000")) U8("1019", P("10")),
      "1006:00 00000000\n1019:00 0A\n1006:00 E8030000\n", "" },
    { "error control last of all but PDOs",
      U16("1017", P("500")) U8("100D", P("3")) U16("100C", P("100")) RECORD("1016")
          U32("1016sub1", P("0x107D0")) U8("2000", P("1")) U32("1015", P("1")),
      "1015:00 01000000\n2000:00 01\n100C:00 6400\n100D:00 03\n1016:01 D0070100\n1017:00 F401\n",
      "" },
    { "consumers that change places",
      RECORD("1016") U32("1016sub1", D("0x107D0") P("0x207D0"))
          U32("1016sub2", D("0x207D0") P("0x107D0")),
      "1016:01 00000000\n1016:02 00000000\n1016:01 D0070200\n1016:02 D0070100\n", "" },
    { "consumers that do not",
      RECORD("1016") U32("1016sub1", D("0x107D0") P("0x307D0"))
          U32("1016sub2", D("0x207D0") P("0x107D0")),
      "1016:01 D0070300\n1016:02 D0070100\n", "" },
    { "the configuration date at the end",
      RECORD("1020") U32("1020sub1", P("1")) U32("1020sub2", P("2")) U8("2000", P("1"))
          RPDO(P("0x205")) U16("1017", P("5")),
      "2000:00 01\n1017:00 0500\n1400:01 05020080\n1400:01 05020000\n1020:01 01000000\n"
      "1020:02 02000000\n",
      "" },
    { "objects that are left alone",
      U32("1000", P("1")) RECORD("1010") U32("1010sub1", P("1")) RECORD("1011")
          U32("1011sub1", P("1")) RECORD("1F51") U8("1F51sub1", P("1")),
      "",
      "5: warning: 1000h:00: a value for a writable entry expected, configurations leave this "
      "object alone: not written\n"
      "13: warning: 1010h:01: a value for a writable entry expected, configurations leave this "
      "object alone: not written\n"
      "21: warning: 1011h:01: a value for a writable entry expected, configurations leave this "
      "object alone: not written\n"
      "29: warning: 1F51h:01: a value for a writable entry expected, configurations leave this "
      "object alone: not written\n" },
    { "read-only and protected entries",
      ENTRY("2000", "5", "ro", P("1")) ENTRY("2001", "5", "const", P("1"))
          U8("2002", "ObjFlags=1\n" P("1")) U8("2003", "ObjFlags=2\n" P("1"))
              ENTRY("2004", "5", "wo", P("1")) ENTRY("2005", "5", "rww", P("1"))
                  ENTRY("2006", "5", "rwr", P("1")),
      "2003:00 01\n2004:00 01\n2005:00 01\n2006:00 01\n",
      "5: warning: 2000h:00: a value for a writable entry expected, this one is read-only: not "
      "written\n"
      "10: warning: 2001h:00: a value for a writable entry expected, this one is read-only: not "
      "written\n"
      "16: warning: 2002h:00: a value for a writable entry expected, ObjFlags refuses to write "
      "this one: not written\n" },
    { "a read-only entry that has the value anyway", ENTRY("2000", "5", "ro", D("1") P("0x01")), "",
      "" },
    { "a formula too large for its type", U8("2000", P("$NODEID+251")), NULL,
      "5: error: 2000h:00 ParameterValue: a node-ID expected with which the formula fits "
      "UNSIGNED8, it is 5\n" },
    { "a formula that just fits", U8("2000", P("250+$NODEID")), "2000:00 FF\n", "" },
};

START_TEST(test_order)
{
    struct dcf_ccf_options options = { .node_id = 5 };

    ccf_make_check(&makes[_i], &options);
}
END_TEST

START_TEST(test_old_style)
{
    static const struct ccf_make make = {
        "old style",
        RPDO(D("0x205")) MAPPING(P("2"), P("0x62000108"), P("0x62000208")),
        "1400:01 05020080\n1600:00 02\n1600:01 08010062\n1600:02 08020062\n1400:01 05020000\n",
        "",
    };
    struct dcf_ccf_options options = { .node_id = 5, .old_style = true };

    ccf_make_check(&make, &options);
}
END_TEST

START_TEST(test_no_node_id)
{
    static const struct ccf_make plain = { "no formula", U8("2000", P("1")), "2000:00 01\n", "" };
    static const struct ccf_make formula = {
        "a formula",
        U8("2000", P("$NODEID+1")),
        NULL,
        "5: error: 2000h:00 ParameterValue: a node-ID expected with which the formula fits "
        "UNSIGNED8, it is 0\n",
    };
    struct dcf_ccf_options options = { .node_id = 0 };

    ccf_make_check(&plain, &options);
    ccf_make_check(&formula, &options);
    ck_assert_int_eq(ccf_make_messages.report.error_kind, DCF_ERROR_WRONG_NODE_ID);
}
END_TEST

/* The line of the value; for what has none of its own, that of its section. */
START_TEST(test_lines)
{
    static const struct dcf_ccf_options options = { .node_id = 5 };
    static const char file[] = U16("1017", P("500")) RPDO(D("0x205") P("0x206"));
    struct dcf dcf;
    struct ccf ccf;

    ccf_make_parse(file, &dcf);
    ck_assert_int_eq(dcf_make_ccf(&dcf, &options, &ccf_make_messages.report, &ccf), CO_OK);
    ck_assert_str_eq(ccf_make_format(&ccf), "1017:00 F401\n1400:01 06020080\n1400:01 06020000\n");
    ck_assert_uint_eq(ccf_line(&ccf, 1), 5);
    ck_assert_uint_eq(ccf_line(&ccf, 2), 14);
    ck_assert_uint_eq(ccf_line(&ccf, 3), 14);
    ccf_done(&ccf);
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_empty_has_its_count)
{
    struct dcf_ccf_options options = { .node_id = 5 };
    struct dcf dcf;
    struct ccf ccf;

    ccf_make_parse(U8("2000", ""), &dcf);
    ck_assert_int_eq(dcf_make_ccf(&dcf, &options, &ccf_make_messages.report, &ccf), CO_OK);
    ck_assert_uint_eq(ccf.size, 4);
    ck_assert_uint_eq(ccf_count(&ccf), 0);
    ccf_done(&ccf);
    dcf_done(&dcf);
}
END_TEST

#define FILE_ENTRY(name) "[2000]\nParameterName=x\nObjectType=2\nDownloadFile=" name "\n"

static enum co_err give_file(void *context, const char *name, uint8_t **ret_bytes, size_t *ret_size)
{
    const char *expected = context;

    ck_assert_str_eq(name, expected);
    if (strcmp(name, "gone.bin") == 0)
        return CO_ERR_IO;
    *ret_size = 5;
    *ret_bytes = malloc(*ret_size);
    ck_assert_ptr_nonnull(*ret_bytes);
    memcpy(*ret_bytes, "abcde", *ret_size);
    return CO_OK;
}

static const struct {
    const char *name;
    const char *dcf;
    const char *expected;
    const char *messages;
} downloads[] = {
    { "prog.bin", FILE_ENTRY("prog.bin"), "2000:00 6162636465\n", "" },
    { "sub/a..b", FILE_ENTRY("sub/a..b"), "2000:00 6162636465\n", "" },
    { "gone.bin", FILE_ENTRY("gone.bin"), NULL,
      "1: error: 2000h:00 DownloadFile: a readable file expected, \"gone.bin\": the operating "
      "system refused\n" },
#define REFUSED(file)                                                                              \
    {                                                                                              \
        "", FILE_ENTRY(file), NULL,                                                                \
            "1: error: 2000h:00 DownloadFile: a name below the folder of this file expected, "     \
            "there is \"" file "\"\n"                                                              \
    }
    REFUSED("/etc/passwd"),
    REFUSED("../up.bin"),
    REFUSED("a/../../up.bin"),
    REFUSED("a/.."),
    REFUSED("a\\..\\up.bin"),
    REFUSED("\\\\server\\file"),
    REFUSED("C:up.bin"),
};

START_TEST(test_download_file)
{
    char name[32];
    struct dcf_ccf_options options = { .node_id = 5, .read_file = give_file, .context = name };
    struct ccf_make make = { downloads[_i].name, downloads[_i].dcf, downloads[_i].expected,
                             downloads[_i].messages };

    strcpy(name, downloads[_i].name);
    ccf_make_check(&make, &options);
}
END_TEST

START_TEST(test_download_file_without_reader)
{
    static const struct ccf_make make = {
        "nobody reads files",
        FILE_ENTRY("prog.bin"),
        NULL,
        "1: error: 2000h:00 DownloadFile: a readable file expected, \"prog.bin\": not found\n",
    };
    struct dcf_ccf_options options = { .node_id = 5 };

    ccf_make_check(&make, &options);
}
END_TEST

static Suite *dcf_ccf_suite(void)
{
    Suite *suite = suite_create("dcf_ccf");
    TCase *tests = tcase_create("dcf_ccf");

    tcase_add_loop_test(tests, test_order, 0, sizeof makes / sizeof makes[0]);
    tcase_add_test(tests, test_old_style);
    tcase_add_test(tests, test_no_node_id);
    tcase_add_test(tests, test_lines);
    tcase_add_test(tests, test_empty_has_its_count);
    tcase_add_loop_test(tests, test_download_file, 0, sizeof downloads / sizeof downloads[0]);
    tcase_add_test(tests, test_download_file_without_reader);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(dcf_ccf_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

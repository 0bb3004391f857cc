/* What a concise DCF has of the values of a file: each type's bytes, and whose value it is. */
#include "support/ccf_make.h"

#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct dcf_ccf_options node_5 = { .node_id = 5 };
static const struct dcf_ccf_options all_of_5 = { .node_id = 5, .all = true };

/* ---- each type --------------------------------------------------------------------------------*/

static const struct {
    const char *type, *value, *bytes;
} types[] = {
    { "0x0001", "1", "01" },
    { "0x0001", "0", "00" },
    { "0x0002", "-128", "80" },
    { "0x0002", "0xFF", "FF" },
    { "0x0003", "-2", "FEFF" },
    { "0x0003", "0x7FFF", "FF7F" },
    { "0x0004", "-559038737", "EFBEADDE" },
    { "0x0010", "-8388608", "000080" },
    { "0x0010", "0x123456", "563412" },
    { "0x0012", "-549755813888", "0000000080" },
    { "0x0012", "0x123456789A", "9A78563412" },
    { "0x0013", "-2", "FEFFFFFFFFFF" },
    { "0x0013", "0x123456789ABC", "BC9A78563412" },
    { "0x0014", "-2", "FEFFFFFFFFFFFF" },
    { "0x0014", "0x123456789ABCDE", "DEBC9A78563412" },
    { "0x0015", "-9223372036854775808", "0000000000000080" },
    { "0x0015", "0x123456789ABCDEF0", "F0DEBC9A78563412" },
    { "0x0005", "255", "FF" },
    { "0x0006", "0xBEEF", "EFBE" },
    { "0x0007", "4294967295", "FFFFFFFF" },
    { "0x0016", "16777215", "FFFFFF" },
    { "0x0016", "0x123456", "563412" },
    { "0x0018", "0x123456789A", "9A78563412" },
    { "0x0018", "1099511627775", "FFFFFFFFFF" },
    { "0x0019", "0x123456789ABC", "BC9A78563412" },
    { "0x001A", "0x123456789ABCDE", "DEBC9A78563412" },
    { "0x001B", "18446744073709551615", "FFFFFFFFFFFFFFFF" },
    { "0x0007", "$NODEID+0x80000180", "85010080" },
    { "0x001B", "$NODEID+0x100000000", "0500000001000000" },
    { "0x0008", "1.5", "0000C03F" },
    { "0x0008", "-0.1", "CDCCCCBD" },
    { "0x0008", "0x3FC00000", "0000C03F" },
    { "0x0008", "1.5E3", "0080BB44" },
    { "0x0011", "1.5", "000000000000F83F" },
    { "0x0011", "0xC008000000000000", "00000000000008C0" },
    { "0x0009", "pump 1; spare", "70756D7020313B207370617265" },
    { "0x000A", "00 ff A5", "00FFA5" },
    { "0x000A", "DEADBEEF", "DEADBEEF" },
    { "0x000B", "0041 20AC", "4100AC20" },
    { "0x000B", "\xE2\x82\xAC", "AC20" },
    { "0x000C", "365 43200000", "002E93026D01" },
    { "0x000C", "002E93026D01", "002E93026D01" },
    { "0x000D", "1 500", "F40100000100" },
    { "0x000F", "01020304", "01020304" },
};

START_TEST(test_type)
{
    char file[200], expected[100];
    struct dcf dcf;
    struct ccf ccf;

    snprintf(file, sizeof file, "[2000]\nParameterName=x\nAccessType=rw\nDataType=%s\n%s%s\n",
             types[_i].type, "DefaultValue=\nParameterValue=", types[_i].value);
    snprintf(expected, sizeof expected, "2000:00 %s\n", types[_i].bytes);
    ccf_make_parse(file, &dcf);
    ck_assert_int_eq(dcf_make_ccf(&dcf, &node_5, &ccf_make_messages.report, &ccf), CO_OK);
    ck_assert_msg(strcmp(ccf_make_format(&ccf), expected) == 0, "%s %s: %s", types[_i].type,
                  types[_i].value, ccf_make_format(&ccf));
    ck_assert_uint_eq(ccf.size, 4 + 7 + strlen(types[_i].bytes) / 2);
    ccf_done(&ccf);
    dcf_done(&dcf);
}
END_TEST

static enum co_err give_file(void *context, const char *name, uint8_t **ret_bytes, size_t *ret_size)
{
    (void)context;
    *ret_size = strcmp(name, "empty") == 0 ? 0 : 300;
    *ret_bytes = malloc(*ret_size + 1);
    ck_assert_ptr_nonnull(*ret_bytes);
    memset(*ret_bytes, 0xA5, *ret_size);
    return CO_OK;
}

/* A file of any length, also of none; its contents come before a value of the same entry. */
START_TEST(test_domain)
{
    static const struct dcf_ccf_options options = { .node_id = 5, .read_file = give_file };
    static const char file[] = "[2000]\nParameterName=x\nObjectType=2\nDownloadFile=program\n"
                               "[2001]\nParameterName=x\nObjectType=2\nDownloadFile=empty\n"
                               "ParameterValue=0102\n";
    struct ccf_reader reader;
    struct ccf_entry entry;
    struct dcf dcf;
    struct ccf ccf;

    ccf_make_parse(file, &dcf);
    ck_assert_int_eq(dcf_make_ccf(&dcf, &options, &ccf_make_messages.report, &ccf), CO_OK);
    ck_assert_uint_eq(ccf.size, 4 + 7 + 300 + 7);
    ccf_reader_init(&reader, &ccf);
    ck_assert(ccf_read(&reader, &entry));
    ck_assert_uint_eq(entry.index, 0x2000);
    ck_assert_uint_eq(entry.size, 300);
    ck_assert_uint_eq(entry.value[299], 0xA5);
    ck_assert(ccf_read(&reader, &entry));
    ck_assert_uint_eq(entry.index, 0x2001);
    ck_assert_uint_eq(entry.size, 0);
    ccf_done(&ccf);
    dcf_done(&dcf);
}
END_TEST

/* ---- ParameterValue and DefaultValue ----------------------------------------------------------*/

static const struct ccf_make parameters[] = {
    { "DefaultValues are not written", U16("1017", D("500")) U8("2000", D("1") P("2")),
      "2000:00 02\n", "" },
    { "a ParameterValue of 0", U16("1017", D("500") P("0")), "1017:00 0000\n", "" },
    { "an empty ParameterValue is none", U16("1017", D("500") P("")), "", "" },
    { "an empty one of a text", ENTRY("2000", "9", "rw", D("text") P("")), "", "" },
    { "TIME that is consumed: not in use, then with its new identifier",
      U32("1012", D("0x80000100") P("0x80000101")), "1012:00 01010000\n1012:00 01010080\n", "" },
    { "TIME that is not", U32("1012", D("0x100") P("0x80000101")), "1012:00 01010080\n", "" },
    { "TIME that ends", U32("1012", D("0x80000100") P("0x101")), "1012:00 01010000\n", "" },
    { "TIME that is produced as well", U32("1012", D("0x80000100") P("0xC0000100")),
      "1012:00 000100C0\n", "" },
};

START_TEST(test_parameters)
{
    ccf_make_check(&parameters[_i], &node_5);
}
END_TEST

static const struct ccf_make defaults[] = {
    { "the ParameterValue, else the DefaultValue",
      U16("1017", D("500")) U8("2000", D("1") P("2")) U8("2001", ""), "2000:00 02\n1017:00 F401\n",
      "" },
    { "only what may be written, without a word",
      ENTRY("2000", "5", "ro", D("1")) ENTRY("2001", "5", "const", D("1"))
          U8("2002", "ObjFlags=1\n" D("1")) ENTRY("2003", "5", "wo", D("1")) U32("1000", D("1")),
      "2003:00 01\n", "" },
    { "formulas", U32("1014", D("$NODEID+0x80")), "1014:00 85000000\n", "" },
    { "a formula that does not fit", U8("2000", D("$NODEID+251")), NULL,
      "5: error: 2000h:00 DefaultValue: a node-ID expected with which the formula fits UNSIGNED8, "
      "it is 5\n" },
    { "not what the device refuses", U8("2000", D("9") "HighLimit=8\n") U8("2001", D("8")),
      "2001:00 08\n", "" },
    { "a PDO with its default values",
      RPDO(D("$NODEID+0x200")) U8("1400sub2", D("255")) U8("1400sub4", D("0"))
          MAPPING(D("1"), D("0x62000108"), D("0x62000208")),
      "1400:01 05020080\n1400:02 FF\n1600:00 00\n1600:01 08010062\n1600:00 01\n"
      "1400:01 05020000\n",
      "" },
    { "a default mapping to which one is added",
      RPDO(D("0x205")) MAPPING(D("1"), D("0x62000108"), P("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:02 08020062\n1600:00 02\n"
      "1400:01 05020000\n",
      "12: warning: 1600h:00 ParameterValue: the number of mapped objects expected, it is "
      "missing: taken as 2\n" },
    { "a default object beyond the number of mapped ones",
      RPDO(D("0x205")) MAPPING(D("1"), P("0x62000108"), D("0x62000208")),
      "1400:01 05020080\n1600:00 00\n1600:01 08010062\n1600:00 01\n1400:01 05020000\n",
      "12: warning: 1600h:00 ParameterValue: the number of mapped objects expected, it is "
      "missing: taken as 1\n" },
    { "a PDO that is off by default", RPDO(D("$NODEID+0x80000200")), "1400:01 05020080\n", "" },
    { "SYNC that is produced by default",
      U32("1005", D("0x40000080")) U32("1006", D("1000")) U8("1019", D("10")),
      "1005:00 80000000\n1006:00 00000000\n1019:00 0A\n1006:00 E8030000\n1005:00 80000040\n", "" },
    { "consumers that change places with a default",
      RECORD("1016") U32("1016sub1", D("0x107D0") P("0x207D0")) U32("1016sub2", D("0x207D0"))
          U32("1016sub3", D("0")),
      "1016:01 00000000\n1016:02 00000000\n1016:03 00000000\n1016:01 D0070200\n"
      "1016:02 D0070200\n1016:03 00000000\n",
      "" },
};

START_TEST(test_all)
{
    ccf_make_check(&defaults[_i], &all_of_5);
}
END_TEST

/* The same file gives the same bytes, whatever the order of its sections. */
START_TEST(test_deterministic)
{
    static const char *const files[] = {
        U8("2000", P("1")) U16("1017", P("500")) RPDO(P("0x205")) U32("1005", P("0x81")),
        RPDO(P("0x205")) U32("1005", P("0x81")) U16("1017", P("500")) U8("2000", P("1")),
    };
    struct ccf ccf[2];
    struct dcf dcf;

    for (size_t i = 0; i < 2; i++) {
        ccf_make_parse(files[i], &dcf);
        ck_assert_int_eq(dcf_make_ccf(&dcf, &node_5, &ccf_make_messages.report, &ccf[i]), CO_OK);
        dcf_done(&dcf);
    }
    ck_assert_uint_eq(ccf[0].size, ccf[1].size);
    ck_assert_mem_eq(ccf[0].bytes, ccf[1].bytes, ccf[0].size);
    ccf_done(&ccf[0]);
    ccf_done(&ccf[1]);
}
END_TEST

static Suite *dcf_ccf_values_suite(void)
{
    Suite *suite = suite_create("dcf_ccf_values");
    TCase *tests = tcase_create("dcf_ccf_values");

    tcase_add_loop_test(tests, test_type, 0, sizeof types / sizeof types[0]);
    tcase_add_test(tests, test_domain);
    tcase_add_loop_test(tests, test_parameters, 0, sizeof parameters / sizeof parameters[0]);
    tcase_add_loop_test(tests, test_all, 0, sizeof defaults / sizeof defaults[0]);
    tcase_add_test(tests, test_deterministic);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(dcf_ccf_values_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

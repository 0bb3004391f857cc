#include "dcf/dcf.h"
#include "support/dcf_file.h"
#include "support/guard.h"
#include "support/hex.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

static struct messages messages;
static struct dcf dcf;

static enum co_err parse(const char *text)
{
    struct guard guard;
    enum co_err err;

    messages_init(&messages);
    guard_init(&guard, text, strlen(text));
    err = dcf_parse(guard.bytes, strlen(text), &messages.report, &dcf);
    guard_done(&guard);
    return err;
}

static void parse_clean(const char *text)
{
    ck_assert_int_eq(parse(text), CO_OK);
    ck_assert_str_eq(messages.text, "");
}

static const char *value_of(const struct dcf_value *value)
{
    static char text[200];

    if (!value->given)
        return "-";
    return hex_format(value->bytes, value->size, text, sizeof text);
}

static unsigned count_lines(const char *text)
{
    unsigned count = 0;

    for (; *text; text++)
        count += *text == '\n';
    return count;
}

START_TEST(test_clean_file)
{
    const struct dcf_entry *entry;

    parse_clean(CLEAN);
    ck_assert_uint_eq(count_lines(CLEAN), 62);
    ck_assert_uint_eq(count_lines(OBJECT("2000", "")), 62);
    ck_assert_uint_eq(dcf.count, 4);
    ck_assert(!dcf.is_dcf);
    ck_assert(!dcf.has_node_id);
    ck_assert_str_eq(dcf.vendor_name, "V");
    ck_assert_str_eq(dcf.product_name, "P");
    ck_assert_uint_eq(dcf.bit_rates, 1u << 5);
    ck_assert_uint_eq(dcf.granularity, 8);
    ck_assert_uint_eq(dcf.dummy_usage, 1u << 5);
    ck_assert_str_eq(dcf.modification_date, "05-15-2004");
    ck_assert_str_eq(dcf.modification_time, "09:45AM");
    entry = dcf_find(&dcf, 0x1018, 0);
    ck_assert_ptr_nonnull(entry);
    ck_assert_uint_eq(entry->object_type, 9);
    ck_assert_uint_eq(entry->type, OD_UNSIGNED8);
    ck_assert_uint_eq(entry->access, OD_CONST);
    ck_assert_uint_eq(entry->line, 54);
    ck_assert_uint_eq(entry->initial.line, 58);
    ck_assert_str_eq(value_of(&entry->initial), "01");
    ck_assert_uint_eq(dcf_find(&dcf, 0x1018, 1)->object_type, 7);
    ck_assert_ptr_null(dcf_find(&dcf, 0x1018, 2));
    ck_assert_ptr_null(dcf_find(&dcf, 0x1019, 0));
    dcf_done(&dcf);
    ck_assert_uint_eq(dcf.count, 0);
    dcf_done(&dcf);
}
END_TEST

#define DCF_PART                                                                                   \
    "[DeviceComissioning]\nNodeID=0x12\nNodeName=Pump 1\nBaudrate=250\nNetNumber=1\n"              \
    "NetworkName=N\nCANopenManager=0\nLSS_SerialNumber=\nNodeRefd=r\n"

START_TEST(test_commissioning)
{
    parse_clean(LINES(DCF_PART));
    ck_assert(dcf.is_dcf);
    ck_assert(dcf.has_node_id);
    ck_assert_uint_eq(dcf.node_id, 0x12);
    ck_assert_uint_eq(dcf.node_id_line, 64);
    ck_assert_str_eq(dcf.node_name, "Pump 1");
    ck_assert_uint_eq(dcf.baudrate, 250);
    ck_assert_uint_eq(dcf.baudrate_line, 66);
    dcf_done(&dcf);
}
END_TEST

#define TYPE_OBJECT(index, rest) VAR(index, "7", "ro") "ObjectType=5\n" rest
#define OF_TYPE(name, type)      VAR(name, type, "rw") "DefaultValue=1\n"

/* clang-format off */
static const char own_types[] = OBJECT("2000",
    TYPE_OBJECT("0040", "DefaultValue=24\n")
    TYPE_OBJECT("0041", "DefaultValue=0x1\n")
    TYPE_OBJECT("0042", "DefaultValue=25\n")
    TYPE_OBJECT("0043", "")
    "[2000]\nParameterName=x\nObjectType=9\nSubNumber=6\n"
    VAR("2000sub0", "5", "ro") "DefaultValue=6\n"
    OF_TYPE("2000sub1", "0x40")
    OF_TYPE("2000sub2", "0x41")
    OF_TYPE("2000sub3", "0x42")
    OF_TYPE("2000sub4", "0x43")
    OF_TYPE("2000sub5", "0x44"));
/* clang-format on */

/* Data types of the device, whose objects tell their size in bits. */
START_TEST(test_own_types)
{
    static const struct {
        uint8_t sub;
        uint8_t type;
        const char *initial;
    } subs[] = {
        { 0, OD_UNSIGNED8, "06" },
        { 1, OD_UNSIGNED24, "010000" },
        { 2, OD_BOOLEAN, "01" },
        { 3, 0, "-" },
        { 4, 0, "-" },
        { 5, 0, "-" },
    };

    ck_assert_int_eq(parse(own_types), CO_OK);
    for (size_t i = 0; i < sizeof subs / sizeof subs[0]; i++) {
        const struct dcf_entry *entry = dcf_find(&dcf, 0x2000, subs[i].sub);

        ck_assert_uint_eq(entry->type, subs[i].type);
        ck_assert_str_eq(value_of(&entry->initial), subs[i].initial);
    }
    ck_assert_uint_eq(count_lines(messages.text), 3);
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_device_info)
{
    static const char file[] =
        "[DEVICEINFO]\nvendorname=A; B\nVendorNumber=0x17\nProductNumber=256\n"
        "RevisionNumber=0x00010001\nBaudRate_10=1\nbaudrate_1000=1\nNrOfRXPDO=4\nNrOfTXPDO=0x10\n";

    ck_assert_int_eq(parse(file), CO_OK);
    ck_assert_str_eq(dcf.vendor_name, "A; B");
    ck_assert_ptr_null(dcf.product_name);
    ck_assert_uint_eq(dcf.vendor_number, 0x17);
    ck_assert_uint_eq(dcf.product_number, 256);
    ck_assert_uint_eq(dcf.revision_number, 0x10001);
    ck_assert_uint_eq(dcf.bit_rates, 0x81);
    ck_assert_uint_eq(dcf.rx_pdos, 4);
    ck_assert_uint_eq(dcf.tx_pdos, 16);
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_all_of_an_entry)
{
    const struct dcf_entry *entry;

    parse_clean(OBJECT("2000", "[2000]\nParameterName=Speed\nObjectType=0x07\nDataType=0x0003\n"
                               "AccessType=RWW\nDefaultValue=-5\nParameterValue=0x0010\n"
                               "LowLimit=0x8000\nHighLimit=0x7FFF\nPDOMapping=1\nObjFlags=0x2\n"
                               "Denotation=axis\nParamRefd=x\nSubNumber=0\nCompactSubObj=0\n"));
    entry = dcf_find(&dcf, 0x2000, 0);
    ck_assert_str_eq(entry->name, "Speed");
    ck_assert_uint_eq(entry->object_type, 7);
    ck_assert_uint_eq(entry->type, OD_INTEGER16);
    ck_assert_uint_eq(entry->access, OD_RWW);
    ck_assert(entry->mappable);
    ck_assert_uint_eq(entry->flags, 2);
    ck_assert_str_eq(entry->denotation, "axis");
    ck_assert_str_eq(value_of(&entry->initial), "FBFF");
    ck_assert_str_eq(value_of(&entry->parameter), "1000");
    ck_assert_uint_eq(entry->parameter.line, 69);
    ck_assert_str_eq(value_of(&entry->low), "0080");
    ck_assert_str_eq(value_of(&entry->high), "FF7F");
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_domain)
{
    const struct dcf_entry *entry;

    parse_clean(OBJECT("2000", "[2000]\nParameterName=Program\nObjectType=2\nDownloadFile=a.bin\n"
                               "UploadFile=b.bin\n"));
    entry = dcf_find(&dcf, 0x2000, 0);
    ck_assert_uint_eq(entry->type, OD_DOMAIN);
    ck_assert_uint_eq(entry->access, OD_RW);
    ck_assert_str_eq(entry->download_file, "a.bin");
    ck_assert_str_eq(entry->upload_file, "b.bin");
    ck_assert(!entry->initial.given);
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_formula)
{
    const struct dcf_entry *entry;
    uint8_t bytes[4];

    parse_clean(OBJECT("2000", VAR("2000", "7", "rw") "DefaultValue=$NODEID+0x200\n"));
    entry = dcf_find(&dcf, 0x2000, 0);
    ck_assert(entry->initial.has_node_id);
    ck_assert_uint_eq(dcf_value(&entry->initial, 5, bytes), 4);
    ck_assert_uint_eq(bytes[0], 5);
    ck_assert_uint_eq(bytes[1], 2);
    ck_assert_uint_eq(dcf_value(&entry->parameter, 5, bytes), 0);
    dcf_done(&dcf);
}
END_TEST

/* ---- compact objects and PDOs -------------------------------------------------------------- */

#define COMPACT(type, access, rest)                                                                \
    "[2100]\nParameterName=Item\nObjectType=8\nDataType=" type "\nAccessType=" access              \
    "\nCompactSubObj=3\n" rest

START_TEST(test_compact_object)
{
    parse_clean(OBJECT("2100", COMPACT("6", "rw",
                                       "DefaultValue=7\nLowLimit=1\nHighLimit=100\n"
                                       "[2100Name]\nNrOfEntries=1\n2=Speed\n"
                                       "[2100Value]\nNrOfEntries=2\n1=0x10\n3=99\n"
                                       "[2100Denotation]\nNrOfEntries=1\n3=Axis\n")));
    ck_assert_uint_eq(dcf.count, 8);
    ck_assert_uint_eq(dcf_find(&dcf, 0x2100, 0)->object_type, 8);
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 0)->initial), "03");
    ck_assert_uint_eq(dcf_find(&dcf, 0x2100, 0)->access, OD_CONST);
    ck_assert_str_eq(dcf_find(&dcf, 0x2100, 1)->name, "Item1");
    ck_assert_str_eq(dcf_find(&dcf, 0x2100, 2)->name, "Speed");
    ck_assert_str_eq(dcf_find(&dcf, 0x2100, 3)->denotation, "Axis");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 1)->initial), "0700");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 1)->parameter), "1000");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 2)->parameter), "-");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 3)->parameter), "6300");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x2100, 3)->low), "0100");
    dcf_done(&dcf);
}
END_TEST

static const char compact_pdos[] =
    "[DeviceInfo]\nGranularity=16\nNrOfRXPDO=3\nNrOfTXPDO=5\nCompactPDO=0x13\n"
    "[1401]\nParameterName=x\nObjectType=9\nSubNumber=1\n" VAR("1401sub0", "5", "const");

static void check_cob_id(uint16_t index, const char *bytes, bool has_node_id)
{
    const struct dcf_entry *entry = dcf_find(&dcf, index, 1);

    ck_assert_ptr_nonnull(entry);
    ck_assert_str_eq(value_of(&entry->initial), bytes);
    ck_assert_int_eq(entry->initial.has_node_id, has_node_id);
    ck_assert_uint_eq(entry->access, OD_RW);
}

START_TEST(test_compact_pdos)
{
    ck_assert_int_eq(parse(compact_pdos), CO_OK);
    check_cob_id(0x1400, "00020000", true);
    ck_assert_ptr_null(dcf_find(&dcf, 0x1401, 1));
    check_cob_id(0x1402, "00040000", true);
    ck_assert_ptr_null(dcf_find(&dcf, 0x1403, 0));
    check_cob_id(0x1800, "80010000", true);
    check_cob_id(0x1803, "80040000", true);
    check_cob_id(0x1804, "00000080", false);
    ck_assert_ptr_null(dcf_find(&dcf, 0x1805, 0));
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x1400, 0)->initial), "05");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x1400, 2)->initial), "FF");
    ck_assert_ptr_null(dcf_find(&dcf, 0x1400, 3));
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x1400, 5)->initial), "0000");
    ck_assert_str_eq(value_of(&dcf_find(&dcf, 0x1601, 4)->initial), "00000000");
    ck_assert_ptr_null(dcf_find(&dcf, 0x1601, 5));
    for (size_t i = 1; i < dcf.count; i++)
        ck_assert(dcf.entries[i - 1].index < dcf.entries[i].index ||
                  dcf.entries[i - 1].sub < dcf.entries[i].sub);
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_too_many_entries)
{
    static char file[40 * 600];
    size_t used = 0;

    for (unsigned i = 0; i < 600; i++)
        used += (size_t)snprintf(file + used, sizeof file - used,
                                 "[%X]\nDataType=5\nCompactSubObj=254\n", 0x2000 + i);
    ck_assert_int_eq(parse(file), CO_ERR_FORMAT);
    ck_assert_str_eq(messages.report.first_error,
                     "f: error: at most 131072 entries expected, there are more");
    ck_assert_uint_eq(messages.report.errors, 1);
    ck_assert_uint_eq(dcf.count, 0);
}
END_TEST

START_TEST(test_every_truncation)
{
    static const char file[] = LINES(DCF_PART) COMPACT("6", "rw", "[2100Value]\n1=$NODEID+5\n");
    struct guard guard;

    for (size_t size = 0; size < sizeof file; size++) {
        messages_init(&messages);
        guard_init(&guard, file, size);
        if (dcf_parse(guard.bytes, size, &messages.report, &dcf) == CO_OK)
            dcf_done(&dcf);
        else
            ck_assert_uint_gt(messages.report.errors, 0);
        guard_done(&guard);
    }
}
END_TEST

static Suite *dcf_suite(void)
{
    Suite *suite = suite_create("dcf");
    TCase *tests = tcase_create("dcf");

    tcase_add_test(tests, test_clean_file);
    tcase_add_test(tests, test_commissioning);
    tcase_add_test(tests, test_own_types);
    tcase_add_test(tests, test_device_info);
    tcase_add_test(tests, test_all_of_an_entry);
    tcase_add_test(tests, test_domain);
    tcase_add_test(tests, test_formula);
    tcase_add_test(tests, test_compact_object);
    tcase_add_test(tests, test_compact_pdos);
    tcase_add_test(tests, test_too_many_entries);
    tcase_add_test(tests, test_every_truncation);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(dcf_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

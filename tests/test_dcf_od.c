/* The object dictionary that a file describes. */
#include "dcf/dcf.h"
#include "support/dcf_file.h"
#include "support/guarded.h"
#include "support/hex.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

static struct messages messages;
static struct dcf dcf;
static struct od od;

static enum co_err make(const char *text, uint8_t node_id)
{
    messages_init(&messages);
    ck_assert_int_eq(guarded_dcf_parse(text, strlen(text), &messages.report, &dcf), CO_OK);
    messages_init(&messages);
    od_init(&od);
    return dcf_make_od(&dcf, node_id, &messages.report, &od);
}

static void done(void)
{
    od_done(&od);
    dcf_done(&dcf);
}

static const char *value_of(uint16_t index, uint8_t sub)
{
    static char text[200];
    const struct od_entry *entry = od_find(&od, index, sub);

    ck_assert_ptr_nonnull(entry);
    return hex_format(entry->value, entry->size, text, sizeof text);
}

#define TEN     "0123456789"
#define SEVENTY TEN TEN TEN TEN TEN TEN TEN

static const struct {
    const char *values;
    const char *type;
    const char *expected;
    uint32_t capacity;
} entries[] = {
    { "DefaultValue=500\n", "6", "F401", 2 },
    { "", "6", "0000", 2 },
    { "DefaultValue=\n", "6", "0000", 2 },
    { "DefaultValue=1\nParameterValue=2\n", "6", "0100", 2 },
    { "DefaultValue=$NODEID+0x180\n", "7", "85010000", 4 },
    { "HighLimit=3\nDefaultValue=4\n", "5", "04", 1 },
    { "DefaultValue=abc\n", "9", "616263", 64 },
    { "", "9", "", 64 },
    { "DefaultValue=abc\nParameterValue=" SEVENTY "\n", "9", "616263", 70 },
    { "", "8", "00000000", 4 },
    { "", "0xC", "000000000000", 6 },
    { "", "0xF", "", 65536 },
};

START_TEST(test_values)
{
    char text[1000];

    snprintf(text, sizeof text, VAR("2000", "%s", "rw") "%s", entries[_i].type, entries[_i].values);
    ck_assert_int_eq(make(text, 5), CO_OK);
    ck_assert_str_eq(messages.text, "");
    ck_assert_str_eq(value_of(0x2000, 0), entries[_i].expected);
    ck_assert_uint_eq(od_find(&od, 0x2000, 0)->capacity, entries[_i].capacity);
    done();
}
END_TEST

START_TEST(test_attributes)
{
    const struct od_entry *entry;

    ck_assert_int_eq(
        make(VAR("2000", "3", "rwr") "PDOMapping=1\nLowLimit=-5\nHighLimit=0x10\n" VAR(
                 "2001", "7", "const") "LowLimit=$NODEID+1\n" VAR("2002", "8",
                                                                  "wo") "HighLimit=1.5\n",
             5),
        CO_OK);
    entry = od_find(&od, 0x2000, 0);
    ck_assert_uint_eq(entry->access, OD_RWR);
    ck_assert_uint_eq(entry->type, OD_INTEGER16);
    ck_assert(entry->mappable);
    ck_assert_str_eq(entry->name, "Name");
    ck_assert(entry->has_low && entry->has_high);
    ck_assert_int_eq(entry->low, -5);
    ck_assert_int_eq(entry->high, 16);
    entry = od_find(&od, 0x2001, 0);
    ck_assert(!entry->mappable);
    ck_assert(entry->has_low && !entry->has_high);
    ck_assert_int_eq(entry->low, 6);
    ck_assert_int_eq(od_find(&od, 0x2002, 0)->high, 0x3FC00000);
    done();
}
END_TEST

START_TEST(test_highest_sub)
{
    ck_assert_int_eq(
        make("[2000]\nObjectType=8\n" VAR("2000sub0", "5", "ro") VAR("2000sub1", "7", "rw")
                 VAR("2000sub7", "7", "rw")
                     VAR("2000subFF", "7", "ro") "[2001]\nObjectType=8\n" VAR(
                         "2001sub0", "5", "ro") "DefaultValue=9\n" VAR("2001sub1", "7", "rw")
                         VAR("2002", "5", "rw"),
             5),
        CO_OK);
    ck_assert_str_eq(value_of(0x2000, 0), "07");
    ck_assert_str_eq(value_of(0x2001, 0), "09");
    ck_assert_str_eq(value_of(0x2002, 0), "00");
    done();
}
END_TEST

START_TEST(test_unknown_type)
{
    ck_assert_int_eq(make(VAR("2000", "0x40", "rw") VAR("2001", "5", "rw"), 5), CO_OK);
    ck_assert_str_eq(messages.text, "1: warning: 2000h:00: a data type of CiA 301 expected, there "
                                    "is none: the entry is left out\n");
    ck_assert_ptr_null(od_find(&od, 0x2000, 0));
    ck_assert_ptr_nonnull(od_find(&od, 0x2001, 0));
    done();
}
END_TEST

START_TEST(test_dictionary_not_empty)
{
    ck_assert_int_eq(make(VAR("2000", "5", "rw"), 5), CO_OK);
    ck_assert_int_eq(dcf_make_od(&dcf, 5, &messages.report, &od), CO_ERR_VALUE);
    ck_assert_str_eq(messages.text, "1: error: 2000h:00: not accepted: already there\n");
    done();
}
END_TEST

START_TEST(test_many_domains)
{
    uint32_t total = 0;

    ck_assert_int_eq(make(VAR("2000", "0xF", "rw") "ObjectType=8\nCompactSubObj=254\n", 5), CO_OK);
    for (size_t i = 0; i < od.count; i++)
        total += od.entries[i]->capacity;
    ck_assert_uint_eq(total, 64 * 65536 + (254 - 64) * 64 + 1);
    done();
}
END_TEST

static Suite *dcf_od_suite(void)
{
    Suite *suite = suite_create("dcf_od");
    TCase *tests = tcase_create("dcf_od");

    tcase_add_loop_test(tests, test_values, 0, sizeof entries / sizeof entries[0]);
    tcase_add_test(tests, test_attributes);
    tcase_add_test(tests, test_highest_sub);
    tcase_add_test(tests, test_unknown_type);
    tcase_add_test(tests, test_dictionary_not_empty);
    tcase_add_test(tests, test_many_domains);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(dcf_od_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

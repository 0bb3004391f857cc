#include "dcf/dcf_convert.h"
#include "dcf/dcf_number.h"
#include "support/guard.h"
#include "support/hex.h"

#include <check.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Converts a text that ends where memory ends; bytes as text, "N..." with the node-ID to add. */
static const char *convert(const char *text, uint8_t type, unsigned *ret_quirks)
{
    static char shown[200];
    struct dcf_value value;
    struct co_pool pool = { NULL };
    struct guard guard;
    enum dcf_fit fit;

    guard_init(&guard, text, strlen(text));
    fit = dcf_convert(&pool, (struct dcf_slice){ guard.bytes, strlen(text) }, type, &value,
                      ret_quirks);
    guard_done(&guard);
    shown[0] = 'N';
    if (fit == DCF_FITS)
        hex_format(value.bytes, value.size, shown + value.has_node_id, sizeof shown - 1);
    co_pool_done(&pool);
    switch (fit) {
    case DCF_FITS: break;
    case DCF_NO_VALUE: return "no value";
    case DCF_OUT_OF_RANGE: return "out of range";
    case DCF_NO_MEMORY: return "no memory";
    }
    return shown;
}

static const struct {
    uint8_t type;
    const char *text;
    const char *expected;
    unsigned quirks;
} values[] = {
    { OD_UNSIGNED8, "0", "00", 0 },
    { OD_UNSIGNED8, "255", "FF", 0 },
    { OD_UNSIGNED8, "256", "out of range", 0 },
    { OD_UNSIGNED8, "0xFF", "FF", 0 },
    { OD_UNSIGNED8, "0XfF", "FF", 0 },
    { OD_UNSIGNED8, "0x100", "out of range", 0 },
    { OD_UNSIGNED8, "0x000000FF", "FF", 0 },
    { OD_UNSIGNED8, "-1", "out of range", 0 },
    { OD_UNSIGNED8, "-0", "00", 0 },
    { OD_UNSIGNED8, "+7", "07", 0 },
    { OD_UNSIGNED8, "010", "0A", DCF_QUIRK_LEADING_ZERO },
    { OD_UNSIGNED8, "08", "08", DCF_QUIRK_LEADING_ZERO },
    { OD_UNSIGNED8, "005", "05", DCF_QUIRK_LEADING_ZERO },
    { OD_UNSIGNED8, "5 ; five", "05", DCF_QUIRK_COMMENT },
    { OD_UNSIGNED8, "0x3ED# much", "out of range", DCF_QUIRK_COMMENT },
    { OD_UNSIGNED8, "7 // seven", "07", DCF_QUIRK_COMMENT },
    { OD_UNSIGNED8, "; nothing", "no value", 0 },
    { OD_UNSIGNED8, "0x", "no value", 0 },
    { OD_UNSIGNED8, "-", "no value", 0 },
    { OD_UNSIGNED8, "5h", "05", DCF_QUIRK_FORM },
    { OD_UNSIGNED32, "0FFF1a2BH ; x", "2B1AFF0F", DCF_QUIRK_FORM | DCF_QUIRK_COMMENT },
    { OD_UNSIGNED8, "FFh", "FF", DCF_QUIRK_FORM },
    { OD_UNSIGNED8, "c0h", "C0", DCF_QUIRK_FORM },
    { OD_UNSIGNED8, "100h", "out of range", DCF_QUIRK_FORM },
    { OD_UNSIGNED64, "10000000000000000h", "out of range", DCF_QUIRK_FORM },
    { OD_UNSIGNED8, "h", "no value", 0 },
    { OD_UNSIGNED32, "each", "no value", 0 },
    { OD_UNSIGNED8, "5gh", "no value", 0 },
    { OD_UNSIGNED8, "1.0", "01", DCF_QUIRK_FORM },
    { OD_INTEGER8, "-20.", "EC", DCF_QUIRK_FORM },
    { OD_UNSIGNED8, "1.5", "no value", 0 },
    { OD_UNSIGNED8, "\"0x1A\"", "1A", DCF_QUIRK_FORM },
    { OD_UNSIGNED8, "\"\"", "no value", 0 },
    { OD_UNSIGNED8, "\"", "no value", 0 },
    { OD_UNSIGNED8, ".0", "no value", 0 },
    { OD_UNSIGNED8, "0x1.0", "no value", 0 },
    { OD_UNSIGNED8, "1L.0", "no value", 0 },
    { OD_BOOLEAN, "TRUE", "01", DCF_QUIRK_FORM },
    { OD_BOOLEAN, "no", "00", DCF_QUIRK_FORM },
    { OD_BOOLEAN, "maybe", "no value", 0 },
    { OD_UNSIGNED8, "1 2", "no value", 0 },
    { OD_UNSIGNED8, "--1", "no value", 0 },
    { OD_UNSIGNED8, "0x-1", "no value", 0 },
    { OD_UNSIGNED8, "No", "no value", 0 },
    { OD_BOOLEAN, "1", "01", 0 },
    { OD_BOOLEAN, "2", "out of range", 0 },
    { OD_BOOLEAN, "-1", "out of range", 0 },
    { OD_INTEGER8, "127", "7F", 0 },
    { OD_INTEGER8, "128", "out of range", 0 },
    { OD_INTEGER8, "-128", "80", 0 },
    { OD_INTEGER8, "-129", "out of range", 0 },
    { OD_INTEGER8, "0xFF", "FF", 0 },
    { OD_INTEGER8, "0x100", "out of range", 0 },
    { OD_INTEGER8, "0xFF80", "80", DCF_QUIRK_WIDE },
    { OD_INTEGER8, "0xFF7F", "out of range", 0 },
    { OD_INTEGER8, "0xFFFFFFFFFFFFFFFE", "FE", DCF_QUIRK_WIDE },
    { OD_INTEGER16, "0xFFFF8000", "0080", DCF_QUIRK_WIDE },
    { OD_INTEGER16, "0x0FFF8000", "out of range", 0 },
    { OD_INTEGER32, "0xFFFFFFFF80000000", "00000080", DCF_QUIRK_WIDE },
    { OD_UNSIGNED8, "0xFFFFFFFE", "out of range", 0 },
    { OD_INTEGER8, "-0x7f", "81", 0 },
    { OD_INTEGER32, "0x80000001", "01000080", 0 },
    { OD_INTEGER32, "-2147483648", "00000080", 0 },
    { OD_INTEGER32, "2147483648", "out of range", 0 },
    { OD_INTEGER24, "-0x7fffff", "010080", 0 },
    { OD_UNSIGNED24, "16777215", "FFFFFF", 0 },
    { OD_UNSIGNED24, "16777216", "out of range", 0 },
    { OD_INTEGER64, "-9223372036854775808", "0000000000000080", 0 },
    { OD_INTEGER64, "9223372036854775808", "out of range", 0 },
    { OD_INTEGER64, "0xFFFFFFFFFFFFFFFF", "FFFFFFFFFFFFFFFF", 0 },
    { OD_INTEGER64, "0x1234567890ABCDEFLL", "EFCDAB9078563412", DCF_QUIRK_SUFFIX },
    { OD_UNSIGNED64, "18446744073709551615ull", "FFFFFFFFFFFFFFFF", DCF_QUIRK_SUFFIX },
    { OD_UNSIGNED64, "18446744073709551616", "out of range", 0 },
    { OD_UNSIGNED64, "0x10000000000000000", "out of range", 0 },
    { OD_UNSIGNED64, "99999999999999999999999999999999", "out of range", 0 },
    { OD_UNSIGNED8, "1LLLL", "no value", 0 },
    { OD_UNSIGNED8, "L", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID+0x180", "N80010000", 0 },
    { OD_UNSIGNED32, "0x180+$NODEID", "N80010000", 0 },
    { OD_UNSIGNED32, "$NodeID + 384", "N80010000", 0 },
    { OD_UNSIGNED32, "0x180 + $nodeid ; x", "N80010000", DCF_QUIRK_COMMENT },
    { OD_UNSIGNED32, "$NODEID", "N00000000", 0 },
    { OD_UNSIGNED32, "$NODEID+180h", "N80010000", DCF_QUIRK_FORM },
    { OD_UNSIGNED32, "($NODEID + 0x180)", "N80010000", DCF_QUIRK_FORM },
    { OD_UNSIGNED32, "NodeId+0x180", "N80010000", DCF_QUIRK_FORM },
    { OD_UNSIGNED32, "0x180 + Node-ID", "N80010000", DCF_QUIRK_FORM },
    { OD_UNSIGNED32, "($NODEID+1", "no value", 0 },
    { OD_UNSIGNED32, "()", "no value", 0 },
    { OD_UNSIGNED32, "(", "no value", 0 },
    { OD_UNSIGNED32, "(5)", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID+", "no value", 0 },
    { OD_UNSIGNED32, "+$NODEID", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID-1", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID0x180", "no value", 0 },
    { OD_UNSIGNED32, "0x180$NODEID", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID+$NODEID", "no value", 0 },
    { OD_UNSIGNED32, "$NODEID+1+1", "no value", 0 },
    { OD_UNSIGNED32, "$NODE", "no value", 0 },
    { OD_REAL32, "1.5", "0000C03F", 0 },
    { OD_REAL32, "1.5E3", "0080BB44", 0 },
    { OD_REAL32, "-.5", "000000BF", 0 },
    { OD_REAL32, "5.", "0000A040", 0 },
    { OD_REAL32, "000", "00000000", 0 },
    { OD_REAL32, "05", "0000A040", 0 },
    { OD_REAL32, "0x40490FDB", "DB0F4940", 0 },
    { OD_REAL32, "0x140490FDB", "out of range", 0 },
    { OD_REAL32, "1e40", "out of range", 0 },
    { OD_REAL32, "1e-60", "00000000", 0 },
    { OD_REAL32, "0.1 ; x", "CDCCCC3D", DCF_QUIRK_COMMENT },
    { OD_REAL32, "1,5", "no value", 0 },
    { OD_REAL32, "1.5e", "no value", 0 },
    { OD_REAL32, "1.5e+", "no value", 0 },
    { OD_REAL32, ".", "no value", 0 },
    { OD_REAL32, "nan", "no value", 0 },
    { OD_REAL32, "inf", "no value", 0 },
    { OD_REAL32, "0x1p3", "no value", 0 },
    { OD_REAL64, "1.6", "9A9999999999F93F", 0 },
    { OD_REAL64, "0x400921FB54442D18", "182D4454FB210940", 0 },
    { OD_REAL64, "1e400", "out of range", 0 },
    { OD_VISIBLE_STRING, "Hello; no comment", "48656C6C6F3B206E6F20636F6D6D656E74", 0 },
    { OD_VISIBLE_STRING, "\"Hi\"", "22486922", DCF_QUIRK_QUOTES },
    { OD_VISIBLE_STRING, "\"", "22", 0 },
    { OD_VISIBLE_STRING, "0x31", "30783331", 0 },
    { OD_VISIBLE_STRING, "\xB0\x43", "B043", 0 },
    { OD_OCTET_STRING, "0123456789abcdef", "0123456789ABCDEF", 0 },
    { OD_OCTET_STRING, "01 23 45", "012345", 0 },
    { OD_OCTET_STRING, "0x0123", "0123", 0 },
    { OD_OCTET_STRING, "0", "00", 0 },
    { OD_OCTET_STRING, "012", "303132", DCF_QUIRK_TEXT },
    { OD_OCTET_STRING, "hello", "68656C6C6F", DCF_QUIRK_TEXT },
    { OD_UNICODE_STRING, "0041 20AC", "4100AC20", 0 },
    { OD_UNICODE_STRING, "004120AC", "4100AC20", 0 },
    { OD_UNICODE_STRING, "a\xE2\x9C\x93", "61001327", DCF_QUIRK_TEXT },
    { OD_UNICODE_STRING, "\xF0\x9F\x98\x80", "3DD800DE", DCF_QUIRK_TEXT },
    { OD_UNICODE_STRING, "\xB0z", "B0007A00", DCF_QUIRK_TEXT },
    { OD_UNICODE_STRING, "z\xE2\x9C", "7A00E2005301", DCF_QUIRK_TEXT },
    { OD_UNICODE_STRING, "\xF4\x90\x80\x80", "F4009000AC20AC20", DCF_QUIRK_TEXT },
    { OD_TIME_OF_DAY, "365 43200000", "002E93026D01", 0 },
    { OD_TIME_DIFFERENCE, "1  0", "000000000100", 0 },
    { OD_TIME_OF_DAY, "002E93026D01", "002E93026D01", 0 },
    { OD_TIME_OF_DAY, "0", "000000000000", 0 },
    { OD_TIME_OF_DAY, "65536 0", "no value", 0 },
    { OD_TIME_OF_DAY, "0 268435456", "no value", 0 },
    { OD_TIME_OF_DAY, "0x1000000000000", "out of range", 0 },
    { OD_TIME_OF_DAY, "noon", "no value", 0 },
    { OD_DOMAIN, "0x00010203", "00010203", DCF_QUIRK_DOMAIN },
    { OD_DOMAIN, "0", "no value", DCF_QUIRK_DOMAIN },
    { OD_DOMAIN, "@AB", "no value", DCF_QUIRK_DOMAIN },
    { 0, "1", "no value", 0 },
    { 0x40, "1", "no value", 0 },
};

START_TEST(test_convert)
{
    unsigned quirks;
    const char *shown = convert(values[_i].text, values[_i].type, &quirks);

    ck_assert_msg(strcmp(shown, values[_i].expected) == 0, "%s \"%s\": %s, expected %s",
                  od_type_name(values[_i].type), values[_i].text, shown, values[_i].expected);
    if (strcmp(shown, "no value") != 0)
        ck_assert_msg(quirks == values[_i].quirks, "\"%s\": quirks %X", values[_i].text, quirks);
}
END_TEST

/* A locale with a decimal comma, where the machine has one; else the tests above have to do. */
START_TEST(test_other_locale)
{
    static const char *const commas[] = { "de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE" };
    unsigned quirks;
    bool found = false;

    for (size_t i = 0; i < sizeof commas / sizeof commas[0] && !found; i++)
        found = setlocale(LC_ALL, commas[i]) != NULL;
    if (!found)
        printf("no locale with a decimal comma on this machine: its test is not run\n");
    ck_assert_str_eq(convert("1.5", OD_REAL32, &quirks), "0000C03F");
    ck_assert_str_eq(convert("1,5", OD_REAL32, &quirks), "no value");
    setlocale(LC_ALL, "C");
}
END_TEST

START_TEST(test_long_texts)
{
    char text[1001];
    unsigned quirks;

    memset(text, '1', sizeof text);
    text[sizeof text - 1] = '\0';
    ck_assert_str_eq(convert(text, OD_UNSIGNED64, &quirks), "out of range");
    ck_assert_str_eq(convert(text, OD_REAL64, &quirks), "no value");
    text[127] = '\0';
    ck_assert_str_eq(convert(text, OD_REAL32, &quirks), "out of range");
    ck_assert_uint_eq(strlen(convert(text, OD_REAL64, &quirks)), 16);
}
END_TEST

static Suite *number_suite(void)
{
    Suite *suite = suite_create("dcf_number");
    TCase *tests = tcase_create("dcf_number");

    tcase_add_loop_test(tests, test_convert, 0, sizeof values / sizeof values[0]);
    tcase_add_test(tests, test_other_locale);
    tcase_add_test(tests, test_long_texts);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(number_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

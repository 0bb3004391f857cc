/* Values in the messages of dcftest --online. */
#include "dcftest_online.h"

#include "od/od.h"
#include "support/suite.h"

static const struct shown {
    uint8_t type;
    const char *bytes;
    uint32_t size;
    const char *text;
} values[] = {
    { OD_UNSIGNED8, "\x09", 1, "9" },
    { OD_UNSIGNED8, "\x0A", 1, "10 (Ah)" },
    { OD_UNSIGNED16, "\xF4\x01", 2, "500 (1F4h)" },
    { OD_UNSIGNED64, "\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 8,
      "18446744073709551615 (FFFFFFFFFFFFFFFFh)" },
    { OD_BOOLEAN, "\x01", 1, "1" },
    { OD_INTEGER8, "\x80", 1, "-128" },
    { OD_INTEGER24, "\xFB\xFF\xFF", 3, "-5" },
    { OD_INTEGER64, "\0\0\0\0\0\0\0\x80", 8, "-9223372036854775808" },
    { OD_REAL32, "\0\0\xC0\x3F", 4, "1.5" },
    { OD_REAL64, "\0\0\0\0\0\0\xF8\xBF", 8, "-1.5" },
    { OD_TIME_OF_DAY, "\x01\x02\x03\x04\x05\x06", 6, "01 02 03 04 05 06" },
    { OD_VISIBLE_STRING, "pump\n\0", 6, "\"pump.\"" },
    { OD_VISIBLE_STRING, "", 0, "\"\"" },
    { OD_VISIBLE_STRING, "abcdefghijklmnopqrstuvwxyz", 26, "\"abcdefghijklmnopqrstuvwx...\"" },
    { OD_OCTET_STRING, "\0\x7F", 2, "00 7F" },
    { OD_OCTET_STRING, "", 0, "empty" },
    { OD_OCTET_STRING, "abcdefghijklmnopqrstuvwxyz", 26,
      "61 62 63 64 65 66 67 68 69 6A 6B 6C 6D 6E 6F 70 71 72 73 74 75 76 77 78 ..." },
    { OD_UNSIGNED32, "\x01\x02", 2, "01 02" }, /* not of its size: bytes */
};

START_TEST(test_texts)
{
    const struct shown *shown = &values[_i];

    ck_assert_str_eq(value_show(shown->type, (const uint8_t *)shown->bytes, shown->size).text,
                     shown->text);
}
END_TEST

static bool same(uint8_t type, const char *a, uint32_t a_size, const char *b, uint32_t b_size)
{
    const bool result = value_is_same(type, (const uint8_t *)a, a_size, (const uint8_t *)b, b_size);

    ck_assert_int_eq(value_is_same(type, (const uint8_t *)b, b_size, (const uint8_t *)a, a_size),
                     result);
    return result;
}

/* Devices fill up their texts with 0; that is no difference, in octets it is. */
START_TEST(test_same)
{
    ck_assert(same(OD_VISIBLE_STRING, "pump", 4, "pump\0\0", 6));
    ck_assert(same(OD_VISIBLE_STRING, "", 0, "\0", 1));
    ck_assert(!same(OD_VISIBLE_STRING, "pump", 4, "pumps", 5));
    ck_assert(!same(OD_VISIBLE_STRING, "pump", 4, "pumq", 4));
    ck_assert(!same(OD_OCTET_STRING, "pump", 4, "pump\0", 5));
    ck_assert(same(OD_OCTET_STRING, "", 0, "", 0));
    ck_assert(!same(OD_UNSIGNED16, "\1\0", 2, "\1", 1));
}
END_TEST

int main(void)
{
    TCase *tcase = tcase_create("values");

    tcase_add_loop_test(tcase, test_texts, 0, (int)(sizeof values / sizeof values[0]));
    tcase_add_test(tcase, test_same);
    return suite_run("tool_values", tcase);
}

#include "dcf/dcf.h"
#include "dcf/dcf_lexer.h"
#include "support/guard.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

static struct messages messages;
static struct guard guard;
static struct dcf_text text;

static enum co_err lex_bytes(const char *bytes, size_t size)
{
    messages_init(&messages);
    guard_init(&guard, bytes, size);
    return dcf_lex(guard.bytes, size, &messages.report, &text);
}

static void done(void)
{
    dcf_text_done(&text);
    guard_done(&guard);
}

/* Sections and keys as "[name]12 key=value@13 ...", in their order. */
static const char *show(void)
{
    static char shown[4000];
    size_t used = 0;

    shown[0] = '\0';
    for (size_t i = 0; i < text.section_count; i++) {
        const struct dcf_section *section = &text.sections[i];

        used += (size_t)snprintf(shown + used, sizeof shown - used, "[%.*s]%u ",
                                 (int)section->name.size, section->name.text, section->line);
        for (size_t k = 0; k < section->count; k++)
            used += (size_t)snprintf(shown + used, sizeof shown - used, "%.*s=%.*s@%u ",
                                     (int)section->keys[k].name.size, section->keys[k].name.text,
                                     (int)section->keys[k].value.size, section->keys[k].value.text,
                                     section->keys[k].line);
    }
    return shown;
}

static const struct {
    const char *name;
    const char *file;
    const char *shown;
    const char *messages;
} files[] = {
    { "a section", "[FileInfo]\nFileName=a.eds\n", "[FileInfo]1 FileName=a.eds@2 ", "" },
    { "CR LF", "[FileInfo]\r\n\r\nFileName=a.eds\r\n", "[FileInfo]1 FileName=a.eds@3 ", "" },
    { "CR", "[FileInfo]\rFileName=a.eds\r\rA=1", "[FileInfo]1 FileName=a.eds@2 A=1@4 ",
      "1: warning: lines are expected to end with CR LF or LF, this one does with CR (and in 2 "
      "more "
      "lines)\n" },
    { "all line ends", "[FileInfo]\r\nA=1\nB=2\rC=3\r", "[FileInfo]1 A=1@2 B=2@3 C=3@4 ",
      "3: warning: lines are expected to end with CR LF or LF, this one does with CR (and in 1 "
      "more "
      "lines)\n" },
    { "comments with //", "[FileInfo]\n // A=1\nB=1\n//", "[FileInfo]1 B=1@3 ",
      "2: warning: comments are expected to begin with \";\", this one does with \"//\" (and in 1 "
      "more lines)\n" },
    { "no line end", "[FileInfo]\nA=1", "[FileInfo]1 A=1@2 ", "" },
    { "DOS end of file", "[FileInfo]\nA=1\n\x1A", "[FileInfo]1 A=1@2 ", "" },
    { "blanks", "  [FileInfo] \t\n\t A \t= \t1 2 \t \n", "[FileInfo]1 A=1 2@2 ",
      "1: warning: a section is expected in the first column, there are blanks before it\n" },
    { "comments", ";x\n[FileInfo];\n ; A=1\nA=1 ; no comment here\n",
      "[FileInfo]2 A=1 ; no comment here@4 ",
      "2: warning: nothing expected behind \"]\", there is \";\": ignored\n" },
    { "comments with #", "#x\n[FileInfo]\n# A=1\n", "[FileInfo]2 ",
      "1: warning: comments are expected to begin with \";\", this one does with \"#\" (and in 1 "
      "more lines)\n" },
    { "empty values, = in values", "[FileInfo]\nA=\nB==\nC=a=b\n",
      "[FileInfo]1 A=@2 B==@3 C=a=b@4 ", "" },
    { "byte order mark", "\xEF\xBB\xBF[FileInfo]\nA=1\n", "[FileInfo]1 A=1@2 ",
      "1: warning: plain text expected, the file begins with a byte order mark: ignored\n" },
    { "bytes of any encoding pass", "[FileInfo]\nA=\xB0\x93 \xC2\xB0\n",
      "[FileInfo]1 A=\xB0\x93 \xC2\xB0@2 ",
      "2: warning: ASCII characters expected, there are others\n" },
    { "control characters", "[FileInfo]\nA=\x01\x02\n", "[FileInfo]1 A=\x01\x02@2 ",
      "2: warning: text expected, there are control characters\n" },
    { "lines that are nothing", "[FileInfo]\nhello\n=5\nA=1\nhello again\n", "[FileInfo]1 A=1@4 ",
      "2: warning: \"[section]\", \"key=value\" or \"; comment\" expected: ignored (and in 2 more "
      "lines)\n" },
    { "keys before the first section", "A=1\n[FileInfo]\n", "[FileInfo]2 ",
      "1: warning: a section expected before the first key: ignored\n" },
    { "no bracket", "[FileInfo\nA=1\n", "[FileInfo]1 A=1@2 ",
      "1: warning: section \"FileInfo\": \"]\" expected at its end, the line ends without one\n" },
    { "sections sorted", "[2000sub10]\n[1018]\n[2000SUB2]\n[2000]\n[2000Value]\n[deviceinfo]\n",
      "[deviceinfo]6 [1018]2 [2000]4 [2000SUB2]3 [2000sub10]1 [2000Value]5 ", "" },
    { "lower case digits", "[10fe]\n[1ABCsubA]\n[1abcsubb]\n", "[10fe]1 [1ABCsubA]2 [1abcsubb]3 ",
      "" },
    { "keys as in the file, the case of letters is nothing", "[FileInfo]\nb=1\nA=2\nC=3\n",
      "[FileInfo]1 b=1@2 A=2@3 C=3@4 ", "" },
    { "the same key twice", "[1017]\nDefaultValue=1\n\ndefaultvalue=2\n",
      "[1017]1 defaultvalue=2@4 ",
      "4: warning: [1017] defaultvalue: expected once, it is also in line 2: \"2\" counts, not "
      "\"1\"\n" },
    { "the same section twice", "[1017]\nA=1\nB=1\n[1018]\nA=3\n[1017]\nB=2\nC=2\n",
      "[1017]6 A=1@2 B=2@7 C=2@8 [1018]4 A=3@5 ",
      "6: warning: [1017]: expected once, it is also in line 1: keys of both are taken, of the "
      "same ones the later\n"
      "7: warning: [1017] B: expected once, it is also in line 3: \"2\" counts, not \"1\"\n" },
    { "both spellings", "[DeviceComissioning]\nA=1\n[DeviceCommissioning]\nA=2\n",
      "[DeviceComissioning]3 A=2@4 ",
      "3: warning: [DeviceComissioning] expected (so the standard spells it), there is "
      "[DeviceCommissioning]\n"
      "3: warning: [DeviceCommissioning]: expected once, it is also in line 1: keys of both are "
      "taken, of the same ones the later\n"
      "4: warning: [DeviceComissioning] A: expected once, it is also in line 2: \"2\" counts, not "
      "\"1\"\n" },
    { "odd names of objects",
      "[0x1018]\n[1018sub01]\n[1018 sub 2]\n[0x1018 sub3]\n[1018 Value]\n[ 1018sub4 ]\n",
      "[0x1018]1 [1018sub01]2 [1018 sub 2]3 [0x1018 sub3]4 [1018sub4]6 [1018 Value]5 ",
      "1: warning: [1018] expected, there is [0x1018]\n"
      "2: warning: [1018sub1] expected, there is [1018sub01]\n"
      "3: warning: [1018sub2] expected, there is [1018 sub 2]\n"
      "4: warning: [1018sub3] expected, there is [0x1018 sub3]\n"
      "5: warning: [1018Value] expected, there is [1018 Value]\n" },
    { "unknown sections last, and they may come twice", "[Foo]\nA=1\nA=2\n[1018]\n[Foo]\n",
      "[1018]4 [Foo]1 A=2@3 [Foo]5 ",
      "1: warning: a section of CiA 306 expected, there is [Foo]: ignored\n"
      "5: warning: a section of CiA 306 expected, there is [Foo]: ignored\n" },
    { "names that are near",
      "[1018sub100]\n[1018subG]\n[1018sub]\n[101]\n[]\n[MaFixed]\n[Toolx]\n"
      "[1018sub00001]\n",
      "[1018sub100]1 [1018subG]2 [1018sub]3 [101]4 []5 [MaFixed]6 [Toolx]7 "
      "[1018sub00001]8 ",
      "1: warning: a section of CiA 306 expected, there is [1018sub100]: ignored\n"
      "2: warning: a section of CiA 306 expected, there is [1018subG]: ignored\n"
      "3: warning: a section of CiA 306 expected, there is [1018sub]: ignored\n"
      "4: warning: a section of CiA 306 expected, there is [101]: ignored\n"
      "5: warning: a section of CiA 306 expected, there is []: ignored\n"
      "6: warning: a section of CiA 306 expected, there is [MaFixed]: ignored\n"
      "7: warning: a section of CiA 306 expected, there is [Toolx]: ignored\n"
      "8: warning: a section of CiA 306 expected, there is [1018sub00001]: ignored\n" },
    { "sections of modules and tools, by their numbers",
      "[M10SubExt6000]\n[M2Fixed6000sub1]\n[M2SubExtends]\n[Tool2]\n[Tool1]\n[M2ModuleInfo]\n"
      "[m2fixed6000]\n[Tools]\n[Comments]\n[DynamicChannels]\n[1600ObjectLinks]\n[1600]\n"
      "[M2FixedObjects]\n[M2Comments]\n[M2SubExt6000]\n",
      "[Comments]9 [DynamicChannels]10 [Tools]8 [1600]12 [1600ObjectLinks]11 [M2ModuleInfo]6 "
      "[M2Comments]14 [M2FixedObjects]13 [M2SubExtends]3 [m2fixed6000]7 [M2Fixed6000sub1]2 "
      "[M2SubExt6000]15 [M10SubExt6000]1 [Tool1]5 [Tool2]4 ",
      "" },
    { "the sections of modules are the same only with the same number",
      "[M1Fixed2000]\nA=1\n[M2Fixed2000]\nA=2\n[2000]\nA=3\n[M1Fixed2000]\nB=4\n",
      "[2000]5 A=3@6 [M1Fixed2000]7 A=1@2 B=4@8 [M2Fixed2000]3 A=2@4 ",
      "7: warning: [M1Fixed2000]: expected once, it is also in line 1: keys of both are taken, of "
      "the same ones the later\n" },
    { "odd names of modules and tools", "[M01ModuleInfo]\n[Tool01]\n[M1Fixed2000sub01]\n",
      "[M01ModuleInfo]1 [M1Fixed2000sub01]3 [Tool01]2 ",
      "1: warning: [M1...] expected, there is [M01ModuleInfo]\n"
      "2: warning: [Tool1...] expected, there is [Tool01]\n"
      "3: warning: [M1Fixed2000sub1] expected, there is [M1Fixed2000sub01]\n" },
    { "no modules and tools",
      "[M0ModuleInfo]\n[M65536Comments]\n[M1Fixed]\n[M1Fixed200]\n[M1SubExt6000sub1]\n[M1X]\n"
      "[M1Fixed2000x]\n[Tool0]\n[Tool1x]\n",
      "[M0ModuleInfo]1 [M65536Comments]2 [M1Fixed]3 [M1Fixed200]4 [M1SubExt6000sub1]5 [M1X]6 "
      "[M1Fixed2000x]7 [Tool0]8 [Tool1x]9 ",
      "1: warning: a section of CiA 306 expected, there is [M0ModuleInfo]: ignored\n"
      "2: warning: a section of CiA 306 expected, there is [M65536Comments]: ignored\n"
      "3: warning: a section of CiA 306 expected, there is [M1Fixed]: ignored\n"
      "4: warning: a section of CiA 306 expected, there is [M1Fixed200]: ignored\n"
      "5: warning: a section of CiA 306 expected, there is [M1SubExt6000sub1]: ignored\n"
      "6: warning: a section of CiA 306 expected, there is [M1X]: ignored\n"
      "7: warning: a section of CiA 306 expected, there is [M1Fixed2000x]: ignored\n"
      "8: warning: a section of CiA 306 expected, there is [Tool0]: ignored\n"
      "9: warning: a section of CiA 306 expected, there is [Tool1x]: ignored\n" },
};

START_TEST(test_lines)
{
    enum co_err err = lex_bytes(files[_i].file, strlen(files[_i].file));

    ck_assert_int_eq(err, CO_OK);
    ck_assert_msg(strcmp(messages.text, files[_i].messages) == 0, "%s: messages:\n%s",
                  files[_i].name, messages.text);
    ck_assert_msg(strcmp(show(), files[_i].shown) == 0, "%s: %s", files[_i].name, show());
    done();
}
END_TEST

static const struct {
    const char *file;
    size_t size;
    const char *messages;
} refused[] = {
    { "", 0, " error: EDS or DCF text expected, there is no section in it\n" },
    { "\n\n", 2, " error: EDS or DCF text expected, there is no section in it\n" },
    { "\xEF\xBB\xBF", 3,
      "1: warning: plain text expected, the file begins with a byte order mark: ignored\n"
      " error: EDS or DCF text expected, there is no section in it\n" },
    { "\0\0\0\0", 4,
      "1: warning: text expected, there are control characters\n"
      " error: EDS or DCF text expected, there is no section in it\n" },
    { "\xFF\xFE[\0", 4,
      " error: EDS or DCF text expected, this is UTF-16: store it as plain text\n" },
    { "\xFE\xFF\0[", 4,
      " error: EDS or DCF text expected, this is UTF-16: store it as plain text\n" },
};

START_TEST(test_refused)
{
    ck_assert_int_eq(lex_bytes(refused[_i].file, refused[_i].size), CO_ERR_FORMAT);
    ck_assert_str_eq(messages.text, refused[_i].messages);
    ck_assert_int_eq(messages.report.error_kind, DCF_ERROR_MISSING_SECTION);
    guard_done(&guard);
}
END_TEST

START_TEST(test_long_line)
{
    char file[600] = "[FileInfo]\n";
    size_t start = strlen(file);

    memset(file + start, 'a', 255);
    file[start + 1] = '=';
    ck_assert_int_eq(lex_bytes(file, start + 255), CO_OK);
    ck_assert_str_eq(messages.text, "");
    done();
    file[start + 255] = 'a';
    ck_assert_int_eq(lex_bytes(file, start + 256), CO_OK);
    ck_assert_str_eq(messages.text,
                     "2: warning: lines of at most 255 characters expected, this one is longer\n");
    ck_assert_uint_eq(text.sections[0].keys[0].value.size, 254);
    done();
}
END_TEST

/* Bytes are looked at eight at a time: an odd one is seen wherever it is. */
START_TEST(test_odd_byte_anywhere)
{
    static const unsigned char odd[] = { 0x01, 0x1F, 0x20, 0x7F, 0x80, 0xFF, '\t' };
    static const bool is_told[] = { true, true, false, false, true, true, false };
    char line[] = "[FileInfo]\nFileName=plain text";
    size_t end = sizeof line - 1;

    for (size_t i = 0; i < sizeof odd; i++) {
        for (size_t place = strlen("[FileInfo]\nFileName=p"); place < end; place++) {
            char kept = line[place];

            line[place] = (char)odd[i];
            ck_assert_int_eq(lex_bytes(line, end), CO_OK);
            ck_assert_msg(messages.report.warnings == is_told[i], "%02X at %zu", odd[i], place);
            done();
            line[place] = kept;
        }
    }
}
END_TEST

START_TEST(test_every_truncation)
{
    static const char file[] = "\xEF\xBB\xBF; x\r\n[1018sub1]\r\nDefaultValue = 5 \r\n[2000Value";

    for (size_t size = 0; size < sizeof file; size++) {
        if (lex_bytes(file, size) == CO_OK)
            dcf_text_done(&text);
        guard_done(&guard);
    }
}
END_TEST

/* Many keys are sorted in another way than few. */
START_TEST(test_many_keys)
{
    char file[8000] = "[FileInfo]\n";
    size_t used = strlen(file);

    for (unsigned i = 0; i < 300; i++)
        used += (size_t)snprintf(file + used, sizeof file - used, "%s%u=%u\n", i % 2 ? "k" : "K",
                                 i * 7 % 100, i);
    ck_assert_int_eq(lex_bytes(file, used), CO_OK);
    ck_assert_uint_eq(messages.report.warnings, 200);
    ck_assert_uint_eq(text.sections[0].count, 100);
    for (unsigned i = 0; i < 100; i++) {
        const struct dcf_key *key;
        char name[8];

        snprintf(name, sizeof name, "K%u", i * 7 % 100);
        key = dcf_section_find(&text.sections[0], name);
        ck_assert_ptr_nonnull(key);
        ck_assert_uint_eq(key->line, 202 + i); /* the last of the three */
        snprintf(name, sizeof name, "K%u", i);
        ck_assert(dcf_slice_is(text.sections[0].keys[i].name, name));
    }
    ck_assert_ptr_null(dcf_section_find(&text.sections[0], "K100"));
    done();
}
END_TEST

START_TEST(test_find)
{
    static const char file[] = "[DeviceInfo]\nB=1\nA=\n[1018]\n[FileInfo]\n";
    struct dcf_section *section;

    ck_assert_int_eq(lex_bytes(file, strlen(file)), CO_OK);
    section = dcf_text_find(&text, DCF_SECTION_DEVICE_INFO);
    ck_assert_ptr_nonnull(section);
    ck_assert_ptr_null(dcf_text_find(&text, DCF_SECTION_COMMISSIONING));
    ck_assert_ptr_null(dcf_section_find(section, "C"));
    ck_assert_ptr_null(dcf_section_find(section, "a"));
    ck_assert(!section->keys[0].used);
    ck_assert(section->keys[1].used);
    ck_assert_uint_eq(dcf_section_find(section, "b")->line, 2);
    ck_assert(section->keys[0].used);
    done();
}
END_TEST

START_TEST(test_show)
{
    static const char *const longest =
        "0123456789012345678901234567890123456789012345678901234567890123456789";

    ck_assert_str_eq(dcf_show(dcf_slice_of("a\tb\x7F\x1B[1m")).text, "a?b??[1m");
    ck_assert_str_eq(dcf_show(dcf_slice_of(longest)).text,
                     "012345678901234567890123456789012345678901234567890123456789...");
    ck_assert_str_eq(dcf_show(dcf_slice_cut(dcf_slice_of(longest), 63)).text,
                     "012345678901234567890123456789012345678901234567890123456789012");
}
END_TEST

static Suite *lexer_suite(void)
{
    Suite *suite = suite_create("dcf_lexer");
    TCase *tests = tcase_create("dcf_lexer");

    tcase_add_loop_test(tests, test_lines, 0, sizeof files / sizeof files[0]);
    tcase_add_loop_test(tests, test_refused, 0, sizeof refused / sizeof refused[0]);
    tcase_add_test(tests, test_long_line);
    tcase_add_test(tests, test_odd_byte_anywhere);
    tcase_add_test(tests, test_every_truncation);
    tcase_add_test(tests, test_many_keys);
    tcase_add_test(tests, test_find);
    tcase_add_test(tests, test_show);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(lexer_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

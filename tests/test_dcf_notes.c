/* Comments, tools, dynamic channels and object links. */
#include "dcf/dcf.h"
#include "support/dcf_file.h"
#include "support/guard.h"
#include "support/messages.h"

#include <check.h>
#include <string.h>

static struct messages messages;

static const struct {
    const char *name;
    const char *file;
    const char *messages;
} notes[] = {
    { "all of them",
      LINES("[Comments]\nLines=3\nLine1=a\nLine2=\nline3=b\n[Tools]\nItems=2\n[Tool1]\nName=a\n"
            "Command=a.exe $DCF\n[Tool2]\nName=b\nCommand=b\n[1018ObjectLinks]\nObjectLinks=2\n"
            "1=0x1000\n2=0x1001\n[DeviceInfo2]\n"),
      "80: warning: a section of CiA 306 expected, there is [DeviceInfo2]: ignored\n" },
    { "nothing in them",
      LINES("[Comments]\nLines=0\n[Tools]\nItems=0\n[DynamicChannels]\nNrOfSeg=0\n"), "" },
    { "comments are missing", LINES("[Comments]\nLines=3\nLine1=a\nLine2=b\n"),
      "63: warning: [Comments] Lines: 2 expected (so many are listed), it is 3\n" },
    { "too many comments", LINES("[Comments]\nLine1=a\nLineX=b\nLine=c\n"),
      "63: warning: [Comments] Lines: 1 expected (so many are listed), it is missing\n"
      "65: warning: [Comments]: a keyword of CiA 306 for this section expected, there is "
      "\"LineX\": "
      "ignored\n"
      "66: warning: [Comments]: a keyword of CiA 306 for this section expected, there is \"Line\": "
      "ignored\n" },
    { "a gap in comments", LINES("[Comments]\nLines=2\nLine1=a\nLine3=b\n"),
      "63: warning: [Comments]: Line1 to Line2 expected, Line2 is missing\n" },
    { "the number of comments is none", LINES("[Comments]\nLines=many\nLine1=a\n"),
      "64: warning: [Comments] Lines: a number of 0..65535 expected, there is \"many\": "
      "ignored\n" },
    { "tools without a list", LINES("[Tool1]\nName=a\nCommand=b\n"),
      "63: warning: [Tools] Items: 1 expected (so many sections [Tooln] are there), it is 0\n" },
    { "tools are missing", LINES("[Tools]\nItems=2\nName=x\n[Tool1]\nName=\nVersion=1\n"),
      "66: warning: [Tool1]: Name, Command expected, they are missing or empty\n"
      "68: warning: [Tool1]: a keyword of CiA 306 for this section expected, there is \"Version\": "
      "ignored\n"
      "65: warning: [Tools]: a keyword of CiA 306 for this section expected, there is \"Name\": "
      "ignored\n"
      "63: warning: [Tools] Items: 1 expected (so many sections [Tooln] are there), it is 2\n" },
    { "a gap in tools", LINES("[Tools]\nItems=1\n[Tool2]\nName=a\nCommand=b\n"),
      "65: warning: [Tool2]: [Tool1] expected as the next one\n" },
    { "links to nothing, from nothing",
      LINES("[2000ObjectLinks]\nObjectLinks=3\n1=0x1000\n2=0x3000\n3=none\nFoo=1\n"),
      "63: warning: [2000ObjectLinks]: a section [2000] for its object expected, it is missing\n"
      "66: warning: [2000ObjectLinks] 2: an object of this file expected, 3000h is not in it\n"
      "67: warning: [2000ObjectLinks] 3: an index expected, there is \"none\": ignored\n"
      "68: warning: [2000ObjectLinks]: a keyword of CiA 306 for this section expected, there is "
      "\"Foo\": ignored\n" },
    { "a wrong number of links", LINES("[1018ObjectLinks]\nObjectLinks=2\n1=0x1000\n"),
      "63: warning: [1018ObjectLinks] ObjectLinks: 1 expected (so many are listed), it is 2\n" },
    { "a gap in links", LINES("[1018ObjectLinks]\nObjectLinks=1\n2=0x1000\n"),
      "63: warning: [1018ObjectLinks]: 1 to 1 expected, 1 is missing\n" },
};

/* With DynamicChannelsSupported, without a word about the second [DeviceInfo]. */
#define DEVICE(text)                                                                               \
    FILE_INFO DEVICE_INFO "DynamicChannelsSupported=1\n" LISTS OPTIONAL MANDATORY text

static const struct {
    const char *name;
    const char *file;
    const char *messages;
} channels[] = {
    { "two segments",
      DEVICE("[DynamicChannels]\nNrOfSeg=2\nType1=0x0007\nDir1=ro\nRange1=0xA080-0xA0BF\n"
             "PPOffset1=0\nType2=0x5\nDir2=RWW\nRange2=0xA480 - 0xA4FF\nPPOffset2=0x10,1\n"),
      "" },
    { "not supported",
      LINES("[DynamicChannels]\nNrOfSeg=1\nType1=7\nDir1=ro\nRange1=0xA080-0xA080\nPPOffset1=0\n"),
      "63: warning: [DynamicChannels]: DynamicChannelsSupported=1 in [DeviceInfo] expected, it is "
      "not there\n" },
    { "keys are missing, keys are too many",
      DEVICE("[DynamicChannels]\nNrOfSeg=1\nType1=7\nType2=7\n"),
      "64: warning: [DynamicChannels] Dir1: ro, wo, rw, rwr or rww expected, it is missing\n"
      "64: warning: [DynamicChannels] Range1: two indices like 0xA000-0xA03F expected, it is "
      "missing\n"
      "64: warning: [DynamicChannels] PPOffset1: an offset, or two numbers with a comma between "
      "expected, it is missing\n"
      "67: warning: [DynamicChannels]: a keyword of CiA 306 for this section expected, there is "
      "\"Type2\": ignored\n" },
    { "values that are none",
      DEVICE("[DynamicChannels]\nNrOfSeg=1\nType1=0x40\nDir1=in\nRange1=0xA080\nPPOffset1=-\n"),
      "66: warning: [DynamicChannels] Type1: a data type of CiA 301 expected, there is 0x40\n"
      "67: warning: [DynamicChannels] Dir1: ro, wo, rw, rwr or rww expected, there is in\n"
      "68: warning: [DynamicChannels] Range1: two indices like 0xA000-0xA03F expected, there is "
      "0xA080\n"
      "69: warning: [DynamicChannels] PPOffset1: an offset, or two numbers with a comma between "
      "expected, there is -\n" },
    { "ranges that cannot be",
      DEVICE("[DynamicChannels]\nNrOfSeg=2\nType1=1\nDir1=ro\nRange1=0xA081-0xA080\nPPOffset1=,1\n"
             "Type2=1\nDir2=rw\nRange2=0xA081-0x10000\nPPOffset2=1,\n"),
      "68: warning: [DynamicChannels] Range1: two indices like 0xA000-0xA03F expected, there is "
      "0xA081-0xA080\n"
      "69: warning: [DynamicChannels] PPOffset1: an offset, or two numbers with a comma between "
      "expected, there is ,1\n"
      "72: warning: [DynamicChannels] Range2: two indices like 0xA000-0xA03F expected, there is "
      "0xA081-0x10000\n"
      "73: warning: [DynamicChannels] PPOffset2: an offset, or two numbers with a comma between "
      "expected, there is 1,\n" },
};

static void check_file(const char *name, const char *file, const char *expected)
{
    struct guard guard;
    struct dcf dcf;

    guard_init(&guard, file, strlen(file));
    messages_init(&messages);
    ck_assert_int_eq(dcf_parse(guard.bytes, strlen(file), &messages.report, &dcf), CO_OK);
    ck_assert_msg(strcmp(messages.text, expected) == 0, "%s:\n%s", name, messages.text);
    dcf_done(&dcf);
    guard_done(&guard);
}

START_TEST(test_note)
{
    check_file(notes[_i].name, notes[_i].file, notes[_i].messages);
}
END_TEST

START_TEST(test_channel)
{
    check_file(channels[_i].name, channels[_i].file, channels[_i].messages);
}
END_TEST

static Suite *notes_suite(void)
{
    Suite *suite = suite_create("dcf_notes");
    TCase *tests = tcase_create("dcf_notes");

    tcase_add_loop_test(tests, test_note, 0, sizeof notes / sizeof notes[0]);
    tcase_add_loop_test(tests, test_channel, 0, sizeof channels / sizeof channels[0]);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(notes_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

/* Modules: what is checked of them, and what those in use add to a device. */
#include "dcf/dcf.h"
#include "support/dcf_file.h"
#include "support/guard.h"
#include "support/hex.h"
#include "support/messages.h"

#include <check.h>
#include <stdio.h>
#include <string.h>

#define MODULE(number)                                                                             \
    "[M" #number "ModuleInfo]\nProductName=I/O\nProductVersion=1\nProductRevision=0\n"             \
    "OrderCode=IO-" #number "\n"
#define LIST(name, index) "[" name "]\nNrOfEntries=1\n1=0x" index "\n"
#define SUPPORTED(count)  "[SupportedModules]\nNrOfEntries=" #count "\n"
#define EXTENSION(part, type, rest)                                                                \
    "[" part "]\nParameterName=Channel\nDataType=" type                                            \
    "\nAccessType=ro\nDefaultValue=3\nPDOMapping=1\n" rest

/* With 1027h; what a test adds begins at line 72. */
#define DEVICE(text)                                                                               \
    LINES("[OptionalObjects]\n1=0x1027\nSupportedObjects=1\n[1027]\nParameterName=Modules\n"       \
          "ObjectType=8\nDataType=6\nAccessType=ro\nCompactSubObj=8\n" text)

static struct messages messages;
static struct dcf dcf;

static void parse(const char *text)
{
    struct guard guard;

    guard_init(&guard, text, strlen(text));
    messages_init(&messages);
    ck_assert_msg(dcf_parse(guard.bytes, strlen(text), &messages.report, &dcf) == CO_OK, "%s",
                  messages.text);
    guard_done(&guard);
}

/* What is told about the device itself: its list is there twice. */
static const char *told(void)
{
    static const char of_device[] =
        "63: warning: [OptionalObjects]: expected once, it is also in line 39: keys of both are "
        "taken, of the same ones the later\n"
        "65: warning: [OptionalObjects] SupportedObjects: expected once, it is also in line 40: "
        "\"1\" counts, not \"0\"\n";

    ck_assert_msg(strncmp(messages.text, of_device, sizeof of_device - 1) == 0, "%s",
                  messages.text);
    return messages.text + sizeof of_device - 1;
}

static const struct {
    const char *name;
    const char *file;
    const char *messages;
} checks[] = {
    { "all there is, none in use",
      DEVICE(SUPPORTED(2) MODULE(1) MODULE(2) "[M1Comments]\nLines=1\nLine1=x\n" LIST(
          "M1FixedObjects", "2000") VAR("M1Fixed2000", "5", "rw") LIST("M2SubExtends", "6000")
                 EXTENSION("M2SubExt6000", "5", "Count=2\nObjExtend=128\n")),
      "" },
    { "no list of modules", LINES(SUPPORTED(1) MODULE(1)),
      "63: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n" },
    { "no modules are none", LINES(SUPPORTED(0)), "" },
    { "a module is missing, one is too many", DEVICE(SUPPORTED(2) MODULE(1) MODULE(3)),
      "79: warning: [M3ModuleInfo]: a module of 1..2 expected\n"
      "72: warning: [SupportedModules]: a section [M2ModuleInfo] expected, it is missing\n" },
    { "keys of modules",
      DEVICE(SUPPORTED(1) "[M1ModuleInfo]\nProductName=\nProductVersion=256\nName=x\n"
                          "[M1Comments]\nLines=2\nLine1=x\n"),
      "74: warning: [M1ModuleInfo]: ProductName, OrderCode expected, they are missing or empty\n"
      "76: warning: [M1ModuleInfo] ProductVersion: a number of 0..255 expected, there is \"256\": "
      "ignored\n"
      "77: warning: [M1ModuleInfo]: a keyword of CiA 306 for this section expected, there is "
      "\"Name\": ignored\n"
      "78: warning: [M1Comments] Lines: 1 expected (so many are listed), it is 2\n" },
    { "nothing but an object of a module", DEVICE(SUPPORTED(1) VAR("M1Fixed2000", "5", "rw")),
      "74: warning: [M1Fixed2000]: a section [M1ModuleInfo] expected, it is missing\n"
      "74: warning: [M1Fixed2000]: its index expected in [M1FixedObjects], it is not there\n" },
    { "lists of modules",
      DEVICE(SUPPORTED(1)
                 MODULE(1) "[M1FixedObjects]\nNrOfEntries=4\n1=0x2000\n2=0x2001\n3=0x2000\n"
                           "4=x\n[M1SubExtends]\nNrOfEntries=2\n1=0x6000\n3=0x6001\n" VAR(
                               "M1Fixed2000", "5", "rw") EXTENSION("M1SubExt6000", "5", "Count=1\n")
                               EXTENSION("M1SubExt6002", "5", "Count=1\n")),
      "82: warning: [M1FixedObjects]: a section [M1Fixed2001] for this index expected, it is "
      "missing\n"
      "83: warning: [M1FixedObjects]: 2000h expected once\n"
      "84: warning: [M1FixedObjects] 4: an index expected, there is \"x\": ignored\n"
      "88: warning: [M1SubExtends]: a section [M1SubExt6001] for this index expected, it is "
      "missing\n"
      "85: warning: [M1SubExtends]: 1 to 2 expected, 2 is missing\n"
      "100: warning: [M1SubExt6002]: its index expected in [M1SubExtends], it is not there\n" },
    { "objects of modules are checked like others",
      DEVICE(SUPPORTED(1) MODULE(1) LIST(
          "M1FixedObjects", "2000") "[M1Fixed2000]\nParameterName=x\nObjectType=9\nSubNumber="
                                    "3\n" VAR("M1Fixed2000sub1", "6",
                                              "rw") "LowLimit=1\nDefaultValue=0\nFoo=1\n"),
      "82: warning: [M1Fixed2000] SubNumber: 1 expected (so many sub-index sections are there), it "
      "is 3\n"
      "82: warning: [M1Fixed2000]: a section [M1Fixed2000sub0] expected, it is missing\n"
      "92: warning: [M1Fixed2000sub1]: a keyword of CiA 306 for this section expected, there is "
      "\"Foo\": ignored\n"
      "91: warning: 2000h:01 DefaultValue: 1 to (none) expected (its limits), there is 0\n" },
    { "sub-indices without object",
      DEVICE(SUPPORTED(1) MODULE(1) LIST("M1FixedObjects", "2000")
                 VAR("M1Fixed2000sub0", "5", "ro")),
      "81: warning: [M1FixedObjects]: a section [M1Fixed2000] for this index expected, it is "
      "missing\n"
      "82: warning: [M1Fixed2000sub0]: a section [M1Fixed2000] for its object expected, it is "
      "missing\n" },
    { "an object of the device as well, without that module",
      OBJECT("2000", VAR("2000", "5", "rw") SUPPORTED(1) MODULE(1) LIST("M1FixedObjects", "2000")
                         VAR("M1Fixed2000", "5", "rw")),
      "67: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n"
      "77: warning: 2000h: an object of modules only expected, [2000] is in this file as well\n" },
    { "counts that are none",
      DEVICE(SUPPORTED(1) MODULE(
          1) "[M1SubExtends]\nNrOfEntries=6\n1=0x6000\n2=0x6001\n3=0x6002\n"
             "4=0x6003\n5=0x6004\n6=0x6005\n" EXTENSION("M1SubExt6000", "5", "") EXTENSION(
                 "M1SubExt6001", "5", "Count=x\n") EXTENSION("M1SubExt6002", "5", "Count=255\n")
                 EXTENSION("M1SubExt6003", "5", "Count=1;2\n")
                     EXTENSION("M1SubExt6004", "5", "Count=0;0\n")
                         EXTENSION("M1SubExt6005", "5", "Count=1\nObjExtend=255\n")),
      "87: warning: [M1SubExt6000] Count: a number of sub-indices, or 0 and a number of bits "
      "(\"0;4\") expected, it is missing: taken as 1\n"
      "99: warning: [M1SubExt6001] Count: a number of sub-indices, or 0 and a number of bits "
      "(\"0;4\") expected, there is x: taken as 1\n"
      "106: warning: [M1SubExt6002] Count: a number of sub-indices, or 0 and a number of bits "
      "(\"0;4\") expected, there is 255: taken as 1\n"
      "113: warning: [M1SubExt6003] Count: a number of sub-indices, or 0 and a number of bits "
      "(\"0;4\") expected, there is 1;2: taken as 1\n"
      "120: warning: [M1SubExt6004] Count: a number of sub-indices, or 0 and a number of bits "
      "(\"0;4\") expected, there is 0;0: taken as 1\n"
      "128: warning: [M1SubExt6005] ObjExtend: a number of 0..254 expected, there is \"255\": "
      "ignored\n" },
    { "slots",
      DEVICE(SUPPORTED(1) MODULE(1) "[ConnectedModules]\nNrOfEntries=3\n1=1\n255=1\n0=1\nName=x\n"),
      "82: warning: [ConnectedModules] 255: a slot of 1..254 expected (1027h has no more): "
      "ignored\n"
      "83: warning: [ConnectedModules] 0: a slot of 1..254 expected (1027h has no more): ignored\n"
      "79: warning: [ConnectedModules]: 1 to 3 expected, 2 is missing\n"
      "84: warning: [ConnectedModules]: a keyword of CiA 306 for this section expected, there is "
      "\"Name\": ignored\n" },
};

START_TEST(test_check)
{
    bool of_device = strstr(checks[_i].file, "[1027]") != NULL;

    parse(checks[_i].file);
    ck_assert_msg(strcmp(of_device ? told() : messages.text, checks[_i].messages) == 0, "%s:\n%s",
                  checks[_i].name, messages.text);
    ck_assert_uint_eq(dcf.count, of_device ? 13 : strstr(checks[_i].file, "[2000]") ? 5 : 4);
    dcf_done(&dcf);
}
END_TEST

/* Objects that are not of the device itself: "6000:0=2 6000:1(Channel1)=3 ..." */
static const char *added(void)
{
    static char shown[8000];
    char value[100];
    size_t used = 0;

    shown[0] = '\0';
    for (size_t i = 0; i < dcf.count; i++) {
        const struct dcf_entry *entry = &dcf.entries[i];

        if (entry->index < 0x2000)
            continue;
        used += (size_t)snprintf(
            shown + used, sizeof shown - used, "%s%04X:%u(%s)=%s", used ? " " : "", entry->index,
            entry->sub, entry->name,
            hex_format(entry->initial.bytes, entry->initial.size, value, sizeof value));
    }
    return shown;
}

#define CHANNELS(rest) LIST("M1SubExtends", "6000") EXTENSION("M1SubExt6000", "5", rest)
#define IN_USE(slots)  "[ConnectedModules]\nNrOfEntries=" slots
#define SUB_0(index)   index ":0(Highest sub-index supported)="

static const struct {
    const char *name;
    const char *file;
    const char *added;
    const char *messages;
} uses[] = {
    { "none in use", DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=2\n") IN_USE("0\n")), "", "" },
    { "one", DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=2\n") IN_USE("1\n1=1\n")),
      SUB_0("6000") "02 6000:1(Channel1)=03 6000:2(Channel2)=03", "" },
    { "three", DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=1\n") IN_USE("3\n1=1\n2=0x1\n3=1\n")),
      SUB_0("6000") "03 6000:1(Channel1)=03 6000:2(Channel2)=03 6000:3(Channel3)=03", "" },
    { "of two kinds, in the order of their slots",
      DEVICE(SUPPORTED(2) MODULE(1) MODULE(2) CHANNELS("Count=1\n") LIST(
          "M2SubExtends", "6000") "[M2SubExt6000]\nParameterName=Other\nDataType=5\nAccessType="
                                  "ro\nCount=1\n" IN_USE("3\n1=2\n2=1\n3=2\n")),
      SUB_0("6000") "03 6000:1(Other1)= 6000:2(Channel2)=03 6000:3(Other3)=", "" },
    { "bits fill a sub-index",
      DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=0;2\n") IN_USE("5\n1=1\n2=1\n3=1\n4=1\n5=1\n")),
      SUB_0("6000") "02 6000:1(Channel1)=03 6000:2(Channel2)=03", "" },
    { "bits over the end of a sub-index",
      DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=0;12\n") IN_USE("2\n1=1\n2=1\n")),
      SUB_0("6000") "03 6000:1(Channel1)=03 6000:2(Channel2)=03 6000:3(Channel3)=03", "" },
    { "bits that are a sub-index each",
      DEVICE(SUPPORTED(1) MODULE(1)
                 LIST("M1SubExtends", "6000") "[M1SubExt6000]\nParameterName=Bit\nDataType="
                                              "1\nAccessType=ro\nCount=0;2\n" IN_USE("1\n1=1\n")),
      SUB_0("6000") "02 6000:1(Bit1)= 6000:2(Bit2)=", "" },
    { "the next object takes what has no room",
      DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=3\nObjExtend=2\n") IN_USE("1\n1=1\n")),
      SUB_0("6000") "02 6000:1(Channel1)=03 6000:2(Channel2)=03 " SUB_0(
          "6001") "01 6001:1(Channel1)=03",
      "" },
    { "the next object is one that modules fill as well",
      DEVICE(SUPPORTED(1) MODULE(1) "[M1SubExtends]\nNrOfEntries=2\n1=0x6000\n2=0x6001\n" EXTENSION(
          "M1SubExt6000", "5",
          "Count=3\nObjExtend=2\n") "[M1SubExt6001]\nParameterName=Next\nDataType=5\nAccessType="
                                    "ro\nCount=1\n" IN_USE("1\n1=1\n")),
      SUB_0("6000") "02 6000:1(Channel1)=03 6000:2(Channel2)=03 " SUB_0(
          "6001") "02 6001:1(Channel1)=03 6001:2(Next2)=",
      "" },
    { "what the file describes stays",
      OBJECT("2000", "[2000]\nParameterName=Own\nObjectType=8\nDataType=5\nAccessType=ro\n"
                     "CompactSubObj=2\n" SUPPORTED(1) MODULE(1) LIST("M1SubExtends", "2000")
                         EXTENSION("M1SubExt2000", "5", "Count=2\n") IN_USE("1\n1=1\n")),
      SUB_0("2000") "02 2000:1(Own1)= 2000:2(Own2)=",
      "69: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n" },
    { "channels of the device come first",
      OBJECT("2000", "[2000]\nParameterName=Own\nObjectType=8\nDataType=5\nAccessType=ro\n"
                     "CompactSubObj=1\n" SUPPORTED(1) MODULE(1) LIST("M1SubExtends", "2000")
                         EXTENSION("M1SubExt2000", "5", "Count=2\n") IN_USE("1\n1=1\n")),
      SUB_0("2000") "03 2000:1(Own1)= 2000:2(Channel2)=03 2000:3(Channel3)=03",
      "69: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n" },
    { "fixed objects are there once",
      DEVICE(SUPPORTED(2) MODULE(1) MODULE(2)
                 LIST("M1FixedObjects",
                      "2000") "[M1Fixed2000]\nParameterName=R\nObjectType=9\nSubNumber="
                              "2\n" VAR("M1Fixed2000sub0", "5", "ro") "DefaultValue=1\n" VAR(
                                  "M1Fixed2000sub1", "5", "rw") "[M2FixedObjects]"
                                                                "\nNrOfEntries="
                                                                "2\n1=0x2000\n2="
                                                                "0x2001\n" VAR("M2F"
                                                                               "ixe"
                                                                               "d20"
                                                                               "00",
                                                                               "5", "rw")
                                                                    VAR("M2Fixed200"
                                                                        "1",
                                                                        "5", "rw") IN_USE("3\n1="
                                                                                          "1\n2="
                                                                                          "1\n3="
                                                                                          "2\n")),
      "2000:0(Name)=01 2000:1(Name)= 2001:0(Name)=", "" },
    { "a fixed object of the file stays, and is right there",
      OBJECT("2000",
             VAR("2000", "5", "rw") "DefaultValue=7\n" SUPPORTED(1) MODULE(1)
                 LIST("M1FixedObjects", "2000") VAR("M1Fixed2000", "5", "rw") IN_USE("1\n1=1\n")),
      "2000:0(Name)=07",
      "68: warning: [SupportedModules]: an object 1027h (the list of modules) expected, it is "
      "missing\n" },
    { "values for what modules add",
      DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=2\n")
                 IN_USE("1\n1=1\n") "[6000Name]\nNrOfEntries=1\n2=Valve\n"),
      SUB_0("6000") "02 6000:1(Channel1)=03 6000:2(Valve)=03", "" },
};

START_TEST(test_use)
{
    bool of_device = strstr(uses[_i].file, "[1027]") != NULL;

    parse(uses[_i].file);
    ck_assert_msg(strcmp(of_device ? told() : messages.text, uses[_i].messages) == 0, "%s:\n%s",
                  uses[_i].name, messages.text);
    ck_assert_msg(strcmp(added(), uses[_i].added) == 0, "%s: %s", uses[_i].name, added());
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_no_room)
{
    const struct dcf_entry *entry;

    parse(DEVICE(SUPPORTED(1) MODULE(1) CHANNELS("Count=200\n") IN_USE("2\n1=1\n2=1\n")));
    ck_assert_str_eq(told(), "82: warning: 6000h: sub-indices up to 254 expected, the connected "
                             "modules give more: left out\n");
    entry = dcf_find(&dcf, 0x6000, 0);
    ck_assert_ptr_nonnull(entry);
    ck_assert_uint_eq(entry->object_type, 8);
    ck_assert_uint_eq(entry->access, OD_RO);
    ck_assert_uint_eq(entry->initial.bytes[0], 254);
    entry = dcf_find(&dcf, 0x6000, 254);
    ck_assert_ptr_nonnull(entry);
    ck_assert_uint_eq(entry->type, OD_UNSIGNED8);
    ck_assert(entry->mappable);
    ck_assert_uint_eq(entry->line, 82);
    ck_assert_ptr_null(dcf_find(&dcf, 0x6000, 255));
    ck_assert_ptr_null(dcf_find(&dcf, 0x6001, 0));
    dcf_done(&dcf);
}
END_TEST

START_TEST(test_last_object)
{
    parse(DEVICE(SUPPORTED(1) MODULE(1) LIST("M1SubExtends", "FFFF")
                     EXTENSION("M1SubExtFFFF", "5", "Count=3\nObjExtend=2\n") IN_USE("1\n1=1\n")));
    ck_assert_str_eq(told(), "82: warning: FFFFh: sub-indices up to 2 expected, the connected "
                             "modules give more: left out\n");
    ck_assert_ptr_nonnull(dcf_find(&dcf, 0xFFFF, 2));
    dcf_done(&dcf);
}
END_TEST

static Suite *modules_suite(void)
{
    Suite *suite = suite_create("dcf_modules");
    TCase *tests = tcase_create("dcf_modules");

    tcase_add_loop_test(tests, test_check, 0, sizeof checks / sizeof checks[0]);
    tcase_add_loop_test(tests, test_use, 0, sizeof uses / sizeof uses[0]);
    tcase_add_test(tests, test_no_room);
    tcase_add_test(tests, test_last_object);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(modules_suite());
    int failed;

    srunner_run_all(runner, CK_NORMAL);
    failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}

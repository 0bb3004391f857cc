/* Sub-indices against their object; a device without faults has no message. */
#include "support/lint.h"
#include "support/suite.h"

static const struct lint_row rows[] = {
    { "nothing to say", "", "" },
    { "the highest sub-index",
      ARRAY_OF("2000", 3) VALUE("2000sub0", "5", "ro", "3") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub3", "7", "rw", "0"),
      "" },
    { "not the highest sub-index",
      ARRAY_OF("2000", 3) VALUE("2000sub0", "5", "ro", "2") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub3", "7", "rw", "0"),
      "9 sub-0-default: 2000h:00 DefaultValue: 3 expected (the highest sub-index), there is 2\n" },
    { "sub-index 255 describes the object",
      ARRAY_OF("2000", 2) VALUE("2000sub0", "5", "ro", "1") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000subFF", "7", "ro", "0x708"),
      "" },
    { "how many are in use",
      ARRAY_OF("2000", 3) VALUE("2000sub0", "5", "rw", "0") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "7", "rw", "0"),
      "" },
    { "more in use than there are",
      ARRAY_OF("2000", 2) VALUE("2000sub0", "5", "rw", "2") VALUE("2000sub1", "7", "rw", "0"),
      "9 sub-0-default: 2000h:00 DefaultValue: 1 expected (the highest sub-index), there is 2\n" },
    { "no highest sub-index",
      ARRAY_OF("2000", 2) ENTRY("2000sub0", "5", "ro", "") VALUE("2000sub1", "7", "rw", "0"),
      "5 sub-0-default-missing: 2000h:00 DefaultValue: 1 expected (the highest sub-index), it is "
      "missing\n" },
    { "no errors",
      ARRAY_OF("1003", 2) VALUE("1003sub0", "5", "rw", "0") VALUE("1003sub1", "7", "ro", "0"), "" },
    { "errors that nobody tells",
      ARRAY_OF("1003", 2) ENTRY("1003sub0", "5", "rw", "") VALUE("1003sub1", "7", "ro", "0"), "" },
    { "errors to begin with",
      ARRAY_OF("1003", 2) VALUE("1003sub0", "5", "rw", "1") VALUE("1003sub1", "7", "ro", "0"),
      "9 sub-0-default: 1003h:00 DefaultValue: 0 expected (no errors), there is 1\n" },
    { "a record that is called an array",
      ARRAY_OF("1280", 4) VALUE("1280sub0", "5", "const", "3")
          VALUE("1280sub1", "7", "rw", "0x80000000") VALUE("1280sub2", "7", "rw", "0x80000000")
              VALUE("1280sub3", "5", "rw", "3"),
      "5 known-object-type: 1280h ObjectType: 9 (RECORD) expected (CiA 301), there is 8 "
      "(ARRAY)\n" },
    { "an array of two types",
      ARRAY_OF("2000", 4) VALUE("2000sub0", "5", "ro", "3") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "6", "rw", "0") VALUE("2000sub3", "6", "rw", "0"),
      "15 array-types: 2000h:02: UNSIGNED32 expected like the others of the ARRAY, there is "
      "UNSIGNED16\n" },
    { "an array whose last one is of another type",
      ARRAY_OF("2000", 4) VALUE("2000sub0", "5", "ro", "3") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "7", "rw", "0") VALUE("2000sub3", "6", "rw", "0"),
      "20 array-types: 2000h:03: UNSIGNED32 expected like the others of the ARRAY, there is "
      "UNSIGNED16\n" },
    { "text among what can be mapped",
      RECORD_OF("2000", 3) VALUE("2000sub0", "5", "ro", "2")
          ENTRY("2000sub1", "7", "rw", "PDOMapping=1") ENTRY("2000sub2", "9", "rw", "PDOMapping=1"),
      "15 mappable-type: 2000h:02 PDOMapping: 0 expected for VISIBLE_STRING, there is 1\n" },
    { "a record of two types",
      RECORD_OF("2000", 3) VALUE("2000sub0", "5", "ro", "2") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "6", "rw", "0"),
      "" },
    { "text that can be mapped", ENTRY("2000", "9", "rw", "PDOMapping=1"),
      "1 mappable-type: 2000h:00 PDOMapping: 0 expected for VISIBLE_STRING, there is 1\n" },
    { "text that cannot be mapped", ENTRY("2000", "9", "rw", "PDOMapping=0"), "" },
    { "a formula for each node-ID", VALUE("2000", "5", "rw", "$NODEID+0x80"), "" },
    { "a formula for few node-IDs", VALUE("2000", "5", "rw", "$NODEID+0x81"),
      "5 formula-range: 2000h:00: a value of UNSIGNED8 expected, with node-ID 127 this is too "
      "large\n" },
    { "a formula for the node-ID of the file",
      VALUE("2000", "5", "rw", "$NODEID+0x81") "[DeviceComissioning]\nNodeID=5\nBaudrate=500\n",
      "" },
};

START_TEST(objects)
{
    lint_check(&rows[_i]);
}
END_TEST

START_TEST(no_objects)
{
    ck_assert_str_eq(lint_of_file("[FileInfo]\nFileName=a.eds\n"),
                     "0 no-error-control: an object 1017h (heartbeat) expected, or 100Ch and 100Dh "
                     "(guarding), there is neither\n");
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("dcf_lint");

    tcase_add_loop_test(tests, objects, 0, sizeof rows / sizeof rows[0]);
    tcase_add_test(tests, no_objects);
    return suite_run("dcf_lint", tests);
}

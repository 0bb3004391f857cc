/* Sub-indices against their object; a device without faults has no message. */
#include "support/lint.h"
#include "support/suite.h"

#include <string.h>

static const struct {
    const char *name, *added, *messages;
} rows[] = {
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
    { "an array of two types",
      ARRAY_OF("2000", 4) VALUE("2000sub0", "5", "ro", "3") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "6", "rw", "0") VALUE("2000sub3", "6", "rw", "0"),
      "15 array-types: 2000h:02: UNSIGNED32 expected like the others of the ARRAY, there is "
      "UNSIGNED16\n" },
    { "a record of two types",
      RECORD_OF("2000", 3) VALUE("2000sub0", "5", "ro", "2") VALUE("2000sub1", "7", "rw", "0")
          VALUE("2000sub2", "6", "rw", "0"),
      "" },
};

START_TEST(objects)
{
    const char *messages = lint_of(rows[_i].added);

    ck_assert_msg(strcmp(messages, rows[_i].messages) == 0, "%s:\n%s", rows[_i].name, messages);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("dcf_lint");

    tcase_add_loop_test(tests, objects, 0, sizeof rows / sizeof rows[0]);
    return suite_run("dcf_lint", tests);
}

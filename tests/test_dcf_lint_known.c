/* Objects of CiA 301 and 302 as they are described there, and as they are not. */
#include "support/lint.h"
#include "support/suite.h"

#define ONE_OF(name, type)                                                                         \
    ARRAY_OF(name, 2) VALUE(name "sub0", "5", "ro", "1") ENTRY(name "sub1", type, "rw", "")
#define SDO(name, access, type)                                                                    \
    RECORD_OF(name, 3)                                                                             \
    VALUE(name "sub0", "5", "ro", "2")                                                             \
    ENTRY(name "sub1", type, access, "") ENTRY(name "sub2", "7", access, "")
#define PDO                                                                                        \
    RECORD_OF("1400", 3)                                                                           \
    VALUE("1400sub0", "5", "ro", "2")                                                              \
    VALUE("1400sub1", "7", "rw", "0x201") VALUE("1400sub2", "5", "rw", "255")

static const struct lint_row objects_rows[] = {
    { "a VAR", VALUE("1006", "7", "rw", "0"), "" },
    { "another data type", VALUE("1006", "6", "rw", "0"),
      "1 known-data-type: 1006h:00 DataType: UNSIGNED32 expected (CiA 301), there is "
      "UNSIGNED16\n" },
    { "no VAR", ONE_OF("1006", "7"),
      "5 known-object-type: 1006h ObjectType: 7 (VAR) expected (CiA 301), there is 8 (ARRAY)\n" },
    { "an ARRAY", ONE_OF("1016", "7"), "" },
    { "an ARRAY of another type", ONE_OF("1016", "6"),
      "10 known-data-type: 1016h:01 DataType: UNSIGNED32 expected (CiA 301), there is "
      "UNSIGNED16\n" },
    { "an ARRAY of CiA 302", ONE_OF("1F81", "6"),
      "10 known-data-type: 1F81h:01 DataType: UNSIGNED32 expected (CiA 302), there is "
      "UNSIGNED16\n" },
    { "no ARRAY",
      RECORD_OF("1029", 2) VALUE("1029sub0", "5", "ro", "1") VALUE("1029sub1", "5", "rw", "0"),
      "5 known-object-type: 1029h ObjectType: 8 (ARRAY) expected (CiA 301), there is 9 "
      "(RECORD)\n" },
    { "no sub-index 0, which alone knows the object's type",
      ARRAY_OF("1029", 1) VALUE("1029sub1", "5", "rw", "0"), "" },
    { "an EDS", ENTRY("1021", "15", "ro", "ObjectType=2"), "" },
    { "an EDS as VAR", ENTRY("1021", "15", "ro", ""), "" },
    { "an EDS that can be written", ENTRY("1021", "15", "rw", ""),
      "1 known-access: 1021h:00 AccessType: ro or const expected (CiA 301), there is rw\n" },
    { "a device name", VALUE("1008", "9", "const", "x"), "" },
    { "a device name of another type", VALUE("1008", "10", "const", "00"),
      "1 known-data-type: 1008h:00 DataType: VISIBLE_STRING expected (CiA 301), there is "
      "OCTET_STRING\n" },
    { "errors that can be written",
      ARRAY_OF("1003", 2) VALUE("1003sub0", "5", "rw", "0") ENTRY("1003sub1", "7", "rw", ""),
      "10 known-access: 1003h:01 AccessType: ro or const expected (CiA 301), there is rw\n" },
    { "a default SDO server", SDO("1200", "ro", "7"), "" },
    { "a default SDO server that can be written, told once", SDO("1200", "rw", "7"),
      "10 known-access: 1200h:01 AccessType: ro or const expected (CiA 301), there is rw\n" },
    { "another SDO server", SDO("1201", "rw", "7"), "" },
    { "an SDO client of another type", SDO("1280", "rw", "6"),
      "10 known-data-type: 1280h:01 DataType: UNSIGNED32 expected (CiA 301), there is "
      "UNSIGNED16\n" },
    { "half an SDO client",
      RECORD_OF("1280", 2) VALUE("1280sub0", "5", "ro", "1") ENTRY("1280sub1", "7", "rw", ""),
      "5 known-sub: 1280h: a sub-index 2 expected (CiA 301), it is missing\n" },
    { "a mapping as ARRAY",
      PDO ARRAY_OF("1600", 2) VALUE("1600sub0", "5", "rw", "0") ENTRY("1600sub1", "7", "rw", ""),
      "" },
    { "a mapping that is none", PDO ENTRY("1600", "7", "ro", ""),
      "20 known-object-type: 1600h ObjectType: 9 (RECORD) expected (CiA 301), there is 7 (VAR)\n" },
    { "an unknown one", ONE_OF("1F00", "6"), "" },
};

START_TEST(objects)
{
    lint_check(&objects_rows[_i]);
}
END_TEST

#define ROWS(table) (int)(sizeof(table) / sizeof *(table))

int main(void)
{
    TCase *tests = tcase_create("dcf_lint_known");

    tcase_add_loop_test(tests, objects, 0, ROWS(objects_rows));
    return suite_run("dcf_lint_known", tests);
}

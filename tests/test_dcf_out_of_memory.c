/* Memory runs out at each moment of reading and checking a file: it is told, nothing is left. */
#include "dcf/dcf_lint.h"
#include "support/lint.h"
#include "support/scarce.h"
#include "support/suite.h"

#include <stdlib.h>
#include <string.h>

#define MOST 2000u /* far more allocations than there are */

static const char text[] = LINES(
    VALUE("1005", "7", "rw", "0x80") ARRAY_OF("1028", 3) VALUE("1028sub0", "5", "ro", "2")
        VALUE("1028sub1", "7", "rw", "0x81") VALUE("1028sub2", "7", "rw", "0x82")
            ARRAY_OF("2000", 0) "DataType=7\nAccessType=rw\nCompactSubObj=3\nDefaultValue=1\n"
                                "[2000Name]\nNrOfEntries=1\n1=One\n"
                                "[2000Value]\nNrOfEntries=1\n1=1\n"
                                "[SupportedModules]\nNrOfEntries=1\n"
                                "[M1ModuleInfo]\nProductName=M\nOrderCode=M\n"
                                "[M1Fixed2001]\nDataType=7\nParameterName=M\n"
                                "[M1SubExt2000]\nDataType=7\nParameterName=N\nCount=5\n"
                                "[ConnectedModules]\nNrOfEntries=1\n1=1\n"
                                "[Comments]\nLines=1\nLine2=a gap\n");

START_TEST(a_file_is_read)
{
    struct co_report report = { .file = "a.eds" };
    enum co_err err = CO_ERR_MEMORY;
    struct dcf dcf;
    unsigned n;

    for (n = 1; err != CO_OK && n < MOST; n++) {
        memory_left = n;
        err = dcf_parse(text, strlen(text), &report, &dcf);
        memory_left = 0;
        ck_assert_msg(err == CO_OK || err == CO_ERR_MEMORY, "%u: %s", n, report.first_error);
    }
    ck_assert_int_eq(err, CO_OK);
    ck_assert_uint_gt(n, 3);
    dcf_done(&dcf);
}
END_TEST

START_TEST(a_file_is_checked)
{
    struct co_report report = { .file = "a.eds" };
    struct dcf dcf;

    ck_assert_int_eq(dcf_parse(text, strlen(text), &report, &dcf), CO_OK);
    memory_left = 1;
    ck_assert_int_eq(dcf_lint(&dcf, &report), CO_ERR_MEMORY);
    memory_left = 0;
    ck_assert_int_eq(dcf_lint(&dcf, &report), CO_OK);
    dcf_done(&dcf);
}
END_TEST

int main(void)
{
    TCase *tests = tcase_create("dcf_out_of_memory");

    tcase_add_test(tests, a_file_is_read);
    tcase_add_test(tests, a_file_is_checked);
    return suite_run("dcf_out_of_memory", tests);
}

/*
 * Runs one function of a test program alone: the environment's TEST_ONLY names it. (Check itself
 * can select only cases, which have many.)
 */
#include <check.h>
#include <stdlib.h>
#include <string.h>

void __real__tcase_add_test(TCase *tc, const TTest *ttest, int signal, int exit_value, int start,
                            int end);
void __wrap__tcase_add_test(TCase *tc, const TTest *ttest, int signal, int exit_value, int start,
                            int end);

void __wrap__tcase_add_test(TCase *tc, const TTest *ttest, int signal, int exit_value, int start,
                            int end)
{
    const char *only = getenv("TEST_ONLY");

    if (!only || strcmp(only, ttest->name) == 0)
        __real__tcase_add_test(tc, ttest, signal, exit_value, start, end);
}

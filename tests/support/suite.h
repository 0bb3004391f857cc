/*
 * Runs one test case as a test program.
 */
#ifndef TEST_SUPPORT_SUITE_H
#define TEST_SUPPORT_SUITE_H

#include <check.h>

/* The program's exit status: 0 if all went well. */
int suite_run(const char *name, TCase *tcase);

#endif

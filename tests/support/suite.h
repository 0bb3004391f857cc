/*
 * Runs one test case as a test program.
 *
 * The program has a folder of its own for files, TMPDIR while it runs. It goes when the program
 * ends, whatever became of its tests; tests that pass and leave something in it have failed.
 */
#ifndef TEST_SUPPORT_SUITE_H
#define TEST_SUPPORT_SUITE_H

#include <check.h>

#define SUITE_PATH_SIZE 256

/* The program's exit status: 0 if all went well. */
int suite_run(const char *name, TCase *tcase);

/* A name for mkdtemp() or mkstemp() in that folder. */
void suite_temporary(const char *name, char ret_path[SUITE_PATH_SIZE]);

#endif

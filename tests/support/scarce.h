/*
 * Memory that runs out when a test says so: for programs that are linked with
 * -Wl,--wrap=malloc, calloc, realloc and strdup, each of them.
 */
#ifndef TEST_SUPPORT_SCARCE_H
#define TEST_SUPPORT_SCARCE_H

#include <stdbool.h>

extern _Thread_local unsigned memory_left; /* this thread's, until one fails; 0: none does */

/* Counts down, and tells the end; for other calls that a test lets fail. */
bool scarce_fails(unsigned *left);

#endif

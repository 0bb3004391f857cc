/*
 * Whether this thread runs code of the application on behalf of the library: a handler, or the log
 * hook. Calls that wait or delete are refused then.
 */
#ifndef CO_API_CALLBACK_H
#define CO_API_CALLBACK_H

#include <stdbool.h>

/* The two come in pairs; within each other, too. */
void callback_begin(void);
void callback_end(void);
bool callback_running(void);

#endif

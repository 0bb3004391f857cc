/*
 * Where messages leave the library: the application's hook, or stderr.
 *
 * Never called under a lock of the library but its own, which is not held while the hook runs;
 * but for messages that are kept.
 */
#ifndef CO_API_LOG_H
#define CO_API_LOG_H

#include "base/report.h"

void log_put(enum co_severity severity, const char *text);
/* A sink for struct co_report; the context is not used. */
void log_sink(void *context, const struct co_message *message);
/*
 * Between the two what this thread puts is kept, and told by log_release(): the first one comes
 * behind taking a lock, the second one behind giving it.
 */
void log_keep(void);
void log_release(void);
/* Back to stderr. */
void log_reset(void);

#endif

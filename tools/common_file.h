/*
 * Files of the small tools: written so that a failure leaves nothing behind. api/file.h reads them.
 */
#ifndef TOOLS_COMMON_FILE_H
#define TOOLS_COMMON_FILE_H

#include "base/error.h"
#include "base/report.h"

#include <stddef.h>
#include <stdint.h>

/* Replaces the file at once, when all has been written; CO_ERR_IO with errno set, CO_ERR_MEMORY. */
enum co_err file_write(const char *name, const uint8_t *bytes, size_t size);

/* The folder of a file with its "/", or "" ; freed by free(), NULL: no memory. */
char *file_folder(const char *name);

/* For co_report: lines to stderr, with the names of rules behind them. */
void file_report_line(void *context, const struct co_message *message);

/* "tool: name: text of err" to stderr, where err is CO_ERR_IO with that of errno. */
void file_tell(const char *tool, const char *name, enum co_err err);

#endif

/*
 * Whole files, for the small tools: read at once, written so that a failure leaves nothing behind.
 */
#ifndef TOOLS_COMMON_FILE_H
#define TOOLS_COMMON_FILE_H

#include "base/error.h"
#include "base/report.h"

#include <stddef.h>
#include <stdint.h>

/* The contents, which are freed by free(); CO_ERR_IO with errno set, CO_ERR_MEMORY. */
enum co_err file_read(const char *name, uint8_t **ret_bytes, size_t *ret_size);

/* Replaces the file at once, when all has been written; CO_ERR_IO with errno set, CO_ERR_MEMORY. */
enum co_err file_write(const char *name, const uint8_t *bytes, size_t size);

/* The folder of a file with its "/", or "" ; freed by free(), NULL: no memory. */
char *file_folder(const char *name);

/* For co_report: lines to stderr. */
void file_report_line(void *context, enum co_severity severity, const char *text);

/* "tool: name: text of err" to stderr, where err is CO_ERR_IO with that of errno. */
void file_tell(const char *tool, const char *name, enum co_err err);

#endif

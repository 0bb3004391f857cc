/*
 * Files of the small tools: where they are, and what is said about them. api/file.h reads them,
 * api/file_draft.h writes them.
 */
#ifndef TOOLS_COMMON_FILE_H
#define TOOLS_COMMON_FILE_H

#include "base/error.h"
#include "base/report.h"

#include <stddef.h>

/* As file_read(), with "-" for standard input. */
enum co_err file_read_input(const char *name, char **ret_text, size_t *ret_size);
/* The name for messages. */
const char *file_input_name(const char *name);

/* The folder of a file with its "/", or "" ; freed by free(), NULL: no memory. */
char *file_folder(const char *name);

/* For co_report: lines to stderr, with the names of rules behind them. */
void file_report_line(void *context, const struct co_message *message);
/* The same without warnings. */
void file_report_error(void *context, const struct co_message *message);

/* "tool: name: text of err" to stderr, where err is CO_ERR_IO with that of errno. */
void file_tell(const char *tool, const char *name, enum co_err err);

#endif

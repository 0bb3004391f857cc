/*
 * Files of the host: reading one whole, and finding those that a configuration names.
 */
#ifndef CO_API_FILE_H
#define CO_API_FILE_H

#include "base/error.h"
#include "manager/network_config.h"

#include <stddef.h>
#include <stdio.h>

#define FILE_SIZE_MAX   (64u << 20) /* more is no configuration file; file_error_text() has it */
#define FILE_WRITER_MS  3000        /* how long a pipe may be without anybody who writes */
#define FILE_SILENCE_MS 60000       /* and with one who does not */

/*
 * The whole contents, with a NUL behind them that does not count; to be freed.
 * CO_ERR_NOT_FOUND, CO_ERR_PERMISSION, CO_ERR_ARG: a folder, CO_ERR_VALUE: too large,
 * CO_ERR_TIMEOUT: a pipe or a device gives nothing, CO_ERR_IO with errno, CO_ERR_MEMORY.
 */
enum co_err file_read(const char *path, char **ret_text, size_t *ret_size);
/* The same of a stream that nobody has read from, which stays open: standard input. */
enum co_err file_read_stream(FILE *stream, char **ret_text, size_t *ret_size);
/* What an error of file_read() means to the user; CO_ERR_IO by errno. */
const char *file_error_text(enum co_err err);

/*
 * Where a file named in a network's configuration is: as given, under its repository, beside the
 * XML file (and the repository beside it). *ret_path is to be freed; the name as given when it is
 * nowhere. CO_ERR_MEMORY.
 */
enum co_err file_find(const struct network_config *config, const char *xml_path, const char *name,
                      char **ret_path);
/*
 * For a name that is nowhere: the file that a machine which tells neither cases nor \ and / apart
 * would have taken; to be freed. NULL: none, or no memory.
 */
char *file_find_alike(const struct network_config *config, const char *xml_path, const char *name);

#endif

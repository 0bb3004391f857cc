/*
 * The files of one run of dcf2ccf: what it has read, and what it writes, all of it or nothing.
 *
 *     ccf_files_read(&files, "pump.dcf") ...       as it reads them
 *     ccf_files_write(&files, "pump.ccf", bytes, size) ...
 *     ccf_files_take(&files)                       now the outputs are there
 *     ccf_files_done(&files)                       without it none is
 *
 * Devices, pipes and stdout ("-") get their bytes at once. Each function tells the user what is
 * wrong, and returns false.
 */
#ifndef TOOLS_DCF2CCF_FILES_H
#define TOOLS_DCF2CCF_FILES_H

#include "api/file_draft.h"

#include <stdbool.h>
#include <stddef.h>

struct ccf_output {
    char *name;
    bool is_draft;
    struct file_draft draft;
};

struct ccf_files { /* zeros: nothing yet */
    char **read;
    size_t read_count;
    struct ccf_output *written;
    size_t written_count;
};

bool ccf_files_read(struct ccf_files *self, const char *name);
/* Refuses to write what has been read. */
bool ccf_files_write(struct ccf_files *self, const char *name, const void *bytes, size_t size);
/* Writes a rule for make and ninja: the outputs so far depend on what has been read. */
bool ccf_files_write_rule(struct ccf_files *self, const char *name);
bool ccf_files_take(struct ccf_files *self);
void ccf_files_done(struct ccf_files *self);

#endif

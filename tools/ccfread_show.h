/*
 * Shows one concise DCF after the other, as far as each can be read.
 */
#ifndef TOOLS_CCFREAD_SHOW_H
#define TOOLS_CCFREAD_SHOW_H

#include "ccfread_view.h"

struct show {
    const struct view *view;
    const struct dcf *eds; /* NULL: none */
    const char *eds_name;
    unsigned files; /* shown by now */
    bool failed;    /* standard output, or no memory: nothing more is shown */
};

/* The exit code for this file. */
int show_file(struct show *self, const char *name);

#endif

/*
 * The files that ccfread reads: concise DCFs that may be damaged, and the EDS or DCF with names.
 */
#ifndef TOOLS_CCFREAD_INPUT_H
#define TOOLS_CCFREAD_INPUT_H

#include "dcf/dcf.h"

enum {
    EXIT_GOOD = 0,
    EXIT_FOUND = 1,  /* damage, or differences */
    EXIT_TROUBLE = 2 /* usage, or a file that cannot be read or written */
};

struct input {
    const char *name;
    uint8_t *bytes;
    size_t size;
    struct co_report report;         /* errors and warnings to stderr */
    char error[CO_REPORT_TEXT_SIZE]; /* what is wrong, without the place */
};

/* "-" is standard input. False: told on stderr, and nothing is to be released. */
bool input_read(struct input *self, const char *name);
void input_done(struct input *self);

/* EDS or DCF. False: told on stderr, and nothing is to be released. */
bool input_read_eds(const char *name, struct dcf *ret_dcf);

/* Tells on stderr that standard output could not be written; the exit code for it. */
int input_tell_output(void);

#endif

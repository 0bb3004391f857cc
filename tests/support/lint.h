/*
 * What dcf_lint() says about a device of a few objects and what a test adds to them.
 *
 * The device alone gives no message. Messages come as "line rule: text", the line counted from the
 * first one that is added; 0: a line before, or none.
 */
#ifndef TEST_SUPPORT_LINT_H
#define TEST_SUPPORT_LINT_H

#include "dcf/dcf.h"
#include "support/dcf_file.h"

/* [xxxx] with a DefaultValue and what else there is. */
#define ENTRY(name, type, access, rest)  VAR(name, type, access) rest "\n"
#define VALUE(name, type, access, value) ENTRY(name, type, access, "DefaultValue=" value)
/* [xxxx] of an object with so many sub-indices. */
#define ARRAY_OF(name, count) "[" name "]\nParameterName=Name\nObjectType=8\nSubNumber=" #count "\n"
#define RECORD_OF(name, count)                                                                     \
    "[" name "]\nParameterName=Name\nObjectType=9\nSubNumber=" #count "\n"

struct lint_row {
    const char *name, *added, *messages;
};

/* Fails where the messages are others. */
void lint_check(const struct lint_row *row);

/* The messages; their memory is used again by the next call. */
const char *lint_of(const char *added);
/* The same for a file of its own. */
const char *lint_of_file(const char *text);

/* Messages of dcf_compare() about two files made of the device and what is added. */
const char *comparison_of(const char *dcf, const char *eds);

#endif

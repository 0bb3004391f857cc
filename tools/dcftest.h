/*
 * dcftest: checks EDS and DCF files with the reader of the manager. What its parts share.
 *
 *   dcftest_files   arguments -> list of files
 *   dcftest_check   one file -> struct result
 *   dcftest_run     all files, several at a time, their results in order -> a writer
 *   dcftest_text, dcftest_json, dcftest_sarif   writers
 *   dcftest_online  one file against a device; dcftest_sdo, dcftest_value
 *   dcftest_rules   which rules there are, and which are wanted
 */
#ifndef TOOLS_DCFTEST_H
#define TOOLS_DCFTEST_H

#include "base/report.h"
#include "common_rules.h"
#include "dcf/dcf.h"
#include "dcf/dcf_rules.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define DCFTEST_CLEAN   0
#define DCFTEST_ERRORS  1
#define DCFTEST_TROUBLE 2 /* wrong usage; no memory, no output */

/* --- rules: those of src/dcf/, and those of the tool itself --- */

enum tool_rule {
    RULE_UNREADABLE,
    RULE_ONLINE_IDENTITY,
    RULE_ONLINE_OBJECT,
    RULE_ONLINE_SIZE,
    RULE_ONLINE_VALUE,
    TOOL_RULE_COUNT
};

extern const struct co_rule tool_rules[TOOL_RULE_COUNT];

#define RULE_COUNT (DCF_RULE_COUNT + TOOL_RULE_COUNT)

const struct co_rule *rule_at(size_t number); /* 0..RULE_COUNT - 1, in the order of a listing */
/* RULE_COUNT: NULL, or a rule that is none of these. */
size_t rule_number(const struct co_rule *rule);
/* "CANOPEN_DCF_..." of a rule, or NULL. */
const char *rule_code(const struct co_rule *rule);
/* All of them are wanted. */
void rules_init(struct rule_choice *self);
bool rules_print(bool json); /* --list-rules; false: not written */

/* --- files --- */

#define NOTHING_IN_IT (-1) /* in place of an errno: a folder without EDS and DCF files */

struct files {
    struct file {
        char *path;
        int error; /* errno: it cannot be read; 0: try */
    } * list;
    size_t count, room;
};

/* One argument: a file, "-" for stdin, or a folder with all that is below. False: no memory. */
bool files_add(struct files *self, const char *argument);
void files_done(struct files *self);

/* --- results --- */

#define FINDINGS_MAX 10000u /* of a severity and a file; the rest is counted */

struct finding {
    enum co_severity severity;
    bool is_minor; /* a warning, or about warnings */
    unsigned line; /* 0: the whole file */
    unsigned order;
    const struct co_rule *rule; /* NULL: none */
    int32_t index, sub;         /* of the section that the line is in; -1: none */
    char *text;
};

#define REST_MAX 3u

struct rest { /* what takes the place of findings that are missing */
    struct finding finding;
    char text[64];
};

struct result {
    const char *file;
    struct finding *findings; /* by their lines */
    size_t count, room;
    unsigned errors, warnings;
    unsigned kept[2]; /* of errors and warnings, findings that are kept */
    bool no_memory;   /* findings are missing */
    struct rest rest[REST_MAX];
    size_t rest_count;
};

struct settings {
    struct rule_choice rules;
    bool strict, json, sarif, summary;
    unsigned quiet;        /* 1: no warnings, 2: nothing */
    unsigned jobs;         /* 0: as many as processors */
    uint8_t node_id;       /* 0: that of the file */
    const struct dcf *eds; /* NULL: none to compare with */
};

void result_init(struct result *self, const char *file);
void result_done(struct result *self);
/* A finding of the tool itself. */
void result_add(struct result *self, const struct settings *settings, const struct co_rule *rule,
                unsigned line, const char *text);
/* For the sink of a report. */
void result_take(struct result *self, const struct settings *settings,
                 const struct co_message *message);
/* Findings by line, each with its object, where there is a text and somebody wants to know. */
void result_finish(struct result *self, const struct settings *settings, const char *text,
                   size_t size);
/* The findings, and the rest behind them, from 0 on; NULL: there are no more. */
const struct finding *result_at(const struct result *self, size_t number);

/* The whole file, to be freed; false: it cannot be read, that is in the result. */
bool read_or_tell(const struct settings *settings, const struct file *file, struct result *result,
                  char **ret_text, size_t *ret_size);
/* A description for other files to be compared with; its errors are in the result. */
bool read_eds(const struct settings *settings, const struct file *file, struct result *result,
              struct dcf *ret_eds);
/* Everything about one file; for any thread. */
void check_file(const struct settings *settings, const struct file *file, struct result *result);

/* --- output --- */

struct totals {
    unsigned long files;
    unsigned long errors, warnings;
};

struct output {
    const struct settings *settings;
    struct totals totals; /* of what has been written */
    unsigned long parts;  /* for a writer: how many it has written */
};

struct writer { /* each returns false where it has not written all */
    bool (*begin)(struct output *self);
    bool (*result)(struct output *self, const struct result *result);
    bool (*end)(struct output *self);
};

extern const struct writer text_writer, json_writer, sarif_writer;

/* Is it to be written, with these settings? */
bool finding_is_shown(const struct settings *settings, const struct finding *finding);
/* What is about the whole file stands at its first line: an editor wants to go somewhere. */
unsigned shown_line(const struct finding *finding);
int exit_code(const struct settings *settings, const struct totals *totals);

/* The whole output for this one result, which is done then. */
bool write_one(const struct settings *settings, const struct writer *writer, struct result *result,
               struct totals *ret_totals);
/* Checks all, writes all, adds all up. False: an output failed, or no memory. */
bool run_checks(const struct settings *settings, const struct files *files,
                const struct writer *writer, struct totals *ret_totals);

#endif

/*
 * Messages about input files, in the style of compilers: "network.xml:14: error: text".
 *
 *   in   severity, line and text from a parser
 *   out  one formatted line for each message, to the sink of whoever reads the file
 *
 * The parser that finds something says it here and goes on as far as it can; its return value only
 * tells that there were errors. A file that is wrong in each of its million lines gives some
 * messages, and a last one that says that there are more.
 */
#ifndef CO_BASE_REPORT_H
#define CO_BASE_REPORT_H

enum co_severity { CO_ERROR, CO_WARNING, CO_INFO };

#define CO_REPORT_TEXT_SIZE 512u
#define CO_REPORT_LIMIT     1000u /* more errors, or more warnings, of one file help nobody */

/* What a file has to keep to, with a name by which users speak of it. */
struct co_rule {
    const char *name; /* "sub-count" */
    enum co_severity severity;
    int kind;           /* as of co_report_kind(); 0: none */
    const char *clause; /* where it is written: "CiA 306-1, object sections" */
    const char *text;   /* a sentence for the manual page */
};

struct co_message {
    enum co_severity severity;
    unsigned line;              /* 0: the whole file */
    const struct co_rule *rule; /* NULL: none */
    const char *text;           /* "network.xml:14: error: what is wrong" */
    const char *body;           /* "what is wrong" */
};

struct co_report {
    const char *file; /* as shown; NULL: no place */

    /* NULL: only count */
    void (*sink)(void *context, const struct co_message *message);
    void *context;

    unsigned errors; /* all, also those that the sink does not get */
    unsigned warnings;
    unsigned limit; /* the sink gets so many of each of them; 0: CO_REPORT_LIMIT */
    int error_kind; /* what the caller gave with co_report_kind for the first error; 0: none */
    char first_error[CO_REPORT_TEXT_SIZE]; /* whole line of the first error */
};

/* line 0: the message is about the whole file */
void co_report_add(struct co_report *self, enum co_severity severity, unsigned line,
                   const char *format, ...) __attribute__((format(printf, 4, 5)));

/* The same for a rule that is broken: its severity and its kind. */
void co_report_rule(struct co_report *self, const struct co_rule *rule, unsigned line,
                    const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Classifies the error reported last, where it was the first: a value of the caller's own. */
void co_report_kind(struct co_report *self, int kind);

const char *co_severity_text(enum co_severity severity);

#endif

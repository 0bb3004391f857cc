/*
 * The messages of one reading of a configuration file: counted, classified, and not too many.
 *
 * Internal to network_config.
 */
#ifndef CO_MANAGER_NETWORK_CONFIG_FAULTS_H
#define CO_MANAGER_NETWORK_CONFIG_FAULTS_H

#include "base/error.h"
#include "base/report.h"

#include <stdbool.h>

struct faults {
    struct co_report *report;
    unsigned told;   /* messages of any severity */
    unsigned errors; /* of this file; the report may have served others before */
    bool full;       /* NETWORK_MESSAGES told: nobody reads more, stop */
    bool no_memory;
};

void faults_error(struct faults *self, enum co_err kind, unsigned line, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
void faults_note(struct faults *self, enum co_severity severity, unsigned line, const char *format,
                 ...) __attribute__((format(printf, 4, 5)));

#define FAULTS_EXCERPT_SIZE 48u

/* What the file says, fit for a message: printable ASCII, shortened. Returns excerpt. */
const char *faults_excerpt(const char *text, char excerpt[FAULTS_EXCERPT_SIZE]);

#endif

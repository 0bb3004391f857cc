#include "manager/network_config_faults.h"

#include "manager/network_config.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void tell(struct faults *self, enum co_severity severity, unsigned line, const char *format,
                 va_list args)
{
    char text[CO_REPORT_TEXT_SIZE];

    if (self->full)
        return;
    vsnprintf(text, sizeof text, format, args);
    co_report_add(self->report, severity, line, "%s", text);
    self->told++;
}

static void stop_when_full(struct faults *self)
{
    if (self->full || self->told < NETWORK_MESSAGES)
        return;
    self->full = true;
    self->errors++;
    co_report_add(self->report, CO_ERROR, 0, "too many messages, the rest is left out");
    co_report_kind(self->report, CO_ERR_VALUE);
}

void faults_error(struct faults *self, enum co_err kind, unsigned line, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    tell(self, CO_ERROR, line, format, args);
    va_end(args);
    self->errors++;
    co_report_kind(self->report, kind);
    stop_when_full(self);
}

void faults_note(struct faults *self, enum co_severity severity, unsigned line, const char *format,
                 ...)
{
    va_list args;

    va_start(args, format);
    tell(self, severity, line, format, args);
    va_end(args);
    stop_when_full(self);
}

const char *faults_excerpt(const char *text, char excerpt[FAULTS_EXCERPT_SIZE])
{
    size_t n = 0;

    for (; text[n] != '\0' && n < FAULTS_EXCERPT_SIZE - 1; n++)
        excerpt[n] = text[n] >= ' ' && text[n] <= '~' ? text[n] : '?';
    excerpt[n] = '\0';
    if (text[n] != '\0')
        memcpy(excerpt + FAULTS_EXCERPT_SIZE - 4, "...", 4);
    return excerpt;
}

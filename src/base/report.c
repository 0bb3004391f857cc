#include "base/report.h"

#include <stdarg.h>
#include <stdio.h>

const char *co_severity_text(enum co_severity severity)
{
    switch (severity) {
    case CO_ERROR: return "error";
    case CO_WARNING: return "warning";
    case CO_INFO: return "info";
    }
    return "error";
}

static int format_place(const struct co_report *self, enum co_severity severity, unsigned line,
                        char *text, size_t size)
{
    const char *kind = co_severity_text(severity);

    if (!self->file)
        return snprintf(text, size, "%s: ", kind);
    if (line == 0)
        return snprintf(text, size, "%s: %s: ", self->file, kind);
    return snprintf(text, size, "%s:%u: %s: ", self->file, line, kind);
}

void co_report_add(struct co_report *self, enum co_severity severity, unsigned line,
                   const char *format, ...)
{
    char text[CO_REPORT_TEXT_SIZE];
    int place = format_place(self, severity, line, text, sizeof text);
    va_list args;

    if (place < 0 || (size_t)place >= sizeof text)
        place = 0;
    va_start(args, format);
    vsnprintf(text + place, sizeof text - (size_t)place, format, args);
    va_end(args);
    if (severity == CO_ERROR && self->errors++ == 0)
        snprintf(self->first_error, sizeof self->first_error, "%s", text);
    if (severity == CO_WARNING)
        self->warnings++;
    if (self->sink)
        self->sink(self->context, severity, text);
}

void co_report_kind(struct co_report *self, int kind)
{
    if (self->errors == 1 && self->error_kind == 0)
        self->error_kind = kind;
}

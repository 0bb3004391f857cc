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

/* Counts a message; its number among those of its severity. */
static unsigned count(struct co_report *self, enum co_severity severity)
{
    switch (severity) {
    case CO_ERROR: return ++self->errors;
    case CO_WARNING: return ++self->warnings;
    case CO_INFO: return 0;
    }
    return 0;
}

static void say(struct co_report *self, struct co_message message, const char *format, va_list args)
    __attribute__((format(printf, 3, 0)));

static void say(struct co_report *self, struct co_message message, const char *format, va_list args)
{
    char text[CO_REPORT_TEXT_SIZE];
    int place = format_place(self, message.severity, message.line, text, sizeof text);

    if (place < 0 || (size_t)place >= sizeof text)
        place = 0;
    vsnprintf(text + place, sizeof text - (size_t)place, format, args);
    message.text = text;
    message.body = text + place;
    if (message.severity == CO_ERROR && self->errors == 1)
        snprintf(self->first_error, sizeof self->first_error, "%s", text);
    if (self->sink)
        self->sink(self->context, &message);
}

static void say_rest(struct co_report *self, enum co_severity severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static void say_rest(struct co_report *self, enum co_severity severity, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    say(self, (struct co_message){ .severity = severity }, format, args);
    va_end(args);
}

static void tell(struct co_report *self, struct co_message message, const char *format,
                 va_list args) __attribute__((format(printf, 3, 0)));

static void tell(struct co_report *self, struct co_message message, const char *format,
                 va_list args)
{
    const unsigned limit = self->limit ? self->limit : CO_REPORT_LIMIT;
    const unsigned number = count(self, message.severity);

    if (number <= limit)
        say(self, message, format, args);
    else if (number == limit + 1)
        say_rest(self, message.severity, "there are more than %u %ss: the rest is left out", limit,
                 co_severity_text(message.severity));
}

void co_report_add(struct co_report *self, enum co_severity severity, unsigned line,
                   const char *format, ...)
{
    va_list args;

    va_start(args, format);
    tell(self, (struct co_message){ .severity = severity, .line = line }, format, args);
    va_end(args);
}

void co_report_rule(struct co_report *self, const struct co_rule *rule, unsigned line,
                    const char *format, ...)
{
    va_list args;

    va_start(args, format);
    tell(self, (struct co_message){ .severity = rule->severity, .line = line, .rule = rule },
         format, args);
    va_end(args);
    if (rule->severity == CO_ERROR)
        co_report_kind(self, rule->kind);
}

void co_report_kind(struct co_report *self, int kind)
{
    if (self->errors == 1 && self->error_kind == 0)
        self->error_kind = kind;
}

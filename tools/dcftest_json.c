/*
 * { "files": [ { "file", "errors", "warnings", "messages": [ ... ] } ... ],
 *   "summary": { "files", "errors", "warnings" } }
 *
 * File by file: all of them together may be more than there is memory.
 */
#include "dcftest.h"

#include "json/json_text.h"

static json_t *number_or_null(int64_t number)
{
    return number < 0 ? json_null() : json_integer(number);
}

static json_t *text_or_null(const char *text)
{
    return text ? json_text(text) : json_null();
}

static json_t *message_of(const struct result *result, const struct finding *finding)
{
    const struct co_rule *rule = finding->rule;

    return json_pack("{s:o, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o}", /* order as here */
                     "file", json_text(result->file), "line",
                     number_or_null(finding->line ? (int64_t)finding->line : -1), "severity",
                     co_severity_text(finding->severity), "rule",
                     text_or_null(rule ? rule->name : NULL), "clause",
                     text_or_null(rule ? rule->clause : NULL), "code",
                     text_or_null(rule_code(rule)), "index", number_or_null(finding->index), "sub",
                     number_or_null(finding->sub), "text", json_text(finding->text));
}

static json_t *messages_of(const struct settings *settings, const struct result *result)
{
    json_t *messages = json_array();
    const struct finding *finding;

    for (size_t i = 0; messages && (finding = result_at(result, i)) != NULL; i++) {
        if (finding_is_shown(settings, finding) &&
            json_array_append_new(messages, message_of(result, finding)) != 0) {
            json_decref(messages);
            return NULL;
        }
    }
    return messages;
}

static bool begin(struct output *self)
{
    (void)self;
    return fputs("{\"files\": [", stdout) >= 0;
}

static bool write_result(struct output *self, const struct result *result)
{
    json_t *file = json_pack("{s:o, s:I, s:I, s:o}", "file", json_text(result->file), "errors",
                             (json_int_t)result->errors, "warnings", (json_int_t)result->warnings,
                             "messages", messages_of(self->settings, result));

    return fputs(self->parts++ > 0 ? ",\n" : "\n", stdout) >= 0 &&
           json_write(file, JSON_INDENT(1), stdout);
}

static bool end(struct output *self)
{
    const struct totals *totals = &self->totals;
    json_t *summary = json_pack("{s:I, s:I, s:I}", "files", (json_int_t)totals->files, "errors",
                                (json_int_t)totals->errors, "warnings",
                                (json_int_t)totals->warnings);

    return fputs("\n],\n\"summary\": ", stdout) >= 0 && json_write(summary, 0, stdout) &&
           puts("}") >= 0;
}

const struct writer json_writer = { begin, write_result, end };

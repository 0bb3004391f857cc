/* One file: what the manager would say to it, and what does not fit together in it. */
#include "dcftest.h"

#include "api/file.h"
#include "common_file.h"
#include "common_tool.h"
#include "dcf/dcf_compare.h"
#include "dcf/dcf_lint.h"
#include "dcf/dcf_slice.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#define NODE_ID_MAX 127u

void result_init(struct result *self, const char *file)
{
    *self = (struct result){ .file = file };
}

void result_done(struct result *self)
{
    for (size_t i = 0; i < self->count; i++)
        free(self->findings[i].text);
    free(self->findings);
    *self = (struct result){ .file = NULL };
}

static struct finding *append(struct result *self)
{
    if (self->count == self->room) {
        const size_t room = self->room ? 2 * self->room : 16;
        struct finding *grown = reallocarray(self->findings, room, sizeof *grown);

        if (!grown)
            return NULL;
        self->findings = grown;
        self->room = room;
    }
    return &self->findings[self->count];
}

void result_take(struct result *self, const struct settings *settings,
                 const struct co_message *message)
{
    const bool warning = message->severity != CO_ERROR;
    struct finding *finding;
    char *text;

    if (!rule_choice_has(&settings->rules, message))
        return;
    ++*(warning ? &self->warnings : &self->errors);
    if (self->kept[warning] == FINDINGS_MAX)
        return;
    finding = append(self);
    text = finding ? strdup(message->body) : NULL;
    if (!text) {
        self->no_memory = true;
        return;
    }
    *finding = (struct finding){ .severity = message->severity,
                                 .is_minor = warning,
                                 .line = message->line,
                                 .order = (unsigned)self->count,
                                 .rule = message->rule,
                                 .index = -1,
                                 .sub = -1,
                                 .text = text };
    self->count++;
    self->kept[warning]++;
}

void result_add(struct result *self, const struct settings *settings, const struct co_rule *rule,
                unsigned line, const char *text)
{
    const struct co_message message = {
        .severity = rule->severity, .line = line, .rule = rule, .text = text, .body = text
    };

    result_take(self, settings, &message);
}

static int by_line(const void *left, const void *right)
{
    const struct finding *a = left, *b = right;

    if (a->line != b->line)
        return a->line < b->line ? -1 : 1;
    return a->order < b->order ? -1 : a->order > b->order;
}

/* "1018", "1018sub1", "1018Name" and so on. */
static void read_object(struct dcf_slice section, int32_t *ret_index, int32_t *ret_sub)
{
    const struct dcf_slice name = dcf_slice_trim(section);
    struct dcf_slice rest;
    unsigned index, sub;

    *ret_index = *ret_sub = -1;
    if (name.size < 4 || !dcf_slice_hex(dcf_slice_cut(name, 4), 4, &index))
        return;
    *ret_index = (int32_t)index;
    rest = dcf_slice_skip(name, 4);
    if (dcf_slice_begins(rest, "sub") && dcf_slice_hex(dcf_slice_skip(rest, 3), 2, &sub))
        *ret_sub = (int32_t)sub;
}

static const char *line_end(const char *at, const char *end)
{
    while (at < end && *at != '\r' && *at != '\n')
        at++;
    return at;
}

/* The line is of a section with another object, or of the same as before. */
static void read_section(const char *line, const char *end, struct finding *place)
{
    const char *close;

    while (line < end && dcf_is_blank(*line))
        line++;
    if (line == end || *line != '[')
        return;
    close = memchr(line, ']', (size_t)(end - line));
    if (close)
        read_object((struct dcf_slice){ line + 1, (size_t)(close - line - 1) }, &place->index,
                    &place->sub);
}

static const char *next_line(const char *at, const char *end)
{
    if (at < end && at[0] == '\r' && at + 1 < end && at[1] == '\n')
        at++;
    return at + 1;
}

/* Reads the text line by line, as far as the findings go. */
static void find_objects(struct result *self, const char *text, size_t size)
{
    const char *at = text, *end = text + size;
    struct finding place = { .line = 1, .index = -1, .sub = -1 };
    size_t next = 0;

    while (next < self->count && self->findings[next].line == 0)
        next++;
    for (; at < end && next < self->count; place.line++) {
        const char *stop = line_end(at, end);

        read_section(at, stop, &place);
        for (; next < self->count && self->findings[next].line <= place.line; next++) {
            self->findings[next].index = place.index;
            self->findings[next].sub = place.sub;
        }
        at = next_line(stop, end);
    }
}

static void add_rest(struct result *self, struct finding kind, const char *format, unsigned number)
    __attribute__((format(printf, 3, 0)));

static void add_rest(struct result *self, struct finding kind, const char *format, unsigned number)
{
    struct rest *rest = &self->rest[self->rest_count++];

    snprintf(rest->text, sizeof rest->text, format, number);
    rest->finding = kind;
    rest->finding.index = rest->finding.sub = -1;
    rest->finding.text = rest->text;
}

void result_finish(struct result *self, const struct settings *settings, const char *text,
                   size_t size)
{
    if (self->count > 0)
        qsort(self->findings, self->count, sizeof *self->findings, by_line);
    if (text && (settings->json || settings->sarif))
        find_objects(self, text, size);
    if (self->no_memory && ++self->errors > 0)
        add_rest(self, (struct finding){ .severity = CO_ERROR },
                 "out of memory: the file is not checked, or not as a whole", 0);
    else if (self->errors > self->kept[0])
        add_rest(self, (struct finding){ .severity = CO_INFO }, "errors that are not shown: %u",
                 self->errors - self->kept[0]);
    if (self->warnings > self->kept[1])
        add_rest(self, (struct finding){ .severity = CO_INFO, .is_minor = true },
                 "warnings that are not shown: %u", self->warnings - self->kept[1]);
}

const struct finding *result_at(const struct result *self, size_t number)
{
    if (number < self->count)
        return &self->findings[number];
    number -= self->count;
    return number < self->rest_count ? &self->rest[number].finding : NULL;
}

struct check {
    const struct settings *settings;
    const struct file *file;
    struct result *result;
    char *folder;
};

static void take_message(void *context, const struct co_message *message)
{
    const struct check *self = context;

    result_take(self->result, self->settings, message);
}

/* A file named in the DCF, beside it or below. */
static enum co_err read_beside(void *context, const char *name, uint8_t **ret_bytes,
                               size_t *ret_size)
{
    const struct check *self = context;
    char *path, *text = NULL;
    enum co_err err;

    if (asprintf(&path, "%s%s", self->folder, name) < 0)
        return CO_ERR_MEMORY;
    err = file_read(path, &text, ret_size);
    free(path);
    if (err == CO_OK)
        *ret_bytes = (uint8_t *)text;
    return err;
}

/*
 * The manager makes a configuration of the file, so this has to go well as well. Where nobody has
 * told the node-ID it is the largest: what leaves its type with one leaves it with that.
 */
static enum co_err try_configuration(struct check *self, const struct dcf *dcf,
                                     struct co_report *report)
{
    struct dcf_ccf_options options = { .node_id = self->settings->node_id,
                                       .read_file = read_beside,
                                       .context = self };
    struct ccf ccf;
    enum co_err err;

    if (options.node_id == 0)
        options.node_id = dcf->has_node_id ? dcf->node_id : NODE_ID_MAX;
    self->folder = file_folder(self->file->path);
    if (!self->folder)
        return CO_ERR_MEMORY;
    ccf_init(&ccf);
    err = dcf_make_ccf(dcf, &options, report, &ccf);
    ccf_done(&ccf);
    free(self->folder);
    return err;
}

/* What is only told; the manager does not ask. */
static enum co_err lint(const struct check *self, const struct dcf *dcf, struct co_report *report)
{
    if (self->settings->eds)
        dcf_compare(dcf, self->settings->eds, report);
    return dcf_lint(dcf, report);
}

static void check_text(struct check *self, const char *text, size_t size)
{
    struct co_report report = { .sink = take_message, .context = self, .limit = UINT_MAX };
    struct dcf dcf;
    enum co_err err = dcf_parse(text, size, &report, &dcf);

    if (err == CO_OK && lint(self, &dcf, &report) != CO_OK)
        self->result->no_memory = true;
    if (err == CO_OK)
        err = try_configuration(self, &dcf, &report);
    dcf_done(&dcf);
    if (err == CO_ERR_MEMORY)
        self->result->no_memory = true;
}

static const char *read_error(const struct file *file, enum co_err err)
{
    if (file->error == NOTHING_IN_IT)
        return "no file in it ends in .eds or .dcf";
    if (file->error == ENOENT)
        return file_error_text(CO_ERR_NOT_FOUND);
    if (file->error == EACCES)
        return file_error_text(CO_ERR_PERMISSION);
    return file->error ? strerror(file->error) : file_error_text(err);
}

bool read_or_tell(const struct settings *settings, const struct file *file, struct result *result,
                  char **ret_text, size_t *ret_size)
{
    enum co_err err = CO_ERR_IO;

    if (!file->error)
        err = file_read_input(file->path, ret_text, ret_size);
    if (err != CO_OK)
        result_add(result, settings, &tool_rules[RULE_UNREADABLE], 0, read_error(file, err));
    return err == CO_OK;
}

static void take_error(void *context, const struct co_message *message)
{
    if (message->severity == CO_ERROR)
        take_message(context, message);
}

bool read_eds(const struct settings *settings, const struct file *file, struct result *result,
              struct dcf *ret_eds)
{
    struct check self = { .settings = settings, .file = file, .result = result };
    struct co_report report = { .sink = take_error, .context = &self };
    enum co_err err = CO_ERR_IO;
    char *text = NULL;
    size_t size = 0;

    result_init(result, file_input_name(file->path));
    if (read_or_tell(settings, file, result, &text, &size))
        err = dcf_parse(text, size, &report, ret_eds);
    if (err == CO_ERR_MEMORY)
        result->no_memory = true;
    result_finish(result, settings, text, size);
    free(text);
    return err == CO_OK;
}

void check_file(const struct settings *settings, const struct file *file, struct result *result)
{
    struct check self = { .settings = settings, .file = file, .result = result };
    char *text = NULL;
    size_t size = 0;

    result_init(result, file_input_name(file->path));
    if (read_or_tell(settings, file, result, &text, &size))
        check_text(&self, text, size);
    result_finish(result, settings, text, size);
    free(text);
}
